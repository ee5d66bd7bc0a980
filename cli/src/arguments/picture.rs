//! The values of the flags that say how a picture file is written.

use clap::{Args, ValueEnum};
use tyndall::Result;
use tyndall::colour::Space;
use tyndall::output::{Numbers, OutputSpace, Units};

/// The exposure of a PNG.
#[derive(Debug, Clone, Copy)]
pub enum Exposure {
    Auto,
    Ev100(f64),
}

/// What the numbers of EXR and HDR stand for.
#[derive(Args, Clone, Debug)]
pub struct NumbersArgs {
    /// The unit of EXR and HDR: photometric (cd/m2) or radiance (cd/m2 over 179) [default: photometric for EXR, radiance for HDR]
    #[arg(long, value_name = "UNIT")]
    units: Option<UnitsFlag>,
    /// Multiply all colours of EXR and HDR
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = positive)]
    multiply: f64,
    /// Hold the colours of EXR and HDR within what half floats hold, 65504, keeping their hue
    #[arg(long)]
    clamp_half: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum UnitsFlag {
    /// cd/m2
    Photometric,
    /// W/(sr m2) by Radiance's 179 lm/W
    Radiance,
}

impl NumbersArgs {
    /// As the writers take them; those of maps stay inside the gamut.
    pub fn numbers(&self, inside_gamut: bool) -> Numbers {
        Numbers {
            units: self.units.map(|units| match units {
                UnitsFlag::Photometric => Units::Photometric,
                UnitsFlag::Radiance => Units::Radiance,
            }),
            multiply: self.multiply,
            inside_gamut,
            clamp_half: self.clamp_half,
        }
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (1e-12..=1e12).contains(&x) => Ok(x),
        _ => Err("a number from 1e-12 to 1e12 was expected".into()),
    }
}

/// A colour space as the writers of EXR and HDR take it.
pub fn output_space(space: Space, numbers: Numbers) -> OutputSpace {
    let c = space.chromaticities();
    OutputSpace {
        name: space.name(),
        from_working: space.from_working(),
        primaries: [c.red, c.green, c.blue].map(Into::into),
        white: c.white.into(),
        numbers,
    }
}

/// `auto` or an EV100.
pub fn exposure_flag(text: &str) -> Result<Exposure, String> {
    match text.parse::<f64>() {
        _ if text == "auto" => Ok(Exposure::Auto),
        Ok(ev) if (-20.0..=40.0).contains(&ev) => Ok(Exposure::Ev100(ev)),
        _ => Err("auto, or an EV100 from -20 to 40, was expected".into()),
    }
}

/// A colour space by its name.
pub fn space(text: &str) -> Result<Space, String> {
    text.parse().map_err(|e: tyndall::Error| e.remedy())
}
