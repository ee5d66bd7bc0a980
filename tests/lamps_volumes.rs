//! Illumination volumes: nothing is lost of the light of many lamps, and a ray that misses them all pays nothing.

mod common;

use common::build::*;
use common::night::*;
use common::shafts;
use glam::{DQuat, DVec3, dvec3};
use tyndall::backend::reference::Reference;
use tyndall::backend::{Limits, Rendered};
use tyndall::conditions::Conditions;
use tyndall::effect::{Field, Paid};
use tyndall::medium::{Edge, Medium, Phase, Shape, Wave};
use tyndall::photometry::Distribution;
use tyndall::plan::{Overrules, Plan};
use tyndall::scene::{Camera, LampEntry, LampForm};
use tyndall::studies::scenes::fog;

/// The layers of lamps alone.
fn done(seen: &Conditions, set: &[(&str, f64)]) -> Rendered {
    let without = ["air_sky", "radiosity", "lamp_faces"].map(str::to_owned);
    let overrules = Overrules {
        without: without.to_vec(),
        set: set.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(seen, &overrules).expect("the plan is sound");
    let reference = Reference::new(&plan).expect("it can be prepared");
    let done = reference.render(&Limits::default(), &|_| {});
    done.expect("it fits into memory")
}

fn paid(done: &Rendered, effect: &str) -> Option<Paid> {
    let step = done.steps.iter().find(|step| step.effect.name == effect);
    step.and_then(|step| step.paid)
}

/// Numbers from 0 to 1 that look random.
fn chance(i: usize, k: usize) -> f64 {
    (0.5 + i as f64 * [0.618_034, 0.754_878, 0.569_84, 0.819_173][k % 4] + 0.37 * k as f64).fract()
}

/// Lamps of all kinds on a field of 200 m.
fn many(count: usize) -> Vec<LampEntry> {
    let one = |i: usize| {
        let at = |k: usize, low: f64, high: f64| low + (high - low) * chance(i, k);
        let distribution = match i % 5 {
            0 => Distribution::Isotropic,
            1 => spot(at(3, 5.0, 120.0), 0.3),
            2 => spot(at(3, 20.0, 70.0), 0.0),
            3 => Distribution::Elliptical {
                spread: [50.0 * DEG, 20.0 * DEG],
                sharpness: 0.2,
            },
            _ => Distribution::Daisy {
                spread: 60.0 * DEG,
                sharpness: 0.3,
                petals: 5,
                ratio: -0.2,
            },
        };
        let form = match i % 11 {
            3 => LampForm::Sphere { radius: 0.2 },
            7 => LampForm::Line {
                to: dvec3(at(0, -100.0, 100.0), 4.0, at(1, -150.0, 10.0)),
            },
            _ => LampForm::Point,
        };
        let down = if i.is_multiple_of(7) { 1.0 } else { -1.0 };
        LampEntry {
            toward: dvec3(at(3, -1.0, 1.0), down, at(2, -1.0, 1.0)),
            form,
            ..lamp(
                dvec3(at(0, -100.0, 100.0), at(2, 0.5, 9.0), at(1, -150.0, 10.0)),
                10.0f64.powf(at(3, 0.0, 3.0)),
                distribution,
            )
        }
    };
    (0..count).map(one).collect()
}

/// Airs in which bounds differ.
fn airs() -> Vec<Vec<Medium>> {
    let haze = |top: f64, scattering: f64| {
        fog(
            Shape::Haze { top },
            scattering,
            0.002,
            Phase::HenyeyGreenstein { g: 0.6 },
        )
    };
    let thinning = Shape::Height {
        base: 0.0,
        scale_height: 8.0,
        far: 400.0,
    };
    let smoke = Shape::Ellipsoid {
        center: dvec3(5.0, 2.0, -30.0),
        radii: dvec3(20.0, 3.0, 25.0),
        rotation: DQuat::IDENTITY,
        edge: Edge::Soft,
    };
    let waves = Shape::Layer {
        top: 1.5,
        waves: vec![Wave::new(0.4, 9.0, 0.3, 0.0)],
        bottom: None,
        far: 300.0,
    };
    vec![
        vec![haze(12.0, 0.01)],
        vec![haze(5.0, 0.1), fog(thinning, 0.02, 0.0, Phase::Rayleigh)],
        vec![
            fog(smoke, 0.05, 0.01, Phase::Isotropic),
            fog(waves, 0.03, 0.0, Phase::Isotropic),
        ],
    ]
}

fn seen(
    lamps: Vec<LampEntry>,
    air: &[Medium],
    eye: DVec3,
    target: DVec3,
    size: [u32; 2],
) -> Conditions {
    let mut triangles = posts();
    triangles.extend(cuboid(dvec3(-30.0, 0.0, -40.0), dvec3(-20.0, 12.0, -30.0)));
    let mut scene = night(&triangles, lamps);
    scene.ground.enabled = true;
    scene.ground.height = Some(0.0);
    scene.media = air.to_vec();
    conditions(scene, Camera::look_at(eye, target, 1.0), size)
}

#[test]
fn the_light_of_many_lamps_is_the_sum_of_that_of_each() {
    let size = [9, 6];
    let lamps = many(120);
    let views = [
        (dvec3(0.0, 1.7, 12.0), dvec3(0.0, 2.5, -20.0)),
        (dvec3(60.0, 40.0, 30.0), dvec3(0.0, 0.0, -60.0)),
    ];
    for air in airs() {
        for (eye, target) in views {
            let whole = |set: &[(&str, f64)]| {
                let done = done(&seen(lamps.clone(), &air, eye, target, size), set);
                [Field::Lights, Field::InscatterLights].map(|field| layer(&done.frame, field))
            };
            let mut sum = [vec![DVec3::ZERO; 54], vec![DVec3::ZERO; 54]];
            for lamp in &lamps {
                let one = done(&seen(vec![lamp.clone()], &air, eye, target, size), &[]);
                for (sum, field) in sum.iter_mut().zip([Field::Lights, Field::InscatterLights]) {
                    let found = layer(&one.frame, field);
                    sum.iter_mut().zip(found).for_each(|(s, f)| *s += f);
                }
            }
            for share in [0.0, 1e-3, 0.1] {
                let set = [
                    ("surface_lamps.left_out", share),
                    ("air_lamps.left_out", share),
                ];
                let [on_surfaces, in_air] = whole(&set);
                let mut all: Vec<f64> = sum[1].iter().map(|v| v.y).collect();
                all.sort_unstable_by(f64::total_cmp);
                // Half of the picture has at least this; a few rays tell.
                let typical = all[(all.len() * 3) / 4];
                for (found, exact) in on_surfaces.iter().zip(&sum[0]) {
                    let off = exact.y - found.y;
                    assert!(
                        off.abs() <= (share + 1e-6) * exact.y,
                        "{share}: {found} {exact}"
                    );
                }
                for (found, exact) in in_air.iter().zip(&sum[1]) {
                    let off = exact.y - found.y;
                    let most = share * exact.y.max(typical) + 1e-6 * exact.y;
                    assert!(off.abs() <= most, "{share}: {found} {exact} {typical}");
                }
            }
        }
    }
}

/// Street lamps in pairs every 6 m down a street.
fn street(count: usize) -> Vec<LampEntry> {
    let one = |i: usize| {
        let side = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        LampEntry {
            toward: dvec3(-0.2 * side, -1.0, 0.0),
            ..lamp(
                dvec3(6.0 * side, 6.0, -6.0 * (i / 2) as f64),
                900.0,
                spot(65.0, 0.2),
            )
        }
    };
    (0..count).map(one).collect()
}

#[test]
fn a_street_costs_by_the_lamps_that_the_picture_sees() {
    let haze = fog(Shape::Haze { top: 20.0 }, 0.01, 0.0, Phase::Isotropic);
    let at = |count: usize, target: DVec3, set: &[(&str, f64)]| {
        let seen = seen(
            street(count),
            std::slice::from_ref(&haze),
            dvec3(0.0, 1.7, 5.0),
            target,
            [24, 15],
        );
        done(&seen, set)
    };
    let ahead = dvec3(0.0, 2.5, -20.0);
    let [hundred, thousand] = [100, 1000].map(|count| at(count, ahead, &[]));
    for effect in ["air_lamps", "surface_lamps"] {
        let [few, many] = [&hundred, &thousand].map(|done| paid(done, effect).expect("it counts"));
        assert!(few.met > 0 && few.met <= few.rays, "{few:?}");
        assert!(
            many.pairs as f64 <= 1.05 * few.pairs as f64,
            "{effect}: {few:?} {many:?}"
        );
        assert!(many.pairs < 40 * many.rays, "{effect}: {many:?}");
    }
    assert_eq!(
        paid(&thousand, "air_lamps").map(|paid| paid.rays),
        Some(360)
    );
    // All of them, one for one, add no more than was allowed to be missing.
    let all = at(
        1000,
        ahead,
        &[("air_lamps.left_out", 0.0), ("surface_lamps.left_out", 0.0)],
    );
    for field in [Field::Lights, Field::InscatterLights] {
        let [found, exact] = [&thousand, &all].map(|done| layer(&done.frame, field));
        assert!(relative_rmse(&found, &exact) < 1e-3, "{field:?}");
    }
    // The same once more, bit by bit.
    let again = at(1000, ahead, &[]);
    assert_eq!(again.frame.layers, thousand.frame.layers);
    // Up into the sky no ray meets the light of any.
    let mut up = seen(
        street(1000),
        &[haze],
        dvec3(0.0, 8.0, 60.0),
        dvec3(0.0, 30.0, 90.0),
        [24, 15],
    );
    up.view.camera.up = DVec3::Y;
    let done = done(&up, &[]);
    let Paid { rays, met, pairs } = paid(&done, "air_lamps").expect("it counts");
    assert_eq!([rays, met, pairs], [360, 0, 0]);
    let dark = layer(&done.frame, Field::InscatterLights);
    assert!(dark.iter().all(|v| *v == DVec3::ZERO));
}

#[test]
fn a_scene_without_lamps_pays_nothing_for_them() {
    const EFFECTS: [&str; 3] = ["surface_lamps", "air_lamps", "lamp_faces"];
    let mut scene = scene(&posts(), 30.0, 40.0);
    scene.media = vec![box_of_fog(4.0, 0.1, 0.03, Phase::Isotropic)];
    let camera = Camera::look_at(dvec3(0.6, 1.7, 8.5), dvec3(0.0, 1.2, 0.0), 50.0 * DEG);
    let seen = conditions(scene, camera, [16, 12]);
    let without = Overrules {
        without: EFFECTS.map(str::to_owned).to_vec(),
        ..Overrules::default()
    };
    let [plan, bare] = [&Overrules::default(), &without]
        .map(|overrules| Plan::new(&seen, overrules).expect("the plan is sound"));
    for step in plan
        .steps
        .iter()
        .filter(|step| EFFECTS.contains(&step.effect.name))
    {
        assert!(
            !step.decision.run && !step.decision.possible,
            "{}",
            step.effect.name
        );
    }
    for field in [Field::Lights, Field::InscatterLights] {
        assert!(!plan.written().contains(&field));
    }
    let names = |plan: &Plan| {
        plan.running()
            .map(|step| step.effect.name)
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&plan), names(&bare));
    let done = Reference::new(&plan).expect("it can be prepared");
    let done = done.render(&Limits::default(), &|_| {}).expect("it fits");
    assert!(done.steps.iter().all(|step| step.paid.is_none()));
    if !common::gpu("a_scene_without_lamps_pays_nothing_for_them") {
        return;
    }
    // Pipelines and scene of a plan without them are on the device.
    let mut gpu = shafts::gpu();
    let mut of = |plan: &Plan| {
        gpu.forget();
        let done = gpu.render(plan, &Limits::default(), &|_| {});
        let done = done.expect("it fits");
        let passes: Vec<_> = done.steps.iter().map(|s| (s.effect.name, s.pass)).collect();
        (passes, done.made.pipelines, done.traffic)
    };
    of(&bare);
    let with = of(&plan);
    assert_eq!(with.1, 0, "no pipeline more");
    assert_eq!(with, of(&bare));
}
