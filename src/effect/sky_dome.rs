//! The sky behind everything, on rays that meet nothing and do not point below the horizon.
//!
//! The models live in [`crate::sky`]; this effect only asks them. Below the horizon a scene without a ground is black.

use super::{Contribution, Decision, Effect, Field, Over, Pass, Resource, When};
use crate::colour::luminance;
use glam::DVec3;
use std::f64::consts::PI;

/// The sky seen directly.
pub const SKY_DOME: Effect = Effect {
    name: "sky_dome",
    summary: "the sky where nothing stands before it",
    reads: &[Field::Surface],
    writes: &[Field::Background],
    decide: |conditions| match &conditions.sky {
        None => Decision::nothing("no sky was asked for"),
        Some(sky) => Decision::run(
            sky.describe(),
            Contribution::Estimate(luminance(sky.horizontal_illuminance()) / PI),
        ),
    },
    reference: |conditions, _, _| {
        let sky = conditions.sky.as_ref();
        Ok(Box::new(move |fields| {
            fields.update(Field::Background, |ray, _, surface, present| match sky {
                Some(sky) if !surface.is_met() && ray.direction.y >= 0.0 => {
                    present + sky.radiance(ray.direction)
                }
                _ => present + DVec3::ZERO,
            });
        }))
    },
    passes: &[Pass {
        shader: include_str!("../../shaders/sky_dome.wgsl"),
        entry: "shine",
        over: Over::Pixels,
        when: When::Tile,
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::Background),
            Resource::Sky,
        ],
    }],
    ..Effect::NOTHING
};
