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

use super::julian::Julian;
use super::place::{Place, half_turn};
use super::spa;
use super::time::Instant;
use chrono::{Datelike, NaiveDate};

/// The sun's place and its equation of time [rad] at a universal time.
pub(super) fn place(instant: &Instant) -> (Place, f64) {
    let ut = instant.ut();
    let angle = day_angle(ut);
    let (sin1, cos1) = angle.sin_cos();
    let (sin2, cos2) = (2.0 * angle).sin_cos();
    let (sin3, cos3) = (3.0 * angle).sin_cos();
    let declination = 0.006_918 - 0.399_912 * cos1 + 0.070_257 * sin1 - 0.006_758 * cos2
        + 0.000_907 * sin2
        - 0.002_697 * cos3
        + 0.001_48 * sin3;
    let equation_of_time =
        0.000_007_5 + 0.001_868 * cos1 - 0.032_077 * sin1 - 0.014_615 * cos2 - 0.040_849 * sin2;
    let inverse_square =
        1.000_11 + 0.034_221 * cos1 + 0.001_28 * sin1 + 0.000_719 * cos2 + 0.000_077 * sin2;
    // The hour angle at Greenwich is the mean time from noon plus the equation of time; the right ascension follows.
    let hour_angle = TAU * ut.fraction - PI + equation_of_time;
    let mean_longitude = spa::mean_longitude(instant.tt().centuries() / 10.0);
    let place = Place {
        from_mean: half_turn(
            spa::sidereal_time(ut.fraction, ut.days()) - hour_angle - mean_longitude,
        ),
        mean_longitude,
        declination,
        distance_au: 1.0 / inverse_square.sqrt(),
        equation_of_equinoxes: 0.0,
    };
    (place, equation_of_time)
}

/// The part of the civil year gone [rad of a turn].
fn day_angle(ut: Julian) -> f64 {
    let date = NaiveDate::from_num_days_from_ce_opt((ut.day - 1_721_424.5) as i32)
        .expect("the years of an instant are within chrono's");
    let length = if date.leap_year() { 366.0 } else { 365.0 };
    TAU * (f64::from(date.ordinal0()) + ut.fraction) / length
}
