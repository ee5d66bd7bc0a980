//! The sun's direction at equally spaced instants and nothing more: a column for each angle.
//!
//! A [`SunPosition`](super::SunPosition) at a time has eleven values and its own [`Instant`]; the directions
//! of a year of minutes need three columns. Here the instants are taken in blocks, and each step of the way is a loop
//! over a block without a branch or a call, which compilers turn into vector instructions.

use super::almanac::Almanac;
use super::day::{Sun, Year};
use super::julian::Julian;
use super::position::{EARTH_RADIUS_AU, aberration, mean_sidereal, topocentric};
use super::position::{SunPosition, sun_position};
use super::refraction::lift;
use super::site::Site;
use super::spa;
use super::tier::Tier;
use super::time::Instant;
use super::trigonometry::sin_cos;
use super::weather::Weather;
use crate::units::DEG;

/// Instants in a block: its columns stay in the processor's nearest memory.
const LANES: usize = 64;

/// Where the sun stands at equally spaced instants. The columns are of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Directions {
    /// Azimuth [rad] in [0, 2 pi), from north through east, topocentric.
    pub azimuth: Vec<f64>,
    /// Topocentric elevation of the disc's centre along the straight line [rad], in [-pi/2, pi/2].
    pub elevation_true: Vec<f64>,
    /// Topocentric elevation of the disc's centre as seen through the air [rad].
    pub elevation_apparent: Vec<f64>,
}

impl Directions {
    /// The directions at `count` instants from the first to the last, both included; for one instant, at the first.
    ///
    /// Agrees with [`super::sun_position`] within 0.01 arcseconds, as [`Almanac`] does, if delta-T is linear in between
    /// to 0.1 s: over a few years it is. The last may come before the first.
    pub fn new(
        tier: Tier,
        first: &Instant,
        last: &Instant,
        count: usize,
        site: &Site,
        weather: &Weather,
    ) -> Self {
        let mut directions = Self {
            azimuth: Vec::with_capacity(count),
            elevation_true: Vec::with_capacity(count),
            elevation_apparent: Vec::with_capacity(count),
        };
        let times = Times::new(first, last, count);
        // An almanac, which `day` needs not, is cheaper from four instants in two days on.
        let tabulated = tier == Tier::Day || times.step_tt.abs() <= 0.5 && count > 24;
        if !tabulated {
            for i in 0..count {
                let sun = sun_position(tier, &times.instant(first, i), site, weather);
                directions.push(&sun);
            }
            return directions;
        }
        let almanac = Almanac::new(tier, first, last);
        let mut block = Block::default();
        for start in (0..count).step_by(LANES) {
            let used = LANES.min(count - start);
            block.compute(tier, &almanac, &times, (start, used), site, weather);
            directions.azimuth.extend_from_slice(&block.azimuth[..used]);
            directions
                .elevation_true
                .extend_from_slice(&block.elevation_true[..used]);
            directions
                .elevation_apparent
                .extend_from_slice(&block.elevation_apparent[..used]);
        }
        directions
    }

    fn push(&mut self, sun: &SunPosition) {
        self.azimuth.push(sun.azimuth);
        self.elevation_true.push(sun.elevation_true);
        self.elevation_apparent.push(sun.elevation_apparent);
    }
}

/// Equally spaced times [days].
struct Times {
    ut: Julian,
    tt_days: f64,
    step_ut: f64,
    step_tt: f64,
}

impl Times {
    fn new(first: &Instant, last: &Instant, count: usize) -> Self {
        let steps = count.saturating_sub(1).max(1) as f64;
        let days = |from: Julian, to: Julian| (to.day - from.day) + (to.fraction - from.fraction);
        Self {
            ut: first.ut(),
            tt_days: first.tt().days(),
            step_ut: days(first.ut(), last.ut()) / steps,
            step_tt: days(first.tt(), last.tt()) / steps,
        }
    }

    fn instant(&self, first: &Instant, i: usize) -> Instant {
        first.later(i as f64 * self.step_ut, i as f64 * self.step_tt)
    }
}

/// What is computed of a block of instants.
struct Block {
    /// Right ascension from the mean longitude [rad], declination [rad], distance [au], equation of the equinoxes [rad].
    place: [[f64; LANES]; 4],
    tt_days: [f64; LANES],
    /// The part of the year gone, of tier `day` [rad of a turn].
    year: [f64; LANES],
    /// The part of the day gone.
    day: [f64; LANES],
    hour_angle: [f64; LANES],
    declination: [f64; LANES],
    /// The earth's radius in distances of the sun.
    radii: [f64; LANES],
    azimuth: [f64; LANES],
    elevation_true: [f64; LANES],
    elevation_apparent: [f64; LANES],
}

impl Default for Block {
    fn default() -> Self {
        Self {
            place: [[0.0; LANES]; 4],
            tt_days: [0.0; LANES],
            year: [0.0; LANES],
            day: [0.0; LANES],
            hour_angle: [0.0; LANES],
            declination: [0.0; LANES],
            radii: [0.0; LANES],
            azimuth: [0.0; LANES],
            elevation_true: [0.0; LANES],
            elevation_apparent: [0.0; LANES],
        }
    }
}

impl Block {
    /// The directions at `used` instants from the one numbered `start` on; behind them is nothing to be used.
    fn compute(
        &mut self,
        tier: Tier,
        almanac: &Almanac,
        times: &Times,
        (start, used): (usize, usize),
        site: &Site,
        weather: &Weather,
    ) {
        match tier {
            Tier::Day => self.by_day(times, (start, used), site),
            _ => self.by_almanac(tier, almanac, times, start, site),
        }
        let aberration = aberration(tier, site);
        for lane in 0..LANES {
            let [hour_angle, declination] =
                sin_cos([self.hour_angle[lane], self.declination[lane]]);
            let radii = self.radii[lane];
            (self.azimuth[lane], self.elevation_true[lane]) =
                topocentric(hour_angle, declination, radii, aberration, site);
        }
        for lane in 0..LANES {
            let elevation = self.elevation_true[lane];
            self.elevation_apparent[lane] = elevation + lift(elevation, weather);
        }
    }

    /// Hour angle and declination by the civil day.
    fn by_day(&mut self, times: &Times, (start, used): (usize, usize), site: &Site) {
        let mut year = Year::of(times.ut.day);
        // Beyond the span there may be no civil year.
        for lane in 0..used {
            let passed = times.ut.fraction + (start as f64 + lane as f64) * times.step_ut;
            let days = passed.floor();
            let day = times.ut.day + days;
            if !year.holds(day) {
                year = Year::of(day);
            }
            self.day[lane] = passed - days;
            self.year[lane] = year.angle(day, self.day[lane]);
        }
        let longitude = site.longitude_deg() * DEG;
        for lane in 0..LANES {
            let sun = Sun::at(self.year[lane]);
            self.hour_angle[lane] = sun.hour_angle(self.day[lane]) + longitude;
            self.declination[lane] = sun.declination;
            // It is seen from the earth's centre.
            self.radii[lane] = 0.0;
        }
    }

    /// Hour angle, declination and distance by the tabulated places.
    fn by_almanac(
        &mut self,
        tier: Tier,
        almanac: &Almanac,
        times: &Times,
        start: usize,
        site: &Site,
    ) {
        let number = |lane: usize| start as f64 + lane as f64;
        for (lane, tt_days) in self.tt_days.iter_mut().enumerate() {
            *tt_days = times.tt_days + number(lane) * times.step_tt;
        }
        almanac.columns(&self.tt_days, &mut self.place);
        let [from_mean, declination, distance_au, equation_of_equinoxes] = &self.place;

        let longitude = site.longitude_deg() * DEG;
        for lane in 0..LANES {
            let passed = number(lane) * times.step_ut;
            let sidereal = mean_sidereal(
                tier,
                times.ut.fraction + passed,
                times.ut.days() + passed,
                self.tt_days[lane],
            );
            let mean_longitude = spa::mean_longitude(self.tt_days[lane] * (1.0 / 365_250.0));
            self.hour_angle[lane] = sidereal + equation_of_equinoxes[lane] + longitude
                - mean_longitude
                - from_mean[lane];
        }
        for lane in 0..LANES {
            self.declination[lane] = declination[lane];
            self.radii[lane] = EARTH_RADIUS_AU / distance_au[lane];
        }
    }
}
