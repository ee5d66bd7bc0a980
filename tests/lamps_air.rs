//! Light of lamps in the air: held to closed forms and to sums over many shadow rays.

mod common;

use common::build::*;
use common::night::*;
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::effect::Field;
use tyndall::medium::{Airlight, Phase};
use tyndall::photometry::{Distribution, Pose};
use tyndall::plan::Quality;
use tyndall::scene::{Camera, LampEntry, Ray};
use tyndall::studies::scenes::Corners;

/// Whether a triangle lies between two points: Cramer's rule, nothing of the library.
fn is_between(triangles: &[Corners], from: DVec3, to: DVec3) -> bool {
    let way = to - from;
    triangles.iter().any(|[a, b, c]| {
        let (e, f) = (*b - *a, *c - *a);
        let p = way.cross(f);
        let determinant = e.dot(p);
        if determinant.abs() < 1e-14 {
            return false;
        }
        let s = from - *a;
        let u = s.dot(p) / determinant;
        let q = s.cross(e);
        let (v, t) = (way.dot(q) / determinant, f.dot(q) / determinant);
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-7 && t < 1.0 - 1e-7
    })
}

/// What the air of a box of fog around the origin sends along a ray, by steps of equal angle and a shadow ray each.
fn stepped(
    triangles: &[Corners],
    lamp: &LampEntry,
    ray: &Ray,
    end: f64,
    half: f64,
    [scattering, extinction]: [f64; 2],
    g: f64,
) -> f64 {
    let chord = |origin: DVec3, direction: DVec3| {
        let inverse = direction.recip();
        let (a, b) = (
            (-DVec3::splat(half) - origin) * inverse,
            (DVec3::splat(half) - origin) * inverse,
        );
        (a.min(b).max_element().max(0.0), a.max(b).min_element())
    };
    let (enter, leave) = chord(ray.origin, ray.direction);
    let end = end.min(leave);
    if end <= enter {
        return 0.0;
    }
    let pose = Pose::new(lamp.toward, lamp.around).expect("it has a direction");
    let foot = (lamp.position - ray.origin).dot(ray.direction);
    let aside = ray.at(foot).distance(lamp.position);
    let angle = |t: f64| ((t - foot) / aside).atan();
    const STEPS: usize = 4000;
    let (first, last) = (angle(enter), angle(end));
    let mut sum = 0.0;
    for i in 0..STEPS {
        let theta = first + (last - first) * (i as f64 + 0.5) / STEPS as f64;
        let t = foot + aside * theta.tan();
        let point = ray.at(t);
        let way = lamp.position - point;
        let shape = lamp.distribution.intensity(&pose, -way);
        if shape == 0.0 || is_between(triangles, point, lamp.position) {
            continue;
        }
        let mu = -ray.direction.dot(way.normalize());
        let mu = -mu;
        let phase = (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * mu).powf(1.5));
        let (_, to_face) = chord(point, way.normalize());
        let depth = extinction * ((t - enter) + way.length().min(to_face));
        sum += shape * phase * (-depth).exp();
    }
    lamp.intensity.y * scattering * sum * (last - first) / STEPS as f64 / aside
}

fn patterns() -> Vec<(&'static str, Distribution)> {
    vec![
        ("isotropic", Distribution::Isotropic),
        ("spot", spot(50.0, 0.25)),
        (
            "daisy",
            Distribution::Daisy {
                spread: 70.0 * DEG,
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
    ]
}

#[test]
fn the_air_among_posts_is_what_many_shadow_rays_say() {
    let triangles = posts();
    let (half, g) = (4.0, 0.5);
    let (scattering, absorption) = (0.1, 0.03);
    let camera = Camera::look_at(dvec3(0.6, 1.7, 8.5), dvec3(0.0, 1.2, 0.0), 50.0 * DEG);
    let size = [12, 8];
    for (name, distribution) in patterns() {
        let lamp = LampEntry {
            toward: dvec3(0.3, -1.0, 0.4),
            around: Some(dvec3(0.2, 0.1, 1.0)),
            ..lamp(dvec3(0.2, 2.2, -0.1), 100.0, distribution)
        };
        let mut scene = night(&triangles, vec![lamp.clone()]);
        scene.media = vec![box_of_fog(
            half,
            scattering,
            absorption,
            Phase::HenyeyGreenstein { g },
        )];
        let seen = conditions(scene, camera, size);
        let frame = rendered_without(&["air_sky", "radiosity"], &seen, Quality::High, &[]);
        let found: Vec<f64> = layer(&frame, Field::InscatterLights)
            .iter()
            .map(|v| v.y)
            .collect();
        let truth: Vec<f64> = (0..size[0] * size[1])
            .map(|i| {
                let pixel = DVec2::new(f64::from(i % size[0]) + 0.5, f64::from(i / size[0]) + 0.5);
                let ray = seen.view.ray(pixel);
                let hit = seen.geometry.closest(&ray, 0.0, f64::INFINITY);
                let end = hit.map_or(f64::INFINITY, |hit| hit.distance);
                let both = [scattering, scattering + absorption];
                stepped(&triangles, &lamp, &ray, end, half, both, g)
            })
            .collect();
        let mean = truth.iter().sum::<f64>() / truth.len() as f64;
        let square = found
            .iter()
            .zip(&truth)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>();
        let off = (square / truth.len() as f64).sqrt() / mean;
        eprintln!("{name}: {:.3} %", 100.0 * off);
        assert!(mean > 0.0 && off < 0.005, "{name}: {off}");
        // Without the posts it is another picture.
        let mut open = night(&nothing(), vec![lamp]);
        open.media = vec![box_of_fog(
            half,
            scattering,
            absorption,
            Phase::HenyeyGreenstein { g },
        )];
        let open = rendered_without(
            &["air_sky", "radiosity"],
            &conditions(open, camera, size),
            Quality::High,
            &[],
        );
        let open: f64 = layer(&open, Field::InscatterLights)
            .iter()
            .map(|v| v.y)
            .sum();
        assert!(
            (open / truth.iter().sum::<f64>() - 1.0).abs() > 0.02,
            "{name}"
        );
    }
}

#[test]
fn the_glow_of_a_lamp_in_even_air_is_its_closed_form() {
    for sigma in [0.01, 0.1, 1.0, 10.0] {
        let at = dvec3(0.3, 0.2, -4.0);
        let mut scene = night(&nothing(), vec![lamp(at, 100.0, Distribution::Isotropic)]);
        scene.media = vec![box_of_fog(
            100.0,
            0.4 * sigma,
            0.6 * sigma,
            Phase::Isotropic,
        )];
        let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0 * DEG);
        let seen = conditions(scene, camera, [9, 9]);
        let frame = rendered_without(&["air_sky", "radiosity"], &seen, Quality::Preview, &[]);
        for (i, found) in layer(&frame, Field::InscatterLights).iter().enumerate() {
            let pixel = DVec2::new((i % 9) as f64 + 0.5, (i / 9) as f64 + 0.5);
            let ray = seen.view.ray(pixel);
            let leave = 100.0 / ray.direction.abs().max_element();
            let air = Airlight::new(ray.origin, ray.direction, at, 0.0);
            let exact = 0.4 * sigma * 100.0 / (4.0 * PI) * air.exact(sigma, 0.0, leave);
            assert!(
                (found.y / exact - 1.0).abs() < 1e-3,
                "{sigma} {i}: {found} {exact}"
            );
        }
    }
}

#[test]
fn hard_cases_of_a_ray_and_a_lamp_are_finite_and_continuous() {
    // Through the lamp, behind it, at the eye, far off; thin and thick air; cones that are touched.
    let along = DVec3::NEG_Z;
    for sigma in [0.0, 1e-6, 0.1, 1e5] {
        for (name, distribution) in patterns() {
            let mut last: Option<f64> = None;
            for aside in [0.0, 1e-12, 1e-9, 1e-6, 1e-3] {
                let lamp = lamp(dvec3(aside, 0.0, -3.0), 10.0, distribution.clone());
                let mut scene = night(&nothing(), vec![lamp]);
                scene.media = vec![box_of_fog(100.0, sigma, 0.0, Phase::Isotropic)];
                let camera = Camera::look_at(DVec3::ZERO, along, 1e-3);
                let frame = rendered_without(
                    &["air_sky", "radiosity"],
                    &conditions(scene, camera, [1, 1]),
                    Quality::High,
                    &[],
                );
                let found = frame
                    .layer("inscatter_lights")
                    .map_or(0.0, |l| f64::from(l.rgb[0][1]));
                assert!(
                    found.is_finite() && found >= 0.0,
                    "{name} {sigma} {aside}: {found}"
                );
                // It grows toward the lamp, but not by leaps.
                if let Some(last) = last {
                    assert!(
                        found <= 1.0001 * last,
                        "{name} {sigma} {aside}: {found} {last}"
                    );
                }
                last = Some(found.max(1e-30));
            }
        }
    }
    let seen = |lamp: LampEntry, sigma: f64| {
        let mut scene = night(&nothing(), vec![lamp]);
        scene.media = vec![box_of_fog(100.0, sigma, 0.0, Phase::Isotropic)];
        let camera = Camera::look_at(DVec3::ZERO, along, 0.5);
        let frame = rendered_without(
            &["air_sky", "radiosity"],
            &conditions(scene, camera, [5, 5]),
            Quality::High,
            &[],
        );
        layer(&frame, Field::InscatterLights)
    };
    for at in [
        DVec3::ZERO,
        DVec3::Z,
        dvec3(0.0, 0.0, 1e-9),
        dvec3(0.0, 1e-5, 0.0),
    ] {
        for spread in [0.0, 30.0, 90.0, 180.0] {
            let values = seen(lamp(at, 10.0, spot(spread, 0.3)), 0.1);
            assert!(
                values
                    .iter()
                    .all(|v| v.is_finite() && v.min_element() >= 0.0),
                "{at} {spread}"
            );
        }
    }
    // Exactly behind the eye and exactly beyond the end of the fog a lamp is what it is a little beside that.
    for z in [10.0, 101.0] {
        let [on, beside] = [0.0, 1e-4]
            .map(|x| seen(lamp(dvec3(x, 0.0, z), 10.0, Distribution::Isotropic), 0.1)[12].y);
        assert!(
            on > 0.0 && (on / beside - 1.0).abs() < 1e-3,
            "{z}: {on} {beside}"
        );
    }
    // A beam of 180 degrees and q = 1 is the same in all directions.
    let at = dvec3(0.3, 0.4, -3.0);
    let whole = seen(lamp(at, 10.0, spot(180.0, 1.0)), 0.1);
    let even = seen(lamp(at, 10.0, Distribution::Isotropic), 0.1);
    assert!(relative_rmse(&whole, &even) < 1e-4);
}
