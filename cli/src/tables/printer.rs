//! How the rows of a batch are printed: as CSV, as JSON or as a table; as they come, or when all are known to be good.

use std::io::{Read, Seek, Write};

use tempfile::SpooledTempFile;
use tyndall::{Error, Result};

use crate::arguments::form::FormArgs;
use crate::tables::rows::Rows;
use crate::tables::stdout::{self, Out};
use crate::tables::stream::Sink;
use crate::tell;

/// How a batch is printed.
#[derive(Clone, Copy)]
pub struct Form {
    /// As what.
    pub as_what: As,
    /// Stop at the first broken row and print nothing.
    pub strict: bool,
}

/// What rows are printed as.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum As {
    /// CSV.
    Csv,
    /// A list of JSON objects.
    Json,
    /// A table for people, whose columns are aligned.
    Table,
}

impl As {
    /// Of a command whose rows are CSV unless JSON is asked for.
    pub fn csv_or_json(form: FormArgs) -> Self {
        match form.json {
            true => As::Json,
            false => As::Csv,
        }
    }

    /// Of a command that prints a table unless something else is asked for.
    pub fn table_or(form: FormArgs) -> Self {
        match form.csv {
            true => As::Csv,
            false if form.json => As::Json,
            false => As::Table,
        }
    }
}

/// How many rows there were.
#[derive(Clone, Copy, Default)]
pub struct Tally {
    /// All of them.
    pub rows: usize,
    /// Those that could not be used.
    pub broken: usize,
}

/// The rows of a piece with their results, as they are printed.
pub(super) struct Block {
    pub text: Vec<u8>,
    pub rows: usize,
    pub broken: Vec<Error>,
}

/// Where blocks go, and what is counted on the way.
pub(super) struct Printer {
    out: Out,
    pub form: Form,
    /// With [`Form::strict`] everything waits here: in memory while it is little, then in a file that no one else sees.
    held: Option<SpooledTempFile>,
    pub started: bool,
    tally: Tally,
}

/// How much waits in memory [bytes].
const HELD: usize = 1 << 24;

impl Printer {
    pub fn new(form: Form) -> Self {
        Printer {
            out: stdout::lock(),
            form,
            held: form.strict.then(|| SpooledTempFile::new(HELD)),
            started: false,
            tally: Tally::default(),
        }
    }

    /// What stands before the rows. A table's head is as wide as its rows are, and comes with them.
    pub fn head(&mut self, names: &[String], results: &[&str]) -> Result<()> {
        let names = names.iter().map(String::as_str);
        match self.form.as_what {
            As::Json => self.print(b"[\n"),
            As::Table => Ok(()),
            As::Csv => {
                let mut head = Rows::with_capacity(0);
                head.row(names.chain(results.iter().copied()));
                self.print(head.bytes())
            }
        }
    }

    fn print(&mut self, text: &[u8]) -> Result<()> {
        match &mut self.held {
            Some(held) => held.write_all(text).map_err(not_held),
            None => self.out.bytes(text),
        }
    }

    pub fn finish(mut self, name: &str) -> Result<Tally> {
        if self.form.as_what == As::Json {
            self.print(if self.started { b"\n]\n" } else { b"]\n" })?;
        }
        if let Some(mut held) = self.held {
            held.rewind().map_err(not_held)?;
            let mut buffer = vec![0; 1 << 16];
            loop {
                match held.read(&mut buffer).map_err(not_held)? {
                    0 => break,
                    length => self.out.bytes(&buffer[..length])?,
                }
            }
        }
        self.out.finish()?;
        if self.tally.rows == 0 {
            tell::line("note", format!("{name} has no rows"));
        }
        let Tally { rows, broken } = self.tally;
        if broken > 0 {
            return Err(Error::input(
                name,
                format!("{broken} of {rows} rows could not be used and were left out"),
                "correct the rows named above",
            ));
        }
        Ok(self.tally)
    }
}

impl Sink<Block> for Printer {
    fn take(&mut self, block: Block) -> Result<()> {
        self.tally.rows += block.rows;
        if !block.text.is_empty() {
            if self.started && self.form.as_what == As::Json {
                self.print(b",\n")?;
            }
            self.started = true;
        }
        self.print(&block.text)?;
        for error in block.broken {
            if self.form.strict {
                return Err(error);
            }
            eprintln!("error: {}", tell::clean(&error.to_string()));
            self.tally.broken += 1;
        }
        Ok(())
    }

    fn wants_more(&self) -> bool {
        !self.out.closed()
    }

    fn idle(&mut self) -> Result<()> {
        self.out.flush()
    }
}

fn not_held(error: std::io::Error) -> Error {
    Error::failed(
        format!("results could not be held back for --strict: {error}"),
        "make room in the folder for temporary files, or leave out --strict",
    )
}
