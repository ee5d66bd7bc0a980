//! Luminous intensity by direction: formulas against themselves written otherwise, poses, tables.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;
use tyndall::photometry::{Distribution, Goniometer, Pose, Table};

const DEG: f64 = PI / 180.0;

fn spot(spread: f64, sharpness: f64) -> Distribution {
    Distribution::NishitaSpot { spread, sharpness }
}

fn daisy(petals: u32, ratio: f64) -> Distribution {
    Distribution::Daisy {
        spread: 40.0 * DEG,
        sharpness: 0.3,
        petals,
        ratio,
    }
}

fn dots(spread: f64, petals: u32, ratio: f64, rings: u32) -> Distribution {
    Distribution::PolkaDots {
        spread,
        sharpness: 0.6,
        petals,
        ratio,
        rings,
    }
}

fn elliptical(a: f64, b: f64, sharpness: f64) -> Distribution {
    Distribution::Elliptical {
        spread: [a, b],
        sharpness,
    }
}

/// All kinds of formulas, with their hard cases.
fn formulas() -> Vec<Distribution> {
    let mut all = vec![Distribution::Isotropic];
    for spread in [0.0, 1e-9, 0.1 * DEG, 28.0 * DEG, FRAC_PI_2, 135.0 * DEG, PI] {
        for sharpness in [0.0, 0.25, 1.0] {
            all.push(spot(spread, sharpness));
            for (petals, ratio) in [(1, 0.0), (10, -1.0), (12, 0.5), (2, 1.0), (3, -4.0)] {
                all.push(Distribution::Daisy {
                    spread,
                    sharpness,
                    petals,
                    ratio,
                });
                for rings in [1, 4] {
                    all.push(Distribution::PolkaDots {
                        spread,
                        sharpness,
                        petals: 2 * petals,
                        ratio,
                        rings,
                    });
                }
            }
            for other in [spread, 0.5 * spread] {
                let pair = elliptical(spread, other, sharpness);
                all.extend(pair.check().is_ok().then_some(pair));
            }
        }
    }
    all
}

#[test]
fn a_spot_is_equation_7_and_nothing_outside() {
    for gamma in [1.0, 28.0, 90.0, 179.0] {
        for q in [0.0, 0.25, 1.0] {
            let spot = spot(gamma * DEG, q);
            for i in 0..=180 {
                let theta = f64::from(i);
                let (c, edge) = ((theta * DEG).cos(), (gamma * DEG).cos());
                let exact = match theta <= gamma {
                    true => (1.0 - q) * (c - edge) / (1.0 - edge) + q,
                    false => 0.0,
                };
                let found = spot.relative(theta * DEG, 1.0);
                assert!(
                    (found - exact).abs() < 1e-12,
                    "{gamma} {q} {theta}: {found} {exact}"
                );
            }
            assert_eq!(spot.relative(0.0, 0.0), 1.0);
        }
    }
    // cos theta - cos gamma has no digit left here.
    let narrow = spot(1e-9, 0.0);
    assert!((narrow.relative(0.5e-9, 0.0) - 0.75).abs() < 1e-12);
    // A beam of no width is its axis; one of 180 degrees reaches everywhere.
    assert_eq!(spot(0.0, 0.5).relative(0.0, 0.0), 1.0);
    assert_eq!(spot(0.0, 0.5).relative(1e-300, 0.0), 0.0);
    assert!((spot(PI, 0.0).relative(FRAC_PI_2, 0.0) - 0.5).abs() < 1e-15);
}

/// Equation 8 as it is printed, for an azimuth that is not negative.
fn printed(phi: f64, period: f64, p: f64) -> f64 {
    (p + (1.0 - p) * (2.0 * (phi % period) - period).abs() / period).max(0.0)
}

#[test]
fn petals_and_dots_are_equations_8_to_10() {
    for (petals, p) in [(9, -0.3), (1, 0.2), (12, 0.5), (6, 1.0)] {
        let daisy = daisy(petals, p);
        let beam = spot(40.0 * DEG, 0.3);
        for i in 0..720 {
            let phi = f64::from(i) * 0.5 * DEG;
            let exact = beam.relative(0.4, phi) * printed(phi, TAU / f64::from(petals), p);
            for turn in [-2.0, -1.0, 0.0, 1.0] {
                let found = daisy.relative(0.4, phi + turn * TAU);
                assert!(
                    (found - exact).abs() < 1e-13,
                    "{petals} {p} {phi}: {found} {exact}"
                );
            }
        }
    }
    let (petals, rings, p, gamma) = (8, 4, -0.2, 36.0 * DEG);
    let dots = dots(gamma, petals, p, rings);
    let beam = spot(gamma, 0.6);
    for i in 0..360 {
        for j in 0..40 {
            let (phi, theta) = ((f64::from(i) + 0.3) * DEG, (f64::from(j) + 0.2) * DEG);
            let (a, b) = (TAU / f64::from(petals), gamma / f64::from(rings));
            let v = ((phi / a).round() + (theta / b).round()) % 2.0;
            let exact = beam.relative(theta, phi) * printed(phi, a, p) * printed(theta, b, p) * v;
            for turn in [-1.0, 0.0] {
                let found = dots.relative(theta, phi + turn * TAU);
                assert!(
                    (found - exact).abs() < 1e-13,
                    "{phi} {theta}: {found} {exact}"
                );
            }
        }
    }
}

#[test]
fn no_dot_is_cut_in_half_and_there_is_no_seam() {
    // Round its middle a dot is the same on both sides, at phi = 0 too, and dark at the ends of its cell.
    let (petals, rings, gamma) = (8, 5, 50.0 * DEG);
    let flat = Distribution::PolkaDots {
        spread: gamma,
        sharpness: 1.0,
        petals,
        ratio: 0.0,
        rings,
    };
    let (a, b) = (TAU / f64::from(petals), gamma / f64::from(rings));
    for i in -8_i32..8 {
        for j in 1..5 {
            let (phi, theta) = (f64::from(i) * a, f64::from(j) * b);
            let lit = (i + j).rem_euclid(2) == 1;
            let whole = flat.relative(theta, phi) - f64::from(u8::from(lit));
            assert!(whole.abs() < 1e-12, "{i} {j}");
            for (x, y) in [(0.1, 0.0), (0.3, 0.2), (0.0, 0.45), (0.49, 0.1)] {
                let all = [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)]
                    .map(|(s, t)| flat.relative(theta + t * y * b, phi + s * x * a));
                assert!(
                    all.iter().all(|v| (v - all[0]).abs() < 1e-12),
                    "{i} {j}: {all:?}"
                );
                assert_eq!(all[0] > 0.0, lit);
            }
        }
    }
    for d in formulas() {
        for theta in [0.0, 0.2, 1.0, 2.0, PI] {
            let [below, above, turn] = [-1e-12, 1e-12, TAU].map(|phi| d.relative(theta, phi));
            let tolerance = 1e-9 * (1.0 + 80.0);
            assert!(
                (below - above).abs() < tolerance,
                "{d:?} {theta}: {below} {above}"
            );
            assert!(
                (turn - above).abs() < tolerance,
                "{d:?} {theta}: {turn} {above}"
            );
        }
    }
}

#[test]
fn a_headlight_is_a_spot_in_every_plane_through_its_axis() {
    let (a, b, q) = (20.0 * DEG, 8.0 * DEG, 0.2);
    let lamp = elliptical(a, b, q);
    for i in 0..360 {
        let phi = f64::from(i) * DEG;
        let inverse = (phi.cos() / a.tan()).powi(2) + (phi.sin() / b.tan()).powi(2);
        let gamma = inverse.sqrt().recip().atan();
        for theta in [0.0, 0.05, 0.13, 0.2, 0.3, 0.5] {
            let exact = spot(gamma, q).relative(theta, 0.0);
            assert!(
                (lamp.relative(theta, phi) - exact).abs() < 1e-12,
                "{i} {theta}"
            );
        }
    }
    // a toward `around`, b across; equal angles of any size are a spot.
    assert!(lamp.relative(19.0 * DEG, 0.0) > 0.0 && lamp.relative(19.0 * DEG, FRAC_PI_2) == 0.0);
    for spread in [0.0, 30.0, 90.0, 120.0, 180.0] {
        let (round, spot) = (
            elliptical(spread * DEG, spread * DEG, q),
            spot(spread * DEG, q),
        );
        for i in 0..=36 {
            let theta = f64::from(i) * 4.97 * DEG;
            let off = round.relative(theta, 0.7) - spot.relative(theta, 0.7);
            assert!(off.abs() < 1e-12, "{spread} {i}: {off}");
        }
        assert!((round.flux() - spot.flux()).abs() < 1e-12);
    }
}

/// The integral over the sphere by the midpoint rule in so many cos theta and phi, within `cone`.
fn counted(d: &Distribution, cone: f64, [n, m]: [usize; 2]) -> f64 {
    let height = 2.0 * (0.5 * cone).sin().powi(2);
    let cell = |i: usize, j: usize| {
        let depth = (i as f64 + 0.5) / n as f64 * height;
        // From 1 - cos theta, which keeps its digits near the axis.
        let theta = 2.0 * (0.5 * depth).sqrt().asin();
        d.relative(theta, (j as f64 + 0.5) / m as f64 * TAU)
    };
    let row = |i: usize| (0..m).map(|j| cell(i, j)).sum::<f64>();
    (0..n).map(row).sum::<f64>() * height * TAU / (n * m) as f64
}

#[test]
fn flux_is_the_integral_over_the_sphere() {
    assert_eq!(Distribution::Isotropic.flux(), 4.0 * PI);
    // 2 pi (1 - cos gamma) (1 + q) / 2.
    assert!((spot(60.0 * DEG, 1.0).flux() - PI).abs() < 1e-14);
    assert!((spot(PI, 0.0).flux() - 2.0 * PI).abs() < 1e-14);
    // Of small sharp beams with one ring, where sin theta is theta: pi gamma^2 / 8 and / 32.
    for (ratio, share) in [(0.0, 8.0), (-1.0, 32.0)] {
        let small = Distribution::PolkaDots {
            spread: 1e-4,
            sharpness: 1.0,
            petals: 6,
            ratio,
            rings: 1,
        };
        let off = small.flux() / (PI * 1e-8 / share) - 1.0;
        assert!(off.abs() < 1e-8, "{ratio}: {off}");
    }
    for d in formulas() {
        let flux = d.flux();
        let cone = d.cone();
        assert!(
            flux.is_finite()
                && flux >= 0.0
                && flux <= TAU * 2.0 * (0.5 * cone).sin().powi(2) + 1e-12
        );
        if cone > 0.0 {
            // Steps of phi end where patterns bend or end.
            let rough = counted(&d, cone, [2000, 240]);
            let off = (flux - rough).abs();
            assert!(off < 6e-3 * flux, "{d:?}: {flux} {rough}");
        }
    }
}

#[test]
fn intensity_is_finite_within_its_peak_and_nothing_outside_its_cone() {
    for d in formulas() {
        d.check().expect("it is in the domain");
        for i in 0..=200 {
            let theta = f64::from(i) / 200.0 * PI;
            for phi in [-1e9, -7.0, -PI, -0.0, 0.0, 0.4, PI, 9.0, 1e9] {
                let value = d.relative(theta, phi);
                assert!(
                    (0.0..=d.peak()).contains(&value),
                    "{d:?} {theta} {phi}: {value}"
                );
                assert!(value == 0.0 || theta <= d.cone() * (1.0 + 1e-15), "{d:?}");
            }
        }
    }
}

#[test]
fn what_is_outside_a_domain_says_its_range_and_the_way_out() {
    for (bad, words) in [
        (spot(-0.1, 0.5), "spread is -5.7"),
        (spot(3.2, 0.5), "0 to 180 degrees"),
        (spot(f64::NAN, 0.5), "spread is NaN degrees"),
        (spot(1.0, 1.1), "sharpness is 1.1, outside 0 to 1"),
        (daisy(0, 0.0), "petals is 0, outside 1 to 1000"),
        (daisy(5, 1.5), "ratio is 1.5"),
        (daisy(5, f64::NEG_INFINITY), "ratio is -inf"),
        (
            dots(1.0, 7, 0.0, 3),
            "petals is 7, outside the even numbers",
        ),
        (dots(1.0, 8, 0.0, 0), "rings is 0, outside 1 to 1000"),
        (elliptical(2.0, 1.0, 0.5), "two angles up to 90 degrees"),
        (elliptical(0.2, 4.0, 0.5), "spread is 229"),
    ] {
        let error = bad.check().expect_err("it is outside");
        assert!(
            error.is_input() && error.to_string().contains(words),
            "{error}"
        );
        assert!(!error.remedy().is_empty());
    }
}

#[test]
fn a_pose_is_right_handed_and_keeps_to_the_contract() {
    let close = |a: DVec3, b: DVec3| (a - b).length() < 1e-15;
    // A hanging lamp: phi = 90 degrees is at +Z, so that C90 of a file, which turns the other way, is at -Z.
    let hanging = Pose::new(DVec3::NEG_Y, None).expect("a pose");
    assert!(close(hanging.around, DVec3::X) && close(hanging.third, DVec3::Z));
    assert_eq!(hanging.angles(DVec3::Z).1, FRAC_PI_2);
    for x in [DVec3::X, DVec3::NEG_X, DVec3::new(-3.0, 1e-9, 0.0)] {
        let along = Pose::new(x, None).expect("a pose");
        assert!((along.around - DVec3::NEG_Z).length() < 1e-9, "{along:?}");
    }
    // Of `around` the part across the axis counts.
    let tilted = Pose::new(DVec3::new(0.0, -2.0, 0.0), Some(DVec3::new(0.0, 5.0, 7.0)));
    assert!(close(tilted.expect("a pose").around, DVec3::Z));

    for (toward, around) in [
        (DVec3::new(0.3, -2.0, 0.7), Some(DVec3::new(-1.0, 0.2, 5.0))),
        (DVec3::new(1e-200, 3e-200, 0.0), None),
        (
            DVec3::new(1e200, -3e200, 1e200),
            Some(DVec3::new(1e200, -3e200, 1.00001e200)),
        ),
        (DVec3::new(1.0, 1e-5, 0.0), None),
    ] {
        let pose = Pose::new(toward, around).expect("a pose");
        let Pose {
            toward: t,
            around: a,
            third: b,
        } = pose;
        for (v, w) in [(t, a), (a, b), (b, t)] {
            assert!(
                v.dot(w).abs() < 4e-16 && (v.length() - 1.0).abs() < 4e-16,
                "{pose:?}"
            );
        }
        assert!(close(t.cross(a), b));
        for theta in [0.0, 1e-12, 0.3, FRAC_PI_2, 3.0, PI - 1e-9] {
            for phi in [-3.0, -1.0, 0.0, 2.0] {
                for length in [1e-9, 1.0, 1e9] {
                    let (found, azimuth) = pose.angles(length * pose.direction(theta, phi));
                    assert!(
                        (found - theta).abs() < 1e-15 + 4e-16 * theta,
                        "{theta}: {found}"
                    );
                    let off = (azimuth - phi).abs() * theta.sin();
                    assert!(off < 1e-15, "{theta} {phi}: {azimuth}");
                }
            }
        }
        assert_eq!(pose.angles(DVec3::ZERO), (0.0, 0.0));
    }
    for (toward, around, words) in [
        (DVec3::ZERO, None, "toward is [0, 0, 0]"),
        (DVec3::splat(f64::NAN), None, "toward is [NaN"),
        (
            DVec3::Y,
            Some(DVec3::new(0.0, -3.0, 0.0)),
            "outside the directions across toward",
        ),
        (DVec3::Y, Some(DVec3::ZERO), "around is [0, 0, 0]"),
    ] {
        let error = Pose::new(toward, around).expect_err("no pose");
        assert!(error.to_string().contains(words), "{error}");
    }
}

fn table(goniometer: Goniometer, horizontal: &[f64], vertical: &[f64], candela: &[f64]) -> Table {
    let [h, v, c] = [horizontal, vertical, candela].map(<[f64]>::to_vec);
    Table::new(goniometer, h, v, c).expect("a table")
}

#[test]
fn a_table_lies_about_its_axis_as_its_type_says() {
    // One bright direction each: C90 and gamma 90; H and V 45.
    let c = table(
        Goniometer::C,
        &[0.0, 90.0, 180.0, 270.0, 360.0],
        &[0.0, 90.0, 180.0],
        &[0., 1., 0., 0., 2., 0., 0., 3., 0., 0., 4., 0., 0., 1., 0.],
    );
    let pose = Pose::new(DVec3::NEG_Y, Some(DVec3::X)).expect("a pose");
    let lamp = Distribution::Table(Arc::new(c));
    for (direction, candela) in [
        (DVec3::X, 1.0),
        (DVec3::NEG_Z, 2.0),
        (DVec3::NEG_X, 3.0),
        (DVec3::Z, 4.0),
    ] {
        assert!(
            (lamp.intensity(&pose, direction) - candela).abs() < 1e-12,
            "{direction}"
        );
    }
    // Straight ahead -Z, up +Y, so that right is +X: a headlight of a car that goes north.
    let car = Pose::new(DVec3::NEG_Z, Some(DVec3::Y)).expect("a pose");
    assert!((car.third - DVec3::X).length() < 1e-15);
    let (s, c) = (20.0 * DEG).sin_cos();
    let (t, d) = (35.0 * DEG).sin_cos();
    for (goniometer, direction) in [
        // H = 20, V = 35.
        (Goniometer::A, DVec3::new(d * s, t, -d * c)),
        (Goniometer::B, DVec3::new(s, c * t, -c * d)),
    ] {
        let values = [0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0];
        let bright = table(
            goniometer,
            &[-20.0, 20.0, 60.0],
            &[0.0, 35.0, 70.0],
            &values,
        );
        let (theta, phi) = car.angles(direction);
        let (h, v) = bright.angles(theta, phi);
        assert!(
            (h - 20.0).abs() < 1e-12 && (v - 35.0).abs() < 1e-12,
            "{goniometer:?} {h} {v}"
        );
        let lamp = Distribution::Table(Arc::new(bright));
        assert!((lamp.intensity(&car, direction) - 5.0).abs() < 1e-12);
        let other = direction * DVec3::new(-1.0, 1.0, 1.0);
        assert!(lamp.intensity(&car, other) < 1e-12, "{goniometer:?}");
    }
}

#[test]
fn a_table_is_bilinear_in_degrees_and_nothing_outside() {
    let t = table(
        Goniometer::C,
        &[0.0, 120.0, 360.0],
        &[10.0, 30.0],
        &[100.0, 200.0, 300.0, 500.0, 100.0, 200.0],
    );
    assert_eq!(t.at(0.0, 10.0), 100.0);
    assert_eq!(t.at(60.0, 20.0), 275.0);
    assert_eq!(t.at(240.0, 30.0), 350.0);
    assert_eq!(t.at(-120.0, 30.0), t.at(240.0, 30.0));
    assert_eq!(t.at(3600.0, 10.0), 100.0);
    assert_eq!((t.at(0.0, 9.999), t.at(0.0, 30.001)), (0.0, 0.0));
    assert_eq!(t.cone(), 30.0 * DEG);
    assert_eq!(t.peak().candela, 500.0);
    // Files turn about minus the axis.
    assert!((t.intensity(30.0 * DEG, -120.0 * DEG) - 500.0).abs() < 1e-9);

    let flat = table(Goniometer::A, &[-30.0, 30.0], &[-10.0, 20.0], &[7.0; 4]);
    assert_eq!(
        (flat.at(31.0, 0.0), flat.at(0.0, -11.0), flat.at(30.0, 20.0)),
        (0.0, 0.0, 7.0)
    );
    // The flux of 7 cd in a rectangle of longitudes and latitudes.
    let exact = 7.0 * 60.0 * DEG * ((20.0 * DEG).sin() + (10.0 * DEG).sin());
    assert!((flat.flux() / exact - 1.0).abs() < 1e-14);
    let exact = 7.0 * 30.0 * DEG * 2.0 * (30.0 * DEG).sin();
    let other = table(Goniometer::B, &[-30.0, 30.0], &[-10.0, 20.0], &[7.0; 4]);
    assert!((other.flux() / exact - 1.0).abs() < 1e-14);
    let farthest = ((30.0 * DEG).cos() * (20.0 * DEG).cos()).acos();
    assert!((flat.cone() - farthest).abs() < 1e-15 && (other.cone() - farthest).abs() < 1e-15);
}

#[test]
fn the_flux_of_a_table_is_exact() {
    for goniometer in [Goniometer::A, Goniometer::B, Goniometer::C] {
        let (h, v): (Vec<f64>, Vec<f64>) = match goniometer {
            Goniometer::A => (
                vec![-180.0, -20.0, 5.0, 70.0, 180.0],
                vec![-90.0, -13.0, 40.0, 90.0],
            ),
            Goniometer::B => (
                vec![-90.0, -20.0, 5.0, 70.0, 90.0],
                vec![-180.0, -13.0, 40.0, 180.0],
            ),
            Goniometer::C => (
                vec![0.0, 20.0, 95.0, 200.0, 360.0],
                vec![0.0, 13.0, 40.0, 180.0],
            ),
        };
        let mut values: Vec<f64> = (0..20).map(|i| f64::from((i * 7 + 3) % 11)).collect();
        if goniometer == Goniometer::C {
            let first = values[..4].to_vec();
            values[16..].copy_from_slice(&first);
        }
        let table = Table::new(goniometer, h, v, values).expect("a table");
        let lamp = Distribution::Table(Arc::new(table));
        let rough = counted(&lamp, PI, [1500, 1500]);
        assert!(
            (lamp.flux() / rough - 1.0).abs() < 2e-4,
            "{goniometer:?} {} {rough}",
            lamp.flux()
        );
    }
}

#[test]
fn tables_that_are_none_are_refused() {
    let new = |g, h: &[f64], v: &[f64], c: &[f64]| {
        Table::new(g, h.to_vec(), v.to_vec(), c.to_vec())
            .expect_err("no table")
            .to_string()
    };
    let turn = [0.0, 360.0];
    for (said, words) in [
        (
            new(Goniometer::C, &[0.0], &[0.0, 1.0], &[1.0, 1.0]),
            "number of horizontal angles is 1",
        ),
        (
            new(Goniometer::C, &[0.0, 90.0], &[0.0, 1.0], &[1.0; 4]),
            "span of the horizontal angles is 90 degrees",
        ),
        (
            new(Goniometer::C, &turn, &[0.0, 181.0], &[1.0; 4]),
            "vertical angle is 181 degrees, outside 0 to 180",
        ),
        (
            new(Goniometer::C, &turn, &[1.0, 1.0], &[1.0; 4]),
            "vertical angle is 1 degrees, outside the angles above 1",
        ),
        (
            new(Goniometer::C, &turn, &[0.0, 1.0], &[1.0; 5]),
            "number of values is 5, outside 2 times 2 angles",
        ),
        (
            new(Goniometer::C, &turn, &[0.0, 1.0], &[1.0, 1.0, -1.0, 1.0]),
            "luminous intensity is -1 cd",
        ),
        (
            new(Goniometer::A, &[-1.0, f64::NAN], &[0.0, 1.0], &[1.0; 4]),
            "horizontal angle is NaN degrees",
        ),
    ] {
        assert!(said.contains(words), "{said}");
    }
}
