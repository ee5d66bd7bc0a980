//! The picture as a screen shows it: 8 bits, tagged as sRGB.

use super::atomic;
use crate::colour::display;
use crate::error::Result;
use crate::frame::Frame;
use glam::DVec3;
use rayon::prelude::*;
use std::fs::File;
use std::io::{BufReader, BufWriter, Error, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Writes `rgb`, three bytes a pixel from the top left, as sRGB (IEC 61966-2-1).
///
/// # Errors
/// [`crate::Error::File`] when the file cannot be written or `rgb` is not `3 * width * height` long.
pub fn write(path: &Path, width: u32, height: u32, rgb: &[u8]) -> Result<()> {
    write_with(path, width, height, rgb, &[])
}

/// The same with words of the picture's own, by their names (Latin-1), in chunks `tEXt`.
///
/// # Errors
/// Those of [`write`].
pub fn write_with(
    path: &Path,
    width: u32,
    height: u32,
    rgb: &[u8],
    words: &[(&str, &str)],
) -> Result<()> {
    atomic::write(path, |file| {
        let mut buffered = BufWriter::new(file);
        write_to(&mut buffered, width, height, rgb, words)?;
        buffered.flush()
    })
}

/// Writes the bytes of the file.
///
/// # Errors
/// Where they cannot be written, or `rgb` is not `3 * width * height` long.
pub(super) fn write_to(
    out: &mut impl Write,
    width: u32,
    height: u32,
    rgb: &[u8],
    words: &[(&str, &str)],
) -> std::io::Result<()> {
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.add_text_chunk("Software".into(), super::exr::SOFTWARE.into())?;
    for (name, words) in words {
        encoder.add_text_chunk((*name).into(), (*words).into())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb).map_err(Error::from)?;
    writer.finish().map_err(Error::from)
}

/// What a PNG that is whole says under `name` in a chunk `tEXt`; nothing for a file that is cut off or no PNG.
pub(super) fn words(path: &Path, name: &str) -> std::io::Result<Option<String>> {
    const END: [u8; 12] = *b"\0\0\0\0IEND\xaeB`\x82";
    let mut file = BufReader::new(File::open(path)?);
    let mut end = [0; END.len()];
    file.seek(SeekFrom::End(-(END.len() as i64)))?;
    file.read_exact(&mut end)?;
    file.rewind()?;
    let reader = png::Decoder::new(file).read_info().map_err(Error::other)?;
    let mut all = reader.info().uncompressed_latin1_text.iter();
    let found = all.find(|chunk| chunk.keyword == name && end == END);
    Ok(found.map(|chunk| chunk.text.clone()))
}

/// The bytes of a picture: each pixel through exposure, display transform and dither ([`display`]).
///
/// Where a pixel holds colours of very different brightness ([`Frame::shares`]) the mean is taken of what is shown of each, as light
/// of the display: an edge is in proportion to what it covers, however bright one of its sides is.
pub fn encode(frame: &Frame, ev100: f64) -> Vec<u8> {
    let width = frame.width as usize;
    let mut bytes = vec![0; 3 * frame.pixels()];
    bytes
        .par_chunks_exact_mut(3)
        .enumerate()
        .for_each(|(pixel, out)| {
            let at = [pixel % width, pixel / width].map(|n| n as u32);
            let shown = |(share, colour)| share * display::display(colour, ev100);
            let light: DVec3 = frame.shares(pixel).map(shown).sum();
            out.copy_from_slice(&display::codes(light, at, true));
        });
    bytes
}
