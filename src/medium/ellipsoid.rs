//! Smoke inside an ellipsoid: chords of rays, and where its shadow meets a ray.

use super::line::{Bulge, Chord};
use super::shape::Edge;
use glam::{DQuat, DVec3};

/// An ellipsoid; in its own axes, in units of its radii, it is the unit sphere.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ellipsoid {
    pub center: DVec3,
    pub radii: DVec3,
    pub rotation: DQuat,
    pub edge: Edge,
}

impl Ellipsoid {
    fn own(&self, v: DVec3) -> DVec3 {
        self.rotation.conjugate() * v / self.radii
    }

    /// Density at a point, relative to the centre.
    pub fn density(&self, point: DVec3) -> f64 {
        let square = self.own(point - self.center).length_squared();
        match self.edge {
            Edge::Sharp => f64::from(u8::from(square <= 1.0)),
            Edge::Soft => (1.0 - square).max(0.0),
        }
    }

    /// The part of a line inside, before its origin too.
    fn line(&self, origin: DVec3, direction: DVec3) -> Option<Chord> {
        let (p, q) = (self.own(origin - self.center), self.own(direction));
        let rate = q.length_squared();
        let middle = -p.dot(q) / rate;
        let square = (1.0 - (p + middle * q).length_squared()) / rate;
        (square > 0.0 && square.is_finite()).then(|| Chord {
            from: middle - square.sqrt(),
            to: middle + square.sqrt(),
            bulge: (self.edge == Edge::Soft).then_some(Bulge {
                middle,
                square,
                rate,
            }),
        })
    }

    /// The part of a ray's first `distance` metres inside.
    pub fn chord(&self, origin: DVec3, direction: DVec3, distance: f64) -> Option<Chord> {
        let line = self.line(origin, direction)?;
        let chord = Chord {
            from: line.from.max(0.0),
            to: line.to.min(distance),
            ..line
        };
        (chord.to > chord.from).then_some(chord)
    }

    /// The part of a ray's line that lies in the cylinder around it along the sun's rays: its shadow, or before it. Endless for a ray
    /// along the sun's within the cylinder.
    pub fn in_line_with(
        &self,
        origin: DVec3,
        direction: DVec3,
        toward_sun: DVec3,
    ) -> Option<[f64; 2]> {
        let (p, q) = (self.own(origin - self.center), self.own(direction));
        let sun = self.own(toward_sun).normalize();
        let across = |v: DVec3| v - v.dot(sun) * sun;
        let (a, b) = (across(p), across(q));
        let rate = b.length_squared();
        if rate <= 1e-30 * q.length_squared() {
            let is_within = a.length_squared() <= 1.0;
            return is_within.then_some([f64::NEG_INFINITY, f64::INFINITY]);
        }
        let middle = -a.dot(b) / rate;
        let square = (1.0 - (a + middle * b).length_squared()) / rate;
        (square > 0.0).then(|| [middle - square.sqrt(), middle + square.sqrt()])
    }
}
