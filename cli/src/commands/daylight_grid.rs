//! `tyndall daylight --grid`: illuminance or daylight factors of sensors, as a table, as files and as a map.

use super::daylight_files::{self, Kind};
use crate::tables::columns;
use crate::tables::daylight_batch::{LAYERS, Meter};
use crate::tables::printer::As;
use crate::tables::rows::Rows;
use crate::tables::stdout;
use crate::tables::together::Together;
use crate::tell;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use tyndall::colour::luminance;
use tyndall::conditions::Conditions;
use tyndall::daylight::factor::{Summary, no_daylight};
use tyndall::daylight::grid::{GridSpec, Sensors};
use tyndall::daylight::map::{self, Caption};
use tyndall::daylight::raster;
use tyndall::output::scale::{Scale, short};
use tyndall::output::{self, atomic};
use tyndall::sky::Sky;
use tyndall::{Error, Result, Warning};

/// What is asked of a grid.
pub struct Grid<'a> {
    /// The grids as they were asked for.
    pub specs: &'a [GridSpec],
    /// Where sensors are.
    pub sensors: &'a Sensors,
    /// Daylight factors instead of illuminances.
    pub is_factor: bool,
    /// The scale of the map, if it is not to be found from the values.
    pub scale: Option<&'a Scale>,
    /// Files to write.
    pub files: &'a [PathBuf],
    /// How the summary is printed.
    pub as_what: As,
}

/// Checks the names of files before the work is done; `in_use` are read or written elsewhere.
///
/// # Errors
/// [`Error::Input`] for an ending that means nothing, for a file named twice, and for one that is in use.
pub fn check(files: &[PathBuf], in_use: &[(PathBuf, &str)]) -> Result<()> {
    let mut in_use = in_use.to_vec();
    for file in files {
        Kind::of(file, false)?;
        daylight_files::claim(file, &mut in_use)?;
    }
    Ok(())
}

/// What sensors receive, and what is shown of it.
struct Values {
    /// All columns of each sensor [lx]: the sum, then the layers.
    all: Vec<Vec<f64>>,
    /// What maps and summaries are of.
    shown: Vec<f64>,
    quantity: &'static str,
    unit: &'static str,
}

/// Says what was left out of a grid.
pub fn tell(sensors: &Sensors) {
    for left in &sensors.left_out {
        tell::line("grid", left);
    }
    for note in &sensors.notes {
        tell::line("grid", note);
    }
    let planes = sensors.planes.len();
    let area = short(sensors.area());
    let count = sensors.points.len();
    tell::line(
        "grid",
        format!("{count} sensors on {planes} planes, {area} m2"),
    );
}

/// Measures, prints the summary and writes the files.
///
/// # Errors
/// Those of rendering and writing; [`Error::Failed`] for a daylight factor under a sky without light.
pub fn run(grid: &Grid, meter: &mut Meter) -> Result<()> {
    let conditions = meter.conditions;
    let lux = meter.of(grid.sensors.receivers())?;
    let columns = lux.len() / grid.sensors.points.len().max(1);
    let all: Vec<Vec<f64>> = lux.chunks_exact(columns).map(<[f64]>::to_vec).collect();
    let total = all.iter().map(|row| row[0]);
    let values = match grid.is_factor {
        false => Values {
            shown: total.collect(),
            quantity: "illuminance",
            unit: "lx",
            all,
        },
        true => {
            let outside = outside(conditions)?;
            Values {
                shown: total.map(|lux| 100.0 * lux / outside).collect(),
                quantity: "daylight factor",
                unit: "%",
                all,
            }
        }
    };
    let shines = |sky: &Sky| luminance(sky.horizontal_illuminance()) > 0.0;
    let mut warnings = conditions.warnings.clone();
    if conditions.sky.as_deref().is_some_and(shines)
        && let Some(dark) = no_daylight(values.all.iter().map(|row| row[0]))
    {
        tell::warnings(std::slice::from_ref(&dark));
        warnings.push(dark);
    }
    let summaries = summaries(grid.sensors, &values);
    print(grid, &values, &summaries)?;
    for file in grid.files {
        match Kind::of(file, false)? {
            Kind::Map => draw(file, grid, conditions, &values)?,
            Kind::Csv => write(file, csv(grid, &values))?,
            Kind::Raster => raster::write(file, grid.sensors, &columns_of(grid, &values))?,
            Kind::Json => {
                let said = report(grid, conditions, &warnings, &values, &summaries);
                output::report::write(file, &said)?;
            }
            // A moment has none, and its ending was refused.
            Kind::Page => {}
        }
    }
    if !grid.files.is_empty() {
        tell::files(grid.files);
    }
    Ok(())
}

/// The columns of the table: the sum, the layers, and the daylight factor where that is asked for.
fn columns_of(grid: &Grid, values: &Values) -> Vec<(String, Vec<f64>)> {
    let count = values.all.first().map_or(1, Vec::len);
    let layers = LAYERS[..count - 1].iter().map(|field| field.name());
    let names = std::iter::once("illuminance").chain(layers);
    let of = |(at, name): (usize, &str)| {
        let lux = values.all.iter().map(|row| row[at]);
        (format!("{name}_lx"), lux.collect())
    };
    let mut columns: Vec<(String, Vec<f64>)> = names.enumerate().map(of).collect();
    if grid.is_factor {
        columns.push(("daylight_factor_percent".into(), values.shown.clone()));
    }
    columns
}

/// Illuminance of open level ground by the sky alone [lx].
fn outside(conditions: &Conditions) -> Result<f64> {
    let sky = conditions.sky.as_ref();
    match sky.map(|sky| luminance(sky.horizontal_illuminance())) {
        Some(lux) if lux > 0.0 => Ok(lux),
        _ => Err(Error::failed(
            "there is no light outside that a daylight factor could be a share of",
            "please report this defect with the command and the scene",
        )),
    }
}

/// Of each plane, and of all together where there are several.
fn summaries(sensors: &Sensors, values: &Values) -> Vec<(String, Summary)> {
    let of = |plane: Option<usize>| -> Option<Summary> {
        let pairs = sensors.points.iter().zip(&values.shown);
        let own = pairs.filter(|(sensor, _)| plane.is_none_or(|plane| sensor.plane == plane));
        Summary::new(
            &own.map(|(sensor, value)| (*value, sensor.area))
                .collect::<Vec<_>>(),
        )
    };
    let planes = sensors.planes.iter().enumerate();
    let mut all: Vec<(String, Summary)> = planes
        .filter_map(|(i, plane)| Some((plane.name.clone(), of(Some(i))?)))
        .collect();
    if all.len() > 1 {
        all.extend(of(None).map(|summary| ("all".to_owned(), summary)));
    }
    all
}

fn print(grid: &Grid, values: &Values, summaries: &[(String, Summary)]) -> Result<()> {
    let suffix = if grid.is_factor { "percent" } else { "lx" };
    let rows = summaries.iter().map(|(name, s)| {
        let mut row = columns::columns([
            ("plane", json!(name)),
            ("sensors", json!(s.sensors)),
            ("area_m2", json!(s.area)),
        ]);
        let values = [
            ("mean", s.mean),
            ("median", s.median),
            ("minimum", s.minimum),
            ("maximum", s.maximum),
        ];
        row.extend(values.map(|(name, value)| (format!("{name}_{suffix}"), json!(value))));
        row.insert("uniformity".into(), json!(s.uniformity));
        row
    });
    let rows: Vec<_> = rows.collect();
    match grid.as_what {
        As::Json => stdout::print_json(&rows),
        As::Csv => stdout::print(columns::csv(&rows)),
        As::Table => stdout::print(table(values, summaries)),
    }
}

fn table(values: &Values, summaries: &[(String, Summary)]) -> String {
    let names = summaries.iter().map(|(name, _)| tell::clean(name));
    let names: Vec<String> = names.collect();
    let wide = names
        .iter()
        .map(|n| n.chars().count())
        .max()
        .unwrap_or(0)
        .max(values.quantity.len() + 4);
    let title = format!("{} [{}]", values.quantity, values.unit);
    let mut text = format!(
        "{title:<wide$} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10}\n",
        "sensors", "m2", "mean", "median", "least", "greatest", "uniformity"
    );
    for (name, (_, s)) in names.iter().zip(summaries) {
        let [area, mean, median, least, greatest, uniformity] =
            [s.area, s.mean, s.median, s.minimum, s.maximum, s.uniformity].map(short);
        text += &format!(
            "{name:<wide$} {:>8} {area:>9} {mean:>9} {median:>9} {least:>9} {greatest:>9} {uniformity:>10}\n",
            s.sensors
        );
    }
    text
}

fn write(file: &Path, bytes: Vec<u8>) -> Result<()> {
    atomic::write(file, |out| out.write_all(&bytes))
}

/// One row a sensor; units stand in the names of columns.
fn csv(grid: &Grid, values: &Values) -> Vec<u8> {
    let places = ["plane", "x_m", "y_m", "z_m", "nx", "ny", "nz", "area_m2"];
    let mut names = places.map(str::to_owned).to_vec();
    names.extend(columns_of(grid, values).into_iter().map(|(name, _)| name));
    let mut rows = Rows::with_capacity(64 * values.all.len());
    rows.row(&names);
    for ((sensor, lux), shown) in grid
        .sensors
        .points
        .iter()
        .zip(&values.all)
        .zip(&values.shown)
    {
        rows.text(&grid.sensors.planes[sensor.plane].name);
        let (position, normal) = (sensor.receiver.position, sensor.receiver.normal);
        for value in position.to_array().into_iter().chain(normal.to_array()) {
            // Nothing is known to a nanometre, and 0 has no sign.
            rows.number((1e9 * value).round() / 1e9 + 0.0);
        }
        rows.number(sensor.area);
        lux.iter().for_each(|value| rows.number(*value));
        if grid.is_factor {
            rows.number(*shown);
        }
        rows.end();
    }
    rows.into_bytes()
}

fn report(
    grid: &Grid,
    conditions: &Conditions,
    warnings: &[Warning],
    values: &Values,
    summaries: &[(String, Summary)],
) -> Value {
    let sensors = grid.sensors;
    // The sun of a daylight factor is nobody's.
    let is_said = |label: &str| !(grid.is_factor && label == "sun");
    let said: serde_json::Map<String, Value> = (conditions.lines().into_iter())
        .filter(|(label, _)| is_said(label))
        .map(|(label, text)| (label.to_owned(), json!(text)))
        .collect();
    let planes: Vec<Value> = (sensors.planes.iter())
        .map(|plane| {
            json!({
                "name": plane.name, "above_m": plane.above, "origin_m": plane.origin, "u": plane.u, "v": plane.v,
                "step_m": plane.step, "cells": plane.cells, "area_m2": plane.outline.area(), "whole_area_m2": plane.whole.area(),
            })
        })
        .collect();
    let points: Vec<Value> = (sensors.points.iter().zip(&values.all).zip(&values.shown))
        .map(|((sensor, lux), shown)| {
            let mut point = json!({
                "plane": sensor.plane, "cell": sensor.cell, "position_m": sensor.receiver.position,
                "normal": sensor.receiver.normal, "area_m2": sensor.area, "illuminance_lx": lux[0],
            });
            for (field, value) in LAYERS.iter().zip(&lux[1..]) {
                point[format!("{}_lx", field.name())] = json!(value);
            }
            if grid.is_factor {
                point["daylight_factor_percent"] = json!(shown);
            }
            point
        })
        .collect();
    let summary: Vec<Value> = (summaries.iter())
        .map(|(name, summary)| json!({ "plane": name, "values": summary }))
        .collect();
    json!({
        "schema": 1,
        "quantity": values.quantity,
        "unit": values.unit,
        "outside_lx": grid.is_factor.then(|| outside(conditions).ok()),
        "scene": conditions.scene.name,
        "north_degrees": conditions.scene.north_deg,
        "conditions": said,
        "warnings": warnings,
        "grids": grid.specs,
        "left_out": sensors.left_out,
        "notes": sensors.notes,
        "summary": summary,
        "planes": planes,
        "sensors": points,
    })
}

fn draw(file: &Path, grid: &Grid, conditions: &Conditions, values: &Values) -> Result<()> {
    let found = Scale::of(values.quantity, values.unit, values.shown.iter().copied());
    let scale = match grid.scale {
        Some(scale) => scale.clone().named(values.quantity, values.unit),
        None => found,
    };
    let wanted: &[&str] = match grid.is_factor {
        true => &["sky"],
        false => &["place", "instant", "sun", "sky"],
    };
    let lines = conditions.lines();
    let lines = lines.iter().filter(|(label, _)| wanted.contains(label));
    let caption = Caption {
        title: format!("{} in {}", scale.title(), conditions.scene.name),
        lines: lines
            .map(|(label, text)| format!("{label}: {text}"))
            .collect(),
    };
    map::draw(
        &conditions.scene,
        grid.sensors,
        &values.shown,
        &scale,
        &caption,
    )
    .save(file)
}
