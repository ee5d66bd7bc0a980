//! `tyndall daylight --weather` and `--sun-hours` from the outside: page, tables and hours tell the same, and what is refused.

mod common;

use common::{quads_obj, stderr, tyndall};
use serde_json::Value;
use std::f64::consts::PI;
use std::path::Path;

/// A folder with a scene.
struct Folder(tempfile::TempDir);

impl Folder {
    /// Quads of four corners each, and the scene file.
    fn new(quads: &[[[f64; 3]; 4]], toml: &str) -> Self {
        let folder = Folder(tempfile::tempdir().expect("a folder"));
        folder.write("mesh.obj", &quads_obj(quads));
        folder.write("scene.toml", &format!("mesh = \"mesh.obj\"\n{toml}"));
        folder
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path().join(name), text).expect("it can be written");
    }
}

/// A room of 4 m x 4 m x 3 m whose southern wall has a window from 1 m to 2.5 m, and what is around it.
fn windowed(rest: &str) -> Folder {
    let quad = |a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]| [a, b, c, d];
    let south = |x: [f64; 2], y: [f64; 2]| {
        quad(
            [x[0], y[0], 4.0],
            [x[0], y[1], 4.0],
            [x[1], y[1], 4.0],
            [x[1], y[0], 4.0],
        )
    };
    Folder::new(
        &[
            quad(
                [0.0, 0.0, 0.0],
                [0.0, 0.0, 4.0],
                [4.0, 0.0, 4.0],
                [4.0, 0.0, 0.0],
            ),
            quad(
                [0.0, 3.0, 0.0],
                [4.0, 3.0, 0.0],
                [4.0, 3.0, 4.0],
                [0.0, 3.0, 4.0],
            ),
            quad(
                [0.0, 0.0, 0.0],
                [4.0, 0.0, 0.0],
                [4.0, 3.0, 0.0],
                [0.0, 3.0, 0.0],
            ),
            quad(
                [0.0, 0.0, 0.0],
                [0.0, 3.0, 0.0],
                [0.0, 3.0, 4.0],
                [0.0, 0.0, 4.0],
            ),
            quad(
                [4.0, 0.0, 0.0],
                [4.0, 0.0, 4.0],
                [4.0, 3.0, 4.0],
                [4.0, 3.0, 0.0],
            ),
            south([0.0, 4.0], [0.0, 1.0]),
            south([0.0, 4.0], [2.5, 3.0]),
            south([0.0, 0.5], [1.0, 2.5]),
            south([3.5, 4.0], [1.0, 2.5]),
        ],
        rest,
    )
}

/// A year of clear days at 48 degrees north, where noon is at 12 o'clock.
fn weather() -> String {
    weather_on(1)
}

/// The same where only every so many days have light.
fn weather_on(every: usize) -> String {
    let mut text = "LOCATION,Made up,-,-,none,000000,48,15,1,100\nDESIGN CONDITIONS,0\nTYPICAL/EXTREME PERIODS,0\n\
        GROUND TEMPERATURES,0\nHOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\nCOMMENTS 1,free <to> use\nCOMMENTS 2,\nDATA PERIODS,1,1,Data,Sunday,1/ 1,12/31\n"
        .to_owned();
    let days = [31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut number = 0.0;
    for (month, count) in days.into_iter().enumerate() {
        for day in 1..=count {
            number += 1.0;
            let declination = 23.45f64.to_radians() * (2.0 * PI * (284.0 + number) / 365.0).sin();
            for hour in 1..=24 {
                let angle = (15.0 * (f64::from(hour) - 12.5)).to_radians();
                let (sin, cos) = 48f64.to_radians().sin_cos();
                let sine = sin * declination.sin() + cos * declination.cos() * angle.cos();
                let is_dark = !(number as usize).is_multiple_of(every);
                let sine = if is_dark { 0.0 } else { sine };
                let direct = if sine > 0.05 { 700.0 } else { 0.0 };
                let diffuse = 120.0 * sine.max(0.0);
                let global = diffuse + direct * sine.max(0.0);
                text += &format!(
                    "2001,{},{day},{hour},0,?9,5,3,85,100220,0,0,323,{global:.1},{direct:.1},{diffuse:.1}\n",
                    month + 1
                );
            }
        }
    }
    text
}

/// The lines of a CSV, cell by cell.
fn cells(text: &str) -> Vec<Vec<String>> {
    let line = |line: &str| {
        let mut cells = vec![String::new()];
        let mut quoted = false;
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => cells.push(String::new()),
                c => cells.last_mut().expect("there is one").push(c),
            }
        }
        cells
    };
    text.lines().map(line).collect()
}

#[test]
fn every_figure_of_the_page_stands_in_the_tables() {
    let scene = windowed("[ground]\nalbedo = 0.2\n");
    scene.write("made.epw", &weather());
    let out = tyndall(
        scene.path(),
        &[
            "daylight",
            "scene.toml",
            "--grid",
            "plane=0.85,spacing=1.5,inset=0.5",
            "--weather",
            "made.epw",
            "--quality",
            "draft",
            "--patches",
            "1",
            "-o",
            "page.html",
            "-o",
            "year.csv",
            "-o",
            "year.json",
            "-o",
            "map.svg",
            "-o",
            "year.exr",
            "--hours",
            "hours.csv",
            "--csv",
        ],
    );
    assert!(out.status.success(), "{}", stderr(&out));
    let read =
        |name: &str| std::fs::read_to_string(scene.path().join(name)).expect("it is written");
    let (page, report) = (read("page.html"), read("year.json"));
    let report: Value = serde_json::from_str(&report).expect("JSON");
    let printed = cells(&String::from_utf8_lossy(&out.stdout));
    assert_eq!(printed[0][..5], ["room", "key", "name", "value", "unit"]);
    // Room, key and value of each figure on the page.
    let attribute = |tag: &str, name: &str| {
        let rest = tag.split_once(&format!("{name}=\"")).expect("it has it").1;
        rest.split_once('"').expect("it ends").0.to_owned()
    };
    let mut count = 0;
    for tag in page.split("<td class=\"n\" data-room").skip(1) {
        let tag = format!("data-room{}", tag.split_once("</td>").expect("it ends").0);
        let [room, key, value] =
            ["data-room", "data-key", "data-value"].map(|a| attribute(&tag, a));
        let shown = tag.rsplit_once('>').expect("a text").1;
        let number: f64 = value.parse().expect("a number");
        let near = shown.parse::<f64>().expect("a number");
        assert!(
            (near - number).abs() <= 0.006 * number.abs().max(1.0),
            "{shown} for {value}"
        );
        let row = printed.iter().find(|row| row[0] == room && row[1] == key);
        assert_eq!(row.map(|row| &row[3]), Some(&value), "{room} {key}");
        let rooms = report["rooms"].as_array().expect("rooms");
        let own = rooms
            .iter()
            .find(|r| r["name"] == room.as_str())
            .expect("the room");
        let figures = own["figures"].as_array().expect("figures");
        let figure = figures
            .iter()
            .find(|f| f["key"] == key.as_str())
            .expect("the figure");
        assert_eq!(figure["value"].as_f64(), Some(number), "{key}");
        assert!(!figure["method"].as_str().expect("a method").is_empty());
        count += 1;
    }
    let rooms = report["rooms"].as_array().expect("rooms").len();
    assert_eq!(count, 21 * rooms, "figures on the page");
    assert!(
        page.contains("View out")
            && page.contains("not assessed")
            && page.contains("sDA300/50%, no blinds")
    );
    assert!(page.contains("COMMENTS 1,free &lt;to&gt; use") && page.contains("<svg"));
    assert!(
        !page.contains("http://") || !page.contains("src="),
        "it needs no other file"
    );
    // The file of figures is what was printed.
    assert_eq!(cells(&read("year.figures.csv")), printed);
    // A part a plane, with all columns.
    let exr = exr::prelude::read_all_flat_layers_from_file(scene.path().join("year.exr"));
    let exr = exr.expect("OpenEXR");
    let mut sum = 0;
    for layer in &exr.layer_data {
        let channels = &layer.channel_data.list;
        let mean = channels.iter().find(|c| c.name.eq("mean_lx"));
        let values = mean.expect("a column").sample_data.values_as_f32();
        sum += values.filter(|value| value.is_finite()).count();
    }
    assert_eq!(sum, report["sensors"].as_array().expect("sensors").len());
    // The tables agree with each other.
    let sensors = cells(&read("year.csv"));
    let list = report["sensors"].as_array().expect("sensors");
    assert_eq!(sensors.len(), 1 + list.len());
    let column = |name: &str| sensors[0].iter().position(|n| n == name).expect("a column");
    let mean = |name: &str| {
        let all = sensors[1..]
            .iter()
            .map(|row| row[column(name)].parse::<f64>().expect("a number"));
        let areas = sensors[1..]
            .iter()
            .map(|row| row[column("area_m2")].parse::<f64>().expect("a number"));
        let pairs: Vec<(f64, f64)> = all.zip(areas).collect();
        pairs.iter().map(|(v, a)| v * a).sum::<f64>() / pairs.iter().map(|(_, a)| a).sum::<f64>()
    };
    let figure = |key: &str| {
        // Of several rooms the last is all of them.
        let row = printed.iter().rfind(|row| row[1] == key);
        let row = row.expect("a row");
        row[3].parse::<f64>().expect("a number")
    };
    assert!((mean("udi_300_3000_pct") - figure("udi_300_3000")).abs() < 1e-6);
    assert!((mean("factor_pct") - figure("factor_mean")).abs() < 1e-6);
    let shares: f64 = [
        "udi_below_100",
        "udi_100_300",
        "udi_300_3000",
        "udi_above_3000",
    ]
    .map(figure)
    .iter()
    .sum();
    assert!((shares - 100.0).abs() < 1e-9);
    let hours = cells(&read("hours.csv"));
    assert_eq!((hours.len(), hours[0].len()), (8761, 4 + list.len()));
    // The mean of the occupied hours by the hourly table.
    let occupied = hours[1..]
        .iter()
        .filter(|row| (9..=18).contains(&row[2].parse::<u32>().expect("an hour")));
    let sum: f64 = occupied
        .map(|row| row[4].parse::<f64>().expect("lux"))
        .sum();
    let own = sensors[1][column("mean_lx")]
        .parse::<f64>()
        .expect("a number");
    assert!((sum / 3650.0 - own).abs() < 0.1, "{} {own}", sum / 3650.0);
    assert!(own > 50.0, "a room with a window has light: {own}");
}

#[test]
fn variants_share_what_their_scene_has() {
    let scene = windowed("[ground]\nalbedo = 0.2\n");
    scene.write("made.epw", &weather_on(3));
    let run = |more: &[&str]| {
        let mut all = vec![
            "daylight",
            "scene.toml",
            "--grid",
            "spacing=1.5",
            "--quality",
            "draft",
        ];
        all.extend([
            "--patches",
            "1",
            "--weather",
            "made.epw",
            "-o",
            "year.csv",
            "--csv",
        ]);
        all.extend(more);
        let out = tyndall(scene.path(), &all);
        assert!(out.status.success(), "{}", stderr(&out));
        cells(&String::from_utf8_lossy(&out.stdout))
    };
    let both = run(&["--turn", "0,180"]);
    let value = |rows: &[Vec<String>], variant: &str, key: &str| -> f64 {
        let row = rows.iter().find(|row| row[0] == variant && row[3] == key);
        row.expect("a row")[5].parse().expect("a number")
    };
    let read = |name: &str| {
        let text = std::fs::read_to_string(scene.path().join(name)).expect("it is written");
        cells(&text)
    };
    // A window in the south lets the sun in; turned to the north it does not.
    assert_eq!(both[0][..3], ["variant", "north_degrees", "room"]);
    let sunny = ["turn0", "turn180"].map(|variant| {
        let sensors = read(&format!("year.{variant}.csv"));
        let at = sensors[0].iter().position(|name| name == "sun1000_h");
        let hours = sensors[1..].iter().map(|row| {
            let cell = &row[at.expect("a column")];
            cell.parse::<f64>().expect("a number")
        });
        hours.fold(0.0, f64::max)
    });
    assert!(sunny[0] > 20.0 && sunny[1] < 0.2 * sunny[0], "{sunny:?}");
    let means = ["turn0", "turn180"].map(|variant| value(&both, variant, "mean"));
    assert!(means[1] < 0.7 * means[0], "{means:?}");
    // A variant is what the turned scene has by itself.
    assert!(read("year.turn0.csv").len() > 1 && read("year.turn180.figures.csv").len() > 1);
    run(&["--north", "180"]);
    let alone = read("year.figures.csv");
    let mean = alone.iter().find(|row| row[1] == "mean").expect("a row");
    let mean: f64 = mean[3].parse().expect("a number");
    assert!((means[1] / mean - 1.0).abs() < 1e-6, "{} {mean}", means[1]);
}

#[test]
fn what_a_year_cannot_use_is_told() {
    let scene = windowed("");
    scene.write("made.epw", &weather());
    scene.write("cut.epw", &weather()[..100_000]);
    for (arguments, word) in [
        (vec!["--weather", "cut.epw"], "cut.epw, line"),
        (vec!["--weather", "none.epw"], "none.epw"),
        (vec!["--weather", "made.epw", "--patches", "3"], "1, 2 or 4"),
        (vec!["--weather", "made.epw", "-o", "year.doc"], ".html"),
        (vec!["--weather", "made.epw", "-o", "made.epw"], "the name"),
        (vec!["--weather", "made.epw", "--show", "lux"], "da300_pct"),
        (
            vec!["--weather", "made.epw", "--weather", "made.epw"],
            "are called made",
        ),
        (vec!["--weather", "made.epw", "--turn", "90,90"], "--turn"),
        (
            vec!["--weather", "made.epw", "--label-shift", "nan"],
            "-12 to 12",
        ),
        (
            vec!["--weather", "made.epw", "--label-shift", "1000"],
            "-12 to 12",
        ),
        (
            vec!["--weather", "made.epw", "--set", "radiosity.rayz=8"],
            "rays",
        ),
        (
            vec!["--weather", "made.epw", "--backend", "gpu"],
            "--backend",
        ),
        (
            vec!["--weather", "made.epw", "--report", "r.json"],
            "--report",
        ),
        (vec!["--weather", "made.epw", "--every", "1min"], "--every"),
        (vec!["--sun-hours", "2026-03-21"], "no place"),
        (vec!["--sun-hours", "2026-03-21", "--sky", "cie:1"], "--sky"),
        (
            vec!["--sun-hours", "2026-03-21", "--label-shift", "1"],
            "--label-shift",
        ),
        (
            vec!["--sun-hours", "2026-03-21", "-o", "sun.html"],
            "no page",
        ),
        (
            vec![
                "--at",
                "48,15",
                "--sun-hours",
                "2026-03-21",
                "--from",
                "12:00",
                "--to",
                "12:04",
            ],
            "shorter than a step",
        ),
        (vec!["--sun-hours", "21 March"], "--sun-hours"),
    ] {
        let mut all = vec![
            "daylight",
            "scene.toml",
            "--grid",
            "spacing=1",
            "--quality",
            "draft",
        ];
        all.extend(&arguments);
        let out = tyndall(scene.path(), &all);
        assert_eq!(
            out.status.code(),
            Some(2),
            "{arguments:?}: {}",
            stderr(&out)
        );
        assert!(
            stderr(&out).contains(word),
            "{arguments:?}: {}",
            stderr(&out)
        );
    }
}

#[test]
fn hours_of_sun_are_printed() {
    let scene = windowed("");
    let run = |more: &[&str]| {
        let mut all = vec![
            "daylight",
            "scene.toml",
            "--grid",
            "plane=0.8,spacing=1",
            "--at",
            "48,15",
            "--tz",
            "Europe/Vienna",
            "--sun-hours",
            "2026-12-21",
            "--every",
            "1min",
            "--csv",
        ];
        all.extend(more);
        let out = tyndall(scene.path(), &all);
        assert!(out.status.success(), "{}", stderr(&out));
        cells(&String::from_utf8_lossy(&out.stdout))
    };
    let rows = run(&[]);
    let hours = |rows: &[Vec<String>]| -> Vec<f64> {
        rows[1..]
            .iter()
            .map(|row| row[8].parse().expect("hours"))
            .collect()
    };
    // In winter the low sun reaches the back; nobody has more than the day.
    let all = hours(&rows);
    assert!(all.iter().all(|h| (0.0..8.4).contains(h)), "{all:?}");
    assert!(all.iter().any(|h| *h > 3.0), "{all:?}");
    let noon = hours(&run(&["--from", "12:00", "--to", "12:30"]));
    assert!(
        noon.iter().all(|h| *h <= 0.5 + 1e-9) && noon.iter().any(|h| *h > 0.49),
        "{noon:?}"
    );
    let high = hours(&run(&["--least-elevation", "30"]));
    assert!(high.iter().all(|h| *h == 0.0), "{high:?}");
}
