//! The integrals against what they are defined by.

use super::*;
use crate::beam::Beam;

/// A plain midpoint rule over the definition, to check the closed forms with.
fn midpoint(air: &Air, o: DVec3, r: DVec3, a: f64, b: f64, sun: DVec3, n: usize) -> DVec3 {
    let one_minus_mu = 0.5 * (r - sun).length_squared();
    (0..n)
        .map(|i| {
            let t = a + (b - a) * (i as f64 + 0.5) / n as f64;
            let p = o + t * r;
            let mut source = DVec3::ZERO;
            for medium in &air.media {
                let density = match medium.shape {
                    Shape::Layer { .. } | Shape::Ellipsoid { .. } => air.density(medium, p),
                    Shape::Box { min, max } => {
                        f64::from(u8::from(p.cmpge(min).all() && p.cmple(max).all()))
                    }
                    Shape::Haze { top } => f64::from(u8::from(p.y >= air.ground && p.y <= top)),
                    Shape::Height {
                        base, scale_height, ..
                    }
                    | Shape::Air {
                        base, scale_height, ..
                    } => (-(p.y - base) / scale_height).exp(),
                };
                source += medium.scattering * density * medium.phase.value(one_minus_mu);
            }
            let depth = air.optical_depth(o, r, t) + air.sun_optical_depth(p, sun);
            source * (-depth).exp()
        })
        .sum::<DVec3>()
        * ((b - a) / n as f64)
}

fn medium(shape: Shape, scattering: DVec3) -> Medium {
    Medium {
        shape,
        scattering,
        absorption: DVec3::splat(0.003),
        phase: Phase::HenyeyGreenstein { g: 0.6 },
    }
}

#[test]
fn pieces_agree_with_the_definition_for_boxes_haze_and_height() {
    let room = Shape::Box {
        min: DVec3::new(-4.0, 0.0, -5.0),
        max: DVec3::new(4.0, 4.0, 5.0),
    };
    let height = Shape::Height {
        base: 0.0,
        scale_height: 7.0,
        far: 1e3,
    };
    let grey = DVec3::splat(0.04);
    let colored = DVec3::new(0.02, 0.05, 0.11);
    let airs = [
        vec![medium(room.clone(), grey)],
        vec![medium(Shape::Haze { top: 6.0 }, colored)],
        vec![medium(height.clone(), colored)],
        vec![
            medium(room, grey),
            medium(Shape::Haze { top: 3.0 }, colored),
            medium(height, grey),
        ],
    ];
    let suns = [
        DVec3::new(0.3, 0.5, -0.8),
        DVec3::new(-0.9, 0.1, 0.2),
        DVec3::Y,
    ];
    let rays = [
        (DVec3::new(0.5, 1.5, 9.0), DVec3::new(0.1, 0.02, -1.0)),
        (DVec3::new(-7.0, 2.0, 1.0), DVec3::new(1.0, 0.0, 0.0)),
        (DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.0, -1e-9, 1.0)),
        (DVec3::new(0.0, 9.0, 0.0), DVec3::new(0.2, -1.0, 0.3)),
    ];
    for media in airs {
        let air = Air { media, ground: 0.0 };
        for sun in suns.map(DVec3::normalize) {
            for (o, r) in rays {
                let r = r.normalize();
                for (a, b) in [(0.0, 8.0), (1.3, 15.7)] {
                    let exact = Scattering::new(&air, o, r, 20.0, &Beam::parallel(sun, DVec3::ONE))
                        .integrate(a, b);
                    let dull = midpoint(&air, o, r, a, b, sun, 40_000);
                    let error = (exact - dull).abs().max_element();
                    // The midpoint rule misses a box's edge by up to half a step.
                    let allowed = 2e-4 * dull.max_element() + 1e-12;
                    assert!(error <= allowed, "{air:?} {o} {r} {sun}: {exact} {dull}");
                }
            }
        }
    }
}

#[test]
fn extreme_optical_depths_stay_finite() {
    let sun = DVec3::new(0.0, 1e-9, 1.0).normalize();
    for scattering in [0.0, 1e-300, 1e-12, 1e5, 1e300] {
        for r in [DVec3::Z, DVec3::X, DVec3::NEG_Y, sun, -sun] {
            let mut fog = medium(Shape::Haze { top: 1e3 }, DVec3::splat(scattering));
            fog.absorption = DVec3::ZERO;
            let mut thin = fog.clone();
            thin.shape = Shape::Height {
                base: 0.0,
                scale_height: 50.0,
                far: 1e5,
            };
            for media in [vec![fog.clone()], vec![thin.clone()], vec![fog, thin]] {
                let air = Air {
                    media,
                    ground: -10.0,
                };
                let sum = Scattering::new(
                    &air,
                    DVec3::Y * 9e3,
                    r,
                    FARTHEST,
                    &Beam::parallel(sun, DVec3::ONE),
                )
                .integrate(0.0, FARTHEST);
                assert!(
                    sum.is_finite() && sum.min_element() >= 0.0,
                    "{scattering} {r} {sum}"
                );
                let depth = air.optical_depth(DVec3::Y * 9e3, r, FARTHEST);
                assert!(!(-depth).exp().is_nan(), "{depth}");
            }
        }
    }
}

/// The two species of a clear air, made up.
fn clear_air() -> Vec<Medium> {
    let species = |scale_height, overhead, scattering| Medium {
        shape: Shape::Air {
            base: 2.0,
            scale_height,
            far: 500.0,
            overhead,
        },
        scattering,
        absorption: DVec3::splat(4e-4),
        phase: Phase::HenyeyGreenstein { g: 0.5 },
    };
    vec![
        species(
            90.0,
            DVec3::new(0.3, 0.8, 2.0),
            DVec3::new(1e-3, 2e-3, 5e-3),
        ),
        species(
            12.0,
            DVec3::new(1.3, 1.5, 1.9),
            DVec3::new(8e-3, 8e-3, 9e-3),
        ),
    ]
}

#[test]
fn clear_air_counts_against_the_site_and_agrees_with_its_integral_written_out() {
    let media = clear_air();
    let air = Air {
        media: media.clone(),
        ground: 2.0,
    };
    for sun in [DVec3::new(0.3, 0.5, -0.8), DVec3::new(-0.9, 0.02, 0.2)].map(DVec3::normalize) {
        for (o, r) in [
            (DVec3::new(0.0, 2.0, 0.0), DVec3::new(1.0, 0.0, 0.0)),
            (DVec3::new(0.0, 9.0, 0.0), DVec3::new(0.2, 0.5, 0.3)),
            (DVec3::new(0.0, 60.0, 0.0), DVec3::new(0.2, -0.1, 0.3)),
        ] {
            let r = r.normalize();
            let (a, b, n) = (3.0, 150.0, 20_000);
            let step = b / f64::from(n);
            let mut eye = DVec3::ZERO;
            let mut sum = DVec3::ZERO;
            for i in 0..n {
                let t = (f64::from(i) + 0.5) * step;
                let mut source = DVec3::ZERO;
                let mut extinction = DVec3::ZERO;
                let mut sun_depth = DVec3::ZERO;
                for medium in &media {
                    let Shape::Air {
                        scale_height,
                        overhead,
                        ..
                    } = medium.shape
                    else {
                        panic!("it is clear air");
                    };
                    let density = (-(o.y + t * r.y - 2.0) / scale_height).exp();
                    source += medium.scattering * density * medium.phase.value(1.0 - r.dot(sun));
                    extinction += medium.extinction() * density;
                    // From the point up, less from the site up.
                    sun_depth += overhead * density - overhead;
                }
                eye += 0.5 * step * extinction;
                if t > a {
                    sum += step * source * (-(eye + sun_depth)).exp();
                }
                eye += 0.5 * step * extinction;
            }
            let exact = Scattering::new(&air, o, r, 200.0, &Beam::parallel(sun, DVec3::ONE))
                .integrate(a, b);
            let error = ((exact - sum) / sum).abs().max_element();
            // The midpoint rule's run begins at a cell's border within half a step.
            assert!(error < 1e-3, "{o} {r} {sun}: {exact} {sum}");
        }
    }
    let toward = DVec3::new(0.0, 1e-4, 1.0).normalize();
    let depth = |y: f64| air.sun_optical_depth(DVec3::Y * y, toward);
    assert_eq!(depth(2.0), DVec3::ZERO);
    assert!(depth(50.0).max_element() < 0.0 && depth(-5.0).min_element() > 0.0);
    let overhead = DVec3::new(1.6, 2.3, 3.9);
    assert!((depth(1e9) + overhead).abs().max_element() < 1e-12);
    assert!((air.greatest_sun_gain() - 3.9f64.exp()).abs() < 1e-9);
    assert_eq!(air.sky_optical_depth(DVec3::ZERO, DVec3::Y), DVec3::ZERO);
    assert!(air.before_sky().media.is_empty());
}

#[test]
fn one_species_alone_has_the_closed_form_that_quadrature_finds() {
    for medium in clear_air() {
        let mut alone = Air {
            media: vec![medium.clone()],
            ground: 0.0,
        };
        let sun = DVec3::new(0.2, 0.1, 0.9).normalize();
        for r in [
            DVec3::X,
            DVec3::Y,
            DVec3::NEG_Y,
            sun,
            DVec3::new(1.0, 1e-9, 0.0),
        ] {
            let (o, end) = (DVec3::Y * 40.0, 38.0);
            let exact = Scattering::new(&alone, o, r, end, &Beam::parallel(sun, DVec3::ONE))
                .integrate(1.0, end);
            // A second medium that does nothing makes it a mixture.
            let mut nothing = medium.clone();
            (nothing.scattering, nothing.absorption) = (DVec3::ZERO, DVec3::ZERO);
            if let Shape::Air { overhead, .. } = &mut nothing.shape {
                *overhead = DVec3::ZERO;
            }
            alone.media.push(nothing);
            let mixed = Scattering::new(&alone, o, r, end, &Beam::parallel(sun, DVec3::ONE))
                .integrate(1.0, end);
            alone.media.pop();
            assert!(((exact - mixed) / exact).abs().max_element() < 1e-10, "{r}");
        }
    }
}

#[test]
fn sources_and_what_lies_before_the_sky_are_told_apart() {
    let mut media = clear_air();
    media.push(medium(Shape::Haze { top: 50.0 }, DVec3::splat(0.01)));
    let air = Air { media, ground: 0.0 };
    let (o, r, sun) = (DVec3::Y, DVec3::new(0.6, 0.1, 0.3).normalize(), DVec3::Y);
    let of = |air: &Air| {
        Scattering::new(air, o, r, 300.0, &Beam::parallel(sun, DVec3::ONE)).integrate(0.0, 300.0)
    };
    let (clear, other) = (
        air.with_sources(Medium::is_clear_air),
        air.with_sources(|m| !m.is_clear_air()),
    );
    assert!(
        ((of(&clear) + of(&other)) / of(&air) - 1.0)
            .abs()
            .max_element()
            < 1e-9
    );
    assert_eq!(
        clear.optical_depth(o, r, 70.0),
        air.optical_depth(o, r, 70.0)
    );
    assert_eq!(air.before_sky().media.len(), 1);
}

/// Air of one height medium.
fn thinning(base: f64, scale_height: f64, coefficient: f64) -> Air {
    Air {
        media: vec![Medium {
            shape: Shape::Height {
                base,
                scale_height,
                far: 1e6,
            },
            scattering: DVec3::splat(coefficient),
            absorption: DVec3::ZERO,
            phase: Phase::Isotropic,
        }],
        ground: base,
    }
}

#[test]
fn height_depths_are_right_along_every_slope() {
    // Horizontal, nearly so on either side, and steep: beta H (e^-a - e^-b) / r_y where that form has its digits.
    let (h, beta) = (50.0, 0.01);
    let air = thinning(0.0, h, beta);
    let o = DVec3::new(0.0, 20.0, 0.0);
    let flat = beta * (-20.0f64 / h).exp() * 1000.0;
    for exponent in 3..=15 {
        for sign in [1.0, -1.0] {
            let y = sign * 10f64.powi(-exponent);
            let r = DVec3::new((1.0 - y * y).sqrt(), y, 0.0);
            let depth = air.optical_depth(o, r, 1000.0).x;
            let k = 1000.0 * y / h;
            let series = flat * (1.0 - k / 2.0 + k * k / 6.0 - k.powi(3) / 24.0);
            assert!((depth / series - 1.0).abs() < 1e-8, "{y}: {depth} {series}");
        }
    }
    assert!((air.optical_depth(o, DVec3::X, 1000.0).x / flat - 1.0).abs() < 1e-14);
    // Straight up for ever, and straight down from 9 km and from space.
    let up = air.optical_depth(o, DVec3::Y, FARTHEST).x;
    assert!((up / (beta * h * (-20.0f64 / h).exp()) - 1.0).abs() < 1e-12);
    for from in [9e3, 4e8] {
        let down = air.optical_depth(DVec3::Y * from, DVec3::NEG_Y, from).x;
        assert!((down / (beta * h) - 1.0).abs() < 1e-12, "{from}: {down}");
    }
}

#[test]
fn depths_add_up_and_never_fall() {
    let air = thinning(3.0, 30.0, 0.02);
    for r in [
        DVec3::X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::new(0.8, -0.6, 0.0),
        DVec3::new(1.0, 1e-9, 0.0),
    ] {
        let o = DVec3::Y * 40.0;
        let depth = |t: f64| air.optical_depth(o, r, t).x;
        let mut last = 0.0;
        for i in 1..100 {
            let (a, b) = (0.7 * f64::from(i), 1.9 * f64::from(i));
            let rest = air.optical_depth(o + a * r, r, b - a).x;
            assert!((depth(a) + rest - depth(b)).abs() <= 1e-12 * depth(b));
            assert!(depth(b) >= last);
            last = depth(b);
        }
    }
}

#[test]
fn a_scale_height_without_end_is_homogeneous_and_one_of_nothing_is_a_layer() {
    let sun = DVec3::new(0.2, 0.6, 0.5).normalize();
    let (o, r) = (DVec3::Y * 2.0, DVec3::new(0.7, 0.2, -0.4).normalize());
    // The sun's depth through endless air is left out: what is compared is the way to the eye.
    let air = thinning(0.0, 1e12, 0.03);
    assert!((air.optical_depth(o, r, 40.0).x / (0.03 * 40.0) - 1.0).abs() < 1e-10);
    // Under the clear air's rule there is no such depth: the integral of a homogeneous medium to the eye.
    let mut still = air.clone();
    still.media[0].shape = Shape::Air {
        base: 0.0,
        scale_height: 1e12,
        far: 1e6,
        overhead: DVec3::ZERO,
    };
    let found = Scattering::new(&still, o, r, 40.0, &Beam::parallel(sun, DVec3::ONE))
        .integrate(0.0, 40.0)
        .x;
    let expected = (1.0 - (-0.03f64 * 40.0).exp()) / (4.0 * std::f64::consts::PI);
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    // A layer of optical depth beta H, met under the angle of the ray.
    let thin = thinning(10.0, 1e-4, 0.5e4);
    let above = thin.optical_depth(DVec3::Y * 30.0, -r, 20.0 / r.y).x;
    assert!((above / (0.5 / r.y) - 1.0).abs() < 1e-9, "{above}");
    assert_eq!(thin.optical_depth(DVec3::Y * 30.0, r, 1e3).x, 0.0);
}

#[test]
fn a_sun_that_sinks_dims_height_air_evenly_down_to_nothing() {
    let air = thinning(0.0, 1200.0, 1e-4);
    let (o, r) = (DVec3::Y * 2.0, DVec3::new(1.0, 0.05, 0.0).normalize());
    let mut last = f64::INFINITY;
    for i in 0..200 {
        let y = 0.5 * 0.8f64.powi(i);
        let sun = DVec3::new(0.0, y, (1.0 - y * y).sqrt());
        let light = Scattering::new(&air, o, r, 5e4, &Beam::parallel(sun, DVec3::ONE))
            .integrate(0.0, 5e4)
            .x;
        assert!(
            light.is_finite() && light >= 0.0 && light <= last,
            "{y}: {light} {last}"
        );
        last = light;
    }
    for sun in [DVec3::Z, DVec3::new(0.0, -0.2, 1.0).normalize()] {
        assert_eq!(
            Scattering::new(&air, o, r, 5e4, &Beam::parallel(sun, DVec3::ONE)).integrate(0.0, 5e4),
            DVec3::ZERO
        );
    }
}

#[test]
fn boxes_hold_the_eye_are_touched_at_a_corner_and_may_be_thin() {
    let fog = |min: DVec3, max: DVec3| Air {
        media: vec![medium(Shape::Box { min, max }, DVec3::splat(0.04))],
        ground: 0.0,
    };
    let sun = DVec3::new(0.3, 0.8, 0.2).normalize();
    let cube = fog(DVec3::ZERO, DVec3::splat(2.0));
    let sigma = 0.043;
    assert!((cube.optical_depth(DVec3::ONE, DVec3::X, 9.0).x - sigma).abs() < 1e-15);
    // Through the corner (2, 2) alone, and along an edge.
    let touch = DVec3::new(1.0, -1.0, 0.0).normalize();
    let from = DVec3::new(2.0, 2.0, 1.0) - 3.0 * touch;
    assert!(cube.optical_depth(from, touch, 9.0).x < 1e-14);
    let light = Scattering::new(&cube, from, touch, 9.0, &Beam::parallel(sun, DVec3::ONE))
        .integrate(0.0, 9.0);
    assert!(light.is_finite() && light.x < 1e-14);
    let edge = Scattering::new(
        &cube,
        DVec3::new(2.0, 2.0, -3.0),
        DVec3::Z,
        9.0,
        &Beam::parallel(sun, DVec3::ONE),
    );
    assert!(edge.integrate(0.0, 9.0).is_finite());
    // As thin as numbers can be: nothing.
    let sheet = fog(DVec3::ZERO, DVec3::new(2.0, f64::MIN_POSITIVE, 2.0));
    for r in [DVec3::Y, DVec3::X, sun] {
        let o = DVec3::new(1.0, 0.0, 1.0) - 0.5 * r;
        let light = Scattering::new(&sheet, o, r, 9.0, &Beam::parallel(sun, DVec3::ONE))
            .integrate(0.0, 9.0);
        assert!(light.is_finite() && light.min_element() >= 0.0);
    }
}

#[test]
fn air_that_nothing_passes_shows_its_own_first_skin() {
    // At depth 1e5 all of the light comes from where the sun's own depth is nothing: a box's face toward sun and eye.
    let fog = Air {
        media: vec![Medium {
            shape: Shape::Box {
                min: DVec3::ZERO,
                max: DVec3::splat(2.0),
            },
            scattering: DVec3::splat(4e4),
            absorption: DVec3::splat(1e4),
            phase: Phase::Isotropic,
        }],
        ground: 0.0,
    };
    // Seen from above, sun at the zenith angle of cosine c: p albedo / (1 + 1 / c), half-infinite.
    for c in [1.0, 0.5, 0.1] {
        let sun = DVec3::new((1.0f64 - c * c).sqrt(), c, 0.0);
        let eye = DVec3::new(0.1, 3.0, 1.0);
        let found = Scattering::new(
            &fog,
            eye,
            DVec3::NEG_Y,
            4.0,
            &Beam::parallel(sun, DVec3::ONE),
        )
        .integrate(0.0, 4.0)
        .x;
        let expected = 0.8 / (4.0 * std::f64::consts::PI) / (1.0 + 1.0 / c);
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{c}: {found} {expected}"
        );
    }
}

#[test]
fn any_number_of_points_integrates_polynomials_exactly() {
    for count in 1..=40_u32 {
        let nodes = gauss_nodes(count);
        assert_eq!(nodes.len(), count as usize);
        for power in 0..2 * count as i32 {
            let sum: f64 = nodes.iter().map(|[x, weight]| weight * x.powi(power)).sum();
            let exact = if power % 2 == 0 {
                2.0 / f64::from(power + 1)
            } else {
                0.0
            };
            assert!(
                (sum - exact).abs() < 1e-12,
                "{count} points, x^{power}: {sum}"
            );
        }
    }
}
