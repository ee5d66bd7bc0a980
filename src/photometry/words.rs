//! A text of lines and of words that may run over lines, which knows where it is.

use crate::error::{Error, Result};
use std::borrow::Cow;

/// What an error about a broken file says to do.
pub(super) const REPAIR: &str = "repair it there, or get the file from its maker again";

/// The text of a file: UTF-8 with or without a byte order mark, anything else as Latin-1, in which every byte is a letter.
///
/// # Errors
/// [`Error::Input`] for UTF-16, which its byte order mark tells.
pub(super) fn decoded<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, str>> {
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        return Err(Error::input(
            format!("{file}:1"),
            "the text is UTF-16; expected ASCII, Latin-1 or UTF-8",
            "save it as UTF-8",
        ));
    }
    let bytes = bytes.strip_prefix(&[0xEF, 0xBB, 0xBF]).unwrap_or(bytes);
    Ok(match str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|&b| char::from(b)).collect()),
    })
}

/// What is left of a text.
#[derive(Debug, Clone)]
pub(super) struct Words<'a> {
    file: &'a str,
    rest: &'a str,
    /// The number of the line where `rest` begins, from 1.
    line: usize,
    /// That of the word or line that was taken last.
    last: usize,
}

/// Between the words of IES files; the mark that ended files under DOS is nothing either.
fn separates(c: char) -> bool {
    c.is_whitespace() || matches!(c, ',' | '\0' | '\u{1a}')
}

impl<'a> Words<'a> {
    pub fn new(file: &'a str, text: &'a str) -> Self {
        Words {
            file,
            rest: text,
            line: 1,
            last: 1,
        }
    }

    /// The next line, without its end: LF, CR LF, or CR alone.
    pub fn line(&mut self) -> Option<&'a str> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.find(['\n', '\r']).unwrap_or(self.rest.len());
        let (line, after) = self.rest.split_at(end);
        // Transfers between systems have doubled carriage returns.
        let marks = after.trim_start_matches('\r');
        self.rest = match marks.strip_prefix('\n') {
            Some(rest) => rest,
            None => after.strip_prefix('\r').unwrap_or(after),
        };
        self.last = self.line;
        self.line += 1;
        Some(line)
    }

    /// The next word, in this line or a later one.
    pub fn word(&mut self) -> Option<&'a str> {
        let start = self.rest.find(|c| !separates(c)).unwrap_or(self.rest.len());
        let (gap, rest) = self.rest.split_at(start);
        // Lines end as in `line`.
        let feeds = gap.matches('\n').count();
        let returns = match feeds {
            0 => gap.matches('\r').count(),
            _ => 0,
        };
        self.line += feeds + returns;
        if rest.is_empty() {
            self.rest = rest;
            return None;
        }
        let end = rest.find(separates).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        self.rest = after;
        self.last = self.line;
        Some(word)
    }

    /// Whether `count` more numbers can be there, each of a digit and what separates it from the next.
    pub fn has_room_for(&self, count: usize) -> bool {
        count <= self.rest.len() / 2 + 1
    }

    /// The file's name.
    pub fn file(&self) -> &'a str {
        self.file
    }

    /// Where what was taken last stands.
    pub fn place(&self) -> String {
        format!("{}:{}", self.file, self.last)
    }

    /// What is wrong with what was taken last.
    pub fn wrong(&self, problem: impl Into<String>) -> Error {
        Error::input(self.place(), problem, REPAIR)
    }

    /// What does not go together in all that was taken so far.
    pub fn because(&self, error: Error) -> Error {
        match error {
            Error::Domain { .. } => self.wrong(error.problem()),
            other => other,
        }
    }

    /// What is wrong with the line that stands so many before the one that was taken last.
    pub fn wrong_before(&self, lines: usize, problem: impl Into<String>) -> Error {
        let line = self.last.saturating_sub(lines).max(1);
        Error::input(format!("{}:{line}", self.file), problem, REPAIR)
    }

    /// The number of the line of what was taken last.
    pub fn number_of_line(&self) -> usize {
        self.last
    }

    fn ended(&mut self, what: &str) -> Error {
        self.last = self.line;
        self.wrong(format!("the file ends where {what} is expected"))
    }

    /// The next word as a number; `what` names it where it is missing or none.
    pub fn number(&mut self, what: impl Fn() -> String) -> Result<f64> {
        match self.word() {
            Some(word) => number(word).ok_or_else(|| {
                self.wrong(format!(
                    "`{}` is no number; expected {}",
                    shown(word),
                    what()
                ))
            }),
            None => Err(self.ended(&what())),
        }
    }

    /// The next word as a whole number of `least` to `most`.
    pub fn count(&mut self, what: &str, least: usize, most: usize) -> Result<usize> {
        let found = self.number(|| what.to_owned())?;
        whole(found, least, most).ok_or_else(|| {
            self.wrong(format!(
                "{what} is {found}; expected {}",
                range(least, most)
            ))
        })
    }

    /// The next line as it stands.
    pub fn text(&mut self, what: &str) -> Result<&'a str> {
        match self.line() {
            Some(line) => Ok(line.trim()),
            None => Err(self.ended(what)),
        }
    }

    /// The next line as a number, whose decimal mark may be a comma; an empty one is `empty` where that is allowed.
    pub fn line_number(&mut self, what: impl Fn() -> String, empty: Option<f64>) -> Result<f64> {
        let Some(line) = self.line() else {
            return Err(self.ended(&what()));
        };
        let line = line.trim_matches(|c: char| separates(c) && c != ',');
        if let (true, Some(value)) = (line.is_empty(), empty) {
            return Ok(value);
        }
        let point = line.replace(',', ".");
        number(&point).ok_or_else(|| {
            self.wrong(format!(
                "`{}` is no number; expected {}",
                shown(line),
                what()
            ))
        })
    }

    /// The next line as a whole number of `least` to `most`.
    pub fn line_count(&mut self, what: &str, least: usize, most: usize) -> Result<usize> {
        let found = self.line_number(|| what.to_owned(), None)?;
        whole(found, least, most).ok_or_else(|| {
            self.wrong(format!(
                "{what} is {found}; expected {}",
                range(least, most)
            ))
        })
    }
}

/// A finite number.
pub(super) fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|x: &f64| x.is_finite())
}

/// A whole number of a range.
fn whole(x: f64, least: usize, most: usize) -> Option<usize> {
    let fits = x.fract() == 0.0 && x >= least as f64 && x <= most as f64;
    fits.then_some(x as usize)
}

fn range(least: usize, most: usize) -> String {
    match most {
        usize::MAX => format!("a whole number from {least}"),
        most => format!("a whole number from {least} to {most}"),
    }
}

/// A text of strangers as messages show it: short, and without control characters.
pub(super) fn shown(text: &str) -> String {
    const MOST: usize = 40;
    let mut shown: String = text
        .chars()
        .take(MOST)
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if text.chars().nth(MOST).is_some() {
        shown.push_str("...");
    }
    shown
}
