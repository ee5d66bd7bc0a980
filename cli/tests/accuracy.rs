//! `tyndall accuracy --effect shafts` and `--effect radiosity` from the outside: table, JSON, CSV, plot and pictures.

mod common;
#[path = "../../tests/common/gpu.rs"]
mod gpu;

use common::not_run;
use gpu::gpu;
use serde_json::Value;
use std::path::Path;

/// What a study prints.
fn printed(folder: &Path, study: &[&str], more: &[&str]) -> String {
    let arguments = [&["accuracy", "--frames", "1"], study, more].concat();
    let output = common::tyndall(folder, &arguments);
    let said = common::stderr(&output);
    assert!(output.status.success(), "{said}");
    // What it will do, and for how long.
    assert!(said.contains(" settings, 1 frames of each, in "), "{said}");
    assert!(said.contains("; roughly "), "{said}");
    String::from_utf8(output.stdout).expect("the output is UTF-8")
}

/// The study of light in the air, of the slats at a tiny size.
const SHAFTS: &[&str] = &[
    "--effect",
    "shafts",
    "--study",
    "slats",
    "--study-size",
    "32x32",
    "--set",
    "shadow.resolution=512",
];

/// The study of light from sky and surfaces, of the court at a tiny size; few patches, but where their number is tried.
const RADIOSITY: &[&str] = &[
    "--effect",
    "radiosity",
    "--study",
    "court",
    "--study-size",
    "12x8",
    "--backend",
    "reference",
    "--set",
    "radiosity.patches=300",
    "--set",
    "radiosity.patch_rays=5000",
];

#[test]
fn the_study_of_shafts_has_its_table_its_plot_and_its_pictures() {
    if !gpu("the_study_of_shafts_has_its_table_its_plot_and_its_pictures") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let files = ["--plot", "cost.html", "--pictures", "pictures"];
    let table = printed(folder.path(), SHAFTS, &files);
    for words in [
        "medians of 1 frames",
        "slats, 32 x 32",
        "rel. RMSE",
        "march steps 64 ",
        "planes planes 15, lattice 40",
        "rectified rows 1024",
        "best of the settings within 1 %",
    ] {
        assert!(table.contains(words), "`{words}` is not in\n{table}");
    }
    let plot = std::fs::read_to_string(folder.path().join("cost-slats.html")).expect("a plot");
    assert!(plot.contains("games: 64 steps") && plot.contains("Pareto front"));
    for name in ["truth", "march-64", "march-64-error-x4"] {
        let path = folder.path().join(format!("pictures/slats-{name}.png"));
        let picture = image::open(path).expect("a PNG");
        assert_eq!((picture.width(), picture.height()), (32, 32), "{name}");
    }
}

#[test]
fn the_study_of_shafts_as_json_and_csv() {
    if !gpu("the_study_of_shafts_as_json_and_csv") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let only = ["--method", "planes"];
    let json = printed(folder.path(), SHAFTS, &[&only[..], &["--json"]].concat());
    let json: Value = serde_json::from_str(&json).expect("it is JSON");
    let rows = json.as_array().expect("a list of rows");
    let methods: Vec<&str> = rows.iter().filter_map(|r| r["method"].as_str()).collect();
    assert!(methods.contains(&"planes") && methods.contains(&"march"));
    assert!(!methods.contains(&"rectified"));
    let baselines: Vec<_> = rows.iter().filter(|r| r["baseline"] == true).collect();
    assert_eq!(baselines.len(), 1);
    assert_eq!(baselines[0]["setting"], "march steps 64");
    for row in rows {
        assert!(row["adapter"].as_str().is_some_and(|a| !a.is_empty()));
        for number in ["relative_rmse", "reads_per_pixel", "hdr_flip"] {
            let value = row[number].as_f64();
            assert!(value.is_some_and(|v| v > 0.0 && v.is_finite()), "{row}");
        }
    }
    assert!(rows.iter().any(|row| row["front_by_reads"] == true));

    let csv = printed(folder.path(), SHAFTS, &[&only[..], &["--csv"]].concat());
    let mut lines = csv.lines();
    let heads = lines.next().expect("a line of names");
    for name in ["scene", "adapter", "setting", "relative_rmse", "hdr_flip"] {
        assert!(heads.split(',').any(|head| head == name), "{heads}");
    }
    // Commas in quotes belong to a cell: adapters' and settings' names have some.
    let cells = |line: &str| {
        let outside = line.split('"').step_by(2);
        1 + outside.map(|part| part.matches(',').count()).sum::<usize>()
    };
    let counts: Vec<usize> = lines.map(cells).collect();
    assert_eq!(counts, vec![cells(heads); rows.len()], "{csv}");
}

#[test]
fn the_study_of_radiosity_has_its_table_its_plot_and_its_rows() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = printed(folder.path(), RADIOSITY, &[]);
    for words in [
        "medians of 1 frames",
        "court, 12 x 8",
        "sky      indirect inscatter_sky",
        "quality                      preview",
    ] {
        assert!(table.contains(words), "`{words}` is not in\n{table}");
    }

    let plots = ["--json", "--plot", "cost.svg", "--plot", "cost.png"];
    let json = printed(folder.path(), RADIOSITY, &plots);
    assert!(image::open(folder.path().join("cost-court.png")).is_ok());
    let plot = std::fs::read_to_string(folder.path().join("cost-court.svg")).expect("a plot");
    assert!(plot.contains("Light from sky and surfaces: court"));
    let json: Value = serde_json::from_str(&json).expect("it is JSON");
    let rows = json.as_array().expect("a list of rows");
    let qualities = rows.iter().filter(|row| row["knob"] == "quality").count();
    assert_eq!(qualities, 3);
    assert!(rows.len() > 8);
    let error = |row: &Value| row["all_relative_rmse"].as_f64().expect("a number");
    for row in rows {
        assert!(error(row) >= 0.0 && row["ms"].as_f64().is_some_and(|ms| ms > 0.0));
        assert!(row["sky_mean"].as_f64().is_some_and(|mean| mean > 0.0));
    }
    // Finer is better, and what beats all others is on the front.
    let quality = |name: &str| {
        let is = |row: &&Value| row["knob"] == "quality" && row["setting"] == name;
        error(rows.iter().find(is).expect("the quality"))
    };
    assert!(quality("high") < quality("draft"));
    let best = rows.iter().min_by(|a, b| error(a).total_cmp(&error(b)));
    assert_eq!(best.expect("there are rows")["front_by_time"], true);
}
