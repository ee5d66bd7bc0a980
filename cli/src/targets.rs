//! Where pictures go: files by their names, and standard output for `-`.

use crate::tables::stdout;
use clap::{Args, ValueEnum};
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use tyndall::output::{self, Format};
use tyndall::{Error, Result};

/// The format of a picture that has no name.
#[derive(Args, Clone, Copy, Debug)]
pub struct FormatArgs {
    /// The format of a picture on standard output, -o - [default: png]
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<FormatFlag>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FormatFlag {
    Png,
    Exr,
    Hdr,
    Jpeg,
}

impl From<FormatFlag> for Format {
    fn from(flag: FormatFlag) -> Self {
        match flag {
            FormatFlag::Png => Format::Png,
            FormatFlag::Exr => Format::Exr,
            FormatFlag::Hdr => Format::Hdr,
            FormatFlag::Jpeg => Format::Jpeg,
        }
    }
}

/// Pictures to write.
pub struct Targets {
    files: Vec<PathBuf>,
    formats: Vec<Format>,
    /// That of standard output, if a picture goes there.
    piped: Option<Format>,
}

impl Targets {
    /// Those of these names, once it is known that all can be written. `prints` is the flag that has words printed there, if one is given.
    ///
    /// # Errors
    /// Those of [`output::check_targets`]; [`Error::Input`] where `-` is a terminal, is named twice, or where words go, and for a format
    /// without it; [`Error::Failed`] where there is no folder for temporary files.
    pub fn check(paths: &[PathBuf], format: FormatArgs, prints: Option<&str>) -> Result<Self> {
        let is_piped = |path: &&PathBuf| path.as_path() == Path::new("-");
        let refused = |problem: &str, remedy: &str| Err(Error::input("-o -", problem, remedy));
        let piped = match (paths.iter().filter(is_piped).count(), prints) {
            (0, _) if format.format.is_some() => {
                return Err(Error::input(
                    "--format",
                    "it is of a picture on standard output, and none goes there",
                    "add -o -, or leave it out: a file's name says its format",
                ));
            }
            (0, _) => None,
            (1, Some(flag)) => {
                return refused(
                    &format!("standard output has {flag} already"),
                    "write the picture to a file",
                );
            }
            (1, None) if std::io::stdout().is_terminal() => {
                return refused(
                    "standard output is a terminal, which shows no pictures",
                    "pipe it into a program, or write to a file",
                );
            }
            (1, None) => {
                temporary_folder()?;
                Some(format.format.map_or(Format::Png, Format::from))
            }
            _ => return refused("it is named twice", "name it once"),
        };
        let files: Vec<PathBuf> = paths.iter().filter(|p| !is_piped(p)).cloned().collect();
        Ok(Targets {
            formats: output::check_targets(&files)?,
            files,
            piped,
        })
    }

    /// Whether a picture goes to standard output.
    pub fn is_piped(&self) -> bool {
        self.piped.is_some()
    }

    /// The files among them.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The formats of all.
    pub fn formats(&self) -> Vec<Format> {
        self.formats.iter().copied().chain(self.piped).collect()
    }

    /// Writes all of them by `write`: what goes to standard output is a file first, as some formats are not written from front to back.
    ///
    /// # Errors
    /// Those of `write`; [`Error::File`] where there is no room, or standard output does not take it.
    pub fn write(&self, write: impl Fn(&Path, Format) -> Result<()>) -> Result<()> {
        for (path, format) in self.files.iter().zip(&self.formats) {
            write(path, *format)?;
        }
        let Some(format) = self.piped else {
            return Ok(());
        };
        let folder = temporary_folder()?;
        let path = folder.path().join("picture");
        write(&path, format)?;
        let wrong = |e| Error::reading(&path, e);
        let mut file = std::fs::File::open(&path).map_err(wrong)?;
        let mut out = stdout::lock();
        let mut bytes = vec![0; 1 << 18];
        loop {
            match file.read(&mut bytes).map_err(wrong)? {
                0 => return out.finish(),
                count => out.bytes(&bytes[..count])?,
            }
        }
    }
}

/// A folder for what goes to standard output.
fn temporary_folder() -> Result<TempDir> {
    tempfile::tempdir().map_err(|error| {
        let folder = std::env::temp_dir();
        Error::failed(
            format!(
                "no folder for temporary files can be made in {}: {error}",
                folder.display()
            ),
            "-o - needs one: name another folder by the variable TMPDIR, or write to a file",
        )
    })
}
