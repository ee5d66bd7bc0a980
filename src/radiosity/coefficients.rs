//! Daylight coefficients: what points receive for each patch of the sky and each patch of a surface, found once for all moments.
//!
//! Light is linear. With E the illuminance that patches receive from outside, rho their reflectance and K what arrives of each
//! other's light, a point that sees the shares w of them receives w rho (1 - K rho)^-1 E. The row R = w rho (1 - K rho)^-1 is found by
//! Gauss and Seidel's iteration from the point's side, for many points at once. What a patch of the sky gives to a point is then
//! what is seen of it, and what R makes of the light that it gives to surfaces; the sun's reflected light is R times what the sun gives
//! to each patch at its true place, and the tiles of those patches that the point sees from near by.
//!
//! Where no surface, pane or medium has a colour, one channel is kept instead of three.
//!
//! Source: Tregenza & Waters 1983, Daylight coefficients, Lighting Research & Technology 15, 65.

use super::arrival::Source;
use super::dome::Dome;
use super::light::{off, open_sky, open_sun};
use super::sun::{Levels, sun_on_levels};
use super::tiles::Tile;
use super::transport::Transport;
use crate::colour::luminance;
use crate::conditions::{Conditions, Receiver};
use crate::error::Result;
use crate::memory;
use crate::sky::Sky;
use crate::task::Task;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Points whose rows are found together: a row of theirs fills some lines of the cache.
const TOGETHER: usize = 32;

/// The most turns of the iteration: at a reflectance of 0.9 everywhere some 60 are needed.
const TURNS: usize = 400;

/// Patches are left out that together, all in full sun, give no point more than this share of what it has of a dim sky [1].
const NOTHING: f64 = 1e-4;

/// What a spot of full sun on a patch, between the places that are looked at first, may give to a point, as a share of what the point has of
/// a dim sky [1].
const SPOT: f64 = 2e-3;

/// Full sun: more than a surface ever receives [lx].
const FULL_SUN: f64 = 1.2e5;

/// The luminance of a dim sky [cd/m2], the same all over: 10 klx on open ground.
const DIM_SKY: f64 = 1e4 / PI;

/// The finest level that is looked at first, however much of a patch points see.
const FINEST_FIRST: u32 = 12;

/// What points receive of each source.
pub struct Coefficients {
    points: usize,
    /// Weights of the channels: of one alone, which stands for all, or of three.
    channels: usize,
    dome: Dome,
    /// By patch of the sky, channel and point: illuminance for a radiance of 1 [lx per cd/m2].
    sky: Vec<f32>,
    /// The patches of surfaces that points receive light of.
    patches: Vec<u32>,
    /// How finely the sun on each of them is looked at.
    levels: Vec<Levels>,
    /// By patch of that list, channel and point: illuminance for 1 lx that the patch receives from outside [1].
    surfaces: Vec<f32>,
    /// The same of the open ground's radiance, by channel and point [lx per cd/m2].
    open_ground: Vec<f32>,
    /// By patch that shines by itself, channel and point: illuminance for an exitance of 1 lm/m2 [1].
    emitted: Vec<f32>,
    /// What points see of tiles: patch, tile, point, and illuminance for 1 lx more on that tile than on the whole patch [1].
    tiles: Vec<(u32, Tile, u32, Vec3)>,
}

/// What one point sees.
#[derive(Default)]
struct Seen {
    sky: BTreeMap<u32, DVec3>,
    open_ground: DVec3,
    patches: BTreeMap<u32, DVec3>,
    tiles: BTreeMap<(u32, Tile), DVec3>,
}

/// What some points receive of everything.
struct Block {
    sky: Vec<f32>,
    surfaces: Vec<f32>,
    open_ground: Vec<f32>,
    emitted: Vec<f32>,
    tiles: Vec<(u32, Tile, u32, Vec3)>,
}

impl Coefficients {
    /// Finds them for points, until what is not followed any more is below the share `unshot` of a point's light. `emitters` are patches
    /// that shine by themselves ([`Coefficients::add_emitted`]).
    ///
    /// Memory: 4 bytes a channel, point and patch of sky and surfaces.
    ///
    /// # Errors
    /// [`crate::Error::Failed`] when memory does not suffice, [`crate::Error::Stopped`] when the work was stopped.
    pub fn new(
        transport: &Transport,
        points: &[Receiver],
        emitters: &[u32],
        unshot: f64,
        task: Task<'_>,
    ) -> Result<Self> {
        let channels = if is_grey(transport) { 1 } else { 3 };
        let (skies, patches) = (transport.dome.len(), transport.patches.all.len());
        let sources = skies + patches + emitters.len();
        let cells = sources.saturating_mul(points.len() * channels);
        memory::check("the daylight coefficients", 8 * cells as u64)?;
        let blocks: Vec<&[Receiver]> = points.chunks(TOGETHER).collect();
        let pieces = task.pieces(blocks.len());
        let open = open_sky(transport, &transport.conditions);
        let blocks: Result<Vec<Block>> = blocks
            .into_par_iter()
            .map(|block| {
                pieces.begin()?;
                Ok(transport.block(block, channels, emitters, unshot, &open))
            })
            .collect();
        let blocks = blocks?;
        let shares = most_shares(&blocks, patches, skies);
        let active = all_but_least(&shares, NOTHING);
        let mut all = Coefficients {
            points: points.len(),
            channels,
            dome: transport.dome.clone(),
            sky: vec![0.0; skies * channels * points.len()],
            surfaces: vec![0.0; active.len() * channels * points.len()],
            open_ground: vec![0.0; channels * points.len()],
            emitted: vec![0.0; emitters.len() * channels * points.len()],
            tiles: Vec::new(),
            levels: Vec::new(),
            patches: active,
        };
        let mut first = 0;
        for block in blocks {
            let count = TOGETHER.min(points.len() - first);
            let copy = |to: &mut [f32], at: usize, from: &[f32], own: usize| {
                let begin = at * points.len() + first;
                to[begin..begin + count].copy_from_slice(&from[own * count..(own + 1) * count]);
            };
            for row in 0..skies * channels {
                copy(&mut all.sky, row, &block.sky, row);
            }
            for row in 0..emitters.len() * channels {
                copy(&mut all.emitted, row, &block.emitted, row);
            }
            for channel in 0..channels {
                copy(&mut all.open_ground, channel, &block.open_ground, channel);
                for (at, patch) in all.patches.iter().enumerate() {
                    let own = *patch as usize * channels + channel;
                    copy(
                        &mut all.surfaces,
                        at * channels + channel,
                        &block.surfaces,
                        own,
                    );
                }
            }
            let moved = block
                .tiles
                .into_iter()
                .map(|(patch, tile, point, share)| (patch, tile, point + first as u32, share));
            all.tiles.extend(moved);
            first += count;
        }
        all.tiles
            .sort_unstable_by_key(|(patch, tile, point, _)| (*patch, *tile, *point));
        let levels = all.patches.iter().map(|patch| {
            let first = (shares[*patch as usize] / SPOT).log(4.0).ceil();
            let first = first.clamp(1.0, f64::from(FINEST_FIRST)) as u32;
            let own = all.tiles_of(*patch).last();
            let seen = own.map_or(0, |(_, tile, ..)| tile.level());
            Levels {
                first,
                finest: seen.max(first + 1),
            }
        });
        all.levels = levels.collect();
        Ok(all)
    }

    /// The patches of the sky.
    pub fn dome(&self) -> &Dome {
        &self.dome
    }

    /// Whether one channel stands for all of them.
    pub fn is_grey(&self) -> bool {
        self.channels == 1
    }

    /// Patches of surfaces whose light points receive.
    pub fn patches(&self) -> usize {
        self.patches.len()
    }

    /// Memory that they take [bytes].
    pub fn bytes(&self) -> usize {
        4 * (self.sky.len() + self.surfaces.len() + self.emitted.len()) + 32 * self.tiles.len()
    }

    /// What points see of the tiles of a patch, from coarse ones to fine.
    fn tiles_of(&self, patch: u32) -> &[(u32, Tile, u32, Vec3)] {
        let begin = self.tiles.partition_point(|(p, ..)| *p < patch);
        let own = &self.tiles[begin..];
        &own[..own.partition_point(|(p, ..)| *p == patch)]
    }

    /// The illuminance [lx] that a sky gives, straight and by surfaces: added to that of each point.
    pub fn add_sky(&self, sky: &Sky, illuminances: &mut [f64]) {
        let mut sum = vec![0.0; self.points];
        if self.is_grey() {
            for (patch, luminance) in self.dome.luminances(sky).into_iter().enumerate() {
                self.add(&self.sky, patch, DVec3::splat(luminance), &mut sum);
            }
        } else {
            for (patch, radiance) in self.dome.radiances(sky).into_iter().enumerate() {
                self.add(&self.sky, patch, radiance, &mut sum);
            }
        }
        for (all, own) in illuminances.iter_mut().zip(sum) {
            *all += f64::from(own);
        }
    }

    /// The illuminance [lx] that surfaces make of the light of the sun of `conditions` (of the same scene): added to that of each
    /// point. What comes straight from the sun is not in it.
    pub fn add_reflected_sun(
        &self,
        transport: &Transport,
        conditions: &Conditions,
        illuminances: &mut [f64],
    ) {
        if !conditions.sun.shines() {
            return;
        }
        let mut sum = vec![0.0; self.points];
        for (at, patch) in self.patches.iter().copied().enumerate() {
            let levels = Some(self.levels[at]);
            let direct = sun_on_levels(transport, conditions, patch as usize, levels);
            if direct.mean != DVec3::ZERO {
                self.add(&self.surfaces, at, direct.mean, &mut sum);
            }
            if direct.tiles.is_empty() {
                continue;
            }
            for (_, tile, point, share) in self.tiles_of(patch) {
                if let Some(off) = off(&direct.tiles, *tile) {
                    sum[*point as usize] += luminance((*share * off).as_dvec3()) as f32;
                }
            }
        }
        self.add(&self.open_ground, 0, open_sun(conditions), &mut sum);
        for (all, own) in illuminances.iter_mut().zip(sum) {
            // Tiles that are darker than their patch cannot take more than there is.
            *all += f64::from(own.max(0.0));
        }
    }

    /// The illuminance [lx] that patches which shine by themselves give, straight and by surfaces, for the exitance of each [lm/m2],
    /// without colour: added to that of each point.
    pub fn add_emitted(&self, exitances: &[f64], illuminances: &mut [f64]) {
        let mut sum = vec![0.0; self.points];
        for (emitter, exitance) in exitances.iter().enumerate() {
            self.add(&self.emitted, emitter, DVec3::splat(*exitance), &mut sum);
        }
        for (all, own) in illuminances.iter_mut().zip(sum) {
            *all += f64::from(own);
        }
    }

    /// Adds what a source of a number gives, of this strength.
    fn add(&self, of: &[f32], number: usize, strength: DVec3, sum: &mut [f32]) {
        let weights = match self.channels {
            1 => [luminance(strength), 0.0, 0.0],
            _ => [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| luminance(axis * strength)),
        };
        for (channel, weight) in weights.iter().enumerate().take(self.channels) {
            let begin = (number * self.channels + channel) * self.points;
            let weight = *weight as f32;
            for (sum, share) in sum.iter_mut().zip(&of[begin..begin + self.points]) {
                *sum += weight * share;
            }
        }
    }
}

impl Transport {
    /// What one point sees of everything: of patches and tiles the form factor times what comes through.
    fn met_from(&self, point: &Receiver) -> Seen {
        let mut seen = Seen::default();
        for arrival in self.before(point.position, point.normal, point.normal) {
            let share = f64::from(arrival.share) * arrival.through.as_dvec3();
            match arrival.source {
                Source::Nothing => {}
                Source::Sky(patch) => *seen.sky.entry(patch).or_default() += share,
                Source::OpenGround => seen.open_ground += share,
                Source::Patch(patch, tile) => {
                    *seen.patches.entry(patch).or_default() += share;
                    if tile != Tile::WHOLE {
                        *seen.tiles.entry((patch, tile)).or_default() += share;
                    }
                }
            }
        }
        seen
    }

    /// What some points receive.
    fn block(
        &self,
        points: &[Receiver],
        channels: usize,
        emitters: &[u32],
        unshot: f64,
        open: &[DVec3],
    ) -> Block {
        let count = points.len();
        let width = channels * count;
        let patches = &self.patches.all;
        let seen: Vec<Seen> = points.iter().map(|point| self.met_from(point)).collect();
        let place = |channel: usize, point: usize| channel * count + point;
        // What a patch's exitance gives to the points, over its area.
        let mut start = vec![0.0f32; patches.len() * width];
        for (point, seen) in seen.iter().enumerate() {
            for (patch, share) in &seen.patches {
                let area = patches[*patch as usize].area;
                for channel in 0..channels {
                    let at = *patch as usize * width + place(channel, point);
                    start[at] = if area > 0.0 {
                        (share[channel] / area) as f32
                    } else {
                        0.0
                    };
                }
            }
        }
        let mut surfaces = self.solved(start, width, channels, unshot);
        let mut emitted = Vec::with_capacity(emitters.len() * width);
        for emitter in emitters.iter().map(|e| *e as usize) {
            let row = &surfaces[emitter * width..(emitter + 1) * width];
            let area = patches[emitter].area as f32;
            emitted.extend(row.iter().map(|share| area * share));
        }
        for (patch, row) in patches.iter().zip(surfaces.chunks_mut(width.max(1))) {
            for channel in 0..channels {
                let factor = (patch.area * patch.albedo[channel]) as f32;
                row[place(channel, 0)..place(channel, count)]
                    .iter_mut()
                    .for_each(|share| *share *= factor);
            }
        }
        let mut sky = vec![0.0f32; self.dome.len() * width];
        let mut open_ground = vec![0.0f32; width];
        for (point, seen) in seen.iter().enumerate() {
            for channel in 0..channels {
                let at = place(channel, point);
                for (patch, share) in &seen.sky {
                    sky[*patch as usize * width + at] = (PI * share[channel]) as f32;
                }
                open_ground[at] = (PI * seen.open_ground[channel]) as f32;
            }
        }
        for (outside, row) in self
            .exchange
            .outside
            .iter()
            .zip(surfaces.chunks(width.max(1)))
        {
            for (source, _, through) in outside {
                let to = match source {
                    Source::Sky(patch) => &mut sky[*patch as usize * width..][..width],
                    Source::OpenGround => &mut open_ground,
                    _ => continue,
                };
                for channel in 0..channels {
                    let factor = PI as f32 * through[channel];
                    let range = place(channel, 0)..place(channel, count);
                    for (to, share) in to[range.clone()].iter_mut().zip(&row[range]) {
                        *to += factor * share;
                    }
                }
            }
        }
        // What the open ground gives it has of the sky.
        let albedo = self.conditions.ground.map_or(DVec3::ZERO, |g| g.albedo) / PI;
        for (open, row) in open.iter().zip(sky.chunks_mut(width.max(1))) {
            for channel in 0..channels {
                let factor = (albedo * *open)[channel] as f32;
                let range = place(channel, 0)..place(channel, count);
                for (to, share) in row[range.clone()].iter_mut().zip(&open_ground[range]) {
                    *to += factor * share;
                }
            }
        }
        // Of the sun: by the illuminance of the open ground.
        for channel in 0..channels {
            let range = place(channel, 0)..place(channel, count);
            let factor = albedo[channel] as f32;
            open_ground[range]
                .iter_mut()
                .for_each(|share| *share *= factor);
        }
        let tiles = seen.into_iter().zip(0..).flat_map(|(seen, point)| {
            seen.tiles.into_iter().map(move |((patch, tile), share)| {
                let sent = patches[patch as usize].albedo;
                (patch, tile, point, (sent * share).as_vec3())
            })
        });
        Block {
            tiles: tiles.collect(),
            sky,
            surfaces,
            open_ground,
            emitted,
        }
    }

    /// The solution V of V_i = start_i + sum over j of K_ij rho_j V_j, for rows of so many values.
    fn solved(&self, start: Vec<f32>, width: usize, channels: usize, unshot: f64) -> Vec<f32> {
        let patches = &self.patches.all;
        let count = width / channels.max(1);
        let mut found = start.clone();
        let mut next = vec![0.0f32; width];
        for _ in 0..TURNS {
            let (mut change, mut whole) = (0.0f64, 0.0f64);
            for (i, to) in self.exchange.to.iter().enumerate() {
                if to.is_empty() {
                    continue;
                }
                next.copy_from_slice(&start[i * width..(i + 1) * width]);
                for (j, _, through) in to {
                    let j = *j as usize;
                    let row = &found[j * width..(j + 1) * width];
                    for channel in 0..channels {
                        let factor = through[channel] * patches[j].albedo[channel] as f32;
                        let range = channel * count..(channel + 1) * count;
                        for (next, value) in next[range.clone()].iter_mut().zip(&row[range]) {
                            *next += factor * value;
                        }
                    }
                }
                let area = patches[i].area * patches[i].albedo.max_element();
                let row = &mut found[i * width..(i + 1) * width];
                let sum: f32 = next.iter().sum();
                let off: f32 = next.iter().zip(&*row).map(|(a, b)| (a - b).abs()).sum();
                whole += area * f64::from(sum);
                change += area * f64::from(off);
                row.copy_from_slice(&next);
            }
            if change <= unshot * whole {
                break;
            }
        }
        found
    }
}

/// By patch: the most that it gives to any point in full sun, over what that point has of a dim sky [1]; infinite where the point has
/// nothing of the sky.
fn most_shares(blocks: &[Block], patches: usize, skies: usize) -> Vec<f64> {
    let mut most = vec![0.0f64; patches];
    for block in blocks {
        let width = (block.sky.len() / skies.max(1)).max(1);
        let mut dim = vec![0.0f64; width];
        for row in block.sky.chunks(width) {
            for (dim, share) in dim.iter_mut().zip(row) {
                *dim += DIM_SKY * f64::from(*share);
            }
        }
        for (most, row) in most.iter_mut().zip(block.surfaces.chunks(width)) {
            let shares = row.iter().zip(&dim).filter(|(share, _)| **share > 0.0);
            *most = shares.fold(*most, |m, (share, dim)| {
                m.max(FULL_SUN * f64::from(*share) / dim)
            });
        }
    }
    most
}

/// The patches, in order, without those of least share which together have no more than `rest`.
fn all_but_least(shares: &[f64], rest: f64) -> Vec<u32> {
    let mut by_share: Vec<u32> = (0..shares.len() as u32).collect();
    by_share.sort_by(|a, b| shares[*a as usize].total_cmp(&shares[*b as usize]));
    let mut sum = 0.0;
    let mut is_least = |patch: &u32| {
        sum += shares[*patch as usize];
        sum <= rest
    };
    let least = by_share.iter().take_while(|patch| is_least(patch)).count();
    let mut kept = by_share.split_off(least);
    kept.sort_unstable();
    kept
}

/// Whether nothing in a scene colours light.
fn is_grey(transport: &Transport) -> bool {
    let near = |v: Vec3| (v.max_element() - v.min_element()) <= 1e-5 * v.max_element();
    let patches = transport.patches.all.iter();
    let ground = transport
        .conditions
        .ground
        .map_or(DVec3::ZERO, |g| g.albedo);
    let exchange = &transport.exchange;
    near(ground.as_vec3())
        && patches.map(|p| p.albedo.as_vec3()).all(near)
        && exchange.to.iter().flatten().all(|(_, _, t)| near(*t))
        && exchange.outside.iter().flatten().all(|(_, _, t)| near(*t))
}
