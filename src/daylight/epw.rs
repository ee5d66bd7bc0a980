//! Weather files: a year of hours in EnergyPlus' format (EPW), as people have them.
//!
//! Eight lines of header by name, then one row an hour. Read are place, zone, clock changes, comments, and of each row date, hour and
//! irradiance (columns 14 to 16, counted from 1), the global illuminance and the albedo, where they are given. Text is UTF-8 or Latin-1.
//! An hour counts 1 to 24, is what its stamp ends, and is in the standard time of the header's zone; minutes say nothing (0 and 60
//! both stand for the whole hour). Each row keeps its own year, as months of a typical year are of different ones.
//!
//! Source: EnergyPlus Auxiliary Programs, EnergyPlus weather file (EPW) data dictionary.

use crate::error::{Error, Result};
use crate::file;
use crate::warning::Warning;
use std::collections::BTreeMap;
use std::path::Path;

/// The most bytes that a weather file may have: ten times a full one.
const LARGEST: u64 = 32 << 20;

/// Days of months in a leap year.
const DAYS: [u32; 12] = [31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];

/// The first words of the header's lines.
const HEADER: [&str; 8] = [
    "LOCATION",
    "DESIGN CONDITIONS",
    "TYPICAL/EXTREME PERIODS",
    "GROUND TEMPERATURES",
    "HOLIDAYS/DAYLIGHT SAVINGS",
    "COMMENTS 1",
    "COMMENTS 2",
    "DATA PERIODS",
];

/// Irradiance from which on a column says that there is none [W/m2].
const MISSING: f64 = 9998.0;

/// The most that falls on the ground [W/m2]: above the sun's constant, since clouds' edges send more for a moment.
const MOST: f64 = 1500.0;

/// A date of any year.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Date {
    /// 1 to 12.
    pub month: u32,
    /// 1 to 31.
    pub day: u32,
}

/// One hour of a weather file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The line of the file, from 1.
    pub line: usize,
    /// Its own year.
    pub year: i32,
    /// Its date.
    pub date: Date,
    /// 1 to 24: the hour that ends then, standard time.
    pub hour: u32,
    /// Global horizontal irradiance [W/m2].
    pub global: Option<f64>,
    /// Direct normal irradiance [W/m2].
    pub direct_normal: Option<f64>,
    /// Diffuse horizontal irradiance [W/m2].
    pub diffuse_horizontal: Option<f64>,
    /// Global horizontal illuminance [lx]: compared, never used.
    pub global_illuminance: Option<f64>,
    /// The ground's reflectance [1].
    pub albedo: Option<f64>,
}

/// A weather file.
#[derive(Debug, Clone)]
pub struct WeatherFile {
    /// Its name.
    pub file: String,
    /// Place, region, country, source and number, as the header has them.
    pub name: String,
    /// Latitude [degrees north].
    pub latitude_deg: f64,
    /// Longitude [degrees east].
    pub longitude_deg: f64,
    /// The zone of its standard time [h east of Greenwich].
    pub zone_h: f64,
    /// Height above sea level [m].
    pub elevation: f64,
    /// The header as it stands: what it says of its source and its licence is there.
    pub header: Vec<String>,
    /// First day and last day of summer time, where the file knows of one.
    pub summer: Option<[Date; 2]>,
    /// The hours, from 1 January: 8 760, or 8 784 with 29 February.
    pub rows: Vec<Row>,
    /// What was doubtful.
    pub warnings: Vec<Warning>,
}

impl WeatherFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Those of [`file::read`], and [`Error::Input`] with line and remedy for one that is no weather file of a year.
    pub fn read(path: &Path) -> Result<Self> {
        Self::from_bytes(&path.display().to_string(), &file::read(path, LARGEST)?)
    }

    /// Reads a file's content; `name` stands for it in errors.
    ///
    /// # Errors
    /// [`Error::Input`] with line and remedy for one that is no weather file of a year.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self> {
        let text = decoded(bytes);
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        Reader {
            name,
            warnings: Vec::new(),
        }
        .file(text)
    }

    /// The line of the header that begins with a word, without it.
    pub fn said(&self, word: &str) -> Option<&str> {
        let line = self.header.iter().find(|line| begins(line, word))?;
        Some(line[word.len()..].trim_start_matches(',').trim())
    }

    /// Whether a date lies in summer time: from its first day to before its last, in the north or over the turn of the year.
    pub fn is_summer(&self, date: Date) -> bool {
        self.summer.is_some_and(|[from, to]| match from <= to {
            true => (from..to).contains(&date),
            false => date >= from || date < to,
        })
    }

    /// The ground's mean reflectance over the hours that have one with light [1]; `None` where the file has none.
    pub fn mean_albedo(&self) -> Option<f64> {
        let lit = self
            .rows
            .iter()
            .filter(|row| row.global.is_some_and(|g| g > 0.0));
        let all: Vec<f64> = lit.filter_map(|row| row.albedo).collect();
        let sum: f64 = all.iter().sum();
        (!all.is_empty() && sum > 0.0).then(|| sum / all.len() as f64)
    }
}

/// UTF-8, or else Latin-1: its bytes are the first 256 characters.
fn decoded(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
    }
}

/// Whether a line begins with a word, in any case.
fn begins(line: &str, word: &str) -> bool {
    (line.get(..word.len())).is_some_and(|start| start.eq_ignore_ascii_case(word))
}

/// The fields of a line; quotes keep commas together.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            _ => {
                if let Some(last) = fields.last_mut() {
                    last.push(c);
                }
            }
        }
    }
    fields.iter().map(|field| field.trim().to_owned()).collect()
}

/// Whether a line is a row: its first field is a number.
fn is_row(line: &str) -> bool {
    let first = line.split(',').next().unwrap_or_default().trim();
    !first.is_empty() && first.parse::<f64>().is_ok()
}

struct Reader<'a> {
    name: &'a str,
    warnings: Vec<Warning>,
}

impl Reader<'_> {
    fn wrong<T>(
        &self,
        line: usize,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Result<T> {
        let place = match line {
            0 => self.name.to_owned(),
            line => format!("{}, line {line}", self.name),
        };
        Err(Error::input(place, problem, remedy))
    }

    fn mend(&mut self, problem: impl Into<String>, instead: impl Into<String>) {
        self.warnings.push(Warning::Weather {
            problem: format!("{}: {}", self.name, problem.into()),
            instead: instead.into(),
            remedy: "correct the file, or take it again from where it came".into(),
        });
    }

    fn file(mut self, text: &str) -> Result<WeatherFile> {
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        let first = lines.iter().position(|line| is_row(line));
        let Some(first) = first.filter(|_| lines.first().is_some_and(|l| begins(l, HEADER[0])))
        else {
            return match lines.first().is_some_and(|line| begins(line, HEADER[0])) {
                true => self.wrong(
                    lines.len(),
                    "there are no hours behind the header",
                    "download the file again: it was cut off",
                ),
                false => self.wrong(
                    1,
                    "the first line does not begin with LOCATION",
                    "name a weather file in EnergyPlus' format (.epw, unpacked)",
                ),
            };
        };
        let header = &lines[..first];
        let missing: Vec<&str> = HEADER
            .into_iter()
            .filter(|word| !header.iter().any(|line| begins(line, word)))
            .collect();
        if !missing.is_empty() {
            self.mend(
                format!("its header has no {}", missing.join(", no ")),
                "the rows alone are gone by",
            );
        }
        let place = self.place(header[0])?;
        let summer = self.summer(header)?;
        self.periods(header)?;
        let mut rows: BTreeMap<(Date, u32), Row> = BTreeMap::new();
        let mut is_ordered = true;
        for (number, line) in lines.iter().enumerate().skip(first) {
            if line.trim().is_empty() {
                continue;
            }
            let row = self.row(number + 1, line)?;
            let key = (row.date, row.hour);
            is_ordered &= rows.last_key_value().is_none_or(|(last, _)| *last < key);
            if let Some(other) = rows.insert(key, row) {
                return self.wrong(
                    row.line,
                    format!(
                        "hour {} of {} stands in line {} already",
                        row.hour,
                        written(row.date),
                        other.line
                    ),
                    "keep one of the two: a year has each hour once",
                );
            }
        }
        if !is_ordered {
            self.mend(
                "its hours are not in the order of the year",
                "they are put in it",
            );
        }
        let has_leap_day = rows.keys().any(|(date, _)| *date == LEAP_DAY);
        self.check_whole(&rows, has_leap_day)?;
        self.leap_days(header, has_leap_day);
        let [latitude_deg, longitude_deg, zone_h, elevation] = place;
        Ok(WeatherFile {
            file: self.name.to_owned(),
            name: fields(header[0])[1..6].join(", "),
            latitude_deg,
            longitude_deg,
            zone_h,
            elevation,
            header: header.iter().map(|line| line.to_string()).collect(),
            summer,
            rows: rows.into_values().collect(),
            warnings: self.warnings,
        })
    }

    /// Latitude, longitude, zone and height of the header's first line.
    fn place(&self, line: &str) -> Result<[f64; 4]> {
        let fields = fields(line);
        if fields.len() < 10 {
            return self.wrong(
                1,
                format!("LOCATION has {} fields", fields.len()),
                "it has ten: LOCATION, city, region, country, source, number, latitude, longitude, zone [h], elevation [m]",
            );
        }
        let mut place = [0.0; 4];
        let names = [
            ("latitude", 90.0, "degrees north"),
            ("longitude", 180.0, "degrees east, negative to the west"),
            ("time zone", 14.0, "hours east of Greenwich"),
            ("elevation", 9000.0, "metres above sea level"),
        ];
        for ((value, text), (name, most, unit)) in place.iter_mut().zip(&fields[6..10]).zip(names) {
            *value = match text.parse::<f64>() {
                Ok(number) if number.abs() <= most => number,
                _ => {
                    return self.wrong(
                        1,
                        format!("the {name} is `{text}`"),
                        format!("write {unit}, -{most} to {most}"),
                    );
                }
            };
        }
        Ok(place)
    }

    /// The days of summer time, where the header has two of the form month/day.
    fn summer(&mut self, header: &[&str]) -> Result<Option<[Date; 2]>> {
        let Some(line) = header.iter().find(|line| begins(line, HEADER[4])) else {
            return Ok(None);
        };
        let fields = fields(line);
        let [from, to] = [2, 3].map(|i| fields.get(i).map_or("0", String::as_str));
        if [from, to].iter().all(|text| ["0", ""].contains(text)) {
            return Ok(None);
        }
        match (month_and_day(from), month_and_day(to)) {
            (Some(from), Some(to)) => Ok(Some([from, to])),
            _ => {
                self.mend(
                    format!(
                        "its summer time goes from `{from}` to `{to}`, which are no dates month/day"
                    ),
                    "standard time is used all the year",
                );
                Ok(None)
            }
        }
    }

    /// There is one row an hour.
    fn periods(&self, header: &[&str]) -> Result<()> {
        let found = header.iter().position(|line| begins(line, HEADER[7]));
        let Some(at) = found else { return Ok(()) };
        let fields = fields(header[at]);
        match fields.get(2).map(|text| text.parse::<f64>()) {
            Some(Ok(records)) if records > 1.0 => self.wrong(
                at + 1,
                format!("there are {records} rows an hour"),
                "name a file with one row an hour",
            ),
            _ => Ok(()),
        }
    }

    fn row(&self, line: usize, text: &str) -> Result<Row> {
        let fields: Vec<&str> = text.split(',').map(str::trim).collect();
        if fields.len() < 16 {
            return self.wrong(
                line,
                format!("the row has {} columns", fields.len()),
                "a row has 35, of which the first 16 are read: download the file again, it was cut off or edited",
            );
        }
        let number = |column: usize, name: &str| -> Result<f64> {
            match fields[column].parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(number),
                _ => self.wrong(
                    line,
                    format!("column {}, {name}, is `{}`", column + 1, fields[column]),
                    "write a number; 9999 stands for what was not measured",
                ),
            }
        };
        let whole = |column: usize, name: &str, low: i32, high: i32| -> Result<i32> {
            let value = number(column, name)?;
            if value.fract() != 0.0 || value < f64::from(low) || value > f64::from(high) {
                return self.wrong(
                    line,
                    format!("column {}, {name}, is {value}", column + 1),
                    format!("write a whole number from {low} to {high}"),
                );
            }
            Ok(value as i32)
        };
        let year = whole(0, "year", 1500, 3000)?;
        let month = whole(1, "month", 1, 12)? as u32;
        let day = whole(2, "day", 1, DAYS[month as usize - 1] as i32)? as u32;
        let hour = match fields[3] {
            "0" | "00" => {
                return self.wrong(
                    line,
                    "the hour is 0",
                    "hours count from 1 to 24, each for what ends then: raise all of them by one",
                );
            }
            _ => whole(3, "hour", 1, 24)? as u32,
        };
        whole(4, "minute", 0, 60)?;
        let irradiance = |column: usize, name: &str| -> Result<Option<f64>> {
            let value = number(column, name)?;
            match value {
                _ if value >= MISSING => Ok(None),
                _ if (0.0..=MOST).contains(&value) => Ok(Some(value)),
                // What sensors give at night.
                _ if (-20.0..0.0).contains(&value) => Ok(Some(0.0)),
                _ => self.wrong(
                    line,
                    format!("column {}, {name}, is {value} Wh/m2", column + 1),
                    format!("no hour has less than 0 or more than {MOST}; write 9999 if it was not measured"),
                ),
            }
        };
        let other = |column: usize, missing: f64| {
            let value: f64 = fields.get(column)?.parse().ok()?;
            (0.0..missing).contains(&value).then_some(value)
        };
        Ok(Row {
            line,
            year,
            date: Date { month, day },
            hour,
            global: irradiance(13, "global horizontal irradiance")?,
            direct_normal: irradiance(14, "direct normal irradiance")?,
            diffuse_horizontal: irradiance(15, "diffuse horizontal irradiance")?,
            global_illuminance: other(16, 999_900.0),
            // 0 stands for what nobody measured, too.
            albedo: other(32, 1.0).filter(|albedo| *albedo > 0.0),
        })
    }

    /// Every hour of the year is there.
    fn check_whole(&self, rows: &BTreeMap<(Date, u32), Row>, has_leap_day: bool) -> Result<()> {
        for month in 1..=12 {
            for day in 1..=DAYS[month as usize - 1] {
                let date = Date { month, day };
                if date == LEAP_DAY && !has_leap_day {
                    continue;
                }
                if let Some(hour) = (1..=24).find(|hour| !rows.contains_key(&(date, *hour))) {
                    let line = rows.range(..(date, hour)).next_back();
                    return self.wrong(
                        line.map_or(0, |(_, row)| row.line),
                        format!(
                            "hour {hour} of {} is not there: the file has {} hours",
                            written(date),
                            rows.len()
                        ),
                        "name a file of a whole year, 8760 or 8784 hours",
                    );
                }
            }
        }
        Ok(())
    }

    /// What the header says of leap years.
    fn leap_days(&mut self, header: &[&str], has_leap_day: bool) {
        let line = header.iter().find(|line| begins(line, HEADER[4]));
        let said = line.and_then(|line| fields(line).get(1).cloned());
        let said = said.map(|text| text.eq_ignore_ascii_case("yes"));
        match (said, has_leap_day) {
            (Some(true), false) => self.mend(
                "its header says that it has a leap day, and there is none",
                "the year has 365 days",
            ),
            (Some(false), true) => self.mend(
                "its header says that it has no leap day, and there is one",
                "the year has 366 days",
            ),
            _ => {}
        }
    }
}

const LEAP_DAY: Date = Date { month: 2, day: 29 };

/// A date as month/day.
fn month_and_day(text: &str) -> Option<Date> {
    let (month, day) = text.split_once('/')?;
    let (month, day) = (month.trim().parse().ok()?, day.trim().parse().ok()?);
    let days = DAYS.get(usize::checked_sub(month as usize, 1)?)?;
    (1..=*days).contains(&day).then_some(Date { month, day })
}

/// A date as month-day.
pub(super) fn written(date: Date) -> String {
    format!("{:02}-{:02}", date.month, date.day)
}
