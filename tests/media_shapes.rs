//! Layers with waves and ellipsoids: held to sums over many small steps, and to boxes and haze of equal shape.

mod common;

use common::build::*;
use common::files::Folder;
use common::shafts;
use glam::{DQuat, DVec2, DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::beam::Beam;
use tyndall::conditions::Conditions;
use tyndall::effect::Field;
use tyndall::medium::{Air, Edge, Medium, Phase, Scattering, Shape, Wave};
use tyndall::photometry::{Distribution, Pose};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::penumbra::NODES;
use tyndall::scene::{Camera, LampEntry, LampForm, Scene};
use tyndall::studies::scenes::fog;

const DEG: f64 = PI / 180.0;
const HAZY: Phase = Phase::HenyeyGreenstein { g: 0.5 };

fn layer_of(top: f64, waves: Vec<Wave>, bottom: Option<f64>) -> Shape {
    Shape::Layer {
        top,
        waves,
        bottom,
        far: 1e5,
    }
}

fn waves() -> Vec<Wave> {
    vec![
        Wave::new(0.18, 3.1, 20.0 * DEG, 0.3),
        Wave::new(0.1, 1.7, -65.0 * DEG, 2.0),
        Wave::new(0.05, 0.6, 130.0 * DEG, 4.0),
    ]
}

fn turned(edge: Edge) -> Shape {
    Shape::Ellipsoid {
        center: dvec3(0.4, 1.2, -0.3),
        radii: dvec3(2.0, 0.5, 1.1),
        rotation: DQuat::from_rotation_z(0.4)
            * DQuat::from_rotation_y(1.1)
            * DQuat::from_rotation_x(-0.7),
        edge,
    }
}

/// What a shape is said to be.
fn density(shape: &Shape, p: DVec3) -> f64 {
    let inside = |is: bool| if is { 1.0 } else { 0.0 };
    match shape {
        Shape::Layer {
            top, waves, bottom, ..
        } => {
            let wave =
                |w: &Wave| w.amplitude * (w.vector.dot(DVec2::new(p.x, p.z)) + w.phase).sin();
            let boundary = top + waves.iter().map(wave).sum::<f64>();
            inside(p.y <= boundary && bottom.is_none_or(|bottom| p.y >= bottom))
        }
        Shape::Ellipsoid {
            center,
            radii,
            rotation,
            edge,
        } => {
            let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| *rotation * axis);
            let own = dvec3(
                (p - *center).dot(axes[0]) / radii.x,
                (p - *center).dot(axes[1]) / radii.y,
                (p - *center).dot(axes[2]) / radii.z,
            );
            match edge {
                Edge::Sharp => inside(own.length() <= 1.0),
                Edge::Soft => (1.0 - own.length_squared()).max(0.0),
            }
        }
        Shape::Box { min, max } => inside(p.cmpge(*min).all() && p.cmple(*max).all()),
        _ => panic!("not among these"),
    }
}

/// The integral of the density along a ray by steps; those that end on another side are cut where the border is.
fn stepped(shape: &Shape, origin: DVec3, direction: DVec3, distance: f64, steps: usize) -> f64 {
    let at = |t: f64| density(shape, origin + t * direction);
    // Simpson's rule, exact for a parabola.
    let simpson = |a: f64, b: f64| (b - a) / 6.0 * (at(a) + 4.0 * at(0.5 * (a + b)) + at(b));
    let step = distance / steps as f64;
    let mut sum = 0.0;
    for i in 0..steps {
        let (from, to) = (step * i as f64, step * (i as f64 + 1.0));
        let (first, last) = (at(from) > 0.0, at(to) > 0.0);
        if first == last {
            sum += simpson(from, to);
            continue;
        }
        let (mut a, mut b) = (from, to);
        for _ in 0..50 {
            let middle = 0.5 * (a + b);
            match (at(middle) > 0.0) == first {
                true => a = middle,
                false => b = middle,
            }
        }
        sum += if first {
            simpson(from, a)
        } else {
            simpson(b, to)
        };
    }
    sum
}

fn air(media: Vec<Medium>) -> Air {
    Air {
        media,
        ground: -5.0,
    }
}

/// Rays all over, among them level ones and steep ones.
fn rays() -> Vec<(DVec3, DVec3)> {
    let mut rays: Vec<(DVec3, DVec3)> = (0..60)
        .map(|i| {
            let part = |a: f64| (0.5 + a * f64::from(i)).fract() * 2.0 - 1.0;
            let origin = dvec3(
                4.0 * part(0.819),
                1.1 + 1.5 * part(0.671),
                4.0 * part(0.549),
            );
            let direction = dvec3(part(0.755), 0.4 * part(0.569), part(0.348));
            (origin, direction.normalize())
        })
        .collect();
    for height in [0.8, 0.95, 1.1, 1.3, 1.42] {
        rays.push((dvec3(-6.0, height, 0.3), DVec3::X));
        rays.push((dvec3(-6.0, height, 0.3), dvec3(0.8, 1e-4, 0.6).normalize()));
    }
    rays.push((dvec3(0.2, 3.0, 0.1), DVec3::NEG_Y));
    rays.push((dvec3(0.2, -3.0, 0.1), DVec3::Y));
    rays
}

#[test]
fn optical_depths_are_those_of_many_steps() {
    let shapes = [
        layer_of(1.1, waves(), None),
        layer_of(1.1, waves(), Some(0.9)),
        layer_of(1.1, vec![Wave::new(0.3, 0.9, 0.0, 1.0)], Some(-1.0)),
        turned(Edge::Sharp),
        turned(Edge::Soft),
    ];
    for shape in shapes {
        let one = air(vec![fog(shape.clone(), 0.7, 0.3, HAZY)]);
        let mut met = 0;
        for (origin, direction) in rays() {
            let distance = 12.0;
            let truth = stepped(&shape, origin, direction, distance, 40_000);
            let found = one.optical_depth(origin, direction, distance).x;
            assert!(
                (found - truth).abs() <= 1e-6 * truth + 2e-8,
                "{shape:?} {origin} {direction}: {found} {truth}"
            );
            met += usize::from(truth > 0.0);
            // A path in two parts is as thick.
            let first = one.optical_depth(origin, direction, 5.3).x;
            let rest = one
                .optical_depth(origin + 5.3 * direction, direction, distance - 5.3)
                .x;
            assert!((first + rest - found).abs() < 1e-8 + 1e-9 * found);
            if matches!(shape, Shape::Ellipsoid { .. }) || direction.y > 0.3 {
                let sun = one.sun_optical_depth(origin, direction).x;
                assert!((sun - found).abs() < 1e-8, "{sun} {found}");
            }
        }
        assert!(met > 8, "{met}");
    }
}

#[test]
fn a_ray_that_touches_or_starts_on_a_border_or_lies_in_it_has_its_length() {
    let length = |shape: &Shape, origin: DVec3, direction: DVec3, distance: f64| {
        air(vec![fog(shape.clone(), 1.0, 0.0, HAZY)])
            .optical_depth(origin, direction, distance)
            .x
    };
    // One wave along X: crests at 1.25, troughs at 0.75, half of a level ray at 1 is inside.
    let one = layer_of(1.0, vec![Wave::new(0.25, 2.0, 0.0, 0.0)], None);
    let close = |found: f64, exact: f64| {
        assert!((found - exact).abs() < 1e-6, "{found} {exact}");
    };
    close(length(&one, dvec3(0.0, 1.0, 0.0), DVec3::X, 100.0), 50.0);
    close(length(&one, dvec3(0.0, 1.0, 0.0), DVec3::X, 1.0), 1.0);
    close(length(&one, dvec3(0.0, 1.0, 0.0), DVec3::NEG_X, 1.0), 0.0);
    close(length(&one, dvec3(0.0, 1.25, 0.0), DVec3::X, 100.0), 0.0);
    close(length(&one, dvec3(0.0, 0.75, 0.0), DVec3::X, 100.0), 100.0);
    let e: f64 = 4e-12;
    close(
        length(
            &one,
            dvec3(0.0, 1.25 * (1.0 - 0.2 * e), 0.0),
            DVec3::X,
            10.0,
        ),
        10.0 / PI * (1.0 - e).acos(),
    );
    // A little below the crests: 2 acos(1 - e) / pi of each wave.
    for e in [1e-2, 1e-4, 1e-6] {
        let exact = 100.0 * (1.0f64 - e).acos() / PI;
        close(
            length(
                &one,
                dvec3(0.0, 1.0 + 0.25 * (1.0 - e), 0.0),
                DVec3::X,
                100.0,
            ),
            exact,
        );
    }
    // Along a trough and along a crest.
    close(length(&one, dvec3(0.5, 1.2, 0.0), DVec3::Z, 30.0), 30.0);
    close(length(&one, dvec3(1.5, 0.8, 0.0), DVec3::Z, 30.0), 0.0);
    // A line that touches the wave where it is steepest crosses it there once.
    let slope = dvec3(1.0, 0.25 * PI, 0.0).normalize();
    close(
        length(&one, dvec3(-1.0, 1.0 - 0.25 * PI, 0.0), slope, 50.0),
        slope.x.recip(),
    );
    // A thousand kilometres off, and for a thousand waves.
    let far = dvec3(1e6, 1.0, -1e6);
    assert!((length(&one, far, DVec3::X, 2000.0) - 1000.0).abs() < 1e-3);
    // A layer of a tenth of a millimetre.
    let thin = layer_of(1.0, vec![Wave::new(0.25, 2.0, 0.0, 0.0)], Some(1.2499));
    close(
        length(&thin, dvec3(0.0, 1.24995, 0.0), DVec3::X, 100.0),
        100.0 * (0.24995f64 / 0.25).acos() / PI,
    );
    close(
        length(&thin, dvec3(0.5, 5.0, 0.0), DVec3::NEG_Y, 100.0),
        1e-4,
    );
    // Spheres: the chord of a ray at a distance from the middle, and 4 R / 3 through the middle of a soft one.
    for (edge, exact) in [(Edge::Sharp, 2.0 * 3.0), (Edge::Soft, 4.0)] {
        let sphere = Shape::Ellipsoid {
            center: dvec3(0.0, 1.0, -20.0),
            radii: DVec3::splat(3.0),
            rotation: DQuat::from_rotation_x(0.7),
            edge,
        };
        close(
            length(&sphere, dvec3(0.0, 1.0, 0.0), DVec3::NEG_Z, 100.0),
            exact,
        );
        close(
            length(&sphere, dvec3(0.0, 1.0, -20.0), DVec3::NEG_Z, 100.0),
            0.5 * exact,
        );
        close(
            length(&sphere, dvec3(0.0, 4.0, 0.0), DVec3::NEG_Z, 100.0),
            0.0,
        );
        close(length(&sphere, dvec3(0.0, 1.0, 0.0), DVec3::Z, 100.0), 0.0);
        let half = (9.0f64 - 4.0).sqrt();
        let chord = match edge {
            Edge::Sharp => 2.0 * half,
            Edge::Soft => 2.0 * (half * (1.0 - 4.0 / 9.0) - half.powi(3) / 27.0),
        };
        close(
            length(&sphere, dvec3(2.0, 1.0, 0.0), DVec3::NEG_Z, 100.0),
            chord,
        );
    }
}

fn sun(elevation_deg: f64) -> Beam {
    let (sin, cos) = (elevation_deg * DEG).sin_cos();
    Beam::parallel(dvec3(0.8 * cos, sin, -0.6 * cos), DVec3::ONE)
}

/// Light of a beam that the media scatter on [from, to] of a ray, by steps; depths are the air's.
fn scattered(
    air: &Air,
    (origin, direction): (DVec3, DVec3),
    [from, to]: [f64; 2],
    beam: &Beam,
    steps: usize,
) -> f64 {
    let mut sum = 0.0;
    for i in 0..steps {
        let t = from + (to - from) * (i as f64 + 0.5) / steps as f64;
        let point = origin + t * direction;
        let one_minus_mu = 0.5 * (direction - beam.toward_from(point)).length_squared();
        let source: f64 = air
            .media
            .iter()
            .map(|m| m.scattering.x * density(&m.shape, point) * m.phase.value(one_minus_mu))
            .sum();
        if source > 0.0 {
            let depth =
                air.optical_depth(origin, direction, t).x + air.beam_optical_depth(point, beam).x;
            sum += source * (-depth).exp();
        }
    }
    sum * (to - from) / steps as f64
}

#[test]
fn sunlight_in_waves_and_smoke_is_that_of_many_steps() {
    let room = Shape::Box {
        min: dvec3(-3.0, 0.0, -2.0),
        max: dvec3(1.0, 1.5, 3.0),
    };
    let airs = [
        air(vec![fog(layer_of(1.1, waves(), None), 0.4, 0.1, HAZY)]),
        air(vec![fog(turned(Edge::Soft), 1.0, 0.2, HAZY)]),
        air(vec![fog(turned(Edge::Sharp), 1.0, 0.2, HAZY)]),
        air(vec![
            fog(layer_of(0.9, waves(), Some(0.6)), 0.8, 0.1, HAZY),
            fog(turned(Edge::Soft), 1.0, 0.2, Phase::Isotropic),
            fog(room, 0.2, 0.05, Phase::Rayleigh),
        ]),
        // What only takes light.
        air(vec![
            fog(turned(Edge::Sharp), 0.0, 3.0, HAZY),
            fog(layer_of(3.0, Vec::new(), Some(-3.0)), 0.1, 0.0, HAZY),
        ]),
    ];
    for (number, air) in airs.iter().enumerate() {
        for elevation in [60.0, 12.0, 3.0] {
            let beam = sun(elevation);
            let mut rays = rays();
            // Along the sun's rays, and toward it.
            let toward = beam.toward_from(DVec3::ZERO);
            rays.extend([1.0, -1.0].map(|sign| (dvec3(0.3, 1.2, 0.0), sign * toward)));
            let start = std::time::Instant::now();
            let (mut worst, mut all, mut off) = (0.0f64, 0.0, 0.0);
            for (k, ray) in rays
                .into_iter()
                .enumerate()
                .filter(|(k, _)| k % 7 == 0 || *k > 70)
            {
                let run = [0.4 * (k % 3) as f64, 9.0];
                let scattering = Scattering::new(air, ray.0, ray.1, 9.0, &beam);
                let found = scattering.integrate(run[0], run[1]).x;
                let truth = scattered(air, ray, run, &beam, 4000);
                assert!(found.is_finite() && found >= 0.0);
                worst = worst.max((found - truth).abs() / (truth + 1e-3));
                off += (found - truth).abs();
                all += truth;
                // Parts add up, and all of the light is all of its shares.
                let cuts: Vec<f64> = std::iter::once(run[0])
                    .chain(scattering.borders().filter(|t| *t > run[0] && *t < run[1]))
                    .chain([run[1]])
                    .collect();
                let shares = [DVec3::ONE; NODES.len()];
                let sum: f64 = cuts
                    .windows(2)
                    .map(|pair| {
                        scattering
                            .integrate_shares([pair[0], pair[1]], &NODES, &shares)
                            .x
                    })
                    .sum();
                for pair in cuts.windows(2) {
                    let v = scattering.integrate_shares([pair[0], pair[1]], &NODES, &shares);
                    assert!(
                        v.is_finite(),
                        "{pair:?} {v} {number} {elevation} {ray:?} {cuts:?}"
                    );
                }
                assert!((sum - found).abs() <= 1e-5 * found + 1e-9, "{sum} {found}");
            }
            eprintln!(
                "air {number}, sun at {elevation}: worst {worst:.1e}, all {:.1e}",
                off / all
            );
            assert!(
                all > 0.0 && off < 1e-3 * all && worst < 3e-3,
                "{number} {elevation}"
            );
        }
    }
}
