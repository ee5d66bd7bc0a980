//! The ways of integrating the light of a lamp over its lit runs of a ray.

use super::met::Met;
use crate::conditions::Conditions;
use crate::medium::{Airlight, Even, LocalScattering, Pattern};
use crate::photometry::Distribution;
use crate::scene::Ray;
use crate::scene::shade::Run;
use glam::DVec3;
use std::f64::consts::PI;

/// How the light of lamps in the air is integrated. They differ only in that: inputs, outputs and tests are shared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Integrator {
    /// Exact lit runs, each to a relative error: [`crate::medium::LocalScattering`].
    Exact,
    /// Packard's glow where its bound is within the error and nothing stands in the way, else as `Exact`: [`Airlight::glow`].
    Glow,
    /// The closed form of homogeneous air on exact lit runs, elsewhere as `Exact`: [`Airlight::exact`].
    Airlight,
    /// So many nodes on each exact lit run, even in the angle that the lamp sees (Kulla & Fajardo 2012).
    Equiangular,
    /// Virtual planes with a projected, shadowed light map (`air_lamps/planes.rs`).
    Planes,
    /// As `Exact`, on the lit runs of rows in the plane of eye and lamp (`air_lamps/rows.rs`).
    Rows,
}

impl Integrator {
    /// All of them, by the value of the knob `integrator`.
    pub const ALL: [Integrator; 6] = [
        Integrator::Exact,
        Integrator::Glow,
        Integrator::Airlight,
        Integrator::Equiangular,
        Integrator::Planes,
        Integrator::Rows,
    ];

    /// Its name in flags and reports.
    pub fn name(self) -> &'static str {
        match self {
            Integrator::Exact => "exact",
            Integrator::Glow => "glow",
            Integrator::Airlight => "airlight",
            Integrator::Equiangular => "equiangular",
            Integrator::Planes => "planes",
            Integrator::Rows => "rows",
        }
    }
}

/// How runs are integrated.
pub(super) struct Care {
    pub integrator: Integrator,
    /// Relative error of what is not in closed form.
    pub error: f64,
    /// Of equi-angular sampling.
    pub nodes: Vec<[f64; 2]>,
}

/// What a spot of 1 cd adds on lit runs of a ray, each with the share of its light that reaches it [1/(m2 sr)].
pub(super) fn integrate(
    conditions: &Conditions,
    met: &Met<'_>,
    ray: &Ray,
    runs: &[(Run, DVec3)],
    care: &Care,
) -> DVec3 {
    let is_closed = matches!(care.integrator, Integrator::Glow | Integrator::Airlight);
    if is_closed && let Some(sum) = in_closed_form(conditions, met, ray, runs, care) {
        return sum;
    }
    let Met { lamp, spot, .. } = met;
    let shape = |direction: DVec3| lamp.shape(spot, direction);
    let pattern = Pattern {
        shape: &shape,
        detail: lamp.distribution.detail(),
    };
    let scattering = LocalScattering::new(
        &conditions.air,
        ray.origin,
        ray.direction,
        met.span[1],
        spot.position,
        spot.radius,
    )
    .shaped(pattern, &met.bends, care.error);
    let run = |([from, to], pass): &(Run, DVec3)| {
        pass * match care.integrator {
            Integrator::Equiangular => scattering.sample(*from, *to, &care.nodes),
            _ => scattering.integrate(*from, *to),
        }
    };
    runs.iter().map(run).sum()
}

/// The same where lamp, air and runs are such as a closed form holds for.
fn in_closed_form(
    conditions: &Conditions,
    met: &Met<'_>,
    ray: &Ray,
    runs: &[(Run, DVec3)],
    care: &Care,
) -> Option<DVec3> {
    let Met {
        lamp, spot, span, ..
    } = met;
    let is_even = matches!(lamp.distribution, Distribution::Isotropic);
    if !is_even || spot.side.is_some() || spot.radius > 0.0 {
        return None;
    }
    let air = Even::of(
        &conditions.air,
        ray.origin,
        ray.direction,
        *span,
        spot.position,
    )?;
    // No nearer than the exact way takes the ray to pass it.
    let foot = (spot.position - ray.origin).dot(ray.direction);
    let least = 1e-9 * (1.0 + foot.abs());
    let light = Airlight::new(ray.at(air.enter), ray.direction, spot.position, least);
    let each = |value: &dyn Fn(f64) -> f64| {
        let DVec3 { x, y, z } = air.extinction;
        let first = value(x);
        let other = |extinction: f64| match extinction == x {
            true => first,
            false => value(extinction),
        };
        DVec3::new(first, other(y), other(z))
    };
    let from_enter = |run: &Run| run.map(|t| t - air.enter);
    let strength = spot.share / (4.0 * PI) * air.scattering;
    if care.integrator == Integrator::Airlight {
        let run = |(run, pass): &(Run, DVec3)| {
            let [from, to] = from_enter(run);
            *pass * each(&|extinction| light.exact(extinction, from, to))
        };
        return Some(strength * runs.iter().map(run).sum::<DVec3>());
    }
    // The whole of the ray in one: nothing stands in the way.
    let (run, _) = runs
        .first()
        .filter(|(_, pass)| runs.len() == 1 && *pass == DVec3::ONE)?;
    let [from, to] = from_enter(run);
    let off = each(&|extinction| light.glow_error(extinction, from, to));
    let is_whole = *run == *span && off.max_element() <= care.error;
    is_whole.then(|| strength * each(&|extinction| light.glow(extinction, from, to)))
}
