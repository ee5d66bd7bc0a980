//! The making of a transport: rays from all patches.

use super::arrival::{Care, Map, Row, Source, merge, spread};
use super::dome::Dome;
use super::exchange::Exchange;
use super::gaps::{Gap, gaps};
use super::hemicube::Drawer;
use super::lamps::is_reached;
use super::openings::{Openings, thinned};
use super::patches::{Patches, Spot};
use super::points::Seen;
use super::pools::{Pool, WIDEST};
use super::transport::{Detail, Look, Transport, WHOLE};
use crate::colour::luminance;
use crate::conditions::Conditions;
use crate::conditions::lamps::Lamp;
use crate::error::Result;
use crate::scene::Ray;
use crate::sky::patches::Subdivision;
use crate::task::{Pieces, Task};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;
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

/// Ways through a gap from each of four points of a patch.
const WAYS: usize = 4;

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
    /// drawn by `drawer`; without one, and where that fails, a ray of the CPU is cast for each texel. They are the published method:
    /// gaps are not looked through beside them.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] when the work was stopped.
    pub fn new(
        conditions: &Conditions,
        detail: Detail,
        drawer: Option<&dyn Drawer>,
        task: Task<'_>,
    ) -> Result<Self> {
        Self::with_shining(conditions, detail, drawer, 0..0, task)
    }

    /// The same where the fronts of some triangles shine by themselves: light reaches what they see.
    ///
    /// # Errors
    /// Those of [`Transport::new`].
    pub fn with_shining(
        conditions: &Conditions,
        detail: Detail,
        drawer: Option<&dyn Drawer>,
        shining: Range<u32>,
        task: Task<'_>,
    ) -> Result<Self> {
        let patches = Patches::new(
            conditions,
            detail.patch,
            detail.patches,
            task.part(0.0, 0.1),
        )?;
        let mut transport = Transport {
            conditions: conditions.clone(),
            dome: Dome::new(match detail.sky {
                0 => Subdivision::Triangles,
                factor => Subdivision::Reinhart(factor),
            }),
            patches,
            exchange: Exchange::default(),
            openings: Openings::default(),
            pools: Vec::new(),
            gaps: Vec::new(),
            by_gaps: Vec::new(),
            shining: Vec::new(),
            seen: Seen::new(),
            seen_bytes: AtomicU64::new(0),
            detail,
            notes: Vec::new(),
        };
        if !shining.is_empty() {
            transport.shining = vec![false; transport.patches.all.len()];
            for (patch, ..) in transport.fronts(shining) {
                transport.shining[patch as usize] = true;
            }
        }
        let pool = |lamp| transport.pool(lamp);
        transport.pools = conditions.lamps.iter().filter_map(pool).collect();
        let all = vec![true; transport.patches.all.len()];
        let (gaps, through) = match detail.hemicube {
            0 => transport.find_gaps(task)?,
            _ => (Vec::new(), Vec::new()),
        };
        transport.gaps = gaps;
        let few = transport.rows(&all, &[], FEW, task.part(0.1, 0.2))?;
        let mut by_own_light: Vec<bool> = match conditions.lamps.is_empty() {
            true => Vec::new(),
            false => {
                let patches = (0..transport.patches.all.len()).into_par_iter();
                patches
                    .map(|patch| is_reached(&transport, conditions, patch))
                    .collect()
            }
        };
        if !transport.shining.is_empty() {
            by_own_light.resize(transport.shining.len(), false);
            for (lit, shines) in by_own_light.iter_mut().zip(&transport.shining) {
                *lit |= shines;
            }
        }
        let lit = Exchange::reached(&few, &through, &by_own_light);
        if !transport.gaps.is_empty() {
            let otherwise = Exchange::reached(&few, &[], &by_own_light);
            let by_gaps = lit.iter().zip(otherwise).map(|(lit, other)| *lit && !other);
            transport.by_gaps = by_gaps.collect();
        }
        transport.openings = transport.find_openings(&lit, task.part(0.2, 0.25))?;
        let count = lit.iter().filter(|lit| **lit).count().max(1);
        let rays = (detail.patch_rays / count).clamp(FEW, MANY);
        let spots = transport.spots(&few, &lit, detail.patch_spots);
        let mut rows = match (detail.hemicube, rays) {
            // The same rays would meet the same.
            (0, FEW) if !transport.by_gaps.contains(&true) => few,
            (0, rays) => {
                let patches = 0..few.len();
                let worth: Vec<f64> = patches.map(|patch| transport.worth(patch)).collect();
                transport.rows(&lit, &worth, rays, task.part(0.25, 0.6))?
            }
            _ => {
                let (rows, notes) = transport.hemicube_rows(&lit, drawer, task.part(0.25, 0.6))?;
                transport.notes = notes;
                rows
            }
        };
        let pieces = task.part(0.6, 0.9).pieces(spots.iter().sum());
        rows.par_iter_mut()
            .enumerate()
            .try_for_each(|(patch, row)| match spots[patch] {
                _ if !lit[patch] => {
                    row.clear();
                    Ok(())
                }
                0 => Ok(()),
                spots => transport.look_outside(row, patch, spots, &pieces),
            })?;
        transport.exchange = Exchange::new(&transport.patches, rows, task.part(0.9, 1.0))?;
        Ok(transport)
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

    /// What the wanted patches see along rays, by source: shares and what is let through of them; and through the small gaps that are
    /// `worth` it to each.
    fn rows(
        &self,
        wanted: &[bool],
        worth: &[f64],
        rays: usize,
        task: Task<'_>,
    ) -> Result<Vec<Row>> {
        let pieces = task.pieces(self.patches.all.len());
        let near = self.near(DVec3::ZERO);
        (0..self.patches.all.len())
            .into_par_iter()
            .map(|patch| {
                pieces.begin()?;
                let own = &self.patches.all[patch];
                if !wanted[patch] || own.area <= 0.0 {
                    return Ok(Row::default());
                }
                let (mut row, gaps) = match worth.get(patch) {
                    Some(worth) => self.through_gaps(patch, *worth, rays),
                    None => (Row::new(), Vec::new()),
                };
                let found: f32 = row.iter().map(|(_, share, _)| share).sum();
                let sent = (0..rays).map(|i| own.ray(&spread(i, patch as u64), near));
                // What a few rays find by chance through a gap is far too much.
                let chance = |ray: &Ray, look: &Look| {
                    worth.is_empty()
                        && is_outside(look.source)
                        && self.gaps.iter().any(|gap| gap.is_on(ray))
                };
                let others: Vec<Look> = sent
                    .filter(|ray| !gaps.iter().any(|gap| gap.is_on(ray)))
                    .map(|ray| (ray, self.look(&ray, WHOLE)))
                    .filter(|(ray, look)| !chance(ray, look))
                    .map(|(_, look)| look)
                    .collect();
                let share = (1.0 - found) / others.len().max(1) as f32;
                row.extend(
                    others
                        .iter()
                        .map(|look| (look.source, share, share * look.through)),
                );
                merge(&mut row);
                Ok(row)
            })
            .collect()
    }

    /// The least share of what comes through a gap that is worth a look at it from a patch [1].
    fn worth(&self, patch: usize) -> f64 {
        match self.by_gaps.get(patch) {
            Some(true) => 1e-4,
            // What it gets is little beside its other light, and of what it gives the other side knows enough.
            _ => 1.0 / 64.0,
        }
    }

    /// The small gaps, and for each what light passes between through it.
    fn find_gaps(&self, task: Task<'_>) -> Result<(Vec<Gap>, Vec<Vec<Source>>)> {
        let near = self.near(DVec3::ZERO);
        let found = gaps(self.patches.sides(), task.part(0.2, 0.2))?;
        let looked: Vec<(Gap, Vec<Source>)> = found
            .into_par_iter()
            .filter_map(|mut gap| {
                let meet = |ray: &Ray| {
                    let look = self.look(ray, WHOLE);
                    (look.source, look.distance)
                };
                let seen = gap.look(meet, near)?;
                Some((gap, seen))
            })
            .collect();
        Ok(looked.into_iter().unzip())
    }

    /// What a patch sees through small gaps, by points of both; and the gaps. None that are wide from there, and none of which less
    /// than this share comes to the patch.
    fn through_gaps(&self, patch: usize, worth: f64, rays: usize) -> (Row, Vec<&Gap>) {
        if self.gaps.is_empty() {
            return (Row::new(), Vec::new());
        }
        let own = &self.patches.all[patch];
        let spots = [0, 1, 2, 3].map(|k| own.spot(&spread(k, patch as u64)));
        let places =
            spots.map(|spot| (spot.lifted(self.near(spot.point)), Map::before(spot.normal)));
        let most = |gap: &Gap| {
            let seen = places.iter().filter(|(place, _)| gap.is_seen_from(*place));
            seen.map(|(place, map)| gap.most(*place, map))
                .fold(0.0, f64::max)
        };
        let mut used: Vec<(&Gap, f64)> = self.gaps.iter().map(|gap| (gap, most(gap))).collect();
        used.retain(|(gap, most)| most * own.area > worth * gap.area);
        used.sort_by(|a, b| b.1.total_cmp(&a.1));
        used.truncate(rays / WAYS);
        let mut row = Row::new();
        for (place, map) in &places {
            for (number, (gap, _)) in used.iter().enumerate() {
                for way in gap.ways(*place, map, WAYS) {
                    let ray = Ray {
                        origin: *place,
                        direction: way.toward,
                    };
                    // A way through two gaps, one behind the other, is one.
                    if used[..number].iter().any(|(other, _)| other.is_on(&ray)) {
                        continue;
                    }
                    let look = self.look(&ray, WHOLE);
                    let share = (way.weight / places.len() as f64) as f32;
                    row.push((look.source, share, share * look.through));
                }
            }
        }
        let found: f32 = row.iter().map(|(_, share, _)| share).sum();
        match found < WIDE {
            true => (row, used.into_iter().map(|(gap, _)| gap).collect()),
            false => (Row::new(), Vec::new()),
        }
    }

    /// Puts what a few of a patch's points see of the outside, through openings that are small from there, in the place of what its
    /// rays have met by chance.
    fn look_outside(
        &self,
        row: &mut Row,
        patch: usize,
        spots: usize,
        pieces: &Pieces<'_>,
    ) -> Result<()> {
        let chance = outside(row);
        if chance > WIDE {
            return Ok(());
        }
        let own = &self.patches.all[patch];
        let mut seen = Row::new();
        for k in 0..spots {
            pieces.begin()?;
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
        Ok(())
    }

    /// Where a narrow beam of a lamp meets a surface.
    fn pool(&self, lamp: &Lamp) -> Option<Pool> {
        let cone = lamp.distribution.cone();
        if cone > WIDEST {
            return None;
        }
        let ray = Ray {
            origin: lamp.middle(),
            direction: lamp.pose.toward,
        };
        let Conditions {
            geometry, ground, ..
        } = &self.conditions;
        // Its own housing is in no one's way: the look goes on from right before what the beam meets.
        let before = lamp.ignored().map_or(0.0, |_| {
            let met = lamp.geometry(geometry).closest(&ray, 0.0, f64::INFINITY);
            let ground = ground.map(|g| (g.height - ray.origin.y) / ray.direction.y);
            let distances = [met.map(|hit| hit.distance), ground].into_iter().flatten();
            let nearest = distances.filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
            if nearest.is_finite() {
                (1.0 - 1e-6) * nearest
            } else {
                0.0
            }
        });
        let rest = Ray {
            origin: ray.at(before),
            ..ray
        };
        let looked = self.look(&rest, 0.0);
        let Source::Patch(patch, _) = looked.source else {
            return None;
        };
        let distance = before + looked.distance;
        let mut radius = distance * cone.tan() + lamp.extent();
        let mut reach = radius;
        let normal = match self.patches.part(patch as usize) {
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
            point: ray.at(distance),
            normal,
            radius,
            reach,
            flux: luminance(self.patches.all[patch as usize].albedo) * lamp.flux(),
        })
    }

    /// Looks for openings from the patches that light reaches.
    fn find_openings(&self, lit: &[bool], task: Task<'_>) -> Result<Openings> {
        let all = &self.patches.all;
        let reached: Vec<usize> = (0..all.len())
            .filter(|patch| lit[*patch] && all[*patch].area > 0.0)
            .collect();
        let stride = reached.len().div_ceil(LOOKERS).max(1);
        let pieces = task.part(0.0, 0.5).pieces(reached.len().div_ceil(stride));
        let looks: Result<Vec<(Spot, Vec<DVec3>)>> = reached
            .par_iter()
            .step_by(stride)
            .filter_map(|patch| {
                if let Err(stopped) = pieces.begin() {
                    return Some(Err(stopped));
                }
                let spot = all[*patch].spot(&spread(0, *patch as u64));
                let found = self.openings_before(spot.point, spot.normal)?;
                Some(Ok((spot, found)))
            })
            .collect();
        let looks = looks?;
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
        let pieces = task.part(0.5, 1.0).pieces(found.len());
        let judged: Result<Vec<(DVec3, usize)>> = found
            .into_par_iter()
            .map(|(point, _)| {
                pieces.begin()?;
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
                Ok((point, through.count()))
            })
            .collect();
        let mut judged = judged?;
        judged.retain(|(_, count)| *count > 0);
        Ok(Openings::new(judged, extent))
    }
}
