//! What of a ray lies in the light of a lamp: in its cone, before its side, on the lamp's side of the ground; and which runs of that
//! are lit.

use crate::conditions::Conditions;
use crate::conditions::lamps::{Lamp, Spot};
use crate::scene::Ray;
use crate::scene::shade::{Run, Shade};
use glam::DVec3;

/// A spot of a lamp on whose light a ray may come.
pub(super) struct Met<'a> {
    /// Its number among all spots; that of a part of a surface is greater than all.
    pub number: usize,
    /// Whose it is.
    pub lamp: &'a Lamp,
    /// The spot.
    pub spot: Spot,
    /// The part of the ray on which it may shine [m].
    pub span: [f64; 2],
    /// Where its light begins, ends or bends along the ray [m].
    pub bends: Vec<f64>,
}

impl<'a> Met<'a> {
    /// What a ray of some length [m] meets of a spot's light; `None` if it misses all of it.
    pub fn of(
        conditions: &Conditions,
        (number, lamp, spot): (usize, &'a Lamp, Spot),
        ray: &Ray,
        end: f64,
    ) -> Option<Self> {
        let bends = lamp.bends(&spot, ray);
        let span = illuminated(lamp, &spot, ray, &bends, end)?;
        Some(Met {
            number,
            lamp,
            spot,
            span: on_its_side(conditions, &spot, ray, span)?,
            bends,
        })
    }

    /// What the spot shines with where its shape is 1 [cd, RGB].
    pub fn light(&self) -> DVec3 {
        self.lamp.intensity * self.spot.tint
    }

    /// The runs of the ray that its light reaches [m], and what is left of it there and on the way to the eye.
    pub fn lit_runs(
        &self,
        conditions: &Conditions,
        ray: &Ray,
        shades: &mut Vec<Shade>,
    ) -> Vec<(Run, DVec3)> {
        let [from, to] = self.span;
        let part = Ray {
            origin: ray.at(from),
            direction: ray.direction,
        };
        let geometry = self.lamp.geometry(&conditions.geometry);
        geometry.shades(&part, to - from, &[Lamp::beam(&self.spot)], shades);
        let lit = shades.first().map(|shade| shade.lit(to - from));
        let along = |([a, b], pass): (Run, DVec3)| {
            // The end of the part is that of the run, without rounding.
            let end = if b == to - from { to } else { from + b };
            ([from + a, end], pass)
        };
        let lit = lit.unwrap_or_default().into_iter().map(along).collect();
        // Panes before the eye do not depend on the lamp.
        conditions.geometry.sighted(ray, to).of(lit)
    }
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
