//! The picture in Radiance's RGBE format: one exponent for three 8-bit mantissas, 1 % steps, no negative values.
//!
//! Radiance holds radiance [W/(sr m2)] and takes 179 lm/W for white light whatever its spectrum; luminances are
//! divided by that, so that its own programs show the cd/m2 of the EXR, unless [`super::Numbers`] say otherwise.
//! Source: G. Ward, "Real pixels", Graphics Gems II (1991); Radiance file formats.

use super::{OutputSpace, Units, atomic};
use crate::error::Result;
use crate::frame::{Frame, Value};
use rayon::prelude::*;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, ErrorKind, Read, Write};
use std::ops::Range;
use std::path::Path;

/// Writes the picture in `space`; what lies outside its gamut is cut off at zero, which is all that the format holds.
///
/// # Errors
/// Those of [`Frame::check`]; [`crate::Error::File`] when the file cannot be written.
pub fn write(path: &Path, frame: &Frame, space: &OutputSpace) -> Result<()> {
    frame.check()?;
    atomic::write(path, |file| {
        let mut out = BufWriter::new(file);
        let [red, green, blue] = space.primaries;
        write!(out, "#?RADIANCE\nSOFTWARE={}\n", super::exr::SOFTWARE)?;
        write!(out, "PRIMARIES=")?;
        for xy in [red, green, blue, space.white] {
            write!(out, " {:.4} {:.4}", xy.x, xy.y)?;
        }
        if let Some(Value::Text(key)) = frame.record.get("key") {
            write!(out, "\n{KEY}={key}")?;
        }
        write!(out, "\nFORMAT=32-bit_rle_rgbe\n\n")?;
        writeln!(out, "-Y {} +X {}", frame.height, frame.width)?;
        let width = frame.width as usize;
        // Rows are encoded on all cores, as many at once as stay small.
        const ROWS: usize = 64;
        let rows: Vec<usize> = (0..frame.height as usize).collect();
        for rows in rows.chunks(ROWS) {
            let encoded: Vec<Vec<u8>> = rows
                .par_iter()
                .map(|y| {
                    let texels = (y * width..(y + 1) * width).map(|i| {
                        let colour = space.colour(Units::Radiance, frame.picture(i));
                        rgbe(colour.to_array())
                    });
                    encoded_row(&texels.collect::<Vec<_>>())
                })
                .collect();
            encoded.iter().try_for_each(|row| out.write_all(row))?;
        }
        out.flush()
    })
}

/// The key of the picture's record, if it has one.
const KEY: &str = "TYNDALL_KEY";

/// The key that an HDR of [`write`] holds; nothing for a file that is cut off, goes on behind its rows, or is none of those.
pub(super) fn key(path: &Path) -> io::Result<Option<String>> {
    let mut file = BufReader::new(File::open(path)?);
    let mut key = None;
    // A header is short; another file may have no line at all.
    for line in file.by_ref().take(4096).split(b'\n') {
        let line = String::from_utf8(line?).unwrap_or_default();
        if let Some(words) = line.strip_prefix(KEY) {
            key = words.strip_prefix('=').map(str::to_owned);
        }
        let size = line
            .strip_prefix("-Y ")
            .and_then(|size| size.split_once(" +X "));
        if let Some((height, width)) = size {
            let whole = match (height.parse(), width.parse()) {
                (Ok(height), Ok(width)) => ends_with_its_rows(&mut file, height, width)?,
                _ => false,
            };
            return Ok(key.filter(|_| whole));
        }
    }
    Ok(None)
}

/// Whether `rows` rows of [`encoded_row`] are what is left of a file.
fn ends_with_its_rows(file: &mut impl BufRead, rows: u64, width: usize) -> io::Result<bool> {
    let skip = |file: &mut dyn BufRead, bytes: u64| {
        let skipped = io::copy(&mut file.take(bytes), &mut io::sink())?;
        match skipped == bytes {
            true => Ok(()),
            false => Err(io::Error::from(ErrorKind::UnexpectedEof)),
        }
    };
    for _ in 0..rows {
        if !IN_RUNS.contains(&width) {
            skip(file, 4 * width as u64)?;
            continue;
        }
        skip(file, 4)?;
        for _ in 0..4 {
            let mut left = width;
            while left > 0 {
                let mut code = [0];
                file.read_exact(&mut code)?;
                let (length, bytes) = match code[0] {
                    run @ 129.. => (usize::from(run) - 128, 1),
                    literal => (usize::from(literal), u64::from(literal)),
                };
                if length == 0 || length > left {
                    return Ok(false);
                }
                skip(file, bytes)?;
                left -= length;
            }
        }
    }
    Ok(file.fill_buf()?.is_empty())
}

/// Mantissas rounded down and the exponent that they share, 128 for a largest component in [0.5, 1).
fn rgbe(rgb: [f64; 3]) -> [u8; 4] {
    let largest = rgb[0].max(rgb[1]).max(rgb[2]);
    if largest < 1e-38 {
        return [0; 4];
    }
    // An f64's own exponent is one less and biased by 1023.
    let exponent = (largest.to_bits() >> 52) as i32 - 1022;
    let scale = f64::from_bits(((1023 + 8 - exponent) as u64) << 52);
    // A float becomes an integer by saturation: what is negative becomes zero.
    let [r, g, b] = rgb.map(|c| (c * scale) as u8);
    [r, g, b, (exponent + 128) as u8]
}

/// How long rows are that are written in runs.
const IN_RUNS: Range<usize> = 8..0x8000;

/// One row, the four components apart, each in runs; rows too short or long for that are written flat.
fn encoded_row(row: &[[u8; 4]]) -> Vec<u8> {
    if !IN_RUNS.contains(&row.len()) {
        return row.concat();
    }
    let length = row.len() as u16;
    let mut out = Vec::with_capacity(2 * row.len());
    out.extend([2, 2, (length >> 8) as u8, length as u8]);
    for component in 0..4 {
        let bytes: Vec<u8> = row.iter().map(|texel| texel[component]).collect();
        let mut rest = &bytes[..];
        while let Some(first) = rest.first() {
            let run = rest.iter().take(127).take_while(|b| *b == first).count();
            if run >= 4 {
                out.extend([128 + run as u8, *first]);
                rest = &rest[run..];
            } else {
                let mut literal = run;
                while literal < rest.len().min(128)
                    && !rest[literal..]
                        .windows(4)
                        .next()
                        .is_some_and(|w| w.iter().all(|b| *b == w[0]))
                {
                    literal += 1;
                }
                out.push(literal as u8);
                out.extend(&rest[..literal]);
                rest = &rest[literal..];
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_exponent_for_three() {
        assert_eq!(rgbe([0.0; 3]), [0; 4]);
        assert_eq!(rgbe([1.0, 0.5, -0.25]), [128, 64, 0, 129]);
        assert_eq!(rgbe([0.999_999, 0.0, 0.0]), [255, 0, 0, 128]);
        // 2^30 exactly, and the float below it.
        assert_eq!(rgbe([1_073_741_824.0, 0.0, 0.0])[3], 128 + 31);
        assert_eq!(rgbe([1_073_741_823.999_999_9, 0.0, 0.0])[3], 128 + 30);
    }
}
