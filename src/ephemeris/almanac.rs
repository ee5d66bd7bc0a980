//! Many positions at the cost of a few: the geocentric place, tabulated and interpolated.
//!
//! Most of the cost of a position is the geocentric place, which is smooth: its fastest component is the nutation, with
//! periods of 5.6, 9.1, 13.7 days and amplitudes of 0.001, 0.04 and 0.23 arcseconds. Between places `h` days apart the
//! polynomial through the eight nearest misses a wave of period P by at most its amplitude times
//! 1.07e-3 (2 pi h / P)^8 (the remainder of Lagrange's interpolation in the middle of the table: (0.5 * 1.5 * 2.5 * 3.5)^2 h^8 / 8!).
//! With h = 2 days these are 0.0001 (13.7 days), 0.0006 (9.1) and 0.001 arcseconds (5.6). The bound of the whole is
//! 0.01 arcseconds; 0.003 are measured (`tests/ephemeris.rs`).

use super::julian::Julian;
use super::place::{Place, half_turn};
use super::position::{SunPosition, geocentric, observe, place_at};
use super::site::Site;
use super::spa;
use super::tier::Tier;
use super::time::Instant;
use super::weather::Weather;

/// The distance of the tabulated places [days].
const STEP: f64 = 2.0;
/// Places on either side of an interval that its polynomial passes through.
const HALF: usize = 4;
const POINTS: usize = 2 * HALF;

/// What is interpolated: right ascension from the mean longitude, declination, distance, equation of the equinoxes.
type Columns = [f64; 4];

/// The sun's geocentric place over a span of time, for positions at any site in it.
///
/// Agrees with [`super::sun_position`] within 0.01 arcseconds. It costs a place for each two days, and then about a fifth
/// of a microsecond a position: worth it from a few positions a day on. Tier `day` is cheap and not tabulated.
#[derive(Clone, Debug)]
pub struct Almanac {
    tier: Tier,
    /// The time of the first interval's beginning [days since J2000.0 TT].
    start: f64,
    /// Coefficients of the polynomial of each interval, over -1 to 1.
    intervals: Vec<[Columns; POINTS]>,
}

impl Almanac {
    /// The places from one instant to another, in any order.
    pub fn new(tier: Tier, one: &Instant, other: &Instant) -> Self {
        let (one, other) = (one.tt().days(), other.tt().days());
        // The grid is fixed in time, so that a position does not depend on the span it was asked in.
        let first = (one.min(other) / STEP).floor();
        let count = if tier == Tier::Day {
            0
        } else {
            ((one.max(other) / STEP).floor() - first) as usize + 1
        };
        let table: Vec<Columns> = (0..if count == 0 { 0 } else { count + POINTS - 1 })
            .map(|i| {
                let days = (first + i as f64 - (HALF - 1) as f64) * STEP;
                let place = place_at(tier, Julian::new(2_451_545.0, days));
                [
                    place.from_mean,
                    place.declination,
                    place.distance_au,
                    place.equation_of_equinoxes,
                ]
            })
            .collect();
        let intervals = table.windows(POINTS).map(polynomial).collect();
        Self {
            tier,
            start: first * STEP,
            intervals,
        }
    }

    /// The sun's position, as [`super::sun_position`] gives it; outside the span by that function itself.
    pub fn sun_position(&self, instant: &Instant, site: &Site, weather: &Weather) -> SunPosition {
        let (place, equation_of_time) = match self.place(instant) {
            Some(place) => (place, place.equation_of_time()),
            None => geocentric(self.tier, instant),
        };
        observe(self.tier, &place, equation_of_time, instant, site, weather)
    }

    /// The interpolated columns at times [days since J2000.0 TT] within the span; outside it, those of its edge's
    /// polynomial. Not for tier `day`, which has none.
    pub(super) fn columns<const N: usize>(&self, tt_days: &[f64; N], columns: &mut [[f64; N]; 4]) {
        let last = self.intervals.len() - 1;
        for (lane, days) in tt_days.iter().enumerate() {
            let position = (days - self.start) / STEP;
            let index = (position as i32).clamp(0, last as i32);
            let sum = evaluate(&self.intervals[index as usize], position - f64::from(index));
            for (column, sum) in columns.iter_mut().zip(sum) {
                column[lane] = sum;
            }
        }
    }

    /// The interpolated place, or `None` outside the span.
    fn place(&self, instant: &Instant) -> Option<Place> {
        let days = instant.tt().days();
        let position = (days - self.start) / STEP;
        if position < 0.0 {
            return None;
        }
        let index = position as usize;
        let coefficients = self.intervals.get(index)?;
        let [from_mean, declination, distance_au, equation_of_equinoxes] =
            evaluate(coefficients, position - index as f64);
        Some(Place {
            from_mean: half_turn(from_mean),
            mean_longitude: spa::mean_longitude(days * (1.0 / 365_250.0)),
            declination,
            distance_au,
            equation_of_equinoxes,
        })
    }
}

/// The columns at a part of an interval, from 0 to 1.
#[inline(always)]
fn evaluate(coefficients: &[Columns; POINTS], part: f64) -> Columns {
    let x = 2.0 * part - 1.0;
    // Four polynomials at once: written so that they share vector registers.
    let mut sum = coefficients[POINTS - 1];
    for column in coefficients[..POINTS - 1].iter().rev() {
        for (sum, c) in sum.iter_mut().zip(column) {
            *sum = *sum * x + c;
        }
    }
    sum
}

/// The coefficients, over -1 to 1, of the polynomial through eight places, of which the middle two are at -1 and 1.
fn polynomial(places: &[Columns]) -> [Columns; POINTS] {
    let nodes: [f64; POINTS] = std::array::from_fn(|i| 2.0 * i as f64 - (POINTS - 1) as f64);
    let columns: [[f64; POINTS]; 4] = std::array::from_fn(|column| {
        let mut values: [f64; POINTS] = std::array::from_fn(|i| places[i][column]);
        if column == 0 {
            // The equation of time is small, but a wrap of pi is not excluded in far years: the places stay together.
            for i in 1..POINTS {
                values[i] = values[i - 1] + half_turn(values[i] - values[i - 1]);
            }
        }
        // Newton's divided differences, then multiplied out.
        for order in 1..POINTS {
            for i in (order..POINTS).rev() {
                values[i] = (values[i] - values[i - 1]) / (nodes[i] - nodes[i - order]);
            }
        }
        let mut coefficients = [0.0; POINTS];
        for i in (0..POINTS).rev() {
            for k in (1..POINTS).rev() {
                coefficients[k] = coefficients[k - 1] - nodes[i] * coefficients[k];
            }
            coefficients[0] = values[i] - nodes[i] * coefficients[0];
        }
        coefficients
    });
    std::array::from_fn(|power| std::array::from_fn(|column| columns[column][power]))
}
