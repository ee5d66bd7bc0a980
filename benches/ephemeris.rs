//! Positions a second, beside the crate solar-positioning (Reda & Andreas 2004) at the same accuracy, in one run.
//!
//! `cargo bench --bench ephemeris`. Both start from chrono's UTC; ours from `Instant::from_utc_with`. One core.

use std::hint::black_box;

use chrono::{DateTime, TimeDelta, Utc};
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use solar_positioning::{Location, RefractionCorrection, SolarPositions};
use tyndall::ephemeris::{Almanac, Directions, Instant, Site, Tier, Weather, sun_position};

const DELTA_T: f64 = 69.2;

fn site() -> Site {
    Site::new(48.8584, 2.2945, 35.0).expect("a place")
}

/// A year at a step, by the almanac of a tier: making it is part of the time.
fn year(tier: Tier, times: &[DateTime<Utc>]) -> f64 {
    let (site, instant) = (site(), |utc| {
        Instant::from_utc_with(utc, DELTA_T).expect("a time")
    });
    let weather = Weather::standard(&site);
    let almanac = Almanac::new(tier, &instant(times[0]), &instant(times[times.len() - 1]));
    times
        .iter()
        .map(|&utc| {
            black_box(almanac.sun_position(&instant(utc), &site, &weather)).elevation_apparent
        })
        .sum()
}

/// The directions alone of as many equally spaced times, in columns.
fn directions(tier: Tier, first: DateTime<Utc>, last: DateTime<Utc>, count: usize) -> Directions {
    let (site, instant) = (site(), |utc| {
        Instant::from_utc_with(utc, DELTA_T).expect("a time")
    });
    let weather = Weather::standard(&site);
    Directions::new(
        tier,
        &instant(first),
        &instant(last),
        count,
        &site,
        &weather,
    )
}

/// The same by solar-positioning.
fn year_by_others(times: &[DateTime<Utc>]) -> f64 {
    let location = Location {
        latitude: 48.8584,
        longitude: 2.2945,
    };
    times
        .iter()
        .map(|utc| {
            let refraction = Some(RefractionCorrection::standard());
            let position = SolarPositions::new().at(utc, location, 35.0, DELTA_T, refraction);
            black_box(position.expect("a position")).zenith_angle()
        })
        .sum()
}

fn benchmarks(c: &mut Criterion) {
    let start: DateTime<Utc> = "2026-01-01T00:00:00Z".parse().expect("a time");
    let times = |count: i32, step: TimeDelta| -> Vec<DateTime<Utc>> {
        (0..count).map(|i| start + step * i).collect()
    };
    for (name, times) in [
        ("year of minutes", times(525_600, TimeDelta::minutes(1))),
        ("year of hours", times(8760, TimeDelta::hours(1))),
    ] {
        let mut group = c.benchmark_group(name);
        group
            .sample_size(10)
            .throughput(Throughput::Elements(times.len() as u64));
        for tier in Tier::ALL {
            group.bench_function(tier.to_string(), |b| b.iter(|| year(tier, &times)));
            let (first, last) = (times[0], times[times.len() - 1]);
            group.bench_function(format!("{tier} directions"), |b| {
                b.iter(|| directions(tier, first, last, times.len()))
            });
        }
        group.bench_function("solar-positioning", |b| b.iter(|| year_by_others(&times)));
        group.finish();
    }

    // Times of a century in no order: nothing to interpolate.
    let times: Vec<DateTime<Utc>> = (0..1000_i64)
        .map(|i| start + TimeDelta::seconds((i * 2_654_435_761) % 3_155_760_000))
        .collect();
    let mut group = c.benchmark_group("unordered");
    group.throughput(Throughput::Elements(times.len() as u64));
    for tier in Tier::ALL {
        group.bench_function(tier.to_string(), |b| {
            let (site, weather) = (site(), Weather::standard(&site()));
            b.iter_batched(
                || (),
                |()| {
                    for &utc in &times {
                        let instant = Instant::from_utc_with(utc, DELTA_T).expect("a time");
                        black_box(sun_position(tier, &instant, &site, &weather));
                    }
                },
                BatchSize::SmallInput,
            )
        });
    }
    group.bench_function("solar-positioning", |b| b.iter(|| year_by_others(&times)));
    group.finish();
}

criterion_group!(group, benchmarks);
criterion_main!(group);
