//! The unit rule: SI and radians inside; any other unit is in the name (`latitude_deg`, `wavelength_nm`).

/// Radians in a degree.
pub const DEG: f64 = std::f64::consts::PI / 180.0;

/// Radians in an arcsecond.
pub const ARCSEC: f64 = DEG / 3600.0;

/// Seconds in a day.
pub const DAY: f64 = 86_400.0;

/// The luminous efficacy of monochromatic radiation at 555 nm in air, 683.002 lm/W.
///
/// Source: CIE 18:2019; the exact constant K_cd = 683 lm/W belongs to 540 THz.
pub const LUMINOUS_EFFICACY: f64 = 683.002;

/// The standard atmosphere's pressure at sea level [hPa].
pub const STANDARD_PRESSURE_HPA: f64 = 1013.25;

/// Angular diameter of the sun at one astronomical unit [rad], 0.5332 degrees.
///
/// Source: twice the arcsine of the IAU 2015 nominal solar radius, 695 700 km, over 149 597 870.7 km.
pub const SUN_DIAMETER: f64 = 2.0 * 695_700.0 / 149_597_870.7;
