//! Rows of CSV (RFC 4180): a cell stands in quotes where it must, and nowhere else.

use std::io::Write;

use csv_core::ReadRecordResult;

/// Rows of two cells or more (an only one that is empty would be no row), written to memory.
pub struct Rows {
    writer: csv_core::Writer,
    bytes: Vec<u8>,
    /// Whether the row that is written has a cell.
    begun: bool,
}

impl Rows {
    /// No rows, with room for so many bytes.
    pub fn with_capacity(bytes: usize) -> Self {
        Self {
            writer: csv_core::Writer::new(),
            bytes: Vec::with_capacity(bytes),
            begun: false,
        }
    }

    /// A cell of text.
    pub fn text(&mut self, cell: impl AsRef<[u8]>) {
        let cell = cell.as_ref();
        self.begin_cell();
        if !self.writer.should_quote(cell) {
            return self.bytes.extend(cell);
        }
        // Room for a cell of quotes alone: each is written twice, and one more at either end.
        let start = self.bytes.len();
        self.bytes.resize(start + 2 * cell.len() + 2, 0);
        let (_, _, length) = self.writer.field(cell, &mut self.bytes[start..]);
        let (_, closing) = self.writer.finish(&mut self.bytes[start + length..]);
        self.bytes.truncate(start + length + closing);
    }

    /// A cell with the shortest decimal that reads back to the same f64. It needs no quotes, and is most of what is
    /// written, so that the writer is not asked.
    pub fn number(&mut self, value: f64) {
        self.begin_cell();
        // As `{}` prints it, which is slow; outside, zmij would write an exponent.
        if value == 0.0 || (1e-4..1e15).contains(&value.abs()) {
            let mut buffer = zmij::Buffer::new();
            let text = buffer.format_finite(value);
            let whole = text.strip_suffix(".0").unwrap_or(text);
            return self.bytes.extend_from_slice(whole.as_bytes());
        }
        // Writing to memory does not fail.
        let _ = write!(self.bytes, "{value}");
    }

    /// Cells as they stand, with commas between them.
    pub fn verbatim(&mut self, cells: &str) {
        self.begin_cell();
        self.bytes.extend_from_slice(cells.as_bytes());
    }

    /// Bytes that are no cells.
    pub fn raw(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// The rows so far.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn begin_cell(&mut self) {
        if self.begun {
            self.bytes.push(b',');
        }
        self.begun = true;
    }

    /// What follows is no cell of this row.
    pub fn cut(&mut self) {
        self.begun = false;
    }

    /// The end of a row.
    pub fn end(&mut self) {
        self.bytes.push(b'\n');
        self.begun = false;
    }

    /// A row of texts.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl AsRef<[u8]>>) {
        for cell in cells {
            self.text(cell);
        }
        self.end();
    }

    /// The rows as they are written.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reads lines as rows, one at a time.
///
/// A line is a row whatever is in it, so that a quote left open breaks its own row and no other. A reader of the whole
/// file would take all that follows for one cell.
pub struct Lines {
    reader: csv_core::Reader,
    line: Vec<u8>,
    cells: Vec<u8>,
    ends: Vec<usize>,
}

impl Lines {
    pub fn new() -> Self {
        // Lines are already told apart: a carriage return within one is part of a cell.
        let newline = csv_core::Terminator::Any(b'\n');
        Self {
            reader: csv_core::ReaderBuilder::new().terminator(newline).build(),
            line: Vec::new(),
            cells: Vec::new(),
            ends: Vec::new(),
        }
    }

    /// Where each cell of a line begins and ends in the text that is given; `None` where a quote is not closed.
    pub fn cells(&mut self, line: &str, cells: &mut Vec<(usize, usize)>) -> Option<&str> {
        self.line.clear();
        self.line.extend(line.as_bytes());
        self.line.push(b'\n');
        // Enough for a line of anything, even of commas alone.
        let most = self.line.len() + 1;
        if self.cells.len() < most {
            self.cells.resize(most, 0);
            self.ends.resize(most, 0);
        }
        let (result, _, length, count) =
            self.reader
                .read_record(&self.line, &mut self.cells, &mut self.ends);
        if result != ReadRecordResult::Record {
            self.reader.reset();
            return None;
        }
        // Cells are cut at commas and quotes, never within a character.
        let text = std::str::from_utf8(&self.cells[..length]).ok()?;
        let mut start = 0;
        cells.extend(self.ends[..count].iter().map(|&end| {
            let cell = (start, end);
            start = end;
            cell
        }));
        Some(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_stand_where_they_must() {
        let mut rows = Rows::with_capacity(0);
        rows.row(["a b", "a,b", "say \"a\"", "\"\"", "two\nlines", ""]);
        rows.number(0.1);
        rows.number(1e300);
        rows.end();
        let text = String::from_utf8(rows.into_bytes()).expect("text");
        let (first, second) = text.rsplit_once("\n0.1,").expect("two rows");
        assert_eq!(
            first,
            "a b,\"a,b\",\"say \"\"a\"\"\",\"\"\"\"\"\",\"two\nlines\","
        );
        assert_eq!(second.trim_end().parse(), Ok(1e300));
    }

    #[test]
    fn numbers_read_back_and_are_as_short_as_they_can_be() {
        let same = |value: f64| {
            let mut rows = Rows::with_capacity(0);
            rows.number(value);
            let text = String::from_utf8_lossy(rows.bytes()).into_owned();
            assert_eq!(
                text.parse().map(f64::to_bits),
                Ok(value.to_bits()),
                "{text}"
            );
            // The standard library's are; of two that are as near it may take the other one.
            assert_eq!(text.len(), value.to_string().len(), "{text} {value}");
        };
        for value in [
            0.0, -0.0, 1.0, -1.0, 0.1, 1e15, 1e16, 1e17, 1e21, 1e300, 1e-4, 1e-5, 1e-6, 5e-324,
        ] {
            same(value);
            same(-value);
        }
        same(f64::INFINITY);
        // A walk over all exponents and many digits: xorshift (Marsaglia 2003).
        let mut bits = 88_172_645_463_325_252_u64;
        for _ in 0..300_000 {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            let value = f64::from_bits(bits);
            if value.is_finite() {
                same(value);
            }
            // And what tables hold: degrees, with any digits and with few.
            same((bits % 360_000_000) as f64 * 1e-6);
            same(360.0 * (bits as f64 / u64::MAX as f64));
        }
    }

    #[test]
    fn a_line_is_a_row() {
        let mut lines = Lines::new();
        let read = |lines: &mut Lines, line: &str| {
            let mut ends = Vec::new();
            let text = lines.cells(line, &mut ends)?;
            let cells = ends.iter().map(|&(start, end)| text[start..end].trim());
            Some(cells.map(str::to_owned).collect::<Vec<_>>())
        };
        for (line, cells) in [
            ("a, b ,", &["a", "b", ""][..]),
            ("\"a, b\",\"say \"\"c\"\"\"", &["a, b", "say \"c\""]),
            ("\"ä\" ,\u{feff}ö", &["ä", "\u{feff}ö"]),
            (",,,", &["", "", "", ""]),
        ] {
            assert_eq!(read(&mut lines, line).expect(line), cells);
            // What is wrong with one row is forgotten with the next.
            assert_eq!(read(&mut lines, "a,\"b,c"), None);
        }
    }
}
