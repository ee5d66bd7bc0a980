//! The values of sensors as an OpenEXR file: a part a plane, a pixel a cell, a channel a quantity.
//!
//! Channels have the names of the columns of tables, units in them, and 32-bit numbers. Cells without a sensor are NaN. The upper row is the last one
//! of the plane (of floors what lies farthest toward -Z), columns run along its `u`. Attributes of each part tell where it lies in scene axes:
//! `tyndall:origin` [m], the corner from which cells count, `tyndall:u` and `tyndall:v`, unit vectors along columns and from row to row, and
//! `tyndall:step`, the distances between columns and rows [m].

use super::grid::Sensors;
use crate::error::Result;
use crate::output::{atomic, exr::SOFTWARE};
use ::exr::error::Error as ExrError;
use ::exr::image::write::WritableImage;
use ::exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use ::exr::math::Vec2;
use ::exr::meta::attribute::{AttributeValue, IntegerBounds, Text};
use ::exr::meta::header::{ImageAttributes, LayerAttributes};
use glam::DVec3;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes it; each column has a value for each sensor.
///
/// # Errors
/// [`crate::Error::File`] when the file cannot be written.
pub fn write(path: &Path, sensors: &Sensors, columns: &[(String, Vec<f64>)]) -> Result<()> {
    // Names are UTF-8, as OpenEXR's own library takes them.
    let text = |words: &str| Text::from_slice_unchecked(words.as_bytes());
    let layer = |number: usize| {
        let plane = &sensors.planes[number];
        let [width, height] = plane.cells.map(|count| count as usize);
        let channels = columns.iter().map(|(name, values)| {
            let mut pixels = vec![f32::NAN; width * height];
            let own = sensors.points.iter().zip(values);
            for (sensor, value) in own.filter(|(sensor, _)| sensor.plane == number) {
                let [column, row] = sensor.cell.map(|at| at as usize);
                pixels[(height - 1 - row) * width + column] = *value as f32;
            }
            AnyChannel::new(text(name), FlatSamples::F32(pixels))
        });
        let mut attributes = LayerAttributes {
            software_name: Some(text(SOFTWARE)),
            ..LayerAttributes::named(text(&plane.name))
        };
        let vector = |v: DVec3| AttributeValue::FloatVec3((v.x as f32, v.y as f32, v.z as f32));
        let [step_u, step_v] = plane.step.map(|step| step as f32);
        let places = [
            ("origin", vector(plane.origin)),
            ("u", vector(plane.u)),
            ("v", vector(plane.v)),
            ("step", AttributeValue::FloatVec2(Vec2(step_u, step_v))),
        ];
        let places = places.map(|(name, value)| (text(&format!("tyndall:{name}")), value));
        attributes.other.extend(places);
        let channels = AnyChannels::sort(channels.collect());
        Layer::new(
            (width, height),
            attributes,
            Encoding::FAST_LOSSLESS,
            channels,
        )
    };
    let layers: Vec<_> = (0..sensors.planes.len()).map(layer).collect();
    let most = |of: &dyn Fn(Vec2<usize>) -> usize| {
        let sizes = layers.iter().map(|layer| of(layer.size));
        sizes.max().unwrap_or(1)
    };
    let window = Vec2(most(&|size| size.0), most(&|size| size.1));
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions(window));
    let image = Image::from_layers(attributes, layers);
    atomic::write(path, |file| {
        let mut buffered = BufWriter::new(file);
        let written = image.write().to_buffered(&mut buffered);
        written.map_err(|e| match e {
            ExrError::Io(e) => e,
            e => io::Error::other(e),
        })?;
        buffered.flush()
    })
}
