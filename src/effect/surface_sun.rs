//! Sunlight on surfaces, with exact shadows.
//!
//! L = albedo / pi * sum over the points of the sun's disc of E w cos(theta) V e^-tau, V by one shadow ray in f64 a point: the share
//! of light that the surfaces on it let through. A point sun has one. On a GPU the ray goes through the same tree of triangles in
//! f32: relative to the anchor, with planes that were made in f64, so that a shadow is as exact at its edges and in corners as
//! elsewhere. A surface whose own triangle faces away from the sun is dark, whatever its interpolated normal says.

use super::shafts::{DISC, SUNS};
use super::{
    Contribution, Decision, Effect, Field, Knob, Over, Pass, Resource, Source, When, sun_beams,
};
use crate::conditions::Conditions;
use crate::scene::Ray;
use crate::scene::disc::{DiscWork, Facing};
use glam::DVec3;
use std::f64::consts::PI;

/// Sunlight reflected by surfaces.
pub const SURFACE_SUN: Effect = Effect {
    name: "surface_sun",
    summary: "sunlight reflected by surfaces, with exact shadows",
    reads: &[Field::Surface],
    writes: &[Field::Sun],
    knobs: &[
        DISC,
        Knob {
            meaning: "points of the sun's disc (one where no penumbra is as wide as a pixel), one shadow ray each",
            ..SUNS
        },
    ],
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
        let disc = match settings.get("disc") > 0.0 {
            true => conditions.sun_edges(),
            false => None,
        };
        Box::new(move |fields| {
            let mut work = DiscWork::default();
            fields.update(Field::Sun, |_, _, surface, present| {
                if !surface.is_met() {
                    return present;
                }
                let near = clearance(conditions, surface.position);
                let origin = match surface.source {
                    Source::Ground => surface.position,
                    _ => surface.position + near * surface.facet,
                };
                if let Some((edges, beam)) = &disc {
                    let facing = Facing {
                        facet: surface.facet,
                        normal: surface.normal,
                    };
                    let disc = edges.disc();
                    if !disc.is_before(surface.facet) || !disc.is_before(surface.normal) {
                        return present;
                    }
                    let geometry = &conditions.geometry;
                    let share = geometry.disc_through(disc, origin, Some(&facing), &mut work);
                    if share == DVec3::ZERO {
                        return present;
                    }
                    let depth = conditions.air.beam_optical_depth(surface.position, beam);
                    let received = share * beam.strength() * (-depth).exp();
                    return present + surface.albedo / PI * received;
                }
                let mut sum = DVec3::ZERO;
                for beam in &beams {
                    let toward = beam.toward_from(surface.position);
                    let cosine = surface.normal.dot(toward);
                    if cosine <= 0.0 || surface.facet.dot(toward) <= 0.0 {
                        continue;
                    }
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
        })
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
