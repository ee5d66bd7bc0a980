//! Reading a file whole: only files that end, and only as much as is allowed and there is memory for.

use crate::error::{Error, Result};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The most that one file of a scene may hold [bytes].
pub const LARGEST: u64 = 16 << 30;

/// The content of a regular file (or of a link to one) of at most `most` bytes.
///
/// # Errors
/// [`Error::File`] when it cannot be read; [`Error::Input`] when it is a folder, a device or a pipe, or larger than `most`;
/// [`Error::Failed`] when memory does not suffice.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    let reading = |e| Error::reading(path, e);
    let place = || path.display().to_string();
    let too_large = || {
        Error::input(
            place(),
            format!("it is larger than {most} bytes"),
            "name a smaller file",
        )
    };
    // Asked before it is opened: opening a pipe waits for whoever writes it.
    let entry = std::fs::metadata(path).map_err(reading)?;
    if !entry.is_file() {
        let kind = if entry.is_dir() {
            "a folder"
        } else {
            "a device or a pipe"
        };
        return Err(Error::input(
            place(),
            format!("it is {kind}, not a file"),
            "name a file",
        ));
    }
    if entry.len() > most {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(entry.len() as usize).map_err(|_| {
        Error::failed(
            format!(
                "{}: there is no memory for its {} bytes",
                place(),
                entry.len()
            ),
            "free memory, or name a smaller file",
        )
    })?;
    // A file may grow while it is read, and some of the system's own name no length.
    let mut file = File::open(path).map_err(reading)?.take(most + 1);
    file.read_to_end(&mut bytes).map_err(reading)?;
    if bytes.len() as u64 > most {
        return Err(too_large());
    }
    Ok(bytes)
}
