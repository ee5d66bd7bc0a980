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
