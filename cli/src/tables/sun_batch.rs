//! `tyndall sun --batch`: a position for every row of a CSV.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use tyndall::Result;
use tyndall::ephemeris::civil::{self, Reading};
use tyndall::ephemeris::{Site, SunPosition, Weather, sun_position};

use crate::arguments::place_time::{SunArgs, TimeArgs};
use crate::tables::batch::{Batch, Results, Row};
use crate::tables::printer::Form;
use crate::tables::sun_columns::columns;
use crate::tell;

static BATCH: Batch = Batch {
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
    required: 3,
    results: &[
        "azimuth",
        "elevation_true",
        "elevation_apparent",
        "declination",
        "right_ascension",
        "equation_of_time",
        "distance_au",
        "hour_angle",
        "angular_radius",
        "air_mass",
        "irradiance_factor",
    ],
};

/// Reads `path` (`-` is standard input) and prints every row with the sun's position.
pub fn run(path: &Path, form: Form, times: &TimeArgs, sun: &SunArgs) -> Result<()> {
    let local = Arc::new(AtomicUsize::new(0));
    let positions = Positions {
        times: times.clone(),
        sun: sun.clone(),
        last: None,
        local: Arc::clone(&local),
    };
    let result = BATCH.run(path, form, positions);
    let rows = match local.load(Ordering::Relaxed) {
        0 => return result,
        1 => "1 row has a time".to_owned(),
        count => format!("{count} rows have times"),
    };
    let text = "without an offset or a zone, taken as local time in the zone of the place";
    tell::line("note", format!("{rows} {text} (--tz names another)"));
    result
}

#[derive(Clone)]
struct Positions {
    times: TimeArgs,
    sun: SunArgs,
    /// Latitude, longitude and elevation of the last row, and what follows from them: places repeat.
    last: Option<([f64; 3], Site, Weather)>,
    /// Rows so far whose times were read by the clock of their place, which nobody has named.
    local: Arc<AtomicUsize>,
}

impl Results for Positions {
    fn of(&mut self, row: &Row, results: &mut [f64]) -> Result<()> {
        let position = self.position(row)?;
        for (result, (_, value)) in results.iter_mut().zip(columns(&position)) {
            *result = value;
        }
        Ok(())
    }
}

impl Positions {
    /// One row's position.
    fn position(&mut self, row: &Row) -> Result<SunPosition> {
        let (site, standard) = self.place(row)?;
        let here = |error| row.here(error);
        let weather = match (row.number(4)?, row.number(5)?) {
            (None, None) => standard,
            (pressure, temperature) => Weather::new(
                pressure.unwrap_or(standard.pressure_hpa()),
                temperature.unwrap_or(standard.temperature_c()),
            )
            .map_err(here)?,
        };
        let time = row.text(0).ok_or_else(|| {
            row.error("time is empty", "write a time, as in 2026-06-21T18:30:00Z")
        })?;
        let reading = Reading {
            delta_t: row.number(6)?.or(self.times.delta_t),
            ..self.times.reading(Some(&site))
        };
        let instant = civil::instant_with(time, &reading).map_err(here)?;
        if reading.zone.is_none() && civil::is_local(time) {
            self.local.fetch_add(1, Ordering::Relaxed);
        }
        Ok(sun_position(self.sun.tier, &instant, &site, &weather))
    }

    /// One row's place, at sea level unless it says otherwise, and the air there where it says nothing of it.
    fn place(&mut self, row: &Row) -> Result<(Site, Weather)> {
        let at = [
            row.needed(1)?,
            row.needed(2)?,
            row.number(3)?.unwrap_or(0.0),
        ];
        if let Some((last, site, weather)) = self.last
            && last == at
        {
            return Ok((site, weather));
        }
        let site = Site::new(at[0], at[1], at[2]).map_err(|error| row.here(error))?;
        let weather = self.sun.weather(&site).map_err(|error| row.here(error))?;
        self.last = Some((at, site, weather));
        Ok((site, weather))
    }
}
