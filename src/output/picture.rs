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
            let write = match format {
                Format::Png => png::write_with,
                _ => jpeg::write,
            };
            write(path, frame.width, frame.height, &bytes, words)
        }
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
