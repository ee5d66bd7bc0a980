//! Places that something lies right upon: a floor under its carpet, a wall behind a picture, one of two sheets of a terrain.
//!
//! It is dark there and nobody looks, but for a thin gap; the surface beside it may lie in the open. So what is found there is not
//! taken for what is beside it, and the other way round.

use super::arrival::{Map, spread};
use super::transport::Transport;
use crate::scene::Ray;
use glam::DVec3;

/// Rays by which it is found, by the cosine law.
const RAYS: usize = 16;

/// So many of them get away from an open place. In the corner of a room that has walls on two sides a quarter of them would.
const FREE: usize = 2;

impl Transport {
    /// Whether nearly all that a place on a surface might see is nearer than `reach` [m]: by less than an eighth of its light.
    pub(super) fn is_covered(&self, point: DVec3, facet: DVec3, reach: f64) -> bool {
        let map = Map::before(facet);
        let origin = point + self.near(point) * facet;
        let is_free = |i: &usize| {
            let [x, y, ..] = spread(*i, 0);
            let ray = Ray {
                origin,
                direction: map.toward(x, y),
            };
            !self.conditions.geometry.occluded(&ray, 0.0, reach)
        };
        let mut free = (0..RAYS).filter(is_free);
        free.nth(FREE - 1).is_none()
    }
}
