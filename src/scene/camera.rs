//! From a pixel to a ray.

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// Where the eye is, where it looks, and how the picture is projected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position of the eye [m].
    pub eye: DVec3,
    /// Where it looks; any length but zero.
    pub forward: DVec3,
    /// A direction that is up in the picture; need not be at right angles to `forward`.
    pub up: DVec3,
    /// How directions become pixels.
    pub projection: Projection,
    /// Lens shift in picture widths and heights; positive looks further right and up.
    pub shift: DVec2,
}

/// How directions become pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Central projection on a plane.
    Perspective {
        /// Vertical field of view [rad], above 0 and below pi.
        fov_y: f64,
    },
    /// Parallel projection.
    Orthographic {
        /// Height of what is seen [m].
        height: f64,
    },
    /// Equirectangular: the whole sphere, the azimuth of `forward` in the middle, the zenith on top.
    Panorama,
}

/// A half-line: `origin + t direction`, t >= 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it begins [m].
    pub origin: DVec3,
    /// Where it goes, unit length.
    pub direction: DVec3,
}

impl Ray {
    /// The point at distance `t` [m].
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

impl Camera {
    /// A perspective camera that looks from `eye` to `target`, heads up.
    pub fn look_at(eye: DVec3, target: DVec3, fov_y: f64) -> Self {
        Camera {
            eye,
            forward: target - eye,
            up: DVec3::Y,
            projection: Projection::Perspective { fov_y },
            shift: DVec2::ZERO,
        }
    }

    /// Right, up and forward of the picture, unit vectors at right angles to each other.
    ///
    /// Looking straight along `up`, the picture's top is where it would come to lie by tilting the head from the
    /// scene's -Z: +Z looking up, -Z looking down.
    pub fn axes(&self) -> [DVec3; 3] {
        let forward = self.forward.normalize();
        let hint = if forward.cross(self.up.normalize()).length_squared() > 1e-18 {
            self.up
        } else if forward.dot(self.up) > 0.0 {
            DVec3::Z
        } else {
            DVec3::NEG_Z
        };
        let right = forward.cross(hint).normalize();
        [right, right.cross(forward), forward]
    }

    /// The axes of a panorama: right and forward are level, up is the zenith.
    pub fn level_axes(&self) -> [DVec3; 3] {
        let forward = self.forward.normalize();
        let forward = DVec3::new(forward.x, 0.0, forward.z)
            .try_normalize()
            .unwrap_or(DVec3::NEG_Z);
        [forward.cross(DVec3::Y), DVec3::Y, forward]
    }

    /// From scene axes to those of the camera, which stands in their origin and looks along -Z: +X is right in the picture and +Y up.
    /// Of a panorama these are level.
    pub fn world_to_camera(&self) -> DMat4 {
        let [right, up, forward] = match self.projection {
            Projection::Panorama => self.level_axes(),
            _ => self.axes(),
        };
        let turn = DMat3::from_cols(right, up, -forward).transpose();
        DMat4::from_mat3_translation(turn, -(turn * self.eye))
    }

    /// From scene axes to the picture: x and y from (0, 0) at its upper left corner to (1, 1) at its lower right one, of what lies
    /// before the eye, after the division by w. `None` of a panorama, which no matrix makes. `aspect` is width over height.
    pub fn world_to_ndc(&self, aspect: f64) -> Option<DMat4> {
        // Half of what is seen upward: of a perspective at a distance of 1 m, whose w is the depth.
        let (half, depth) = match self.projection {
            Projection::Perspective { fov_y } => ((0.5 * fov_y).tan(), 1.0),
            Projection::Orthographic { height } => (0.5 * height, 0.0),
            Projection::Panorama => return None,
        };
        let middle = DVec2::new(0.5 - self.shift.x, 0.5 + self.shift.y);
        // The third row keeps the matrix from losing what has a depth.
        let to_picture = DMat4::from_cols(
            DVec4::new(0.5 / (half * aspect), 0.0, 0.0, 0.0),
            DVec4::new(0.0, -0.5 / half, 0.0, 0.0),
            DVec4::new(-depth * middle.x, -depth * middle.y, depth - 1.0, -depth),
            DVec4::new(
                (1.0 - depth) * middle.x,
                (1.0 - depth) * middle.y,
                depth,
                1.0 - depth,
            ),
        );
        Some(to_picture * self.world_to_camera())
    }

    /// The ray through a position on the picture.
    ///
    /// `position` is in pixels from the upper left corner; pixel (i, j) has its centre at (i + 0.5, j + 0.5).
    pub fn ray(&self, position: DVec2, size: [u32; 2]) -> Ray {
        let [right, up, forward] = self.axes();
        let size = DVec2::new(f64::from(size[0]), f64::from(size[1]));
        let x = 2.0 * (position.x / size.x + self.shift.x) - 1.0;
        let y = 1.0 - 2.0 * (position.y / size.y - self.shift.y);
        let aspect = size.x / size.y;
        match self.projection {
            Projection::Perspective { fov_y } => {
                let half = (0.5 * fov_y).tan();
                let direction = forward + right * (x * half * aspect) + up * (y * half);
                Ray {
                    origin: self.eye,
                    direction: direction.normalize(),
                }
            }
            Projection::Orthographic { height } => Ray {
                origin: self.eye + 0.5 * height * (right * (x * aspect) + up * y),
                direction: forward,
            },
            Projection::Panorama => {
                let (sin_lon, cos_lon) = (x * std::f64::consts::PI).sin_cos();
                let (sin_lat, cos_lat) = (y * std::f64::consts::FRAC_PI_2).sin_cos();
                let [right, up, forward] = self.level_axes();
                Ray {
                    origin: self.eye,
                    direction: cos_lat * (cos_lon * forward + sin_lon * right) + sin_lat * up,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_the_picture_looks_forward_and_its_top_looks_up() {
        let eye = DVec3::new(1.0, 2.0, 3.0);
        let camera = Camera::look_at(eye, DVec3::new(4.0, 2.0, -1.0), 1.0);
        let middle = camera.ray(DVec2::new(32.0, 24.0), [64, 48]);
        assert!((middle.direction - DVec3::new(0.6, 0.0, -0.8)).length() < 1e-15);
        let top = camera.ray(DVec2::new(32.0, 0.0), [64, 48]);
        assert!((top.direction.angle_between(middle.direction) - 0.5).abs() < 1e-12);
        assert!(top.direction.y > 0.0);
        let right = camera.ray(DVec2::new(64.0, 24.0), [64, 48]);
        assert!(right.direction.cross(middle.direction).y > 0.0);
    }

    #[test]
    fn matrices_find_what_rays_see() {
        let size = [64, 48];
        let whole = DVec2::new(64.0, 48.0);
        let mut camera =
            Camera::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 0.0, -1.0), 0.7);
        camera.up = DVec3::new(0.3, 1.0, 0.1);
        camera.shift = DVec2::new(0.2, -0.3);
        for height in [None, Some(5.0)] {
            if let Some(height) = height {
                camera.projection = Projection::Orthographic { height };
            }
            let to_picture = camera.world_to_ndc(64.0 / 48.0).expect("it is flat");
            for position in [
                DVec2::new(0.0, 0.0),
                DVec2::new(32.0, 24.0),
                DVec2::new(50.0, 7.0),
            ] {
                let ray = camera.ray(position, size);
                for t in [0.5, 20.0] {
                    let found = to_picture * ray.at(t).extend(1.0);
                    let found = DVec2::new(found.x, found.y) / found.w * whole;
                    assert!((found - position).length() < 1e-9, "{found} {position}");
                    // It lies before the camera.
                    assert!(camera.world_to_camera().transform_point3(ray.at(t)).z < 0.0);
                }
            }
            assert!(to_picture.determinant().abs() > 1e-6);
        }
        camera.projection = Projection::Panorama;
        assert_eq!(camera.world_to_ndc(2.0), None);
        assert!(
            camera
                .world_to_camera()
                .transform_point3(camera.eye)
                .length()
                < 1e-12
        );
    }

    #[test]
    fn straight_up_and_straight_down_have_axes() {
        for y in [1.0, -1.0] {
            let camera = Camera::look_at(DVec3::ZERO, DVec3::new(0.0, y, 0.0), 1.0);
            let [right, up, forward] = camera.axes();
            assert!((right.cross(up) + forward).length() < 1e-15);
            assert!(right.is_finite() && right.x == 1.0);
        }
    }

    #[test]
    fn a_panorama_covers_the_sphere() {
        let mut camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0);
        camera.projection = Projection::Panorama;
        let ray = |x, y| camera.ray(DVec2::new(x, y), [400, 200]).direction;
        assert!((ray(200.0, 100.0) - DVec3::NEG_Z).length() < 1e-15);
        assert!((ray(300.0, 100.0) - DVec3::X).length() < 1e-15);
        assert!((ray(123.0, 0.0) - DVec3::Y).length() < 1e-15);
    }
}
