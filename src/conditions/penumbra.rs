//! How wide the edges of shadows are in the picture.

use super::Conditions;
use crate::beam::Beam;
use crate::scene::Projection;
use crate::scene::edges::Edges;
use glam::DVec2;
use std::ops::RangeInclusive;

/// Above so many of its radii the sun's disc counts as one direction for what the air takes of its light.
const LOW: f64 = 8.0;

/// The angular radii of discs whose edges are told [rad]: a smaller one is a point to f32, a larger one is not flat.
const TOLD: RangeInclusive<f64> = 1e-6..=0.01;

impl Conditions {
    /// The beams of the sun's disc that shadows are made for: `count` of them, or one where no penumbra is as wide as a pixel.
    pub fn sun_beams(&self, count: usize) -> Vec<Beam> {
        let one = self.view.points().is_none() && self.widest_penumbra() < 1.0;
        self.sun.beams(if one { 1 } else { count })
    }

    /// The edges of shadows as the sun's disc makes them, and the beam that stands for its light as a whole; `None` where one point or
    /// several have to do: no penumbra is as wide as a pixel, the disc is wider than 1.1 degrees, or the sun is so low that its light comes
    /// through other air from its lower edge than from its upper one.
    pub fn sun_edges(&self) -> Option<(Edges, Beam)> {
        let beam = self.whole_sun()?;
        Some((Edges::new(&self.geometry, self.sun.disc()?), beam))
    }

    /// The beam that stands for the light of the sun's whole disc where [`Conditions::sun_edges`] has its edges.
    pub fn whole_sun(&self) -> Option<Beam> {
        let radius = self.sun.angular_radius();
        let elevation = self.sun.toward.y.clamp(-1.0, 1.0).asin();
        let is_told = TOLD.contains(&radius) && elevation >= LOW * radius;
        let is_narrow = self.view.points().is_none() && self.widest_penumbra() < 1.0;
        (is_told && !is_narrow).then_some(Beam::Parallel {
            toward: self.sun.toward,
            illuminance: self.sun.light.illuminance,
            angular_radius: radius,
        })
    }

    /// No penumbra in the air or on the ground is wider in the picture than this [pixels]; infinite where that cannot be said.
    ///
    /// The edge of a shadow is as wide as the sun's disc looks from behind it, s 2 tan(r): r the disc's angular radius, s the
    /// distance from the edge; on the ground longer by 1 / sin(elevation). All shadow lies in the sphere around the casters,
    /// drawn out along the light as far as there is ground or air to fall on; the distance to that from the eye says how large
    /// it can look. On faces of casters that the sun grazes it may be longer.
    pub fn widest_penumbra(&self) -> f64 {
        let (low, high) = self.geometry.bounds();
        let middle = 0.5 * (low + high);
        let radius = 0.5 * (high - low).length();
        let down = -self.sun.toward;
        // The lower edge of the disc throws the longest shadows.
        let lowest = (self.sun.toward.y.clamp(-1.0, 1.0).asin() - self.sun.angular_radius()).sin();
        if lowest <= 0.0 {
            return f64::INFINITY;
        }
        let to_ground = self
            .ground
            .map(|ground| (middle.y + radius - ground.height).max(0.0) / lowest);
        // Without ground, shadows end where bounded air does, and are without end in other air.
        let to_air = self.air.media.iter().map(|medium| match medium.bounds() {
            Some([min, max]) => {
                let far =
                    |i: usize| (down[i] * (min[i] - middle[i])).max(down[i] * (max[i] - middle[i]));
                far(0) + far(1) + far(2)
            }
            None => f64::INFINITY,
        });
        let length = to_ground
            .unwrap_or_else(|| to_air.fold(0.0, f64::max))
            .max(0.0);
        if !length.is_finite() {
            return f64::INFINITY;
        }
        let stretch = if self.ground.is_some() {
            1.0 / lowest
        } else {
            1.0
        };
        let width = (length + radius) * 2.0 * self.sun.angular_radius().tan() * stretch;
        let along = (self.view.camera.eye - middle).dot(down).clamp(0.0, length);
        let nearest = self.view.camera.eye.distance(middle + along * down) - radius;
        let pixel = self.smallest_pixel();
        match self.view.camera.projection {
            Projection::Orthographic { .. } => width / pixel,
            _ if nearest <= 0.0 => f64::INFINITY,
            _ => width / nearest / pixel,
        }
    }

    /// The width of a pixel at a metre from the eye where it is least [m]: toward a perspective's corners it shrinks by cos2. A
    /// panorama's is that of its rows; in an orthographic view all are alike, anywhere.
    fn smallest_pixel(&self) -> f64 {
        let at = |x: f64, y: f64| self.view.camera.ray(DVec2::new(x, y), self.view.size);
        let [w, h] = self.view.size.map(f64::from);
        let (x, y) = (0.5 * w, 0.5 * h);
        let (middle, below) = (at(x, y), at(x, y + 1.0));
        match self.view.camera.projection {
            Projection::Orthographic { .. } => middle.origin.distance(below.origin),
            Projection::Panorama => middle.direction.distance(below.direction),
            Projection::Perspective { fov_y } => {
                let [_, _, forward] = self.view.camera.axes();
                let cosine = [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)]
                    .map(|(x, y)| at(x, y).direction.dot(forward))
                    .into_iter()
                    .fold(1.0, f64::min);
                2.0 * (0.5 * fov_y).tan() / h * cosine * cosine
            }
        }
    }
}
