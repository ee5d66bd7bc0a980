//! What patches exchange: areas times form factors, the same both ways.
//!
//! Rays from both patches of a pair count, so that A_i F_ij = A_j F_ji holds to rounding: of two estimates that scatter like the
//! area from which the rays came, the mean A_i A_j (F_ij + F_ji) / (A_i + A_j). Then all pairs are scaled until each patch sends
//! exactly what it has (the rows of a closed room sum to 1).

use super::arrival::{Row, Source};
use super::patches::Patches;
use crate::error::Result;
use crate::task::Task;
use glam::{DVec3, Vec3};

/// What all patches exchange with each other and receive from outside.
#[derive(Default)]
pub(super) struct Exchange {
    /// Of each patch: the others, the share of its light that goes to each, and what of this arrives.
    pub to: Vec<Vec<(u32, f32, Vec3)>>,
    /// Of each patch: what it sees that is no patch, by share, and what of it is let through.
    pub outside: Vec<Row>,
    /// The share of each patch's light that leaves the scene [1].
    pub escapes: Vec<f64>,
    /// The largest factor by which a row's sum was corrected, up or down, less 1 [1].
    pub correction: f64,
}

impl Exchange {
    /// Whether a patch sees anything: those that no light reaches are not looked from.
    pub fn sees(&self, patch: usize) -> bool {
        !self.to[patch].is_empty() || !self.outside[patch].is_empty()
    }

    /// Which patches light from outside can reach, directly or by others, and light from those that are `lit` otherwise. `groups` are
    /// sources that light passes between in other ways than along the rows.
    pub fn reached(rows: &[Row], groups: &[Vec<Source>], lit: &[bool]) -> Vec<bool> {
        let patches = rows.len();
        let count = patches + groups.len();
        let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); count];
        let mut open: Vec<u32> = Vec::new();
        let mut reached = vec![false; count];
        let rows = rows
            .iter()
            .map(|row| row.iter().map(|(source, ..)| source).collect());
        let groups = groups.iter().map(|group| group.iter().collect());
        let seen: Vec<Vec<&Source>> = rows.chain(groups).collect();
        for (i, sources) in seen.iter().enumerate() {
            for source in sources {
                match source {
                    Source::Patch(j, _) => {
                        neighbours[i].push(*j);
                        neighbours[*j as usize].push(i as u32);
                    }
                    Source::Sky(_) | Source::OpenGround if !reached[i] => {
                        reached[i] = true;
                        open.push(i as u32);
                    }
                    _ => {}
                }
            }
        }
        for (i, _) in lit.iter().enumerate().filter(|(_, lit)| **lit) {
            if !reached[i] {
                reached[i] = true;
                open.push(i as u32);
            }
        }
        while let Some(i) = open.pop() {
            for &j in &neighbours[i as usize] {
                if !reached[j as usize] {
                    reached[j as usize] = true;
                    open.push(j);
                }
            }
        }
        reached.truncate(patches);
        reached
    }

    /// Makes it of what each patch sees along its rays.
    pub fn new(patches: &Patches, rows: Vec<Row>, task: Task<'_>) -> Result<Self> {
        let count = rows.len();
        let areas: Vec<f64> = patches.all.iter().map(|patch| patch.area).collect();
        let mut pairs: Vec<(u32, u32, f64, DVec3)> = Vec::new();
        let mut outside: Vec<Row> = Vec::with_capacity(count);
        let mut escapes = vec![0.0; count];
        let is_known: Vec<bool> = rows.iter().map(|row| !row.is_empty()).collect();
        for (i, row) in rows.into_iter().enumerate() {
            let mut out = Row::new();
            for (source, share, through) in row {
                match source {
                    Source::Patch(j, _) => {
                        let (a, b) = (areas[i], areas[j as usize]);
                        let (i, known) = (i as u32, is_known[j as usize] && i as u32 != j);
                        let area = if known { a * b / (a + b) } else { a };
                        let (share, through) = (f64::from(share), through.as_dvec3());
                        pairs.push((i.min(j), i.max(j), area * share, area * through));
                    }
                    _ => {
                        escapes[i] += f64::from(share);
                        out.push((source, share, through));
                    }
                }
            }
            outside.push(out);
        }
        pairs.sort_unstable_by_key(|(i, j, ..)| (*i, *j));
        pairs.dedup_by(|next, sum| {
            let same = (next.0, next.1) == (sum.0, sum.1);
            if same {
                sum.2 += next.2;
                sum.3 += next.3;
            }
            same
        });
        let mut correction = 0.0f64;
        let turns = task.pieces(TURNS);
        for turn in 0..TURNS {
            turns.begin()?;
            let mut sums: Vec<f64> = (0..count).map(|i| areas[i] * escapes[i]).collect();
            for (i, j, area, _) in &pairs {
                sums[*i as usize] += area;
                if i != j {
                    sums[*j as usize] += area;
                }
            }
            let counted = (0..count).filter(|i| is_known[*i] && sums[*i] > 0.0);
            let ratios: Vec<f64> = counted.map(|i| areas[i] / sums[i]).collect();
            let off = ratios.iter().map(|r| (r - 1.0).abs()).fold(0.0, f64::max);
            if turn == 0 {
                // A fifth is as much as five times.
                let factors = ratios.iter().map(|r| r.max(1.0 / r));
                correction = factors.fold(1.0, f64::max) - 1.0;
            }
            if off < ENOUGH {
                break;
            }
            let factor = |i: usize| match is_known[i] && sums[i] > 0.0 {
                true => (areas[i] / sums[i]).sqrt(),
                false => 1.0,
            };
            for (i, j, area, through) in &mut pairs {
                let by = factor(*i as usize) * factor(*j as usize);
                *area *= by;
                *through *= by;
            }
            for (i, escapes) in escapes.iter_mut().enumerate() {
                *escapes *= factor(i);
                for (_, share, through) in &mut outside[i] {
                    *share *= factor(i) as f32;
                    *through *= factor(i) as f32;
                }
            }
        }
        let mut to: Vec<Vec<(u32, f32, Vec3)>> = vec![Vec::new(); count];
        for (i, j, area, through) in pairs {
            let mut send = |from: u32, at: u32| {
                let own = areas[from as usize];
                if own > 0.0 {
                    let share = (area / own) as f32;
                    to[from as usize].push((at, share, (through / own).as_vec3()));
                }
            };
            send(i, j);
            if i != j {
                send(j, i);
            }
        }
        Ok(Exchange {
            to,
            outside,
            escapes,
            correction,
        })
    }
}

/// Rows that are off by no more than this are not scaled any more [1].
const ENOUGH: f64 = 5e-4;

/// How often rows are scaled at most: of what they were off by each time leaves less than half, but of patches that see little else than
/// each other a larger part.
const TURNS: usize = 200;
