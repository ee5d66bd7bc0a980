//! `tyndall render` and `tyndall plan` from the outside: flags, files, exit status, what is said.

mod common;

use common::{slats, stderr, tyndall};
use std::path::Path;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

#[test]
fn a_picture_is_written_and_everything_is_said_on_standard_error() {
    let folder = folder();
    slats(folder.path(), [48, 30]);
    let output = tyndall(
        folder.path(),
        &["render", "slats.toml", "--report", "report.json"],
    );
    let said = stderr(&output);
    assert!(output.status.success(), "{said}");
    assert!(output.stdout.is_empty());
    for words in [
        "2026-06-21 16:30:00 UTC",
        "+02:00",
        "zone Europe/Paris, looked up from the coordinates",
        "azimuth 271.",
        "sunrise 05:4",
        "sunset 21:58",
        "reference (CPU",
        "effects",
        "surface_sun",
        "estimate",
        "wrote",
        "tyndall.png, tyndall.exr",
    ] {
        assert!(
            said.contains(words) || words == "estimate",
            "`{words}` is not in {said}"
        );
    }
    let png = image::open(folder.path().join("tyndall.png")).expect("a PNG");
    assert_eq!((png.width(), png.height()), (48, 30));
    let exr = exr::prelude::read_first_flat_layer_from_file(folder.path().join("tyndall.exr"))
        .expect("an EXR");
    let names: Vec<String> = exr
        .layer_data
        .channel_data
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    for name in [
        "R",
        "G",
        "B",
        "Z",
        "sun.R",
        "sky.G",
        "indirect.B",
        "inscatter_sun.B",
        "transmittance.R",
        "normal.X",
    ] {
        assert!(
            names.contains(&name.to_owned()),
            "{name} is not in {names:?}"
        );
    }
    // What a compositor takes: points are rows. The camera looks from (0, 1.2, 6) at (0, 1.4, 0); the window is 8:5 and 60 degrees high.
    let attributes = &exr.layer_data.attributes;
    let times = |p: [f32; 3], m: Option<[f32; 16]>| -> [f32; 4] {
        let m = m.expect("it is there");
        std::array::from_fn(|c| p[0] * m[c] + p[1] * m[4 + c] + p[2] * m[8 + c] + m[12 + c])
    };
    let near = |found: [f32; 2], x: f32, y: f32| {
        assert!(
            (found[0] - x).abs() < 1e-5 && (found[1] - y).abs() < 1e-5,
            "{found:?}"
        );
    };
    let seen = |p| {
        let [x, y, _, w] = times(p, attributes.world_to_normalized_device);
        assert!(w > 0.0);
        [x / w, y / w]
    };
    near(seen([0.0, 1.4, 0.0]), 0.5, 0.5);
    let distance = 36.04f32.sqrt();
    let half = distance * 30f32.to_radians().tan();
    near(seen([half * 1.6, 1.4, 0.0]), 1.0, 0.5);
    let [x, y, z, _] = times([0.0, 1.4, 0.0], attributes.world_to_camera);
    near([x, y], 0.0, 0.0);
    assert!((z + distance).abs() < 1e-5, "it looks along -Z");
    let report = std::fs::read_to_string(folder.path().join("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!(report["record"]["utc"], "2026-06-21T16:30:00Z");
    let local = report["record"]["local_time"].as_str().expect("words");
    assert!(
        local.starts_with("2026-06-21") && local.contains("18:30"),
        "{local}"
    );
    let camera = report["record"]["camera"].as_str().expect("a block");
    assert!(camera.contains("eye = [0.0, 1.2, 6.0]"), "{camera}");
    assert_eq!(
        report["record"]["worldToNDC"].as_array().map(Vec::len),
        Some(16)
    );
    assert!(report["plan"].as_array().is_some_and(|p| p.len() > 5));
}

#[test]
fn the_stages_are_all_of_the_time() {
    let folder = folder();
    slats(folder.path(), [48, 30]);
    let begin = std::time::Instant::now();
    let report = report(folder.path(), &["--samples", "4"]);
    let wall = begin.elapsed().as_secs_f64();
    let stages = report["stages"].as_array().expect("stages");
    let named = |name: &str| stages.iter().any(|stage| stage["name"] == name);
    for name in ["prepare", "device", "plan", "radiosity.prepare", "write"] {
        assert!(named(name), "{name} is not in {stages:?}");
    }
    let seconds = stages.iter().filter_map(|stage| stage["seconds"].as_f64());
    let sum: f64 = seconds.sum();
    // The process itself starts and ends too.
    assert!(sum <= wall && sum >= 0.95 * wall - 0.3, "{sum} of {wall} s");
    assert!(report["convergence"].is_null(), "nothing goes by points");
}

#[test]
fn the_plain_way_says_how_far_it_is_from_converged() {
    let folder = folder();
    slats(folder.path(), [48, 30]);
    let flags = "--quality reference --size 24x15 --without radiosity --without air_sky";
    let flags: Vec<&str> = flags.split(' ').collect();
    let report = report(folder.path(), &flags);
    let convergence = &report["convergence"];
    assert_eq!(convergence["points"], 128);
    let layers = convergence["layers"].as_array().expect("layers");
    let names: Vec<&str> = layers.iter().filter_map(|l| l["layer"].as_str()).collect();
    assert_eq!(names, ["sun", "inscatter_sun"]);
    for layer in layers {
        let change = layer["relative_rmse"].as_f64().expect("a number");
        assert!((0.0..0.1).contains(&change), "{layer}");
    }
    let said = std::fs::read_to_string(folder.path().join("said")).expect("what was said");
    assert!(said.contains("half as many change sun by"), "{said}");
}

/// The report of a picture of the scene; what was said lies beside it in `said`.
fn report(folder: &Path, flags: &[&str]) -> serde_json::Value {
    let all = [&["render", "slats.toml", "--report", "report.json"], flags].concat();
    let output = tyndall(folder, &all);
    let said = stderr(&output);
    assert!(output.status.success(), "{said}");
    std::fs::write(folder.join("said"), said).expect("it is written");
    let text = std::fs::read_to_string(folder.join("report.json")).expect("a report");
    serde_json::from_str(&text).expect("it is JSON")
}

#[test]
fn the_same_command_makes_the_same_bytes() {
    let folder = folder();
    slats(folder.path(), [48, 30]);
    for name in ["a.exr", "b.exr"] {
        let output = tyndall(
            folder.path(),
            &["render", "slats.toml", "--samples", "4", "-o", name],
        );
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("an EXR");
    assert!(read("a.exr") == read("b.exr"));
}

#[test]
fn what_the_user_must_change_is_status_2_and_says_how() {
    let folder = folder();
    slats(folder.path(), [48, 30]);
    std::fs::write(folder.path().join("bare.toml"), "mesh = \"slats.obj\"\n").expect("written");
    std::fs::write(
        folder.path().join("typo.toml"),
        "mesh = \"slats.obj\"\n[site]\nlattitude = 1\n",
    )
    .expect("written");
    let cases: [(&[&str], &[&str]); 16] = [
        (&["bare.toml"], &["no sun", "--at", "--time", "--sun"]),
        (
            &["bare.toml", "--time", "2026-06-21T12:00Z"],
            &["no place", "--at"],
        ),
        (&["bare.toml", "--at", "48,2"], &["no time", "--time"]),
        (&["missing.glb"], &["missing.glb"]),
        (&["typo.toml"], &["typo.toml", "3", "lattitude", "latitude"]),
        (&["slats.toml", "--at", "151.2,-33.86"], &["-33.86,151.2"]),
        (&["slats.toml", "--at", "--north", "5"], &["--north"]),
        (
            &["slats.toml", "--time", "2026-03-29T02:30"],
            &["--fold", "earlier"],
        ),
        (&["slats.toml", "--without", "shaft"], &["shafts"]),
        (&["slats.toml", "--set", "shafts.sun=4"], &["suns"]),
        (&["slats.toml", "--set", "shafts.suns=0"], &["1 to 4096"]),
        (&["slats.toml", "--size", "0x10"], &["1 to 65536"]),
        (
            &["slats.toml", "--layers", "inscater_sun"],
            &["inscatter_sun"],
        ),
        (&["slats.toml", "-o", "picture.tif"], &[".png"]),
        (&["slats.toml", "--camera", "north"], &["--camera inside"]),
        (&["slats.toml", "--sky", "blue"], &["perez"]),
    ];
    for (arguments, words) in cases {
        let output = tyndall(folder.path(), &[&["render"], arguments].concat());
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        for word in words {
            assert!(said.contains(word), "`{word}` is not in {said}");
        }
    }
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .expect("a folder")
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".png") || name.ends_with(".exr"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn work_that_fails_is_status_1() {
    let folder = folder();
    slats(folder.path(), [48, 30]);
    let output = tyndall(
        folder.path(),
        &["render", "slats.toml", "-o", "no/such/folder/a.png"],
    );
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let output = tyndall(
        folder.path(),
        &[
            "render",
            "slats.toml",
            "--max-memory",
            "1e-6",
            "-o",
            "a.png",
        ],
    );
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("--max-memory"));
}

#[test]
fn quality_follows_the_error_or_the_time_that_is_asked_for() {
    let folder = folder();
    slats(folder.path(), [48, 30]);
    let chosen = |arguments: &[&str]| {
        let always = [
            "render",
            "slats.toml",
            "--backend",
            "reference",
            "-o",
            "a.png",
            // What takes long at the quality `reference`, and is not needed to see which quality is chosen.
            "--without",
            "radiosity",
            "--without",
            "air_sky",
        ];
        tyndall(folder.path(), &[&always[..], arguments].concat())
    };
    let loose = chosen(&["--max-error", "10"]);
    assert!(
        stderr(&loose).contains("draft: relative RMSE"),
        "{}",
        stderr(&loose)
    );
    let tight = chosen(&["--max-error", "1e-9"]);
    assert!(
        stderr(&tight).contains("reference: relative RMSE"),
        "{}",
        stderr(&tight)
    );
    let slow = chosen(&["--within", "1e9"]);
    assert!(
        stderr(&slow).contains("reference: about"),
        "{}",
        stderr(&slow)
    );
    let fast = chosen(&["--within", "1e-6"]);
    assert_eq!(fast.status.code(), Some(1), "{}", stderr(&fast));
    let both = chosen(&["--within", "1", "--max-error", "1"]);
    assert_eq!(both.status.code(), Some(2));
}

#[test]
fn no_haze_no_shafts_and_no_sun_no_sun_passes() {
    let folder = folder();
    slats(folder.path(), [48, 30]);
    let decisions = |arguments: &[&str]| {
        let output = tyndall(folder.path(), &[&["plan", "--json"], arguments].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        let plan: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let effects = plan["effects"].as_array().expect("a list").clone();
        move |name: &str| {
            let entry = effects
                .iter()
                .find(|e| e["effect"] == name)
                .expect("every effect is listed");
            assert!(entry["reason"].as_str().is_some_and(|r| !r.is_empty()));
            entry["run"].as_bool().expect("run or skipped")
        }
    };
    let day = decisions(&["slats.toml"]);
    assert!(
        day("shafts_rectified") && day("surface_sun") && day("transmittance") && !day("sun_disc")
    );
    let night = decisions(&["slats.toml", "--time", "2026-06-21T23:30"]);
    assert!(!night("shafts_rectified") && !night("surface_sun") && night("radiosity"));
    std::fs::write(
        folder.path().join("clear.toml"),
        "mesh = \"slats.obj\"\n[sun]\nazimuth = 120\nelevation = 30\nilluminance = 1\ndiameter = 0\n",
    )
    .expect("written");
    let clear = decisions(&["clear.toml"]);
    assert!(
        !clear("shafts_rectified")
            && !clear("transmittance")
            && !clear("sky_dome")
            && clear("surface_sun")
    );
    let without = decisions(&["slats.toml", "--without", "shafts"]);
    assert!(!without("shafts_rectified"));
    let output = tyndall(folder.path(), &["plan", "clear.toml", "--force", "shafts"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
}

#[test]
fn the_table_of_the_plan_names_every_effect() {
    let folder = folder();
    slats(folder.path(), [48, 30]);
    let output = tyndall(folder.path(), &["plan", "slats.toml"]);
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    for name in [
        "visibility",
        "sky_dome",
        "radiosity",
        "air_sky",
        "shafts",
        "estimate",
        "predicted",
    ] {
        assert!(table.contains(name), "{name} is not in {table}");
    }
    // As CSV only cells with commas stand in quotes.
    let output = tyndall(folder.path(), &["plan", "slats.toml", "--csv"]);
    let csv = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(csv.starts_with("effect,,adds at most [cd/m2],predicted,why\nvisibility,run,all,"));
    assert!(
        csv.contains(",\"Perez 1993 all-weather sky, clear, turbidity 3\"\n"),
        "{csv}"
    );
}

#[test]
fn schema_completions_manual_and_doctor_are_there() {
    let folder = folder();
    for arguments in [
        &["schema"][..],
        &["completions", "bash"],
        &["completions", "zsh"],
        &["man"],
        &["doctor"],
    ] {
        let output = tyndall(folder.path(), arguments);
        assert!(
            output.status.success(),
            "{arguments:?}: {}",
            stderr(&output)
        );
        assert!(!output.stdout.is_empty(), "{arguments:?}");
    }
}
