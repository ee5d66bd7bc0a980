//! Points of surfaces that have been looked at from, whatever the moment.

use super::arrival::Row;
use super::shards::Shards;

/// What points have seen.
pub(super) type Seen = Shards<Point, Row>;

/// A point of the lattices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Point {
    /// On a face, at coordinates in units of a millionth of its side.
    Face(u32, i64, i64),
    /// A corner of a triangle, and on which side.
    Corner(u32, u8, bool),
}
