//! The flags for a place and a time, shared by every command that asks where the sun is.

use crate::arguments::hinted::{hinted, zones};
use crate::tell;
use chrono::TimeDelta;
use clap::Args;
use tyndall::ephemeris::civil::{self, Fold, Moment, Reading};
use tyndall::ephemeris::gazetteer::{self, NamedPlace};
use tyndall::ephemeris::{Site, Tier, TimeScale, Weather, duration};
use tyndall::{Error, Result};

/// Where: `--at`, or `--place`.
#[derive(Args, Clone, Debug, Default)]
pub struct PlaceArgs {
    /// The place: degrees north and east, and metres above sea level, as in 48.8584,2.2945,35 or 33°51'36"S,151.2E
    #[arg(long, value_name = "LAT,LON[,ELEV]", value_parser = site, allow_hyphen_values = true)]
    at: Option<Site>,
    /// The place by its name, as in Chicago: the principal places of all time zones are known
    #[arg(long, value_name = "NAME", value_parser = hinted(place, gazetteer::names()), hide_possible_values = true, conflicts_with = "at")]
    place: Option<NamedPlace>,
}

impl PlaceArgs {
    /// The place, if one is given.
    pub fn site(&self) -> Option<Site> {
        self.at.or(self.place.as_ref().map(|place| place.site))
    }

    /// Says which place a name was taken for.
    pub fn say(&self) {
        if let Some(NamedPlace {
            name,
            country,
            site,
            ..
        }) = &self.place
        {
            tell::line(
                "place",
                format!(
                    "{name}, {country}: --at {},{}",
                    site.latitude_deg(),
                    site.longitude_deg()
                ),
            );
        }
    }
}

/// A place by its name.
fn place(text: &str) -> Result<NamedPlace, String> {
    gazetteer::named(text).map_err(|error| format!("{}; {}", error.problem(), error.remedy()))
}

/// When: `--time` and how to read it.
#[derive(Args, Clone, Debug, Default)]
pub struct TimeArgs {
    /// The time: RFC 3339 (2026-06-21T18:30:00+02:00), a local time of the site, a Julian date (JD2451545.0) or now
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = not_a_flag)]
    pub time: Option<String>,
    /// The time zone of local times and of dates: IANA name or offset [default: looked up from --at]
    #[arg(long, value_name = "ZONE", allow_hyphen_values = true, value_parser = hinted(not_a_flag, zones()), hide_possible_values = true)]
    pub tz: Option<String>,
    /// Which reading to use of a time that a clock change skips or repeats
    #[arg(long, value_name = "earlier|later", value_parser = hinted(named::<Fold>, ["earlier", "later"]), hide_possible_values = true)]
    pub fold: Option<Fold>,
    /// The scale of Julian dates; UTC is taken as UT1 (they differ by less than 0.9 s, 13.5 arcseconds of hour angle)
    #[arg(long, value_name = "utc|ut1|tt", default_value = "utc", value_parser = hinted(named::<TimeScale>, ["utc", "ut1", "tt"]), hide_possible_values = true)]
    pub time_scale: TimeScale,
    /// TT - UT1 in seconds [default: observed, predicted or extrapolated, by the year]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = number)]
    pub delta_t: Option<f64>,
}

/// How: the algorithm and the air.
#[derive(Args, Clone, Debug, Default)]
pub struct SunArgs {
    /// The algorithm: day (1.2 degrees), minute (0.0105), spa (0.0003) or arcsecond (0.2 arcseconds)
    #[arg(long, value_name = "TIER", default_value = "spa", value_parser = hinted(named::<Tier>, ["day", "minute", "spa", "arcsecond"]), hide_possible_values = true)]
    pub tier: Tier,
    /// Air pressure at the site in hPa [default: the standard atmosphere's at its elevation]
    #[arg(long, value_name = "HPA", allow_negative_numbers = true, value_parser = number)]
    pub pressure: Option<f64>,
    /// Air temperature at the site in degrees Celsius [default: the standard atmosphere's at its elevation]
    #[arg(long, value_name = "C", allow_negative_numbers = true, value_parser = number)]
    pub temperature: Option<f64>,
}

impl TimeArgs {
    /// What the flags say about reading a time at a site.
    pub fn reading<'a>(&'a self, site: Option<&'a Site>) -> Reading<'a> {
        Reading {
            zone: self.tz.as_deref(),
            site,
            fold: self.fold,
            scale: self.time_scale,
            delta_t: self.delta_t,
        }
    }

    /// The moment that a text means at a site.
    ///
    /// # Errors
    /// [`Error::Input`] or [`Error::Domain`] from [`civil::resolve_with`], and for a civil time with `--time-scale tt`.
    pub fn moment(&self, text: &str, site: Option<&Site>) -> Result<Moment> {
        self.moment_by(text, &self.reading(site))
    }

    /// The same as another reading has it, such as that of a scene with a zone.
    ///
    /// # Errors
    /// Those of [`Self::moment`].
    pub fn moment_by(&self, text: &str, reading: &Reading) -> Result<Moment> {
        let julian = text
            .trim()
            .get(..2)
            .is_some_and(|start| start.eq_ignore_ascii_case("jd"));
        if self.time_scale == TimeScale::Tt && !julian {
            return Err(Error::input(
                "--time-scale tt",
                format!("`{text}` is a civil time, which is UTC"),
                "write the time as a Julian date, JD2451545.0, or leave out --time-scale",
            ));
        }
        civil::resolve_with(text, reading)
    }
}

impl SunArgs {
    /// Pressure and temperature at a site: those of the flags, else of the standard atmosphere.
    ///
    /// # Errors
    /// [`Error::Domain`] for a pressure or temperature out of range.
    pub fn weather(&self, site: &Site) -> Result<Weather> {
        let standard = Weather::standard(site);
        if self.pressure.is_none() && self.temperature.is_none() {
            return Ok(standard);
        }
        Weather::new(
            self.pressure.unwrap_or(standard.pressure_hpa()),
            self.temperature.unwrap_or(standard.temperature_c()),
        )
    }
}

/// One of a flag's names.
fn named<T: std::str::FromStr<Err = Error>>(text: &str) -> Result<T, String> {
    text.parse().map_err(|error: Error| error.remedy())
}

/// A finite number.
fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err("a finite number was expected".into()),
    }
}

/// Seconds, or numbers with units: `90`, `90s`, `10 min`, `1h30m`, `1d12h`.
pub fn step(text: &str) -> Result<TimeDelta, String> {
    let step = match text.trim().parse::<f64>() {
        Ok(seconds) if (0.0..=1e9).contains(&seconds) => duration(&format!("{seconds}s")),
        Ok(_) => None,
        Err(_) => duration(text),
    };
    step.filter(|step| (1..=1_000_000_000_000).contains(&step.num_milliseconds()))
        .ok_or_else(|| {
            "write seconds, or numbers with ms, s, m or min, h, or d (24 h), as in 10min, 1h30m or 0.5s, of a millisecond to 1e9 seconds \
             in all"
                .into()
        })
}

/// A value that may start with a minus sign, but is no flag.
fn not_a_flag(text: &str) -> Result<String, String> {
    if looks_like_a_flag(text) {
        return Err(format!("a value was expected, found the flag `{text}`"));
    }
    Ok(text.to_owned())
}

fn looks_like_a_flag(text: &str) -> bool {
    text.strip_prefix('-')
        .is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_digit() || c == '.'))
}

/// `LAT,LON[,ELEV]`, as `-33.86,151.2` or `33.86S,151.2E,58`.
pub fn site(text: &str) -> Result<Site, String> {
    if looks_like_a_flag(text) {
        return Err(format!(
            "a place LAT,LON[,ELEV] was expected, found the flag `{text}`"
        ));
    }
    let parts: Vec<&str> = text.split(',').collect();
    if !(2..=3).contains(&parts.len()) {
        return Err(
            "write LAT,LON or LAT,LON,ELEV, as in -33.86,151.2 or 48.8584N,2.2945E,35".into(),
        );
    }
    let latitude = degrees(parts[0], 'N', 'S')?;
    let longitude = degrees(parts[1], 'E', 'W')?;
    let elevation = match parts.get(2) {
        None => 0.0,
        Some(metres) => {
            let metres = metres.trim();
            let metres = metres.strip_suffix('m').unwrap_or(metres).trim_end();
            number(metres)
                .map_err(|_| format!("the elevation `{metres}` is not a number of metres"))?
        }
    };
    Site::new(latitude, longitude, elevation).map_err(|error| {
        if latitude.abs() > 90.0 && longitude.abs() <= 90.0 {
            let swapped = [parts[1], parts[0]].map(str::trim).join(",");
            return format!(
                "{}; {} (try --at {swapped})",
                error.problem(),
                error.remedy()
            );
        }
        error.to_string()
    })
}

/// Degrees with a sign or a letter of the compass.
fn degrees(text: &str, positive: char, negative: char) -> Result<f64, String> {
    let text = text.trim();
    let (body, letter) = match text.chars().last() {
        Some(c) if c.is_ascii_alphabetic() => {
            (&text[..text.len() - 1], Some(c.to_ascii_uppercase()))
        }
        _ => (text, None),
    };
    let value = sexagesimal(body).ok_or_else(|| format!("`{text}` is not a number of degrees"))?;
    match letter {
        Some(_) if value < 0.0 => Err(format!(
            "`{text}` has both a sign and a letter: leave out one"
        )),
        None => Ok(value),
        Some(c) if c == positive => Ok(value),
        Some(c) if c == negative => Ok(-value),
        Some(c) => Err(format!(
            "`{text}` ends in {c} where {positive} or {negative} was expected"
        )),
    }
}

/// Degrees, or degrees with minutes and perhaps seconds of arc: 48.8584, 48°51'30", 48 51 30, 48:51.5.
fn sexagesimal(text: &str) -> Option<f64> {
    let marks = [
        '°', '\'', '"', '\u{2032}', '\u{2033}', '\u{2019}', '\u{201d}', ':',
    ];
    let parts: Vec<&str> = text
        .split(|c: char| c.is_whitespace() || marks.contains(&c))
        .filter(|part| !part.is_empty())
        .collect();
    let (first, rest) = parts.split_first()?;
    let whole = number(first).ok()?;
    if rest.len() > 2 || !rest.is_empty() && first.contains('.') {
        return None;
    }
    let mut size = 0.0;
    for (i, part) in rest.iter().enumerate() {
        let is_last = i + 1 == rest.len();
        let value = number(part).ok().filter(|v| (0.0..60.0).contains(v))?;
        if part.starts_with(['-', '+']) || !is_last && part.contains('.') {
            return None;
        }
        size += value / [60.0, 3600.0][i];
    }
    // -0 30 is south of the equator.
    Some(match first.starts_with('-') {
        true => whole - size,
        false => whole + size,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps() {
        let of = |text: &str| step(text).map(|step| step.num_milliseconds());
        for (text, ms) in [
            ("90", 90_000),
            ("0.5", 500),
            ("30min", 1_800_000),
            ("10m", 600_000),
            ("1h30m", 5_400_000),
            ("1.5 d", 129_600_000),
            ("1d12h", 129_600_000),
            ("10 min", 600_000),
            ("1 h 30 min", 5_400_000),
            ("1e3s", 1_000_000),
            ("1e3", 1_000_000),
            ("2.5E-1 s", 250),
            ("123456789.123s", 123_456_789_123),
            ("123456789.123", 123_456_789_123),
        ] {
            assert_eq!(of(text), Ok(ms), "{text}");
            let exact = step(text).expect("it is a step");
            assert_eq!(exact, TimeDelta::milliseconds(ms), "{text}");
        }
        for text in ["0.0333", "0.0333s", "33.3 ms"] {
            assert_eq!(step(text), Ok(TimeDelta::nanoseconds(33_300_000)), "{text}");
        }
        for bad in [
            "", "0", "-1h", "1x", "h", "0.0001s", "1e10", "-5", "1e", "1 2s", "NaN", "1h30",
        ] {
            assert!(of(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn places() {
        let at =
            |text: &str| site(text).map(|s| (s.latitude_deg(), s.longitude_deg(), s.elevation()));
        assert_eq!(at("-33.86,151.2"), Ok((-33.86, 151.2, 0.0)));
        assert_eq!(at("48.8584N, 2.2945E, 35"), Ok((48.8584, 2.2945, 35.0)));
        assert_eq!(at("33.86S,70W,-5m"), Ok((-33.86, -70.0, -5.0)));
        let paris = Ok((
            48.0 + 51.0 / 60.0 + 30.0 / 3600.0,
            -(2.0 + 17.5 / 60.0),
            0.0,
        ));
        for text in [
            "48°51'30\"N,2°17.5'W",
            "48 51 30 N, 2 17.5 W",
            "48:51:30,-2:17.5",
            "48° 51\u{2032} 30\u{2033} N,-2°17\u{2019}30\u{201d}",
        ] {
            assert_eq!(at(text), paris, "{text}");
        }
        assert_eq!(at("-0 30,0"), Ok((-0.5, 0.0, 0.0)));
        for bad in [
            "--north",
            "-h",
            "1",
            "1,2,3,4",
            "1E,2N",
            "NaN,0",
            "1e400,0",
            "a,b",
            "-3S,0",
            "1,2,x",
            "",
            "48°61',0",
            "48.5°30',0",
            "1 2 3 4,0",
            "48°-3',0",
            "48°5.5'3\",0",
        ] {
            assert!(site(bad).is_err(), "{bad}");
        }
        assert!(
            site("151.2,-33.86")
                .unwrap_err()
                .contains("--at -33.86,151.2")
        );
    }
}
