//! Daylight over a year: weather files, coefficients against single moments and against RADIANCE, hours of sun by hand.

mod common;

use chrono::{NaiveDate, NaiveTime};
use common::annual::{Annual, Sample, input, table_of};
use common::build::cuboid;
use common::receive::{self, QUALITY, at};
use common::rooms::{Room, WEATHER, room};
use common::weather::{MadeUp, ULM, line, made_up, told, with, with_columns};
use glam::{DVec3, dvec3};
use proptest::prelude::*;
use serde_json::json;
use std::time::Instant as Clock;
use tyndall::backend::Wanted;
use tyndall::colour::luminance;
use tyndall::conditions::Receiver;
use tyndall::daylight::epw::WeatherFile;
use tyndall::daylight::hours::{Hour, Hours, ShiftFrom, label_shift};
use tyndall::daylight::metrics::Metrics;
use tyndall::daylight::sun_hours::{Span, SunHours};
use tyndall::daylight::year::{Fineness, Year, conditions};
use tyndall::ephemeris::civil::Zone;
use tyndall::ephemeris::{Instant, Julian, Site, Tier, TimeScale, Weather, sun_position};
use tyndall::plan::Quality;
use tyndall::task::Task;
use tyndall::units::DEG;

fn read(text: &str) -> tyndall::Result<WeatherFile> {
    WeatherFile::from_bytes("made.epw", text.as_bytes())
}

/// The hours of a sound file.
fn hours(file: &WeatherFile) -> tyndall::Result<Hours> {
    Hours::new(file, 0.0, None, None)
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
    assert_eq!(marked.rows, file.rows.to_vec());
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
        let at = text.match_indices("85,100220").nth(5000).expect("a row").0;
        text[..at].to_owned()
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
    // A shift that is given does not make north of south.
    let file = read(&first([-48.4, 10.0, 1.0])).expect("it can be read");
    let error = Hours::new(&file, 0.0, None, Some(0.0)).expect_err("it is winter in June");
    assert!(error.to_string().contains("latitude"), "{error}");
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
    let text = with_columns(&lines, &[14]);
    let found = hours(&read(&text).expect("it is sound")).expect("it follows");
    assert!(told(&found.warnings, "follows from the other two"));
    let off = global(&found) / global(&sound) - 1.0;
    eprintln!("without direct light measured: {:.3} %", 100.0 * off);
    assert!(off.abs() < 0.01, "{off}");
    // All of it.
    let none = with_columns(&lines, &[13, 14, 15]);
    let error = hours(&read(&none).expect("it is sound"))
        .expect_err("there is none")
        .to_string();
    // The sun down where there is light: a shift by 12 h.
    let night = Hours::new(&plain.read(), 0.0, None, Some(12.0)).expect("it is in range");
    assert_eq!(night.shift_from, ShiftFrom::Given);
    assert!(told(&night.warnings, "hours without sun have irradiance"));
    for shift in [f64::NAN, f64::INFINITY, 12.5, -1000.0] {
        let error = Hours::new(&plain.read(), 0.0, None, Some(shift)).expect_err("out of range");
        assert!(error.to_string().contains("-12 to 12 h"), "{error}");
    }
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
            // Without global irradiance; one shift, as each takes a second.
            if shift != 0.5 {
                continue;
            }
            let lines = MadeUp {
                shift,
                ..made_up(place)
            }
            .lines();
            let file = read(&with_columns(&lines, &[13])).expect("it is sound");
            let found = label_shift(&file).expect("sound").expect("light").hours;
            assert!(
                (found - shift).abs() < 0.05,
                "{place:?}: {found} for {shift} without global irradiance"
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
    for (name, step, quality) in [("study", 9, QUALITY), ("furnished", 16, Quality::Preview)] {
        let room = room(name, 1.0).expect("it is in the list");
        let fineness = Fineness::new(quality, &[]);
        let year = of_room(&room, &file, step, &fineness);
        for hour in &some(&all, 2200).lit {
            let [total, straight] = year.hour(hour);
            let now = year.at(hour);
            let set = [("radiosity.sky", 2.0)];
            let same = receive::received_at(quality, &now, Wanted::Reference, &set);
            let fine =
                receive::received_at(quality, &now, Wanted::Reference, &[("radiosity.sky", 16.0)]);
            let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
            let off = |lux: &receive::Lux| {
                let all = receive::y(&lux.total());
                (
                    mean(&total) / mean(&all) - 1.0,
                    receive::worst(&total, &all),
                )
            };
            let (same_mean, same_worst) = off(&same);
            let (fine_mean, fine_worst) = off(&fine);
            eprintln!(
                "{name}, month {}, {} h, sun at {:.0} degrees: same patches of the sky: mean {:+.3} %, worst {:.3} %; finer ones: mean {:+.2} %, worst {:.2} %",
                hour.date.month,
                hour.hour,
                hour.sun.toward.y.asin() / DEG,
                100.0 * same_mean,
                100.0 * same_worst,
                100.0 * fine_mean,
                100.0 * fine_worst
            );
            assert!(same_mean.abs() < 0.001 && same_worst < 0.005, "{name}");
            assert!(fine_mean.abs() < 0.01 && fine_worst < 0.03, "{name}");
            for (own, sun) in straight.iter().zip(receive::y(&same.sun)) {
                assert!((own - sun).abs() <= 1e-6 * sun.max(1.0), "{own} {sun}");
            }
        }
    }
}

/// A room with a window through a year, against the two-phase method with a run of its own for the suns. `TYNDALL_ANNUAL=8` takes
/// every eighth hour of a real weather file, and 1 all of them; the tests take some twenty of a made-up one, whose coefficients are stored:
/// `TYNDALL_TRUTHS=year` makes these anew.
#[test]
fn a_year_is_that_of_radiance() {
    let test = "a_year_is_that_of_radiance";
    let wanted = std::env::var("TYNDALL_ANNUAL")
        .ok()
        .and_then(|v| v.parse::<usize>().ok());
    let (file, each, sky, sun, allowed) = match (wanted, wanted.and_then(|_| common::data(test))) {
        (Some(each), Some(data)) => {
            let path = data.join("epw/chicago_ohare_tmy3.epw");
            let file = WeatherFile::read(&path).expect("it is sound");
            (file, each, [8, 16_384], [6, 4096], 0.03)
        }
        _ => (made_up(ULM).read(), 240, [8, 262_144], [6, 65_536], 0.03),
    };
    let sample = Sample {
        hours: some(&hours(&file).expect("it is sound"), each),
        each,
    };
    let mut room = room("study", 1.0).expect("it is in the list");
    let step = if wanted.is_some() { 3 } else { 7 };
    room.points = room.points.iter().copied().step_by(step).collect();
    let begin = Clock::now();
    let year = of_room(&room, &file, 1, &Fineness::new(QUALITY, &[]));
    let made = begin.elapsed().as_secs_f64();
    // The sun is a point there.
    let mut lit = sample.hours.lit.clone();
    lit.iter_mut()
        .for_each(|hour| hour.sun.light.angular_radius = 0.0);
    let begin = Clock::now();
    let table = year
        .table(
            &Hours {
                lit: lit.clone(),
                ..sample.hours.clone()
            },
            |_| 0.0,
            Task::unwatched(),
        )
        .expect("it works");
    let found = begin.elapsed().as_secs_f64();
    let points = room.points.len();
    let own: Vec<Vec<f64>> = (0..lit.len())
        .map(|h| (0..points).map(|p| table.at(h, p)).collect())
        .collect();
    let own_sun: Vec<Vec<f64>> = (0..lit.len())
        .map(|h| (0..points).map(|p| table.sun_at(h, p)).collect())
        .collect();
    let triangles: Vec<Vec<f64>> = (room.triangles.iter())
        .map(|(corners, material)| {
            let numbers = corners.iter().flat_map(|c| c.to_array());
            numbers.chain([f64::from(*material)]).collect()
        })
        .collect();
    let ground = year.conditions().ground.expect("there is one");
    let dome = year.coefficients().dome();
    let task = json!({
        "triangles": triangles,
        "materials": room.working().iter().map(|r| luminance(*r)).collect::<Vec<_>>(),
        "ground": [ground.height, luminance(ground.albedo), 2000.0],
        "points": room.points.iter().map(|p| json!([p.x, p.y, p.z, 0.0, 1.0, 0.0])).collect::<Vec<_>>(),
        "factor": 2,
        "patches": dome.patches().iter().map(|p| p.direction.to_array()).collect::<Vec<_>>(),
        "skies": lit.iter().map(|hour| receive::y(&dome.radiances(&hour.sky))).collect::<Vec<_>>(),
        "suns": lit.iter().map(|hour| {
            let t = hour.sun.toward;
            [t.x, t.y, t.z, if hour.sun.shines() { hour.sun.illuminance_lux() } else { 0.0 }]
        }).collect::<Vec<_>>(),
        "sky": sky,
        "sun": sun,
        "n": 2,
    });
    let middles: Vec<DVec3> = dome.patches().iter().map(|p| p.direction).collect();
    let lux = |hour: &Hour| match hour.sun.shines() {
        true => hour.sun.illuminance_lux(),
        false => 0.0,
    };
    let suns = lit.iter().filter(|hour| lux(hour) > 0.0);
    let suns: Vec<DVec3> = suns.map(|hour| hour.sun.toward).collect();
    let is_asked = std::env::var("TYNDALL_TRUTHS").is_ok_and(|names| names == "year");
    let truth = if wanted.is_some() || is_asked {
        let Some(truth) = Annual::run(test, &task, &middles, &suns) else {
            return;
        };
        if wanted.is_none() {
            truth.store();
        }
        truth
    } else {
        Annual::stored()
    };
    let now = input(&task);
    assert!(
        (truth.input / now - 1.0).abs() < 1e-8,
        "the truth is that of {:.9e}, the room is {now:.9e}: TYNDALL_TRUTHS=year makes it anew",
        truth.input
    );
    let same = |((own, _), middle): (&(DVec3, _), &DVec3)| own.distance(*middle) < 1e-5;
    assert!(truth.sky.len() == middles.len() && truth.sky.iter().zip(&middles).all(same));
    let (theirs, their_sun): (Vec<_>, Vec<_>) = (lit.iter())
        .map(|hour| {
            let luminances = receive::y(&dome.radiances(&hour.sky));
            let [total, straight] = truth.hour(&luminances, hour.sun.toward, lux(hour));
            (total, straight)
        })
        .unzip();
    let is_occupied = |h: &usize| (9..=18).contains(&lit[*h].hour);
    let occupied: Vec<usize> = (0..lit.len()).filter(is_occupied).collect();
    let pairs = || {
        occupied
            .iter()
            .flat_map(|h| own[*h].iter().zip(&theirs[*h]))
    };
    let count = pairs().count() as f64;
    let rms = (pairs().map(|(a, b)| (a / b - 1.0).powi(2)).sum::<f64>() / count).sqrt();
    let sums = pairs().fold((0.0, 0.0), |s, (a, b)| (s.0 + a, s.1 + b));
    let mean = sums.0 / sums.1 - 1.0;
    eprintln!("{}", truth.said);
    eprintln!(
        "{} hours, {points} points: mean {:+.3} %, RMS over {} occupied hours {:.2} %; tyndall {made:.2} + {found:.2} s",
        lit.len(),
        100.0 * mean,
        occupied.len(),
        100.0 * rms,
    );
    // A stored truth was made on another machine.
    if truth.seconds > 0.0 {
        eprintln!(
            "rfluxmtx, dctimestep and rcontrib {:.1} s: {:.0} times",
            truth.seconds,
            truth.seconds / (made + found)
        );
    }
    assert!(mean.abs() < 0.01 && rms < allowed, "mean {mean}, RMS {rms}");
    // What the sun gives straight is the same but for rounding.
    for (own, theirs) in own_sun.iter().flatten().zip(their_sun.iter().flatten()) {
        assert!(
            (own - theirs).abs() < 0.002 * theirs.max(100.0),
            "{own} {theirs}"
        );
    }
    let factors = vec![0.0; points];
    let metrics = [(&own, &own_sun), (&theirs, &their_sun)]
        .map(|(total, sun)| Metrics::new(&table_of(&sample, total, sun), &factors));
    let areas = vec![1.0; points];
    let all: Vec<usize> = (0..points).collect();
    let [a, b] = metrics.map(|m| m.figures(&all, &areas));
    for (a, b) in a
        .iter()
        .zip(&b)
        .filter(|(a, _)| a.value.is_some() && a.unit.starts_with('%') && !a.key.contains("factor"))
    {
        let (own, theirs) = (a.value.expect("a figure"), b.value.expect("a figure"));
        // A point, or two of the sensors.
        let allowed = if a.unit == "% of the plane" {
            200.0 / points as f64
        } else {
            1.0
        };
        eprintln!("{}: {own:.2} {theirs:.2} {}", a.name, a.unit);
        assert!((own - theirs).abs() <= allowed + 1e-9, "{}", a.name);
    }
}

/// Hours of sun between two blocks 20 km long, which begin so far to the north and to the south of a point and are so high.
fn in_a_street(
    latitude: f64,
    date: NaiveDate,
    distances: [f64; 2],
    height: f64,
    span: Span,
) -> f64 {
    let [north, south] = distances;
    let blocks = [
        cuboid(dvec3(-1e4, 0.0, -north - 30.0), dvec3(1e4, height, -north)),
        cuboid(dvec3(-1e4, 0.0, south), dvec3(1e4, height, south + 30.0)),
    ];
    let triangles: Vec<_> = blocks.concat().into_iter().map(|t| (t, 0.3)).collect();
    let scene = receive::surfaces(&triangles);
    let sensor = at(dvec3(0.0, 0.01, 0.0), DVec3::Y);
    let conditions = receive::conditions(scene, &[sensor]);
    let site = Site::new(latitude, 10.0, 0.0).expect("a place");
    let zone = Zone::named("Europe/Berlin").expect("a zone");
    let span = Span { date, ..span };
    let found = SunHours::new(
        &conditions,
        &[sensor],
        &site,
        &zone,
        &span,
        Task::unwatched(),
    );
    found.expect("it works").hours[0]
}

/// In a street from west to east the southern block is an inclined horizon: what stands above it is what would stand above the
/// level horizon of a place farther north by the angle b of its cornice. cos H = tan d' tan(latitude + b), d' = -declination.
#[test]
fn a_street_has_the_sun_that_the_hour_angle_gives() {
    let latitude = 48.0f64;
    let site = Site::new(latitude, 10.0, 0.0).expect("a place");
    for (month, day) in [(2, 1), (2, 20), (3, 10), (11, 5)] {
        let date = NaiveDate::from_ymd_opt(2026, month, day).expect("a date");
        let noon = Julian::from_date(date, 3600.0 * 11.5);
        let noon = Instant::from_julian(noon, TimeScale::Utc, None).expect("a time");
        let sun = sun_position(Tier::Spa, &noon, &site, &Weather::standard(&site));
        for (distance, height) in [(20.0, 5.0), (14.0, 6.0), (10.0, 8.0)] {
            let cornice = f64::atan((height - 0.01) / distance);
            let cosine = (-sun.declination).tan() * (latitude * DEG + cornice).tan();
            let is_above = latitude * DEG + cornice < 90.0 * DEG;
            let by_hand = match is_above && cosine < 1.0 {
                true => 2.0 * cosine.acos() / (15.0 * DEG),
                false => 0.0,
            };
            let span = Span {
                step_s: 60,
                ..Span::of_day(date)
            };
            let found = in_a_street(latitude, date, [1e3, distance], height, span);
            eprintln!(
                "{date}, cornice {:.1} degrees: {found:.3} h, by hand {by_hand:.3} h",
                cornice / DEG
            );
            // Refraction, and a declination that changes over the day.
            assert!((found - by_hand).abs() < 0.1, "{found} {by_hand}");
            // By the ephemeris itself, minute by minute: higher than the cornice as the street's section shows it.
            let weather = Weather::standard(&site);
            let is_lit = |minute: u32| {
                let jd = Julian::from_date(date, 60.0 * (f64::from(minute) + 0.5) - 3600.0);
                let instant = Instant::from_julian(jd, TimeScale::Utc, None).expect("a time");
                let sun = sun_position(Tier::Spa, &instant, &site, &weather);
                let (up, south) = (
                    sun.elevation_apparent.sin(),
                    -sun.azimuth.cos() * sun.elevation_apparent.cos(),
                );
                up > 0.0 && up > south * cornice.tan()
            };
            let exact = (0..1440).filter(|minute| is_lit(*minute)).count() as f64 / 60.0;
            assert!((found - exact).abs() < 0.04, "{found} {exact}");
        }
    }
    // The local clock: from noon on, half of it; above 20 degrees less.
    let date = NaiveDate::from_ymd_opt(2026, 3, 10).expect("a date");
    let day = Span {
        step_s: 60,
        ..Span::of_day(date)
    };
    let whole = in_a_street(latitude, date, [1e3, 20.0], 5.0, day.clone());
    let noon = NaiveTime::from_hms_opt(12, 30, 0).expect("a time");
    let from = in_a_street(
        latitude,
        date,
        [1e3, 20.0],
        5.0,
        Span {
            from: noon,
            ..day.clone()
        },
    );
    let to = in_a_street(
        latitude,
        date,
        [1e3, 20.0],
        5.0,
        Span {
            to: Some(noon),
            ..day.clone()
        },
    );
    assert!(
        (from + to - whole).abs() < 1e-9 && (from - to).abs() < 0.05,
        "{from} {to} {whole}"
    );
    let high = in_a_street(
        latitude,
        date,
        [1e3, 20.0],
        5.0,
        Span {
            least_elevation_deg: 20.0,
            ..day.clone()
        },
    );
    assert!(high < whole - 0.5, "{high} {whole}");
}
