//! How air lifts the sun: true to apparent elevation and back, and the mass of air that its light crosses.

use super::trigonometry::sin_cos;
use super::weather::Weather;
use crate::units::DEG;

/// Below this true elevation [degrees] the lift is zero; the formula itself reaches zero here.
const FOOT_DEG: f64 = -5.001_580_751_409_264;

/// The lift [rad] of a body at a true elevation [rad]: apparent minus true elevation.
///
/// Valid from -90 to 90 degrees; continuous, and true plus lift rises with the true elevation. At the
/// zenith it is -0.1 arcseconds, as the source has it.
///
/// Source: Saemundsson 1986 (Sky & Telescope 72, 70), as in Reda & Andreas 2004, equation 42.
///
/// Differs: Reda & Andreas cut the lift to zero below the sun's rising, a jump of 0.6 degrees. Here the formula runs
/// on until its own argument passes 90 degrees, where it is zero, at -5.0016 degrees. Near the horizon the real lift
/// varies by minutes of arc with the weather, and no formula of pressure and temperature knows it.
pub fn refraction(elevation_true: f64, weather: &Weather) -> f64 {
    lift(elevation_true, weather)
}

/// [`refraction`], without a branch, for loops.
#[inline(always)]
pub(super) fn lift(elevation_true: f64, weather: &Weather) -> f64 {
    let degrees = elevation_true * (1.0 / DEG);
    let e = if degrees > FOOT_DEG { degrees } else { 0.0 };
    let argument = (e + 10.3 / (e + 5.11)) * DEG;
    // 1 / tan as cos / sin: it passes through zero at 90 degrees.
    let [(sin, cos)] = sin_cos([argument]);
    let lift = weather.density * 1.02 / 60.0 * DEG * cos / sin;
    if degrees > FOOT_DEG { lift } else { 0.0 }
}

/// The true elevation [rad] of what is seen at an apparent elevation [rad]: the inverse of [`refraction`].
pub fn true_elevation(apparent: f64, weather: &Weather) -> f64 {
    // Apparent elevation rises with the true one, and the lift is between 0 and 0.75 degrees of standard air.
    let lift_max = 0.75 * DEG * weather.density.max(1.0);
    let (mut low, mut high) = (
        apparent - lift_max,
        apparent + 0.001 * DEG * weather.density.max(1.0),
    );
    while high - low > 1e-14 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if middle + refraction(middle, weather) < apparent {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The mass of air that light crosses from an apparent elevation [rad], relative to the zenith's.
///
/// 37.92 at the horizon. Below the apparent horizon the earth stands in the way and no path exists: the horizon's
/// value is given there, so that what is computed from it stays finite and continuous.
///
/// Source: Kasten & Young 1989 (Applied Optics 28, 4735), equation 3.
pub fn air_mass(elevation_apparent: f64) -> f64 {
    let h = (elevation_apparent / DEG).max(0.0);
    1.0 / ((h * DEG).sin() + 0.505_72 * (h + 6.079_95).powf(-1.6364))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weathers() -> Vec<Weather> {
        vec![
            Weather::new(1010.0, 10.0).unwrap(),
            Weather::new(820.0, 11.0).unwrap(),
            Weather::new(1080.0, -60.0).unwrap(),
            Weather::new(0.0, 0.0).unwrap(),
        ]
    }

    #[test]
    fn the_apparent_elevation_is_continuous_and_rises() {
        for weather in weathers() {
            let mut last = -90.0 * DEG;
            // Steps of 3.6 arcseconds: no step of the apparent elevation may exceed 1.6 of it, nor fall.
            for i in 1..=180_000 {
                let e = (-90.0 + f64::from(i) * 1e-3) * DEG;
                let apparent = e + refraction(e, &weather);
                let step = (apparent - last) / (1e-3 * DEG);
                assert!(
                    step > 0.0 && step < 1.6 + 0.5 * weather.density,
                    "{} degrees: {step}",
                    e / DEG
                );
                last = apparent;
            }
        }
    }

    #[test]
    fn the_inverse_inverts() {
        for weather in weathers() {
            for i in 0..=1800 {
                let e = (-90.0 + 0.1 * f64::from(i)) * DEG;
                let back = true_elevation(e + refraction(e, &weather), &weather);
                assert!(
                    (back - e).abs() < 1e-12,
                    "{} degrees: {}",
                    e / DEG,
                    (back - e) / DEG
                );
            }
        }
    }

    #[test]
    fn published_values() {
        // Reda & Andreas 2004, table A5.1: 0.016332 degrees at 39.872046 degrees, 820 mb, 11 C.
        let weather = Weather::new(820.0, 11.0).unwrap();
        assert!((refraction(39.872046 * DEG, &weather) / DEG - 0.016332).abs() < 5e-7);
        // Kasten & Young 1989, table II: 37.9196 at 0, 10.3164 at 5 degrees, 1.9939 at 30.
        for (h, m) in [(0.0, 37.9196), (5.0, 10.3058), (30.0, 1.9943), (90.0, 1.0)] {
            assert!(
                (air_mass(h * DEG) / m - 1.0).abs() < 1.5e-3,
                "{h}: {}",
                air_mass(h * DEG)
            );
        }
        assert!((air_mass(1e-9) - air_mass(0.0)).abs() < 1e-5);
    }
}
