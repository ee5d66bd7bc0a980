//! Tier `spa`: the solar position algorithm of Reda & Andreas 2004.
//!
//! Direction within 0.0003 degrees from -2000 to 6000 by its authors' statement, 0.75 arcseconds at most from 1900 to
//! 2100 by measurement. Heliocentric place from 195 terms of VSOP87, 63 terms of nutation (IAU 1980), aberration.
//!
//! Source: Reda & Andreas 2004, Solar Energy 76, 577; NREL/TP-560-34302 (revised 2008); equation numbers are the
//! report's.

use super::julian::{CENTURY, Julian};
use super::place::Place;
use super::series::periodic;
use super::spa_terms::{B, L, NUTATION, R};
use super::trigonometry::sin_cos;
use crate::units::{ARCSEC, DEG};

/// The sun's geocentric apparent place at a terrestrial time.
pub(super) fn place(tt: Julian) -> Place {
    let t = tt.centuries();
    let millennia = 0.1 * t;
    // Equations 9 to 12; the sun stands opposite to the earth.
    let longitude = periodic(&L, millennia) * 1e-8 + std::f64::consts::PI;
    let latitude = -periodic(&B, millennia) * 1e-8;
    let distance_au = periodic(&R, millennia) * 1e-8;
    let (d_psi, d_eps) = nutation(t);
    let obliquity = mean_obliquity(millennia) + d_eps;
    // Equations 26 and 27.
    let aberration = -20.4898 * ARCSEC / distance_au;
    let apparent = longitude + d_psi + aberration;
    Place::from_ecliptic(
        apparent,
        latitude,
        obliquity,
        distance_au,
        d_psi * obliquity.cos(),
        mean_longitude(millennia),
    )
}

/// Nutation in longitude and in obliquity [rad] (equations 15 to 23).
pub(super) fn nutation(t: f64) -> (f64, f64) {
    let cubic = |c: [f64; 4]| (c[0] + t * (c[1] + t * (c[2] + t * c[3]))) * DEG;
    let arguments = [
        cubic([297.850_36, 445_267.111_480, -0.001_914_2, 1.0 / 189_474.0]),
        cubic([357.527_72, 35_999.050_340, -0.000_160_3, -1.0 / 300_000.0]),
        cubic([134.962_98, 477_198.867_398, 0.008_697_2, 1.0 / 56_250.0]),
        cubic([93.271_91, 483_202.017_538, -0.003_682_5, 1.0 / 327_270.0]),
        cubic([125.044_52, -1_934.136_261, 0.002_070_8, 1.0 / 450_000.0]),
    ];
    // Each angle is a sum of small multiples of five: their cosines and sines are products of those of the multiples.
    const MOST: usize = 4;
    let mut multiples = [[(1.0, 0.0); 2 * MOST + 1]; 5];
    for (turns, (sin, cos)) in multiples.iter_mut().zip(sin_cos(arguments)) {
        for n in 1..=MOST {
            let (c, s) = product(turns[MOST + n - 1], (cos, sin));
            turns[MOST + n] = (c, s);
            turns[MOST - n] = (c, -s);
        }
    }
    let (mut d_psi, mut d_eps) = (0.0, 0.0);
    for (numbers, [a, b, c, d]) in &NUTATION {
        let mut angle = (1.0, 0.0);
        for (&n, turns) in numbers.iter().zip(&multiples) {
            if n != 0 {
                angle = product(angle, turns[(MOST as i8 + n) as usize]);
            }
        }
        let (cos, sin) = angle;
        d_psi += (a + b * t) * sin;
        d_eps += (c + d * t) * cos;
    }
    (d_psi * 1e-4 * ARCSEC, d_eps * 1e-4 * ARCSEC)
}

/// Cosine and sine of the sum of two angles, from theirs.
fn product((c, s): (f64, f64), (d, t): (f64, f64)) -> (f64, f64) {
    (c * d - s * t, c * t + s * d)
}

/// The mean obliquity of the ecliptic [rad] (equation 24, Laskar 1986).
fn mean_obliquity(millennia: f64) -> f64 {
    const ARCSECONDS: [f64; 11] = [
        84_381.448, -4680.93, -1.55, 1999.25, -51.38, -249.67, -39.05, 7.12, 27.87, 5.79, 2.45,
    ];
    let u = millennia / 10.0;
    ARCSECONDS.iter().rev().fold(0.0, |sum, c| sum * u + c) * ARCSEC
}

/// The sun's mean longitude [rad], of which the equation of time counts (appendix A.1).
#[inline(always)]
pub(super) fn mean_longitude(millennia: f64) -> f64 {
    let m = millennia;
    let degrees = 280.466_456_7
        + m * (360_007.698_277_9
            + m * (0.030_320_28
                + m * (1.0 / 49_931.0 - m * (1.0 / 15_300.0 + m * (1.0 / 2_000_000.0)))));
    degrees * DEG
}

/// The mean sidereal time at Greenwich [rad] (equation 28), of the part of the day and the days since J2000.0 (UT).
#[inline(always)]
pub(super) fn sidereal_time(fraction: f64, days: f64) -> f64 {
    let t = days * (1.0 / CENTURY);
    // 360.98564736629 degrees a day, of which the whole turns are never multiplied out: what counts is the time since
    // noon, when J2000.0 was.
    (280.460_618_37
        + 360.0 * (fraction - 0.5)
        + 0.985_647_366_29 * days
        + t * t * (0.000_387_933 - t * (1.0 / 38_710_000.0)))
        * DEG
}

#[cfg(test)]
mod tests {
    use super::super::time::{Instant, TimeScale};
    use super::*;

    /// The worked example: 2003 October 17, 12:30:30 at UTC-7, delta-T 67 s.
    fn example() -> Instant {
        let ut = Julian::new(2_452_929.5, (19.0 * 3600.0 + 30.0 * 60.0 + 30.0) / 86_400.0);
        Instant::from_julian(ut, TimeScale::Ut1, Some(67.0)).unwrap()
    }

    #[test]
    fn the_report_s_intermediate_values() {
        let tt = example().tt();
        let t = tt.centuries();
        let m = t / 10.0;
        let near = |value: f64, published: f64, last_digit: f64| {
            assert!(
                (value - published).abs() <= last_digit,
                "{value} against {published}"
            );
        };
        assert!((example().ut().jd() - 2_452_930.312_847).abs() < 5e-7);
        near(
            (periodic(&L, m) * 1e-8 / DEG).rem_euclid(360.0),
            24.018_261_691_7,
            1e-10,
        );
        near(periodic(&B, m) * 1e-8 / DEG, -0.000_101_121_9, 1e-10);
        near(periodic(&R, m) * 1e-8, 0.996_542_297_4, 1e-10);
        let (d_psi, d_eps) = nutation(t);
        near(d_psi / DEG, -0.003_998_40, 5e-9);
        near(d_eps / DEG, 0.001_666_57, 5e-9);
        near((mean_obliquity(m) + d_eps) / DEG, 23.440_465, 5e-7);
        let place = place(tt);
        near(place.right_ascension() / DEG, 202.227_41, 5e-6);
        near(place.declination / DEG, -9.314_34, 5e-6);
        let ut = example().ut();
        let sidereal = sidereal_time(ut.fraction, ut.days()) + place.equation_of_equinoxes;
        near((sidereal / DEG).rem_euclid(360.0), 318.511_91, 5e-6);
    }
}
