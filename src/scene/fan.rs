//! Exact dark runs of a ray under light from a place near by: the fan.
//!
//! The ways from a lamp to the points of a ray fill a fan, a part of the plane that holds both. Every triangle that the plane
//! cuts darkens exactly one interval of the ray: that onto which its cut is projected from the lamp. In the ray's frame, with the
//! lamp at height Y over the place Z of the ray, a point at height y, 0 <= y < Y, over the place z shades t = (z Y - Z y) / (Y - y).
//! On the cut this has no pole, so that the interval's ends are those of the cut.

use super::Ray;
use super::curtain::weights;
use super::geometry::Geometry;
use super::shade::{Run, Shade};
use glam::{DMat3, DVec3};

/// A lamp nearer to the ray than this share of the scene's diagonal lies on it.
const ON_RAY: f64 = 1e-12;

/// What is nearer to the lamp's height than this share of it shades the ray's ends.
const BESIDE_LAMP: f64 = 1e-12;

impl Geometry {
    /// What keeps the light of a place off the first `far` metres of a ray.
    pub(super) fn fan(&self, ray: &Ray, far: f64, lamp: DVec3, shade: &mut Shade) {
        let r = ray.direction;
        let base = ray.origin - self.origin;
        let way = lamp - ray.origin;
        let along = way.dot(r);
        let across = way - along * r;
        let height = across.length();
        if height <= ON_RAY * (self.extent + along.abs()) {
            return self.along_ray(ray, far, along, shade);
        }
        let m = across / height;
        let n = m.cross(r);
        let to_frame = DMat3::from_cols(n, m, r).transpose();
        let together = 1e-13 * (far.min(self.extent + base.length()) + self.extent);
        // The fan's other two sides go through the lamp: it lies where the first is positive, and the second negative (NaN of a ray
        // without end, which leaves nothing out).
        let side = |to: f64| (height * r + (to - along) * m) / height.hypot(to - along);
        let (first, last) = (side(0.0), side(far));
        let mut stack = vec![0u32];
        while let Some(top) = stack.pop() {
            let node = &self.nodes[top as usize];
            // Boxes are in f32: nothing that the plane may cut is skipped.
            let middle = node.middle.as_dvec3() - base;
            let half =
                node.half.as_dvec3() + 1e-6 * (self.extent + base.length()) + 1e-14 * way.length();
            let reach = |across: DVec3| across.abs().dot(half);
            let up = m.dot(middle);
            if n.dot(middle).abs() > reach(n)
                || (up - 0.5 * height).abs() > 0.5 * height + reach(m)
                || first.dot(middle - way) < -reach(first)
                || last.dot(middle - way) > reach(last)
            {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, node.first + 1]);
                continue;
            }
            for index in node.first..node.first + node.count {
                let points = self.corners[index as usize].map(|p| to_frame * (p - base));
                let lamp = [height, along];
                self.shade(index as usize, &points, lamp, [0.0, far], together, shade);
            }
        }
    }

    /// Darkens what one triangle shades, its corners and the lamp (height and place) in the ray's frame (n, m, r).
    fn shade(
        &self,
        index: usize,
        points: &[DVec3; 3],
        [height, along]: [f64; 2],
        span: Run,
        together: f64,
        shade: &mut Shade,
    ) {
        // A triangle whose plane holds the lamp, as the lamp's own face does, is seen edge on.
        let [p, q, s] = points;
        let normal = (q - p).cross(s - p);
        let lamp = DVec3::new(0.0, height, along);
        if normal.dot(lamp - p).abs() <= together * normal.length() {
            return;
        }
        let below = points.map(|p| p.x < 0.0);
        // The corner that lies alone on its side of the plane; its two edges are cut.
        let alone = match below {
            [a, b, c] if a == b && b == c => return,
            [a, b, _] if a == b => 2,
            [a, _, c] if a == c => 1,
            _ => 0,
        };
        let cut = |other: usize| {
            // From the lower to the upper side, so that both triangles of an edge find the same point.
            let (lower, upper) = if below[alone] {
                (alone, other)
            } else {
                (other, alone)
            };
            let (p, q) = (points[lower], points[upper]);
            let f = p.x / (p.x - q.x);
            (p.lerp(q, f), (lower, upper, f))
        };
        let (a, edge_a) = cut((alone + 1) % 3);
        let (b, edge_b) = cut((alone + 2) % 3);
        // The part of the cut between the ray and the lamp's height.
        let (mut from, mut to) = (0.0f64, 1.0f64);
        let rise = b.y - a.y;
        let top = height * (1.0 - BESIDE_LAMP);
        for (start, least) in [(a.y, true), (top - a.y, false)] {
            let slope = if least { rise } else { -rise };
            if slope == 0.0 {
                if start < 0.0 {
                    return;
                }
            } else if slope > 0.0 {
                from = from.max(-start / slope);
            } else {
                to = to.min(-start / slope);
            }
        }
        if from >= to {
            return;
        }
        let shaded = |f: f64| {
            let p = a.lerp(b, f);
            let y = p.y.clamp(0.0, top);
            (p.z * height - along * y) / (height - y)
        };
        if self.glazing.is_some() {
            let [first, last] =
                [edge_a, edge_b].map(|(lower, upper, f)| weights(lower).lerp(weights(upper), f));
            let line = [first.lerp(last, from), first.lerp(last, to)];
            let normal = normal.normalize();
            let at = |f: f64| from + f * (to - from);
            let cosine = |f: f64| normal.dot((lamp - a.lerp(b, at(f))).normalize_or_zero());
            self.colours(index, line, cosine, |p, q, through| {
                shade.tint(through, [p, q].map(|f| shaded(at(f))), span);
            });
            return;
        }
        let veil = self.veil(index);
        let Some((cut, map)) = self.cut_out(index) else {
            shade.add(veil, [shaded(from), shaded(to)], span, together);
            return;
        };
        let spot =
            |(lower, upper, f): (usize, usize, f64)| cut.corner(lower).lerp(cut.corner(upper), f);
        let (first, last) = (spot(edge_a), spot(edge_b));
        let line = [first.lerp(last, from), first.lerp(last, to)];
        let at = |f: f64| shaded(from + f * (to - from));
        map.solid_parts(line, [0.0, 1.0], |p, q| {
            shade.add(veil, [at(p), at(q)], span, together);
        });
    }

    /// What shades a ray on which the lamp itself lies: what stands before the lamp does up to itself, what stands behind it from
    /// there on.
    fn along_ray(&self, ray: &Ray, far: f64, lamp: f64, shade: &mut Shade) {
        let origin = ray.at(lamp);
        if self.glazing.is_some() {
            let look = |direction: DVec3, reach: f64| {
                self.crossings(&Ray { origin, direction }, 0.0, reach)
            };
            for (distance, through) in look(-ray.direction, lamp.max(0.0)) {
                shade.tint(through, [0.0, lamp - distance], [0.0, far]);
            }
            for (distance, through) in look(ray.direction, f64::INFINITY) {
                shade.tint(through, [lamp + distance, far], [0.0, far]);
            }
            return;
        }
        let mut look = |direction: DVec3, reach: f64, run: &dyn Fn(f64) -> Run| {
            let (solid, veils) = self.met(&Ray { origin, direction }, 0.0, reach);
            let solid = solid.map(|hit| (hit.distance, None));
            let veils = veils
                .iter()
                .map(|v| (v.hit.distance, Some((v.kind, v.pass))));
            for (distance, veil) in veils.chain(solid) {
                shade.add(veil, run(distance), [0.0, far], 0.0);
            }
        };
        look(-ray.direction, lamp.max(0.0), &|distance| {
            [0.0, lamp - distance]
        });
        look(ray.direction, f64::INFINITY, &|distance| {
            [lamp + distance, far]
        });
    }
}
