//! Small scenes in code, and pictures of them.

use glam::DVec3;
use tyndall::backend::Limits;
use tyndall::backend::reference::Reference;
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::effect::Field;
use tyndall::frame::Frame;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, Scene};
#[allow(unused_imports)] // not every test needs each
pub use tyndall::studies::scenes::{cuboid, material, quad, scene};

/// The conditions of a scene seen by a camera.
pub fn conditions(scene: Scene, camera: Camera, size: [u32; 2]) -> Conditions {
    let request = Request {
        size: Some(size),
        samples: Some(1),
        camera: CameraChoice::Given(camera),
        ..Request::default()
    };
    Conditions::new(scene, &request).expect("the scene is sound")
}

/// Light between surfaces and in the air as at `preview`: tests of their own hold it to its truth, and at the finest quality it would
/// take them minutes.
const PREVIEW: &[(&str, f64)] = &[
    ("radiosity.rays", 256.0),
    ("radiosity.outline", 0.02),
    ("radiosity.patch", 0.125),
    ("radiosity.patches", 4e3),
    ("radiosity.patch_rays", 2e5),
    ("radiosity.patch_spots", 0.0),
    ("radiosity.bend", 0.06),
    ("air_sky.columns", 16.0),
    ("air_sky.spacing", 0.25),
    ("air_sky.difference", 0.015),
    ("air_sky.rays", 100.0),
    ("air_sky.outline", 0.1),
];

/// The least of it.
pub const LEAST: &[(&str, f64)] = &[
    ("radiosity.sky", 1.0),
    ("radiosity.rays", 16.0),
    ("radiosity.outline", 1.0),
    ("radiosity.patches", 64.0),
    ("radiosity.patch_rays", 1e3),
    ("radiosity.bend", 1.0),
    ("air_sky.rays", 16.0),
    ("air_sky.outline", 1.0),
];

/// A picture at the finest quality, but for the light of [`PREVIEW`].
pub fn render(conditions: &Conditions) -> Frame {
    render_at(conditions, Quality::Reference, PREVIEW)
}

/// A picture, all of whose values have been checked to be finite and not negative.
pub fn render_at(conditions: &Conditions, quality: Quality, set: &[(&str, f64)]) -> Frame {
    let overrules = Overrules {
        quality,
        set: set.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let frame = Reference::new(&plan)
        .expect("it can be prepared")
        .render(&Limits::memory(1 << 30), &|_| {})
        .expect("the picture fits into memory")
        .frame;
    frame
        .check()
        .expect("every value is finite and not negative");
    frame
}

/// A layer of a picture; zeros where it was not made.
pub fn layer(frame: &Frame, field: Field) -> Vec<DVec3> {
    match frame.layer(field.name()) {
        Some(layer) => layer.rgb.iter().map(|v| v.as_dvec3()).collect(),
        None => vec![DVec3::ZERO; frame.pixels()],
    }
}

/// Relative RMSE: sqrt(mean((a - b)^2)) / mean(b), over the first channel.
pub fn relative_rmse(a: &[DVec3], b: &[DVec3]) -> f64 {
    let n = a.len() as f64;
    let mean = b.iter().map(|v| v.x).sum::<f64>() / n;
    let square = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a.x - b.x).powi(2))
        .sum::<f64>()
        / n;
    square.sqrt() / mean
}
