//! Cutting a polygon into triangles.

use glam::{DVec2, DVec3};

/// Splits a simple polygon, convex or not, into triangles by cutting ears in the plane of its area vector.
///
/// The triangles keep its winding; there are always `corners.len() - 2`, also of a polygon that crosses itself. False when
/// some of them are not ears: it crosses itself, has no area, or its outline is too intricate for work that grows with
/// its corners.
pub(super) fn triangulate(
    positions: &[DVec3],
    corners: &[u32],
    triangles: &mut Vec<[u32; 3]>,
) -> bool {
    match *corners {
        [] | [_] | [_, _] => return true,
        [a, b, c] => {
            triangles.push([a, b, c]);
            return true;
        }
        _ => {}
    }
    let at = |i: usize| positions[corners[i] as usize];
    let count = corners.len();
    let normal: DVec3 = (1..count - 1)
        .map(|i| (at(i) - at(0)).cross(at(i + 1) - at(0)))
        .sum();
    let flat = flattened((0..count).map(at), normal);
    let outline = flat.and_then(Outline::new);
    let Some(mut outline) = outline else {
        triangles.extend((1..count - 1).map(|i| [0, i, i + 1].map(|i| corners[i])));
        return false;
    };
    let mut all_ears = true;
    let mut corner = 0;
    for _ in 3..count {
        let ear = outline.ear_from(corner);
        all_ears &= ear.is_some();
        // Without an ear any corner will do.
        let ear = ear.unwrap_or(outline.next[corner]);
        let (before, after) = outline.cut(ear);
        triangles.push([before, ear, after].map(|i| corners[i]));
        corner = after;
    }
    let (before, after) = (outline.previous[corner], outline.next[corner]);
    triangles.push([before, corner, after].map(|i| corners[i]));
    all_ears
}

/// The polygon seen along the axis nearest to its area vector, so that it turns left; `None` without an area.
///
/// Leaving a coordinate out rounds nothing.
fn flattened(corners: impl Iterator<Item = DVec3>, normal: DVec3) -> Option<Vec<DVec2>> {
    let size = normal.abs();
    let largest = size.max_element();
    if !(largest.is_finite() && largest > 0.0) {
        return None;
    }
    let project = |p: DVec3| match largest {
        l if l == size.z => DVec2::new(p.x, p.y),
        l if l == size.y => DVec2::new(p.z, p.x),
        _ => DVec2::new(p.y, p.z),
    };
    let sign = match largest {
        l if l == size.z => normal.z,
        l if l == size.y => normal.y,
        _ => normal.x,
    };
    let mirror = DVec2::new(1.0, sign.signum());
    Some(corners.map(|p| project(p) * mirror).collect())
}

/// What is left of a polygon.
struct Outline {
    points: Vec<DVec2>,
    previous: Vec<usize>,
    next: Vec<usize>,
    /// Whether the outline does not turn left there: only such corners can lie in an ear.
    dented: Vec<bool>,
    /// The dented corners along `axis`, with some that no longer are.
    dents: Vec<(f64, usize)>,
    dent_count: usize,
    /// The axis along which the polygon is longest: 0 or 1.
    axis: usize,
    /// Corners that may still be looked at.
    budget: usize,
}

impl Outline {
    fn new(points: Vec<DVec2>) -> Option<Self> {
        let count = points.len();
        let (least, most) = points
            .iter()
            .fold((points[0], points[0]), |(a, b), &p| (a.min(p), b.max(p)));
        let size = most - least;
        if !size.is_finite() {
            return None;
        }
        let mut places: Vec<[u64; 2]> = points
            .iter()
            .map(|p| p.to_array().map(f64::to_bits))
            .collect();
        places.sort_unstable();
        places.dedup();
        let repeats = 2 * places.len() < count;
        let mut outline = Outline {
            points,
            previous: (0..count).map(|i| (i + count - 1) % count).collect(),
            next: (0..count).map(|i| (i + 1) % count).collect(),
            dented: Vec::new(),
            dents: Vec::new(),
            dent_count: 0,
            axis: usize::from(size.y > size.x),
            // Enough for any outline of a hundred corners, and for those that buildings and maps have; less for one that keeps coming
            // back to the same places, which is no outline.
            budget: 10_000 + if repeats { 30 } else { 1000 } * count,
        };
        outline.dented = (0..count).map(|i| !outline.turns_left(i)).collect();
        outline.dents = (0..count)
            .filter(|&i| outline.dented[i])
            .map(|i| (outline.points[i][outline.axis], i))
            .collect();
        outline.dents.sort_by(|a, b| a.0.total_cmp(&b.0));
        outline.dent_count = outline.dents.len();
        Some(outline)
    }

    fn turns_left(&self, corner: usize) -> bool {
        let [a, b, c] = self.ear(corner);
        (b - a).perp_dot(c - b) > 0.0
    }

    /// The triangle that a corner spans with its neighbours.
    fn ear(&self, corner: usize) -> [DVec2; 3] {
        [self.previous[corner], corner, self.next[corner]].map(|i| self.points[i])
    }

    /// The first corner from `start` on that can be cut off.
    fn ear_from(&mut self, start: usize) -> Option<usize> {
        let mut corner = start;
        while self.budget > 0 {
            self.budget -= 1;
            if !self.dented[corner] && self.is_empty(corner) {
                return Some(corner);
            }
            corner = self.next[corner];
            if corner == start {
                break;
            }
        }
        None
    }

    /// Whether no other corner is in the triangle of this one.
    fn is_empty(&mut self, corner: usize) -> bool {
        let [a, b, c] = self.ear(corner);
        let least = a.min(b).min(c)[self.axis];
        let most = a.max(b).max(c)[self.axis];
        let from = self.dents.partition_point(|&(x, _)| x < least);
        for &(x, i) in &self.dents[from..] {
            if x > most {
                break;
            }
            if self.budget == 0 {
                return false;
            }
            self.budget -= 1;
            let p = self.points[i];
            let inside = |u: DVec2, v: DVec2| (v - u).perp_dot(p - v) >= 0.0;
            // Corners that meet one of the three are where a slit joins a hole to the outline.
            if self.dented[i]
                && p != a
                && p != b
                && p != c
                && inside(a, b)
                && inside(b, c)
                && inside(c, a)
            {
                return false;
            }
        }
        true
    }

    /// Takes a corner away; its neighbours.
    fn cut(&mut self, corner: usize) -> (usize, usize) {
        let (before, after) = (self.previous[corner], self.next[corner]);
        self.next[before] = after;
        self.previous[after] = before;
        self.straighten(corner);
        for neighbour in [before, after] {
            if self.dented[neighbour] && self.turns_left(neighbour) {
                self.straighten(neighbour);
            }
        }
        if self.dents.len() > 2 * self.dent_count + 16 {
            let dented = &self.dented;
            self.dents.retain(|&(_, i)| dented[i]);
        }
        (before, after)
    }

    fn straighten(&mut self, corner: usize) {
        if std::mem::replace(&mut self.dented[corner], false) {
            self.dent_count -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn areas(outline: &[(f64, f64)], lift: impl Fn(f64, f64) -> DVec3) -> (bool, Vec<f64>) {
        let positions: Vec<_> = outline.iter().map(|&(x, y)| lift(x, y)).collect();
        let corners: Vec<u32> = (0..outline.len() as u32).collect();
        let mut triangles = Vec::new();
        let clean = triangulate(&positions, &corners, &mut triangles);
        assert_eq!(triangles.len(), outline.len() - 2);
        let up = (lift(1.0, 0.0) - lift(0.0, 0.0)).cross(lift(0.0, 1.0) - lift(0.0, 0.0));
        let area = |t: [u32; 3]| {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            (b - a).cross(c - a).dot(up) / up.length_squared() / 2.0
        };
        (clean, triangles.into_iter().map(area).collect())
    }

    #[test]
    fn concave_polygon_keeps_its_area() {
        // An L of area 3; a fan from its first corner would cover the notch.
        let outline = [
            (2.0, 0.0),
            (2.0, 1.0),
            (1.0, 1.0),
            (1.0, 2.0),
            (0.0, 2.0),
            (0.0, 0.0),
        ];
        let axes: [fn(f64, f64) -> DVec3; 6] = [
            |x, y| DVec3::new(x, y, 5.0),
            |x, y| DVec3::new(y, x, 5.0),
            |x, y| DVec3::new(x, 5.0, y),
            |x, y| DVec3::new(y, 5.0, x),
            |x, y| DVec3::new(5.0, x, y),
            |x, y| DVec3::new(5.0, y, x),
        ];
        for lift in axes {
            for start in 0..6 {
                let mut turned = outline;
                turned.rotate_left(start);
                let (clean, areas) = areas(&turned, lift);
                assert!(clean && areas.iter().all(|&a| a > 0.0), "{areas:?}");
                assert_eq!(areas.iter().sum::<f64>(), 3.0);
            }
        }
    }

    #[test]
    fn a_hole_that_a_slit_joins_stays_open() {
        // A square of side 3 with a hole of side 1, joined at (0, 0) to (1, 1).
        let outline = [
            (0.0, 0.0),
            (3.0, 0.0),
            (3.0, 3.0),
            (0.0, 3.0),
            (0.0, 0.0),
            (1.0, 1.0),
            (1.0, 2.0),
            (2.0, 2.0),
            (2.0, 1.0),
            (1.0, 1.0),
        ];
        let (clean, areas) = areas(&outline, |x, y| DVec3::new(x, y, 0.0));
        assert!(clean, "{areas:?}");
        assert!(areas.iter().all(|&a| a >= 0.0), "{areas:?}");
        assert_eq!(areas.iter().sum::<f64>(), 8.0);
    }

    #[test]
    fn work_grows_with_the_corners() {
        let circle = |n: usize, radius: fn(usize) -> f64| -> Vec<(f64, f64)> {
            (0..n)
                .map(|i| {
                    let (sin, cos) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
                    (radius(i) * cos, radius(i) * sin)
                })
                .collect()
        };
        let n = 100_000;
        let half_turn = std::f64::consts::PI / n as f64;
        for (outline, expected) in [
            (circle(n, |_| 1.0), (2.0 * half_turn).sin() / 2.0),
            (
                circle(n, |i| if i % 2 == 0 { 1.0 } else { 0.9 }),
                0.9 * (2.0 * half_turn).sin() / 2.0,
            ),
        ] {
            let started = std::time::Instant::now();
            let (clean, areas) = areas(&outline, |x, y| DVec3::new(x, y, 0.0));
            assert!(clean && areas.iter().all(|&a| a >= 0.0));
            let sum: f64 = areas.iter().sum();
            assert!((sum / (expected * n as f64) - 1.0).abs() < 1e-9, "{sum}");
            assert!(started.elapsed().as_secs() < 5, "{:?}", started.elapsed());
        }
        // Nothing but crossings: no ears, the same number of triangles, and an end.
        let tangle: Vec<_> = (0..n)
            .map(|i| ((i * 7919 % n) as f64, (i * 104_729 % n) as f64))
            .collect();
        let started = std::time::Instant::now();
        areas(&tangle, |x, y| DVec3::new(x, y, 0.0));
        assert!(started.elapsed().as_secs() < 5, "{:?}", started.elapsed());
    }
}
