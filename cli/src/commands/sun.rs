//! `tyndall sun`: where the sun is, at an instant, over a day, over a range, or for every row of a table.

use std::io::Write;
use std::path::PathBuf;

use chrono::{DateTime, NaiveDate, SecondsFormat, TimeDelta, Utc};
use clap::Args;
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use tyndall::ephemeris::civil::{self, Moment, Zone};
use tyndall::ephemeris::{Almanac, Instant, Site, SunPosition, Tier, TimeScale};
use tyndall::units::DEG;
use tyndall::{Error, Result};

use super::sun_events;
use super::sun_place::Place;
use crate::arguments::form::FormArgs;
use crate::arguments::place_time::{self, PlaceArgs, TimeArgs, step};
use crate::arguments::steps::Steps;
use crate::plots::sun_path::{self, Marked};
use crate::tables::printer::{As, Form};
use crate::tables::rows::Rows;
use crate::tables::stdout;
use crate::tables::sun_batch;
use crate::tables::sun_columns::columns;
use crate::tables::time_text::{time_text, write_time};
use crate::tell;

/// The flags of `tyndall sun`.
#[derive(Args, Debug)]
#[command(after_help = "\
A time gives one instant with the events of its date; a date alone (--time 2026-06-21) the events and a table of the day; \
--until a table up to that time, with --events a row of events a day. Azimuth is from north through east; degrees throughout.\n\n\
Examples:\n  \
tyndall sun --at 48.8584,2.2945 --time 2026-06-21T18:30\n  \
tyndall sun --at 48.8584,2.2945 --time 2026-06-21\n  \
tyndall sun --at 48.8584,2.2945 --time 2026-01-01T00:00Z --until 2027-01-01T00:00Z --step 1m --csv > year.csv\n  \
tyndall sun --at 48.8584,2.2945 --plot paths.svg\n  \
tyndall sun --batch rows.csv > positions.csv")]
pub struct SunArgs {
    #[command(flatten)]
    place: PlaceArgs,
    #[command(flatten)]
    time: TimeArgs,
    #[command(flatten)]
    sun: place_time::SunArgs,
    /// The end of a range that begins at --time; it is not in the table itself
    #[arg(
        long,
        value_name = "T",
        allow_hyphen_values = true,
        conflicts_with = "batch"
    )]
    until: Option<String>,
    /// A row a day: rise, set, noon, twilights, golden and blue hours, the length of the day
    #[arg(long, conflicts_with_all = ["batch", "step"])]
    events: bool,
    /// The step of a table: a number of seconds, or with s, min, h or d (24 h), as in 30min [default: 1h]
    #[arg(long, value_name = "STEP", value_parser = step)]
    step: Option<TimeDelta>,
    /// The true elevation of the sun's centre that counts as rise and set, in degrees
    #[arg(long, value_name = "DEG", default_value_t = -0.8333, allow_negative_numbers = true)]
    horizon: f64,
    /// A CSV of time, latitude, longitude, elevation (and pressure, temperature, delta_t), one position a row; - is stdin
    #[arg(long, value_name = "FILE", conflicts_with_all = ["at", "place", "time", "step", "plot"])]
    batch: Option<PathBuf>,
    /// With --batch: stop at the first broken row, and print nothing
    #[arg(long, requires = "batch")]
    strict: bool,
    /// Draw the sun's paths over the year, stereographic and cartesian, as .svg or .png, with the sun at --time or the paths of its date and
    /// of those up to --until (repeatable)
    #[arg(long, value_name = "FILE")]
    plot: Vec<PathBuf>,
    #[command(flatten)]
    form: FormArgs,
}

/// Runs `tyndall sun`.
pub fn run(args: &SunArgs) -> Result<()> {
    if let Some(path) = &args.batch {
        let form = Form {
            as_what: As::csv_or_json(args.form),
            strict: args.strict,
        };
        return sun_batch::run(path, form, &args.time, &args.sun);
    }
    args.place.say();
    let site = args.place.site().ok_or_else(|| {
        Error::input(
            "tyndall sun",
            "no place is given",
            "write --at LAT,LON[,ELEV] or --place NAME, or --batch FILE",
        )
    })?;
    let weather = args.sun.weather(&site)?;
    let text = args.time.time.as_deref().unwrap_or("now");
    let when = match civil::date_alone(text)? {
        Some(date) => When::Day(date, zone(args, &site, date)?),
        None => When::Moment(Box::new(args.time.moment(text, Some(&site))?)),
    };
    let clock = match &when {
        When::Day(_, zone) => zone.clone(),
        When::Moment(moment) => moment.clock.clone(),
    };
    if let When::Moment(moment) = &when {
        tell::warnings(&moment.warnings);
    }
    let context = Context {
        args,
        place: Place {
            site,
            weather,
            clock,
            tier: args.sun.tier,
            horizon_deg: args.horizon,
            delta_t: args.time.delta_t,
        },
    };
    if !args.plot.is_empty() {
        let year = match &when {
            When::Day(date, _) => chrono::Datelike::year(date),
            When::Moment(moment) => chrono::Datelike::year(&moment.local()),
        };
        let drawing = sun_path::draw(
            &site,
            &context.place.clock,
            year,
            args.sun.tier,
            args.time.delta_t,
            &context.marked(&when)?,
        )?;
        for path in &args.plot {
            drawing.save(path)?;
            tell::files(std::slice::from_ref(path));
        }
        // A picture was asked for; numbers only where a time was, too.
        if args.time.time.is_none() {
            return Ok(());
        }
    }
    if args.events {
        let first = match &when {
            When::Day(date, _) => *date,
            When::Moment(moment) => moment.local().date_naive(),
        };
        return sun_events::run(&context.place, args.form, first, context.last_date(first)?);
    }
    match (when, &args.until) {
        (When::Day(date, _), None) => context.day(date),
        (When::Moment(moment), None) if args.step.is_none() => context.instant(&moment),
        (When::Moment(_), None) => Err(Error::input(
            "--step",
            "a step without an end",
            "add --until T, or give a date alone to --time",
        )),
        (when, Some(until)) => {
            let start = match when {
                When::Day(date, zone) => zone.day(date)?.0,
                When::Moment(moment) => moment.utc,
            };
            let end = match civil::date_alone(until)? {
                Some(date) => context.place.clock.day(date)?.0,
                None => args.time.moment(until, Some(&site))?.utc,
            };
            if end <= start {
                return Err(Error::input(
                    "--until",
                    format!("{until} is not after --time"),
                    "give a later time",
                ));
            }
            context.range(start, end)
        }
    }
}

impl Context<'_> {
    /// What the sun-path diagram marks: the sun at --time, or the path of its date, or those up to --until.
    fn marked(&self, when: &When) -> Result<Marked> {
        if self.args.time.time.is_none() {
            return Ok(Marked::default());
        }
        let (first, instant) = match when {
            When::Day(date, _) => (*date, None),
            When::Moment(moment) => (moment.local().date_naive(), Some(moment.utc)),
        };
        Ok(match &self.args.until {
            Some(_) => Marked {
                instant: None,
                dates: Some([first, self.last_date(first)?]),
            },
            None => Marked {
                instant,
                dates: Some([first, first]),
            },
        })
    }
}

enum When {
    Day(NaiveDate, Zone),
    Moment(Box<Moment>),
}

/// The clock for a date at the site.
fn zone(args: &SunArgs, site: &Site, date: NaiveDate) -> Result<Zone> {
    if args.time.time_scale == TimeScale::Tt {
        return Err(Error::input(
            "--time-scale tt",
            "a civil date has no terrestrial time",
            "leave out --time-scale",
        ));
    }
    civil::zone_for(args.time.tz.as_deref(), site, date)
}

struct Context<'a> {
    args: &'a SunArgs,
    place: Place,
}

impl Context<'_> {
    /// One instant: the position, and the events of its date.
    fn instant(&self, moment: &Moment) -> Result<()> {
        let sun = tyndall::ephemeris::sun_position(
            self.place.tier,
            &moment.instant,
            &self.place.site,
            &self.place.weather,
        );
        let time = civil::local_text(moment.local());
        let mut out = stdout::lock();
        if self.args.form.csv {
            let mut csv = Rows::with_capacity(0);
            csv_names(&mut csv, &sun);
            csv_row(&mut csv, time_text(&moment.local()), &sun);
            out.bytes(&csv.into_bytes())?;
            return out.finish();
        }
        let events = self.place.events(moment.local().date_naive())?;
        if self.args.form.json {
            let value = json!({
                "time": time_text(&moment.local()),
                "utc": moment.utc.to_rfc3339_opts(SecondsFormat::AutoSi, true),
                "jd_utc": moment.instant.ut().jd(),
                "delta_t": moment.instant.delta_t(),
                "clock": self.place.clock_json(),
                "warnings": moment.warnings,
                "place": self.place.json(),
                "tier": self.place.tier.to_string(),
                "sun": sun_json(&sun),
                "events": self.place.events_json(&events),
            });
            out.line(&serde_json::to_string_pretty(&value).unwrap_or_default())?;
            return out.finish();
        }
        let database = moment
            .tz_database
            .as_deref()
            .map(|d| format!("; {d}"))
            .unwrap_or_default();
        let (tier, error) = (self.place.tier, tier_error(self.place.tier));
        let lines = [
            (
                "time",
                format!("{time} ({}{database})", moment.offset_source),
            ),
            (
                "universal time",
                format!(
                    "{}, JD {:.6}, delta-T {:.1} s",
                    moment.utc.to_rfc3339_opts(SecondsFormat::AutoSi, true),
                    moment.instant.ut().jd(),
                    moment.instant.delta_t()
                ),
            ),
            ("place", self.place.text()),
            (
                "algorithm",
                format!(
                    "{tier}, within {error} for the same universal time (UTC is taken as UT1: up to 13.5\" more)"
                ),
            ),
            (
                "azimuth",
                format!(
                    "{:.4}° from north through east ({})",
                    sun.azimuth_deg(),
                    compass(sun.azimuth_deg())
                ),
            ),
            (
                "elevation",
                format!(
                    "{:.4}° apparent, {:.4}° true",
                    sun.elevation_apparent_deg(),
                    sun.elevation_true_deg()
                ),
            ),
            (
                "declination",
                format!(
                    "{:.4}°, right ascension {:.4}°, hour angle {:.4}°",
                    sun.declination / DEG,
                    sun.right_ascension / DEG,
                    sun.hour_angle / DEG
                ),
            ),
            (
                "equation of time",
                format!("{:+.3} min", sun.equation_of_time_minutes),
            ),
            (
                "distance",
                format!(
                    "{:.6} au, angular radius {:.4}°, irradiance {:.4} of the mean",
                    sun.distance_au,
                    sun.angular_radius / DEG,
                    sun.irradiance_factor
                ),
            ),
            (
                "air mass",
                if sun.elevation_apparent > 0.0 {
                    format!("{:.3}", sun.air_mass())
                } else {
                    "the sun is below the horizon".into()
                },
            ),
        ];
        for (name, value) in lines {
            out.line(&format!("{name:<17} {value}"))?;
        }
        out.line("")?;
        self.place.print_events(&mut out, &events)?;
        out.finish()
    }

    /// The last date of a table that begins with `first` and ends before --until; `first` alone without that.
    fn last_date(&self, first: NaiveDate) -> Result<NaiveDate> {
        let Some(until) = &self.args.until else {
            return Ok(first);
        };
        let last = match civil::date_alone(until)? {
            Some(date) => date.pred_opt(),
            // A date that has begun by then is one of them.
            None => {
                let end = self.args.time.moment(until, Some(&self.place.site))?;
                let before = end.utc - TimeDelta::nanoseconds(1);
                Some(self.place.clock.local(before).date_naive())
            }
        };
        last.filter(|last| *last >= first).ok_or_else(|| {
            Error::input(
                "--until",
                format!("{until} is not after --time"),
                "give a later time",
            )
        })
    }

    /// A date: its events, and a table of positions.
    fn day(&self, date: NaiveDate) -> Result<()> {
        let events = self.place.events(date)?;
        let step = self.args.step.unwrap_or(TimeDelta::hours(1));
        let (start, end) = (events.span.0.to_utc(), events.span.1.to_utc());
        if self.args.form.csv {
            return self.range(start, end);
        }
        let steps = Steps::new(start, end, step);
        let rows = self.rows(end, steps, 0..steps.count)?;
        let mut out = stdout::lock();
        if self.args.form.json {
            let positions: Vec<Value> = rows
                .iter()
                .map(|(utc, sun)| with_time(&self.time_text(*utc), sun))
                .collect();
            let value = json!({
                "date": date.to_string(),
                "clock": self.place.clock_json(),
                "place": self.place.json(),
                "tier": self.place.tier.to_string(),
                "events": self.place.events_json(&events),
                "positions": positions,
            });
            out.line(&serde_json::to_string_pretty(&value).unwrap_or_default())?;
            return out.finish();
        }
        out.line(&format!(
            "{date} at {} ({}), tier {}",
            self.place.text(),
            self.place.clock.source(),
            self.place.tier
        ))?;
        out.line("")?;
        self.place.print_events(&mut out, &events)?;
        out.line("")?;
        self.print_table(&mut out, &rows)?;
        out.finish()
    }

    /// A table from one instant up to another.
    fn range(&self, start: DateTime<Utc>, end: DateTime<Utc>) -> Result<()> {
        let step = self.args.step.unwrap_or(TimeDelta::hours(1));
        let steps = Steps::new(start, end, step);
        let count = steps.count;
        let mut out = stdout::lock();
        if self.args.form.csv {
            let sun = tyndall::ephemeris::sun_position(
                self.place.tier,
                &self.instant_at(start)?,
                &self.place.site,
                &self.place.weather,
            );
            let mut csv = Rows::with_capacity(0);
            csv_names(&mut csv, &sun);
            out.bytes(&csv.into_bytes())?;
        } else if self.args.form.json {
            out.line("[")?;
        } else {
            out.line(&format!(
                "{} ({}), tier {}",
                self.place.text(),
                self.place.clock.source(),
                self.place.tier
            ))?;
        }
        // Pieces small enough to be written while the next are computed, large enough for an almanac to pay.
        const PIECE: u64 = 20_000;
        let mut first = 0;
        while first < count {
            let waves: Vec<(u64, u64)> = (0..8)
                .map(|i| (first + i * PIECE, (first + (i + 1) * PIECE).min(count)))
                .filter(|(a, b)| a < b)
                .collect();
            let texts: Vec<Result<Vec<u8>>> = waves
                .par_iter()
                .map(|&(from, to)| {
                    let rows = self.rows(end, steps, from..to)?;
                    if self.args.form.csv {
                        return Ok(self.csv(&rows));
                    }
                    let mut text = Vec::with_capacity(rows.len() * 220);
                    for (i, (utc, sun)) in rows.iter().enumerate() {
                        if self.args.form.json {
                            let comma = if from + i as u64 + 1 < count { "," } else { "" };
                            let row = with_time(&self.time_text(*utc), sun);
                            let _ = writeln!(text, "{row}{comma}");
                        } else {
                            let _ = writeln!(text, "{}", self.table_row(*utc, sun));
                        }
                    }
                    Ok(text)
                })
                .collect();
            if first == 0 && !self.args.form.csv && !self.args.form.json {
                out.line(TABLE_HEAD)?;
            }
            for text in texts {
                out.bytes(&text?)?;
            }
            first += 8 * PIECE;
        }
        if self.args.form.json {
            out.line("]")?;
        }
        out.finish()
    }

    fn instant_at(&self, utc: DateTime<Utc>) -> Result<Instant> {
        match self.args.time.delta_t {
            Some(delta_t) => Instant::from_utc_with(utc, delta_t),
            None => Instant::from_utc(utc),
        }
    }

    /// Rows `range` of a table.
    fn rows(
        &self,
        end: DateTime<Utc>,
        steps: Steps,
        range: std::ops::Range<u64>,
    ) -> Result<Vec<(DateTime<Utc>, SunPosition)>> {
        let (from, to) = (
            self.instant_at(steps.at(range.start))?,
            self.instant_at(steps.at(range.end).min(end))?,
        );
        // An almanac takes a place for each two days: below four positions in these it would not pay.
        let almanac = (steps.are_close() && range.end - range.start > 24)
            .then(|| Almanac::new(self.place.tier, &from, &to));
        range
            .map(|i| {
                let utc = steps.at(i);
                let instant = self.instant_at(utc)?;
                let sun = match &almanac {
                    Some(almanac) => {
                        almanac.sun_position(&instant, &self.place.site, &self.place.weather)
                    }
                    None => tyndall::ephemeris::sun_position(
                        self.place.tier,
                        &instant,
                        &self.place.site,
                        &self.place.weather,
                    ),
                };
                Ok((utc, sun))
            })
            .collect()
    }

    fn time_text(&self, utc: DateTime<Utc>) -> String {
        time_text(&self.place.clock.local(utc))
    }

    fn csv(&self, rows: &[(DateTime<Utc>, SunPosition)]) -> Vec<u8> {
        let mut csv = Rows::with_capacity(rows.len() * 220);
        let mut time = Vec::new();
        for (utc, sun) in rows {
            time.clear();
            write_time(&mut time, &self.place.clock.local(*utc));
            csv_row(&mut csv, &time, sun);
        }
        csv.into_bytes()
    }

    fn print_table(
        &self,
        out: &mut stdout::Out,
        rows: &[(DateTime<Utc>, SunPosition)],
    ) -> Result<()> {
        out.line(TABLE_HEAD)?;
        for (utc, sun) in rows {
            out.line(&self.table_row(*utc, sun))?;
        }
        Ok(())
    }

    fn table_row(&self, utc: DateTime<Utc>, sun: &SunPosition) -> String {
        format!(
            "{:<25} {:>9.4} {:>9.4} {:>9.4} {:>9.4} {:>8.3}",
            civil::local_text(self.place.clock.local(utc)),
            sun.azimuth_deg(),
            sun.elevation_apparent_deg(),
            sun.elevation_true_deg(),
            sun.declination / DEG,
            sun.equation_of_time_minutes
        )
    }
}

const TABLE_HEAD: &str =
    "time                        azimuth  apparent      true     decl.  eq. of time [min]";

fn sun_json(sun: &SunPosition) -> Value {
    Value::Object(
        columns(sun)
            .into_iter()
            .map(|(name, value)| (name.to_owned(), json!(value)))
            .collect(),
    )
}

fn with_time(time: &str, sun: &SunPosition) -> Value {
    let mut row = Map::new();
    row.insert("time".into(), json!(time));
    for (name, value) in columns(sun) {
        row.insert(name.into(), json!(value));
    }
    Value::Object(row)
}

fn csv_names(csv: &mut Rows, sun: &SunPosition) {
    csv.text("time");
    csv.row(columns(sun).map(|(name, _)| name));
}

fn csv_row(csv: &mut Rows, time: impl AsRef<[u8]>, sun: &SunPosition) {
    csv.text(time);
    for (_, value) in columns(sun) {
        csv.number(value);
    }
    csv.end();
}

/// A tier's stated error.
fn tier_error(tier: Tier) -> &'static str {
    match tier {
        Tier::Day => "1.2°",
        Tier::Minute => "0.0105°",
        Tier::Spa => "0.0003°",
        Tier::Arcsecond => "0.2\"",
    }
}

fn compass(azimuth: f64) -> &'static str {
    const POINTS: [&str; 16] = [
        "N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW",
        "NW", "NNW",
    ];
    POINTS[(azimuth / 22.5).round() as usize % 16]
}
