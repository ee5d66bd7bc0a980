//! Angles between directions that keep their digits where acos and asin do not.

use glam::DVec3;

/// Angle [rad] between unit vectors and its cosine, exact near 0 and pi, where acos is not.
pub(super) fn angle_between(a: DVec3, b: DVec3) -> (f64, f64) {
    let cos = a.dot(b);
    (a.cross(b).length().atan2(cos), cos)
}

/// Elevation [rad] of a unit vector.
pub(super) fn elevation_of(w: DVec3) -> f64 {
    w.y.atan2(w.x.hypot(w.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::DEG;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn an_elevation_is_exact_at_the_zenith() {
        assert_eq!(elevation_of(DVec3::Y), FRAC_PI_2);
        let near = DVec3::new(1e-9, 1.0, 0.0);
        assert!((FRAC_PI_2 - elevation_of(near) - 1e-9).abs() < 1e-15);
        assert!(elevation_of(DVec3::new(0.8, -0.6, 0.0)) < -0.6 * DEG);
    }
}
