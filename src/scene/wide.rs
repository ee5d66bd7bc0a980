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
    /// What is inside each: a node, or packets.
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
