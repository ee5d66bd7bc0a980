//! Small gaps in planes: pinholes, slits, what is left open between two panels.
//!
//! Chance does not find them, and where it does, one ray stands for far more than the gap. They are found by what of a plane no
//! triangle covers. Places that see one take points all over it, each with its own form factor, in the stead of their other rays
//! that way. Gaps between things that have no plane in common, and holes in masked textures, are found by chance alone.

use super::arrival::{Map, Source, spread};
use super::cells::{Face, area, clip, holds};
use super::planes::Plane;
use crate::error::Result;
use crate::scene::Ray;
use crate::task::Task;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// A gap is small up to this share of the surface around it [1]: what is larger, rays find.
const SMALL: f64 = 2e-3;

/// What is narrower than this share of its plane is rounding [1].
const NARROW: f64 = 1e-5;

/// Less than this share of the surface around it is nothing [1].
const NOTHING: f64 = 1e-8;

/// The most gaps that are looked through, the largest.
const MOST: usize = 256;

/// The most points of a gap that are looked through.
const POINTS: usize = 256;

/// Rays from a gap by which it is found who may see it, on each side.
const RAYS: usize = 256;

/// How many of these meet no surface where it lies open.
const OPEN: usize = RAYS / 4;

/// A plane that leaves open more polygons is too finely cut to be looked at.
const MANY: usize = 1 << 16;

type Polygon = Vec<DVec2>;

/// A small gap in a plane.
pub(super) struct Gap {
    plane: Plane,
    polygons: Vec<Polygon>,
    /// What it leaves open [m2].
    pub area: f64,
    middle: DVec3,
    /// How far it reaches from its middle [m].
    radius: f64,
    /// Points all over it: of any first few too.
    points: Vec<DVec3>,
    /// The box around what sees it, behind it and before it.
    seen_from: [(DVec3, DVec3); 2],
}

/// A way through a gap: toward where, and how much it stands for, in the units of a [`Map`].
pub(super) struct Way {
    pub toward: DVec3,
    pub weight: f64,
}

impl Gap {
    fn new(plane: &Plane, polygons: Vec<Polygon>) -> Self {
        let mut until = Vec::new();
        let mut whole = 0.0;
        let mut middle = DVec2::ZERO;
        for polygon in &polygons {
            for k in 1..polygon.len() - 1 {
                let corners = [polygon[0], polygon[k], polygon[k + 1]];
                let size = area(&corners);
                middle += size * (corners[0] + corners[1] + corners[2]) / 3.0;
                whole += size;
                until.push((corners, whole));
            }
        }
        middle /= whole;
        let reach = |polygon: &Polygon| {
            polygon
                .iter()
                .map(|p| p.distance(middle))
                .fold(0.0, f64::max)
        };
        let radius = polygons.iter().map(reach).fold(0.0, f64::max);
        let point = |i| {
            let [x, y, z, ..] = spread(i, 0);
            let at = until.partition_point(|(_, until)| *until <= x * whole);
            let ([a, b, c], _) = until[at.min(until.len() - 1)];
            let root = y.sqrt();
            plane.point(a + root * (1.0 - z) * (b - a) + root * z * (c - a))
        };
        Gap {
            points: (0..POINTS).map(point).collect(),
            middle: plane.point(middle),
            plane: plane.clone(),
            area: whole,
            seen_from: [(DVec3::INFINITY, DVec3::NEG_INFINITY); 2],
            polygons,
            radius,
        }
    }

    /// On which side a place is: behind it or before it.
    fn side(&self, place: DVec3) -> usize {
        usize::from((place - self.middle).dot(self.plane.normal) > 0.0)
    }

    /// Whether a place may see it.
    pub fn is_seen_from(&self, place: DVec3) -> bool {
        let (low, high) = self.seen_from[self.side(place)];
        place.cmpge(low).all() && place.cmple(high).all()
    }

    /// Whether a ray goes through it, if it goes that far.
    pub fn is_on(&self, ray: &Ray) -> bool {
        let distance = (self.middle - ray.origin).dot(self.plane.normal)
            / ray.direction.dot(self.plane.normal);
        if distance <= 0.0 || !distance.is_finite() {
            return false;
        }
        let point = ray.at(distance);
        point.distance_squared(self.middle) <= 1.001 * self.radius * self.radius && {
            let at = self.plane.flat(point);
            self.polygons.iter().any(|polygon| holds(polygon, at))
        }
    }

    /// The most that it can be of what a place sees, in the units of a map.
    pub fn most(&self, place: DVec3, map: &Map) -> f64 {
        let distance = place.distance(self.middle) - self.radius;
        let square = distance.max(0.0).powi(2);
        let whole = match map {
            Map::Sphere => 1.0,
            Map::Cosine(_) => PI,
        };
        self.area / (whole * square)
    }

    /// Ways through it from a place, by so many of its points.
    pub fn ways(&self, place: DVec3, map: &Map, count: usize) -> Vec<Way> {
        let count = count.clamp(1, POINTS);
        let way = |point: &DVec3| {
            let way = *point - place;
            let square = way.length_squared();
            let toward = way / square.sqrt();
            let facing = match map {
                Map::Sphere => 1.0,
                Map::Cosine([.., normal]) => toward.dot(*normal).max(0.0) / PI,
            };
            let across = toward.dot(self.plane.normal).abs();
            let weight = self.area / count as f64 * across * facing / square;
            Way { toward, weight }
        };
        let ways = self.points[..count].iter().map(way);
        ways.filter(|way| way.weight > 0.0 && way.weight.is_finite())
            .collect()
    }

    /// Rays that leave it on one side by the cosine law.
    pub fn rays(&self, side: usize, near: f64) -> impl Iterator<Item = Ray> + '_ {
        let normal = match side {
            0 => -self.plane.normal,
            _ => self.plane.normal,
        };
        let map = Map::before(normal);
        (0..RAYS).map(move |i| {
            let [.., x, y] = spread(i, side as u64);
            Ray {
                origin: self.points[i % POINTS] + near * normal,
                direction: map.toward(x, y),
            }
        })
    }

    /// Learns who may see it, from what its rays meet: sources and how far they are [m]. All of them; `None` if it lies open on both
    /// sides, and little depends on it.
    pub fn look(&mut self, meet: impl Fn(&Ray) -> (Source, f64), near: f64) -> Option<Vec<Source>> {
        let mut all = Vec::new();
        let mut is_closed = false;
        for side in 0..2 {
            let mut free = 0;
            let (mut low, mut high) = (self.middle, self.middle);
            for ray in self.rays(side, near) {
                let (source, distance) = meet(&ray);
                let end = match distance.is_finite() {
                    true => ray.at(distance),
                    false => f64::INFINITY * ray.direction.signum(),
                };
                (low, high) = (low.min(end), high.max(end));
                free += usize::from(!matches!(source, Source::Patch(..)));
                all.push(source);
            }
            is_closed |= free < OPEN;
            // Rays are few: what they meet ends somewhat farther.
            let slack = 0.1 * (high - low) + self.radius;
            self.seen_from[side] = (low - slack, high + slack);
        }
        all.sort_unstable();
        all.dedup();
        is_closed.then_some(all)
    }
}

/// The small gaps of some planes, given by one face each.
pub(super) fn gaps<'f>(faces: impl Iterator<Item = &'f Face>, task: Task<'_>) -> Result<Vec<Gap>> {
    let faces: Vec<&Face> = faces.collect();
    let pieces = task.pieces(faces.len());
    let found: Result<Vec<Vec<Gap>>> = faces
        .into_par_iter()
        .map(|face| {
            pieces.begin()?;
            Ok(of_plane(face))
        })
        .collect();
    let mut gaps: Vec<Gap> = found?.into_iter().flatten().collect();
    gaps.sort_by(|a, b| b.area.total_cmp(&a.area));
    gaps.truncate(MOST);
    Ok(gaps)
}

fn of_plane(face: &Face) -> Vec<Gap> {
    let plane = &face.plane;
    let extent = plane.extent();
    let mut open = Vec::new();
    for (low, side, pieces) in face.squares() {
        let [low, high] = [low, low + side].map(|p| p.clamp(plane.low, plane.high));
        uncovered(low, high, pieces, 0, NARROW * extent, &mut open);
        if open.len() > MANY {
            return Vec::new();
        }
    }
    let size = plane.high - plane.low;
    let covered = size.x * size.y - open.iter().map(|polygon| area(polygon)).sum::<f64>();
    let small = |polygons: &Vec<Polygon>| {
        let size: f64 = polygons.iter().map(|polygon| area(polygon)).sum();
        let points = polygons.iter().flatten();
        let (low, high) = points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| {
            (l.min(*p), h.max(*p))
        });
        size <= SMALL * covered
            && size >= NOTHING * covered
            && size >= NARROW * extent * (high - low).length()
    };
    let mut gaps = together(open, NARROW * extent);
    gaps.retain(small);
    gaps.into_iter().map(|gap| Gap::new(plane, gap)).collect()
}

/// Adds what of a rectangle some convex pieces leave open, where it is wider than `narrow` [m].
fn uncovered(
    low: DVec2,
    high: DVec2,
    pieces: Vec<Polygon>,
    depth: u32,
    narrow: f64,
    open: &mut Vec<Polygon>,
) {
    let size = high - low;
    if size.min_element() <= 0.0 {
        return;
    }
    let square = vec![
        low,
        DVec2::new(high.x, low.y),
        high,
        DVec2::new(low.x, high.y),
    ];
    let tiny = 1e-14 * size.x * size.y;
    // So few that it costs less to take one after the other.
    const FEW: usize = 24;
    const DEPTH: u32 = 12;
    if pieces.len() > FEW && depth < DEPTH {
        let middle = 0.5 * (low + high);
        for quarter in 0..4 {
            let pick = |upper: bool, low: f64, middle: f64, high: f64| match upper {
                true => (middle, high),
                false => (low, middle),
            };
            let (left, right) = pick(quarter % 2 == 1, low.x, middle.x, high.x);
            let (lower, upper) = pick(quarter / 2 == 1, low.y, middle.y, high.y);
            let (low, high) = (DVec2::new(left, lower), DVec2::new(right, upper));
            let inside = pieces
                .iter()
                .map(|piece| super::cells::within(piece, low, high));
            let inside = inside.filter(|piece| area(piece) > tiny).collect();
            uncovered(low, high, inside, depth + 1, narrow, open);
        }
        return;
    }
    let mut rest = vec![square];
    for piece in &pieces {
        let mut left = Vec::with_capacity(rest.len());
        for polygon in rest {
            without(polygon, piece, [tiny, narrow], &mut left);
        }
        rest = left;
        if rest.is_empty() {
            return;
        }
    }
    open.extend(rest);
}

/// Adds what of a convex polygon another one leaves open, as convex polygons.
fn without(polygon: Polygon, piece: &[DVec2], [tiny, narrow]: [f64; 2], open: &mut Vec<Polygon>) {
    let middle = piece.iter().copied().sum::<DVec2>() / piece.len() as f64;
    let mut outside = Vec::new();
    let mut rest = polygon.clone();
    for (i, a) in piece.iter().enumerate() {
        let way = piece[(i + 1) % piece.len()] - *a;
        // The direction of so short an edge is rounding.
        if way.length() <= 1e-3 * narrow {
            continue;
        }
        let outward = match way.perp().dot(middle - *a) > 0.0 {
            true => -way.perp(),
            false => way.perp(),
        };
        let distance = outward.dot(*a);
        let beyond = clip(&rest, -outward, -distance);
        if area(&beyond) > tiny {
            outside.push(beyond);
        }
        rest = clip(&rest, outward, distance);
        if area(&rest) <= tiny {
            open.push(polygon);
            return;
        }
    }
    open.extend(outside);
}

/// Sorts polygons by what is connected.
fn together(polygons: Vec<Polygon>, slack: f64) -> Vec<Vec<Polygon>> {
    let bounds = |polygon: &Polygon| {
        let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        polygon
            .iter()
            .fold(none, |(l, h), p| (l.min(*p), h.max(*p)))
    };
    let mut all: Vec<_> = polygons
        .into_iter()
        .map(|polygon| (bounds(&polygon), polygon))
        .collect();
    all.sort_by(|a, b| a.0.0.x.total_cmp(&b.0.0.x));
    let mut parent: Vec<usize> = (0..all.len()).collect();
    let root = |parent: &mut [usize], mut i: usize| {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    };
    for (i, ((low, high), polygon)) in all.iter().enumerate() {
        for (j, ((other_low, other_high), other)) in all.iter().enumerate().skip(i + 1) {
            if other_low.x > high.x + slack {
                break;
            }
            if other_low.y > high.y + slack || other_high.y < low.y - slack {
                continue;
            }
            let (one, two) = (root(&mut parent, i), root(&mut parent, j));
            if one != two && touch(polygon, other, slack) {
                parent[two] = one;
            }
        }
    }
    let mut gaps: Vec<Vec<Polygon>> = all.iter().map(|_| Vec::new()).collect();
    for (i, (_, polygon)) in all.into_iter().enumerate() {
        gaps[root(&mut parent, i)].push(polygon);
    }
    gaps.retain(|gap| !gap.is_empty());
    gaps
}

/// Whether no edge of one of two convex polygons has all of the other one beyond it.
fn touch(a: &[DVec2], b: &[DVec2], slack: f64) -> bool {
    let parts = |a: &[DVec2], b: &[DVec2]| {
        let middle = a.iter().copied().sum::<DVec2>() / a.len() as f64;
        (0..a.len()).any(|i| {
            let Some(along) = (a[(i + 1) % a.len()] - a[i]).try_normalize() else {
                return false;
            };
            let outward = match along.perp().dot(middle - a[i]) > 0.0 {
                true => -along.perp(),
                false => along.perp(),
            };
            b.iter().all(|p| outward.dot(*p - a[i]) > slack)
        })
    };
    !parts(a, b) && !parts(b, a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(low: [f64; 2], high: [f64; 2]) -> Polygon {
        let ([a, b], [c, d]) = (low, high);
        [[a, b], [c, b], [c, d], [a, d]]
            .map(DVec2::from_array)
            .to_vec()
    }

    #[test]
    fn what_pieces_leave_open_is_found_whole() {
        // Four panels around a hole, one of them lying on another, and a slit beside them.
        let pieces = vec![
            rectangle([0.0, 0.0], [0.9, 0.5]),
            rectangle([0.0, 0.51], [0.9, 1.0]),
            rectangle([0.0, 0.4], [0.4, 0.6]),
            rectangle([0.42, 0.4], [0.9, 0.6]),
            rectangle([0.901, 0.0], [1.0, 1.0]),
        ];
        let mut open = Vec::new();
        uncovered(DVec2::ZERO, DVec2::ONE, pieces, 0, 1e-6, &mut open);
        let gaps = together(open, 1e-9);
        let mut areas: Vec<f64> = gaps
            .iter()
            .map(|gap| gap.iter().map(|p| area(p)).sum())
            .collect();
        areas.sort_by(f64::total_cmp);
        assert_eq!(areas.len(), 2);
        assert!((areas[0] - 0.02 * 0.01).abs() < 1e-12, "{areas:?}");
        assert!((areas[1] - 0.001).abs() < 1e-12, "{areas:?}");
    }
}
