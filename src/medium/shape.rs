//! A participating medium: where it is, how its coefficients vary and how it scatters.

use super::phase::Phase;
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::TAU;

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
#[derive(Debug, Clone, PartialEq)]
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
    /// Homogeneous below a wavy boundary, y = top + the sum of the waves, down to `bottom` (Nishita, Miyawaki & Nakamae 1987,
    /// section 4: dry ice, ground fog). Where a trough lies below `bottom` there is nothing.
    Layer {
        /// Mean height of the boundary [m].
        top: f64,
        /// The waves of the boundary; none: it is flat.
        waves: Vec<Wave>,
        /// Height at which it ends [m]; absent: it goes down without end.
        bottom: Option<f64>,
        /// Distance at which rays that meet nothing end [m], positive.
        far: f64,
    },
    /// Inside an ellipsoid (after Nishita 1987: smoke).
    Ellipsoid {
        /// Its centre [m].
        center: DVec3,
        /// Its half axes before it is turned, along X, Y and Z [m], positive.
        radii: DVec3,
        /// How it is turned about its centre; a unit quaternion.
        rotation: DQuat,
        /// How its density ends.
        edge: Edge,
    },
}

/// One wave of the boundary of a [`Shape::Layer`]: amplitude sin(vector . (x, z) + phase).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// How far it rises above its mean [m], finite.
    pub amplitude: f64,
    /// The wave vector over x and z [rad/m]: 2 pi / wavelength in the direction in which the phase grows.
    pub vector: DVec2,
    /// Its phase at x = z = 0 [rad].
    pub phase: f64,
}

impl Wave {
    /// A wave by its length [m], above 0, and by its direction from +X toward +Z and its phase [rad].
    pub fn new(amplitude: f64, wavelength: f64, direction: f64, phase: f64) -> Self {
        Wave {
            amplitude,
            vector: TAU / wavelength * DVec2::from_angle(direction),
            phase,
        }
    }
}

/// How the density of a [`Shape::Ellipsoid`] ends at its rim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    /// All at once: it is homogeneous.
    Sharp,
    /// It is 1 - r^2, r from 0 at the centre, where the coefficients are those given, to 1 at the rim.
    Soft,
}

/// No path through the air is followed further than this [m]; a flat, endless haze is practically opaque long before.
pub const FARTHEST: f64 = 1e9;

impl Medium {
    /// Extinction coefficient [1/m]: scattering plus absorption.
    pub fn extinction(&self) -> DVec3 {
        self.scattering + self.absorption
    }

    /// The least box with the scene's axes around it: its least and greatest corners [m]; `None` of one without bounds to all sides.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        match self.shape {
            Shape::Box { min, max } => Some([min, max]),
            Shape::Ellipsoid {
                center,
                radii,
                rotation,
                ..
            } => {
                let square = |axis: DVec3| {
                    let side = rotation * (axis * radii);
                    side * side
                };
                let sum = square(DVec3::X) + square(DVec3::Y) + square(DVec3::Z);
                let half = DVec3::new(sum.x.sqrt(), sum.y.sqrt(), sum.z.sqrt());
                Some([center - half, center + half])
            }
            _ => None,
        }
    }

    /// No path through it is optically thicker than one of as many metres at the coefficients that are given; infinite of one without
    /// bounds.
    pub fn greatest_length(&self) -> f64 {
        match self.shape {
            Shape::Box { min, max } => (max - min).length(),
            Shape::Ellipsoid { radii, edge, .. } => {
                // The integral of 1 - r^2 from -1 to 1 is 4 / 3.
                let mean = match edge {
                    Edge::Sharp => 1.0,
                    Edge::Soft => 2.0 / 3.0,
                };
                2.0 * mean * radii.max_element()
            }
            _ => f64::INFINITY,
        }
    }

    /// Whether it has borders that are not flat: the shaders know no such media.
    pub fn is_curved(&self) -> bool {
        matches!(self.shape, Shape::Layer { .. } | Shape::Ellipsoid { .. })
    }

    /// Whether the models of sun and sky hold its light already.
    pub fn is_clear_air(&self) -> bool {
        matches!(self.shape, Shape::Air { .. })
    }
}
