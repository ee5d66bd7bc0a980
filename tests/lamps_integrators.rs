//! Ways of integrating the light of lamps in the air, against the exact one and closed forms, where each holds.

mod common;

use common::build::*;
use common::night::*;
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::{PI, TAU};
use tyndall::beam::Beam;
use tyndall::conditions::Conditions;
use tyndall::effect::Field;
use tyndall::effect::air_lamps::Integrator;
use tyndall::medium::{Airlight, Phase};
use tyndall::photometry::Distribution;
use tyndall::plan::Quality;
use tyndall::scene::shade::Shade;
use tyndall::scene::{Camera, Geometry, LampEntry, Ray};
use tyndall::studies::lamp_scenes;
use tyndall::studies::lamps::{Trial, measure, truth};

/// The light of lamps in the air by an integrator.
fn air(seen: &Conditions, integrator: Integrator, set: &[(&str, f64)]) -> Vec<DVec3> {
    let number = Integrator::ALL.iter().position(|i| *i == integrator);
    let mut all = vec![("air_lamps.integrator", number.expect("it is one") as f64)];
    all.extend(set);
    let frame = rendered_without(&["air_sky", "radiosity"], seen, Quality::High, &all);
    layer(&frame, Field::InscatterLights)
}

/// A lamp in a box of fog of 100 m around the origin, seen from there along -Z.
fn in_fog(lamp: LampEntry, [scattering, absorption]: [f64; 2], size: u32) -> Conditions {
    let mut scene = night(&nothing(), vec![lamp]);
    scene.media = vec![box_of_fog(100.0, scattering, absorption, Phase::Isotropic)];
    let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0 * DEG);
    conditions(scene, camera, [size, size])
}

/// The integral of e^-(sigma (t + d)) / d^2 along a ray up to `end`, by Simpson's rule in the angle that the lamp sees.
fn counted(foot: f64, aside: f64, sigma: f64, end: f64) -> f64 {
    const STEPS: u32 = 20_000;
    let angle = |t: f64| ((t - foot) / aside).atan();
    let (first, last) = (angle(0.0), angle(end));
    let value = |i: u32| {
        let t = foot + aside * (first + (last - first) * f64::from(i) / f64::from(STEPS)).tan();
        let weight = match i {
            0 | STEPS => 1.0,
            i => f64::from(2 + 2 * (i % 2)),
        };
        weight * (-sigma * (t + (t - foot).hypot(aside))).exp()
    };
    let sum: f64 = (0..=STEPS).map(value).sum();
    sum * (last - first) / f64::from(3 * STEPS) / aside
}

#[test]
fn homogeneous_air_in_closed_form_is_its_quadrature() {
    let at = dvec3(0.3, 0.2, -4.0);
    for [scattering, absorption] in [[1e-6, 0.0], [0.004, 0.006], [0.1, 0.05], [1.0, 2.0]] {
        let lamp = lamp(at, 100.0, Distribution::Isotropic);
        let seen = in_fog(lamp, [scattering, absorption], 9);
        let found = air(&seen, Integrator::Airlight, &[]);
        for (i, found) in found.iter().enumerate() {
            let pixel = DVec2::new((i % 9) as f64 + 0.5, (i / 9) as f64 + 0.5);
            let ray = seen.view.ray(pixel);
            let foot = at.dot(ray.direction);
            let aside = at.cross(ray.direction).length();
            let end = 100.0 / ray.direction.abs().max_element();
            let exact = scattering * 100.0 / (4.0 * PI)
                * counted(foot, aside, scattering + absorption, end);
            assert!((found.y / exact - 1.0).abs() < 1e-6, "{i}: {found} {exact}");
        }
    }
    // Among posts, on exact lit runs, too.
    for view in ["posts", "open-lamp"] {
        let seen = lamp_scenes::named(view)
            .expect("it is there")
            .conditions([24, 16]);
        let seen = seen.expect("it is sound");
        let [closed, exact] = [Integrator::Airlight, Integrator::Exact]
            .map(|integrator| air(&seen, integrator, &[("air_lamps.error", 1e-9)]));
        for (closed, exact) in closed.iter().zip(&exact) {
            assert!(
                (closed.y - exact.y).abs() <= 1e-6 * exact.y,
                "{view}: {closed} {exact}"
            );
        }
    }
}

#[test]
fn the_glow_is_taken_where_its_bound_is_within_the_error_and_only_there() {
    let at = dvec3(0.3, 0.2, -4.0);
    let (mut chosen, mut left) = (0, 0);
    for (sigma, error) in [
        (1e-5, 1e-3),
        (1e-3, 1e-3),
        (3e-3, 1e-2),
        (0.01, 1e-2),
        (1.0, 1e-2),
    ] {
        let lamp = lamp(at, 100.0, Distribution::Isotropic);
        let seen = in_fog(lamp, [sigma, 0.0], 9);
        let set = [("air_lamps.error", error)];
        let found = air(&seen, Integrator::Glow, &set);
        for (i, found) in found.iter().enumerate() {
            let pixel = DVec2::new((i % 9) as f64 + 0.5, (i / 9) as f64 + 0.5);
            let ray = seen.view.ray(pixel);
            let end = 100.0 / ray.direction.abs().max_element();
            let light = Airlight::new(ray.origin, ray.direction, at, 0.0);
            let strength = sigma * 100.0 / (4.0 * PI);
            let exact = strength * light.exact(sigma, 0.0, end);
            let bound = light.glow_error(sigma, 0.0, end);
            let off = (found.y / exact - 1.0).abs();
            let expected = match bound <= error {
                true => {
                    chosen += 1;
                    strength * light.glow(sigma, 0.0, end)
                }
                false => {
                    left += 1;
                    exact
                }
            };
            assert!(
                off <= bound.min(error) + 1e-6 || bound > error && off < 1e-3,
                "{off} {bound}"
            );
            let tolerance = if bound <= error { 1e-6 } else { 1e-3 };
            assert!(
                (found.y / expected - 1.0).abs() < tolerance,
                "{sigma} {i}: {bound}"
            );
        }
    }
    assert!(chosen > 80 && left > 80, "{chosen} {left}");
    // Something stands in the way, or it is no even lamp in even air: the exact way takes over.
    let posts = lamp_scenes::named("posts").expect("it is there");
    let mut spot_in_fog = lamp_scenes::named("open-lamp").expect("it is there");
    spot_in_fog.scene.lamps[0].distribution = spot(60.0, 0.3);
    let mut forward = lamp_scenes::named("open-lamp").expect("it is there");
    forward.scene.media[0].phase = Phase::HenyeyGreenstein { g: 0.3 };
    let mut outside = lamp_scenes::named("open-lamp").expect("it is there");
    outside.scene.lamps[0].position.y = 9.0;
    for (view, share) in [
        (posts, 0.2),
        (spot_in_fog, 1.0),
        (forward, 1.0),
        (outside, 1.0),
    ] {
        let seen = view.conditions([24, 16]).expect("it is sound");
        let [glow, exact] = [Integrator::Glow, Integrator::Exact].map(|i| air(&seen, i, &[]));
        let same = glow.iter().zip(&exact).filter(|(a, b)| a == b).count();
        assert!(same as f64 >= share * 384.0, "{}: {same}", view.name);
        assert!(relative_rmse(&glow, &exact) < 1e-3, "{}", view.name);
    }
}

/// Relative RMSE of a setting in a scene of the study.
fn error_of(view: &str, integrator: Integrator, set: &[(&'static str, f64)]) -> f64 {
    let seen = lamp_scenes::named(view)
        .expect("it is there")
        .conditions([30, 20]);
    let seen = seen.expect("it is sound");
    let truth = truth(&seen).expect("it can be rendered");
    let trial = Trial {
        integrator,
        set: set.to_vec(),
    };
    let outcome = measure(&seen, &trial, &[], &truth, 1).expect("it can be measured");
    outcome.relative_rmse
}

#[test]
fn every_integrator_goes_toward_the_exact_one_as_it_takes_more_care() {
    for view in ["open-lamp", "posts", "grille"] {
        for (integrator, knob, values, last) in [
            (Integrator::Exact, "error", [1e-1, 1e-3, 1e-6], 1e-5),
            (Integrator::Glow, "error", [1e-1, 1e-3, 1e-6], 1e-5),
            (Integrator::Airlight, "error", [1e-1, 1e-3, 1e-6], 1e-5),
            (Integrator::Equiangular, "nodes", [1.0, 4.0, 32.0], 1e-3),
        ] {
            let errors = values.map(|value| error_of(view, integrator, &[(knob, value)]));
            let name = integrator.name();
            assert!(errors[2] <= errors[1] + 1e-7, "{view} {name}: {errors:?}");
            assert!(errors[1] <= errors[0] + 1e-7, "{view} {name}: {errors:?}");
            assert!(errors[2] < last, "{view} {name}: {errors:?}");
        }
    }
}

/// sum |L - R| / sum R of an integrator, and sum (L - R) / sum R, over all rays but the few that pass right beside the lamp.
fn off(view: &str, integrator: Integrator, set: &[(&str, f64)]) -> [f64; 2] {
    let seen = lamp_scenes::named(view).expect("it is there");
    let seen = seen.conditions([30, 20]).expect("it is sound");
    let exact = air(&seen, Integrator::Exact, &[]);
    let found = air(&seen, integrator, set);
    let mut lights: Vec<f64> = exact.iter().map(|v| v.y).collect();
    lights.sort_unstable_by(f64::total_cmp);
    let most = lights[lights.len() * 98 / 100];
    let pairs = || exact.iter().zip(&found).filter(|(e, _)| e.y <= most);
    let all: f64 = pairs().map(|(e, _)| e.y).sum();
    let sum = |of: fn(f64) -> f64| pairs().map(|(e, f)| of(f.y - e.y)).sum::<f64>() / all;
    [sum(f64::abs), sum(|v| v)]
}

#[test]
fn virtual_planes_converge_as_planes_lattice_and_light_map_grow() {
    let of = |view: &str, planes: f64, lattice: f64, map: f64| {
        let set = [
            ("air_lamps.planes", planes),
            ("air_lamps.lattice", lattice),
            ("air_lamps.map", map),
        ];
        off(view, Integrator::Planes, &set)
    };
    for (view, close) in [("open-lamp", 0.04), ("posts", 0.04), ("grille", 0.1)] {
        let planes = [15.0, 75.0, 600.0].map(|planes| of(view, planes, 80.0, 256.0));
        let [[a, _], [b, _], [c, bias]] = planes;
        eprintln!("{view}: planes {planes:?}");
        assert!(a > 2.0 * c && a > b, "{view}: {planes:?}");
        assert!(c < close && bias.abs() < 0.5 * close, "{view}: {planes:?}");
        let lattices = [5.0, 20.0, 80.0].map(|lattice| of(view, 150.0, lattice, 256.0));
        let [[a, _], [b, _], [c, _]] = lattices;
        eprintln!("{view}: lattices {lattices:?}");
        assert!(a > 2.0 * c && a > b, "{view}: {lattices:?}");
    }
    let maps = [8.0, 32.0, 256.0].map(|map| of("posts", 300.0, 40.0, map));
    let [[a, _], [b, _], [c, _]] = maps;
    assert!(a > 2.0 * c && a > b, "{maps:?}");
}

#[test]
fn rows_converge_as_they_grow() {
    for view in ["posts", "grille"] {
        let rows = [32.0, 256.0, 8192.0]
            .map(|rows| off(view, Integrator::Rows, &[("air_lamps.rows", rows)])[0]);
        assert!(
            rows[0] > 2.0 * rows[1] && rows[1] > 4.0 * rows[2],
            "{view}: {rows:?}"
        );
        assert!(rows[2] < 3e-3, "{view}: {rows:?}");
    }
}

#[test]
fn hard_cases_are_finite_and_not_negative_by_every_integrator() {
    let patterns = [
        Distribution::Isotropic,
        spot(0.0, 0.3),
        spot(30.0, 0.0),
        spot(180.0, 1.0),
        Distribution::PolkaDots {
            spread: 60.0 * DEG,
            sharpness: 0.2,
            petals: 8,
            ratio: -0.3,
            rings: 4,
        },
    ];
    for integrator in Integrator::ALL {
        for sigma in [0.0, 0.1, 1e5] {
            for at in [
                DVec3::ZERO,
                DVec3::Z,
                dvec3(0.0, 0.0, -3.0),
                dvec3(0.0, 1.0, -3.0),
                dvec3(0.0, 0.0, -100.0),
                dvec3(1e-9, 0.0, -1.0),
            ] {
                for pattern in &patterns {
                    let seen = in_fog(lamp(at, 10.0, pattern.clone()), [sigma, 0.0], 3);
                    let set = [("air_lamps.lattice", 4.0), ("air_lamps.map", 8.0)];
                    // Checked by itself: every value is finite and not negative.
                    let found = air(&seen, integrator, &set);
                    assert!(sigma > 0.0 || found.iter().all(|v| *v == DVec3::ZERO));
                }
            }
        }
    }
}

#[test]
fn a_ray_ever_nearer_to_a_lamp_tends_to_the_ray_beside_it_or_grows() {
    // In front of a lamp beyond the end of the fog the light of a ray toward it tends to (b - a) / (a b) without loss; past a lamp it
    // is pi / p.
    for distance in [1.0, 30.0, 1e3, 1e4] {
        let mut before = [0.0; 3];
        for aside in [1e-3, 1e-6, 1e-9, 0.0] {
            let seen = |z: f64| {
                let at = dvec3(aside * distance, 0.0, z);
                let mut scene = night(&nothing(), vec![lamp(at, 1e6, Distribution::Isotropic)]);
                scene.media = vec![box_of_fog(2.0 * distance, 1e-9, 0.0, Phase::Isotropic)];
                let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 2e-6);
                conditions(scene, camera, [1, 1])
            };
            let all = [Integrator::Exact, Integrator::Airlight, Integrator::Glow];
            for (integrator, before) in all.into_iter().zip(&mut before) {
                let fine = [("air_lamps.error", 1e-6)];
                let strength = 1e-9 * 1e6 / (4.0 * PI);
                // The fog ends at twice the distance; the lamp stands as far behind that again.
                let beyond = air(&seen(-3.0 * distance), integrator, &fine)[0].y / strength;
                let exact = 1.0 / distance - 1.0 / (3.0 * distance);
                assert!(
                    (beyond / exact - 1.0).abs() < 1e-2,
                    "{integrator:?} {distance} {aside}: {beyond} {exact}"
                );
                let past = air(&seen(-distance), integrator, &fine)[0].y / strength;
                assert!(
                    past >= *before,
                    "{integrator:?} {distance} {aside}: {past} {before}"
                );
                if aside >= 1e-6 {
                    let angle = PI - 2.0 * aside;
                    let exact = angle / (aside * distance);
                    assert!(
                        (past / exact - 1.0).abs() < 1e-2,
                        "{integrator:?} {distance} {aside}: {past} {exact}"
                    );
                }
                *before = past * (1.0 - 1e-5);
            }
        }
    }
}

#[test]
fn the_edge_of_a_cone_is_crossed_without_a_leap() {
    // The leap from ray to ray falls with their distance, as a chord does that is cut ever shorter.
    let leap = |steps: u32| {
        let lamp = lamp(dvec3(0.0, 2.0, 0.0), 100.0, spot(30.0, 0.25));
        let value = |i: u32| {
            let mut scene = night(&nothing(), vec![lamp.clone()]);
            scene.media = vec![box_of_fog(10.0, 0.1, 0.02, Phase::Isotropic)];
            let x = -3.0 + 6.0 * f64::from(i) / f64::from(steps);
            let camera = Camera::look_at(dvec3(x, 0.0, 8.0), dvec3(x, 0.1, 0.0), 2e-6);
            air(&conditions(scene, camera, [1, 1]), Integrator::Exact, &[])[0].y
        };
        let values: Vec<f64> = (0..=steps).map(value).collect();
        let most = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        most.fold(0.0, f64::max)
    };
    let leaps = [50, 200, 800].map(leap);
    assert!(
        leaps[0] > 0.0 && leaps[1] < 0.6 * leaps[0] && leaps[2] < 0.6 * leaps[1],
        "{leaps:?}"
    );
}

#[test]
fn petals_and_dots_have_no_seam() {
    // Turned by one period (dots by two: every other is left out) the picture is the same, wherever azimuth begins and whatever its
    // sign.
    let daisy = Distribution::Daisy {
        spread: 60.0 * DEG,
        sharpness: 0.3,
        petals: 9,
        ratio: -0.2,
    };
    let dots = Distribution::PolkaDots {
        spread: 60.0 * DEG,
        sharpness: 0.4,
        petals: 8,
        ratio: -0.2,
        rings: 4,
    };
    for (pattern, period) in [(daisy, TAU / 9.0), (dots, TAU / 4.0)] {
        let of = |turn: f64| {
            let (y, x) = turn.sin_cos();
            let lamp = LampEntry {
                around: Some(dvec3(x, 0.0, y)),
                ..lamp(dvec3(0.0, 3.0, 0.0), 100.0, pattern.clone())
            };
            let mut scene = night(&nothing(), vec![lamp]);
            scene.media = vec![box_of_fog(10.0, 0.1, 0.0, Phase::Isotropic)];
            let camera = Camera::look_at(dvec3(0.4, -1.0, 0.3), dvec3(0.0, 3.0, 0.0), 1.5);
            let seen = conditions(scene, camera, [24, 24]);
            air(&seen, Integrator::Exact, &[("air_lamps.error", 1e-6)])
        };
        let first = of(0.0);
        for turns in [1.0, -1.0, 3.0] {
            let turned = of(turns * period);
            assert!(relative_rmse(&turned, &first) < 1e-5, "{pattern:?} {turns}");
        }
        let other = of(0.5 * period);
        assert!(relative_rmse(&other, &first) > 0.03, "{pattern:?}");
    }
}

#[test]
fn a_ray_in_a_half_plane_has_the_runs_of_its_fan() {
    let mut triangles = Vec::new();
    for i in 0..12 {
        let (y, x) = (0.7 * f64::from(i)).sin_cos();
        let at = dvec3(3.0 * x, 0.3 * f64::from(i % 5), 3.0 * y);
        triangles.extend(cuboid(at - 0.2, at + 0.4));
    }
    let geometry = Geometry::new(&scene(&triangles, 0.0, 0.0));
    let (eye, lamp) = (dvec3(6.0, 0.9, 1.0), dvec3(-0.5, 1.1, 0.3));
    let way = Ray {
        origin: eye,
        direction: (lamp - eye).normalize(),
    };
    let (u, v) = way.direction.any_orthonormal_pair();
    let mut runs = 0;
    for i in 0..40 {
        let (y, x) = (0.157 * f64::from(i) + 0.01).sin_cos();
        let across = x * u + y * v;
        let half = geometry.half_plane(&way, eye.distance(lamp), across);
        for angle in [0.05, 0.3, 0.9, 1.8, 3.0f64] {
            let (sin, cos) = angle.sin_cos();
            let ray = Ray {
                origin: eye,
                direction: cos * way.direction + sin * across,
            };
            let mut fan = Vec::new();
            geometry.shades(&ray, 20.0, &[Beam::local(lamp, DVec3::ONE)], &mut fan);
            let mut found = Shade::default();
            half.shade([cos, sin], 20.0, &mut found);
            let dark = |shade: &Shade| shade.dark.iter().map(|[a, b]| b - a).sum::<f64>();
            assert!((dark(&found) - dark(&fan[0])).abs() < 1e-7, "{i} {angle}");
            runs += found.dark.len();
        }
    }
    assert!(runs > 40, "{runs}");
}
