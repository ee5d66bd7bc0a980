//! Where light comes into rooms: points in windows, doors, gaps.
//!
//! They are few and small, and chance finds them badly. Rays from all patches find each of them from somewhere; from then on every
//! place looks for those that its own rays have missed.

use glam::DVec3;
use std::collections::HashMap;

/// Points in openings.
#[derive(Default)]
pub(super) struct Openings {
    points: Vec<DVec3>,
    /// How far they are from each other, about [m].
    pub size: f64,
}

/// The most points that are kept: each costs a look at it from every place that sees nothing bright there.
const MOST: usize = 256;

impl Openings {
    /// Keeps some of the points found, `extent` [m] the diagonal of all: of those that are near to each other the one through which
    /// most others see the outside, as `merit` counts.
    pub fn new(points: Vec<(DVec3, usize)>, extent: f64) -> Self {
        let (points, size) = thinned(points, MOST, 1e-4 * extent);
        Openings {
            points: points.into_iter().map(|(point, _)| point).collect(),
            size,
        }
    }

    /// All points.
    pub fn all(&self) -> &[DVec3] {
        &self.points
    }
}

/// At most so many of some points, of those in one cell of space the one of greatest merit; and how large the cells are [m].
pub(super) fn thinned(
    mut points: Vec<(DVec3, usize)>,
    most: usize,
    mut cell: f64,
) -> (Vec<(DVec3, usize)>, f64) {
    while points.len() > most {
        cell *= 1.25;
        let mut best: HashMap<[i64; 3], (DVec3, usize)> = HashMap::new();
        for point in points {
            let place = (point.0 / cell).floor().to_array().map(|x| x as i64);
            let held = best.entry(place).or_insert(point);
            if point.1 > held.1 {
                *held = point;
            }
        }
        let mut kept: Vec<_> = best.into_iter().collect();
        kept.sort_unstable_by_key(|(place, _)| *place);
        points = kept.into_iter().map(|(_, point)| point).collect();
    }
    (points, cell)
}
