//! `tyndall daylight`: illuminance at points and on grids.

use crate::arguments::backend::BackendFlag;
use crate::arguments::form::FormArgs;
use crate::arguments::grid::{GridArgs, scale};
use crate::arguments::memory::MemoryArgs;
use crate::arguments::scene::{PlanArgs, SceneArgs};
use crate::commands::daylight_grid::{self, Grid};
use crate::commands::daylight_year::{self, Asked, YearArgs};
use crate::machine;
use crate::tables::daylight_batch::{Done, Meter};
use crate::tables::printer::{As, Form};
use crate::tables::work;
use crate::tell;
use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};
use glam::DVec3;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;
use tyndall::conditions::{CameraChoice, Conditions, Receiver, Request, View};
use tyndall::daylight::{assumed, factor};
use tyndall::output;
use tyndall::output::scale::Scale;
use tyndall::plan::Plan;
use tyndall::scene::Camera;
use tyndall::{Error, Result};

/// Illuminance at points and on grids: what light meters would read there; daylight factors
#[derive(Debug, Args)]
#[command(after_help = "\
The points are a CSV with the columns x, y, z in metres, in the scene's axes (+Y up), and perhaps nx, ny, nz: the direction that \
the meter faces, of any length; it looks up where they are left out. Every row comes out again, in its order, with its \
illuminance in lux: `illuminance` is the whole, `sun` and `sky` what comes straight from them, `indirect` what surfaces and the \
ground send on; a scene with lamps has `lights` too, what comes straight from them.\n\n\
With --grid the points are found: on a plane over all floors, over those of a room or an object, or on a surface by name. A summary \
is printed, and -o writes a map (.png, .svg) or all values (.csv, .json, .exr). With --weather it is a year of hours with the metrics of \
standards, and -o page.html one page of all that; with --sun-hours the hours of sun on a day.\n\n\
Examples:\n  \
tyndall daylight room.glb --at 48.8584,2.2945 --time 2026-06-21T12:00 --points desk.csv\n  \
tyndall daylight room.glb --sun 180,30 --sky cie:1 --points desk.csv --csv > lux.csv\n  \
tyndall daylight room.glb --at 48.8584,2.2945 --time 2026-06-21T12:00 --grid plane=0.85,spacing=0.5 -o map.png -o map.csv\n  \
tyndall daylight room.glb --factor --grid plane=0.85,spacing=0.25,inset=0.5,room=Kitchen -o factor.svg\n  \
tyndall daylight room.glb --grid plane=0.76,spacing=0.6 --weather chicago.epw -o page.html -o year.csv\n  \
tyndall daylight street.glb --at 48.1,11.6 --grid plane=1.2,spacing=1 --sun-hours 2026-03-21 -o sun.svg\n  \
seq 0 0.5 4 | awk 'BEGIN{print \"x,y,z\"}{print $1\",0.8,0\"}' | tyndall daylight room.glb --sun 180,30 --points -")]
pub struct DaylightArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// A CSV of points: x, y, z in metres and perhaps nx, ny, nz, one point a row; - is stdin
    #[arg(long, value_name = "FILE", required_unless_present = "grid")]
    points: Option<PathBuf>,
    #[command(flatten)]
    grid: GridArgs,
    /// Daylight factors under an overcast sky, cie:16 unless --sky says cie:1; place and time do not count
    #[arg(long, requires = "grid", conflicts_with = "points")]
    factor: bool,
    /// With --grid: a file to write, by its ending .png or .svg (a map), .csv, .json, .exr, or of a year .html; may be repeated
    #[arg(
        short,
        long,
        value_name = "FILE",
        requires = "grid",
        conflicts_with = "points"
    )]
    output: Vec<PathBuf>,
    /// The range of the map's colours, in lx or % [default: found from the values]
    #[arg(long, value_name = "LOW..HIGH", requires = "output", value_parser = scale)]
    false_colour: Option<Scale>,
    /// Stop at the first broken row, and print nothing
    #[arg(long, conflicts_with = "grid")]
    strict: bool,
    #[command(flatten)]
    year: YearArgs,
    #[command(flatten)]
    plan: PlanArgs,
    /// What computes: auto uses a hardware adapter, else the CPU reference; gpu also accepts a software adapter
    #[arg(long, value_name = "BACKEND", default_value = "auto", value_enum)]
    backend: BackendFlag,
    /// Write what was done to a JSON file
    #[arg(long, value_name = "FILE.json", value_parser = PathBufValueParser::new().try_map(report_file))]
    report: Option<PathBuf>,
    #[command(flatten)]
    memory: MemoryArgs,
    #[command(flatten)]
    form: FormArgs,
}

/// A report's file: standard output has the table.
fn report_file(path: PathBuf) -> Result<PathBuf, &'static str> {
    match path == Path::new("-") {
        true => Err("a file is named here; standard output has the table"),
        false => Ok(path),
    }
}

/// Runs `tyndall daylight`.
pub fn run(args: &DaylightArgs) -> Result<()> {
    if args.year.is_asked() {
        return daylight_year::run(
            &args.year,
            &Asked {
                scene: &args.scene,
                plan: &args.plan,
                grids: &args.grid.grid,
                files: &args.output,
                scale: args.false_colour.as_ref(),
                form: args.form,
            },
        );
    }
    let start = Instant::now();
    let conditions = conditions(args)?;
    let mut in_use = args.scene.files(&conditions.scene);
    daylight_grid::check(&args.output, &in_use)?;
    if let Some(report) = &args.report {
        in_use.extend(args.points.iter().map(|file| (file.clone(), "the points")));
        in_use.extend(args.output.iter().map(|file| (file.clone(), "the result")));
        output::check_apart("--report", report, &in_use)?;
    }
    // What is wrong with the flags is said before the points are awaited.
    Plan::new(&conditions, &args.plan.overrules())?;
    // The sun of a daylight factor is nobody's: it sets the sky's level, which cancels.
    let left_out: &[&str] = if args.factor { &["sun"] } else { &[] };
    tell::conditions_without(&conditions, left_out);
    let sensors = match args.grid.grid.is_empty() {
        true => None,
        false => Some(args.grid.sensors(&conditions)?),
    };
    if let Some(sensors) = &sensors {
        daylight_grid::tell(sensors);
    }
    let mut meter = Meter {
        conditions: &conditions,
        backend: machine::open(args.backend.wanted())?,
        overrules: args.plan.overrules(),
        goal: args.plan.goal(),
        limits: args.memory.limits(),
        done: Done::default(),
    };
    let prepared = ("prepare".to_owned(), start.elapsed().as_secs_f64());
    meter.done.stages.push(prepared);
    let as_what = As::table_or(args.form);
    let result = match (&sensors, &args.points) {
        (Some(sensors), _) => {
            let grid = Grid {
                specs: &args.grid.grid,
                sensors,
                is_factor: args.factor,
                scale: args.false_colour.as_ref(),
                files: &args.output,
                as_what,
            };
            daylight_grid::run(&grid, &mut meter)
        }
        (None, points) => {
            let strict = args.strict;
            let points = points.as_deref().unwrap_or(Path::new("-"));
            meter.run(points, Form { as_what, strict }).map(drop)
        }
    };
    let done = &meter.done;
    tell::stages(&done.stages);
    if let Some(path) = &args.report {
        output::report::write(path, &report(&conditions, done, result.as_ref().err()))?;
    }
    result
}

/// The scene at its moment, seen by one point in its origin: each piece of points takes that one's place.
fn conditions(args: &DaylightArgs) -> Result<Conditions> {
    // Nothing is seen by it, and no scene need have one.
    let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0);
    let request = Request {
        camera: CameraChoice::Given(camera),
        ..args.scene.request()
    };
    let origin = Receiver::new(DVec3::ZERO, DVec3::Y)?;
    let mut scene = args.scene.load()?;
    if !args.grid.grid.is_empty() {
        assumed::reflectances(&mut scene);
    }
    let scene = match args.factor {
        true => factor::overcast(scene, args.scene.sky())?,
        false => scene,
    };
    Conditions::new(scene, &request)?.seen_from(View::of_points([origin]))
}

/// What was done, as far as it went.
fn report(conditions: &Conditions, done: &Done, error: Option<&Error>) -> serde_json::Value {
    let first = done.first.as_ref();
    json!({
        "schema": 1,
        "record": first.map(|(record, _, _)| record),
        "warnings": conditions.warnings,
        "plan": first.map(|(_, plan, _)| plan),
        "points": done.points,
        "error": error.map(Error::to_string),
        "stages": work::stages_json(&done.stages),
        "render_seconds": done.seconds,
        "work": first.map(|(_, _, work)| work),
    })
}
