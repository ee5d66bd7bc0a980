//! How bright every source is at a moment.

use super::arrival::{Arrival, Source};
use super::transport::Transport;
use crate::conditions::Conditions;
use glam::DVec3;
use std::f64::consts::PI;

/// How bright every source is at a moment [cd/m2, RGB].
pub struct Light {
    sky: Vec<DVec3>,
    open_ground: DVec3,
    patches: Vec<DVec3>,
}

impl Light {
    /// Finds it for the sun and the sky of `conditions`, over the transport of the same scene.
    pub fn new(transport: &Transport, conditions: &Conditions) -> Self {
        let sky = conditions.sky.as_ref();
        let whole = sky.map_or(DVec3::ZERO, |sky| sky.horizontal_illuminance());
        Light {
            sky: sky.map_or(vec![DVec3::ZERO; transport.dome.len()], |sky| {
                transport.dome.radiances(sky)
            }),
            open_ground: conditions
                .ground
                .map_or(DVec3::ZERO, |ground| ground.albedo)
                / PI
                * whole,
            patches: vec![DVec3::ZERO],
        }
    }

    /// The radiance of a source [cd/m2, RGB].
    pub fn radiance(&self, source: Source) -> DVec3 {
        match source {
            Source::Nothing => DVec3::ZERO,
            Source::Sky(patch) => self.sky[patch as usize],
            Source::OpenGround => self.open_ground,
            Source::Patch(patch) => self.patches[patch as usize],
        }
    }

    /// The light of one arrival: share times radiance times what is let through.
    pub fn of(&self, arrival: &Arrival) -> DVec3 {
        f64::from(arrival.share) * arrival.through.as_dvec3() * self.radiance(arrival.source)
    }
}
