//! Results on standard output. A reader that has had enough (`| head`) is no error.

use std::io::{self, BufWriter, ErrorKind, StdoutLock, Write};
use std::path::Path;

use tyndall::{Error, Result};

/// Prints `text` as it is.
pub fn print(text: impl AsRef<[u8]>) -> Result<()> {
    let mut out = lock();
    out.bytes(text.as_ref())?;
    out.finish()
}

/// Prints `value` as indented JSON.
pub fn print_json(value: &impl serde::Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(|e| {
        Error::failed(
            format!("the result is not JSON: {e}"),
            "please report this defect with the command",
        )
    })?;
    print(text + "\n")
}

/// Buffered standard output. When its reader has gone, the rest is dropped in silence.
pub struct Out {
    writer: BufWriter<StdoutLock<'static>>,
    closed: bool,
}

/// Standard output, to write to piece by piece.
pub fn lock() -> Out {
    Out {
        writer: BufWriter::with_capacity(1 << 16, io::stdout().lock()),
        closed: false,
    }
}

impl Out {
    /// Writes a line.
    pub fn line(&mut self, text: &str) -> Result<()> {
        self.bytes(text.as_bytes())?;
        self.bytes(b"\n")
    }

    /// Writes bytes.
    pub fn bytes(&mut self, bytes: &[u8]) -> Result<()> {
        if self.closed {
            return Ok(());
        }
        let result = self.writer.write_all(bytes);
        self.check(result)
    }

    /// Whether its reader has gone.
    pub fn closed(&self) -> bool {
        self.closed
    }

    /// Lets out what is still buffered.
    pub fn flush(&mut self) -> Result<()> {
        if self.closed {
            return Ok(());
        }
        let result = self.writer.flush();
        self.check(result)
    }

    /// Writes what is still buffered.
    pub fn finish(mut self) -> Result<()> {
        self.flush()
    }

    fn check(&mut self, result: io::Result<()>) -> Result<()> {
        match result {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.closed = true;
                Ok(())
            }
            Err(error) => Err(Error::writing(Path::new("standard output"), error)),
            Ok(()) => Ok(()),
        }
    }
}
