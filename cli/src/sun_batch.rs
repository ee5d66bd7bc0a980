//! `tyndall sun --batch`: a position for every row of a CSV.

use std::io::Read;
use std::path::Path;

use rayon::prelude::*;
use serde_json::{Map, Value, json};
use tyndall::ephemeris::civil::{self, Reading};
use tyndall::ephemeris::{Air, Site, SunPosition, sun_position};
use tyndall::{Error, Result};

use crate::output;
use crate::sun::{SunArgs, columns};

/// What a column may hold; the first four must be there.
const KNOWN: [&str; 7] = [
    "time",
    "latitude",
    "longitude",
    "elevation",
    "pressure",
    "temperature",
    "delta_t",
];
const REQUIRED: usize = 4;
/// How many columns of a position a batch prints.
const RESULTS: usize = 7;

/// Where each known column stands.
struct Header {
    names: Vec<String>,
    index: [Option<usize>; 7],
}

/// A row that could be computed.
struct Done {
    cells: Vec<String>,
    sun: SunPosition,
}

/// Runs `tyndall sun --batch`.
pub fn run(args: &SunArgs) -> Result<()> {
    let path = args.batch.as_deref().unwrap_or(Path::new("-"));
    let (name, text) = read(path)?;
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty());
    let (number, first) = lines.next().ok_or_else(|| {
        Error::input(
            &name,
            "the file is empty",
            "begin with a line time,latitude,longitude,elevation",
        )
    })?;
    let header = header(
        first.trim_start_matches('\u{feff}'),
        &format!("{name}:{}", number + 1),
    )?;
    let rows: Vec<(usize, &str)> = lines.collect();
    if rows.is_empty() {
        eprintln!("note: {name} has no rows");
    }

    let mut out = output::stdout();
    let mut broken = 0_usize;
    let mut started = false;
    // With --strict nothing is printed before all is known to be right.
    let piece = if args.strict {
        rows.len().max(1)
    } else {
        50_000
    };
    let pieces = rows.chunks(piece);
    let last = pieces.len();
    if !args.json {
        out.line(&csv_line(
            header
                .names
                .iter()
                .map(String::as_str)
                .chain(result_names()),
        ))?;
        if last == 0 {
            return out.finish();
        }
    } else {
        out.line("[")?;
    }
    for piece in pieces {
        let done: Vec<Result<Done>> = piece
            .par_iter()
            .map(|&(number, line)| row(args, &header, line, &format!("{name}:{}", number + 1)))
            .collect();
        if args.strict
            && let Some(position) = done.iter().position(Result::is_err)
        {
            // Nothing but the header has been buffered; it stays unwritten.
            out.discard();
            return done
                .into_iter()
                .nth(position)
                .map_or(Ok(()), |row| row.map(|_| ()));
        }
        let texts: Vec<String> = done
            .par_iter()
            .map(|row| {
                row.as_ref().map_or_else(
                    |_| String::new(),
                    |row| {
                        if args.json {
                            json_row(&header, row)
                        } else {
                            csv_row(row)
                        }
                    },
                )
            })
            .collect();
        for (row, text) in done.iter().zip(&texts) {
            match row {
                Err(error) => {
                    eprintln!("error: {error}");
                    broken += 1;
                }
                Ok(_) if args.json => {
                    out.bytes(if started { b",\n" } else { b"" })?;
                    out.bytes(text.as_bytes())?;
                    started = true;
                }
                Ok(_) => out.line(text)?,
            }
        }
    }
    if args.json {
        out.line(if started { "\n]" } else { "]" })?;
    }
    out.finish()?;
    if broken > 0 {
        return Err(Error::input(
            name,
            format!(
                "{broken} of {} rows could not be read and were left out",
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

fn result_names() -> std::array::IntoIter<&'static str, RESULTS> {
    [
        "azimuth",
        "elevation_true",
        "elevation_apparent",
        "declination",
        "right_ascension",
        "equation_of_time",
        "distance_au",
    ]
    .into_iter()
}

/// Finds the columns.
fn header(line: &str, place: &str) -> Result<Header> {
    let names: Vec<String> = cells(line, place)?
        .iter()
        .map(|name| name.trim().to_ascii_lowercase())
        .collect();
    let mut index = [None; 7];
    for (known, slot) in KNOWN.iter().zip(&mut index) {
        let mut at = names
            .iter()
            .enumerate()
            .filter(|(_, name)| name == known)
            .map(|(i, _)| i);
        *slot = at.next();
        if at.next().is_some() {
            return Err(Error::input(
                place,
                format!("the column `{known}` is there twice"),
                "leave out one",
            ));
        }
    }
    let missing: Vec<&str> = KNOWN[..REQUIRED]
        .iter()
        .zip(&index)
        .filter(|(_, i)| i.is_none())
        .map(|(k, _)| *k)
        .collect();
    if !missing.is_empty() {
        return Err(Error::input(
            place,
            format!(
                "the column {} is missing; there are {}",
                quoted(&missing),
                quoted(&names)
            ),
            "the first line names the columns: time,latitude,longitude,elevation and perhaps pressure,temperature,delta_t, with commas",
        ));
    }
    for name in names.iter().filter(|name| !KNOWN.contains(&name.as_str())) {
        if let Some(taken) = result_names().find(|result| result == name) {
            return Err(Error::input(
                place,
                format!("the column `{taken}` is also a result's name"),
                "call it otherwise",
            ));
        }
        eprintln!(
            "note: {place}: the column `{name}` is not read, and passed on; known are {}",
            quoted(&KNOWN)
        );
    }
    Ok(Header { names, index })
}

fn quoted(names: &[impl AsRef<str>]) -> String {
    names
        .iter()
        .map(|name| format!("`{}`", name.as_ref()))
        .collect::<Vec<_>>()
        .join(", ")
}

/// The cells of a line; a cell in double quotes may hold commas, and "" for a quote.
fn cells(line: &str, place: &str) -> Result<Vec<String>> {
    let line = line.trim_end_matches('\r');
    if !line.contains('"') {
        return Ok(line.split(',').map(str::to_owned).collect());
    }
    let mut cells = vec![String::new()];
    let (mut quoted, mut chars) = (false, line.chars().peekable());
    while let Some(c) = chars.next() {
        let cell = cells.last_mut().expect("there is a first cell");
        match (c, quoted) {
            ('"', true) if chars.peek() == Some(&'"') => {
                chars.next();
                cell.push('"');
            }
            ('"', _) => quoted = !quoted,
            (',', false) => cells.push(String::new()),
            (c, _) => cell.push(c),
        }
    }
    if quoted {
        return Err(Error::input(
            place,
            "a quote is not closed",
            "close it on the same line",
        ));
    }
    Ok(cells)
}

/// One row's position.
fn row(args: &SunArgs, header: &Header, line: &str, place: &str) -> Result<Done> {
    let cells = cells(line, place)?;
    if cells.len() != header.names.len() {
        return Err(Error::input(
            place,
            format!(
                "{} cells where the first line has {}",
                cells.len(),
                header.names.len()
            ),
            "give every column a cell, empty where it does not apply",
        ));
    }
    let cell = |column: usize| {
        header.index[column]
            .map(|i| cells[i].trim())
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
                "write a decimal number",
            )
        })
    };
    let here = |error: Error| Error::input(place, error.problem(), error.remedy());

    let site = Site::new(needed(1)?, needed(2)?, needed(3)?).map_err(here)?;
    let standard = args.sun.air(&site).map_err(here)?;
    let air = match (number(4)?, number(5)?) {
        (None, None) => standard,
        (pressure, temperature) => Air::new(
            pressure.unwrap_or(standard.pressure_hpa()),
            temperature.unwrap_or(standard.temperature_c()),
        )
        .map_err(here)?,
    };
    let time = cell(0).ok_or_else(|| {
        Error::input(
            place,
            "time is empty",
            "write a time, as in 2026-06-21T18:30:00Z",
        )
    })?;
    let reading = Reading {
        delta_t: number(6)?.or(args.time.delta_t),
        ..args.time.reading(Some(&site))
    };
    let instant = civil::instant_with(time, &reading).map_err(here)?;
    Ok(Done {
        sun: sun_position(args.sun.tier, &instant, &site, &air),
        cells,
    })
}

fn csv_line<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    let mut line = String::new();
    for (i, cell) in cells.enumerate() {
        if i > 0 {
            line.push(',');
        }
        if cell.contains([',', '"']) {
            line.push_str(&format!("\"{}\"", cell.replace('"', "\"\"")));
        } else {
            line.push_str(cell);
        }
    }
    line
}

fn csv_row(row: &Done) -> String {
    use std::fmt::Write;
    let mut line = csv_line(row.cells.iter().map(|cell| cell.trim()));
    for (_, value) in &columns(&row.sun)[..RESULTS] {
        let _ = write!(line, ",{value}");
    }
    line
}

fn json_row(header: &Header, row: &Done) -> String {
    let mut map = Map::new();
    for (i, name) in header.names.iter().enumerate() {
        let cell = row.cells[i].trim();
        // The known columns but the time are numbers; others pass as they are.
        let number = header.index[1..]
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
    for (name, value) in &columns(&row.sun)[..RESULTS] {
        map.insert((*name).to_owned(), json!(value));
    }
    Value::Object(map).to_string()
}
