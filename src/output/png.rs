//! The picture as a screen shows it: 8 bits, tagged as sRGB.

use super::atomic;
use crate::error::Result;
use crate::frame::Frame;
use glam::DVec3;
use rayon::prelude::*;
use std::io::{BufWriter, Error, Write};
use std::path::Path;

/// Writes `rgb`, three bytes a pixel from the top left, as sRGB (IEC 61966-2-1).
///
/// # Errors
/// [`crate::Error::File`] when the file cannot be written or `rgb` is not `3 * width * height` long.
pub fn write(path: &Path, width: u32, height: u32, rgb: &[u8]) -> Result<()> {
    atomic::write(path, |file| {
        let mut buffered = BufWriter::new(file);
        let mut encoder = png::Encoder::new(&mut buffered, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.add_text_chunk("Software".into(), super::exr::SOFTWARE.into())?;
        let mut writer = encoder.write_header()?;
        writer.write_image_data(rgb).map_err(Error::from)?;
        writer.finish()?;
        buffered.flush()
    })
}

/// The bytes of a picture: `encode` makes three of them from a pixel's x, y and its colour in the working space
/// [cd/m2]; exposure, display transform and dither are in there.
pub fn encode(frame: &Frame, encode: impl Fn(u32, u32, DVec3) -> [u8; 3] + Sync) -> Vec<u8> {
    let width = frame.width as usize;
    let mut bytes = vec![0; 3 * frame.pixels()];
    bytes
        .par_chunks_exact_mut(3)
        .enumerate()
        .for_each(|(pixel, out)| {
            let (x, y) = ((pixel % width) as u32, (pixel / width) as u32);
            out.copy_from_slice(&encode(x, y, frame.picture(pixel)));
        });
    bytes
}
