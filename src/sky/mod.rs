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
//! from the model's to the twilight's. Between -12 and -18 degrees
//! the night comes in, and is left alone below: stars and airglow, 6.4e-4 lx.

pub mod cie;
pub mod circles;
pub mod day;
pub mod gradation;
pub mod hemisphere;
pub mod hosek;
pub mod map;
pub mod named;
pub mod patches;
pub mod perez;
pub mod preetham;
pub mod sun;
mod table;
pub mod twilight;

pub use sun::{SunLight, SunPath};
pub(crate) use table::constants;

use crate::colour::{luminance, working_from_xyz, xyz_from_xyy};
use crate::error::{Error, Result};
use crate::units::DEG;
use day::{Day, Position};
use glam::DVec3;
use perez::Bins;
use std::f64::consts::{FRAC_PI_2, PI};
use twilight::{Twilight, smoothstep};

/// The turbidity that is taken when nothing is said: a clear day.
pub const DEFAULT_TURBIDITY: f64 = 3.0;

/// A sky model and its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Model {
    /// Perez, Seals & Michalsky 1993, all-weather.
    Perez {
        /// Turbidity [1] of the clear sky that is taken when no irradiance is given, and of the sky's colour; 1 to 10.
        turbidity: f64,
        /// What a weather station measures; absent: a clear sky.
        irradiance: Option<Irradiance>,
    },
    /// Preetham, Shirley & Smits 1999.
    Preetham {
        /// Turbidity [1], 2 to 10.
        turbidity: f64,
    },
    /// Hosek & Wilkie 2012.
    Hosek {
        /// Turbidity [1], 1 to 10.
        turbidity: f64,
        /// Albedo of the ground far around, 0 to 1.
        albedo: f64,
    },
    /// CIE S 011 general sky.
    Cie {
        /// 1 to 15, or 16 for the traditional overcast sky.
        kind: u8,
        /// Turbidity [1] of the sky's colour where there are no clouds; 1 to 10.
        turbidity: f64,
        /// What sets its level; absent: what is typical of the type.
        irradiance: Option<Irradiance>,
    },
    /// The same white luminance everywhere, whatever the sun: for tests and comparisons.
    Uniform {
        /// Luminance [cd/m2], finite and not negative.
        luminance: f64,
    },
}

/// Broadband solar irradiance, as weather files carry it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Irradiance {
    /// Direct normal [W/m2], not negative.
    pub direct_normal: f64,
    /// Diffuse horizontal [W/m2], not negative.
    pub diffuse_horizontal: f64,
}

/// Where the sun stands for a sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunAt {
    /// Unit vector toward the apparent sun in scene axes (+Y up).
    pub toward_sun: DVec3,
    /// True (geometric) elevation [rad]: what models and the twilight curve go by.
    pub elevation_true: f64,
    /// Distance [au].
    pub distance_au: f64,
    /// The site's height above sea level [m].
    pub site_elevation: f64,
}

impl SunAt {
    /// A sun without refraction, one astronomical unit away, over sea level. `toward_sun` is a unit vector.
    pub fn unrefracted(toward_sun: DVec3) -> Self {
        SunAt {
            toward_sun,
            elevation_true: elevation_of(toward_sun),
            distance_au: 1.0,
            site_elevation: 0.0,
        }
    }
}

/// A sky for one place of the sun.
#[derive(Debug, Clone)]
pub struct Sky {
    model: Model,
    toward_sun: DVec3,
    /// Unit vector toward the sun's azimuth in the horizontal plane.
    toward_azimuth: DVec3,
    elevation_true: f64,
    day: Option<(Day, f64)>,
    twilight: Option<(Twilight, f64)>,
    /// What does not depend on direction: the night.
    uniform: DVec3,
    /// Times 1 + 2 cos(zenith angle): clouds in twilight.
    cloud: DVec3,
    illuminance: DVec3,
    warnings: Vec<String>,
}

/// Chromaticity x, y of the night sky without moon: taken as D65, between blue stars and reddish airglow.
const NIGHT_XY: [f64; 2] = [0.3127, 0.3290];

/// Horizontal illuminance under heavy clouds over that under a clear sky [1], where nothing else says it.
const OVERCAST_SHARE: f64 = 0.2;

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
        let flat = DVec3::new(sun.toward_sun.x, 0.0, sun.toward_sun.z);
        let mut sky = Sky {
            model,
            toward_sun: sun.toward_sun,
            toward_azimuth: flat.try_normalize().unwrap_or(DVec3::X),
            elevation_true: sun.elevation_true,
            day: None,
            twilight: None,
            uniform: DVec3::ZERO,
            cloud: DVec3::ZERO,
            illuminance: DVec3::ZERO,
            warnings: Vec::new(),
        };
        if let Model::Uniform { luminance } = model {
            sky.prepare_uniform(luminance)?;
        } else {
            sky.prepare(sun)?;
        }
        Ok(sky)
    }

    fn prepare_uniform(&mut self, luminance: f64) -> Result<()> {
        if !(luminance.is_finite() && luminance >= 0.0) {
            return Err(Error::domain(
                "the luminance of the uniform sky",
                format!("{luminance} cd/m2"),
                "finite and not negative",
                "give cd/m2",
            ));
        }
        self.uniform = DVec3::splat(luminance);
        self.illuminance = self.uniform * PI;
        Ok(())
    }

    /// Weighs day, twilight and night.
    fn prepare(&mut self, sun: SunAt) -> Result<()> {
        let e = self.elevation_true;
        let seen_zenith_angle = FRAC_PI_2 - elevation_of(self.toward_sun);
        let frame = self.sun_in_frame();
        let day_at = |elevation: f64, seen_zenith_angle: f64| {
            let position = Position {
                zenith_angle: (FRAC_PI_2 - elevation).max(0.0),
                seen_zenith_angle,
                distance_au: sun.distance_au,
                site_elevation: sun.site_elevation,
            };
            Day::new(self.model, position, Bins::Blended)
        };
        let day = if e > twilight::SHAPE {
            Some(day_at(e, seen_zenith_angle)?)
        } else {
            None
        };
        let own = day
            .as_ref()
            .map(|day| hemisphere::horizontal_integral(seen_zenith_angle, |w| day.seen(w, frame)));
        if let Some(day) = &day {
            self.warnings.clone_from(&day.warnings);
        }
        if e >= twilight::BEGIN {
            self.illuminance = own.unwrap_or_default();
            self.day = day.map(|day| (day, 1.0));
            return Ok(());
        }
        let (grey, hidden, darkening) = self.clouds(day.as_ref());
        let curve = self.clear_sky_illuminance(hidden)? * (1.0 + hidden * (darkening - 1.0));
        let level = match own {
            Some(own) if e > twilight::LEVEL => {
                let share = smoothstep(twilight::LEVEL, twilight::BEGIN, e);
                (luminance(own).ln() * share + curve.ln() * (1.0 - share)).exp()
            }
            _ => curve,
        };
        let shares = twilight::shares(e);
        if let (Some(day), Some(own)) = (day, own) {
            let scale = level * shares.day / luminance(own);
            self.illuminance += own * scale;
            self.day = Some((day, scale));
        }
        if shares.twilight > 0.0 {
            let twilight = Twilight::new(e);
            let total = hemisphere::horizontal_integral(seen_zenith_angle, |w| {
                twilight.radiance(w, DVec3::X, w.dot(frame))
            });
            let scale = level * shares.twilight / luminance(total);
            self.illuminance += total * scale;
            // Clouds scatter the same light evenly: their colour is the mean of the clear twilight's.
            // The integral of (1 + 2 cos) cos over the dome is 7 pi / 3.
            self.cloud = total * (scale * grey * 3.0 / (7.0 * PI));
            self.twilight = Some((twilight, scale * (1.0 - grey)));
        }
        let [x, y] = NIGHT_XY;
        self.uniform = working_from_xyz(xyz_from_xyy(DVec3::new(x, y, level * shares.night / PI)));
        self.illuminance += self.uniform * PI;
        Ok(())
    }

    /// For twilight: how grey the sky is, how much of the sun clouds hide, and what heavy clouds leave of a clear sky's light.
    fn clouds(&self, day: Option<&Day>) -> (f64, f64, f64) {
        match (self.model, day) {
            (
                Model::Cie {
                    kind, irradiance, ..
                },
                _,
            ) => {
                let Ok(kind) = cie::Kind::new(kind) else {
                    return (0.0, 0.0, 1.0);
                };
                let hidden = if kind.hides_sun() { 1.0 } else { 0.0 };
                let share = match irradiance {
                    // As much darker than the clear day as the type is where its own level ends.
                    None => {
                        kind.typical_diffuse_share()
                            * cie::SOLAR_ILLUMINANCE
                            * twilight::BEGIN.sin()
                            / twilight::clear_illuminance(twilight::BEGIN)
                    }
                    Some(_) => OVERCAST_SHARE,
                };
                (kind.cloud_share(), hidden, share)
            }
            (_, Some(day)) => (day.grey, day.hidden, OVERCAST_SHARE),
            (
                Model::Perez {
                    turbidity,
                    irradiance: Some(irradiance),
                },
                None,
            ) => {
                let grey = day::cloudiness(irradiance, self.elevation_true, turbidity);
                (grey, grey, OVERCAST_SHARE)
            }
            _ => (0.0, 0.0, 1.0),
        }
    }

    /// Horizontal illuminance [lx] of the clear sky alone: the published curve less the sun's, as far as it is not hidden.
    fn clear_sky_illuminance(&self, hidden: f64) -> Result<f64> {
        let apparent = elevation_of(self.toward_sun);
        let sun = SunLight::new(&SunPath::standard(apparent, self.model.turbidity()))?;
        let total = twilight::clear_illuminance(self.elevation_true);
        // The sky never gives less than a third of the whole while the sun is this low.
        let sky = (total - luminance(sun.horizontal_illuminance())).max(total / 3.0);
        Ok(sky + (total - sky) * hidden)
    }

    fn sun_in_frame(&self) -> DVec3 {
        DVec3::new(
            self.toward_sun.dot(self.toward_azimuth),
            self.toward_sun.y,
            0.0,
        )
    }

    /// Radiance toward a unit direction: RGB in the working space, luminance in cd/m2; finite, no channel negative.
    ///
    /// Domain: directions with y >= 0. Gradations are held below 0.57 degrees, so that the horizon is finite and smooth;
    /// a direction below the horizon gets what the horizon has at its angle from the sun.
    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        let mut sum = self.uniform;
        if let Some((day, scale)) = &self.day {
            sum += day.seen(direction, self.toward_sun) * *scale;
        }
        if let Some((twilight, scale)) = &self.twilight {
            let cos_gamma = direction.dot(self.toward_sun);
            sum += twilight.radiance(direction, self.toward_azimuth, cos_gamma) * *scale;
            sum += self.cloud * (1.0 + 2.0 * direction.y.max(0.0));
        }
        sum
    }

    /// Illuminance [lx] of the whole dome on the horizontal plane, without the sun: RGB in the working space.
    pub fn horizontal_illuminance(&self) -> DVec3 {
        self.illuminance
    }

    /// Radiance of the zenith: RGB in the working space, luminance in cd/m2.
    pub fn zenith(&self) -> DVec3 {
        self.radiance(DVec3::Y)
    }

    /// The sunlight that belongs to this sky: what comes through the clear air of `path`, as far as the model lets it.
    ///
    /// A measured direct-normal irradiance sets its illuminance (by the efficacy of Perez et al. 1990); CIE types 1 to 6
    /// and 16 hide the sun. With a sun below 5 degrees the measured level gives way to the clear one less the clouds' share.
    /// Errors: [`Error::Domain`] when a quantity of `path` is outside its range.
    pub fn sunlight(&self, path: &SunPath) -> Result<SunLight> {
        let clear = SunLight::new(path)?;
        let day = self.day.as_ref().map(|(day, _)| day);
        let (_, hidden, _) = self.clouds(day);
        let full = luminance(clear.full_illuminance);
        let factor = match day.and_then(|day| day.direct_normal) {
            Some(measured) if full > 0.0 => {
                let share = smoothstep(twilight::SHAPE, twilight::LEVEL, self.elevation_true);
                measured / full * share + (1.0 - hidden) * (1.0 - share)
            }
            _ => 1.0 - hidden,
        };
        Ok(clear.dimmed(factor))
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
        match self.elevation_true {
            _ if matches!(self.model, Model::Uniform { .. }) => model,
            e if e >= twilight::BEGIN => model,
            e if e > twilight::SHAPE => format!("{model}, turning into twilight"),
            e if e > twilight::END => format!("twilight (the sun is down; {model} by day)"),
            _ => format!("night without moon ({model} by day)"),
        }
    }

    /// What a user should know about this sky, one sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

/// XYZ [cd/m2] of a model as published, toward a direction: no blending of clearness bins, no twilight, no gamut.
///
/// `sun_elevation` (above 0, to 90 degrees), `view_azimuth` from the sun's, `view_elevation` (0 to 90 degrees) in radians.
/// One astronomical unit, sea level, 2 cm of water, air mass by Kasten 1965, cos(zenith angle) at least 0.01.
///
/// Errors: [`Error::Domain`] outside the model's range or below the horizon.
pub fn published_xyz(
    model: Model,
    sun_elevation: f64,
    view_azimuth: f64,
    view_elevation: f64,
) -> Result<DVec3> {
    let degrees = |e: f64| format!("{} degrees", e / DEG);
    if !(sun_elevation > 0.0 && sun_elevation <= FRAC_PI_2 + 1e-12) {
        return Err(Error::domain(
            "the sun's elevation",
            degrees(sun_elevation),
            "above 0, to 90 degrees",
            "the models as published have no sky without a sun; pictures and maps go on into the night",
        ));
    }
    if !(-1e-12..=FRAC_PI_2 + 1e-12).contains(&view_elevation) || !view_azimuth.is_finite() {
        return Err(Error::domain(
            "the view's elevation",
            degrees(view_elevation),
            "0 to 90 degrees",
            "a sky has no direction below the horizon",
        ));
    }
    if let Model::Uniform { luminance } = model {
        Sky::new(model, SunAt::unrefracted(DVec3::Y))?;
        return Ok(crate::colour::xyz_from_working(DVec3::splat(luminance)));
    }
    let zenith_angle = (FRAC_PI_2 - sun_elevation).max(0.0);
    let position = Position {
        zenith_angle,
        seen_zenith_angle: zenith_angle,
        distance_au: 1.0,
        site_elevation: 0.0,
    };
    let day = Day::new(model, position, Bins::Published)?;
    let (sin, cos) = view_elevation.sin_cos();
    let (sin_azimuth, cos_azimuth) = view_azimuth.sin_cos();
    let view = DVec3::new(cos * cos_azimuth, sin.max(0.0), cos * sin_azimuth);
    let (sin, cos) = sun_elevation.sin_cos();
    Ok(day.xyz(view, DVec3::new(cos, sin, 0.0)))
}

impl Model {
    /// The turbidity that goes with the model's clear sky [1].
    pub fn turbidity(&self) -> f64 {
        match self {
            Model::Perez { turbidity, .. }
            | Model::Preetham { turbidity }
            | Model::Hosek { turbidity, .. }
            | Model::Cie { turbidity, .. } => *turbidity,
            Model::Uniform { .. } => DEFAULT_TURBIDITY,
        }
    }

    /// The name on the command line.
    pub fn name(&self) -> String {
        match self {
            Model::Perez { .. } => "perez".into(),
            Model::Preetham { .. } => "preetham".into(),
            Model::Hosek { .. } => "hosek".into(),
            Model::Cie { kind, .. } => format!("cie:{kind}"),
            Model::Uniform { .. } => "uniform".into(),
        }
    }
}

/// Angle [rad] between unit vectors and its cosine, exact near 0 and pi, where acos is not.
fn angle_between(a: DVec3, b: DVec3) -> (f64, f64) {
    let cos = a.dot(b);
    (a.cross(b).length().atan2(cos), cos)
}

/// Elevation [rad] of a unit vector.
fn elevation_of(w: DVec3) -> f64 {
    w.y.atan2(w.x.hypot(w.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_elevation_is_exact_at_the_zenith() {
        assert_eq!(elevation_of(DVec3::Y), FRAC_PI_2);
        let near = DVec3::new(1e-9, 1.0, 0.0);
        assert!((FRAC_PI_2 - elevation_of(near) - 1e-9).abs() < 1e-15);
        assert!(elevation_of(DVec3::new(0.8, -0.6, 0.0)) < -0.6 * DEG);
    }
}
