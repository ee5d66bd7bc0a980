//! Light of lamps scattered once by the air toward the eye: cones, glows.
//!
//! L = sum over lamps of integral over the ray of sum_i sigma_s,i p_i(mu) I(direction) e^-(tau_eye + tau_lamp) V / d^2 dt. The part of
//! the ray that a lamp's cone and side leave is found first: a ray that meets none costs nothing more. On it the fan between lamp and
//! ray gives the exact lit runs ([`crate::scene::curtain`]), and each is integrated in the angle that the lamp sees
//! ([`crate::medium::LocalScattering`]), in which nothing peaks however near the lamp is. A lamp with an extent is as many points as `points`
//! says.
//!
//! Lamps are gone through by the most that they could add; the last, which together could add less than a share of what the others
//! do, are left out. Light that is scattered more than once is neglected.

use super::surface_lamps::{LEFT_OUT, NO_LAMPS, counted};
use super::{Contribution, Decision, Effect, Field, Knob};
use crate::colour::luminance;
use crate::conditions::Conditions;
use crate::conditions::lamps::{Lamp, Spot};
use crate::conditions::received::rests;
use crate::medium::{LocalScattering, Pattern, Shape};
use crate::scene::Ray;
use crate::scene::shade::Shade;
use glam::DVec3;

/// Light of lamps in the air.
pub const AIR_LAMPS: Effect = Effect {
    name: "air_lamps",
    summary: "light of lamps that the air scatters to the eye",
    reads: &[Field::Surface],
    writes: &[Field::InscatterLights],
    knobs: &[
        Knob {
            name: "points",
            meaning: "points, each way, that stand for a lamp with an extent",
            values: [1.0, 2.0, 4.0, 8.0],
            range: [1.0, 64.0],
        },
        Knob {
            name: "error",
            meaning: "relative error of the integral over a lit run",
            values: [1e-2, 1e-3, 3e-4, 1e-6],
            range: [1e-9, 0.1],
        },
        LEFT_OUT,
    ],
    decide,
    reference: |conditions, settings, _| {
        let points = settings.get("points") as u32;
        let (error, left_out) = (settings.get("error"), settings.get("left_out"));
        let spots: Vec<(&Lamp, Spot)> = conditions
            .lamps
            .iter()
            .flat_map(|lamp| lamp.spots(points).into_iter().map(move |spot| (lamp, spot)))
            .collect();
        Ok(Box::new(move |fields| {
            let mut met = Vec::new();
            let mut shades = Vec::new();
            fields.update(Field::InscatterLights, |ray, _, surface, present| {
                let end = conditions.air.end(ray.origin, ray.direction);
                let end = surface.distance.min(end);
                if end <= 0.0 {
                    return present;
                }
                met.clear();
                met.extend(spots.iter().filter_map(|(lamp, spot)| {
                    let bends = lamp.bends(spot, ray);
                    let span = illuminated(lamp, spot, ray, &bends, end)?;
                    let span = on_its_side(conditions, spot, ray, span)?;
                    let most = at_most(conditions, lamp, spot, ray, span);
                    (most > 0.0).then_some(Met {
                        lamp,
                        spot,
                        span,
                        bends,
                        most,
                    })
                }));
                met.sort_by(|a: &Met, b: &Met| b.most.total_cmp(&a.most));
                let rests = rests(met.iter().map(|met| met.most));
                let mut sum = DVec3::ZERO;
                for (met, rest) in met.iter().zip(rests) {
                    if rest <= left_out * luminance(sum) {
                        break;
                    }
                    sum += scattered(conditions, met, ray, error, &mut shades);
                }
                present + sum
            });
        }))
    },
    ..Effect::NOTHING
};

fn decide(conditions: &Conditions) -> Decision {
    if conditions.lamps.is_empty() {
        return Decision::nothing(NO_LAMPS);
    }
    let media = &conditions.air.media;
    if media.is_empty() {
        return Decision::nothing("the scene has no medium: nothing scatters light");
    }
    if media.iter().all(|m| m.scattering.max_element() == 0.0) {
        return Decision::nothing("no medium scatters light");
    }
    let strongest = media.iter().map(|m| m.phase.peak()).fold(0.0, f64::max);
    let lit = -(-conditions.greatest_optical_depth()).exp_m1();
    Decision::run(
        format!(
            "{} in {}",
            counted(conditions.lamps.len()),
            conditions.media_phrase()
        ),
        Contribution::Estimate(strongest * lit * conditions.typical_lamp_light()),
    )
}

/// A spot of a lamp on whose light a ray may come.
struct Met<'a> {
    lamp: &'a Lamp,
    spot: &'a Spot,
    /// The part of the ray on which it may shine [m].
    span: [f64; 2],
    /// Where its light begins, ends or bends along the ray [m].
    bends: Vec<f64>,
    /// The most that it adds [cd/m2, luminance].
    most: f64,
}

/// The part of the first `end` metres of a ray on which a spot may shine.
fn illuminated(lamp: &Lamp, spot: &Spot, ray: &Ray, bends: &[f64], end: f64) -> Option<[f64; 2]> {
    let inner = bends.iter().copied().filter(|t| *t > 0.0 && *t < end);
    let mut hull: Option<[f64; 2]> = None;
    let mut from = 0.0;
    for to in inner.chain([end]) {
        if lamp.faces(spot, ray.at(0.5 * (from + to))) {
            hull = Some([hull.map_or(from, |[first, _]| first), to]);
        }
        from = to;
    }
    hull.filter(|[from, to]| to > from)
}

/// The part of a span on which the ground does not lie between a spot under it and the ray.
fn on_its_side(
    conditions: &Conditions,
    spot: &Spot,
    ray: &Ray,
    [from, to]: [f64; 2],
) -> Option<[f64; 2]> {
    let Some(ground) = conditions.ground.filter(|g| spot.position.y < g.height) else {
        return Some([from, to]);
    };
    let above = |t: f64| ray.at(t).y >= ground.height;
    let crossing = (ground.height - ray.origin.y) / ray.direction.y;
    match (above(from), above(to)) {
        (true, true) => None,
        (true, false) => Some([crossing.clamp(from, to), to]),
        (false, true) => Some([from, crossing.clamp(from, to)]),
        (false, false) => Some([from, to]),
    }
}

/// A medium is at most e^this times as dense as where its coefficients are those given.
const DENSEST: f64 = 600.0;

/// The most that a spot adds on a span of a ray [cd/m2, luminance]: nothing in the way, no air that takes light.
fn at_most(
    conditions: &Conditions,
    lamp: &Lamp,
    spot: &Spot,
    ray: &Ray,
    [from, to]: [f64; 2],
) -> f64 {
    let lowest = ray.at(from).y.min(ray.at(to).y);
    let coefficient = |medium: &crate::medium::Medium| {
        let density = match medium.shape {
            Shape::Height {
                base, scale_height, ..
            }
            | Shape::Air {
                base, scale_height, ..
            } => ((base - lowest) / scale_height).min(DENSEST).exp(),
            _ => 1.0,
        };
        if medium.scattering == DVec3::ZERO {
            return 0.0;
        }
        density * medium.scattering.max_element() * medium.phase.peak()
    };
    let coefficient: f64 = conditions.air.media.iter().map(coefficient).sum();
    let foot = (spot.position - ray.origin).dot(ray.direction);
    let aside = (ray.at(foot) - spot.position).length().max(spot.radius);
    // As near as the ray is taken to pass it at least.
    let aside = aside.max(1e-9 * (1.0 + foot.abs()));
    let angle = (to - foot).atan2(aside) - (from - foot).atan2(aside);
    // Within its radius a spot gets no brighter, but 1 / r^2 is up to twice 1 / (t^2 + r^2).
    2.0 * lamp.greatest_intensity() * spot.share * coefficient * (angle / aside)
}

/// What a spot adds on a span of a ray [cd/m2, RGB].
fn scattered(
    conditions: &Conditions,
    met: &Met<'_>,
    ray: &Ray,
    error: f64,
    shades: &mut Vec<Shade>,
) -> DVec3 {
    let Met { lamp, spot, .. } = met;
    let [from, to] = met.span;
    let part = Ray {
        origin: ray.at(from),
        direction: ray.direction,
    };
    let geometry = lamp.geometry(&conditions.geometry);
    geometry.shades(&part, to - from, &[Lamp::beam(spot)], shades);
    let lit = shades.first().map(|shade| shade.lit(to - from));
    let lit = lit.unwrap_or_default();
    if lit.is_empty() {
        return DVec3::ZERO;
    }
    let shape = |direction: DVec3| lamp.shape(spot, direction);
    let pattern = Pattern {
        shape: &shape,
        detail: lamp.distribution.detail(),
    };
    let scattering = LocalScattering::new(
        &conditions.air,
        ray.origin,
        ray.direction,
        to,
        spot.position,
        spot.radius,
    )
    .shaped(pattern, &met.bends, error);
    let lit = lit
        .into_iter()
        .map(|([a, b], pass)| ([from + a, from + b], pass));
    // Panes before the eye do not depend on the lamp.
    let sighted = conditions.geometry.sighted(ray, to);
    let sum: DVec3 = sighted
        .of(lit.collect())
        .into_iter()
        .map(|([a, b], pass)| pass * scattering.integrate(a, b))
        .sum();
    lamp.intensity * sum
}
