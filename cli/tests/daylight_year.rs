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
        let places = &layer.attributes.other;
        for name in ["origin", "u", "v", "step"] {
            let is_there = places.keys().any(|key| key.eq(&format!("tyndall:{name}")));
            assert!(is_there, "{name}");
        }
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
    let both = run(&["--turn", "-90,0,90,180"]);
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
    // Occupied hours are not the same before noon and after: west and east differ.
    let mut others = Vec::new();
    for (north, turn) in [("180", "turn180"), ("90", "turn90")] {
        run(&["--north", north]);
        let alone = read("year.figures.csv");
        let mean = alone.iter().find(|row| row[1] == "mean").expect("a row");
        let mean: f64 = mean[3].parse().expect("a number");
        let turned = value(&both, turn, "mean");
        assert!(
            (turned / mean - 1.0).abs() < 1e-6,
            "{turn}: {turned} {mean}"
        );
        others.push(mean);
    }
    let east = value(&both, "turn-90", "mean");
    assert!((east / others[1] - 1.0).abs() > 0.02, "{east} {others:?}");
}

/// Glass with a blind in the window, and a wall 20 m before it: other glass and shards are variants, and all figures of blinds and views
/// stand on the page.
#[test]
fn blinds_views_and_glazings_are_told() {
    let scene = windowed(
        "[ground]\nalbedo = 0.2\n[[pane]]\nmaterial = \"glass\"\ntransmittance = 0.7\npanes = 2\n\
         [[shade]]\nwindows = [\"glass\"]\ntransmittance = 0.1\n",
    );
    let mesh = std::fs::read_to_string(scene.path().join("mesh.obj")).expect("it is there");
    let glass = "v 0.5 1 4\nv 0.5 2.5 4\nv 3.5 2.5 4\nv 3.5 1 4\nusemtl glass\nf -4 -3 -2 -1\n\
                 v -30 0 24\nv -30 9 24\nv 30 9 24\nv 30 0 24\nusemtl wall\nf -4 -3 -2 -1\n";
    scene.write(
        "mesh.obj",
        &format!("mtllib a.mtl\nusemtl wall\n{mesh}\n{glass}"),
    );
    scene.write("a.mtl", "newmtl glass\nnewmtl wall\nKd 0.5 0.5 0.5\n");
    scene.write("made.epw", &weather_on(20));
    let run = |more: &[&str]| {
        let mut all = vec!["daylight", "scene.toml", "--grid", "spacing=1"];
        all.extend(["--quality", "draft", "--patches", "1"]);
        all.extend(["--weather", "made.epw"]);
        all.extend(more);
        let out = tyndall(scene.path(), &all);
        assert!(out.status.success(), "{}", stderr(&out));
        cells(&String::from_utf8_lossy(&out.stdout))
    };
    let alone = run(&["--csv", "-o", "p.html", "-o", "p.json", "-o", "p.csv"]);
    let value = |rows: &[Vec<String>], key: &str| -> f64 {
        let at = rows[0]
            .iter()
            .position(|name| name == "key")
            .expect("a column");
        let row = rows.iter().find(|row| row[at] == key);
        row.expect("a row")[at + 2].parse().expect("a number")
    };
    assert!(value(&alone, "closed_h:glass") > 0.0);
    assert!(value(&alone, "sda") <= value(&alone, "sda_no_blinds"));
    assert!(value(&alone, "view_minimum") > 0.0);
    let page = std::fs::read_to_string(scene.path().join("p.html")).expect("it is written");
    for row in &alone[1..] {
        let value = format!("data-key=\"{}\" data-value=\"{}\"", row[1], row[3]);
        assert!(row[3].is_empty() || page.contains(&value), "{value}");
    }
    assert!(page.contains("Blinds of glass closed") && !page.contains("There are no blinds"));
    let json = std::fs::read(scene.path().join("p.json")).expect("it is written");
    let json: Value = serde_json::from_slice(&json).expect("it is JSON");
    let sensor = &json["sensors"][0];
    assert!(
        sensor["sight_deg"]
            .as_f64()
            .is_some_and(|angle| angle > 14.0)
    );
    assert!(
        sensor["view_m"]
            .as_f64()
            .is_some_and(|way| (20.0..30.0).contains(&way))
    );
    assert!(sensor["da300_blinds_pct"].is_number());
    // The glass that is there already, and darker glass: two variants, one to each shard.
    let both = run(&["--csv", "--glazing", "glass=0.7", "--glazing", "glass=0.3"]);
    let rows = |tag: &str| -> Vec<Vec<String>> {
        let own = |row: &&Vec<String>| row[0] == tag || row[0] == "variant";
        both.iter().filter(own).cloned().collect()
    };
    let (same, darker) = (rows("glass0.7"), rows("glass0.3"));
    assert_eq!(value(&same, "mean"), value(&alone, "mean"));
    let ratio = value(&darker, "factor_mean") / value(&same, "factor_mean");
    // Less on a slant still.
    assert!((0.36..0.43).contains(&ratio), "{ratio}");
    let second = run(&[
        "--csv",
        "--glazing",
        "glass=0.7",
        "--glazing",
        "glass=0.3",
        "--shard",
        "2/2",
    ]);
    assert_eq!(second, darker);
}

/// Two weather files: what is said of one place stands in the report of that file alone.
#[test]
fn a_variant_has_the_warnings_of_its_own_file() {
    let scene = windowed("[site]\nlatitude = 48.0\nlongitude = 15.0\n");
    let near = weather_on(60);
    scene.write("near.epw", &near);
    scene.write(
        "far.epw",
        &near.replace("none,000000,48,15", "none,000000,51,15"),
    );
    let run = |files: [&str; 2]| -> Vec<String> {
        let mut all = vec!["daylight", "scene.toml", "--grid", "spacing=2"];
        all.extend(["--quality", "draft", "--patches", "1", "--json"]);
        all.extend(files.iter().flat_map(|file| ["--weather", *file]));
        let out = tyndall(scene.path(), &all);
        assert!(out.status.success(), "{}", stderr(&out));
        assert_eq!(stderr(&out).matches("the scene lies at").count(), 1);
        let report: Value = serde_json::from_slice(&out.stdout).expect("JSON");
        let variants = report["variants"].as_array().expect("variants").iter();
        variants
            .map(|variant| variant["report"]["warnings"].to_string())
            .collect()
    };
    for files in [["near.epw", "far.epw"], ["far.epw", "near.epw"]] {
        for (file, said) in files.iter().zip(run(files)) {
            let is_far = *file == "far.epw";
            assert_eq!(said.contains("the scene lies at"), is_far, "{file}: {said}");
            assert!(!said.contains("near.epw at"), "{said}");
        }
    }
}

/// A window in the southern wall of a court, a roof window, and a pane that leads from the room into a closed one beside it. At 48 degrees
/// north on 21 March the sun is up for some twelve hours, before a southern wall all of them.
#[test]
fn openings_have_the_hours_of_sun_that_their_hour_angles_give() {
    let (a, b) = (4.0, 3.0);
    let floor = |x: [f64; 2], y: f64| [[x[0], y, 0.0], [x[0], y, a], [x[1], y, a], [x[1], y, 0.0]];
    let across = |x: f64, z: [f64; 2], y: [f64; 2]| {
        [
            [x, y[0], z[0]],
            [x, y[1], z[0]],
            [x, y[1], z[1]],
            [x, y[0], z[1]],
        ]
    };
    let along = |z: f64, x: [f64; 2], y: [f64; 2]| {
        [
            [x[0], y[0], z],
            [x[0], y[1], z],
            [x[1], y[1], z],
            [x[1], y[0], z],
        ]
    };
    // The room to x = 4, and a closed one to x = 6.
    let walls = [
        floor([0.0, 6.0], 0.0),
        along(0.0, [0.0, 6.0], [0.0, b]),
        across(0.0, [0.0, a], [0.0, b]),
        across(6.0, [0.0, a], [0.0, b]),
        along(a, [0.0, 1.0], [0.0, b]),
        along(a, [3.0, 6.0], [0.0, b]),
        along(a, [1.0, 3.0], [0.0, 1.0]),
        along(a, [1.0, 3.0], [2.0, b]),
        across(a, [0.0, 1.0], [0.0, b]),
        across(a, [2.0, a], [0.0, b]),
        across(a, [1.0, 2.0], [0.0, 1.0]),
        across(a, [1.0, 2.0], [2.0, b]),
        [[0.0, b, 0.0], [0.0, b, 1.0], [6.0, b, 1.0], [6.0, b, 0.0]],
        [[0.0, b, 2.0], [0.0, b, a], [6.0, b, a], [6.0, b, 2.0]],
        [[0.0, b, 1.0], [0.0, b, 2.0], [1.0, b, 2.0], [1.0, b, 1.0]],
        [[2.0, b, 1.0], [2.0, b, 2.0], [6.0, b, 2.0], [6.0, b, 1.0]],
    ];
    let glass = [
        along(a, [1.0, 3.0], [1.0, 2.0]),
        [[1.0, b, 1.0], [1.0, b, 2.0], [2.0, b, 2.0], [2.0, b, 1.0]],
        across(a, [1.0, 2.0], [1.0, 2.0]),
    ];
    // The inner pane has a closed room behind it, and lets no sky be seen but through the other panes.
    let scene = Folder::new(&[], "");
    let part = |name: &str, quads: &[[[f64; 3]; 4]], before: usize| {
        let mut text = format!("o {name}\nusemtl {name}\n");
        for quad in quads {
            for [x, y, z] in quad {
                text += &format!("v {x} {y} {z}\n");
            }
        }
        for i in 0..quads.len() {
            let first = 4 * (before + i) + 1;
            text += &format!("f {first} {} {} {}\n", first + 1, first + 2, first + 3);
        }
        text
    };
    let parts = part("wall", &walls, 0) + &part("glass", &glass, walls.len());
    scene.write("mesh.obj", &format!("mtllib mesh.mtl\n{parts}"));
    scene.write(
        "mesh.mtl",
        "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl glass\nKd 1 1 1\n",
    );
    scene.write(
        "scene.toml",
        "mesh = \"mesh.obj\"\n[[pane]]\nmaterial = \"glass\"\n",
    );
    let run = |more: &[&str]| {
        let mut all = vec!["daylight", "scene.toml", "--at", "48,15"];
        all.extend(["--tz", "Etc/GMT-1", "--grid", "opening=all"]);
        all.extend(["--sun-hours", "2026-03-21", "--every", "1min"]);
        all.extend(more);
        tyndall(scene.path(), &all)
    };
    let out = run(&["--csv"]);
    assert!(out.status.success(), "{}", stderr(&out));
    let rows = cells(&String::from_utf8_lossy(&out.stdout));
    eprintln!("{rows:?}");
    let number = |row: &[String], at: usize| row[at].parse::<f64>().expect("a number");
    assert!(rows.iter().flatten().all(|cell| cell != "-0"), "{rows:?}");
    assert_eq!(rows.len(), 3, "the inner pane is left out");
    assert!(
        stderr(&out).contains("1 sensors left out: they have no free sky"),
        "{}",
        stderr(&out)
    );
    // In the middle, 0.3 m above the sill.
    let at = |row: &[String]| [1, 2, 3, 4, 5, 6].map(|i| number(row, i));
    for (row, wanted) in [
        (&rows[1], [2.0, 1.3, 4.0, 0.0, 0.0, 1.0]),
        (&rows[2], [1.5, 3.0, 1.5, 0.0, 1.0, 0.0]),
    ] {
        let is_near = at(row)
            .iter()
            .zip(&wanted)
            .all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(is_near, "{row:?}");
    }
    // Refraction lengthens the day: cos H = (sin h - sin lat sin d) / (cos lat cos d), d = 0.34 degrees, h = -0.57 degrees. The sun is before a
    // southern wall from where it crosses the east: a day hardly longer than the equinox's has all of its hours but minutes.
    let (lat, d, h) = (
        48f64.to_radians(),
        0.34f64.to_radians(),
        -0.57f64.to_radians(),
    );
    let cosine = (h.sin() - lat.sin() * d.sin()) / (lat.cos() * d.cos());
    let day = 2.0 * cosine.acos().to_degrees() / 15.0;
    let south = 2.0 * (d.tan() / lat.tan()).acos().to_degrees() / 15.0;
    let hours = [number(&rows[1], 8), number(&rows[2], 8)];
    eprintln!(
        "wall {} h, by hand {south:.3}; roof {} h, by hand {day:.3}",
        hours[0], hours[1]
    );
    assert!((hours[0] - south).abs() < 0.06 && (hours[1] - day).abs() < 0.06);
    // What stands in reports, and what openings are not for.
    let out = run(&["--json"]);
    let report: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    assert!(
        report["assumptions"]
            .to_string()
            .contains("told from memory")
    );
    assert_eq!(report["left_out"][0]["count"], 1);
    scene.write("made.epw", &weather_on(60));
    let out = tyndall(
        scene.path(),
        &[
            "daylight",
            "scene.toml",
            "--grid",
            "opening=all",
            "--weather",
            "made.epw",
        ],
    );
    assert_eq!(out.status.code(), Some(2));
    assert!(stderr(&out).contains("face outward"), "{}", stderr(&out));
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
        (
            vec!["--weather", "made.epw", "--glazing", "glass=0.5"],
            "no glass `glass`",
        ),
        (vec!["--weather", "made.epw", "--glazing", "x"], "south=0.6"),
        (vec!["--weather", "made.epw", "--shard", "3/2"], "I from 1"),
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
        (vec!["--sun-hours", "21.3.2026"], "write YYYY-MM-DD"),
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
