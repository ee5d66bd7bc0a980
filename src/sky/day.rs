//! A daylight model prepared for one place of the sun: what is evaluated per direction.

use super::cie::{self, Kind};
use super::gradation::Gradation;
use super::hosek::Hosek;
use super::perez::{self, Bins, State};
use super::preetham::{self, Preetham};
use super::twilight::smoothstep;
use super::{Irradiance, Model, angle_between, hemisphere};
use crate::colour::{Space, XYZ_FROM_WORKING, into_gamut, working_from_xyz, xyz_from_xyy};
use crate::error::Result;
use crate::units::DEG;
use glam::{DMat3, DVec3};
use std::cell::Cell;
use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

static XYZ_FROM_REC709: LazyLock<DMat3> =
    LazyLock::new(|| XYZ_FROM_WORKING * Space::Rec709.to_working());

/// Chromaticity x, y of an overcast sky: 6 191 K on the daylight locus (Diakite-Kindel & Knoop, as in Radiance's gendaylit).
pub const OVERCAST_XY: [f64; 2] = [0.318_1, 0.334_2];

/// The share of the clear sky's beam from which on a sky has its full colour.
const CLEAR_BEAM: f64 = 0.7;

/// A model, ready to be evaluated.
#[derive(Debug, Clone)]
pub struct Day {
    form: Form,
    /// How much of the light comes from clouds [1].
    pub grey: f64,
    /// How much of the sun clouds hide [1].
    pub hidden: f64,
    /// Direct-normal illuminance that the model states [lx].
    pub direct_normal: Option<f64>,
    /// What a user should know, one sentence each.
    pub warnings: Vec<String>,
}

#[derive(Debug, Clone)]
enum Form {
    Preetham(Preetham),
    Uniform(DVec3),
    Hosek(Hosek),
    /// Luminance [cd/m2] as a sum of two gradations, and whence the colour.
    Luminance {
        parts: [(Gradation, f64); 2],
        clear: Preetham,
        grey: f64,
    },
}

/// Where a daylight model has its sun.
#[derive(Debug, Clone, Copy)]
pub struct Position {
    /// True zenith angle [rad], 0 to below pi/2.
    pub zenith_angle: f64,
    /// The zenith angle [rad] around which directions are seen: the apparent one.
    pub seen_zenith_angle: f64,
    /// Distance [au].
    pub distance_au: f64,
    /// The site's height above sea level [m].
    pub site_elevation: f64,
}

impl Position {
    fn elevation(&self) -> f64 {
        FRAC_PI_2 - self.zenith_angle
    }
}

impl Day {
    /// Prepares a model for a sun that is up.
    pub fn new(model: Model, sun: Position, bins: Bins) -> Result<Self> {
        match model {
            Model::Preetham { turbidity } => Ok(Day {
                warnings: vec![
                    "the Preetham sky's luminance is 1.5 to 2.8 times too high by day; its colours are usable".into(),
                ],
                ..Day::plain(Form::Preetham(Preetham::new(turbidity, sun.zenith_angle)?))
            }),
            Model::Hosek { turbidity, albedo } => {
                Ok(Day::plain(Form::Hosek(Hosek::new(turbidity, albedo, sun.elevation())?)))
            }
            Model::Uniform { luminance } => {
                let [x, y] = Space::WORKING.chromaticities().white;
                Ok(Day::plain(Form::Uniform(xyz_from_xyy(DVec3::new(x, y, luminance)))))
            }
            Model::Perez { turbidity, irradiance } => Day::perez(turbidity, irradiance, sun, bins),
            Model::Cie { kind, turbidity, irradiance } => {
                Day::cie(Kind::new(kind)?, turbidity, irradiance, sun)
            }
        }
    }

    fn plain(form: Form) -> Self {
        Day {
            form,
            grey: 0.0,
            hidden: 0.0,
            direct_normal: None,
            warnings: Vec::new(),
        }
    }

    fn perez(
        turbidity: f64,
        measured: Option<Irradiance>,
        sun: Position,
        bins: Bins,
    ) -> Result<Self> {
        let clear = Preetham::new(turbidity, sun.zenith_angle)?;
        let cloudless = perez::clear_sky(
            sun.elevation(),
            turbidity,
            sun.site_elevation,
            sun.distance_au,
        );
        let irradiance = measured.unwrap_or(cloudless);
        let state = State::new(irradiance, sun.zenith_angle, sun.distance_au, bins)?;
        let (gradations, lifted) = state.gradations();
        let diffuse = irradiance.diffuse_horizontal * state.diffuse_efficacy(perez::WATER_CM);
        let (parts, negative) = scaled(gradations, diffuse, sun);
        let grey = measured.map_or(0.0, |m| cloudiness(m, sun.elevation(), turbidity));
        let mut warnings = Vec::new();
        if state.limited && measured.is_some() {
            warnings.push(format!(
                "these irradiances are outside the Perez model's data: held at clearness {:.3}, brightness {:.3}",
                state.clearness, state.brightness
            ));
        }
        if lifted || negative {
            warnings.push(
                "the Perez fit breaks at this clearness and brightness (b > 0 or negative luminance): b is held at 0, luminance at 0 and above".into(),
            );
        }
        Ok(Day {
            form: Form::Luminance { parts, clear, grey },
            grey,
            hidden: grey,
            direct_normal: measured
                .map(|m| m.direct_normal * state.direct_efficacy(perez::WATER_CM)),
            warnings,
        })
    }

    fn cie(
        kind: Kind,
        turbidity: f64,
        measured: Option<Irradiance>,
        sun: Position,
    ) -> Result<Self> {
        let clear = Preetham::new(turbidity, sun.zenith_angle)?;
        let state = match measured {
            Some(m) => Some((
                m,
                State::new(m, sun.zenith_angle, sun.distance_au, Bins::Blended)?,
            )),
            None => None,
        };
        let diffuse = match &state {
            Some((m, state)) => m.diffuse_horizontal * state.diffuse_efficacy(perez::WATER_CM),
            None => kind.typical_diffuse(turbidity, sun)?,
        };
        let (parts, _) = scaled(
            [(kind.gradation(), 1.0), (kind.gradation(), 0.0)],
            diffuse,
            sun,
        );
        let grey = kind.cloud_share();
        Ok(Day {
            form: Form::Luminance { parts, clear, grey },
            grey,
            hidden: if kind.hides_sun() { 1.0 } else { 0.0 },
            direct_normal: state.map(|(m, s)| m.direct_normal * s.direct_efficacy(perez::WATER_CM)),
            warnings: Vec::new(),
        })
    }

    /// XYZ [cd/m2] toward `w` with the sun toward `s`, unit vectors, +Y up: the model as it is, its colours not fitted to a gamut.
    pub fn xyz(&self, w: DVec3, s: DVec3) -> DVec3 {
        let cos_theta = w.y;
        match &self.form {
            Form::Uniform(xyz) => *xyz,
            Form::Preetham(form) => {
                let (gamma, cos_gamma) = angle_between(w, s);
                xyz_from_xyy(form.xyy(cos_theta, gamma, cos_gamma))
            }
            Form::Hosek(form) => {
                let (gamma, cos_gamma) = angle_between(w, s);
                *XYZ_FROM_REC709 * form.rec709(cos_theta, gamma, cos_gamma)
            }
            Form::Luminance { parts, clear, grey } => {
                let (gamma, cos_gamma) = angle_between(w, s);
                let mut luminance = 0.0;
                for (gradation, scale) in parts {
                    if *scale > 0.0 {
                        luminance += scale * gradation.value(cos_theta, gamma, cos_gamma).max(0.0);
                    }
                }
                let overcast = DVec3::new(OVERCAST_XY[0], OVERCAST_XY[1], luminance);
                if *grey == 1.0 {
                    return xyz_from_xyy(overcast);
                }
                let [x, y] = clear.chromaticity(cos_theta, gamma, cos_gamma);
                xyz_from_xyy(DVec3::new(x, y, luminance)).lerp(xyz_from_xyy(overcast), *grey)
            }
        }
    }

    /// Radiance, RGB in the working space, no channel negative, toward `w` with the sun toward `s`.
    pub fn seen(&self, w: DVec3, s: DVec3) -> DVec3 {
        into_gamut(working_from_xyz(self.xyz(w, s)))
    }
}

/// How much clouds take part in a sky of measured irradiance [1]: 0 from 70 % of the clear sky's beam up, 1 without beam.
///
/// Below 5 degrees of elevation [rad] the clear beam of 5 degrees is the measure: lower ones are too weak to tell by.
pub fn cloudiness(measured: Irradiance, elevation: f64, turbidity: f64) -> f64 {
    let clear = perez::clear_sky(elevation.max(5.0 * DEG), turbidity, 0.0, 1.0);
    1.0 - smoothstep(
        0.0,
        CLEAR_BEAM,
        measured.direct_normal / clear.direct_normal,
    )
}

impl Kind {
    /// Diffuse horizontal illuminance [lx] typical of the type.
    ///
    /// Differs: the cloudless types 11 to 15 give no less than the clear sky of their turbidity: with a low sun type 12's
    /// typical share, 0.10, is less than half of that.
    fn typical_diffuse(self, turbidity: f64, sun: Position) -> Result<f64> {
        let typical = self.typical_diffuse_share() * cie::SOLAR_ILLUMINANCE
            / sun.distance_au.powi(2)
            * sun.zenith_angle.cos();
        if self.cloud_share() > 0.0 {
            return Ok(typical);
        }
        let clear = perez::clear_sky(
            sun.elevation(),
            turbidity,
            sun.site_elevation,
            sun.distance_au,
        );
        let state = State::new(clear, sun.zenith_angle, sun.distance_au, Bins::Blended)?;
        Ok(typical.max(clear.diffuse_horizontal * state.diffuse_efficacy(perez::WATER_CM)))
    }
}

/// The gradations scaled to luminance so that each alone would give the diffuse illuminance [lx] times its weight; and
/// whether any was negative somewhere.
fn scaled(
    parts: [(Gradation, f64); 2],
    diffuse: f64,
    sun: Position,
) -> ([(Gradation, f64); 2], bool) {
    let (sin, cos) = sun.seen_zenith_angle.sin_cos();
    let toward_sun = DVec3::new(sin, cos, 0.0);
    let negative = Cell::new(false);
    let sums = hemisphere::horizontal_integral(sun.seen_zenith_angle, |w| {
        let (gamma, cos_gamma) = angle_between(w, toward_sun);
        let value = |i: usize| {
            let (gradation, weight) = &parts[i];
            if *weight == 0.0 {
                return 1.0;
            }
            let v = gradation.value(w.y, gamma, cos_gamma);
            if v < 0.0 {
                negative.set(true);
            }
            v.max(0.0)
        };
        DVec3::new(value(0), value(1), 0.0)
    });
    let [(first, w0), (second, w1)] = parts;
    (
        [
            (first, w0 * diffuse / sums.x),
            (second, w1 * diffuse / sums.y),
        ],
        negative.get(),
    )
}

/// [`Error::Domain`](crate::Error::Domain) for a turbidity that a model cannot take, wherever the sun is.
pub fn check(model: Model) -> Result<()> {
    match model {
        Model::Preetham { turbidity } => preetham::check_turbidity(turbidity),
        Model::Perez { turbidity, .. } => preetham::check_turbidity(turbidity),
        Model::Cie {
            kind, turbidity, ..
        } => {
            Kind::new(kind)?;
            preetham::check_turbidity(turbidity)
        }
        Model::Hosek { turbidity, albedo } => Hosek::new(turbidity, albedo, 0.5).map(|_| ()),
        Model::Uniform { .. } => Ok(()),
    }
}
