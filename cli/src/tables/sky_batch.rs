//! `tyndall sky --batch`: the models as published, for every row of a CSV.

use std::path::Path;

use tyndall::Result;
use tyndall::colour::{Space, working_from_xyz};
use tyndall::sky::{DEFAULT_TURBIDITY, Irradiance, Model, published_xyz};
use tyndall::units::DEG;

use crate::tables::batch::{Batch, Form, Row};

const BATCH: Batch = Batch {
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
    BATCH.run(path, form, |row| {
        let (sun, azimuth, elevation) = (row.needed(1)?, row.needed(2)?, row.needed(3)?);
        let xyz = published_xyz(model(row)?, sun * DEG, azimuth * DEG, elevation * DEG)
            .map_err(|error| row.here(error))?;
        let rgb = Space::Rec709.from_working() * working_from_xyz(xyz);
        Ok([xyz.to_array(), rgb.to_array()].concat())
    })
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
    let name = row.text(0).unwrap_or_default().to_ascii_lowercase();
    let turbidity = row.number(4)?.unwrap_or(DEFAULT_TURBIDITY);
    let albedo = row.number(7)?.unwrap_or(ALBEDO);
    Model::named(&name, turbidity, irradiance, albedo).map_err(|error| row.here(error))
}
