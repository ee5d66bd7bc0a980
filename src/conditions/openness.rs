//! How much daylight meets a surface that shines, against a surface in the open.
//!
//! A sign that is lost beside open ground is all there is to see by in a room without windows.

use super::GroundPlane;
use super::evenly::evenly;
use crate::colour::luminance;
use crate::scene::{Geometry, Ray};
use glam::DVec3;

/// Directions from one place.
const RAYS: u32 = 64;

/// The share of what a place with a normal would receive from a dome all around that comes from the sky, or from ground that the zenith
/// lights [1]. Light that surfaces send on is not counted.
pub(super) fn openness(
    place: DVec3,
    normal: DVec3,
    geometry: &Geometry,
    ground: Option<GroundPlane>,
) -> f64 {
    let near = 1e-9 * geometry.extent();
    let free = |origin: DVec3, direction: DVec3, far: f64| {
        luminance(geometry.transmittance(&Ray { origin, direction }, near, far))
    };
    let along = |k: u32| {
        // A normal and an even direction together go by the cosine law.
        let direction = (normal + evenly(k, RAYS)).normalize_or(normal);
        if direction.y > 0.0 {
            return free(place, direction, f64::INFINITY);
        }
        let Some(GroundPlane { height, .. }) = ground else {
            return 0.0;
        };
        let far = (height - place.y) / direction.y;
        match far.is_finite() && far > near {
            true => {
                let lit = place + far * direction;
                free(place, direction, far) * free(lit, DVec3::Y, f64::INFINITY)
            }
            false => 0.0,
        }
    };
    (0..RAYS).map(along).sum::<f64>() / f64::from(RAYS)
}
