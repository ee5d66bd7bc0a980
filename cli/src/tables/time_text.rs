//! How local times are written.

use std::io::Write;

use chrono::{DateTime, Datelike, FixedOffset, Timelike};

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
