//! Delta-T = TT - UT1: what was observed, what is predicted, and polynomials beyond.
//!
//! The clock of the earth is not regular: nobody can compute delta-T. Observed from 1962 to 2026 it is known to
//! 1 ms, from records of the telescope's age to about a second, in antiquity to minutes (year -700: 3 minutes, -2000:
//! an hour). After 2027 it is a guess: 2 s wrong in ten years, 30 s in a hundred, hours in year 6000. A second of
//! delta-T moves the sun by 0.04 arcseconds.

use std::sync::LazyLock;

use super::julian::Julian;

/// Rows of `from, to, c0, c1, c2, c3, basis`; the sources stand in the file's head.
const TABLE: &str = include_str!("../../data/ephemeris/delta_t.csv");

/// A piece of the curve: a cubic in t = (y - from) / (to - from).
struct Piece {
    from: f64,
    to: f64,
    coefficients: [f64; 4],
}

static PIECES: LazyLock<Vec<Piece>> = LazyLock::new(|| {
    let rows = TABLE
        .lines()
        .filter(|line| line.starts_with(|c: char| c == '-' || c.is_ascii_digit()));
    rows.map(|row| {
        let mut numbers = row
            .split(',')
            .take(6)
            .map(|cell| cell.parse().expect("the table holds numbers"));
        let mut next = || numbers.next().expect("six numbers a row");
        Piece {
            from: next(),
            to: next(),
            coefficients: [next(), next(), next(), next()],
        }
    })
    .collect()
});

/// Delta-T at a universal time [s], from the table of `data/ephemeris/delta_t.csv`; continuous, over all years.
///
/// Source: Morrison, Stephenson, Hohenkerk & Zawilski 2021 (-720 to 1962), IERS EOP C04 and Bulletin A (1962 to 2027),
/// Stephenson, Morrison & Hohenkerk 2016 (the parabola beyond).
pub fn delta_t(ut: Julian) -> f64 {
    let year = ut.epoch();
    let after = PIECES.partition_point(|piece| piece.from <= year);
    match after.checked_sub(1).map(|i| &PIECES[i]) {
        Some(piece) if year < piece.to => {
            let t = (year - piece.from) / (piece.to - piece.from);
            let [c0, c1, c2, c3] = piece.coefficients;
            c0 + t * (c1 + t * (c2 + t * c3))
        }
        _ => -320.0 + 32.5 * ((year - 1825.0) / 100.0).powi(2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(year: f64) -> f64 {
        delta_t(Julian::new(2_451_545.0, (year - 2000.0) * 365.25))
    }

    #[test]
    fn published_values() {
        // Astronomical Almanac, table of delta-T (observed) at the beginning of the year.
        for (year, seconds) in [
            (1965.0, 35.73),
            (1980.0, 50.54),
            (2000.0, 63.83),
            (2010.0, 66.07),
            (2020.0, 69.36),
        ] {
            assert!((at(year) - seconds).abs() < 0.05, "{year}: {}", at(year));
        }
        // Morrison et al. 2021, table of delta-T: to its rounding.
        for (year, seconds, within) in [
            (-500.0, 16_800.0, 400.0),
            (1000.0, 1650.0, 10.0),
            (1600.0, 109.0, 1.0),
            (1900.0, -2.0, 0.5),
        ] {
            assert!((at(year) - seconds).abs() < within, "{year}: {}", at(year));
        }
    }

    #[test]
    fn the_curve_has_no_jump() {
        // A hundredth of a year; the steepest slope, in year -2000, is 25 s a year.
        let mut last = at(-2000.0);
        for i in 1..=800_000 {
            let now = at(-2000.0 + 0.01 * f64::from(i));
            assert!(
                (now - last).abs() < 0.35,
                "year {}: {last} to {now}",
                -2000.0 + 0.01 * f64::from(i)
            );
            last = now;
        }
        for piece in PIECES.windows(2) {
            let end: f64 = piece[0].coefficients.iter().sum();
            assert_eq!(piece[0].to, piece[1].from);
            assert!(
                (end - piece[1].coefficients[0]).abs() < 0.03,
                "at {}",
                piece[0].to
            );
        }
    }
}
