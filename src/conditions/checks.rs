//! The domains of what a user can say.

use crate::error::{Error, Result};
use crate::medium::{Medium, Phase, Shape};
use crate::scene::{Camera, Projection};
use crate::units::DEG;
use glam::DVec3;
use std::f64::consts::PI;

/// Checks a medium's numbers.
pub(super) fn medium(index: usize, medium: &Medium, ground: f64) -> Result<()> {
    let name = |key: &str| format!("medium {}: {key}", index + 1);
    let coefficient = |key: &str, value: DVec3| {
        if value.min_element() >= 0.0 && value.max_element() <= 1e12 {
            Ok(())
        } else {
            Err(Error::domain(
                name(key),
                format!("{value} 1/m"),
                "0 to 1e12 1/m",
                "give the coefficient per metre",
            ))
        }
    };
    coefficient("scattering", medium.scattering)?;
    coefficient("absorption", medium.absorption)?;
    match medium.phase {
        Phase::HenyeyGreenstein { g } | Phase::CornetteShanks { g } if !(g.abs() <= 0.9999) => {
            return Err(Error::domain(
                name("g"),
                g,
                "-0.9999 to 0.9999",
                "0.6 to 0.9 is usual for haze and fog",
            ));
        }
        _ => {}
    }
    match medium.shape {
        Shape::Box { min, max }
            if !(min.is_finite() && max.is_finite() && min.cmplt(max).all()) =>
        {
            Err(Error::domain(
                name("min, max"),
                format!("{min}, {max} m"),
                "min below max on every axis",
                "give two opposite corners, the least coordinates first",
            ))
        }
        Shape::Haze { top } if !(top.is_finite() && top > ground) => Err(Error::domain(
            name("top"),
            format!("{top} m"),
            format!("above the ground at {ground} m"),
            "raise it, or set the ground's height",
        )),
        Shape::Height {
            base,
            scale_height,
            far,
        } if !(base.is_finite()
            && scale_height.is_finite()
            && scale_height > 0.0
            && far.is_finite()
            && far > 0.0) =>
        {
            Err(Error::domain(
                name("base, scale_height, far"),
                format!("{base}, {scale_height}, {far} m"),
                "scale_height and far above 0, all finite",
                "8000 m is the scale height of clear air, 1200 m that of haze",
            ))
        }
        _ => Ok(()),
    }
}

/// Checks a camera's numbers.
pub(super) fn camera(camera: &Camera) -> Result<()> {
    if !camera.eye.is_finite() {
        return Err(Error::domain(
            "the camera's eye",
            camera.eye,
            "finite coordinates",
            "give --eye X,Y,Z in metres",
        ));
    }
    if !(camera.forward.is_finite() && camera.forward.length() > 0.0 && camera.up.is_finite()) {
        return Err(Error::domain(
            "the camera's direction",
            camera.forward,
            "a direction",
            "give a --target that is not the eye itself",
        ));
    }
    match camera.projection {
        Projection::Perspective { fov_y } if !(fov_y > 0.0 && fov_y < PI) => Err(Error::domain(
            "the camera's fov_y",
            format!("{} degrees", fov_y / DEG),
            "above 0 and below 180 degrees",
            "30 to 70 is usual",
        )),
        Projection::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
            Err(Error::domain(
                "the camera's height",
                format!("{height} m"),
                "above 0",
                "give the height of what is seen, in metres",
            ))
        }
        _ => Ok(()),
    }
}
