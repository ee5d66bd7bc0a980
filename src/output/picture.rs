//! A picture's file in any of the formats, and the key that it holds: a hash of everything that the picture was made of.

use super::{Format, OutputSpace, exr, hdr, jpeg, png};
use crate::error::Result;
use crate::frame::{Frame, Value};
use std::path::Path;

/// The name under which EXR, PNG and JPEG hold the key of a picture's record, where it has one.
const KEY: &str = "tyndall:key";

/// Writes a picture in one of the formats: EXR and HDR in `space`, an EXR with `layers` (see [`super::select_layers`]), a PNG and a
/// JPEG with the exposure `ev100`.
///
/// # Errors
/// Those of [`exr::write`], [`hdr::write`], [`png::write`] and [`jpeg::write`].
pub fn write(
    path: &Path,
    format: Format,
    frame: &Frame,
    space: &OutputSpace,
    layers: &[&'static str],
    ev100: f64,
) -> Result<()> {
    match format {
        Format::Exr => exr::write(path, frame, space, layers),
        Format::Hdr => hdr::write(path, frame, space),
        Format::Png | Format::Jpeg => {
            let bytes = png::encode(frame, ev100);
            let words: &[(&str, &str)] = match frame.record.get("key") {
                Some(Value::Text(key)) => &[(KEY, key)],
                _ => &[],
            };
            write_shown(path, format, [frame.width, frame.height], &bytes, words)
        }
    }
}

/// Writes a picture as a screen shows it, three bytes a pixel from the top left, as a JPEG or else a PNG, with words of its own by their
/// names.
///
/// # Errors
/// Those of [`png::write_with`] and [`jpeg::write`].
pub fn write_shown(
    path: &Path,
    format: Format,
    [width, height]: [u32; 2],
    rgb: &[u8],
    words: &[(&str, &str)],
) -> Result<()> {
    match format {
        Format::Jpeg => jpeg::write(path, width, height, rgb, words),
        _ => png::write_with(path, width, height, rgb, words),
    }
}

/// Whether each of the formats has room for a picture of that size [pixels]: to be asked before the expensive work.
///
/// # Errors
/// Those of [`jpeg::check_size`].
pub fn check_size(formats: &[Format], size: [u32; 2]) -> Result<()> {
    match formats.contains(&Format::Jpeg) {
        true => jpeg::check_size(size),
        false => Ok(()),
    }
}

/// The key that the file of a picture holds; nothing where there is no file, or one without a key, or (EXR, PNG and JPEG) one that is cut off.
pub fn key_of(path: &Path, format: Format) -> Option<String> {
    let read = match format {
        Format::Exr => exr::words(path, KEY),
        Format::Hdr => hdr::key(path),
        Format::Png => png::words(path, KEY),
        Format::Jpeg => jpeg::words(path, KEY),
    };
    read.ok().flatten()
}
