//! Light of the sky and of surfaces scattered once by the air toward the eye.
//!
//! L(T) = integral_0^T sum_m sigma_s,m(t) e^-tau(t) J_m(x(t)) dt, J_m = integral over the sphere of p_m L_in dw', tau the optical
//! depth of all media from the eye ([`crate::radiosity::air`] has the method). L_in is what comes to that place of the air from
//! sky, surfaces and open ground: occluded by what stands in between, and weakened by the media on its way.
//!
//! As everywhere ([`crate::medium`]), the clear air sends nothing on rays that meet nothing, since the sky holds that light, and
//! takes nothing of what comes from the sky. Light of the sun itself is that of the shafts ([`super::shafts`]); sunlight that a
//! surface has sent on is in here.
//!
//! Neglected: light that is scattered more than once.

use super::kept::Shared;
use super::radiosity::shared;
use super::{Contribution, Decision, Effect, Field, Keep, Keeper, Knob, Settings};
use crate::conditions::{Conditions, Input};
use crate::error::Result;
use crate::radiosity::Care;
use crate::radiosity::air::{self, Fineness, Lattice, Picture};
use glam::{DVec3, UVec2};
use std::sync::Arc;

/// Light of sky and surfaces in the air.
pub const AIR_SKY: Effect = Effect {
    name: "air_sky",
    summary: "light of sky and surfaces that the air scatters to the eye",
    reads: &[Field::Surface],
    writes: &[Field::InscatterSky],
    keeps: &[&LATTICE, &PICTURE],
    knobs: &[
        Knob {
            name: "columns",
            meaning: "distance of eye rays on which the air's light is found, before cells are divided [pixels]",
            values: [32.0, 16.0, 8.0, 4.0],
            range: [1.0, 64.0],
        },
        Knob {
            name: "spacing",
            meaning: "distance of places at which the air's light is found, as a share of their distance from the eye",
            values: [0.4, 0.25, 0.16, 0.14],
            range: [0.01, 1.0],
        },
        Knob {
            name: "difference",
            meaning: "difference of the air's light that finer places resolve, times the part of the way from the eye on which it is",
            values: [0.04, 0.015, 0.006, 0.004],
            range: [1e-4, 1.0],
        },
        Knob {
            name: "finest",
            meaning: "least distance of such finer places, as a share of the spacing of all",
            values: [1.0, 0.5, 0.25, 0.125],
            range: [1.0 / 1024.0, 1.0],
        },
        Knob {
            name: "rays",
            meaning: "rays from each of these places, before outlines are refined",
            values: [64.0, 64.0, 400.0, 784.0],
            range: [16.0, 65536.0],
        },
        Knob {
            name: "outline",
            meaning: "share of the light of such a place that may be uncertain at outlines",
            values: [0.05, 0.02, 0.004, 0.002],
            range: [1e-5, 1.0],
        },
    ],
    decide,
    reference: |conditions, settings, kept| {
        let light = air_light(conditions, settings, kept)?;
        let before_sky = conditions.air.before_sky();
        Ok(Box::new(move |fields| {
            let mut sight = light.sight();
            fields.update(Field::InscatterSky, |ray, pixel, surface, present| {
                let is_met = surface.is_met();
                let distance = match is_met {
                    true => surface.distance,
                    false => before_sky.end(ray.origin, ray.direction),
                };
                let mut sum = DVec3::ZERO;
                let mut nearer = DVec3::ZERO;
                // What lies beyond a pane is all up to there less what is before it.
                let sighted = conditions.geometry.sighted(ray, distance);
                for ([_, to], left) in sighted.runs(distance) {
                    let up_to = light.light(centre(pixel), ray, to, is_met, &mut sight);
                    sum += left * (up_to - nearer);
                    nearer = up_to;
                }
                present
                    + match sighted.is_clear() {
                        true => sum,
                        false => sum.max(DVec3::ZERO),
                    }
            });
        }))
    },
    passes: &[],
    ..Effect::NOTHING
};

fn centre(pixel: UVec2) -> glam::DVec2 {
    pixel.as_dvec2() + 0.5
}

/// What comes to places of the air from whom: of the transport, whose patches it names.
const LATTICE: Keep = Keep {
    name: "who lights the air",
    reads: &[
        Input::Geometry,
        Input::Materials,
        Input::Extinction,
        Input::Lamps,
    ],
};

/// What the air of a picture sends to the eye: of [`LATTICE`], and of the light of all sources.
const PICTURE: Keep = Keep {
    name: "the air's light in the picture",
    reads: &[Input::Geometry, Input::Media, Input::View],
};

fn air_light(
    conditions: &Conditions,
    settings: &Settings<'_>,
    kept: &Keeper<'_>,
) -> Result<Arc<Picture>> {
    let (transport, light) = shared(conditions, kept)?;
    let seen_by: [Shared; 1] = [transport.clone()];
    let lattice = kept.get_from(&LATTICE, conditions, settings, &seen_by, |_| {
        let care = Care {
            rays: settings.get("rays") as usize,
            outline: settings.get("outline"),
        };
        Ok(Lattice::new(transport, conditions.geometry.clone(), care))
    })?;
    kept.get_from(
        &PICTURE,
        conditions,
        settings,
        &[lattice.clone(), light.clone()],
        |_| {
            let fineness = Fineness {
                columns: settings.get("columns"),
                spacing: settings.get("spacing"),
                difference: settings.get("difference"),
                finest: settings.get("finest"),
            };
            Ok(air::picture(conditions, lattice, light, fineness))
        },
    )
}

fn decide(conditions: &Conditions) -> Decision {
    let media = &conditions.air.media;
    if media.is_empty() {
        return Decision::nothing("the scene has no medium: nothing scatters light");
    }
    let scatters = |m: &&crate::medium::Medium| m.scattering.max_element() > 0.0;
    if !media.iter().any(|m| scatters(&m)) {
        return Decision::nothing("no medium scatters light");
    }
    if !conditions.is_lit() {
        return Decision::nothing("neither sky nor sun nor a lamp gives light");
    }
    let brightest = conditions.brightest();
    let brightest = brightest.sky.max(brightest.surface);
    if brightest == 0.0 {
        return Decision::nothing("there is no sky, and no surface reflects light");
    }
    let albedo = (media.iter().filter(scatters))
        .map(|m| m.scattering / m.extinction().max(DVec3::splat(f64::MIN_POSITIVE)))
        .fold(0.0, |most: f64, albedo| most.max(albedo.max_element()));
    // J is a mean of what comes in, and the weights of a ray sum to no more than albedo (1 - e^-tau).
    let weight = albedo * -(-conditions.greatest_optical_depth()).exp_m1();
    Decision::run(
        format!("sky and surfaces light {}", conditions.media_phrase()),
        Contribution::at_most(weight * brightest, conditions),
    )
}
