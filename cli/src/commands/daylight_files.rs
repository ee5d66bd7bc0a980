//! The files that `tyndall daylight` writes, by their endings.

use std::path::{Path, PathBuf};
use tyndall::output::{self, atomic};
use tyndall::{Error, Result};

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// A picture, .png or .svg.
    Map,
    /// OpenEXR.
    Raster,
    Csv,
    Json,
    /// HTML.
    Page,
}

impl Kind {
    /// The kind that a file's ending means; `pages` says whether there are pages.
    ///
    /// # Errors
    /// [`Error::Input`] for an ending that means nothing.
    pub fn of(file: &Path, pages: bool) -> Result<Self> {
        let ending = file.extension().unwrap_or_default().to_string_lossy();
        match ending.to_ascii_lowercase().as_str() {
            "png" | "svg" => Ok(Kind::Map),
            "exr" => Ok(Kind::Raster),
            "csv" => Ok(Kind::Csv),
            "json" => Ok(Kind::Json),
            "html" | "htm" if pages => Ok(Kind::Page),
            _ => Err(Error::input(
                format!("-o {}", file.display()),
                "the name does not say what to write",
                match pages {
                    true => {
                        "let it end in .png or .svg for a map, .csv, .json or .exr for numbers, .html for a page"
                    }
                    false => {
                        "let it end in .png or .svg for a map, .csv, .json or .exr for numbers"
                    }
                },
            )),
        }
    }
}

/// Takes a file that is to be written among those in use, which are read or written elsewhere.
///
/// # Errors
/// [`Error::Input`] for one that is in use; those of [`atomic::check`].
pub fn claim(file: &Path, in_use: &mut Vec<(PathBuf, &str)>) -> Result<()> {
    output::check_apart("-o", file, in_use)?;
    atomic::check(file)?;
    in_use.push((file.to_owned(), "another of the files"));
    Ok(())
}
