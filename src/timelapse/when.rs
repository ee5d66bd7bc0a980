//! The instants of a time-lapse: two ends, and a step or a number of frames.
//!
//! Ends are times as people write them, or what the sun does on a date. Steps of days go by the clock, through clock changes; what the
//! sun does is solved anew on each day. All others are seconds of time.

use crate::ephemeris::civil::{self, Reading, Zone};
use crate::ephemeris::{Absence, Crossings, DayEvents, HORIZON, Instant, Site, Tier, duration};
use crate::error::{Error, Result, nearest};
use chrono::{DateTime, Days, NaiveDate, NaiveDateTime, NaiveTime, SubsecRound, TimeDelta, Utc};
use std::str::FromStr;

/// The most frames of a sequence.
const MOST_FRAMES: u64 = 10_000_000;

/// So many days around a date are searched for one on which the sun does something: half a year, and the longest polar day.
const SEARCHED: u64 = 200;

/// What the sun does once a day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Its centre passes -18 degrees upward.
    AstronomicalDawn,
    /// -12 degrees upward.
    NauticalDawn,
    /// -6 degrees upward.
    CivilDawn,
    /// Its upper edge rises ([`HORIZON`]).
    Sunrise,
    /// It passes the meridian.
    SolarNoon,
    /// Its upper edge sets.
    Sunset,
    /// -6 degrees downward.
    CivilDusk,
    /// -12 degrees downward.
    NauticalDusk,
    /// -18 degrees downward.
    AstronomicalDusk,
    /// It passes the meridian on the other side of the earth.
    SolarMidnight,
}

impl Event {
    /// All of them, in the order of a day.
    pub const ALL: [Event; 10] = [
        Event::AstronomicalDawn,
        Event::NauticalDawn,
        Event::CivilDawn,
        Event::Sunrise,
        Event::SolarNoon,
        Event::Sunset,
        Event::CivilDusk,
        Event::NauticalDusk,
        Event::AstronomicalDusk,
        Event::SolarMidnight,
    ];

    /// Its name in flags.
    pub fn name(self) -> &'static str {
        match self {
            Event::AstronomicalDawn => "astronomical-dawn",
            Event::NauticalDawn => "nautical-dawn",
            Event::CivilDawn => "civil-dawn",
            Event::Sunrise => "sunrise",
            Event::SolarNoon => "solar-noon",
            Event::Sunset => "sunset",
            Event::CivilDusk => "civil-dusk",
            Event::NauticalDusk => "nautical-dusk",
            Event::AstronomicalDusk => "astronomical-dusk",
            Event::SolarMidnight => "solar-midnight",
        }
    }

    fn of(self, day: &DayEvents) -> Result<Instant, Absence> {
        let rise = |crossings: &Crossings| crossings.rise();
        let set = |crossings: &Crossings| crossings.set();
        let transit = |found: &[Instant]| found.first().copied().ok_or(Absence::OtherDate);
        match self {
            Event::AstronomicalDawn => rise(&day.astronomical),
            Event::NauticalDawn => rise(&day.nautical),
            Event::CivilDawn => rise(&day.civil),
            Event::Sunrise => rise(&day.day),
            Event::SolarNoon => transit(&day.noon),
            Event::Sunset => set(&day.day),
            Event::CivilDusk => set(&day.civil),
            Event::NauticalDusk => set(&day.nautical),
            Event::AstronomicalDusk => set(&day.astronomical),
            Event::SolarMidnight => transit(&day.midnight),
        }
    }

    /// Why it is not there, in words.
    fn missing(self, absence: Absence) -> String {
        let level = match self {
            Event::Sunrise | Event::Sunset => "the horizon",
            Event::CivilDawn | Event::CivilDusk => "-6 degrees",
            Event::NauticalDawn | Event::NauticalDusk => "-12 degrees",
            _ => "-18 degrees",
        };
        match absence {
            Absence::AboveAllDay => format!("the sun stays above {level} all day"),
            Absence::BelowAllDay => format!("the sun stays below {level} all day"),
            Absence::OtherDate => "it falls on the date before or after".to_owned(),
        }
    }
}

/// The time from a frame to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Every {
    /// Of time: `24h` is 86 400 s.
    Time(TimeDelta),
    /// Of the calendar: `1d` keeps the clock's time through clock changes.
    Days(u64),
}

impl FromStr for Every {
    type Err = Error;

    /// Numbers with `ms`, `s`, `m` (or `min`) and `h`, as in `30s`, `1h30m` and `1.5h`; or whole days, `1d`, and weeks, `2w`.
    fn from_str(text: &str) -> Result<Self> {
        let problem = |what: &str| {
            Error::input(
                format!("a step of `{text}`"),
                what,
                "write it as 30s, 5m, 1h30m, 1d or 1w, above zero",
            )
        };
        let days = |unit: char, each: u64| {
            let number = text.trim().strip_suffix(unit)?.parse::<u64>().ok()?;
            (1..=1_000_000).contains(&number).then_some(each * number)
        };
        if let Some(days) = days('d', 1).or(days('w', 7)) {
            return Ok(Every::Days(days));
        }
        // Days go by the clock: they are no part of a time.
        let time = whole_milliseconds(text).filter(|_| !text.contains('d'));
        match time {
            Some(time) if time > TimeDelta::zero() => Ok(Every::Time(time)),
            Some(_) => Err(problem("no time passes")),
            None => Err(problem("it is no time that passes")),
        }
    }
}

impl std::fmt::Display for Every {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Every::Days(days) => write!(f, "{days}d"),
            Every::Time(time) => match time.num_milliseconds() {
                ms if ms % 1000 == 0 => write!(f, "{}s", ms / 1000),
                ms => write!(f, "{ms}ms"),
            },
        }
    }
}

/// How many frames there are between the ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Count {
    /// So many, evenly over time, both ends among them.
    Frames(u64),
    /// One at the first end, and one after each such time up to and including the second.
    Every(Every),
}

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// The first end.
    pub from: &'a str,
    /// The second.
    pub to: &'a str,
    /// The date of what the sun does, and of times of day.
    pub date: Option<NaiveDate>,
    /// How many frames.
    pub count: Count,
}

/// Where and by which clock.
#[derive(Debug, Clone, Copy)]
pub struct Observer<'a> {
    /// The place.
    pub site: &'a Site,
    /// How times are read.
    pub reading: Reading<'a>,
    /// How the sun is found.
    pub tier: Tier,
}

/// The instants of a sequence, in order.
#[derive(Debug, Clone)]
pub struct When {
    count: u64,
    steps: Steps,
    clock: Zone,
    /// In words.
    step: String,
}

#[derive(Debug, Clone)]
enum Steps {
    Even {
        from: DateTime<Utc>,
        to: DateTime<Utc>,
    },
    Every {
        from: DateTime<Utc>,
        step: TimeDelta,
    },
    Days(Box<Daily>),
}

/// The same time of some days.
#[derive(Debug, Clone)]
struct Daily {
    first: NaiveDate,
    /// On that date, as it was asked for: a clock may show its time twice.
    start: DateTime<Utc>,
    days: u64,
    what: OfDay,
    sun: Observed,
}

/// An end as it was written.
#[derive(Debug, Clone, Copy, PartialEq)]
enum OfDay {
    /// What the sun does, and so long after.
    Sun(Event, TimeDelta),
    /// A time of the clock.
    Clock(NaiveTime),
}

#[derive(Debug, Clone)]
enum End {
    OfDay(OfDay),
    Date(NaiveDate),
    At(DateTime<Utc>, Zone),
}

/// The observer, kept.
#[derive(Debug, Clone)]
struct Observed {
    site: Site,
    tier: Tier,
    delta_t: Option<f64>,
    fold: Option<civil::Fold>,
    zone: Zone,
}

impl When {
    /// Reads the ends and counts the frames.
    ///
    /// # Errors
    /// Those of [`civil::resolve_with`]; [`Error::Input`] for an end that cannot be read or has no date, for a day on which the sun does
    /// not do that here (with the nearest day on which it does), and for ends in the wrong order.
    pub fn new(asked: &Asked<'_>, observer: &Observer<'_>) -> Result<Self> {
        let [from, to] = [("--from", asked.from), ("--to", asked.to)]
            .map(|(flag, text)| read(flag, text, observer));
        let (from, to) = (from?, to?);
        let date = |flag: &str, other: &End| match (asked.date, other) {
            (Some(date), _) => Ok(date),
            (None, End::At(utc, zone)) => Ok(zone.local(*utc).date_naive()),
            (None, End::Date(date)) if flag == "--from" => Ok(*date),
            _ => Err(Error::input(
                flag,
                "its date is not known",
                "give --date YYYY-MM-DD",
            )),
        };
        let zone = match (&from, &to) {
            (End::At(_, zone), _) | (_, End::At(_, zone)) => zone.clone(),
            _ => {
                let date = date("--from", &to)?;
                civil::zone_for(observer.reading.zone, observer.site, date)?
            }
        };
        let sun = Observed {
            site: *observer.site,
            tier: observer.tier,
            delta_t: observer.reading.delta_t,
            fold: observer.reading.fold,
            zone,
        };
        let (first, start, what) = match &from {
            End::At(utc, _) => {
                let local = sun.zone.local(*utc).naive_local();
                (local.date(), *utc, OfDay::Clock(local.time()))
            }
            End::OfDay(what) => {
                let date = date("--from", &to)?;
                (date, sun.at("--from", *what, date)?, *what)
            }
            End::Date(date) => {
                return Err(Error::input(
                    format!("--from {date}"),
                    "it has no time of day",
                    "write 2026-06-21T18:30, or sunrise with --date 2026-06-21",
                ));
            }
        };
        let end = match &to {
            End::At(utc, _) => *utc,
            End::Date(date) => sun.at("--to", what, *date)?,
            End::OfDay(of_day) => {
                let date = date("--to", &from).unwrap_or(first);
                let end = sun.at("--to", *of_day, date)?;
                match date.succ_opt() {
                    // That of the next day.
                    Some(next) if end < start => sun.at("--to", *of_day, next)?,
                    _ => end,
                }
            }
        };
        let order = |problem: &str| {
            Err(Error::input(
                format!("--to {}", asked.to),
                format!(
                    "it is {}, and --from is {}: {problem}",
                    civil::local_text(sun.zone.local(end)),
                    civil::local_text(sun.zone.local(start))
                ),
                "give a --to that is after --from",
            ))
        };
        if end < start {
            return order("it is before it");
        }
        let span = end - start;
        let (count, steps, step) = match asked.count {
            Count::Frames(0) => {
                return Err(Error::input(
                    "--frames 0",
                    "there would be no frame",
                    "ask for one or more",
                ));
            }
            Count::Frames(count) if count <= MOST_FRAMES => {
                if count > 1 && span < TimeDelta::milliseconds(count as i64 - 1) {
                    return order("there is less than a millisecond from a frame to the next");
                }
                let even = Steps::Even {
                    from: start,
                    to: end,
                };
                (count, even, format!("{count} frames"))
            }
            Count::Frames(count) => return Err(too_many(count)),
            Count::Every(every) => {
                let step = format!("every {every}");
                match every {
                    Every::Time(time) => {
                        let count = nanoseconds(span) / nanoseconds(time) + 1;
                        let every = Steps::Every {
                            from: start,
                            step: time,
                        };
                        (u64::try_from(count).unwrap_or(u64::MAX), every, step)
                    }
                    Every::Days(days) => {
                        let daily = Daily {
                            first,
                            start,
                            days,
                            what,
                            sun: sun.clone(),
                        };
                        let end_local = sun.zone.local(end).naive_local();
                        // An offset brings an instant to another date, and a clock's day may begin before or after the sun's: from a day
                        // that is surely late enough it is counted down.
                        let last = match what {
                            OfDay::Sun(_, offset) => end_local.checked_sub_signed(offset),
                            OfDay::Clock(_) => Some(end_local),
                        };
                        let last = last.unwrap_or(end_local).date();
                        let between = (last - first).num_days().max(0) as u64;
                        let mut count = (between + 2) / days + 1;
                        while count > 1 && daily.is_after(count - 1, end, end_local) {
                            count -= 1;
                        }
                        (count, Steps::Days(Box::new(daily)), step)
                    }
                }
            }
        };
        if count > MOST_FRAMES {
            return Err(too_many(count));
        }
        Ok(When {
            count,
            steps,
            clock: sun.zone,
            step,
        })
    }

    /// The number of frames, 1 or more.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The clock of the place.
    pub fn clock(&self) -> &Zone {
        &self.clock
    }

    /// The step from frame to frame, in words.
    pub fn step(&self) -> &str {
        &self.step
    }

    /// The instant of a frame, 0 to [`When::count`] less 1.
    ///
    /// # Errors
    /// [`Error::Input`] for a day on which the sun does not do what is asked for, and for a time of the clock that is skipped or
    /// repeated on that day.
    pub fn get(&self, number: u64) -> Result<DateTime<Utc>> {
        match &self.steps {
            Steps::Even { to, .. } if number > 0 && number + 1 >= self.count => Ok(*to),
            Steps::Even { from, to } => {
                let parts = i128::from(self.count.max(2) - 1);
                let after = nanoseconds(*to - *from) * i128::from(number) / parts;
                Ok(match number {
                    0 => *from,
                    _ => later(*from, after).round_subsecs(3),
                })
            }
            Steps::Every { from, step } => {
                Ok(later(*from, nanoseconds(*step) * i128::from(number)))
            }
            Steps::Days(daily) => daily.get(number),
        }
    }

    /// An instant as [`crate::conditions::Conditions::at`] reads it: exact, and by the clock of the place.
    pub fn text(&self, utc: DateTime<Utc>) -> String {
        let time = utc_text(utc);
        match (self.clock.name(), self.clock.offset_seconds(utc)) {
            (Some(name), _) => format!("{time}[{name}]"),
            (None, offset) if self.clock.source() == "UTC" && offset == 0 => format!("{time}[UTC]"),
            (None, offset) => format!("{time}[{}]", civil::offset_text(offset)),
        }
    }

    /// An instant by the clock of the place, with its offset.
    pub fn local_text(&self, utc: DateTime<Utc>) -> String {
        civil::exact_local_text(self.clock.local(utc))
    }
}

/// An instant as UTC (RFC 3339).
pub fn utc_text(utc: DateTime<Utc>) -> String {
    utc.format("%Y-%m-%dT%H:%M:%S%.fZ").to_string()
}

/// A time that passes, for frames: plans and keys hold milliseconds.
fn whole_milliseconds(text: &str) -> Option<TimeDelta> {
    duration(text).filter(|time| time.subsec_nanos() % 1_000_000 == 0)
}

fn too_many(count: u64) -> Error {
    Error::domain(
        "the number of frames",
        count,
        format!("1 to {MOST_FRAMES}"),
        "take fewer frames, or longer steps",
    )
}

fn nanoseconds(time: TimeDelta) -> i128 {
    i128::from(time.num_seconds()) * 1_000_000_000 + i128::from(time.subsec_nanos())
}

/// The instant so many nanoseconds later, within the time between two instants.
fn later(from: DateTime<Utc>, nanoseconds: i128) -> DateTime<Utc> {
    let [seconds, rest] = [nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000];
    from + TimeDelta::seconds(seconds as i64) + TimeDelta::nanoseconds(rest as i64)
}

impl Daily {
    fn date(&self, number: u64) -> Option<NaiveDate> {
        let days = Days::new(self.days.saturating_mul(number));
        self.first.checked_add_days(days)
    }

    fn get(&self, number: u64) -> Result<DateTime<Utc>> {
        if number == 0 {
            return Ok(self.start);
        }
        let date = self.date(number).ok_or_else(|| {
            Error::input(
                "--to",
                "it is too far in the future",
                "give an earlier --to",
            )
        })?;
        self.sun.at("--from", self.what, date)
    }

    /// Whether a frame would be after the end, which is `end_local` by the clock. One that is not there is if all of its day is.
    fn is_after(&self, number: u64, end: DateTime<Utc>, end_local: NaiveDateTime) -> bool {
        if let Ok(utc) = self.get(number) {
            return utc > end;
        }
        let earliest = self.date(number).and_then(|date| match self.what {
            OfDay::Clock(time) => Some(date.and_time(time)),
            OfDay::Sun(_, offset) => date.and_time(NaiveTime::MIN).checked_add_signed(offset),
        });
        earliest.is_none_or(|earliest| earliest > end_local)
    }
}

impl Observed {
    /// The instant of a time of day on a date.
    fn at(&self, flag: &str, what: OfDay, date: NaiveDate) -> Result<DateTime<Utc>> {
        let (event, offset) = match what {
            OfDay::Clock(time) => return self.zone.instant(date.and_time(time), self.fold),
            OfDay::Sun(event, offset) => (event, offset),
        };
        match self.event(event, date)? {
            Ok(utc) => Ok(utc + offset),
            Err(absence) => {
                let name = event.name();
                let near = (1..=SEARCHED)
                    .flat_map(|days| {
                        let days = Days::new(days);
                        [date.checked_add_days(days), date.checked_sub_days(days)]
                    })
                    .flatten()
                    .find(|near| matches!(self.event(event, *near), Ok(Ok(_))));
                Err(Error::input(
                    format!("{flag} {name}"),
                    format!(
                        "there is no {name} here on {date}: {}",
                        event.missing(absence)
                    ),
                    match near {
                        Some(near) => {
                            format!("the nearest day with one is {near} (--date {near})")
                        }
                        None => "no day of the year has one here: take another end".to_owned(),
                    },
                ))
            }
        }
    }

    fn event(&self, event: Event, date: NaiveDate) -> Result<Result<DateTime<Utc>, Absence>> {
        let Observed {
            site,
            tier,
            delta_t,
            zone,
            ..
        } = self;
        let day = DayEvents::new(date, zone, site, *tier, HORIZON, *delta_t)?;
        // No picture shows less than a millisecond.
        Ok(event.of(&day).map(|at| at.to_utc().round_subsecs(3)))
    }
}

/// Whether an end is what the sun does or a time of day, so that it has no date of its own.
pub fn is_of_day(end: &str) -> bool {
    is_event(end) || clock_time(end).is_some()
}

fn is_event(end: &str) -> bool {
    let end = end.trim();
    let begins = |with: &str| {
        end.get(..with.len())
            .is_some_and(|start| start.eq_ignore_ascii_case(with))
    };
    // A word, but for `now` and Julian dates.
    end.starts_with(|c: char| c.is_ascii_alphabetic())
        && !end.eq_ignore_ascii_case("now")
        && !begins("jd")
}

fn clock_time(end: &str) -> Option<NaiveTime> {
    ["%H:%M", "%H:%M:%S", "%H:%M:%S%.f"]
        .iter()
        .find_map(|form| NaiveTime::parse_from_str(end.trim(), form).ok())
}

/// Reads an end.
fn read(flag: &str, text: &str, observer: &Observer<'_>) -> Result<End> {
    let text = text.trim();
    if is_event(text) {
        return event(flag, text).map(End::OfDay);
    }
    if let Some(date) = civil::date_alone(text)? {
        return Ok(End::Date(date));
    }
    if let Some(time) = clock_time(text) {
        return Ok(End::OfDay(OfDay::Clock(time)));
    }
    let moment = civil::resolve_with(text, &observer.reading)?;
    Ok(End::At(moment.utc, moment.clock))
}

/// `sunset`, `sunset-20m`, `civil-dusk+1h`.
fn event(flag: &str, text: &str) -> Result<OfDay> {
    let problem =
        |what: String, remedy: String| Error::input(format!("{flag} {text}"), what, remedy);
    // Names have hyphens too, with a letter behind.
    let is_sign = |(at, c): &(usize, char)| {
        let after = text[at + c.len_utf8()..].trim_start();
        "+-".contains(*c) && !after.starts_with(|c: char| c.is_ascii_alphabetic())
    };
    let sign = text.char_indices().find(is_sign);
    let (name, offset) = text.split_at(sign.map_or(text.len(), |(at, _)| at));
    let names = || Event::ALL.iter().map(|event| event.name());
    let name = name.trim().to_ascii_lowercase();
    let Some(event) = Event::ALL.into_iter().find(|event| event.name() == name) else {
        return Err(problem(
            format!("`{name}` is nothing that the sun does"),
            match nearest(&name, names()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!(
                    "write a time, or one of {}",
                    names().collect::<Vec<_>>().join(", ")
                ),
            },
        ));
    };
    let offset = match offset.trim() {
        "" => Some(TimeDelta::zero()),
        offset => match offset.split_at(1) {
            ("+", time) => whole_milliseconds(time),
            ("-", time) => whole_milliseconds(time).map(|time| -time),
            _ => None,
        },
    };
    match offset {
        Some(offset) => Ok(OfDay::Sun(event, offset)),
        None => Err(problem(
            format!("what follows `{name}` is no time before or after it"),
            format!("write {name}-20m or {name}+1h30m"),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_as_people_write_them() {
        let seconds = |text: &str| match text.parse() {
            Ok(Every::Time(time)) => time.num_milliseconds() as f64 / 1e3,
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(seconds("30s"), 30.0);
        assert_eq!(seconds("250ms"), 0.25);
        assert_eq!(seconds("5m"), 300.0);
        assert_eq!(seconds("5min"), 300.0);
        assert_eq!(seconds("1h30m"), 5400.0);
        assert_eq!(seconds("1.5h"), 5400.0);
        assert_eq!(seconds("24h"), 86_400.0);
        assert_eq!("1d".parse::<Every>().ok(), Some(Every::Days(1)));
        assert_eq!("2w".parse::<Every>().ok(), Some(Every::Days(14)));
        for bad in [
            "", "30", "s", "-5s", "0s", "0d", "1.5d", "1d12h", "1x", "1e3", "0.1ms", "1..5s",
        ] {
            assert!(bad.parse::<Every>().is_err_and(|e| e.is_input()), "{bad}");
        }
    }

    #[test]
    fn times_have_a_date() {
        for text in [
            "2026-06-21T18:30",
            "2026-06-21",
            "-0500-01-01T00:00Z",
            "now",
            "JD2461200.5",
        ] {
            assert!(!is_of_day(text), "{text}");
        }
        for text in ["18:30", "06:00:00.5", "sunrise-20m", " civil-dusk"] {
            assert!(is_of_day(text), "{text}");
        }
    }

    #[test]
    fn what_the_sun_does_with_an_offset() {
        let of = |text: &str| event("--from", text);
        let sun = |event, minutes| OfDay::Sun(event, TimeDelta::minutes(minutes));
        assert_eq!(of("sunrise-20m").ok(), Some(sun(Event::Sunrise, -20)));
        assert_eq!(of("sunset + 1h40m").ok(), Some(sun(Event::Sunset, 100)));
        assert_eq!(of("Civil-Dusk").ok(), Some(sun(Event::CivilDusk, 0)));
        assert_eq!(of("solar-noon+0s").ok(), Some(sun(Event::SolarNoon, 0)));
        let misspelt = of("sunsett-5m").expect_err("it is misspelt");
        assert!(misspelt.remedy().contains("`sunset`?"), "{misspelt}");
        for bad in [
            "sunset-",
            "sunset+",
            "sunset-20",
            "sunset*2m",
            "sunset--5m",
            "5m",
        ] {
            assert!(of(bad).is_err_and(|e| e.is_input()), "{bad}");
        }
    }
}
