//! Sunlight scattered once by the air toward the eye: light shafts. What all methods of integrating it share.
//!
//! L = integral over the ray of sum_i sigma_s,i p_i(mu) E_sun e^-(tau_eye + tau_sun) V dt, mu = r . toward_sun, up to the
//! surface or the end of the air. The reference knows no step and no method: [`crate::scene::curtain`] finds the exact lit runs
//! of the ray, [`crate::medium::Scattering`] integrates each in closed form (by adaptive quadrature where media of different
//! kinds overlap). The sun's disc is a set of points of equal shares of its area, each with runs of its own; where its penumbra
//! is narrower than a pixel one point would do, and more change nothing.
//!
//! Multiple scattering is not simulated: in air of optical depth tau and single-scattering albedo w about w tau / 2 of the
//! scattered light is missing from each further order.

use super::{Batch, Contribution, Decision, Field, Keeper, Knob, Settings, sun_beams};
use crate::conditions::{Conditions, spread};
use crate::error::Result;
use crate::medium::Scattering;
use crate::scene::edges::Edges;
use crate::scene::penumbra::{NODES, SoftShade};
use glam::DVec3;

/// The knob that all methods have: as many points stand for the sun's disc.
pub const SUNS: Knob = Knob {
    name: "suns",
    meaning: "points of the sun's disc where it is not `disc` (one where no penumbra is as wide as a pixel), lit runs for each",
    values: [1.0, 4.0, 16.0, 128.0],
    range: [1.0, 4096.0],
};

/// The knob that says whether the disc is more than points.
pub const DISC: Knob = Knob {
    name: "disc",
    meaning: "1: the sun's disc as it is, `suns` points only where edges are too many to be told apart; 0: points everywhere",
    values: [0.0, 1.0, 1.0, 0.0],
    range: [0.0, 1.0],
};

/// Whether the air of a scene shows the sun's light, and how much of it at most.
pub fn decide(conditions: &Conditions) -> Decision {
    if conditions.air.media.is_empty() {
        return Decision::nothing("the scene has no medium: nothing scatters light");
    }
    if let Some(reason) = conditions.sun.missing() {
        return Decision::nothing(reason);
    }
    let media = &conditions.air.media;
    if media.iter().all(|m| m.scattering.max_element() == 0.0) {
        return Decision::nothing("no medium scatters light");
    }
    let from = if conditions.sun.angular_radius() > 0.0 && conditions.widest_penumbra() < 1.0 {
        ", as from a point: no edge of a shadow is as wide as a pixel"
    } else {
        ""
    };
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
        format!("sunlight meets {}{from}", conditions.media_phrase()),
        Contribution::Bound(
            strongest
                * conditions.air.greatest_sun_gain()
                * conditions.sun.illuminance_lux()
                * -(-conditions.greatest_optical_depth()).exp_m1(),
        ),
    )
}

/// With more penumbrae than this on the way of a ray, on average, to tell them apart takes many times as long as points of the disc.
const FEW: usize = 40;

/// Whether rays of a picture can tell the edges of shadows apart, judged by some of them.
fn are_told_apart(conditions: &Conditions, edges: &Edges) -> bool {
    const RAYS: usize = 64;
    let pixels = spread(conditions.view.size, RAYS);
    let mut shade = SoftShade::default();
    let (mut told, mut penumbrae) = (0, 0);
    for pixel in &pixels {
        let ray = conditions.view.ray(pixel.as_dvec2() + 0.5);
        let geometry = &conditions.geometry;
        let hit = geometry.closest(&ray, 0.0, f64::INFINITY);
        let end = hit.map_or(f64::INFINITY, |hit| hit.distance);
        let end = end.min(conditions.air.end(ray.origin, ray.direction));
        let is_told = geometry.soft_shade(&ray, end, edges, std::iter::empty(), &mut shade);
        told += usize::from(is_told);
        penumbrae += shade.penumbrae();
    }
    2 * told > pixels.len() && penumbrae <= FEW * pixels.len()
}

/// The exact lit runs and their integrals, for whichever method.
pub fn reference<'a>(
    conditions: &'a Conditions,
    settings: &Settings<'_>,
    kept: &Keeper<'_>,
) -> Result<Batch<'a>> {
    let beams = sun_beams(conditions, settings);
    let edges = match settings.get("disc") > 0.0 {
        true => conditions.sun_edges(),
        false => None,
    };
    let edges = edges.filter(|(edges, _)| {
        let is_told = are_told_apart(conditions, edges);
        if !is_told {
            kept.note(format!(
                "shadows have too many edges for the sun's disc to be told in the air: {} points stand for it there (`suns`)",
                beams.len()
            ));
        }
        is_told
    });
    let before_sky = conditions.air.before_sky();
    let open = conditions.air.with_sources(|medium| !medium.is_clear_air());
    Ok(Box::new(move |fields| {
        let mut shades = Vec::new();
        let mut soft = SoftShade::default();
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
            let geometry = &conditions.geometry;
            let mut sum = DVec3::ZERO;
            if let Some((edges, beam)) = &edges {
                let scattering = Scattering::new(air, ray.origin, ray.direction, end, beam);
                let is_told = geometry.soft_shade(ray, end, edges, scattering.borders(), &mut soft);
                if is_told {
                    for ([from, to], pass) in &soft.lit {
                        sum += *pass * scattering.integrate(*from, *to);
                    }
                    for ramp in &soft.ramps {
                        sum += scattering.integrate_shares(ramp.run, &NODES, &ramp.shares);
                    }
                    return present + beam.strength() * sum;
                }
            }
            geometry.shades(ray, end, &beams, &mut shades);
            for (beam, shade) in beams.iter().zip(&shades) {
                let scattering = Scattering::new(air, ray.origin, ray.direction, end, beam);
                for ([from, to], pass) in shade.lit(end) {
                    sum += pass * beam.strength() * scattering.integrate(from, to);
                }
            }
            present + sum
        });
    }))
}
