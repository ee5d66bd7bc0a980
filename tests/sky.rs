//! The sky and the sun: closed forms, published figures, and no seam from noon to night.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};
use tyndall::colour::{self, luminance};
use tyndall::sky::{Irradiance, Model, Sky, SunAt, SunLight, SunPath, hemisphere, sun, twilight};
use tyndall::units::{DEG, STANDARD_PRESSURE_HPA};

/// Unit vector at an azimuth and elevation [degrees], -Z being azimuth 0.
fn toward(azimuth: f64, elevation: f64) -> DVec3 {
    let ((sa, ca), (se, ce)) = ((azimuth * DEG).sin_cos(), (elevation * DEG).sin_cos());
    DVec3::new(ce * sa, se, -ce * ca)
}

fn sky(model: Model, elevation: f64) -> Sky {
    Sky::new(model, SunAt::unrefracted(toward(40.0, elevation))).unwrap()
}

const PREETHAM: Model = Model::Preetham { turbidity: 3.0 };
const PEREZ: Model = Model::Perez {
    turbidity: 3.0,
    irradiance: None,
};
const HOSEK: Model = Model::Hosek {
    turbidity: 3.0,
    albedo: 0.2,
};

fn cie(kind: u8) -> Model {
    Model::Cie {
        kind,
        turbidity: 3.0,
        irradiance: None,
    }
}

fn measured(direct_normal: f64, diffuse_horizontal: f64) -> Model {
    Model::Perez {
        turbidity: 3.0,
        irradiance: Some(Irradiance {
            direct_normal,
            diffuse_horizontal,
        }),
    }
}

/// Every model under a sky without clouds.
fn clear_models() -> Vec<Model> {
    let mut models = vec![PEREZ, HOSEK];
    for turbidity in [2.0, 3.0, 6.0, 10.0] {
        models.push(Model::Preetham { turbidity });
    }
    for turbidity in [2.0, 6.0] {
        models.push(Model::Perez {
            turbidity,
            irradiance: None,
        });
    }
    for (turbidity, albedo) in [(1.0, 0.0), (10.0, 1.0), (4.7, 0.5)] {
        models.push(Model::Hosek { turbidity, albedo });
    }
    models.extend((7..=15).map(cie));
    models
}

/// Directions over the dome, the horizon and the sun's own included.
fn views(sun_azimuth: f64, sun_elevation: f64) -> Vec<DVec3> {
    let mut views = vec![DVec3::Y, toward(sun_azimuth, sun_elevation.max(0.0))];
    for elevation in [0.0, 0.3, 2.0, 10.0, 30.0, 60.0, 85.0] {
        for step in 0..12 {
            views.push(toward(
                sun_azimuth + 30.0 * f64::from(step) + 1.0,
                elevation,
            ));
        }
    }
    views
}

#[test]
fn a_uniform_sky_is_pi_times_its_luminance() {
    let sky = sky(Model::Uniform { luminance: 5000.0 }, 30.0);
    assert!((luminance(sky.horizontal_illuminance()) - PI * 5000.0).abs() < 1e-6);
    assert_eq!(sky.radiance(toward(200.0, 3.0)), DVec3::splat(5000.0));
    // The quadrature itself, on integrals with closed forms: 1, cos theta, and a cusp at the sun.
    for zenith_angle in [0.0, 0.3, 1.2, FRAC_PI_2, 1.8] {
        let one = hemisphere::horizontal_integral(zenith_angle, |_| DVec3::ONE);
        assert!((one.x - PI).abs() < 1e-12, "{one}");
        let cos = hemisphere::horizontal_integral(zenith_angle, |w| DVec3::splat(w.y));
        assert!((cos.x - 2.0 * PI / 3.0).abs() < 1e-12);
    }
    // With the sun at the zenith: 2 pi times the integral of e^(-3 t) sin t cos t over 0 to pi/2 = (1 + e^(-3 pi / 2)) / 13.
    let cusp = hemisphere::horizontal_integral(0.0, |w| DVec3::splat((-3.0 * w.y.acos()).exp()));
    let exact = 2.0 * PI * (1.0 + (-3.0 * FRAC_PI_2).exp()) / 13.0;
    assert!((cusp.x / exact - 1.0).abs() < 1e-7, "{} {exact}", cusp.x);
}

#[test]
fn horizontal_illuminance_is_what_the_radiances_sum_to() {
    for elevation in [90.0, 62.0, 15.0, 7.0, 1.0, -4.0, -15.0] {
        for turbidity in [2.0, 5.0, 10.0] {
            let sky = sky(Model::Preetham { turbidity }, elevation);
            // Midpoints, unaware of the sun, half a million of them, crowded at the horizon: y = u^2.
            let (rings, steps) = (1024, 512);
            let mut sum = DVec3::ZERO;
            for i in 0..rings {
                let u = (f64::from(i) + 0.5) / f64::from(rings);
                let y = u * u;
                let r = (1.0 - y * y).sqrt();
                for j in 0..steps {
                    let (s, c) = (2.0 * PI * (f64::from(j) + 0.5) / f64::from(steps)).sin_cos();
                    sum += sky.radiance(DVec3::new(r * s, y, -r * c)) * (2.0 * u * y);
                }
            }
            let brute = sum * 2.0 * PI / f64::from(rings * steps);
            let own = sky.horizontal_illuminance();
            // By day the midpoints' own error at the cusp; in twilight the quadrature's, see its documentation.
            let allowed = if elevation < 0.0 { 1e-3 } else { 2e-4 };
            assert!(
                (brute / own - DVec3::ONE).abs().max_element() < allowed,
                "{elevation} {turbidity}: {brute} {own}"
            );
        }
    }
}

#[test]
fn preetham_is_its_paper_above_ten_degrees() {
    // Zenith of appendix A.2 for turbidity 3 and a sun at 45 degrees, worked by hand from the printed constants:
    // chi = (4/9 - 3/120) (pi - pi/2) = 0.658862, Yz = (12.1359 - 4.9710) tan chi - 0.6465 + 2.4192.
    let zenith = sky(PREETHAM, 45.0).zenith();
    let expected = 1000.0 * (7.1649 * 0.658_862_f64.tan() - 0.6465 + 2.4192);
    assert!(
        (luminance(zenith) / expected - 1.0).abs() < 1e-5,
        "{zenith} {expected}"
    );
    let xyy = colour::xyy_from_xyz(colour::xyz_from_working(zenith));
    let s = PI / 4.0;
    let powers = [s * s * s, s * s, s, 1.0];
    let row = |r: [f64; 4]| r.iter().zip(powers).map(|(a, b)| a * b).sum::<f64>();
    let x = 9.0 * row([0.00166, -0.00375, 0.00209, 0.0])
        + 3.0 * row([-0.02903, 0.06377, -0.03202, 0.00394])
        + row([0.11693, -0.21196, 0.06052, 0.25886]);
    assert!((xyy.x - x).abs() < 1e-12);
    // The scene's azimuth does not matter.
    let turned = Sky::new(PREETHAM, SunAt::unrefracted(toward(200.0, 45.0))).unwrap();
    let original = sky(PREETHAM, 45.0);
    let difference = turned.radiance(toward(250.0, 20.0)) - original.radiance(toward(90.0, 20.0));
    assert!(difference.length() < 1e-9 * original.zenith().length());
}

#[test]
fn what_cannot_be_is_an_error_that_helps() {
    for turbidity in [1.9, 10.1, f64::NAN] {
        let error =
            Sky::new(Model::Preetham { turbidity }, SunAt::unrefracted(DVec3::Y)).unwrap_err();
        assert!(
            error.is_input() && error.to_string().contains("2 to 10"),
            "{error}"
        );
    }
    assert!(Sky::new(PREETHAM, SunAt::unrefracted(DVec3::new(1.0, 1.0, 0.0))).is_err());
    assert!(
        Sky::new(
            Model::Uniform { luminance: -1.0 },
            SunAt::unrefracted(DVec3::Y)
        )
        .is_err()
    );
    for path in [
        SunPath {
            turbidity: 0.5,
            ..SunPath::standard(0.5, 2.0)
        },
        SunPath {
            pressure_hpa: f64::NAN,
            ..SunPath::standard(0.5, 2.0)
        },
        SunPath {
            distance_au: 0.0,
            ..SunPath::standard(0.5, 2.0)
        },
    ] {
        assert!(SunLight::new(&path).is_err(), "{path:?}");
    }
    assert!(!sky(PREETHAM, 40.0).warnings().is_empty());
}

#[test]
fn the_illuminance_curve_passes_its_landmarks_without_a_step() {
    // USNO Circular 171: 760 lx at sunrise (geometric), 3.4 at -6, 0.008 at -12, 0.00064 at -18 degrees; 129 klx overhead.
    for (degrees, lux) in [
        (90.0, 128_800.0),
        (0.0, 758.6),
        (-6.0, 3.41),
        (-12.0, 0.008_1),
        (-18.0, 0.000_645),
    ] {
        let value = twilight::clear_illuminance(degrees * DEG);
        assert!((value / lux - 1.0).abs() < 0.01, "{degrees}: {value}");
    }
    assert_eq!(
        twilight::clear_illuminance(-1.0),
        twilight::clear_illuminance(-FRAC_PI_2)
    );
    let mut last = twilight::clear_illuminance(-18.0 * DEG);
    for i in 1..=10_800 {
        let value = twilight::clear_illuminance((f64::from(i) * 0.01 - 18.0) * DEG);
        // The steepest part (about 8.5 degrees down) falls by 0.49 in log10 a degree, 1.1 % a step.
        assert!(
            value >= last && value / last < 1.0125,
            "{i}: {last} {value}"
        );
        last = value;
    }
}

/// Horizontal illuminance of sun and sky [lx].
fn global(model: Model, elevation: f64) -> f64 {
    let sky = sky(model, elevation);
    let path = SunPath::standard(elevation * DEG, model.turbidity());
    let sun = sky.sunlight(&path).unwrap();
    luminance(sky.horizontal_illuminance() + sun.horizontal_illuminance())
}

#[test]
fn skies_follow_the_published_curve_through_twilight() {
    for model in clear_models() {
        let mut last = f64::INFINITY;
        for i in 0..=340 {
            let elevation = 5.0 - 0.05 * f64::from(i);
            let (total, published) = (
                global(model, elevation),
                twilight::clear_illuminance(elevation * DEG),
            );
            // The bar is 1.5; the sky's floor of a third of the whole costs 1.1 where the sun alone is above the curve.
            assert!(
                (1.0 / 1.5..1.5).contains(&(total / published)),
                "{model:?} {elevation}: {total} {published}"
            );
            assert!(total < last, "{model:?} {elevation}: {last} {total}");
            last = total;
        }
    }
    // The default sky by day: within 20 % of the curve above 10 degrees.
    for elevation in [10.5, 12.0, 15.0, 20.0, 30.0, 45.0, 60.0, 75.0, 90.0] {
        let ratio = global(PEREZ, elevation) / twilight::clear_illuminance(elevation * DEG);
        assert!((0.8..1.2).contains(&ratio), "{elevation}: {ratio}");
    }
    // Clouds: darker than the clear sky by a steady factor, and monotone all the way.
    for kind in [1, 3, 5, 6, 16] {
        let mut last = f64::INFINITY;
        for i in 0..=540 {
            let elevation = 15.0 - 0.05 * f64::from(i);
            let total = global(cie(kind), elevation);
            assert!(total < last, "cie:{kind} {elevation}: {last} {total}");
            let share = total / twilight::clear_illuminance(elevation * DEG);
            assert!(
                (0.1..0.9).contains(&share),
                "cie:{kind} {elevation}: {share}"
            );
            last = total;
        }
    }
}

/// Sweeps the sun and asserts that no pixel steps.
fn sweep(model: Model, from: f64, to: f64, allowed: f64) {
    let (mut last, mut before): (Option<Vec<f64>>, Option<Vec<f64>>) = (None, None);
    let steps = ((from - to) / 0.01).round() as i32;
    for i in 0..=steps {
        let elevation = from - 0.01 * f64::from(i);
        let sky = sky(model, elevation);
        let now: Vec<f64> = views(40.0, 5.0)
            .into_iter()
            .map(|w| {
                let v = sky.radiance(w);
                assert!(
                    v.is_finite() && v.min_element() >= 0.0,
                    "{model:?} {elevation} {w}: {v}"
                );
                luminance(v)
            })
            .collect();
        if let Some(last) = &last {
            let rates: Vec<f64> = now.iter().zip(last).map(|(n, l)| (n / l).ln()).collect();
            for (k, rate) in rates.iter().enumerate() {
                assert!(now[k] > 0.0);
                assert!(rate.abs() < allowed, "{model:?} {elevation} {k}: {rate}");
                // And no kink that would show as one.
                if let Some(before) = &before {
                    assert!(
                        (rate - before[k]).abs() < 0.004,
                        "{model:?} {elevation} {k}: {rate} {}",
                        before[k]
                    );
                }
            }
            before = Some(rates);
        }
        last = Some(now);
    }
}

#[test]
fn no_seam_from_noon_to_night() {
    // 2 %, and 1 % for the gradient of the sky itself: under the setting sun the horizon fades by 2.1 % a hundredth of a degree.
    let models = [
        PEREZ,
        Model::Perez {
            turbidity: 1.0,
            irradiance: None,
        },
        Model::Perez {
            turbidity: 10.0,
            irradiance: None,
        },
        HOSEK,
        Model::Hosek {
            turbidity: 10.0,
            albedo: 1.0,
        },
        Model::Preetham { turbidity: 2.0 },
        Model::Preetham { turbidity: 10.0 },
        cie(1),
        cie(12),
    ];
    for model in models {
        sweep(model, 90.0, -19.0, 0.03);
    }
    sweep(measured(420.0, 110.0), 40.0, -3.0, 0.03);
    // The night: the same whatever the sun does.
    assert_eq!(sky(PEREZ, -18.0).zenith(), sky(PEREZ, -60.0).zenith());
    // The check can fail: the bins as published are a step for a steady irradiance.
    let published = |e: f64| {
        tyndall::sky::published_xyz(measured(420.0, 110.0), e * DEG, 0.3, 0.4)
            .unwrap()
            .y
    };
    let jump = (1..7000)
        .map(|i| 40.0 - 0.005 * f64::from(i))
        .map(|e| (published(e) / published(e + 0.005) - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(jump > 0.03, "{jump}");
}

#[test]
fn twilight_has_its_colours() {
    let at = |elevation: f64, w: DVec3| {
        let xyz = colour::xyz_from_working(sky(PEREZ, elevation).radiance(w));
        let v = colour::xyy_from_xyz(xyz);
        (v.x, v.y, v.z)
    };
    // The zenith is bluer after sunset than at it, thanks to ozone.
    assert!(at(-5.0, DVec3::Y).0 < at(0.0, DVec3::Y).0);
    // Over the sunken sun the horizon is orange, and brighter than the zenith.
    let arch = at(-4.0, toward(40.0, 3.0));
    assert!(
        arch.0 > 0.35 && arch.2 > 5.0 * at(-4.0, DVec3::Y).2,
        "{arch:?}"
    );
    // Opposite stands the earth's shadow, blue and dark, under a band that is rosier and brighter.
    let (shadow, band) = (at(-2.0, toward(220.0, 1.0)), at(-2.0, toward(220.0, 9.0)));
    assert!(
        band.2 > shadow.2 && band.0 > shadow.0,
        "{shadow:?} {band:?}"
    );
    // The arch narrows: its brightness at 20 degrees of height over that at 1 falls.
    let narrow = |e: f64| at(e, toward(40.0, 20.0)).2 / at(e, toward(40.0, 3.0)).2;
    assert!(narrow(-10.0) < narrow(-5.0) && narrow(-5.0) < narrow(-2.0));
}

#[test]
fn hosek_has_its_authors_level() {
    // Diffuse horizontal illuminance measured on other implementations: 14.4 klx at turbidity 2 and 45 degrees.
    let model = Model::Hosek {
        turbidity: 2.0,
        albedo: 0.2,
    };
    let e = luminance(sky(model, 45.0).horizontal_illuminance());
    assert!((e / 14_400.0 - 1.0).abs() < 0.03, "{e}");
    // Between the knots of turbidity and albedo it is linear, at them exact.
    let y = |turbidity: f64, albedo: f64| {
        let model = Model::Hosek { turbidity, albedo };
        tyndall::sky::published_xyz(model, 0.7, 1.0, 0.5).unwrap().y
    };
    assert!((y(10.0, 1.0) / y(10.0 - 1e-9, 1.0) - 1.0).abs() < 1e-7);
    assert!((y(3.0, 0.0) / y(3.0 - 1e-9, 0.0) - 1.0).abs() < 1e-7);
    assert!(y(3.0, 1.0) > y(3.0, 0.0));
}

#[test]
fn the_cie_skies_are_the_standard_s() {
    let ratio = |kind: u8, sun: f64, azimuth: f64, elevation: f64| {
        let at = |az: f64, el: f64| {
            tyndall::sky::published_xyz(cie(kind), sun * DEG, az * DEG, el * DEG)
                .unwrap()
                .y
        };
        at(azimuth, elevation) / at(0.0, 90.0)
    };
    // Type 16: the horizon has a third of the zenith, exactly; type 5 is uniform.
    assert!((ratio(16, 40.0, 77.0, 0.0) - 1.0 / 3.0).abs() < 1e-12);
    assert!((ratio(5, 40.0, 77.0, 12.0) - 1.0).abs() < 1e-12);
    // Type 1 by hand: (1 + 4 e^(-0.7 / cos 60)) / (1 + 4 e^-0.7).
    let hand = (1.0 + 4.0 * (-1.4f64).exp()) / (1.0 + 4.0 * (-0.7f64).exp());
    assert!((ratio(1, 20.0, 10.0, 30.0) - hand).abs() < 1e-12);
    // Type 12 by hand, sun at 50 degrees, view at 30 degrees on the opposite side: chi = 100 degrees, Zs = 40.
    let f = |chi: f64| {
        1.0 + 10.0 * ((-3.0 * chi * DEG).exp() - (-3.0 * FRAC_PI_2).exp())
            + 0.45 * (chi * DEG).cos().powi(2)
    };
    let phi = |z: f64| 1.0 - (-0.32 / (z * DEG).cos()).exp();
    let hand = phi(60.0) * f(100.0) / (phi(0.0) * f(40.0));
    assert!((ratio(12, 50.0, 180.0, 30.0) / hand - 1.0).abs() < 1e-12);
    assert!((ratio(11, 50.0, 180.0, 30.0) / hand - 1.0).abs() > 0.01);
    // The overcast sky's horizontal illuminance is 7 pi / 9 times its zenith luminance.
    let overcast = sky(cie(16), 40.0);
    let e = luminance(overcast.horizontal_illuminance()) / luminance(overcast.zenith());
    assert!((e / (7.0 * PI / 9.0) - 1.0).abs() < 1e-12, "{e}");
    // Kittler & Darula's zenith formula with the same Dv/Ev, for the types where it reproduces Dv to 0.1 %.
    for (kind, share, b, c, d, e) in [
        (1, 0.10, 54.63, 1.0, 0.0, 0.0),
        (3, 0.15, 48.30, 1.0, 0.0, 0.0),
        (5, 0.20, 42.59, 1.0, 0.0, 0.0),
    ] {
        let g: f64 = 35.0 * DEG;
        let zenith = 1000.0 * share * (b * g.sin().powf(c) / g.cos().powf(d) + e * g.sin());
        let ours = tyndall::sky::published_xyz(cie(kind), g, 0.0, FRAC_PI_2)
            .unwrap()
            .y;
        assert!(
            (ours / zenith - 1.0).abs() < 2e-3,
            "{kind}: {ours} {zenith}"
        );
    }
    assert_eq!(
        sky(cie(1), 40.0)
            .sunlight(&SunPath::standard(0.7, 3.0))
            .unwrap()
            .illuminance,
        DVec3::ZERO
    );
}

#[test]
fn the_horizon_is_finite_and_smooth() {
    for elevation in [80.0, 30.0, 12.0, 3.0, -3.0, -10.0] {
        let sky = sky(PREETHAM, elevation);
        for azimuth in [40.0, 100.0, 220.0] {
            let mut last = sky.radiance(toward(azimuth, 0.0));
            for i in 1..=300 {
                let next = sky.radiance(toward(azimuth, 0.01 * f64::from(i)));
                assert!(next.is_finite());
                // The arch over a sunken sun rises from the dark horizon by a factor e in a third of a degree.
                assert!(
                    (luminance(next) / luminance(last) - 1.0).abs() < 0.04,
                    "{elevation} {azimuth} {i}"
                );
                last = next;
            }
        }
        assert!(sky.radiance(toward(10.0, -5.0)).is_finite());
    }
}

#[test]
fn the_disc_s_mean_is_its_illuminance_over_its_solid_angle() {
    // Mean over the disc of the limb profile: 2 times the integral of limb(rho) rho, by substitution u = rho^2.
    let n = 200_000;
    let mean: DVec3 = (0..n)
        .map(|i| sun::limb(((f64::from(i) + 0.5) / f64::from(n)).sqrt()))
        .sum::<DVec3>()
        / f64::from(n);
    assert!((mean - DVec3::ONE).abs().max_element() < 1e-5, "{mean}");
    // The limb is darker, and redder.
    assert!(sun::limb(0.95).max_element() < sun::limb(0.0).min_element());
    assert!(sun::limb(0.95).x > sun::limb(0.95).z);
    assert!(sun::limb(1.0).is_finite());
    let light = SunLight::new(&SunPath::standard(FRAC_PI_2, 2.0)).unwrap();
    // 32 arcminutes: 6.8e-5 sr, and 1.6 to 1.9 Gcd/m2 at the ground.
    assert!((light.solid_angle() / 6.8e-5 - 1.0).abs() < 0.01);
    let mean = luminance(light.full_illuminance) / light.solid_angle();
    assert!((1.3e9..1.9e9).contains(&mean), "{mean}");
}

#[test]
fn sunlight_has_published_values() {
    let lux = |elevation: f64, turbidity: f64| {
        luminance(
            SunLight::new(&SunPath::standard(elevation * DEG, turbidity))
                .unwrap()
                .illuminance,
        )
    };
    // Outside the atmosphere: 133 klx by ASTM G173 (accepted values 128 to 134), 1 340 W/m2 from 0.3 to 4 micrometres.
    let outside = SunLight::new(&SunPath {
        pressure_hpa: 0.0,
        ozone_cm: 0.0,
        water_cm: 0.0,
        turbidity: 1.0,
        ..SunPath::standard(FRAC_PI_2, 2.0)
    })
    .unwrap();
    assert!(
        (128e3..134.5e3).contains(&luminance(outside.illuminance)),
        "{}",
        luminance(outside.illuminance)
    );
    assert!(
        (outside.irradiance.unwrap() / 1339.7 - 1.0).abs() < 0.002,
        "{:?}",
        outside.irradiance
    );
    // Preetham's own sun (the same optics with Kasten's 1965 air mass and a coarser spectrum that sums to 4 % less), at
    // 30 degrees: 81, 67 and 37 klx at turbidity 2, 3 and 6.
    for (turbidity, klx) in [(2.0, 81.0), (3.0, 67.0), (6.0, 37.0)] {
        let ratio = lux(30.0, turbidity) / 1000.0 / klx;
        assert!((0.97..1.08).contains(&ratio), "{turbidity}: {ratio}");
    }
    // Thinner air lets more through.
    let high = SunPath {
        pressure_hpa: 0.7 * STANDARD_PRESSURE_HPA,
        ..SunPath::standard(0.5, 2.0)
    };
    assert!(luminance(SunLight::new(&high).unwrap().illuminance) > lux(0.5 / DEG, 2.0));
    // The inverse square.
    let near = SunLight::new(&SunPath {
        distance_au: 0.983,
        ..SunPath::standard(0.5, 2.0)
    })
    .unwrap();
    assert!(
        (luminance(near.illuminance) * 0.983 * 0.983 / lux(0.5 / DEG, 2.0) - 1.0).abs() < 1e-12
    );
}

#[test]
fn the_sun_sets_smoothly_and_reddens() {
    let at = |elevation: f64| SunLight::new(&SunPath::standard(elevation * DEG, 3.0)).unwrap();
    let radius = at(0.0).angular_radius / DEG;
    assert!((radius - 0.2665).abs() < 1e-3);
    assert!((at(0.0).visible_share - 0.5).abs() < 1e-12);
    assert_eq!(at(-radius - 1e-6).illuminance, DVec3::ZERO);
    assert_eq!(at(-40.0).illuminance, DVec3::ZERO);
    assert_eq!(at(radius + 1e-6).visible_share, 1.0);
    let start = at(4.0);
    let mut last = luminance(start.illuminance);
    for i in 1..=5000 {
        let light = at(4.0 - 0.001 * f64::from(i));
        let now = luminance(light.illuminance);
        assert!(light.illuminance.is_finite() && light.illuminance.min_element() >= 0.0);
        assert!(light.full_illuminance.is_finite() && luminance(light.full_illuminance) > 0.0);
        // Falls without a step: by less than 1e-4 of the light at 4 degrees per thousandth of a degree, twice the mean slope.
        assert!(
            now <= last && last - now < 1e-3 * luminance(start.illuminance),
            "{i}: {last} {now}"
        );
        last = now;
    }
    assert_eq!(last, 0.0);
    let red = |l: &SunLight| l.full_illuminance.x / luminance(l.full_illuminance);
    assert!(red(&at(0.0)) > red(&at(5.0)) && red(&at(5.0)) > red(&at(40.0)));
    // Kasten & Young 1989: 37.92 at the horizon, 1.9939 at 30 degrees, 1 overhead to 3e-4.
    for (elevation, mass) in [(0.0, 37.92), (30.0, 1.9939), (90.0, 1.0)] {
        assert!(
            (sun::relative_air_mass(elevation * DEG) / mass - 1.0).abs() < 4e-4,
            "{elevation}"
        );
    }
}

#[test]
fn patches_fill_the_dome_and_sum_to_its_illuminance() {
    use tyndall::sky::patches::{Subdivision, dome, radiances, raw_share};
    for (subdivision, count) in [
        (Subdivision::Triangles, 5728),
        (Subdivision::Tregenza, 145),
        (Subdivision::Reinhart(2), 577),
        (Subdivision::Reinhart(4), 2305),
    ] {
        let patches = dome(subdivision).unwrap();
        assert_eq!(patches.len(), count);
        let solid: f64 = patches.iter().map(|p| p.solid_angle).sum();
        let projected: f64 = patches.iter().map(|p| p.projected).sum();
        assert!(
            (solid / (2.0 * PI) - 1.0).abs() < 1e-12,
            "{subdivision:?} {solid}"
        );
        assert!(
            (projected / PI - 1.0).abs() < 1e-12,
            "{subdivision:?} {projected}"
        );
        for p in &patches {
            assert!((p.direction.length() - 1.0).abs() < 1e-12 && p.direction.y > 0.0);
            // A patch's projected solid angle is its solid angle times the sine of some elevation within it.
            let sine = p.projected / p.solid_angle;
            assert!((sine - p.direction.y).abs() < 0.03, "{p:?}");
        }
        for (model, elevation) in [
            (PEREZ, 55.0),
            (PEREZ, 12.0),
            (HOSEK, 25.0),
            (cie(1), 40.0),
            (PEREZ, -3.0),
        ] {
            let sky = sky(model, elevation);
            let sum: DVec3 = radiances(&sky, &patches)
                .iter()
                .zip(&patches)
                .map(|(l, p)| *l * p.projected)
                .sum();
            let own = sky.horizontal_illuminance();
            assert!(
                (sum / own - DVec3::ONE).abs().max_element() < 1e-3,
                "{subdivision:?} {model:?}"
            );
            // The common factor hides little: 5 728 triangles need none, 145 patches are off by some per cent.
            let raw = raw_share(&sky, &patches);
            let allowed = if count == 5728 { 1e-3 } else { 0.06 };
            assert!(
                (raw - 1.0).abs() < allowed,
                "{subdivision:?} {model:?} {elevation}: {raw}"
            );
        }
    }
    let triangles = dome(Subdivision::Triangles).unwrap();
    let mean = 2.0 * PI / 5728.0;
    assert!(
        triangles
            .iter()
            .all(|p| (0.4..1.8).contains(&(p.solid_angle / mean)))
    );
    assert!(dome(Subdivision::Reinhart(0)).is_err() && dome(Subdivision::Reinhart(17)).is_err());
}

#[test]
fn sunlight_is_that_of_astm_g173() {
    // The standard's direct spectrum: air mass 1.5 (41.8 degrees), aerosol optical depth 0.084 at 500 nm, 0.344 atm-cm of
    // ozone, 1.416 cm of water, computed by SMARTS: 900.1 W/m2, and by the 1931 observer 97 140 lx
    // and x, y 0.3391, 0.3501.
    // Our aerosol has exponent 1.3: turbidity for the same depth at 500 nm.
    let turbidity = (0.084 * 0.5f64.powf(1.3) + 0.045_860_26) / 0.046_083_66;
    let path = SunPath {
        water_cm: 1.416,
        ozone_cm: 0.344,
        ..SunPath::standard(41.8 * DEG, turbidity)
    };
    let light = SunLight::new(&path).unwrap();
    let ratio = light.irradiance.unwrap() / 900.1;
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    // The bar is 5 %; the parametric model does better than 2 %.
    assert!((luminance(light.illuminance) / 97_140.0 - 1.0).abs() < 0.02);
    let xyy = colour::xyy_from_xyz(colour::xyz_from_working(light.illuminance));
    assert!(
        (xyy.x - 0.3391).abs() < 0.004 && (xyy.y - 0.3501).abs() < 0.004,
        "{xyy}"
    );
    // Another path is noticed.
    let hazier = SunLight::new(&SunPath {
        turbidity: 3.0,
        ..path
    })
    .unwrap();
    assert!((hazier.irradiance.unwrap() / 900.1 - 1.0).abs() > 0.05);
}
