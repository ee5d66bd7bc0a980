//! The sky dome and the sun, in absolute photometric units, from noon to night.
//!
//! One interface for every model: [`Sky::new`] prepares a model for one place of the sun, [`Sky::radiance`] gives the
//! radiance of a direction, [`Sky::horizontal_illuminance`] what the whole dome gives to the ground. Sunlight itself is
//! [`SunLight`]; a sky never holds the disc.
//!
//! # Through twilight
//!
//! The models are made for the day. From 10 degrees of true solar elevation down, a sky turns into the twilight of
//! [`twilight`]: between 10 and 5 degrees its horizontal illuminance goes (in the logarithm) from the model's own to the
//! published curve of sun and clear sky less the sun's own share; between 10 and 2 degrees its distribution and colour go
//! from the model's to the twilight's. Between -12 and -18 degrees the night comes in, and below that it is alone: stars and
//! airglow, 6.4e-4 lx. A measured irradiance sets the sky's illuminance at every height of the sun.

mod angles;
pub mod cie;
pub mod circles;
pub mod day;
mod dusk;
pub mod gradation;
pub mod hemisphere;
pub mod hosek;
pub mod map;
mod model;
pub mod patches;
pub mod perez;
pub mod preetham;
pub mod sun;
mod table;
pub mod twilight;

pub use model::{DEFAULT_TURBIDITY, Irradiance, Model};
pub use sun::{SunAt, SunLight, SunPath};
pub(crate) use table::constants;

use crate::colour::luminance;
use crate::error::{Error, Result, with_short_numbers};
use crate::units::DEG;
use crate::warning::Warning;
use day::{Day, Position};
use dusk::Blend;
use glam::{DQuat, DVec3};
use perez::Bins;
use std::f64::consts::FRAC_PI_2;

/// A sky for one place of the sun.
#[derive(Debug, Clone)]
pub struct Sky {
    model: Model,
    toward_sun: DVec3,
    /// Unit vector toward the sun's azimuth in the horizontal plane.
    toward_azimuth: DVec3,
    elevation_true: f64,
    sun_is_up: bool,
    blend: Blend,
}

impl Sky {
    /// Prepares a model for one place of the sun, for pictures and maps: continuous from noon to night.
    ///
    /// Errors: [`Error::Domain`] when a parameter is outside the range in which the model holds, or `toward_sun` is no unit vector.
    pub fn new(model: Model, sun: SunAt) -> Result<Self> {
        if (sun.toward_sun.length() - 1.0).abs() > 1e-6 || !sun.elevation_true.is_finite() {
            return Err(Error::domain(
                "the direction toward the sun",
                format!(
                    "{} with elevation {} rad",
                    sun.toward_sun, sun.elevation_true
                ),
                "unit vectors and finite elevations",
                "normalise it",
            ));
        }
        day::check(model)?;
        let blend = match model {
            Model::Uniform { luminance } => Blend::uniform(luminance)?,
            _ => Blend::new(model, sun)?,
        };
        Ok(Sky {
            model,
            toward_sun: sun.toward_sun,
            toward_azimuth: sun.toward_azimuth(),
            elevation_true: sun.elevation_true,
            sun_is_up: sun.is_up(),
            blend,
        })
    }

    /// The same sky turned by an angle about the vertical [rad]: what is toward -Z comes toward -X.
    pub fn turned(&self, by: f64) -> Self {
        let turn = DQuat::from_rotation_y(by);
        Sky {
            toward_sun: turn * self.toward_sun,
            toward_azimuth: turn * self.toward_azimuth,
            ..self.clone()
        }
    }

    /// Radiance toward a unit direction: RGB in the working space, luminance in cd/m2; finite, no channel negative.
    ///
    /// Domain: directions with y >= 0. Gradations are held below 0.57 degrees, so that the horizon is finite and smooth;
    /// a direction below the horizon gets what the horizon has at its angle from the sun.
    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        let mut sum = self.blend.uniform;
        if let Some((day, scale)) = &self.blend.day {
            sum += day.seen(direction, self.toward_sun) * *scale;
        }
        if let Some((twilight, scale)) = &self.blend.twilight {
            let cos_gamma = direction.dot(self.toward_sun);
            sum += twilight.radiance(direction, self.toward_azimuth, cos_gamma) * *scale;
            sum += self.blend.cloud * (1.0 + 2.0 * direction.y.max(0.0));
        }
        sum
    }

    /// The luminance of [`Sky::radiance`] [cd/m2], without the work for its colour.
    pub fn luminance(&self, direction: DVec3) -> f64 {
        let mut sum = luminance(self.blend.uniform);
        if let Some((day, scale)) = &self.blend.day {
            sum += day.luminance(direction, self.toward_sun) * scale;
        }
        if let Some((twilight, scale)) = &self.blend.twilight {
            let cos_gamma = direction.dot(self.toward_sun);
            sum += luminance(twilight.radiance(direction, self.toward_azimuth, cos_gamma)) * scale;
            sum += luminance(self.blend.cloud) * (1.0 + 2.0 * direction.y.max(0.0));
        }
        sum
    }

    /// Illuminance [lx] of the whole dome on the horizontal plane, without the sun: RGB in the working space.
    pub fn horizontal_illuminance(&self) -> DVec3 {
        self.blend.illuminance
    }

    /// Radiance of the zenith: RGB in the working space, luminance in cd/m2.
    pub fn zenith(&self) -> DVec3 {
        self.radiance(DVec3::Y)
    }

    /// The sunlight that belongs to this sky: what comes through the clear air of `path`, as far as the model lets it.
    ///
    /// A measured direct-normal irradiance sets its illuminance (by the efficacy of Perez et al. 1990); CIE types 1 to 6
    /// and 16 hide the sun. Between 5 and 2 degrees that efficacy gives way to the one of sunlight through clear air, of the path's
    /// turbidity or of a lower one that lets the measured irradiance through; this is the whole disc's, of which the visible part
    /// gives its share.
    /// Errors: [`Error::Domain`] when a quantity of `path` is outside its range.
    pub fn sunlight(&self, path: &SunPath) -> Result<SunLight> {
        let turbidity = match self.model.irradiance() {
            Some(measured) => dusk::beam_turbidity(measured, path, self.elevation_true)?,
            None => path.turbidity,
        };
        let clear = SunLight::new(&SunPath { turbidity, ..*path })?;
        let share = self
            .blend
            .beam_share(self.model, self.elevation_true, &clear);
        Ok(clear.dimmed(share))
    }

    /// The model and its parameters.
    pub fn model(&self) -> Model {
        self.model
    }

    /// The unit vector toward the apparent sun.
    pub fn toward_sun(&self) -> DVec3 {
        self.toward_sun
    }

    /// The model's name, as on the command line.
    pub fn name(&self) -> String {
        self.model.name()
    }

    /// One line that says what this sky is.
    pub fn describe(&self) -> String {
        let model = match self.model {
            Model::Perez {
                irradiance: None,
                turbidity,
            } => {
                format!("Perez 1993 all-weather sky, clear, turbidity {turbidity}")
            }
            Model::Perez {
                irradiance: Some(i),
                ..
            } => format!(
                "Perez 1993 all-weather sky, {} W/m2 direct normal, {} W/m2 diffuse horizontal",
                i.direct_normal, i.diffuse_horizontal
            ),
            Model::Preetham { turbidity } => format!("Preetham 1999 sky, turbidity {turbidity}"),
            Model::Hosek { turbidity, albedo } => {
                format!("Hosek-Wilkie 2012 sky, turbidity {turbidity}, ground albedo {albedo}")
            }
            Model::Cie { kind, .. } => format!("CIE S 011 sky, type {kind}"),
            Model::Uniform { luminance } => format!("uniform white sky, {luminance} cd/m2"),
        };
        let model = with_short_numbers(model);
        match self.elevation_true {
            _ if matches!(self.model, Model::Uniform { .. }) => model,
            e if e >= twilight::BEGIN => model,
            e if e > twilight::SHAPE => format!("{model}, turning into twilight"),
            e if e > twilight::END => {
                let sun = if self.sun_is_up { "low" } else { "down" };
                format!("twilight (the sun is {sun}; {model} by day)")
            }
            _ => format!("night without moon ({model} by day)"),
        }
    }

    /// What a user should know about this sky.
    pub fn warnings(&self) -> &[Warning] {
        &self.blend.warnings
    }
}

/// XYZ [cd/m2] of a model as published, toward a direction: [`Published`] for one direction alone.
///
/// # Errors
/// Those of [`Published::new`] and [`Published::xyz`].
pub fn published_xyz(
    model: Model,
    sun_elevation: f64,
    view_azimuth: f64,
    view_elevation: f64,
) -> Result<DVec3> {
    Published::new(model, sun_elevation)?.xyz(view_azimuth, view_elevation)
}

/// A model as published, for one height of the sun: no blending of clearness bins, no twilight, no gamut.
///
/// One astronomical unit, sea level, 2 cm of water, air mass by Kasten 1965, cos(zenith angle) at least 0.01.
#[derive(Debug, Clone)]
pub struct Published {
    day: Day,
    toward_sun: DVec3,
}

impl Published {
    /// Prepares a model for a sun at an elevation [rad] above 0, to 90 degrees.
    ///
    /// # Errors
    /// [`Error::Domain`] outside the model's range.
    pub fn new(model: Model, sun_elevation: f64) -> Result<Self> {
        if !(sun_elevation > 0.0 && sun_elevation <= FRAC_PI_2 + 1e-12) {
            return Err(Error::domain(
                "the sun's elevation",
                format!("{} degrees", sun_elevation / DEG),
                "above 0, to 90 degrees",
                "the models as published have no sky without a sun; pictures and maps go on into the night",
            ));
        }
        if let Model::Uniform { luminance } = model {
            Blend::uniform(luminance)?;
        }
        let zenith_angle = (FRAC_PI_2 - sun_elevation).max(0.0);
        let position = Position {
            zenith_angle,
            seen_zenith_angle: zenith_angle,
            distance_au: 1.0,
            site_elevation: 0.0,
        };
        let (sin, cos) = sun_elevation.sin_cos();
        Ok(Published {
            day: Day::new(model, position, Bins::Published)?,
            toward_sun: DVec3::new(cos, sin, 0.0),
        })
    }

    /// XYZ [cd/m2] toward an azimuth from the sun's [rad] and an elevation [rad], 0 to 90 degrees.
    ///
    /// # Errors
    /// [`Error::Domain`] below the horizon.
    pub fn xyz(&self, view_azimuth: f64, view_elevation: f64) -> Result<DVec3> {
        if !(-1e-12..=FRAC_PI_2 + 1e-12).contains(&view_elevation) || !view_azimuth.is_finite() {
            return Err(Error::domain(
                "the view's elevation",
                format!("{} degrees", view_elevation / DEG),
                "0 to 90 degrees",
                "a sky has no direction below the horizon",
            ));
        }
        let (sin, cos) = view_elevation.sin_cos();
        let (sin_azimuth, cos_azimuth) = view_azimuth.sin_cos();
        let view = DVec3::new(cos * cos_azimuth, sin.max(0.0), cos * sin_azimuth);
        Ok(self.day.xyz(view, self.toward_sun))
    }
}
