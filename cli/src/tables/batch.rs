//! A CSV in, the same rows with results out: what `tyndall sun --batch` and `tyndall sky --batch` share.

use std::fmt::Write;
use std::io::Read;
use std::path::Path;

use rayon::prelude::*;
use serde_json::{Map, Value, json};
use tyndall::{Error, Result};

use crate::tables::stdout;

/// What a batch reads and adds. Names of columns are read in any case.
pub struct Batch {
    /// The columns that it knows: words first.
    pub known: &'static [&'static str],
    /// How many of these are words; the others are numbers.
    pub words: usize,
    /// How many of the known, from the first, must be there.
    pub required: usize,
    /// The columns that it adds.
    pub results: &'static [&'static str],
}

/// How a batch is printed.
#[derive(Clone, Copy)]
pub struct Form {
    /// JSON instead of CSV.
    pub json: bool,
    /// Stop at the first broken row and print nothing.
    pub strict: bool,
}

/// A row of the file, with the place that its errors name.
pub struct Row<'a> {
    batch: &'a Batch,
    header: &'a Header,
    cells: Vec<String>,
    place: String,
}

struct Header {
    names: Vec<String>,
    /// Where each known column stands.
    at: Vec<Option<usize>>,
}

impl Batch {
    /// Prints the rows of `path` (`-` is standard input) with their results.
    ///
    /// # Errors
    /// A file that cannot be read, a missing column; at the end, if rows were broken: these are named on standard error
    /// and left out.
    pub fn run<F>(&self, path: &Path, form: Form, results: F) -> Result<()>
    where
        F: Fn(&Row) -> Result<Vec<f64>> + Sync,
    {
        let (name, text) = read(path)?;
        let mut lines = text
            .trim_start_matches('\u{feff}')
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty());
        let (number, first) = lines.next().ok_or_else(|| {
            Error::input(
                &name,
                "the file is empty",
                format!("begin with a line {}", self.known.join(",")),
            )
        })?;
        let header = self.header(first, &format!("{name}:{}", number + 1))?;
        let rows: Vec<(usize, &str)> = lines.collect();
        if rows.is_empty() {
            eprintln!("note: {name} has no rows");
        }

        let mut out = stdout::lock();
        if form.json {
            out.line("[")?;
        } else {
            out.line(&csv_line(
                header
                    .names
                    .iter()
                    .map(String::as_str)
                    .chain(self.results.iter().copied()),
            ))?;
        }
        // Pieces are written while the next are computed; with --strict all must be known to be right first.
        let piece = if form.strict { rows.len() } else { 50_000 };
        let (mut broken, mut started) = (0_usize, false);
        for piece in rows.chunks(piece.max(1)) {
            let texts: Vec<Result<String>> = piece
                .par_iter()
                .map(|&(number, line)| {
                    let row = self.row(&header, line, format!("{name}:{}", number + 1))?;
                    let values = results(&row)?;
                    Ok(if form.json {
                        row.json(&values)
                    } else {
                        row.csv(&values)
                    })
                })
                .collect();
            for text in texts {
                match text {
                    Ok(text) if form.json => {
                        out.bytes(if started { b",\n" } else { b"" })?;
                        out.bytes(text.as_bytes())?;
                        started = true;
                    }
                    Ok(text) => out.line(&text)?,
                    Err(error) if form.strict => {
                        out.discard();
                        return Err(error);
                    }
                    Err(error) => {
                        eprintln!("error: {error}");
                        broken += 1;
                    }
                }
            }
        }
        if form.json {
            out.line(if started { "\n]" } else { "]" })?;
        }
        out.finish()?;
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

    /// Finds the columns.
    fn header(&self, line: &str, place: &str) -> Result<Header> {
        let names: Vec<String> = cells(line, place)?;
        let is = |name: &str, known: &str| name.eq_ignore_ascii_case(known);
        let mut at = Vec::with_capacity(self.known.len());
        for known in self.known {
            let mut found = (0..names.len()).filter(|&i| is(&names[i], known));
            at.push(found.next());
            if found.next().is_some() {
                return Err(Error::input(
                    place,
                    format!("the column `{known}` is there twice"),
                    "leave out one",
                ));
            }
        }
        let missing: Vec<&str> = (0..self.required)
            .filter(|&i| at[i].is_none())
            .map(|i| self.known[i])
            .collect();
        if !missing.is_empty() {
            return Err(Error::input(
                place,
                format!(
                    "the column {} is missing; there are {}",
                    quoted(&missing),
                    quoted(&names)
                ),
                format!(
                    "the first line names the columns, with commas: {} and perhaps {}",
                    self.known[..self.required].join(","),
                    self.known[self.required..].join(",")
                ),
            ));
        }
        for name in &names {
            if self.known.iter().any(|known| is(name, known)) {
                continue;
            }
            if self.results.contains(&name.as_str()) {
                return Err(Error::input(
                    place,
                    format!("the column `{name}` is also a result's name"),
                    "call it otherwise",
                ));
            }
            eprintln!(
                "note: {place}: the column `{name}` is not read, and passed on; known are {}",
                quoted(self.known)
            );
        }
        Ok(Header { names, at })
    }

    fn row<'a>(&'a self, header: &'a Header, line: &str, place: String) -> Result<Row<'a>> {
        let cells = cells(line, &place)?;
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
        Ok(Row {
            batch: self,
            header,
            cells,
            place,
        })
    }
}

impl Row<'_> {
    /// The text of a known column, by its number; `None` where the cell is empty or there is no such column.
    pub fn text(&self, column: usize) -> Option<&str> {
        self.header.at[column]
            .map(|i| self.cells[i].as_str())
            .filter(|cell| !cell.is_empty())
    }

    /// The number in a known column.
    pub fn number(&self, column: usize) -> Result<Option<f64>> {
        let Some(cell) = self.text(column) else {
            return Ok(None);
        };
        match cell.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(self.error(
                format!("{}: `{cell}` is no finite number", self.batch.known[column]),
                "write a decimal number",
            )),
        }
    }

    /// The number in a known column that must not be empty.
    pub fn needed(&self, column: usize) -> Result<f64> {
        self.number(column)?.ok_or_else(|| {
            self.error(
                format!("{} is empty", self.batch.known[column]),
                "write a decimal number",
            )
        })
    }

    /// An error in this row.
    pub fn error(&self, problem: impl Into<String>, remedy: impl Into<String>) -> Error {
        Error::input(&self.place, problem, remedy)
    }

    /// An error of the library, as one in this row.
    pub fn here(&self, error: Error) -> Error {
        self.error(error.problem(), error.remedy())
    }

    fn csv(&self, values: &[f64]) -> String {
        let mut line = csv_line(self.cells.iter().map(String::as_str));
        for value in values {
            // The shortest decimal that reads back to the same f64.
            let _ = write!(line, ",{value}");
        }
        line
    }

    fn json(&self, values: &[f64]) -> String {
        let mut map = Map::new();
        for (i, (name, cell)) in self.header.names.iter().zip(&self.cells).enumerate() {
            // Known numbers are numbers; what is unknown passes as it is.
            let number = self.header.at[self.batch.words..]
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
        for (name, value) in self.batch.results.iter().zip(values) {
            map.insert((*name).to_owned(), json!(value));
        }
        Value::Object(map).to_string()
    }
}

/// The text of a file or of standard input, and what to call it.
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

fn quoted(names: &[impl AsRef<str>]) -> String {
    names
        .iter()
        .map(|name| format!("`{}`", name.as_ref()))
        .collect::<Vec<_>>()
        .join(", ")
}

/// The cells of a line, without the blanks around them; a cell in double quotes may hold commas, and "" for a quote.
///
/// A line is a row whatever is in it, so that a quote left open breaks its own row and no other.
fn cells(line: &str, place: &str) -> Result<Vec<String>> {
    if !line.contains('"') {
        return Ok(line.split(',').map(|cell| cell.trim().to_owned()).collect());
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
    Ok(cells
        .into_iter()
        .map(|cell| cell.trim().to_owned())
        .collect())
}

fn csv_line<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    let mut line = String::new();
    for (i, cell) in cells.enumerate() {
        if i > 0 {
            line.push(',');
        }
        if cell.contains([',', '"']) {
            let _ = write!(line, "\"{}\"", cell.replace('"', "\"\""));
        } else {
            line.push_str(cell);
        }
    }
    line
}
