//! How bright every source is at a moment: progressive refinement.
//!
//! The patches that have most unshot light shoot it to all that they see, until the unshot share of each is below the tolerance
//! (Cohen, Chen, Wallace & Greenberg 1988): of each, since the ground around a house holds more than all its rooms. Of what arrives at a patch its reflectance is sent on and the rest absorbed; what meets no patch
//! escapes; what media take on the way stays there. At every step emitted = absorbed + escaped + taken + unshot.
//!
//! Differs from the ReLiShaft paper's algorithm 2 as that must be read: dB_j = rho_j dB_i F_ij A_i / A_j.

use super::arrival::{Arrival, Source};
use super::lamps::lamps_on;
use super::sun::sun_on;
use super::tiles::Tile;
use super::transport::Transport;
use crate::colour::luminance;
use crate::conditions::Conditions;
use crate::error::Result;
use crate::sky::patches::Patch;
use crate::task::Task;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Values of tiles, sorted.
type Tiles = Box<[(Tile, Vec3)]>;

/// How bright every source is at a moment [cd/m2, RGB].
pub struct Light {
    sky: Vec<DVec3>,
    open_ground: DVec3,
    /// What open ground receives from the sky [lx].
    open_sky: DVec3,
    /// Means over the patches.
    patches: Vec<DVec3>,
    /// By patch: the radiance of each tile less the mean, where sun or lamps light the patch unevenly.
    tiles: Vec<Tiles>,
    /// The account of energy.
    pub account: Account,
}

/// Where the light went that sky, sun, lamps and open ground gave to surfaces [lm, RGB].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Account {
    /// What surfaces received from outside.
    pub received: DVec3,
    /// What they absorbed of it, at once or later.
    pub absorbed: DVec3,
    /// What left the scene.
    pub escaped: DVec3,
    /// What the air took between surfaces.
    pub taken: DVec3,
    /// What was not shot.
    pub unshot: DVec3,
    /// How often a patch shot.
    pub shots: u64,
}

impl Light {
    /// Finds it for sun, sky and lamps of `conditions`, over the transport of the same scene, until the unshot share of what
    /// surfaces received is below `unshot`.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] when the work was stopped.
    pub fn new(
        transport: &Transport,
        conditions: &Conditions,
        unshot: f64,
        task: Task<'_>,
    ) -> Result<Self> {
        let sky = conditions.sky.as_ref();
        let sky = sky.map_or(vec![DVec3::ZERO; transport.dome.len()], |sky| {
            transport.dome.radiances(sky)
        });
        let receives = open_sky(transport, conditions);
        let open_sky: DVec3 = receives.iter().zip(&sky).map(|(r, l)| *r * *l).sum();
        let open_sun = open_sun(conditions);
        let open_ground =
            conditions.ground.map_or(DVec3::ZERO, |g| g.albedo) / PI * (open_sky + open_sun);
        let mut light = Light {
            sky,
            open_sky,
            open_ground,
            patches: Vec::new(),
            tiles: Vec::new(),
            account: Account::default(),
        };
        let pieces = task.part(0.0, 0.5).pieces(transport.patches.all.len());
        let received: Result<Vec<(DVec3, Tiles)>> = (0..transport.patches.all.len())
            .into_par_iter()
            .map(|patch| {
                pieces.begin()?;
                let outside = transport.exchange.outside[patch].iter();
                let sky: DVec3 = outside
                    .map(|(source, _, through)| through.as_dvec3() * light.radiance(*source))
                    .sum();
                let sun = sun_on(transport, conditions, patch);
                let lamps = lamps_on(transport, conditions, patch);
                let sent = (transport.patches.all[patch].albedo / PI).as_vec3();
                let tiles = together(sun.tiles, lamps.tiles).into_iter();
                let tiles = tiles.map(|(tile, off)| (tile, sent * off)).collect();
                Ok((PI * sky + sun.mean + lamps.mean, tiles))
            })
            .collect();
        let (irradiance, tiles): (Vec<DVec3>, Vec<Tiles>) = received?.into_iter().unzip();
        let task = task.part(0.5, 1.0);
        let (exitance, account) = shoot(transport, &irradiance, unshot, task)?;
        light.patches = exitance.into_iter().map(|m| m / PI).collect();
        light.tiles = tiles;
        light.account = account;
        Ok(light)
    }

    /// The radiance of a source [cd/m2, RGB].
    pub fn radiance(&self, source: Source) -> DVec3 {
        match source {
            Source::Nothing => DVec3::ZERO,
            Source::Sky(patch) => self.sky[patch as usize],
            Source::OpenGround => self.open_ground,
            Source::Patch(patch, tile) => {
                let mean = self.patches[patch as usize];
                match off(&self.tiles[patch as usize], tile) {
                    Some(off) => (mean + off.as_dvec3()).max(DVec3::ZERO),
                    None => mean,
                }
            }
        }
    }

    /// What the open ground receives: straight from the sky, and from surfaces [lx, RGB].
    pub(super) fn on_open_ground(&self) -> [DVec3; 2] {
        [self.open_sky, DVec3::ZERO]
    }

    /// The light of one arrival: share times radiance times what is let through.
    pub fn of(&self, arrival: &Arrival) -> DVec3 {
        f64::from(arrival.share) * arrival.through.as_dvec3() * self.radiance(arrival.source)
    }

    /// How it came about, in words: patches, openings, where the light went; and why there is none.
    pub fn describe(&self, transport: &Transport) -> String {
        let all = &transport.patches;
        let exchange = &transport.exchange;
        let reached = (0..all.all.len())
            .filter(|patch| exchange.sees(*patch) && !all.is_ground(*patch as u32));
        let surfaces = (0..all.all.len()).filter(|patch| !all.is_ground(*patch as u32));
        let (reached, surfaces) = (reached.count(), surfaces.count());
        let openings = match (transport.openings.all().len(), transport.gaps.len()) {
            (0, 0) => "no small openings".to_owned(),
            (count, 0) => format!("{count} points in openings"),
            (count, gaps) => format!("{count} points in openings and {gaps} small gaps in planes"),
        };
        let coarse = match all.coarse {
            true => ", fewer than the scene's shape asks for (radiosity.patches)",
            false => "",
        };
        let account = &self.account;
        let share = |part: DVec3| {
            let whole = luminance(account.received);
            if whole > 0.0 {
                100.0 * luminance(part) / whole
            } else {
                0.0
            }
        };
        let closed = match surfaces > 0 && reached < surfaces {
            true => "; light from outside reaches none of the others",
            false => "",
        };
        format!(
            "{surfaces} patches{coarse}, {reached} of them in reach of light{closed}; {openings}; what patches see of each other was balanced \
             by factors up to {:.2}; of the light that surfaces received from outside {:.1} % was absorbed, {:.1} % escaped, {:.1} % the air took, {:.3} % was not \
             shot",
            1.0 + exchange.correction.min(99.0),
            share(account.absorbed),
            share(account.escaped),
            share(account.taken),
            share(account.unshot),
        )
    }
}

/// The value of a tile, or of the smallest one around it that has one.
pub(super) fn off(tiles: &[(Tile, Vec3)], tile: Tile) -> Option<Vec3> {
    if tiles.is_empty() {
        return None;
    }
    let mut around = Some(tile);
    while let Some(tile) = around {
        if let Ok(found) = tiles.binary_search_by_key(&tile, |(tile, _)| *tile) {
            return Some(tiles[found].1);
        }
        around = tile.whole();
    }
    None
}

/// The sum of two sets of tiles, each of which holds for all of its quarters that it does not have.
fn together(one: Vec<(Tile, Vec3)>, other: Vec<(Tile, Vec3)>) -> Vec<(Tile, Vec3)> {
    if one.is_empty() || other.is_empty() {
        return [one, other].concat();
    }
    let mut tiles: Vec<Tile> = one.iter().chain(&other).map(|(tile, _)| *tile).collect();
    tiles.sort_unstable();
    tiles.dedup();
    let of = |all: &[(Tile, Vec3)], tile| off(all, tile).unwrap_or(Vec3::ZERO);
    let sum = |tile: Tile| (tile, of(&one, tile) + of(&other, tile));
    tiles.into_iter().map(sum).collect()
}

/// What ground receives that lies open for a radiance of 1 of each patch of the sky [lx per cd/m2, RGB]; without a ground, nothing.
pub(super) fn open_sky(transport: &Transport, conditions: &Conditions) -> Vec<DVec3> {
    let Some(ground) = conditions.ground else {
        return vec![DVec3::ZERO; transport.dome.len()];
    };
    let place = DVec3::new(0.0, ground.height, 0.0);
    let patches = transport.dome.patches().iter();
    let receives = |patch: &Patch| {
        let depth = conditions.air.sky_optical_depth(place, patch.direction);
        patch.projected * (-depth).exp()
    };
    patches.map(receives).collect()
}

/// What ground receives from the sun that lies open [lx, RGB].
pub(super) fn open_sun(conditions: &Conditions) -> DVec3 {
    let sun = &conditions.sun;
    let Some(ground) = conditions
        .ground
        .filter(|_| sun.shines() && sun.toward.y > 0.0)
    else {
        return DVec3::ZERO;
    };
    let place = DVec3::new(0.0, ground.height, 0.0);
    let depth = conditions.air.sun_optical_depth(place, sun.toward);
    sun.light.illuminance * sun.toward.y * (-depth).exp()
}

/// What each patch sends in the end [lm/m2, RGB], for what it receives from outside.
fn shoot(
    transport: &Transport,
    irradiance: &[DVec3],
    tolerance: f64,
    task: Task<'_>,
) -> Result<(Vec<DVec3>, Account)> {
    let patches = &transport.patches.all;
    let exchange = &transport.exchange;
    let mut account = Account::default();
    let mut exitance: Vec<DVec3> = Vec::with_capacity(patches.len());
    // Light on its way [lm].
    let mut waiting: Vec<DVec3> = Vec::with_capacity(patches.len());
    for (patch, irradiance) in patches.iter().zip(irradiance) {
        let sent = patch.albedo * *irradiance;
        account.received += patch.area * *irradiance;
        account.absorbed += patch.area * (*irradiance - sent);
        exitance.push(sent);
        waiting.push(patch.area * sent);
    }
    // A patch has done its part when what it has not shot is this share of all that it sends; of a bright one less, since that comes
    // back to it again and again.
    let done: Vec<f64> = patches
        .iter()
        .map(|patch| tolerance * patch.area * (1.0 - patch.albedo.max_element()).max(1e-4))
        .collect();
    let waits = |i: usize, waiting: &[DVec3], exitance: &[DVec3]| {
        let own = waiting[i].element_sum();
        if own > done[i] * exitance[i].element_sum() {
            own
        } else {
            0.0
        }
    };
    let unshot = |waiting: &[DVec3]| waiting.iter().copied().sum::<DVec3>().element_sum();
    let all = unshot(&waiting);
    loop {
        // It falls about as quickly all the time.
        task.tell((unshot(&waiting) / all).ln() / tolerance.ln());
        let most = (0..patches.len()).map(|i| waits(i, &waiting, &exitance));
        let level = 0.5 * most.fold(0.0, f64::max);
        if level == 0.0 {
            break;
        }
        for from in 0..patches.len() {
            if waits(from, &waiting, &exitance) < level {
                continue;
            }
            task.check()?;
            let flux = std::mem::take(&mut waiting[from]);
            account.shots += 1;
            account.escaped += flux * exchange.escapes[from];
            let mut rest = flux * (1.0 - exchange.escapes[from]);
            for (to, share, through) in &exchange.to[from] {
                let to = *to as usize;
                let arrives = flux * through.as_dvec3();
                let sent = patches[to].albedo * arrives;
                account.absorbed += arrives - sent;
                account.taken += flux * f64::from(*share) - arrives;
                rest -= flux * f64::from(*share);
                waiting[to] += sent;
                exitance[to] += sent / patches[to].area;
            }
            // What scaling has left of a row's sum.
            account.absorbed += rest;
        }
    }
    account.unshot = waiting.iter().copied().sum();
    Ok((exitance, account))
}
