//! A position of the sun as the cells of a row.

use tyndall::ephemeris::SunPosition;
use tyndall::units::DEG;

/// The columns of a position, in degrees unless the name says otherwise.
pub fn columns(sun: &SunPosition) -> [(&'static str, f64); 11] {
    [
        ("azimuth", sun.azimuth_deg()),
        ("elevation_true", sun.elevation_true_deg()),
        ("elevation_apparent", sun.elevation_apparent_deg()),
        ("declination", sun.declination / DEG),
        ("right_ascension", sun.right_ascension / DEG),
        ("equation_of_time", sun.equation_of_time_minutes),
        ("distance_au", sun.distance_au),
        ("hour_angle", sun.hour_angle / DEG),
        ("angular_radius", sun.angular_radius / DEG),
        ("air_mass", sun.air_mass()),
        ("irradiance_factor", sun.irradiance_factor),
    ]
}
