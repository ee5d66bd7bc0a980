//! `tyndall daylight` from the outside: illuminance against closed forms, rows in and out, what is refused.

mod common;

use common::{quads_obj, stderr, tyndall};
use serde_json::Value;
use std::f64::consts::PI;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// What lights points from sky and surfaces, and its knob for rays from each.
const SKY: [&str; 2] = ["radiosity", "radiosity.rays=16"];

/// Luminance of the uniform skies of these tests [cd/m2], and what they give on open ground [lx].
const LUMINANCE: f64 = 5000.0;
const OPEN: f64 = PI * LUMINANCE;

/// A scene under a white point sun in the south, 30 degrees high, whose illuminance is given [lx].
struct Scene {
    folder: tempfile::TempDir,
}

impl Scene {
    /// Quads of four corners each, and the rest of the scene file.
    fn new(quads: &[[[f64; 3]; 4]], sun: f64, rest: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let toml = format!(
            "mesh = \"mesh.obj\"\n[sun]\nazimuth = 180.0\nelevation = 30.0\nilluminance = {sun:?}\n\
             diameter = 0.0\n{rest}"
        );
        let scene = Scene { folder };
        scene.write("mesh.obj", &quads_obj(quads));
        scene.write("scene.toml", &toml);
        scene
    }

    /// Nothing but a speck that no light meets on its way, far below.
    fn open(sun: f64, rest: &str) -> Self {
        let [low, side] = [-90.0, 1e-3];
        let corner = |x, z| [x, low, z];
        let speck = [
            corner(0.0, 0.0),
            corner(side, 0.0),
            corner(side, side),
            corner(0.0, side),
        ];
        Self::new(&[speck], sun, rest)
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path().join(name), text).expect("a file");
    }

    /// Runs the command on the points of a CSV under a sky.
    fn run(&self, points: &str, more: &[&str]) -> Output {
        self.write("points.csv", points);
        let fixed = [
            "daylight",
            "scene.toml",
            "--points",
            "points.csv",
            "--backend",
            "reference",
        ];
        tyndall(self.path(), &[&fixed, more].concat())
    }

    /// The illuminances that it prints.
    fn lux(&self, points: &str, sky: &str, more: &[&str]) -> Vec<Lux> {
        let output = self.run(points, &[&["--csv", "--sky", sky], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        lux(&text(&output.stdout))
    }
}

/// A row's results [lx].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lux {
    illuminance: f64,
    sun: f64,
    sky: f64,
    indirect: f64,
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("the output is UTF-8")
}

/// The last four cells of each row.
fn lux(csv: &str) -> Vec<Lux> {
    let mut lines = csv.lines();
    let head = lines.next().expect("a line of names");
    assert!(head.ends_with(",illuminance,sun,sky,indirect"), "{head}");
    let row = |line: &str| {
        let mut cells = line
            .rsplit(',')
            .map(|cell| cell.parse::<f64>().expect("a number"));
        let [indirect, sky, sun, illuminance] =
            std::array::from_fn(|_| cells.next().expect("a cell"));
        Lux {
            illuminance,
            sun,
            sky,
            indirect,
        }
    };
    let rows: Vec<Lux> = lines.map(row).collect();
    for row in &rows {
        let sum = row.sun + row.sky + row.indirect;
        assert!((row.illuminance - sum).abs() <= 1e-6 * sum, "{row:?}");
    }
    rows
}

fn near(found: f64, truth: f64, allowed: f64) -> bool {
    (found - truth).abs() <= allowed * truth.abs()
}

const UNIFORM: &str = "uniform:5000";

#[test]
fn open_ground_has_what_the_sky_and_the_sun_give() {
    let scene = Scene::open(2e4, "");
    let points = "x,y,z\n0,1,0\n-40,2.5,17\n";
    // Rays meet the halo of a clear sky's sun by chance: more of them less so.
    let more = ["--set", "radiosity.rays=4096"];
    for (sky, allowed, more) in [
        (UNIFORM, 1e-6, &[][..]),
        ("cie:1", 5e-3, &[]),
        ("cie:12", 8e-3, &[]),
        ("cie:12", 3e-3, &more),
    ] {
        let said = tyndall(
            scene.path(),
            &["sky", "--sun", "180,30", "--sky", sky, "--json"],
        );
        let said: Value = serde_json::from_slice(&said.stdout).expect("it is JSON");
        let truth = said["sky_horizontal_illuminance_lx"].as_f64();
        let truth = truth.unwrap_or_else(|| panic!("{said}"));
        for row in scene.lux(points, sky, more) {
            eprintln!("{sky}: {row:?}, {truth}");
            assert!(near(row.sky, truth, allowed), "{sky}: {row:?} {truth}");
            assert!(near(row.sun, 1e4, 1e-6), "{row:?}");
            assert_eq!(row.indirect, 0.0);
        }
    }
}

#[test]
fn a_wall_sees_half_the_sky_and_what_the_ground_sends() {
    let albedo = 0.3;
    let ground = format!("[ground]\nenabled = true\nheight = 0.0\nalbedo = {albedo}\n");
    let points = "x,y,z,nx,ny,nz\n0,2,0,0,0,-1\n0,2,0,-1,0,0\n0,2,0,0,-1,0\n0,2,0,0,1,0\n";
    let none = "[ground]\nenabled = false\n".to_owned();
    for (sun, ground, albedo) in [
        (0.0, &ground, albedo),
        (2e4, &ground, albedo),
        (2e4, &none, 0.0),
    ] {
        let scene = Scene::open(sun, ground);
        // What open ground receives of the sky and of the sun, and sends back.
        let sent = albedo * (OPEN + 0.5 * sun);
        let rows = scene.lux(points, UNIFORM, &[]);
        // The shares of the sky and the ground that a wall, a ceiling and a floor see: (1 +- cos) / 2.
        for (row, of_sky) in rows.iter().zip([0.5, 0.5, 0.0, 1.0]) {
            eprintln!("{row:?}");
            assert!(near(row.sky, of_sky * OPEN, 5e-3), "{row:?}");
            let indirect = (1.0 - of_sky) * sent;
            assert!(near(row.indirect, indirect, 5e-3), "{row:?} {indirect}");
        }
    }
}

#[test]
fn the_normal_is_what_the_sun_is_measured_by() {
    let scene = Scene::open(1e5, "");
    // Toward the sun, with any length; across it; away from it; up where nothing is said.
    let points = "x,y,z,nx,ny,nz\n\
                  0,1,0,0,0.5,0.8660254037844386\n0,1,0,0,1e-200,1.7320508075688772e-200\n0,1,0,0,1e300,1.7320508075688772e300\n\
                  0,1,0,7,0,0\n0,1,0,0,-0.5,-0.8660254\n0,1,0,,,\n";
    let rows = scene.lux(points, UNIFORM, &[]);
    for (row, truth) in rows.iter().zip([1e5, 1e5, 1e5, 0.0, 0.0, 5e4]) {
        assert!((row.sun - truth).abs() < 1e-2, "{row:?} {truth}");
    }
}

/// A quad by a corner and two sides.
fn quad(corner: [f64; 3], a: [f64; 3], b: [f64; 3]) -> [[f64; 3]; 4] {
    let plus = |p: [f64; 3], q: [f64; 3]| std::array::from_fn(|i| p[i] + q[i]);
    [
        corner,
        plus(corner, a),
        plus(plus(corner, a), b),
        plus(corner, b),
    ]
}

/// The six sides of a box.
fn cuboid(min: [f64; 3], size: [f64; 3]) -> Vec<[[f64; 3]; 4]> {
    let side = |axis: usize| {
        let mut side = [0.0; 3];
        side[axis] = size[axis];
        side
    };
    (0..3)
        .flat_map(|axis| {
            let (a, b) = (side((axis + 1) % 3), side((axis + 2) % 3));
            let mut far = min;
            far[axis] += size[axis];
            [quad(min, a, b), quad(far, a, b)]
        })
        .collect()
}

#[test]
fn walls_keep_light_out_and_a_point_inside_one_is_dark() {
    // A closed room, and beside it a solid wall 0.4 m thick.
    let mut quads = cuboid([-2.0, 0.0, -2.0], [4.0, 3.0, 4.0]);
    quads.extend(cuboid([5.0, 0.0, -2.0], [0.4, 3.0, 4.0]));
    let scene = Scene::new(&quads, 1e5, "[ground]\nenabled = true\nheight = 0.0\n");
    let points = "x,y,z,nx,ny,nz\n0,1,0,0,1,0\n0,0,0,0,1,0\n1.9,2.9,-1.9,0,0,1\n5.2,1,0,0,1,0\n5.2,1,0,1,0,0\n";
    for row in scene.lux(points, UNIFORM, &[]) {
        eprintln!("{row:?}");
        assert_eq!([row.sun, row.sky], [0.0; 2]);
        // Patches of the ground end at the foot of a wall only where it crosses enough of their cell; one that lies on both sides
        // carries a little of what it receives outside into the room. Of 65 000 lx outside a hundred-thousandth may come in.
        assert!(row.indirect < 0.65, "{row:?}");
    }
}

#[test]
fn rows_come_out_as_they_went_in_however_many_there_are() {
    let scene = Scene::new(&cuboid([-2.0, 1.0, -2.0], [4.0, 0.1, 4.0]), 1e5, "");
    let point = |i: usize| {
        let x = -3.0 + 0.01 * (i % 600) as f64;
        format!("{i},{x},{},0\n", 0.2 + 0.1 * (i % 5) as f64)
    };
    let all: String = (0..20_000).map(point).collect();
    let few = ["--quality", "draft", "--set", SKY[1]];
    let many = scene.run(
        &format!("id,x,y,z\n{all}"),
        &[&["--csv", "--sky", UNIFORM][..], &few].concat(),
    );
    assert!(many.status.success(), "{}", stderr(&many));
    assert!(stderr(&many).contains("points.csv:1: the column `id` is not read"));
    let many = text(&many.stdout);
    for (i, line) in many.lines().skip(1).enumerate() {
        assert!(line.starts_with(point(i).trim_end()), "{line}");
    }
    let rows = lux(&many);
    assert_eq!(rows.len(), 20_000);
    // A point has the same light alone, among some, and twice; wherever pieces of the input are cut.
    for (first, count) in [(0, 1), (777, 1), (5000, 1000)] {
        let some: String = (first..first + count).map(point).collect();
        let found = scene.lux(&format!("id,x,y,z\n{some}"), UNIFORM, &few);
        assert_eq!(found, rows[first..first + count]);
    }
    let twice = scene.lux(&format!("id,x,y,z\n{0}{0}", point(700)), UNIFORM, &few);
    assert_eq!(twice, [rows[700]; 2]);
}

#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_points() {
    let scene = Scene::open(1e5, "");
    let most = |points: usize| {
        let child = Command::new(env!("CARGO_BIN_EXE_tyndall"))
            .current_dir(scene.path())
            .args([
                "daylight",
                "scene.toml",
                "--points",
                "-",
                "--csv",
                "--backend",
                "reference",
            ])
            .args(["--quality", "draft", "--set", SKY[1]])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("tyndall starts");
        let block = "1.25,0.5,-3\n".repeat(1000);
        let (peak, bytes) = common::peak_memory(child, "x,y,z\n", &block, points / 1000);
        assert!(bytes > 20 * points as u64);
        peak
    };
    // As pixels of one frame, with their rays and what these meet, they would take more than 100 MB.
    let peak = most(200_000);
    assert!(peak < 64 << 10, "{peak} KiB");
}

#[test]
fn every_form_has_the_same_rows() {
    let scene = Scene::open(1e5, "");
    let points = "name,x,y,z\n\"a, b\",0,1,0\n\"say \"\"c\"\"\", 3 ,1,0\n";
    let sky = ["--sky", UNIFORM];
    let csv = scene.run(points, &[&sky[..], &["--csv"]].concat());
    let csv = text(&csv.stdout);
    assert!(
        csv.starts_with("name,x,y,z,illuminance,sun,sky,indirect\n\"a, b\",0,1,0,"),
        "{csv}"
    );
    let rows = lux(&csv);
    let json = scene.run(points, &[&sky[..], &["--json"]].concat());
    let json: Value = serde_json::from_slice(&json.stdout).expect("it is JSON");
    for (i, row) in rows.iter().enumerate() {
        assert_eq!(json[i]["name"], ["a, b", "say \"c\""][i]);
        assert_eq!(json[i]["x"], [0.0, 3.0][i]);
        for (name, value) in [
            ("illuminance", row.illuminance),
            ("sun", row.sun),
            ("sky", row.sky),
        ] {
            assert_eq!(json[i][name].as_f64(), Some(value), "{name}");
        }
    }
    let table = scene.run(points, &sky);
    assert!(table.status.success());
    let table = text(&table.stdout);
    let lines: Vec<&str> = table.lines().collect();
    let width = lines[0].chars().count();
    assert!(
        lines.iter().all(|line| line.chars().count() == width),
        "{table}"
    );
    assert!(
        lines[0]
            .trim_start()
            .starts_with("name  x  y  z  illuminance"),
        "{table}"
    );
    assert!(
        lines[1].contains("a, b  0  1  0") && lines[1].contains("50000.00"),
        "{table}"
    );
    assert_eq!(lines.len(), 3);
}

#[test]
fn standard_input_is_read_and_what_is_said_stays_off_standard_output() {
    let scene = Scene::open(1e5, "");
    let mut child = Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .current_dir(scene.path())
        .args([
            "daylight",
            "scene.toml",
            "--points",
            "-",
            "--csv",
            "--sky",
            UNIFORM,
        ])
        .args(["--backend", "reference", "--tier", "day"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("tyndall starts");
    let mut stdin = child.stdin.take().expect("it is piped");
    stdin.write_all(b"x,y,z\n0,1,0\n0,2,0\n").expect("it reads");
    drop(stdin);
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success());
    assert_eq!(lux(&text(&output.stdout)).len(), 2);
    let said = stderr(&output);
    // The tier has no effect where a sun stands in for place and time.
    for words in ["warning", "tier", "surface_sun", "uniform"] {
        assert!(said.contains(words), "`{words}` is not in\n{said}");
    }
}

#[test]
fn what_is_wrong_with_the_points_is_named_with_its_line() {
    let scene = Scene::open(1e5, "");
    let wrong = [
        ("", "points.csv: the file is empty", "x,y,z"),
        (
            "x,y\n1,2\n",
            "points.csv:1: the column `z` is missing",
            "x,y,z",
        ),
        (
            "x;y;z\n1;2;3\n",
            "points.csv:1: the column `x`, `y`, `z` is missing",
            "not semicolons",
        ),
        (
            "x,y,z,sky\n1,2,3,4\n",
            "points.csv:1: the column `sky` is also a result's name",
            "rename",
        ),
        (
            "x,y,z,X\n1,2,3,4\n",
            "points.csv:1: the column `x` appears twice",
            "remove one",
        ),
        (
            "x,y,z\n1,nan,3\n",
            "points.csv:2: y: `nan` is not a finite number",
            "decimal",
        ),
        (
            "x,y,z\n1,2,3\n\n1,1e400,3\n",
            "points.csv:4: y: `1e400` is not",
            "decimal",
        ),
        ("x,y,z\n1,,3\n", "points.csv:2: y is empty", "decimal"),
        (
            "x,y,z\n1,2\n",
            "points.csv:2: 2 cells where the first line has 3",
            "every column",
        ),
        ("x,y,z\n1e300,2,3\n", "points.csv:2: the position", "1e9 m"),
        (
            "x,y,z,nx,ny,nz\n1,2,3,0,0,0\n",
            "points.csv:2: the normal",
            "0, 1, 0 is up",
        ),
        (
            "x,y,z,nx,ny,nz\n1,2,3,0,,1\n",
            "points.csv:2: only some of nx, ny, nz",
            "all three",
        ),
        (
            "x,y,z,nx\n1,2,3,1\n",
            "points.csv:2: only some of nx, ny, nz",
            "all three",
        ),
    ];
    for (points, problem, remedy) in wrong {
        let output = scene.run(points, &["--csv"]);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{points}: {said}");
        assert!(said.contains(problem), "`{problem}` is not in\n{said}");
        assert!(said.contains(remedy), "`{remedy}` is not in\n{said}");
        assert!(said.lines().all(|line| line.len() < 300), "{said}");
    }
    let output = scene.run("x,y,z,normalx\n1,2,3,4\n", &["--csv"]);
    assert!(output.status.success());
    assert!(stderr(&output).contains("the column `normalx` is not read"));
    let output = scene.run("x,y,z,ny_\n1,2,3,4\n", &["--csv"]);
    assert!(
        stderr(&output).contains("did you mean `ny`?"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_broken_row_costs_that_row_or_with_strict_all() {
    let scene = Scene::open(1e5, "");
    let points = "x,y,z\n0,1,0\nhere,1,0\n2,1,0\n";
    let loose = scene.run(points, &["--csv"]);
    assert_eq!(loose.status.code(), Some(2));
    assert!(stderr(&loose).contains("1 of 3 rows could not be used"));
    let rows = text(&loose.stdout);
    let begins: Vec<&str> = rows.lines().map(|line| &line[..5]).collect();
    assert_eq!(begins, ["x,y,z", "0,1,0", "2,1,0"]);
    let strict = scene.run(points, &["--csv", "--strict"]);
    assert_eq!(strict.status.code(), Some(2));
    assert!(strict.stdout.is_empty());
    assert!(stderr(&strict).contains("points.csv:3"));
    let none = scene.run("x,y,z\n", &["--json"]);
    assert!(none.status.success());
    assert_eq!(text(&none.stdout), "[\n]\n");
    assert!(stderr(&none).contains("has no rows"));
}

#[test]
fn flags_and_files_that_do_not_fit_are_refused_before_anything_is_computed() {
    let scene = Scene::open(1e5, "");
    let points = "x,y,z\n0,1,0\n";
    for (more, words) in [
        (&["--set", "surface_sun.sun=4"][..], "suns"),
        (&["--without", "surface_sn"], "surface_sun"),
        (&["--report", "points.csv"], "the points"),
        (&["--report", "scene.toml"], "the scene"),
        (&["--sky", "cie:99"], "CIE sky type"),
        (&["--eye", "0,0,0"], "--eye"),
    ] {
        let output = scene.run(points, more);
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        assert!(
            stderr(&output).contains(words),
            "{more:?}: {}",
            stderr(&output)
        );
        assert!(output.stdout.is_empty());
    }
    let missing = [
        "daylight",
        "scene.toml",
        "--points",
        "nowhere.csv",
        "--backend",
        "reference",
    ];
    let output = tyndall(scene.path(), &missing);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("nowhere.csv"));
    let output = tyndall(scene.path(), &["daylight", "scene.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("--points"));
}

#[test]
fn the_report_says_what_was_done() {
    let scene = Scene::open(1e5, "");
    let output = scene.run(
        "x,y,z\n0,1,0\n1,1,0\n",
        &[
            "--report",
            "report.json",
            "--set",
            "surface_sun.suns=4",
            "--without",
            SKY[0],
            "--sky",
            UNIFORM,
        ],
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let report = std::fs::read(scene.path().join("report.json")).expect("a report");
    let report: Value = serde_json::from_slice(&report).expect("it is JSON");
    assert_eq!(report["points"], 2);
    assert_eq!(report["error"], Value::Null);
    assert_eq!(report["record"]["surface_sun.suns"], 4.0);
    let lux = report["record"]["sun_illuminance_lx"].as_f64();
    assert!(near(lux.expect("a number"), 1e5, 1e-12));
    assert_eq!(report["work"]["backend"], "reference");
    let steps = report["plan"].as_array().expect("steps");
    let left_out = steps.iter().find(|step| step["effect"] == SKY[0]);
    assert!(left_out.is_none_or(|step| step["run"] == false));
    let stages = report["stages"].as_array().expect("stages");
    assert!(stages.iter().any(|stage| stage["name"] == "surface_sun"));
    let rows = scene.lux("x,y,z\n0,1,0\n", UNIFORM, &["--without", SKY[0]]);
    assert_eq!((rows[0].sky, rows[0].indirect), (0.0, 0.0));
    assert!(near(rows[0].illuminance, 5e4, 1e-6));
}

/// A floor of 4 by 3 m without a roof, and a board of 2 by 1 m that stands on its edge.
fn court() -> Scene {
    let floor = [[0.0, 0.0], [0.0, 3.0], [4.0, 3.0], [4.0, 0.0]].map(|[x, z]| [x, 0.0, z]);
    let board = [[1.0, 2.0], [3.0, 2.0], [3.0, 3.0], [1.0, 3.0]].map(|[x, y]| [x, y, -50.0]);
    Scene::new(&[floor, board], 0.0, "[ground]\nenabled = false\n")
}

#[test]
fn grids_have_summaries_tables_and_maps() {
    let scene = court();
    let run = |more: &[&str]| {
        let fixed = ["daylight", "scene.toml", "--backend", "reference", "--grid"];
        let output = tyndall(scene.path(), &[&fixed, more].concat());
        assert!(output.status.success(), "{more:?}: {}", stderr(&output));
        output
    };
    let all = [
        "spacing=1",
        "--sky",
        UNIFORM,
        "-o",
        "a.csv",
        "-o",
        "a.json",
        "-o",
        "a.svg",
        "-o",
        "a.png",
        "--report",
        "report.json",
        "--json",
    ];
    let output = run(&all);
    // Open ground under a uniform sky, and what the bright floor sends nowhere.
    let rows: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let row = &rows[0];
    assert_eq!(
        (&row["sensors"], &row["area_m2"]),
        (&Value::from(12), &Value::from(12.0))
    );
    for key in ["mean_lx", "median_lx", "minimum_lx", "maximum_lx"] {
        let lux = row[key].as_f64().expect("a number");
        assert!(near(lux, OPEN, 0.01), "{key}: {lux}");
    }
    assert!(row["uniformity"].as_f64().expect("a number") > 0.98);
    assert!(
        stderr(&output).contains("12 sensors on 1 planes"),
        "{}",
        stderr(&output)
    );
    let read = |name: &str| std::fs::read(scene.path().join(name)).expect("the file is there");
    let csv = text(&read("a.csv"));
    let head = "plane,x_m,y_m,z_m,nx,ny,nz,area_m2,illuminance_lx,sun_lx,sky_lx,indirect_lx";
    assert_eq!(csv.lines().next(), Some(head));
    let first: Vec<&str> = csv.lines().nth(1).expect("a row").split(',').collect();
    assert_eq!(first[1..8], ["0.5", "0.85", "2.5", "0", "1", "0", "1"]);
    assert_eq!(csv.lines().count(), 13);
    let json: Value = serde_json::from_slice(&read("a.json")).expect("JSON");
    assert_eq!(json["sensors"].as_array().map(Vec::len), Some(12));
    assert_eq!(json["unit"], "lx");
    assert_eq!(json["grids"][0]["spacing"], 1.0);
    let warned = json["warnings"].to_string();
    assert!(warned.contains("triangles have no colour"), "{warned}");
    assert!(text(&read("a.svg")).contains("illuminance [lx] in scene.toml"));
    let report: Value = serde_json::from_slice(&read("report.json")).expect("JSON");
    assert_eq!(report["points"], 12);
    let png = image::open(scene.path().join("a.png"))
        .expect("a PNG")
        .into_rgb8();
    assert_eq!(png.width(), 2000);
    assert!(png.pixels().any(|p| p.0 == [20, 20, 20]) && png.get_pixel(0, 0).0 == [255; 3]);

    // Open ground has a daylight factor of 100 %, whatever the sky's level.
    let table = text(&run(&["spacing=1.5", "--factor"]).stdout);
    let cells: Vec<&str> = table
        .lines()
        .nth(1)
        .expect("a row")
        .split_whitespace()
        .collect();
    assert_eq!(cells[..4], ["floor", "(assumed)", "6", "12"]);
    assert!(
        near(cells[4].parse().expect("a number"), 100.0, 0.01),
        "{table}"
    );
    // A board sees half of a uniform sky.
    let csv = text(
        &run(&[
            "surface=wall (assumed),spacing=5,plane=0.01",
            "--sky",
            UNIFORM,
            "--csv",
        ])
        .stdout,
    );
    assert!(csv.starts_with("plane,sensors,area_m2,mean_lx"), "{csv}");
    let board: Vec<&str> = csv.lines().nth(1).expect("a surface").split(',').collect();
    assert!(
        near(board[3].parse().expect("a number"), 0.5 * OPEN, 0.01),
        "{csv}"
    );
}

#[test]
fn grids_that_cannot_be_are_refused() {
    let scene = court();
    let cases: [(&[&str], &str); 11] = [
        (&["--grid", "spacing=1", "-o", "a.txt"], ".svg"),
        (
            &["--grid", "spacing=1", "-o", "scene.toml"],
            "the name does not say",
        ),
        (
            &["--grid", "spacing=1", "--factor", "--sky", "perez"],
            "cie:16",
        ),
        (&["--grid", "spaceing=1"], "did you mean `spacing`?"),
        (
            &["--grid", "plane=0.85,hight=2"],
            "the keys are plane, spacing",
        ),
        (
            &["--grid", "spacing=1", "--set", "radiosity.pixels=1"],
            "it has sky, rays, outline",
        ),
        (&["--grid", "room=Kitchen"], "floor (assumed)"),
        (&["--grid", "spacing=1", "--points", "p.csv"], "--points"),
        (&["--factor", "--points", "p.csv"], "cannot be used with"),
        (&["--grid", "inset=2"], "no sensor finds room"),
        (
            &["--grid", "spacing=1", "-o", "a.png", "-o", "a.png"],
            "another of the files",
        ),
    ];
    for (more, words) in cases {
        let fixed = ["daylight", "scene.toml", "--backend", "reference"];
        let output = tyndall(scene.path(), &[&fixed, more].concat());
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{more:?}: {said}");
        assert!(said.contains(words), "{more:?}: {said}");
        assert!(output.stdout.is_empty());
    }
}
