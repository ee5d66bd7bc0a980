//! Sunlight on surfaces, with exact shadows.
//!
//! L = albedo / pi * E * integral over the sun's disc of w cos(theta) V e^-tau: what of the disc is seen past all casters is found
//! from their edges ([`crate::scene::disc`]), so that penumbrae have no steps and are as narrow as they are where things touch.
//! On a GPU the same triangles are found in the tree of casters, and what they cover of the disc is counted in 512 parts of it.
//!
//! Panes colour what comes through them ([`crate::scene::panes`]), chord by chord or ray by ray.
//!
//! Where `disc` is 0, where no penumbra is as wide as a pixel, and where the sun is low, the disc is a sum over points, V by one
//! shadow ray in f64 a point: the share of light that the surfaces on it let through. A point sun has one. On a GPU the ray goes
//! through the same tree of triangles in f32: relative to the anchor, with planes that were made in f64, so that a shadow is as exact
//! at its edges and in corners as elsewhere. A surface whose own triangle faces away from the sun is dark, whatever its
//! interpolated normal says.

use super::shafts::{DISC, SUNS};
use super::{
    Contribution, Decision, Effect, Field, Knob, Number, Over, Pass, Resource, Settings, Source,
    Surface, When, sun_beams,
};
use crate::beam::Beam;
use crate::conditions::Conditions;
use crate::scene::Ray;
use crate::scene::disc::{DiscWork, Facing};
use crate::units::brief;
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
            meaning: "points of the sun's disc where it is not `disc` (one where no penumbra is as wide as a pixel), one shadow ray each",
            ..SUNS
        },
    ],
    decide: |conditions| {
        if let Some(reason) = conditions.sun.missing() {
            return Decision::nothing(reason);
        }
        Decision::run(
            format!(
                "the sun gives {} lx",
                brief(conditions.sun.illuminance_lux())
            ),
            Contribution::Bound(
                conditions.air.greatest_sun_gain() * conditions.sun.illuminance_lux() / PI,
            ),
        )
    },
    reference: |conditions, settings, _| {
        let beams = sun_beams(conditions, settings);
        let whole = whole_sun(conditions, settings).zip(conditions.sun.disc());
        Ok(Box::new(move |fields| {
            let mut work = DiscWork::default();
            fields.update(Field::Sun, |_, _, surface, present| {
                if !surface.is_met() {
                    return present;
                }
                let (origin, near) = shadow_start(conditions, surface);
                if let Some((beam, disc)) = &whole {
                    let facing = Facing {
                        facet: surface.facet,
                        normal: surface.normal,
                    };
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
                    if through == DVec3::ZERO {
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
        when: When::EachBeam(beams),
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::Sun),
            Resource::Knobs(|conditions, settings| {
                let is_disc = whole_sun(conditions, settings).is_some();
                let limb = conditions.sun.limb_exponent();
                vec![
                    ("disc", Number::Count(is_disc.into())),
                    ("limb_red", Number::float(limb.x)),
                    ("limb_green", Number::float(limb.y)),
                    ("limb_blue", Number::float(limb.z)),
                ]
            }),
            Resource::CasterTree,
            Resource::Attributes,
            Resource::Facets,
            Resource::Materials,
            Resource::Texels,
        ],
    }],
    ..Effect::NOTHING
};

/// The sun as one beam, where it is more than points.
fn whole_sun(conditions: &Conditions, settings: &Settings<'_>) -> Option<Beam> {
    conditions
        .whole_sun()
        .filter(|_| settings.get("disc") > 0.0)
}

/// The beams for which the pass runs.
fn beams(conditions: &Conditions, settings: &Settings<'_>) -> Vec<Beam> {
    match whole_sun(conditions, settings) {
        Some(beam) => vec![beam],
        None => sun_beams(conditions, settings),
    }
}

/// Where shadow rays leave a surface [m], and what they meet nearer than which is the surface itself [m].
pub(super) fn shadow_start(conditions: &Conditions, surface: &Surface) -> (DVec3, f64) {
    let near = clearance(conditions, surface.position);
    let origin = match surface.source {
        Source::Ground => surface.position,
        _ => surface.position + near * surface.facet,
    };
    (origin, near)
}

/// How far a shadow ray must go before it counts what it meets [m]: above the rounding of the position it leaves from.
pub(super) fn clearance(conditions: &Conditions, position: DVec3) -> f64 {
    1e-11 * conditions.geometry.extent() + 1e-12 * position.length()
}
