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
//! published curve of sun and clear sky less the sun's own share; between 10 and 0 degrees its distribution and colour go
//! from the model's to the twilight's. Between -12 and -18 degrees
//! the night comes in, and is left alone below: stars and airglow, 6.4e-4 lx.

pub mod gradation;
pub mod hemisphere;
pub mod preetham;
pub mod sun;
pub mod twilight;

pub use sun::{SunLight, SunPath};

use crate::colour::{into_gamut, luminance, working_from_xyz, xyz_from_xyy};
use crate::error::{Error, Result};
use glam::DVec3;
use preetham::Preetham;
use std::f64::consts::{FRAC_PI_2, PI};
use twilight::{Twilight, smoothstep};

/// A sky model and its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Model {
    /// Perez, Seals & Michalsky 1993, all-weather.
    Perez {
        /// Turbidity [1] of the clear sky that is taken when no irradiance is given, and of the sky's colour; 2 to 10.
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
    /// The night's uniform part.
    night: DVec3,
    illuminance: DVec3,
    warnings: Vec<String>,
}

/// A daylight model, ready to be evaluated.
#[derive(Debug, Clone)]
enum Day {
    Preetham(Preetham),
    Uniform(DVec3),
}

/// Chromaticity x, y of the night sky without moon: stars and airglow are a little warmer than D65.
const NIGHT_XY: [f64; 2] = [0.325, 0.340];

impl Sky {
    /// Prepares a model for one place of the sun.
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
        let flat = DVec3::new(sun.toward_sun.x, 0.0, sun.toward_sun.z);
        let mut sky = Sky {
            model,
            toward_sun: sun.toward_sun,
            toward_azimuth: flat.try_normalize().unwrap_or(DVec3::X),
            elevation_true: sun.elevation_true,
            day: None,
            twilight: None,
            night: DVec3::ZERO,
            illuminance: DVec3::ZERO,
            warnings: Vec::new(),
        };
        match model {
            Model::Uniform { luminance } => sky.prepare_uniform(luminance)?,
            Model::Preetham { turbidity } => {
                preetham::check_turbidity(turbidity)?;
                sky.warnings.push(
                    "the Preetham sky's luminance is 1.5 to 2.8 times too high while the sun is above 10 degrees; its colours are usable".into(),
                );
                let zenith_angle = (FRAC_PI_2 - sun.elevation_true).max(0.0);
                sky.prepare(turbidity, || {
                    Ok(Day::Preetham(Preetham::new(turbidity, zenith_angle)?))
                })?;
            }
            Model::Perez { .. } | Model::Hosek { .. } | Model::Cie { .. } => {
                return Err(Error::failed(
                    "this sky is not there yet",
                    "take `--sky preetham`",
                ));
            }
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
        let rgb = DVec3::splat(luminance);
        self.day = Some((Day::Uniform(rgb), 1.0));
        self.illuminance = rgb * PI;
        Ok(())
    }

    /// Weighs day, twilight and night for a model that follows the sun; `day` is asked for only while the sun is up.
    fn prepare(&mut self, turbidity: f64, day: impl FnOnce() -> Result<Day>) -> Result<()> {
        let e = self.elevation_true;
        let zenith_angle = FRAC_PI_2 - elevation_of(self.toward_sun);
        let day = if e > twilight::SHAPE {
            Some(day()?)
        } else {
            None
        };
        let day_illuminance = day.as_ref().map(|day| {
            hemisphere::horizontal_integral(zenith_angle, |w| day.seen(w, self.sun_in_frame()))
        });
        if e >= twilight::BEGIN {
            self.illuminance = day_illuminance.unwrap_or_default();
            self.day = day.map(|day| (day, 1.0));
            return Ok(());
        }
        let twilight = Twilight::new(e)?;
        let twilight_illuminance = hemisphere::horizontal_integral(zenith_angle, |w| {
            let (gamma, cos_gamma) = angle_between(w, self.sun_in_frame());
            twilight.radiance(w.y, gamma, cos_gamma)
        });
        let curve = self.clear_sky_illuminance(turbidity)?;
        let level = match day_illuminance {
            Some(own) if e > twilight::LEVEL => {
                let share = smoothstep(twilight::LEVEL, twilight::BEGIN, e);
                (luminance(own).ln() * share + curve.ln() * (1.0 - share)).exp()
            }
            _ => curve,
        };
        let share = smoothstep(twilight::SHAPE, twilight::BEGIN, e);
        let night = level * (1.0 - smoothstep(twilight::END, twilight::NIGHTFALL, e));
        let lit = level - night;
        if let (Some(day), Some(own)) = (day, day_illuminance) {
            let scale = lit * share / luminance(own);
            self.illuminance += own * scale;
            self.day = Some((day, scale));
        }
        let scale = lit * (1.0 - share) / luminance(twilight_illuminance);
        self.illuminance += twilight_illuminance * scale;
        self.twilight = Some((twilight, scale));
        let [x, y] = NIGHT_XY;
        self.night = working_from_xyz(xyz_from_xyy(DVec3::new(x, y, night / PI)));
        self.illuminance += self.night * PI;
        Ok(())
    }

    /// Horizontal illuminance [lx] of the clear sky alone: the published curve less the sun's share at this turbidity.
    fn clear_sky_illuminance(&self, turbidity: f64) -> Result<f64> {
        let apparent = elevation_of(self.toward_sun);
        let sun = SunLight::new(&SunPath::standard(apparent, turbidity))?;
        let total = twilight::clear_illuminance(self.elevation_true);
        // The sky never gives less than a third of the whole while the sun is this low.
        Ok((total - luminance(sun.horizontal_illuminance())).max(total / 3.0))
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
        let mut sum = self.night;
        if let Some((day, scale)) = &self.day {
            sum += day.seen(direction, self.toward_sun) * *scale;
        }
        if let Some((twilight, scale)) = &self.twilight {
            let (gamma, cos_gamma) = angle_between(direction, self.toward_sun);
            sum += twilight.radiance(direction.y, gamma, cos_gamma) * *scale;
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

    /// The sunlight that belongs to this sky: what comes through the clear air of `path`.
    ///
    /// Errors: [`Error::Domain`] when a quantity of `path` is outside its range.
    pub fn sunlight(&self, path: &SunPath) -> Result<SunLight> {
        SunLight::new(path)
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
            Model::Cie { kind } => format!("CIE S 011 sky, type {kind}"),
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

impl Model {
    /// The name on the command line.
    pub fn name(&self) -> String {
        match self {
            Model::Perez { .. } => "perez".into(),
            Model::Preetham { .. } => "preetham".into(),
            Model::Hosek { .. } => "hosek".into(),
            Model::Cie { kind } => format!("cie:{kind}"),
            Model::Uniform { .. } => "uniform".into(),
        }
    }
}

impl Day {
    /// Radiance, RGB in the working space, toward `w` with the sun toward `s`; both unit vectors, +Y up.
    fn seen(&self, w: DVec3, s: DVec3) -> DVec3 {
        match self {
            Day::Preetham(form) => {
                let (gamma, cos_gamma) = angle_between(w, s);
                into_gamut(working_from_xyz(xyz_from_xyy(
                    form.xyy(w.y, gamma, cos_gamma),
                )))
            }
            Day::Uniform(rgb) => *rgb,
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
    use crate::units::DEG;

    #[test]
    fn an_elevation_is_exact_at_the_zenith() {
        assert_eq!(elevation_of(DVec3::Y), FRAC_PI_2);
        let near = DVec3::new(1e-9, 1.0, 0.0);
        assert!((FRAC_PI_2 - elevation_of(near) - 1e-9).abs() < 1e-15);
        assert!(elevation_of(DVec3::new(0.8, -0.6, 0.0)) < -0.6 * DEG);
    }
}
