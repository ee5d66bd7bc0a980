//! `tyndall daylight`: illuminance at points.

use crate::arguments::backend::BackendFlag;
use crate::arguments::form::FormArgs;
use crate::arguments::memory::MemoryArgs;
use crate::arguments::scene::{PlanArgs, SceneArgs};
use crate::machine;
use crate::tables::daylight_batch::{Done, Meter};
use crate::tables::printer::{As, Form, Tally};
use crate::tables::work;
use crate::tell;
use clap::Args;
use glam::DVec3;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use tyndall::conditions::{CameraChoice, Conditions, Receiver, Request, View};
use tyndall::output;
use tyndall::plan::Plan;
use tyndall::scene::Camera;
use tyndall::{Error, Result};

/// Illuminance at points: what light meters would read there
#[derive(Debug, Args)]
#[command(after_help = "\
The points are a CSV with the columns x, y, z in metres, in the scene's axes (+Y up), and perhaps nx, ny, nz: the direction that \
the meter faces, of any length; it looks up where they are left out. Every row comes out again, in its order, with its \
illuminance in lux: `illuminance` is the whole, `sun` and `sky` what comes straight from them, `indirect` what surfaces and the \
ground send on; a scene with lamps has `lights` too, what comes straight from them.\n\n\
Examples:\n  \
tyndall daylight room.glb --at 48.8584,2.2945 --time 2026-06-21T12:00 --points desk.csv\n  \
tyndall daylight room.glb --sun 180,30 --sky cie:1 --points desk.csv --csv > lux.csv\n  \
seq 0 0.5 4 | awk 'BEGIN{print \"x,y,z\"}{print $1\",0.8,0\"}' | tyndall daylight room.glb --sun 180,30 --points -")]
pub struct DaylightArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// A CSV of points: x, y, z in metres and perhaps nx, ny, nz, one point a row; - is stdin
    #[arg(long, value_name = "FILE")]
    points: PathBuf,
    /// Stop at the first broken row, and print nothing
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    plan: PlanArgs,
    /// What computes: auto uses a hardware adapter, else the CPU reference; gpu also accepts a software adapter
    #[arg(long, value_name = "BACKEND", default_value = "auto", value_enum)]
    backend: BackendFlag,
    /// Write what was done to a JSON file
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    memory: MemoryArgs,
    #[command(flatten)]
    form: FormArgs,
}

/// Runs `tyndall daylight`.
pub fn run(args: &DaylightArgs) -> Result<()> {
    let start = Instant::now();
    let conditions = conditions(&args.scene)?;
    if let Some(report) = &args.report {
        let mut in_use = args.scene.files(&conditions.scene);
        in_use.push((args.points.clone(), "the points"));
        output::check_apart("--report", report, &in_use)?;
    }
    // What is wrong with the flags is said before the points are awaited.
    Plan::new(&conditions, &args.plan.overrules())?;
    tell::conditions(&conditions);
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
    let form = Form {
        as_what: As::table_or(args.form),
        strict: args.strict,
    };
    let result = meter.run(&args.points, form);
    let done = &meter.done;
    tell::stages(&done.stages);
    if let Some(path) = &args.report {
        output::report::write(path, &report(&conditions, done, result.as_ref()))?;
    }
    result.map(drop)
}

/// The scene at its moment, seen by one point in its origin: each piece of points takes that one's place.
fn conditions(scene: &SceneArgs) -> Result<Conditions> {
    // Nothing is seen by it, and no scene need have one.
    let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0);
    let request = Request {
        camera: CameraChoice::Given(camera),
        ..scene.request()
    };
    let origin = Receiver::new(DVec3::ZERO, DVec3::Y)?;
    Conditions::new(scene.load()?, &request)?.seen_from(View::of_points([origin]))
}

/// What was done, as far as it went.
fn report(
    conditions: &Conditions,
    done: &Done,
    result: Result<&Tally, &Error>,
) -> serde_json::Value {
    let first = done.first.as_ref();
    json!({
        "schema": 1,
        "record": first.map(|(record, _, _)| record),
        "warnings": conditions.warnings,
        "plan": first.map(|(_, plan, _)| plan),
        "points": done.points,
        "error": result.err().map(Error::to_string),
        "stages": work::stages_json(&done.stages),
        "render_seconds": done.seconds,
        "work": first.map(|(_, _, work)| work),
    })
}
