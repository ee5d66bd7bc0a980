//! Illuminance at points with normals and no camera, against closed forms, on both backends.

mod common;

use common::build::{conditions as seen, layer, quad, scene};
use common::shafts;
use common::views::fog;
use glam::DVec3;
use std::f64::consts::PI;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::colour::luminance;
use tyndall::conditions::{Conditions, Receiver, View, toward};
use tyndall::effect::Field;
use tyndall::frame::Frame;
use tyndall::medium::{Phase, Shape};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, Scene};

const DEG: f64 = PI / 180.0;

/// One small triangle far below everything, since a scene must have one.
const SPECK: [[DVec3; 3]; 1] = [[
    DVec3::new(0.0, -50.0, 0.0),
    DVec3::new(1e-3, -50.0, 0.0),
    DVec3::new(0.0, -50.0, 1e-3),
]];

fn at(position: DVec3, normal: DVec3) -> Receiver {
    Receiver { position, normal }
}

/// Evenly spread numbers in 0 to 1 (Roberts 2018), three for each point.
fn spread(i: usize) -> DVec3 {
    let steps = DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478);
    (0.5 + i as f64 * steps).fract()
}

/// Unit vectors in all directions.
fn direction(i: usize) -> DVec3 {
    let u = spread(i);
    let y = 2.0 * u.x - 1.0;
    let (sin, cos) = (2.0 * PI * u.y).sin_cos();
    let level = (1.0 - y * y).sqrt();
    DVec3::new(level * cos, y, level * sin).normalize()
}

/// A scene at points.
fn conditions(scene: Scene, points: &[Receiver]) -> Conditions {
    let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0);
    let conditions = seen(scene, camera, [8, 8]);
    let view = View::of_points(points);
    conditions.seen_from(view).expect("the points are sound")
}

fn plan<'c>(conditions: &'c Conditions, set: &[(&str, f64)]) -> Plan<'c> {
    let overrules = Overrules {
        quality: Quality::High,
        set: set.iter().map(|(knob, v)| (knob.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    Plan::new(conditions, &overrules).expect("the plan is sound")
}

/// What every backend that there is makes of points.
fn pictures(test: &str, plan: &Plan) -> Vec<(Wanted, Frame)> {
    let mut reference = Backend::open(Wanted::Reference).expect("it is always there");
    let rendered = reference.render(plan, &Limits::default(), &|_| {});
    let mut found = vec![(Wanted::Reference, rendered.expect("it works").frame)];
    if common::gpu(test) {
        found.push((Wanted::Gpu, shafts::render(plan).frame));
    }
    for (_, frame) in &found {
        frame.check().expect("every value is sound");
    }
    found
}

/// The illuminance of each point [lx, RGB]; nothing must stand in pixels without a point.
fn illuminance(frame: &Frame, field: Field, points: &[Receiver]) -> Vec<DVec3> {
    let mut all = layer(frame, field);
    let rest = all.split_off(points.len());
    assert!(rest.iter().all(|v| *v == DVec3::ZERO), "{field:?}");
    all
}

fn under(sky: &str) -> Scene {
    let mut scene = scene(&SPECK, 120.0, 40.0);
    scene.sky.model = Some(sky.into());
    scene
}

#[test]
fn open_ground_has_the_skys_horizontal_illuminance() {
    let test = "open_ground_has_the_skys_horizontal_illuminance";
    for (sky, allowed) in [
        ("uniform:5000", 1e-6),
        ("cie:16", 5e-3),
        ("cie:1", 5e-3),
        ("preetham", 5e-3),
    ] {
        let points = [
            at(DVec3::ZERO, DVec3::Y),
            at(DVec3::new(30.0, 2.0, -7.0), DVec3::Y),
        ];
        let conditions = conditions(under(sky), &points);
        let truth = conditions.sky.as_ref().expect("it was asked for");
        let truth = truth.horizontal_illuminance();
        let plan = plan(&conditions, &[("radiosity.rays", 1024.0)]);
        for (backend, frame) in pictures(test, &plan) {
            for found in illuminance(&frame, Field::Sky, &points) {
                let error = (found / truth - 1.0).abs().max_element();
                eprintln!("{sky}, {backend:?}: {error:.1e}");
                assert!(error < allowed, "{sky}, {backend:?}: {found} {truth}");
            }
        }
    }
}

#[test]
fn a_point_sees_its_own_share_of_a_uniform_sky_and_of_the_ground() {
    let test = "a_point_sees_its_own_share_of_a_uniform_sky_and_of_the_ground";
    let whole = PI * 5000.0;
    for albedo in [None, Some(0.0), Some(0.4), Some(1.0)] {
        let mut scene = under("uniform:5000");
        scene.ground.enabled = albedo.is_some();
        scene.ground.albedo = albedo.unwrap_or(0.0);
        let points: Vec<Receiver> = [DVec3::X, DVec3::NEG_Z, DVec3::NEG_Y]
            .into_iter()
            .chain((0..30).map(direction))
            .map(|normal| at(2.0 * DVec3::Y, normal))
            .collect();
        let conditions = conditions(scene, &points);
        // A horizon that cuts off less than the outermost cells takes small ones.
        let plan = plan(&conditions, &[("radiosity.rays", 16384.0)]);
        for (backend, frame) in pictures(test, &plan) {
            let from_sky = illuminance(&frame, Field::Sky, &points);
            let from_ground = illuminance(&frame, Field::Indirect, &points);
            let mut worst = 0.0f64;
            for (i, point) in points.iter().enumerate() {
                // View factor of a half space: (1 + cos) / 2 to the sky, the rest to the ground.
                let sky = 0.5 * (1.0 + point.normal.y);
                let ground = albedo.unwrap_or(0.0) * (1.0 - sky);
                // The sun lights the ground too.
                let below = whole + 1e5 * (40.0 * DEG).sin();
                for (found, share, whole) in
                    [(from_sky[i], sky, whole), (from_ground[i], ground, below)]
                {
                    let error = (found.y - whole * share).abs() / whole;
                    worst = worst.max(error);
                    assert!(
                        error < 2e-3,
                        "{backend:?}, {albedo:?}, {}: {found} {}",
                        point.normal,
                        whole * share
                    );
                }
            }
            eprintln!("{backend:?}, albedo {albedo:?}: {worst:.1e}");
        }
    }
}

/// A roof of 10 m by 10 m, 5 m above the ground.
fn roof() -> Scene {
    let roof = quad(
        DVec3::new(-5.0, 5.0, -5.0),
        DVec3::X * 10.0,
        DVec3::Z * 10.0,
    );
    scene(&roof, 120.0, 35.0)
}

fn sun() -> DVec3 {
    toward(120.0 * DEG, 35.0 * DEG, 0.0)
}

/// Points in, over and under the roof's shadow, each with another normal and none within 0.2 m of the shadow's edge; the first
/// lies in the sun.
fn points(count: usize) -> Vec<Receiver> {
    let place = |i| DVec3::new(-13.0, 0.0, -12.0) + spread(i) * DVec3::new(20.0, 8.0, 20.0);
    let open = at(DVec3::new(12.0, 2.0, 9.0), DVec3::Y);
    let others = (0..).map(|i| at(place(i), direction(i + 7)));
    let away = others.filter(|p| behind_the_roof(p.position, sun()).1 > 0.2);
    [open].into_iter().chain(away).take(count).collect()
}

/// Whether the roof keeps the sun from a point, and how far it is from the edge of the shadow [m].
fn behind_the_roof(point: DVec3, sun: DVec3) -> (bool, f64) {
    let way = (5.0 - point.y) / sun.y;
    if way <= 0.0 {
        return (false, f64::INFINITY);
    }
    let there = point + way * sun;
    let beyond = (there.x.abs() - 5.0).max(there.z.abs() - 5.0);
    (beyond < 0.0, beyond.abs())
}

/// Haze of an extinction [1/m] up to a height [m].
const HAZE: (f64, f64) = (0.03, 9.0);

/// E cos(theta) e^-tau [lx].
fn sunlight(point: &Receiver, sun: DVec3, extinction: f64) -> f64 {
    match behind_the_roof(point.position, sun).0 {
        true => 0.0,
        false => {
            let depth = extinction * (HAZE.1 - point.position.y) / sun.y;
            1e5 * (-depth).exp() * point.normal.dot(sun).max(0.0)
        }
    }
}

/// The greatest relative error of sunlight; that of a grazing sun relative to 1000 lx, whose cosine has few digits in f32.
fn worst(points: &[Receiver], found: &[DVec3], sun: DVec3, extinction: f64) -> f64 {
    let off = |(point, found): (&Receiver, &DVec3)| {
        let truth = sunlight(point, sun, extinction);
        (found.y - truth).abs() / truth.max(1e3)
    };
    points.iter().zip(found).map(off).fold(0.0, f64::max)
}

#[test]
fn sunlight_goes_by_the_cosine_and_stops_at_what_stands_in_its_way() {
    let test = "sunlight_goes_by_the_cosine_and_stops_at_what_stands_in_its_way";
    for extinction in [0.0, HAZE.0] {
        for count in [1, 2, 600, 1500] {
            let points = points(count);
            let mut scene = roof();
            if extinction > 0.0 {
                let shape = Shape::Haze { top: HAZE.1 };
                let phase = Phase::HenyeyGreenstein { g: 0.5 };
                scene.media = vec![fog(shape, 0.8 * extinction, 0.2 * extinction, phase)];
            }
            let conditions = conditions(scene, &points);
            for (backend, frame) in pictures(test, &plan(&conditions, &[])) {
                let found = illuminance(&frame, Field::Sun, &points);
                let error = worst(&points, &found, sun(), extinction);
                eprintln!("{backend:?}, extinction {extinction}, {count} points: {error:.1e}");
                let allowed = match backend {
                    Wanted::Reference => 1e-6,
                    _ => 1e-5,
                };
                assert!(error < allowed, "{backend:?} {extinction} {count}: {error}");
                // Half a degree and a tenth of the haze are noticed.
                let lower = toward(120.0 * DEG, 34.5 * DEG, 0.0);
                assert!(worst(&points, &found, lower, extinction) > 1e-3);
                if extinction > 0.0 {
                    assert!(worst(&points, &found, sun(), 0.9 * extinction) > 1e-3);
                }
                let dark = |p: &&Receiver| sunlight(p, sun(), 0.0) == 0.0;
                let away = points.iter().filter(|p| p.normal.dot(sun()) <= 0.0).count();
                let shaded = points.iter().filter(dark).count() - away;
                assert!(count < 600 || away > 100 && shaded > 30, "{away} {shaded}");
                for (point, found) in points.iter().zip(&found) {
                    assert!(
                        !dark(&point) || *found == DVec3::ZERO,
                        "{backend:?} {point:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn points_on_a_surface_are_not_shaded_by_it() {
    let test = "points_on_a_surface_are_not_shaded_by_it";
    let points: Vec<Receiver> = (0..64)
        .map(|i| {
            let place = 9.0 * (spread(i) - 0.5);
            let side = if i % 2 == 0 { DVec3::Y } else { DVec3::NEG_Y };
            at(DVec3::new(place.x, 5.0, place.z), side)
        })
        .collect();
    let conditions = conditions(roof(), &points);
    for (backend, frame) in pictures(test, &plan(&conditions, &[])) {
        let found = illuminance(&frame, Field::Sun, &points);
        for (point, found) in points.iter().zip(found) {
            let truth = 1e5 * sun().y * f64::from(point.normal.y > 0.0);
            let error = (found.y - truth).abs();
            assert!(error < 1e-6 * 1e5, "{backend:?} {point:?}: {found} {truth}");
        }
    }
}

#[test]
fn a_point_far_off_takes_nothing_from_the_others() {
    let test = "a_point_far_off_takes_nothing_from_the_others";
    for count in [1, 30] {
        let mut points = points(count);
        points.push(at(DVec3::new(5e8, 3.0, -2e7), DVec3::Y));
        let conditions = conditions(roof(), &points);
        for (backend, frame) in pictures(test, &plan(&conditions, &[])) {
            let found = illuminance(&frame, Field::Sun, &points);
            let error = worst(&points, &found, sun(), 0.0);
            eprintln!("{backend:?}, {count} points: {error:.1e}");
            let allowed = match backend {
                Wanted::Reference => 1e-6,
                _ => 1e-5,
            };
            assert!(error < allowed, "{backend:?} {count}: {error}");
        }
    }
}

#[test]
fn a_disc_cut_in_half_gives_half_its_light_however_many_points_there_are() {
    let mut scene = roof();
    if let Some(entry) = &mut scene.sun {
        entry.diameter_deg = None;
    }
    // The sun's centre is just in the middle of the roof's edge, seen from there.
    let half = DVec3::new(5.0, 5.0, 0.3) - 8.0 * sun();
    let others = (0..600).map(|i| at(60.0 * (spread(i) + 1.0), DVec3::Y));
    for count in [1, 601] {
        let points: Vec<Receiver> = [at(half, sun())]
            .into_iter()
            .chain(others.clone())
            .take(count)
            .collect();
        let conditions = conditions(scene.clone(), &points);
        let plan = plan(&conditions, &[("surface_sun.suns", 1024.0)]);
        let mut backend = Backend::open(Wanted::Reference).expect("it is always there");
        let frame = backend
            .render(&plan, &Limits::default(), &|_| {})
            .expect("it works")
            .frame;
        let share = illuminance(&frame, Field::Sun, &points)[0].y / 1e5;
        eprintln!("{count} points: {share:.4}");
        assert!((share - 0.5).abs() < 5e-3, "{share}");
    }
}

#[test]
fn both_backends_agree_and_keep_the_order_of_points() {
    let test = "both_backends_agree_and_keep_the_order_of_points";
    let mut scene = roof();
    scene.sky.model = Some("preetham".into());
    scene.ground.enabled = true;
    let points = points(600);
    let backward: Vec<Receiver> = points.iter().rev().copied().collect();
    let forward = conditions(scene.clone(), &points);
    let turned = conditions(scene, &backward);
    let truth = pictures(test, &plan(&forward, &[]));
    let other = pictures(test, &plan(&turned, &[]));
    for field in [Field::Sun, Field::Sky] {
        let reference = illuminance(&truth[0].1, field, &points);
        let mean = reference.iter().map(|v| luminance(*v)).sum::<f64>() / points.len() as f64;
        let worst = |found: &[DVec3]| {
            let off = |i: usize| (found[i] - reference[i]).abs().max_element() / mean;
            (0..points.len()).map(off).fold(0.0, f64::max)
        };
        for ((backend, forward), (_, turned)) in truth.iter().zip(&other) {
            let mut back = illuminance(turned, field, &backward);
            assert!(worst(&back) > 0.1, "points in another order are told apart");
            back.reverse();
            let errors = [worst(&illuminance(forward, field, &points)), worst(&back)];
            eprintln!("{field:?}, {backend:?}: {errors:?}");
            let allowed = match field {
                Field::Sky => 1e-6,
                _ => 1e-4,
            };
            assert!(
                errors.iter().all(|e| *e <= allowed),
                "{field:?}: {errors:?}"
            );
        }
    }
}

#[test]
fn points_see_nothing_and_the_plan_says_so() {
    let test = "points_see_nothing_and_the_plan_says_so";
    let mut scene = under("preetham");
    scene.air = Some(Default::default());
    scene.media = vec![fog(Shape::Haze { top: 9.0 }, 0.02, 0.0, Phase::Isotropic)];
    let points = [at(DVec3::Y, DVec3::Y)];
    let conditions = conditions(scene, &points);
    let plan = plan(&conditions, &[]);
    for step in &plan.steps {
        let made = step.effect.writes.iter().chain(step.effect.alters);
        let lights = |field: &Field| {
            matches!(
                field,
                Field::Sun | Field::Sky | Field::Indirect | Field::Lights | Field::Surface
            )
        };
        let name = step.effect.name;
        if made.clone().next().is_some() && !made.clone().any(lights) {
            assert!(!step.decision.run, "{name}");
            let reason = &step.decision.reason;
            let other = [
                "the method is",
                "points receive light",
                "nothing makes",
                "no effect",
            ];
            assert!(
                other.iter().any(|words| reason.contains(words)),
                "{name}: {reason}"
            );
        }
        if step.effect.writes == [Field::Background] {
            assert!(
                step.decision.reason.contains("points receive light"),
                "{name}"
            );
        }
    }
    let runs = |name: &str| plan.running().any(|step| step.effect.name == name);
    assert!(runs("surface_sun") && runs("radiosity") && !runs("compose"));
    for (backend, frame) in pictures(test, &plan) {
        let names: Vec<&str> = frame.layers.iter().map(|layer| layer.name).collect();
        assert_eq!(names, ["sun", "sky", "indirect"], "{backend:?}");
    }
    let force = Overrules {
        force: vec!["sky_dome".into()],
        ..Overrules::default()
    };
    assert!(Plan::new(&conditions, &force).is_err_and(|e| e.is_input()));
}
