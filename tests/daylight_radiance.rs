//! Workplane illuminance in rooms against RADIANCE's rtrace: light from sky, sun and all surfaces.
//!
//! Both programs have the same triangles, reflectances, sky, sun and ground. rtrace has three channels that nothing mixes: in a
//! grey room each has the luminance of another sky, and one run gives three truths; in a coloured one they are red, green and
//! blue of one sky.
//!
//! Truths stand in `tests/truth`, one file a room, with the command that made them and what doubling bounces and rays changed.
//! `TYNDALL_TRUTHS=study,well cargo test --release --test daylight_radiance rooms` makes those of some rooms anew (`all`: of
//! all; hours). Rooms whose truth has not been made are named, not judged. A part of one is made in each run of the tests.

mod common;

use common::judge::world;
use common::receive::{self, at, received};
use common::rooms::{ROOMS, Room, WEATHER, Weather, room};
use glam::DVec3;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;
use tyndall::backend::Wanted;
use tyndall::colour::luminance;
use tyndall::conditions::{Conditions, Receiver};

/// What is compared: three numbers a point.
type Rows = Vec<[f64; 3]>;

/// Relative differences: of the means, root mean square and greatest of the points'.
#[derive(Debug, Clone, Copy)]
struct Figures {
    mean: f64,
    rms: f64,
    worst: f64,
}

/// What a room may be off.
const ALLOWED: Figures = Figures {
    mean: 0.005,
    rms: 0.01,
    worst: 0.03,
};

impl Figures {
    fn new(found: &Rows, truth: &Rows, channel: usize) -> Self {
        assert_eq!(found.len(), truth.len(), "one row a point");
        let pairs = || {
            found
                .iter()
                .zip(truth)
                .map(|(f, t)| (f[channel], t[channel]))
        };
        let off = || pairs().map(|(f, t)| (f - t) / t);
        let sums = pairs().fold((0.0, 0.0), |(a, b), (f, t)| (a + f, b + t));
        Figures {
            mean: sums.0 / sums.1 - 1.0,
            rms: (off().map(|d| d * d).sum::<f64>() / found.len() as f64).sqrt(),
            worst: off().fold(
                0.0,
                |worst: f64, d| if d.abs() > worst.abs() { d } else { worst },
            ),
        }
    }

    /// Whether all are at most a share of what is allowed.
    fn within(&self, share: f64) -> bool {
        self.mean.abs() <= share * ALLOWED.mean
            && self.rms <= share * ALLOWED.rms
            && self.worst.abs() <= share * ALLOWED.worst
    }
}

impl std::fmt::Display for Figures {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let [mean, rms, worst] = [self.mean, self.rms, self.worst].map(|v| 100.0 * v);
        write!(f, "mean {mean:+.3} %, rms {rms:.3} %, worst {worst:+.2} %")
    }
}

/// What the three channels of a room's truth are.
enum Channels {
    /// The luminance of each sky.
    Skies,
    /// Red, green and blue, in the working space, of one sky.
    Colours(Weather),
}

impl Channels {
    fn of(room: &Room) -> Self {
        let grey = |r: &DVec3| r.x == r.y && r.y == r.z;
        match room.reflectances.iter().all(grey) {
            true => Channels::Skies,
            false => Channels::Colours(WEATHER[2]),
        }
    }

    fn names(&self) -> [&'static str; 3] {
        match self {
            Channels::Skies => WEATHER.map(|w| w.name),
            Channels::Colours(_) => ["red", "green", "blue"],
        }
    }
}

/// A room under a weather, seen by its points.
fn conditions(room: &Room, weather: &Weather) -> Conditions {
    let points: Vec<Receiver> = room.points.iter().map(|p| at(*p, DVec3::Y)).collect();
    receive::conditions(room.under(weather), &points)
}

/// A room under the weather or the three of its channels.
fn skies(room: &Room) -> Vec<Conditions> {
    match Channels::of(room) {
        Channels::Skies => WEATHER.iter().map(|w| conditions(room, w)).collect(),
        Channels::Colours(w) => vec![conditions(room, &w)],
    }
}

/// What tyndall makes of a room from sun, sky and surfaces together, and the seconds it took.
fn found(room: &Room, backend: Wanted) -> (Rows, f64) {
    let skies = skies(room);
    let begin = Instant::now();
    let all: Vec<Vec<DVec3>> = skies.iter().map(|c| received(c, backend).total()).collect();
    let row = |i: usize| match all.as_slice() {
        [one] => one[i].to_array(),
        all => [0, 1, 2].map(|k: usize| luminance(all[k][i])),
    };
    let rows = (0..room.points.len()).map(row).collect();
    (rows, begin.elapsed().as_secs_f64())
}

/// What rtrace is to know of a room under some skies: bounces, divisions of a hemisphere, and how many hemispheres each point has.
fn task(room: &Room, skies: &[Conditions], ab: u32, ad: u32, repeats: &[u32]) -> Value {
    let mut task = world(room, skies);
    let up = |p: &DVec3| json!([p.x, p.y, p.z, 0.0, 1.0, 0.0]);
    task["points"] = room.points.iter().map(up).collect();
    task["ab"] = json!(ab);
    task["ad"] = json!(ad);
    task["repeats"] = json!(repeats);
    task
}

/// What rtrace makes of a room.
struct Traced {
    rows: Rows,
    /// Standard deviation of one hemisphere's.
    spread: Rows,
    seconds: f64,
    command: String,
}

fn trace(test: &str, task: &Value) -> Option<Traced> {
    let text = common::python(test, "rtrace.py", &task.to_string())?;
    let out: Value = serde_json::from_str(&text).expect("rtrace.py prints JSON");
    let numbers = |name: &str| serde_json::from_value(out[name].clone()).expect("rows of three");
    Some(Traced {
        rows: numbers("illuminances"),
        spread: numbers("spread"),
        seconds: out["seconds"].as_f64().expect("a time"),
        command: out["command"].as_str().expect("a command").to_owned(),
    })
}

fn file(room: &Room) -> PathBuf {
    let name = room.name.replace(' ', "_");
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/truth/{name}.csv"))
}

/// One number for the whole of what a truth was made for, so that one for another room is noticed.
fn input(room: &Room) -> f64 {
    let skies = skies(room);
    let light = |c: &Conditions| {
        let sky = c.sky.as_ref().expect("there is one");
        sky.horizontal_illuminance() + c.sun.light.illuminance * c.sun.toward.y
    };
    let light: f64 = (skies.iter().zip([1.0, 2.0, 3.0]))
        .map(|(c, weight)| weight * luminance(light(c)))
        .sum();
    let surface = |(corners, material): &([DVec3; 3], u32)| {
        let [a, b, c] = *corners;
        let reflectance = room.reflectances[*material as usize].dot(DVec3::new(1.0, 2.0, 3.0));
        (b - a).cross(c - a).length() * reflectance * (1.0 + 0.1 * (a + b + c).length())
    };
    room.triangles.iter().map(surface).sum::<f64>() * light
}

/// How far a point of a truth may scatter: well below a third of what a point may be off.
const SCATTER: f64 = 0.0028;

/// Hemispheres that each point needs in each half of a truth, from the scatter of small ones.
fn hemispheres(small: &Traced, divisions: u32, of: u32) -> Vec<u32> {
    let need = |(mean, spread): (&[f64; 3], &[f64; 3])| {
        let worst = (0..3).map(|k| spread[k] / mean[k]).fold(0.0, f64::max);
        let paths = f64::from(of) * (worst / SCATTER).powi(2);
        (0.5 * paths / f64::from(divisions)).ceil().clamp(2.0, 30.0) as u32
    };
    small.rows.iter().zip(&small.spread).map(need).collect()
}

/// Makes a truth and stores it: the mean of two tracings, the second with twice the bounces. What doubling the rays changes is
/// what lies between the first alone and both.
fn make(test: &str, room: &Room) -> Option<()> {
    let skies = skies(room);
    let (small, divisions) = (2048, 32_768);
    let pilot = task(room, &skies, 40, small, &vec![32; room.points.len()]);
    let repeats = hemispheres(&trace(test, &pilot)?, divisions, small);
    let traced = [40, 80].map(|ab| trace(test, &task(room, &skies, ab, divisions, &repeats)));
    let [Some(first), Some(second)] = traced else {
        return None;
    };
    let pairs = first.rows.iter().zip(&second.rows);
    let both: Rows = pairs
        .map(|(a, b)| [0, 1, 2].map(|k: usize| 0.5 * (a[k] + b[k])))
        .collect();
    let names = Channels::of(room).names();
    let mut text = format!(
        "# {}: illuminance [lx], {} hemispheres by each of two, in {:.0} s\n# {}\n# {}\n# input {:.9e}\n",
        room.name,
        repeats.iter().sum::<u32>(),
        first.seconds + second.seconds,
        first.command,
        second.command,
        input(room)
    );
    for (channel, name) in names.iter().enumerate() {
        let change = Figures::new(&first.rows, &both, channel);
        let _ = writeln!(text, "# doubling bounces and rays, {name}: {change}");
        eprintln!("{}, {name}: doubling bounces and rays: {change}", room.name);
        assert!(change.within(1.0 / 3.0), "this is no truth");
    }
    let _ = writeln!(text, "x,y,z,{}", names.join(","));
    for (p, row) in room.points.iter().zip(&both) {
        let [a, b, c] = row;
        let _ = writeln!(
            text,
            "{:.4},{:.4},{:.4},{a:.2},{b:.2},{c:.2}",
            p.x, p.y, p.z
        );
    }
    std::fs::write(file(room), text).expect("the truth can be written");
    Some(())
}

/// What stands in a truth's file.
struct Stored {
    rows: Rows,
    /// The greatest change of a point in each channel when bounces and rays were doubled.
    worst: [f64; 3],
}

/// A stored truth, if there is one.
fn stored(room: &Room) -> Option<Stored> {
    let text = std::fs::read_to_string(file(room)).ok()?;
    let made_for: f64 = (text.lines())
        .find_map(|line| line.strip_prefix("# input "))
        .and_then(|number| number.parse().ok())
        .expect("a truth says what it was made for");
    assert!(
        (input(room) / made_for - 1.0).abs() < 1e-6,
        "the truth of {} was made for another room or sky",
        room.name
    );
    let rows = text.lines().filter(|l| !l.starts_with(['#', 'x']));
    let number = |v: &str| v.parse().expect("a number");
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(number).collect();
        [numbers[3], numbers[4], numbers[5]]
    };
    let changes = text.lines().filter(|l| l.starts_with("# doubling"));
    let change = |line: &str| -> f64 {
        let (_, worst) = line.rsplit_once("worst ").expect("it says the worst");
        let share = worst.trim_end_matches(" %").parse::<f64>();
        0.01 * share.expect("a number").abs()
    };
    let changes: Vec<f64> = changes.map(change).collect();
    Some(Stored {
        rows: rows.map(row).collect(),
        worst: changes.try_into().expect("one of each channel"),
    })
}

/// Prints what a room is off, and lists what is more than is allowed. Where the truth's own worst point moves by more than a third
/// of what is allowed, a point may be off by as much more: it cannot tell better.
fn compare(room: &Room, found: &Rows, truth: &Rows, own: [f64; 3], failures: &mut Vec<String>) {
    for (channel, name) in Channels::of(room).names().iter().enumerate() {
        let figures = Figures::new(found, truth, channel);
        let line = format!("{}, {name}: {figures}", room.name);
        let own = own[channel];
        let more = if own > ALLOWED.worst / 3.0 { own } else { 0.0 };
        match more > 0.0 {
            true => eprintln!(
                "{line}; the truth's worst point moves by {:.2} %",
                100.0 * own
            ),
            false => eprintln!("{line}"),
        }
        let worst = figures.worst.abs() - more;
        if !(Figures { worst, ..figures }).within(1.0) {
            failures.push(line);
        }
    }
}

#[test]
fn rooms_have_the_light_that_radiance_gives_them() {
    let test = "rooms_have_the_light_that_radiance_gives_them";
    let asked = std::env::var("TYNDALL_TRUTHS").unwrap_or_default();
    let mut failures = Vec::new();
    for name in ROOMS {
        let room = room(name, 1.0).expect("it is in the list");
        if (asked == "all" || asked.split(',').any(|n| n == name)) && make(test, &room).is_none() {
            return;
        }
        let Some(truth) = stored(&room) else {
            eprintln!("{name}: no truth yet");
            continue;
        };
        let (rows, seconds) = found(&room, Wanted::Reference);
        eprintln!("{name}: {} points, {seconds:.1} s", room.points.len());
        compare(&room, &rows, &truth.rows, truth.worst, &mut failures);
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// One in so many points is traced anew.
const PART: usize = 12;

/// A part of a truth is made anew, under one sky, by the setting that is converged to half a percent; beside it stands the time for
/// all points, of which each takes rtrace as long as another.
#[test]
fn a_room_is_traced_anew() {
    let test = "a_room_is_traced_anew";
    let room = room("study", 1.0).expect("it is in the list");
    let truth = stored(&room).expect("its truth is stored").rows;
    let sky = conditions(&room, &WEATHER[2]);
    let mut part = room.clone();
    part.points = room.points.iter().copied().step_by(PART).collect();
    let once = vec![1; part.points.len()];
    let Some(new) = trace(test, &task(&part, &[sky], 10, 65_536, &once)) else {
        return;
    };
    let traced = new.seconds * room.points.len() as f64 / part.points.len() as f64;
    // The last channel of the stored truth is this sky's.
    let all = |v: f64| [v, v, v];
    let rows: Rows = (new.rows.iter())
        .map(|row| all(luminance(DVec3::from(*row))))
        .collect();
    let same: Rows = truth.iter().copied().step_by(PART).collect();
    let change = Figures::new(&rows, &same, 2);
    eprintln!("rtrace anew against the stored truth: {change}");
    assert!(change.within(1.0), "{change}");
    let begin = Instant::now();
    let found = received(&conditions(&room, &WEATHER[2]), Wanted::Reference).total();
    let seconds = begin.elapsed().as_secs_f64();
    let rows: Rows = found.iter().map(|v| all(luminance(*v))).collect();
    let off = Figures::new(&rows, &truth, 2);
    let count = room.points.len();
    eprintln!("{count} points: {off}; rtrace {traced:.1} s, tyndall {seconds:.2} s");
    assert!(off.within(1.0), "{off}");
}

#[test]
fn a_wrong_room_is_noticed() {
    let sound = room("study", 1.0).expect("it is in the list");
    let truth = stored(&sound).expect("its truth is stored").rows;
    for wrong in [
        sound.lighter(0.05),
        room("study", 1.05).expect("it is in the list"),
    ] {
        let (rows, _) = found(&wrong, Wanted::Reference);
        for (channel, name) in Channels::of(&wrong).names().iter().enumerate() {
            let figures = Figures::new(&rows, &truth, channel);
            eprintln!("{name}: {figures}");
            assert!(!figures.within(1.0), "{name}: {figures}");
        }
    }
}

/// What is compared fits together even without light from surfaces: black rooms are lit by sky and sun alone.
#[test]
fn a_black_room_has_the_light_of_sky_and_sun() {
    let test = "a_black_room_has_the_light_of_sky_and_sun";
    for name in ["study", "thick", "furnished"] {
        let mut room = room(name, 1.0).expect("it is in the list").lighter(0.0);
        room.reflectances.fill(DVec3::ZERO);
        room.ground = 0.0;
        room.points = room.points.iter().copied().step_by(6).collect();
        let repeats = vec![16; room.points.len()];
        let task = task(&room, &skies(&room), 1, 65_536, &repeats);
        let Some(truth) = trace(test, &task) else {
            return;
        };
        let (rows, _) = found(&room, Wanted::Reference);
        // Behind a cupboard no sky is seen.
        let lit: Vec<usize> = (0..rows.len())
            .filter(|i| truth.rows[*i][0] > 5.0)
            .collect();
        let of = |rows: &Rows| lit.iter().map(|i| rows[*i]).collect();
        let mut failures = Vec::new();
        // Without light from walls single points see the window's outline alone: a percent more at the worst of them.
        compare(
            &room,
            &of(&rows),
            &of(&truth.rows),
            [0.011; 3],
            &mut failures,
        );
        assert!(failures.is_empty(), "{failures:#?}");
    }
}
