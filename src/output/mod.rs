//! From a [`Frame`](crate::frame::Frame) to files.
//!
//! - [`exr`]: everything, in numbers
//! - [`png`]: the picture as a screen shows it
//! - [`hdr`]: the picture for programs that read Radiance's format
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
pub mod lettering;
pub mod picture;
pub mod png;
pub mod report;
pub mod scale;
pub mod space;

use crate::error::{Error, Result};
use crate::frame::Field;
use std::path::{Path, PathBuf};

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
