//! The GPU's pictures against the reference's.

mod common;

use common::build::*;
use glam::{DVec2, DVec3, UVec2};
use std::f64::consts::PI;
use tyndall::colour::luminance;
use tyndall::conditions::{Conditions, toward};
use tyndall::effect::Field;
use tyndall::frame::Frame;
use tyndall::gpu::{Choice, Device, Gpu, Rendered};
use tyndall::medium::{Medium, Phase, Shape};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::reference::Reference;
use tyndall::scene::{Camera, Projection, Scene};

const DEG: f64 = PI / 180.0;
const SIZE: [u32; 2] = [96, 64];

fn overrules(set: &[(&str, f64)]) -> Overrules {
    Overrules {
        quality: Quality::Draft,
        set: set.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    }
}

fn by_gpu(conditions: &Conditions, set: &[(&str, f64)]) -> Rendered {
    let plan = Plan::new(conditions, &overrules(set)).expect("the plan is sound");
    let device = Device::open(Choice::Any).expect("there is an adapter");
    let mut gpu = Gpu::new(&plan, device).expect("the plan fits the device");
    let rendered = gpu.render(1 << 30, &|_| {}).expect("the device works");
    rendered
        .frame
        .check()
        .expect("every value is finite and not negative");
    rendered
}

fn by_reference(conditions: &Conditions, set: &[(&str, f64)]) -> Frame {
    let plan = Plan::new(conditions, &overrules(set)).expect("the plan is sound");
    Reference::new(&plan)
        .render(1 << 30, &|_| {})
        .expect("it fits into memory")
        .frame
}

fn rmse(a: &[DVec3], b: &[DVec3], keep: impl Fn(usize) -> bool) -> f64 {
    let (mut square, mut mean, mut n) = (0.0, 0.0, 0.0);
    for i in (0..a.len()).filter(|i| keep(*i)) {
        square += (luminance(a[i]) - luminance(b[i])).powi(2);
        mean += luminance(b[i]);
        n += 1.0;
    }
    if square == 0.0 {
        0.0
    } else {
        (square / n).sqrt() / (mean / n)
    }
}

fn slats() -> Conditions {
    let mut triangles = Vec::new();
    for i in 0..14 {
        let x = -4.0 + 8.0 * f64::from(i) / 14.0;
        triangles.extend(cuboid(
            DVec3::new(x, 3.9, -5.0),
            DVec3::new(x + 0.3, 4.0, 5.0),
        ));
    }
    triangles.extend(quad(
        DVec3::new(-4.0, 0.0, -5.0),
        DVec3::Z * 10.0,
        DVec3::X * 8.0,
    ));
    triangles.extend(quad(
        DVec3::new(-4.0, 0.0, -5.0),
        DVec3::Y * 4.0,
        DVec3::X * 8.0,
    ));
    let mut scene = scene(&triangles, 65.0, 50.0);
    scene.media = vec![Medium {
        shape: Shape::Box {
            min: DVec3::new(-4.0, 0.0, -5.0),
            max: DVec3::new(4.0, 4.0, 5.0),
        },
        scattering: DVec3::splat(0.06),
        absorption: DVec3::splat(0.01),
        phase: Phase::HenyeyGreenstein { g: 0.5 },
    }];
    let camera = Camera::look_at(
        DVec3::new(0.5, 1.5, 4.5),
        DVec3::new(0.0, 1.6, -5.0),
        60.0 * DEG,
    );
    conditions(scene, camera, SIZE)
}

#[test]
fn explore() {
    let c = slats();
    let t = std::time::Instant::now();
    let r = by_reference(&c, &[]);
    eprintln!("reference {:?}", t.elapsed());
    for (steps, res) in [(64., 512.), (128., 1024.), (256., 2048.), (512., 4096.)] {
        let t = std::time::Instant::now();
        let g = by_gpu(&c, &[("shafts.steps", steps), ("shadow.resolution", res)]);
        eprintln!("gpu {:?} {:?}", t.elapsed(), g.traffic);
        if steps == 64. {
            for p in &g.passes {
                eprintln!("{p:?}");
            }
        }
        for f in Field::LAYERS {
            let (a, b) = (layer(&g.frame, f), layer(&r, f));
            eprintln!("{steps} {} {:.5}", f.name(), rmse(&a, &b, |_| true));
        }
        let dz = g
            .frame
            .depth
            .iter()
            .zip(&r.depth)
            .map(|(a, b)| ((a - b) / b).abs())
            .fold(0.0, f32::max);
        let nz = g
            .frame
            .depth
            .iter()
            .zip(&r.depth)
            .filter(|(a, b)| ((*a - *b) / *b).abs() > 1e-4)
            .count();
        eprintln!("depth {dz} {nz}");
    }
}
