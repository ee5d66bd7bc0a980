//! A CSV in, the same rows with results out: what `tyndall sun --batch` and `tyndall sky --batch` share.

use std::io::Read;
use std::path::Path;

use rayon::prelude::*;
use serde_json::{Map, Value, json};
use tyndall::{Error, Result};

use crate::tables::rows::{Lines, Rows};
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
    cells: Vec<&'a str>,
    place: Place<'a>,
}

/// A line of a file.
#[derive(Clone, Copy)]
struct Place<'a> {
    file: &'a str,
    line: usize,
}

impl From<Place<'_>> for String {
    fn from(place: Place) -> Self {
        format!("{}:{}", place.file, place.line)
    }
}

/// Some rows with their results, as they are printed.
struct Block {
    text: Vec<u8>,
    broken: Vec<Error>,
}

/// How many rows are computed and written to memory by one thread at a time.
const BLOCK: usize = 500;

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
                format!("start with the line {}", self.known.join(",")),
            )
        })?;
        let place = |number: usize| Place {
            file: &name,
            line: number + 1,
        };
        let header = self.header(first, place(number))?;
        let rows: Vec<(Place, &str)> = lines.map(|(i, line)| (place(i), line)).collect();
        if rows.is_empty() {
            eprintln!("note: {name} has no rows");
        }

        let mut out = stdout::lock();
        if form.json {
            out.line("[")?;
        } else {
            let mut csv = Rows::with_capacity(0);
            let names = header.names.iter().map(String::as_str);
            csv.row(names.chain(self.results.iter().copied()));
            out.bytes(&csv.into_bytes())?;
        }
        // Pieces are written while the next are computed; with --strict all must be known to be right first.
        let piece = if form.strict { rows.len() } else { 50_000 };
        let (mut broken, mut started) = (0_usize, false);
        for piece in rows.chunks(piece.max(1)) {
            let blocks: Vec<Block> = piece
                .par_chunks(BLOCK)
                .map(|rows| self.block(&header, rows, form.json, &results))
                .collect();
            for block in blocks {
                if form.json && !block.text.is_empty() {
                    out.bytes(if started { b",\n" } else { b"" })?;
                    started = true;
                }
                out.bytes(&block.text)?;
                for error in block.broken {
                    if form.strict {
                        out.discard();
                        return Err(error);
                    }
                    eprintln!("error: {error}");
                    broken += 1;
                }
            }
        }
        if form.json {
            out.line(if started { "\n]" } else { "]" })?;
        }
        out.finish()?;
        if broken > 0 {
            return Err(Error::input(
                &name,
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
    fn header(&self, line: &str, place: Place) -> Result<Header> {
        let mut lines = Lines::new();
        let names = cells(&mut lines, line, place)?;
        let names: Vec<String> = names.into_iter().map(str::to_owned).collect();
        let is = |name: &str, known: &str| name.eq_ignore_ascii_case(known);
        let mut at = Vec::with_capacity(self.known.len());
        for known in self.known {
            let mut found = (0..names.len()).filter(|&i| is(&names[i], known));
            at.push(found.next());
            if found.next().is_some() {
                return Err(Error::input(
                    place,
                    format!("the column `{known}` appears twice"),
                    "remove one",
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
                    "rename it",
                ));
            }
            eprintln!(
                "note: {}: the column `{name}` is not read, only passed on; known are {}",
                String::from(place),
                quoted(self.known)
            );
        }
        Ok(Header { names, at })
    }

    /// The results of rows of the file.
    fn block<F>(&self, header: &Header, rows: &[(Place, &str)], json: bool, results: &F) -> Block
    where
        F: Fn(&Row) -> Result<Vec<f64>>,
    {
        let mut lines = Lines::new();
        let mut csv = Rows::with_capacity(if json { 0 } else { 250 * rows.len() });
        let (mut texts, mut broken) = (Vec::new(), Vec::new());
        for &(place, line) in rows {
            let row = self.row(header, &mut lines, line, place);
            match row.and_then(|row| Ok((results(&row)?, row))) {
                Ok((values, row)) if json => texts.push(row.json(&values)),
                Ok((values, row)) => row.csv(&values, &mut csv),
                Err(error) => broken.push(error),
            }
        }
        let text = match json {
            true => texts.join(",\n").into_bytes(),
            false => csv.into_bytes(),
        };
        Block { text, broken }
    }

    fn row<'a>(
        &'a self,
        header: &'a Header,
        lines: &'a mut Lines,
        line: &str,
        place: Place<'a>,
    ) -> Result<Row<'a>> {
        let cells = cells(lines, line, place)?;
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
            .map(|i| self.cells[i])
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
                format!(
                    "{}: `{cell}` is not a finite number",
                    self.batch.known[column]
                ),
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
        Error::input(self.place, problem, remedy)
    }

    /// An error of the library, as one in this row.
    pub fn here(&self, error: Error) -> Error {
        self.error(error.problem(), error.remedy())
    }

    fn csv(&self, values: &[f64], csv: &mut Rows) {
        for cell in &self.cells {
            csv.text(cell);
        }
        for &value in values {
            csv.number(value);
        }
        csv.end();
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

/// The cells of a line.
fn cells<'l>(lines: &'l mut Lines, line: &str, place: Place) -> Result<Vec<&'l str>> {
    let problem = "a quote is not closed";
    let cells = lines.cells(line);
    cells.ok_or_else(|| Error::input(place, problem, "close it on the same line"))
}
