//! Pools of light: where the beams of lamps meet surfaces.
//!
//! They may be small and bright, and chance finds them as badly as it does openings. Every place looks at those that may give it much of
//! its light, closely enough to know how much.

use super::arrival::{Map, Source};
use super::transport::Transport;
use crate::colour::luminance;
use crate::conditions::lamps::Lamp;
use crate::scene::{Geometry, Ray};
use glam::DVec3;
use std::f64::consts::PI;

/// The widest cone whose pool is looked at by itself [rad].
const WIDEST: f64 = 0.8;

/// The most pools that a place looks at.
const MOST: usize = 4;

/// Pools that could give less than this share of what the brightest one could are not looked at [1].
const DIM: f64 = 0.05;

/// So many cells of directions lie on a pool at least.
const CELLS: f64 = 32.0;

/// Where the beam of a lamp meets a surface.
pub(super) struct Pool {
    /// Its middle [m].
    point: DVec3,
    /// Unit normal of the surface on the lamp's side.
    normal: DVec3,
    /// Its radius [m].
    radius: f64,
    /// How far from its middle tiles may have of its light [m].
    reach: f64,
    /// The flux that the surface sends on [lm].
    flux: f64,
}

impl Pool {
    /// That of a lamp, if it has a narrow beam that meets anything.
    pub fn of(transport: &Transport, lamp: &Lamp) -> Option<Self> {
        let cone = lamp.distribution.cone();
        if cone > WIDEST {
            return None;
        }
        let ray = Ray {
            origin: lamp.middle(),
            direction: lamp.pose.toward,
        };
        let looked = transport.look(&ray, 0.0);
        let Source::Patch(patch, _) = looked.source else {
            return None;
        };
        let patches = &transport.patches;
        let point = ray.at(looked.distance);
        let mut radius = looked.distance * cone.tan() + lamp.extent();
        let mut reach = radius;
        let normal = match patches.part(patch as usize) {
            Some((face, part)) => {
                // Its light is spread over tiles.
                let tile = (part.high - part.low) / f64::from(1u32 << part.depth);
                reach = radius + tile.length();
                radius = radius.max(0.5 * tile.max_element());
                face.plane.normal
            }
            None => -ray.direction,
        };
        Some(Pool {
            point,
            normal,
            radius,
            reach,
            flux: luminance(patches.all[patch as usize].albedo) * lamp.flux(),
        })
    }

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
        let height = way.dot(self.normal).max(0.0);
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
    /// Unit vector toward its middle.
    toward: DVec3,
    /// How far around that it reaches [rad].
    reach: f64,
    /// Cells of more weight are quartered where it lies.
    pub weight: f64,
}

impl Seen {
    /// Whether what a ray finds may be of the pool: the tile that it takes reaches as far as two of its own width.
    pub fn holds(&self, toward: DVec3, width: f64) -> bool {
        let reach = self.reach + 3.0 * width;
        (toward - self.toward).length_squared() <= reach * reach
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
    let seen = |(_, pool): (f64, &Pool)| {
        let way = pool.point - origin;
        Some(Seen {
            toward: way.try_normalize()?,
            reach: pool.reach / way.length(),
            weight: pool.weight(origin, map) / CELLS,
        })
    };
    all.into_iter().filter_map(seen).collect()
}
