//! The sky behind everything, on rays that meet nothing and do not point below the horizon.
//!
//! The models live in [`crate::sky`]; this effect only asks them. Below the horizon a scene without a ground is black.

use super::{Contribution, Decision, Effect, Field, Kind, Pass, Resource, Settings};
use crate::colour::luminance;
use crate::conditions::Conditions;
use crate::sky::Sky;
use glam::DVec3;
use std::f64::consts::PI;

/// The sky seen directly.
pub const SKY_DOME: Effect = Effect {
    name: "sky_dome",
    summary: "the sky where nothing stands before it",
    reads: &[Field::Surface],
    writes: &[Field::Background],
    remembers: false,
    method: None,
    knobs: &[],
    decide: |conditions| match &conditions.sky {
        None => Decision::nothing("no sky was asked for"),
        Some(sky) => Decision::run(
            sky.describe(),
            Contribution::Estimate(luminance(sky.horizontal_illuminance()) / PI),
        ),
    },
    reference: |conditions, _| {
        let sky = conditions.sky.as_ref();
        Box::new(move |fields| {
            fields.update(Field::Background, |ray, _, surface, present| match sky {
                Some(sky) if !surface.is_met() && ray.direction.y >= 0.0 => {
                    present + sky.radiance(ray.direction)
                }
                _ => present + DVec3::ZERO,
            });
        })
    },
    passes: &[Pass {
        shader: concat!(
            include_str!("../../shaders/sky_dome.wgsl"),
            include_str!("../../shaders/common/sky_table.wgsl"),
        ),
        entry: "shine",
        kind: Kind::Pixels,
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::Background),
            Resource::Table(table),
        ],
        scratch: &[],
    }],
};

/// The sky for the GPU.
fn table(conditions: &Conditions, _: &Settings<'_>) -> Vec<f32> {
    conditions
        .sky
        .as_ref()
        .map_or_else(|| vec![0.0], Sky::table)
}
