//! A furnished room behind glass, and what RADIANCE gives its points.

use super::build::quad;
use super::rooms::{self, Room};
use glam::{DVec3, dvec3};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::PathBuf;

/// What the glazing lets through at normal incidence, as Radiance's users write double glazing: one sheet.
pub const GLAZING: f64 = 0.72;

/// The same as the transmissivity that RADIANCE has for one sheet of n = 1.52 (its manual on `glass`).
fn transmissivity() -> f64 {
    let squared = 0.007_252_223_9 * GLAZING * GLAZING;
    ((0.840_252_843_5 + squared).sqrt() - 0.916_653_066_1) / 0.003_626_111_9 / GLAZING
}

/// The room of the truth, with every fourth of its points.
pub fn room() -> Room {
    let mut glazed = rooms::room("furnished", 1.0).expect("it is in the list");
    glazed.points = glazed.points.into_iter().step_by(4).collect();
    glazed
}

/// Illuminance of open ground by the truth's sky, and of its suns [lx], with their azimuths and elevations [degrees].
pub const SKY: f64 = 1e4;
pub const SUNS: [([f64; 2], f64); 2] = [([197.0, 33.0], 76_000.0), ([62.0, 41.0], 48_000.0)];

/// Hemispheres that each point of the truth has.
const REPEATS: u32 = 24;

/// The window, 2.4 by 1.5 m in the southern wall.
pub const WINDOW: [DVec3; 3] = [
    dvec3(0.8, 0.9, 0.0),
    dvec3(2.4, 0.0, 0.0),
    dvec3(0.0, 1.5, 0.0),
];

/// RADIANCE's task: three channels, sky alone, a sun in the window without ground, a sun from the north-east with it. The glazing is one
/// sheet of glass.
fn task(room: &Room) -> Value {
    let triangles: Vec<Vec<f64>> = (room.triangles.iter())
        .map(|(corners, material)| {
            let numbers = corners.iter().flat_map(|c| c.to_array());
            numbers.chain([f64::from(*material)]).collect()
        })
        .collect();
    let zenith = 9.0 * SKY / (7.0 * PI);
    let row = |elevation: i32| {
        let luminance = zenith * (1.0 + 2.0 * f64::from(elevation).to_radians().sin()) / 3.0;
        vec![[luminance, 0.0, 0.0]; 361]
    };
    let toward = |[azimuth, elevation]: [f64; 2]| {
        let [a, e] = [azimuth, elevation].map(f64::to_radians);
        [e.cos() * a.sin(), e.sin(), -e.cos() * a.cos()]
    };
    let sun = |k: usize| {
        let (place, lux) = SUNS[k];
        let mut channels = [0.0; 3];
        channels[k + 1] = lux;
        [toward(place), channels].concat()
    };
    let albedo = [room.ground, 0.0, room.ground];
    let (place, lux) = SUNS[1];
    let far = [
        room.ground * SKY / PI,
        0.0,
        room.ground * lux * toward(place)[1] / PI,
    ];
    let panes: Vec<Vec<f64>> = (quad(WINDOW[0], WINDOW[1], WINDOW[2]).iter())
        .map(|corners| {
            let numbers = corners.iter().flat_map(|c| c.to_array());
            numbers.chain([transmissivity()]).collect()
        })
        .collect();
    let up = |p: &DVec3| json!([p.x, p.y, p.z, 0.0, 1.0, 0.0]);
    json!({
        "triangles": triangles,
        "materials": room.reflectances.iter().map(|r| r.to_array()).collect::<Vec<_>>(),
        "sky": (0..=90).map(row).collect::<Vec<_>>(),
        "suns": [sun(0), sun(1)],
        "ground": { "height": -0.2, "albedo": albedo, "extent": 60.0, "far": far },
        "panes": panes,
        "points": room.points.iter().map(up).collect::<Vec<_>>(),
        "ab": 40,
        "ad": 32_768,
        "repeats": vec![REPEATS; room.points.len()],
    })
}

/// The truth of one sheet, and of two under the sky.
pub const TRUTH: &str = "glazed.csv";
pub const DOUBLE: &str = "double_glazed.csv";

fn truth_file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/truth")
        .join(name)
}

/// The rows of a stored truth.
pub fn rows(name: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(truth_file(name)).expect("the truth is stored");
    let numbers = |line: &str| {
        line.split(',')
            .map(|v| v.parse().expect("a number"))
            .collect()
    };
    let rows = text.lines().filter(|line| !line.starts_with(['#', 'x']));
    rows.map(numbers).collect()
}

/// What two sheets let through of natural light at an angle [rad], of which each leaves 0.9 of light on one way: with each
/// polarisation passing both (Stokes 1862), and with light behind the first taken for natural again.
pub fn double(angle: f64) -> [f64; 2] {
    let n = 1.52;
    let (c, inside) = (angle.cos(), (1.0 - (angle.sin() / n).powi(2)).sqrt());
    let a = 0.9_f64.powf(1.0 / inside);
    let sheet = |t: f64| {
        let r = 1.0 - t;
        let through = t * t * a / (1.0 - (r * a).powi(2));
        [through, r + r * a * through]
    };
    let across = sheet(4.0 * n * c * inside / (c + n * inside).powi(2));
    let along = sheet(4.0 * n * c * inside / (n * c + inside).powi(2));
    let both = |[t, r]: [f64; 2]| t * t / (1.0 - r * r);
    let natural = [0, 1].map(|k: usize| 0.5 * (across[k] + along[k]));
    [0.5 * (both(across) + both(along)), both(natural)]
}

/// Makes the truth and stores it.
pub fn make(test: &str, room: &Room) -> Option<()> {
    let text = super::python(test, "rtrace.py", &task(room).to_string())?;
    let out: Value = serde_json::from_str(&text).expect("rtrace.py prints JSON");
    let rows =
        |name: &str| -> Vec<[f64; 3]> { serde_json::from_value(out[name].clone()).expect("rows") };
    let mut text = format!(
        "# furnished room behind glass: illuminance [lx] by each of three lights, in {:.0} s\n# {}\n",
        out["seconds"].as_f64().expect("a time"),
        out["command"].as_str().expect("a command"),
    );
    let error = |(mean, spread): (&[f64; 3], &[f64; 3])| {
        (0..3)
            .map(|k| spread[k] / mean[k] / f64::from(REPEATS).sqrt())
            .fold(0.0, f64::max)
    };
    let (means, spreads) = (rows("illuminances"), rows("spread"));
    let worst = means.iter().zip(&spreads).map(error).fold(0.0, f64::max);
    writeln!(
        text,
        "# standard error of the worst point {:.2} %",
        100.0 * worst
    )
    .expect("text");
    text += "x,y,z,sky,sun in the window,sun from the north-east\n";
    for (p, [a, b, c]) in room.points.iter().zip(means) {
        writeln!(
            text,
            "{:.4},{:.4},{:.4},{a:.3},{b:.3},{c:.3}",
            p.x, p.y, p.z
        )
        .expect("text");
    }
    std::fs::write(truth_file(TRUTH), text).expect("the truth can be written");
    Some(())
}
