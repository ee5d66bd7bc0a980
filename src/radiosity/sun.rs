//! What the sun gives to each patch, and where on it.
//!
//! Shadow rays go from places that are spread over the rectangle around the patch, more of them where patches are large beside the
//! finest of their plane, so that no shadow of what stands there falls between them. Where they differ, an edge runs through: tiles
//! along it are quartered as far as tiles go.

use super::arrival::spread;
use super::cells::{Face, Part};
use super::tiles::{Tile, first};
use super::transport::Transport;
use crate::conditions::Conditions;
use crate::scene::Ray;
use glam::{DVec2, DVec3, Vec3};

/// The sun on a patch.
#[derive(Default)]
pub(super) struct Sunned {
    /// The mean illuminance [lx, RGB].
    pub mean: DVec3,
    /// Where the sun lights the patch in part: that of tiles less the mean, sorted, of those alone that have other than the tile
    /// that they are a quarter of. The mean over the patch is zero.
    pub tiles: Vec<(Tile, Vec3)>,
}

/// Shadow rays to a patch that is no part of a plane: first, and where they differ.
const RAYS: [usize; 2] = [16, 128];

/// The least level on which it is found whether the sun lights all of a patch alike; else that of tiles half as large as the plane's
/// finest cells.
const FIRST: u32 = 2;

/// Shadow rays to each of the finest tiles along an edge.
const EDGE_RAYS: usize = 2;

/// What differs by more of the sun's light is not alike [1].
const ALIKE: f64 = 0.02;

/// What of the sun's light arrives in a tile, and the share of the tile that is there [1].
#[derive(Clone, Copy, Default)]
struct Lit {
    through: DVec3,
    there: f64,
}

impl Lit {
    fn mean(all: &[Lit]) -> Self {
        let there: f64 = all.iter().map(|one| one.there).sum();
        if there <= 0.0 {
            return Lit::default();
        }
        let through: DVec3 = all.iter().map(|one| one.there * one.through).sum();
        Lit {
            through: through / there,
            there: there / all.len() as f64,
        }
    }

    fn is_like(&self, other: &Lit) -> bool {
        self.there == 0.0
            || other.there == 0.0
            || (self.through - other.through).abs().max_element() <= ALIKE
    }
}

/// Finds it for the sun of `conditions`.
pub(super) fn sun_on(transport: &Transport, conditions: &Conditions, patch: usize) -> Sunned {
    let sun = &conditions.sun;
    if !sun.shines() || !transport.exchange.sees(patch) {
        return Sunned::default();
    }
    if let Some((face, part)) = transport.patches.part(patch) {
        let cosine = face.plane.normal.dot(sun.toward);
        if cosine <= 0.0 {
            return Sunned::default();
        }
        let look = Look {
            transport,
            conditions,
            face,
            part,
        };
        if let Some(levels) = look.levels() {
            let light = cosine * sun.light.illuminance;
            let mean = levels[0].through;
            let tiles = levels.iter().enumerate().filter_map(|(number, lit)| {
                let tile = Tile::numbered(number);
                let whole = levels[tile.whole()?.number()].through;
                let off = (light * (lit.through - mean)).as_vec3();
                let differs = (lit.through - whole).abs().max_element() > 1e-6;
                differs.then_some((tile, off))
            });
            return Sunned {
                mean: light * mean,
                tiles: tiles.collect(),
            };
        }
    }
    Sunned {
        mean: by_spots(transport, conditions, patch),
        tiles: Vec::new(),
    }
}

/// What of the sun's light arrives at a point that rays leave by the normal.
fn through(transport: &Transport, conditions: &Conditions, point: DVec3, normal: DVec3) -> DVec3 {
    let toward = conditions.sun.toward;
    let ray = Ray {
        origin: point + transport.near(DVec3::ZERO) * normal,
        direction: toward,
    };
    let through = conditions.geometry.transmittance(&ray, 0.0, f64::INFINITY);
    if through != DVec3::ZERO {
        through * (-conditions.air.sun_optical_depth(point, toward)).exp()
    } else {
        DVec3::ZERO
    }
}

/// The mean illuminance [lx, RGB] of a patch by points all over it.
fn by_spots(transport: &Transport, conditions: &Conditions, patch: usize) -> DVec3 {
    let own = &transport.patches.all[patch];
    let sun = &conditions.sun;
    let lit = |range: std::ops::Range<usize>| {
        let mut sum = DVec3::ZERO;
        let mut some = [false; 2];
        for i in range {
            let spot = own.spot(&spread(i, patch as u64));
            let cosine = spot.normal.dot(sun.toward);
            if cosine > 0.0 {
                let through = through(transport, conditions, spot.point, spot.normal);
                some[usize::from(through != DVec3::ZERO)] = true;
                sum += cosine * through;
            }
        }
        (sum, some)
    };
    let [few, many] = RAYS;
    let (mut sum, some) = lit(0..few);
    let mut count = few;
    if some == [true, true] {
        sum += lit(few..many).0;
        count = many;
    }
    sun.light.illuminance * sum / count as f64
}

/// A part of a cell that the sun may light.
struct Look<'a> {
    transport: &'a Transport,
    conditions: &'a Conditions,
    face: &'a Face,
    part: &'a Part,
}

impl Look<'_> {
    /// The tiles of all levels, by number; the whole alone where the sun lights all of it alike. `None` where no ray began on it.
    fn levels(&self) -> Option<Vec<Lit>> {
        let depth = self.part.depth;
        let mut level = depth.saturating_sub(2).max(FIRST);
        let side = 1 << level;
        let mut tiles: Vec<Lit> = (0..side * side)
            .map(|k| self.tile(level, k % side, k / side, 1))
            .collect();
        let one = tiles.iter().find(|lit| lit.there > 0.0)?;
        if tiles.iter().all(|lit| lit.is_like(one)) {
            return Some(vec![Lit::mean(&tiles)]);
        }
        while level < depth {
            let rays = if level + 1 < depth { 1 } else { EDGE_RAYS };
            tiles = self.quartered(level, &tiles, rays);
            level += 1;
        }
        let mut levels = vec![Lit::default(); first(depth + 1)];
        levels[first(depth)..].copy_from_slice(&tiles);
        for level in (0..depth).rev() {
            each_quarters(level, |tile, quarters| {
                levels[tile] = Lit::mean(&quarters.map(|quarter| levels[quarter]));
            });
        }
        // Where nothing was found to be there, what is around it holds.
        for level in 0..depth {
            each_quarters(level, |tile, quarters| {
                for quarter in quarters {
                    if levels[quarter].there == 0.0 {
                        levels[quarter].through = levels[tile].through;
                    }
                }
            });
        }
        Some(levels)
    }

    /// One tile, by so many rays.
    fn tile(&self, level: u32, i: usize, j: usize, rays: usize) -> Lit {
        let Look {
            transport,
            conditions,
            face,
            part,
        } = self;
        let ray = |k: usize| {
            let seed = u64::from(part.patch) << 32 | (first(level) + (j << level) + i) as u64;
            let [x, y, ..] = spread(k, seed);
            let place = DVec2::new(i as f64 + x, j as f64 + y) / f64::from(1u32 << level);
            let at = part.low + place * (part.high - part.low);
            if !part.covers(at) {
                return Lit::default();
            }
            let point = face.plane.point(at);
            Lit {
                through: through(transport, conditions, point, face.plane.normal),
                there: 1.0,
            }
        };
        let found: Vec<Lit> = (0..rays).map(ray).collect();
        Lit::mean(&found)
    }

    /// The tiles of the next level: found anew where one beside differs, or where the surface may end.
    fn quartered(&self, level: u32, tiles: &[Lit], rays: usize) -> Vec<Lit> {
        let side = 1usize << level;
        let is_even = |i: usize, j: usize| {
            let own = &tiles[j * side + i];
            let across = |at: usize| at.saturating_sub(1)..(at + 2).min(side);
            let mut around = across(j).flat_map(|v| across(i).map(move |u| &tiles[v * side + u]));
            match own.there > 0.0 {
                true => around.all(|other| own.is_like(other)),
                false => around.all(|other| other.there == 0.0),
            }
        };
        let even: Vec<bool> = (0..side * side)
            .map(|k| is_even(k % side, k / side))
            .collect();
        let quarter = |k: usize| {
            let (i, j) = (k % (2 * side), k / (2 * side));
            let whole = j / 2 * side + i / 2;
            match even[whole] {
                true => tiles[whole],
                false => self.tile(level + 1, i, j, rays),
            }
        };
        (0..4 * side * side).map(quarter).collect()
    }
}

/// Calls `each` with every tile of a level and its quarters.
fn each_quarters(level: u32, mut each: impl FnMut(usize, [usize; 4])) {
    let side = 1usize << level;
    for k in 0..side * side {
        let corner = first(level + 1) + k / side * 4 * side + k % side * 2;
        let below = corner + 2 * side;
        each(first(level) + k, [corner, corner + 1, below, below + 1]);
    }
}
