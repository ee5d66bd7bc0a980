//! Points of surfaces that have been looked at from, whatever the moment.

use super::arrival::Source;
use super::shards::Shards;
use glam::Vec3;

/// What a point has seen of each source: the form factor [1] times what is let through on the way.
pub(super) type Factors = Box<[(Source, Vec3)]>;

/// A look around from a point.
pub(super) struct Sight {
    pub factors: Factors,
    /// Whether something lies right upon it.
    pub is_covered: bool,
}

/// What points have seen.
pub(super) type Seen = Shards<Point, Sight>;

/// A point of the lattices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Point {
    /// On a face, at coordinates in units of a millionth of its side.
    Face(u32, i64, i64),
    /// A corner of a triangle, and on which side.
    Corner(u32, u8, bool),
}
