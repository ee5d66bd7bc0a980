//! From a [`Frame`](crate::frame::Frame) to files.
//!
//! - [`exr`]: everything, in numbers
//! - [`png`]: the picture as a screen shows it
//! - [`hdr`]: the picture for programs that read Radiance's format
//! - [`picture`]: one of these by its name, and the key that it holds
//! - [`report`]: the record and the plan, for scripts
//! - [`drawing`], [`canvas`], [`lettering`]: lines and words, as SVG and as pixels
//! - [`scale`], [`isolines`], [`false_colour`]: values as colours, lines of equal value, luminance as a picture of both
//! - [`atomic`]: how each file is written whole or not at all

pub mod atomic;
pub mod canvas;
pub mod drawing;
pub mod exr;
pub mod false_colour;
pub mod hdr;
pub mod isolines;
pub mod lettering;
pub mod picture;
pub mod png;
pub mod report;
pub mod scale;

use crate::colour::luminance;
use crate::error::{Error, Result};
use crate::frame::Field;
use glam::{DMat3, DVec2, DVec3};
use std::path::{Path, PathBuf};

/// A kind of picture file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR: all layers, 32-bit float.
    Exr,
    /// PNG: display-referred, 8 bits.
    Png,
    /// Radiance RGBE: the picture alone.
    Hdr,
}

impl Format {
    /// The format that a file's name asks for.
    ///
    /// # Errors
    /// [`Error::Input`] when the name's extension is none that can be written.
    pub fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        match ending.to_ascii_lowercase().as_str() {
            "exr" => Ok(Format::Exr),
            "png" => Ok(Format::Png),
            "hdr" => Ok(Format::Hdr),
            _ => Err(Error::input(
                format!("-o {}", path.display()),
                "the name does not say which kind of picture to write",
                "let it end in .exr, .png or .hdr",
            )),
        }
    }
}

/// The formats of the files that a picture is to be written to, once it is known that all of them can be.
///
/// To be called before the expensive work.
///
/// # Errors
/// Those of [`Format::of`] and [`atomic::check`]; [`Error::Input`] when a file is named twice.
pub fn check_targets(paths: &[PathBuf]) -> Result<Vec<Format>> {
    let mut formats = Vec::with_capacity(paths.len());
    for (index, path) in paths.iter().enumerate() {
        formats.push(Format::of(path)?);
        if paths[..index].iter().any(|other| is_same_file(other, path)) {
            return Err(Error::input(
                format!("-o {}", path.display()),
                "the file is named twice",
                "name it once",
            ));
        }
        atomic::check(path)?;
    }
    Ok(formats)
}

/// Refuses to write over what is read, or over what else is written: `path` is given by `flag`, `others` are in use already.
///
/// # Errors
/// [`Error::Input`] when one of `others` is the same file, by whatever name.
pub fn check_apart(flag: &str, path: &Path, others: &[(PathBuf, &str)]) -> Result<()> {
    let same = others.iter().find(|(other, _)| is_same_file(other, path));
    same.map_or(Ok(()), |(_, what)| {
        Err(Error::input(
            format!("{flag} {}", path.display()),
            format!("this is {what}, which would be lost"),
            "write to another file",
        ))
    })
}

/// Whether two names stand for one file, which need not exist.
fn is_same_file(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        path.canonicalize().or_else(|_| {
            let folder = match path.parent() {
                Some(folder) if folder != Path::new("") => folder,
                _ => Path::new("."),
            };
            let name = path.file_name().unwrap_or_default();
            folder.canonicalize().map(|folder| folder.join(name))
        })
    };
    match (place(a), place(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

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
    /// W/(sr m2) as Radiance counts them: cd/m2 over 179 lm/W, [`hdr::WHITE_EFFICACY`].
    Radiance,
}

/// The greatest number that a half float holds.
pub const HALF_MOST: f64 = 65_504.0;

impl OutputSpace {
    /// What a luminance of 1 cd/m2 is in a file whose format has a unit of its own.
    pub fn per_candela(&self, own: Units) -> f64 {
        let unit = match self.numbers.units.unwrap_or(own) {
            Units::Photometric => 1.0,
            Units::Radiance => 1.0 / hdr::WHITE_EFFICACY,
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

/// The layers of an EXR, in its own names: those of [`Field::layers`], then `transmittance` and `normal`.
///
/// The picture (R, G, B) and Z are always written.
pub fn layer_names() -> impl Iterator<Item = &'static str> {
    Field::layers()
        .map(Field::name)
        .chain(["transmittance", "normal"])
}

/// The layers of those names (`--layers`); all of them for no names.
///
/// # Errors
/// [`Error::Input`] with the nearest name for one that is unknown.
pub fn select_layers<S: AsRef<str>>(names: &[S]) -> Result<Vec<&'static str>> {
    if names.is_empty() {
        return Ok(layer_names().collect());
    }
    let mut selected = Vec::new();
    for name in names {
        let name = name.as_ref();
        let Some(known) = layer_names().find(|known| *known == name) else {
            let nearest = layer_names()
                .max_by(|a, b| {
                    strsim::jaro_winkler(a, name).total_cmp(&strsim::jaro_winkler(b, name))
                })
                .unwrap_or_default();
            let all = layer_names().collect::<Vec<_>>().join(", ");
            return Err(Error::input(
                "--layers",
                format!("there is no layer `{name}`"),
                format!("did you mean `{nearest}`? There are {all}"),
            ));
        };
        if !selected.contains(&known) {
            selected.push(known);
        }
    }
    Ok(selected)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_by_name() {
        assert_eq!(Format::of(Path::new("a/b.EXR")).ok(), Some(Format::Exr));
        assert_eq!(Format::of(Path::new("b.png")).ok(), Some(Format::Png));
        for bad in ["b.jpg", "png", "a.exr/b"] {
            assert!(
                Format::of(Path::new(bad)).is_err_and(|e| e.is_input()),
                "{bad}"
            );
        }
    }

    #[test]
    fn layers_by_name() {
        let all = select_layers::<&str>(&[]).expect("no names are all names");
        assert_eq!(all.len(), 10);
        assert_eq!(all[..3], ["sun", "sky", "indirect"]);
        let two = select_layers(&["normal", "sun", "normal"]).expect("both are known");
        assert_eq!(two, ["normal", "sun"]);
        let error = select_layers(&["inscater_sun"]).expect_err("it is misspelt");
        assert!(error.is_input());
        assert!(error.remedy().contains("`inscatter_sun`?"), "{error}");
    }
}
