//! Results on standard output.

use std::io::{ErrorKind, Write};
use tyndall::Error;

/// Prints `text` as it is.
///
/// A reader that has had enough (`| head`) is no error.
pub fn print(text: &str) -> tyndall::Result<()> {
    let mut stdout = std::io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Error::writing("standard output".as_ref(), e))
        }
        _ => Ok(()),
    }
}

/// Prints `value` as indented JSON.
pub fn print_json(value: &impl serde::Serialize) -> tyndall::Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(|e| {
        Error::failed(
            format!("the result is not JSON: {e}"),
            "please report this defect with the command",
        )
    })?;
    print(&(text + "\n"))
}
