//! What a backend makes: the layers of a picture, and the record of how they came about.
//!
//! Colours are photometric triples in the working space (linear Rec. 2020, D65): their luminance is in cd/m2. Every
//! layer holds what reaches the eye, so the picture is the plain sum of the layers. Rows run from the top, pixels from
//! the left; pixel (x, y) stands at `y * width + x` of every list.

mod field;
mod mixed;

pub use field::{Field, Part};
pub use mixed::{Mixed, Mixture};

use crate::error::{Error, Result};
use crate::memory;
use glam::{DMat4, DVec3, Vec3};
use rayon::prelude::*;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// The depth of a ray that hits nothing [m].
pub const NO_HIT: f32 = 1e10;

/// No radiance is brighter than this [cd/m2]; the sun's disc has 1.6e9. What is above is a defect, and would
/// overflow f32 in sums.
pub const MAX_LUMINANCE: f32 = 1e30;

/// A picture in layers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Frame {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The layers that were made; one that is absent is black.
    pub layers: Vec<Layer>,
    /// Distance along the ray to the surface [m], [`NO_HIT`] where there is none. A map has none of the three lists
    /// from here on.
    pub depth: Vec<f32>,
    /// Unit normal of the surface in scene axes, zero where there is none.
    pub normal: Vec<Vec3>,
    /// Share of light that the air lets through from the surface, or from where the ray leaves all media, to the eye; 0 to 1.
    pub transmittance: Vec<Vec3>,
    /// The pixels whose samples differ much in brightness, for a display ([`Frame::shares`]); none with one sample a pixel.
    pub mixed: Mixed,
    /// How the picture came about.
    pub record: Record,
}

/// One layer: what reaches the eye by one way.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// That of a [`Field`] which is a layer.
    pub name: &'static str,
    /// Photometric colour of every pixel, working space [cd/m2].
    pub rgb: Vec<Vec3>,
}

impl Frame {
    /// A frame that sees nothing: no layers, no hits, clear air.
    ///
    /// # Errors
    /// [`Error::Failed`] when there is not enough memory.
    pub fn new(width: u32, height: u32) -> Result<Self> {
        let pixels = width as usize * height as usize;
        let what = "the picture";
        Ok(Frame {
            width,
            height,
            layers: Vec::new(),
            depth: memory::filled(what, pixels, NO_HIT)?,
            normal: memory::filled(what, pixels, Vec3::ZERO)?,
            transmittance: memory::filled(what, pixels, Vec3::ONE)?,
            mixed: Mixed::default(),
            record: Record::default(),
        })
    }

    /// A map of colours alone, whose background is given, row by row: nothing was met, and nothing is told of it.
    pub fn map(width: u32, height: u32, background: Vec<Vec3>) -> Self {
        Frame {
            width,
            height,
            layers: vec![Layer {
                name: "background",
                rgb: background,
            }],
            depth: Vec::new(),
            normal: Vec::new(),
            transmittance: Vec::new(),
            mixed: Mixed::default(),
            record: Record::default(),
        }
    }

    /// Whether this is a map: colours without depth, normals and transmittance.
    pub fn is_map(&self) -> bool {
        self.depth.is_empty() && self.normal.is_empty() && self.transmittance.is_empty()
    }

    /// Memory that a frame with this many layers holds [bytes per pixel].
    pub const fn bytes_per_pixel(layers: usize) -> usize {
        layers * size_of::<Vec3>() + size_of::<f32>() + 2 * size_of::<Vec3>()
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The layer of that name, if it was made.
    pub fn layer(&self, name: &str) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// The picture at a pixel: the sum of its layers, working space [cd/m2].
    ///
    /// The sum is taken in f64, so that a dim layer is not lost beside the sun's disc before it is converted.
    pub fn picture(&self, pixel: usize) -> DVec3 {
        let colour = |layer: &Layer| layer.rgb[pixel].as_dvec3();
        self.layers.iter().map(colour).sum()
    }

    /// The colours that a pixel holds [cd/m2], and the share of its area that each takes: several where its samples differ much in
    /// brightness. Their mean is [`Frame::picture`].
    pub fn shares(&self, pixel: usize) -> impl Iterator<Item = (f64, DVec3)> {
        self.mixed.shares(pixel, self.picture(pixel))
    }

    /// Whether this can be written: lists as long as the picture, known layers, every value finite, radiance,
    /// transmittance and depth not negative.
    ///
    /// # Errors
    /// [`Error::Failed`] that names the first layer and pixel where it is not so. Such a frame is a defect of what
    /// made it, never of the user's scene.
    pub fn check(&self) -> Result<()> {
        let pixels = self.pixels();
        if pixels == 0 {
            return Err(defect(format!(
                "the picture of {} x {} has no pixels",
                self.width, self.height
            )));
        }
        let lengths = [
            ("depth", self.depth.len()),
            ("normal", self.normal.len()),
            ("transmittance", self.transmittance.len()),
        ];
        let layers = self
            .layers
            .iter()
            .map(|layer| (layer.name, layer.rgb.len()));
        if let Some((name, found)) = lengths
            .into_iter()
            .chain(layers)
            .skip(if self.is_map() { 3 } else { 0 })
            .find(|(_, found)| *found != pixels)
        {
            return Err(defect(format!(
                "{name} has {found} values for {pixels} pixels"
            )));
        }
        for (index, layer) in self.layers.iter().enumerate() {
            if !Field::named(layer.name).is_some_and(Field::is_layer) {
                return Err(defect(format!("`{}` is not a layer", layer.name)));
            }
            if self.layers[..index].iter().any(|l| l.name == layer.name) {
                return Err(defect(format!("layer {} is there twice", layer.name)));
            }
            let good = |c: f32| (0.0..=MAX_LUMINANCE).contains(&c);
            self.check_all(layer.name, &layer.rgb, |v| {
                good(v.x) && good(v.y) && good(v.z)
            })?;
        }
        self.check_all("transmittance", &self.transmittance, |v| {
            v.is_finite() && v.min_element() >= 0.0
        })?;
        self.check_all("normal", &self.normal, |v| v.is_finite())?;
        self.check_all("depth", &self.depth, |z| z.is_finite() && *z >= 0.0)?;
        if let Some(pixel) = self.mixed.spoilt(pixels) {
            return Err(defect(format!("what pixel number {pixel} holds is spoilt")));
        }
        match self.record.iter().find(|(_, value)| !value.is_finite()) {
            Some((key, _)) => Err(defect(format!("`{key}` of the record is not finite"))),
            None => Ok(()),
        }
    }

    fn check_all<T: std::fmt::Display + Sync>(
        &self,
        name: &str,
        values: &[T],
        good: impl Fn(&T) -> bool + Sync,
    ) -> Result<()> {
        let parts = values.par_chunks(1 << 16);
        if parts
            .map(|part| part.iter().all(&good))
            .reduce(|| true, |a, b| a & b)
        {
            return Ok(());
        }
        match values.iter().position(|value| !good(value)) {
            None => Ok(()),
            Some(pixel) => Err(defect(format!(
                "{name} is {} at pixel ({}, {})",
                values[pixel],
                pixel % self.width as usize,
                pixel / self.width as usize
            ))),
        }
    }
}

fn defect(problem: String) -> Error {
    Error::failed(
        problem,
        "this is a defect of tyndall: please report it with the scene and the command",
    )
}

/// How a picture came about: an ordered list of names and values.
///
/// An EXR carries it as attributes called `tyndall:NAME`, and `--report` as JSON.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Record {
    entries: Vec<(String, Value)>,
}

/// A value of the [`Record`].
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Words.
    Text(String),
    /// A finite number; its unit belongs to the name.
    Number(f64),
    /// What a column times it is, column by column; finite.
    Matrix([f64; 16]),
}

impl Record {
    /// Says `key`; what it said before is replaced where it stood.
    pub fn set(&mut self, key: impl Into<String>, value: impl Into<Value>) {
        let (key, value) = (key.into(), value.into());
        match self.entries.iter_mut().find(|(known, _)| *known == key) {
            Some(entry) => entry.1 = value,
            None => self.entries.push((key, value)),
        }
    }

    /// What was said under `key`.
    pub fn get(&self, key: &str) -> Option<&Value> {
        let entry = self.entries.iter().find(|(known, _)| known == key);
        entry.map(|(_, value)| value)
    }

    /// Everything, in the order in which it was said first.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.entries.iter().map(|(key, value)| (&**key, value))
    }
}

impl Serialize for Record {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.entries.len()))?;
        for (key, value) in self.iter() {
            match value {
                Value::Text(text) => map.serialize_entry(key, text)?,
                Value::Number(number) => map.serialize_entry(key, number)?,
                Value::Matrix(matrix) => map.serialize_entry(key, matrix)?,
            }
        }
        map.end()
    }
}

impl Value {
    fn is_finite(&self) -> bool {
        match self {
            Value::Text(_) => true,
            Value::Number(number) => number.is_finite(),
            Value::Matrix(matrix) => matrix.iter().all(|number| number.is_finite()),
        }
    }
}

impl From<DMat4> for Value {
    fn from(matrix: DMat4) -> Self {
        Value::Matrix(matrix.to_cols_array())
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Value::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Value::Text(text)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Value::Number(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_left_out_is_black() {
        let mut frame = Frame::new(2, 1).expect("room for it");
        assert_eq!(frame.picture(1), DVec3::ZERO);
        for (name, rgb) in [("sun", Vec3::splat(1.6e9)), ("sky", Vec3::splat(3.0))] {
            let rgb = vec![rgb; 2];
            frame.layers.push(Layer { name, rgb });
        }
        assert_eq!(frame.picture(1), DVec3::splat(1_600_000_003.0));
        assert!(frame.layer("lights").is_none());
    }

    #[test]
    fn a_pixel_takes_the_room_that_is_told() {
        let mut frame = Frame::new(5, 7).expect("room for it");
        for (layers, name) in (1..).zip(["sun", "sky", "lamps"]) {
            let rgb = vec![Vec3::ONE; frame.pixels()];
            frame.layers.push(Layer { name, rgb });
            let colours = frame.layers.iter().map(|layer| size_of_val(&layer.rgb[..]));
            let held = colours.sum::<usize>()
                + size_of_val(&frame.depth[..])
                + size_of_val(&frame.normal[..])
                + size_of_val(&frame.transmittance[..]);
            assert_eq!(35 * Frame::bytes_per_pixel(layers), held);
        }
    }

    #[test]
    fn what_cannot_be_written_is_named() {
        let good = || {
            let mut frame = Frame::new(3, 2).expect("room for it");
            let rgb = vec![Vec3::ONE; 6];
            frame.layers.push(Layer { name: "sky", rgb });
            frame
        };
        good().check().expect("nothing is wrong with it");
        type Spoil = fn(&mut Frame);
        let spoilt: [(&str, Spoil); 10] = [
            ("sky is [1, NaN, 1] at pixel (1, 1)", |f| {
                f.layers[0].rgb[4].y = f32::NAN
            }),
            ("sky is [-1, 1, 1] at pixel (0, 1)", |f| {
                f.layers[0].rgb[3].x = -1.0
            }),
            ("sky is [1, 1, inf] at pixel (2, 0)", |f| {
                f.layers[0].rgb[2].z = f32::INFINITY
            }),
            ("depth is inf at pixel (0, 0)", |f| {
                f.depth[0] = f32::INFINITY
            }),
            ("transmittance is", |f| f.transmittance[5].x = -0.1),
            ("normal is", |f| f.normal[5].x = f32::NAN),
            ("normal has 5 values for 6 pixels", |f| f.normal.truncate(5)),
            ("`glow` is not a layer", |f| f.layers[0].name = "glow"),
            ("sky is there twice", |f| f.layers.push(f.layers[0].clone())),
            ("`ev` of the record", |f| f.record.set("ev", f64::NAN)),
        ];
        for (message, spoil) in spoilt {
            let mut frame = good();
            spoil(&mut frame);
            let found = frame.check().expect_err(message).to_string();
            assert!(found.contains(message), "{found}");
        }
    }

    #[test]
    fn a_record_keeps_its_order() {
        let mut record = Record::default();
        record.set("utc", "2026-06-21T16:30:00Z");
        record.set("azimuth_deg", 282.5);
        record.set("backend", "reference".to_owned());
        record.set("utc", "2026-06-21T16:31:00Z");
        let json = serde_json::to_string(&record).expect("a record is JSON");
        assert_eq!(
            json,
            r#"{"utc":"2026-06-21T16:31:00Z","azimuth_deg":282.5,"backend":"reference"}"#
        );
        assert_eq!(record.get("azimuth_deg"), Some(&Value::Number(282.5)));
    }
}
