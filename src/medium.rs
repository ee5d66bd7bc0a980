//! What fills the air: shapes, scattering and absorption coefficients, phase functions.

use glam::DVec3;

/// A participating medium. Coefficients of media that overlap add.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Where it is.
    pub shape: Shape,
    /// Scattering coefficient [1/m] of each channel of the working space, finite and not negative.
    pub scattering: DVec3,
    /// Absorption coefficient [1/m] of each channel of the working space, finite and not negative.
    pub absorption: DVec3,
    /// How scattered light spreads over directions.
    pub phase: Phase,
}

/// Where a medium is and how its coefficients vary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Homogeneous inside an axis-aligned box [m]; sunlight is attenuated from the box's face.
    Box {
        /// The corner of least coordinates [m].
        min: DVec3,
        /// The corner of greatest coordinates [m].
        max: DVec3,
    },
    /// Homogeneous from the ground up to `top` [m]; sunlight is attenuated from there along the slant.
    Haze {
        /// Height of the upper boundary [m].
        top: f64,
    },
    /// Coefficients fall as exp(-(y - base) / scale_height) over a flat earth.
    Height {
        /// Height at which the coefficients are those given [m].
        base: f64,
        /// Height over which they fall by a factor e [m], positive.
        scale_height: f64,
        /// Distance at which rays that meet nothing end [m], positive.
        far: f64,
    },
}

/// A phase function, normalised: its integral over the sphere is 1 [1/sr].
///
/// `mu` is the cosine between the ray from the eye and the direction toward the sun: +1 looks into the sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Phase {
    /// The same in every direction.
    Isotropic,
    /// Molecules.
    Rayleigh,
    /// Henyey & Greenstein 1941, |g| < 1.
    HenyeyGreenstein {
        /// Mean cosine.
        g: f64,
    },
    /// Cornette & Shanks 1992, |g| < 1.
    CornetteShanks {
        /// Parameter; the mean cosine is 3 g (4 + g^2) / (5 (2 + g^2)).
        g: f64,
    },
    /// Nishita et al. 1987, 1 + 9 cos^16(alpha / 2), normalised.
    NishitaHazy,
    /// Nishita et al. 1987, 1 + 50 cos^64(alpha / 2), normalised.
    NishitaMurky,
}
