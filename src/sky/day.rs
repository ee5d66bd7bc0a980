//! A daylight model prepared for one place of the sun: what is evaluated per direction.
//!
//! Perez and CIE skies have luminance alone. Where they are clear they take the chromaticity that the sky of Hosek & Wilkie
//! 2012 has in that direction, with that sun and turbidity; where clouds make the light, [`OVERCAST_XY`]; mixed as light by
//! the clouds' share. Differs: Preetham's x, y, which the ReLiShaft paper uses, turn lavender around the sun and pink at
//! the horizon of a plain clear day (at 35 degrees and turbidity 3: x, y 0.279, 0.288 and 0.345, 0.340, where path-traced
//! skies have 0.291, 0.309 and 0.313, 0.340). They remain the colours of `preetham`.

use super::angles::angle_between;
use super::cie::{self, Kind};
use super::gradation::Gradation;
use super::hemisphere;
use super::hosek::Hosek;
use super::model::{Irradiance, Model};
use super::perez::{self, Bins, State};
use super::preetham::{self, Preetham};
use super::twilight::smoothstep;
use crate::colour::{
    Space, WORKING_FROM_XYZ, into_gamut, luminance, working_from_xyz, xyz_from_working,
    xyz_from_xyy,
};
use crate::error::Result;
use crate::units::DEG;
use crate::warning::Warning;
use glam::{DMat3, DVec3, Vec3Swizzles};
use std::cell::Cell;
use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

static WORKING_FROM_REC709: LazyLock<DMat3> = LazyLock::new(|| Space::Rec709.to_working());

/// Chromaticity x, y of an overcast sky: 6 191 K on the daylight locus (Diakite-Kindel & Knoop, as in Radiance's gendaylit).
pub const OVERCAST_XY: [f64; 2] = [0.318_1, 0.334_2];

static OVERCAST: LazyLock<DVec3> = LazyLock::new(|| {
    let [x, y] = OVERCAST_XY;
    working_from_xyz(xyz_from_xyy(DVec3::new(x, y, 1.0)))
});

/// The ground's albedo for the colour of the skies that have none of their own.
const COLOUR_ALBEDO: f64 = 0.2;

/// The share of the clear sky's beam from which on a sky has its full colour.
const CLEAR_BEAM: f64 = 0.7;

/// In what a table of a day's sky has its colours: chromaticity with luminance, linear RGB, or luminance apart from the colour.
pub(super) const FORM_XYY: f64 = 1.0;
const FORM_RGB: f64 = 2.0;
pub(super) const FORM_LUMINANCE: f64 = 3.0;

/// A prepared model.
#[derive(Debug, Clone)]
pub struct Day {
    form: Form,
    working_from_rec709: DMat3,
    /// RGB in the working space of one cd/m2 of [`OVERCAST_XY`].
    overcast: DVec3,
    /// How much of the light comes from clouds [1].
    pub grey: f64,
    /// How much of the sun clouds hide [1].
    pub hidden: f64,
    /// Direct-normal illuminance that the model states [lx].
    pub direct_normal: Option<f64>,
    /// What a user should know.
    pub warnings: Vec<Warning>,
}

#[derive(Debug, Clone)]
enum Form {
    Preetham(Preetham),
    /// RGB in the working space.
    Uniform(DVec3),
    Hosek(Hosek),
    /// Luminance [cd/m2] as a sum of two gradations, and where the colour comes from.
    Luminance {
        parts: [(Gradation, f64); 2],
        clear: Hosek,
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
                warnings: vec![Warning::PreethamLuminance],
                ..Day::plain(Form::Preetham(Preetham::new(turbidity, sun.zenith_angle)?))
            }),
            Model::Hosek { turbidity, albedo } => Ok(Day::plain(Form::Hosek(Hosek::new(
                turbidity,
                albedo,
                sun.elevation(),
            )?))),
            Model::Uniform { luminance } => Ok(Day::plain(Form::Uniform(DVec3::splat(luminance)))),
            Model::Perez {
                turbidity,
                irradiance,
            } => Day::perez(turbidity, irradiance, sun, bins),
            Model::Cie {
                kind,
                turbidity,
                irradiance,
            } => Day::cie(Kind::new(kind)?, turbidity, irradiance, sun),
        }
    }

    fn plain(form: Form) -> Self {
        Day {
            form,
            working_from_rec709: *WORKING_FROM_REC709,
            overcast: *OVERCAST,
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
        let clear = Hosek::new(turbidity, COLOUR_ALBEDO, sun.elevation())?;
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
            warnings.push(Warning::OutsidePerezData {
                clearness: state.clearness,
                brightness: state.brightness,
            });
        }
        if lifted || negative {
            warnings.push(Warning::PerezFitBreaks);
        }
        Ok(Day {
            grey,
            hidden: grey,
            direct_normal: measured
                .map(|m| m.direct_normal * state.direct_efficacy(perez::WATER_CM)),
            warnings,
            ..Day::plain(Form::Luminance { parts, clear, grey })
        })
    }

    fn cie(
        kind: Kind,
        turbidity: f64,
        measured: Option<Irradiance>,
        sun: Position,
    ) -> Result<Self> {
        let clear = Hosek::new(turbidity, COLOUR_ALBEDO, sun.elevation())?;
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
            grey,
            hidden: if kind.hides_sun() { 1.0 } else { 0.0 },
            direct_normal: state.map(|(m, s)| m.direct_normal * s.direct_efficacy(perez::WATER_CM)),
            ..Day::plain(Form::Luminance { parts, clear, grey })
        })
    }

    /// What depends on the height of a direction alone, by the cosine of its zenith angle.
    pub fn over_height(&self, cos_theta: f64) -> Height {
        match &self.form {
            Form::Uniform(rgb) => Height {
                luminance: [0.0; 2],
                factor: *rgb,
                addend: DVec3::ZERO,
            },
            Form::Preetham(form) => Height {
                luminance: [0.0; 2],
                factor: form.over_height(cos_theta),
                addend: DVec3::ZERO,
            },
            Form::Hosek(form) => Height::new([0.0; 2], form.over_height(cos_theta)),
            Form::Luminance { parts, clear, .. } => {
                Height::new(by_height(parts, cos_theta), clear.over_height(cos_theta))
            }
        }
    }

    /// What depends on the angle from the sun alone [rad].
    pub fn around_sun(&self, gamma: f64, cos_gamma: f64) -> Around {
        match &self.form {
            Form::Uniform(_) => Around::default(),
            Form::Preetham(form) => Around {
                luminance: [0.0; 2],
                colour: form.around_sun(gamma, cos_gamma),
            },
            Form::Hosek(form) => Around {
                luminance: [0.0; 2],
                colour: form.around_sun(gamma, cos_gamma),
            },
            Form::Luminance { parts, clear, .. } => Around {
                luminance: by_angle(parts, gamma, cos_gamma),
                colour: clear.around_sun(gamma, cos_gamma),
            },
        }
    }

    /// RGB in the working space, not yet fitted to its gamut, where both are known: every model is a product of the two, or
    /// nearly so.
    #[inline(always)]
    fn join(&self, height: &Height, around: &Around) -> DVec3 {
        let rec709 = || height.factor * (around.colour + height.addend);
        match &self.form {
            Form::Uniform(_) => height.factor,
            Form::Preetham(_) => {
                working_from_xyz(xyz_from_xyy((height.factor * around.colour).yzx()))
            }
            Form::Hosek(_) => self.working_from_rec709 * rec709(),
            Form::Luminance { grey, .. } => {
                let wanted = together(height.luminance, around.luminance);
                let overcast = self.overcast * wanted;
                if *grey == 1.0 {
                    return overcast;
                }
                let colour = self.working_from_rec709 * rec709();
                (colour * (wanted / luminance(colour))).lerp(overcast, *grey)
            }
        }
    }

    /// XYZ [cd/m2] toward `w` with the sun toward `s`, unit vectors, +Y up: the model as it is, its colours not fitted to a gamut.
    pub fn xyz(&self, w: DVec3, s: DVec3) -> DVec3 {
        let (gamma, cos_gamma) = angle_between(w, s);
        xyz_from_working(self.join(&self.over_height(w.y), &self.around_sun(gamma, cos_gamma)))
    }

    /// Radiance, RGB in the working space, no channel negative, toward `w` with the sun toward `s`.
    pub fn seen(&self, w: DVec3, s: DVec3) -> DVec3 {
        let (gamma, cos_gamma) = angle_between(w, s);
        self.seen_at(&self.over_height(w.y), &self.around_sun(gamma, cos_gamma))
    }

    /// The luminance of [`Day::seen`] [cd/m2].
    pub fn luminance(&self, w: DVec3, s: DVec3) -> f64 {
        let Form::Luminance { parts, .. } = &self.form else {
            return luminance(self.seen(w, s));
        };
        let (gamma, cos_gamma) = angle_between(w, s);
        together(by_height(parts, w.y), by_angle(parts, gamma, cos_gamma))
    }

    /// The same as [`Day::seen`] where height and angle from the sun are known.
    #[inline(always)]
    pub fn seen_at(&self, height: &Height, around: &Around) -> DVec3 {
        into_gamut(self.join(height, around))
    }
}

/// What of the luminance of each part goes by the height alone, by the cosine of the zenith angle.
#[inline(always)]
fn by_height(parts: &[(Gradation, f64); 2], cos_theta: f64) -> [f64; 2] {
    parts.map(|(gradation, scale)| match scale > 0.0 {
        true => scale * gradation.gradation(cos_theta),
        false => 0.0,
    })
}

/// What of it goes by the angle from the sun alone [rad].
#[inline(always)]
fn by_angle(parts: &[(Gradation, f64); 2], gamma: f64, cos_gamma: f64) -> [f64; 2] {
    parts.map(|(gradation, scale)| match scale > 0.0 {
        true => gradation.indicatrix(gamma, cos_gamma),
        false => 0.0,
    })
}

/// The luminance of all parts.
#[inline(always)]
fn together([first, second]: [f64; 2], [a, b]: [f64; 2]) -> f64 {
    (first * a).max(0.0) + (second * b).max(0.0)
}

/// A day as numbers, for [`Sky::table`](super::Sky).
impl Day {
    /// 1 where the five factors give Y, x, y by the last three; 2 where these are Rec. 709; 3 where they are, of a luminance
    /// that the first two give.
    pub(super) fn form_number(&self) -> f64 {
        match self.form {
            Form::Preetham(_) => FORM_XYY,
            Form::Hosek(_) | Form::Uniform(_) => FORM_RGB,
            Form::Luminance { .. } => FORM_LUMINANCE,
        }
    }

    /// RGB in the working space of one cd/m2 of an overcast sky.
    pub(super) fn overcast(&self) -> DVec3 {
        self.overcast
    }

    /// From the model's own colours to the working space.
    pub(super) fn working_from_own(&self) -> DMat3 {
        match self.form {
            Form::Preetham(_) => WORKING_FROM_XYZ,
            Form::Uniform(_) => DMat3::IDENTITY,
            _ => self.working_from_rec709,
        }
    }

    /// Coefficients of [`Self::over_height`]: s, a, b, o, c, h of two luminances and three colours.
    pub(super) fn factors(&self) -> [[f64; 6]; 5] {
        let mut factors = [[0.0; 6]; 5];
        let colours = match &self.form {
            Form::Preetham(form) => form.coefficients(),
            Form::Hosek(form) => form.coefficients(),
            // A sky of even luminance is made without a day.
            Form::Uniform(_) => [[0.0; 6]; 3],
            Form::Luminance { parts, clear, .. } => {
                for (factor, (gradation, scale)) in factors.iter_mut().zip(parts) {
                    let [s, a, b, o, c] = gradation.coefficients();
                    *factor = [s * scale, a, b, o, c, 0.0];
                }
                clear.coefficients()
            }
        };
        factors[2..].copy_from_slice(&colours);
        factors
    }
}

/// What a model needs of a direction's height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Height {
    /// Factors of the luminance of both gradations [cd/m2].
    luminance: [f64; 2],
    /// Factor and addend of the colour.
    factor: DVec3,
    addend: DVec3,
}

impl Height {
    fn new(luminance: [f64; 2], (factor, addend): (DVec3, DVec3)) -> Self {
        Height {
            luminance,
            factor,
            addend,
        }
    }
}

/// What a model needs of a direction's angle from the sun [1]. A smooth function of that angle.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Around {
    luminance: [f64; 2],
    colour: DVec3,
}

impl Around {
    /// As plain numbers, to be interpolated.
    pub fn to_array(self) -> [f64; 5] {
        let ([a, b], [x, y, z]) = (self.luminance, self.colour.to_array());
        [a, b, x, y, z]
    }

    /// From [`Self::to_array`].
    pub fn from_array([a, b, x, y, z]: [f64; 5]) -> Self {
        Around {
            luminance: [a, b],
            colour: DVec3::new(x, y, z),
        }
    }
}

/// How much clouds take part in a sky of measured irradiance [1]: 0 from 70 % of the clear sky's beam up, 1 without beam.
///
/// Below 5 degrees of elevation [rad] the clear beam of 5 degrees is the measure: lower ones are too weak to compare with.
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
    let negative = Cell::new(false);
    let sums = parts.map(|(gradation, weight)| {
        if weight == 0.0 {
            return 1.0;
        }
        hemisphere::product_integral(
            sun.seen_zenith_angle,
            |cos_theta| gradation.gradation(cos_theta),
            |gamma, cos_gamma| gradation.indicatrix(gamma, cos_gamma),
            |value| {
                negative.set(negative.get() || value < 0.0);
                value.max(0.0)
            },
        )
    });
    let [(first, w0), (second, w1)] = parts;
    (
        [
            (first, w0 * diffuse / sums[0]),
            (second, w1 * diffuse / sums[1]),
        ],
        negative.get(),
    )
}

/// [`Error::Domain`](crate::Error::Domain) for a turbidity that a model cannot take, wherever the sun is.
pub fn check(model: Model) -> Result<()> {
    match model {
        Model::Preetham { turbidity } => preetham::check_turbidity(turbidity),
        Model::Perez { turbidity, .. } => Hosek::new(turbidity, COLOUR_ALBEDO, 0.5).map(|_| ()),
        Model::Cie {
            kind, turbidity, ..
        } => {
            Kind::new(kind)?;
            Hosek::new(turbidity, COLOUR_ALBEDO, 0.5).map(|_| ())
        }
        Model::Hosek { turbidity, albedo } => Hosek::new(turbidity, albedo, 0.5).map(|_| ()),
        Model::Uniform { .. } => Ok(()),
    }
}
