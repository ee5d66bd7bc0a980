//! The sun's geocentric place: what a tier computes, before an observer is put on the earth.

use std::f64::consts::{PI, TAU};

use crate::units::DEG;

/// The aberration in the mean longitude that the equation of time counts from, 0.0057183 degrees (Meeus, chapter 28).
const MEAN_ABERRATION: f64 = 0.005_718_3 * DEG;

/// Turns in a radian.
const TURN: f64 = 1.0 / TAU;

/// The sun's geocentric apparent place, referred to the true equator and equinox of date.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Right ascension minus mean longitude [rad], in (-pi, pi]: small and slow, where the right ascension turns.
    pub from_mean: f64,
    /// The sun's mean longitude [rad], any number of turns.
    pub mean_longitude: f64,
    /// Declination [rad].
    pub declination: f64,
    /// Distance [au].
    pub distance_au: f64,
    /// Apparent minus mean sidereal time [rad].
    pub equation_of_equinoxes: f64,
}

impl Place {
    /// From the apparent ecliptic longitude and latitude and the true obliquity [rad].
    pub fn from_ecliptic(
        longitude: f64,
        latitude: f64,
        obliquity: f64,
        distance_au: f64,
        equation_of_equinoxes: f64,
        mean_longitude: f64,
    ) -> Self {
        let (sin_l, cos_l) = longitude.sin_cos();
        let (sin_b, cos_b) = latitude.sin_cos();
        let (sin_e, cos_e) = obliquity.sin_cos();
        let x = cos_b * cos_l;
        let y = cos_b * sin_l * cos_e - sin_b * sin_e;
        let z = cos_b * sin_l * sin_e + sin_b * cos_e;
        Self::from_equatorial(
            [x, y, z],
            distance_au,
            equation_of_equinoxes,
            mean_longitude,
        )
    }

    /// From a direction of any length in the true equator and equinox of date.
    pub fn from_equatorial(
        [x, y, z]: [f64; 3],
        distance_au: f64,
        equation_of_equinoxes: f64,
        mean_longitude: f64,
    ) -> Self {
        Self {
            from_mean: half_turn(y.atan2(x) - mean_longitude),
            mean_longitude,
            declination: z.atan2(x.hypot(y)),
            distance_au,
            equation_of_equinoxes,
        }
    }

    /// Right ascension [rad], in [0, 2 pi).
    pub fn right_ascension(&self) -> f64 {
        full_turn(self.mean_longitude + self.from_mean)
    }

    /// The equation of time [rad]: apparent minus mean solar time, as Reda & Andreas 2004 (appendix A.1) define it.
    pub fn equation_of_time(&self) -> f64 {
        half_turn(self.equation_of_equinoxes - MEAN_ABERRATION - self.from_mean)
    }
}

/// An angle [rad] wrapped into [0, 2 pi).
pub(super) fn full_turn(angle: f64) -> f64 {
    let wrapped = angle - TAU * floor(angle * TURN);
    // Rounding may leave it slightly outside.
    if (0.0..TAU).contains(&wrapped) {
        wrapped
    } else {
        0.0
    }
}

/// An angle [rad] wrapped into (-pi, pi].
pub(super) fn half_turn(angle: f64) -> f64 {
    let wrapped = angle - TAU * floor(angle * TURN + 0.5);
    if wrapped > -PI {
        wrapped
    } else {
        wrapped + TAU
    }
}

/// The whole number below, for numbers that an i64 holds: without the call that f64::floor is on older processors.
pub(super) fn floor(x: f64) -> f64 {
    let cut = x as i64 as f64;
    if cut > x { cut - 1.0 } else { cut }
}
