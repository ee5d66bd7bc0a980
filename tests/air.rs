//! The clear air over a site: its coefficients, and what the sun loses to it. Media of any shape: what lies along a ray, held to sums over
//! many small steps.

mod common;

use common::curved::{HAZY, density, fog, layer_of, rays, sun, turned, waves};
use glam::{DQuat, DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::beam::Beam;
use tyndall::colour::luminance;
use tyndall::medium::{Air, Edge, Medium, Phase, Scattering, Shape, Wave, clear};
use tyndall::scene::penumbra::NODES;
use tyndall::sky::sun::{Column, outside_the_atmosphere};
use tyndall::sky::{SunLight, SunPath};
use tyndall::units::{DEG, STANDARD_PRESSURE_HPA};

#[test]
fn the_clear_air_over_a_site_has_the_suns_own_depths() {
    let sea = SunPath::standard(40.0 * DEG, 3.0);
    let column = Column::new(&sea).unwrap();
    // Bucholtz 1995: 0.0971 at 550 nm, 0.0425 at 650, 0.1837 at 470; the green channel answers to about 540 nm.
    let [r, g, b] = column.molecules.to_array();
    assert!((0.055..0.085).contains(&r) && (0.09..0.11).contains(&g) && (0.19..0.24).contains(&b));
    // Near the ground as measured: 1.16e-5 per metre at 550 nm (Bucholtz 1995).
    let at_ground = g / clear::MOLECULES;
    assert!((at_ground / 1.16e-5 - 1.0).abs() < 0.05, "{at_ground}");
    // The aerosol's column is beta lambda^-1.3 of some wavelength of the channel, and nothing at turbidity 1.
    let beta = 0.046_083_658 * 3.0 - 0.045_860_26;
    for (tau, [short, long]) in
        column
            .aerosol
            .to_array()
            .iter()
            .zip([[0.56, 0.66], [0.52, 0.58], [0.43, 0.5f64]])
    {
        let (most, least) = (beta * short.powf(-1.3), beta * long.powf(-1.3));
        assert!((least..most).contains(tau), "{tau} {least} {most}");
    }
    let none = Column::new(&SunPath {
        turbidity: 1.0,
        ..sea
    })
    .unwrap();
    assert!(none.aerosol.max_element() < 1e-3);
    let high = Column::new(&SunPath {
        pressure_hpa: 0.5 * STANDARD_PRESSURE_HPA,
        ..sea
    })
    .unwrap();
    assert!(
        (high.molecules / column.molecules - 0.5)
            .abs()
            .max_element()
            < 1e-12
    );
    let outside = outside_the_atmosphere(1.0);
    assert!((128e3..134.5e3).contains(&luminance(outside)));

    // Above all air the sun is what it is outside the atmosphere, except for ozone and vapour, and never brighter; at any height
    // of the sun that is finite.
    for turbidity in [1.0, 2.0, 3.0, 6.0, 20.0] {
        let mut last = f64::INFINITY;
        for elevation in [-2.0, -0.3, 0.0, 0.1, 1.0, 3.0, 10.0, 30.0, 60.0, 90.0] {
            let path = SunPath::standard(elevation * DEG, turbidity);
            let column = Column::new(&path).unwrap();
            let depth: DVec3 = clear::overhead(&column, &path).unwrap().iter().sum();
            assert!(depth.is_finite() && depth.min_element() >= 0.0);
            assert!(depth.y <= last + 1e-9, "{turbidity} {elevation}");
            last = depth.y;
            let light = SunLight::new(&path).unwrap().full_illuminance;
            let above = light * depth.exp();
            assert!(
                above.cmple(outside * (1.0 + 1e-9)).all(),
                "{turbidity} {elevation}: {above}"
            );
            if elevation >= 3.0 && turbidity <= 6.0 {
                assert!(
                    luminance(above) > 0.6 * luminance(outside),
                    "{turbidity} {elevation}: {above}"
                );
            }
        }
    }
}

fn air(media: Vec<Medium>) -> Air {
    Air {
        media,
        ground: -5.0,
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
