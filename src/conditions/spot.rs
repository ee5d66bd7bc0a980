//! A place that stands for a part of a lamp.

use glam::DVec3;

/// A place of a lamp that stands for a part of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Where it is [m].
    pub position: DVec3,
    /// The side on which it shines, and whether the cosine with it counts; `None` where it shines all around.
    pub side: Option<(DVec3, bool)>,
    /// The part of the lamp's intensity that it has [1].
    pub share: f64,
    /// How far it stands for the lamp [m]: nearer than this it gets no brighter.
    pub radius: f64,
    /// Its colour beside the lamp's [1, RGB].
    pub tint: DVec3,
}
