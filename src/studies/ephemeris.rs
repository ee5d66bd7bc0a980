//! The price list of the ephemeris: error and speed of each tier, measured on this machine.

use std::hint::black_box;
use std::time::Instant as Clock;

use rayon::prelude::*;

use crate::ephemeris::{
    Almanac, Directions, Instant, Julian, Site, SunPosition, Tier, TimeScale, Weather, sun_position,
};
use crate::units::{ARCSEC, DEG};

/// Topocentric places by ERFA; the sources stand in the file's head.
const TRUTH: &str = include_str!("../../data/ephemeris/truth.csv");

/// What a tier costs and gives.
#[derive(Clone, Copy, Debug)]
pub struct Price {
    /// The tier.
    pub tier: Tier,
    /// Worst and RMS great-circle distance from the tier `arcsecond` at random places and times, 1900 to 2100 [arcsec].
    pub against_arcsecond: (f64, f64),
    /// The same against the stored places by ERFA [arcsec].
    pub against_erfa: (f64, f64),
    /// Positions a second at unordered times, on one core and on all.
    pub single: (f64, f64),
    /// Positions a second over a year of minutes at one place (by an [`Almanac`]), on one core and on all.
    pub series: (f64, f64),
    /// The same for azimuth and elevations alone, in columns (by [`Directions`]).
    pub directions: (f64, f64),
}

/// How many places and times the comparison with `arcsecond` takes.
pub const SAMPLES: usize = 20_000;

type Case = (Instant, Site);

/// The price of each tier. Takes about two seconds; speeds are the best of three runs.
pub fn prices() -> Vec<Price> {
    let random = cases();
    let finest: Vec<[f64; 3]> = directions(Tier::Arcsecond, &random);
    let stored = truth();
    let stored_cases: Vec<Case> = stored.iter().map(|(case, _)| *case).collect();
    let stored_directions: Vec<[f64; 3]> = stored.iter().map(|(_, direction)| *direction).collect();
    Tier::ALL
        .into_iter()
        .map(|tier| Price {
            tier,
            against_arcsecond: error(&directions(tier, &random), &finest),
            against_erfa: error(&directions(tier, &stored_cases), &stored_directions),
            single: (single(tier, &random, false), single(tier, &random, true)),
            series: (series(tier, false), series(tier, true)),
            directions: (
                columns(tier, 1),
                columns(tier, rayon::current_num_threads()),
            ),
        })
        .collect()
}

/// Places spread evenly over the sphere and times over two centuries, by the golden ratio and its relatives: the same
/// in every run.
fn cases() -> Vec<Case> {
    let part = |i: usize, step: f64| (i as f64 * step).fract();
    (0..SAMPLES)
        .map(|i| {
            let latitude = (2.0 * part(i, 0.618_033_988_749_895) - 1.0).asin() / DEG;
            let longitude = 360.0 * part(i, 0.754_877_666_246_693) - 180.0;
            let date = Julian::new(
                2_415_020.5 + (73_048.0 * part(i, 0.569_840_290_998_053)).floor(),
                part(i, 0.328_479_7),
            );
            let instant =
                Instant::from_julian(date, TimeScale::Ut1, None).expect("years 1900 to 2100");
            (
                instant,
                Site::new(latitude, longitude, 0.0).expect("a place"),
            )
        })
        .collect()
}

/// The stored cases and the directions that ERFA gives.
fn truth() -> Vec<(Case, [f64; 3])> {
    TRUTH
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .map(|line| {
            let n: Vec<f64> = line
                .split(',')
                .map(|cell| cell.parse().expect("the table holds numbers"))
                .collect();
            let instant = Instant::from_julian(Julian::new(n[0], n[1]), TimeScale::Ut1, Some(n[2]))
                .expect("a time");
            let (sin_a, cos_a) = (n[6] * DEG).sin_cos();
            let (sin_e, cos_e) = (n[7] * DEG).sin_cos();
            (
                (instant, Site::new(n[3], n[4], n[5]).expect("a place")),
                [cos_e * sin_a, cos_e * cos_a, sin_e],
            )
        })
        .collect()
}

fn position(tier: Tier, (instant, site): &Case) -> SunPosition {
    sun_position(tier, instant, site, &Weather::standard(site))
}

fn directions(tier: Tier, cases: &[Case]) -> Vec<[f64; 3]> {
    cases
        .par_iter()
        .map(|case| position(tier, case).direction(false))
        .collect()
}

/// The worst and the RMS distance [arcsec].
fn error(some: &[[f64; 3]], truth: &[[f64; 3]]) -> (f64, f64) {
    let squares = some.iter().zip(truth).map(|(a, b)| {
        // The chord, which for what is near is the arc, and exact where a cosine is not.
        let squared: f64 = a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum();
        (2.0 * (0.5 * squared.sqrt()).min(1.0).asin() / ARCSEC).powi(2)
    });
    let (worst, sum) = squares.fold((0.0_f64, 0.0), |(worst, sum), e| (worst.max(e), sum + e));
    (worst.sqrt(), (sum / truth.len() as f64).sqrt())
}

/// Positions a second at unordered times.
fn single(tier: Tier, cases: &[Case], all_cores: bool) -> f64 {
    let weathers: Vec<Weather> = cases
        .iter()
        .map(|(_, site)| Weather::standard(site))
        .collect();
    let run = |i: usize| {
        black_box(sun_position(tier, &cases[i].0, &cases[i].1, &weathers[i]));
    };
    best(cases.len(), || {
        if all_cores {
            (0..cases.len()).into_par_iter().for_each(run)
        } else {
            (0..cases.len()).for_each(run)
        }
    })
}

/// The year of minutes that series are measured over: its first instant, place and air.
fn year() -> (Instant, Site, Weather) {
    let site = Site::new(48.8584, 2.2945, 35.0).expect("a place");
    let start = Instant::from_julian(Julian::new(2_461_041.5, 0.0), TimeScale::Ut1, None)
        .expect("the year 2026");
    (start, site, Weather::standard(&site))
}

const MINUTES: u32 = 525_600;

/// Positions a second over a year of minutes.
fn series(tier: Tier, all_cores: bool) -> f64 {
    let (start, site, weather) = year();
    let end = start.plus_seconds(60.0 * f64::from(MINUTES));
    best(MINUTES as usize, || {
        let almanac = Almanac::new(tier, &start, &end);
        let run = |i: u32| {
            black_box(almanac.sun_position(
                &start.plus_seconds(60.0 * f64::from(i)),
                &site,
                &weather,
            ));
        };
        if all_cores {
            (0..MINUTES).into_par_iter().for_each(run)
        } else {
            (0..MINUTES).for_each(run)
        }
    })
}

/// Directions a second over a year of minutes in so many parts, one a core.
fn columns(tier: Tier, parts: usize) -> f64 {
    let (start, site, weather) = year();
    let part = MINUTES as usize / parts;
    best(part * parts, || {
        (0..parts).into_par_iter().for_each(|i| {
            let at = |minute: usize| start.plus_seconds(60.0 * minute as f64);
            let (first, last) = (at(i * part), at((i + 1) * part - 1));
            black_box(Directions::new(tier, &first, &last, part, &site, &weather));
        })
    })
}

/// The best rate of three runs [1/s].
fn best(count: usize, run: impl Fn()) -> f64 {
    (0..3)
        .map(|_| {
            let clock = Clock::now();
            run();
            count as f64 / clock.elapsed().as_secs_f64()
        })
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stored_truth_holds_the_tiers_to_their_bounds() {
        let truth = truth();
        assert_eq!(truth.len(), 600);
        let cases: Vec<Case> = truth.iter().map(|(case, _)| *case).collect();
        let directions_of_truth: Vec<[f64; 3]> =
            truth.iter().map(|(_, direction)| *direction).collect();
        for (tier, bound) in [
            (Tier::Day, 4320.0),
            (Tier::Minute, 37.8),
            (Tier::Spa, 1.08),
            (Tier::Arcsecond, 0.2),
        ] {
            let (worst, rms) = error(&directions(tier, &cases), &directions_of_truth);
            assert!(worst < bound && rms < worst, "{tier}: {worst} arcseconds");
            // A quarter turn of the earth is seen.
            let late: Vec<Case> = cases
                .iter()
                .map(|(i, s)| (i.plus_seconds(21_600.0), *s))
                .collect();
            assert!(error(&directions(tier, &late), &directions_of_truth).0 > bound);
        }
    }
}
