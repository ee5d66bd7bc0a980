//! The triangles that a ray may meet: a tree of four children a node, four triangles a leaf, in f32.
//!
//! It decides nothing. It names every triangle that the exact test in f64 could find on a ray, and few others.
//! Lengths are in box units, in which the bounds' diagonal E is at most 2048 and the middle of the bounds is the origin; u = 2^-24 is
//! the unit roundoff of f32. A ray starts at most 0.02 E outside the bounds and its direction has unit length.
//!
//! **Boxes** hold what is in them with a margin of 8 u E on every side. The distance to a box's plane, (plane - origin) /
//! direction, is computed with relative errors of u each for the direction, its reciprocal, the difference and the product:
//! together 4.2 u E along the axis, as the difference is at most 1.04 E. Origin and corner are rounded by 0.5 u E each, the plane
//! again by 0.5 u E: less than 6 u E. So every point of the content on the ray is, as computed, behind the near planes and
//! before the far ones. A component of the direction below 1e-30 counts as 1e-30, which moves no point of the ray
//! by more than 1e-26 of a unit, so no infinity meets a zero.
//!
//! **Triangles** are tested by the signed volumes of Moeller & Trumbore (1997), with s the way from the first corner to the
//! ray's start, e and f the edges from the first corner, d the direction:
//!
//! - p = d x f, u = s . p: rounding of d and f 2 u, of the cross product 2 sqrt(2) u, so p is off by 4.9 u |f|. s is off by the
//!   roundings of start, corner and difference, 2.1 u E; |s| <= 1.05 E; the scalar product adds 3 u |s||p|. Together 10.4 u E |f|.
//! - v = d . (s x e): likewise 10.4 u E |e|.
//! - w = e . p - u - v: e . p is off by 8.9 u |e||f|, at most 4.5 u E (|e| + |f|), as no edge is longer than E; the two
//!   differences round by at most 3.1 u E (|e| + |f|). Together 18 u E (|e| + |f|).
//!
//! A triangle is left out where one volume is below -T and another above T, T = 24 u E (|e| + |f|) + N. N bounds the error of
//! the same volumes in f64, which grows with the square of the distance D from the ray's own origin to the farthest corner: 8 x
//! 2^-53 D^2, doubled. So what the f64 test takes for a hit is never left out, be its triangle ever so small.

use glam::{DVec3, Vec3A, Vec4};
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::{Boundable, BvhBuildParams};
use std::time::Duration;

/// T without N, over 2^-24 E (|e| + |f|).
const SLACK: f64 = 24.0;

/// N over 2^-53 D^2.
const NOISE: f64 = 16.0;

/// Nodes that may wait at once without memory of their own.
const STACK: usize = 64;

/// What a node of the binary tree and a packet cost, relative to each other.
const NODE_COST: f32 = 0.4;
const PACKET_COST: f32 = 1.0;

/// Four boxes.
#[derive(Clone, Copy)]
#[repr(align(64))] // Whole cache lines.
struct Node {
    /// Least and greatest coordinates along each axis.
    planes: [[Vec4; 2]; 3],
    /// What is inside each: a node or a packet.
    children: [Child; 4],
}

/// The number of a node, or [`LEAF`] and that of a packet.
type Child = u32;

const LEAF: Child = 1 << 31;

/// Four triangles; the last one is repeated where there are fewer.
#[derive(Clone, Copy)]
#[repr(align(64))] // Whole cache lines.
struct Packet {
    /// First corners and edges from there, by coordinate.
    corner: [Vec4; 3],
    edges: [[Vec4; 3]; 2],
    /// T without N.
    slack: Vec4,
    /// Their numbers.
    slots: [u32; 4],
    /// How many there are.
    count: u32,
}

/// The tree.
pub(super) struct Wide {
    nodes: Vec<Node>,
    packets: Vec<Packet>,
    root: Child,
    /// The most nodes that wait at once.
    waiting: usize,
}

/// A ray in box units.
pub(super) struct BoxRay {
    origin: Vec3A,
    direction: Vec3A,
    inverse: Vec3A,
    noise: f32,
}

impl BoxRay {
    /// `reach` is the distance from the ray's own origin to the farthest corner, whence the f64 test computes.
    pub fn new(origin: DVec3, direction: DVec3, reach: f64) -> Self {
        let direction = direction.as_vec3a();
        let inverse = Vec3A::from_array(direction.to_array().map(|d| {
            let d = if d.abs() < 1e-30 {
                1e-30f32.copysign(d)
            } else {
                d
            };
            d.recip()
        }));
        BoxRay {
            origin: origin.as_vec3a(),
            direction,
            inverse,
            noise: (NOISE * 0.5f64.powi(53) * reach * reach) as f32,
        }
    }
}

fn cross(a: [Vec4; 3], b: [Vec4; 3]) -> [Vec4; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn dot(a: [Vec4; 3], b: [Vec4; 3]) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn splat(v: Vec3A) -> [Vec4; 3] {
    [Vec4::splat(v.x), Vec4::splat(v.y), Vec4::splat(v.z)]
}

impl Node {
    /// Boxes of nodes of the binary tree; nothing is in those that are left.
    fn around(tree: &Bvh2, parts: &[usize]) -> Self {
        let mut node = Node {
            planes: [[Vec4::INFINITY, Vec4::NEG_INFINITY]; 3],
            children: [0; 4],
        };
        for (k, part) in parts.iter().enumerate() {
            let aabb = &tree.nodes[*part].aabb;
            for (axis, planes) in node.planes.iter_mut().enumerate() {
                planes[0][k] = aabb.min[axis];
                planes[1][k] = aabb.max[axis];
            }
        }
        node
    }
}

impl Packet {
    /// Of one to four triangles.
    fn new(corners: &[[DVec3; 3]], slots: &[u32], scale: f64, extent: f64) -> Self {
        let mut packet = Packet {
            corner: [Vec4::ZERO; 3],
            edges: [[Vec4::ZERO; 3]; 2],
            slack: Vec4::ZERO,
            slots: [0; 4],
            count: slots.len() as u32,
        };
        for k in 0..4 {
            let slot = slots[k.min(slots.len() - 1)];
            let [a, b, c] = corners[slot as usize].map(|p| scale * p);
            let (e, f) = (b - a, c - a);
            for axis in 0..3 {
                packet.corner[axis][k] = a[axis] as f32;
                packet.edges[0][axis][k] = e[axis] as f32;
                packet.edges[1][axis][k] = f[axis] as f32;
            }
            let unit = 0.5f64.powi(24) * scale * extent;
            packet.slack[k] = (SLACK * unit * (e.length() + f.length())) as f32;
            packet.slots[k] = slot;
        }
        packet
    }

    /// Bits of the triangles that may be met.
    #[inline(always)]
    fn may_meet(&self, origin: [Vec4; 3], d: [Vec4; 3], noise: Vec4) -> u32 {
        let [e, f] = self.edges;
        let s = [
            origin[0] - self.corner[0],
            origin[1] - self.corner[1],
            origin[2] - self.corner[2],
        ];
        let p = cross(d, f);
        let u = dot(s, p);
        let v = dot(d, cross(s, e));
        let w = dot(e, p) - u - v;
        let least = u.min(v).min(w);
        let most = u.max(v).max(w);
        let slack = self.slack + noise;
        (least.cmpge(-slack) | most.cmple(slack)).bitmask() & ((1 << self.count) - 1)
    }
}

impl Wide {
    /// Of triangles and the boxes around them in box units, `scale` to a metre; `extent` is the bounds' diagonal [m].
    pub fn new(boxes: &[impl Boundable], corners: &[[DVec3; 3]], scale: f64, extent: f64) -> Self {
        let mut wide = Wide {
            nodes: Vec::new(),
            packets: Vec::new(),
            root: 0,
            waiting: 0,
        };
        if corners.is_empty() {
            return wide;
        }
        let single = BvhBuildParams {
            max_prims_per_leaf: 1,
            ..BvhBuildParams::medium_build()
        };
        let tree = &build_bvh2(boxes, single, &mut Duration::default());
        let is_leaf = leaves(tree);
        // Nodes of the binary tree, where they belong here, and how many wait there.
        let mut open = vec![(0, None, 0)];
        while let Some((at, place, waiting)) = open.pop() {
            let child = if is_leaf[at] {
                let packet = Packet::new(corners, &inside(tree, at), scale, extent);
                wide.packets.push(packet);
                LEAF | (wide.packets.len() - 1) as u32
            } else {
                let parts = parts(tree, &is_leaf, at);
                wide.waiting = wide.waiting.max(waiting + parts.len());
                let number = wide.nodes.len();
                let waiting = waiting + parts.len() - 1;
                open.extend(
                    (0..)
                        .zip(&parts)
                        .map(|(k, p)| (*p, Some((number, k)), waiting)),
                );
                wide.nodes.push(Node::around(tree, &parts));
                number as u32
            };
            match place {
                Some((node, k)) => {
                    let node: &mut Node = &mut wide.nodes[node];
                    node.children[k as usize] = child;
                }
                None => wide.root = child,
            }
        }
        wide.nodes.shrink_to_fit();
        wide.packets.shrink_to_fit();
        wide
    }

    /// Calls `found` with the number of each triangle that a ray may meet up to the distance `far`, the near ones first; it
    /// returns the distance beyond which none is wanted any more, `None` if none at all.
    #[inline]
    pub fn walk(
        &self,
        ray: &BoxRay,
        mut far: f32,
        mut found: impl FnMut(usize, f32) -> Option<f32>,
    ) {
        let mut few = [(0.0, 0); STACK];
        let mut many = Vec::new();
        let stack = if self.waiting <= STACK {
            &mut few[..]
        } else {
            many.resize(self.waiting, (0.0, 0));
            &mut many[..]
        };
        let origin = splat(ray.origin);
        let direction = splat(ray.direction);
        let inverse = splat(ray.inverse);
        let noise = Vec4::splat(ray.noise);
        let near = ray.inverse.to_array().map(|d| usize::from(d < 0.0));
        let mut top = 0;
        let mut child = self.root;
        loop {
            if child & LEAF == 0 {
                let node = &self.nodes[child as usize];
                let mut enter = Vec4::ZERO;
                let mut leave = Vec4::splat(far);
                for axis in 0..3 {
                    let planes = &node.planes[axis];
                    let side = near[axis] & 1;
                    let (a, b) = (planes[side], planes[1 - side]);
                    enter = enter.max((a - origin[axis]) * inverse[axis]);
                    leave = leave.min((b - origin[axis]) * inverse[axis]);
                }
                let mut hits = enter.cmple(leave).bitmask();
                if hits != 0 {
                    let enter = enter.to_array();
                    let base = top;
                    while hits != 0 {
                        let k = hits.trailing_zeros() as usize & 3;
                        hits &= hits - 1;
                        let (at, part) = (enter[k], node.children[k]);
                        let mut place = top;
                        while place > base && stack[place - 1].0 < at {
                            stack[place] = stack[place - 1];
                            place -= 1;
                        }
                        stack[place] = (at, part);
                        top += 1;
                    }
                    top -= 1;
                    child = stack[top].1;
                    continue;
                }
            } else {
                let packet = &self.packets[(child & !LEAF) as usize];
                let mut met = packet.may_meet(origin, direction, noise);
                while met != 0 {
                    let k = met.trailing_zeros() as usize & 3;
                    met &= met - 1;
                    match found(packet.slots[k] as usize, far) {
                        Some(wanted) => far = wanted,
                        None => return,
                    }
                }
            }
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                if stack[top].0 <= far {
                    child = stack[top].1;
                    break;
                }
            }
        }
    }
}

/// Which nodes of a binary tree of single triangles become packets: those where that is cheaper than their parts (the surface
/// area heuristic of MacDonald & Booth 1990).
fn leaves(tree: &Bvh2) -> Vec<bool> {
    let children = |at: usize| {
        let node = &tree.nodes[at];
        let first = node.first_index as usize;
        (node.prim_count == 0).then_some([first, first + 1])
    };
    let mut order = vec![0];
    let mut next = 0;
    while let Some(at) = order.get(next) {
        order.extend(children(*at).into_iter().flatten());
        next += 1;
    }
    let mut is_leaf = vec![false; tree.nodes.len()];
    let mut counts = vec![1; tree.nodes.len()];
    let mut costs = vec![0.0; tree.nodes.len()];
    for at in order.into_iter().rev() {
        let area = tree.nodes[at].aabb.half_area();
        let packet = area * PACKET_COST;
        let Some([a, b]) = children(at) else {
            (is_leaf[at], costs[at]) = (true, packet);
            continue;
        };
        counts[at] = counts[a] + counts[b];
        costs[at] = area * NODE_COST + costs[a] + costs[b];
        if counts[at] <= 4 && packet <= costs[at] {
            (is_leaf[at], costs[at]) = (true, packet);
        }
    }
    is_leaf
}

/// Up to four nodes below one that is no leaf: the largest are opened first.
fn parts(tree: &Bvh2, is_leaf: &[bool], at: usize) -> Vec<usize> {
    let mut parts = vec![at];
    while parts.len() < 4 {
        let area = |k: &usize| tree.nodes[parts[*k]].aabb.half_area();
        let inner = (0..parts.len()).filter(|k| !is_leaf[parts[*k]]);
        let Some(k) = inner.max_by(|a, b| area(a).total_cmp(&area(b))) else {
            break;
        };
        let first = tree.nodes[parts[k]].first_index as usize;
        parts[k] = first;
        parts.push(first + 1);
    }
    parts
}

/// The triangles below a node.
fn inside(tree: &Bvh2, at: usize) -> Vec<u32> {
    let mut slots = Vec::new();
    let mut open = vec![at];
    while let Some(at) = open.pop() {
        let node = &tree.nodes[at];
        let first = node.first_index as usize;
        if node.prim_count == 0 {
            open.extend([first, first + 1]);
        } else {
            slots.extend(&tree.primitive_indices[first..first + node.prim_count as usize]);
        }
    }
    slots
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::geometry::intersect;
    use crate::scene::{self, AlphaMode, Geometry, Hit, Material, Mesh, Ray, Scene};
    use crate::split_mix::SplitMix;
    use glam::DVec2;

    type Triangle = [DVec3; 3];

    /// Of one opaque material.
    fn scene(triangles: &[Triangle]) -> Scene {
        let positions: Vec<DVec3> = triangles.iter().flatten().copied().collect();
        Scene {
            materials: vec![Material {
                name: "grey".into(),
                base_color: DVec3::splat(0.5),
                alpha: 1.0,
                texture: None,
                alpha_mode: AlphaMode::Opaque,
                pane: None,
            }],
            mesh: Mesh {
                normals: vec![DVec3::ZERO; positions.len()],
                uvs: vec![DVec2::ZERO; positions.len()],
                colors: Vec::new(),
                triangles: (0..triangles.len() as u32)
                    .map(|i| scene::Triangle {
                        vertices: [3 * i, 3 * i + 1, 3 * i + 2],
                        material: 0,
                    })
                    .collect(),
                positions,
            },
            ..Scene::default()
        }
    }

    fn quad(corner: DVec3, a: DVec3, b: DVec3) -> [Triangle; 2] {
        [
            [corner, corner + a, corner + a + b],
            [corner, corner + a + b, corner + b],
        ]
    }

    /// Numbers, places and directions that look like chance.
    struct Chance(SplitMix);

    impl Chance {
        fn number(&mut self) -> f64 {
            self.0.unit()
        }

        fn between(&mut self, low: f64, high: f64) -> f64 {
            low + (high - low) * self.number()
        }

        /// One of `count`.
        fn one(&mut self, count: usize) -> usize {
            (self.number() * count as f64) as usize
        }

        fn cube(&mut self) -> DVec3 {
            DVec3::from_array([(); 3].map(|()| self.between(-1.0, 1.0)))
        }

        fn direction(&mut self) -> DVec3 {
            self.cube().normalize()
        }

        /// A corner, a point of an edge, or one inside.
        fn point(&mut self, [a, b, c]: &Triangle) -> DVec3 {
            let (s, t) = (self.number(), self.number());
            match self.one(3) {
                0 => [*a, *b, *c][self.one(3)],
                1 => a.lerp(*b, s),
                _ => a.lerp(b.lerp(*c, s), t),
            }
        }

        fn triangle(&mut self, middle: DVec3, size: f64) -> Triangle {
            [(); 3].map(|()| middle + size * self.cube())
        }

        /// At a point of a triangle: from anywhere, or parallel to one or two axes.
        fn ray(&mut self, triangle: &Triangle, distance: f64) -> Ray {
            let target = self.point(triangle);
            let mut direction = self.direction();
            for _ in 0..self.one(3) {
                direction[self.one(3)] = 0.0;
            }
            let direction = direction.try_normalize().unwrap_or(DVec3::NEG_Y);
            Ray {
                origin: target - distance * direction,
                direction,
            }
        }
    }

    #[test]
    fn no_triangle_that_is_hit_is_left_out() {
        let mut chance = Chance(SplitMix(1));
        let extent = 2000.0;
        let (mut hits, mut named, mut tests) = (0, 0, 0);
        for _ in 0..1_000_000 {
            let size = 10f64.powf(chance.between(-8.0, 2.7));
            let middle = 0.27 * extent * chance.cube();
            let triangle = chance.triangle(middle, size);
            let distance = 0.5 * extent * chance.number();
            let mut ray = chance.ray(&triangle, distance);
            if chance.number() < 0.5 {
                // Beside it.
                let direction = ray.direction + size / distance * chance.cube();
                ray.direction = direction.normalize();
            }
            let skip = match chance.number() < 0.5 {
                true => extent * 10f64.powf(chance.between(0.0, 4.0)),
                false => 0.0,
            };
            ray.origin -= skip * ray.direction;
            let start = ray.origin + skip * ray.direction;
            let reach = ray.origin.length() + extent;
            let box_ray = BoxRay::new(start, ray.direction, reach);
            assert!(box_ray.inverse.is_finite(), "{ray:?}");
            let packet = Packet::new(&[triangle], &[0], 1.0, extent);
            let may = packet.may_meet(
                splat(box_ray.origin),
                splat(box_ray.direction),
                Vec4::splat(box_ray.noise),
            );
            let hit = intersect(&triangle, ray.origin, ray.direction);
            assert!(hit.is_none() || may == 1, "{triangle:?} {ray:?} {hit:?}");
            hits += u32::from(hit.is_some());
            if size > 1.0 && reach < 2.0 * extent {
                (tests, named) = (tests + 1, named + i32::from(hit.is_none() && may == 1));
            }
        }
        assert!(hits > 200_000, "{hits}");
        // Those that are aimed at corners and edges.
        assert!(named < tests / 3, "{named} of {tests}");
    }

    /// What a test of every triangle finds.
    fn by_all(geometry: &Geometry, ray: &Ray, near: f64, far: f64) -> Option<Hit> {
        let origin = ray.origin - geometry.origin;
        let all = geometry.corners.iter().zip(&geometry.scene_triangle);
        all.filter_map(|(corners, triangle)| {
            let hit = intersect(corners, origin, ray.direction)?;
            let triangle = *triangle;
            (hit.distance > near && hit.distance < far).then_some(Hit { triangle, ..hit })
        })
        .min_by(|a, b| {
            let by_distance = a.distance.total_cmp(&b.distance);
            by_distance.then(a.triangle.cmp(&b.triangle))
        })
    }

    /// Aims rays at triangles from distances up to these, in lengths of the bounds, and compares; the share that hit.
    fn compare(name: &str, triangles: &[Triangle], aimed_at: usize, distances: &[f64]) -> f64 {
        let geometry = Geometry::new(&scene(triangles));
        let mut chance = Chance(SplitMix(7));
        let mut hits = 0;
        let rays = 4000;
        for k in 0..rays {
            let triangle = &triangles[chance.one(aimed_at)];
            let distance = distances[k % distances.len()] * chance.number();
            let ray = chance.ray(triangle, distance * geometry.extent());
            let far = match k % 3 {
                0 => 1.5 * distance * chance.number() * geometry.extent(),
                _ => f64::INFINITY,
            };
            let near = if k % 5 == 0 { 0.1 * far.min(1.0) } else { 0.0 };
            let expected = by_all(&geometry, &ray, near, far);
            let found = geometry.closest(&ray, near, far);
            assert_eq!(found, expected, "{name}: {ray:?} from {near} to {far}");
            assert_eq!(geometry.met(&ray, near, far).0, expected, "{name}: {ray:?}");
            let occluded = geometry.occluded(&ray, near, far);
            assert_eq!(occluded, expected.is_some(), "{name}: {ray:?}");
            hits += u32::from(expected.is_some());
        }
        f64::from(hits) / rays as f64
    }

    fn moved(triangles: &[Triangle], scale: f64, shift: DVec3) -> Vec<Triangle> {
        let triangles = triangles.iter();
        triangles.map(|t| t.map(|p| scale * p + shift)).collect()
    }

    #[test]
    fn rays_meet_what_a_test_of_every_triangle_finds() {
        let mut chance = Chance(SplitMix(3));
        let soup: Vec<Triangle> = (0..300)
            .map(|_| {
                let size = 10f64.powf(chance.between(-3.0, -0.3));
                let middle = chance.cube();
                chance.triangle(middle, size)
            })
            .collect();
        let needles: Vec<Triangle> = (0..200)
            .map(|_| {
                let (a, way) = (chance.cube(), 0.5 * chance.direction());
                [
                    a,
                    a + way,
                    a + chance.number() * way + 1e-6 * chance.direction(),
                ]
            })
            .collect();
        // Walls and floors that share edges and lie in the planes of each other's boxes.
        let mut cells = Vec::new();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis / 7.0);
        for (i, j) in (0..7).flat_map(|i| (0..7).map(move |j| (i, j))) {
            for (k, level) in [(0, 0.0), (1, 3.0), (2, 5.0), (0, 7.0)] {
                let [across, along, up] = [0, 1, 2].map(|n| axes[(k + n) % 3]);
                let corner = f64::from(i) * across + f64::from(j) * along + level * up;
                cells.extend(quad(corner, across, along));
            }
        }
        let scenes = [("soup", &soup), ("needles", &needles), ("cells", &cells)];
        for (name, triangles) in scenes {
            for (scale, shift) in [(1.0, 0.0), (1e-6, 0.0), (1e5, 0.0), (0.1, 1.0), (1.0, 1e6)] {
                let shift = shift * DVec3::new(1.0, -0.3, 0.7);
                let name = format!("{name} x {scale} + {shift}");
                let moved = moved(triangles, scale, shift);
                let share = compare(&name, &moved, moved.len(), &[0.01, 1.0, 100.0]);
                assert!(share > 0.4, "{name}: {share}");
            }
        }
        // Dust on a plain.
        let mut plain: Vec<Triangle> = (0..300)
            .map(|_| {
                let middle = DVec3::new(2e4, 1.0, -3e4) + 1e-5 * chance.cube();
                chance.triangle(middle, 1e-6)
            })
            .collect();
        let corner = DVec3::new(-5e4, 0.0, -5e4);
        plain.extend(quad(corner, 1e5 * DVec3::Z, 1e5 * DVec3::X));
        let share = compare("dust", &plain, 300, &[1e-10, 1e-8]);
        assert!(share > 0.4, "{share}");
        compare("one", &soup[..1], 1, &[0.5, 10.0]);
    }

    #[test]
    fn a_tree_of_any_depth_is_walked() {
        let mut chance = Chance(SplitMix(5));
        let corners: Vec<Triangle> = (0..100)
            .map(|_| {
                let middle = 500.0 * chance.cube();
                chance.triangle(middle, 200.0)
            })
            .collect();
        struct Around(obvhs::aabb::Aabb);
        impl Boundable for Around {
            fn aabb(&self) -> obvhs::aabb::Aabb {
                self.0
            }
        }
        let boxes: Vec<Around> = corners
            .iter()
            .map(|t| Around(obvhs::aabb::Aabb::from_points(&t.map(|p| p.as_vec3a()))))
            .collect();
        let mut wide = Wide::new(&boxes, &corners, 1.0, 2000.0);
        for _ in 0..100 {
            let ray = BoxRay::new(500.0 * chance.cube(), chance.direction(), 2000.0);
            let [few, many] = [0, 10 * STACK].map(|waiting| {
                wide.waiting = wide.waiting.max(waiting);
                let mut slots = Vec::new();
                wide.walk(&ray, f32::INFINITY, |slot, far| {
                    slots.push(slot);
                    Some(far)
                });
                slots
            });
            assert_eq!(few, many);
        }
    }
}
