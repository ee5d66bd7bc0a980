//! What does not change with the time of day: who sees whom, and through what.

use super::arrival::{Care, Source};
use super::dome::Dome;
use super::exchange::Exchange;
use super::gaps::Gap;
use super::openings::Openings;
use super::patches::{Patch, Patches, Spot};
use super::points::Seen;
use super::pools::Pool;
use super::tiles::Tile;
use crate::conditions::{Conditions, Receiver};
use crate::scene::{Hit, Ray, opacity};
use glam::{DVec3, Vec3};
use std::ops::Range;
use std::sync::atomic::AtomicU64;

/// How finely light is carried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detail {
    /// Each of Tregenza's 145 patches of the sky is split this many times each way; 0 stands for ReLiShaft's 5 728 triangles.
    pub sky: u32,
    /// How closely places are looked at whose light is wanted.
    pub care: Care,
    /// A patch is at most this share as large as what it is a part of and what stands next to it.
    pub patch: f64,
    /// The most patches.
    pub patches: usize,
    /// Rays from all patches together; none sends fewer than 16.
    pub patch_rays: usize,
    /// Texels on a side of the hemicubes by which patches see each other; 0: by rays.
    pub hemicube: usize,
    /// Points of each patch on which a hemicube stands; 1: its middle.
    pub hemicube_spots: usize,
    /// Points on patches from where openings are looked at closely: of all patches that see the outside through small openings, the
    /// largest.
    pub patch_spots: usize,
}

/// Who sees whom in a scene, and through what.
pub struct Transport {
    pub(super) conditions: Conditions,
    pub(super) dome: Dome,
    pub(super) patches: Patches,
    pub(super) exchange: Exchange,
    pub(super) openings: Openings,
    /// Where the beams of lamps meet surfaces.
    pub(super) pools: Vec<Pool>,
    pub(super) gaps: Vec<Gap>,
    /// Which patches light reaches through small gaps alone; none of them, where there are no gaps.
    pub(super) by_gaps: Vec<bool>,
    /// Which patches shine by themselves; empty: none.
    pub(super) shining: Vec<bool>,
    /// What points of lattices have seen.
    pub(super) seen: Seen,
    /// How much memory that takes [bytes].
    pub(super) seen_bytes: AtomicU64,
    pub(super) detail: Detail,
    /// What is to be said of how it was made.
    pub(super) notes: Vec<String>,
}

/// The width of a ray for which it does not count where on a patch it ends [rad].
pub(super) const WHOLE: f64 = f64::INFINITY;

/// What a ray meets.
pub(super) struct Look {
    pub source: Source,
    pub through: Vec3,
    /// How far it goes [m].
    pub distance: f64,
}

impl Transport {
    /// What a user may want to know of how it was made.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Area in square metres, a place on it [m] and the normal there, of each patch.
    pub fn patches(&self) -> impl Iterator<Item = (f64, DVec3, DVec3)> + '_ {
        self.patches.all.iter().map(|patch| {
            let spot = patch.middle();
            (patch.area, spot.point, spot.normal)
        })
    }

    /// The patches on the fronts of some triangles of the scene: the number of each, the triangle about its middle, and what would be
    /// met on its back there.
    pub fn fronts(&self, triangles: Range<u32>) -> Vec<(u32, u32, Receiver)> {
        let mesh = &self.conditions.scene.mesh;
        let front = |(number, patch): (u32, &Patch)| {
            let Spot {
                point,
                normal,
                triangle,
            } = patch.middle();
            let is_own = triangles.contains(&triangle) && {
                let [a, b, c] = mesh.corners(triangle);
                (b - a).cross(c - a).dot(normal) > 0.0
            };
            let back = Receiver {
                position: point,
                normal: -normal,
            };
            is_own.then_some((number, triangle, back))
        };
        (0..).zip(&self.patches.all).filter_map(front).collect()
    }

    /// Where the light that a patch sends goes: shares, which sum to 1, and what the air lets through of them [1, RGB]. Empty for a patch
    /// that no light reaches.
    pub fn form_factors(&self, patch: usize) -> Vec<(Source, f32, Vec3)> {
        let others = self.exchange.to[patch].iter();
        let others = others.map(|(to, share, through)| {
            let to = Source::Patch(*to, Tile::WHOLE);
            (to, *share, *through)
        });
        others
            .chain(self.exchange.outside[patch].iter().copied())
            .collect()
    }

    /// How far from a surface rays begin [m]: above the rounding of positions.
    pub(super) fn near(&self, point: DVec3) -> f64 {
        let (low, high) = self.conditions.geometry.bounds();
        let far = low.abs().max(high.abs()).max(point.abs()).max_element();
        1e-10 * self.conditions.geometry.extent() + 1e-12 * far
    }

    /// What a ray meets that stands for a square of directions so wide [rad], and what is let through on the way. Of surfaces that let a
    /// part of the light through and what is behind them it is one, by chance.
    pub(super) fn look(&self, ray: &Ray, width: f64) -> Look {
        let geometry = &self.conditions.geometry;
        let hit = if geometry.has_veils() {
            let bits = (ray.direction.to_array()).map(|x| (x.to_bits() >> 20) as u32);
            geometry.seen(ray, opacity::choice([bits[0], bits[1] ^ bits[2]], 0))
        } else {
            geometry.closest(ray, 0.0, f64::INFINITY)
        };
        self.look_at(ray, hit, width)
    }

    /// The same of all of them: what stops all light, the share of it that is seen [1], and each of the others with its own.
    pub(super) fn look_through(&self, ray: &Ray, width: f64) -> (Look, f64, Vec<(Look, f64)>) {
        let geometry = &self.conditions.geometry;
        if !geometry.has_veils() {
            return (self.look(ray, width), 1.0, Vec::new());
        }
        let (solid, veils) = geometry.met(ray, 0.0, f64::INFINITY);
        let mut rest = 1.0;
        let mut before = Vec::with_capacity(veils.len());
        for veil in veils {
            let look = self.look_at(ray, Some(veil.hit), width);
            before.push((look, rest * (1.0 - veil.pass)));
            rest *= veil.pass;
        }
        (self.look_at(ray, solid, width), rest, before)
    }

    /// What a ray meets whose first surface is known.
    pub(super) fn look_at(&self, ray: &Ray, hit: Option<Hit>, width: f64) -> Look {
        let Conditions { air, ground, .. } = &self.conditions;
        let Ray { origin, direction } = *ray;
        let panes = self.conditions.geometry.panes();
        let clear = air.media.is_empty();
        let through = |depth: DVec3| (-depth).exp().as_vec3();
        let tinted = |distance: f64| match panes {
            None => Vec3::ONE,
            Some(panes) => panes.transmittance(ray, 0.0, distance).as_vec3(),
        };
        let along = |distance: f64| match clear {
            true => tinted(distance),
            false => tinted(distance) * through(air.optical_depth(origin, direction, distance)),
        };
        if let Some(hit) = hit {
            return Look {
                source: self.patches.of_hit(ray, &hit, width),
                through: along(hit.distance),
                distance: hit.distance,
            };
        }
        if direction.y >= 0.0 {
            return Look {
                source: Source::Sky(self.dome.patch_of(direction)),
                through: match clear {
                    true => tinted(f64::INFINITY),
                    false => {
                        tinted(f64::INFINITY) * through(air.sky_optical_depth(origin, direction))
                    }
                },
                distance: f64::INFINITY,
            };
        }
        match ground {
            Some(ground) if origin.y >= ground.height => {
                let distance = (origin.y - ground.height) / -direction.y;
                let near = self.patches.of_ground(ray.at(distance), width * distance);
                Look {
                    source: near.unwrap_or(Source::OpenGround),
                    through: along(distance),
                    distance,
                }
            }
            _ => Look {
                source: Source::Nothing,
                through: Vec3::ZERO,
                distance: f64::INFINITY,
            },
        }
    }

    /// Whether a source is one that openings are looked for.
    pub(super) fn is_bright(&self, source: Source) -> bool {
        match source {
            Source::Nothing => false,
            Source::Sky(_) | Source::OpenGround => true,
            Source::Patch(patch, _) => {
                self.patches.is_ground(patch) || self.shining.get(patch as usize) == Some(&true)
            }
        }
    }
}
