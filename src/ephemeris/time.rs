//! Time scales, and the one instant that every tier shares.

use chrono::{DateTime, Timelike, Utc};

use super::delta_t;
use super::julian::Julian;
use crate::error::{Error, Result};
use crate::units::DAY;

/// The scale in which a Julian date counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeScale {
    /// Coordinated universal time, taken as UT1: they differ by less than 0.9 s, which is up to 13.5 arcseconds of
    /// hour angle.
    #[default]
    Utc,
    /// Universal time, the angle of the earth.
    Ut1,
    /// Terrestrial time, which moves the sun; UT1 = TT - delta-T.
    Tt,
}

impl std::str::FromStr for TimeScale {
    type Err = Error;
    fn from_str(text: &str) -> Result<Self> {
        match text {
            "utc" => Ok(Self::Utc),
            "ut1" => Ok(Self::Ut1),
            "tt" => Ok(Self::Tt),
            _ => Err(Error::input(
                "time scale",
                format!("`{text}` is not known"),
                "write utc, ut1 or tt",
            )),
        }
    }
}

impl std::fmt::Display for TimeScale {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Utc => "utc",
            Self::Ut1 => "ut1",
            Self::Tt => "tt",
        })
    }
}

/// The first and the last Julian date that an [`Instant`] takes: the years -2000 to 6000.
const RANGE: (f64, f64) = (990_574.5, 3_912_880.5);

/// An instant: universal time, which turns the earth, and terrestrial time, which moves the sun.
///
/// UTC is taken as UT1. Valid for the years -2000 to 6000 (proleptic Gregorian).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    ut: Julian,
    tt: Julian,
}

impl Instant {
    /// From UTC, with the tabulated delta-T.
    ///
    /// A leap second (23:59:60) is kept: it reads as the first second of the next day, as it does for the earth.
    ///
    /// # Errors
    /// [`Error::Domain`] outside the years -2000 to 6000.
    pub fn from_utc(utc: DateTime<Utc>) -> Result<Self> {
        Self::from_julian(julian(utc), TimeScale::Utc, None)
    }

    /// From UTC, with delta-T given [s].
    ///
    /// # Errors
    /// [`Error::Domain`] outside the years -2000 to 6000, or where delta-T is not within a million seconds.
    pub fn from_utc_with(utc: DateTime<Utc>, delta_t: f64) -> Result<Self> {
        Self::from_julian(julian(utc), TimeScale::Utc, Some(delta_t))
    }

    /// From a Julian date in a time scale, with delta-T [s] given or tabulated.
    ///
    /// # Errors
    /// As for [`Instant::from_utc_with`].
    pub fn from_julian(date: Julian, scale: TimeScale, delta_t: Option<f64>) -> Result<Self> {
        if !(RANGE.0..RANGE.1).contains(&date.jd()) {
            return Err(Error::domain(
                "the time",
                format!("JD {}", date.jd()),
                "the years -2000 to 6000 (JD 990574.5 to 3912880.5)",
                "choose a time for which the series hold",
            ));
        }
        if let Some(given) = delta_t
            && !(-1e6..=1e6).contains(&given)
        {
            return Err(Error::domain(
                "delta-T",
                format!("{given} s"),
                "-1e6 to 1e6 s",
                "give TT - UT1 in seconds, 69.1 for 2026",
            ));
        }
        Ok(match scale {
            TimeScale::Utc | TimeScale::Ut1 => {
                let delta_t = delta_t.unwrap_or_else(|| delta_t::delta_t(date));
                Self {
                    ut: date,
                    tt: date.plus_seconds(delta_t),
                }
            }
            TimeScale::Tt => {
                // delta-T is tabulated over UT and changes by less than 2 minutes a year: three rounds leave nothing.
                let delta_t = delta_t.unwrap_or_else(|| {
                    (0..3).fold(0.0, |delta_t, _| {
                        delta_t::delta_t(date.plus_seconds(-delta_t))
                    })
                });
                Self {
                    ut: date.plus_seconds(-delta_t),
                    tt: date,
                }
            }
        })
    }

    /// The instant `seconds` later, with the same delta-T: for steps of days, not of centuries.
    #[must_use]
    pub fn plus_seconds(self, seconds: f64) -> Self {
        Self {
            ut: self.ut.plus_seconds(seconds),
            tt: self.tt.plus_seconds(seconds),
        }
    }

    /// The instant so many days later in universal and in terrestrial time.
    pub(super) fn later(self, ut_days: f64, tt_days: f64) -> Self {
        Self {
            ut: Julian::new(self.ut.day, self.ut.fraction + ut_days),
            tt: Julian::new(self.tt.day, self.tt.fraction + tt_days),
        }
    }

    /// Universal time, UT1 (and UTC, which is taken as UT1).
    pub fn ut(&self) -> Julian {
        self.ut
    }

    /// Terrestrial time.
    pub fn tt(&self) -> Julian {
        self.tt
    }

    /// Delta-T = TT - UT1 [s].
    pub fn delta_t(&self) -> f64 {
        self.tt.seconds_since(self.ut)
    }

    /// As UTC, to the nanosecond.
    pub fn to_utc(&self) -> DateTime<Utc> {
        let days = (self.ut.day - 2_440_587.5) as i64;
        let nanos = (self.ut.fraction * DAY * 1e9).round() as i64;
        DateTime::from_timestamp(
            days * 86_400 + nanos / 1_000_000_000,
            (nanos % 1_000_000_000) as u32,
        )
        .expect("the years of an instant are within chrono's")
    }
}

/// The Julian date of a UTC time; a leap second runs on into the next day.
fn julian(utc: DateTime<Utc>) -> Julian {
    let seconds = f64::from(utc.num_seconds_from_midnight()) + f64::from(utc.nanosecond()) * 1e-9;
    Julian::from_date(utc.date_naive(), seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_survives_the_way_there_and_back() {
        for text in [
            "2026-06-21T18:30:00.123456789Z",
            "1900-02-28T23:59:59.999999999Z",
            "1600-02-29T00:00:00Z",
        ] {
            let utc: DateTime<Utc> = text.parse().unwrap();
            let back = Instant::from_utc(utc).unwrap().to_utc();
            assert!(
                (back - utc).num_nanoseconds().unwrap().abs() <= 1,
                "{text} {back}"
            );
        }
    }

    #[test]
    fn a_leap_second_is_the_first_of_the_next_day() {
        let leap = DateTime::parse_from_rfc3339("2016-12-31T23:59:60.5Z")
            .unwrap()
            .to_utc();
        let ut = Instant::from_utc(leap).unwrap().ut();
        assert_eq!(ut.day, 2_457_754.5);
        assert!((ut.fraction * DAY - 0.5).abs() < 1e-9);
    }

    #[test]
    fn terrestrial_time_inverts() {
        let ut = Julian::new(1_000_000.25, 0.0);
        let there = Instant::from_julian(ut, TimeScale::Ut1, None).unwrap();
        let back = Instant::from_julian(there.tt(), TimeScale::Tt, None).unwrap();
        assert!(back.ut().seconds_since(ut).abs() < 1e-3);
    }

    #[test]
    fn dates_that_are_no_numbers_are_refused() {
        for jd in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, 0.0] {
            assert!(Instant::from_julian(Julian::new(jd, 0.0), TimeScale::Utc, None).is_err());
        }
        let j2000 = Julian::new(2_451_545.0, 0.0);
        for delta_t in [f64::NAN, f64::INFINITY, 2e6] {
            assert!(Instant::from_julian(j2000, TimeScale::Utc, Some(delta_t)).is_err());
        }
    }
}
