//! Julian dates.

use chrono::{Datelike, NaiveDate};

use super::place::floor;
use crate::units::DAY;

/// The Julian date of J2000.0, 2000 January 1.5.
const J2000: f64 = 2_451_545.0;
/// Days in a Julian century.
pub(super) const CENTURY: f64 = 36_525.0;

/// A Julian date in two parts, so that no digit of the time of day is lost to the count of days.
///
/// One f64 holds a Julian date of today to 40 microseconds; the pair holds it to 10 picoseconds.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Julian {
    /// The Julian date of the last midnight [days], a whole number and a half.
    pub day: f64,
    /// The part of the day since then [days], in [0, 1).
    pub fraction: f64,
}

impl Julian {
    /// From a Julian date in parts of any size, say 2451545.0 and 0.25 [days].
    pub fn new(jd: f64, fraction: f64) -> Self {
        let midnight = floor(jd - 0.5) + 0.5;
        let rest = (jd - midnight) + fraction;
        let carry = floor(rest);
        // 1 - 1e-17 rounds to 1: the carry is checked again.
        let fraction = rest - carry;
        if fraction < 1.0 {
            Self {
                day: midnight + carry,
                fraction,
            }
        } else {
            Self {
                day: midnight + carry + 1.0,
                fraction: 0.0,
            }
        }
    }

    /// From a civil date of the proleptic Gregorian calendar and the seconds since its midnight.
    pub fn from_date(date: NaiveDate, seconds: f64) -> Self {
        Self::new(
            f64::from(date.num_days_from_ce()) + 1_721_424.5,
            seconds / DAY,
        )
    }

    /// The date as one number [days]; good to 40 microseconds.
    pub fn jd(self) -> f64 {
        self.day + self.fraction
    }

    /// The days since J2000.0 [days].
    pub fn days(self) -> f64 {
        (self.day - J2000) + self.fraction
    }

    /// The Julian centuries since J2000.0.
    pub fn centuries(self) -> f64 {
        self.days() * (1.0 / CENTURY)
    }

    /// The date `seconds` later.
    pub fn plus_seconds(self, seconds: f64) -> Self {
        Self::new(self.day, self.fraction + seconds * (1.0 / DAY))
    }

    /// The seconds from `earlier` to this date [s].
    pub fn seconds_since(self, earlier: Self) -> f64 {
        ((self.day - earlier.day) + (self.fraction - earlier.fraction)) * DAY
    }

    /// The Julian epoch, a year with its decimal part: 2000 + days since J2000.0 / 365.25.
    pub fn epoch(self) -> f64 {
        2000.0 + self.days() / 365.25
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn julian_dates_of_meeus_chapter_7() {
        // Proleptic Gregorian where Meeus writes Gregorian; his Julian-calendar dates are tested through JD text.
        for (y, m, d, seconds, jd) in [
            (2000, 1, 1, 43_200.0, 2_451_545.0),
            (1999, 1, 1, 0.0, 2_451_179.5),
            (1987, 1, 27, 0.0, 2_446_822.5),
            (1988, 6, 19, 43_200.0, 2_447_332.0),
            (1957, 10, 4, 0.81 * DAY, 2_436_116.31),
            (1900, 1, 1, 0.0, 2_415_020.5),
            (1600, 12, 31, 0.0, 2_305_812.5),
        ] {
            let date = NaiveDate::from_ymd_opt(y, m, d).unwrap();
            assert_eq!(Julian::from_date(date, seconds).jd(), jd);
        }
    }
}
