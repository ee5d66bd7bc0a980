//! `tyndall sky` as a user types it.

mod common;

use common::not_run;
use std::io::Write;
use std::process::{Command, Output, Stdio};

fn sky(arguments: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .arg("sky")
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(input.as_bytes())
        .unwrap();
    child.wait_with_output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

#[test]
fn a_batch_gives_the_models_as_published() {
    let input = "model,sun_elevation,turbidity,view_azimuth,view_elevation,direct_normal,diffuse_horizontal\n\
        preetham,45,3,0,90,,\n\
        perez,40,,30,20,500,100\n\
        cie:16,40,,30,0,,\n\
        cie:16,40,,30,90,,\n";
    let output = sky(&["--batch", "-"], input);
    assert!(output.status.success());
    let text = stdout(&output);
    let rows: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
    assert_eq!(rows[0][7..], ["X", "Y", "Z", "R", "G", "B"]);
    assert_eq!(rows.len(), 5);
    let y = |row: usize| rows[row][8].parse::<f64>().unwrap();
    // Preetham's zenith from the printed constants.
    let chi: f64 = (4.0 / 9.0 - 3.0 / 120.0) * std::f64::consts::FRAC_PI_2;
    assert!(
        (y(1) / (1000.0 * (7.1649 * chi.tan() + 1.7727)) - 1.0).abs() < 1e-9,
        "{}",
        y(1)
    );
    // The traditional overcast sky's horizon has a third of its zenith.
    assert!((y(3) / y(4) - 1.0 / 3.0).abs() < 1e-12);
    // R, G, B are those of X, Y, Z: luminance by the weights of Rec. 709.
    for row in &rows[1..] {
        let v: Vec<f64> = row[7..].iter().map(|c| c.parse().unwrap()).collect();
        let luminance = 0.212_639 * v[3] + 0.715_169 * v[4] + 0.072_192 * v[5];
        assert!((luminance / v[1] - 1.0).abs() < 1e-5);
    }
    // JSON holds the same digits. (serde_json's quick reading would be off by an ulp.)
    let text = stdout(&sky(&["--batch", "-", "--json"], input));
    assert!(text.contains(&format!("\"Y\":{}", rows[2][8])), "{text}");
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json[1]["direct_normal"], 500.0);
}

#[test]
fn a_bad_row_is_named_and_the_rest_printed() {
    let input = "model,sun_elevation,turbidity,view_azimuth,view_elevation\n\
        preetham,45,1.5,0,90\nperez,-5,3,0,90\nnishita,45,3,0,90\npreetham,45,x,0,90\npreetham,45,3,0,-4\npreetham,45,3,0,90\n";
    let output = sky(&["--batch", "-"], input);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(stdout(&output).lines().count(), 2);
    let errors = String::from_utf8(output.stderr).unwrap();
    for line in 2..=6 {
        assert!(
            errors.contains(&format!("standard input:{line}:")),
            "{errors}"
        );
    }
    let strict = sky(&["--batch", "-", "--strict"], input);
    assert_eq!(strict.status.code(), Some(2));
    assert!(strict.stdout.is_empty());
    // A comma in quotes is part of its cell, and stays so.
    let quoted = "model,note,sun_elevation,view_azimuth,view_elevation\ncie:12,\"a, b\",40,0,90\n";
    let text = stdout(&sky(&["--batch", "-"], quoted));
    assert!(text.contains("\ncie:12,\"a, b\",40,0,90,"), "{text}");
    let missing = sky(&["--batch", "-"], "model,turbidity\npreetham,3\n");
    assert_eq!(missing.status.code(), Some(2));
    assert!(
        String::from_utf8(missing.stderr)
            .unwrap()
            .contains("sun_elevation")
    );
    assert_eq!(sky(&["--batch", "/no/such.csv"], "").status.code(), Some(2));
}

#[test]
fn maps_are_written_and_values_printed() {
    let folder = tempfile::tempdir().unwrap();
    let (exr, png) = (folder.path().join("s.exr"), folder.path().join("s.png"));
    let output = sky(
        &[
            "--sun",
            "90,30",
            "--size",
            "128x64",
            "-o",
            exr.to_str().unwrap(),
            "-o",
            png.to_str().unwrap(),
            "--json",
        ],
        "",
    );
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let json: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    let number = |key: &str| json[key].as_f64().unwrap();
    assert!((number("sun_elevation_true") - 30.0).abs() < 1e-9);
    let total = number("sky_horizontal_illuminance_lx") + number("sun_horizontal_illuminance_lx");
    assert!((total / number("horizontal_illuminance_lx") - 1.0).abs() < 1e-12);
    // The sun stands in the east: three quarters of the width from the left, a third of the way down.
    let picture = image::open(&png).unwrap().to_rgb8();
    let brightest = picture
        .enumerate_pixels()
        .max_by_key(|(_, _, p)| p.0.map(u32::from).iter().sum::<u32>())
        .unwrap();
    assert!(
        (95..=97).contains(&brightest.0) && (20..=22).contains(&brightest.1),
        "{brightest:?}"
    );
    assert!(exr.exists());
    // A night has a value, and no CCT that is a guess.
    let night = sky(&["--sun", "90,-40", "--csv"], "");
    assert!(night.status.success() && stdout(&night).contains("null"));
    // The commas of a colour are within its cell.
    let csv = stdout(&sky(&["--sun", "90,30", "--csv"], ""));
    assert_eq!(csv.matches(",\"[").count(), 2, "{csv}");
    assert_eq!(csv.matches("]\",").count(), 2, "{csv}");
    assert!(csv.contains(",perez,\"Perez 1993 "), "{csv}");
}

/// The texels of a map, by channels in the order of their names: B, G, R.
fn texels(path: &std::path::Path) -> Vec<Vec<f32>> {
    let image = exr::prelude::read_first_flat_layer_from_file(path).unwrap();
    let channels = &image.layer_data.channel_data.list;
    let values = |c: &exr::prelude::AnyChannel<_>| {
        let data: &exr::prelude::FlatSamples = &c.sample_data;
        data.values_as_f32().collect()
    };
    channels.iter().map(values).collect()
}

#[test]
fn maps_are_in_the_units_asked_for_and_inside_their_gamut() {
    let folder = tempfile::tempdir().unwrap();
    let map = |name: &str, flags: &[&str]| {
        let path = folder.path().join(name);
        // A low sun is redder than Rec. 709.
        let words = [
            "--sun",
            "270,0.1",
            "--size",
            "512x256",
            "-o",
            path.to_str().unwrap(),
        ];
        let output = sky(&[&words[..], flags].concat(), "");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        (texels(&path), said)
    };
    let (plain, said) = map("a.exr", &[]);
    assert!(
        said.contains("texels above 65504") && said.contains("--clamp-half"),
        "{said}"
    );
    assert!(plain.iter().flatten().all(|v| *v >= 0.0), "inside Rec. 709");
    let (radiance, _) = map("b.exr", &["--units", "radiance", "--multiply", "2"]);
    for (a, b) in plain.iter().flatten().zip(radiance.iter().flatten()) {
        assert!((a / 179.0 * 2.0 - b).abs() <= 2e-7 * a, "{a} {b}");
    }
    let (clamped, said) = map("c.exr", &["--clamp-half"]);
    assert!(said.contains("held there"), "{said}");
    let most = |map: &[Vec<f32>]| map.iter().flatten().copied().fold(0.0, f32::max);
    assert!(most(&plain) > 65504.0 && most(&clamped) == 65504.0);
    // The wider space has another red; the luminance is the same.
    let (wide, _) = map("d.exr", &["--color-space", "rec2020"]);
    let y = |map: &[Vec<f32>], w: [f64; 3]| -> Vec<f64> {
        let at = |i: usize| (0..3).map(|c| w[2 - c] * f64::from(map[c][i])).sum();
        (0..map[0].len()).map(at).collect()
    };
    let (narrow, wide) = (
        y(&plain, [0.212_639, 0.715_169, 0.072_192]),
        y(&wide, [0.262_700, 0.677_998, 0.059_302]),
    );
    for (a, b) in narrow.iter().zip(&wide) {
        assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    }
}

#[test]
fn blender_takes_our_map_and_our_sun() {
    // Its Python module weighs 374 MB: it is used where a Python that has it is named.
    let Some(python) = std::env::var_os("TYNDALL_BLENDER") else {
        let reason = "TYNDALL_BLENDER names no Python with Blender's module `bpy`";
        return not_run("blender_takes_our_map_and_our_sun", reason);
    };
    let folder = tempfile::tempdir().unwrap();
    let (azimuth, elevation) = (230.0, 35.0);
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (with_disc, without) = (file("a.exr"), file("b.exr"));
    // Blender's map has +X in its middle, which is east where +Y is north.
    let common = [
        "--sun", "230,35", "--north", "90", "--units", "radiance", "--json",
    ];
    let disc = ["--size", "2048x1024", "-o", &with_disc];
    let no_disc = ["--size", "512x256", "--without-sun", "-o", &without];
    let json = stdout(&sky(&[&common[..], &disc].concat(), ""));
    assert!(sky(&[&common[..], &no_disc].concat(), "").status.success());
    let ours: serde_json::Value = serde_json::from_str(&json).unwrap();
    let sun = serde_json::json!({
        "azimuth": azimuth,
        "elevation": elevation,
        "illuminance": ours["sun_normal_illuminance_lx"],
        "colour": ours["sun_rec709_lx"],
    });
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/python/blender.py");
    let mut child = Command::new(python)
        .args([script, &with_disc, &without, &file("scratch.exr")])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    input.write_all(sun.to_string().as_bytes()).unwrap();
    drop(input);
    let said = stdout(&child.wait_with_output().unwrap());
    let result = said.lines().find_map(|line| line.split_once("RESULT "));
    let result = result.unwrap_or_else(|| panic!("Blender says {said}")).1;
    let found: serde_json::Value = serde_json::from_str(result).unwrap();
    for way in ["map", "lamp"] {
        let number = |key: &str| found[way][key].as_f64().unwrap();
        let truth = ours["horizontal_illuminance_lx"].as_f64().unwrap();
        eprintln!(
            "{way}: shadow at {}, {:.4} of the light",
            number("shadow"),
            number("illuminance") / truth
        );
        // A pixel is 1.2 degrees at half of the shadow's length.
        assert!(
            (number("shadow") - (azimuth - 180.0)).abs() < 1.5,
            "{found}"
        );
        assert!(
            (number("illuminance") / truth - 1.0).abs() < 0.01,
            "{found}"
        );
    }
}

#[test]
fn what_is_missing_is_named() {
    for (arguments, word) in [
        (&[][..], "--at"),
        (&["--sun", "0,95"], "-90 to 90"),
        (&["--sun", "0,40", "--sky", "cie:17"], "1 to 16"),
        (&["--sun", "0,40", "--sky", "blue"], "perez, preetham"),
        (
            &["--sun", "0,40", "--sky", "preetham", "--turbidity", "1"],
            "2 to 10",
        ),
        (
            &["--sun", "0,40", "--direct-normal", "500"],
            "--diffuse-horizontal",
        ),
        (
            &["--sun", "0,40", "--size", "100x100", "-o", "x.png"],
            "twice as wide",
        ),
        (&["--sun", "0,40", "-o", "x.tif"], ".exr"),
    ] {
        let output = sky(arguments, "");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(text.contains(word), "{arguments:?}: {text}");
    }
}

#[test]
fn the_gpu_paints_the_same_map() {
    // Without an adapter `gpu` says what to do.
    let folder = tempfile::tempdir().unwrap();
    let paint = |backend: &str, name: &str| {
        let path = folder.path().join(name);
        let file = path.to_str().unwrap();
        let flags = ["--sun", "200,20", "--size", "256x128", "--backend", backend];
        let output = sky(&[&flags[..], &["-o", file]].concat(), "");
        (output, path)
    };
    let (reference, truth) = paint("reference", "reference.exr");
    assert!(reference.status.success());
    let (output, path) = paint("gpu", "gpu.exr");
    let errors = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        let required = std::env::var_os("REQUIRE_GPU").is_some_and(|v| v == "1");
        assert!(!required && errors.contains("tyndall doctor"), "{errors}");
        return;
    }
    assert!(errors.contains("backend    gpu ("), "{errors}");
    let (found, truth) = (texels(&path), texels(&truth));
    assert_eq!(found.len(), 3, "colour alone");
    let (found, truth) = (found.concat(), truth.concat());
    let largest = truth.iter().copied().fold(0.0, f32::max);
    assert!(largest > 1e6, "the sun is in it");
    for (found, truth) in found.iter().zip(&truth) {
        assert!((found / truth - 1.0).abs() < 2e-4, "{found} {truth}");
    }
}

#[test]
fn measured_irradiance_counts_under_a_low_sun_and_that_is_said() {
    let lux = |elevation: &str, diffuse: &str| {
        let sun = format!("180,{elevation}");
        let flags = [
            "--sun",
            &sun,
            "--direct-normal",
            "0",
            "--diffuse-horizontal",
            diffuse,
            "--json",
        ];
        let json: serde_json::Value = serde_json::from_str(&stdout(&sky(&flags, ""))).unwrap();
        let said = json["warnings"][0].as_str().unwrap_or("").to_owned();
        (
            json["sky_horizontal_illuminance_lx"].as_f64().unwrap(),
            said,
        )
    };
    for (elevation, diffuse, expected) in [
        ("5", "10", 1200.0),
        ("5", "30", 3600.0),
        ("5", "60", 7000.0),
        ("0.5", "5", 550.0),
        ("-1", "2", 220.0),
    ] {
        let (found, said) = lux(elevation, diffuse);
        assert!(
            (found / expected - 1.0_f64).abs() < 0.15,
            "{elevation} {diffuse}: {found}"
        );
        assert!(said.contains("measured irradiance"), "{said}");
    }
    assert!(!lux("30", "200").1.contains("twilight"));
    let one = sky(&["--sun", "180,5", "--diffuse-horizontal", "10"], "");
    assert_eq!(one.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&one.stderr).contains("--direct-normal"));
}
