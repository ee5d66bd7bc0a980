//! The values of the flags that say how a picture file is written.

use tyndall::Result;
use tyndall::colour::Space;
use tyndall::output::OutputSpace;

/// The exposure of a PNG.
#[derive(Debug, Clone, Copy)]
pub enum Exposure {
    Auto,
    Ev100(f64),
}

/// A colour space as the writers of EXR and HDR take it.
pub fn output_space(space: Space) -> OutputSpace {
    let c = space.chromaticities();
    OutputSpace {
        name: space.name(),
        from_working: space.from_working(),
        primaries: [c.red, c.green, c.blue].map(Into::into),
        white: c.white.into(),
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
