//! Light between the points where it was looked at: lattices on surfaces that are refined where light changes.
//!
//! On a plane each part of a cell has its rectangle, with what the corners receive; a rectangle whose middle receives otherwise than
//! its corners say is quartered. Points are fixed on the surface, whoever looks, so that nothing moves with the camera; they are looked
//! at when a picture needs them, and what they have seen serves other moments too. Small and bent triangles have their corners'
//! light.
//!
//! What lies right under something else ([`super::cover`]: a floor under its carpet, one sheet of a terrain where it dips below the other) is
//! dark, and says nothing of the open surface beside it: open places are interpolated between open points alone, covered ones between
//! covered ones. An open place among points that are all covered is looked at itself.

use super::arrival::{Arrival, Row, Source, merge};
use super::cells::{Face, Part};
use super::light::Light;
use super::planes::Home;
use super::points::{Factors, Point, Sight};
use super::shards::Shards;
use super::transport::Transport;
use crate::colour::luminance;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::PI;
use std::sync::OnceLock;
use std::sync::atomic::Ordering;

/// What a place receives straight from the sky, and from surfaces [lx, RGB].
pub type Received = [DVec3; 2];

/// The light of a moment on surfaces.
pub struct Lattice {
    /// By patch.
    parts: Vec<OnceLock<Box<Node>>>,
    /// By triangle and side.
    bent: Shards<(u32, bool), [Known; 3]>,
    open_ground: Received,
    tolerance: f64,
    depth: u32,
}

/// What is known of a point.
#[derive(Clone, Copy)]
struct Known {
    received: Received,
    /// Whether something lies right upon it.
    is_covered: bool,
}

/// A rectangle of a part.
struct Node {
    low: DVec2,
    high: DVec2,
    depth: u32,
    corners: [Known; 4],
    /// Those that were asked for, if it is divided.
    quarters: OnceLock<Option<Box<[OnceLock<Node>; 4]>>>,
}

/// What points have seen is kept up to so many bytes; beyond, it is found anew for each moment.
const MOST_BYTES: u64 = 1 << 30;

/// How far from borders points stay, over the size of a cell.
const INSET: f64 = 2e-3;

/// How far around a point of a plane is looked for what may cover it, over the size of the finest rectangles there: what is as near as
/// they are wide shades less than them, and covers; what is farther away than that is drawn, and a corridor is none of it.
const REACH: f64 = 3.0;

/// Two points of a face that are nearer to each other are one, over the size of the face.
const SAME: f64 = 1e-6;

impl Lattice {
    /// One on which nothing is known yet; rectangles whose middle is off by less than `tolerance` of its light are not divided, none
    /// more often than `depth` times.
    pub fn new(transport: &Transport, light: &Light, tolerance: f64, depth: u32) -> Self {
        Lattice {
            parts: std::iter::repeat_with(OnceLock::new)
                .take(transport.patches.all.len())
                .collect(),
            bent: Shards::new(),
            open_ground: light.on_open_ground(),
            tolerance,
            depth,
        }
    }

    /// What a triangle receives at a point on one side, by the weights of its second and third vertex; `facet` is its normal on that side.
    pub fn on_triangle(
        &self,
        transport: &Transport,
        light: &Light,
        triangle: u32,
        [v, w]: [f64; 2],
        facet: DVec3,
        position: DVec3,
    ) -> Received {
        let [a, b, c] = transport.conditions.scene.mesh.corners(triangle);
        let outward = (b - a).cross(c - a);
        let front = outward.dot(facet) >= 0.0;
        if let Home::Plane(plane, is_front) = transport.patches.homes[triangle as usize]
            && !transport.patches.is_bent(triangle)
        {
            let face = 2 * plane + u32::from(front != is_front);
            if let Some(received) = self.on_face(transport, light, face, position) {
                return received;
            }
        }
        let place = self.bent.place((triangle, front));
        let corners = place.get_or_init(|| {
            [0, 1, 2].map(|corner| transport.at_corner(light, triangle, corner, front))
        });
        let reach = transport.reach(triangle);
        let is_covered = || transport.is_covered(position, facet, reach);
        let gathered = || {
            let normal = transport.normal(triangle, [v, w], facet);
            light.given_by(&transport.factors(position, normal, facet))
        };
        between(corners, [1.0 - v - w, v, w], is_covered, gathered)
            .map(|received| received.max(DVec3::ZERO))
    }

    /// What the ground receives at a point.
    pub fn on_ground(&self, transport: &Transport, light: &Light, position: DVec3) -> Received {
        let face = transport.patches.faces.len() as u32 - 1;
        self.on_face(transport, light, face, position)
            .unwrap_or(self.open_ground)
    }

    fn on_face(
        &self,
        transport: &Transport,
        light: &Light,
        face: u32,
        position: DVec3,
    ) -> Option<Received> {
        let of = &transport.patches.faces[face as usize];
        let at = of.plane.flat(position);
        let (_, cell) = of.cell(at)?;
        let part = cell.part(at)?;
        let look = Look {
            transport,
            light,
            face,
            of,
            part,
            side: cell.side,
            depth: self.depth,
        };
        let root = &self.parts[part.patch as usize];
        let mut node = &**root.get_or_init(|| Box::new(look.node(part.low, part.high, 0)));
        loop {
            let quarters = node
                .quarters
                .get_or_init(|| look.bends(node, self.tolerance).then(Box::default));
            let Some(quarters) = quarters else {
                let point = of.plane.point(at);
                let is_covered = || look.is_covered(at);
                let gathered = || {
                    let normal = of.plane.normal;
                    light.given_by(&transport.factors(point, normal, normal))
                };
                let weights = node.weights(at);
                return Some(between(&node.corners, weights, is_covered, gathered));
            };
            let middle = 0.5 * (node.low + node.high);
            let upper = [at.x >= middle.x, at.y >= middle.y];
            let quarter = &quarters[usize::from(upper[0]) + 2 * usize::from(upper[1])];
            node = quarter.get_or_init(|| look.quarter(node, upper));
        }
    }
}

/// What a place receives between points: interpolated between those that are covered as it is. An open place among covered points is
/// `gathered`; a covered one among open points is darker than they say, but hardly seen.
fn between<const N: usize>(
    points: &[Known; N],
    weights: [f64; N],
    is_covered: impl FnOnce() -> bool,
    gathered: impl FnOnce() -> Received,
) -> Received {
    let covered = points.iter().filter(|point| point.is_covered).count();
    let own = covered > 0 && is_covered();
    if covered == N && !own {
        return gathered();
    }
    let is_mixed = covered > 0 && covered < N;
    let counted = |(point, weight): (&Known, f64)| match is_mixed {
        false => weight,
        // One corner may speak for all of it, up to where it has no weight.
        true if point.is_covered == own => weight.max(1e-6),
        true => 0.0,
    };
    let weights = points.iter().zip(weights).map(counted);
    let mut sum = [DVec3::ZERO; 2];
    let mut whole = 0.0;
    for (point, weight) in points.iter().zip(weights) {
        whole += weight;
        for (sum, received) in sum.iter_mut().zip(point.received) {
            *sum += weight * received;
        }
    }
    match is_mixed {
        true => sum.map(|sum| sum / whole),
        false => sum,
    }
}

impl Node {
    /// The weights of the corners at a place.
    fn weights(&self, at: DVec2) -> [f64; 4] {
        let size = (self.high - self.low).max(DVec2::splat(f64::MIN_POSITIVE));
        let f = ((at - self.low) / size).clamp(DVec2::ZERO, DVec2::ONE);
        let g = DVec2::ONE - f;
        [g.x * g.y, f.x * g.y, g.x * f.y, f.x * f.y]
    }
}

/// One part of a cell under one light.
struct Look<'a> {
    transport: &'a Transport,
    light: &'a Light,
    face: u32,
    of: &'a Face,
    part: &'a Part,
    /// Of the cell [m].
    side: f64,
    /// How often it may be quartered.
    depth: u32,
}

impl Look<'_> {
    fn node(&self, low: DVec2, high: DVec2, depth: u32) -> Node {
        let corners = [
            low,
            DVec2::new(high.x, low.y),
            DVec2::new(low.x, high.y),
            high,
        ];
        Node {
            low,
            high,
            depth,
            corners: corners.map(|at| self.known(at)),
            quarters: OnceLock::new(),
        }
    }

    /// Whether the middle of a rectangle is not what its corners say.
    fn bends(&self, node: &Node, tolerance: f64) -> bool {
        if node.depth >= self.depth {
            return false;
        }
        let middle = 0.5 * (node.low + node.high);
        if !self.of.covers(middle) {
            return false;
        }
        let found = self.known(middle);
        let differs = |corner: &Known| corner.is_covered != found.is_covered;
        // What covers a part of it ends somewhere in it.
        if node.corners.iter().any(differs) {
            return true;
        }
        let whole = |known: &Known| luminance(known.received[0] + known.received[1]);
        let found = whole(&found);
        let corners = node.corners.each_ref().map(whole);
        let mean = 0.25 * corners.iter().sum::<f64>();
        let most = corners.iter().copied().fold(found, f64::max);
        let least = corners.iter().copied().fold(found, f64::min);
        let bends = (found - mean).abs() > tolerance * found.max(mean);
        // A shadow that passes between the corners and the middle shows by its steepness.
        let steep = most > 4.0 * least && node.depth + 2 < self.depth;
        bends || steep
    }

    /// A quarter of a rectangle: on which side of the middle it lies, each way.
    fn quarter(&self, node: &Node, upper: [bool; 2]) -> Node {
        let middle = 0.5 * (node.low + node.high);
        let pick = |upper: bool, low: f64, middle: f64, high: f64| match upper {
            true => (middle, high),
            false => (low, middle),
        };
        let (left, right) = pick(upper[0], node.low.x, middle.x, node.high.x);
        let (lower, higher) = pick(upper[1], node.low.y, middle.y, node.high.y);
        let (low, high) = (DVec2::new(left, lower), DVec2::new(right, higher));
        self.node(low, high, node.depth + 1)
    }

    /// What the surface receives at a point, or as near to it as it goes on.
    fn known(&self, at: DVec2) -> Known {
        let at = self.within(at);
        let unit = 1.0 / (SAME * self.of.side());
        let key = Point::Face(
            self.face,
            (at.x * unit).round() as i64,
            (at.y * unit).round() as i64,
        );
        let (point, normal) = (self.of.plane.point(at), self.of.plane.normal);
        let sight = || Sight {
            factors: self.transport.factors(point, normal, normal),
            is_covered: self.is_covered(at),
        };
        self.transport.known(self.light, key, sight)
    }

    /// Whether a point is covered. It is kept for all cells that meet there, so that it is the point's own matter, not that of who asks
    /// first: the largest of them counts.
    fn is_covered(&self, at: DVec2) -> bool {
        let step = 0.1 * SAME * self.of.side();
        let steps = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let around = steps.map(|(x, y)| at + step * DVec2::new(x, y));
        let sides = around.iter().filter_map(|p| self.of.cell(*p));
        let largest = sides.map(|(_, cell)| cell.side).fold(0.0, f64::max);
        let finest = largest / f64::from(1u32 << self.depth);
        let plane = &self.of.plane;
        self.transport
            .is_covered(plane.point(at), plane.normal, REACH * finest)
    }

    /// A point itself where the surface goes on around it, else one a little inside the part.
    fn within(&self, at: DVec2) -> DVec2 {
        let steps = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let inset = INSET * self.side;
        let around = steps.map(|(x, y)| at + inset * DVec2::new(x, y));
        let is_own = around.map(|p| self.of.covers(p) && self.of.patch(p) == Some(self.part.patch));
        let on = around
            .iter()
            .all(|p| self.of.covers(*p) && self.of.is_uncut_between(at, *p));
        if on {
            return at;
        }
        let own = around.iter().zip(is_own).filter(|(_, own)| *own);
        let count = own.clone().count();
        if count > 0 {
            return own.map(|(p, _)| *p).sum::<DVec2>() / count as f64;
        }
        // The nearest point of the part, a little toward the middle of its polygon.
        let nearest = self.part.pieces.iter().map(|(_, polygon)| {
            let near = nearest_on(polygon, at);
            let middle = polygon.iter().copied().sum::<DVec2>() / polygon.len() as f64;
            let way = middle - near;
            let step = inset.min(0.5 * way.length());
            (
                near.distance_squared(at),
                near + step * way.normalize_or_zero(),
            )
        });
        let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or(at, |(_, point)| point)
    }
}

/// The point of a convex polygon that is nearest to another point.
fn nearest_on(polygon: &[DVec2], at: DVec2) -> DVec2 {
    if super::cells::holds(polygon, at) {
        return at;
    }
    let edges = (0..polygon.len()).map(|i| {
        let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        let way = b - a;
        let square = way.length_squared();
        let f = if square > 0.0 {
            (way.dot(at - a) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        a + f * way
    });
    let near = edges.min_by(|a, b| a.distance_squared(at).total_cmp(&b.distance_squared(at)));
    near.unwrap_or(at)
}

impl Transport {
    /// What a surface sees from a point, by source.
    fn factors(&self, point: DVec3, normal: DVec3, facet: DVec3) -> Factors {
        let arrivals = self.before(point, normal, facet);
        let entry = |a: Arrival| (a.source, a.share, a.share * a.through);
        let mut row: Row = arrivals.into_iter().map(entry).collect();
        merge(&mut row);
        row.into_iter()
            .map(|(source, _, through)| (source, through))
            .collect()
    }

    /// What a triangle receives at a corner: looked at from a little inside, of a vertex with a normal from the first triangle that
    /// has it.
    fn at_corner(&self, light: &Light, triangle: u32, corner: usize, front: bool) -> Known {
        let mesh = &self.conditions.scene.mesh;
        let outward = |triangle: u32| {
            let [a, b, c] = self.conditions.scene.mesh.corners(triangle);
            (b - a).cross(c - a).normalize_or_zero()
        };
        let vertex = mesh.triangles[triangle as usize].vertices[corner];
        let own = mesh.normals[vertex as usize];
        let (mut triangle, mut corner, mut front) = (triangle, corner as u8, front);
        if own != DVec3::ZERO {
            // Which side is the front is each triangle's own matter; where its normal points is not.
            let agrees = (outward(triangle).dot(own) >= 0.0) == front;
            (triangle, corner) = self.patches.first_alike[vertex as usize];
            front = (outward(triangle).dot(own) >= 0.0) == agrees;
        }
        let sight = || {
            let places = self.conditions.scene.mesh.corners(triangle);
            let facet = if front {
                outward(triangle)
            } else {
                -outward(triangle)
            };
            let middle = places.iter().sum::<DVec3>() / 3.0;
            let point = places[usize::from(corner)].lerp(middle, INSET);
            let normal = toward(facet, own);
            Sight {
                factors: self.factors(point, normal, facet),
                is_covered: self.is_covered(point, facet, self.reach(triangle)),
            }
        };
        self.known(light, Point::Corner(triangle, corner, front), sight)
    }

    /// The normal of a triangle at a place on the side of `facet`, by the weights of its second and third vertex.
    fn normal(&self, triangle: u32, [v, w]: [f64; 2], facet: DVec3) -> DVec3 {
        let mesh = &self.conditions.scene.mesh;
        let [a, b, c] = mesh.triangles[triangle as usize]
            .vertices
            .map(|vertex| mesh.normals[vertex as usize]);
        toward(facet, (1.0 - v - w) * a + v * b + w * c)
    }

    /// How far around a place of a triangle is looked for what may cover it [m]: half as far as the triangle goes.
    fn reach(&self, triangle: u32) -> f64 {
        let [a, b, c] = self.conditions.scene.mesh.corners(triangle);
        0.5 * a.distance(b).max(b.distance(c).max(c.distance(a)))
    }

    /// What is known of a point under a light. What it sees is kept for other moments as long as there is room for it.
    fn known(&self, light: &Light, key: Point, sight: impl Fn() -> Sight) -> Known {
        let known = |sight: &Sight| Known {
            received: light.given_by(&sight.factors),
            is_covered: sight.is_covered,
        };
        if self.seen_bytes.load(Ordering::Relaxed) > MOST_BYTES {
            return known(&sight());
        }
        let seen = self.seen.place(key);
        known(seen.get_or_init(|| {
            let sight = sight();
            let bytes = size_of::<(Source, Vec3)>() * sight.factors.len() + 128;
            self.seen_bytes.fetch_add(bytes as u64, Ordering::Relaxed);
            sight
        }))
    }
}

/// A normal on the side of a facet; the facet's own where there is none.
fn toward(facet: DVec3, normal: DVec3) -> DVec3 {
    match normal.try_normalize() {
        Some(n) if n.dot(facet) < 0.0 => -n,
        Some(n) => n,
        None => facet,
    }
}

impl Light {
    /// What a place receives that sees these.
    fn given_by(&self, row: &Factors) -> Received {
        let mut received = [DVec3::ZERO; 2];
        for (source, through) in row {
            let which = usize::from(!matches!(source, Source::Sky(_)));
            received[which] += PI * through.as_dvec3() * self.radiance(*source);
        }
        received
    }
}
