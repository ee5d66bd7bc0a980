//! Lines of OBJ and MTL files, as people have them.
//!
//! Keywords and numbers are ASCII; names may be in any old encoding. A line ends with LF, CR LF or CR alone, and goes on
//! after a backslash at its end. Bytes that files are padded with (NUL) are spaces; a byte order mark is skipped.

use crate::error::{Error, Result};
use crate::warning::{Lines, Warning};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The mark that some programs put at the start of UTF-8 text, and that stays inside where such files are joined.
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// A line with its number, counted from 1; one that was continued has its first part's.
pub(super) struct Line<'a> {
    pub number: usize,
    text: Cow<'a, [u8]>,
}

/// The lines of a file.
pub(super) struct LinesOf<'a> {
    rest: &'a [u8],
    /// Of the last line that was taken.
    number: usize,
}

impl<'a> LinesOf<'a> {
    /// # Errors
    /// [`Error::Input`] for UTF-16 and UTF-32, by their byte order mark or by every other byte being NUL.
    pub fn new(file: &str, bytes: &'a [u8]) -> Result<Self> {
        let start = &bytes[..bytes.len().min(64)];
        let every_other_is_nul = |from: usize| {
            start.len() >= 8
                && start
                    .iter()
                    .enumerate()
                    .all(|(i, &b)| (b == 0) == (i % 2 == from))
        };
        if start.starts_with(b"\xFF\xFE")
            || start.starts_with(b"\xFE\xFF")
            || every_other_is_nul(0)
            || every_other_is_nul(1)
        {
            return Err(Error::input(
                file,
                "it is UTF-16 text",
                "save the file as UTF-8",
            ));
        }
        Ok(LinesOf {
            rest: bytes,
            number: 0,
        })
    }

    /// What stands before the next line end.
    fn physical(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let is_end = |&b: &u8| b == b'\n' || b == b'\r';
        let end = self.rest.iter().position(is_end);
        let (line, after) = match end {
            Some(end) => (&self.rest[..end], &self.rest[end..]),
            None => (self.rest, &self.rest[self.rest.len()..]),
        };
        self.rest = after
            .strip_prefix(b"\r\n")
            .or(after.get(1..))
            .unwrap_or(after);
        Some(line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line))
    }
}

impl<'a> Iterator for LinesOf<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let mut last = self.physical()?;
        let number = self.number;
        let mut text = Cow::Borrowed(last);
        // A comment does not go on: many end in the name of a folder, `# C:\models\`.
        while last.ends_with(b"\\") && !last.contains(&b'#') {
            let Some(more) = self.physical() else { break };
            let joined = text.to_mut();
            joined.pop();
            joined.push(b' ');
            joined.extend(more);
            last = more;
        }
        Some(Line { number, text })
    }
}

/// Whether a byte separates words.
fn is_space(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | 0 | 0x0B | 0x0C | b'\n' | b'\r')
}

impl Line<'_> {
    /// The keyword, and the words after it up to a comment.
    pub fn words(&self) -> (&[u8], impl Iterator<Item = &[u8]> + Clone) {
        let mut words = self
            .text
            .split(|&b| is_space(b))
            .filter(|word| !word.is_empty());
        let keyword = words.next().unwrap_or_default();
        (keyword, words.take_while(|word| word[0] != b'#'))
    }

    /// What stands after the keyword, as a name: it may hold spaces and `#`, but not ` # `, which begins a comment.
    ///
    /// Text that is not UTF-8 is read as Latin-1, in which every byte is a letter: names stay different.
    pub fn name(&self) -> String {
        let text = trimmed(&self.text);
        let keyword = text.iter().position(|&b| is_space(b));
        let name = trimmed(&text[keyword.unwrap_or(text.len())..]);
        let comment = (0..name.len()).find(|&i| {
            name[i] == b'#'
                && (i == 0 || is_space(name[i - 1]))
                && name.get(i + 1).is_none_or(|&b| is_space(b))
        });
        let name = trimmed(&name[..comment.unwrap_or(name.len())]);
        match str::from_utf8(name) {
            Ok(name) => name.to_owned(),
            Err(_) => name.iter().map(|&b| char::from(b)).collect(),
        }
    }

    /// The line as a message shows it.
    pub fn shown(&self) -> String {
        let text = trimmed(&self.text);
        shortened(&String::from_utf8_lossy(&text[..text.len().min(200)]))
    }
}

fn trimmed(text: &[u8]) -> &[u8] {
    let start = text.iter().position(|&b| !is_space(b));
    let end = text.iter().rposition(|&b| !is_space(b));
    match (start, end) {
        (Some(start), Some(end)) => &text[start..=end],
        _ => &[],
    }
}

/// A text of others as messages show it: short, and without control characters.
pub(super) fn shortened(text: &str) -> String {
    cut(text, 60)
}

/// The first `most` characters of a text, without control characters.
pub(super) fn cut(text: &str, most: usize) -> String {
    let mut shown: String = text
        .chars()
        .take(most)
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if text.chars().nth(most).is_some() {
        shown.push_str("...");
    }
    shown
}

/// A file's name as messages show it: of a long one the end.
pub(super) fn shown_path(path: &str) -> String {
    const MOST: usize = 200;
    let shown: String = path
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    match shown.char_indices().rev().nth(MOST) {
        Some((at, _)) => format!("...{}", &shown[at..]),
        None => shown,
    }
}

/// A finite number.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let number: f64 = str::from_utf8(word).ok()?.parse().ok()?;
    number.is_finite().then_some(number)
}

/// Counts `what`; of more kinds than anyone reads, the rest are counted together.
pub(super) fn tally(counts: &mut BTreeMap<String, usize>, what: &str, times: usize) {
    const MOST: usize = 24;
    let what = shortened(what);
    let full = counts.len() >= MOST && !counts.contains_key(&what);
    *counts
        .entry(if full { "others".to_owned() } else { what })
        .or_default() += times;
}

/// What is wrong with lines of a file, by kind.
#[derive(Default)]
pub(super) struct Faults(Vec<Fault>);

/// A kind of fault, its lines, and the last one's number.
type Fault = (&'static str, Lines, usize);

impl Faults {
    /// Adds a line to those with the same `problem`; `shown` makes the example, which only the first has.
    pub fn add(&mut self, problem: &'static str, number: usize, shown: impl FnOnce() -> String) {
        const FIRST: usize = 5;
        match self.0.iter_mut().find(|fault| fault.0 == problem) {
            Some((.., last)) if *last == number => {}
            Some((_, lines, last)) => {
                *last = number;
                lines.count += 1;
                if lines.first.len() < FIRST {
                    lines.first.push(number);
                }
            }
            None => self.0.push((
                problem,
                Lines {
                    count: 1,
                    first: vec![number],
                    example: shown(),
                },
                number,
            )),
        }
    }

    /// The fault on the earliest line.
    pub fn earliest(&self) -> Option<(&'static str, &Lines)> {
        let earliest = self.0.iter().min_by_key(|fault| fault.1.first.first());
        earliest.map(|(problem, lines, _)| (*problem, lines))
    }

    pub fn into_warnings(self, file: &str) -> impl Iterator<Item = Warning> {
        self.0
            .into_iter()
            .map(move |(problem, lines, _)| Warning::DoubtfulLines {
                file: file.to_owned(),
                lines,
                problem: problem.to_owned(),
            })
    }
}
