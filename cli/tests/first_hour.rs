//! What somebody finds in the first hour: a picture that is dark says why, pipes, sizes, layers, what is said and what is not.

mod common;

use common::{quads_obj, slats, stderr, tyndall};
use std::collections::BTreeSet;
use std::path::Path;

/// A picture of a scene in a folder, by the reference; what was said of it.
fn rendered(folder: &Path, scene: &str, more: &[&str]) -> std::process::Output {
    let usual = ["render", scene, "--backend", "reference", "--size", "24x16"];
    tyndall(folder, &[&usual[..], more].concat())
}

/// A closed box around a room, and what is written of it: a place, an eye in the room.
fn closed_room(folder: &Path) {
    let quad = |axis: usize, at: f64| {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[u, v]| {
            let mut corner = [0.0; 3];
            corner[axis] = at;
            corner[(axis + 1) % 3] = 4.0 * u - 2.0;
            corner[(axis + 2) % 3] = 4.0 * v - 2.0;
            corner
        })
    };
    let sides: Vec<_> = (0..3)
        .flat_map(|axis| [quad(axis, -2.0), quad(axis, 2.0)])
        .collect();
    std::fs::write(folder.join("box.obj"), quads_obj(&sides)).expect("the mesh is written");
    let text = "mesh = \"box.obj\"\ntime = \"2026-06-21T12:00\"\n[site]\nlatitude = 48.8\nlongitude = 2.3\n\
                [camera]\neye = [0.0, 0.0, 1.0]\ntarget = [0.0, 0.0, -1.0]\n";
    std::fs::write(folder.join("box.toml"), text).expect("the scene is written");
}

#[test]
fn a_picture_that_nothing_lights_says_why() {
    let folder = tempfile::tempdir().expect("a folder");
    closed_room(folder.path());
    slats(folder.path(), [24, 16]);
    let said = |scene: &str, more: &[&str]| {
        let output = rendered(folder.path(), scene, &[&["-o", "a.png"], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    let lit = said("slats.toml", &[]);
    assert!(!lit.contains("nothing lights"), "{lit}");
    // The same is said whoever listens.
    let quiet = said("box.toml", &["--quiet"]);
    assert!(
        quiet.contains("nothing lights this picture: none of 512 rays from the eye")
            && quiet.contains("(it is black)")
            && quiet.contains("--camera inside"),
        "{quiet}"
    );
    // A hole in the roof is a window.
    let mesh = std::fs::read_to_string(folder.path().join("box.obj")).expect("it is there");
    let open: Vec<&str> = mesh
        .lines()
        .filter(|line| *line != "f 13 14 15 16")
        .collect();
    assert!(open.len() < mesh.lines().count(), "{mesh}");
    std::fs::write(folder.path().join("box.obj"), open.join("\n")).expect("it is written");
    let open = said("box.toml", &[]);
    assert!(!open.contains("nothing lights"), "{open}");

    let night = said("slats.toml", &["--time", "2026-12-21T23:50"]);
    assert!(
        night.contains("nothing lights this picture: the sun is 6")
            && night.contains("the night has no moon")
            && night.contains("(EV100 -"),
        "{night}"
    );
    let given = said(
        "slats.toml",
        &["--time", "2026-12-21T23:50", "--exposure", "-10"],
    );
    assert!(!given.contains("nothing lights"), "{given}");
    let output = rendered(
        folder.path(),
        "slats.toml",
        &["--json", "--time", "2026-12-21T23:50"],
    );
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let warnings = report["warnings"].to_string();
    assert!(
        warnings.contains("nothing lights this picture"),
        "{warnings}"
    );
}

#[test]
fn a_picture_brighter_than_snow_says_why() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = slats(folder.path(), [24, 16]);
    let text = std::fs::read_to_string(&path).expect("it is there");
    let sun = "[sun]\nazimuth = 180\nelevation = 60\nilluminance = 1.2e8\n";
    let kept = text.split("[camera]").nth(1).expect("a camera");
    let text = format!("mesh = \"slats.obj\"\n{sun}[camera]{kept}");
    std::fs::write(&path, text).expect("it is written");
    let output = rendered(folder.path(), "slats.toml", &["-o", "a.png"]);
    let said = stderr(&output);
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("brighter than snow in the sun: the sun is given 1.200e8 lx"),
        "{said}"
    );
}

#[test]
fn a_sequence_names_its_darkest_frame() {
    let folder = tempfile::tempdir().expect("a folder");
    slats(folder.path(), [16, 10]);
    let words = "timelapse slats.toml --from 2026-12-21T12:00 --to 2026-12-21T23:50 --frames 3 --quality draft --backend reference \
                 -o out/f_#.exr --json";
    let output = tyndall(folder.path(), &words.split(' ').collect::<Vec<_>>());
    let said = stderr(&output);
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("nothing lights frame 3, 2026-12-21T23:50"),
        "{said}"
    );
    assert!(
        !said.contains("frame 1, 2026-12-21T12:00:00+01:00:"),
        "{said}"
    );
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON alone");
    assert!(
        report["warnings"]
            .to_string()
            .contains("nothing lights frame 3")
    );

    // By night and by day a file holds the same, under the same names.
    let file = |frame: u32| {
        let path = folder.path().join(format!("out/f_{frame}.exr"));
        exr::prelude::read_first_flat_layer_from_file(path).expect("an EXR")
    };
    let names = |frame: u32| -> [BTreeSet<String>; 2] {
        let file = file(frame);
        let channels = file.layer_data.channel_data.list.iter();
        let attributes = file.layer_data.attributes.other.keys();
        [
            channels.map(|channel| channel.name.to_string()).collect(),
            attributes.map(|name| name.to_string()).collect(),
        ]
    };
    let [channels, attributes] = names(1);
    assert_eq!(names(3), [channels.clone(), attributes.clone()]);
    for name in [
        "sun.R",
        "inscatter_sun.B",
        "transmittance.G",
        "normal.X",
        "Z",
    ] {
        assert!(channels.contains(name), "{name}: {channels:?}");
    }
    assert!(
        attributes.contains("tyndall:shafts_rectified.rows"),
        "{attributes:?}"
    );
    // There are no lamps, and five ways to integrate one light.
    assert!(
        !channels.iter().any(|name| name.contains("lights")),
        "{channels:?}"
    );
    let others = ["tyndall:shafts_march.steps", "tyndall:surface_lamps.cells"];
    assert!(
        others.iter().all(|name| !attributes.contains(*name)),
        "{attributes:?}"
    );
}

#[test]
fn an_exr_holds_what_the_scene_can_hold_or_what_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    closed_room(folder.path());
    slats(folder.path(), [24, 16]);
    let layers = |scene: &str, more: &[&str]| {
        let output = rendered(
            folder.path(),
            scene,
            &[&["-o", "a.exr", "--json"], more].concat(),
        );
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let names = report["layers"].as_array().expect("a list").clone();
        let file = exr::prelude::read_first_flat_layer_from_file(folder.path().join("a.exr"));
        let file = file.expect("an EXR");
        let channels = &file.layer_data.channel_data.list;
        // R, G, B and Z are no layers of their own.
        assert_eq!(channels.len(), 4 + 3 * names.len(), "{report}");
        names
            .iter()
            .map(|n| n.as_str().expect("a name").to_owned())
            .collect::<Vec<_>>()
    };
    let room = layers("box.toml", &[]);
    assert_eq!(room, ["sun", "sky", "indirect", "background", "normal"]);
    let hazy = layers("slats.toml", &[]);
    assert_eq!(hazy.len(), 8, "{hazy:?}");
    let without = layers("slats.toml", &["--without", "shafts"]);
    assert!(
        !without.contains(&"inscatter_sun".to_owned()),
        "{without:?}"
    );
    assert_eq!(layers("box.toml", &["--layers", "all"]).len(), 10);
    assert_eq!(
        layers("box.toml", &["--layers", "sky,inscatter_sky"]).len(),
        2
    );
}

#[test]
fn pictures_go_through_pipes() {
    let folder = tempfile::tempdir().expect("a folder");
    slats(folder.path(), [24, 16]);
    let begins = [
        ("png", &b"\x89PNG"[..]),
        ("exr", b"\x76\x2f\x31\x01"),
        ("hdr", b"#?RADIANCE"),
        ("jpeg", b"\xff\xd8\xff\xe0"),
    ];
    for (format, magic) in begins {
        let sky = [
            "sky", "--sun", "180,30", "--size", "64", "-o", "-", "--format", format,
        ];
        let output = tyndall(folder.path(), &sky);
        assert!(output.status.success(), "{format}: {}", stderr(&output));
        assert!(
            output.stdout.starts_with(magic),
            "{format}: the picture alone"
        );
    }
    // A PNG unless another is asked for, and files beside it.
    let output = rendered(
        folder.path(),
        "slats.toml",
        &["-o", "-", "-o", "a.jpg", "--quiet"],
    );
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{}",
        stderr(&output)
    );
    let png = image::load_from_memory(&output.stdout).expect("a PNG");
    assert_eq!((png.width(), png.height()), (24, 16));
    let jpeg = std::fs::read(folder.path().join("a.jpg")).expect("it is there");
    assert!(jpeg.starts_with(b"\xff\xd8") && jpeg.ends_with(b"\xff\xd9"));
    for (bad, says) in [
        (
            &["-o", "-", "--json"][..],
            "standard output has what --json prints already",
        ),
        (&["-o", "-", "-o", "-"], "named twice"),
        (&["-o", "a.tiff"], ".jpg"),
        (&["-o", "-", "--format", "gif"], "gif"),
    ] {
        let output = rendered(folder.path(), "slats.toml", bad);
        assert_eq!(output.status.code(), Some(2), "{bad:?}");
        assert!(
            stderr(&output).contains(says),
            "{bad:?}: {}",
            stderr(&output)
        );
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn what_is_skipped_is_said_where_somebody_expects_it() {
    let folder = tempfile::tempdir().expect("a folder");
    slats(folder.path(), [24, 16]);
    let skipped = |more: &[&str]| -> Vec<String> {
        let output = rendered(
            folder.path(),
            "slats.toml",
            &[&["-o", "a.png"], more].concat(),
        );
        let said = stderr(&output);
        assert!(output.status.success(), "{said}");
        let lines = said.lines().filter(|line| line.starts_with("skipped"));
        lines.map(str::to_owned).collect()
    };
    assert_eq!(skipped(&[]), [""; 0]);
    let night = skipped(&["--time", "2026-06-21T23:50"]);
    assert_eq!(night.len(), 1, "{night:?}");
    for name in [
        "shafts_rectified",
        "surface_sun",
        "the sun is below the horizon",
    ] {
        assert!(night[0].contains(name), "{night:?}");
    }
    let without = skipped(&["--without", "shafts"]);
    assert!(
        without.len() == 1 && without[0].contains("--without"),
        "{without:?}"
    );
    let set = skipped(&["--set", "surface_lamps.cells=2"]);
    assert!(
        set.len() == 1 && set[0].contains("surface_lamps"),
        "{set:?}"
    );
    let all = skipped(&["--verbose"]).join("\n");
    for name in ["shafts_march", "the method is rectified", "air_lamps"] {
        assert!(all.contains(name), "{all}");
    }
    let both = rendered(folder.path(), "slats.toml", &["--quiet", "--verbose"]);
    assert_eq!(both.status.code(), Some(2));
}

#[test]
fn one_side_of_a_picture_is_enough() {
    let folder = tempfile::tempdir().expect("a folder");
    slats(folder.path(), [48, 30]);
    for (size, expected) in [
        ("96", [96, 60]),
        ("x60", [96, 60]),
        ("16x", [16, 10]),
        ("9x9", [9, 9]),
    ] {
        let output = tyndall(
            folder.path(),
            &["plan", "slats.toml", "--json", "--size", size],
        );
        let plan: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(plan["size"], serde_json::json!(expected), "{size}");
    }
}

#[test]
fn the_sky_over_a_day_is_a_row_a_step() {
    let folder = tempfile::tempdir().expect("a folder");
    let day = [
        "sky",
        "--at",
        "-20.333333333,202.6",
        "--time",
        "2026-06-21",
        "--until",
        "2026-06-22",
    ];
    let output = tyndall(
        folder.path(),
        &[&day[..], &["--step", "90min", "--json"]].concat(),
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let whole: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(
        (&whole["sky"], &whole["step_seconds"]),
        (&"perez".into(), &5400.0.into())
    );
    let rows = whole["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 16);
    assert_eq!(rows[0]["longitude"], -157.4);
    let lux = |i: usize| {
        rows[i]["horizontal_illuminance_lx"]
            .as_f64()
            .expect("a number")
    };
    assert!(
        lux(8) > 1e4 && lux(0) < 1.0,
        "noon {} and midnight {}",
        lux(8),
        lux(0)
    );
    // The same as at one time.
    let time = rows[8]["utc"].as_str().expect("a time");
    let one = tyndall(
        folder.path(),
        &[
            "sky",
            "--at",
            "-20.333333333,202.6",
            "--time",
            time,
            "--json",
        ],
    );
    let one: serde_json::Value = serde_json::from_slice(&one.stdout).expect("JSON");
    assert_eq!(
        one["horizontal_illuminance_lx"],
        rows[8]["horizontal_illuminance_lx"]
    );
    // The clock of the place, as without --until.
    assert_eq!(rows[0]["time"], "2026-06-21T00:00:00-10:00");
    assert!(
        rows[0]["offset_from"]
            .as_str()
            .is_some_and(|source| source.contains("looked up"))
    );

    let csv = tyndall(folder.path(), &[&day[..], &["--csv"]].concat());
    let csv = String::from_utf8(csv.stdout).expect("UTF-8");
    assert_eq!(csv.lines().count(), 25);
    assert!(csv.starts_with("time,utc,"), "{csv}");
    let table = tyndall(folder.path(), &day);
    let table = String::from_utf8(table.stdout).expect("UTF-8");
    assert!(
        table.lines().count() == 25 && table.contains("ground lx"),
        "{table}"
    );
    for (bad, says) in [
        (&["--until", "2026-06-20"][..], "not after"),
        (&["--until", "2126-06-20", "--step", "1s"], "1 to 100000"),
        (&["--until", "2026-06-22", "--step", "soon"], "10min"),
    ] {
        let output = tyndall(folder.path(), &[&day[..5], bad].concat());
        assert_eq!(output.status.code(), Some(2), "{bad:?}");
        assert!(
            stderr(&output).contains(says),
            "{bad:?}: {}",
            stderr(&output)
        );
    }
}

/// The rows of `tyndall sky` over a range, or what it says of one time, as JSON; and what else it says.
fn skies(words: &str) -> (serde_json::Value, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let words: Vec<&str> = ["sky"].into_iter().chain(words.split(' ')).collect();
    let output = tyndall(folder.path(), &[&words[..], &["--json"]].concat());
    let said = stderr(&output);
    assert!(output.status.success(), "{words:?}: {said}");
    let mut all: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = all.get_mut("rows").map(serde_json::Value::take);
    (rows.unwrap_or(all), said)
}

#[test]
fn the_instants_of_a_range_are_not_rounded() {
    // Paris mean time was 9 minutes and 21 seconds ahead.
    let (rows, _) = skies("--at 48.8584,2.2945 --time 1900-01-01 --until 1900-01-02 --step 12h");
    let expected = [
        ("1900-01-01T00:00:00+00:09:21", "1899-12-31T23:50:39Z"),
        ("1900-01-01T12:00:00+00:09:21", "1900-01-01T11:50:39Z"),
    ];
    let texts = |rows: &serde_json::Value, name: &str| -> Vec<String> {
        let rows = rows.as_array().expect("rows").iter();
        rows.map(|row| row[name].as_str().expect("a text").to_owned())
            .collect()
    };
    assert_eq!(texts(&rows, "time"), expected.map(|(time, _)| time));
    assert_eq!(texts(&rows, "utc"), expected.map(|(_, utc)| utc));
    // Monrovia kept 44 minutes and 30 seconds until 1972.
    let (one, _) = skies("--at 6.3,-10.8 --time 1970-01-01T12:00");
    assert_eq!(one["time"], "1970-01-01T12:00:00-00:44:30");
    assert_eq!(one["utc"], "1970-01-01T12:44:30Z");

    let terrestrial = "--at 48.8584,2.2945 --time-scale tt --time JD2461000.5";
    let (rows, _) = skies(&format!("{terrestrial} --until JD2461000.7 --step 2h"));
    let (one, _) = skies(terrestrial);
    assert_eq!(rows.as_array().map(Vec::len), Some(3));
    for name in ["utc", "time", "offset_from"] {
        assert_eq!(rows[0][name], one[name], "{name}");
    }
    let azimuth = |row: &serde_json::Value| row["sun_azimuth"].as_f64().expect("degrees");
    assert!((azimuth(&rows[0]) - azimuth(&one)).abs() < 1e-9);
    // TT is 69 s ahead of UTC.
    let utc = one["utc"].as_str().expect("a time");
    assert!(utc.starts_with("2025-11-20T23:58:5"), "{utc}");

    let (rows, _) =
        skies("--at 0,0 --time 2026-06-21T12:00:00Z --until 2026-06-21T12:00:00.1Z --step 0.0333");
    let utc = texts(&rows, "utc");
    let ends = ["00Z", "00.033300Z", "00.066600Z", "00.099900Z"];
    assert_eq!(utc, ends.map(|end| format!("2026-06-21T12:00:{end}")));
    assert_eq!(rows[1]["time"], "2026-06-21T12:00:00.033300+00:00");
}

#[test]
fn a_range_warns_as_one_time_does() {
    let measured = "--at 48,2 --time 2026-06-21T12:30 --direct-normal 900 --diffuse-horizontal 1";
    let (one, said) = skies(measured);
    let words = "outside the Perez model's data";
    assert!(said.contains(words), "{said}");
    let (rows, said) = skies(&format!("{measured} --until 2026-06-21T14:30 --step 30min"));
    assert_eq!(said.matches(words).count(), 1, "{said}");
    assert!(
        said.contains("from 2026-06-21T12:30:00+02:00 on: "),
        "{said}"
    );
    assert_eq!(rows[0]["warnings"], one["warnings"]);
    assert_eq!(rows[3]["warnings"].as_array().map(Vec::len), Some(1));
}

#[test]
fn flags_that_would_do_nothing_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    slats(folder.path(), [24, 16]);
    let render = "render slats.toml --backend reference --size 24x16";
    for (words, says) in [
        (
            "sky --sun 180,30 -o a.png --format jpeg".to_owned(),
            "add -o -",
        ),
        ("sky --sun 180,30 --format jpeg".into(), "--format"),
        (format!("{render} -o a.png --format png"), "--format"),
        (format!("{render} -o a.png --layers sun"), "--layers"),
        (
            format!("{render} -o a.png --report -"),
            "--json prints the same",
        ),
        (
            "render slats.toml --size 65536x2 -o a.jpg".into(),
            "1 to 65535",
        ),
        (
            "sky --sun 180,30 --size 65536 -o a.jpg".into(),
            "1 to 65535",
        ),
        ("sky --sun 180,30 --size 101 -o a.png".into(), "--size 100"),
        ("sky --sun 180,30 --size 0 -o a.png".into(), "--size 4"),
        ("sky --sun 180,30 --size x51 -o a.png".into(), "--size x52"),
        (
            "sky --sun 180,30 --size 64x40 --projection cube -o a.png".into(),
            "--size 66x11",
        ),
    ] {
        let output = tyndall(folder.path(), &words.split(' ').collect::<Vec<_>>());
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{words}: {said}");
        assert!(said.contains(says), "{words}: {said}");
        assert!(output.stdout.is_empty(), "{words}");
    }
    let written = folder.path().read_dir().expect("it is there");
    assert_eq!(written.count(), 2, "the scene and its mesh");
}

#[test]
fn a_pipe_needs_a_temporary_folder_before_anything_is_made() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .args(["sky", "--sun", "180,30", "--size", "64", "-o", "-"])
        .args(["-o", "beside.png"])
        .current_dir(folder.path())
        .env("TMPDIR", "/nowhere/at/all")
        .output()
        .expect("tyndall starts");
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("/nowhere/at/all"), "{said}");
    assert!(said.contains("TMPDIR"), "{said}");
    assert!(!folder.path().join("beside.png").exists());
}

#[test]
fn notes_are_not_said_to_who_wants_quiet() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = "model,sun_elevation,turbidity,view_azimuth,view_elevation,place\n";
    std::fs::write(folder.path().join("a.csv"), rows).expect("it is written");
    let said = |more: &[&str]| {
        let words = [&["sky", "--batch", "a.csv"], more].concat();
        let output = tyndall(folder.path(), &words);
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    let usual = said(&[]);
    assert!(usual.contains("the column `place` is not read"), "{usual}");
    assert!(usual.contains("a.csv has no rows"), "{usual}");
    assert_eq!(said(&["--quiet"]), "");
}

#[test]
fn pictures_over_a_range_are_rows_of_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    slats(folder.path(), [24, 15]);
    let range = [
        "render",
        "slats.toml",
        "--quality",
        "draft",
        "--backend",
        "reference",
        "--without",
        "shafts",
        "--time",
        "2026-06-21T16:00",
        "--until",
        "2026-06-21T19:00",
        "--step",
        "90min",
    ];
    let output = tyndall(folder.path(), &[&range[..], &["--json"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let whole: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = whole["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 2);
    assert_eq!(rows[1]["time"], "2026-06-21T17:30:00+02:00");
    let number = |name: &str| rows[1][name].as_f64().expect(name);
    // The same as a picture of that time.
    let one = [
        &range[..8],
        &["--time", "2026-06-21T17:30", "--json", "-o", "one.exr"],
    ]
    .concat();
    let one = tyndall(folder.path(), &one);
    assert!(one.status.success(), "{}", stderr(&one));
    let one: serde_json::Value = serde_json::from_slice(&one.stdout).expect("JSON");
    for (name, record) in [
        ("ev100", "exposure_ev100"),
        ("sun_azimuth", "sun_azimuth_deg"),
        ("sun_normal_illuminance_lx", "sun_illuminance_lx"),
    ] {
        let truth = one["record"][record].as_f64().expect(record);
        assert!((number(name) - truth).abs() < 1e-6 * truth, "{name}");
    }
    // Layers add up to the picture, and the eye in the open has some of the sky.
    let layers = rows[1].as_object().expect("columns").iter();
    let layers =
        layers.filter(|(name, _)| name.starts_with("mean_") && *name != "mean_luminance_cd_m2");
    let sum: f64 = layers.filter_map(|(_, mean)| mean.as_f64()).sum();
    let mean = number("mean_luminance_cd_m2");
    assert!(
        mean > 10.0 && (sum / mean - 1.0).abs() < 1e-4,
        "{sum} {mean}"
    );
    let (eye, sky) = (
        number("eye_illuminance_lx"),
        number("sky_horizontal_illuminance_lx"),
    );
    assert!(eye > 0.02 * sky && eye < 10.0 * sky, "{eye} {sky}");

    let csv = tyndall(folder.path(), &[&range[..], &["--csv"]].concat());
    let csv = String::from_utf8(csv.stdout).expect("UTF-8");
    assert!(
        csv.starts_with("time,utc,") && csv.lines().count() == 3,
        "{csv}"
    );
    let with_files = tyndall(folder.path(), &[&range[..], &["-o", "x.png"]].concat());
    assert_eq!(with_files.status.code(), Some(2));
    assert!(
        stderr(&with_files).contains("timelapse"),
        "{}",
        stderr(&with_files)
    );
}

#[test]
fn exposures_places_and_plots_are_as_written_or_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    slats(folder.path(), [24, 15]);
    let ev100 = |exposure: &str| {
        let words = [
            "render",
            "slats.toml",
            "--quality",
            "draft",
            "--backend",
            "reference",
            "--without",
            "shafts",
            "--without",
            "radiosity",
            "--json",
            "-o",
            "e.png",
            "--exposure",
            exposure,
        ];
        let output = tyndall(folder.path(), &words);
        assert!(output.status.success(), "{}", stderr(&output));
        let all: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        all["record"]["exposure_ev100"].as_f64().expect("EV")
    };
    assert!((ev100("auto") - ev100("auto+2") - 2.0).abs() < 1e-9);

    let chicago = tyndall(
        folder.path(),
        &[
            "sun",
            "--place",
            "chicago",
            "--time",
            "2026-06-21T12:00",
            "--json",
        ],
    );
    let said = stderr(&chicago);
    assert!(
        said.contains("Chicago, United States: --at 41.85,-87.65"),
        "{said}"
    );
    let all: serde_json::Value = serde_json::from_slice(&chicago.stdout).expect("JSON");
    assert_eq!(all["time"], "2026-06-21T12:00:00-05:00");
    for (words, says) in [
        (&["sun", "--place", "Chicgo"][..], "`Chicago`"),
        (
            &["sun", "--place", "Paris", "--at", "1,2"],
            "cannot be used",
        ),
        (&["accuracy", "--plot", "x.svg"], "no plot"),
        (
            &[
                "render",
                "--time",
                "2026-06-21",
                "--until",
                "2026-06-22",
                "--multiply",
                "2",
            ],
            "cannot be used",
        ),
        (&["sky", "--sun", "1,2", "--exposure", "auto2"], "auto+2"),
    ] {
        let output = tyndall(folder.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(
            stderr(&output).contains(says),
            "{words:?}: {}",
            stderr(&output)
        );
    }
    // Paris the wrong way round is in the Indian Ocean.
    for (words, warned) in [
        (&["--at", "2.2945,48.8584"][..], true),
        (&["--at", "48.8584,2.2945"], false),
        (&["--at", "40.7,-74"], false),
        (&["--at", "-74,40.7"], true),
        (&["--at", "9.03,38.74", "--tz", "Africa/Addis_Ababa"], false),
        // In the Antarctic is who names it.
        (&["--place", "Mawson"], false),
        (&["--at", "-67.6,62.9", "--tz", "Antarctica/Mawson"], false),
    ] {
        let words = [&["sun", "--time", "2026-06-21T12:00"], words].concat();
        let said = stderr(&tyndall(folder.path(), &words));
        assert_eq!(said.contains("swapped"), warned, "{words:?}: {said}");
    }
}

#[test]
#[cfg(unix)]
fn whoever_asks_a_picture_to_end_is_told_what_is_kept() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};
    let folder = tempfile::tempdir().expect("a folder");
    slats(folder.path(), [400, 300]);
    for (signal, status) in [("TERM", 75), ("INT", 130)] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        let child = child.current_dir(folder.path()).stderr(Stdio::piped());
        let words = [
            "render",
            "slats.toml",
            "--quality",
            "reference",
            "--backend",
            "reference",
            "-o",
            "x.png",
        ];
        let mut child = child.args(words).spawn().expect("it starts");
        let id = child.id().to_string();
        // What is drawn is said when the picture begins.
        let mut lines = BufReader::new(child.stderr.take().expect("it is piped"));
        let mut said = String::new();
        while !said.contains("\neffects ") {
            let read = lines.read_line(&mut said).expect("it talks");
            assert!(read > 0, "it ended: {said}");
        }
        let sent = Command::new("kill").args(["-s", signal, &id]).status();
        assert!(sent.expect("kill is there").success());
        lines.read_to_string(&mut said).expect("it talks");
        let ended = child.wait().expect("it ends");
        assert_eq!(ended.code(), Some(status), "{said}");
        assert!(
            said.contains("kept       nothing of this picture; not written: x.png"),
            "{said}"
        );
        assert!(!folder.path().join("x.png").exists());
    }
}
