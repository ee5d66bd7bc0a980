//! Batches whose rows are answered many at once: a piece of the input is read on all cores, and then has its results.

use std::path::Path;
use std::sync::Arc;

use tyndall::{Error, Result};

use crate::tables::batch::{Batch, Header, Place, Row, cells};
use crate::tables::printer::{As, Block, Form, Printer, Tally};
use crate::tables::rows::{Lines, Rows};
use crate::tables::stream::{self, Input, Piece, Sink};
use crate::tell;

/// What finds the results of many rows at once.
pub trait Together {
    /// What a row asks for.
    type Asked: Send + 'static;

    /// Reads a row.
    fn read(row: &Row) -> Result<Self::Asked>;

    /// The results of rows, one after the other, each in the order of [`Batch::results`].
    fn of(&mut self, asked: Vec<Self::Asked>) -> Result<Vec<f64>>;
}

/// The rows of a piece as far as they are known before their results are.
struct Questions<A> {
    /// Their cells, as the beginning of what is printed; where each ends.
    text: Vec<u8>,
    ends: Vec<usize>,
    asked: Vec<A>,
    rows: usize,
    broken: Vec<Error>,
}

/// Finds the results of a piece's rows and prints them.
struct Answers<'a, T> {
    batch: &'static Batch,
    together: &'a mut T,
    names: Vec<String>,
    /// Of the table's columns, as wide as was needed so far.
    widths: Vec<usize>,
    printer: Printer,
}

impl Batch {
    /// The same for results that are found together, piece by piece: what has come in is answered before more is awaited.
    ///
    /// # Errors
    /// Those of [`Batch::run`] and of `together`.
    pub fn run_together<T: Together>(
        &'static self,
        path: &Path,
        form: Form,
        together: &mut T,
    ) -> Result<Tally> {
        let mut input = Input::open(path)?;
        let name: Arc<str> = input.name.as_str().into();
        let (header, rest) = self.begin(&mut input)?;
        let mut answers = Answers {
            batch: self,
            together,
            names: header.names.clone(),
            widths: Vec::new(),
            printer: Printer::new(form),
        };
        answers.printer.head(&header.names, self.results)?;
        let header = Arc::new(header);
        let file = Arc::clone(&name);
        let work =
            move |piece: &Piece| self.questions(&header, &file, piece, form.as_what, T::read);
        stream::run(rest, input, work, &mut answers)?;
        answers.printer.finish(&name)
    }

    /// What the rows of a piece ask for.
    fn questions<A>(
        &self,
        header: &Header,
        file: &str,
        piece: &Piece,
        as_what: As,
        read: impl Fn(&Row) -> Result<A>,
    ) -> Questions<A> {
        let mut text = Rows::with_capacity(2 * piece.bytes.len());
        let (mut asked, mut ends) = (Vec::new(), Vec::new());
        let (rows, broken) = self.rows(header, file, piece, |row| {
            asked.push(read(row)?);
            row.begin(as_what, &mut text);
            text.cut();
            ends.push(text.bytes().len());
            Ok(())
        });
        Questions {
            text: text.into_bytes(),
            ends,
            asked,
            rows,
            broken,
        }
    }
}

impl<T: Together> Answers<'_, T> {
    /// The rows of a piece with their results.
    fn text(&mut self, text: &[u8], ends: &[usize], values: &[f64]) -> Vec<u8> {
        let as_what = self.printer.form.as_what;
        let begins = std::iter::once(0).chain(ends.iter().copied());
        let cells = begins.zip(ends).map(|(from, to)| &text[from..*to]);
        let rows = cells.zip(values.chunks_exact(self.batch.results.len()));
        if as_what == As::Table {
            let rows = rows.map(|(cells, values)| {
                let line = String::from_utf8_lossy(cells);
                let results = values.iter().map(|value| in_table(*value));
                split(&line).into_iter().chain(results).collect()
            });
            return self.table(rows.collect());
        }
        let mut written = Rows::with_capacity(2 * text.len());
        for (i, (cells, values)) in rows.enumerate() {
            match as_what {
                As::Json => {
                    written.raw(if i > 0 { b",\n" } else { b"" });
                    written.raw(cells);
                }
                _ => written.verbatim(&String::from_utf8_lossy(cells)),
            }
            self.batch.end(as_what, values, &mut written);
        }
        written.into_bytes()
    }

    /// Rows whose columns are aligned, the first below their names.
    fn table(&mut self, mut rows: Vec<Vec<String>>) -> Vec<u8> {
        if !self.printer.started && !rows.is_empty() {
            let results = self.batch.results.iter().map(|name| (*name).to_owned());
            rows.insert(0, self.names.iter().cloned().chain(results).collect());
        }
        self.widths
            .resize(self.names.len() + self.batch.results.len(), 0);
        for row in &rows {
            for (width, cell) in self.widths.iter_mut().zip(row) {
                *width = (*width).max(cell.chars().count());
            }
        }
        let mut text = String::new();
        for row in &rows {
            let cells = row.iter().zip(&self.widths);
            let cells: Vec<String> = cells
                .map(|(cell, width)| format!("{cell:>width$}"))
                .collect();
            text += &tell::clean(&cells.join("  "));
            text.push('\n');
        }
        text.into_bytes()
    }
}

impl<T: Together> Sink<Questions<T::Asked>> for Answers<'_, T> {
    fn take(&mut self, questions: Questions<T::Asked>) -> Result<()> {
        let Questions {
            text,
            ends,
            asked,
            rows,
            broken,
        } = questions;
        let text = match asked.is_empty() {
            true => Vec::new(),
            false => {
                let values = self.together.of(asked)?;
                self.text(&text, &ends, &values)
            }
        };
        self.printer.take(Block { text, rows, broken })
    }

    fn wants_more(&self) -> bool {
        Sink::<Block>::wants_more(&self.printer)
    }

    fn idle(&mut self) -> Result<()> {
        Sink::<Block>::idle(&mut self.printer)
    }
}

/// A result for people.
fn in_table(value: f64) -> String {
    match value {
        0.0 => "0".into(),
        v if !(0.1..1e9).contains(&v.abs()) => format!("{v:.3e}"),
        v => format!("{v:.2}"),
    }
}

/// The cells of a line that was written as CSV.
fn split(line: &str) -> Vec<String> {
    let place = Place { file: "", line: 0 };
    let (mut lines, mut ends) = (Lines::new(), Vec::new());
    let cells = cells(&mut lines, &mut ends, line, place);
    cells.map_or(Vec::new(), |cells| {
        cells.iter().map(str::to_owned).collect()
    })
}
