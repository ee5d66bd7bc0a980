//! Sunlight scattered once by the air toward the eye: light shafts.
//!
//! L = integral over the ray of sum_i sigma_s,i p_i(mu) E_sun e^-(tau_eye + tau_sun) V dt, mu = r . toward_sun, up to the
//! surface or the end of the air. The reference knows no step: [`crate::scene::curtain`] finds the exact lit runs of the ray,
//! [`crate::medium::Scattering`] integrates each in closed form (by adaptive quadrature where media of different kinds
//! overlap). The sun's disc is a set of points of equal shares of its area, each with runs of its own; where its penumbra is
//! narrower than a pixel one point would do, and more change nothing.
//!
//! Multiple scattering is not simulated: in air of optical depth tau and single-scattering albedo w about w tau / 2 of the
//! scattered light is missing from each further order.

use super::{Contribution, Decision, Effect, Field, Kind, Knob, Pass, Resource};
use crate::medium::Scattering;
use crate::scene::curtain::complement;
use glam::DVec3;

/// Sunlight scattered by the air.
pub const SHAFTS: Effect = Effect {
    name: "shafts",
    summary: "sunlight scattered by the air, between exact shadows",
    reads: &[Field::Surface],
    writes: &[Field::InscatterSun],
    remembers: false,
    knobs: &[
        Knob {
            name: "suns",
            meaning: "points of the sun's disc, lit runs for each",
            values: [1.0, 4.0, 8.0, 16.0],
            range: [1.0, 4096.0],
        },
        Knob {
            name: "steps",
            meaning: "steps along each ray on a GPU (the reference knows none)",
            values: [64.0, 192.0, 512.0, 2048.0],
            range: [1.0, 65536.0],
        },
    ],
    decide: |conditions| {
        if conditions.air.media.is_empty() {
            return Decision::nothing("the scene has no medium: nothing scatters light");
        }
        if !conditions.sun.shines() {
            return Decision::nothing("the sun is below the horizon");
        }
        let media = &conditions.air.media;
        if media.iter().all(|m| m.scattering.max_element() == 0.0) {
            return Decision::nothing("no medium scatters light");
        }
        // At most p_max E albedo (1 - e^-tau) comes from a ray: the integral of sigma_t e^-tau.
        let strongest = media
            .iter()
            .filter(|m| m.scattering.max_element() > 0.0)
            .map(|m| {
                let albedo = m.scattering / m.extinction().max(DVec3::splat(f64::MIN_POSITIVE));
                m.phase.peak() * albedo.max_element()
            })
            .fold(0.0, f64::max);
        Decision::run(
            format!("sunlight meets {}", conditions.media_phrase()),
            Contribution::Bound(
                strongest
                    * conditions.air.greatest_sun_gain()
                    * conditions.sun.illuminance_lux()
                    * -(-conditions.greatest_optical_depth()).exp_m1(),
            ),
        )
    },
    reference: |conditions, settings| {
        let suns = conditions.sun.points(settings.get("suns") as usize);
        let toward: Vec<DVec3> = suns.iter().map(|sun| sun.toward).collect();
        let before_sky = conditions.air.before_sky();
        let open = conditions.air.with_sources(|medium| !medium.is_clear_air());
        Box::new(move |fields| {
            let mut dark = Vec::new();
            fields.update(Field::InscatterSun, |ray, _, surface, present| {
                // On a ray that meets nothing the clear air only takes from what other media send.
                let (air, within) = match surface.is_met() {
                    true => (&conditions.air, &conditions.air),
                    false => (&open, &before_sky),
                };
                let end = surface.distance.min(within.end(ray.origin, ray.direction));
                if end <= 0.0 {
                    return present;
                }
                conditions.geometry.dark_runs(ray, end, &toward, &mut dark);
                let mut sum = DVec3::ZERO;
                for (sun, dark) in suns.iter().zip(&dark) {
                    let scattering =
                        Scattering::new(air, ray.origin, ray.direction, end, sun.toward);
                    for [from, to] in complement(dark, end) {
                        sum += sun.illuminance * scattering.integrate(from, to);
                    }
                }
                present + sum
            });
        })
    },
    passes: &[Pass {
        shader: include_str!("../../shaders/shafts.wgsl"),
        entry: "march",
        kind: Kind::EachSun("suns"),
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::InscatterSun),
            Resource::Table(|_, settings| vec![settings.get("steps") as f32]),
        ],
    }],
};
