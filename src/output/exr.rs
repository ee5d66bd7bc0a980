//! The picture file: everything that was computed, in numbers, in one OpenEXR part.
//!
//! Scan lines from the top, ZIP16 (PIZ for a map), every channel 32-bit float, since the sun's disc (1.6e9 cd/m2) overflows half.
//!
//! | channels | what |
//! |---|---|
//! | `R` `G` `B` | the picture: the sum of all layers [cd/m2] |
//! | `Z` | distance along the ray [m], 1e10 where nothing is hit; not in maps |
//! | `sun.R`, `indirect.R` ... `inscatter_lights.B` | the layers of [`Field`](crate::frame::Field) [cd/m2] that were asked for; zero where one was not run |
//! | `transmittance.R` `.G` `.B` | share of light that the air lets through |
//! | `normal.X` `.Y` `.Z` | unit normal, scene axes |
//!
//! `chromaticities` match the pixels, `whiteLuminance` is the luminance of RGB 1, 1, 1 (1 cd/m2 unless [`super::Numbers`] say
//! otherwise), and the
//! [`Record`](crate::frame::Record) is in attributes called `tyndall:NAME`.
//! Transmittance is per channel of the working space, not a colour, and is not converted.

use super::{OutputSpace, Units, atomic};
use crate::error::Result;
use crate::frame::{Frame, Value};
use ::exr::block::lines::LineRefMut;
use ::exr::error::Error as ExrError;
use ::exr::image::write::samples::{SamplesWriter, WritableSamples};
use ::exr::math::RoundingMode;
use ::exr::meta::attribute::{
    AttributeValue, Chromaticities, LevelMode, LineOrder, SampleType, Text,
};
use ::exr::meta::header::{Header, LayerAttributes};
use ::exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, Image, Layer, Vec2, WritableImage,
};
use glam::{DVec2, DVec3, Vec3};
use std::cell::RefCell;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// The program, as files name it.
pub const SOFTWARE: &str = concat!("tyndall ", env!("CARGO_PKG_VERSION"));

/// Writes `frame` with those of its layers that `layers` names (see [`super::select_layers`]): of a map, those of colour alone.
///
/// Beside the frame this only needs memory for a few blocks of 16 rows.
///
/// # Errors
/// Those of [`Frame::check`]; [`crate::Error::File`] when the file cannot be written.
pub fn write(
    path: &Path,
    frame: &Frame,
    space: &OutputSpace,
    layers: &[&'static str],
) -> Result<()> {
    frame.check()?;
    let mut image = Image::from_layer(Layer::new(
        (frame.width as usize, frame.height as usize),
        attributes(frame, space),
        Encoding {
            compression: match frame.is_map() {
                // On skies half the time and a fifth smaller; every reader built on OpenEXR takes it.
                true => Compression::PIZ,
                false => Compression::ZIP16,
            },
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        },
        AnyChannels::sort(channels(frame, space, layers).into_iter().collect()),
    ));
    let xy = |v: DVec2| Vec2(v.x as f32, v.y as f32);
    let [red, green, blue] = space.primaries.map(xy);
    image.attributes.chromaticities = Some(Chromaticities {
        red,
        green,
        blue,
        white: xy(space.white),
    });
    atomic::write(path, |file| {
        let mut buffered = BufWriter::new(&mut *file);
        image
            .write()
            .to_buffered(&mut buffered)
            .map_err(|e| match e {
                ExrError::Io(e) => e,
                e => io::Error::other(e),
            })?;
        buffered.flush()?;
        drop(buffered);
        sort_attributes(file)
    })
}

fn attributes(frame: &Frame, space: &OutputSpace) -> LayerAttributes {
    // Names and words are UTF-8, as OpenEXR's own library takes them.
    let text = |words: &str| Text::from_slice_unchecked(words.as_bytes());
    let mut attributes = LayerAttributes {
        // The luminance of RGB 1, 1, 1.
        white_luminance: Some((1.0 / space.per_candela(Units::Photometric)) as f32),
        software_name: Some(text(SOFTWARE)),
        ..LayerAttributes::default()
    };
    let words = |words: &str| AttributeValue::Text(text(words));
    let mut say = |key: &str, value| {
        attributes
            .other
            .insert(text(&format!("tyndall:{key}")), value)
    };
    say("color_space", words(space.name));
    for (key, value) in frame.record.iter() {
        say(
            key,
            match value {
                Value::Text(value) => words(value),
                Value::Number(value) => AttributeValue::F64(*value),
                Value::Matrix(_) => continue,
            },
        );
    }
    // The format's own: points are rows there, so that its rows are our columns.
    let matrix = |key: &str| match frame.record.get(key) {
        Some(Value::Matrix(matrix)) => Some(matrix.map(|number| number as f32)),
        _ => None,
    };
    attributes.world_to_camera = matrix("worldToCamera");
    attributes.world_to_normalized_device = matrix("worldToNDC");
    attributes
}

fn channels<'f>(
    frame: &'f Frame,
    space: &OutputSpace,
    layers: &[&'static str],
) -> Vec<AnyChannel<Samples<'f>>> {
    let mut channels = Vec::new();
    let mut add = |name: String, source| {
        channels.push(AnyChannel {
            name: Text::from_slice_unchecked(name.as_bytes()),
            sample_data: Samples {
                width: frame.width as usize,
                source,
            },
            // Marks hue or alpha for lossy compression; these are neither, whatever their names suggest.
            quantize_linearly: false,
            sampling: Vec2(1, 1),
        });
    };
    let mut add_colour = |prefix: &str, colours: Colours<'f>| {
        let (number, space) = (COLOURS.fetch_add(1, Ordering::Relaxed), *space);
        for (component, letter) in ["R", "G", "B"].into_iter().enumerate() {
            let source = Source::Colour {
                colours,
                space,
                component,
                number,
            };
            add(format!("{prefix}{letter}"), source);
        }
    };
    add_colour("", Colours::Picture(frame));
    let mut plain = Vec::new();
    for &name in layers {
        match (name, frame.layer(name)) {
            ("normal", _) => {}
            (_, Some(layer)) => add_colour(&format!("{name}."), Colours::Layer(&layer.rgb)),
            ("transmittance", None) => plain.push((name, Some(&frame.transmittance))),
            (_, None) => plain.push((name, None)),
        }
    }
    for (name, values) in plain {
        for (component, letter) in ["R", "G", "B"].into_iter().enumerate() {
            let source = match values {
                Some(values) => Source::Component(values, component),
                None => Source::Black,
            };
            add(format!("{name}.{letter}"), source);
        }
    }
    if layers.contains(&"normal") {
        for (component, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
            let source = Source::Component(&frame.normal, component);
            add(format!("normal.{letter}"), source);
        }
    }
    if !frame.is_map() {
        add("Z".into(), Source::Depth(&frame.depth));
    }
    channels
}

/// A channel that is made row by row from the frame while it is written.
#[derive(Clone, Copy)]
struct Samples<'f> {
    width: usize,
    source: Source<'f>,
}

#[derive(Clone, Copy)]
enum Source<'f> {
    /// One of the three numbers of colours, which have a number of their own.
    Colour {
        colours: Colours<'f>,
        space: OutputSpace,
        component: usize,
        number: u64,
    },
    /// A component as it stands.
    Component(&'f [Vec3], usize),
    Depth(&'f [f32]),
    Black,
}

#[derive(Clone, Copy)]
enum Colours<'f> {
    /// The sum of all layers.
    Picture(&'f Frame),
    Layer(&'f [Vec3]),
}

impl Colours<'_> {
    fn at(&self, pixel: usize) -> DVec3 {
        match self {
            Colours::Picture(frame) => frame.picture(pixel),
            Colours::Layer(rgb) => rgb[pixel].as_dvec3(),
        }
    }
}

/// The number of the next colours: no two that are written have the same.
static COLOURS: AtomicU64 = AtomicU64::new(0);

/// A piece of a row as the file has it. The channels of a colour are asked for one after the other, and each is made of all of it.
#[derive(Default)]
struct Row {
    /// Of which colours, from which pixel on.
    of: Option<(u64, usize)>,
    values: Vec<[f32; 3]>,
}

thread_local! {
    static ROW: RefCell<Row> = RefCell::default();
}

impl Row {
    /// Gives `read` the row of colours from a pixel on.
    fn with(
        (colours, space, number): (Colours, &OutputSpace, u64),
        pixels: Range<usize>,
        read: impl FnOnce(&[[f32; 3]]),
    ) {
        ROW.with_borrow_mut(|row| {
            let of = Some((number, pixels.start));
            if row.of != of || row.values.len() != pixels.len() {
                let value = |pixel| {
                    let colour = space.colour(Units::Photometric, colours.at(pixel));
                    colour.as_vec3().to_array()
                };
                row.values.clear();
                row.values.extend(pixels.map(value));
                row.of = of;
            }
            read(&row.values);
        });
    }
}

impl Source<'_> {
    /// Fills in the values of a piece of a row, from a pixel on.
    fn fill(&self, start: usize, out: &mut [f32]) {
        let pixels = start..start + out.len();
        match *self {
            Source::Colour {
                colours,
                ref space,
                component,
                number,
            } => Row::with((colours, space, number), pixels, |row| {
                for (out, colour) in out.iter_mut().zip(row) {
                    *out = colour[component];
                }
            }),
            Source::Component(values, component) => {
                for (out, value) in out.iter_mut().zip(&values[pixels]) {
                    *out = value[component];
                }
            }
            Source::Depth(values) => out.copy_from_slice(&values[pixels]),
            Source::Black => out.fill(0.0),
        }
    }
}

impl<'f> WritableSamples<'_> for Samples<'f> {
    type Writer = Samples<'f>;

    fn sample_type(&self) -> SampleType {
        SampleType::F32
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&self, _: &Header) -> Self::Writer {
        *self
    }
}

impl SamplesWriter for Samples<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let start = line.location.position.y() * self.width + line.location.position.x();
        let mut values = vec![0.0; line.location.sample_count];
        self.source.fill(start, &mut values);
        line.write_samples_from_slice(&values)
            .expect("a line in memory has room for its samples");
    }
}

/// Puts the header's attributes in the order of their names.
///
/// The exr crate keeps our own in a hash map, so that the same picture would give another file every time. The order
/// means nothing to readers, and the header keeps its length.
fn sort_attributes(file: &mut File) -> io::Result<()> {
    file.seek(SeekFrom::Start(MAGIC_AND_VERSION))?;
    let mut attributes = read_attributes(&mut io::BufReader::new(&mut *file))?;
    attributes.sort();
    file.seek(SeekFrom::Start(MAGIC_AND_VERSION))?;
    file.write_all(&attributes.concat())
}

/// Bytes before the first attribute.
const MAGIC_AND_VERSION: u64 = 8;

/// No attribute that is written here is as long [bytes].
const LONGEST_ATTRIBUTE: u32 = 1 << 24;

/// The attributes of a header, each with its name, type and length.
fn read_attributes(reader: &mut impl io::BufRead) -> io::Result<Vec<Vec<u8>>> {
    let mut attributes = Vec::new();
    loop {
        let mut attribute = Vec::new();
        // Name and type end in zero; an attribute without a name ends the header.
        read_name(reader, &mut attribute)?;
        if attribute == [0] {
            return Ok(attributes);
        }
        read_name(reader, &mut attribute)?;
        let mut length = [0; 4];
        reader.read_exact(&mut length)?;
        attribute.extend(length);
        let start = attribute.len();
        let length = u32::from_le_bytes(length);
        if length > LONGEST_ATTRIBUTE {
            return Err(io::ErrorKind::InvalidData.into());
        }
        attribute.resize(start + length as usize, 0);
        reader.read_exact(&mut attribute[start..])?;
        attributes.push(attribute);
    }
}

/// What an EXR that is whole says under `name` in its record, in words; nothing for a file that is cut off or was not written here.
pub(super) fn words(path: &Path, name: &str) -> io::Result<Option<String>> {
    let mut file = io::BufReader::new(File::open(path)?);
    let length = file.get_ref().metadata()?.len();
    file.seek(SeekFrom::Start(MAGIC_AND_VERSION))?;
    let attributes = read_attributes(&mut file)?;
    let head = format!("{name}\0string\0").into_bytes();
    let found = attributes.iter().find(|a| a.starts_with(&head));
    let words = found.and_then(|a| str::from_utf8(&a[head.len() + 4..]).ok());
    Ok(words
        .filter(|_| ends_with_its_last_block(&mut file, length).unwrap_or(false))
        .map(str::to_owned))
}

/// Whether a file ends where its last block does. The table of blocks follows the header, where the reader stands.
fn ends_with_its_last_block(file: &mut (impl Read + Seek), length: u64) -> io::Result<bool> {
    let number = |file: &mut _, bytes: usize| {
        let mut buffer = [0; 8];
        Read::read_exact(file, &mut buffer[..bytes])?;
        io::Result::Ok(u64::from_le_bytes(buffer))
    };
    let table = file.stream_position()?;
    // Blocks stand in the order of the table, the first one behind it.
    let first = number(file, 8)?;
    if first < table + 8 || first > length {
        return Ok(false);
    }
    file.seek(SeekFrom::Start(first - 8))?;
    let last = number(file, 8)?;
    // Before a block stand its first row and its size.
    file.seek(SeekFrom::Start(last + 4))?;
    Ok(number(file, 4)?.saturating_add(last + 8) == length)
}

fn read_name(reader: &mut impl io::BufRead, into: &mut Vec<u8>) -> io::Result<()> {
    reader.read_until(0, into)?;
    match into.last() {
        Some(0) => Ok(()),
        _ => Err(io::ErrorKind::UnexpectedEof.into()),
    }
}
