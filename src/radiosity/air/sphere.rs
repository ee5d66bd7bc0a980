//! The cells of the sphere that arrivals stand for.
//!
//! [`crate::radiosity::Transport::around`] sends one ray into each cell of a grid, anywhere in it. What a phase function makes of
//! the cell's light goes by the cell's middle, and the sky's radiance is its mean over the cell: else a grid of wide cells would
//! take the sky near the sun for what one ray of it happens to see.

use super::lattice::Lattice;
use crate::radiosity::arrival::{Arrival, Map, Source};
use crate::radiosity::light::Light;
use crate::sky::Sky;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// So often cells are quartered over which the sky's mean is taken; smaller ones see it as even.
const LEVELS: usize = 3;

/// Light from around one direction at a moment.
#[derive(Debug, Clone, Copy)]
pub struct Lit {
    /// Unit vector toward where it comes from.
    pub toward: Vec3,
    /// The solid angle that it stands for [sr].
    pub share: f32,
    /// Solid angle times radiance [lx, RGB].
    pub light: Vec3,
}

/// The mean radiance of the sky over cells.
pub struct Sphere {
    /// By level: cells along each side, and the mean over each [cd/m2].
    means: Vec<(u32, Vec<DVec3>)>,
}

impl Sphere {
    pub fn new(lattice: &Lattice, sky: Option<&Sky>) -> Self {
        let Some(sky) = sky else {
            return Sphere { means: Vec::new() };
        };
        let coarsest = lattice.side();
        let mean = |side: u32, cell: u32| {
            // As many places in all cells of a level, few in small ones.
            const FINE: u32 = 64;
            let fine = FINE.div_ceil(side).max(2);
            let mut sum = (DVec3::ZERO, 0.0);
            for k in 0..fine * fine {
                let at = |cell: u32, k: u32| {
                    (f64::from(cell) + (f64::from(k) + 0.5) / f64::from(fine)) / f64::from(side)
                };
                let toward =
                    Map::Sphere.toward(at(cell % side, k % fine), at(cell / side, k / fine));
                if toward.y >= 0.0 {
                    sum.0 += sky.radiance(toward);
                    sum.1 += 1.0;
                }
            }
            sum.0 / f64::max(sum.1, 1.0)
        };
        let level = |level: usize| {
            let side = coarsest << level;
            (
                side,
                (0..side * side).map(|cell| mean(side, cell)).collect(),
            )
        };
        Sphere {
            means: (0..LEVELS).map(level).collect(),
        }
    }

    /// The light of an arrival.
    pub fn lit(&self, arrival: &Arrival, light: &Light) -> Lit {
        let side = (4.0 * PI / f64::from(arrival.share)).sqrt().round();
        let place = Map::Sphere.place(arrival.toward.as_dvec3());
        let [i, j] = place
            .unwrap_or_default()
            .map(|at| (at * side).floor().clamp(0.0, side - 1.0));
        let means = self.means.iter().find(|level| f64::from(level.0) == side);
        let radiance = match (arrival.source, means) {
            (Source::Sky(_), Some((_, means))) => means[(j * side + i) as usize],
            (source, _) => light.radiance(source),
        };
        Lit {
            toward: Map::Sphere
                .toward((i + 0.5) / side, (j + 0.5) / side)
                .as_vec3(),
            share: arrival.share,
            light: arrival.share * arrival.through * radiance.as_vec3(),
        }
    }
}
