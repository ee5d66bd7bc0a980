//! `tyndall render`: a picture for a place, a date and a time.

use crate::commands::render_args::RenderArgs;
use crate::commands::render_range;
use crate::machine;
use crate::signals;
use crate::tables::{stdout, work};
use crate::targets::Targets;
use crate::tell;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use tyndall::Result;
use tyndall::backend::check::Check;
use tyndall::backend::choose::choose;
use tyndall::backend::convergence::Convergence;
use tyndall::backend::{Limits, Rendered};
use tyndall::colour::{exposure, luminance};
use tyndall::effect::Kept;
use tyndall::error::Error;
use tyndall::frame::Frame;
use tyndall::output::{self, Format};
use tyndall::plan::Plan;
use tyndall::warning::Warning;

/// Renders.
pub fn run(args: &RenderArgs) -> Result<()> {
    if let Some(until) = &args.until {
        return render_range::run(args, until);
    }
    let start = Instant::now();
    let files = if args.output.is_empty() {
        vec![PathBuf::from("tyndall.png"), PathBuf::from("tyndall.exr")]
    } else {
        args.output.clone()
    };
    let prints = args.json.then_some("what --json prints");
    let targets = Targets::check(&files, args.format, prints)?;
    let files = targets.files();
    args.picture.check(&targets.formats())?;
    let shown = |format: &Format| format.is_for_screens();
    if args.false_colour.is_some() && !targets.formats().iter().any(shown) {
        return Err(Error::input(
            "--false-colour",
            "no -o has a format that it concerns",
            "add -o with a name in .png or .jpg, or leave it out",
        ));
    }
    let conditions = args.view.conditions()?;
    output::picture::check_size(&targets.formats(), conditions.view.size)?;
    let layers = args.picture.layers(&conditions, &args.plan.overrules())?;
    let mut in_use = args.view.scene.files(&conditions.scene);
    for file in files {
        output::check_apart("-o", file, &in_use)?;
    }
    if let Some(report) = &args.check.report {
        in_use.extend(files.iter().map(|file| (file.clone(), "the picture")));
        output::check_apart("--report", report, &in_use)?;
    }
    // What is wrong with the flags is said before anything is measured.
    Plan::new(&conditions, &args.plan.overrules())?;
    tell::conditions(&conditions);
    let stop = signals::asked_to_end();
    let limits = Limits {
        stop: Some(stop),
        ..args.memory.limits()
    };
    let mut overrules = args.plan.overrules();
    let mut stages = vec![("prepare".to_owned(), start.elapsed().as_secs_f64())];
    let opening = Instant::now();
    let mut backend = machine::open(args.picture.backend.wanted())?;
    stages.push(("device".to_owned(), opening.elapsed().as_secs_f64()));
    let planning = Instant::now();
    if let Some(goal) = args.plan.goal() {
        let bar = tell::bar();
        let step = |step| bar.step(step);
        let chosen = choose(&mut backend, &conditions, &overrules, goal, &limits, &step);
        drop(bar);
        let chosen = chosen.inspect_err(|error| say_kept(error, files))?;
        tell::chosen(&chosen.why);
        overrules = chosen.overrules;
    }
    let plan = Plan::new(&conditions, &overrules)?;
    tell::plan(&plan, &overrules, &backend.describe());
    stages.push(("plan".to_owned(), planning.elapsed().as_secs_f64()));

    let bar = tell::bar();
    let rendered = backend.render(&plan, &limits, &|step| bar.step(step));
    drop(bar);
    let mut rendered = rendered.inspect_err(|error| say_kept(error, files))?;

    let converging = Instant::now();
    let convergence = tell::watched(Some(stop), |task| {
        Convergence::of(&plan, pixels_to_converge(&rendered.frame), task)
    });
    let convergence = convergence.inspect_err(|error| say_kept(error, files))?;
    let converging = converging.elapsed();
    let writing = Instant::now();
    let given = args.picture.ev100(&conditions.scene);
    let metered = metered(&rendered.frame);
    // A black picture is black at any exposure.
    let metered_for = metered.map(|ev100| ev100 - args.picture.stops());
    let ev100 = given.or(metered_for).unwrap_or(0.0);
    let odd = match (given, metered) {
        (Some(_), Some(_)) => None,
        _ => {
            let overrules = args.plan.overrules();
            conditions.odd_exposure(metered, "this picture", &overrules.lights_left_out())
        }
    };
    let record = &mut rendered.frame.record;
    backend.record(&plan, record);
    record.set("exposure_ev100", ev100);
    let space = args.picture.space();
    targets.write(|path, format| match (format, &args.false_colour) {
        (Format::Png | Format::Jpeg, Some(scale)) => {
            let scale = scale.clone().named("luminance", "cd/m2");
            let shown = output::false_colour::picture(&rendered.frame, &scale);
            let size = [shown.width(), shown.height()].map(|side| side as u32);
            output::picture::write_shown(path, format, size, &shown.bytes(), &[])
        }
        _ => output::picture::write(path, format, &rendered.frame, &space, &layers, ev100),
    })?;
    stages.extend(work::stages(&backend, &rendered));
    if convergence.is_some() {
        stages.push(("convergence".to_owned(), converging.as_secs_f64()));
    }
    stages.push(("write".to_owned(), writing.elapsed().as_secs_f64()));
    tell::rendered(&rendered, ev100, &stages);
    tell::warnings(odd.as_slice());
    if let Some(convergence) = &convergence {
        tell::convergence(convergence);
    }
    tell::files(files);
    let checked = (&conditions, &args.plan.overrules());
    let check = tell::watched(Some(stop), |task| {
        args.check
            .measure(checked, &rendered.frame, &Kept::default(), task)
    })?;
    if let Some(check) = &check {
        tell::check(&work::check_lines(check));
    }
    let work = work::details(&backend, &rendered);
    let report = report(
        &plan,
        &rendered,
        work,
        &stages,
        (files, &layers[..]),
        (check.as_ref(), convergence.as_ref()),
        odd.as_ref(),
    );
    if let Some(path) = &args.check.report {
        output::report::write(path, &report)?;
    }
    if args.json {
        stdout::print_json(&report)?;
    }
    check.map_or(Ok(()), |check| args.check.judge("the picture", &check))
}

/// Says what is left of work that was stopped.
fn say_kept(error: &Error, files: &[PathBuf]) {
    if let Error::Stopped = error {
        let names: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
        let names = names.join(", ");
        tell::line(
            "kept",
            format!("nothing of this picture; not written: {names}"),
        );
    }
}

/// On how many pixels it is measured how far points of the sun's disc are from converged: few against the picture's own.
fn pixels_to_converge(frame: &Frame) -> usize {
    (frame.pixels() / 32).clamp(64, 1024)
}

/// The exposure that the picture's own luminances call for [EV100]; nothing for a black one.
fn metered(frame: &Frame) -> Option<f64> {
    exposure::auto((0..frame.pixels()).map(|i| luminance(frame.picture(i))))
}

fn report(
    plan: &Plan,
    rendered: &Rendered,
    work: serde_json::Value,
    stages: &[(String, f64)],
    (files, layers): (&[PathBuf], &[&str]),
    (check, convergence): (Option<&Check>, Option<&Convergence>),
    odd: Option<&Warning>,
) -> serde_json::Value {
    let warnings: Vec<&Warning> = plan.conditions.warnings.iter().chain(odd).collect();
    json!({
        "schema": 1,
        "record": rendered.frame.record,
        "warnings": warnings,
        "plan": tell::plan_json(plan),
        "size": [rendered.frame.width, rendered.frame.height],
        "refined_pixels": rendered.refined,
        "notes": rendered.notes,
        "stages": work::stages_json(stages),
        "render_seconds": rendered.elapsed.as_secs_f64(),
        "work": work,
        "lamp_rays": work::paid(rendered),
        "check": check,
        "convergence": convergence,
        "layers": layers,
        "files": files.iter().map(|file| file.to_string_lossy()).collect::<Vec<_>>(),
    })
}
