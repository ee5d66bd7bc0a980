//! `tyndall photometry` from the outside.

mod common;

use common::{stderr, tyndall};
use serde_json::Value;

const LAMP: &str = "IESNA:LM-63-2002\n[TEST] \u{1b}[31m17\nTILT=NONE\n1 -1 1 3 1 1 2 -0.1 0 0\n1 1 12\n0 45 90\n0\n100 80 0\n";

#[test]
fn a_file_is_told_as_text_json_and_csv() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("lamp.ies"), LAMP).expect("it is written");
    let run = |more: &[&str]| {
        let arguments = [&["photometry", "lamp.ies"], more].concat();
        let output = tyndall(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert_eq!(stderr(&output), "");
        String::from_utf8(output.stdout).expect("it is UTF-8")
    };
    let text = run(&[]);
    for words in [
        "standard    IES LM-63-2002",
        "photometry  type C, symmetry about its axis",
        "angles      1 horizontal, 3 vertical (0 to 90 degrees)",
        "lamps       not stated",
        "peak        100.0 cd at horizontal 0, vertical 0 degrees",
        "power       12 W",
        "opening     disc, 0.1 x 0 x 0 m",
        "  [TEST] ",
    ] {
        assert!(text.contains(words), "{text}");
    }
    assert!(!text.contains('\u{1b}'));
    let json: Value = serde_json::from_str(&run(&["--json"])).expect("it is JSON");
    assert_eq!(json["type"], "C");
    assert_eq!(
        (&json["lamp_lumens"], &json["warnings"]),
        (&Value::Null, &Value::Array(vec![]))
    );
    let flux = json["integrated_lumens"].as_f64().expect("a number");
    let csv = run(&["--csv"]);
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!((rows.len(), rows[0].len()), (2, rows[1].len()));
    let column = |name: &str| {
        rows[0]
            .iter()
            .position(|column| *column == name)
            .expect("it is there")
    };
    assert_eq!(rows[1][column("integrated_lumens")].parse(), Ok(flux));
    assert_eq!(rows[1][column("lamp_lumens")], "");
}

#[test]
fn what_is_wrong_is_told_on_standard_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let broken = LAMP.replace("80 0", "8x 0");
    std::fs::write(folder.path().join("broken.ies"), broken).expect("it is written");
    let output = tyndall(folder.path(), &["photometry", "broken.ies"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("broken.ies:8: `8x` is no number"),
        "{}",
        stderr(&output)
    );
    std::fs::write(
        folder.path().join("cut.ies"),
        LAMP.replace("0 45 90", "0 45 60").replace("80 0", "80 50"),
    )
    .expect("it is written");
    let output = tyndall(folder.path(), &["photometry", "cut.ies"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(
        stderr(&output).contains("warning") && stderr(&output).contains("help:"),
        "{}",
        stderr(&output)
    );
    let output = tyndall(folder.path(), &["photometry", "cut.ies", "--lamp-set", "2"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("lamp_set is 2, outside 1"),
        "{}",
        stderr(&output)
    );
}
