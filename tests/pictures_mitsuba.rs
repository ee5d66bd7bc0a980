//! Pictures without media against Mitsuba's path tracer: an interior and a street, sun, sky and all that surfaces reflect.
//!
//! Both programs have the same rays, through the middles of pixels. The truths stand in `tests/truth`;
//! `TYNDALL_TRUTHS=interior,street cargo test --release --test pictures_mitsuba` makes them anew (minutes).

mod common;

use common::build::{conditions, layer};
use common::judge::world;
use common::rooms::{Room, WEATHER, Weather, interior, street};
use glam::{DVec2, DVec3, dvec3};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::colour::luminance;
use tyndall::conditions::Conditions;
use tyndall::effect::Field;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::Camera;

/// The size of the pictures [pixels].
const SIZE: [u32; 2] = [60, 40];
/// Mean relative difference of the means of 2 by 2 pixels.
const ALLOWED: f64 = 0.02;

/// A room or a street, and what sees it.
struct Shot {
    name: &'static str,
    room: Room,
    weather: Weather,
    camera: Camera,
    /// Paths of each pixel in each half of a truth.
    samples: u32,
}

fn shots() -> [Shot; 2] {
    let fov = 65f64.to_radians();
    [
        Shot {
            name: "interior",
            room: interior(),
            weather: WEATHER[2],
            camera: Camera::look_at(dvec3(3.6, 1.7, -0.4), dvec3(1.2, 0.9, -5.0), fov),
            samples: 12_288,
        },
        Shot {
            name: "street",
            room: street(),
            weather: WEATHER[2],
            camera: Camera::look_at(dvec3(1.0, 1.8, 9.0), dvec3(-0.4, 3.6, -20.0), fov),
            samples: 4096,
        },
    ]
}

impl Shot {
    fn conditions(&self) -> Conditions {
        conditions(self.room.under(&self.weather), self.camera, SIZE)
    }
}

/// The radiance of every pixel [cd/m2, RGB] and the seconds that it took.
fn picture(conditions: &Conditions, backend: Wanted) -> (Vec<DVec3>, f64) {
    let overrules = Overrules {
        quality: Quality::High,
        ..Overrules::default()
    };
    let begin = Instant::now();
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let mut backend = Backend::open(backend).expect("there is one");
    let rendered = backend.render(&plan, &Limits::default(), &|_| {});
    let frame = rendered.expect("it works").frame;
    frame.check().expect("every value is sound");
    let fields = [Field::Sun, Field::Sky, Field::Indirect, Field::Background];
    let layers = fields.map(|field| layer(&frame, field));
    let sum = |i: usize| layers.iter().map(|layer| layer[i]).sum();
    (
        (0..frame.pixels()).map(sum).collect(),
        begin.elapsed().as_secs_f64(),
    )
}

/// Luminances of means of 2 by 2 pixels, in which the truth's noise is half of its pixels'.
fn blocks(picture: &[DVec3]) -> Vec<f64> {
    let [width, height] = SIZE.map(|s| s as usize);
    let block = |i: usize| {
        let (x, y) = (2 * (i % (width / 2)), 2 * (i / (width / 2)));
        let at = |dx: usize, dy: usize| luminance(picture[(y + dy) * width + x + dx]);
        0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1))
    };
    (0..width * height / 4).map(block).collect()
}

/// Mean of the relative differences, and relative difference of the means.
fn apart(found: &[DVec3], truth: &[DVec3]) -> (f64, f64) {
    let (found, truth) = (blocks(found), blocks(truth));
    let off = found.iter().zip(&truth).map(|(f, t)| (f / t - 1.0).abs());
    let mean = off.sum::<f64>() / truth.len() as f64;
    (
        mean,
        found.iter().sum::<f64>() / truth.iter().sum::<f64>() - 1.0,
    )
}

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/truth/picture_{name}.csv"))
}

/// Makes a truth and stores it; `None` where there is no Mitsuba.
fn make(test: &str, shot: &Shot) -> Option<()> {
    let conditions = shot.conditions();
    let mut task = world(&shot.room, std::slice::from_ref(&conditions));
    let ray = |i: u32| {
        let at = DVec2::new(f64::from(i % SIZE[0]), f64::from(i / SIZE[0])) + 0.5;
        let ray = conditions.view.ray(at);
        [ray.origin.to_array(), ray.direction.to_array()].concat()
    };
    task["rays"] = (0..SIZE[0] * SIZE[1]).map(ray).collect::<Vec<_>>().into();
    task["samples"] = json!(shot.samples);
    task["depth"] = json!(64);
    let text = common::python(test, "path_tracer.py", &task.to_string())?;
    let out: Value = serde_json::from_str(&text).expect("path_tracer.py prints JSON");
    let halves: [Vec<[f64; 3]>; 2] =
        serde_json::from_value(out["halves"].clone()).expect("two halves");
    let [a, b] = halves.map(|half| half.into_iter().map(DVec3::from).collect::<Vec<_>>());
    let both: Vec<DVec3> = a.iter().zip(&b).map(|(a, b)| 0.5 * (*a + *b)).collect();
    let (noise, drift) = apart(&a, &both);
    let mut text = format!(
        "# {}: {} by {} pixels row by row, radiance [cd/m2] by Mitsuba's `path`, 2 times {} paths a pixel, {:.0} s\n\
         # one half from both: mean relative difference {:.3} %, of the means {:+.3} %\nred,green,blue\n",
        shot.name,
        SIZE[0],
        SIZE[1],
        shot.samples,
        out["seconds"].as_f64().expect("a time"),
        100.0 * noise,
        100.0 * drift
    );
    eprintln!("{}: noise {:.3} %", shot.name, 100.0 * noise);
    assert!(noise < ALLOWED / 3.0, "this is no truth: {noise}");
    for v in &both {
        let _ = writeln!(text, "{:.4e},{:.4e},{:.4e}", v.x, v.y, v.z);
    }
    std::fs::write(file(shot.name), text).expect("the truth can be written");
    Some(())
}

fn stored(name: &str) -> Vec<DVec3> {
    let text = std::fs::read_to_string(file(name))
        .unwrap_or_else(|_| panic!("{name} has no truth: see the top of this file"));
    let rows = text.lines().filter(|l| !l.starts_with(['#', 'r']));
    rows.map(|line| {
        let numbers: Vec<f64> = line
            .split(',')
            .map(|v| v.parse().expect("a number"))
            .collect();
        DVec3::from_slice(&numbers)
    })
    .collect()
}

#[test]
fn pictures_are_those_of_a_path_tracer() {
    let test = "pictures_are_those_of_a_path_tracer";
    let asked = std::env::var("TYNDALL_TRUTHS").unwrap_or_default();
    let mut failures = Vec::new();
    for shot in shots() {
        let wanted = asked == "all" || asked.split(',').any(|n| n == shot.name);
        if wanted && make(test, &shot).is_none() {
            return;
        }
        let truth = stored(shot.name);
        let (found, seconds) = picture(&shot.conditions(), Wanted::Reference);
        let (off, of_means) = apart(&found, &truth);
        eprintln!(
            "{}: mean relative difference {:.3} %, of the means {:+.3} %, {seconds:.1} s",
            shot.name,
            100.0 * off,
            100.0 * of_means
        );
        if off > ALLOWED {
            failures.push(format!("{}: {off:.4}", shot.name));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn another_colour_or_another_hour_is_noticed() {
    let shots = shots();
    let wrong = |shot: &Shot, room: Room, sun: [f64; 2]| Shot {
        name: shot.name,
        room,
        weather: Weather {
            sun,
            ..shot.weather
        },
        camera: shot.camera,
        samples: shot.samples,
    };
    let sun = WEATHER[2].sun;
    for shot in &shots {
        let truth = stored(shot.name);
        for other in [
            wrong(shot, shot.room.lighter(0.05), sun),
            wrong(shot, shot.room.clone(), [sun[0] - 4.0, sun[1]]),
        ] {
            let (found, _) = picture(&other.conditions(), Wanted::Reference);
            let (off, _) = apart(&found, &truth);
            eprintln!("{}: {:.3} %", shot.name, 100.0 * off);
            assert!(off > ALLOWED, "{}: {off}", shot.name);
        }
    }
}
