//! What comes to a place, by rays: more of them along outlines of what is bright.
//!
//! Directions lie in equal cells of a square that is mapped to the sphere or the hemisphere. Where a cell and its
//! neighbour differ (one sees the sky, the other a wall), an outline runs through, and the cell is quartered until outlines are known
//! well enough; openings that are known to be somewhere are looked for, however small they are from there, pools of lamp light are looked at
//! closely ([`super::pools`]), and small gaps are looked through ([`super::gaps`]). The same directions
//! everywhere let what is found change smoothly from place to place; each lies elsewhere in its cell, since an outline that runs along
//! the cells' borders would be off by the same in all of them.

use super::arrival::{Arrival, Care, Map, Source, spread};
use super::gaps::{Gap, Way};
use super::pools::looked_at;
use super::transport::{Look, Transport, WHOLE};
use crate::scene::Ray;
use glam::DVec3;
use std::f64::consts::PI;

/// How often a cell may be quartered, and one in which an opening is known to be.
const LEVELS: [u32; 2] = [4, 9];

/// The least share of a place's light that is worth a finer outline [1].
const DIM: f64 = 0.004;

/// About so many cells are quartered for one pool of lamp light at most.
const POOL: usize = 8192;

/// The fewest ways through a gap.
const FEWEST: usize = 8;

/// How often a ray is sent another way in its cell, for want of one that does not go through a gap.
const TURNS: usize = 4;

/// What outlines are drawn between.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Dark,
    Sky,
    Ground,
}

/// A cell's level, and its place there.
type Place = (u32, u32, u32);

/// A cell: its level and place there, what its ray has met, and the first of its quarters, 0 for none.
struct Square {
    at: Place,
    kind: Kind,
    quarters: u32,
    arrival: Arrival,
    /// Of surfaces before that which let a part of the light through.
    before: Vec<Arrival>,
}

/// All cells of one place: the first n x n are the coarsest, row by row.
struct View {
    n: u32,
    /// Whether what lies along the border of the square is worth a look: the strip of wall between a window and the horizon.
    is_edge: bool,
    squares: Vec<Square>,
}

impl View {
    /// The cell without quarters at a place of a level, or the one of that level.
    fn leaf(&self, level: u32, i: u32, j: u32) -> u32 {
        let mut at = (j >> level) * self.n + (i >> level);
        for up in (0..level).rev() {
            let quarters = self.squares[at as usize].quarters;
            if quarters == 0 {
                break;
            }
            at = quarters + ((i >> up) & 1) + 2 * ((j >> up) & 1);
        }
        at
    }

    /// The cells beside one, of its own level or coarser; one of its own level may have quarters.
    fn beside(&self, square: u32) -> impl Iterator<Item = u32> + '_ {
        let (level, i, j) = self.squares[square as usize].at;
        let side = self.n << level;
        let places = [
            (i > 0).then(|| (i - 1, j)),
            (i + 1 < side).then_some((i + 1, j)),
            (j > 0).then(|| (i, j - 1)),
            (j + 1 < side).then_some((i, j + 1)),
        ];
        places
            .into_iter()
            .flatten()
            .map(move |(i, j)| self.leaf(level, i, j))
    }

    /// The cells of a level that differ from one beside them.
    fn outline(&self, level: u32) -> Vec<u32> {
        (0..self.squares.len() as u32)
            .filter(|square| {
                let own = &self.squares[*square as usize];
                own.at.0 == level
                    && own.quarters == 0
                    && (own.kind != Kind::Dark && self.is_edge && self.is_border(own.at)
                        || self
                            .beside(*square)
                            .any(|other| self.holds_other(other, own.kind)))
            })
            .collect()
    }

    /// Whether a cell lies along the border of the square.
    fn is_border(&self, (level, i, j): Place) -> bool {
        let last = (self.n << level) - 1;
        i == 0 || j == 0 || i == last || j == last
    }

    /// Whether there is anything of another kind in a cell.
    fn holds_other(&self, square: u32, kind: Kind) -> bool {
        let square = &self.squares[square as usize];
        match square.quarters {
            0 => square.kind != kind,
            first => (first..first + 4).any(|quarter| self.holds_other(quarter, kind)),
        }
    }

    /// Adds a cell and those beside it to `open` where they differ.
    fn differing(&self, square: u32, open: &mut Vec<u32>) {
        let kind = self.squares[square as usize].kind;
        let mut differs = false;
        for other in self.beside(square) {
            if self.holds_other(other, kind) {
                differs = true;
                if self.squares[other as usize].quarters == 0 {
                    open.push(other);
                }
            }
        }
        if differs {
            open.push(square);
        }
    }

    /// The weight of all that is bright.
    fn bright(&self) -> f64 {
        let bright = |s: &&Square| s.quarters == 0 && s.kind != Kind::Dark;
        let shares = self.squares.iter().filter(bright);
        shares.map(|square| f64::from(square.arrival.share)).sum()
    }
}

/// Where in a cell its ray goes, 0 to 1: another place in each, the same at every point. If that will not do, the next of some.
fn within_cell(level: u32, i: u32, j: u32, turn: usize) -> [f64; 2] {
    let [x, y, ..] = spread(
        turn,
        u64::from(level) << 56 | u64::from(i) << 28 | u64::from(j),
    );
    [x, y]
}

/// Whether a direction leads through one of some gaps.
fn is_through(gaps: &[(&Gap, Vec<Way>)], origin: DVec3, direction: DVec3) -> bool {
    let ray = Ray { origin, direction };
    gaps.iter().any(|(gap, _)| gap.is_on(&ray))
}

impl Transport {
    /// What a point of the air receives from all directions; the solid angles sum to 4 pi, but for those of surfaces that let a part
    /// of the light through, which come on top.
    pub fn around(&self, point: DVec3, care: Care) -> Vec<Arrival> {
        self.gather(point, &Map::Sphere, care)
    }

    /// What a surface receives at a point; the shares sum to 1. `normal` is that of the cosine law, `facet` the side on which
    /// the point is.
    pub fn before(&self, point: DVec3, normal: DVec3, facet: DVec3) -> Vec<Arrival> {
        let origin = point + self.near(point) * facet;
        self.gather(origin, &Map::before(normal), self.detail.care)
    }

    pub(super) fn gather(&self, origin: DVec3, map: &Map, care: Care) -> Vec<Arrival> {
        let n = (care.rays as f64).sqrt().round().max(2.0) as u32;
        let whole = map.whole();
        let look_along = |toward: DVec3, share: f64| {
            let ray = Ray {
                origin,
                direction: toward,
            };
            let (look, part, before) = self.look_through(&ray, map.width(share, toward));
            let arrival = |look: &Look, part: f64| {
                let whole = Arrival {
                    toward: toward.as_vec3(),
                    share: share as f32,
                    through: look.through,
                    source: look.source,
                };
                whole.weakened(map, part)
            };
            let before = before.iter().map(|(look, part)| arrival(look, *part));
            (arrival(&look, part), before.collect())
        };
        let see = |level: u32, i: u32, j: u32, beside: &[(&Gap, Vec<Way>)]| {
            let side = f64::from(n << level);
            // What is seen through gaps is looked at by itself.
            let toward = |turn| {
                let [x, y] = within_cell(level, i, j, turn);
                map.toward((f64::from(i) + x) / side, (f64::from(j) + y) / side)
            };
            let is_beside = |toward: &DVec3| !is_through(beside, origin, *toward);
            let mut others = (0..TURNS).map(toward).filter(is_beside);
            let (toward, share) = match others.next() {
                Some(other) => (other, whole / (side * side)),
                None => (toward(0), 0.0),
            };
            let (arrival, before) = look_along(toward, share);
            Square {
                at: (level, i, j),
                kind: match share > 0.0 {
                    true => self.kind(arrival.source),
                    false => Kind::Dark,
                },
                quarters: 0,
                arrival,
                before,
            }
        };
        let mut view = View {
            n,
            is_edge: false,
            squares: (0..n * n).map(|k| see(0, k % n, k / n, &[])).collect(),
        };
        let gaps = self.gaps_before(origin, map, &view, care);
        if !gaps.is_empty() {
            for square in &mut view.squares {
                let (_, i, j) = square.at;
                if is_through(&gaps, origin, square.arrival.toward.as_dvec3()) {
                    *square = see(0, i, j, &gaps);
                }
            }
        }
        view.is_edge = matches!(map, Map::Cosine(_)) && view.bright() < 0.5;
        let mut places = self.places(origin, map, &view, care);
        if !gaps.is_empty() {
            places.retain(|[x, y]| !is_through(&gaps, origin, map.toward(*x, *y)));
        }
        let quarter = |view: &mut View, leaf: u32| {
            let first = view.squares.len() as u32;
            let (own, i, j) = view.squares[leaf as usize].at;
            view.squares[leaf as usize].quarters = first;
            for quarter in 0..4 {
                let (i, j) = (2 * i + quarter % 2, 2 * j + quarter / 2);
                view.squares.push(see(own + 1, i, j, &gaps));
            }
            first
        };
        for level in 0..LEVELS[1] {
            let mut open: Vec<u32> = match level < LEVELS[0] {
                true => view.outline(level),
                false => Vec::new(),
            };
            // A cell that an outline crosses is off by 0.29 of its weight on average.
            let weight = whole / f64::from(n << level).powi(2);
            let error = |cells: usize| 0.29 * weight * (cells as f64).sqrt();
            let bright = view.bright();
            if error(open.len()) < care.outline * (bright + DIM * whole) {
                open.clear();
            }
            // Openings count even where they are all the light that there is.
            if error(places.len()) < care.outline * bright {
                places.clear();
            }
            // Outlines are followed wherever they go, else what chance has missed of them would always err to one side.
            let outlined = !open.is_empty();
            let seek = |view: &View, [x, y]: &[f64; 2]| {
                let side = f64::from(n << LEVELS[1]);
                view.leaf(LEVELS[1], (x * side) as u32, (y * side) as u32)
            };
            places.retain(|at| {
                let leaf = seek(&view, at);
                let Square { at, kind, .. } = view.squares[leaf as usize];
                // What is found of an opening counts as exactly as what was missed of it: else chance would err to one side.
                let wanted = kind == Kind::Dark
                    || level < LEVELS[0]
                        && view.beside(leaf).any(|other| view.holds_other(other, kind));
                if wanted && at.0 == level {
                    open.push(leaf);
                }
                wanted
            });
            if open.is_empty() {
                break;
            }
            while let Some(leaf) = open.pop() {
                let Square { at, quarters, .. } = view.squares[leaf as usize];
                if quarters != 0 || at.0 > level {
                    continue;
                }
                let first = quarter(&mut view, leaf);
                if outlined {
                    for quarter in first..first + 4 {
                        view.differing(quarter, &mut open);
                    }
                }
            }
        }
        for pool in looked_at(&self.pools, &self.conditions.geometry, origin, map) {
            let most = view.squares.len() + POOL;
            for level in 0..LEVELS[1] {
                let weight = whole / f64::from(n << level).powi(2);
                if weight <= pool.weight || view.squares.len() > most {
                    break;
                }
                let is_on = |square: &Square| {
                    let toward = square.arrival.toward.as_dvec3();
                    square.at.0 == level
                        && square.quarters == 0
                        && pool.holds(toward, map.width(weight, toward))
                };
                for leaf in 0..view.squares.len() {
                    if is_on(&view.squares[leaf]) {
                        quarter(&mut view, leaf as u32);
                    }
                }
            }
        }
        // Cells all of whose rays would go through gaps stand for nothing.
        let is_empty = |s: &&Square| s.quarters == 0 && s.arrival.share == 0.0;
        let empty = view.squares.iter().filter(is_empty);
        let empty: f64 = empty.map(|s| whole / f64::from(n << s.at.0).powi(2)).sum();
        let leaves = view.squares.into_iter().filter(|s| s.quarters == 0);
        let all = leaves.flat_map(|square| square.before.into_iter().chain([square.arrival]));
        let mut all: Vec<Arrival> = all.collect();
        let ways = gaps.iter().flat_map(|(_, ways)| ways);
        let through: f64 = ways.clone().map(|way| way.weight).sum();
        if through > 0.0 {
            let rest = ((whole - through) / (whole - empty)) as f32;
            all.iter_mut().for_each(|arrival| arrival.share *= rest);
        }
        for way in ways {
            let (arrival, before) = look_along(way.toward, way.weight);
            let before: Vec<Arrival> = before;
            all.extend(before.into_iter().chain([arrival]));
        }
        all
    }

    /// The small gaps that a place looks through, and by which ways: those none of which stands for more than a
    /// ray, and that give some of the light.
    fn gaps_before(
        &self,
        origin: DVec3,
        map: &Map,
        view: &View,
        care: Care,
    ) -> Vec<(&Gap, Vec<Way>)> {
        let all = self.gaps.iter().filter(|gap| gap.is_seen_from(origin));
        let all: Vec<&Gap> = all.collect();
        if all.is_empty() {
            return Vec::new();
        }
        let chance = |square: &&Square| {
            let ray = Ray {
                origin,
                direction: square.arrival.toward.as_dvec3(),
            };
            square.kind != Kind::Dark && !all.iter().any(|gap| gap.is_on(&ray))
        };
        let bright = view.squares.iter().filter(chance);
        let bright: f64 = bright.map(|square| f64::from(square.arrival.share)).sum();
        // A room that is lit otherwise has light of its own.
        let is_lit = |square: &Square| match square.arrival.source {
            Source::Patch(patch, _) => self.by_gaps.get(patch as usize) != Some(&true),
            _ => false,
        };
        let dim = match view.squares.iter().any(is_lit) {
            true => DIM * map.whole(),
            false => 0.0,
        };
        let least = 0.05 * care.outline * (bright + dim);
        let rays = view.squares.len();
        let mut used: Vec<(&Gap, f64)> = all
            .iter()
            .map(|gap| (*gap, gap.most(origin, map)))
            .collect();
        used.retain(|(_, most)| *most > least);
        used.sort_by(|a, b| b.1.total_cmp(&a.1));
        used.truncate((rays / FEWEST).max(1));
        let count = (rays / 2 / used.len().max(1)).max(FEWEST);
        // Of two gaps one behind the other the smaller one says more of what is seen.
        let ways = used
            .into_iter()
            .rev()
            .map(|(gap, _)| (gap, gap.ways(origin, map, count)));
        let is_small = |(_, ways): &(&Gap, Vec<Way>)| {
            let weight: f64 = ways.iter().map(|way| way.weight).sum();
            let most = ways.iter().map(|way| way.weight).fold(0.0, f64::max);
            weight > least && most < map.whole() / rays as f64
        };
        let mut gaps: Vec<(&Gap, Vec<Way>)> = ways.filter(is_small).collect();
        // A way through two gaps, one behind the other, is one.
        for behind in 1..gaps.len() {
            let (before, rest) = gaps.split_at_mut(behind);
            let is_other = |way: &Way| !is_through(before, origin, way.toward);
            rest[0].1.retain(is_other);
        }
        gaps
    }

    /// Places in the square where there are openings.
    fn places(&self, origin: DVec3, map: &Map, view: &View, care: Care) -> Vec<[f64; 2]> {
        let n = view.n;
        let mut places = Vec::new();
        // What would be seen through an opening is about the square of the openings' distance from each other, over that of their
        // distance from here.
        let known = view.bright() + DIM * map.whole();
        let least = (0.05 * care.outline * known / map.whole() * PI).max(f64::MIN_POSITIVE);
        let farthest = self.openings.size / least.sqrt();
        for opening in self.openings.all() {
            let way = *opening - origin;
            if way.length() > farthest {
                continue;
            }
            let Some(direction) = way.try_normalize() else {
                continue;
            };
            let Some([x, y]) = map.place(direction) else {
                continue;
            };
            let at = [x, y].map(|at| at.clamp(0.0, 1.0 - 1e-12));
            let [i, j] = at.map(|at| (at * f64::from(n)) as u32);
            let is_seen = view.squares[(j * n + i) as usize].kind != Kind::Dark;
            let ray = Ray { origin, direction };
            let is_free = || {
                let geometry = &self.conditions.geometry;
                !geometry.occluded(&ray, 0.0, 0.999 * way.length())
            };
            if is_seen || is_free() && self.is_bright(self.look(&ray, WHOLE).source) {
                places.push(at);
            }
        }
        places
    }

    /// Points in openings, as they are seen before a surface: where a direction is free and the next one is blocked, the free ray
    /// where the farthest of those beside it ends. `None` from a place that sees much of the outside.
    pub(super) fn openings_before(&self, point: DVec3, normal: DVec3) -> Option<Vec<DVec3>> {
        const SIDE: usize = 16;
        let origin = point + self.near(point) * normal;
        let map = Map::before(normal);
        let looks: Vec<(DVec3, Look)> = (0..SIDE * SIDE)
            .map(|k| {
                let (i, j) = (k % SIDE, k / SIDE);
                let [x, y] = within_cell(0, i as u32, j as u32, 0);
                let at = |i: usize, x: f64| (i as f64 + x) / SIDE as f64;
                let direction = map.toward(at(i, x), at(j, y));
                (direction, self.look(&Ray { origin, direction }, WHOLE))
            })
            .collect();
        let free = |k: usize| self.is_bright(looks[k].1.source);
        let count = (0..looks.len()).filter(|k| free(*k)).count();
        if 2 * count > looks.len() {
            return None;
        }
        let mut points = Vec::new();
        for k in (0..looks.len()).filter(|k| free(*k)) {
            let beside = [
                (k % SIDE > 0).then(|| k - 1),
                (k % SIDE + 1 < SIDE).then_some(k + 1),
                k.checked_sub(SIDE),
                Some(k + SIDE).filter(|k| *k < looks.len()),
            ];
            let blocked = beside.into_iter().flatten().filter(|k| !free(*k));
            let far = blocked
                .map(|other| looks[other].1.distance)
                .fold(0.0, f64::max);
            if far > 0.0 && far.is_finite() {
                points.push(origin + far * looks[k].0);
            }
        }
        Some(points)
    }

    /// What outlines are drawn between: surfaces, the sky, the ground outside.
    fn kind(&self, source: Source) -> Kind {
        match source {
            Source::Sky(_) => Kind::Sky,
            other if self.is_bright(other) => Kind::Ground,
            _ => Kind::Dark,
        }
    }
}
