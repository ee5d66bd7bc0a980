//! Air that thins exponentially with height over a flat earth, along a ray.

use super::exponential::phi1;
use super::shape::{Medium, Shape};
use glam::DVec3;

/// No depth toward the sun is greater [1]: a finite number times a density of nothing is nothing.
const BLACK: f64 = 1e300;

/// The exponential profile of a height medium along a ray; lengths are those of air as dense as at the base.
#[derive(Debug, Clone, Copy)]
pub(super) struct Height {
    start: f64,
    rise: f64,
}

impl Height {
    pub fn new(base: f64, scale_height: f64, origin: DVec3, direction: DVec3) -> Self {
        Height {
            start: (origin.y - base) / scale_height,
            rise: direction.y / scale_height,
        }
    }

    /// Density relative to the base. Far below the base e^600 stands for more (so that lengths stay finite): nothing is
    /// seen through either.
    pub fn density(&self, t: f64) -> f64 {
        (-(self.start + self.rise * t)).min(600.0).exp()
    }

    /// Length of base air between two distances, from the denser end (so that nothing overflows against a zero).
    pub fn length(&self, from: f64, to: f64) -> f64 {
        let dense = self.density(from).max(self.density(to));
        dense * (to - from) * phi1((self.rise * (to - from)).abs())
    }
}

/// A height medium along a ray, under a sun.
#[derive(Debug, Clone, Copy)]
pub(super) struct HeightTerm {
    pub profile: Height,
    extinction: DVec3,
    /// Scattering coefficient times phase function [1/(m sr)] at the base.
    pub source: DVec3,
    sun: SunDepth,
}

/// Optical depth toward the sun: `overhead` times the density, less what is counted elsewhere.
#[derive(Debug, Clone, Copy)]
struct SunDepth {
    overhead: DVec3,
    counted: DVec3,
}

impl SunDepth {
    fn at(&self, density: f64) -> DVec3 {
        (self.overhead * density - self.counted).min(DVec3::splat(BLACK))
    }
}

impl HeightTerm {
    /// The term of a medium of shape height or air; `None` for any other. `source` is per unit of density.
    pub fn new(
        medium: &Medium,
        origin: DVec3,
        direction: DVec3,
        toward_sun: DVec3,
        source: DVec3,
    ) -> Option<Self> {
        let extinction = medium.extinction();
        let (base, scale_height, sun) = match medium.shape {
            Shape::Height {
                base, scale_height, ..
            } => {
                // Under a sun that is not above the horizon there is air without end.
                let length = if toward_sun.y > 0.0 {
                    scale_height / toward_sun.y
                } else {
                    f64::MAX
                };
                let sun = SunDepth {
                    overhead: (extinction * length).min(DVec3::splat(BLACK)),
                    counted: DVec3::ZERO,
                };
                (base, scale_height, sun)
            }
            Shape::Air {
                base,
                scale_height,
                overhead,
                ..
            } => {
                let sun = SunDepth {
                    overhead,
                    counted: overhead,
                };
                (base, scale_height, sun)
            }
            _ => return None,
        };
        Some(HeightTerm {
            profile: Height::new(base, scale_height, origin, direction),
            extinction,
            source,
            sun,
        })
    }

    /// Optical depth of the first `distance` metres of the ray [1].
    pub fn eye_depth(&self, distance: f64) -> DVec3 {
        self.extinction * self.profile.length(0.0, distance)
    }

    /// Optical depth from the ray's point at `t` to the sun [1].
    pub fn sun_depth(&self, t: f64) -> DVec3 {
        self.sun.at(self.profile.density(t))
    }

    /// Optical depth from the eye to the point at `t` and on to the sun [1].
    pub fn depth(&self, t: f64) -> DVec3 {
        (self.eye_depth(t) + self.sun_depth(t)).min(DVec3::splat(BLACK))
    }

    /// The integral over a run with nothing else in the air. The density, and with it the depth toward the sun, is linear in
    /// the length of base air l that has been passed; so is the whole exponent Psi, and the integral of e^-Psi dl is
    /// l e^-Psi phi1(dPsi), taken from the end at which Psi is less.
    pub fn integrate(&self, a: f64, b: f64) -> DVec3 {
        let run = self.profile.length(a, b);
        let (first, last) = (self.depth(a), self.depth(b));
        let channel = |i: usize| {
            let change = (last[i] - first[i]).abs();
            self.source[i] * ((-first[i].min(last[i])).exp() * run * phi1(change))
        };
        DVec3::new(channel(0), channel(1), channel(2))
    }
}
