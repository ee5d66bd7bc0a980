//! The flags that say what renders a picture and how its files are written.

use crate::arguments::backend::BackendFlag;
use crate::arguments::hinted::{hinted, text};
use clap::{Args, ValueEnum};
use tyndall::colour::Space;
use tyndall::conditions::Conditions;
use tyndall::output::layers::EVERY;
use tyndall::output::{self, Format, Numbers, OutputSpace, Units};
use tyndall::plan::Overrules;
use tyndall::scene::Scene;
use tyndall::{Error, Result};

/// What renders, and what is in the files.
#[derive(Debug, Args)]
pub struct PictureArgs {
    /// What renders: auto uses a hardware adapter, else the CPU reference; gpu also accepts a software adapter
    #[arg(long, value_name = "BACKEND", default_value = "auto", value_enum)]
    pub backend: BackendFlag,
    /// The layers of the EXR, separated by commas, or all [default: those that the scene can hold something in, whatever the hour]
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = hinted(text, output::layer_names().chain([EVERY])), hide_possible_values = true)]
    layers: Vec<String>,
    /// Exposure of the PNG: auto, auto+2 for two stops brighter, or the EV100 whose white is 1.2 * 2^EV cd/m2 [default: the scene's, or auto]
    #[arg(long, value_name = "auto[+STOPS]|EV", allow_negative_numbers = true, value_parser = hinted(exposure_flag, ["auto"]), hide_possible_values = true)]
    exposure: Option<Exposure>,
    /// The colour space of EXR and HDR: rec709, rec2020, acescg or xyz
    #[arg(long, value_name = "NAME", default_value = "rec709", value_parser = hinted(space, SPACES), hide_possible_values = true)]
    color_space: Space,
    #[command(flatten)]
    numbers: NumbersArgs,
}

impl PictureArgs {
    /// The layers of an EXR: those that are named, else those that can hold something.
    ///
    /// # Errors
    /// Those of [`output::select_layers`].
    pub fn layers(
        &self,
        conditions: &Conditions,
        overrules: &Overrules,
    ) -> Result<Vec<&'static str>> {
        match self.layers.is_empty() {
            true => Ok(output::layers_of(conditions, overrules)),
            false => output::select_layers(&self.layers),
        }
    }

    /// The exposure that the flag or the scene asks for [EV100]; nothing where pictures are to be metered.
    pub fn ev100(&self, scene: &Scene) -> Option<f64> {
        match self.exposure {
            Some(Exposure::Ev100(ev100)) => Some(ev100),
            Some(Exposure::Auto(_)) => None,
            None => scene.picture.exposure_ev100,
        }
    }

    /// How many stops brighter than metered pictures are shown that are metered.
    pub fn stops(&self) -> f64 {
        match self.exposure {
            Some(Exposure::Auto(stops)) => stops,
            _ => 0.0,
        }
    }

    /// Refuses layers and numbers for files that hold none: PNGs are as a screen shows them.
    ///
    /// # Errors
    /// [`Error::Input`] where no file of these formats has the layers or the numbers that the flags say anything of.
    pub fn check(&self, formats: &[Format]) -> Result<()> {
        if !self.layers.is_empty() && !formats.contains(&Format::Exr) {
            return Err(Error::input(
                "--layers",
                "no -o has a format that has layers",
                "add -o with a name in .exr, or leave it out",
            ));
        }
        let written = formats.iter().any(|format| !format.is_for_screens());
        match self.numbers.numbers(false) == Numbers::default() || written {
            true => Ok(()),
            false => Err(Error::input(
                "--units, --multiply and --clamp-half",
                "no -o has a format that they concern",
                "add -o with a name in .exr or .hdr, or leave them out",
            )),
        }
    }

    /// The colour space as the writers take it.
    pub fn space(&self) -> OutputSpace {
        output_space(self.color_space, self.numbers.numbers(false))
    }
}

/// Colour spaces by their names.
pub const SPACES: [&str; 4] = ["rec709", "rec2020", "acescg", "xyz"];

/// The exposure of a PNG.
#[derive(Debug, Clone, Copy)]
pub enum Exposure {
    /// As metered, so many stops brighter.
    Auto(f64),
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
    OutputSpace::new(space, numbers)
}

/// `auto`, with stops to add, or an EV100.
pub fn exposure_flag(text: &str) -> Result<Exposure, String> {
    let stops = match text.strip_prefix("auto") {
        Some("") => Some(Ok(0.0)),
        Some(stops) if stops.starts_with(['+', '-']) => Some(stops.parse::<f64>()),
        _ => None,
    };
    match (stops, text.parse::<f64>()) {
        (Some(Ok(stops)), _) if stops.abs() <= 20.0 => Ok(Exposure::Auto(stops)),
        (None, Ok(ev)) if (-20.0..=40.0).contains(&ev) => Ok(Exposure::Ev100(ev)),
        _ => Err("auto, auto+2 or auto-1.5 for stops brighter or darker, or an EV100 from -20 to 40, was expected".into()),
    }
}

/// A colour space by its name.
pub fn space(text: &str) -> Result<Space, String> {
    text.parse().map_err(|e: tyndall::Error| e.remedy())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposures() {
        let of = |text: &str| match exposure_flag(text) {
            Ok(Exposure::Auto(stops)) => Some((true, stops)),
            Ok(Exposure::Ev100(ev)) => Some((false, ev)),
            Err(_) => None,
        };
        assert_eq!(of("auto"), Some((true, 0.0)));
        assert_eq!(of("auto+2"), Some((true, 2.0)));
        assert_eq!(of("auto-1.5"), Some((true, -1.5)));
        assert_eq!(of("-2"), Some((false, -2.0)));
        for bad in [
            "auto2",
            "auto+",
            "auto+x",
            "auto+99",
            "41",
            "NaN",
            "automatic",
        ] {
            assert_eq!(of(bad), None, "{bad}");
        }
    }
}
