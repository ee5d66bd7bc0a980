//! Rectangles seen along a direction, and the depths of what lies within them: however far the triangles reach beyond.

use crate::conditions::Conditions;
use crate::scene::Projection;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// A rectangle across a direction [m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    pub min: DVec2,
    pub max: DVec2,
}

impl Window {
    pub const EMPTY: Window = Window {
        min: DVec2::INFINITY,
        max: DVec2::NEG_INFINITY,
    };

    pub fn with(self, at: DVec2) -> Window {
        Window {
            min: self.min.min(at),
            max: self.max.max(at),
        }
    }

    pub fn and(self, other: &Window) -> Window {
        Window {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    pub fn within(self, other: &Window) -> Window {
        Window {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    pub fn grown(self, by: DVec2) -> Window {
        Window {
            min: self.min - by,
            max: self.max + by,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    pub fn encloses(&self, other: &Window) -> bool {
        self.min.cmple(other.min).all() && self.max.cmpge(other.max).all()
    }
}

/// Triangles, whose corners come one after the other, in other axes.
pub fn placed(corners: &[DVec3], place: impl Fn(DVec3) -> DVec3 + Sync) -> Vec<[DVec3; 3]> {
    corners
        .par_chunks_exact(3)
        .map(|t| [place(t[0]), place(t[1]), place(t[2])])
        .collect()
}

/// Least and greatest height of what lies over or under each window [m]; 0 and 0 where nothing does.
pub fn heights(triangles: &[[DVec3; 3]], windows: &[Window]) -> Vec<(f64, f64)> {
    let none = || vec![(f64::INFINITY, f64::NEG_INFINITY); windows.len()];
    let with = |mut heights: Vec<(f64, f64)>, triangle: &[DVec3; 3]| {
        let bounds = triangle
            .iter()
            .fold(Window::EMPTY, |window, p| window.with(p.truncate()));
        for (window, heights) in windows.iter().zip(&mut heights) {
            if bounds.within(window).is_empty() {
                continue;
            }
            let mut count = |p: DVec3| *heights = (heights.0.min(p.z), heights.1.max(p.z));
            if window.encloses(&bounds) {
                triangle.iter().copied().for_each(count);
            } else {
                clipped(triangle, window).into_iter().for_each(&mut count);
            }
        }
        heights
    };
    let join = |a: Vec<(f64, f64)>, b: Vec<(f64, f64)>| {
        let pairs = a.into_iter().zip(b);
        pairs.map(|(a, b)| (a.0.min(b.0), a.1.max(b.1))).collect()
    };
    let found = triangles
        .par_iter()
        .with_min_len(4096)
        .fold(none, with)
        .reduce(none, join);
    let or_flat = |heights: (f64, f64)| match heights.0 <= heights.1 {
        true => heights,
        false => (0.0, 0.0),
    };
    found.into_iter().map(or_flat).collect()
}

/// The corners of what a window leaves of a triangle (Sutherland & Hodgman 1974).
fn clipped(triangle: &[DVec3; 3], window: &Window) -> Vec<DVec3> {
    let mut polygon = triangle.to_vec();
    for (axis, limit, sign) in [
        (0, window.min.x, 1.0),
        (0, window.max.x, -1.0),
        (1, window.min.y, 1.0),
        (1, window.max.y, -1.0),
    ] {
        let inside = |p: DVec3| sign * (p[axis] - limit);
        let mut next = Vec::with_capacity(polygon.len() + 1);
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let (a, b) = (inside(p), inside(q));
            if a >= 0.0 {
                next.push(p);
            }
            if (a >= 0.0) != (b >= 0.0) {
                next.push(p + (q - p) * (a / (a - b)));
            }
        }
        polygon = next;
    }
    polygon
}

/// The greatest depth of what an orthographic view has in its frame [m]; of other views nothing needs it.
///
/// Depths are even from the eye to there: a far end of the scene beside the frame does not make them coarse.
pub fn deepest(conditions: &Conditions, casters: &[DVec3]) -> f64 {
    let camera = &conditions.view.camera;
    let least = 1e-6 * conditions.geometry.extent();
    if !matches!(camera.projection, Projection::Orthographic { .. }) {
        return least;
    }
    let [right, up, forward] = camera.axes();
    let place = |p: DVec3| {
        let p = p - camera.eye;
        DVec3::new(right.dot(p), up.dot(p), forward.dot(p))
    };
    let triangles = placed(casters, place);
    let [w, h] = conditions.view.size.map(f64::from);
    // A pixel more, since samples lie beside the centres.
    let corners = [(-1.0, -1.0), (w + 1.0, h + 1.0)].map(|(x, y)| {
        let ray = camera.ray(DVec2::new(x, y), conditions.view.size);
        place(ray.origin).truncate()
    });
    let frame = Window::EMPTY.with(corners[0]).with(corners[1]);
    heights(&triangles, &[frame])[0].1.max(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_those_within_the_window() {
        // A plane z = x that reaches far, and something high elsewhere.
        let far = 1e5;
        let plane = [
            DVec3::new(-far, -far, -far),
            DVec3::new(far, -far, far),
            DVec3::new(0.0, far, 0.0),
        ];
        let tower = [DVec3::new(50.0, 0.0, 900.0); 3];
        let window = Window {
            min: DVec2::new(-2.0, -1.0),
            max: DVec2::new(3.0, 1.0),
        };
        let found = heights(&[plane, tower], &[window]);
        assert!(
            (found[0].0 + 2.0).abs() < 1e-9 && (found[0].1 - 3.0).abs() < 1e-9,
            "{found:?}"
        );
    }
}
