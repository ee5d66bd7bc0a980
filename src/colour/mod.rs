//! Colour: spectra, CIE 1931, RGB spaces, exposure, display.
//!
//! Everything inside is in the working space, linear Rec. 2020 with D65 white, and photometric: the luminance of a triple
//! ([`luminance`]) is in cd/m2, or its illuminance in lux. Spectra become XYZ through the CIE 1931 2 degree observer
//! ([`xyz_from_spectrum`]) and XYZ becomes working-space RGB through [`WORKING_FROM_XYZ`], without adaptation: the daylight
//! keeps its own colour, and white is D65.

pub mod cie1931;
pub mod display;
pub mod exposure;
mod space;
mod temperature;
mod transfer;

pub use cie1931::xyz_from_spectrum;
pub use space::{Chromaticities, LUMINANCE, Space, WORKING_FROM_XYZ, XYZ_FROM_WORKING, bradford};
pub use temperature::{DUV_LIMIT, Temperature, temperature, uv};
pub use transfer::{srgb_decode, srgb_encode};

use glam::DVec3;

/// Luminance [cd/m2] (or illuminance [lx]) of a triple of the working space.
pub fn luminance(rgb: DVec3) -> f64 {
    LUMINANCE.dot(rgb)
}

/// XYZ of a triple of the working space, in its unit.
pub fn xyz_from_working(rgb: DVec3) -> DVec3 {
    XYZ_FROM_WORKING * rgb
}

/// Working-space triple of an XYZ, in its unit; channels are negative outside the gamut of Rec. 2020.
pub fn working_from_xyz(xyz: DVec3) -> DVec3 {
    WORKING_FROM_XYZ * xyz
}

/// XYZ of a chromaticity x, y and a luminance Y, given as (x, y, Y). Black (y = 0) is zero.
pub fn xyz_from_xyy(xyy: DVec3) -> DVec3 {
    if xyy.y == 0.0 {
        return DVec3::ZERO;
    }
    let per_y = xyy.z / xyy.y;
    DVec3::new(xyy.x * per_y, xyy.z, (1.0 - xyy.x - xyy.y) * per_y)
}

/// (x, y, Y) of an XYZ; black gets the chromaticity of D65.
pub fn xyy_from_xyz(xyz: DVec3) -> DVec3 {
    let sum = xyz.x + xyz.y + xyz.z;
    if sum == 0.0 {
        let [x, y] = Space::WORKING.chromaticities().white;
        return DVec3::new(x, y, 0.0);
    }
    DVec3::new(xyz.x / sum, xyz.y / sum, xyz.y)
}

/// The nearest triple without negative channels toward the grey of the same luminance: hue and luminance stay, saturation is reduced.
///
/// Light is never negative, but light purer than the primaries of Rec. 2020 (a sun deep in haze) has a negative channel
/// there. Triples inside the gamut are returned as they are; one of luminance <= 0 becomes black.
#[inline]
pub fn into_gamut(rgb: DVec3) -> DVec3 {
    let least = rgb.min_element();
    if least >= 0.0 {
        return rgb;
    }
    let grey = luminance(rgb);
    if grey <= 0.0 {
        return DVec3::ZERO;
    }
    // The channel that is least ends at exactly zero; max() removes what rounding leaves.
    DVec3::splat(grey)
        .lerp(rgb, grey / (grey - least))
        .max(DVec3::ZERO)
}
