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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_are_those_of_a_sphere() {
        let sphere = Ellipsoid {
            center: DVec3::new(1.0, 2.0, 3.0),
            radii: DVec3::splat(2.0),
            rotation: DQuat::from_rotation_y(0.7),
            edge: Edge::Sharp,
        };
        // Half a radius beside the centre the chord is sqrt(3) radii long; from the centre it is one radius.
        let origin = sphere.center + DVec3::new(-10.0, 1.0, 0.0);
        let chord = sphere.chord(origin, DVec3::X, 100.0).expect("it is met");
        assert!((chord.from - 10.0 + 3f64.sqrt()).abs() < 1e-12);
        assert!((chord.to - 10.0 - 3f64.sqrt()).abs() < 1e-12);
        let chord = sphere
            .chord(sphere.center, DVec3::Z, 100.0)
            .expect("from within");
        assert!(chord.from == 0.0 && (chord.to - 2.0).abs() < 1e-12);
        assert!(sphere.chord(origin, DVec3::X, 7.0).is_none());
        assert!(sphere.chord(origin, -DVec3::X, 100.0).is_none());
        assert_eq!(
            sphere.density(sphere.center + DVec3::new(0.0, 1.9, 0.0)),
            1.0
        );
        assert_eq!(
            sphere.density(sphere.center + DVec3::new(0.0, 2.1, 0.0)),
            0.0
        );
    }

    #[test]
    fn a_shadow_is_where_the_way_to_the_sun_meets_the_body() {
        let body = Ellipsoid {
            center: DVec3::new(-3.0, 5.0, 2.0),
            radii: DVec3::new(1.0, 0.5, 3.0),
            rotation: DQuat::from_euler(glam::EulerRot::YXZ, 0.4, -0.9, 1.3),
            edge: Edge::Sharp,
        };
        let sun = DVec3::new(0.3, 0.8, -0.5).normalize();
        let origin = DVec3::new(1.0, 0.2, -4.0);
        let direction = (body.center - 4.0 * sun - origin).normalize();
        let [from, to] = body
            .in_line_with(origin, direction, sun)
            .expect("it is in shadow");
        // Whether the whole line through a point along the sun's rays meets the body, by its own chord.
        let is_shaded = |t: f64| body.line(origin + t * direction, sun).is_some();
        let margin = 1e-6 * (to - from);
        assert!(to - from > 0.5);
        assert!(is_shaded(from + margin) && is_shaded(to - margin));
        assert!(!is_shaded(from - margin) && !is_shaded(to + margin));
        // Along the sun's rays all is in line or nothing; beside the body nothing is.
        let endless = Some([f64::NEG_INFINITY, f64::INFINITY]);
        assert_eq!(
            body.in_line_with(body.center - 9.0 * sun, sun, sun),
            endless
        );
        assert!(
            body.in_line_with(body.center + 9.0 * sun.any_orthonormal_vector(), sun, sun)
                .is_none()
        );
        let beside = origin + 20.0 * direction.cross(sun).normalize();
        assert!(body.in_line_with(beside, direction, sun).is_none());
    }
}
