//! Lamps on a device: its own shadow rays and fans in f32 against the reference's in f64.

mod common;

use common::build::*;
use common::night::*;
use common::shafts;
use glam::{DVec3, dvec3};
use std::sync::Arc;
use tyndall::backend::reference::Reference;
use tyndall::backend::{Limits, Rendered};
use tyndall::conditions::Conditions;
use tyndall::effect::Field;
use tyndall::medium::{Phase, Shape};
use tyndall::photometry::{Distribution, Goniometer, Table};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, LampEntry, LampForm};
use tyndall::studies::scenes::fog;

/// Lamps alone, without what their light does further.
fn plan<'c>(seen: &'c Conditions, quality: Quality, set: &[(&str, f64)]) -> Plan<'c> {
    let overrules = Overrules {
        quality,
        without: ["radiosity", "air_sky"].map(str::to_owned).to_vec(),
        set: set.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    Plan::new(seen, &overrules).expect("the plan is sound")
}

fn on_device(plan: &Plan) -> Rendered {
    let rendered = shafts::gpu().render(plan, &Limits::default(), &|_| {});
    let rendered = rendered.expect("the device works");
    rendered.frame.check().expect("every value is sound");
    rendered
}

fn by_reference(plan: &Plan) -> Rendered {
    let reference = Reference::new(plan).expect("it can be prepared");
    let rendered = reference.render(&Limits::default(), &|_| {});
    rendered.expect("it fits into memory")
}

/// Whether passes do an effect, and all of it.
fn is_by_passes(rendered: &Rendered, effect: &str) -> bool {
    let mut steps = rendered.steps.iter().filter(|s| s.effect.name == effect);
    steps.all(|step| !step.on_cpu) && rendered.steps.iter().any(|s| s.effect.name == effect)
}

/// The share of pixels at shadow edges, where one shows light and the other does not, and the relative RMSE of all others.
fn apart(found: &[DVec3], truth: &[DVec3]) -> [f64; 2] {
    let mean = truth.iter().map(|v| v.y).sum::<f64>() / truth.len() as f64;
    assert!(mean > 0.0);
    let off = |(a, b): (&DVec3, &DVec3)| (*a - *b).abs().max_element() / mean;
    let (edges, rest): (Vec<f64>, Vec<f64>) = found
        .iter()
        .zip(truth)
        .map(off)
        .partition(|off| *off > 0.02);
    let square: f64 = rest.iter().map(|off| off * off).sum();
    [
        edges.len() as f64 / truth.len() as f64,
        (square / rest.len().max(1) as f64).sqrt(),
    ]
}

/// Every plane and every angle of it differs.
fn table(goniometer: Goniometer) -> Distribution {
    let (across, up): (Vec<f64>, Vec<f64>) = match goniometer {
        Goniometer::C => (
            vec![0.0, 90.0, 180.0, 270.0, 360.0],
            vec![0.0, 20.0, 45.0, 80.0, 120.0],
        ),
        Goniometer::A => (
            vec![-90.0, -30.0, 0.0, 45.0, 90.0],
            vec![-60.0, -10.0, 0.0, 30.0, 70.0],
        ),
        Goniometer::B => (
            vec![-80.0, -30.0, 0.0, 45.0, 70.0],
            vec![-90.0, -10.0, 0.0, 30.0, 120.0],
        ),
    };
    let candela = (0..25).map(|i| {
        let (plane, row) = (i / 5, i % 5);
        let plane = if goniometer == Goniometer::C {
            plane % 4
        } else {
            plane
        };
        f64::from(60 + 35 * plane - 11 * row + 7 * (plane * row % 3))
    });
    let table = Table::new(goniometer, across, up, candela.collect());
    Distribution::Table(Arc::new(table.expect("it is sound")))
}

fn patterns() -> Vec<(&'static str, Distribution)> {
    vec![
        ("even", Distribution::Isotropic),
        ("spot", spot(50.0, 0.25)),
        (
            "daisy",
            Distribution::Daisy {
                spread: 75.0 * DEG,
                sharpness: 0.25,
                petals: 9,
                ratio: -0.3,
            },
        ),
        (
            "dots",
            Distribution::PolkaDots {
                spread: 70.0 * DEG,
                sharpness: 0.5,
                petals: 8,
                ratio: -0.2,
                rings: 4,
            },
        ),
        (
            "headlight",
            Distribution::Elliptical {
                spread: [70.0 * DEG, 30.0 * DEG],
                sharpness: 0.2,
            },
        ),
        (
            "wide",
            Distribution::Elliptical {
                spread: [100.0 * DEG, 140.0 * DEG],
                sharpness: 0.2,
            },
        ),
        (
            "cone",
            Distribution::Cone {
                inner: 20.0 * DEG,
                outer: 50.0 * DEG,
            },
        ),
        ("type A", table(Goniometer::A)),
        ("type B", table(Goniometer::B)),
        ("type C", table(Goniometer::C)),
    ]
}

fn hall_camera() -> Camera {
    Camera::look_at(dvec3(0.6, 1.7, 8.5), dvec3(0.0, 1.2, 0.0), 50.0 * DEG)
}

fn hung(distribution: Distribution) -> LampEntry {
    LampEntry {
        toward: dvec3(0.3, -1.0, 0.4),
        around: Some(dvec3(0.2, 0.1, 1.0)),
        ..lamp(dvec3(0.2, 2.2, -0.1), 100.0, distribution)
    }
}

/// What is off, by layer, of a scene whose lamps the device must do itself.
fn off(seen: &Conditions, quality: Quality, set: &[(&str, f64)], field: Field) -> [f64; 2] {
    let plan = plan(seen, quality, set);
    let rendered = on_device(&plan);
    let effect = match field {
        Field::Lights => "surface_lamps",
        _ => "air_lamps",
    };
    assert!(is_by_passes(&rendered, effect), "{:?}", rendered.steps);
    let truth = by_reference(&plan);
    apart(&layer(&rendered.frame, field), &layer(&truth.frame, field))
}

#[test]
fn surfaces_among_posts_get_what_the_reference_says() {
    if !common::gpu("surfaces_among_posts_get_what_the_reference_says") {
        return;
    }
    for (name, distribution) in patterns() {
        let mut scene = night(&posts(), vec![hung(distribution)]);
        scene.media = vec![box_of_fog(4.0, 0.1, 0.03, Phase::Isotropic)];
        let seen = conditions(scene, hall_camera(), [64, 48]);
        let [edges, rest] = off(&seen, Quality::Preview, &[], Field::Lights);
        eprintln!(
            "{name}: {:.2} % at edges, {:.5} %",
            100.0 * edges,
            100.0 * rest
        );
        // A shadow's edge that passes a pixel's middle by a rounding; f32 has 6e-8, angles by its functions 2e-5.
        assert!(edges < 0.002 && rest < 5e-4, "{name}: {edges} {rest}");
    }
}

#[test]
fn lamps_with_an_extent_are_divided_as_by_the_reference() {
    if !common::gpu("lamps_with_an_extent_are_divided_as_by_the_reference") {
        return;
    }
    let at = dvec3(0.2, 2.2, -0.1);
    let forms = [
        LampForm::Line {
            to: at + dvec3(0.7, 0.2, 0.3),
        },
        LampForm::Rectangle {
            edges: [dvec3(0.5, 0.0, 0.1), dvec3(0.0, 0.1, 0.6)],
        },
        LampForm::Sphere { radius: 0.2 },
    ];
    for form in forms {
        let lamp = LampEntry {
            form,
            ..lamp(at, 100.0, spot(80.0, 0.5))
        };
        let seen = conditions(night(&posts(), vec![lamp]), hall_camera(), [48, 36]);
        let plan = plan(&seen, Quality::Preview, &[]);
        let found = on_device(&plan);
        let truth = by_reference(&plan);
        let [edges, rest] = apart(
            &layer(&found.frame, Field::Lights),
            &layer(&truth.frame, Field::Lights),
        );
        eprintln!(
            "{form:?}: {:.2} % at edges, {:.4} %; {:?}",
            100.0 * edges,
            100.0 * rest,
            found.notes
        );
        // Both stop dividing where parts differ by 0.5 % of the lamp, at places of their own.
        assert!(edges < 0.01 && rest < 3e-3, "{form:?}: {edges} {rest}");
    }
}
