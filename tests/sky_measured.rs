//! Measured irradiance sets the level of sky and sun at every height of the sun.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};
use tyndall::colour::luminance;
use tyndall::conditions::{Conditions, Request};
use tyndall::scene::{Scene, SkyEntry, SunEntry};
use tyndall::sky::{Irradiance, Model, Sky, SunAt, SunLight, SunPath, perez, twilight};
use tyndall::units::DEG;
use tyndall::warning::Warning;

/// Heights of the sun [degrees] on both sides of every place where something goes over into something else.
const HEIGHTS: [f64; 14] = [
    -20.0, -8.0, -3.0, -0.5, 0.0, 0.5, 2.0, 3.0, 5.0, 7.0, 9.99, 10.0, 30.0, 62.0,
];

fn perez(direct_normal: f64, diffuse_horizontal: f64) -> Model {
    Model::Perez {
        turbidity: 3.0,
        irradiance: Some(Irradiance {
            direct_normal,
            diffuse_horizontal,
        }),
    }
}

fn cie(kind: u8, direct_normal: f64, diffuse_horizontal: f64) -> Model {
    Model::Cie {
        kind,
        turbidity: 3.0,
        irradiance: Some(Irradiance {
            direct_normal,
            diffuse_horizontal,
        }),
    }
}

fn sky(model: Model, elevation: f64) -> Sky {
    let (sin, cos) = (elevation * DEG).sin_cos();
    Sky::new(model, SunAt::unrefracted(DVec3::new(cos, sin, 0.0))).unwrap()
}

fn level(model: Model, elevation: f64) -> f64 {
    luminance(sky(model, elevation).horizontal_illuminance())
}

fn sunlight(model: Model, elevation: f64) -> f64 {
    let path = SunPath::standard(elevation * DEG, 3.0);
    let sun = sky(model, elevation).sunlight(&path).unwrap();
    luminance(sun.illuminance)
}

/// Illuminance [lx] that radiances sum to: midpoints, crowded at the horizon by y = u^2.
fn summed(sky: &Sky) -> f64 {
    let (rings, steps) = (512, 256);
    let mut sum = 0.0;
    for i in 0..rings {
        let u = (f64::from(i) + 0.5) / f64::from(rings);
        let (y, r) = (u * u, (1.0 - u.powi(4)).sqrt());
        for j in 0..steps {
            let (s, c) = (2.0 * PI * (f64::from(j) + 0.5) / f64::from(steps)).sin_cos();
            sum += luminance(sky.radiance(DVec3::new(r * s, y, -r * c))) * (2.0 * u * y);
        }
    }
    sum * 2.0 * PI / f64::from(rings * steps)
}

/// Diffuse luminous efficacy [lm/W] under an overcast sky by hand: Perez et al. 1990, table 4, first row, 2 cm of water.
fn overcast_efficacy(diffuse: f64, elevation: f64) -> f64 {
    let zenith = 90.0 - elevation.max(0.0);
    let mass = 1.0 / ((zenith * DEG).cos() + 0.15 * (93.885 - zenith).powf(-1.253));
    let brightness = (mass * diffuse / 1367.0).clamp(0.01, 0.6);
    let held = (zenith * DEG).max(3.0 * DEG);
    97.24 - 0.46 * 2.0 + 12.0 * held.cos() - 8.91 * brightness.ln()
}

#[test]
fn a_sky_has_its_measured_irradiance_times_the_efficacy_at_every_height() {
    for elevation in HEIGHTS {
        for diffuse in [2.0, 10.0, 30.0, 60.0, 120.0] {
            let expected = diffuse * overcast_efficacy(diffuse, elevation);
            for model in [perez(0.0, diffuse), cie(1, 0.0, diffuse)] {
                let sky = sky(model, elevation);
                let told = luminance(sky.horizontal_illuminance());
                assert!(
                    (told / expected - 1.0).abs() < 1e-4,
                    "{model:?} {elevation}: {told} {expected}"
                );
                // The quadrature's own error is largest in twilight, whose table is read along straight lines.
                let brute = summed(&sky);
                assert!(
                    (brute / expected - 1.0).abs() < 2e-3,
                    "{model:?} {elevation}: {brute} {expected}"
                );
            }
        }
    }
    // The round figures that the efficacies lead one to expect: 110 to 130 lm/W.
    for (elevation, diffuse, lux) in [
        (5.0, 10.0, 1200.0),
        (5.0, 30.0, 3600.0),
        (5.0, 60.0, 7000.0),
        (3.0, 5.0, 600.0),
        (3.0, 40.0, 4500.0),
    ] {
        let own = level(perez(0.0, diffuse), elevation);
        assert!(
            (own / lux - 1.0).abs() < 0.12,
            "{elevation} {diffuse}: {own}"
        );
    }
    // A clear hour, 400 and 60 W/m2 at 3 degrees: clearness 2.44 is in the fifth bin, brightness above 0.6.
    let own = level(perez(400.0, 60.0), 3.0);
    assert!((own / 7265.0 - 1.0).abs() < 0.05, "{own}");
}

#[test]
fn more_irradiance_is_more_light_in_proportion() {
    for elevation in HEIGHTS {
        for direct in [0.0, 50.0, 200.0, 600.0] {
            let mut last = 0.0;
            for i in 1..=60 {
                let diffuse = 4.0 * f64::from(i);
                let now = level(perez(direct, diffuse), elevation);
                assert!(now > last, "{elevation} {direct} {diffuse}: {last} {now}");
                // 85 to 220 lm/W: what the table's rows span between a dull and a very clear sky.
                let efficacy = now / diffuse;
                assert!(
                    (85.0..240.0).contains(&efficacy),
                    "{elevation} {direct} {diffuse}: {efficacy}"
                );
                last = now;
            }
        }
    }
}

#[test]
fn the_level_has_no_step_in_the_height_of_the_sun() {
    for model in [
        perez(0.0, 30.0),
        perez(120.0, 25.0),
        perez(400.0, 60.0),
        cie(12, 300.0, 40.0),
    ] {
        let heights = (0..=3000).map(|i| 12.0 - 0.01 * f64::from(i));
        let both: Vec<[f64; 2]> = heights
            .map(|e| [level(model, e), sunlight(model, e)])
            .collect();
        for (i, pair) in both.windows(2).enumerate() {
            let at = 12.0 - 0.01 * i as f64;
            let change = (pair[1][0] / pair[0][0] - 1.0).abs();
            assert!(change < 2e-3, "{model:?} {at}: {pair:?}");
            // The disc takes half a degree to set.
            let most = both[0][1];
            let step = (pair[1][1] - pair[0][1]).abs();
            assert!(step <= 0.03 * most, "{model:?} {at}: {pair:?}");
        }
    }
}

#[test]
fn sunlight_has_its_measured_irradiance_times_an_efficacy_too() {
    for elevation in [0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 30.0] {
        let light =
            |turbidity| SunLight::new(&SunPath::standard(elevation * DEG, turbidity)).unwrap();
        let efficacy = |t: f64| luminance(light(t).illuminance) / light(t).irradiance.unwrap();
        for direct in [20.0, 120.0, 400.0] {
            let (diffuse, zenith) = (40.0, FRAC_PI_2 - elevation * DEG);
            let irradiance = Irradiance {
                direct_normal: direct,
                diffuse_horizontal: diffuse,
            };
            let bins = perez::Bins::Blended;
            let state = perez::State::new(irradiance, zenith, 1.0, bins).unwrap();
            let fitted = state.direct_efficacy(perez::WATER_CM);
            let own = sunlight(perez(direct, diffuse), elevation) / direct;
            // Air of turbidity 3 if it lets as much through, else the haziest that does, in steps of a thousandth.
            let steps = (0..=2000).map(|i| 3.0 - 0.001 * f64::from(i));
            let air = steps
                .into_iter()
                .find(|t| light(*t).irradiance >= Some(direct));
            let spectral = efficacy(air.unwrap_or(1.0));
            let expected = match elevation {
                e if e >= 5.0 => [fitted, fitted],
                e if e <= 2.0 => [spectral, spectral],
                _ => [0.0, fitted.max(efficacy(1.0))],
            };
            assert!(
                own > expected[0] * 0.995 && own < expected[1] * 1.005,
                "{elevation} {direct}: {own} {expected:?}"
            );
        }
    }
    assert_eq!(sunlight(perez(400.0, 60.0), -1.0), 0.0);
    assert_eq!(sunlight(perez(0.0, 60.0), 3.0), 0.0);
}

#[test]
fn what_is_done_with_a_low_sun_is_said() {
    let warnings = |model, elevation| sky(model, elevation).warnings().to_vec();
    let low = |w: &Warning| matches!(w, Warning::IrradianceOfLowSun { .. });
    let without = |w: &Warning| matches!(w, Warning::IrradianceWithoutSun { .. });
    let zero = |w: &Warning| matches!(w, Warning::NoDiffuseIrradiance { .. });
    for elevation in [0.5, 5.0, 9.9] {
        assert!(warnings(perez(0.0, 30.0), elevation).iter().any(low));
    }
    assert!(!warnings(perez(0.0, 30.0), 10.0).iter().any(low));
    assert!(warnings(perez(0.0, 30.0), -2.0).iter().any(without));
    let said = warnings(perez(80.0, 30.0), -2.0);
    assert!(
        said.iter().any(|w| w.message().contains("80 W/m2")),
        "{said:?}"
    );
    // Nothing measured: twilight's own level, and nothing to say.
    let plain = Model::Perez {
        turbidity: 3.0,
        irradiance: None,
    };
    for elevation in [5.0, -2.0] {
        assert!(
            !warnings(plain, elevation)
                .iter()
                .any(|w| low(w) || without(w))
        );
    }
    // A reading of 0 at dusk is a rounded one; by day it cannot be.
    let dark = perez(0.0, 0.0);
    for elevation in [2.0, 0.0, -5.0, -30.0] {
        assert!(warnings(dark, elevation).iter().any(zero));
        let share = level(dark, elevation) / twilight::clear_illuminance(elevation * DEG);
        assert!((0.1..1.0).contains(&share), "{elevation}: {share}");
    }
    // Out of range is out of range at every height.
    for elevation in HEIGHTS {
        let (sin, cos) = (elevation * DEG).sin_cos();
        let at = SunAt::unrefracted(DVec3::new(cos, sin, 0.0));
        for (direct, diffuse) in [(-1.0, 10.0), (10.0, -1.0), (10.0, 1e9), (f64::NAN, 10.0)] {
            assert!(Sky::new(perez(direct, diffuse), at).unwrap_err().is_input());
        }
        assert_eq!(Sky::new(dark, at).is_ok(), elevation <= 2.0, "{elevation}");
    }
    let words = |elevation| sky(plain, elevation).describe();
    assert!(words(2.0).contains("the sun is low"), "{}", words(2.0));
    assert!(words(-0.2).contains("the sun is low"), "{}", words(-0.2));
    assert!(words(-0.3).contains("the sun is down"), "{}", words(-0.3));
}

#[test]
fn a_sun_without_light_is_not_below_the_horizon() {
    let conditions = |sun: SunEntry, sky: SkyEntry| {
        let scene = Scene {
            sun: Some(sun),
            sky,
            ..Scene::builtin("nave").unwrap()
        };
        Conditions::new(scene, &Request::default()).unwrap()
    };
    let sun = |elevation_deg, illuminance| SunEntry {
        azimuth_deg: 120.0,
        elevation_deg,
        illuminance,
        diameter_deg: None,
    };
    let dark = conditions(sun(30.0, Some(0.0)), SkyEntry::default());
    assert!(!dark.sun.shines());
    assert!(!dark.sun.missing().unwrap().contains("below"));
    let down = conditions(sun(-5.0, Some(1000.0)), SkyEntry::default());
    assert!(down.sun.missing().unwrap().contains("below the horizon"));
    let overcast = SkyEntry {
        model: Some("cie:1".into()),
        ..SkyEntry::default()
    };
    let clouds = conditions(sun(30.0, None), overcast);
    assert!(clouds.sun.missing().unwrap().contains("clouds"));
    // Irradiances of a sky that there is not.
    let unused = SkyEntry {
        direct_normal: Some(300.0),
        diffuse_horizontal: Some(80.0),
        ..SkyEntry::default()
    };
    let said = conditions(sun(30.0, Some(1000.0)), unused).warnings;
    assert!(
        said.contains(&Warning::UnusedSky {
            keys: vec!["direct_normal", "diffuse_horizontal"]
        }),
        "{said:?}"
    );
}
