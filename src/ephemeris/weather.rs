//! Pressure and temperature at the site, which say how strongly the air bends light.

use super::site::Site;
use crate::error::{Error, Result};
use crate::units::STANDARD_PRESSURE_HPA;

/// The pressure and the temperature of the air at the site, on which refraction depends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weather {
    pressure_hpa: f64,
    temperature_c: f64,
    /// How much stronger this air bends light than that of 1010 hPa and 10 degrees [1].
    pub(super) density: f64,
}

impl Weather {
    /// A pressure [hPa] in [0, 2000] (0: no refraction) and a temperature [degrees C] in [-150, 100].
    ///
    /// # Errors
    /// [`Error::Domain`] for a value outside its range.
    pub fn new(pressure_hpa: f64, temperature_c: f64) -> Result<Self> {
        if !(0.0..=2000.0).contains(&pressure_hpa) {
            return Err(Error::domain(
                "pressure",
                format!("{pressure_hpa} hPa"),
                "0 to 2000 hPa",
                "give the station's own pressure in hPa (mbar), 1013.25 at sea level",
            ));
        }
        if !(-150.0..=100.0).contains(&temperature_c) {
            return Err(Error::domain(
                "temperature",
                format!("{temperature_c} degrees C"),
                "-150 to 100 degrees C",
                "give the air's temperature in degrees Celsius",
            ));
        }
        Ok(Self {
            pressure_hpa,
            temperature_c,
            density: density(pressure_hpa, temperature_c),
        })
    }

    /// The standard atmosphere at the site's elevation.
    pub fn standard(site: &Site) -> Self {
        let (pressure_hpa, temperature_c) = standard_atmosphere(site.elevation());
        Self {
            pressure_hpa,
            temperature_c,
            density: density(pressure_hpa, temperature_c),
        }
    }

    /// The pressure at the site [hPa].
    pub fn pressure_hpa(&self) -> f64 {
        self.pressure_hpa
    }

    /// The temperature at the site [degrees C].
    pub fn temperature_c(&self) -> f64 {
        self.temperature_c
    }
}

/// How much more air of a pressure [hPa] and a temperature [degrees C] bends light than that of 1010 hPa and 10 degrees [1].
fn density(pressure_hpa: f64, temperature_c: f64) -> f64 {
    pressure_hpa / 1010.0 * 283.0 / (273.0 + temperature_c)
}

/// Pressure [hPa] and temperature [degrees C] of the standard atmosphere at a height [m].
///
/// Source: ISO 2533 (1975): 15 degrees at sea level, 6.5 K less for each km up to 11 km. Above, we stay with its
/// isothermal layer, which gives 1 % of the true pressure's scale at 100 km: refraction is negligible there.
fn standard_atmosphere(height: f64) -> (f64, f64) {
    const LAPSE: f64 = 0.0065; // K/m
    const SEA_LEVEL: f64 = 288.15; // K
    const EXPONENT: f64 = 9.806_65 * 0.028_964_4 / (8.314_32 * LAPSE);
    let tropopause = height.min(11_000.0);
    let temperature = SEA_LEVEL - LAPSE * tropopause;
    let below = STANDARD_PRESSURE_HPA * (temperature / SEA_LEVEL).powf(EXPONENT);
    let above = (height - tropopause) * EXPONENT * LAPSE / temperature;
    (below * (-above).exp(), temperature - 273.15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_atmosphere_is_the_published_one() {
        // ISO 2533, table 5: geopotential heights.
        for (height, pressure, temperature) in [
            (0.0, 1013.25, 15.0),
            (1000.0, 898.746, 8.5),
            (5000.0, 540.199, -17.5),
            (11_000.0, 226.320, -56.5),
            (20_000.0, 54.7489, -56.5),
        ] {
            let (p, t) = standard_atmosphere(height);
            assert!((p / pressure - 1.0).abs() < 1e-5, "{height} m: {p} hPa");
            assert!((t - temperature).abs() < 1e-9);
        }
    }
}
