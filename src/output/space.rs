//! The colour space and the unit of what is written as EXR and HDR.

use crate::colour::{Space, luminance};
use glam::{DMat3, DVec2, DVec3};

/// What Radiance calls WHTEFFICACY [lm/W].
pub const WHITE_EFFICACY: f64 = 179.0;

/// The colour space of what is written, and the way there from the working space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputSpace {
    /// Its name, as in `--color-space`.
    pub name: &'static str,
    /// Takes a column of linear Rec. 2020 to one of this space; luminance stays what it is.
    pub from_working: DMat3,
    /// CIE 1931 x, y of its red, green and blue.
    pub primaries: [DVec2; 3],
    /// CIE 1931 x, y of its white.
    pub white: DVec2,
    /// What its numbers stand for.
    pub numbers: Numbers,
}

/// What the numbers of a picture file stand for, and which of them it may hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numbers {
    /// Their unit; absent: the format's own, [`Units::Photometric`] for EXR and [`Units::Radiance`] for HDR.
    pub units: Option<Units>,
    /// What all of them are multiplied by, positive.
    pub multiply: f64,
    /// Whether colours outside the space's gamut are moved toward the grey of their luminance until no channel is negative.
    pub inside_gamut: bool,
    /// Whether colours are held within what a half float holds, [`HALF_MOST`], keeping their hue.
    pub clamp_half: bool,
}

impl Default for Numbers {
    fn default() -> Self {
        Numbers {
            units: None,
            multiply: 1.0,
            inside_gamut: false,
            clamp_half: false,
        }
    }
}

/// What the luminance of a colour is measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Units {
    /// cd/m2.
    Photometric,
    /// W/(sr m2) as Radiance counts them: cd/m2 over 179 lm/W, [`WHITE_EFFICACY`].
    Radiance,
}

/// The greatest number that a half float holds.
pub const HALF_MOST: f64 = 65_504.0;

impl OutputSpace {
    /// What EXR and HDR take to hold colours of `space`.
    pub fn new(space: Space, numbers: Numbers) -> Self {
        let c = space.chromaticities();
        OutputSpace {
            name: space.name(),
            from_working: space.from_working(),
            primaries: [c.red, c.green, c.blue].map(Into::into),
            white: c.white.into(),
            numbers,
        }
    }

    /// What a luminance of 1 cd/m2 is in a file whose format has a unit of its own.
    pub fn per_candela(&self, own: Units) -> f64 {
        let unit = match self.numbers.units.unwrap_or(own) {
            Units::Photometric => 1.0,
            Units::Radiance => 1.0 / WHITE_EFFICACY,
        };
        unit * self.numbers.multiply
    }

    /// A colour of the working space [cd/m2] as such a file has it.
    pub fn colour(&self, own: Units, working: DVec3) -> DVec3 {
        let mut colour = self.from_working * working;
        let least = colour.min_element();
        if self.numbers.inside_gamut && least < 0.0 {
            // Toward grey, which has the colour's luminance in each channel.
            let grey = luminance(working).max(0.0);
            let share = grey / (grey - least);
            colour = (grey + (colour - grey) * share).max(DVec3::ZERO);
        }
        colour *= self.per_candela(own);
        let most = colour.abs().max_element();
        if self.numbers.clamp_half && most > HALF_MOST {
            colour *= HALF_MOST / most;
        }
        colour
    }
}
