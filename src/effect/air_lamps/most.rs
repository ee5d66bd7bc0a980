//! The most that lamps add to a ray, whatever stands in the way.
//!
//! On a part of the ray of length l that comes no nearer to a lamp than d, the integral of 1 / d^2 is at most min(pi / d, l / d^2). Where
//! a convex, homogeneous medium holds that part and the lamp, light has gone at least as far in it as the lamp is from where the ray
//! enters, since two sides of a triangle are longer than the third, and at least as far as the part's start and the distance from it
//! together. Air that thins with height is at least as dense as it is where that way is highest.

use crate::conditions::Conditions;
use crate::conditions::lamps::{Lamp, Spot};
use crate::conditions::volumes::{Bounds, EVERYWHERE, Volume, greatest_integral, joined, part};
use crate::medium::{Medium, Shape};
use crate::scene::Ray;
use glam::DVec3;

/// A medium is at most e^this times as dense as where its coefficients are those given.
const DENSEST: f64 = 600.0;

/// Where lamps light air that sends light on, for those who look from above the ground.
pub(super) fn lit_world(conditions: &Conditions) -> Bounds {
    let air = &conditions.air;
    let scatters = |medium: &&Medium| medium.scattering != DVec3::ZERO;
    let of = |medium: &Medium| {
        let mut bounds = medium.bounds().unwrap_or(EVERYWHERE);
        match &medium.shape {
            Shape::Haze { top } => (bounds[0].y, bounds[1].y) = (air.ground, *top),
            Shape::Layer {
                top, waves, bottom, ..
            } => {
                let rise: f64 = waves.iter().map(|wave| wave.amplitude.abs()).sum();
                bounds[0].y = bottom.unwrap_or(f64::NEG_INFINITY);
                bounds[1].y = top + rise;
            }
            _ => {}
        }
        bounds
    };
    let all = air.media.iter().filter(scatters).map(of);
    let mut world = all.reduce(|a, b| joined(&a, &b)).unwrap_or(EVERYWHERE);
    if let Some(ground) = conditions.ground {
        world[0].y = world[0].y.max(ground.height);
    }
    world
}

/// What is lost on the way from a lamp over a part of the ray to the eye, at least.
enum Loss {
    /// In a convex, homogeneous medium.
    Within {
        extinction: f64,
        bounds: Bounds,
        /// Where the ray is inside [m], and where it enters.
        chord: [f64; 2],
        enters: DVec3,
    },
    /// In air that thins with height.
    Thinning {
        extinction: f64,
        base: f64,
        scale_height: f64,
    },
}

/// The most that lamps add to one ray.
pub(super) struct Most<'r> {
    ray: &'r Ray,
    /// The part of it that counts [m].
    span: [f64; 2],
    /// Whether the reach of lamps in the world is theirs on this ray.
    is_in_world: bool,
    /// Scattering coefficient times greatest phase function, on all of it [1/(m sr)].
    coefficient: f64,
    losses: Vec<Loss>,
}

impl<'r> Most<'r> {
    pub fn new(conditions: &Conditions, ray: &'r Ray, end: f64) -> Self {
        let air = &conditions.air;
        let ground = conditions.ground.map_or(f64::NEG_INFINITY, |g| g.height);
        let lowest = ray.origin.y.min(ray.at(end).y);
        let coefficient = |medium: &Medium| {
            let density = match medium.shape {
                Shape::Height {
                    base, scale_height, ..
                }
                | Shape::Air {
                    base, scale_height, ..
                } => ((base - lowest) / scale_height).min(DENSEST).exp(),
                _ => 1.0,
            };
            match medium.scattering == DVec3::ZERO {
                true => 0.0,
                false => density * medium.scattering.max_element() * medium.phase.peak(),
            }
        };
        let loss = |medium: &Medium| {
            let extinction = medium.extinction().min_element();
            let [low, high] = EVERYWHERE;
            let bounds = match &medium.shape {
                Shape::Box { min, max } => [*min, *max],
                Shape::Haze { top } => [low.with_y(air.ground), high.with_y(*top)],
                Shape::Layer {
                    top, waves, bottom, ..
                } if waves.is_empty() => [
                    low.with_y(bottom.unwrap_or(f64::NEG_INFINITY)),
                    high.with_y(*top),
                ],
                Shape::Height {
                    base, scale_height, ..
                }
                | Shape::Air {
                    base, scale_height, ..
                } => {
                    return Some(Loss::Thinning {
                        extinction,
                        base: *base,
                        scale_height: *scale_height,
                    });
                }
                _ => return None,
            };
            let chord = part(&bounds, ray, [0.0, f64::INFINITY])?;
            Some(Loss::Within {
                extinction,
                bounds,
                chord,
                enters: ray.at(chord[0]),
            })
        };
        Most {
            ray,
            span: [0.0, end],
            is_in_world: ray.origin.y >= ground,
            coefficient: air.media.iter().map(coefficient).sum(),
            losses: air.media.iter().filter_map(loss).collect(),
        }
    }

    /// The most that a group of lamps adds [cd/m2, luminance].
    pub fn of_group(&self, group: &Volume) -> f64 {
        let span = match self.is_in_world {
            true => group.part(self.ray, self.span),
            false => Some(self.span),
        };
        let Some([from, to]) = span else {
            return 0.0;
        };
        let distance = group.distance_to_part(self.ray, [from, to]);
        let loss = self.loss(group, [from, to], distance);
        group.power * self.coefficient * greatest_integral(to - from, distance) * (-loss).exp()
    }

    /// The most that a spot adds on a part of the ray [cd/m2, luminance].
    pub fn of_spot(&self, lamp: &Lamp, spot: &Spot, [from, to]: [f64; 2]) -> f64 {
        let ray = self.ray;
        let foot = (spot.position - ray.origin).dot(ray.direction);
        let aside = (ray.at(foot) - spot.position).length().max(spot.radius);
        // As near as the ray is taken to pass it at least.
        let aside = aside.max(1e-9 * (1.0 + foot.abs()));
        let angle = (to - foot).atan2(aside) - (from - foot).atan2(aside);
        let place = Volume {
            places: [spot.position; 2],
            reach: EVERYWHERE,
            power: lamp.greatest_intensity() * spot.share,
        };
        let nearest = ray.at(foot.clamp(from, to)).distance(spot.position);
        let loss = self.loss(&place, [from, to], nearest);
        // Within its radius a spot gets no brighter, but 1 / r^2 is up to twice 1 / (t^2 + r^2).
        2.0 * place.power * self.coefficient * (angle / aside) * (-loss).exp()
    }

    /// The least optical depth from lamps over a part of the ray that comes no nearer to them than `distance` to the eye [1].
    fn loss(&self, lamps: &Volume, [from, to]: [f64; 2], distance: f64) -> f64 {
        let [low, high] = lamps.places;
        let of = |loss: &Loss| match loss {
            Loss::Within {
                extinction,
                bounds: [least, greatest],
                chord: [enter, leave],
                enters,
            } => {
                // As long as rounding may have made the part.
                let rounding = 1e-9 * (1.0 + to);
                let holds_part = from >= enter - rounding && to <= leave + rounding;
                let holds_lamps = low.cmpge(*least).all() && high.cmple(*greatest).all();
                match holds_part && holds_lamps {
                    true => extinction * lamps.distance(*enters).max(from - enter + distance),
                    false => 0.0,
                }
            }
            Loss::Thinning {
                extinction,
                base,
                scale_height,
            } => {
                let ends = self.ray.at(from).y.max(self.ray.at(to).y);
                let highest = self.ray.origin.y.max(ends).max(high.y);
                let density = ((base - highest) / scale_height).min(DENSEST).exp();
                let way = lamps.distance(self.ray.origin).max(from + distance);
                extinction * density * way
            }
        };
        self.losses.iter().map(of).sum()
    }
}
