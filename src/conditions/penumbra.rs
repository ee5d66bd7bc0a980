//! How wide the edges of shadows are in the picture.

use super::{Conditions, SunPoint};
use crate::medium::Shape;
use crate::scene::Projection;
use glam::DVec2;

impl Conditions {
    /// The points of the sun's disc that shadows are made for: `count` of them, or one where no penumbra is as wide as a pixel.
    pub fn sun_points(&self, count: usize) -> Vec<SunPoint> {
        let one = self.widest_penumbra() < 1.0;
        self.sun.points(if one { 1 } else { count })
    }

    /// No penumbra is wider in the picture than this [pixels]; infinite where that cannot be said.
    ///
    /// The edge of a shadow is as wide as the sun's disc looks from behind it, s 2 tan(r): r the disc's angular radius, s the
    /// distance from the edge. All shadow lies in the sphere around the casters, drawn out along the light as far as there is
    /// ground or air to fall on; the distance to that from the eye says how large it can look.
    pub fn widest_penumbra(&self) -> f64 {
        let (low, high) = self.geometry.bounds();
        let middle = 0.5 * (low + high);
        let radius = 0.5 * (high - low).length();
        let down = -self.sun.toward;
        let to_ground = self
            .ground
            .map(|ground| (middle.y + radius - ground.height).max(0.0) / self.sun.toward.y);
        // Without ground, shadows end where boxes of air do, and are without end in other air.
        let to_air = self.air.media.iter().map(|medium| match medium.shape {
            Shape::Box { min, max } => {
                let far =
                    |i: usize| (down[i] * (min[i] - middle[i])).max(down[i] * (max[i] - middle[i]));
                far(0) + far(1) + far(2)
            }
            _ => f64::INFINITY,
        });
        let length = to_ground
            .unwrap_or_else(|| to_air.fold(0.0, f64::max))
            .max(0.0);
        if !length.is_finite() {
            return f64::INFINITY;
        }
        let width = (length + radius) * 2.0 * self.sun.angular_radius.tan();
        let along = (self.camera.eye - middle).dot(down).clamp(0.0, length);
        let nearest = self.camera.eye.distance(middle + along * down) - radius;
        let pixel = self.smallest_pixel();
        match self.camera.projection {
            Projection::Orthographic { .. } => width / pixel,
            _ if nearest <= 0.0 => f64::INFINITY,
            _ => width / nearest / pixel,
        }
    }

    /// The least distance between the rays of neighbouring pixels, at a metre from the eye [m]; in an orthographic view
    /// anywhere.
    fn smallest_pixel(&self) -> f64 {
        let at = |x: f64, y: f64| {
            let ray = self.camera.ray(DVec2::new(x, y), self.size);
            match self.camera.projection {
                Projection::Orthographic { .. } => ray.origin,
                _ => ray.direction,
            }
        };
        let [w, h] = self.size.map(f64::from);
        // Perspective shrinks toward the corners; a panorama toward its poles, where pixels lie side by side, not its meridians.
        let corners = [
            (0.0, 0.0),
            (w - 1.0, 0.0),
            (0.0, h - 1.0),
            (w - 1.0, h - 1.0),
        ];
        let aside = |(x, y): (f64, f64)| at(x, y).distance(at(x + 1.0, y));
        let below = |(x, y): (f64, f64)| at(x, y).distance(at(x, y + 1.0));
        let least = corners.map(below).into_iter().fold(f64::INFINITY, f64::min);
        match self.camera.projection {
            Projection::Panorama => least,
            _ => corners.map(aside).into_iter().fold(least, f64::min),
        }
    }
}
