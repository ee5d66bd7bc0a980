//! The making of a transport: rays from all patches.

use super::arrival::{Care, Map, Row, Source, merge, spread};
use super::dome::Dome;
use super::exchange::Exchange;
use super::hemicube::Drawer;
use super::openings::{Openings, thinned};
use super::patches::{Patches, Spot};
use super::points::Seen;
use super::transport::{Detail, Transport, WHOLE};
use crate::conditions::Conditions;
use crate::scene::Ray;
use crate::sky::patches::Subdivision;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::sync::atomic::AtomicU64;

/// The share of what a patch sees from which on its rays alone find the outside well enough [1].
const WIDE: f32 = 0.3;

/// How closely patches look at the outside: what one of them misses another sees too much of.
const SPOT: Care = Care {
    rays: 64,
    outline: 0.05,
};

/// Rays by which it is found which patches light can reach at all: the fewest of a patch.
const FEW: usize = 16;

/// The most rays of a patch.
const MANY: usize = 4096;

/// From so many patches openings are looked for.
const LOOKERS: usize = 1000;

/// From so many of them what was found is looked at again: points beside a pillar before a window are in no opening.
const JUDGES: usize = 32;

/// The most points that are looked at again.
const JUDGED: usize = 4096;

fn is_outside(source: Source) -> bool {
    !matches!(source, Source::Patch(..))
}

/// The share of what is seen that is no patch [1].
fn outside(row: &Row) -> f32 {
    row.iter().filter(|r| is_outside(r.0)).map(|r| r.1).sum()
}

impl Transport {
    /// Prepares it for a scene: of the conditions, geometry, materials, media and ground count. Hemicubes, if they are wanted, are
    /// drawn by `drawer`; without one, and where that fails, a ray of the CPU is cast for each texel.
    pub fn new(conditions: &Conditions, detail: Detail, drawer: Option<&dyn Drawer>) -> Self {
        let mut transport = Transport {
            conditions: conditions.clone(),
            dome: Dome::new(match detail.sky {
                0 => Subdivision::Triangles,
                factor => Subdivision::Reinhart(factor),
            }),
            patches: Patches::new(conditions, detail.patch, detail.patches),
            exchange: Exchange::default(),
            openings: Openings::default(),
            seen: Seen::new(),
            seen_bytes: AtomicU64::new(0),
            detail,
            notes: Vec::new(),
        };
        let all = vec![true; transport.patches.all.len()];
        let few = transport.rows(&all, FEW);
        let lit = Exchange::reached(&few);
        transport.openings = transport.find_openings(&lit);
        let count = lit.iter().filter(|lit| **lit).count().max(1);
        let rays = (detail.patch_rays / count).clamp(FEW, MANY);
        let spots = transport.spots(&few, &lit, detail.patch_spots);
        let mut rows = match (detail.hemicube, rays) {
            // The same rays would meet the same.
            (0, FEW) => few,
            (0, rays) => transport.rows(&lit, rays),
            _ => {
                let (rows, notes) = transport.hemicube_rows(&lit, drawer);
                transport.notes = notes;
                rows
            }
        };
        rows.par_iter_mut()
            .enumerate()
            .for_each(|(patch, row)| match spots[patch] {
                _ if !lit[patch] => row.clear(),
                0 => {}
                spots => transport.look_outside(row, patch, spots),
            });
        transport.exchange = Exchange::new(&transport.patches, rows);
        transport
    }

    /// From how many of its points each patch looks at the outside: as many as there are points to spend, the largest patches first,
    /// of those that see it through small openings at most.
    fn spots(&self, few: &[Row], lit: &[bool], most: usize) -> Vec<usize> {
        let narrow = |patch: &usize| {
            lit[*patch] && !self.patches.is_ground(*patch as u32) && outside(&few[*patch]) <= WIDE
        };
        let mut patches: Vec<usize> = (0..lit.len()).filter(narrow).collect();
        let area = |patch: usize| self.patches.all[patch].area;
        patches.sort_by(|a, b| area(*b).total_cmp(&area(*a)));
        let each = (most / patches.len().max(1)).clamp(1, 16);
        let mut spots = vec![0; lit.len()];
        for patch in patches.into_iter().take(most) {
            spots[patch] = each;
        }
        spots
    }

    /// What the wanted patches see along rays, by source: shares and what is let through of them.
    fn rows(&self, wanted: &[bool], rays: usize) -> Vec<Row> {
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
                        let look = self.look(&ray, WHOLE);
                        (look.source, share, share * look.through)
                    })
                    .collect();
                merge(&mut row);
                row
            })
            .collect()
    }

    /// Puts what a few of a patch's points see of the outside, through openings that are small from there, in the place of what its
    /// rays have met by chance.
    fn look_outside(&self, row: &mut Row, patch: usize, spots: usize) {
        let chance = outside(row);
        if chance > WIDE {
            return;
        }
        let own = &self.patches.all[patch];
        let mut seen = Row::new();
        for k in 0..spots {
            let spot = own.spot(&spread(k, patch as u64));
            let origin = spot.lifted(self.near(spot.point));
            for arrival in self.gather(origin, &Map::before(spot.normal), SPOT) {
                if is_outside(arrival.source) {
                    let share = arrival.share / spots as f32;
                    seen.push((arrival.source, share, share * arrival.through));
                }
            }
        }
        let found = outside(&seen);
        let rest = if chance < 1.0 {
            (1.0 - found) / (1.0 - chance)
        } else {
            1.0
        };
        row.retain(|r| !is_outside(r.0));
        for (_, share, through) in row.iter_mut() {
            *share *= rest;
            *through *= rest;
        }
        row.extend(seen);
        merge(row);
    }

    /// Looks for openings from the patches that light reaches.
    fn find_openings(&self, lit: &[bool]) -> Openings {
        let all = &self.patches.all;
        let reached: Vec<usize> = (0..all.len())
            .filter(|patch| lit[*patch] && all[*patch].area > 0.0)
            .collect();
        let stride = reached.len().div_ceil(LOOKERS).max(1);
        let looks: Vec<(Spot, Vec<DVec3>)> = reached
            .par_iter()
            .step_by(stride)
            .filter_map(|patch| {
                let spot = all[*patch].spot(&spread(0, *patch as u64));
                let found = self.openings_before(spot.point, spot.normal)?;
                Some((spot, found))
            })
            .collect();
        // Points beside a pillar before a window are in no opening: through a point in one others see the outside too.
        let stride = looks.len().div_ceil(JUDGES).max(1);
        let judges: Vec<Spot> = looks
            .iter()
            .step_by(stride)
            .map(|(spot, _)| *spot)
            .collect();
        let found = looks.into_iter().flat_map(|(_, found)| found);
        let found = found.map(|point| (point, 0)).collect();
        let extent = self.conditions.geometry.extent();
        let (found, _) = thinned(found, JUDGED, 1e-4 * extent);
        let mut judged: Vec<(DVec3, usize)> = found
            .into_par_iter()
            .map(|(point, _)| {
                let through = judges.iter().filter(|judge| {
                    let way = (point - judge.point).normalize_or_zero();
                    let near = self.near(judge.point);
                    way.dot(judge.normal) > 0.0 && {
                        let ray = Ray {
                            origin: judge.lifted(near),
                            direction: way,
                        };
                        let look = self.look(&ray, WHOLE);
                        self.is_bright(look.source)
                    }
                });
                (point, through.count())
            })
            .collect();
        judged.retain(|(_, count)| *count > 0);
        Openings::new(judged, extent)
    }
}
