//! Sunlight on surfaces, with exact shadows.
//!
//! L = albedo / pi * sum over the points of the sun's disc of E w cos(theta) V e^-tau, V by one shadow ray in f64 a point: the share
//! of light that the surfaces on it let through. A point sun has one. On a GPU the ray goes through the same tree of triangles in
//! f32: relative to the anchor, with planes that were made in f64, so that a shadow is as exact at its edges and in corners as
//! elsewhere. A surface whose own triangle faces away from the sun is dark, whatever its interpolated normal says.

use super::{
    Contribution, Decision, Effect, Field, Knob, Over, Pass, Resource, Source, When, sun_beams,
};
use crate::conditions::Conditions;
use crate::scene::Ray;
use glam::DVec3;
use std::f64::consts::PI;

/// Sunlight reflected by surfaces.
pub const SURFACE_SUN: Effect = Effect {
    name: "surface_sun",
    summary: "sunlight reflected by surfaces, with exact shadows",
    reads: &[Field::Surface],
    writes: &[Field::Sun],
    knobs: &[Knob {
        name: "suns",
        meaning: "points of the sun's disc (one where no penumbra is as wide as a pixel), one shadow ray each",
        values: [1.0, 4.0, 16.0, 128.0],
        range: [1.0, 4096.0],
    }],
    decide: |conditions| {
        if let Some(reason) = conditions.sun.missing() {
            return Decision::nothing(reason);
        }
        Decision::run(
            format!("the sun gives {:.0} lx", conditions.sun.illuminance_lux()),
            Contribution::Bound(
                conditions.air.greatest_sun_gain() * conditions.sun.illuminance_lux() / PI,
            ),
        )
    },
    reference: |conditions, settings, _| {
        let beams = sun_beams(conditions, settings);
        Ok(Box::new(move |fields| {
            fields.update(Field::Sun, |_, _, surface, present| {
                if !surface.is_met() {
                    return present;
                }
                let near = clearance(conditions, surface.position);
                let skip_ground = matches!(surface.source, Source::Ground);
                let mut sum = DVec3::ZERO;
                for beam in &beams {
                    let toward = beam.toward_from(surface.position);
                    let cosine = surface.normal.dot(toward);
                    if cosine <= 0.0 || surface.facet.dot(toward) <= 0.0 {
                        continue;
                    }
                    let origin = if skip_ground {
                        surface.position
                    } else {
                        surface.position + near * surface.facet
                    };
                    let ray = Ray {
                        origin,
                        direction: toward,
                    };
                    let far = beam.distance_from(surface.position);
                    let through = conditions.geometry.transmittance(&ray, near, far);
                    if through == 0.0 {
                        continue;
                    }
                    let depth = conditions.air.beam_optical_depth(surface.position, beam);
                    sum +=
                        through * beam.illuminance_at(surface.position) * cosine * (-depth).exp();
                }
                present + surface.albedo / PI * sum
            });
        }))
    },
    passes: &[Pass {
        shader: include_str!("../../shaders/surface_sun.wgsl"),
        entry: "light_surfaces",
        over: Over::Pixels,
        when: When::EachBeam(sun_beams),
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::Sun),
            Resource::CasterTree,
            Resource::Attributes,
            Resource::Facets,
            Resource::Materials,
            Resource::Texels,
        ],
    }],
    ..Effect::NOTHING
};

/// How far a shadow ray must go before it counts what it meets [m]: above the rounding of the position it leaves from.
pub(super) fn clearance(conditions: &Conditions, position: DVec3) -> f64 {
    1e-11 * conditions.geometry.extent() + 1e-12 * position.length()
}
