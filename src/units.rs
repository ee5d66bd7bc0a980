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

/// A quantity in words for people: whole numbers, two significant digits below ten, an exponent below a thousandth.
pub fn brief(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if size >= 9.95 => format!("{value:.0}"),
        size if size >= 0.995 => format!("{value:.1}"),
        size if size >= 0.0995 => format!("{value:.2}"),
        size if size >= 0.00995 => format!("{value:.3}"),
        size if size >= 0.000_995 => format!("{value:.4}"),
        _ => format!("{value:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_light_is_written_as_none() {
        for (value, text) in [
            (88_501.2, "88501"),
            (9.96, "10"),
            (3.27, "3.3"),
            (0.1, "0.10"),
            (0.0021, "0.0021"),
            (3.2e-7, "3.2e-7"),
            (0.0, "0"),
            (-0.25, "-0.25"),
        ] {
            assert_eq!(brief(value), text);
        }
    }
}
