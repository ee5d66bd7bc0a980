//! A homogeneous medium as a region of space: chords of rays, and where the depth toward the sun bends.

use super::shape::FARTHEST;
use glam::DVec3;

/// A homogeneous medium as an axis-aligned region, endless where its bounds are infinite.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    pub min: DVec3,
    pub max: DVec3,
}

impl Region {
    /// The part of a half-line inside, as distances; an empty one has its end before its start.
    pub fn chord(&self, origin: DVec3, direction: DVec3) -> (f64, f64) {
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            if d == 0.0 {
                if o < self.min[axis] || o > self.max[axis] {
                    return (0.0, -1.0);
                }
                continue;
            }
            let (a, b) = ((self.min[axis] - o) / d, (self.max[axis] - o) / d);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter, leave)
    }

    /// Whether a point is inside.
    pub fn holds(&self, point: DVec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    /// Whether it may meet the plane through a point across a direction of any length, 0 included.
    pub fn meets(&self, point: DVec3, across: DVec3) -> bool {
        let (middle, half) = (0.5 * (self.min + self.max), 0.5 * (self.max - self.min));
        // A hair is left for rounding. Endless regions give no number, and meet everything.
        let apart = (middle - point).dot(across).abs();
        let reach = half.dot(across.abs()) + 1e-9 * (middle - point).abs().dot(across.abs());
        apart.is_nan() || reach.is_nan() || apart <= reach
    }

    /// Length of the half-line from a point toward the sun inside.
    pub fn depth(&self, point: DVec3, toward_sun: DVec3) -> f64 {
        let (enter, leave) = self.chord(point, toward_sun);
        (leave - enter).clamp(0.0, FARTHEST)
    }

    /// Distances along a ray at which [`Region::depth`] bends: where the plane of ray and sun meets the region's edges,
    /// and where the ray meets its faces.
    pub fn bends(&self, origin: DVec3, direction: DVec3, toward_sun: DVec3, out: &mut Vec<f64>) {
        let (enter, leave) = self.chord(origin, direction);
        if leave > enter {
            out.extend([enter, leave]);
        }
        for (a, b, c) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            let determinant = direction[a] * toward_sun[b] - direction[b] * toward_sun[a];
            if determinant == 0.0 {
                continue;
            }
            for face_a in [self.min[a], self.max[a]] {
                for face_b in [self.min[b], self.max[b]] {
                    let (p, q) = (face_a - origin[a], face_b - origin[b]);
                    let t = (p * toward_sun[b] - q * toward_sun[a]) / determinant;
                    let s = (direction[a] * q - direction[b] * p) / determinant;
                    let third = origin[c] + t * direction[c] + s * toward_sun[c];
                    let slack = 1e-9 * (self.max[c] - self.min[c]);
                    let met = third >= self.min[c] - slack && third <= self.max[c] + slack;
                    if t.is_finite() && s >= 0.0 && (met || slack.is_infinite()) {
                        out.push(t);
                    }
                }
            }
        }
    }
}
