//! Rows with named columns, printed as JSON, as CSV or as a table for people.

use serde_json::{Map, Value};
use tyndall::Result;

use crate::arguments::form::FormArgs;
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
        let join = |cells: Vec<String>| cells.join(",");
        for (i, row) in rows.iter().enumerate() {
            if i == 0 {
                out.line(&join(row.keys().cloned().collect()))?;
            }
            let cell = |v: &Value| v.as_str().map_or_else(|| v.to_string(), quoted);
            out.line(&join(row.values().map(cell).collect()))?;
        }
    } else {
        table(&mut out)?;
    }
    out.finish()
}

/// A text as a cell of CSV (RFC 4180): in quotes where it has a comma or quotes itself.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// A row of columns in this order.
pub fn columns<const N: usize>(columns: [(&str, Value); N]) -> Columns {
    let named = columns.map(|(name, value)| (name.to_owned(), value));
    named.into_iter().collect()
}
