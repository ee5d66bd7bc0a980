//! Where the observer stands.

use crate::error::{Error, Result};
use crate::units::DEG;

/// The ratio of the earth's polar to its equatorial radius (WGS84, f = 1/298.257223563).
const AXIS_RATIO: f64 = 1.0 - 1.0 / 298.257_223_563;
/// The earth's equatorial radius [m] (WGS84).
pub(super) const EARTH_RADIUS: f64 = 6_378_137.0;

/// A place on the earth: geodetic latitude, longitude and height on WGS84.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    latitude_deg: f64,
    longitude_deg: f64,
    elevation: f64,
    /// Sine and cosine of the latitude.
    pub(super) sin_latitude: f64,
    pub(super) cos_latitude: f64,
    /// Distance from the earth's axis and from the equator's plane [equatorial radii].
    pub(super) axial: f64,
    pub(super) polar: f64,
}

impl Site {
    /// A place: latitude in [-90, 90] degrees north, longitude in degrees east (any number of turns, wrapped into
    /// [-180, 180)), elevation in metres above sea level in [-12 000, 100 000].
    ///
    /// # Errors
    /// [`Error::Domain`] for a value outside its range or not finite.
    pub fn new(latitude_deg: f64, longitude_deg: f64, elevation: f64) -> Result<Self> {
        if !(-90.0..=90.0).contains(&latitude_deg) {
            return Err(Error::domain(
                "latitude",
                format!("{latitude_deg} degrees"),
                "-90 to 90 degrees",
                "were latitude and longitude swapped?",
            ));
        }
        if !longitude_deg.is_finite() {
            return Err(Error::domain(
                "longitude",
                format!("{longitude_deg} degrees"),
                "any finite number of degrees east",
                "give the longitude as a number, negative to the west",
            ));
        }
        if !(-12_000.0..=100_000.0).contains(&elevation) {
            return Err(Error::domain(
                "elevation",
                format!("{elevation} m"),
                "-12000 to 100000 m above sea level",
                "give the site's height in metres",
            ));
        }
        let wrapped = (longitude_deg + 180.0).rem_euclid(360.0) - 180.0;
        // 202.6 degrees are -157.4, not -157.39999999999998.
        let wrapped = (wrapped * 1e11).round() / 1e11;
        // What is in range already keeps all its bits.
        let longitude_deg = if (-180.0..180.0).contains(&longitude_deg) {
            longitude_deg
        } else if wrapped < 180.0 {
            wrapped
        } else {
            -180.0
        };
        let (sin_latitude, cos_latitude) = (latitude_deg * DEG).sin_cos();
        // The point of the ellipsoid under the site by its reduced latitude u, tan u = (b/a) tan(latitude).
        let (sin_u, cos_u) = (AXIS_RATIO * sin_latitude).atan2(cos_latitude).sin_cos();
        let height = elevation / EARTH_RADIUS;
        Ok(Self {
            latitude_deg,
            longitude_deg,
            elevation,
            sin_latitude,
            cos_latitude,
            axial: cos_u + height * cos_latitude,
            polar: AXIS_RATIO * sin_u + height * sin_latitude,
        })
    }

    /// The geodetic latitude [degrees], north positive, in [-90, 90].
    pub fn latitude_deg(&self) -> f64 {
        self.latitude_deg
    }

    /// Latitude and longitude as people write them ([`coordinates`]).
    pub fn coordinates(&self) -> String {
        coordinates(self.latitude_deg, self.longitude_deg)
    }

    /// The longitude [degrees], east positive, in [-180, 180).
    pub fn longitude_deg(&self) -> f64 {
        self.longitude_deg
    }

    /// The height above sea level [m]; geoid and ellipsoid are not distinguished (at most 107 m, 0.0001 arcseconds).
    pub fn elevation(&self) -> f64 {
        self.elevation
    }
}

/// Latitude and longitude [degrees] as people write them: `48.8584°N, 2.2945°E`, to a millionth of a degree, 0.1 m on the ground.
pub fn coordinates(latitude_deg: f64, longitude_deg: f64) -> String {
    let degrees = |value: f64, letters: [char; 2]| {
        let rounded = (value * 1e6).round() / 1e6;
        format!("{}°{}", rounded.abs(), letters[usize::from(rounded < 0.0)])
    };
    let north = degrees(latitude_deg, ['N', 'S']);
    format!("{north}, {}", degrees(longitude_deg, ['E', 'W']))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn longitude_wraps_and_latitude_does_not() {
        assert_eq!(Site::new(0.0, 540.0, 0.0).unwrap().longitude_deg(), -180.0);
        assert_eq!(Site::new(0.0, 180.0, 0.0).unwrap().longitude_deg(), -180.0);
        assert_eq!(Site::new(0.0, -190.0, 0.0).unwrap().longitude_deg(), 170.0);
        assert_eq!(Site::new(0.0, 202.6, 0.0).unwrap().longitude_deg(), -157.4);
        let site = Site::new(-(20.0 + 1.0 / 3.0), 202.6, 0.0).unwrap();
        assert_eq!(site.coordinates(), "20.333333°S, 157.4°W");
        assert_eq!(coordinates(-1e-9, -1e-9), "0°N, 0°E");
        assert_eq!(coordinates(-1e-6, 6e-7), "0.000001°S, 0.000001°E");
        assert!(
            (-180.0..180.0).contains(&Site::new(0.0, -180.0 - 1e-14, 0.0).unwrap().longitude_deg())
        );
        assert!((-180.0..180.0).contains(&Site::new(0.0, 1e300, 0.0).unwrap().longitude_deg()));
        let swapped = Site::new(151.2, -33.86, 0.0).unwrap_err();
        assert!(swapped.to_string().contains("swapped"));
        for (lat, lon, elevation) in [
            (91.0, 0.0, 0.0),
            (f64::NAN, 0.0, 0.0),
            (0.0, f64::INFINITY, 0.0),
            (0.0, 0.0, 2e5),
            (0.0, 0.0, f64::NAN),
        ] {
            assert!(Site::new(lat, lon, elevation).is_err());
        }
    }
}
