//! What the air sends toward the eye where nothing stands around: it depends on height and direction alone.
//!
//! Light comes from the whole sky above and from the open ground below, through all media but those that have bounds; a layer counts with
//! its mean height. J is found at heights that
//! lie the denser the nearer the ground or the top of a haze is, and in directions some degrees apart, as they are needed.

use super::source::Lobes;
use super::sphere::Lit;
use crate::conditions::Conditions;
use crate::medium::{Air, Shape};
use crate::radiosity::arrival::Source;
use crate::radiosity::light::Light;
use crate::radiosity::shards::Shards;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::{Arc, OnceLock};

/// Directions from nadir to zenith, and around.
const UP: usize = 45;
const AROUND: usize = 90;

/// Rows of the sky and of the ground, and places in each row, from which light comes. Rows are narrow at the horizon, where the
/// way through the air changes most.
const SKY: [usize; 2] = [24, 48];
const GROUND: [usize; 2] = [16, 24];

/// Heights next to a border, each this much farther from it than the one before.
const RATIO: f64 = 1.25;

/// The nearest and the farthest height from a border [m].
const OFFSETS: [f64; 2] = [0.01, 3e5];

/// A direction from which light comes without media, and that light.
struct Incoming {
    toward: DVec3,
    share: f64,
    /// Solid angle times radiance [lx].
    light: DVec3,
}

/// J in the open air at a moment.
pub struct OpenAir {
    air: Air,
    ground: Option<f64>,
    lobes: Arc<Lobes>,
    incoming: Vec<Incoming>,
    heights: Vec<f64>,
    /// What comes to each height.
    lit: Vec<OnceLock<Vec<Lit>>>,
    values: Shards<[u16; 3], Vec<DVec3>>,
}

impl OpenAir {
    pub fn new(conditions: &Conditions, light: &Light, lobes: Arc<Lobes>) -> Self {
        let mut air = conditions.air.clone();
        air.media.retain(|medium| medium.bounds().is_none());
        for medium in &mut air.media {
            if let Shape::Layer { waves, .. } = &mut medium.shape {
                waves.clear();
            }
        }
        let heights = heights(&air);
        OpenAir {
            ground: conditions.ground.map(|ground| ground.height),
            incoming: incoming(conditions, light),
            lit: heights.iter().map(|_| OnceLock::new()).collect(),
            air,
            lobes,
            heights,
            values: Shards::new(),
        }
    }

    /// J of each kind at a height [m] that the eye sees in this direction [cd/m2].
    pub fn source(&self, height: f64, direction: DVec3) -> Vec<DVec3> {
        let above = self
            .heights
            .partition_point(|h| *h <= height)
            .clamp(1, self.heights.len() - 1);
        let (low, high) = (self.heights[above - 1], self.heights[above]);
        let at_height = ((height - low) / (high - low)).clamp(0.0, 1.0);
        let up = (direction.y.clamp(-1.0, 1.0).asin() / PI + 0.5) * UP as f64;
        let around = (direction.z.atan2(direction.x) / TAU).rem_euclid(1.0) * AROUND as f64;
        let row = (up as usize).min(UP - 1);
        let column = (around as usize).min(AROUND - 1);
        let (at_up, at_around) = (up - row as f64, around - column as f64);
        let mut sum: Vec<DVec3> = Vec::new();
        for corner in 0..8 {
            let of = |bit: usize, at: f64| match corner >> bit & 1 {
                0 => (0, 1.0 - at),
                _ => (1, at),
            };
            let ((h, a), (u, b), (r, c)) = (of(0, at_height), of(1, at_up), of(2, at_around));
            let weight = a * b * c;
            if weight == 0.0 {
                continue;
            }
            let key = [above - 1 + h, row + u, (column + r) % AROUND].map(|v| v as u16);
            let slot = self.values.place(key);
            let found = slot.get_or_init(|| self.at_node(key.map(usize::from)));
            sum.resize(found.len(), DVec3::ZERO);
            for (sum, j) in sum.iter_mut().zip(found) {
                *sum += weight * *j;
            }
        }
        sum
    }

    fn at_node(&self, [height, row, column]: [usize; 3]) -> Vec<DVec3> {
        let (sin, cos) = (PI * (row as f64 / UP as f64 - 0.5)).sin_cos();
        let (z, x) = (TAU * column as f64 / AROUND as f64).sin_cos();
        let lit = self.lit[height].get_or_init(|| self.lit_at(self.heights[height]));
        self.lobes.source(lit, DVec3::new(cos * x, sin, cos * z))
    }

    /// What comes to a height through the media.
    fn lit_at(&self, height: f64) -> Vec<Lit> {
        let place = DVec3::new(0.0, height, 0.0);
        let mut row = (f64::NAN, DVec3::ZERO);
        let of = |one: &Incoming| {
            let up = one.toward.y;
            if row.0 != up {
                let through = match self.ground {
                    _ if up >= 0.0 => (-self.air.sky_optical_depth(place, one.toward)).exp(),
                    Some(ground) if height >= ground => {
                        let distance = (height - ground) / -up;
                        (-self.air.optical_depth(place, one.toward, distance)).exp()
                    }
                    _ => DVec3::ZERO,
                };
                row = (up, through);
            }
            Lit {
                toward: one.toward.as_vec3(),
                share: one.share as f32,
                light: (row.1 * one.light).as_vec3(),
            }
        };
        self.incoming.iter().map(of).collect()
    }
}

/// Light from all sides in the open, without media.
fn incoming(conditions: &Conditions, light: &Light) -> Vec<Incoming> {
    const FINE: usize = 3;
    let sky = |toward: DVec3| match &conditions.sky {
        Some(sky) => sky.radiance(toward),
        None => DVec3::ZERO,
    };
    let ground = light.radiance(Source::OpenGround);
    let mut found = Vec::new();
    for (sign, [rows, columns]) in [(1.0, SKY), (-1.0, GROUND)] {
        let edge = |row: f64| (row / rows as f64).powi(2);
        let toward = |row: f64, column: f64| {
            let sin = edge(row);
            let level = (1.0 - sin * sin).max(0.0).sqrt();
            let (z, x) = (TAU * column / columns as f64).sin_cos();
            DVec3::new(level * x, sign * sin, level * z)
        };
        for row in 0..rows {
            let share = (edge(row as f64 + 1.0) - edge(row as f64)) * TAU / columns as f64;
            for column in 0..columns {
                let radiance = if sign > 0.0 {
                    let mut mean = (DVec3::ZERO, 0.0);
                    for i in 0..FINE * FINE {
                        let at = |i: usize| (i as f64 + 0.5) / FINE as f64;
                        let (r, c) = (row as f64 + at(i / FINE), column as f64 + at(i % FINE));
                        // Equal steps of a row do not have equal solid angles.
                        mean.0 += r * sky(toward(r, c));
                        mean.1 += r;
                    }
                    mean.0 / mean.1
                } else {
                    ground
                };
                let sin = 0.5 * (edge(row as f64) + edge(row as f64 + 1.0));
                let at = sin.sqrt() * rows as f64;
                found.push(Incoming {
                    toward: toward(at, column as f64 + 0.5),
                    share,
                    light: share * radiance,
                });
            }
        }
    }
    found
}

/// The heights at which J is found [m].
fn heights(air: &Air) -> Vec<f64> {
    let tops = air.media.iter().filter_map(|medium| match medium.shape {
        Shape::Haze { top } | Shape::Layer { top, .. } => Some(top),
        Shape::Height { base, .. } | Shape::Air { base, .. } => Some(base),
        Shape::Box { .. } | Shape::Ellipsoid { .. } => None,
    });
    let bottoms = air.media.iter().filter_map(|medium| match medium.shape {
        Shape::Layer { bottom, .. } => bottom,
        _ => None,
    });
    let mut heights = Vec::new();
    for border in tops.chain(bottoms).chain([air.ground]) {
        heights.push(border);
        let mut offset = OFFSETS[0];
        while offset < OFFSETS[1] {
            heights.extend([border - offset, border + offset]);
            offset *= RATIO;
        }
    }
    heights.sort_unstable_by(f64::total_cmp);
    heights.dedup_by(|b, a| *b - *a < 1e-3);
    heights
}
