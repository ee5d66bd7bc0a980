//! `tyndall sky --batch`: the models as published, for every row of a CSV.

use crate::stdout;
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::io::Read;
use std::path::Path;
use tyndall::colour::{Space, working_from_xyz};
use tyndall::sky::{DEFAULT_TURBIDITY, Irradiance, Model, published_xyz};
use tyndall::units::DEG;
use tyndall::{Error, Result};

/// Columns that are read; the first four must be there.
const KNOWN: [&str; 8] = [
    "model",
    "sun_elevation",
    "view_azimuth",
    "view_elevation",
    "turbidity",
    "direct_normal",
    "diffuse_horizontal",
    "albedo",
];
const REQUIRED: usize = 4;

/// Columns that are added.
const RESULTS: [&str; 6] = ["X", "Y", "Z", "R", "G", "B"];

/// The ground's albedo for `hosek`, where no column says it.
const ALBEDO: f64 = 0.2;

struct Header {
    names: Vec<String>,
    at: [Option<usize>; 8],
}

struct Done<'a> {
    cells: Vec<&'a str>,
    values: [f64; 6],
}

/// Reads `path` (`-` is standard input) and prints every row with X, Y, Z [cd/m2] and linear Rec. 709 R, G, B.
pub fn run(path: &Path, as_json: bool) -> Result<()> {
    let (name, text) = read(path)?;
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty());
    let Some((number, first)) = lines.next() else {
        return Err(Error::input(
            name,
            "the file is empty",
            "begin with a line model,sun_elevation,turbidity,view_azimuth,view_elevation",
        ));
    };
    let header = Header::read(first, &format!("{name}:{}", number + 1))?;
    let rows: Vec<(usize, &str)> = lines.collect();
    let done: Vec<Result<Done>> = rows
        .par_iter()
        .map(|(number, line)| header.row(line, &format!("{name}:{}", number + 1)))
        .collect();
    let broken = done.iter().filter(|row| row.is_err()).count();
    for error in done.iter().filter_map(|row| row.as_ref().err()) {
        eprintln!("error: {error}");
    }
    let good = done.iter().filter_map(|row| row.as_ref().ok());
    if as_json {
        stdout::print_json(&good.map(|row| header.json(row)).collect::<Vec<_>>())?;
    } else {
        let mut out = String::new();
        let titles: Vec<&str> = header
            .names
            .iter()
            .map(String::as_str)
            .chain(RESULTS)
            .collect();
        out.push_str(&titles.join(","));
        out.push('\n');
        for row in good {
            out.push_str(&row.cells.join(","));
            for value in row.values {
                // The shortest decimal that reads back to the same f64.
                let _ = write!(out, ",{value}");
            }
            out.push('\n');
        }
        stdout::print(&out)?;
    }
    if broken > 0 {
        return Err(Error::input(
            name,
            format!(
                "{broken} of {} rows could not be used and were left out",
                rows.len()
            ),
            "correct the rows named above",
        ));
    }
    Ok(())
}

fn read(path: &Path) -> Result<(String, String)> {
    if path == Path::new("-") {
        let mut text = String::new();
        std::io::stdin()
            .read_to_string(&mut text)
            .map_err(|error| Error::reading(Path::new("standard input"), error))?;
        return Ok(("standard input".into(), text));
    }
    let text = std::fs::read_to_string(path).map_err(|error| Error::reading(path, error))?;
    Ok((path.display().to_string(), text))
}

fn cells(line: &str) -> Vec<&str> {
    line.split(',')
        .map(|cell| cell.trim().trim_matches('"'))
        .collect()
}

impl Header {
    fn read(line: &str, place: &str) -> Result<Self> {
        let names: Vec<String> = cells(line).into_iter().map(str::to_owned).collect();
        let mut at = [None; 8];
        for (i, name) in names.iter().enumerate() {
            if let Some(known) = KNOWN.iter().position(|k| k.eq_ignore_ascii_case(name)) {
                if at[known].is_some() {
                    return Err(Error::input(
                        place,
                        format!("the column `{name}` is there twice"),
                        "leave out one",
                    ));
                }
                at[known] = Some(i);
            } else if RESULTS.contains(&name.as_str()) {
                return Err(Error::input(
                    place,
                    format!("the column `{name}` is also a result's name"),
                    "call it otherwise",
                ));
            } else {
                eprintln!(
                    "note: {place}: the column `{name}` is not read, and passed on; known are {}",
                    KNOWN.join(", ")
                );
            }
        }
        if let Some(missing) = (0..REQUIRED).find(|i| at[*i].is_none()) {
            return Err(Error::input(
                place,
                format!("the column `{}` is missing", KNOWN[missing]),
                "the first line names the columns: model,sun_elevation,turbidity,view_azimuth,view_elevation, and perhaps direct_normal,diffuse_horizontal,albedo",
            ));
        }
        Ok(Header { names, at })
    }

    fn row<'a>(&self, line: &'a str, place: &str) -> Result<Done<'a>> {
        let cells = cells(line);
        if cells.len() != self.names.len() {
            return Err(Error::input(
                place,
                format!(
                    "{} cells where the first line has {}",
                    cells.len(),
                    self.names.len()
                ),
                "give every column a cell, empty where it does not apply",
            ));
        }
        let cell = |column: usize| {
            self.at[column]
                .map(|i| cells[i])
                .filter(|cell| !cell.is_empty())
        };
        let number = |column: usize| -> Result<Option<f64>> {
            let Some(cell) = cell(column) else {
                return Ok(None);
            };
            match cell.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(Some(value)),
                _ => Err(Error::input(
                    place,
                    format!("{}: `{cell}` is no finite number", KNOWN[column]),
                    "write a decimal number",
                )),
            }
        };
        let needed = |column: usize| {
            number(column)?.ok_or_else(|| {
                Error::input(
                    place,
                    format!("{} is empty", KNOWN[column]),
                    "write degrees",
                )
            })
        };
        let here = |error: Error| Error::input(place, error.problem(), error.remedy());
        let irradiance = match (number(5)?, number(6)?) {
            (Some(direct_normal), Some(diffuse_horizontal)) => Some(Irradiance {
                direct_normal,
                diffuse_horizontal,
            }),
            (None, None) => None,
            _ => {
                return Err(Error::input(
                    place,
                    "only one of direct_normal and diffuse_horizontal is given",
                    "give both in W/m2, or neither",
                ));
            }
        };
        let name = cell(0).unwrap_or_default().to_ascii_lowercase();
        let turbidity = number(4)?.unwrap_or(DEFAULT_TURBIDITY);
        let albedo = number(7)?.unwrap_or(ALBEDO);
        let model = Model::named(&name, turbidity, irradiance, albedo).map_err(here)?;
        let xyz = published_xyz(model, needed(1)? * DEG, needed(2)? * DEG, needed(3)? * DEG)
            .map_err(here)?;
        let rgb = Space::Rec709.from_working() * working_from_xyz(xyz);
        Ok(Done {
            cells,
            values: [xyz.x, xyz.y, xyz.z, rgb.x, rgb.y, rgb.z],
        })
    }

    fn json(&self, row: &Done) -> Value {
        let mut map = Map::new();
        for (i, name) in self.names.iter().enumerate() {
            let cell = row.cells[i];
            let number = self.at[1..]
                .contains(&Some(i))
                .then(|| cell.parse::<f64>().ok())
                .flatten();
            let value = match number {
                Some(number) => json!(number),
                None if cell.is_empty() => Value::Null,
                None => json!(cell),
            };
            map.insert(name.clone(), value);
        }
        for (name, value) in RESULTS.iter().zip(row.values) {
            map.insert((*name).to_owned(), json!(value));
        }
        Value::Object(map)
    }
}
