//! A camera for a scene that has none, from its bounds.

use super::{Camera, Projection};
use crate::units::DEG;
use glam::{DVec2, DVec3};

/// Vertical field of view of a default camera [degrees].
pub const DEFAULT_FOV_Y_DEG: f64 = 50.0;

impl Camera {
    /// Everything in view, from the right, from in front and from above.
    pub fn around((min, max): (DVec3, DVec3), aspect: f64) -> Self {
        let middle = 0.5 * (min + max);
        let radius = (0.5 * (max - min).length()).max(f64::MIN_POSITIVE);
        let fov_y = DEFAULT_FOV_Y_DEG * DEG;
        let half = (0.5 * fov_y).tan().min((0.5 * fov_y).tan() * aspect).atan();
        let eye = middle + DVec3::new(0.6, 0.45, 1.0).normalize() * radius / half.sin();
        Camera::look_at(eye, middle, fov_y)
    }

    /// The camera as a block of the scene file, its numbers with as many digits as tell eye and target apart.
    pub fn to_toml(&self) -> String {
        let target = self.eye + self.forward;
        let length = self.forward.length();
        let list = |v: DVec3| {
            let [x, y, z] = v.to_array().map(|c| number(c, 1e-5 * length));
            format!("[{x}, {y}, {z}]")
        };
        let projection = match self.projection {
            Projection::Perspective { fov_y } => {
                let fov_y = fov_y / DEG;
                format!("fov_y = {}", number(fov_y, 1e-5 * fov_y))
            }
            Projection::Orthographic { height } => format!(
                "projection = \"orthographic\"\nheight = {}",
                number(height, 1e-5 * height)
            ),
            Projection::Panorama => "projection = \"panorama\"".into(),
        };
        let mut text = format!(
            "[camera]\neye = {}\ntarget = {}\n{projection}\n",
            list(self.eye),
            list(target),
        );
        if self.up != DVec3::Y {
            let [x, y, z] = self.up.normalize().to_array().map(|c| number(c, 1e-6));
            text += &format!("up = [{x}, {y}, {z}]\n");
        }
        if self.shift != DVec2::ZERO {
            let [x, y] = self.shift.to_array().map(|c| number(c, 1e-6));
            text += &format!("shift = [{x}, {y}]\n");
        }
        text
    }
}

/// A number of a TOML file, rounded to the power of ten just below `step` (above 0), without long rows of zeros.
fn number(value: f64, step: f64) -> String {
    let size = value.abs().max(step);
    let digits = (size.log10().floor() - step.log10().floor()).clamp(0.0, 16.0) as usize;
    let rounded = format!("{value:.digits$e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0.0".into(),
        1e-4..1e9 => format!("{rounded:?}"),
        _ => format!("{rounded:e}"),
    }
}
