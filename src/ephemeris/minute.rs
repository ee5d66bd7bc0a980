//! Tier `minute`: Meeus's low-accuracy sun, the algorithm behind NOAA's calculator, with delta-T and parallax.
//!
//! Direction within 0.0105 degrees from 1900 to 2100 (36 arcseconds measured). An unperturbed ellipse with the main
//! term of nutation; what is left out is mainly the pull of the planets (up to 20 arcseconds) and of the moon (6).
//!
//! Source: Meeus 1998, Astronomical Algorithms, chapter 25 (equations 25.2 to 25.8) and chapter 12 (sidereal time).

use super::julian::Julian;
use super::place::Place;
use super::spa;
use crate::units::DEG;

/// The sun's geocentric apparent place at a terrestrial time.
pub(super) fn place(tt: Julian) -> Place {
    let t = tt.centuries();
    let mean_longitude = (280.466_46 + t * (36_000.769_83 + 0.000_303_2 * t)) * DEG; // 25.2
    let mean_anomaly = (357.529_11 + t * (35_999.050_29 - 0.000_153_7 * t)) * DEG; // 25.3
    let eccentricity = 0.016_708_634 - t * (0.000_042_037 + 0.000_000_126_7 * t); // 25.4
    let centre = ((1.914_602 - t * (0.004_817 + 0.000_014 * t)) * mean_anomaly.sin()
        + (0.019_993 - 0.000_101 * t) * (2.0 * mean_anomaly).sin()
        + 0.000_289 * (3.0 * mean_anomaly).sin())
        * DEG;
    let true_anomaly = mean_anomaly + centre;
    // 25.5
    let distance_au = 1.000_001_018 * (1.0 - eccentricity * eccentricity)
        / (1.0 + eccentricity * true_anomaly.cos());
    let (sin_node, cos_node) = ((125.04 - 1934.136 * t) * DEG).sin_cos();
    let nutation = -0.004_78 * DEG * sin_node;
    let longitude = mean_longitude + centre - 0.005_69 * DEG + nutation;
    // 22.2 and 25.8
    let obliquity = (84_381.448 - t * (46.8150 + t * (0.000_59 - 0.001_813 * t))) / 3600.0 * DEG
        + 0.002_56 * DEG * cos_node;
    Place::from_ecliptic(
        longitude,
        0.0,
        obliquity,
        distance_au,
        nutation * obliquity.cos(),
        spa::mean_longitude(t / 10.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meeus_example_25a() {
        // 1992 October 13, 0h TD: alpha = 198.38083, delta = -7.78507 degrees, R = 0.99766.
        let place = place(Julian::new(2_448_908.5, 0.0));
        assert!(
            (place.right_ascension() / DEG - 198.380_83).abs() < 5.1e-6,
            "{}",
            place.right_ascension() / DEG
        );
        assert!(
            (place.declination / DEG + 7.785_07).abs() < 5.1e-6,
            "{}",
            place.declination / DEG
        );
        assert!((place.distance_au - 0.997_66).abs() < 5.1e-6);
    }
}
