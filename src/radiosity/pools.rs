//! Pools of light: where the beams of lamps meet surfaces.
//!
//! They may be small and bright, and chance finds them as badly as it does openings. Every place looks at those that may give it much of
//! its light, closely enough to know how much.

use super::arrival::Map;
use crate::scene::{Geometry, Ray};
use glam::DVec3;
use std::f64::consts::PI;

/// The widest cone whose pool is looked at by itself [rad].
pub(super) const WIDEST: f64 = 0.8;

/// The most pools that a place looks at.
const MOST: usize = 4;

/// Pools that could give less than this share of what the brightest one could are not looked at [1].
const DIM: f64 = 0.05;

/// So many cells of directions lie on a pool at least.
const CELLS: f64 = 32.0;

/// Seen more level than this a pool counts as seen at it, as the sine of the angle [1].
const LOW: f64 = 0.05;

/// Where the beam of a lamp meets a surface.
pub(super) struct Pool {
    /// Its middle [m].
    pub point: DVec3,
    /// Unit normal of the surface on the lamp's side.
    pub normal: DVec3,
    /// Its radius [m].
    pub radius: f64,
    /// How far from its middle tiles may have of its light [m].
    pub reach: f64,
    /// The flux that the surface sends on [lm].
    pub flux: f64,
}

impl Pool {
    /// The most that a place may receive of it, up to a factor that is the same for all [lm/m2].
    fn at_most(&self, origin: DVec3) -> f64 {
        let way = origin - self.point;
        let height = way.dot(self.normal);
        if height <= 0.0 {
            return 0.0;
        }
        let square = way.length_squared() + self.radius * self.radius;
        self.flux * height / (square * square.sqrt())
    }

    /// Whether any of it lies before a place that looks at it, and nothing between them: its middle and four points of its rim tell.
    fn is_seen(&self, geometry: &Geometry, origin: DVec3, map: &Map) -> bool {
        let is_before = |point: DVec3| match map {
            Map::Sphere => true,
            Map::Cosine([.., normal]) => normal.dot(point - origin) > 0.0,
        };
        let (u, v) = self.normal.any_orthonormal_pair();
        let rim = [u, -u, v, -v].map(|to| self.point + 0.9 * self.radius * to);
        [self.point].into_iter().chain(rim).any(|point| {
            let way = point - origin;
            way.try_normalize().is_some_and(|direction| {
                is_before(point)
                    && !geometry.occluded(&Ray { origin, direction }, 0.0, 0.999 * way.length())
            })
        })
    }

    /// Its part of all directions, as a map weighs them, about.
    fn weight(&self, origin: DVec3, map: &Map) -> f64 {
        let way = origin - self.point;
        let square = way.length_squared() + self.radius * self.radius;
        // Low over it, or right before it, it fills more than this says of one far away.
        let height = way.dot(self.normal).max(LOW * square.sqrt());
        let solid = PI * self.radius * self.radius * height / (square * square.sqrt());
        match map {
            Map::Sphere => solid,
            Map::Cosine([.., normal]) => {
                let cosine = -normal.dot(way) / square.sqrt();
                solid * cosine.max(self.radius / square.sqrt()).min(1.0) / PI
            }
        }
    }
}

/// A pool as a place sees it.
pub(super) struct Seen {
    /// From the place to its middle [m].
    way: DVec3,
    /// Unit normal of the surface.
    normal: DVec3,
    /// How far from its middle tiles may have of its light [m].
    reach: f64,
    /// Cells of more weight are quartered where it lies.
    pub weight: f64,
}

impl Seen {
    /// Whether a ray's cell may hold a part of the pool, or the tile that it takes on the surface have some of its light: the cell
    /// reaches as far as its own width, which is longer on the surface the more level that is seen, the tile as far as two of them.
    pub fn holds(&self, toward: DVec3, width: f64) -> bool {
        let middle = self.way.normalize_or_zero();
        if (toward - middle).length() <= 2.0 * width {
            return true;
        }
        let fall = self.normal.dot(toward);
        let distance = self.normal.dot(self.way) / fall;
        let aside = distance * toward - self.way;
        let along = (toward - fall * self.normal).normalize_or_zero();
        let (far, across) = (aside.dot(along), aside.cross(along).length());
        let own = width * distance;
        let wide = self.reach + 4.5 * own;
        let long = wide + 1.5 * own / fall.abs().max(0.01);
        distance > 0.0 && (far / long).powi(2) + (across / wide).powi(2) <= 1.0
    }
}

/// Those of some pools that a place looks at: the ones that may give it most.
pub(super) fn looked_at(
    pools: &[Pool],
    geometry: &Geometry,
    origin: DVec3,
    map: &Map,
) -> Vec<Seen> {
    let of = |pool| (Pool::at_most(pool, origin), pool);
    let mut all: Vec<(f64, &Pool)> = pools.iter().map(of).collect();
    all.retain(|(most, _)| *most > 0.0);
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let least = all.first().map_or(0.0, |(most, _)| DIM * most);
    all.truncate(MOST);
    all.retain(|(most, pool)| *most >= least && pool.is_seen(geometry, origin, map));
    let seen = |(_, pool): (f64, &Pool)| Seen {
        way: pool.point - origin,
        normal: pool.normal,
        reach: pool.reach,
        weight: pool.weight(origin, map) / CELLS,
    };
    all.into_iter().map(seen).collect()
}
