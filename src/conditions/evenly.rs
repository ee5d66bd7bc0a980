//! Directions that lie evenly all around.

use glam::DVec3;

/// Turned by this again and again, directions lie evenly around: pi (3 - sqrt 5) [rad].
pub(super) const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// The `k`th of `count` unit vectors that lie evenly on a sphere, from the top down.
pub(super) fn evenly(k: u32, count: u32) -> DVec3 {
    let height = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count);
    let (y, x) = (GOLDEN_ANGLE * f64::from(k)).sin_cos();
    let across = (1.0 - height * height).sqrt();
    DVec3::new(across * x, height, across * y)
}
