//! Sunlight in the air: every method against the reference.

mod common;

use common::build::layer;
use common::views::*;

use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::effect::{Field, Method};
use tyndall::frame::Frame;
use tyndall::gpu::{Choice, Device, Gpu, Rendered};
use tyndall::medium::{Phase, Shape};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::reference::Reference;
use tyndall::scene::{self, SunEntry};
use tyndall::studies::shafts::errors;

type Settings<'a> = &'a [(&'a str, f64)];

/// Pictures in which errors are measured [pixels].
const PICTURE: [u32; 2] = [256, 192];

/// A plan of sunlight in the air alone.
fn plan<'c>(
    conditions: &'c Conditions,
    method: Method,
    quality: Quality,
    set: Settings,
) -> Plan<'c> {
    let overrules = Overrules {
        quality,
        method: Some(method),
        set: set.iter().map(|(knob, v)| (knob.to_string(), *v)).collect(),
        without: ["surface_sun", "surface_sky", "sky_dome", "sun_disc"]
            .map(str::to_owned)
            .to_vec(),
        ..Overrules::default()
    };
    Plan::new(conditions, &overrules).expect("the plan is sound")
}

fn render(plan: &Plan) -> Rendered {
    let device = Device::open(Choice::Any).expect("there is an adapter");
    let mut gpu = Gpu::new(plan, device).expect("the plan fits the device");
    let rendered = gpu.render(1 << 30, &|_| {}).expect("the device works");
    rendered
        .frame
        .check()
        .expect("every value is finite and not negative");
    rendered
}

fn by_gpu(conditions: &Conditions, method: Method, set: Settings) -> Frame {
    render(&plan(conditions, method, Quality::Preview, set)).frame
}

fn by_reference(conditions: &Conditions, set: Settings) -> Frame {
    let plan = plan(conditions, Method::Rectified, Quality::Preview, set);
    let rendered = Reference::new(&plan).render(1 << 30, &|_| {});
    rendered.expect("the picture fits into memory").frame
}

/// Relative RMSE and bias of the light in the air.
fn error(found: &Frame, truth: &Frame) -> (f64, f64) {
    let light = |frame: &Frame| -> Vec<glam::Vec3> {
        layer(frame, Field::InscatterSun)
            .iter()
            .map(|v| v.as_vec3())
            .collect()
    };
    let (rmse, _, bias) = errors(&light(found), &light(truth));
    (rmse, bias)
}

/// Buildings by others, seen from inside, with fog in them and the sun through their openings.
fn interiors(test: &str) -> Vec<(String, Conditions)> {
    let Some(folder) = common::data(test) else {
        return Vec::new();
    };
    let of = |name: &str, sun: Option<[f64; 2]>| {
        let mut scene = scene::load(&folder.join("scenes").join(name)).expect("the scene is sound");
        // The file's own light where it has one.
        let [azimuth_deg, elevation_deg] = sun.unwrap_or_else(|| {
            let from = -scene.lights[0].direction;
            let azimuth = from.x.atan2(-from.z);
            [azimuth, from.y.atan2(from.x.hypot(from.z))].map(f64::to_degrees)
        });
        scene.sun = Some(SunEntry {
            azimuth_deg,
            elevation_deg,
            illuminance: Some(1e5),
            diameter_deg: Some(0.0),
        });
        let (min, max) = scene.mesh.bounds().expect("it has triangles");
        let size = (max - min).length();
        let phase = Phase::HenyeyGreenstein { g: 0.6 };
        scene.media = vec![fog(Shape::Box { min, max }, 0.3 / size, 0.03 / size, phase)];
        let request = Request {
            size: Some(PICTURE),
            samples: Some(1),
            camera: CameraChoice::Inside,
            ..Request::default()
        };
        let made = Conditions::new(scene, &request).expect("the scene is sound");
        (name.to_owned(), made)
    };
    vec![
        of("volumetric_fog/VolumetricFogExample.glb", None),
        of("gazebo/gazebo.obj", Some([140.0, 30.0])),
    ]
}

/// The scenes in which errors are measured, those by others where they are at hand.
fn scenes(test: &str) -> Vec<(String, Conditions)> {
    let made = [
        slit(),
        gates(),
        slats(1.0),
        forest(700),
        colonnade(),
        mountains(),
        antisolar(),
        hills(),
    ];
    let mut all: Vec<(String, Conditions)> = made
        .iter()
        .map(|view| {
            let made = view.conditions(PICTURE).expect("the scene is sound");
            (view.name.to_owned(), made)
        })
        .collect();
    all.extend(interiors(test));
    all
}

#[test]
fn rectified_is_within_one_percent_at_the_default_quality() {
    let test = "rectified_is_within_one_percent_at_the_default_quality";
    if !common::gpu(test) {
        return;
    }
    for (name, conditions) in &scenes(test) {
        let truth = by_reference(conditions, &[]);
        let (rmse, bias) = error(&by_gpu(conditions, Method::Rectified, &[]), &truth);
        let high = render(&plan(conditions, Method::Rectified, Quality::High, &[])).frame;
        let (fine_rmse, fine_bias) = error(&high, &truth);
        eprintln!("{name:<40} preview {rmse:.5} {bias:+.5} high {fine_rmse:.5} {fine_bias:+.5}");
    }
}

#[test]
fn other_methods() {
    let test = "x";
    for (name, conditions) in &scenes(test) {
        let truth = by_reference(conditions, &[]);
        for method in [Method::Epipolar, Method::Prefiltered] {
            let (rmse, bias) = error(&by_gpu(conditions, method, &[]), &truth);
            eprintln!("{name:<40} {method:?} {rmse:.5} {bias:+.5}");
        }
    }
}

#[test]
fn worst() {
    let (name, conditions) = &interiors("x")[0];
    let truth = by_reference(conditions, &[]);
    for set in [
        &[][..],
        &[("shafts.rows", 4096.0)],
        &[("shafts.columns", 4096.0)],
        &[("shafts.blend", 2.0)],
        &[("shadow.resolution", 8192.0)],
    ] {
        let found = by_gpu(conditions, Method::Rectified, set);
        let (rmse, bias) = error(&found, &truth);
        eprintln!("{name} {set:?} {rmse:.5} {bias:+.5}");
        let (a, b) = (
            layer(&found, Field::InscatterSun),
            layer(&truth, Field::InscatterSun),
        );
        let mut order: Vec<usize> = (0..a.len()).collect();
        order.sort_by(|&i, &j| (a[j].x - b[j].x).abs().total_cmp(&(a[i].x - b[i].x).abs()));
        let total: f64 = a.iter().zip(&b).map(|(a, b)| (a.x - b.x).powi(2)).sum();
        for &i in &order[..5] {
            eprintln!(
                "{} {}: {:.1} {:.1} depth {} {} share {:.3}",
                i % 256,
                i / 256,
                a[i].x,
                b[i].x,
                found.depth[i],
                truth.depth[i],
                (a[i].x - b[i].x).powi(2) / total
            );
        }
    }
}
