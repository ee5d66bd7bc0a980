//! The instants of a table: a start, and one after each step up to an end.

use chrono::{DateTime, SecondsFormat, TimeDelta, Utc};
use tyndall::ephemeris::Site;
use tyndall::ephemeris::civil::{self, Moment, Reading, Zone};
use tyndall::{Error, Result};

/// No more rows than these of a range: they are made before the first is printed.
const MOST_ROWS: u64 = 100_000;

/// A range of times as flags give it, and the clock by which it is read.
pub struct Range {
    /// Its instants.
    pub steps: Steps,
    /// The clock of its beginning.
    pub clock: Zone,
}

impl Range {
    /// That from one text up to, not including, another, each read by `moment`; a date alone begins with its first moment. A step is an
    /// hour unless one is given.
    ///
    /// # Errors
    /// Those of reading; [`Error::Input`] where the end is not after the beginning; [`Error::Domain`] for too many steps.
    pub fn read(
        [from, until]: [&str; 2],
        step: Option<TimeDelta>,
        site: &Site,
        zone: Option<&str>,
        moment: impl Fn(&str) -> Result<Moment>,
    ) -> Result<Self> {
        let read = |text: &str| -> Result<(DateTime<Utc>, Zone)> {
            Ok(match civil::date_alone(text)? {
                Some(date) => {
                    let zone = civil::zone_for(zone, site, date)?;
                    (zone.day(date)?.0, zone)
                }
                None => {
                    let moment = moment(text)?;
                    (moment.utc, moment.clock)
                }
            })
        };
        let ((start, clock), (end, _)) = (read(from)?, read(until)?);
        if end <= start {
            return Err(Error::input(
                "--until",
                format!("{until} is not after --time"),
                "give a later time",
            ));
        }
        let steps = Steps::new(start, end, step.unwrap_or(TimeDelta::hours(1)));
        if steps.count > MOST_ROWS {
            return Err(Error::domain(
                "the number of rows",
                steps.count,
                format!("1 to {MOST_ROWS}"),
                "give a larger --step, or a part of the range",
            ));
        }
        Ok(Range { steps, clock })
    }

    /// One of its instants, counted from zero, as [`tyndall::conditions::Conditions::at`] reads it: by the clock of its beginning.
    pub fn text(&self, number: u64) -> String {
        let utc = self.steps.at(number);
        let time = utc.to_rfc3339_opts(SecondsFormat::AutoSi, true);
        match (self.clock.name(), self.clock.offset_seconds(utc)) {
            (Some(name), _) => format!("{time}[{name}]"),
            (None, offset) if self.clock.source() == "UTC" && offset == 0 => format!("{time}[UTC]"),
            (None, offset) => format!("{time}[{}]", civil::offset_text(offset)),
        }
    }

    /// One of its moments, counted from zero.
    ///
    /// # Errors
    /// [`Error::Domain`] outside the years of ephemerides.
    pub fn moment(&self, number: u64, reading: &Reading) -> Result<Moment> {
        Moment::at(self.steps.at(number), &self.clock, reading)
    }
}

/// Instants from `start` on, `step` apart, before an end.
#[derive(Debug, Clone, Copy)]
pub struct Steps {
    start: DateTime<Utc>,
    /// [ns], above zero.
    step: i128,
    /// How many there are.
    pub count: u64,
}

impl Steps {
    /// Those from `start` up to, not including, `end`, which is later.
    pub fn new(start: DateTime<Utc>, end: DateTime<Utc>, step: TimeDelta) -> Self {
        let step = nanoseconds(step).max(1);
        let count = (nanoseconds(end - start) + step - 1) / step;
        Steps {
            start,
            step,
            count: u64::try_from(count).unwrap_or(0),
        }
    }

    /// The time from one to the next [s].
    pub fn step_seconds(&self) -> f64 {
        self.step as f64 / 1e9
    }

    /// Whether some of them are within half a day of each other.
    pub fn are_close(&self) -> bool {
        self.step <= nanoseconds(TimeDelta::hours(12))
    }

    /// One of them, counted from zero; also those that would follow the last. Nanoseconds of centuries do not fit into 64 bits.
    pub fn at(&self, number: u64) -> DateTime<Utc> {
        let total = self.step * i128::from(number);
        self.start
            + TimeDelta::seconds((total / 1_000_000_000) as i64)
            + TimeDelta::nanoseconds((total % 1_000_000_000) as i64)
    }
}

fn nanoseconds(span: TimeDelta) -> i128 {
    i128::from(span.num_seconds()) * 1_000_000_000 + i128::from(span.subsec_nanos())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_is_not_among_them_and_nothing_is_rounded() {
        let start = DateTime::<Utc>::UNIX_EPOCH;
        let of = |end, step| Steps::new(start, start + TimeDelta::seconds(end), step);
        assert_eq!(of(60, TimeDelta::seconds(20)).count, 3);
        assert_eq!(of(61, TimeDelta::seconds(20)).count, 4);
        // 33.3 ms: a thousand of them are 33.3 s, not 33.
        let fine = of(60, TimeDelta::microseconds(33_300));
        assert_eq!(fine.count, 1802);
        assert_eq!(fine.at(1000) - start, TimeDelta::milliseconds(33_300));
        let centuries = of(100_000_000_000, TimeDelta::nanoseconds(86_400_000_000_001));
        let last = centuries.at(1_000_000) - start;
        assert_eq!(last.num_seconds(), 86_400_000_000);
        assert_eq!(last.subsec_nanos(), 1_000_000);
    }
}
