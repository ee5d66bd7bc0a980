//! Direct light over a part of a plane: where it falls, tile by tile.
//!
//! It is looked at from places that are spread over the rectangle around the part. Where tiles differ, the edge of a shadow or of a
//! beam runs through: tiles along it are quartered as far as tiles go, and so are those around places that are watched, as where the
//! axis of a narrow beam meets the plane.

use super::arrival::spread;
use super::cells::{Face, Part};
use super::tiles::{Tile, first};
use glam::{DVec2, DVec3, Vec3};
use std::collections::HashMap;

/// Direct light on a patch.
#[derive(Default)]
pub(super) struct Direct {
    /// The mean illuminance [lx, RGB].
    pub mean: DVec3,
    /// Where it is uneven: the illuminance of tiles less the mean, sorted, of those alone that have other than the tile that they are a
    /// quarter of. The mean over the patch is zero.
    pub tiles: Vec<(Tile, Vec3)>,
}

/// Places looked at in a finest tile that is watched: so many where what is there is half as wide, and more where it is narrower, up to
/// the second number.
const WATCHED: [f64; 2] = [512.0, 16384.0];

/// What arrives in a tile, and the share of the tile that is there [1].
#[derive(Clone, Copy, Default)]
struct Lit {
    arrives: DVec3,
    there: f64,
}

impl Lit {
    fn mean(all: &[Lit]) -> Self {
        let there: f64 = all.iter().map(|one| one.there).sum();
        if there <= 0.0 {
            return Lit::default();
        }
        let arrives: DVec3 = all.iter().map(|one| one.there * one.arrives).sum();
        Lit {
            arrives: arrives / there,
            there: there / all.len() as f64,
        }
    }

    fn is_like(&self, other: &Lit, least: f64) -> bool {
        self.there == 0.0
            || other.there == 0.0
            || (self.arrives - other.arrives).abs().max_element() <= least
    }
}

/// Where light may be too narrow for the first look.
pub(super) struct Watched {
    /// A place of the part's rectangle.
    pub at: DVec2,
    /// How wide it may be there [m]: tiles more than half as wide are quartered.
    pub width: f64,
}

/// How direct light on a part of a plane is looked at.
pub(super) struct Look<'a, F> {
    pub face: &'a Face,
    pub part: &'a Part,
    /// What arrives at a point of the plane [any unit, RGB].
    pub arrives: F,
    /// What differs by no more than this share of the most is alike [1].
    pub alike: f64,
    /// The most that can arrive, if that is known; else the most that has been found.
    pub most: Option<f64>,
    /// The level that is looked at first.
    pub level: u32,
    /// The finest level: that of the part, or a coarser one.
    pub depth: u32,
    /// Places looked at in all of the finest tiles along edges together; in each at least two, and at most so many.
    pub edge: [usize; 2],
    /// Where tiles are quartered however even it is around them.
    pub watched: Vec<Watched>,
}

impl<F: Fn(DVec3) -> DVec3> Look<'_, F> {
    /// Direct light on the part, where `light` is the illuminance for 1 of what arrives. `None` where no place looked at lies on it.
    pub fn direct(&self, light: DVec3) -> Option<Direct> {
        let levels = self.levels()?;
        let mean = levels[0].arrives;
        let least = 1e-6 * self.most(&levels);
        let tiles = levels.iter().enumerate().filter_map(|(number, lit)| {
            let tile = Tile::numbered(number);
            let whole = levels[tile.whole()?.number()].arrives;
            let off = (light * (lit.arrives - mean)).as_vec3();
            let differs = (lit.arrives - whole).abs().max_element() > least;
            differs.then_some((tile, off))
        });
        Some(Direct {
            mean: light * mean,
            tiles: tiles.collect(),
        })
    }

    fn most(&self, tiles: &[Lit]) -> f64 {
        let found = tiles.iter().map(|lit| lit.arrives.max_element());
        self.most.unwrap_or_else(|| found.fold(0.0, f64::max))
    }

    /// The tiles of all levels, by number; the whole alone where all of it is alike.
    fn levels(&self) -> Option<Vec<Lit>> {
        let mut level = self.level;
        let side = 1 << level;
        let mut tiles: Vec<Lit> = (0..side * side)
            .map(|k| self.tile(level, k % side, k / side, 1))
            .collect();
        let one = tiles.iter().find(|lit| lit.there > 0.0);
        let least = self.alike * self.most(&tiles);
        if self.watched(level).is_empty() {
            let one = one?;
            if tiles.iter().all(|lit| lit.is_like(one, least)) {
                return Some(vec![Lit::mean(&tiles)]);
            }
        }
        while level < self.depth {
            tiles = self.quartered(level, &tiles);
            level += 1;
        }
        let mut levels = vec![Lit::default(); first(level + 1)];
        levels[first(level)..].copy_from_slice(&tiles);
        for level in (0..level).rev() {
            each_quarters(level, |tile, quarters| {
                levels[tile] = Lit::mean(&quarters.map(|quarter| levels[quarter]));
            });
        }
        if levels[0].there == 0.0 {
            return None;
        }
        // Where nothing was found to be there, what is around it holds.
        for level in 0..level {
            each_quarters(level, |tile, quarters| {
                for quarter in quarters {
                    if levels[quarter].there == 0.0 {
                        levels[quarter].arrives = levels[tile].arrives;
                    }
                }
            });
        }
        Some(levels)
    }

    /// One tile, by so many places.
    fn tile(&self, level: u32, i: usize, j: usize, places: usize) -> Lit {
        let Look { face, part, .. } = self;
        let place = |k: usize| {
            let seed = u64::from(part.patch) << 32 | (first(level) + (j << level) + i) as u64;
            let [x, y, ..] = spread(k, seed);
            let place = DVec2::new(i as f64 + x, j as f64 + y) / f64::from(1u32 << level);
            let at = part.low + place * (part.high - part.low);
            if !part.covers(at) {
                return Lit::default();
            }
            Lit {
                arrives: (self.arrives)(face.plane.point(at)),
                there: 1.0,
            }
        };
        let found: Vec<Lit> = (0..places).map(place).collect();
        Lit::mean(&found)
    }

    /// Which tiles of a level are watched, by number within the level, and how many places tell what is there.
    fn watched(&self, level: u32) -> Vec<(usize, usize)> {
        let Part { low, high, .. } = self.part;
        let width = (*high - *low).max_element() / f64::from(1u32 << level);
        let too_wide = self.watched.iter().filter(|w| width > 0.5 * w.width);
        let [some, most] = WATCHED;
        let tile = |w: &Watched| {
            let tile = Tile::at(level, (w.at - *low) / (*high - *low));
            let places = some * (0.5 * width / w.width).powi(2);
            (
                tile.number() - first(level),
                places.clamp(some, most) as usize,
            )
        };
        too_wide.map(tile).collect()
    }

    /// The tiles of the next level: found anew where one beside differs, where the surface may end, and where it is watched.
    fn quartered(&self, level: u32, tiles: &[Lit]) -> Vec<Lit> {
        let side = 1usize << level;
        let least = self.alike * self.most(tiles);
        let is_even = |i: usize, j: usize| {
            let own = &tiles[j * side + i];
            let across = |at: usize| at.saturating_sub(1)..(at + 2).min(side);
            let mut around = across(j).flat_map(|v| across(i).map(move |u| &tiles[v * side + u]));
            match own.there > 0.0 {
                true => around.all(|other| own.is_like(other, least)),
                false => around.all(|other| other.there == 0.0),
            }
        };
        let mut even: Vec<bool> = (0..side * side)
            .map(|k| is_even(k % side, k / side))
            .collect();
        for (tile, _) in self.watched(level) {
            even[tile] = false;
        }
        let is_finest = level + 1 == self.depth;
        let mut watched: HashMap<usize, usize> = HashMap::new();
        if is_finest {
            for (tile, places) in self.watched(level + 1) {
                let most = watched.entry(tile).or_insert(places);
                *most = places.max(*most);
            }
        }
        let [together, most] = self.edge;
        let uneven = 4 * even.iter().filter(|even| !**even).count();
        let edge = (together / uneven.max(1)).clamp(2, most);
        let quarter = |k: usize| {
            let (i, j) = (k % (2 * side), k / (2 * side));
            let whole = j / 2 * side + i / 2;
            if even[whole] {
                return tiles[whole];
            }
            let places = match watched.get(&k) {
                Some(places) => *places,
                None if is_finest => edge,
                None => 1,
            };
            self.tile(level + 1, i, j, places)
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
