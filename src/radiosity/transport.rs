//! What does not change with the time of day: who sees whom, and through what.

use super::arrival::{Map, Source};
use super::dome::Dome;
use super::exchange::Exchange;
use super::gather::Care;
use super::lattice::Seen;
use super::openings::Openings;
use super::patches::{Patches, spread};
use crate::conditions::Conditions;
use crate::scene::{Ray, opacity};
use crate::sky::patches::Subdivision;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

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
    /// Rays from each patch.
    pub patch_rays: usize,
    /// Points of each patch that sees the outside through small openings, from where these are looked at closely.
    pub patch_spots: usize,
}

/// Who sees whom in a scene, and through what.
pub struct Transport {
    pub(super) conditions: Conditions,
    pub(super) dome: Dome,
    pub(super) patches: Patches,
    pub(super) exchange: Exchange,
    pub(super) openings: Openings,
    /// What points of lattices have seen.
    pub(super) seen: Seen,
    pub(super) detail: Detail,
}

/// What a ray meets.
pub(super) struct Look {
    pub source: Source,
    pub through: Vec3,
    /// How far it goes [m].
    pub distance: f64,
}

impl Transport {
    /// Prepares it for a scene: of the conditions, geometry, materials, media and ground count.
    pub fn new(conditions: &Conditions, detail: Detail) -> Self {
        let mut transport = Transport {
            conditions: conditions.clone(),
            dome: Dome::new(match detail.sky {
                0 => Subdivision::Triangles,
                factor => Subdivision::Reinhart(factor),
            }),
            patches: Patches::new(conditions, detail.patch, detail.patches),
            exchange: Exchange::default(),
            openings: Openings::default(),
            seen: Seen::default(),
            detail,
        };
        let few = transport.rows(&vec![true; transport.patches.all.len()], FEW, 0);
        let lit = Exchange::reached(&few);
        let now = std::time::Instant::now();
        let td = |what: &str| {
            if std::env::var("TD").is_ok() {
                eprintln!(
                    "{what} {:?} rays {}",
                    now.elapsed(),
                    RAYS.load(std::sync::atomic::Ordering::Relaxed)
                )
            }
        };
        td("few");
        transport.openings = Openings::find(&transport, &lit);
        td("openings");
        let rows = transport.rows(&lit, detail.patch_rays, detail.patch_spots);
        td("rows");
        transport.exchange = Exchange::new(&transport.patches, rows);
        td("exchange");
        transport
    }

    /// What the wanted patches see along rays, by source: shares and what is let through of them.
    fn rows(&self, wanted: &[bool], rays: usize, spots: usize) -> Vec<Row> {
        let near = self.near(DVec3::ZERO);
        (0..self.patches.all.len())
            .into_par_iter()
            .map(|patch| {
                let own = &self.patches.all[patch];
                if !wanted[patch] || own.area <= 0.0 {
                    return Row::default();
                }
                let share = 1.0 / rays as f32;
                let mut row: Vec<(Source, f32, Vec3)> = (0..rays)
                    .map(|i| {
                        let ray = own.ray(&spread(i, patch as u64), near);
                        let look = self.look(&ray);
                        (look.source, share, share * look.through)
                    })
                    .collect();
                if spots > 0 {
                    self.look_outside(&mut row, patch, spots);
                }
                merge(&mut row);
                row
            })
            .collect()
    }

    /// Puts what a few of a patch's points see of the outside, through openings that are small from there, in the place of what its
    /// rays have met by chance.
    fn look_outside(&self, row: &mut Row, patch: usize, spots: usize) {
        let outside = |source: &Source| !matches!(source, Source::Patch(_));
        let chance: f32 = row.iter().filter(|r| outside(&r.0)).map(|r| r.1).sum();
        if chance > WIDE {
            return;
        }
        let own = &self.patches.all[patch];
        let mut seen = Row::new();
        for k in 0..spots {
            let spot = own.spot(&spread(k, patch as u64));
            let origin = spot.point + self.near(spot.point) * spot.normal;
            for arrival in self.gather(origin, &Map::before(spot.normal), SPOT) {
                if outside(&arrival.source) {
                    let share = arrival.share / spots as f32;
                    seen.push((arrival.source, share, share * arrival.through));
                }
            }
        }
        let found: f32 = seen.iter().map(|r| r.1).sum();
        let rest = if chance < 1.0 {
            (1.0 - found) / (1.0 - chance)
        } else {
            1.0
        };
        row.retain(|r| !outside(&r.0));
        for (_, share, through) in row.iter_mut() {
            *share *= rest;
            *through *= rest;
        }
        row.extend(seen);
    }

    /// How far from a surface rays begin [m]: above the rounding of positions.
    pub(super) fn near(&self, point: DVec3) -> f64 {
        let (low, high) = self.conditions.geometry.bounds();
        let far = low.abs().max(high.abs()).max(point.abs()).max_element();
        1e-10 * self.conditions.geometry.extent() + 1e-12 * far
    }

    /// What a ray meets, and what is let through on the way.
    pub(super) fn look(&self, ray: &Ray) -> Look {
        let Conditions {
            geometry,
            air,
            ground,
            ..
        } = &self.conditions;
        RAYS.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let Ray { origin, direction } = *ray;
        let clear = air.media.is_empty();
        let through = |depth: DVec3| (-depth).exp().as_vec3();
        let hit = if geometry.has_veils() {
            let bits = direction.to_array().map(|x| (x.to_bits() >> 20) as u32);
            geometry.seen(ray, opacity::choice([bits[0], bits[1] ^ bits[2]], 0))
        } else {
            geometry.closest(ray, 0.0, f64::INFINITY)
        };
        let along = |distance: f64| match clear {
            true => Vec3::ONE,
            false => through(air.optical_depth(origin, direction, distance)),
        };
        if let Some(hit) = hit {
            return Look {
                source: self.patches.of_hit(&self.conditions, ray, &hit),
                through: along(hit.distance),
                distance: hit.distance,
            };
        }
        if direction.y >= 0.0 {
            return Look {
                source: Source::Sky(self.dome.patch_of(direction)),
                through: match clear {
                    true => Vec3::ONE,
                    false => through(air.sky_optical_depth(origin, direction)),
                },
                distance: f64::INFINITY,
            };
        }
        match ground {
            Some(ground) if origin.y >= ground.height => {
                let distance = (origin.y - ground.height) / -direction.y;
                let near = self.patches.of_ground(ray.at(distance));
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
}

/// The share of what a patch sees from which on its rays alone find the outside well enough [1].
const WIDE: f32 = 0.3;

/// How closely patches look at the outside: what one of them misses another sees too much of.
const SPOT: Care = Care {
    rays: 64,
    outline: 0.05,
};

/// Rays by which it is found which patches light can reach at all.
const FEW: usize = 16;

/// What a place sees of each source: its share, and the share of light that comes through.
pub(super) type Row = Vec<(Source, f32, Vec3)>;

/// Sums what is of one source.
pub(super) fn merge(row: &mut Row) {
    row.sort_unstable_by_key(|(source, ..)| *source);
    row.dedup_by(|next, sum| {
        let same = next.0 == sum.0;
        if same {
            sum.1 += next.1;
            sum.2 += next.2;
        }
        same
    });
}

pub static RAYS: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);
