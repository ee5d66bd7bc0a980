//! Exact lit and dark runs of a ray: the curtain.
//!
//! Light that is parallel reaches the points of a ray along a half-plane, the curtain, which is bounded by the ray and swept
//! from it toward the sun. Every triangle that the curtain cuts darkens exactly one interval of the ray (a cut-out triangle:
//! one for each run of solid texels). So the bounding volumes are searched for the half-plane instead of for many shadow rays:
//! no step, no missed sliver. These are the segments of Nishita, Miyawaki & Nakamae 1987 without their shadow volumes.
//!
//! Everything happens in the ray's own frame (n, m, r): r along the ray, m across it on the sun's side, n at right angles to
//! both. A point p of the curtain (p.n = 0, p.m = y >= 0) shades the ray at t = p.r - y cot(theta), theta being the angle
//! between the ray and the sun. Several suns (the points of its disc) share one search: each only turns the half-plane a
//! little about the ray.

use super::Ray;
use super::geometry::{CutOut, Geometry};
use glam::{DVec2, DVec3, Vec3A};

/// A run of a ray between two distances [m].
pub type Run = [f64; 2];

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
    /// The dark runs of the first `far` metres of a ray, for each of `suns` (unit vectors toward it).
    ///
    /// `dark[k]` is overwritten with the runs that `suns[k]` does not reach, in order and apart from each other.
    /// Exact but for f64 rounding.
    pub fn dark_runs(&self, ray: &Ray, far: f64, suns: &[DVec3], dark: &mut Vec<Vec<Run>>) {
        dark.resize_with(suns.len(), Vec::new);
        dark.iter_mut().for_each(Vec::clear);
        if self.corners.is_empty() || far <= 0.0 {
            return;
        }
        let r = ray.direction;
        // The frame's origin is the point of the ray nearest to the scene, so that a far eye costs no digits.
        let near = (self.origin - ray.origin).dot(r).clamp(0.0, far);
        let base = (ray.origin - self.origin) + near * r;
        let mean: DVec3 = suns.iter().sum();
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
        for (k, sun) in suns.iter().enumerate() {
            let (y, x) = (sun.dot(m), sun.dot(n));
            let sine = y.hypot(x);
            if sine < PARALLEL {
                if self.occluded(
                    &Ray {
                        origin: ray.origin,
                        direction: *sun,
                    },
                    0.0,
                    f64::INFINITY,
                ) {
                    dark[k].push([0.0, far]);
                }
                continue;
            }
            which.push(k);
            planes.push(HalfPlane {
                cos: y / sine,
                sin: x / sine,
                cot: sun.dot(r) / sine,
            });
        }
        if planes.is_empty() {
            return;
        }
        let search = Search {
            geometry: self,
            frame: [n, m, r],
            base,
            planes: &planes,
            span: [-near, far - near],
        };
        search.run(|k, run| {
            let run = [(run[0] + near).max(0.0), (run[1] + near).min(far)];
            if run[1] > run[0] {
                dark[which[k]].push(run);
            }
        });
        let together = 1e-13 * (far + self.extent);
        for runs in dark.iter_mut() {
            merge(runs, together);
        }
    }
}

/// Sorts runs and joins those that touch (within `together`).
fn merge(runs: &mut Vec<Run>, together: f64) {
    runs.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let mut kept = 0;
    for i in 0..runs.len() {
        if kept > 0 && runs[i][0] <= runs[kept - 1][1] + together {
            runs[kept - 1][1] = runs[kept - 1][1].max(runs[i][1]);
        } else {
            runs[kept] = runs[i];
            kept += 1;
        }
    }
    runs.truncate(kept);
}

/// The runs of [0, far] between the given ones: from dark to lit and back.
pub fn complement(runs: &[Run], far: f64) -> impl Iterator<Item = Run> + '_ {
    let starts = std::iter::once(0.0).chain(runs.iter().map(|r| r[1]));
    let ends = runs.iter().map(|r| r[0]).chain(std::iter::once(far));
    starts.zip(ends).map(|(a, b)| [a, b]).filter(|[a, b]| b > a)
}

struct Search<'a> {
    geometry: &'a Geometry,
    frame: [DVec3; 3],
    base: DVec3,
    planes: &'a [HalfPlane],
    span: Run,
}

impl Search<'_> {
    fn run(&self, mut found: impl FnMut(usize, Run)) {
        let [n, m, r] = self.frame.map(|v| v.as_vec3a());
        let (na, ma, ra) = (n.abs(), m.abs(), r.abs());
        let base = self.base.as_vec3a();
        let planes: Vec<[f32; 3]> = self
            .planes
            .iter()
            .map(|p| [p.cos as f32, p.sin as f32, p.cot as f32])
            .collect();
        // f32 rounding of the frame's coordinates, several times over.
        let slack = 1e-6 * (self.geometry.extent as f32 + base.length());
        let (first, last) = (self.span[0] as f32, self.span[1] as f32);
        let cut = |node: usize| {
            let (centre, half) = self.geometry.node_box(node);
            let c: Vec3A = centre - base;
            let (x, y, z) = (n.dot(c), m.dot(c), r.dot(c));
            let (hx, hy, hz) = (
                na.dot(half) + slack,
                ma.dot(half) + slack,
                ra.dot(half) + slack,
            );
            planes.iter().any(|&[cos, sin, cot]| {
                let aside = (cos * x - sin * y).abs() - cos.abs() * hx - sin.abs() * hy;
                let height = cos * y + sin * x;
                let reach = cos.abs() * hy + sin.abs() * hx;
                let (low, high) = ((height - reach).max(0.0), height + reach);
                let (a, b) = (low * cot, high * cot);
                let margin = slack * (1.0 + cot.abs());
                aside <= 0.0
                    && high >= 0.0
                    && z + hz - a.min(b) + margin >= first
                    && z - hz - a.max(b) - margin <= last
            })
        };
        let nodes = &self.geometry.planes.nodes;
        let mut stack = Vec::with_capacity(64);
        stack.push(0u32);
        while let Some(top) = stack.pop() {
            if !cut(top as usize) {
                continue;
            }
            let node = &nodes[top as usize];
            if node.prim_count == 0 {
                stack.push(node.first_index);
                stack.push(node.first_index + 1);
                continue;
            }
            for slot in node.first_index..node.first_index + node.prim_count {
                let index = self.geometry.planes.primitive_indices[slot as usize] as usize;
                self.triangle(index, &mut found);
            }
        }
    }

    /// The run of the ray that one triangle darkens, for each half-plane that cuts it.
    fn triangle(&self, index: usize, found: &mut impl FnMut(usize, Run)) {
        let [n, m, r] = self.frame;
        let points = self.geometry.corners[index].map(|p| {
            let p = p - self.base;
            [p.dot(n), p.dot(m), p.dot(r)]
        });
        let cut_out = self.geometry.cut_outs[index].as_ref();
        for (k, plane) in self.planes.iter().enumerate() {
            let side = points.map(|[x, y, _]| plane.cos * x - plane.sin * y);
            let below = side.map(|s| s < 0.0);
            if below[0] == below[1] && below[1] == below[2] {
                continue;
            }
            let mut ends = [End::default(); 2];
            let mut count = 0;
            for i in 0..3 {
                let j = (i + 1) % 3;
                if below[i] == below[j] {
                    continue;
                }
                // From the lower to the upper side, so that both triangles of an edge find the same point.
                let (lower, upper) = if below[i] { (i, j) } else { (j, i) };
                let f = side[lower] / (side[lower] - side[upper]);
                let mix = |a: f64, b: f64| a + f * (b - a);
                let height = |p: [f64; 3]| plane.cos * p[1] + plane.sin * p[0];
                ends[count] = End {
                    y: mix(height(points[lower]), height(points[upper])),
                    z: mix(points[lower][2], points[upper][2]),
                    uv: cut_out.map_or(DVec2::ZERO, |c| c.uvs[lower].lerp(c.uvs[upper], f)),
                };
                count += 1;
            }
            let [mut a, mut b] = ends;
            if a.y < 0.0 && b.y < 0.0 {
                continue;
            }
            // Only what stands on the sun's side of the ray shades it.
            if a.y < 0.0 {
                a = a.raised(&b);
            } else if b.y < 0.0 {
                b = b.raised(&a);
            }
            let (ta, tb) = (a.z - a.y * plane.cot, b.z - b.y * plane.cot);
            match cut_out {
                None => found(k, [ta.min(tb), ta.max(tb)]),
                Some(cut) => self.solid_parts(cut, a.uv, b.uv, |f, g| {
                    let (t, u) = (ta + f * (tb - ta), ta + g * (tb - ta));
                    found(k, [t.min(u), t.max(u)]);
                }),
            }
        }
    }

    /// The parts of a straight line over a texture on which it is solid, as fractions of the line, texel by texel.
    fn solid_parts(&self, cut: &CutOut, from: DVec2, to: DVec2, mut found: impl FnMut(f64, f64)) {
        let size = self.geometry.texture_size(cut);
        let mut borders = vec![0.0, 1.0];
        for axis in 0..2 {
            let (a, b) = (from[axis] * size[axis], to[axis] * size[axis]);
            let (low, high) = (a.min(b), a.max(b));
            let mut border = low.floor() + 1.0;
            while border < high {
                borders.push((border - a) / (b - a));
                border += 1.0;
            }
        }
        borders.sort_unstable_by(f64::total_cmp);
        for pair in borders.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            if pair[1] > pair[0] && self.geometry.opaque(cut, from.lerp(to, middle)) {
                found(pair[0], pair[1]);
            }
        }
    }
}

/// An end of the line in which a half-plane cuts a triangle.
#[derive(Clone, Copy, Default)]
struct End {
    /// Height above the ray.
    y: f64,
    /// Place along the ray.
    z: f64,
    uv: DVec2,
}

impl End {
    /// The point at height 0 on the way to an end that is above it.
    fn raised(&self, other: &End) -> End {
        let f = self.y / (self.y - other.y);
        End {
            y: 0.0,
            z: self.z + f * (other.z - self.z),
            uv: self.uv.lerp(other.uv, f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_runs_become_one_and_the_rest_is_lit() {
        let mut runs = vec![[5.0, 6.0], [1.0, 2.0], [2.0, 3.0], [1.5, 1.6]];
        merge(&mut runs, 0.0);
        assert_eq!(runs, [[1.0, 3.0], [5.0, 6.0]]);
        let lit: Vec<Run> = complement(&runs, 6.0).collect();
        assert_eq!(lit, [[0.0, 1.0], [3.0, 5.0]]);
    }
}
