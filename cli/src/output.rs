//! Standard output that takes a closed pipe for success, and files that nobody sees half written.

use std::io::{self, BufWriter, ErrorKind, StdoutLock, Write};
use std::path::Path;

use chrono::{DateTime, Datelike, FixedOffset, Timelike};
use tyndall::{Error, Result};

/// Buffered standard output. When its reader has gone, the rest is dropped in silence.
pub struct Out {
    writer: BufWriter<StdoutLock<'static>>,
    closed: bool,
}

/// Standard output.
pub fn stdout() -> Out {
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

    /// Forgets what is still buffered.
    pub fn discard(self) {
        // The parts are taken from the writer without a flush.
        let _ = self.writer.into_parts();
    }

    /// Writes what is still buffered.
    pub fn finish(mut self) -> Result<()> {
        if self.closed {
            return Ok(());
        }
        let result = self.writer.flush();
        self.check(result)
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

/// Writes a file beside its name and renames it into place.
pub fn save(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    let fail = |error| Error::writing(path, error);
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(fail)?;
    file.write_all(bytes).map_err(fail)?;
    // A temporary file is its owner's alone; a result is for everyone whom the umask lets in.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.as_file()
            .set_permissions(std::fs::Permissions::from_mode(0o644))
            .map_err(fail)?;
    }
    file.persist(path).map_err(|error| fail(error.error))?;
    Ok(())
}

/// A local time as RFC 3339, with as many digits of the second as it has.
pub fn time_text(time: &DateTime<FixedOffset>) -> String {
    let mut text = Vec::with_capacity(35);
    write_time(&mut text, time);
    String::from_utf8_lossy(&text).into_owned()
}

/// Writes a local time as [`time_text`] has it; UTC where the offset is not of whole minutes, as local mean time's was
/// not and RFC 3339 cannot say.
///
/// chrono's own formatting costs as much as the numbers beside it.
pub fn write_time(text: &mut Vec<u8>, time: &DateTime<FixedOffset>) {
    if time.offset().local_minus_utc() % 60 != 0 {
        return write_time(text, &time.to_utc().fixed_offset());
    }
    let year = time.year();
    // As chrono has it: a sign where four digits do not hold the year.
    let _ = if (0..=9999).contains(&year) {
        write!(text, "{year:04}")
    } else {
        write!(text, "{year:+05}")
    };
    let two = |text: &mut Vec<u8>, before: u8, value: u32| {
        text.extend([before, b'0' + (value / 10) as u8, b'0' + (value % 10) as u8]);
    };
    two(text, b'-', time.month());
    two(text, b'-', time.day());
    two(text, b'T', time.hour());
    two(text, b':', time.minute());
    two(text, b':', time.second());
    let nanos = time.nanosecond() % 1_000_000_000;
    if nanos != 0 {
        let digits = format!("{nanos:09}");
        let _ = write!(text, ".{}", digits.trim_end_matches('0'));
    }
    let offset = time.offset().local_minus_utc();
    if offset == 0 {
        text.push(b'Z');
        return;
    }
    let minutes = offset.unsigned_abs() / 60;
    two(text, if offset < 0 { b'-' } else { b'+' }, minutes / 60);
    two(text, b':', minutes % 60);
}
