//! The film encoder that is built in: the kept crate `rusty_h264` (BSD-2) in the boxes of [`mp4`](super::mp4).
//!
//! Constrained baseline, 4:2:0 in 8 bits, a constant quantiser, a key frame every two seconds. One frame is in memory at a time.

use super::frames::{self, Frames, Rate, even};
use super::mp4::Index;
use crate::error::{Error, Result};
use crate::output::atomic;
use crate::task::Task;
use rayon::prelude::*;
use rusty_h264_common::nal::{NalUnit, NalUnitType, emulation_prevent_into};
use rusty_h264_common::{BitReader, BitWriter, YuvFrame};
use rusty_h264_encoder::{Encoder, EncoderConfig, Sps};
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Of 0 to 51; steps of the coefficients are three codes wide. Most of the error that is left is that of 4:2:0.
const QUANTISER: u8 = 13;

/// The most squares of 16 pixels a frame, that of H.264's level 5.2: beyond it no browser plays.
const MOST_BLOCKS: u32 = 36_864;

/// Makes a film.
///
/// # Errors
/// [`Error::Domain`] for frames of more than 9.4 million pixels; those of reading the frames and writing the file; [`Error::Stopped`].
pub fn write(path: &Path, frames: &Frames, size: [u32; 2], rate: Rate, task: Task) -> Result<()> {
    let [width, height] = size.map(even);
    if width.div_ceil(16).saturating_mul(height.div_ceil(16)) > MOST_BLOCKS {
        return Err(Error::domain(
            "the size of the film's frames",
            format!("{} x {} pixels", size[0], size[1]),
            "at most 9.4 million pixels, such as 4096 x 2304, for the encoder that is built in",
            "install ffmpeg, or make smaller frames",
        ));
    }
    let mut configuration = EncoderConfig::baseline(width as usize, height as usize);
    configuration.qp = QUANTISER;
    configuration.gop_size = (2.0 * rate.per_second()).round().max(1.0) as u32;
    configuration.min_keyint = configuration.gop_size;
    let failed = |e: &dyn std::fmt::Display| {
        Error::failed(
            format!("the film could not be encoded: {e}"),
            "install ffmpeg, which is used where it is found",
        )
    };
    let mut encoder = Encoder::new(configuration).map_err(|e| failed(&e))?;
    let sequence = tagged(encoder.config());
    let keys = frames
        .count()
        .div_ceil(u64::from(encoder.config().gop_size));
    let mut coded = |frame: PathBuf| {
        task.check()?;
        let yuv = converted(&frames::read_pixels(&frame, size)?, size);
        encoder.try_encode(&yuv).map_err(|e| failed(&e))
    };
    atomic::write_by_name(path, |aside| {
        let wrong = |e| Error::writing(path, e);
        let file = File::options().write(true).open(aside).map_err(wrong)?;
        let mut paths = frames.paths();
        let first = paths
            .next()
            .map(&mut coded)
            .transpose()?
            .unwrap_or_default();
        let picture = units(&first).find(|unit| kind(unit) == Some(NalUnitType::Pps));
        let begun = Film {
            file: BufWriter::with_capacity(1 << 20, file),
            size: [width, height],
            rate,
            sequence,
            picture: picture.unwrap_or_default().to_vec(),
            lengths: vec![0; frames.count() as usize],
            keys: vec![0; keys as usize],
            room: 0,
        };
        let mut film = begun.with_room().map_err(wrong)?;
        film.add(&first).map_err(wrong)?;
        for (number, frame) in paths.enumerate() {
            task.tell((number + 1) as f64 / frames.count() as f64);
            film.add(&coded(frame)?).map_err(wrong)?;
        }
        film.end().map_err(wrong)
    })
}

/// A file that grows frame by frame behind the room for its index.
struct Film {
    file: BufWriter<File>,
    size: [u32; 2],
    rate: Rate,
    sequence: Vec<u8>,
    picture: Vec<u8>,
    lengths: Vec<u32>,
    keys: Vec<u32>,
    room: usize,
}

impl Film {
    /// Leaves room for the index of as many frames and key frames as it has tables for, and empties those.
    fn with_room(mut self) -> io::Result<Self> {
        self.room = self.index().bytes().len();
        self.file.seek(SeekFrom::Start(self.room as u64))?;
        self.lengths.clear();
        self.keys.clear();
        Ok(self)
    }

    fn index(&self) -> Index<'_> {
        Index {
            size: self.size,
            rate: self.rate,
            sequence: &self.sequence,
            picture: &self.picture,
            lengths: &self.lengths,
            keys: &self.keys,
        }
    }

    /// Appends a frame: its units, each after its length; the parameter sets stand in the index.
    fn add(&mut self, coded: &[u8]) -> io::Result<()> {
        let mut length = 0;
        let mut key = false;
        for unit in units(coded) {
            match kind(unit) {
                Some(NalUnitType::Sps | NalUnitType::Pps) | None => continue,
                Some(NalUnitType::IdrSlice) => key = true,
                Some(_) => {}
            }
            self.file.write_all(&(unit.len() as u32).to_be_bytes())?;
            self.file.write_all(unit)?;
            length += 4 + unit.len() as u32;
        }
        self.lengths.push(length);
        if key {
            self.keys.push(self.lengths.len() as u32);
        }
        Ok(())
    }

    /// Writes the index.
    fn end(mut self) -> io::Result<()> {
        let bytes = self.index().bytes();
        if bytes.len() != self.room {
            return Err(io::Error::other(
                "the encoder's key frames are not where they should be",
            ));
        }
        self.file.seek(SeekFrom::Start(0))?;
        self.file.write_all(&bytes)?;
        self.file.flush()
    }
}

/// The units of a stream, between start codes of three or four bytes.
fn units(stream: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = stream;
    std::iter::from_fn(move || {
        let code = |bytes: &[u8]| bytes.windows(3).position(|w| w == [0, 0, 1]);
        rest = &rest[code(rest)? + 3..];
        let end = code(rest).unwrap_or(rest.len());
        let unit = &rest[..end];
        rest = &rest[end..];
        // The first zero of a code of four bytes; no unit ends in one.
        Some(unit.strip_suffix(&[0]).unwrap_or(unit))
    })
}

fn kind(unit: &[u8]) -> Option<NalUnitType> {
    unit.first().map(|&header| NalUnitType::from_id(header))
}

/// The sequence parameter set with what the encoder leaves out (ITU-T H.264, annex E): that colours are BT.709 in limited range, and that
/// no frame waits for another.
fn tagged(configuration: &EncoderConfig) -> Vec<u8> {
    let plain: NalUnit = Sps::from_config(configuration).to_nal();
    // The last bit that is set ends the set; the one before it says that nothing more was said.
    let bits = 8 * plain.rbsp.len() - plain.rbsp.last().map_or(0, |b| b.trailing_zeros() as usize);
    let mut reader = BitReader::new(&plain.rbsp);
    let mut writer = BitWriter::new();
    for _ in 0..bits.saturating_sub(2) {
        writer.write_bit(reader.read_bit().unwrap_or(false));
    }
    writer.write_bit(true);
    // Neither an aspect ratio nor an overscan.
    writer.write_bits(0, 2);
    // A video signal of no particular system, limited, with its colours: primaries, transfer, matrix.
    writer.write_bit(true);
    writer.write_bits(5, 3);
    writer.write_bit(false);
    writer.write_bit(true);
    for _ in 0..3 {
        writer.write_bits(1, 8);
    }
    // No place of chroma but the usual, no clock, no two buffers of a receiver, no structure of pictures.
    writer.write_bits(0, 5);
    // Bounds: vectors may leave the picture; bytes, bits and lengths of vectors are not bounded; none is reordered.
    writer.write_bit(true);
    writer.write_bit(true);
    for number in [0, 0, 15, 15, 0, configuration.num_ref_frames.max(1)] {
        writer.write_ue(number);
    }
    writer.rbsp_trailing_bits();
    let mut unit = vec![plain.header_byte()];
    emulation_prevent_into(&writer.into_bytes(), &mut unit);
    unit
}

/// A frame in Y'CbCr: BT.709, limited range, 4:2:0 with chroma between two rows and on even columns, as H.264 takes it; sides that are odd
/// get the last column or row twice.
fn converted(rgb: &[u8], [width, height]: [u32; 2]) -> YuvFrame {
    let (w, h) = (width as usize, height as usize);
    let (wide, high) = (even(width) as usize, even(height) as usize);
    let pixel = |x: usize, y: usize| -> [f64; 3] {
        let at = 3 * (y.min(h - 1) * w + x.min(w - 1));
        [0, 1, 2].map(|c| f64::from(rgb[at + c]) / 255.0)
    };
    let luma = |[r, g, b]: [f64; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let mut frame = YuvFrame::black(wide, high);
    let code = |value: f64| value.round().clamp(1.0, 254.0) as u8;
    let rows = frame.y.par_chunks_exact_mut(wide).enumerate();
    rows.for_each(|(y, row)| {
        for (x, out) in row.iter_mut().enumerate() {
            *out = code(16.0 + 219.0 * luma(pixel(x, y)));
        }
    });
    let u = frame.u.par_chunks_exact_mut(wide / 2);
    let rows = u.zip(frame.v.par_chunks_exact_mut(wide / 2)).enumerate();
    rows.for_each(|(row, (u, v))| {
        for x in 0..wide / 2 {
            let mut mean = [0.0; 3];
            for (column, weight) in [(2 * x).saturating_sub(1), 2 * x, 2 * x + 1]
                .into_iter()
                .zip([0.125, 0.25, 0.125])
            {
                for y in [2 * row, 2 * row + 1] {
                    for (sum, value) in mean.iter_mut().zip(pixel(column, y)) {
                        *sum += weight * value;
                    }
                }
            }
            let y = luma(mean);
            u[x] = code(128.0 + 224.0 * (mean[2] - y) / 1.8556);
            v[x] = code(128.0 + 224.0 * (mean[0] - y) / 1.5748);
        }
    });
    frame
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_bt_709() {
        // White, black, and the primaries of ITU-R BT.709-6, table 4, in 8 bits.
        for (rgb, yuv) in [
            ([255, 255, 255], [235, 128, 128]),
            ([0, 0, 0], [16, 128, 128]),
            ([255, 0, 0], [63, 102, 240]),
            ([0, 255, 0], [173, 42, 26]),
            ([0, 0, 255], [32, 240, 118]),
        ] {
            let frame = converted(&rgb.repeat(15), [5, 3]);
            assert_eq!((frame.width, frame.height), (6, 4));
            assert!(frame.y.iter().all(|&y| y == yuv[0]), "{rgb:?}");
            assert!(
                frame.u.iter().all(|&u| u == yuv[1]),
                "{rgb:?}: {}",
                frame.u[0]
            );
            assert!(
                frame.v.iter().all(|&v| v == yuv[2]),
                "{rgb:?}: {}",
                frame.v[0]
            );
        }
    }

    #[test]
    fn odd_sides_repeat_their_last_pixels() {
        let rgb: Vec<u8> = (0..15).flat_map(|i| [16 * i as u8; 3]).collect();
        let frame = converted(&rgb, [5, 3]);
        for y in 0..4 {
            assert_eq!(frame.y[6 * y + 5], frame.y[6 * y + 4]);
        }
        assert_eq!(frame.y[18..], frame.y[12..18]);
        assert!(frame.y[0] < frame.y[1] && frame.y[6] > frame.y[5]);
    }

    #[test]
    fn a_stream_falls_into_its_units() {
        let stream = [
            0, 0, 0, 1, 0x67, 5, 0, 0, 1, 0x68, 7, 8, 0, 0, 0, 1, 0x65, 9,
        ];
        let found: Vec<_> = units(&stream).collect();
        assert_eq!(found, [&[0x67, 5][..], &[0x68, 7, 8], &[0x65, 9]]);
        assert_eq!(kind(found[2]), Some(NalUnitType::IdrSlice));
        assert_eq!(units(&[]).count(), 0);
    }

    #[test]
    fn the_sequence_says_its_colours() {
        let configuration = EncoderConfig::baseline(320, 180);
        let plain = Sps::from_config(&configuration).to_nal();
        let unit = tagged(&configuration);
        assert_eq!(unit[0], 0x67);
        let payload = rusty_h264_common::nal::emulation_unprevent(&unit[1..]);
        // As far as the flag nothing changes, and the flag is set.
        let mut old = BitReader::new(&plain.rbsp);
        let mut new = BitReader::new(&payload);
        let last = 8 * plain.rbsp.len() - plain.rbsp.last().unwrap().trailing_zeros() as usize - 2;
        for _ in 0..last {
            assert_eq!(old.read_bit().unwrap(), new.read_bit().unwrap());
        }
        assert!(!old.read_bit().unwrap() && new.read_bit().unwrap());
        assert_eq!(new.read_bits(2).unwrap(), 0);
        assert_eq!(new.read_bits(6).unwrap(), 0b11_0101);
        assert_eq!(new.read_bits(24).unwrap(), 0x01_01_01);
        assert_eq!(new.read_bits(7).unwrap(), 0b000_0011);
        let bounds: Vec<_> = (0..6).map(|_| new.read_ue().unwrap()).collect();
        assert_eq!(bounds, [0, 0, 15, 15, 0, 1]);
        assert!(new.read_bit().unwrap());
    }
}
