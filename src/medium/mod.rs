//! What fills the air: shapes, scattering and absorption coefficients, phase functions.
//!
//! # The clear air
//!
//! Sky and sun models hold the light of the clear air already: the sun's illuminance is that at the site, the sky's radiance is
//! what comes through to the eye. Media of the shape [`Shape::Air`] make that air visible between the eye and what it sees,
//! counted once:
//! - toward the sun they count only against the site: overhead (density - 1), negative above the site's height, where the sun
//!   is brighter. It never falls below -overhead, which is finite for any sun ([`clear::overhead`] says how);
//! - a ray that meets a surface is attenuated and lit as in any medium;
//! - on a ray that meets nothing they add no light and attenuate neither sky nor disc ([`Air::before_sky`]); of the sky's light
//!   is taken what geometry shadows of them ([`crate::effect::air_shadow`]). Light that other media send there still passes
//!   through them, as it does beside it on a ray that meets a surface.

mod airlight;
mod body;
pub mod clear;
mod curved;
mod ellipsoid;
mod even;
mod exponential;
mod height;
mod layer;
mod line;
mod local;
mod phase;
mod region;
mod scattering;
mod shape;
mod sight;

pub use airlight::Airlight;
pub use clear::ClearAir;
pub use even::Even;
pub use exponential::gauss_nodes;
pub use local::{LocalScattering, Pattern};
pub use phase::{Fog, Phase};
pub use scattering::Scattering;
pub use shape::{Edge, FARTHEST, Medium, Shape, Wave};
pub use sight::{Kind, Sight, kinds};

use crate::beam::Beam;
use glam::DVec3;
use height::{Height, HeightTerm};

/// The air of a scene: its media above its ground.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Air {
    /// The media. Those of the shape haze begin at the ground.
    pub media: Vec<Medium>,
    /// Height of the ground [m].
    pub ground: f64,
}

impl Air {
    /// The media that take light from sky and disc: all but the clear air.
    pub fn before_sky(&self) -> Air {
        let mut air = self.clone();
        air.media.retain(|medium| !medium.is_clear_air());
        air
    }

    /// Extinction coefficient at a place [1/m].
    pub fn extinction_at(&self, point: DVec3) -> DVec3 {
        let of = |medium: &Medium| self.density(medium, point) * medium.extinction();
        self.media.iter().map(of).sum()
    }

    /// What the media at a place send on of light of 1 lx that comes in at an angle, whose cosine is less than 1 by so much
    /// [1/(m sr)].
    pub fn scattered_at(&self, point: DVec3, one_minus_mu: f64) -> DVec3 {
        let of = |medium: &Medium| match medium.scattering == DVec3::ZERO {
            true => DVec3::ZERO,
            false => {
                let density = self.density(medium, point);
                density * medium.phase.value(one_minus_mu) * medium.scattering
            }
        };
        self.media.iter().map(of).sum()
    }

    /// Of a medium at a place [1], relative to where its coefficients are those given.
    fn density(&self, medium: &Medium, point: DVec3) -> f64 {
        match (self.body(medium), &medium.shape) {
            (Some(body), _) => body.density(point),
            (
                None,
                Shape::Height {
                    base, scale_height, ..
                }
                | Shape::Air {
                    base, scale_height, ..
                },
            ) => Height::new(*base, *scale_height, point, DVec3::ZERO).density(0.0),
            (None, _) => 0.0,
        }
    }

    /// The same air, without what depends on where the sun stands: how much of the clear air its light has come through.
    pub fn without_sun(&self) -> Air {
        let mut air = self.clone();
        for medium in &mut air.media {
            if let Shape::Air { overhead, .. } = &mut medium.shape {
                *overhead = DVec3::ZERO;
            }
        }
        air
    }

    /// The same air, in which only the media that `scatters` keeps send light; the others absorb what they would scatter.
    pub fn with_sources(&self, scatters: impl Fn(&Medium) -> bool) -> Air {
        let mut air = self.clone();
        for medium in air.media.iter_mut().filter(|medium| !scatters(medium)) {
            medium.absorption = medium.extinction();
            medium.scattering = DVec3::ZERO;
        }
        air
    }

    /// The most by which sunlight may be brighter somewhere than at the site [1], at least 1.
    pub fn greatest_sun_gain(&self) -> f64 {
        let overhead = self.media.iter().map(|medium| match medium.shape {
            Shape::Air { overhead, .. } => overhead,
            _ => DVec3::ZERO,
        });
        overhead.sum::<DVec3>().max_element().exp()
    }

    /// Distance beyond which a ray that meets nothing sees no more air [m].
    pub fn end(&self, ray_origin: DVec3, ray_direction: DVec3) -> f64 {
        self.media
            .iter()
            .map(|medium| {
                let within = self.body(medium);
                let within =
                    within.map_or(f64::INFINITY, |body| body.end(ray_origin, ray_direction));
                match medium.shape {
                    Shape::Height { far, .. }
                    | Shape::Air { far, .. }
                    | Shape::Layer { far, .. } => within.min(far),
                    _ => within,
                }
            })
            .fold(0.0, f64::max)
            .min(FARTHEST)
    }

    /// Optical depth of the first `distance` metres of a ray [1].
    pub fn optical_depth(&self, origin: DVec3, direction: DVec3, distance: f64) -> DVec3 {
        let depth = |medium: &Medium| match self.body(medium) {
            Some(body) => medium.extinction() * body.length(origin, direction, distance),
            None => HeightTerm::new(medium, origin, direction, DVec3::Y, DVec3::ZERO)
                .map_or(DVec3::ZERO, |term| term.eye_depth(distance)),
        };
        self.media.iter().map(depth).sum()
    }

    /// Optical depth from a point to the sun [1]: of the clear air relative to the site, so that it may be negative; beyond all
    /// bounds where another haze or height medium is met by a sun that is not above the horizon.
    pub fn sun_optical_depth(&self, point: DVec3, toward_sun: DVec3) -> DVec3 {
        self.depth_beyond(point, toward_sun, |_| true)
    }

    /// Optical depth from a point to where a beam comes from [1]: of parallel light as [`Air::sun_optical_depth`], of a local beam
    /// that of all media on the way.
    pub fn beam_optical_depth(&self, point: DVec3, beam: &Beam) -> DVec3 {
        match beam {
            Beam::Parallel { toward, .. } => self.sun_optical_depth(point, *toward),
            Beam::Local { .. } => {
                self.optical_depth(point, beam.toward_from(point), beam.distance_from(point))
            }
        }
    }

    /// Optical depth from a point to the sky in some direction [1]: that of all media but the clear air.
    pub fn sky_optical_depth(&self, point: DVec3, direction: DVec3) -> DVec3 {
        self.depth_beyond(point, direction, |medium| !medium.is_clear_air())
    }

    fn depth_beyond(&self, point: DVec3, toward: DVec3, counts: fn(&Medium) -> bool) -> DVec3 {
        let depth = |medium: &Medium| match self.body(medium) {
            Some(body) => {
                let extinction = medium.extinction();
                extinction * body.depth(point, toward, extinction)
            }
            None => HeightTerm::new(medium, point, DVec3::X, toward, DVec3::ZERO)
                .map_or(DVec3::ZERO, |term| term.sun_depth(0.0)),
        };
        self.media.iter().filter(|m| counts(m)).map(depth).sum()
    }
}

#[cfg(test)]
mod tests;
