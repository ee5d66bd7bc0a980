//! From a pixel to a ray.

use glam::{DVec2, DVec3};

/// Where the eye is, where it looks, and how the picture is projected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position of the eye [m].
    pub eye: DVec3,
    /// Where it looks; any length but zero.
    pub forward: DVec3,
    /// A direction that is up in the picture; need not be at right angles to `forward`. Where the two are parallel,
    /// the scene's -Z (or, looking down, +Z... the head's own up) takes its place: see [`Camera::axes`].
    pub up: DVec3,
    /// How directions become pixels.
    pub projection: Projection,
    /// Lens shift in picture widths and heights, right and up positive.
    pub shift: DVec2,
}

/// How directions become pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Central projection on a plane.
    Perspective {
        /// Vertical field of view [rad], above 0 and below pi.
        fov_y: f64,
    },
    /// Parallel projection.
    Orthographic {
        /// Height of what is seen [m].
        height: f64,
    },
    /// Equirectangular: the whole sphere, `forward` in the middle, the zenith on top.
    Panorama,
}
