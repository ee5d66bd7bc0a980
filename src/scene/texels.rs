//! Pictures as texels: PNG and JPEG, decoded to eight bits in each of red, green, blue and opacity.

use png::{BitDepth, ColorType, Transformations};
use std::io::Cursor;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// A picture, row by row from the top left.
pub(crate) struct Texels {
    pub width: u32,
    pub height: u32,
    /// Codes as the file has them: red, green, blue, opacity.
    pub pixels: Vec<[u8; 4]>,
}

/// Decodes a picture of at most `most` texels; the error says what is wrong with it.
///
/// Decoders of other people's formats may panic on damaged files; that must not end the caller.
pub(crate) fn decode(bytes: &[u8], most: u64) -> Result<Texels, String> {
    let decode = || match bytes {
        [0x89, b'P', b'N', b'G', ..] => decode_png(bytes, most),
        [0xff, 0xd8, 0xff, ..] => decode_jpeg(bytes, most),
        _ => Err("it is neither PNG nor JPEG".to_owned()),
    };
    let picture = std::panic::catch_unwind(decode)
        .unwrap_or_else(|_| Err("the picture is damaged".to_owned()))?;
    match picture.pixels.is_empty() {
        true => Err("the picture has no pixels".to_owned()),
        false => Ok(picture),
    }
}

fn check_size(width: u64, height: u64, most: u64) -> Result<(), String> {
    match width * height > most {
        true => Err(format!("{width} x {height} pixels are more than {most}")),
        false => Ok(()),
    }
}

fn decode_png(bytes: &[u8], most: u64) -> Result<Texels, String> {
    // Sixteen bits in each of four channels, once.
    let limits = png::Limits {
        bytes: usize::try_from(most.saturating_mul(8)).unwrap_or(usize::MAX),
    };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::EXPAND | Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let (width, height) = reader.info().size();
    check_size(width.into(), height.into(), most)?;
    let (color, depth) = reader.output_color_type();
    let size = reader.output_buffer_size();
    let mut codes = vec![0; size.ok_or("it is larger than memory")?];
    reader.next_frame(&mut codes).map_err(|e| e.to_string())?;
    if depth == BitDepth::Sixteen {
        let wide = codes.as_chunks().0.iter().map(|c| u16::from_be_bytes(*c));
        // To the nearest: 257 is 0xffff over 0xff.
        codes = wide.map(|c| ((u32::from(c) + 128) / 257) as u8).collect();
    }
    let pixels = match color {
        ColorType::Rgba => codes.as_chunks().0.to_vec(),
        ColorType::GrayscaleAlpha => {
            let pairs = codes.as_chunks().0.iter();
            pairs.map(|[gray, a]| [*gray, *gray, *gray, *a]).collect()
        }
        other => return Err(format!("it has channels that are not read ({other:?})")),
    };
    Ok(Texels {
        width,
        height,
        pixels,
    })
}

fn decode_jpeg(bytes: &[u8], most: u64) -> Result<Texels, String> {
    // A side has sixteen bits; strict decoders refuse files that every program shows.
    let options = DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|e| e.to_string())?;
    let (width, height) = decoder.dimensions().ok_or("it has no header")?;
    check_size(width as u64, height as u64, most)?;
    let codes = decoder.decode().map_err(|e| e.to_string())?;
    let opaque = |[r, g, b]: &[u8; 3]| [*r, *g, *b, u8::MAX];
    Ok(Texels {
        width: width as u32,
        height: height as u32,
        pixels: codes.as_chunks().0.iter().map(opaque).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::Engine;
    use base64::prelude::BASE64_STANDARD;

    /// By ffmpeg: 16 x 8, the left half (200, 90, 30), the right one (30, 60, 210); and 40 and 220 in one channel.
    const COLOUR: &str = "/9j//gAPTGF2YzYxLjMuMTAwAP/bAEMACAQEBAQEBQUFBQUFBgYGBgYGBgYGBgYGBgcHBwgICAcHBwYGBwcICAgICQkJCAgICAkJCgoKDAwLCw4ODhERFP/EAE8AAQEBAAAAAAAAAAAAAAAAAAAEBgEBAQEBAAAAAAAAAAAAAAAAAAYHCBABAAAAAAAAAAAAAAAAAAAAABEBAAAAAAAAAAAAAAAAAAAAAP/AABEIAAgAEAMBEgACEgADEgD/2gAMAwEAAhEDEQA/AIxHC8GPHQIygf/Z";
    const GREY: &str = "/9j//gAPTGF2YzYxLjMuMTAwAP/bAEMACAQEBAQEBQUFBQUFBgYGBgYGBgYGBgYGBgcHBwgICAcHBwYGBwcICAgICQkJCAgICAkJCgoKDAwLCw4ODhERFP/EAEwAAQEBAAAAAAAAAAAAAAAAAAAHCAEBAAAAAAAAAAAAAAAAAAAAABABAAAAAAAAAAAAAAAAAAAAABEBAAAAAAAAAAAAAAAAAAAAAP/AABEIAAgAEAMBEgACEgADEgD/2gAMAwEAAhEDEQA/AJOADWgAP//Z";

    fn png(color: ColorType, depth: BitDepth, size: [u32; 2], codes: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![10, 20, 30, 40, 50, 60]);
            encoder.set_trns(vec![255, 7]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(codes).unwrap();
        writer.finish().unwrap();
        bytes
    }

    fn pixels(bytes: &[u8]) -> Vec<[u8; 4]> {
        decode(bytes, 1000).unwrap().pixels
    }

    #[test]
    fn every_kind_of_png_is_red_green_blue_and_opacity() {
        use {BitDepth::*, ColorType::*};
        let of = |color, depth, width, codes: &[u8]| pixels(&png(color, depth, [width, 1], codes));
        let opaque = |codes: &[u8]| codes.iter().map(|c| [*c, *c, *c, 255]).collect::<Vec<_>>();
        assert_eq!(of(Rgb, Eight, 1, &[1, 2, 3]), [[1, 2, 3, 255]]);
        assert_eq!(of(Rgba, Eight, 1, &[1, 2, 3, 4]), [[1, 2, 3, 4]]);
        assert_eq!(of(Grayscale, One, 3, &[0b0100_0000]), opaque(&[0, 255, 0]));
        assert_eq!(of(Grayscale, Four, 2, &[0x0f]), opaque(&[0, 255]));
        assert_eq!(of(GrayscaleAlpha, Eight, 1, &[9, 8]), [[9, 9, 9, 8]]);
        assert_eq!(
            of(Indexed, Eight, 2, &[0, 1]),
            [[10, 20, 30, 255], [40, 50, 60, 7]]
        );
        // Sixteen bits go to the nearest of eight: 0x00ff is 0.99 of them.
        let wide = [0x80, 0xff, 0xff, 0xff, 0x00, 0xff];
        assert_eq!(of(Rgb, Sixteen, 1, &wide), [[128, 255, 1, 255]]);
        assert_eq!(
            of(GrayscaleAlpha, Sixteen, 1, &wide[..4]),
            [[128, 128, 128, 255]]
        );
    }

    #[test]
    fn a_jpeg_is_what_its_encoder_was_given() {
        let read = |text| decode(&BASE64_STANDARD.decode(text).unwrap(), 1000).unwrap();
        for (text, left, right) in [
            (COLOUR, [200, 90, 30, 255], [30, 60, 210, 255]),
            (GREY, [40, 40, 40, 255], [220, 220, 220, 255]),
        ] {
            let picture = read(text);
            assert_eq!((picture.width, picture.height), (16, 8));
            for (i, pixel) in picture.pixels.iter().enumerate() {
                let expected = if i % 16 < 8 { left } else { right };
                let far = (0..4).map(|c| pixel[c].abs_diff(expected[c])).max();
                assert!(far <= Some(4), "{i}: {pixel:?}");
            }
        }
    }

    #[test]
    fn what_is_no_picture_is_said() {
        let problem = |bytes: &[u8], most| decode(bytes, most).err().unwrap();
        let good = png(ColorType::Rgb, BitDepth::Eight, [3, 2], &[0; 18]);
        assert!(decode(&good, 6).is_ok());
        assert_eq!(problem(&good, 5), "3 x 2 pixels are more than 5");
        let jpeg = BASE64_STANDARD.decode(COLOUR).unwrap();
        assert_eq!(problem(&jpeg, 127), "16 x 8 pixels are more than 127");
        assert_eq!(problem(b"GIF89a", 10), "it is neither PNG nor JPEG");
        assert_eq!(problem(b"", 10), "it is neither PNG nor JPEG");
        assert!(!problem(&good[..40], 10).is_empty());
        assert!(!problem(&jpeg[..60], 1000).is_empty());
    }
}
