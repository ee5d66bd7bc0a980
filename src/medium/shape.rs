//! A participating medium: where it is, how its coefficients vary and how it scatters.

use super::phase::Phase;
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
    /// One kind of particle of the clear air, whose light the models of sun and sky hold already. Coefficients fall as those of
    /// [`Shape::Height`].
    Air {
        /// Height of the site, to which sun and sky belong and the coefficients too [m].
        base: f64,
        /// Height over which they fall by a factor e [m], positive.
        scale_height: f64,
        /// Distance up to which shadows in it are seen on rays that meet nothing [m], positive.
        far: f64,
        /// Optical depth from the site to the sun [1], finite: what the sun's illuminance has lost to it.
        overhead: DVec3,
    },
}

/// No path through the air is followed further than this [m]; a flat, endless haze is practically opaque long before.
pub const FARTHEST: f64 = 1e9;

impl Medium {
    /// Extinction coefficient [1/m]: scattering plus absorption.
    pub fn extinction(&self) -> DVec3 {
        self.scattering + self.absorption
    }

    /// Whether the models of sun and sky hold its light already.
    pub fn is_clear_air(&self) -> bool {
        matches!(self.shape, Shape::Air { .. })
    }
}
