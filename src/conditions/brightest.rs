//! How bright sky and surfaces can be at most: by this a plan leaves out what adds too little to be seen.

use super::Conditions;
use crate::colour::luminance;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Rings of directions in which the sky is looked at, and directions in each.
const RINGS: [usize; 2] = [24, 72];

/// The greatest luminances there can be [cd/m2].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Brightest {
    /// Of the sky beside the sun's disc, among 1 728 directions and that toward the sun; 0 without a sky.
    pub sky: f64,
    /// Of a surface: r / (1 - r) times what the sun and the brightest part of the sky all over would make of a white one, r the greatest
    /// reflectance of all, since each further reflection has at most r of the one before. Infinite where something reflects all
    /// light, and with lamps, near which there is no bound; 0 where nothing reflects any.
    pub surface: f64,
}

impl Conditions {
    /// How bright sky and surfaces can be at most.
    pub fn brightest(&self) -> Brightest {
        let sky = self.brightest_sky();
        let r = self.greatest_albedo();
        let lamps = self.greatest_lamp_luminance();
        let surface = match r {
            0.0 => 0.0,
            r => (self.sun.illuminance_lux() / PI + sky + lamps) * r / (1.0 - r).max(0.0),
        };
        Brightest { sky, surface }
    }

    fn brightest_sky(&self) -> f64 {
        let Some(sky) = &self.sky else {
            return 0.0;
        };
        let [rings, directions] = RINGS;
        let rings = (0..rings).flat_map(|ring| {
            let (sin, cos) = (0.5 * PI * ring as f64 / rings as f64).sin_cos();
            (0..directions).map(move |k| {
                let (x, z) = (TAU * k as f64 / directions as f64).sin_cos();
                DVec3::new(cos * x, sin, cos * z)
            })
        });
        let sun = Some(self.sun.toward).filter(|sun| sun.y >= 0.0);
        let all = rings.chain(sun).chain([DVec3::Y]);
        all.map(|toward| luminance(sky.radiance(toward)))
            .fold(0.0, f64::max)
    }

    /// The greatest reflectance of a surface, in any channel [1].
    pub fn greatest_albedo(&self) -> f64 {
        let ground = self.ground.map_or(0.0, |g| g.albedo.max_element());
        if self.geometry.triangle_count() == 0 {
            return ground;
        }
        let materials = self.scene.materials.iter();
        let colors = self.scene.mesh.colors.iter();
        let tint = colors.fold(0.0, |most: f64, c| most.max(c.truncate().max_element()));
        let tint = if tint > 0.0 { tint } else { 1.0 };
        materials
            .map(|material| tint * material.base_color.max_element())
            .fold(ground, f64::max)
            .min(1.0)
    }
}
