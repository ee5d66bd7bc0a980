//! Rows with named columns, printed as JSON, as CSV or as a table for people.

use serde_json::{Map, Value};
use tyndall::Result;

use crate::arguments::form::FormArgs;
use crate::tables::rows::Rows;
use crate::tables::stdout::{self, Out};

/// A row of a table, by its columns' names.
pub type Columns = Map<String, Value>;

/// Prints rows as JSON or CSV, or else as the table that `table` writes.
pub fn print(
    form: FormArgs,
    rows: Vec<Columns>,
    table: impl FnOnce(&mut Out) -> Result<()>,
) -> Result<()> {
    if form.json {
        return stdout::print_json(&rows);
    }
    let mut out = stdout::lock();
    if form.csv {
        out.bytes(&csv(&rows))?;
    } else {
        table(&mut out)?;
    }
    out.finish()
}

/// Rows as CSV, below the names of the first one's columns.
pub fn csv(rows: &[Columns]) -> Vec<u8> {
    let mut csv = Rows::with_capacity(0);
    if let Some(first) = rows.first() {
        csv.row(first.keys());
    }
    let mut bytes = csv.into_bytes();
    bytes.extend(csv_below(rows));
    bytes
}

/// Rows as CSV, without names above them.
pub fn csv_below(rows: &[Columns]) -> Vec<u8> {
    let mut csv = Rows::with_capacity(0);
    for row in rows {
        for value in row.values() {
            match value {
                Value::String(text) => csv.text(text),
                other => csv.text(other.to_string()),
            }
        }
        csv.end();
    }
    csv.into_bytes()
}

/// A row of columns in this order.
pub fn columns<const N: usize>(columns: [(&str, Value); N]) -> Columns {
    let named = columns.map(|(name, value)| (name.to_owned(), value));
    named.into_iter().collect()
}

/// Some columns of rows for people, below their titles; the column `time` before them.
pub fn table(out: &mut Out, rows: &[Columns], shown: &[(&str, &str)]) -> Result<()> {
    let longest = rows.iter().map(|row| time(row).len()).max();
    let width = longest.unwrap_or(0).max(25) + 1;
    out.line(&titles(width, shown))?;
    for row in rows {
        out.line(&line(row, width, shown))?;
    }
    Ok(())
}

/// The titles of some columns, below which the column `time` is so wide.
pub fn titles(width: usize, shown: &[(&str, &str)]) -> String {
    let titles = shown.iter().map(|(_, title)| format!("{title:>14}"));
    format!("{:<width$}{}", "time", titles.collect::<String>())
}

/// A row below such titles.
pub fn line(row: &Columns, width: usize, shown: &[(&str, &str)]) -> String {
    let cells = shown.iter().map(|(name, _)| {
        let number = row.get(*name).and_then(Value::as_f64);
        format!("{:>14}", number.map_or("\u{2014}".into(), short))
    });
    format!("{:<width$}{}", time(row), cells.collect::<String>())
}

fn time(row: &Columns) -> &str {
    row.get("time").and_then(Value::as_str).unwrap_or_default()
}

/// A number in as many digits as people read.
pub fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        a if a >= 1000.0 => format!("{value:.0}"),
        a if a >= 0.1 => format!("{value:.3}"),
        _ => format!("{value:.3e}"),
    }
}
