//! From the sun's geocentric place to what an observer sees.

use std::f64::consts::TAU;

use super::julian::Julian;
use super::place::{Place, half_turn};
use super::refraction::{air_mass, refraction};
use super::site::{EARTH_RADIUS, Site};
use super::tier::Tier;
use super::time::Instant;
use super::trigonometry::{arctangent, sin_cos};
use super::weather::Weather;
use super::{arcsecond, day, minute, spa};
use crate::units::{DEG, SUN_DIAMETER};

/// The earth's equatorial radius [au]; the unit is 149 597 870 700 m (IAU 2012).
pub(super) const EARTH_RADIUS_AU: f64 = EARTH_RADIUS / 149_597_870_700.0;

/// The speed of the equator by the earth's rotation over that of light: diurnal aberration, 0.32 arcseconds.
const ROTATION_SPEED: f64 = 7.292_115e-5 * EARTH_RADIUS / 299_792_458.0;

/// Where the sun stands for an observer. Every value is finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPosition {
    /// Azimuth [rad] in [0, 2 pi), from north through east, topocentric. At the zenith and the nadir it has no
    /// meaning: some finite value.
    pub azimuth: f64,
    /// Topocentric elevation of the disc's centre along the straight line [rad], in [-pi/2, pi/2].
    pub elevation_true: f64,
    /// Topocentric elevation of the disc's centre as seen through the air [rad]: see [`refraction`].
    pub elevation_apparent: f64,
    /// Geocentric apparent declination [rad].
    pub declination: f64,
    /// Geocentric apparent right ascension [rad] in [0, 2 pi), from the true equinox of date.
    pub right_ascension: f64,
    /// Local hour angle [rad] in (-pi, pi], geocentric; zero when the sun crosses the meridian, positive after.
    pub hour_angle: f64,
    /// Apparent minus mean solar time [minutes], as Reda & Andreas 2004 define it.
    pub equation_of_time_minutes: f64,
    /// Distance of the sun's from the earth's centre [au].
    pub distance_au: f64,
    /// Angular radius of the disc [rad], from the earth's centre.
    pub angular_radius: f64,
    /// Extraterrestrial irradiance over the solar constant, 1 / distance^2.
    pub irradiance_factor: f64,
}

impl SunPosition {
    /// Relative air mass along the apparent elevation, 37.92 at and below the horizon (Kasten & Young 1989, [`air_mass`]).
    pub fn air_mass(&self) -> f64 {
        air_mass(self.elevation_apparent)
    }

    /// Azimuth [degrees] in [0, 360), from north through east.
    pub fn azimuth_deg(&self) -> f64 {
        let degrees = self.azimuth / DEG;
        if degrees < 360.0 { degrees } else { 0.0 }
    }

    /// True elevation [degrees].
    pub fn elevation_true_deg(&self) -> f64 {
        self.elevation_true / DEG
    }

    /// Apparent elevation [degrees].
    pub fn elevation_apparent_deg(&self) -> f64 {
        self.elevation_apparent / DEG
    }

    /// The unit vector toward the sun on axes east, north and up, along the true or the apparent elevation.
    pub fn direction(&self, apparent: bool) -> [f64; 3] {
        let elevation = if apparent {
            self.elevation_apparent
        } else {
            self.elevation_true
        };
        let (sin_a, cos_a) = self.azimuth.sin_cos();
        let (sin_e, cos_e) = elevation.sin_cos();
        [cos_e * sin_a, cos_e * cos_a, sin_e]
    }
}

/// The sun's position at an instant for an observer.
///
/// Topocentric in every tier but `day`, which is not that accurate: the observer stands on WGS84, 8.8 arcseconds of
/// parallax away from the earth's centre. Polar motion (0.5 arcseconds) is left out.
///
/// Source of the geocentric place: see [`Tier`]; of the parallax: the exact difference of vectors, which Reda & Andreas
/// 2004, equations 35 to 41, also amounts to.
pub fn sun_position(tier: Tier, instant: &Instant, site: &Site, weather: &Weather) -> SunPosition {
    let (place, equation_of_time) = geocentric(tier, instant);
    observe(tier, &place, equation_of_time, instant, site, weather)
}

/// The geocentric place and the equation of time [rad].
pub(super) fn geocentric(tier: Tier, instant: &Instant) -> (Place, f64) {
    if tier == Tier::Day {
        return day::place(instant);
    }
    let place = place_at(tier, instant.tt());
    (place, place.equation_of_time())
}

/// The geocentric place at a terrestrial time, of a tier that has such (`day` counts the civil days of universal time).
pub(super) fn place_at(tier: Tier, tt: Julian) -> Place {
    match tier {
        Tier::Day | Tier::Minute => minute::place(tt),
        Tier::Spa => spa::place(tt),
        Tier::Arcsecond => arcsecond::place(tt),
    }
}

/// The arcsine of a few thousandths, to 1e-13.
fn small_arcsine(x: f64) -> f64 {
    x * (1.0 + x * x * (1.0 / 6.0))
}

/// The mean sidereal time at Greenwich [rad] of a tier: the part of the day since midnight, which may be any number of
/// days more than the truth, days since J2000.0 of universal and of terrestrial time.
#[inline(always)]
pub(super) fn mean_sidereal(tier: Tier, fraction: f64, ut_days: f64, tt_days: f64) -> f64 {
    match tier {
        Tier::Arcsecond => arcsecond::sidereal_time(fraction, ut_days, tt_days),
        _ => spa::sidereal_time(fraction, ut_days),
    }
}

/// The speed of the place by the earth's rotation over that of light, in the tier that knows of it.
pub(super) fn aberration(tier: Tier, site: &Site) -> f64 {
    if tier == Tier::Arcsecond {
        ROTATION_SPEED * site.axial
    } else {
        0.0
    }
}

/// Azimuth [rad] in [0, 2 pi) and true elevation [rad] from sine and cosine of hour angle and declination and the
/// earth's radius in distances of the sun. Without a branch.
#[inline(always)]
pub(super) fn topocentric(
    (sin_h, cos_h): (f64, f64),
    (sin_d, cos_d): (f64, f64),
    radii: f64,
    aberration: f64,
    site: &Site,
) -> (f64, f64) {
    // Axes of the meridian: outward in the equator's plane, east, and north along the earth's axis.
    let outward = cos_d * cos_h - radii * site.axial;
    let east = aberration - cos_d * sin_h;
    let along = sin_d - radii * site.polar;
    let north = along * site.cos_latitude - outward * site.sin_latitude;
    let up = along * site.sin_latitude + outward * site.cos_latitude;

    let angle = arctangent(east, north);
    let azimuth = if angle < 0.0 { angle + TAU } else { angle };
    (
        // Slightly west of north rounds to a whole turn.
        if azimuth < TAU { azimuth } else { 0.0 },
        arctangent(up, (east * east + north * north).sqrt()),
    )
}

/// What an observer sees of a geocentric place.
pub(super) fn observe(
    tier: Tier,
    place: &Place,
    equation_of_time: f64,
    instant: &Instant,
    site: &Site,
    weather: &Weather,
) -> SunPosition {
    let (ut, tt) = (instant.ut(), instant.tt());
    let sidereal =
        mean_sidereal(tier, ut.fraction, ut.days(), tt.days()) + place.equation_of_equinoxes;
    let longitude = site.longitude_deg() * DEG;
    let hour_angle = half_turn(sidereal + longitude - place.mean_longitude - place.from_mean);

    let nearness = 1.0 / place.distance_au;
    let [h, d] = sin_cos([hour_angle, place.declination]);
    let radii = if tier == Tier::Day {
        0.0
    } else {
        EARTH_RADIUS_AU * nearness
    };
    let (azimuth, elevation_true) = topocentric(h, d, radii, aberration(tier, site), site);
    let elevation_apparent = elevation_true + refraction(elevation_true, weather);
    SunPosition {
        azimuth,
        elevation_true,
        elevation_apparent,
        declination: place.declination,
        right_ascension: place.right_ascension(),
        hour_angle,
        equation_of_time_minutes: equation_of_time * (4.0 / DEG),
        distance_au: place.distance_au,
        angular_radius: small_arcsine(0.5 * SUN_DIAMETER * nearness),
        irradiance_factor: nearness * nearness,
    }
}

#[cfg(test)]
mod tests {
    use super::super::time::TimeScale;
    use super::*;

    #[test]
    fn the_report_s_worked_example() {
        // Reda & Andreas 2004, table A5.1, each to its last digit.
        let ut = Julian::new(2_452_929.5, (19.0 * 3600.0 + 30.0 * 60.0 + 30.0) / 86_400.0);
        let instant = Instant::from_julian(ut, TimeScale::Ut1, Some(67.0)).unwrap();
        let site = Site::new(39.742_476, -105.1786, 1830.14).unwrap();
        let sun = sun_position(
            Tier::Spa,
            &instant,
            &site,
            &Weather::new(820.0, 11.0).unwrap(),
        );
        for (value, published, last_digit) in [
            (90.0 - sun.elevation_apparent / DEG, 50.111_62, 5e-6),
            (sun.azimuth_deg(), 194.340_24, 5e-6),
            (sun.hour_angle / DEG, 11.105_90, 5e-6),
            (sun.elevation_true / DEG, 39.872_046, 5e-7),
            (sun.right_ascension / DEG, 202.227_41, 5e-6),
            (sun.declination / DEG, -9.314_34, 5e-6),
            // Its printed 14.641503 follows from the rounded right ascension; pvlib has 14.641511 too.
            (sun.equation_of_time_minutes, 14.641_511, 5e-7),
        ] {
            assert!(
                (value - published).abs() <= last_digit,
                "{value} against {published}"
            );
        }
    }
}
