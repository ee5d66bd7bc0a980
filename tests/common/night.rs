//! Scenes that lamps alone light, and their pictures.

use super::build::{conditions, cuboid, scene};
use glam::{DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::backend::reference::Reference;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::conditions::{Conditions, Receiver, View};
use tyndall::effect::Field;
use tyndall::frame::Frame;
use tyndall::medium::{Medium, Phase, Shape};
use tyndall::photometry::Distribution;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, LampEntry, LampForm, Scene};
use tyndall::studies::scenes::{Corners, fog};

pub const DEG: f64 = PI / 180.0;

pub fn lamp(position: DVec3, candela: f64, distribution: Distribution) -> LampEntry {
    LampEntry {
        name: "lamp".into(),
        position,
        toward: DVec3::NEG_Y,
        around: None,
        intensity: DVec3::splat(candela),
        distribution,
        form: LampForm::Point,
        ignore: None,
    }
}

pub fn spot(spread_deg: f64, sharpness: f64) -> Distribution {
    Distribution::NishitaSpot {
        spread: spread_deg * DEG,
        sharpness,
    }
}

/// Triangles lit by lamps alone.
pub fn night(triangles: &[Corners], lamps: Vec<LampEntry>) -> Scene {
    let mut scene = scene(triangles, 0.0, 0.0);
    scene.sun = None;
    scene.lamps = lamps;
    scene
}

/// A speck far below, so that there is a mesh.
pub fn nothing() -> Vec<Corners> {
    cuboid(dvec3(0.0, -1e3, 0.0), dvec3(0.01, -999.99, 0.01))
}

pub fn box_of_fog(half: f64, scattering: f64, absorption: f64, phase: Phase) -> Medium {
    fog(
        Shape::Box {
            min: DVec3::splat(-half),
            max: DVec3::splat(half),
        },
        scattering,
        absorption,
        phase,
    )
}

pub fn rendered(conditions: &Conditions, quality: Quality, set: &[(&str, f64)]) -> Frame {
    rendered_without(&[], conditions, quality, set)
}

pub fn rendered_without(
    effects: &[&str],
    conditions: &Conditions,
    quality: Quality,
    set: &[(&str, f64)],
) -> Frame {
    let overrules = Overrules {
        without: effects.iter().map(|name| name.to_string()).collect(),
        quality,
        set: set.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let reference = Reference::new(&plan).expect("it can be prepared");
    let rendered = reference.render(&Limits::default(), &|_| {});
    let frame = rendered.expect("it fits into memory").frame;
    frame.check().expect("every value is sound");
    frame
}

/// A hall of posts around a lamp.
pub fn posts() -> Vec<Corners> {
    let mut triangles = cuboid(dvec3(-5.0, -0.2, -5.0), dvec3(5.0, 0.0, 5.0));
    for i in 0..8 {
        let (z, x) = (f64::from(i) * PI / 4.0 + 0.1).sin_cos();
        let at = 2.0 * dvec3(x, 0.0, z);
        triangles.extend(cuboid(
            at - dvec3(0.15, 0.0, 0.1),
            at + dvec3(0.15, 2.5, 0.1),
        ));
    }
    triangles
}

/// What lamps give to points that face a direction [lx], green.
pub fn received(scene: Scene, points: &[(DVec3, DVec3)], wanted: Wanted, field: Field) -> Vec<f64> {
    let receivers: Vec<Receiver> = points
        .iter()
        .map(|(p, n)| Receiver::new(*p, *n).expect("they are sound"))
        .collect();
    let seen = conditions(
        scene,
        Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0),
        [8, 8],
    );
    let seen = seen
        .seen_from(View::of_points(receivers))
        .expect("points are sound");
    let overrules = Overrules {
        quality: Quality::High,
        ..Overrules::default()
    };
    let plan = Plan::new(&seen, &overrules).expect("the plan is sound");
    let mut backend = Backend::open(wanted).expect("there is one");
    let rendered = backend.render(&plan, &Limits::default(), &|_| {});
    let frame = rendered.expect("it can be rendered").frame;
    let found = frame.layer(field.name());
    (0..points.len())
        .map(|i| found.map_or(0.0, |layer| f64::from(layer.rgb[i][1])))
        .collect()
}
