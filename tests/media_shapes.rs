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
            let part = |a: f64| (0.5 + a * f64::from(i + 1)).fract() * 2.0 - 1.0;
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

/// Light of a beam that the media scatter on [from, to] of a ray, by steps that end at borders; depths are the air's.
fn scattered(
    air: &Air,
    (origin, direction): (DVec3, DVec3),
    [from, to]: [f64; 2],
    beam: &Beam,
    steps: usize,
) -> f64 {
    let present = |t: f64| {
        let point = origin + t * direction;
        let is_there = |m: &Medium| density(&m.shape, point) > 0.0;
        air.media.iter().map(is_there).collect::<Vec<bool>>()
    };
    let light = |t: f64| {
        let point = origin + t * direction;
        let one_minus_mu = 0.5 * (direction - beam.toward_from(point)).length_squared();
        let source: f64 = air
            .media
            .iter()
            .map(|m| m.scattering.x * density(&m.shape, point) * m.phase.value(one_minus_mu))
            .sum();
        if source == 0.0 {
            return 0.0;
        }
        let before = air.optical_depth(origin, direction, t).x;
        source * (-before - air.beam_optical_depth(point, beam).x).exp()
    };
    let step = (to - from) / steps as f64;
    let mut sum = 0.0;
    for i in 0..steps {
        let (start, end) = (from + step * i as f64, from + step * (i as f64 + 1.0));
        let (mut a, mut b) = (start, end);
        let first = present(a);
        if first != present(b) {
            for _ in 0..45 {
                let middle = 0.5 * (a + b);
                match present(middle) == first {
                    true => a = middle,
                    false => b = middle,
                }
            }
            sum += (a - start) * light(0.5 * (start + a)) + (end - b) * light(0.5 * (b + end));
        } else {
            sum += step * light(0.5 * (start + end));
        }
    }
    sum
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
            let (mut worst, mut all, mut off) = (0.0f64, 0.0, 0.0);
            for (k, ray) in rays
                .into_iter()
                .enumerate()
                .filter(|(k, _)| k % 7 == 0 || *k > 70)
            {
                let run = [0.4 * (k % 3) as f64, 9.0];
                let scattering = Scattering::new(air, ray.0, ray.1, 9.0, &beam);
                let found = scattering.integrate(run[0], run[1]).x;
                let truth = scattered(air, ray, run, &beam, 3000);
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
                assert!((sum - found).abs() <= 1e-5 * found + 1e-9, "{sum} {found}");
            }
            eprintln!(
                "air {number}, sun at {elevation}: worst {worst:.1e}, all {:.1e}",
                off / all
            );
            assert!(
                all > 0.0 && off < 1e-4 * all && worst < 1e-3,
                "{number} {elevation}"
            );
        }
    }
}

fn lamp(position: DVec3) -> LampEntry {
    LampEntry {
        name: "lamp".into(),
        position,
        toward: dvec3(0.2, -1.0, 0.1),
        around: None,
        intensity: DVec3::splat(100.0),
        distribution: Distribution::NishitaSpot {
            spread: 40.0 * DEG,
            sharpness: 0.3,
        },
        form: LampForm::Point,
        ignore: None,
    }
}

/// A speck far below, so that there is a mesh.
fn nothing() -> Scene {
    let speck = cuboid(dvec3(0.0, -1e3, 0.0), dvec3(0.01, -999.99, 0.01));
    let mut scene = scene(&speck, 0.0, 0.0);
    scene.sun = None;
    scene
}

fn picture(conditions: &Conditions, without: &[&str]) -> tyndall::frame::Frame {
    let overrules = Overrules {
        quality: Quality::High,
        without: without.iter().map(|name| name.to_string()).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(conditions, &overrules).expect("the plan is sound");
    let reference = tyndall::backend::reference::Reference::new(&plan).expect("it can be prepared");
    let rendered = reference.render(&tyndall::backend::Limits::default(), &|_| {});
    let frame = rendered.expect("it fits into memory").frame;
    frame.check().expect("every value is sound");
    frame
}

#[test]
fn a_spot_in_waves_and_smoke_is_that_of_many_steps() {
    let position = dvec3(0.3, 2.6, -0.2);
    for shape in [layer_of(1.1, waves(), Some(-1.0)), turned(Edge::Soft)] {
        let mut scene = nothing();
        scene.media = vec![fog(shape.clone(), 0.5, 0.1, HAZY)];
        scene.lamps = vec![lamp(position)];
        let camera = Camera::look_at(dvec3(0.5, 1.9, 5.5), dvec3(0.3, 0.9, 0.0), 45.0 * DEG);
        let seen = conditions(scene, camera, [8, 6]);
        let found = layer(
            &picture(&seen, &["air_sky", "radiosity"]),
            Field::InscatterLights,
        );
        let lamp = lamp(position);
        let pose = Pose::new(lamp.toward, lamp.around).expect("it has a direction");
        let beam = Beam::local(position, DVec3::ONE);
        let air = &seen.air;
        let (mut off, mut all) = (0.0, 0.0);
        for (i, found) in (0..48).zip(&found) {
            let ray = seen
                .view
                .ray(DVec2::new(f64::from(i % 8) + 0.5, f64::from(i / 8) + 0.5));
            const STEPS: usize = 20_000;
            let step = 12.0 / STEPS as f64;
            let mut truth = 0.0;
            for k in 0..STEPS {
                let t = step * (k as f64 + 0.5);
                let point = ray.at(t);
                let way = position - point;
                let intensity = 100.0 * lamp.distribution.intensity(&pose, -way);
                let source = 0.5 * density(&shape, point) * intensity;
                if source > 0.0 {
                    let toward = way.normalize();
                    let phase = HAZY.value(0.5 * (ray.direction - toward).length_squared());
                    let depth = air.optical_depth(ray.origin, ray.direction, t).x
                        + air.beam_optical_depth(point, &beam).x;
                    truth += step * source * phase * (-depth).exp() / way.length_squared();
                }
            }
            off += (found.x - truth).abs();
            all += truth;
        }
        eprintln!("a spot: {:.1e}", off / all);
        assert!(all > 0.0 && off < 1e-3 * all, "{shape:?}: {off} {all}");
    }
}

#[test]
fn thick_and_empty_media_give_what_is_due() {
    let toward = dvec3(0.3, 0.9, 0.2).normalize();
    let (origin, direction) = (dvec3(0.1, 5.0, 0.2), dvec3(0.1, -1.0, 0.05).normalize());
    for shape in [
        layer_of(1.1, waves(), None),
        turned(Edge::Sharp),
        turned(Edge::Soft),
    ] {
        for sigma in [0.0, 1e-6, 1e3, 1e5, 1e9] {
            let one = air(vec![fog(
                shape.clone(),
                0.8 * sigma,
                0.2 * sigma,
                Phase::Isotropic,
            )]);
            let parallel = Beam::parallel(toward, DVec3::ONE);
            let local = Beam::local(1e4 * toward, DVec3::splat(1e8));
            for beam in [parallel, local] {
                let scattering = Scattering::new(&one, origin, direction, 20.0, &beam);
                let found = beam.strength().x * scattering.integrate(0.0, 20.0).x;
                assert!(
                    found.is_finite() && found >= 0.0,
                    "{shape:?} {sigma} {found}"
                );
                assert_eq!(found == 0.0, sigma == 0.0, "{shape:?} {sigma} {found}");
                // A thick body is a surface: albedo p / (1 + cos(n, eye) / cos(n, sun)), which lies between 0 and albedo p.
                assert!(found < 0.8 / (4.0 * PI), "{shape:?} {sigma} {found}");
                if sigma >= 1e3 && matches!(shape, Shape::Layer { .. }) {
                    assert!(found > 0.2 * 0.8 / (4.0 * PI), "{shape:?} {sigma} {found}");
                }
            }
        }
    }
    let beam = Beam::parallel(toward, DVec3::ONE);
    let wave = vec![Wave::new(1e-9, 2.0, 0.0, 0.0)]; // flat, all but
    let flat = air(vec![fog(
        layer_of(1.1, wave, None),
        1e4,
        0.0,
        Phase::Isotropic,
    )]);
    let found = Scattering::new(&flat, origin, direction, 20.0, &beam)
        .integrate(0.0, 20.0)
        .x;
    let exact = 1.0 / (4.0 * PI) / (1.0 - direction.y / toward.y);
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
}

/// A floor with a wall, under an overcast sky and a sun.
fn court(media: Vec<Medium>) -> Conditions {
    let mut triangles = cuboid(dvec3(-4.0, -0.2, -4.0), dvec3(4.0, 0.0, 4.0));
    triangles.extend(cuboid(dvec3(-1.5, 0.0, -1.0), dvec3(-1.0, 2.5, 1.0)));
    let mut scene = scene(&triangles, 250.0, 30.0);
    scene.sky.model = Some("cie:1".into());
    scene.media = media;
    let camera = Camera::look_at(dvec3(0.5, 1.6, 7.0), dvec3(0.0, 0.8, 0.0), 50.0 * DEG);
    conditions(scene, camera, [16, 12])
}

#[test]
fn a_layer_without_waves_is_haze() {
    let rgb = |shape| Medium {
        scattering: dvec3(0.1, 0.2, 0.3),
        ..fog(shape, 0.0, 0.05, HAZY)
    };
    let haze = court(vec![rgb(Shape::Haze { top: 1.2 })]);
    let still = vec![Wave::new(0.0, 2.0, 0.3, 0.4)];
    let flat = court(vec![rgb(layer_of(1.2, still, Some(haze.air.ground)))]);
    for (origin, direction) in rays() {
        assert_eq!(
            haze.air.optical_depth(origin, direction, 7.0),
            flat.air.optical_depth(origin, direction, 7.0)
        );
        let beam = sun(25.0);
        let of =
            |air: &Air| Scattering::new(air, origin, direction, 7.0, &beam).integrate(0.1, 6.0);
        assert_eq!(of(&haze.air), of(&flat.air));
    }
    let (a, b) = (picture(&haze, &[]), picture(&flat, &[]));
    let apart = |(a, b): (&glam::Vec3, &glam::Vec3)| (*a - *b).abs().max_element() > 1e-6;
    assert!(!a.transmittance.iter().zip(&b.transmittance).any(apart));
    for field in [
        Field::Sun,
        Field::Sky,
        Field::InscatterSun,
        Field::InscatterSky,
    ] {
        let (a, b) = (layer(&a, field), layer(&b, field));
        assert!(relative_rmse(&b, &a) < 1e-6, "{}", field.name());
    }
}

#[test]
fn waves_that_are_small_and_a_fog_bank_change_the_light_of_the_sky_by_little() {
    let of = |shape| picture(&court(vec![fog(shape, 0.3, 0.05, HAZY)]), &[]);
    let flat = of(layer_of(1.2, Vec::new(), None));
    let small = of(layer_of(1.2, vec![Wave::new(0.01, 1.0, 0.5, 0.0)], None));
    for field in [Field::InscatterSun, Field::InscatterSky, Field::Sky] {
        let off = relative_rmse(&layer(&small, field), &layer(&flat, field));
        eprintln!("{}: {off:.1e}", field.name());
        assert!(off > 0.0 && off < 0.02, "{}: {off}", field.name());
    }
    let smoke = of(turned(Edge::Soft));
    let light: f64 = layer(&smoke, Field::InscatterSky).iter().map(|v| v.y).sum();
    assert!(light.is_finite() && light > 0.0, "{light}");
}

#[test]
fn every_backend_makes_the_same_picture() {
    if !common::gpu("every_backend_makes_the_same_picture") {
        return;
    }
    let media = vec![
        fog(layer_of(0.7, waves(), None), 0.3, 0.05, HAZY),
        fog(turned(Edge::Soft), 1.0, 0.1, HAZY),
    ];
    let mut seen = court(media);
    let mut scene = (*seen.scene).clone();
    scene.lamps = vec![lamp(dvec3(1.0, 2.4, 0.5))];
    seen = conditions(scene, seen.view.camera, [36, 24]);
    let overrules = Overrules {
        set: LEAST.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    let plan = Plan::new(&seen, &overrules).expect("the plan is sound");
    for name in ["transmittance", "surface_sun", "shafts_rectified"] {
        let step = plan.steps.iter().find(|step| step.effect.name == name);
        let step = step.expect("it is in the plan");
        assert!(step.is_by_reference(&seen), "{name}");
        assert!(step.decision.reason.contains("curved"), "{name}");
    }
    let by_device = shafts::render(&plan).frame;
    let truth = tyndall::backend::reference::Reference::new(&plan).expect("it can be prepared");
    let truth = truth.render(&tyndall::backend::Limits::default(), &|_| {});
    let truth = truth.expect("it fits into memory").frame;
    let apart = by_device.transmittance.iter().zip(&truth.transmittance);
    let apart: f32 = apart.map(|(a, b)| (*a - *b).abs().element_sum()).sum();
    assert!(apart < 1e-3 * truth.pixels() as f32, "{apart}");
    for field in [
        Field::Sun,
        Field::Sky,
        Field::Lights,
        Field::InscatterSun,
        Field::InscatterSky,
        Field::InscatterLights,
    ] {
        let off = relative_rmse(&layer(&by_device, field), &layer(&truth, field));
        eprintln!("{}: {off:.1e}", field.name());
        assert!(off < 2e-3, "{}: {off}", field.name());
    }
}

const TOML: &str = r#"
[sun]
azimuth = 120.0
elevation = 30.0
[[medium]]
shape = "layer"
top = 1.1
waves = [{ amplitude = 0.18, wavelength = 3.1, direction = 90.0, phase = 45.0 }, { amplitude = 0.1, wavelength = 2.0 }]
bottom = 0.2
scattering = 0.25
[[medium]]
shape = "ellipsoid"
center = [0.0, 1.0, 2.0]
radii = [1.0, 2.0, 3.0]
rotation = [90.0, 0.0, 90.0]
edge = "soft"
scattering = [0.1, 0.2, 0.3]
"#;

#[test]
fn a_scene_file_says_layers_and_ellipsoids() {
    let folder = Folder::new();
    let scene = folder.load("fog.toml", TOML).expect("it loads");
    let wave = Wave::new(0.18, 3.1, 0.5 * PI, 0.25 * PI);
    let Shape::Layer {
        top,
        waves,
        bottom,
        far,
    } = &scene.media[0].shape
    else {
        panic!("{:?}", scene.media[0]);
    };
    assert_eq!((*top, *bottom, *far), (1.1, Some(0.2), 1e5));
    assert_eq!((waves.len(), waves[0]), (2, wave));
    // Its phase grows toward +Z.
    assert!((wave.vector.y - 2.0 * PI / 3.1).abs() < 1e-12 && wave.vector.x.abs() < 1e-12);
    let Shape::Ellipsoid { rotation, edge, .. } = scene.media[1].shape else {
        panic!("{:?}", scene.media[1]);
    };
    assert_eq!(edge, Edge::Soft);
    // +Y goes to +Z about X, and stays about Z; +X goes to +Y about Z.
    assert!((rotation * DVec3::Y).distance(DVec3::Z) < 1e-12);
    assert!((rotation * DVec3::X).distance(DVec3::Y) < 1e-12);
    for (from, to, place, word) in [
        ("wavelength = 3.1", "wavelength = 0.0", ":8", "wavelength"),
        ("wavelength = 2.0", "wavelenght = 2.0", ":8", "wavelength"),
        ("bottom = 0.2", "bottom = 2.0", ":9", "crest"),
        ("edge = \"soft\"", "edge = \"softly\"", ":16", "soft"),
        ("radii = [1.0", "radii = [-1.0", ":14", "radii"),
        ("top = 1.1\n", "", ":5", "top"),
    ] {
        let text = TOML.replace(from, to);
        assert_ne!(text, TOML);
        let error = folder.refused("fog.toml", &text);
        assert!(
            error.contains(place) && error.contains(word),
            "{from}: {error}"
        );
    }
}
