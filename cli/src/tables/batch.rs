//! A CSV in, the same rows with results out: what `tyndall sun --batch`, `tyndall sky --batch` and `tyndall daylight` share.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Map, Value, json};
use tyndall::error::nearest;
use tyndall::{Error, Result};

use crate::tables::printer::{As, Block, Form, Printer};
use crate::tables::rows::{Lines, Rows};
use crate::tables::stream::{self, Input, LONGEST, Piece};
use crate::tell;

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

/// What finds the results of one row after another; it may remember what the last one needed.
pub trait Results: Clone + Send + 'static {
    /// Fills in the results, in the order of [`Batch::results`].
    fn of(&mut self, row: &Row, results: &mut [f64]) -> Result<()>;
}

/// A row of the file, with the place that its errors name.
pub struct Row<'a> {
    batch: &'a Batch,
    header: &'a Header,
    cells: Cells<'a>,
    place: Place<'a>,
}

/// The cells of a row: where each begins and ends in a text.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a> {
    text: &'a str,
    ends: &'a [(usize, usize)],
    /// Whether they stand in the text as they are printed: no quotes, no blanks around them.
    plain: bool,
}

impl<'a> Cells<'a> {
    fn get(&self, i: usize) -> &'a str {
        let (start, end) = self.ends[i];
        &self.text[start..end]
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &'a str> {
        let text = self.text;
        self.ends.iter().map(move |&(start, end)| &text[start..end])
    }
}

/// A line of a file.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    pub(super) file: &'a str,
    pub(super) line: usize,
}

impl From<Place<'_>> for String {
    fn from(place: Place) -> Self {
        format!("{}:{}", place.file, place.line)
    }
}

pub(super) struct Header {
    pub(super) names: Vec<String>,
    /// Where each known column stands.
    at: Vec<Option<usize>>,
}

impl Batch {
    /// Prints the rows of `path` (`-` is standard input) with their results, as they come.
    ///
    /// # Errors
    /// A file that cannot be read, a missing column; at the end, if rows were broken: these are named on standard error
    /// and left out.
    pub fn run(&'static self, path: &Path, form: Form, results: impl Results) -> Result<()> {
        let mut input = Input::open(path)?;
        let name: Arc<str> = input.name.as_str().into();
        let (header, rest) = self.begin(&mut input)?;
        let mut printer = Printer::new(form);
        printer.head(&header.names, self.results)?;
        let header = Arc::new(header);
        let mut results = results;
        let file = Arc::clone(&name);
        let work =
            move |piece: &Piece| self.block(&header, &file, piece, form.as_what, &mut results);
        stream::run(rest, input, work, &mut printer)?;
        printer.finish(&name).map(drop)
    }

    /// Reads the first line that is not empty, and gives what stands behind it too.
    pub(super) fn begin(&self, input: &mut Input) -> Result<(Header, Piece)> {
        let mut start = true;
        while let Some(mut piece) = input.next()? {
            if start {
                start = false;
                refuse_utf16(&piece.bytes, &input.name)?;
                if piece.bytes.starts_with(b"\xef\xbb\xbf") {
                    piece.bytes.drain(..3);
                }
            }
            while !piece.bytes.is_empty() {
                let end = piece.bytes.iter().position(|byte| *byte == b'\n');
                let line: Vec<u8> = piece
                    .bytes
                    .drain(..end.map_or(piece.bytes.len(), |i| i + 1))
                    .collect();
                let place = Place {
                    file: &input.name,
                    line: piece.first,
                };
                let text = utf8(&line, place)?.trim();
                piece.first += 1;
                if !text.is_empty() {
                    return Ok((self.header(text, place)?, piece));
                }
            }
        }
        Err(Error::input(
            &input.name,
            "the file is empty",
            format!("start with the line {}", self.known.join(",")),
        ))
    }

    /// Finds the columns.
    fn header(&self, line: &str, place: Place) -> Result<Header> {
        let (mut lines, mut ends) = (Lines::new(), Vec::new());
        let cells = cells(&mut lines, &mut ends, line, place)?;
        let names: Vec<String> = cells.iter().map(str::to_owned).collect();
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
                    "the first line names the columns, with commas{}: {} and perhaps {}",
                    match line.contains(';') || line.contains('\t') {
                        true => " (not semicolons or tabs)",
                        false => "",
                    },
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
            let near = nearest(&name.to_ascii_lowercase(), self.known.iter().copied());
            let near = near.map_or(String::new(), |near| format!("did you mean `{near}`? "));
            let note = format!(
                "{}: the column `{name}` is not read, only passed on; {near}known are {}",
                String::from(place),
                quoted(self.known)
            );
            tell::line("note", note);
        }
        Ok(Header { names, at })
    }

    /// The results of the rows of a piece.
    fn block(
        &self,
        header: &Header,
        file: &str,
        piece: &Piece,
        as_what: As,
        results: &mut impl Results,
    ) -> Block {
        let mut values = vec![0.0; self.results.len()];
        let mut text = Rows::with_capacity(5 * piece.bytes.len());
        let mut started = false;
        let (rows, broken) = self.rows(header, file, piece, |row| {
            results.of(row, &mut values)?;
            if as_what == As::Json {
                text.raw(if started { b",\n" } else { b"" });
            }
            started = true;
            row.begin(as_what, &mut text);
            self.end(as_what, &values, &mut text);
            Ok(())
        });
        Block {
            text: text.into_bytes(),
            rows,
            broken,
        }
    }

    /// Does something with every row of a piece; how many there are, and what was wrong with some.
    pub(super) fn rows(
        &self,
        header: &Header,
        file: &str,
        piece: &Piece,
        mut each: impl FnMut(&Row) -> Result<()>,
    ) -> (usize, Vec<Error>) {
        let (mut lines, mut ends) = (Lines::new(), Vec::new());
        let (mut count, mut broken) = (0, Vec::new());
        for (i, line) in piece.bytes.split(|byte| *byte == b'\n').enumerate() {
            let line_number = piece.first + i;
            let place = Place {
                file,
                line: line_number,
            };
            let line = match utf8(line, place) {
                Ok(line) => line.strip_suffix('\r').unwrap_or(line),
                Err(error) => {
                    count += 1;
                    broken.push(error);
                    continue;
                }
            };
            if line.trim_start().is_empty() {
                continue;
            }
            count += 1;
            let row = self.row(header, &mut lines, &mut ends, line, place);
            if let Err(error) = row.and_then(|row| each(&row)) {
                broken.push(error);
            }
        }
        (count, broken)
    }

    /// Writes results behind the cells of a row ([`Row::begin`]).
    pub(super) fn end(&self, as_what: As, values: &[f64], rows: &mut Rows) {
        if as_what == As::Json {
            for (name, value) in self.results.iter().zip(values) {
                rows.raw(format!(",{}:{}", json!(name), json!(value)).as_bytes());
            }
            return rows.raw(b"}");
        }
        for &value in values {
            rows.number(value);
        }
        rows.end();
    }

    fn row<'a>(
        &'a self,
        header: &'a Header,
        lines: &'a mut Lines,
        ends: &'a mut Vec<(usize, usize)>,
        line: &'a str,
        place: Place<'a>,
    ) -> Result<Row<'a>> {
        let cells = cells(lines, ends, line, place)?;
        if cells.ends.len() != header.names.len() {
            return Err(Error::input(
                place,
                format!(
                    "{} cells where the first line has {}",
                    cells.ends.len(),
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
            .map(|i| self.cells.get(i))
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

    /// Writes the cells, as the beginning of what is printed.
    pub(super) fn begin(&self, as_what: As, rows: &mut Rows) {
        if as_what == As::Json {
            let mut object = self.json().to_string();
            object.pop();
            return rows.raw(object.as_bytes());
        }
        if self.cells.plain {
            rows.verbatim(self.cells.text);
        } else {
            for cell in self.cells.iter() {
                rows.text(cell);
            }
        }
    }

    fn json(&self) -> Value {
        let mut map = Map::new();
        for (i, (name, cell)) in self.header.names.iter().zip(self.cells.iter()).enumerate() {
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
        Value::Object(map)
    }
}

/// A line's text.
fn utf8<'a>(line: &'a [u8], place: Place) -> Result<&'a str> {
    if line.len() > LONGEST {
        let problem = format!("the line is longer than {LONGEST} bytes");
        return Err(Error::input(place, problem, "give shorter cells"));
    }
    std::str::from_utf8(line).map_err(|_| {
        Error::input(
            place,
            "the line is not UTF-8 text",
            "save the file as UTF-8 (\"CSV UTF-8\" in a spreadsheet)",
        )
    })
}

/// Every other byte of English in UTF-16 is 0, with or without a mark of byte order.
fn refuse_utf16(bytes: &[u8], name: &str) -> Result<()> {
    let marked = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    let unmarked = matches!(bytes, [0, a, 0, b, ..] | [a, 0, b, 0, ..] if *a != 0 && *b != 0);
    if marked || unmarked {
        return Err(Error::input(
            name,
            "the file is UTF-16 text",
            "save it as UTF-8 (\"CSV UTF-8\" in a spreadsheet)",
        ));
    }
    Ok(())
}

fn quoted(names: &[impl AsRef<str>]) -> String {
    names
        .iter()
        .map(|name| format!("`{}`", name.as_ref()))
        .collect::<Vec<_>>()
        .join(", ")
}

/// The cells of a line, without the blanks around them. Lines without quotes, which most are, are cut at their commas.
pub(super) fn cells<'a>(
    lines: &'a mut Lines,
    ends: &'a mut Vec<(usize, usize)>,
    line: &'a str,
    place: Place,
) -> Result<Cells<'a>> {
    ends.clear();
    let (mut start, mut quoted) = (0, false);
    for (i, byte) in line.bytes().enumerate() {
        match byte {
            b',' => {
                ends.push((start, i));
                start = i + 1;
            }
            b'"' | b'\r' => quoted = true,
            _ => {}
        }
    }
    ends.push((start, line.len()));
    let mut text = line;
    if quoted {
        ends.clear();
        let problem = "a quote is not closed";
        let cells = lines.cells(line, ends);
        text = cells.ok_or_else(|| Error::input(place, problem, "close it on the same line"))?;
    }
    let mut plain = !quoted;
    for (start, end) in ends.iter_mut() {
        let cell = &text[*start..*end];
        let solid = |byte: Option<&u8>| byte.is_none_or(|b| b.is_ascii_graphic());
        if solid(cell.as_bytes().first()) && solid(cell.as_bytes().last()) {
            continue;
        }
        let inner = cell.trim_start();
        let from = *start + (cell.len() - inner.len());
        let to = from + inner.trim_end().len();
        plain &= (from, to) == (*start, *end);
        (*start, *end) = (from, to);
    }
    Ok(Cells { text, ends, plain })
}
