//! Weather files that are made up: clear days and cloudy ones by turns.

use chrono::NaiveDate;
use tyndall::daylight::epw::WeatherFile;
use tyndall::ephemeris::{Instant, Julian, Site, Tier, TimeScale, Weather, sun_position};

/// A made-up weather file.
#[derive(Clone, Copy)]
pub struct MadeUp {
    /// Latitude and longitude [degrees], zone [h].
    pub place: [f64; 3],
    /// What the header says of the place, where it lies.
    pub said: [f64; 3],
    /// The sun's time is so much later than the middle of the label's hour [h].
    pub shift: f64,
    pub is_leap: bool,
}

pub const ULM: [f64; 3] = [48.4, 10.0, 1.0];

pub fn made_up(place: [f64; 3]) -> MadeUp {
    MadeUp {
        place,
        said: place,
        shift: 0.0,
        is_leap: false,
    }
}

impl MadeUp {
    /// Its lines: clear days and cloudy ones by turns.
    pub fn lines(&self) -> Vec<String> {
        let [latitude, longitude, zone] = self.place;
        let [a, b, c] = self.said;
        let yes = if self.is_leap { "Yes" } else { "No" };
        let mut lines = vec![
            format!("LOCATION,Made up,-,-,none,000000,{a},{b},{c},100"),
            "DESIGN CONDITIONS,0".into(),
            "TYPICAL/EXTREME PERIODS,0".into(),
            "GROUND TEMPERATURES,0".into(),
            format!("HOLIDAYS/DAYLIGHT SAVINGS,{yes},0,0,0"),
            "COMMENTS 1,free to use".into(),
            "COMMENTS 2,".into(),
            "DATA PERIODS,1,1,Data,Sunday,1/ 1,12/31".into(),
        ];
        let site = Site::new(latitude, longitude, 100.0).expect("a place");
        let weather = Weather::standard(&site);
        // Months of a typical year are of different ones.
        let year = |month: u32| {
            if self.is_leap {
                2020
            } else {
                2001 + 2 * (month as i32 % 5)
            }
        };
        for month in 1..=12 {
            let first = NaiveDate::from_ymd_opt(year(month), month, 1).expect("a date");
            for (day, date) in first
                .iter_days()
                .take_while(|d| chrono::Datelike::month(d) == month)
                .enumerate()
            {
                for hour in 1..=24 {
                    let middle = f64::from(hour) - 0.5 + self.shift - zone;
                    let jd = Julian::from_date(date, 3600.0 * middle);
                    let instant = Instant::from_julian(jd, TimeScale::Utc, None).expect("a time");
                    let sun = sun_position(Tier::Minute, &instant, &site, &weather);
                    let sine = sun.elevation_true.sin().max(0.0);
                    let direct = if day % 3 == 0 || sine < 0.02 {
                        0.0
                    } else {
                        850.0 * sine.sqrt()
                    };
                    let diffuse = if day % 3 == 0 { 300.0 } else { 120.0 } * sine;
                    let global = diffuse + direct * sine;
                    lines.push(format!(
                        "{},{month},{},{hour},0,?9,5,3,85,100220,0,0,323,{global:.1},{direct:.1},{diffuse:.1},999999,999999,999999,9999,190,2.2,10,10,999,999,9,999999999,14,0.085,0,88,0.2,0,0",
                        year(month), day + 1
                    ));
                }
            }
        }
        lines
    }

    pub fn read(&self) -> WeatherFile {
        WeatherFile::from_bytes("made.epw", self.lines().join("\r\n").as_bytes())
            .expect("it is sound")
    }
}

/// Row of an hour in the lines of a file that begins on 1 January.
pub fn line(day: usize, hour: usize) -> usize {
    8 + 24 * (day - 1) + hour - 1
}

/// One field of a line is another.
pub fn with(mut lines: Vec<String>, at: usize, column: usize, value: &str) -> String {
    let mut fields: Vec<&str> = lines[at].split(',').collect();
    fields[column] = value;
    lines[at] = fields.join(",");
    lines.join("\n")
}

/// Some columns are missing in all rows.
pub fn with_columns(lines: &[String], columns: &[usize]) -> String {
    let row = |line: &String| {
        let mut fields: Vec<&str> = line.split(',').collect();
        columns.iter().for_each(|column| fields[*column] = "9999");
        fields.join(",")
    };
    let rows: Vec<String> = lines[8..].iter().map(row).collect();
    [&lines[..8], &rows].concat().join("\n")
}

pub fn told(warnings: &[tyndall::Warning], what: &str) -> bool {
    warnings
        .iter()
        .any(|warning| warning.to_string().contains(what))
}
