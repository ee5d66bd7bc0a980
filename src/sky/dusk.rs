//! How a sky goes from its model by day into twilight and night.
//!
//! The models are made for the day. From 10 degrees of true solar elevation down, a sky turns into the twilight of
//! [`twilight`]: between 10 and 5 degrees its horizontal illuminance goes (in the logarithm) from the model's own to the
//! published curve of sun and clear sky less the sun's own share; between 10 and 2 degrees its distribution and colour go
//! from the model's to the twilight's. Between -12 and -18 degrees the night comes in, and below that it is alone: stars and
//! airglow, 6.4e-4 lx.
//!
//! Measured irradiance is worth more than a curve: at every height of the sun the sky's illuminance is the measured diffuse
//! irradiance times the diffuse luminous efficacy, which below the horizon is the horizon's. Twilight and night then say how
//! that light is spread, and its colour. The sun's own light is the measured direct irradiance times the direct luminous
//! efficacy down to 5 degrees, and times that of sunlight through clear air from 2 degrees down, where the fit of the former
//! falls to 0; the part of the disc that has set gives nothing. Clear air of the sky's turbidity may let less through than was
//! measured: then it is taken as clear as it must have been.

use super::angles::elevation_of;
use super::day::{self, Day, Position};
use super::model::{Irradiance, Model};
use super::perez::{self, Bins, State};
use super::sun::{SunAt, SunLight, SunPath, visible_part};
use super::twilight::{self, Twilight, smoothstep};
use super::{cie, hemisphere};
use crate::colour::{luminance, working_from_xyz, xyz_from_xyy};
use crate::error::{Error, Result};
use crate::units::{DEG, SUN_DIAMETER};
use crate::warning::Warning;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Chromaticity x, y of the night sky without moon: taken as D65, between blue stars and reddish airglow.
const NIGHT_XY: [f64; 2] = [0.3127, 0.3290];

/// Horizontal illuminance under heavy clouds over that under a clear sky [1], where nothing else says it.
const OVERCAST_SHARE: f64 = 0.2;

/// What a sky consists of at one place of the sun: radiances add.
#[derive(Debug, Clone, Default)]
pub(super) struct Blend {
    /// The model by day and the factor of its radiance [1], above [`twilight::SHAPE`].
    pub day: Option<(Day, f64)>,
    /// The clear twilight and the factor of its radiance, from [`twilight::BEGIN`] down to [`twilight::END`].
    pub twilight: Option<(Twilight, f64)>,
    /// Radiance that does not depend on direction [cd/m2, RGB]: the night, or a uniform sky.
    pub uniform: DVec3,
    /// Radiance of clouds in twilight [cd/m2, RGB], over 1 + 2 cos(zenith angle).
    pub cloud: DVec3,
    /// Horizontal illuminance of all of it [lx, RGB].
    pub illuminance: DVec3,
    /// What a user should know.
    pub warnings: Vec<Warning>,
}

impl Blend {
    /// White of the same luminance [cd/m2] everywhere, whatever the sun.
    ///
    /// # Errors
    /// [`Error::Domain`] for a luminance that is negative or not finite.
    pub fn uniform(luminance: f64) -> Result<Self> {
        if !(luminance.is_finite() && luminance >= 0.0) {
            return Err(Error::domain(
                "the luminance of the uniform sky",
                format!("{luminance} cd/m2"),
                "finite and not negative",
                "give cd/m2",
            ));
        }
        let uniform = DVec3::splat(luminance);
        Ok(Blend {
            uniform,
            illuminance: uniform * PI,
            ..Blend::default()
        })
    }

    /// Weighs day, twilight and night for a model other than the uniform one.
    ///
    /// # Errors
    /// [`Error::Domain`] when a parameter is outside the range in which the model holds.
    pub fn new(model: Model, sun: SunAt) -> Result<Self> {
        let e = sun.elevation_true;
        let seen_zenith_angle = FRAC_PI_2 - elevation_of(sun.toward_sun);
        let frame = DVec3::new(
            sun.toward_sun.dot(sun.toward_azimuth()),
            sun.toward_sun.y,
            0.0,
        );
        let mut blend = Blend::default();
        let day_at = |elevation: f64, seen_zenith_angle: f64| {
            let position = Position {
                zenith_angle: (FRAC_PI_2 - elevation).max(0.0),
                seen_zenith_angle,
                distance_au: sun.distance_au,
                site_elevation: sun.site_elevation,
            };
            Day::new(model, position, Bins::Blended)
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
            blend.warnings.clone_from(&day.warnings);
        }
        let measured = measured_illuminance(model, sun)?;
        blend.warnings.extend(low_sun(model, sun, measured));
        if e >= twilight::BEGIN {
            blend.illuminance = own.unwrap_or_default();
            blend.day = day.map(|day| (day, 1.0));
            return Ok(blend);
        }
        let (grey, hidden, darkening) = clouds(model, e, day.as_ref());
        let curve = || -> Result<f64> {
            let clear = clear_sky_illuminance(model, sun, hidden)?;
            Ok(clear * (1.0 + hidden * (darkening - 1.0)))
        };
        let level = match (measured, own) {
            (Some(measured), _) => measured,
            (None, Some(own)) if e > twilight::LEVEL => {
                let share = smoothstep(twilight::LEVEL, twilight::BEGIN, e);
                (luminance(own).ln() * share + curve()?.ln() * (1.0 - share)).exp()
            }
            _ => curve()?,
        };
        let shares = twilight::shares(e);
        if let (Some(day), Some(own)) = (day, own) {
            let scale = level * shares.day / luminance(own);
            blend.illuminance += own * scale;
            blend.day = Some((day, scale));
        }
        if shares.twilight > 0.0 {
            let twilight = Twilight::new(e);
            let total = hemisphere::horizontal_integral(seen_zenith_angle, |w| {
                twilight.radiance(w, DVec3::X, w.dot(frame))
            });
            let scale = level * shares.twilight / luminance(total);
            blend.illuminance += total * scale;
            // Clouds scatter the same light evenly: their colour is the mean of the clear twilight's.
            // The integral of (1 + 2 cos) cos over the dome is 7 pi / 3.
            blend.cloud = total * (scale * grey * 3.0 / (7.0 * PI));
            blend.twilight = Some((twilight, scale * (1.0 - grey)));
        }
        let [x, y] = NIGHT_XY;
        blend.uniform = working_from_xyz(xyz_from_xyy(DVec3::new(x, y, level * shares.night / PI)));
        blend.illuminance += blend.uniform * PI;
        Ok(blend)
    }

    /// Share of the clear air's sunlight that this sky lets through [1], where that is `clear`.
    pub fn beam_share(&self, model: Model, elevation_true: f64, clear: &SunLight) -> f64 {
        let day = self.day.as_ref().map(|(day, _)| day);
        let full = luminance(clear.full_illuminance);
        let Some(measured) = model.irradiance() else {
            return 1.0 - clouds(model, elevation_true, day).1;
        };
        let whole = whole_irradiance(clear);
        if !(full > 0.0 && whole > 0.0) {
            return 0.0;
        }
        // As irradiance, below where the fitted efficacy is taken.
        let low = measured.direct_normal / whole;
        match day.and_then(|day| day.direct_normal) {
            Some(illuminance) => {
                let share = smoothstep(twilight::SHAPE, twilight::LEVEL, elevation_true);
                illuminance / full * share + low * (1.0 - share)
            }
            None => low,
        }
    }
}

/// The turbidity [1] of the air through which a measured beam comes: the path's from 5 degrees up; from 2 degrees down a lower
/// one, to 1, if the beam would be weaker than measured.
///
/// # Errors
/// [`Error::Domain`] when a quantity of `path` is outside its range.
pub(super) fn beam_turbidity(
    measured: Irradiance,
    path: &SunPath,
    elevation_true: f64,
) -> Result<f64> {
    let share = smoothstep(twilight::SHAPE, twilight::LEVEL, elevation_true);
    // The beam falls steadily with turbidity: half of the range at a time is left out.
    let (mut low, mut high) = (1.0, path.turbidity);
    let lets_through = |turbidity: f64| -> Result<bool> {
        let light = SunLight::new(&SunPath { turbidity, ..*path })?;
        Ok(whole_irradiance(&light) >= measured.direct_normal)
    };
    if share == 1.0 || lets_through(high)? {
        return Ok(high);
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        match lets_through(middle)? {
            true => low = middle,
            false => high = middle,
        }
    }
    Ok(low + (path.turbidity - low) * share)
}

/// Irradiance [W/m2] on a plane facing the sun if the whole disc were up; nothing for one that is wholly down.
fn whole_irradiance(light: &SunLight) -> f64 {
    match light.visible_share > 0.0 {
        true => light.irradiance.unwrap_or_default() / light.visible_share,
        false => 0.0,
    }
}

/// Horizontal illuminance [lx] that a measured diffuse irradiance gives to the sky, by the efficacy of Perez et al. 1990.
///
/// With the sun below the horizon the efficacy is the horizon's. `None` without a measurement, and for one of 0 with the sun no
/// higher than [`twilight::SHAPE`]: less than an instrument tells apart.
///
/// # Errors
/// [`Error::Domain`] for an irradiance outside its range, and for none under a higher sun.
fn measured_illuminance(model: Model, sun: SunAt) -> Result<Option<f64>> {
    let Some(measured) = model.irradiance() else {
        return Ok(None);
    };
    let dark = measured.diffuse_horizontal == 0.0 && sun.elevation_true <= twilight::SHAPE;
    let checked = Irradiance {
        diffuse_horizontal: if dark {
            1.0
        } else {
            measured.diffuse_horizontal
        },
        ..measured
    };
    let zenith_angle = (FRAC_PI_2 - sun.elevation_true).clamp(0.0, FRAC_PI_2.next_down());
    let state = State::new(checked, zenith_angle, sun.distance_au, Bins::Blended)?;
    let illuminance = measured.diffuse_horizontal * state.diffuse_efficacy(perez::WATER_CM);
    Ok((!dark).then_some(illuminance))
}

/// What a user should know of irradiance that is measured while the sun is low or down, where it gives `illuminance` [lx].
fn low_sun(model: Model, sun: SunAt, illuminance: Option<f64>) -> Option<Warning> {
    let measured = model.irradiance()?;
    if sun.elevation_true >= twilight::BEGIN {
        return None;
    }
    let elevation_deg = sun.elevation_true / DEG;
    let Some(illuminance) = illuminance else {
        return Some(Warning::NoDiffuseIrradiance { elevation_deg });
    };
    if sun.is_up() {
        return Some(Warning::IrradianceOfLowSun { elevation_deg });
    }
    Some(Warning::IrradianceWithoutSun {
        elevation_deg,
        direct_normal: measured.direct_normal,
        illuminance,
        clear: twilight::clear_illuminance(sun.elevation_true),
    })
}

impl SunAt {
    /// Whether any part of the disc is above the apparent horizon.
    pub(super) fn is_up(&self) -> bool {
        let radius = (0.5 * SUN_DIAMETER / self.distance_au).asin();
        visible_part(elevation_of(self.toward_sun), radius).0 > 0.0
    }
}

/// For twilight: how grey the sky is, how much of the sun clouds hide, and what heavy clouds leave of a clear sky's light.
fn clouds(model: Model, elevation_true: f64, day: Option<&Day>) -> (f64, f64, f64) {
    match (model, day) {
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
                    kind.typical_diffuse_share() * cie::SOLAR_ILLUMINANCE * twilight::BEGIN.sin()
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
            let grey = day::cloudiness(irradiance, elevation_true, turbidity);
            (grey, grey, OVERCAST_SHARE)
        }
        _ => (0.0, 0.0, 1.0),
    }
}

/// Horizontal illuminance [lx] of the clear sky alone: the published curve less the sun's, as far as it is not hidden.
fn clear_sky_illuminance(model: Model, sun: SunAt, hidden: f64) -> Result<f64> {
    let apparent = elevation_of(sun.toward_sun);
    let light = SunLight::new(&SunPath::standard(apparent, model.turbidity()))?;
    let total = twilight::clear_illuminance(sun.elevation_true);
    // The sky never gives less than a third of the whole while the sun is this low.
    let sky = (total - luminance(light.horizontal_illuminance())).max(total / 3.0);
    Ok(sky + (total - sky) * hidden)
}
