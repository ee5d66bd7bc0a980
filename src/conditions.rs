//! What physics makes of a scene: the sun, the sky, the air, all in their domains.
//!
//! This is the one place where domains are checked; everything behind it may rely on them.

use crate::colour::luminance;
use crate::ephemeris;
use crate::error::{Error, Result};
use crate::medium::{Air, FARTHEST, Medium, Phase, Shape};
use crate::effect::Surface;
use crate::scene::{Camera, Geometry, Projection, Ray, Scene};
use crate::sky::{self, Sky};
use crate::units::{DEG, SUN_DIAMETER};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Everything that effects need to know, in SI units and scene axes.
pub struct Conditions {
    /// The scene: meshes, materials, textures.
    pub scene: Scene,
    /// What stands in the way of light.
    pub geometry: Geometry,
    /// The camera.
    pub camera: Camera,
    /// Where the camera comes from, in words.
    pub camera_origin: String,
    /// Width and height of the picture [pixels].
    pub size: [u32; 2],
    /// Samples of pixels that need them.
    pub samples: u32,
    /// The sun.
    pub sun: Sun,
    /// The sky, if there is one.
    pub sky: Option<Sky>,
    /// The endless ground, if there is one.
    pub ground: Option<GroundPlane>,
    /// The media.
    pub air: Air,
}
