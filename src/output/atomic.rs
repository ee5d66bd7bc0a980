//! Files that are whole or not there at all.
//!
//! A file is written beside its name and renamed into place once it is complete and on the disk. Whatever fails on
//! the way leaves the folder, and a file that was there before, as they were.

use crate::error::{Error, Result};
use std::ffi::OsStr;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Letters and digits by which the names of temporary files differ.
const RANDOM: usize = 6;

/// Whether a file of this name could be written, to be asked before the work that fills it.
///
/// Leaves nothing behind, so that a run which is interrupted leaves nothing either.
///
/// # Errors
/// [`Error::File`]: the folder is missing or may not be written, the name is a folder's or a device's, or the
/// file that it names is protected.
pub fn check(path: &Path) -> Result<()> {
    begin(path).map(drop).map_err(|e| Error::writing(path, e))
}

/// Writes the file `path` with `fill`, which may also read and seek in it.
///
/// # Errors
/// Those of [`check`], and [`Error::File`] with whatever `fill` or the disk reports.
pub fn write(path: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> Result<()> {
    let whole = || {
        let (target, mut temporary) = begin(path)?;
        fill(temporary.as_file_mut())?;
        end(&target, temporary)
    };
    whole().map_err(|e| Error::writing(path, e))
}

/// Has the file `path` written by another program: `fill` gets the name under which it lies until it is whole.
///
/// # Errors
/// Those of [`check`]; those of `fill`, and [`Error::File`] with whatever the disk reports.
pub fn write_by_name(path: &Path, fill: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    let wrong = |e| Error::writing(path, e);
    let (target, temporary) = begin(path).map_err(wrong)?;
    fill(temporary.path())?;
    end(&target, temporary).map_err(wrong)
}

/// Renames a file that is whole.
fn end(target: &Path, temporary: NamedTempFile) -> io::Result<()> {
    temporary.as_file().sync_all()?;
    temporary.persist(target).map_err(|e| e.error)?;
    sync_folder(target);
    Ok(())
}

/// The file that `path` stands for, links followed, and an empty one beside it that vanishes unless it is renamed.
fn begin(path: &Path) -> io::Result<(PathBuf, NamedTempFile)> {
    let found = match path.metadata() {
        Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => {
            return Err(io::Error::other("it is a device or a pipe, not a file"));
        }
        Ok(found) if found.permissions().readonly() => {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        Ok(found) => Some(found),
        Err(e) if e.kind() == io::ErrorKind::NotFound => None,
        Err(e) => return Err(e),
    };
    // A link stays a link: what it points to is replaced.
    let target = match &found {
        Some(_) => path.canonicalize()?,
        None => path.to_owned(),
    };
    let name = target
        .file_name()
        .ok_or_else(|| io::Error::from(io::ErrorKind::IsADirectory))?;
    let folder = match target.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let mut prefix = std::ffi::OsString::from(".");
    // The longest names leave no room for more.
    prefix.push(if name.len() < 200 {
        name
    } else {
        OsStr::new("tyndall")
    });
    prefix.push(".");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).rand_bytes(RANDOM);
    // A temporary file is its owner's alone; a picture is as open as any new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let temporary = builder.tempfile_in(folder).map_err(without_name)?;
    if let Some(found) = found {
        temporary.as_file().set_permissions(found.permissions())?;
    }
    Ok((target, temporary))
}

/// The name of the file that a temporary one was to become, by the name of that: what was killed on the way has left it.
pub fn name_of(temporary: &str) -> Option<&str> {
    let (name, random) = temporary.strip_prefix('.')?.rsplit_once('.')?;
    let is_random = random.len() == RANDOM && random.bytes().all(|b| b.is_ascii_alphanumeric());
    (is_random && !name.is_empty()).then_some(name)
}

/// What the system said, without the name that only we know.
fn without_name(error: io::Error) -> io::Error {
    let text = error.to_string();
    match text.split_once(" at path ") {
        Some((said, _)) => io::Error::new(error.kind(), said.to_owned()),
        None => error,
    }
}

/// Syncs the new name to the disk too. The file itself is there already, so a failure here is ignored.
fn sync_folder(target: &Path) {
    #[cfg(unix)]
    if let Some(folder) = target.parent()
        && let Ok(folder) = File::open(if folder == Path::new("") {
            Path::new(".")
        } else {
            folder
        })
    {
        let _ = folder.sync_all();
    }
    #[cfg(not(unix))]
    let _ = target;
}
