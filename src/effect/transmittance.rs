//! How much light air and glass let through from the end of each ray to the eye: e^-tau, tau the optical depth, times what panes
//! leave.
//!
//! Coefficients of media that overlap add. Rays that meet nothing end where the air does (a height medium: at its `far`), and
//! the clear air counts only on those that meet a surface: sky and sun hold it already ([`crate::medium`]). So the layer is
//! everywhere what the light behind the air is multiplied by; at a silhouette it steps from the whole of the air before the
//! surface to what the other media leave of the sky.

use super::{Contribution, Decision, Effect, Field, Over, Pass, Resource, When};

/// Attenuation between eye and surface.
pub const TRANSMITTANCE: Effect = Effect {
    name: "transmittance",
    summary: "attenuation by air and glass between the eye and what it sees",
    reads: &[Field::Surface],
    writes: &[Field::Transmittance],
    decide: |conditions| {
        if conditions.geometry.panes().is_some() {
            Decision::run(
                "panes colour what is behind them",
                Contribution::Estimate(conditions.typical_luminance()),
            )
        } else if conditions.air.media.is_empty() {
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
    reference: |conditions, _, _| {
        let before_sky = conditions.air.before_sky();
        Ok(Box::new(move |fields| {
            fields.update(Field::Transmittance, |ray, _, surface, _| {
                let (air, end) = match surface.is_met() {
                    true => (&conditions.air, surface.distance),
                    false => (&before_sky, before_sky.end(ray.origin, ray.direction)),
                };
                let sighted = conditions.geometry.sighted(ray, surface.distance);
                let left = (-air.optical_depth(ray.origin, ray.direction, end)).exp();
                sighted.from(surface.distance) * left
            });
        }))
    },
    passes: &[Pass {
        shader: include_str!("../../shaders/transmittance.wgsl"),
        entry: "attenuate",
        over: Over::Pixels,
        when: When::Tile,
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::Transmittance),
        ],
    }],
    ..Effect::NOTHING
};
