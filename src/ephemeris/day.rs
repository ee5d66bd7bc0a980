//! Tier `day`: declination and equation of time from the day of the year alone.
//!
//! Direction within 1.2 degrees from 1900 to 2100 (0.9 measured), no delta-T, no parallax. This is what the paper
//! ReLiShaft calls Julian dating, and what Preetham's and Radiance's skies use without a year.
//!
//! Differs: of such series we take Spencer's, because it closes over the year. Preetham's sines have periods of 368,
//! 373 and 355 days and jump by 0.2 degrees at New Year. The day angle runs over the true length of the year, so that
//! a leap year neither jumps nor drifts.
//!
//! Source: Spencer 1971, Search 2 (5), 172, as in Iqbal 1983, equations 1.2.1, 1.3.1 and 1.4.1.

use std::f64::consts::{PI, TAU};

use super::place::{Place, half_turn};
use super::spa;
use super::time::Instant;
use super::trigonometry::sin_cos;
use chrono::{Datelike, NaiveDate};

/// The sun's place and its equation of time [rad] at a universal time.
pub(super) fn place(instant: &Instant) -> (Place, f64) {
    let ut = instant.ut();
    let sun = Sun::at(Year::of(ut.day).angle(ut.day, ut.fraction));
    // The right ascension follows from the hour angle at Greenwich.
    let hour_angle = sun.hour_angle(ut.fraction);
    let mean_longitude = spa::mean_longitude(instant.tt().centuries() / 10.0);
    let place = Place {
        from_mean: half_turn(
            spa::sidereal_time(ut.fraction, ut.days()) - hour_angle - mean_longitude,
        ),
        mean_longitude,
        declination: sun.declination,
        distance_au: 1.0 / sun.inverse_square.sqrt(),
        equation_of_equinoxes: 0.0,
    };
    (place, sun.equation_of_time)
}

/// Spencer's series at a day angle.
pub(super) struct Sun {
    /// [rad]
    pub declination: f64,
    /// [rad]
    equation_of_time: f64,
    /// Of the distance [1/au2].
    inverse_square: f64,
}

impl Sun {
    /// Without a branch. Sines and cosines of the angle's multiples are made of its own.
    #[inline(always)]
    pub(super) fn at(angle: f64) -> Self {
        let [(sin1, cos1)] = sin_cos([angle]);
        let (sin2, cos2) = (2.0 * sin1 * cos1, cos1 * cos1 - sin1 * sin1);
        let (sin3, cos3) = (sin2 * cos1 + cos2 * sin1, cos2 * cos1 - sin2 * sin1);
        Self {
            declination: 0.006_918 - 0.399_912 * cos1 + 0.070_257 * sin1 - 0.006_758 * cos2
                + 0.000_907 * sin2
                - 0.002_697 * cos3
                + 0.001_48 * sin3,
            equation_of_time: 0.000_007_5 + 0.001_868 * cos1
                - 0.032_077 * sin1
                - 0.014_615 * cos2
                - 0.040_849 * sin2,
            inverse_square: 1.000_11
                + 0.034_221 * cos1
                + 0.001_28 * sin1
                + 0.000_719 * cos2
                + 0.000_077 * sin2,
        }
    }

    /// The hour angle at Greenwich [rad] at a part of the day: the mean time from noon plus the equation of time.
    #[inline(always)]
    pub(super) fn hour_angle(&self, fraction: f64) -> f64 {
        TAU * fraction - PI + self.equation_of_time
    }
}

/// A civil year of universal time.
#[derive(Clone, Copy)]
pub(super) struct Year {
    /// The midnight that it begins with [Julian days].
    first: f64,
    /// [days]
    length: f64,
}

impl Year {
    /// The year of a midnight [Julian days].
    pub(super) fn of(day: f64) -> Self {
        let date = NaiveDate::from_num_days_from_ce_opt((day - 1_721_424.5) as i32)
            .expect("the years of an instant are within chrono's");
        Self {
            first: day - f64::from(date.ordinal0()),
            length: if date.leap_year() { 366.0 } else { 365.0 },
        }
    }

    /// Whether a midnight [Julian days] belongs to it.
    pub(super) fn holds(&self, day: f64) -> bool {
        (self.first..self.first + self.length).contains(&day)
    }

    /// The part of the year gone at a part of a day [rad of a turn].
    pub(super) fn angle(&self, day: f64, fraction: f64) -> f64 {
        TAU * (day - self.first + fraction) / self.length
    }
}
