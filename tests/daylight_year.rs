//! Daylight over a year: weather files, coefficients against single moments and against RADIANCE, hours of sun by hand.

mod common;

use chrono::{NaiveDate, NaiveTime};
use common::receive::{self, QUALITY, at};
use common::rooms::{Room, WEATHER, room};
use glam::{DVec3, dvec3};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::time::Instant as Clock;
use tyndall::backend::Wanted;
use tyndall::colour::luminance;
use tyndall::conditions::{Conditions, Receiver};
use tyndall::daylight::epw::WeatherFile;
use tyndall::daylight::hours::{Hours, label_shift};
use tyndall::daylight::metrics::Metrics;
use tyndall::daylight::sun_hours::{Span, SunHours};
use tyndall::daylight::table::{Stamp, Table};
use tyndall::daylight::year::{Fineness, Year, conditions};
use tyndall::ephemeris::civil::Zone;
use tyndall::ephemeris::{Instant, Julian, Site, Tier, TimeScale, Weather, sun_position};
use tyndall::task::Task;
use tyndall::units::DEG;

/// A made-up weather file.
#[derive(Clone, Copy)]
struct MadeUp {
    place: [f64; 3],
    /// What the header says of the place, where it lies.
    said: [f64; 3],
    /// The sun's time is so much later than the middle of the label's hour [h].
    shift: f64,
    is_leap: bool,
}

const ULM: [f64; 3] = [48.4, 10.0, 1.0];

fn made_up(place: [f64; 3]) -> MadeUp {
    MadeUp {
        place,
        said: place,
        shift: 0.0,
        is_leap: false,
    }
}

impl MadeUp {
    /// Its lines: clear days and cloudy ones by turns.
    fn lines(&self) -> Vec<String> {
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

    fn read(&self) -> WeatherFile {
        read(&self.lines().join("\r\n")).expect("it is sound")
    }
}

fn read(text: &str) -> tyndall::Result<WeatherFile> {
    WeatherFile::from_bytes("made.epw", text.as_bytes())
}

/// The hours of a sound file.
fn hours(file: &WeatherFile) -> tyndall::Result<Hours> {
    Hours::new(file, 0.0, None, None)
}

/// Row of an hour in the lines of a file that begins on 1 January.
fn line(day: usize, hour: usize) -> usize {
    8 + 24 * (day - 1) + hour - 1
}

/// One field of a line is another.
fn with(mut lines: Vec<String>, at: usize, column: usize, value: &str) -> String {
    let mut fields: Vec<&str> = lines[at].split(',').collect();
    fields[column] = value;
    lines[at] = fields.join(",");
    lines.join("\n")
}

#[test]
fn files_as_people_have_them_are_read() {
    let Some(data) = common::data("files_as_people_have_them_are_read") else {
        return;
    };
    // Latitude, longitude, zone; by how much the sun is later than the labels; a word of the header.
    for (name, place, later, word) in [
        (
            "chicago_ohare_tmy3",
            [41.98, -87.92, -6.0],
            0.03,
            "NREL TMY",
        ),
        (
            "mannheim_dwd_try_latin1",
            [49.52, 8.55, 1.0],
            0.45,
            "für Bau-, Stadt- und Raumforschung",
        ),
    ] {
        let path = data.join(format!("epw/{name}.epw"));
        let file = WeatherFile::read(&path).expect("it is sound");
        assert_eq!([file.latitude_deg, file.longitude_deg, file.zone_h], place);
        assert_eq!(file.rows.len(), 8760);
        let comments = file.said("COMMENTS 1").expect("there are some");
        assert!(comments.contains(word), "{comments}");
        let shift = label_shift(&file)
            .expect("dates are sound")
            .expect("there is light");
        eprintln!("{name}: {shift:?}");
        assert!((shift.hours - later).abs() <= 0.05, "{shift:?}");
        let begin = Clock::now();
        let hours = hours(&file).expect("place and irradiance agree");
        eprintln!(
            "{} lit hours in {:.2} s",
            hours.lit.len(),
            begin.elapsed().as_secs_f64()
        );
        let said = hours
            .warnings
            .iter()
            .any(|w| w.to_string().contains("h later than the labels"));
        assert_eq!(said, later > 0.1, "{:?}", hours.warnings);
        // Half of the year is day, and some twilight.
        assert!(
            (4200..4700).contains(&hours.lit.len()),
            "{}",
            hours.lit.len()
        );
        // Efficacies of daylight lie around 110 lm/W.
        let light: f64 = hours.lit.iter().map(|hour| hour.global()).sum();
        let power: f64 = file.rows.iter().filter_map(|row| row.global).sum();
        eprintln!("{:.1} lm/W, light {light:.3e}", light / power);
        assert!(
            (95.0..130.0).contains(&(light / power)),
            "{}",
            light / power
        );
    }
}

#[test]
fn sound_files_in_other_forms_are_read() {
    let plain = made_up(ULM);
    let lines = plain.lines();
    let file = plain.read();
    assert_eq!(file.rows.len(), 8760);
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
    assert_eq!(file.said("COMMENTS 1"), Some("free to use"));
    // With a byte order mark, in Latin-1, with the minute 60, a year that ends with empty lines.
    let text = lines.join("\n").replace(",0,?9", ",60,?9") + "\n\n\n";
    let marked = read(&format!("\u{feff}{text}")).expect("a mark is no text");
    assert_eq!(marked.rows, file.rows.iter().copied().collect::<Vec<_>>());
    let latin: Vec<u8> = (text.replace("free to use", "f\u{fc}r alle").chars())
        .map(|c| c as u8)
        .collect();
    let latin = WeatherFile::from_bytes("made.epw", &latin).expect("Latin-1 is read");
    assert_eq!(latin.said("COMMENTS 1"), Some("f\u{fc}r alle"));
    // Leap days, with a header that knows of them and with one that does not.
    let leap = MadeUp {
        is_leap: true,
        ..plain
    };
    let file = leap.read();
    assert_eq!((file.rows.len(), file.warnings.len()), (8784, 0));
    let text = leap.lines().join("\n").replace("SAVINGS,Yes", "SAVINGS,No");
    assert!(told(
        &read(&text).expect("it is sound").warnings,
        "leap day"
    ));
    // 29 February of a year without one.
    let odd = leap
        .lines()
        .join("\n")
        .replace("\n2020,2,29,", "\n2019,2,29,");
    assert_eq!(
        hours(&read(&odd).expect("it is sound"))
            .expect("it has a place")
            .count,
        8784
    );
    // Months in another order.
    let mut turned = lines.clone();
    turned[8..].rotate_left(24 * 31);
    let turned = read(&turned.join("\n")).expect("all are there");
    assert!(told(&turned.warnings, "not in the order"));
    assert_eq!(turned.rows[0].date.month, 1);
    // Summer time.
    let summer = lines
        .join("\n")
        .replace("SAVINGS,No,0,0", "SAVINGS,No,3/25,10/28");
    let summer = read(&summer).expect("it is sound");
    let is_summer = |month, day| summer.is_summer(tyndall::daylight::epw::Date { month, day });
    assert!(is_summer(3, 25) && is_summer(7, 1) && !is_summer(10, 28) && !is_summer(1, 1));
}

fn told(warnings: &[tyndall::Warning], what: &str) -> bool {
    warnings
        .iter()
        .any(|warning| warning.to_string().contains(what))
}

#[test]
fn damaged_files_are_told_with_line_and_remedy() {
    let plain = made_up(ULM);
    let lines = plain.lines();
    let without = |at: usize| {
        let mut lines = lines.clone();
        lines.remove(at);
        lines.join("\n")
    };
    let twice = {
        let mut lines = lines.clone();
        lines[line(100, 12)] = lines[line(100, 11)].clone();
        lines.join("\n")
    };
    let cut = {
        let text = lines.join("\n");
        text[..text.len() - 1_000_000].to_owned()
    };
    let first = |said: [f64; 3]| MadeUp { said, ..plain }.lines().join("\n");
    let noon = line(172, 12);
    let cases = [
        (
            "a page",
            "<html><body>404</body></html>".to_owned(),
            "line 1",
            "LOCATION",
        ),
        ("nothing", String::new(), "line 1", "LOCATION"),
        (
            "a header alone",
            lines[..8].join("\n"),
            "line 8",
            "no hours",
        ),
        ("a file cut off", cut, "line", "the row has"),
        (
            "an hour less",
            without(noon),
            &format!("line {noon}"),
            "8759 hours",
        ),
        (
            "an hour twice",
            twice,
            &format!("line {}", line(100, 12) + 1),
            "stands in line",
        ),
        (
            "hour 0",
            with(lines.clone(), line(1, 1), 3, "0"),
            "line 9",
            "hours count from 1",
        ),
        (
            "month 13",
            with(lines.clone(), noon, 1, "13"),
            &format!("line {}", noon + 1),
            "month",
        ),
        (
            "31 June",
            with(lines.clone(), noon, 2, "31"),
            &format!("line {}", noon + 1),
            "day",
        ),
        (
            "words",
            with(lines.clone(), noon, 14, "cloudy"),
            "column 15",
            "cloudy",
        ),
        (
            "less than nothing",
            with(lines.clone(), noon, 15, "-500"),
            "column 16",
            "-500",
        ),
        (
            "more than the sun",
            with(lines.clone(), noon, 13, "4000"),
            "column 14",
            "4000",
        ),
        (
            "no number",
            with(lines.clone(), noon, 13, "NaN"),
            "column 14",
            "NaN",
        ),
        (
            "two rows an hour",
            with(lines.clone(), 7, 2, "2"),
            "line 8",
            "rows an hour",
        ),
        (
            "no place",
            with(lines.clone(), 0, 6, "N48"),
            "line 1",
            "latitude",
        ),
        (
            "half a place",
            "LOCATION,a,b\n2001,1,1,1".into(),
            "line 1",
            "fields",
        ),
    ];
    for (what, text, place, word) in cases {
        let error = read(&text).expect_err(what).to_string();
        eprintln!("{what}: {error}");
        assert!(error.contains("made.epw"), "{what}: {error}");
        assert!(
            error.contains(place) && error.contains(word),
            "{what}: {error}"
        );
    }
    // What disagrees with the irradiance.
    for (what, said, word) in [
        ("west for east", [48.4, -90.0, 1.0], "longitude"),
        ("the zone of another continent", [48.4, 10.0, -6.0], "zone"),
        ("south for north", [-48.4, 10.0, 1.0], "latitude"),
    ] {
        let error = hours(&read(&first(said)).expect(what))
            .expect_err(what)
            .to_string();
        eprintln!("{what}: {error}");
        assert!(
            error.contains("line 1") && error.contains(word),
            "{what}: {error}"
        );
    }
}

#[test]
fn what_was_not_measured_follows_or_is_taken_from_near() {
    let plain = made_up(ULM);
    let lines = plain.lines();
    let sound = hours(&plain.read()).expect("it is sound");
    let global = |hours: &Hours| hours.lit.iter().map(|hour| hour.global()).sum::<f64>();
    // One hour, by any code.
    for code in ["9999", "9.99e+09", "99999"] {
        let mut text = lines.clone();
        for column in [13, 14, 15] {
            text = with(text, line(172, 12), column, code)
                .lines()
                .map(str::to_owned)
                .collect();
        }
        let found =
            hours(&read(&text.join("\n")).expect("it is sound")).expect("one hour is missing");
        assert!(
            told(&found.warnings, "1 hours by day lack irradiance"),
            "{:?}",
            found.warnings
        );
        assert_eq!(found.lit.len(), sound.lit.len());
    }
    // All direct light: it is what global and diffuse leave.
    let text: Vec<String> = (lines.iter().enumerate())
        .map(|(i, line)| {
            let mut fields: Vec<&str> = line.split(',').collect();
            if i >= 8 {
                fields[14] = "9999";
            }
            fields.join(",")
        })
        .collect();
    let found = hours(&read(&text.join("\n")).expect("it is sound")).expect("it follows");
    assert!(told(&found.warnings, "follows from the other two"));
    let off = global(&found) / global(&sound) - 1.0;
    eprintln!("without direct light measured: {:.3} %", 100.0 * off);
    assert!(off.abs() < 0.01, "{off}");
    // All of it.
    let text = text
        .join("\n")
        .replace(",323,", ",323,9999,")
        .replace(",323,9999,9999", ",323,9999");
    let none: String = text
        .lines()
        .enumerate()
        .map(|(i, l)| {
            let mut fields: Vec<&str> = l.split(',').collect();
            if i >= 8 {
                fields[13] = "9999";
                fields[14] = "9999";
                fields[15] = "9999";
            }
            fields.join(",") + "\n"
        })
        .collect();
    let error = hours(&read(&none).expect("it is sound"))
        .expect_err("there is none")
        .to_string();
    assert!(
        error.contains("line ") && error.contains("irradiance is missing"),
        "{error}"
    );
}

#[test]
fn labels_that_are_off_are_found() {
    for place in [
        ULM,
        [-33.9, 18.5, 2.0],
        [78.2, 15.6, 1.0],
        [1.3, 103.8, 8.0],
    ] {
        for shift in [-0.5, 0.0, 0.5, 1.0] {
            let file = MadeUp {
                shift,
                ..made_up(place)
            }
            .read();
            let found = label_shift(&file).expect("sound").expect("light").hours;
            assert!(
                (found - shift).abs() < 0.03,
                "{place:?}: {found} for {shift}"
            );
        }
    }
}

#[test]
fn the_sun_stands_where_it_is_up() {
    // South and beyond the polar circle, too.
    for place in [ULM, [-33.9, 18.5, 2.0], [78.2, 15.6, 1.0]] {
        let file = made_up(place).read();
        let found = hours(&file).expect("it is sound");
        assert!(found.lit.iter().all(|hour| hour.sun.toward.y > 0.0));
        let of = |month: u32| found.lit.iter().filter(|h| h.date.month == month).count();
        eprintln!(
            "{place:?}: lit hours in June {}, in December {}",
            of(6),
            of(12)
        );
        match place[0] {
            north if north > 70.0 => assert_eq!((of(6), of(12)), (720, 0)),
            north if north > 0.0 => assert!(of(6) > of(12) + 200),
            _ => assert!(of(12) > of(6) + 100),
        }
        // At noon it stands in the south, or in the north.
        let noon = found
            .lit
            .iter()
            .find(|h| h.date.month == 5 && h.hour == 12)
            .expect("a day");
        assert_eq!(noon.sun.toward.z > 0.0, place[0] > 0.0);
    }
}

proptest! {
    #[test]
    fn no_bytes_break_the_reader(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = WeatherFile::from_bytes("any", &bytes);
        let mut behind = b"LOCATION,a,b,c,d,e,1,2,3,4\n".to_vec();
        behind.extend(&bytes);
        let _ = WeatherFile::from_bytes("any", &behind);
    }

    #[test]
    fn no_fields_break_the_reader(
        head in "(LOCATION|HOLIDAYS/DAYLIGHT SAVINGS|DATA PERIODS|COMMENTS 1)[,0-9a-z/\\.\"-]{0,40}",
        rows in proptest::collection::vec("[0-9]{1,4},[0-9]{1,2},[0-9]{1,2},[0-9]{1,2},[0-9]{1,2}(,[-+0-9eE\\.]{0,9}){0,36}", 0..8),
    ) {
        let text = format!("LOCATION,a,b,c,d,e,1,2,3,4\n{head}\n{}", rows.join("\n"));
        let _ = WeatherFile::from_bytes("any", text.as_bytes());
    }
}

/// Sensors of a room, and the room at the place of a weather file.
fn of_room(room: &Room, file: &WeatherFile, step: usize, fineness: &Fineness) -> Year {
    let sensors: Vec<Receiver> = room
        .points
        .iter()
        .step_by(step)
        .map(|p| at(*p, DVec3::Y))
        .collect();
    let scene = room.under(&WEATHER[1]);
    let base = conditions(scene, &Default::default(), file).expect("it is sound");
    Year::new(&base, sensors, fineness, Task::unwatched()).expect("it works")
}

/// Every so many hours.
fn some(hours: &Hours, step: usize) -> Hours {
    Hours {
        lit: hours
            .lit
            .iter()
            .skip(step / 2)
            .step_by(step)
            .cloned()
            .collect(),
        ..hours.clone()
    }
}

#[test]
fn an_hour_is_what_the_moment_gives() {
    let file = made_up(ULM).read();
    let all = hours(&file).expect("it is sound");
    for (name, step) in [("study", 4), ("furnished", 8)] {
        let room = room(name, 1.0).expect("it is in the list");
        let fineness = Fineness::new(QUALITY, &[]);
        let year = of_room(&room, &file, step, &fineness);
        let mut worst = [0.0f64; 3];
        for hour in &some(&all, 1500).lit {
            let [total, straight] = year.hour(hour);
            let now = year.at(hour);
            let lux = receive::received_by(&now, Wanted::Reference, &[("radiosity.sky", 2.0)]);
            let fine = receive::received_by(&now, Wanted::Reference, &[]);
            let y = |v: &[DVec3]| receive::y(v);
            let all = y(&lux.total());
            let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
            let figures = [
                mean(&total) / mean(&all) - 1.0,
                receive::worst(&total, &all),
                mean(&total) / mean(&y(&fine.total())) - 1.0,
            ];
            eprintln!(
                "{name}, {:?} {} h, sun at {:.0} degrees: same patches: mean {:+.3} %, worst {:.3} %; finer sky: mean {:+.2} %",
                hour.date,
                hour.hour,
                hour.sun.toward.y.asin() / DEG,
                100.0 * figures[0],
                100.0 * figures[1],
                100.0 * figures[2]
            );
            for (worst, figure) in worst.iter_mut().zip(figures) {
                *worst = worst.max(figure.abs());
            }
            for (own, sun) in straight.iter().zip(y(&lux.sun)) {
                assert!((own - sun).abs() <= 1e-6 * sun.max(1.0), "{own} {sun}");
            }
        }
        assert!(
            worst[0] < 0.005 && worst[1] < 0.01 && worst[2] < 0.03,
            "{name}: {worst:?}"
        );
    }
}
