//! How much light the air lets through from the end of each ray to the eye: e^-tau, tau the optical depth.
//!
//! Coefficients of media that overlap add. Rays that meet nothing end where the air does (a height medium: at its `far`).

use super::{Contribution, Decision, Effect, Field, Kind, Pass, Resource};

/// Attenuation between eye and surface.
pub const TRANSMITTANCE: Effect = Effect {
    name: "transmittance",
    summary: "attenuation by the air between the eye and what it sees",
    reads: &[Field::Surface],
    writes: &[Field::Transmittance],
    remembers: false,
    method: None,
    knobs: &[],
    decide: |conditions| {
        if conditions.air.media.is_empty() {
            Decision::nothing("the scene has no medium")
        } else if conditions
            .air
            .media
            .iter()
            .all(|m| m.extinction().max_element() == 0.0)
        {
            Decision::nothing("no medium attenuates light")
        } else {
            Decision::run(
                format!("{} in the air", conditions.media_phrase()),
                Contribution::Estimate(conditions.typical_luminance()),
            )
        }
    },
    reference: |conditions, _| {
        Box::new(|fields| {
            fields.update(Field::Transmittance, |ray, _, surface, _| {
                let end = conditions.ray_end(ray, surface.distance);
                let depth = conditions.air.optical_depth(ray.origin, ray.direction, end);
                (-depth).exp()
            });
        })
    },
    passes: &[Pass {
        shader: include_str!("../../shaders/transmittance.wgsl"),
        entry: "attenuate",
        kind: Kind::Pixels,
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::Transmittance),
        ],
        scratch: &[],
    }],
};
