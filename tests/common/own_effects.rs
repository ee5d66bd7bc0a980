//! Effects that tests bring: planned with those of the project, rendered on both backends.

use super::build::scene;
use super::shafts::gpu;
use glam::DVec3;
use std::f64::consts::PI;
use tyndall::backend::reference::Reference;
use tyndall::backend::{Limits, Rendered};
use tyndall::conditions::Conditions;
use tyndall::effect::{ALL, Effect};
use tyndall::medium::{Phase, Shape};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, Scene};
use tyndall::studies::scenes::{cuboid, fog};

/// The effects of the project with others before that which takes light through the air to the eye.
pub fn with(own: &[&'static Effect]) -> Vec<&'static Effect> {
    let compose = ALL.iter().position(|effect| effect.name == "compose");
    let (before, after) = ALL.split_at(compose.expect("there is compose"));
    [before, own, after].concat()
}

pub fn plan<'c>(
    conditions: &'c Conditions,
    own: &[&'static Effect],
    set: &[(&str, f64)],
) -> Plan<'c> {
    let overrules = Overrules {
        quality: Quality::Draft,
        set: set.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    Plan::with(conditions, &overrules, &with(own)).expect("the effects fit together")
}

pub fn on_gpu(plan: &Plan) -> Rendered {
    let rendered = gpu().render(plan, &Limits::default(), &|_| {});
    let rendered = rendered.expect("the device works");
    rendered.frame.check().expect("every value is sound");
    rendered
}

pub fn by_reference(plan: &Plan) -> Rendered {
    let rendered = Reference::new(plan)
        .expect("it can be prepared")
        .render(&Limits::default(), &|_| {});
    rendered.expect("it fits into memory")
}

pub fn runs(rendered: &Rendered, pass: &str) -> u32 {
    let step = rendered.steps.iter().find(|step| step.pass == pass);
    step.expect("the pass is there").runs
}

/// A floor and a roof over a part of it, with a place and a time.
pub fn shelter() -> Scene {
    let mut triangles = cuboid(DVec3::new(-4.0, -0.2, -4.0), DVec3::new(4.0, 0.0, 4.0));
    triangles.extend(cuboid(
        DVec3::new(-2.0, 2.0, -2.0),
        DVec3::new(0.0, 2.1, 2.0),
    ));
    let mut scene = scene(&triangles, 140.0, 50.0);
    scene.ground.enabled = false;
    scene
}

pub fn camera() -> Camera {
    Camera::look_at(
        DVec3::new(0.5, 1.2, 6.0),
        DVec3::new(0.0, 1.0, 0.0),
        60.0 * PI / 180.0,
    )
}

/// A slotted roof between the lamp and the floor, in fog.
pub fn lamp_scene() -> Scene {
    let mut triangles = cuboid(DVec3::new(-4.0, -0.2, -4.0), DVec3::new(4.0, 0.0, 4.0));
    for i in 0..6 {
        let x = -2.0 + 0.8 * f64::from(i);
        triangles.extend(cuboid(
            DVec3::new(x, 1.6, -1.5),
            DVec3::new(x + 0.4, 1.7, 1.5),
        ));
    }
    let mut scene = scene(&triangles, 140.0, 50.0);
    scene.ground.enabled = false;
    let shape = Shape::Box {
        min: DVec3::new(-4.0, 0.0, -4.0),
        max: DVec3::new(4.0, 4.0, 4.0),
    };
    scene.media = vec![fog(shape, 0.08, 0.02, Phase::HenyeyGreenstein { g: 0.4 })];
    scene
}

/// Relative RMSE over the second channel.
pub fn apart(found: &[DVec3], truth: &[DVec3]) -> f64 {
    let mean = truth.iter().map(|v| v.y).sum::<f64>() / truth.len() as f64;
    let square = found.iter().zip(truth).map(|(a, b)| (a.y - b.y).powi(2));
    (square.sum::<f64>() / truth.len() as f64).sqrt() / mean
}
