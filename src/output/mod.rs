//! From a [`Frame`](crate::frame::Frame) to files.
//!
//! - [`exr`]: everything, in numbers
//! - [`png`], [`jpeg`]: the picture as a screen shows it
//! - [`hdr`]: the picture for programs that read Radiance's format
//! - [`layers`]: which layers an EXR holds
//! - [`picture`]: one of these by its name, and the key that it holds
//! - [`space`]: the colour space and the unit of EXR and HDR
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
pub mod jpeg;
pub mod layers;
pub mod lettering;
pub mod picture;
pub mod png;
pub mod report;
pub mod scale;
pub mod space;

use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

pub use layers::{layer_names, layers_of, select_layers};
pub use space::{HALF_MOST, Numbers, OutputSpace, Units};

/// A kind of picture file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR: all layers, 32-bit float.
    Exr,
    /// PNG: display-referred, 8 bits.
    Png,
    /// Radiance RGBE: the picture alone.
    Hdr,
    /// JPEG: display-referred, 8 bits, not quite exact.
    Jpeg,
}

impl Format {
    /// All of them, by the ending of their files' names.
    pub const ENDINGS: [(&str, Format); 5] = [
        ("png", Format::Png),
        ("exr", Format::Exr),
        ("hdr", Format::Hdr),
        ("jpg", Format::Jpeg),
        ("jpeg", Format::Jpeg),
    ];

    /// Whether it holds the picture as a screen shows it, and no numbers.
    pub fn is_for_screens(self) -> bool {
        matches!(self, Format::Png | Format::Jpeg)
    }

    /// The format that a file's name asks for.
    ///
    /// # Errors
    /// [`Error::Input`] when the name's extension is none that can be written.
    pub fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        let ending = ending.to_ascii_lowercase();
        let mut formats = Format::ENDINGS.iter();
        let found = formats.find(|(known, _)| *known == ending);
        found.map(|(_, format)| *format).ok_or_else(|| {
            Error::input(
                format!("-o {}", path.display()),
                "the name does not say which kind of picture to write",
                "let it end in .exr, .png, .jpg or .hdr",
            )
        })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_by_name() {
        assert_eq!(Format::of(Path::new("a/b.EXR")).ok(), Some(Format::Exr));
        assert_eq!(Format::of(Path::new("b.png")).ok(), Some(Format::Png));
        assert_eq!(Format::of(Path::new("b.jpg")).ok(), Some(Format::Jpeg));
        for bad in ["b.tif", "png", "a.exr/b"] {
            assert!(
                Format::of(Path::new(bad)).is_err_and(|e| e.is_input()),
                "{bad}"
            );
        }
    }
}
