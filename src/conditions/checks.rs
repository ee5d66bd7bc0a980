//! The domains of what a user can say.

use crate::error::{Error, Result};
use crate::medium::{ClearAir, Fog, Medium, Phase, Shape};
use crate::scene::{Camera, Ground, Projection, SunEntry};
use crate::units::DEG;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

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
    phase(&medium.phase, name)?;
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
        Shape::Layer { .. } => layer(&medium.shape, name),
        Shape::Ellipsoid { .. } => ellipsoid(&medium.shape, name),
        _ => Ok(()),
    }
}

/// The shortest and the longest wave of a layer [m].
const WAVELENGTHS: [f64; 2] = [1e-3, 1e9];

/// The most waves of a layer.
const MOST_WAVES: usize = 64;

/// Checks the numbers of a layer, named by `name`.
fn layer(shape: &Shape, name: impl Fn(&str) -> String) -> Result<()> {
    let Shape::Layer {
        top,
        waves,
        bottom,
        far,
    } = shape
    else {
        return Ok(());
    };
    let is_height = |y: f64| y.abs() <= FARTHEST;
    if !is_height(*top) {
        return Err(Error::domain(
            name("top"),
            format!("{top} m"),
            "-1e9 to 1e9 m",
            "give the mean height of the boundary, in metres",
        ));
    }
    if waves.len() > MOST_WAVES {
        return Err(Error::domain(
            name("waves"),
            waves.len(),
            format!("at most {MOST_WAVES}"),
            "leave out the smallest",
        ));
    }
    for (number, wave) in (1..).zip(waves) {
        let name = |key: &str| name(&format!("wave {number}: {key}"));
        if !is_height(wave.amplitude) {
            return Err(Error::domain(
                name("amplitude"),
                format!("{} m", wave.amplitude),
                "-1e9 to 1e9 m",
                "give how far the boundary rises above its mean, in metres",
            ));
        }
        let wavelength = TAU / wave.vector.length();
        // Rounding may take a hair off.
        if !(WAVELENGTHS[0] * (1.0 - 1e-9)..=WAVELENGTHS[1] * (1.0 + 1e-9)).contains(&wavelength) {
            return Err(Error::domain(
                name("wavelength"),
                format!("{wavelength} m"),
                format!("{} to {:e} m", WAVELENGTHS[0], WAVELENGTHS[1]),
                "give the distance from crest to crest, in metres",
            ));
        }
        if wave.phase.is_nan() || wave.phase.abs() > 1e6 {
            return Err(Error::domain(
                name("phase"),
                format!("{} degrees", wave.phase / DEG),
                "a turn or a few",
                "0 to 360 degrees are all there are",
            ));
        }
    }
    let highest = top + waves.iter().map(|wave| wave.amplitude.abs()).sum::<f64>();
    if let Some(bottom) = bottom
        && !(is_height(*bottom) && *bottom < highest)
    {
        return Err(Error::domain(
            name("bottom"),
            format!("{bottom} m"),
            format!("below the highest crest at {highest} m"),
            "lower it, or leave it out: then the layer goes down without end",
        ));
    }
    if !(far.is_finite() && *far > 0.0) {
        return Err(Error::domain(
            name("far"),
            format!("{far} m"),
            "above 0",
            "100000 m is usual",
        ));
    }
    Ok(())
}

/// Checks the numbers of an ellipsoid, named by `name`.
fn ellipsoid(shape: &Shape, name: impl Fn(&str) -> String) -> Result<()> {
    let Shape::Ellipsoid {
        center,
        radii,
        rotation,
        ..
    } = shape
    else {
        return Ok(());
    };
    if !near(*center) {
        return Err(Error::domain(
            name("center"),
            format!("{center} m"),
            "-1e9 to 1e9 m in each coordinate",
            "give metres in the scene's axes",
        ));
    }
    let is_radius = |r: f64| (RADII[0]..=RADII[1]).contains(&r);
    if !radii.to_array().into_iter().all(is_radius) {
        return Err(Error::domain(
            name("radii"),
            format!("{radii} m"),
            format!("{:e} to {:e} m", RADII[0], RADII[1]),
            "give half of each axis, in metres",
        ));
    }
    if !(rotation.is_finite() && rotation.is_normalized()) {
        return Err(Error::domain(
            name("rotation"),
            rotation,
            "a rotation",
            "give a unit quaternion",
        ));
    }
    Ok(())
}

/// The least and the greatest half axis of an ellipsoid [m].
const RADII: [f64; 2] = [1e-6, 1e9];

/// Checks a phase function's numbers, named by `name`.
fn phase(phase: &Phase, name: impl Fn(&str) -> String) -> Result<()> {
    match *phase {
        Phase::HenyeyGreenstein { g } | Phase::CornetteShanks { g } | Phase::Draine { g, .. }
            if !(-0.9999..=0.9999).contains(&g) =>
        {
            Err(Error::domain(
                name("g"),
                g,
                "-0.9999 to 0.9999",
                "0.6 to 0.9 is usual for haze and fog",
            ))
        }
        Phase::Draine { a, .. } if !(0.0..=1e6).contains(&a) => Err(Error::domain(
            name("a"),
            a,
            "0 to 1e6",
            "0 is Henyey-Greenstein, 1 Cornette-Shanks",
        )),
        Phase::Fog { droplet } if !(Fog::DIAMETER[0]..=Fog::DIAMETER[1]).contains(&droplet) => {
            Err(Error::domain(
                name("droplet_um"),
                format!("{} micrometres", 1e6 * droplet),
                "0.01 to 50 micrometres",
                "fog has droplets of 5 to 20 micrometres, mist and haze smaller ones",
            ))
        }
        _ => Ok(()),
    }
}

/// Checks the numbers of the clear air that no other check sees.
pub(super) fn air(air: &ClearAir) -> Result<()> {
    let name = |key: &str| format!("the air's {key}");
    let positive = |key: &str, value: f64, remedy: &str| {
        if value.is_finite() && value > 0.0 {
            Ok(())
        } else {
            Err(Error::domain(
                name(key),
                format!("{value} m"),
                "above 0",
                remedy,
            ))
        }
    };
    positive(
        "scale_height",
        air.molecules_scale_height,
        "8434 m is usual for molecules",
    )?;
    positive(
        "aerosol_scale_height",
        air.aerosol_scale_height,
        "1200 m is usual",
    )?;
    positive("far", air.far, "100000 m is usual")?;
    if air.base.is_some_and(|base| !base.is_finite()) {
        return Err(Error::domain(
            name("base"),
            air.base.unwrap_or_default(),
            "a finite height",
            "give the site's height in the scene, in metres",
        ));
    }
    if !(0.0..=1.0).contains(&air.aerosol_albedo) {
        return Err(Error::domain(
            name("aerosol_albedo"),
            air.aerosol_albedo,
            "0 to 1",
            "0.9 to 1 is usual",
        ));
    }
    phase(&air.aerosol_phase, name)
}

/// Farther from the origin than this, nothing is told apart any more [m].
const FARTHEST: f64 = 1e9;

/// The least field of view [degrees]: with less, a GPU's directions of neighbouring pixels are one.
const LEAST_FOV_DEG: f64 = 1e-4;

/// The least and the greatest height of what an orthographic camera sees [m].
const HEIGHTS: [f64; 2] = [1e-6, 1e9];

/// The greatest lens shift [picture widths and heights].
const GREATEST_SHIFT: f64 = 100.0;

/// Checks where the scene's -Z faces [degrees].
pub(super) fn north(degrees: f64) -> Result<()> {
    if (-360.0..=360.0).contains(&degrees) {
        return Ok(());
    }
    Err(Error::domain(
        "north",
        format!("{degrees} degrees"),
        "-360 to 360 degrees",
        "give the azimuth that the scene's -Z faces",
    ))
}

/// Whether a point is where places are told apart.
pub(super) fn near(point: DVec3) -> bool {
    point.abs().cmple(DVec3::splat(FARTHEST)).all()
}

/// Checks where a point is that receives light.
pub(super) fn position(point: DVec3) -> Result<()> {
    if near(point) {
        return Ok(());
    }
    Err(Error::domain(
        "the position",
        format!("{point} m"),
        "-1e9 to 1e9 m in each coordinate",
        "give metres in the scene's axes",
    ))
}

/// Checks a camera's numbers.
pub(super) fn camera(camera: &Camera) -> Result<()> {
    if !near(camera.eye) {
        return Err(Error::domain(
            "the camera's eye",
            format!("{} m", camera.eye),
            "-1e9 to 1e9 m in each coordinate",
            "give --eye X,Y,Z in metres; a mesh in another unit has its --scale",
        ));
    }
    let is_direction = |v: DVec3| v.length() > 0.0 && v.length().is_finite();
    if !is_direction(camera.forward) {
        return Err(Error::domain(
            "the camera's direction",
            camera.forward,
            "a direction",
            "give a --target that is not the eye itself",
        ));
    }
    if !near(camera.eye + camera.forward) {
        return Err(Error::domain(
            "the camera's target",
            format!("{} m", camera.eye + camera.forward),
            "-1e9 to 1e9 m in each coordinate",
            "give --target X,Y,Z in metres, a nearer point in the same direction",
        ));
    }
    if !is_direction(camera.up) {
        return Err(Error::domain(
            "the camera's up",
            camera.up,
            "a direction",
            "leave it out, or give one, such as [0, 1, 0]",
        ));
    }
    let shift = camera.shift.abs().max_element();
    if camera.shift.is_nan() || shift > GREATEST_SHIFT {
        return Err(Error::domain(
            "the camera's shift",
            camera.shift,
            format!("-{GREATEST_SHIFT} to {GREATEST_SHIFT} picture widths and heights"),
            "0.5 moves the picture by half its size",
        ));
    }
    match camera.projection {
        Projection::Perspective { fov_y } if !(LEAST_FOV_DEG * DEG..PI).contains(&fov_y) => {
            Err(Error::domain(
                "the camera's fov_y",
                format!("{} degrees", fov_y / DEG),
                format!("{LEAST_FOV_DEG} to below 180 degrees"),
                "30 to 70 is usual",
            ))
        }
        Projection::Orthographic { height } if !(HEIGHTS[0]..=HEIGHTS[1]).contains(&height) => {
            Err(Error::domain(
                "the camera's height",
                format!("{height} m"),
                format!("{:e} to {:e} m", HEIGHTS[0], HEIGHTS[1]),
                "give the height of what is seen, in metres",
            ))
        }
        _ => Ok(()),
    }
}

/// Checks the picture's size and samples.
pub(super) fn picture(size: [u32; 2], samples: u32) -> Result<()> {
    if size.contains(&0) || size.iter().any(|s| *s > 65_536) {
        return Err(Error::domain(
            "the picture's size",
            format!("{} x {} pixels", size[0], size[1]),
            "1 to 65536 on each side",
            "give --size WIDTHxHEIGHT",
        ));
    }
    if !(1..=4096).contains(&samples) {
        return Err(Error::domain(
            "samples",
            samples,
            "1 to 4096",
            "8 is usual, 64 is fine",
        ));
    }
    Ok(())
}

/// Checks the ground.
pub(super) fn ground(ground: &Ground, height: f64) -> Result<()> {
    if !height.is_finite() {
        return Err(Error::domain(
            "the ground's height",
            format!("{height} m"),
            "any finite height",
            "leave it out for the scene's lowest point",
        ));
    }
    if !(0.0..=1.0).contains(&ground.albedo) {
        return Err(Error::domain(
            "the ground's albedo",
            ground.albedo,
            "0 to 1",
            "0.2 is usual, fresh snow is 0.8",
        ));
    }
    Ok(())
}

/// Checks a sun that the user put somewhere.
pub(super) fn sun(entry: &SunEntry) -> Result<()> {
    let within = |name: &str, value: f64, low: f64, high: f64, unit: &str, remedy: &str| {
        if (low..=high).contains(&value) {
            Ok(())
        } else {
            Err(Error::domain(
                name,
                format!("{value} {unit}"),
                format!("{low} to {high} {unit}"),
                remedy,
            ))
        }
    };
    within(
        "the sun's azimuth",
        entry.azimuth_deg,
        -3600.0,
        3600.0,
        "degrees",
        "give it from north through east",
    )?;
    within(
        "the sun's elevation",
        entry.elevation_deg,
        -90.0,
        90.0,
        "degrees",
        "give it above the horizon",
    )?;
    if let Some(diameter) = entry.diameter_deg {
        within(
            "the sun's diameter",
            diameter,
            0.0,
            90.0,
            "degrees",
            "the real one is 0.533, a point is 0",
        )?;
    }
    if let Some(illuminance) = entry.illuminance {
        within(
            "the sun's illuminance",
            illuminance,
            0.0,
            1e9,
            "lx",
            "the real one gives up to 1.3e5",
        )?;
    }
    Ok(())
}
