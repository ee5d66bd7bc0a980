//! `tyndall sky --batch`: the models as published, for every row of a CSV.

use std::borrow::Cow;
use std::path::Path;

use glam::DMat3;
use tyndall::Result;
use tyndall::colour::{Space, working_from_xyz};
use tyndall::sky::{DEFAULT_TURBIDITY, Irradiance, Model, Published};
use tyndall::units::DEG;

use crate::tables::batch::{Batch, Results, Row};
use crate::tables::printer::Form;

static BATCH: Batch = Batch {
    known: &[
        "model",
        "sun_elevation",
        "view_azimuth",
        "view_elevation",
        "turbidity",
        "direct_normal",
        "diffuse_horizontal",
        "albedo",
    ],
    words: 1,
    required: 4,
    results: &["X", "Y", "Z", "R", "G", "B"],
};

/// The ground's albedo for `hosek`, where no column says it.
const ALBEDO: f64 = 0.2;

/// Reads `path` (`-` is standard input) and prints every row with X, Y, Z [cd/m2] and linear Rec. 709 R, G, B.
pub fn run(path: &Path, form: Form) -> Result<()> {
    let colours = Colours {
        last: None,
        rec709_from_working: Space::Rec709.from_working(),
    };
    BATCH.run(path, form, colours)
}

#[derive(Clone)]
struct Colours {
    /// The sky of the last row, with its model and the sun's elevation [degrees]: rows often ask for another direction alone.
    last: Option<(Model, f64, Published)>,
    rec709_from_working: DMat3,
}

impl Results for Colours {
    fn of(&mut self, row: &Row, results: &mut [f64]) -> Result<()> {
        let here = |error| row.here(error);
        let (sun, azimuth, elevation) = (row.needed(1)?, row.needed(2)?, row.needed(3)?);
        let model = model(row)?;
        let sky = match &self.last {
            Some((last, at, sky)) if *last == model && *at == sun => sky,
            _ => {
                let sky = Published::new(model, sun * DEG).map_err(here)?;
                &self.last.insert((model, sun, sky)).2
            }
        };
        let xyz = sky.xyz(azimuth * DEG, elevation * DEG).map_err(here)?;
        let rgb = self.rec709_from_working * working_from_xyz(xyz);
        results[..3].copy_from_slice(&xyz.to_array());
        results[3..].copy_from_slice(&rgb.to_array());
        Ok(())
    }
}

/// One row's model.
fn model(row: &Row) -> Result<Model> {
    let irradiance = match (row.number(5)?, row.number(6)?) {
        (Some(direct_normal), Some(diffuse_horizontal)) => Some(Irradiance {
            direct_normal,
            diffuse_horizontal,
        }),
        (None, None) => None,
        _ => {
            return Err(row.error(
                "only one of direct_normal and diffuse_horizontal is given",
                "give both in W/m2, or neither",
            ));
        }
    };
    let name = row.text(0).unwrap_or_default();
    let name = match name.bytes().any(|b| b.is_ascii_uppercase()) {
        true => Cow::Owned(name.to_ascii_lowercase()),
        false => Cow::Borrowed(name),
    };
    let turbidity = row.number(4)?.unwrap_or(DEFAULT_TURBIDITY);
    let albedo = row.number(7)?.unwrap_or(ALBEDO);
    Model::named(&name, turbidity, irradiance, albedo).map_err(|error| row.here(error))
}
