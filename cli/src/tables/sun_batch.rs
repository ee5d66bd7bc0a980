//! `tyndall sun --batch`: a position for every row of a CSV.

use std::path::Path;

use tyndall::Result;
use tyndall::ephemeris::civil::{self, Reading};
use tyndall::ephemeris::{Site, SunPosition, Weather, sun_position};

use crate::arguments::place_time::{SunArgs, TimeArgs};
use crate::tables::batch::{Batch, Form, Row};
use crate::tables::sun_columns::columns;

const BATCH: Batch = Batch {
    known: &[
        "time",
        "latitude",
        "longitude",
        "elevation",
        "pressure",
        "temperature",
        "delta_t",
    ],
    words: 1,
    required: 4,
    results: &[
        "azimuth",
        "elevation_true",
        "elevation_apparent",
        "declination",
        "right_ascension",
        "equation_of_time",
        "distance_au",
    ],
};

/// Reads `path` (`-` is standard input) and prints every row with the sun's position.
pub fn run(path: &Path, form: Form, times: &TimeArgs, sun: &SunArgs) -> Result<()> {
    BATCH.run(path, form, |row| {
        let position = position(times, sun, row)?;
        // The first columns of a position are those of a batch.
        Ok(columns(&position)[..BATCH.results.len()]
            .iter()
            .map(|(_, value)| *value)
            .collect())
    })
}

/// One row's position.
fn position(times: &TimeArgs, sun: &SunArgs, row: &Row) -> Result<SunPosition> {
    let here = |error| row.here(error);
    let site = Site::new(row.needed(1)?, row.needed(2)?, row.needed(3)?).map_err(here)?;
    let standard = sun.weather(&site).map_err(here)?;
    let weather = match (row.number(4)?, row.number(5)?) {
        (None, None) => standard,
        (pressure, temperature) => Weather::new(
            pressure.unwrap_or(standard.pressure_hpa()),
            temperature.unwrap_or(standard.temperature_c()),
        )
        .map_err(here)?,
    };
    let time = row
        .text(0)
        .ok_or_else(|| row.error("time is empty", "write a time, as in 2026-06-21T18:30:00Z"))?;
    let reading = Reading {
        delta_t: row.number(6)?.or(times.delta_t),
        ..times.reading(Some(&site))
    };
    let instant = civil::instant_with(time, &reading).map_err(here)?;
    Ok(sun_position(sun.tier, &instant, &site, &weather))
}
