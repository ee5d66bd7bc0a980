//! How dates, times of day, offsets, times that pass and Julian dates are written.

use chrono::{DateTime, Datelike, NaiveDate, NaiveDateTime, NaiveTime, TimeDelta, Timelike, Utc};

use super::julian::Julian;
use crate::error::{Error, Result};

/// A date, a time of day and perhaps an offset.
pub(super) struct Written {
    pub local: NaiveDateTime,
    pub offset: Option<WrittenOffset>,
}

#[derive(Clone, Copy)]
pub(super) struct WrittenOffset {
    pub seconds: i32,
    /// `Z`: universal time, of which the local offset is not known (RFC 9557), so that it contradicts no zone.
    pub zulu: bool,
}

pub(super) fn bad_time(text: &str, problem: &str) -> Error {
    bad_remedy(
        text,
        problem,
        "write a time as in 2026-06-21T18:30:00+02:00, 2026-06-21T18:30, JD2451545.0 or now",
    )
}

pub(super) fn bad_remedy(text: &str, problem: &str, remedy: &str) -> Error {
    Error::input("the time", format!("`{text}` {problem}"), remedy)
}

/// The universal time of `YYYY-MM-DDTHH:MM:SS[.fraction]` with `Z` or `+HH:MM`, as most tables have it; `None` for all else,
/// also for what is wrong. What it reads, [`parse`] reads to the same.
pub(super) fn plain(text: &str) -> Option<DateTime<Utc>> {
    let bytes = text.as_bytes();
    let digits = |from: usize, count: usize| {
        bytes.get(from..from + count)?.iter().try_fold(0, |sum, b| {
            b.is_ascii_digit().then(|| 10 * sum + u32::from(b - b'0'))
        })
    };
    let stands = |at: usize, mark: u8| bytes.get(at) == Some(&mark);
    if !(stands(4, b'-')
        && stands(7, b'-')
        && stands(10, b'T')
        && stands(13, b':')
        && stands(16, b':'))
    {
        return None;
    }
    let date = NaiveDate::from_ymd_opt(digits(0, 4)? as i32, digits(5, 2)?, digits(8, 2)?)?;
    let (mut nanos, mut at) = (0, 19);
    if stands(19, b'.') {
        let count = bytes[20..]
            .iter()
            .take_while(|b| b.is_ascii_digit())
            .count();
        if !(1..=9).contains(&count) {
            return None;
        }
        nanos = digits(20, count)? * 10_u32.pow(9 - count as u32);
        at = 20 + count;
    }
    // Not the second 60, nor the minute 60.
    let time = NaiveTime::from_hms_nano_opt(digits(11, 2)?, digits(14, 2)?, digits(17, 2)?, nanos)?;
    let sign = match bytes.get(at)? {
        b'Z' if bytes.len() == at + 1 => 0,
        b'+' => 1,
        b'-' => -1,
        _ => return None,
    };
    let local = date.and_time(time);
    if sign == 0 {
        return Some(local.and_utc());
    }
    let (hours, minutes) = (digits(at + 1, 2)?, digits(at + 4, 2)?);
    if bytes.len() != at + 6 || !stands(at + 3, b':') || hours > 23 || minutes > 59 {
        return None;
    }
    let offset = chrono::TimeDelta::minutes(sign * i64::from(60 * hours + minutes));
    Some(local.checked_sub_signed(offset)?.and_utc())
}

/// `DATE T TIME [OFFSET]`.
pub(super) fn parse(text: &str) -> Result<Written> {
    let Some((date, rest)) = text.split_once(['T', 't', ' ']) else {
        let problem = if date_alone(text)?.is_some() {
            "has no time of day"
        } else {
            "is no date and time"
        };
        return Err(bad_time(text, problem));
    };
    let date = parse_date(date, text)?;
    let rest = rest.trim();
    let (clock, offset) = match rest.find(['Z', 'z', '+', '-']) {
        Some(at) => (
            rest[..at].trim_end(),
            Some(parse_offset(&rest[at..], text)?),
        ),
        None => (rest, None),
    };
    Ok(Written {
        local: date.and_time(parse_clock(clock, text)?),
        offset,
    })
}

/// The civil date in a text that is a date alone (`2026-06-21`), or `None` if it is not of that form.
///
/// # Errors
/// [`Error::Input`] for a date that does not exist.
pub fn date_alone(text: &str) -> Result<Option<NaiveDate>> {
    let text = text.trim();
    let unsigned = text.strip_prefix(['-', '+']).unwrap_or(text);
    let parts: Vec<&str> = unsigned.split('-').collect();
    if parts.len() != 3
        || !parts
            .iter()
            .all(|part| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit()))
    {
        return Ok(None);
    }
    parse_date(text, text).map(Some)
}

/// `[+-]YEAR-MM-DD`, proleptic Gregorian; a year without sign has four digits.
pub(super) fn parse_date(date: &str, text: &str) -> Result<NaiveDate> {
    let form = || bad_time(text, "is no date and time");
    let (negative, unsigned) = match date.as_bytes().first() {
        Some(b'-') => (true, &date[1..]),
        Some(b'+') => (false, &date[1..]),
        _ => (false, date),
    };
    let parts: Vec<&str> = unsigned.split('-').collect();
    let [year, month, day] = parts[..] else {
        return Err(form());
    };
    let digits = |s: &str, least: usize, most: usize| {
        ((least..=most).contains(&s.len()) && s.bytes().all(|b| b.is_ascii_digit()))
            .then(|| s.parse::<i32>().ok())
            .flatten()
    };
    let least = if unsigned.len() == date.len() { 4 } else { 1 };
    let year = digits(year, least, 6).ok_or_else(form)?;
    let year = if negative { -year } else { year };
    let month = digits(month, 2, 2).ok_or_else(form)?;
    let day = digits(day, 2, 2).ok_or_else(form)?;
    NaiveDate::from_ymd_opt(year, month as u32, day as u32).ok_or_else(|| {
        let problem = match last_day(year, month as u32) {
            Some(last) => format!("is impossible: month {month} of {year} has {last} days"),
            None => format!("is impossible: there is no month {month}"),
        };
        bad_time(text, &problem)
    })
}

pub(super) fn last_day(year: i32, month: u32) -> Option<u32> {
    let first = NaiveDate::from_ymd_opt(year, month, 1)?;
    Some(
        (28..=31)
            .rev()
            .find(|&day| first.with_day(day).is_some())
            .unwrap_or(28),
    )
}

/// `HH:MM[:SS[.fraction]]`; second 60 is chrono's leap second.
pub(super) fn parse_clock(clock: &str, text: &str) -> Result<NaiveTime> {
    let form = || bad_time(text, "has no time of day of the form HH:MM:SS");
    let parts: Vec<&str> = clock.split(':').collect();
    if !(2..=3).contains(&parts.len()) {
        return Err(form());
    }
    let two = |s: &str| {
        (s.len() == 2 && s.bytes().all(|b| b.is_ascii_digit()))
            .then(|| s.parse::<u32>().ok())
            .flatten()
    };
    let hour = two(parts[0]).ok_or_else(form)?;
    let minute = two(parts[1]).ok_or_else(form)?;
    let (second, nanos) = match parts.get(2) {
        None => (0, 0),
        Some(seconds) => {
            let (whole, fraction) = seconds.split_once(['.', ',']).unwrap_or((seconds, "0"));
            if fraction.is_empty() || !fraction.bytes().all(|b| b.is_ascii_digit()) {
                return Err(form());
            }
            let nanos = format!("{fraction:0<9}")[..9]
                .parse::<u32>()
                .map_err(|_| form())?;
            (two(whole).ok_or_else(form)?, nanos)
        }
    };
    let time = if second == 60 && minute == 59 {
        NaiveTime::from_hms_nano_opt(hour, minute, 59, 1_000_000_000 + nanos)
    } else {
        NaiveTime::from_hms_nano_opt(hour, minute, second, nanos)
    };
    time.ok_or_else(|| {
        bad_time(
            text,
            "is impossible: hours run to 23, minutes and seconds to 59",
        )
    })
}

/// Leap seconds end a day (or a month) of UTC.
pub(super) fn check_leap_second(text: &str, utc: DateTime<Utc>) -> Result<()> {
    if utc.nanosecond() >= 1_000_000_000 && (utc.hour(), utc.minute()) != (23, 59) {
        return Err(bad_time(
            text,
            "has a second 60, which only 23:59 UTC can have",
        ));
    }
    Ok(())
}

/// `Z`, `+HH:MM`, `+HHMM`, `+HH` or `+HH:MM:SS`.
pub(super) fn parse_offset(offset: &str, text: &str) -> Result<WrittenOffset> {
    if offset.eq_ignore_ascii_case("z") {
        return Ok(WrittenOffset {
            seconds: 0,
            zulu: true,
        });
    }
    let form = || bad_time(text, "has an offset that is not of the form +HH:MM");
    let sign = if offset.starts_with('-') { -1 } else { 1 };
    let body = offset.get(1..).ok_or_else(form)?;
    let digits: String = body.chars().filter(|&c| c != ':').collect();
    let colons_right = body.len() == digits.len() || body.split(':').all(|part| part.len() == 2);
    if !offset.starts_with(['+', '-'])
        || !colons_right
        || !digits.bytes().all(|b| b.is_ascii_digit())
        || ![2, 4, 6].contains(&digits.len())
    {
        return Err(form());
    }
    let at = |i: usize| {
        digits
            .get(i..i + 2)
            .map_or(0, |s| s.parse::<i32>().unwrap_or(0))
    };
    let (hours, minutes, seconds) = (at(0), at(2), at(4));
    if hours > 25 || minutes > 59 || seconds > 59 {
        return Err(bad_time(text, "has an impossible offset"));
    }
    Ok(WrittenOffset {
        seconds: sign * (hours * 3600 + minutes * 60 + seconds),
        zulu: false,
    })
}

/// The digits of `JD2451545.0`.
pub(super) fn julian_digits(text: &str) -> Option<&str> {
    let prefix = text.get(..2)?;
    prefix.eq_ignore_ascii_case("jd").then(|| text[2..].trim())
}

/// A Julian date from its digits; whole days and fraction are read apart, so that no digit is lost.
pub(super) fn julian_date(text: &str, digits: &str) -> Result<Julian> {
    let form = || bad_time(text, "is no Julian date");
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let decimal = |s: &str| s.bytes().all(|b| b.is_ascii_digit());
    let unsigned = whole.strip_prefix(['-', '+']).unwrap_or(whole);
    if unsigned.is_empty() || !decimal(unsigned) || !decimal(fraction) {
        return Err(form());
    }
    let day: f64 = whole.parse().map_err(|_| form())?;
    let part: f64 = format!("0.{fraction}0").parse().map_err(|_| form())?;
    Ok(Julian::new(
        day,
        if whole.starts_with('-') { -part } else { part },
    ))
}

/// A time that passes, to the nanosecond: numbers and their units (`ms`, `s`, `m` or `min`, `h`, and `d` of 24 hours), the largest first or
/// not, as in `30s`, `1h30m`, `1.5h`, `10 min` and `1e3s`. Nothing for other texts.
pub fn duration(text: &str) -> Option<TimeDelta> {
    let mut rest = text.trim();
    let mut sum = 0.0;
    if rest.is_empty() {
        return None;
    }
    while !rest.is_empty() {
        let (number, after) = rest.split_at(number_length(rest));
        let after = after.trim_start();
        let end = after.find(|c: char| !c.is_ascii_alphabetic());
        let (unit, after) = after.split_at(end.unwrap_or(after.len()));
        let milliseconds = match unit {
            "ms" => 1.0,
            "s" | "sec" => 1e3,
            "m" | "min" => 6e4,
            "h" => 3.6e6,
            "d" => 8.64e7,
            _ => return None,
        };
        sum += number.parse::<f64>().ok()? * milliseconds;
        rest = after.trim_start();
    }
    if sum > 1e15 {
        return None;
    }
    // What is written in whole milliseconds is read so, whatever the sum's last bits.
    let whole = sum.round();
    match (whole - sum).abs() <= f64::max(1e-7, 4.0 * f64::EPSILON * sum) {
        true => TimeDelta::try_milliseconds(whole as i64),
        false => {
            let nanoseconds = 1e6 * (sum - sum.floor());
            let rest = TimeDelta::nanoseconds(nanoseconds.round() as i64);
            TimeDelta::try_milliseconds(sum.floor() as i64)?.checked_add(&rest)
        }
    }
}

/// How many bytes of a text are a number without a sign, perhaps with an exponent.
fn number_length(text: &str) -> usize {
    let digits = |text: &str, more: &str| {
        let is_part = |c: char| c.is_ascii_digit() || more.contains(c);
        text.find(|c| !is_part(c)).unwrap_or(text.len())
    };
    let length = digits(text, ".");
    let Some(exponent) = text[length..].strip_prefix(['e', 'E']) else {
        return length;
    };
    let unsigned = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
    match digits(unsigned, "") {
        0 => length,
        count => text.len() - unsigned.len() + count,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chrono::TimeDelta;
    use proptest::prelude::*;

    /// The long way to universal time.
    fn read(text: &str) -> Option<DateTime<Utc>> {
        let written = parse(text).ok()?;
        let offset = TimeDelta::seconds(i64::from(written.offset?.seconds));
        Some(written.local.checked_sub_signed(offset)?.and_utc())
    }

    #[test]
    fn the_short_way_leads_where_the_long_way_does() {
        for text in [
            "2026-06-21T18:30:00Z",
            "0000-01-01T00:00:00+23:59",
            "9999-12-31T23:59:59.999999999-14:00",
            "2024-02-29T00:00:00.5Z",
        ] {
            assert_eq!(plain(text), read(text), "{text}");
            assert!(plain(text).is_some(), "{text}");
        }
        for text in [
            "2023-02-29T00:00:00Z",
            "2016-12-31T23:59:60Z",
            "2026-06-21T24:00:00Z",
            "2026-06-21T18:30:00",
            "2026-06-21T18:30Z",
            "2026-06-21 18:30:00Z",
            "2026-06-21T18:30:00.Z",
            "2026-06-21T18:30:00Zx",
            "2026-06-21T18:30:00+1:00",
            "+2026-06-21T18:30:00Z",
            "2026-06-21T18:30:00+24:00",
            "2026-06-21T18:30:00.1234567891Z",
            "",
            "\u{e9}\u{e9}\u{e9}\u{e9}\u{e9}\u{e9}\u{e9}\u{e9}\u{e9}\u{e9}",
        ] {
            assert_eq!(plain(text), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn what_the_short_way_reads_the_long_way_reads_the_same(
            text in "[0-2][0-9]{3}-[01][0-9]-[0-3][0-9]T[0-2][0-9]:[0-6][0-9]:[0-6][0-9](\\.[0-9]{0,10})?(Z|[+-][0-2][0-9]:[0-6][0-9])?"
        ) {
            if let Some(utc) = plain(&text) {
                prop_assert_eq!(Some(utc), read(&text));
            }
        }
    }
}
