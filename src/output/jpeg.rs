//! The picture as a screen shows it, in a JPEG: 8 bits, sRGB, as readers take a JPEG without a profile.
//!
//! Quality 95 with full resolution of colour: a few kilobytes more than usual, and no fringes at the edges of shafts. What is to be
//! measured or worked on is better read from a PNG or an EXR.

use super::atomic;
use crate::error::{Error, Result};
use jpeg_encoder::{ColorType, Encoder, EncodingError, SamplingFactor};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Longest side that the format has room for [pixels].
const LONGEST: u32 = 65_535;

/// The application segment that holds words of the picture's own; no program is known to use it.
const SEGMENT: u8 = 9;

/// Whether the format has room for a picture of that size [pixels].
///
/// # Errors
/// [`Error::Domain`] for a side of more than 65 535 pixels.
pub fn check_size([width, height]: [u32; 2]) -> Result<()> {
    let longest = width.max(height);
    if longest <= LONGEST {
        return Ok(());
    }
    Err(Error::domain(
        "a side of a JPEG",
        format!("{longest} pixels"),
        format!("1 to {LONGEST}"),
        "write a PNG",
    ))
}

/// Writes `rgb`, three bytes a pixel from the top left, with words of the picture's own by their names, in application segments.
///
/// # Errors
/// [`Error::Domain`] for a side of more than 65 535 pixels; [`Error::File`] when the file cannot be written or `rgb` is not
/// `3 * width * height` long.
pub fn write(
    path: &Path,
    width: u32,
    height: u32,
    rgb: &[u8],
    words: &[(&str, &str)],
) -> Result<()> {
    check_size([width, height])?;
    let [width, height] = [width, height].map(|side| side as u16);
    let fill = |file: &mut File| {
        let mut buffered = BufWriter::new(file);
        let mut encoder = Encoder::new(&mut buffered, 95);
        encoder.set_sampling_factor(SamplingFactor::R_4_4_4);
        encoder.set_optimized_huffman_tables(true);
        for (name, words) in words {
            let segment = format!("{name}\0{words}").into_bytes();
            encoder.add_app_segment(SEGMENT, segment).map_err(broken)?;
        }
        encoder
            .encode(rgb, width, height, ColorType::Rgb)
            .map_err(broken)?;
        buffered.flush()
    };
    atomic::write(path, fill)
}

fn broken(error: EncodingError) -> io::Error {
    match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other.to_string()),
    }
}

/// What a JPEG that is whole says under `name` in a segment of [`write`]; nothing for a file that is cut off or no JPEG.
pub(super) fn words(path: &Path, name: &str) -> io::Result<Option<String>> {
    let mut file = BufReader::new(File::open(path)?);
    let mut end = [0; 2];
    file.seek(SeekFrom::End(-2))?;
    file.read_exact(&mut end)?;
    file.rewind()?;
    let mut start = [0; 2];
    file.read_exact(&mut start)?;
    if start != [0xff, 0xd8] || end != [0xff, 0xd9] {
        return Ok(None);
    }
    loop {
        let mut head = [0; 4];
        file.read_exact(&mut head)?;
        let [mark, kind, high, low] = head;
        // The first that is not of an application: tables, then the picture.
        if mark != 0xff || !(0xe0..=0xef).contains(&kind) {
            return Ok(None);
        }
        let length = usize::from(u16::from_be_bytes([high, low])).saturating_sub(2);
        let mut segment = vec![0; length];
        file.read_exact(&mut segment)?;
        let text = String::from_utf8(segment).unwrap_or_default();
        if kind == 0xe0 + SEGMENT
            && let Some((found, words)) = text.split_once('\0')
            && found == name
        {
            return Ok(Some(words.to_owned()));
        }
    }
}
