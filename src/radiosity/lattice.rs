//! Light between the points where it was looked at: lattices on surfaces that are refined where light changes.
//!
//! On a plane each part of a cell has its rectangle, with what the corners receive; a rectangle whose middle receives otherwise than
//! its corners say is quartered. Points are fixed on the surface, whoever looks, so that nothing moves with the camera; they are looked
//! at when a picture needs them, and what they have seen serves other moments too. Small and bent triangles have their corners'
//! light.

use super::arrival::{Arrival, Row, Source, merge};
use super::cells::{Face, Part};
use super::light::Light;
use super::planes::Home;
use super::points::{Factors, Point};
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
    bent: Shards<(u32, bool), [Received; 3]>,
    open_ground: Received,
    tolerance: f64,
    depth: u32,
}

/// A rectangle of a part.
struct Node {
    low: DVec2,
    high: DVec2,
    depth: u32,
    corners: [Received; 4],
    /// Those that were asked for, if it is divided.
    quarters: OnceLock<Option<Box<[OnceLock<Node>; 4]>>>,
}

/// What points have seen is kept up to so many bytes; beyond, it is found anew for each moment.
const MOST_BYTES: u64 = 1 << 30;

/// How far from borders points stay, over the size of a cell.
const INSET: f64 = 2e-3;

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
        let mix = |k: usize| corners[0][k] * (1.0 - v - w) + corners[1][k] * v + corners[2][k] * w;
        [mix(0), mix(1)].map(|received| received.max(DVec3::ZERO))
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
            inset: INSET * cell.side,
        };
        let root = &self.parts[part.patch as usize];
        let mut node = &**root.get_or_init(|| Box::new(look.node(part.low, part.high, 0)));
        loop {
            let quarters = node.quarters.get_or_init(|| {
                look.bends(node, self.tolerance, self.depth)
                    .then(Box::default)
            });
            let Some(quarters) = quarters else {
                return Some(node.at(at));
            };
            let middle = 0.5 * (node.low + node.high);
            let upper = [at.x >= middle.x, at.y >= middle.y];
            let quarter = &quarters[usize::from(upper[0]) + 2 * usize::from(upper[1])];
            node = quarter.get_or_init(|| look.quarter(node, upper));
        }
    }
}

impl Node {
    fn at(&self, at: DVec2) -> Received {
        let size = (self.high - self.low).max(DVec2::splat(f64::MIN_POSITIVE));
        let f = ((at - self.low) / size).clamp(DVec2::ZERO, DVec2::ONE);
        let [a, b, c, d] = &self.corners;
        [0, 1].map(|k| {
            (a[k] * (1.0 - f.x) + b[k] * f.x) * (1.0 - f.y)
                + (c[k] * (1.0 - f.x) + d[k] * f.x) * f.y
        })
    }
}

/// One part of a cell under one light.
struct Look<'a> {
    transport: &'a Transport,
    light: &'a Light,
    face: u32,
    of: &'a Face,
    part: &'a Part,
    inset: f64,
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
            corners: corners.map(|at| self.received(at)),
            quarters: OnceLock::new(),
        }
    }

    /// Whether the middle of a rectangle is not what its corners say.
    fn bends(&self, node: &Node, tolerance: f64, depth: u32) -> bool {
        if node.depth >= depth {
            return false;
        }
        let middle = 0.5 * (node.low + node.high);
        if !self.of.covers(middle) {
            return false;
        }
        let whole = |received: &Received| luminance(received[0] + received[1]);
        let found = whole(&self.received(middle));
        let corners = node.corners.each_ref().map(whole);
        let mean = 0.25 * corners.iter().sum::<f64>();
        let most = corners.iter().copied().fold(found, f64::max);
        let least = corners.iter().copied().fold(found, f64::min);
        let bends = (found - mean).abs() > tolerance * found.max(mean);
        // A shadow that passes between the corners and the middle shows by its steepness.
        let steep = most > 4.0 * least && node.depth + 2 < depth;
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
    fn received(&self, at: DVec2) -> Received {
        let at = self.within(at);
        let unit = 1e6 / self.of.side();
        let key = Point::Face(
            self.face,
            (at.x * unit).round() as i64,
            (at.y * unit).round() as i64,
        );
        let normal = self.of.plane.normal;
        let row = || self.transport.row(self.of.plane.point(at), normal, normal);
        self.transport
            .seen_from(key, row, |row| self.light.given_by(row))
    }

    /// A point itself where the surface goes on around it, else one a little inside the part.
    fn within(&self, at: DVec2) -> DVec2 {
        let steps = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let around = steps.map(|(x, y)| at + self.inset * DVec2::new(x, y));
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
            let step = self.inset.min(0.5 * way.length());
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
    fn row(&self, point: DVec3, normal: DVec3, facet: DVec3) -> Factors {
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
    fn at_corner(&self, light: &Light, triangle: u32, corner: usize, front: bool) -> Received {
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
        let row = || {
            let places = self.conditions.scene.mesh.corners(triangle);
            let facet = if front {
                outward(triangle)
            } else {
                -outward(triangle)
            };
            let normal = match own.try_normalize() {
                Some(n) if n.dot(facet) < 0.0 => -n,
                Some(n) => n,
                None => facet,
            };
            let middle = places.iter().sum::<DVec3>() / 3.0;
            self.row(
                places[usize::from(corner)].lerp(middle, INSET),
                normal,
                facet,
            )
        };
        let key = Point::Corner(triangle, corner, front);
        self.seen_from(key, row, |row| light.given_by(row))
    }

    /// What is made of what a point sees, which is kept for other moments as long as there is room for it.
    fn seen_from<T>(
        &self,
        key: Point,
        row: impl Fn() -> Factors,
        made: impl Fn(&Factors) -> T,
    ) -> T {
        if self.seen_bytes.load(Ordering::Relaxed) > MOST_BYTES {
            return made(&row());
        }
        let seen = self.seen.place(key);
        made(seen.get_or_init(|| {
            let row = row();
            let bytes = size_of::<(Source, Vec3)>() * row.len() + 128;
            self.seen_bytes.fetch_add(bytes as u64, Ordering::Relaxed);
            row
        }))
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
