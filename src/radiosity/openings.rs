//! Where light comes into rooms: points in windows, doors, gaps.
//!
//! They are few and small, and chance finds them badly. Rays from all patches find each of them from somewhere; from then on every
//! place looks for those that its own rays have missed.

use super::arrival::Source;
use super::patches::{Spot, spread};
use super::transport::Transport;
use crate::scene::Ray;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Points in openings [m].
#[derive(Default)]
pub(super) struct Openings(Vec<DVec3>);

/// The most points that are kept: each costs a look at it from every place that sees nothing bright there.
const MOST: usize = 256;

/// From so many patches openings are looked for.
const LOOKERS: usize = 1000;

/// From so many of them what was found is looked at again.
const JUDGES: usize = 32;

impl Openings {
    /// Looks for them from the patches that light reaches.
    pub fn find(transport: &Transport, lit: &[bool]) -> Self {
        let all = &transport.patches.all;
        let reached: Vec<usize> = (0..all.len())
            .filter(|patch| lit[*patch] && all[*patch].area > 0.0)
            .collect();
        let stride = reached.len().div_ceil(LOOKERS).max(1);
        let looks: Vec<(Spot, Vec<DVec3>)> = reached
            .par_iter()
            .step_by(stride)
            .filter_map(|patch| {
                let spot = all[*patch].spot(&spread(0, *patch as u64));
                let found = transport.openings_before(spot.point, spot.normal)?;
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
        let found: Vec<DVec3> = looks.into_iter().flat_map(|(_, found)| found).collect();
        let extent = transport.conditions.geometry.extent();
        let (found, _) = thinned(found, |_| 0, 16 * MOST, 1e-4 * extent);
        let mut judged: Vec<(DVec3, usize)> = found
            .into_par_iter()
            .map(|point| {
                let through = judges.iter().filter(|judge| {
                    let way = (point - judge.point).normalize_or_zero();
                    let near = transport.near(judge.point);
                    way.dot(judge.normal) > 0.0 && {
                        let look = transport.look(&Ray {
                            origin: judge.point + near * judge.normal,
                            direction: way,
                        });
                        transport.is_bright(look.source)
                    }
                });
                (point, through.count())
            })
            .collect();
        judged.retain(|(_, count)| *count > 0);
        let merit: HashMap<[u64; 3], usize> = judged
            .iter()
            .map(|(point, count)| (point.to_array().map(f64::to_bits), *count))
            .collect();
        let points = judged.into_iter().map(|(point, _)| point).collect();
        let of = |point: &DVec3| merit[&point.to_array().map(f64::to_bits)];
        let (points, _) = thinned(points, of, MOST, 1e-4 * extent);
        Openings(points)
    }

    /// All points.
    pub fn all(&self) -> &[DVec3] {
        &self.0
    }
}

/// At most so many of some points, of those in one cell of space the one of greatest merit; and how large the cells are [m].
fn thinned(
    mut points: Vec<DVec3>,
    merit: impl Fn(&DVec3) -> usize,
    most: usize,
    mut cell: f64,
) -> (Vec<DVec3>, f64) {
    while points.len() > most {
        cell *= 1.25;
        let mut best: HashMap<[i64; 3], DVec3> = HashMap::new();
        for point in &points {
            let place = (*point / cell).floor().to_array().map(|x| x as i64);
            let held = best.entry(place).or_insert(*point);
            if merit(point) > merit(held) {
                *held = *point;
            }
        }
        let mut kept: Vec<_> = best.into_iter().collect();
        kept.sort_unstable_by_key(|(place, _)| *place);
        points = kept.into_iter().map(|(_, point)| point).collect();
    }
    (points, cell)
}

impl Transport {
    /// Whether a source is one that openings are looked for.
    pub(super) fn is_bright(&self, source: Source) -> bool {
        match source {
            Source::Nothing => false,
            Source::Sky(_) | Source::OpenGround => true,
            Source::Patch(patch) => self.patches.is_ground(patch),
        }
    }
}
