//! Where light comes into rooms: points in windows, doors, gaps.
//!
//! They are few and small, and chance finds them badly. Rays from all patches find each of them from somewhere; from then on every
//! place looks for those that its own rays have missed.

use super::patches::spread;
use super::transport::Transport;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Points in openings.
#[derive(Default)]
pub(super) struct Openings {
    points: Vec<DVec3>,
    /// How large a part of an opening each stands for [m].
    pub size: f64,
}

/// The most points that are kept: each costs a look at it from every place that does not see an opening around there.
const MOST: usize = 200;

/// From so many patches openings are looked for.
const LOOKERS: usize = 1000;

impl Openings {
    /// Looks for them from the patches that light reaches.
    pub fn find(transport: &Transport, lit: &[bool]) -> Self {
        let all = &transport.patches.all;
        let stride = all.len().div_ceil(LOOKERS).max(1);
        let mut found: Vec<DVec3> = (0..all.len())
            .into_par_iter()
            .step_by(stride)
            .map(|patch| (patch, &all[patch]))
            .filter(|(patch, own)| lit[*patch] && own.area > 0.0)
            .flat_map_iter(|(patch, own)| {
                let spot = own.spot(&spread(0, patch as u64));
                transport.openings_before(spot.point, spot.normal)
            })
            .collect();
        let mut cell = 1e-3 * transport.conditions.geometry.extent();
        while found.len() > MOST {
            let mut first: HashMap<[i64; 3], DVec3> = HashMap::new();
            for point in &found {
                let place = (*point / cell).floor().to_array().map(|x| x as i64);
                first.entry(place).or_insert(*point);
            }
            let mut kept: Vec<_> = first.into_iter().collect();
            kept.sort_unstable_by_key(|(place, _)| *place);
            found = kept.into_iter().map(|(_, point)| point).collect();
            cell *= 1.5;
        }
        Openings {
            points: found,
            size: cell,
        }
    }

    /// All points.
    pub fn all(&self) -> &[DVec3] {
        &self.points
    }
}
