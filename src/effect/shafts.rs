//! Sunlight scattered once by the air toward the eye: light shafts. What all methods of integrating it share.
//!
//! L = integral over the ray of sum_i sigma_s,i p_i(mu) E_sun e^-(tau_eye + tau_sun) V dt, mu = r . toward_sun, up to the
//! surface or the end of the air. The reference knows no step and no method: [`crate::scene::curtain`] finds the exact lit runs
//! of the ray, [`crate::medium::Scattering`] integrates each in closed form (by adaptive quadrature where media of different
//! kinds overlap). The sun's disc is a set of points of equal shares of its area, each with runs of its own; where its penumbra
//! is narrower than a pixel one point would do, and more change nothing.
//!
//! Panes colour the light on both its ways ([`crate::scene::panes`]): a run ends where what they leave changes, and the sun's disc is
//! points then.
//!
//! Multiple scattering is not simulated: in air of optical depth tau and single-scattering albedo w about w tau / 2 of the
//! scattered light is missing from each further order.

use super::{Batch, Contribution, Decision, Field, Keeper, Knob, Settings, sun_beams};
use crate::beam::Beam;
use crate::conditions::{Conditions, DiscInAir, Told};
use crate::error::Result;
use crate::medium::Scattering;
use crate::scene::penumbra::{NODES, SoftShade};
use glam::DVec3;
use std::sync::Arc;

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

/// At least so many points stand for the sun's disc where panes colour its light: their borders are as sharp as those of surfaces.
const FEWEST: usize = 16;

/// What stands for the sun in the air.
enum SunInAir {
    /// The whole disc, its edges told apart; points where a ray cannot.
    Disc(Arc<DiscInAir>),
    /// Points, and why, where it could have been the disc.
    Points(Option<&'static str>),
}

fn sun_in_air(conditions: &Conditions, settings: &Settings<'_>, on_gpu: bool) -> SunInAir {
    if settings.get("disc") == 0.0 {
        return SunInAir::Points(None);
    }
    match conditions.disc_in_air() {
        None => SunInAir::Points(None),
        Some(disc) => match disc.told {
            Told::Not => SunInAir::Points(Some("shadows have too many edges")),
            // Edges of penumbrae are told apart for what stops light, not for what colours it.
            _ if conditions.geometry.panes().is_some() => {
                SunInAir::Points(Some("panes colour the light too variously"))
            }
            // Passes on a device know nothing of them within a penumbra.
            _ if on_gpu && conditions.geometry.has_holes() => {
                SunInAir::Points(Some("surfaces have holes"))
            }
            Told::Mostly if on_gpu => {
                SunInAir::Points(Some("some rays pass leaves or too many edges of shadows"))
            }
            Told::Mostly | Told::Everywhere => SunInAir::Disc(disc),
        },
    }
}

/// What a user may want to know of it.
fn note_of(sun: &SunInAir, beams: usize) -> Option<String> {
    match sun {
        SunInAir::Points(Some(reason)) => Some(format!(
            "{reason} for the sun's disc to be told in the air: {beams} points stand for it there (`suns`)",
        )),
        _ => None,
    }
}

/// The same of passes on a GPU.
pub fn note(conditions: &Conditions, settings: &Settings<'_>) -> Option<String> {
    let sun = sun_in_air(conditions, settings, true);
    note_of(&sun, sun_beams(conditions, settings).len())
}

/// The beams for which passes of all methods run: the disc as a whole, whose edges [`super::soft_edges`] then makes soft, or its points.
pub fn beams(conditions: &Conditions, settings: &Settings<'_>) -> Vec<Beam> {
    match sun_in_air(conditions, settings, true) {
        SunInAir::Disc(disc) => vec![disc.beam],
        SunInAir::Points(_) => sun_beams(conditions, settings),
    }
}

/// The beam whose shadows have soft edges, if there is one.
pub fn soft_beams(conditions: &Conditions, settings: &Settings<'_>) -> Vec<Beam> {
    match sun_in_air(conditions, settings, true) {
        SunInAir::Disc(disc) => vec![disc.beam],
        SunInAir::Points(_) => Vec::new(),
    }
}

/// The exact lit runs and their integrals, for whichever method.
pub fn reference<'a>(
    conditions: &'a Conditions,
    settings: &Settings<'_>,
    kept: &Keeper<'_>,
) -> Result<Batch<'a>> {
    let sun = sun_in_air(conditions, settings, false);
    let beams = match (&sun, conditions.geometry.panes()) {
        (SunInAir::Points(Some(_)), Some(_)) => {
            conditions.sun_beams(FEWEST.max(settings.get("suns") as usize))
        }
        _ => sun_beams(conditions, settings),
    };
    note_of(&sun, beams.len())
        .into_iter()
        .for_each(|note| kept.note(note));
    let disc = match sun {
        SunInAir::Disc(disc) => Some(disc),
        SunInAir::Points(_) => None,
    };
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
            if let Some(disc) = &disc {
                let DiscInAir { edges, beam, .. } = &**disc;
                let scattering = Scattering::new(air, ray.origin, ray.direction, end, beam);
                if geometry.soft_shade(ray, end, edges, scattering.borders(), &mut soft) {
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
            let sighted = geometry.sighted(ray, end);
            for (beam, shade) in beams.iter().zip(&shades) {
                let scattering = Scattering::new(air, ray.origin, ray.direction, end, beam);
                for ([from, to], pass) in sighted.of(shade.lit(end)) {
                    sum += pass * beam.strength() * scattering.integrate(from, to);
                }
            }
            present + sum
        });
    }))
}
