//! What cuts a half-plane that a line through an eye and a lamp bounds: the same for all rays from the eye in it.
//!
//! In the half-plane the line from the eye over the lamp is x, and y >= 0 lies across. Every triangle that it cuts is a line there, and
//! darkens the interval of a ray onto which that is projected from the lamp, as in the fan of a single ray (`super::fan`).

use super::Ray;
use super::geometry::Geometry;
use super::shade::{Run, Shade};
use glam::{DMat3, DVec2, DVec3};

/// What is nearer to the lamp's height over a ray than this share of it shades the ray's ends.
const BESIDE_LAMP: f64 = 1e-12;

/// A half-plane and what cuts it.
#[derive(Debug, Clone)]
pub struct HalfPlane {
    /// How far the lamp is from the eye [m].
    lamp: f64,
    cuts: Vec<Cut>,
    together: f64,
}

/// The line in which a triangle cuts a half-plane.
#[derive(Debug, Clone, Copy)]
struct Cut {
    ends: [DVec2; 2],
    veil: Option<(u32, f64)>,
}

impl Geometry {
    /// What cuts the half-plane on the side of `across`, a unit vector, of the line along `way`, a ray from the eye to a lamp that is
    /// `lamp` away [m]. What has holes counts as solid.
    pub fn half_plane(&self, way: &Ray, lamp: f64, across: DVec3) -> HalfPlane {
        let base = way.origin - self.origin;
        let along = way.direction;
        let n = across.cross(along);
        let to_frame = DMat3::from_cols(along, across, n).transpose();
        let together = 1e-13 * (self.extent + base.length());
        let mut cuts = Vec::new();
        let mut stack = match self.corners.is_empty() {
            true => Vec::new(),
            false => vec![0u32],
        };
        while let Some(top) = stack.pop() {
            let node = &self.nodes[top as usize];
            // Boxes are in f32: nothing that the half-plane may cut is skipped.
            let middle = node.middle.as_dvec3() - base;
            let half = node.half.as_dvec3() + 1e-6 * (self.extent + base.length());
            let reach = |across: DVec3| across.abs().dot(half);
            if n.dot(middle).abs() > reach(n) || across.dot(middle) < -reach(across) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, node.first + 1]);
                continue;
            }
            for index in node.first..node.first + node.count {
                let points = self.corners[index as usize].map(|p| to_frame * (p - base));
                let ends = cut(&points, lamp, together);
                let veil = self.veil(index as usize);
                cuts.extend(ends.map(|ends| Cut { ends, veil }));
            }
        }
        HalfPlane {
            lamp,
            cuts,
            together,
        }
    }
}

/// The line in which a triangle cuts the plane z = 0; none of one whose own plane holds the lamp, which is seen edge on.
fn cut([p, q, s]: &[DVec3; 3], lamp: f64, together: f64) -> Option<[DVec2; 2]> {
    let normal = (*q - *p).cross(*s - *p);
    if normal.dot(DVec3::X * lamp - *p).abs() <= together * normal.length() {
        return None;
    }
    let crossed = |a: &DVec3, b: &DVec3| {
        // From the lower to the upper side, so that both triangles of an edge find the same point.
        let (a, b) = if a.z < b.z { (a, b) } else { (b, a) };
        (a.z < 0.0 && b.z >= 0.0).then(|| a.lerp(*b, a.z / (a.z - b.z)).truncate())
    };
    let mut found = [(p, q), (q, s), (s, p)]
        .into_iter()
        .filter_map(|(a, b)| crossed(a, b));
    Some([found.next()?, found.next()?])
}

impl HalfPlane {
    /// What keeps the lamp's light off the first `far` metres of a ray from the eye in the half-plane, by the cosine and sine of its
    /// angle with the way to the lamp.
    pub fn shade(&self, [cos, sin]: [f64; 2], far: f64, shade: &mut Shade) {
        shade.clear();
        let (height, along) = (self.lamp * sin, self.lamp * cos);
        for Cut { ends, veil } in &self.cuts {
            // Along the ray, and toward the lamp.
            let [a, b] = ends.map(|p| DVec2::new(cos * p.x + sin * p.y, sin * p.x - cos * p.y));
            if let Some(run) = shaded(a, b, height, along) {
                shade.add(*veil, run, [0.0, far], self.together);
            }
        }
    }
}

/// What of a ray a line shades, under a lamp at a height over a place of it.
fn shaded(a: DVec2, b: DVec2, height: f64, along: f64) -> Option<Run> {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    let rise = b.y - a.y;
    let top = height * (1.0 - BESIDE_LAMP);
    for (start, slope) in [(a.y, rise), (top - a.y, -rise)] {
        if slope == 0.0 {
            if start < 0.0 {
                return None;
            }
        } else if slope > 0.0 {
            from = from.max(-start / slope);
        } else {
            to = to.min(-start / slope);
        }
    }
    let place = |f: f64| {
        let p = a.lerp(b, f);
        let y = p.y.clamp(0.0, top);
        (p.x * height - along * y) / (height - y)
    };
    (from < to).then(|| [place(from), place(to)])
}
