//! What a place receives, direction by direction.

use glam::{DVec3, Vec3};

/// Where light comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Source {
    /// Nowhere: below the horizon of a scene without a ground.
    Nothing,
    /// A patch of the sky, by its number in the [`super::Dome`].
    Sky(u32),
    /// The ground far from everything, which lies open to sky and sun.
    OpenGround,
    /// A patch of a surface, by its number.
    Patch(u32),
}

/// Light that comes to a place from around one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// Unit vector toward where it comes from.
    pub toward: Vec3,
    /// The solid angle that it stands for [sr]; of a surface's arrivals, the part of its form factor: cos(theta) dw / pi [1].
    pub share: f32,
    /// What media and see-through surfaces on the way let through [1], RGB.
    pub through: Vec3,
    /// Where it comes from.
    pub source: Source,
}

/// The direction around +Z of a point of the unit square, equal areas for equal shares of cos(theta) dw: the concentric map
/// of Shirley & Chiu 1997 onto the disc, raised to the hemisphere.
pub(super) fn cosine_law(x: f64, y: f64) -> DVec3 {
    use std::f64::consts::PI;
    let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec3::Z;
    }
    let (radius, angle) = if a.abs() > b.abs() {
        (a, PI / 4.0 * (b / a))
    } else {
        (b, PI / 2.0 - PI / 4.0 * (a / b))
    };
    let (sin, cos) = angle.sin_cos();
    DVec3::new(
        radius * cos,
        radius * sin,
        (1.0 - radius * radius).max(0.0).sqrt(),
    )
}

/// The direction of a point of the unit square, equal areas for equal solid angles of the sphere: the cylinder of Archimedes around
/// the vertical.
pub(super) fn all_round(x: f64, y: f64) -> DVec3 {
    let height = 2.0 * y - 1.0;
    let level = (1.0 - height * height).max(0.0).sqrt();
    let (sin, cos) = (2.0 * std::f64::consts::PI * x).sin_cos();
    DVec3::new(level * cos, height, level * sin)
}
