//! Exact lit and dark runs of a ray: the curtain.
//!
//! Light that is parallel reaches the points of a ray along a half-plane, the curtain, which is bounded by the ray and swept
//! from it toward the sun. Every triangle that the curtain cuts darkens exactly one interval of the ray (a cut-out triangle:
//! one for each run of solid texels). So the bounding volumes are searched for the half-plane instead of for many shadow rays:
//! no step size, no missed gap. These are the segments of Nishita, Miyawaki & Nakamae 1987 without their shadow volumes.
//!
//! Everything happens in the ray's own frame (n, m, r): r along the ray, m across it on the sun's side, n at right angles to
//! both. A point p of the curtain (p.n = 0, p.m = y >= 0) shades the ray at t = p.r - y cot(theta), theta being the angle
//! between the ray and the sun. Several suns (the points of its disc) share one search: each only turns the half-plane a
//! little about the ray. What could only darken points that are dark already is skipped, and what may darken most is
//! visited first.
//!
//! Light from a place near by reaches the ray along a fan instead: see the module `fan`.

use super::Ray;
use super::geometry::{Geometry, Node, Veil};
use super::shade::{Shade, Tinted, Veiled, gaps, holds};
use crate::beam::Beam;
use glam::{BVec4A, DMat3, DVec2, DVec3, Vec3A, Vec4};

pub use super::shade::Run;

/// Below this sine of the angle between ray and sun, the ray's points all see the sun along the ray itself.
const PARALLEL: f64 = 1e-9;

/// One half-plane in the ray's frame.
#[derive(Clone, Copy)]
struct HalfPlane {
    /// Cosine and sine of its turn about the ray, from m toward n.
    cos: f64,
    sin: f64,
    /// Cotangent of the angle between the ray and this sun.
    cot: f64,
}

impl Geometry {
    /// The dark runs of the first `far` metres of a ray, for each of `beams`.
    ///
    /// `dark[k]` is overwritten with the runs of which something keeps all light of `beams[k]` off, in order and apart from each
    /// other. Exact except for f64 rounding. A beam is that of the middle of its cell.
    pub fn dark_runs(&self, ray: &Ray, far: f64, beams: &[Beam], dark: &mut Vec<Vec<Run>>) {
        let mut shades = Vec::new();
        self.shades(ray, far, beams, &mut shades);
        dark.clear();
        dark.extend(shades.into_iter().map(|shade| shade.dark));
    }

    /// What shades and colours the first `far` metres of a ray, for each of `beams`: `shades[k]` is overwritten. Exact except for f64
    /// rounding.
    pub fn shades(&self, ray: &Ray, far: f64, beams: &[Beam], shades: &mut Vec<Shade>) {
        self.shades_of_triangles(ray, far, beams, shades);
        if let Some(panes) = self.panes() {
            panes.tint(ray, far, beams, shades);
        }
    }

    /// What its own triangles do.
    pub(super) fn shades_of_triangles(
        &self,
        ray: &Ray,
        far: f64,
        beams: &[Beam],
        shades: &mut Vec<Shade>,
    ) {
        shades.resize_with(beams.len(), Shade::default);
        shades.iter_mut().for_each(Shade::clear);
        if self.corners.is_empty() || far <= 0.0 {
            return;
        }
        let mut suns = Vec::with_capacity(beams.len());
        for (k, beam) in beams.iter().enumerate() {
            match beam {
                Beam::Parallel { toward, .. } => suns.push((k, *toward)),
                Beam::Local { position, .. } => self.fan(ray, far, *position, &mut shades[k]),
            }
        }
        if suns.is_empty() {
            return;
        }
        let r = ray.direction;
        // The frame's origin is the point of the ray nearest to the scene, so that a far eye costs no digits.
        let near = (self.origin - ray.origin).dot(r).clamp(0.0, far);
        let base = (ray.origin - self.origin) + near * r;
        let mean: DVec3 = suns.iter().map(|(_, toward)| toward).sum();
        let aside = mean - r * mean.dot(r);
        let m = if aside.length() > PARALLEL * mean.length() {
            // Twice, so that the cancellation of the first subtraction leaves no part along r.
            let once = aside.normalize();
            (once - r * once.dot(r)).normalize()
        } else {
            r.any_orthonormal_vector()
        };
        let n = m.cross(r);
        let mut planes = Vec::with_capacity(suns.len());
        let mut which = Vec::with_capacity(suns.len());
        for (k, sun) in &suns {
            let (y, x) = (sun.dot(m), sun.dot(n));
            let sine = y.hypot(x);
            if sine < PARALLEL {
                self.along_sun(ray, far, *sun, &mut shades[*k]);
                continue;
            }
            which.push(*k);
            planes.push(HalfPlane {
                cos: y / sine,
                sin: x / sine,
                cot: sun.dot(r) / sine,
            });
        }
        if planes.is_empty() {
            return;
        }
        let mut search = Search {
            geometry: self,
            frame: [n, m, r],
            to_frame: DMat3::from_cols(n, m, r).transpose(),
            base,
            planes: &planes,
            span: [-near, far - near],
            shades: vec![Shade::default(); planes.len()],
            lit: Vec::new(),
            together: 1e-13 * (near + self.extent),
        };
        search.run();
        let back = |[from, to]: Run| [(from + near).max(0.0), (to + near).min(far)];
        for (k, found) in which.iter().zip(search.shades) {
            let shade = &mut shades[*k];
            let dark = found.dark.iter().map(|run| back(*run));
            shade.dark.extend(dark.filter(|[a, b]| b > a));
            for veiled in found.veiled {
                let run = back(veiled.run);
                shade.veiled.push(Veiled { run, ..veiled });
            }
            for tinted in found.tinted {
                let run = back(tinted.run);
                shade.tinted.push(Tinted { run, ..tinted });
            }
        }
    }

    /// What shades a ray along which the sun itself shines, or from the sun.
    fn along_sun(&self, ray: &Ray, far: f64, sun: DVec3, shade: &mut Shade) {
        let way = Ray {
            origin: ray.origin,
            direction: sun,
        };
        let ahead = sun.dot(ray.direction) > 0.0;
        if self.glazing.is_some() {
            for (distance, through) in self.crossings(&way, 0.0, f64::INFINITY) {
                let end = if ahead { distance } else { far };
                shade.tint(through, [0.0, end], [0.0, far]);
            }
            let behind = (!ahead).then(|| self.crossings(ray, 0.0, far));
            for (distance, through) in behind.into_iter().flatten() {
                shade.tint(through, [distance, far], [0.0, far]);
            }
            return;
        }
        let (solid, before) = self.met(&way, 0.0, f64::INFINITY);
        if solid.is_some() {
            shade.dark.push([0.0, far]);
            return;
        }
        let mut add = |veil: Veil, run: Run| {
            shade.add(Some((veil.kind, veil.pass)), run, [0.0, far], 0.0);
        };
        for veil in before {
            let end = if ahead { veil.hit.distance } else { far };
            add(veil, [0.0, end]);
        }
        if !ahead && self.has_veils() {
            for veil in self.met(ray, 0.0, far).1 {
                add(veil, [veil.hit.distance, far]);
            }
        }
    }
}

struct Search<'a> {
    geometry: &'a Geometry,
    /// The ray's frame (n, m, r), and what takes a vector to it.
    frame: [DVec3; 3],
    to_frame: DMat3,
    base: DVec3,
    planes: &'a [HalfPlane],
    span: Run,
    /// What was found so far, for each half-plane.
    shades: Vec<Shade>,
    /// What a cut may yet darken, for the while.
    lit: Vec<Run>,
    together: f64,
}

/// Four half-planes at once, in f32; the last one is repeated where there are fewer.
struct Lanes {
    cos: Vec4,
    sin: Vec4,
    cot: Vec4,
    /// Which of [`Search::planes`] the first lane is, and how many lanes count.
    first: usize,
    count: usize,
}

impl Lanes {
    fn new(planes: &[HalfPlane], first: usize) -> Self {
        let count = (planes.len() - first).min(4);
        let lane = |value: fn(&HalfPlane) -> f64| {
            Vec4::from_array(std::array::from_fn(|i| {
                value(&planes[first + i.min(count - 1)]) as f32
            }))
        };
        Lanes {
            cos: lane(|p| p.cos),
            sin: lane(|p| p.sin),
            cot: lane(|p| p.cot),
            first,
            count,
        }
    }

    /// Which half-planes cut a box (its middle and half size in the ray's frame), and between which places of the ray it may
    /// shade.
    fn cut(&self, c: [f32; 3], h: [f32; 3], slack: f32) -> (BVec4A, Vec4, Vec4) {
        let (cos, sin) = (self.cos.abs(), self.sin.abs());
        let aside = (self.cos * c[0] - self.sin * c[1]).abs() - cos * h[0] - sin * h[1];
        let height = self.cos * c[1] + self.sin * c[0];
        let reach = cos * h[1] + sin * h[0];
        let (low, high) = ((height - reach).max(Vec4::ZERO), height + reach);
        let (a, b) = (low * self.cot, high * self.cot);
        let margin = slack * (Vec4::ONE + self.cot.abs());
        let cut = aside.cmple(Vec4::ZERO) & high.cmpge(Vec4::ZERO);
        (
            cut,
            c[2] - h[2] - a.max(b) - margin,
            c[2] + h[2] - a.min(b) + margin,
        )
    }
}

impl Search<'_> {
    fn run(&mut self) {
        let [n, m, r] = self.frame.map(|v| v.as_vec3a());
        let (na, ma, ra) = (n.abs(), m.abs(), r.abs());
        let base = self.base.as_vec3a();
        let lanes: Vec<Lanes> = (0..self.planes.len())
            .step_by(4)
            .map(|first| Lanes::new(self.planes, first))
            .collect();
        // f32 rounding of the frame's coordinates, several times over.
        let slack = 1e-6 * (self.geometry.extent as f32 + base.length());
        let span = self.span;
        let geometry = self.geometry;
        // Between which places of the ray a node may yet darken something; `None` if nowhere.
        let reach = |node: &Node, shades: &[Shade]| -> Option<[f32; 2]> {
            let c: Vec3A = node.middle - base;
            let c = [n.dot(c), m.dot(c), r.dot(c)];
            let h = [
                na.dot(node.half) + slack,
                ma.dot(node.half) + slack,
                ra.dot(node.half) + slack,
            ];
            let mut reach = [f32::INFINITY, f32::NEG_INFINITY];
            for lane in &lanes {
                let (cut, from, to) = lane.cut(c, h, slack);
                if !cut.any() {
                    continue;
                }
                let (from, to, cut) = (from.to_array(), to.to_array(), cut.bitmask());
                for i in 0..lane.count {
                    if cut & (1 << i) == 0 {
                        continue;
                    }
                    let (a, b) = (
                        f64::from(from[i]).max(span[0]),
                        f64::from(to[i]).min(span[1]),
                    );
                    if a < b && !holds(&shades[lane.first + i].dark, a, b) {
                        reach = [reach[0].min(from[i]), reach[1].max(to[i])];
                    }
                }
            }
            (reach[0] < reach[1]).then_some(reach)
        };
        let nodes = &geometry.nodes;
        let mut stack: Vec<(u32, [f32; 2])> = Vec::with_capacity(64);
        stack.extend(reach(&nodes[0], &self.shades).map(|reach| (0, reach)));
        while let Some((top, [from, to])) = stack.pop() {
            // What was worth visiting when it was pushed may be dark by now.
            let (from, to) = (f64::from(from).max(span[0]), f64::from(to).min(span[1]));
            if self.shades.iter().all(|s| holds(&s.dark, from, to)) {
                continue;
            }
            let node = &nodes[top as usize];
            if node.count > 0 {
                for index in node.first..node.first + node.count {
                    self.triangle(index as usize);
                }
                continue;
            }
            let children = [node.first, node.first + 1];
            let reaches = children.map(|child| reach(&nodes[child as usize], &self.shades));
            // The child that may darken most comes first, so last onto the stack.
            let length = |i: usize| reaches[i].map_or(0.0, |[from, to]| to - from);
            let order = if length(0) > length(1) {
                [1, 0]
            } else {
                [0, 1]
            };
            for i in order {
                stack.extend(reaches[i].map(|reach| (children[i], reach)));
            }
        }
    }

    /// Darkens the run of the ray that one triangle shades, for each half-plane that cuts it.
    fn triangle(&mut self, index: usize) {
        let [p, q, s] = &self.geometry.corners[index];
        let to_frame = |p: &DVec3| self.to_frame * (*p - self.base);
        let points = [to_frame(p), to_frame(q), to_frame(s)];
        for (k, plane) in self.planes.iter().enumerate() {
            let side = |p: &DVec3| plane.cos * p.x - plane.sin * p.y;
            let side = [side(&points[0]), side(&points[1]), side(&points[2])];
            let below = [side[0] < 0.0, side[1] < 0.0, side[2] < 0.0];
            // The corner that lies alone on its side of the half-plane; its two edges are cut.
            let alone = match below {
                [a, b, c] if a == b && b == c => continue,
                [a, b, _] if a == b => 2,
                [a, _, c] if a == c => 1,
                _ => 0,
            };
            // Where all that the triangle can shade is dark already there is nothing to do. A corner at height y shades
            // the place z - y cot; where the ray's own height cuts the triangle, the place lies between the corners' z.
            let height = |p: &DVec3| plane.cos * p.y + plane.sin * p.x;
            let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
            let mut under = false;
            for p in &points {
                let y = height(p);
                under |= y < 0.0;
                let shaded = p.z - y.max(0.0) * plane.cot;
                (from, to) = (from.min(shaded), to.max(shaded));
            }
            if under {
                for p in &points {
                    (from, to) = (from.min(p.z), to.max(p.z));
                }
            }
            let (from, to) = (from.max(self.span[0]), to.min(self.span[1]));
            if from >= to || holds(&self.shades[k].dark, from, to) {
                continue;
            }
            let cut = |other: usize| {
                // From the lower to the upper side, so that both triangles of an edge find the same point.
                let (lower, upper) = if below[alone] {
                    (alone, other)
                } else {
                    (other, alone)
                };
                let f = side[lower] / (side[lower] - side[upper]);
                let (p, q) = (&points[lower], &points[upper]);
                let mix = |a: f64, b: f64| a + f * (b - a);
                End {
                    y: mix(height(p), height(q)),
                    z: mix(p.z, q.z),
                    edge: (lower, upper, f),
                }
            };
            let a = cut(if alone == 0 { 1 } else { 0 });
            let b = cut(if alone == 2 { 1 } else { 2 });
            if a.y < 0.0 && b.y < 0.0 {
                continue;
            }
            // Only what stands on the sun's side of the ray shades it: the part f to g of the line from a to b.
            let crossing = || a.y / (a.y - b.y);
            let f = if a.y < 0.0 { crossing() } else { 0.0 };
            let g = if b.y < 0.0 { crossing() } else { 1.0 };
            let at = |f: f64| {
                let y = (a.y + f * (b.y - a.y)).max(0.0);
                a.z + f * (b.z - a.z) - y * plane.cot
            };
            let (from, to) = (at(f), at(g));
            if self.geometry.glazing.is_some() {
                let [first, last] = [&a, &b].map(End::weights);
                let line = [first.lerp(last, f), first.lerp(last, g)];
                let normal = self.to_frame * self.geometry.pane_normal(index);
                let toward = DVec3::new(plane.sin, plane.cos, plane.cot).normalize();
                let cosine = normal.dot(toward);
                let (shade, span) = (&mut self.shades[k], self.span);
                let mix = |f: f64| from + f * (to - from);
                let add = |p: f64, q: f64, through: DVec3| {
                    shade.tint(through, [mix(p), mix(q)], span);
                };
                self.geometry.colours(index, line, |_| cosine, add);
                continue;
            }
            let veil = self.geometry.veil(index);
            let Some((cut, map)) = self.geometry.cut_out(index) else {
                self.shades[k].add(veil, [from, to], self.span, self.together);
                continue;
            };
            let spot = |end: &End| {
                let (lower, upper, f) = end.edge;
                cut.corner(lower).lerp(cut.corner(upper), f)
            };
            let (first, last) = (spot(&a), spot(&b));
            let line = [first.lerp(last, f), first.lerp(last, g)];
            // Only over what is still lit.
            self.lit.clear();
            let (low, high) = (
                from.min(to).max(self.span[0]),
                from.max(to).min(self.span[1]),
            );
            gaps(&self.shades[k].dark, low, high, &mut self.lit);
            for gap in &self.lit {
                let [p, q] = gap.map(|t| ((t - from) / (to - from)).clamp(0.0, 1.0));
                let within = if p < q { [p, q] } else { [q, p] };
                let shade = &mut self.shades[k];
                map.solid_parts(line, within, |p, q| {
                    let mix = |f: f64| from + f * (to - from);
                    shade.add(veil, [mix(p), mix(q)], self.span, self.together);
                });
            }
        }
    }
}

/// An end of the line in which a half-plane cuts a triangle.
#[derive(Clone, Copy)]
struct End {
    /// Height above the ray.
    y: f64,
    /// Place along the ray.
    z: f64,
    /// The edge that is cut, from corner to corner, and how far along.
    edge: (usize, usize, f64),
}

impl End {
    /// Weights of the second and third corner.
    fn weights(&self) -> DVec2 {
        let (lower, upper, f) = self.edge;
        weights(lower).lerp(weights(upper), f)
    }
}

/// Weights of the second and third corner at one of them.
pub(super) fn weights(corner: usize) -> DVec2 {
    [DVec2::ZERO, DVec2::X, DVec2::Y][corner]
}
