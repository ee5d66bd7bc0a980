//! Places of the air that stand still in the world, and what comes to them from all sides.
//!
//! For each level there is a cubic lattice, of twice the spacing of the one below, which has all its points. Its points do not move
//! with the eye, so that pictures from neighbouring places agree; they are made when they are first needed, and what comes to them
//! is kept.

use crate::radiosity::Care;
use crate::radiosity::arrival::Arrival;
use crate::radiosity::shards::Shards;
use crate::radiosity::transport::Transport;
use crate::scene::{Geometry, Ray};
use glam::DVec3;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// Spacing of level 0 [m].
const UNIT: f64 = 0.968_245_836_551_854;

/// A point of the lattices of all levels, in units of level 0. Like these no round number, so that no point lies in a wall that
/// stands at one.
const START: DVec3 = DVec3::new(0.381_966, 0.276_393, 0.434_17);

/// Pairs of corners of a cell: those of an edge, and those of a diagonal.
pub const PAIRS: [(usize, usize); 16] = [
    (0, 1),
    (2, 3),
    (4, 5),
    (6, 7),
    (0, 2),
    (1, 3),
    (4, 6),
    (5, 7),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
    (0, 7),
    (1, 6),
    (2, 5),
    (3, 4),
];

/// What arrivals may take in memory [bytes]; beyond that they are found anew for another moment.
const MOST: usize = 1 << 29;

/// A point of the lattice, or the cell of which it is the least corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Place {
    level: i32,
    at: [i64; 3],
}

impl Place {
    /// The cell of a level that holds a point, and where in it the point is, 0 to 1.
    pub fn around(point: DVec3, level: i32) -> (Place, DVec3) {
        let position = (point - UNIT * START) / spacing(level);
        let cell = position.floor();
        let place = Place {
            level,
            at: cell.to_array().map(|v| v as i64),
        };
        (place, position - cell)
    }

    /// Where it is [m].
    pub fn position(&self) -> DVec3 {
        let [x, y, z] = self.at.map(|v| v as f64);
        UNIT * START + spacing(self.level) * DVec3::new(x, y, z)
    }

    /// The same point, as one of the coarsest lattice that has it.
    pub fn coarsest(mut self) -> Place {
        const HIGHEST: i32 = 60;
        while self.level < HIGHEST && self.at.iter().all(|v| v % 2 == 0) {
            self.at = self.at.map(|v| v / 2);
            self.level += 1;
        }
        self
    }

    /// The corners of the cell; bits 0, 1 and 2 of their number tell whether they are the farther ones along x, y and z.
    pub fn corners(&self) -> [Place; 8] {
        std::array::from_fn(|corner| Place {
            level: self.level,
            at: std::array::from_fn(|axis| self.at[axis] + (corner >> axis & 1) as i64),
        })
    }

    /// The corners of the cell and those of the cells around it, and where they are in it, -1 to 2.
    pub fn surroundings(&self) -> impl Iterator<Item = (Place, DVec3)> {
        let place = *self;
        (0..64i64).map(move |i| {
            let offset = [i % 4 - 1, i / 4 % 4 - 1, i / 16 - 1];
            let at = std::array::from_fn(|axis| place.at[axis] + offset[axis]);
            let level = place.level;
            (
                Place { level, at },
                DVec3::from_array(offset.map(|v| v as f64)),
            )
        })
    }
}

/// The spacing of a level [m].
pub fn spacing(level: i32) -> f64 {
    UNIT * f64::from(level).exp2()
}

/// The level, as a number that need not be whole, whose spacing is this [m].
pub fn level_of(spacing: f64) -> f64 {
    (spacing / UNIT).log2()
}

/// What comes to points of the air, as far as it was asked for.
pub struct Lattice {
    /// Who sees whom.
    pub transport: Arc<Transport>,
    geometry: Arc<Geometry>,
    care: Care,
    arrivals: Shards<Place, Option<Arc<Vec<Arrival>>>>,
    pairs: Shards<Place, u16>,
    bytes: AtomicUsize,
}

impl Lattice {
    /// An empty one.
    pub fn new(transport: Arc<Transport>, geometry: Arc<Geometry>, care: Care) -> Self {
        Lattice {
            transport,
            geometry,
            care,
            arrivals: Shards::new(),
            pairs: Shards::new(),
            bytes: AtomicUsize::new(0),
        }
    }

    /// Cells along each side of the grid of directions in which points look around, before outlines are refined.
    pub fn side(&self) -> u32 {
        (self.care.rays as f64).sqrt().round().max(2.0) as u32
    }

    /// What comes to any point from all sides.
    pub fn around(&self, point: DVec3) -> Vec<Arrival> {
        self.transport.around(point, self.care)
    }

    /// What comes to a point of the lattice from all sides.
    pub fn arrivals(&self, place: Place) -> Arc<Vec<Arrival>> {
        let slot: Arc<OnceLock<_>> = self.arrivals.place(place);
        let mut found = None;
        let kept = slot.get_or_init(|| {
            let arrivals = Arc::new(self.around(place.position()));
            found = Some(arrivals.clone());
            let bytes = size_of::<Arrival>() * arrivals.capacity();
            let before = self.bytes.fetch_add(bytes, Ordering::Relaxed);
            (before + bytes <= MOST).then_some(arrivals)
        });
        match kept.clone().or(found) {
            Some(arrivals) => arrivals,
            None => Arc::new(self.around(place.position())),
        }
    }

    /// Which of the `PAIRS` of a cell's corners see each other, bit by bit.
    pub fn pairs(&self, cell: Place) -> u16 {
        *self.pairs.place(cell).get_or_init(|| {
            let corners = cell.corners().map(|corner| corner.position());
            let (low, high) = self.geometry.bounds();
            if self.geometry.triangle_count() == 0 && self.geometry.panes().is_none()
                || corners[0].cmpgt(high).any()
                || corners[7].cmplt(low).any()
            {
                return u16::MAX;
            }
            let seen = PAIRS.map(|(a, b)| self.sees(corners[a], corners[b]));
            (0..16).map(|i| u16::from(seen[i]) << i).sum()
        })
    }

    /// Whether nothing stands between two places that stops all light, or colours it.
    pub fn sees(&self, from: DVec3, to: DVec3) -> bool {
        let way = to - from;
        let distance = way.length();
        if distance == 0.0 {
            return true;
        }
        let ray = Ray {
            origin: from,
            direction: way / distance,
        };
        let is_coloured = self
            .geometry
            .panes()
            .is_some_and(|panes| !panes.crossings(&ray, 0.0, distance).is_empty());
        !is_coloured && !self.geometry.occluded(&ray, 0.0, distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_holds_what_is_in_it() {
        for level in [-7, 0, 3] {
            for point in [
                DVec3::new(0.3, -12.7, 1e3),
                DVec3::ZERO,
                DVec3::splat(-0.01),
            ] {
                let (cell, share) = Place::around(point, level);
                let corners = cell.corners();
                let (low, high) = (corners[0].position(), corners[7].position());
                assert!(low.cmple(point).all() && high.cmpge(point).all());
                let same = corners[5].coarsest().position();
                assert!((same - corners[5].position()).length() < 1e-9 * (1.0 + same.length()));
                let back = low + share * (high - low);
                assert!((back - point).length() < 1e-9 * (1.0 + point.length()));
            }
            assert!((level_of(spacing(level)) - f64::from(level)).abs() < 1e-12);
        }
    }
}
