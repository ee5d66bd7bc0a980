//! JSON for scripts: the record of a picture, and whatever else a command reports.

use super::atomic;
use crate::error::Result;
use serde::Serialize;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes `report` as indented JSON.
///
/// # Errors
/// [`crate::Error::File`] when the file cannot be written or the report is not JSON.
pub fn write(path: &Path, report: &impl Serialize) -> Result<()> {
    atomic::write(path, |file| {
        let mut writer = BufWriter::new(file);
        serde_json::to_writer_pretty(&mut writer, report)?;
        writeln!(writer)?;
        writer.flush()
    })
}
