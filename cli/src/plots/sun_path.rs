//! The sun-path diagram: where the sun stands at every hour of the year, as a dome seen from above and as a panorama.

use crate::plots::labels::Room;
use chrono::{DateTime, NaiveDate, TimeDelta, Utc};
use tyndall::ephemeris::civil::{Zone, offset_text};
use tyndall::ephemeris::{Almanac, Instant, Site, SunPosition, Tier, Weather, sun_position};
use tyndall::output::canvas::Color;
use tyndall::output::drawing::Drawing;
use tyndall::output::lettering::{Anchor, text_width};
use tyndall::units::DEG;
use tyndall::{Error, Result};

const INK: Color = [20, 20, 20];
const GRID: Color = [190, 190, 190];
const PATH: Color = [190, 70, 0];
const HOUR: Color = [20, 70, 150];
const MARKED: Color = [0, 120, 85];
const SUN: Color = [255, 200, 40];

/// No more paths of dates than these are drawn: of a longer range some of them, evenly.
const MOST_PATHS: usize = 13;

/// Radius of the sun's mark.
const MARK: f64 = 11.0;

const DOME: [f64; 2] = [400.0, 500.0];
const RADIUS: f64 = 335.0;
/// The panorama's corners: left, top, right, bottom.
const PANORAMA: [f64; 4] = [850.0, 165.0, 1550.0, 835.0];

/// A place on the sky [degrees].
type Sky = (f64, f64);

/// What a diagram marks of its year.
#[derive(Debug, Clone, Default)]
pub struct Marked {
    /// The sun at this instant.
    pub instant: Option<DateTime<Utc>>,
    /// The paths of the dates from the first to the last.
    pub dates: Option<[NaiveDate; 2]>,
}

/// Draws the diagram of a year at a site. Elevations are apparent ones; hours are those of the clock's standard time.
///
/// # Errors
/// [`Error::Domain`] for a year outside those of the ephemeris.
pub fn draw(
    site: &Site,
    clock: &Zone,
    year: i32,
    tier: Tier,
    delta_t: Option<f64>,
    marked: &Marked,
) -> Result<Drawing> {
    let year = Year::new(site, clock, year, tier, delta_t)?;
    let mut drawing = Drawing::new(1600.0, 930.0);
    drawing.text(
        [800.0, 40.0],
        30.0,
        Anchor::Middle,
        INK,
        format!("Sun paths at {} in {}", site.coordinates(), year.number),
    );
    drawing.text(
        [800.0, 78.0],
        17.0,
        Anchor::Middle,
        INK,
        format!(
            "apparent elevation; hours at UTC{}{} (standard time all year); thin paths on the 21st of the months between",
            offset_text(year.offset),
            clock.name().map(|name| format!(", {name}")).unwrap_or_default()
        ),
    );
    dome_grid(&mut drawing);
    let facing = if site.latitude_deg() < 0.0 {
        0.0
    } else {
        180.0
    };
    panorama_grid(&mut drawing, facing);
    let charts: [&dyn Fn(Sky) -> [f64; 2]; 2] = [&dome, &|sky| panorama(sky, facing)];
    for (number, project) in charts.into_iter().enumerate() {
        let wraps = number == 1;
        for hour in 0..24 {
            plot(
                &mut drawing,
                &year.hour(hour),
                project,
                wraps,
                1.1,
                HOUR,
                Some([5.0, 3.0]),
            );
        }
        for month in 1..=12 {
            if let Some(date) = NaiveDate::from_ymd_opt(year.number, month, 21)
                && ![3, 6, 9, 12].contains(&month)
            {
                plot(
                    &mut drawing,
                    &year.path(date),
                    project,
                    wraps,
                    0.9,
                    PATH,
                    None,
                );
            }
        }
        let [march, june, _, december] = year.turns;
        plot(
            &mut drawing,
            &year.path(june),
            project,
            wraps,
            3.0,
            PATH,
            None,
        );
        plot(
            &mut drawing,
            &year.path(march),
            project,
            wraps,
            2.2,
            PATH,
            Some([14.0, 4.0]),
        );
        plot(
            &mut drawing,
            &year.path(december),
            project,
            wraps,
            3.0,
            PATH,
            Some([7.0, 5.0]),
        );
        let mut dates = marked.dates.map_or(Vec::new(), of_range);
        dates.retain(|date| year.reaches(*date));
        for date in &dates {
            let path = year.path(*date);
            plot(&mut drawing, &path, project, wraps, 1.2, MARKED, None);
        }
        let mut room = room(number);
        if let Some(instant) = marked.instant {
            sun_mark(&mut drawing, &mut room, (&year, clock, instant), project);
        }
        date_labels(&mut drawing, &mut room, &year, project);
        marked_labels(&mut drawing, &mut room, (&year, &dates), project);
        hour_labels(&mut drawing, &mut room, &year, project);
    }
    legend(&mut drawing, (&year, clock), marked);
    Ok(drawing)
}

/// A year at a site.
struct Year<'a> {
    site: &'a Site,
    weather: Weather,
    almanac: Almanac,
    /// The first and the last instant that the almanac holds.
    held: [DateTime<Utc>; 2],
    tier: Tier,
    number: i32,
    /// Standard time minus universal time [s].
    offset: i32,
    delta_t: Option<f64>,
    /// March equinox, June solstice, September equinox, December solstice.
    turns: [NaiveDate; 4],
}

impl<'a> Year<'a> {
    fn new(
        site: &'a Site,
        clock: &Zone,
        number: i32,
        tier: Tier,
        delta_t: Option<f64>,
    ) -> Result<Self> {
        let date = |month, day| {
            NaiveDate::from_ymd_opt(number, month, day).ok_or_else(|| {
                Error::domain("the year", number, "-2000 to 6000", "choose another year")
            })
        };
        let noon = |date: NaiveDate| date.and_hms_opt(12, 0, 0).unwrap_or_default().and_utc();
        // Summer time is ahead of standard time, in both hemispheres.
        let offset = clock
            .offset_seconds(noon(date(1, 15)?))
            .min(clock.offset_seconds(noon(date(7, 15)?)));
        let instant = |utc: DateTime<Utc>| match delta_t {
            Some(delta_t) => Instant::from_utc_with(utc, delta_t),
            None => Instant::from_utc(utc),
        };
        let (start, end) = (
            noon(date(1, 1)?) - TimeDelta::days(2),
            noon(date(12, 31)?) + TimeDelta::days(2),
        );
        let mut year = Self {
            site,
            weather: Weather::standard(site),
            almanac: Almanac::new(tier, &instant(start)?, &instant(end)?),
            held: [start, end],
            tier,
            number,
            offset,
            delta_t,
            turns: [date(3, 21)?, date(6, 21)?, date(9, 21)?, date(12, 21)?],
        };
        // The days on which the declination is nearest to zero, greatest, and least.
        let turn = |around: NaiveDate, off: &dyn Fn(f64) -> f64| {
            (-20..=20)
                .map(|i| around + TimeDelta::days(i))
                .min_by(|a, b| {
                    off(year.at(noon(*a)).declination)
                        .total_cmp(&off(year.at(noon(*b)).declination))
                })
                .unwrap_or(around)
        };
        let [march, june, september, december] = year.turns;
        year.turns = [
            turn(march, &f64::abs),
            turn(june, &|d| -d),
            turn(september, &f64::abs),
            turn(december, &|d| d),
        ];
        Ok(year)
    }

    fn at(&self, utc: DateTime<Utc>) -> SunPosition {
        #[expect(
            clippy::expect_used,
            reason = "the year was checked when it was made, and other dates when they were marked"
        )]
        let instant = self.instant(utc).expect("a day of a valid year");
        let (site, weather) = (self.site, &self.weather);
        // A range may go on into other years.
        match (self.held[0]..=self.held[1]).contains(&utc) {
            true => self.almanac.sun_position(&instant, site, weather),
            false => sun_position(self.tier, &instant, site, weather),
        }
    }

    fn instant(&self, utc: DateTime<Utc>) -> Result<Instant> {
        match self.delta_t {
            Some(delta_t) => Instant::from_utc_with(utc, delta_t),
            None => Instant::from_utc(utc),
        }
    }

    /// Whether the ephemeris reaches a date and those beside it.
    fn reaches(&self, date: NaiveDate) -> bool {
        let midnight = date.and_time(chrono::NaiveTime::MIN).and_utc();
        let beside = [-2, 2].map(|days| midnight.checked_add_signed(TimeDelta::days(days)));
        beside
            .into_iter()
            .all(|utc| utc.is_some_and(|utc| self.instant(utc).is_ok()))
    }

    fn sky(&self, date: NaiveDate, seconds: i64) -> Sky {
        let midnight = date.and_time(chrono::NaiveTime::MIN).and_utc();
        let sun = self.at(midnight + TimeDelta::seconds(seconds - i64::from(self.offset)));
        (sun.azimuth_deg(), sun.elevation_apparent_deg())
    }

    /// The path of a day, every four minutes.
    fn path(&self, date: NaiveDate) -> Vec<Sky> {
        (0..=360).map(|i| self.sky(date, 240 * i)).collect()
    }

    /// The place at an hour on every second day of the year.
    fn hour(&self, hour: i64) -> Vec<Sky> {
        let first = NaiveDate::from_ymd_opt(self.number, 1, 1).unwrap_or_default();
        (0..=183)
            .map(|i| self.sky(first + TimeDelta::days(2 * i), 3600 * hour))
            .collect()
    }
}

fn dome((azimuth, elevation): Sky) -> [f64; 2] {
    let r = RADIUS * ((90.0 - elevation) * 0.5 * DEG).tan();
    let (sin, cos) = (azimuth * DEG).sin_cos();
    [DOME[0] + r * sin, DOME[1] - r * cos]
}

fn panorama((azimuth, elevation): Sky, facing: f64) -> [f64; 2] {
    let [left, top, right, bottom] = PANORAMA;
    let turn = (azimuth - facing + 540.0).rem_euclid(360.0) / 360.0;
    [
        left + (right - left) * turn,
        bottom - (bottom - top) * elevation / 90.0,
    ]
}

const WINDS: [&str; 8] = ["N", "NE", "E", "SE", "S", "SW", "W", "NW"];

fn dome_grid(drawing: &mut Drawing) {
    for elevation in (10..90).step_by(10) {
        let r = RADIUS * (f64::from(90 - elevation) * 0.5 * DEG).tan();
        drawing.circle(DOME, r, 0.7, GRID);
    }
    for azimuth in (0..360).step_by(10) {
        let major = azimuth % 30 == 0;
        let inner = dome((f64::from(azimuth), if major { 80.0 } else { 10.0 }));
        drawing.line(
            vec![inner, dome((f64::from(azimuth), 0.0))],
            0.7,
            GRID,
            None,
        );
    }
    drawing.circle(DOME, RADIUS, 2.0, INK);
    for azimuth in (0..360).step_by(15) {
        let (sin, cos) = (f64::from(azimuth) * DEG).sin_cos();
        let at = |r: f64| [DOME[0] + r * sin, DOME[1] - r * cos];
        if azimuth % 45 == 0 {
            let name = WINDS[azimuth as usize / 45];
            drawing.text(
                at(RADIUS + 24.0),
                if azimuth % 90 == 0 { 24.0 } else { 17.0 },
                Anchor::Middle,
                INK,
                name,
            );
        } else if azimuth % 30 == 0 {
            drawing.text(
                at(RADIUS + 22.0),
                14.0,
                Anchor::Middle,
                INK,
                format!("{azimuth}°"),
            );
        }
    }
    // Along an azimuth that few paths cross.
    for elevation in (10..90).step_by(20) {
        drawing.text(
            dome((0.0, f64::from(elevation))),
            12.0,
            Anchor::Middle,
            [90; 3],
            format!("{elevation}°"),
        );
    }
    drawing.text(
        [DOME[0], DOME[1] + RADIUS + 58.0],
        17.0,
        Anchor::Middle,
        INK,
        "stereographic, seen from above",
    );
}

fn panorama_grid(drawing: &mut Drawing, facing: f64) {
    let [left, top, right, bottom] = PANORAMA;
    for elevation in (0..=90).step_by(10) {
        let y = panorama((0.0, f64::from(elevation)), facing)[1];
        drawing.line(vec![[left, y], [right, y]], 0.7, GRID, None);
        drawing.text(
            [left - 10.0, y],
            14.0,
            Anchor::End,
            INK,
            format!("{elevation}°"),
        );
    }
    for step in 0..=24 {
        let azimuth = (facing - 180.0 + 15.0 * f64::from(step)).rem_euclid(360.0);
        let x = left + (right - left) * f64::from(step) / 24.0;
        drawing.line(vec![[x, top], [x, bottom]], 0.7, GRID, None);
        let degrees = azimuth.round() as usize;
        if degrees.is_multiple_of(45) {
            drawing.text(
                [x, bottom + 42.0],
                20.0,
                Anchor::Middle,
                INK,
                WINDS[degrees / 45 % 8],
            );
        }
        if degrees.is_multiple_of(30) {
            drawing.text(
                [x, bottom + 19.0],
                13.0,
                Anchor::Middle,
                INK,
                format!("{degrees}°"),
            );
        }
    }
    drawing.line(
        vec![
            [left, top],
            [right, top],
            [right, bottom],
            [left, bottom],
            [left, top],
        ],
        2.0,
        INK,
        None,
    );
    drawing.text(
        [0.5 * (left + right), bottom + 70.0],
        17.0,
        Anchor::Middle,
        INK,
        "azimuth and elevation",
    );
}

/// Draws what is above the horizon, cut there, and at the panorama's edge.
fn plot(
    drawing: &mut Drawing,
    points: &[Sky],
    project: &dyn Fn(Sky) -> [f64; 2],
    wraps: bool,
    width: f64,
    color: Color,
    dash: Option<[f64; 2]>,
) {
    let mut line: Vec<[f64; 2]> = Vec::new();
    for pair in points.windows(2) {
        let (mut a, mut b) = (pair[0], pair[1]);
        if a.1 < 0.0 && b.1 < 0.0 {
            continue;
        }
        // The shorter way round.
        b.0 = a.0 + (b.0 - a.0 + 540.0).rem_euclid(360.0) - 180.0;
        let cut = |a: Sky, b: Sky| (a.0 + (b.0 - a.0) * a.1 / (a.1 - b.1), 0.0);
        let (enters, leaves) = (a.1 < 0.0, b.1 < 0.0);
        if enters {
            a = cut(a, b);
        } else if leaves {
            b = cut(a, b);
        }
        let (p, q) = (project(a), project(b));
        let torn = wraps && (p[0] - q[0]).abs() > 300.0;
        if line.is_empty() || enters {
            drawing.line(std::mem::take(&mut line), width, color, dash);
            line.push(p);
        }
        if torn {
            drawing.line(std::mem::take(&mut line), width, color, dash);
        } else {
            line.push(q);
        }
        if leaves {
            drawing.line(std::mem::take(&mut line), width, color, dash);
        }
    }
    drawing.line(line, width, color, dash);
}

/// The room for labels in the dome (0) or the panorama (1), without what their grids write there.
fn room(chart: usize) -> Room {
    let [left, top, right, bottom] = PANORAMA;
    if chart == 1 {
        return Room::new([left, top - 20.0, right, bottom]);
    }
    let mut room = Room::new([0.0, 95.0, 800.0, 900.0]);
    for azimuth in (0..360).step_by(15) {
        let (sin, cos) = (f64::from(azimuth) * DEG).sin_cos();
        if azimuth % 45 == 0 || azimuth % 30 == 0 {
            let r = RADIUS + 23.0;
            room.mark([DOME[0] + r * sin, DOME[1] - r * cos], 13.0);
        }
    }
    for elevation in (10..90).step_by(20) {
        room.mark(dome((0.0, f64::from(elevation))), 9.0);
    }
    room
}

/// The dates from the first to the last, both among them.
fn of_range([first, last]: [NaiveDate; 2]) -> Vec<NaiveDate> {
    let days = (last - first).num_days().max(0) as usize;
    let paths = MOST_PATHS.min(days + 1);
    (0..paths)
        .map(|i| first + TimeDelta::days((i * days / (paths - 1).max(1)) as i64))
        .collect()
}

/// `21 Jun`.
fn day_text(date: NaiveDate) -> String {
    date.format("%-d %b").to_string()
}

/// The sun at an instant, with its time; nothing of it below the horizon.
fn sun_mark(
    drawing: &mut Drawing,
    room: &mut Room,
    (year, clock, instant): (&Year, &Zone, DateTime<Utc>),
    project: &dyn Fn(Sky) -> [f64; 2],
) {
    let sun = year.at(instant);
    let sky = (sun.azimuth_deg(), sun.elevation_apparent_deg());
    if sky.1 < 0.0 {
        return;
    }
    let at = project(sky);
    let corner = |i: u32| {
        let (sin, cos) = (f64::from(i) * 10.0 * DEG).sin_cos();
        [at[0] + MARK * cos, at[1] + MARK * sin]
    };
    let time = clock.local(instant);
    let tip = format!(
        "{}: azimuth {:.2}, elevation {:.2} degrees",
        time.format("%Y-%m-%d %H:%M"),
        sky.0,
        sky.1
    );
    drawing.shape((0..36).map(corner).collect(), SUN, 2.0, INK, tip);
    room.mark(at, MARK + 2.0);
    let text = time.format("%H:%M").to_string();
    for offset in [[0.0, -24.0], [0.0, 24.0], [36.0, 0.0], [-36.0, 0.0]] {
        let place = [at[0] + offset[0], at[1] + offset[1]];
        if room.claim(place, [text_width(&text, 16.0) + 4.0, 18.0]) {
            drawing.text(place, 16.0, Anchor::Middle, INK, text);
            return;
        }
    }
}

/// The first and the last date of a range, on their paths in the morning, where those of the year's turns are not.
fn marked_labels(
    drawing: &mut Drawing,
    room: &mut Room,
    (year, dates): (&Year, &[NaiveDate]),
    project: &dyn Fn(Sky) -> [f64; 2],
) {
    let last = dates.last().filter(|_| dates.len() > 1);
    for date in dates.first().into_iter().chain(last) {
        path_label(
            drawing,
            room,
            (year, *date),
            project,
            (MARKED, day_text(*date)),
        );
    }
}

/// Writes along a path, between two hour lines, where there is room: from the highest place on, toward the morning and then the evening.
fn path_label(
    drawing: &mut Drawing,
    room: &mut Room,
    (year, date): (&Year, NaiveDate),
    project: &dyn Fn(Sky) -> [f64; 2],
    (color, text): (Color, String),
) {
    let highest = (0..288)
        .max_by(|&a, &b| {
            let height = |step: i64| year.sky(date, 300 * step).1;
            height(a).total_cmp(&height(b))
        })
        .unwrap_or(144);
    let size = [text_width(&text, 14.0) + 4.0, 16.0];
    for hours in [0, -1, 1, -2, 2, -3, 3, -4, 4] {
        let sky = year.sky(date, 300 * highest - 2100 + 3600 * hours);
        let place = project(sky);
        if sky.1 >= 2.0 && room.claim(place, size) {
            drawing.text(place, 14.0, Anchor::Middle, color, text);
            return;
        }
    }
}

/// Each hour's number, beyond the end of its line on the higher solstice, or on the other; none where there is no room.
fn hour_labels(
    drawing: &mut Drawing,
    room: &mut Room,
    year: &Year,
    project: &dyn Fn(Sky) -> [f64; 2],
) {
    let [_, june, _, december] = year.turns;
    let ends = match year.site.latitude_deg() < 0.0 {
        true => [december, june],
        false => [june, december],
    };
    for hour in 0..24 {
        let (seconds, text) = (3600 * hour, hour.to_string());
        let size = [text_width(&text, 15.0) + 4.0, 16.0];
        let places = ends.into_iter().flat_map(|date| {
            let sky = year.sky(date, seconds);
            // The line comes from there.
            let from = project(year.sky(date - TimeDelta::days(36), seconds));
            let at = project(sky);
            let way = [at[0] - from[0], at[1] - from[1]];
            let length = way[0].hypot(way[1]).max(1e-6);
            // Lines of a few days, or over the panorama's edge, have no direction.
            let direction = match (2.0..200.0).contains(&length) {
                true => way.map(|d| d / length),
                false => [0.0, -1.0],
            };
            let is_up = sky.1 > 1.0;
            let offsets = [14.0, 24.0].into_iter().filter(move |_| is_up);
            offsets.map(move |r| [at[0] + r * direction[0], at[1] + r * direction[1]])
        });
        for place in places {
            if room.claim(place, size) {
                drawing.text(place, 15.0, Anchor::Middle, HOUR, text);
                break;
            }
        }
    }
}

/// The dates of solstices and equinoxes, on their paths.
fn date_labels(
    drawing: &mut Drawing,
    room: &mut Room,
    year: &Year,
    project: &dyn Fn(Sky) -> [f64; 2],
) {
    let [march, june, september, december] = year.turns;
    let both = format!("{}, {}", day_text(march), day_text(september));
    for (date, text) in [
        (june, day_text(june)),
        (march, both),
        (december, day_text(december)),
    ] {
        path_label(drawing, room, (year, date), project, (PATH, text));
    }
}

fn legend(drawing: &mut Drawing, (year, clock): (&Year, &Zone), marked: &Marked) {
    let [march, june, september, december] = year.turns;
    let mut x = 800.0;
    let mut entry = |width: f64, color: Color, dash: Option<[f64; 2]>, text: String| {
        drawing.line(vec![[x, 128.0], [x + 46.0, 128.0]], width, color, dash);
        drawing.text([x + 54.0, 128.0], 14.0, Anchor::Start, INK, text.clone());
        x += 76.0 + text_width(&text, 14.0);
    };
    entry(
        3.0,
        PATH,
        None,
        format!("solstice {}", june.format("%d/%m")),
    );
    entry(
        2.2,
        PATH,
        Some([14.0, 4.0]),
        format!(
            "equinoxes {}, {}",
            march.format("%d/%m"),
            september.format("%d/%m")
        ),
    );
    entry(
        3.0,
        PATH,
        Some([7.0, 5.0]),
        format!("solstice {}", december.format("%d/%m")),
    );
    entry(1.1, HOUR, Some([5.0, 3.0]), "hours".into());
    let (color, text) = match (marked.instant, marked.dates) {
        (Some(instant), _) => {
            let sun = year.at(instant);
            let elevation = sun.elevation_apparent_deg();
            let time = clock.local(instant).format("%Y-%m-%d %H:%M");
            let place = match elevation < 0.0 {
                true => format!("the sun is {:.1} degrees below the horizon", -elevation),
                false => format!(
                    "azimuth {:.1}, elevation {elevation:.1} degrees",
                    sun.azimuth_deg()
                ),
            };
            (INK, format!("{time}: {place}"))
        }
        (None, Some([first, last])) if first == last => (MARKED, first.to_string()),
        (None, Some([first, last])) => (MARKED, format!("{first} to {last}")),
        (None, None) => return,
    };
    drawing.text([24.0, 106.0], 15.0, Anchor::Start, color, text);
}
