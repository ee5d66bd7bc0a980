//! Rise, set, noon, midnight and the twilights of a civil date, as roots of the sun's own elevation.
//!
//! Differs from the closed procedure of Reda & Andreas 2004 (appendix A.2), which takes the ephemeris of the wrong day
//! when an event falls on another UTC date than the transit (up to 167 s off at ordinary latitudes).

use chrono::NaiveDate;

use super::almanac::Almanac;
use super::civil::Zone;
use super::position::SunPosition;
use super::site::Site;
use super::tier::Tier;
use super::time::Instant;
use super::weather::Weather;
use crate::error::{Error, Result};
use crate::units::{DAY, DEG};

/// The true elevation of the sun's centre at sunrise and sunset [rad]: 34' of refraction and 16' of radius.
pub const HORIZON: f64 = -0.8333 * DEG;

/// The instants at which the sun passes an elevation on a date.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossings {
    /// Upward, in order; mostly one, none or two near the polar day.
    pub rising: Vec<Instant>,
    /// Downward, in order.
    pub setting: Vec<Instant>,
    /// Whether the sun is above the elevation when the date begins.
    pub above_at_start: bool,
}

/// Why there is no such event on a date.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Absence {
    /// The sun stays above the elevation all day (for the horizon: polar day).
    AboveAllDay,
    /// The sun stays below the elevation all day (for the horizon: polar night).
    BelowAllDay,
    /// The sun passes the elevation the other way only, as on the last day of a polar night; the event falls on a
    /// neighbouring date.
    OtherDate,
}

impl Crossings {
    /// The first passage upward, or why there is none.
    pub fn rise(&self) -> Result<Instant, Absence> {
        self.rising.first().copied().ok_or_else(|| self.absence())
    }

    /// The last passage downward, or why there is none.
    pub fn set(&self) -> Result<Instant, Absence> {
        self.setting.last().copied().ok_or_else(|| self.absence())
    }

    fn absence(&self) -> Absence {
        match (
            self.rising.is_empty() && self.setting.is_empty(),
            self.above_at_start,
        ) {
            (false, _) => Absence::OtherDate,
            (true, true) => Absence::AboveAllDay,
            (true, false) => Absence::BelowAllDay,
        }
    }

    /// The time above the elevation between two instants [s].
    fn seconds_above(&self, start: &Instant, end: &Instant) -> f64 {
        let mut total = 0.0;
        let (mut above, mut since) = (self.above_at_start, *start);
        let mut passages: Vec<Instant> = self.rising.iter().chain(&self.setting).copied().collect();
        passages.sort_by(|a, b| a.ut().seconds_since(b.ut()).total_cmp(&0.0));
        for passage in passages.iter().chain([end]) {
            if above {
                total += passage.ut().seconds_since(since.ut());
            }
            above = !above;
            since = *passage;
        }
        total
    }
}

/// What the sun does on a civil date at a place.
///
/// The elevations are true ones, of the sun's centre, topocentric. At each instant the sun's elevation is the event's
/// to 0.1 arcseconds.
#[derive(Clone, Debug)]
pub struct DayEvents {
    /// The date, by the site's clock.
    pub date: NaiveDate,
    /// The first instant of the date and the first of the next.
    pub span: (Instant, Instant),
    /// The elevation that counts as rise and set [rad].
    pub horizon: f64,
    /// Passages of the horizon: rise and set.
    pub day: Crossings,
    /// Passages of -6 degrees: civil dawn and dusk; the blue hour lies between this and -4 degrees.
    pub civil: Crossings,
    /// Passages of -12 degrees: nautical dawn and dusk.
    pub nautical: Crossings,
    /// Passages of -18 degrees: astronomical dawn and dusk.
    pub astronomical: Crossings,
    /// Passages of +6 degrees: the golden hour's bright end.
    pub golden: Crossings,
    /// Passages of -4 degrees: the golden hour's dark end, the blue hour's bright one.
    pub blue: Crossings,
    /// Upper transits of the meridian: solar noon. One, except by clocks far from the sun's: none or two.
    pub noon: Vec<Instant>,
    /// Lower transits: solar midnight. Mostly one.
    pub midnight: Vec<Instant>,
    /// The time that the sun is above the horizon on this date [s].
    pub day_length: f64,
}

impl DayEvents {
    /// The events of a date by the clock `zone`, with `horizon` [rad] for rise and set, mostly [`HORIZON`].
    ///
    /// `delta_t` [s] as in [`Instant::from_utc_with`], or tabulated.
    ///
    /// # Errors
    /// [`Error::Input`] for a date that the zone does not have; [`Error::Domain`] for a horizon not between -90 and 90
    /// degrees, or a date outside the years -2000 to 6000.
    pub fn new(
        date: NaiveDate,
        zone: &Zone,
        site: &Site,
        tier: Tier,
        horizon: f64,
        delta_t: Option<f64>,
    ) -> Result<Self> {
        if !(-90.0..=90.0).contains(&(horizon / DEG)) {
            return Err(Error::domain(
                "the horizon",
                format!("{} degrees", horizon / DEG),
                "-90 to 90 degrees",
                "give the sun's elevation at rise and set, -0.8333 at sea level",
            ));
        }
        let (start, end) = zone.day(date)?;
        let instant = |utc| match delta_t {
            Some(delta_t) => Instant::from_utc_with(utc, delta_t),
            None => Instant::from_utc(utc),
        };
        let start = instant(start)?;
        let end = start.plus_seconds(instant(end)?.ut().seconds_since(start.ut()));
        let path = Path::new(tier, start, end, site);
        let degrees = |e: f64| path.crossings(e * DEG);
        let day = path.crossings(horizon);
        let day_length = day.seconds_above(&start, &end);
        Ok(Self {
            date,
            span: (start, end),
            horizon,
            day,
            civil: degrees(-6.0),
            nautical: degrees(-12.0),
            astronomical: degrees(-18.0),
            golden: degrees(6.0),
            blue: degrees(-4.0),
            noon: path.transits(0.0),
            midnight: path.transits(std::f64::consts::PI),
            day_length,
        })
    }
}

/// The sun's way over a site from one instant to another.
struct Path<'a> {
    almanac: Almanac,
    site: &'a Site,
    weather: Weather,
    start: Instant,
    seconds: f64,
    /// Elevations at equal steps.
    samples: Vec<f64>,
}

impl<'a> Path<'a> {
    /// Samples every 10 minutes: the sun turns 2.5 degrees, so that a step holds at most one extremum.
    fn new(tier: Tier, start: Instant, end: Instant, site: &'a Site) -> Self {
        let seconds = end.ut().seconds_since(start.ut());
        let steps = (seconds / 600.0).ceil().max(1.0) as usize;
        let mut path = Self {
            almanac: Almanac::new(tier, &start, &end),
            site,
            weather: Weather::standard(site),
            start,
            seconds,
            samples: Vec::new(),
        };
        path.samples = (0..=steps)
            .map(|i| path.elevation(path.time(i, steps)))
            .collect();
        path
    }

    fn time(&self, i: usize, steps: usize) -> f64 {
        self.seconds * i as f64 / steps as f64
    }

    fn at(&self, seconds: f64) -> SunPosition {
        self.almanac
            .sun_position(&self.start.plus_seconds(seconds), self.site, &self.weather)
    }

    fn elevation(&self, seconds: f64) -> f64 {
        self.at(seconds).elevation_true
    }

    /// The passages of an elevation [rad].
    fn crossings(&self, level: f64) -> Crossings {
        let steps = self.samples.len() - 1;
        let height = |seconds: f64| self.elevation(seconds) - level;
        // The times and heights between which the sun passes once at most: the samples, and the extrema that may pass
        // the level unseen between them.
        let mut points: Vec<(f64, f64)> = Vec::with_capacity(steps + 3);
        for i in 0..=steps {
            points.push((self.time(i, steps), self.samples[i] - level));
            if i < steps {
                let (here, next) = (self.samples[i] - level, self.samples[i + 1] - level);
                // A step turns the sun by 2.6 degrees at most: farther from the level nothing is hidden.
                let hidden = here * next > 0.0 && here.abs().min(next.abs()) < 1.4 * DEG;
                if hidden {
                    let (t, h) = extremum(
                        height,
                        self.time(i, steps),
                        self.time(i + 1, steps),
                        here > 0.0,
                    );
                    points.push((t, h));
                }
            }
        }
        let (mut rising, mut setting) = (Vec::new(), Vec::new());
        for pair in points.windows(2) {
            let [(t0, h0), (t1, h1)] = [pair[0], pair[1]];
            if (h0 >= 0.0) != (h1 >= 0.0) {
                let instant = self.start.plus_seconds(root(height, t0, h0, t1, h1));
                if h0 < 0.0 {
                    rising.push(instant)
                } else {
                    setting.push(instant)
                }
            }
        }
        Crossings {
            rising,
            setting,
            above_at_start: points[0].1 >= 0.0,
        }
    }

    /// The passages of a local hour angle [rad].
    fn transits(&self, hour_angle: f64) -> Vec<Instant> {
        let steps = self.samples.len() - 1;
        let past = |seconds: f64| super::place::half_turn(self.at(seconds).hour_angle - hour_angle);
        let times: Vec<(f64, f64)> = (0..=steps)
            .map(|i| (self.time(i, steps), past(self.time(i, steps))))
            .collect();
        times
            .windows(2)
            // The far side of the sky, where the hour angle wraps, is no transit. A date ends before its last instant.
            .filter(|p| p[0].1 <= 0.0 && p[1].1 > 0.0 && p[1].1 - p[0].1 < 1.0)
            .map(|p| {
                self.start
                    .plus_seconds(root(past, p[0].0, p[0].1, p[1].0, p[1].1))
            })
            .collect()
    }
}

/// The lowest (or the highest) point of a function between two times, by golden section to 0.1 s.
///
/// The elevation is flat there: 0.1 s beside it, it differs by less than 1e-5 arcseconds.
fn extremum(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64, lowest: bool) -> (f64, f64) {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let value = |t: f64| if lowest { f(t) } else { -f(t) };
    let (mut a, mut b) = (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut fa, mut fb) = (value(a), value(b));
    while high - low > 0.1 {
        if fa < fb {
            (high, b, fb) = (b, a, fa);
            a = high - RATIO * (high - low);
            fa = value(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + RATIO * (high - low);
            fb = value(b);
        }
    }
    let t = 0.5 * (low + high);
    (t, f(t))
}

/// The root of a function between two times where its sign changes, to a microsecond: the ITP method.
///
/// Source: Oliveira & Takahashi 2020, ACM Transactions on Mathematical Software 47 (1), 5; never slower than bisection.
fn root(f: impl Fn(f64) -> f64, mut a: f64, mut fa: f64, mut b: f64, mut fb: f64) -> f64 {
    const EPSILON: f64 = 0.5e-6;
    if fa == 0.0 {
        return a;
    }
    if fb == 0.0 {
        return b;
    }
    let sign = fb.signum();
    let halvings = ((b - a) / (2.0 * EPSILON)).log2().ceil().max(0.0) + 1.0;
    let kappa = 0.2 / (b - a);
    let mut j = 0.0;
    while b - a > 2.0 * EPSILON && j < 100.0 {
        let middle = 0.5 * (a + b);
        let radius = EPSILON * (halvings - j).exp2() - 0.5 * (b - a);
        let delta = kappa * (b - a) * (b - a);
        let secant = (fb * a - fa * b) / (fb - fa);
        let toward = (middle - secant).signum();
        let truncated = if delta <= (middle - secant).abs() {
            secant + toward * delta
        } else {
            middle
        };
        let t = if (truncated - middle).abs() <= radius {
            truncated
        } else {
            middle - toward * radius
        };
        let value = f(t);
        if value * sign > 0.0 {
            (b, fb) = (t, value);
        } else if value * sign < 0.0 {
            (a, fa) = (t, value);
        } else {
            return t;
        }
        j += 1.0;
    }
    0.5 * (a + b)
}

/// The length of a time [s] as hours, minutes and seconds, `16:10:34`.
pub fn duration_text(seconds: f64) -> String {
    let s = seconds.clamp(0.0, 100.0 * DAY).round() as u64;
    format!("{:02}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn the_ends_of_a_parabola_are_found() {
        let bowl = |t: f64| (t - 1234.5) * (t - 1234.5) - 7.0;
        let (t, value) = extremum(bowl, 0.0, 5000.0, true);
        assert!((t - 1234.5).abs() < 0.1 && (value + 7.0).abs() < 0.01);
        let (t, value) = extremum(|t| -bowl(t), 0.0, 5000.0, false);
        assert!((t - 1234.5).abs() < 0.1 && (value - 7.0).abs() < 0.01);
    }

    #[test]
    fn a_root_takes_few_looks_and_never_more_than_bisection() {
        let day = 86_400.0;
        let looks_at = |f: &dyn Fn(f64) -> f64| {
            let looks = Cell::new(0);
            let counted = |t: f64| {
                looks.set(looks.get() + 1);
                f(t)
            };
            let t = root(counted, 0.0, f(0.0), day, f(day));
            (t, looks.get())
        };
        // Halving a day down to a microsecond takes 37 looks; the method may take one more, and rounding another.
        let (t, looks) = looks_at(&|t| (t / day - 0.3).sin());
        assert!((t - 0.3 * day).abs() < 1e-6 && looks <= 10, "{t}: {looks}");
        let (t, looks) = looks_at(&|t| 0.7 - t / day);
        assert!((t - 0.7 * day).abs() < 1e-6 && looks <= 10, "{t}: {looks}");
        let (t, looks) = looks_at(&|t| (t / day).powi(20) - 1e-6);
        let at = day * 1e-6f64.powf(0.05);
        assert!((t - at).abs() < 1e-6 && looks <= 39, "{t}: {looks}");
        let (t, looks) = looks_at(&|t| if t < 40_000.0 { -1.0 } else { 1e6 });
        assert!((t - 40_000.0).abs() < 1e-6 && looks <= 39, "{t}: {looks}");
        // Ends that are roots need no look.
        assert_eq!(looks_at(&|t| t), (0.0, 0));
        assert_eq!(looks_at(&|t| t - day), (day, 0));
    }
}
