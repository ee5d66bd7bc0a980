//! A time-lapse by the library: its instants, its keys, the same frames in any order, and an exposure that does not flicker.

use chrono::{DateTime, NaiveDate, Utc};
use glam::{DVec3, UVec2};
use std::path::Path;
use tyndall::backend::reference::Reference;
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::colour::exposure::white_luminance;
use tyndall::colour::luminance;
use tyndall::conditions::{Conditions, Request};
use tyndall::ephemeris::civil::{Fold, Reading};
use tyndall::ephemeris::{Site, Tier};
use tyndall::frame::{Field, Frame};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Camera, Scene, SiteEntry};
use tyndall::task::Task;
use tyndall::timelapse::plan::{ExposurePlan, FrameLine};
use tyndall::timelapse::template::Template;
use tyndall::timelapse::when::{self, Count, Observer, When};
use tyndall::timelapse::{Asked, Sequence, key};
use tyndall::{Error, Result, output};

const PARIS: [f64; 2] = [48.8584, 2.2945];

/// The instants between two ends at a place.
fn when(
    [latitude, longitude]: [f64; 2],
    [from, to]: [&str; 2],
    date: Option<&str>,
    step: &str,
    fold: Option<Fold>,
) -> Result<When> {
    let site = Site::new(latitude, longitude, 0.0)?;
    let count = match step.strip_suffix(" frames") {
        Some(count) => Count::Frames(count.parse().expect("a number")),
        None => Count::Every(step.parse()?),
    };
    let asked = when::Asked {
        from,
        to,
        date: date.map(|date| date.parse::<NaiveDate>().expect("a date")),
        count,
    };
    let reading = Reading {
        site: Some(&site),
        fold,
        ..Reading::default()
    };
    When::new(
        &asked,
        &Observer {
            site: &site,
            reading,
            tier: Tier::Spa,
        },
    )
}

/// The first and the last of them by the clock of the place, and how many there are.
fn ends(when: &When) -> (u64, String, String) {
    let count = when.count();
    let text = |number| when.local_text(when.get(number).expect("it is one of them"));
    (count, text(0), text(count - 1))
}

fn all(when: &When) -> Vec<DateTime<Utc>> {
    let all = (0..when.count()).map(|number| when.get(number));
    all.collect::<Result<_>>().expect("all are there")
}

#[test]
fn both_ends_are_frames_and_steps_end_at_the_second() {
    let day = |to, step| when(PARIS, ["2026-06-21T18:00", to], None, step, None).expect("two ends");
    let (count, from, to) = ends(&day("2026-06-21T19:00", "61 frames"));
    assert_eq!(
        (count, &*from, &*to),
        (61, "2026-06-21T18:00:00+02:00", "2026-06-21T19:00:00+02:00")
    );
    assert_eq!(ends(&day("2026-06-21T19:00", "30s")).0, 121);
    let (count, _, to) = ends(&day("2026-06-21T18:59:59", "30s"));
    assert_eq!((count, &*to), (120, "2026-06-21T18:59:30+02:00"));
    // Thirds of a second are told to the millisecond, and both ends are what was asked for.
    let thirds = all(&day("2026-06-21T18:00:01", "4 frames"));
    let after = |k: usize| (thirds[k] - thirds[0]).num_milliseconds();
    assert_eq!([1, 2, 3].map(after), [333, 667, 1000]);
    assert_eq!(ends(&day("2026-06-21T18:00", "1h")).0, 1);
    assert_eq!(ends(&day("2026-06-21T19:00", "1 frames")).0, 1);
    for (to, step) in [
        ("2026-06-21T17:59", "1m"),
        ("2026-06-21T18:00", "2 frames"),
        ("2026-06-21T19:00", "0 frames"),
        ("2026-06-21T19:00", "99999999999 frames"),
    ] {
        let error = when(PARIS, ["2026-06-21T18:00", to], None, step, None);
        assert!(error.is_err_and(|e| e.is_input()), "{to} {step}");
    }
}

#[test]
fn days_go_by_the_clock_and_hours_by_time_through_clock_changes() {
    // Summer time ends on 25 October 2026 and begins on 29 March.
    let of = |from, to, step, fold| when(PARIS, [from, to], None, step, fold).expect("two ends");
    let days = all(&of("2026-10-24T12:00", "2026-10-26T12:00", "1d", None));
    let hours: Vec<i64> = days.windows(2).map(|w| (w[1] - w[0]).num_hours()).collect();
    assert_eq!(hours, [25, 24]);
    let times = of("2026-10-24T12:00", "2026-10-26T12:00", "24h", None);
    assert_eq!(ends(&times).2, "2026-10-26T11:00:00+01:00");
    assert_eq!(
        all(&of("2026-03-28T12:00", "2026-03-29T12:00", "1d", None)).len(),
        2
    );
    // Of the day with 25 hours each is there, and of that with 23 none is made up.
    assert_eq!(
        ends(&of("2026-10-25T00:00", "2026-10-26T00:00", "1h", None)).0,
        26
    );
    assert_eq!(
        ends(&of("2026-03-29T00:00", "2026-03-30T00:00", "1h", None)).0,
        24
    );
    // An hour that is there twice, or not at all, is asked about.
    let twice = when(
        PARIS,
        ["2026-10-24T02:30", "2026-10-26T02:30"],
        None,
        "1d",
        None,
    );
    let error = twice
        .expect("its ends are there")
        .get(1)
        .expect_err("it is there twice");
    assert!(
        error.is_input() && error.remedy().contains("--fold"),
        "{error}"
    );
    let later = of(
        "2026-10-24T02:30",
        "2026-10-26T02:30",
        "1d",
        Some(Fold::Later),
    );
    assert_eq!(
        later.local_text(later.get(1).expect("it is chosen")),
        "2026-10-25T02:30:00+01:00"
    );
    // Unless the first end says which.
    let exact = "2026-10-25T02:30+01:00[Europe/Paris]";
    let exact = of(exact, "2026-10-26T02:30", "1d", None);
    assert_eq!(
        ends(&exact),
        (
            2,
            "2026-10-25T02:30:00+01:00".into(),
            "2026-10-26T02:30:00+01:00".into()
        )
    );
    // A year of noons by the clock, leap year or not.
    assert_eq!(
        ends(&of("2028-01-01T12:00", "2028-12-31T12:00", "1d", None)).0,
        366
    );
    assert_eq!(
        ends(&of("2026-01-01T12:00", "2026-12-31", "1w", None)).0,
        53
    );
}

#[test]
fn what_the_sun_does_is_solved_on_each_day_and_after_midnight() {
    let of = |site, ends, date, step| when(site, ends, Some(date), step, None);
    let day = of(PARIS, ["sunrise-20m", "sunset+40m"], "2026-06-21", "1m").expect("a day");
    let (_, from, to) = ends(&day);
    // Sunrise 05:46:53 and sunset 21:58:06 by the almanac (to a minute).
    assert!(from.starts_with("2026-06-21T05:2"), "{from}");
    assert!(to.starts_with("2026-06-21T22:3"), "{to}");
    // A night: the sunrise after the sunset is the next day's.
    let night = of(PARIS, ["sunset", "sunrise"], "2026-06-21", "2 frames").expect("a night");
    let (_, from, to) = ends(&night);
    assert!(
        from.starts_with("2026-06-21T21:5") && to.starts_with("2026-06-22T05:4"),
        "{from} {to}"
    );
    let evening = when(PARIS, ["2026-06-21T22:30", "sunrise"], None, "1h", None).expect("a night");
    assert!(ends(&evening).2.starts_with("2026-06-22T05:30"));
    let clock = of(PARIS, ["22:00", "04:00"], "2026-12-31", "1h").expect("a night");
    assert_eq!(ends(&clock).2, "2027-01-01T04:00:00+01:00");
    // The sun's noon wanders by half an hour of the clock over a year.
    let noons = of(PARIS, ["solar-noon", "2026-12-31"], "2026-01-01", "1d").expect("a year");
    assert_eq!(noons.count(), 365);
    let seconds: Vec<i64> = all(&noons)
        .iter()
        .map(|utc| utc.timestamp() % 86_400)
        .collect();
    let spread = seconds.iter().max().expect("some") - seconds.iter().min().expect("some");
    assert!((1800..1920).contains(&spread), "{spread} s");
    // Seven hours before sunrise is on the date before: both ends are there.
    for (start, count, first, last) in [
        ("sunrise-7h", 30, "2026-05-31T22:5", "2026-06-29T22:5"),
        ("sunset+5h", 29, "2026-06-02T02:4", "2026-06-30T02:5"),
    ] {
        let nights = of(PARIS, [start, "2026-06-30T23:59"], "2026-06-01", "1d");
        let (_, from, _) = ends(&nights.expect("a month"));
        assert!(from.starts_with(first), "{from}");
        let nights = of(PARIS, [start, "2026-06-30T12:00"], "2026-06-01", "1d");
        let (nights, _, to) = ends(&nights.expect("a month"));
        assert!(nights == count && to.starts_with(last), "{nights} {to}");
    }
    let nights = of(PARIS, ["sunrise-7h", "2026-06-30"], "2026-06-01", "1d");
    assert_eq!(nights.expect("a month").count(), 30);
    // South of the equator December has the long days.
    let sydney = [-33.86, 151.2];
    let length = |date| {
        let all = all(&of(sydney, ["sunrise", "sunset"], date, "2 frames").expect("a day"));
        (all[1] - all[0]).num_minutes()
    };
    assert!(length("2026-12-21") > 860 && length("2026-06-21") < 600);
    let other = when(PARIS, ["sunrise", "sunset"], None, "1h", None).expect_err("no date");
    assert!(other.remedy().contains("--date"), "{other}");
}

#[test]
fn in_polar_night_the_nearest_sunset_is_named() {
    let tromso = [69.65, 18.96];
    let of = |date: &str| when(tromso, ["sunrise", "sunset"], Some(date), "1m", None);
    let error = of("2026-12-21").expect_err("the sun does not rise");
    assert!(error.is_input());
    let said = error.to_string();
    assert!(
        said.contains("there is no sunrise here on 2026-12-21"),
        "{said}"
    );
    assert!(said.contains("below the horizon all day"), "{said}");
    // Polar night ends there in the middle of January and begins at the end of November.
    let (_, date) = error
        .remedy()
        .split_once("--date ")
        .map(|(a, b)| (a.to_owned(), b[..10].to_owned()))
        .expect("a date");
    assert!(of(&date).is_ok(), "{date}");
    let near = |days: i64| {
        let night: NaiveDate = "2026-12-21".parse().expect("a date");
        let date: NaiveDate = date.parse().expect("a date");
        (date - night).num_days().abs() == days
    };
    let distance = (1..60).find(|days| near(*days)).expect("within two months");
    for days in 1..distance {
        for step in [-days, days] {
            let night: NaiveDate = "2026-12-21".parse().expect("a date");
            let date = night + chrono::TimeDelta::days(step);
            assert!(of(&date.to_string()).is_err(), "{date} is nearer");
        }
    }
    let summer = of("2026-06-21")
        .expect_err("the sun does not set")
        .to_string();
    assert!(summer.contains("above the horizon all day"), "{summer}");
    // Within a sequence too, and at the pole on no day of the year.
    let weeks = when(
        tromso,
        ["sunrise", "2026-12-31"],
        Some("2026-11-01"),
        "1w",
        None,
    );
    let weeks = weeks.and_then(|when| {
        (0..when.count())
            .map(|k| when.get(k))
            .collect::<Result<Vec<_>>>()
    });
    assert!(weeks.is_err_and(|e| e.to_string().contains("there is no sunrise here")));
    let pole = when(
        [90.0, 0.0],
        ["civil-dawn", "civil-dusk"],
        Some("2026-06-21"),
        "1h",
        None,
    );
    assert!(pole.is_err_and(|e| e.is_input()));
}

/// A room of 4 x 3 x 6 m whose window looks west, some haze in it, seen away from the window.
fn room(folder: &Path) -> Scene {
    let mut obj = String::new();
    let mut count = 0;
    let mut quad = |corners: [[f64; 3]; 4]| {
        for [x, y, z] in corners {
            obj += &format!("v {x} {y} {z}\n");
        }
        obj += &format!(
            "f {} {} {} {}\n",
            count + 1,
            count + 2,
            count + 3,
            count + 4
        );
        count += 4;
    };
    let (w, h, d) = (2.0, 3.0, 3.0);
    quad([[-w, 0.0, -d], [-w, 0.0, d], [w, 0.0, d], [w, 0.0, -d]]);
    quad([[-w, h, -d], [w, h, -d], [w, h, d], [-w, h, d]]);
    quad([[-w, 0.0, -d], [w, 0.0, -d], [w, h, -d], [-w, h, -d]]);
    quad([[-w, 0.0, d], [-w, h, d], [w, h, d], [w, 0.0, d]]);
    quad([[w, 0.0, -d], [w, 0.0, d], [w, h, d], [w, h, -d]]);
    // The wall around the window, 1 to 2.2 m high and 2 m wide.
    let mut wall = |y: [f64; 2], z: [f64; 2]| {
        quad([
            [-w, y[0], z[0]],
            [-w, y[1], z[0]],
            [-w, y[1], z[1]],
            [-w, y[0], z[1]],
        ]);
    };
    wall([0.0, 1.0], [-d, d]);
    wall([2.2, h], [-d, d]);
    wall([1.0, 2.2], [-d, -1.0]);
    wall([1.0, 2.2], [1.0, d]);
    std::fs::write(folder.join("room.obj"), obj).expect("the mesh is written");
    let text = r#"mesh = "room.obj"
[[medium]]
shape = "box"
min = [-2.0, 0.0, -3.0]
max = [2.0, 3.0, 3.0]
scattering = 0.01
"#;
    std::fs::write(folder.join("room.toml"), text).expect("the scene is written");
    let mut scene = tyndall::scene::load(&folder.join("room.toml")).expect("it is a scene");
    let target = DVec3::new(1.6, 0.8, -2.0);
    let eye = DVec3::new(-1.5, 1.6, 2.5);
    scene.camera = Some(Camera::look_at(eye, target, 1.0));
    scene
}

/// A sequence in Paris at draft quality, its frames in a folder.
fn sequence(scene: Scene, ends: [&str; 2], step: &str, size: [u32; 2], folder: &Path) -> Sequence {
    let when = when(PARIS, ends, Some("2026-06-21"), step, None).expect("two ends");
    asked(scene, when, size, Quality::Draft, folder)
}

fn asked(
    mut scene: Scene,
    when: When,
    size: [u32; 2],
    quality: Quality,
    folder: &Path,
) -> Sequence {
    scene.site = Some(SiteEntry {
        latitude_deg: PARIS[0],
        longitude_deg: PARIS[1],
        ..SiteEntry::default()
    });
    scene.time = Some(when.text(when.get(0).expect("there is one")));
    let request = Request {
        size: Some(size),
        ..Request::default()
    };
    let rec709 = tyndall::colour::Space::Rec709;
    let c = rec709.chromaticities();
    let template = format!("{}/f_####.exr", folder.display());
    Sequence::new(Asked {
        conditions: Conditions::new(scene, &request).expect("they are physics"),
        when,
        overrules: Overrules {
            quality,
            ..Overrules::default()
        },
        outputs: vec![Template::new(&template).expect("a template")],
        layers: output::select_layers::<&str>(&[]).expect("all layers"),
        space: output::OutputSpace {
            name: rec709.name(),
            from_working: rec709.from_working(),
            primaries: [c.red, c.green, c.blue].map(Into::into),
            white: c.white.into(),
            numbers: output::Numbers::default(),
        },
        exposure: None,
        stops: 0.0,
        first: 1,
        command: String::new(),
    })
    .expect("a sequence")
}

fn reference() -> Backend {
    Backend::open(Wanted::Reference).expect("there is a CPU")
}

fn lines(sequence: &Sequence, backend: &mut Backend) -> Vec<FrameLine> {
    let planned = sequence
        .plan(backend, &Limits::default(), &|_| {}, &mut |_, _| {})
        .expect("it can be planned");
    let lines = sequence.lines(&planned).collect::<Result<Vec<_>>>();
    lines.expect("all have a line")
}

fn render(sequence: &Sequence, line: &FrameLine, backend: &mut Backend) -> Frame {
    let rendered = sequence.render(line, backend, &Limits::default(), &|_| {});
    rendered.expect("it renders").frame
}

#[test]
fn frames_are_the_same_bytes_in_any_order_and_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    // From sunlight in the room through sunset to night; one of them with the effects of none of its neighbours.
    let ends = ["sunset-3h", "sunset+2h"];
    let sequence = sequence(
        room(folder.path()),
        ends,
        "6 frames",
        [32, 20],
        folder.path(),
    );
    let lines = lines(&sequence, &mut reference());
    assert!(lines[0].run.contains(&"surface_sun".to_owned()));
    assert!(lines[5].skipped.contains(&"surface_sun".to_owned()));
    let bytes = |line: &FrameLine| {
        let (path, _) = sequence.outputs().of(line.index).next().expect("one file");
        std::fs::read(path).expect("it was written")
    };
    let mut in_order = Vec::new();
    let mut backend = reference();
    for line in &lines {
        render(&sequence, line, &mut backend);
        in_order.push(bytes(line));
    }
    let mut made = Vec::new();
    for line in lines.iter().rev() {
        let rendered = sequence.render(line, &mut backend, &Limits::default(), &|_| {});
        made.extend(rendered.expect("it renders").made.products);
        assert_eq!(
            bytes(line),
            in_order[line.index as usize - 1],
            "frame {}, backward",
            line.index
        );
    }
    assert!(made.contains(&"the light of all patches"));
    assert!(!made.contains(&"who sees whom"), "{made:?}");
    for line in &lines {
        render(&sequence, line, &mut reference());
        assert_eq!(
            bytes(line),
            in_order[line.index as usize - 1],
            "frame {}, alone",
            line.index
        );
    }
    // They differ, and whoever planned before, for key frames, has changed nothing.
    assert!(in_order.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn keys_change_with_what_changes_pictures_and_with_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |change: &dyn Fn(&mut Scene), size: [u32; 2], quality: Quality, name: &str| {
        let folder = folder.path();
        let mut scene = room(folder);
        change(&mut scene);
        let when = when(PARIS, ["12:00", "12:01"], Some("2026-06-21"), "1m", None).expect("two");
        let sequence = asked(scene, when, size, quality, &folder.join(name));
        lines(&sequence, &mut reference()).swap_remove(0)
    };
    let draft = Quality::Draft;
    let plain = of(&|_| {}, [8, 5], draft, "a");
    assert_eq!(plain.key.len(), 64);
    // Other names of files and a scene that is read again are no other pictures.
    assert_eq!(of(&|_| {}, [8, 5], draft, "b").key, plain.key);
    assert_ne!(of(&|_| {}, [8, 6], draft, "a").key, plain.key);
    assert_ne!(of(&|_| {}, [8, 5], Quality::Preview, "a").key, plain.key);
    let changes: [&dyn Fn(&mut Scene); 7] = [
        &|scene| scene.mesh.positions[3].y += 1e-12,
        &|scene| scene.mesh.triangles.swap(0, 1),
        &|scene| scene.materials[0].base_color.x *= 0.999,
        &|scene| scene.north_deg = 1.0,
        &|scene| scene.ground.albedo += 0.01,
        &|scene| scene.sky.turbidity = Some(4.0),
        &|scene| scene.media.clear(),
    ];
    for (number, change) in changes.iter().enumerate() {
        assert_ne!(
            of(change, [8, 5], draft, "a").key,
            plain.key,
            "change {number}"
        );
    }
    let utc = plain.instant.parse::<DateTime<Utc>>().expect("an instant");
    let other = |utc, ev100| key::of_frame("a", "b", (utc, "12:00+02:00"), ev100);
    assert_eq!(other(utc, 8.0), other(utc, 8.0));
    assert_ne!(other(utc, 8.0), other(utc, 8.000_000_1));
    assert_ne!(
        other(utc, 8.0),
        other(utc + chrono::TimeDelta::milliseconds(1), 8.0)
    );
}

/// Second differences of the exposed mean luminance, over the mean of three neighbours.
fn flicker(means: &[f64]) -> (f64, f64) {
    let mut off: Vec<f64> = means
        .windows(3)
        .map(|m| (m[0] - 2.0 * m[1] + m[2]).abs() / (m.iter().sum::<f64>() / 3.0))
        .collect();
    off.sort_by(f64::total_cmp);
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    (mean, off[(0.99 * off.len() as f64) as usize])
}

#[test]
fn a_sunset_and_a_room_at_dusk_do_not_flicker() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut outdoors = room(folder.path());
    // Under the open sky, with the sun behind.
    outdoors.media.clear();
    let eye = DVec3::new(3.0, 1.7, 8.0);
    outdoors.camera = Some(Camera::look_at(eye, DVec3::new(8.0, 1.5, 0.0), 1.0));
    for (name, scene) in [("outdoors", outdoors), ("room", room(folder.path()))] {
        let ends = ["sunset-5m", "sunset+5m"];
        let when = when(PARIS, ends, Some("2026-06-21"), "40 frames", None).expect("two ends");
        let sequence = asked(scene, when, [16, 10], Quality::Preview, folder.path());
        let mut backend = reference();
        let lines = lines(&sequence, &mut backend);
        let luminances: Vec<f64> = lines
            .iter()
            .map(|line| {
                let frame = render(&sequence, line, &mut backend);
                let pixels = frame.pixels();
                let sum: f64 = (0..pixels).map(|i| luminance(frame.picture(i))).sum();
                sum / pixels as f64
            })
            .collect();
        let exposed = |ev100: &dyn Fn(&FrameLine) -> f64| {
            let pairs = luminances.iter().zip(&lines);
            let means = pairs.map(|(luminance, line)| luminance / white_luminance(ev100(line)));
            means.collect::<Vec<f64>>()
        };
        let means = exposed(&|line| line.ev100);
        let (mean, most) = flicker(&means);
        println!("{name}: second differences {mean:.5} in the mean, {most:.5} at 99 %");
        assert!(mean <= 0.005 && most <= 0.02, "{name}: {mean} {most}");
        let (darkest, brightest) = (
            means.iter().copied().fold(f64::INFINITY, f64::min),
            means.iter().copied().fold(0.0, f64::max),
        );
        assert!(
            brightest < 1.5 * darkest,
            "{name}: {darkest} to {brightest}"
        );
        // One that goes by tenths of a stop is seen to jump.
        let (mean, most) = flicker(&exposed(&|line| (10.0 * line.ev100).round() / 10.0));
        assert!(mean > 0.005 && most > 0.02, "{name}: {mean} {most}");
    }
}

#[test]
fn the_exposure_follows_the_light_through_twilight() {
    let folder = tempfile::tempdir().expect("a folder");
    let ends = ["sunset-15m", "civil-dusk"];
    let sequence = sequence(
        room(folder.path()),
        ends,
        "80 frames",
        [16, 10],
        folder.path(),
    );
    let mut backend = reference();
    let plan = |backend: &mut Backend| {
        sequence
            .plan(backend, &Limits::default(), &|_| {}, &mut |_, _| {})
            .expect("it can be planned")
    };
    let planned = plan(&mut backend);
    let ExposurePlan::Curve(frames) = &planned.header.exposure else {
        panic!("it is not fixed");
    };
    // 7 degrees of the sun, at 1.25 a key frame.
    assert!((6..=16).contains(&frames.len()), "{frames:?}");
    assert_eq!((frames[0].index, frames[frames.len() - 1].index), (1, 80));
    assert!(frames.is_sorted_by(|a, b| a.ev100 > b.ev100));
    assert!(frames[0].ev100 > frames[frames.len() - 1].ev100 + 5.0);
    let line = |number| sequence.line(&planned, number).expect("it has a line");
    for frame in frames {
        assert!((line(frame.index - 1).ev100 - frame.ev100).abs() < 1e-12);
    }
    // Whoever plans, with whatever kept, plans the same.
    assert_eq!(plan(&mut backend).header, planned.header);
    assert_eq!(plan(&mut reference()).header, planned.header);
}

#[test]
fn a_sun_that_stands_still_is_refused() {
    let mut scene = Scene::builtin("nave").expect("it is built in");
    scene.sun = Some(tyndall::scene::SunEntry {
        azimuth_deg: 180.0,
        elevation_deg: 30.0,
        illuminance: None,
        diameter_deg: None,
    });
    scene.site = None;
    let conditions = Conditions::new(scene, &Request::default()).expect("they are physics");
    assert!(matches!(
        conditions.at("2026-06-21T12:00Z"),
        Err(Error::Input { .. })
    ));
}

/// A frame of a day in the nave: what is left of the sun's disc at one place is so little that rounding made it less than nothing, and no
/// frame with that can be written.
#[test]
fn a_sliver_of_the_sun_gives_no_less_than_nothing() {
    let mut scene = Scene::builtin("nave").expect("it is built in");
    scene.time = Some("2026-10-22T07:46:57.391Z[Europe/Paris]".into());
    let request = Request {
        size: Some([320, 200]),
        ..Request::default()
    };
    let conditions = Conditions::new(scene, &request).expect("they are physics");
    let overrules = Overrules {
        without: ["radiosity", "air_sky", "shafts"].map(String::from).into(),
        ..Overrules::default()
    };
    let plan = Plan::new(&conditions, &overrules).expect("a plan");
    let reference = Reference::new(&plan).expect("it is prepared");
    let values = reference.sampled(&[UVec2::new(152, 112)], 8, Task::unwatched());
    let values = values.expect("nothing stops it");
    let sun = values[0][Field::Sun as usize];
    assert!(sun.cmpge(DVec3::ZERO).all(), "{sun}");
    assert!(sun.max_element() > 0.0, "it is a place with a sliver");
}
