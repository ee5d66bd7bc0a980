//! `tyndall sun` as a user meets it.

use std::io::{Read, Write};
use std::process::{Command, Output, Stdio};

fn tyndall(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .args(args)
        .stdin(Stdio::null())
        .output()
        .expect("tyndall starts")
}

fn with_input(args: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("tyndall starts");
    child
        .stdin
        .take()
        .expect("stdin is piped")
        .write_all(input.as_bytes())
        .expect("tyndall reads");
    child.wait_with_output().expect("tyndall ends")
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

fn stderr(output: &Output) -> String {
    // Words may be wrapped at the terminal's width.
    String::from_utf8(output.stderr.clone())
        .expect("UTF-8")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

/// The cells of the only row of a CSV, by column.
fn cell(csv: &str, row: usize, name: &str) -> f64 {
    let mut lines = csv.lines();
    let column = lines
        .next()
        .expect("a header")
        .split(',')
        .position(|c| c == name)
        .expect("the column");
    lines
        .nth(row)
        .expect("the row")
        .split(',')
        .nth(column)
        .expect("the cell")
        .parse()
        .expect("a number")
}

/// The text of a number reads back to the same f64, but serde_json's reader rounds the last bit its own way.
fn same(json: Option<f64>, csv: f64) -> bool {
    json.is_some_and(|json| (json - csv).abs() <= 4.0 * f64::EPSILON * csv.abs())
}

const NREL: [&str; 10] = [
    "sun",
    "--at",
    "39.742476,-105.1786,1830.14",
    "--time",
    "2003-10-17T12:30:30-07:00",
    "--delta-t",
    "67",
    "--pressure",
    "820",
    "--temperature",
];

#[test]
fn the_worked_example_of_the_spa_report() {
    let output = tyndall(&[&NREL[..], &["11", "--csv"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let csv = stdout(&output);
    assert!((cell(&csv, 0, "azimuth") - 194.340_24).abs() < 5e-6);
    assert!((90.0 - cell(&csv, 0, "elevation_apparent") - 50.111_62).abs() < 5e-6);
    assert!((cell(&csv, 0, "elevation_true") - 39.872_046).abs() < 5e-7);
    // Not the tier that was asked for, not the number: the tiers are told apart.
    let day = stdout(&tyndall(
        &[&NREL[..], &["11", "--csv", "--tier", "day"]].concat(),
    ));
    assert!((cell(&day, 0, "azimuth") - 194.340_24).abs() > 1e-3);
}

#[test]
fn json_and_text_agree_with_csv() {
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&tyndall(&[&NREL[..], &["11", "--json"]].concat())))
            .expect("JSON");
    let csv = stdout(&tyndall(&[&NREL[..], &["11", "--csv"]].concat()));
    assert!(same(
        json["sun"]["azimuth"].as_f64(),
        cell(&csv, 0, "azimuth")
    ));
    assert_eq!(json["tier"], "spa");
    assert_eq!(json["utc"], "2003-10-17T19:30:30Z");
    // The report prints a sunrise of 06:12:43, by its closed procedure with the seconds cut. Its sunset of 17:20:19 is
    // the evening before's: it falls on the next UTC date, of which the procedure takes the wrong one. The sun's
    // centre is at -0.8333 degrees at 17:18:51 (pvlib gives this instant as the sunset of the day after).
    let seconds = |event: &str| -> f64 {
        let text = json["events"][event]["times"][0]
            .as_str()
            .expect("a time")
            .to_owned();
        let n = |range: std::ops::Range<usize>| text[range].parse::<f64>().expect("digits");
        3600.0 * n(11..13) + 60.0 * n(14..16) + n(17..23)
    };
    assert!(
        (seconds("sunrise") - (6.0 * 3600.0 + 12.0 * 60.0 + 43.5)).abs() < 1.5,
        "{}",
        seconds("sunrise")
    );
    assert!(
        (seconds("sunset") - (17.0 * 3600.0 + 18.0 * 60.0 + 51.0)).abs() < 1.5,
        "{}",
        seconds("sunset")
    );
    let text = stdout(&tyndall(&[&NREL[..], &["11"]].concat()));
    assert!(
        text.contains("194.3402°") && text.contains("written in the time"),
        "{text}"
    );
}

#[test]
fn clock_changes_are_named_and_never_guessed() {
    let at = ["sun", "--at", "48.8584,2.2945", "--csv", "--time"];
    let gap = tyndall(&[&at[..], &["2026-03-29T02:30"]].concat());
    assert_eq!(gap.status.code(), Some(2));
    let text = stderr(&gap);
    assert!(
        text.contains("2026-03-29T01:30:00+01:00") && text.contains("2026-03-29T03:30:00+02:00"),
        "{text}"
    );
    let fold = tyndall(&[&at[..], &["2026-10-25T02:30"]].concat());
    assert_eq!(fold.status.code(), Some(2));
    let text = stderr(&fold);
    assert!(
        text.contains("02:30:00+02:00")
            && text.contains("02:30:00+01:00")
            && text.contains("--fold"),
        "{text}"
    );
    let hours = |which: &str| {
        let csv = stdout(&tyndall(
            &[&at[..], &["2026-10-25T02:30", "--fold", which]].concat(),
        ));
        cell(&csv, 0, "hour_angle")
    };
    assert!(((hours("later") - hours("earlier")).rem_euclid(360.0) - 15.0).abs() < 0.01);
    let contradiction = tyndall(&[&at[..], &["2026-06-21T12:00:00+05:00[Europe/Paris]"]].concat());
    assert_eq!(contradiction.status.code(), Some(2));
    let told = tyndall(&[
        "sun",
        "--at",
        "48.8584,2.2945",
        "--time",
        "2026-06-21T12:00",
    ]);
    assert!(stdout(&told).contains("zone Europe/Paris, looked up from the coordinates"));
}

#[test]
fn what_cannot_be_meant_is_refused_with_a_remedy() {
    for (args, says) in [
        (&["--at", "151.2,-33.86"][..], "--at -33.86,151.2"),
        (&["--at", "0,0", "--time", "2026-02-29T12:00Z"], "28 days"),
        (
            &[
                "--at",
                "0,0",
                "--tz",
                "Europe/Pariss",
                "--time",
                "2026-06-21T12:00",
            ],
            "Europe/Paris",
        ),
        (
            &[
                "--at",
                "0,0",
                "--time",
                "2026-06-21T12:00Z",
                "--time-scale",
                "tt",
            ],
            "--time-scale",
        ),
        (&["--at", "0,0", "--time", "JD1e9"], "no Julian date"),
        (&["--at", "0,0", "--time", "JD9999999.5"], "-2000 to 6000"),
        (&["--at", "0,0", "--pressure", "-1"], "0 to 2000 hPa"),
        (&["--at", "0,0", "--tier", "best"], "arcsecond"),
        (
            &[
                "--at",
                "0,0",
                "--time",
                "2026-06-21",
                "--until",
                "2026-06-20",
            ],
            "not after",
        ),
        (&["--at", "0,0", "--plot", "x.pdf"], ".svg"),
        (
            &["--at", "0,0", "--horizon", "100", "--time", "2026-06-21"],
            "-90 to 90",
        ),
        (
            &[
                "--at",
                "-13.8,-171.8",
                "--tz",
                "Pacific/Apia",
                "--time",
                "2011-12-30",
            ],
            "skipped",
        ),
        (&[], "--at"),
    ] {
        let output = tyndall(&[&["sun"], args].concat());
        assert_eq!(
            output.status.code(),
            Some(2),
            "{args:?}: {}",
            stdout(&output)
        );
        assert!(
            stderr(&output).contains(says),
            "{args:?}: {}",
            stderr(&output)
        );
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn polar_day_and_night_say_so() {
    let day = stdout(&tyndall(&[
        "sun",
        "--at",
        "69.65,18.96",
        "--time",
        "2026-06-21",
    ]));
    assert!(
        day.contains("polar day") && day.contains("day length        24:00:00"),
        "{day}"
    );
    let night = stdout(&tyndall(&[
        "sun",
        "--at",
        "69.65,18.96",
        "--time",
        "2026-12-21",
    ]));
    assert!(
        night.contains("polar night") && night.contains("day length        00:00:00"),
        "{night}"
    );
}

#[test]
fn a_range_counts_its_steps_and_a_day_its_hours() {
    let range = [
        "sun",
        "--at",
        "10,20",
        "--time",
        "2026-01-01T00:00Z",
        "--until",
        "2026-01-02T00:00Z",
        "--step",
        "90s",
        "--csv",
    ];
    let csv = stdout(&tyndall(&range));
    assert_eq!(csv.lines().count(), 1 + 960);
    // The interpolated places of a range are those of single instants, to 0.01 arcseconds.
    let single = stdout(&tyndall(&[
        "sun",
        "--at",
        "10,20",
        "--time",
        "2026-01-01T10:30Z",
        "--csv",
    ]));
    for column in ["elevation_true", "declination"] {
        assert!((cell(&csv, 420, column) - cell(&single, 0, column)).abs() < 3e-6);
    }
    // The day on which the clocks go forward has 23 hours.
    let day = stdout(&tyndall(&[
        "sun",
        "--at",
        "48.8584,2.2945",
        "--time",
        "2026-03-29",
        "--csv",
    ]));
    assert_eq!(day.lines().count(), 1 + 23);
    let json = stdout(&tyndall(&[&range[..9], &["--json"]].concat()));
    let rows: Vec<serde_json::Value> = serde_json::from_str(&json).expect("JSON");
    assert_eq!(rows.len(), 960);
    assert!(same(
        rows[420]["azimuth"].as_f64(),
        cell(&csv, 420, "azimuth")
    ));
}

const BATCH: &str = "time,latitude,longitude,elevation,pressure,temperature,delta_t\n\
    2003-10-17T12:30:30-07:00,39.742476,-105.1786,1830.14,820,11,67\n\
    JD2448908.5,0,0,0,1013.25,15,59\n";

#[test]
fn a_batch_prints_its_rows_with_their_positions() {
    let output = with_input(&["sun", "--batch", "-"], BATCH);
    assert!(output.status.success(), "{}", stderr(&output));
    let csv = stdout(&output);
    assert_eq!(
        csv.lines().next(),
        Some(
            "time,latitude,longitude,elevation,pressure,temperature,delta_t,azimuth,elevation_true,elevation_apparent,\
             declination,right_ascension,equation_of_time,distance_au,hour_angle,angular_radius,air_mass,irradiance_factor"
        )
    );
    assert!((cell(&csv, 0, "azimuth") - 194.340_24).abs() < 5e-6);
    let tt = stdout(&with_input(
        &[
            "sun",
            "--batch",
            "-",
            "--time-scale",
            "tt",
            "--tier",
            "minute",
        ],
        BATCH,
    ));
    // Meeus, example 25.a: 1992 October 13, 0h TD.
    assert!((cell(&tt, 1, "right_ascension") - 198.380_83).abs() < 5.1e-6);
    assert!((cell(&tt, 1, "declination") + 7.785_07).abs() < 5.1e-6);
    let json = stdout(&with_input(&["sun", "--batch", "-", "--json"], BATCH));
    let rows: Vec<serde_json::Value> = serde_json::from_str(&json).expect("JSON");
    assert!(same(rows[0]["azimuth"].as_f64(), cell(&csv, 0, "azimuth")));
    assert_eq!(rows[1]["delta_t"].as_f64(), Some(59.0));
}

#[test]
fn a_broken_row_loses_no_other_unless_strict() {
    let broken = BATCH.to_owned()
        + "2026-06-21T12:00:00Z,91,0,0,,,\n2026-06-21T12:00:00Z,45,0\n2026-06-21T12:00:00Z,45,abc,0,,,\n\
        2026-06-21T12:00:00Z,45,0,0,,,\n";
    let output = with_input(&["sun", "--batch", "-"], &broken);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(stdout(&output).lines().count(), 1 + 3);
    let text = stderr(&output);
    for line in [
        "standard input:4: latitude is 91",
        "standard input:5: 3 cells",
        "standard input:6: longitude: `abc`",
        "3 of 6 rows",
    ] {
        assert!(text.contains(line), "{line} is not in {text}");
    }
    let strict = with_input(&["sun", "--batch", "-", "--strict"], &broken);
    assert_eq!(strict.status.code(), Some(2));
    assert!(strict.stdout.is_empty());
    assert!(stderr(&strict).contains("standard input:4"));
}

#[test]
fn a_missing_column_is_named_with_file_and_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("rows.csv");
    std::fs::write(&path, "time,lat,longitude,elevation\n").expect("written");
    let output = tyndall(&["sun", "--batch", path.to_str().expect("a name")]);
    assert_eq!(output.status.code(), Some(2));
    let text = stderr(&output);
    assert!(
        text.contains("rows.csv:1: the column `latitude` is missing"),
        "{text}"
    );
    let absent = tyndall(&["sun", "--batch", "/nowhere/rows.csv"]);
    assert_eq!(absent.status.code(), Some(2));
}

#[test]
fn a_closed_pipe_is_success() {
    let args = [
        "sun",
        "--at",
        "0,0",
        "--time",
        "2026-01-01T00:00Z",
        "--until",
        "2026-06-01T00:00Z",
        "--step",
        "1m",
        "--csv",
    ];
    let mut child = Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .args(args)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("tyndall starts");
    let mut first = [0; 100];
    child
        .stdout
        .take()
        .expect("stdout is piped")
        .read_exact(&mut first)
        .expect("it writes");
    // The pipe is closed here, with megabytes to come.
    let output = child.wait_with_output().expect("tyndall ends");
    assert!(output.status.success());
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
}

#[test]
fn diagrams_are_drawn_everywhere() {
    let folder = tempfile::tempdir().expect("a folder");
    for (i, at) in [
        "48.8584,2.2945",
        "-33.86,151.2",
        "0,0",
        "90,0",
        "-90,0",
        "69.65,18.96",
    ]
    .iter()
    .enumerate()
    {
        let (svg, png) = (
            folder.path().join(format!("{i}.svg")),
            folder.path().join(format!("{i}.png")),
        );
        let output = tyndall(&[
            "sun",
            "--at",
            at,
            "--plot",
            svg.to_str().expect("a name"),
            "--plot",
            png.to_str().expect("a name"),
        ]);
        assert!(output.status.success(), "{}", stderr(&output));
        let text = std::fs::read_to_string(&svg).expect("the SVG");
        assert!(text.starts_with("<svg") && text.ends_with("</svg>\n") && !text.contains("NaN"));
        assert_eq!(collisions(&text), [""; 0], "{at}");
        let picture = image::open(&png).expect("the PNG").to_rgb8();
        // Ink is there, and most of the paper is white.
        let white = picture.pixels().filter(|p| p.0 == [255; 3]).count() as f64
            / (picture.width() * picture.height()) as f64;
        assert!((0.5..0.99).contains(&white), "{at}: {white}");
    }
}

/// Words of a chart that are in each other's way.
fn collisions(svg: &str) -> Vec<String> {
    let value = |line: &str, name: &str| -> f64 {
        let rest = line
            .split(&format!(" {name}=\""))
            .nth(1)
            .expect("the attribute");
        let number = rest.split('"').next().expect("its end");
        number.parse().expect("a number")
    };
    let words = svg.lines().filter(|line| line.starts_with("<text"));
    let middle = words.filter(|line| line.contains("\"middle\""));
    let areas: Vec<([f64; 4], &str)> = middle
        .map(|line| {
            let [x, y, size] = ["x", "y", "font-size"].map(|name| value(line, name));
            let text = line.split('>').nth(1).expect("words");
            let text = text.split('<').next().expect("their end");
            // Digits are about half as wide as they are high.
            let half = 0.25 * size * text.chars().count() as f64;
            ([x - half, y - 0.7 * size, x + half, y], text)
        })
        .collect();
    let mut found = Vec::new();
    for (i, (a, first)) in areas.iter().enumerate() {
        for (b, second) in &areas[..i] {
            if a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3] {
                found.push(format!("{first} and {second}"));
            }
        }
    }
    found
}

#[test]
fn the_diagram_marks_the_sun_and_the_paths_of_dates() {
    let folder = tempfile::tempdir().expect("a folder");
    let svg = folder.path().join("a.svg");
    let drawn = |more: &[&str]| {
        let usual = ["sun", "--at", "48.8584,2.2945", "--plot"];
        let path = [svg.to_str().expect("a name")];
        let output = tyndall(&[&usual[..], &path, more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        let text = std::fs::read_to_string(&svg).expect("the SVG");
        assert_eq!(collisions(&text), [""; 0], "{more:?}");
        text
    };
    let marks = |text: &str| text.matches("<polygon").count();
    let paths = |text: &str| text.matches("stroke=\"#007855\"").count();
    let plain = drawn(&[]);
    assert_eq!((marks(&plain), paths(&plain)), (0, 0));
    assert!(plain.contains("48.8584°N, 2.2945°E"), "{plain}");
    let noon = drawn(&["--time", "2026-08-10T13:50"]);
    // In both charts, with its path.
    assert_eq!((marks(&noon), paths(&noon)), (2, 2));
    assert!(
        noon.contains(">13:50<")
            && noon.contains("2026-08-10 13:50: azimuth 177.")
            && noon.contains(">10 Aug<")
    );
    let night = drawn(&["--time", "2026-08-10T23:50"]);
    assert_eq!(marks(&night), 0);
    assert!(night.contains("below the horizon"));
    let week = drawn(&["--time", "2026-02-01", "--until", "2026-02-08"]);
    assert_eq!((marks(&week), paths(&week)), (0, 14));
    assert!(week.contains(">2026-02-01 to 2026-02-07<"));
    // A few of them, where they are many.
    let months = drawn(&["--time", "2026-02-01", "--until", "2026-08-01"]);
    assert_eq!(paths(&months), 2 * 13);
    // On into the next year.
    let winter = drawn(&["--time", "2026-12-28", "--until", "2027-01-04"]);
    assert_eq!(paths(&winter), 2 * 7);
    assert!(winter.contains(">2026-12-28 to 2027-01-03<"));
}

#[test]
fn a_row_a_day_has_the_events_of_each_date() {
    // The clock goes back within the week.
    let week = [
        "sun",
        "--at",
        "48°51'30\"N,2°17'40\"E",
        "--events",
        "--time",
        "2026-10-22",
        "--until",
        "2026-10-29",
    ];
    let with = |form: &str| stdout(&tyndall(&[&week[..], &[form]].concat()));
    let csv = with("--csv");
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 1 + 7);
    let json: serde_json::Value = serde_json::from_str(&with("--json")).expect("JSON");
    let time = |text: &str| chrono::DateTime::parse_from_rfc3339(text).expect("a time");
    for (row, day) in rows[1..].iter().zip(json["days"].as_array().expect("days")) {
        let single = [
            "sun",
            "--at",
            "48.858333333333334,2.2944444444444443",
            "--time",
            row[0],
            "--json",
        ];
        let single: serde_json::Value =
            serde_json::from_str(&stdout(&tyndall(&single))).expect("JSON");
        assert_eq!(single["events"], *day, "{}", row[0]);
        for (name, cell) in rows[0].iter().zip(row).skip(1) {
            if let Some(local) = name.strip_suffix("_utc") {
                assert_eq!(day[local]["utc"][0], *cell);
                let at = rows[0]
                    .iter()
                    .position(|n| *n == local)
                    .expect("its neighbour");
                assert_eq!(time(row[at]), time(cell));
                let hours =
                    if row[0] < "2026-10-25" || local == "midnight" && row[0] == "2026-10-25" {
                        2
                    } else {
                        1
                    };
                assert_eq!(
                    time(row[at]).offset().local_minus_utc(),
                    3600 * hours,
                    "{local} {row:?}"
                );
            }
        }
    }
    let text = with("--tier=spa");
    assert!(
        text.contains("2026-10-25") && text.contains("UTC+01:00") && !text.contains("2026-10-29")
    );
    // None on that date: an empty cell, a dash.
    let polar = [
        "sun",
        "--at",
        "69.6,18.9",
        "--events",
        "--time",
        "2026-06-21",
    ];
    assert!(stdout(&tyndall(&polar)).contains("-: not on that date"));
    let csv = stdout(&tyndall(&[&polar[..], &["--csv"]].concat()));
    assert_eq!(
        csv.lines().nth(1).expect("a row").split(',').nth(9),
        Some("")
    );
    // Half-hour steps and offsets as people write them.
    let half = [
        "sun",
        "--at",
        "28.6,77.2",
        "--tz",
        "+5:30",
        "--time",
        "2026-06-21",
        "--step",
        "30min",
        "--csv",
    ];
    let csv = stdout(&tyndall(&half));
    assert_eq!(csv.lines().count(), 1 + 48);
    assert!(
        csv.lines()
            .nth(2)
            .expect("a row")
            .starts_with("2026-06-21T00:30:00+05:30,")
    );
}
