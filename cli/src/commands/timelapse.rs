//! `tyndall timelapse`: frames over a range of times.

use crate::arguments::check::CheckArgs;
use crate::arguments::memory::MemoryArgs;
use crate::arguments::picture::PictureArgs;
use crate::arguments::scene::{PlanArgs, ViewArgs};
use crate::commands::timelapse_film::{self, FilmArgs};
use crate::machine;
use crate::progress::duration;
use crate::signals;
use crate::tables::stdout;
use crate::tell;
use clap::Args;
use serde_json::json;
use std::ffi::OsString;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Instant;
use tyndall::Result;
use tyndall::backend::check::Check;
use tyndall::backend::choose::choose;
use tyndall::backend::{Backend, Limits, Step};
use tyndall::conditions::{Conditions, Request};
use tyndall::effect::Kept;
use tyndall::ephemeris::Site;
use tyndall::ephemeris::civil::{self, Reading};
use tyndall::error::Error;
use tyndall::frame::Frame;
use tyndall::output::{self, atomic};
use tyndall::plan::Plan;
use tyndall::scene::Scene;
use tyndall::task::Task;
use tyndall::timelapse::cluster;
use tyndall::timelapse::plan::{self, ExposurePlan, FrameLine, Header, Reader};
use tyndall::timelapse::resume::Outputs;
use tyndall::timelapse::select::{Only, Shard};
use tyndall::timelapse::template::{self, Template};
use tyndall::timelapse::when::{self, Count, Every, Observer, When};
use tyndall::timelapse::{Asked, Sequence};
use tyndall::warning::Warning;

/// Make frames over a range of times, without a flicker and without a lost frame
#[derive(Debug, Args)]
#[command(after_help = "\
Ends are times as --time takes them, times of day with --date, or what the sun does on --date: astronomical-dawn, nautical-dawn, civil-dawn, \
sunrise, solar-noon, sunset, civil-dusk, nautical-dusk, astronomical-dusk, solar-midnight, each with an offset such as -20m.\n\n\
Examples:\n  \
tyndall timelapse --date 2026-10-10 --from sunrise-20m --to sunset+40m --every 2m --exposure auto -o 'out/day_{frame:04}.exr'\n  \
tyndall timelapse scene.toml --date 2026-01-01 --from solar-noon --to 2026-12-31 --every 1d -o 'out/noon_####.png'\n  \
tyndall timelapse scene.toml --from 2026-06-21T18:00 --to 2026-06-21T22:00 --frames 240 --shard 2/16 -o 'out/dusk_%04d.exr'")]
pub struct TimelapseArgs {
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    plan: PlanArgs,
    #[command(flatten)]
    picture: PictureArgs,
    #[command(flatten)]
    memory: MemoryArgs,
    /// The first frame's time, or what the sun does: sunrise-20m
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    from: String,
    /// The last frame's time at the latest; what the sun does before --from is that of the next day
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    to: String,
    /// The date of what the sun does, and of times of day [default: that of the other end, or of the scene]
    #[arg(long, value_name = "YYYY-MM-DD")]
    date: Option<String>,
    /// The time from frame to frame: 30s, 5m, 24h; or 1d and 1w, which keep the clock's time, or the sun's event
    #[arg(long, value_name = "STEP", value_parser = every, required_unless_present = "frames")]
    every: Option<Every>,
    /// So many frames, with one at each end
    #[arg(long, value_name = "N", conflicts_with = "every")]
    frames: Option<u64>,
    /// The frames' files, by their ending .png, .jpg, .exr or .hdr, with {frame:04}, #### or %04d for the index; may be repeated
    #[arg(short, long, value_name = "FILE", required = true)]
    output: Vec<String>,
    /// The index of the first frame
    #[arg(long, value_name = "N", default_value_t = 1)]
    start_number: u64,
    /// Look after these frames alone: indices and ranges, 2,4,10-20, or missing, those of which there is no file
    #[arg(long, value_name = "LIST|missing", value_parser = only)]
    only: Option<Only>,
    /// Look after one of N equal shares of the frames
    #[arg(long, value_name = "I/N", value_parser = shard)]
    shard: Option<Shard>,
    #[command(flatten)]
    check: CheckArgs,
    #[command(flatten)]
    film: FilmArgs,
    /// Say what would be done, how long it would take and how much room, and write nothing
    #[arg(long)]
    dry_run: bool,
    /// Print what was done as JSON
    #[arg(long)]
    json: bool,
}

/// Renders what is not there yet.
pub fn run(args: &TimelapseArgs) -> Result<()> {
    let stop = signals::asked_to_end();
    let outputs = args.output.iter().map(|text| Template::new(text));
    let outputs: Vec<Template> = outputs.collect::<Result<_>>()?;
    Outputs::new(outputs.clone())?;
    let formats = outputs.iter().map(Template::format);
    let formats = formats.collect::<Result<Vec<_>>>()?;
    args.picture.check(&formats)?;
    if args.plan.within.is_some() {
        return Err(Error::input(
            "--within",
            "each machine would measure another time, and frames would differ",
            "give --quality, or --max-error",
        ));
    }
    let mut scene = args.view.scene.load()?;
    let when = when(args, &scene)?;
    say_when(&when)?;
    // The ends of the command line win over a sun of the file.
    scene.sun = None;
    scene.time = Some(when.text(when.get(0)?));
    let conditions = args.view.conditions_of(scene)?;
    let mut overrules = args.plan.overrules();
    Plan::new(&conditions, &overrules)?;
    output::picture::check_size(&formats, conditions.view.size)?;
    let layers = args.picture.layers(&conditions, &overrules)?;
    let in_use = args.view.scene.files(&conditions.scene);
    let (first, count) = (args.start_number, when.count());
    let plan_file = plan::beside(&outputs[0]);
    output::check_apart("the plan file", &plan_file, &in_use)?;
    let indices = first..first.saturating_add(count);
    template::check_apart(&outputs, &indices, &in_use)?;
    let mut in_use = in_use;
    if let Some(report) = &args.check.report {
        in_use.push((plan_file.clone(), "the plan"));
        output::check_apart("--report", report, &in_use)?;
        template::check_apart(&outputs, &indices, &[(report.clone(), "the report")])?;
        atomic::check(report)?;
        in_use.push((report.clone(), "the report"));
    }
    if !args.dry_run {
        if !args.film.emits() {
            for template in &outputs {
                let folder = template.folder();
                std::fs::create_dir_all(&folder).map_err(|e| Error::writing(&folder, e))?;
                // A link is written through.
                output::check_apart("-o", &template.path(first), &in_use)?;
            }
            output::check_targets(&outputs.iter().map(|o| o.path(first)).collect::<Vec<_>>())?;
        }
        let partial = args.only.is_some() || args.shard.is_some();
        args.film
            .check(&plan_file, &outputs, &indices, partial, &in_use)?;
    }
    let words: Vec<OsString> = std::env::args_os().collect();
    if args.film.emits() {
        return args.film.emit(&conditions.scene.name, &words, count);
    }
    tell::conditions(&conditions);
    let limits = Limits {
        stop: Some(stop),
        ..args.memory.limits()
    };
    let mut backend = machine::open(args.picture.backend.wanted())?;
    if let Some(goal) = args.plan.goal() {
        if matches!(backend, Backend::Gpu(_)) && overrules.method.is_none() {
            return Err(Error::input(
                "--max-error",
                "on a GPU it chooses the method by measured time, which is another on each run, and frames would differ",
                "give --method too, such as --method rectified, or --backend reference",
            ));
        }
        // By a frame in the middle, whichever frames this process renders.
        let middle = conditions.at(&when.text(when.get(count / 2)?))?;
        let bar = tell::bar();
        let step = |step| bar.step(step);
        let chosen = choose(&mut backend, &middle, &overrules, goal, &limits, &step)?;
        drop(bar);
        tell::chosen(&chosen.why);
        overrules = chosen.overrules;
    }
    let usual = Plan::new(&conditions, &overrules)?;
    tell::plan(&usual, &overrules, &backend.describe());
    let warnings = conditions.warnings.clone();
    let sequence = Sequence::new(Asked {
        exposure: args.picture.ev100(&conditions.scene),
        stops: args.picture.stops(),
        conditions,
        when,
        overrules,
        outputs,
        layers,
        space: args.picture.space(),
        first,
        command: command(&words),
    })?;
    let run = Run {
        args,
        sequence: &sequence,
        plan_file: &plan_file,
        limits: &limits,
        warnings: &warnings,
    };
    if args.film.assembles() {
        return run.assemble(&backend);
    }
    if args.dry_run {
        return run.dry(&mut backend);
    }
    let reader = run.planned(&mut backend)?;
    run.render(reader, &mut backend)
}

/// The instants, by the place and the clock of the scene and of the flags.
fn when(args: &TimelapseArgs, scene: &Scene) -> Result<When> {
    if args.view.scene.time.time.is_some() {
        return Err(Error::input(
            "--time",
            "the times of a time-lapse are those between --from and --to",
            "leave it out",
        ));
    }
    let (Some(entry), false) = (&scene.site, args.view.scene.has_given_sun()) else {
        return Err(Error::input(
            &scene.name,
            "it has no place, or a sun that stands still",
            "give --at LAT,LON, and leave out --sun",
        ));
    };
    let site = Site::new(entry.latitude_deg, entry.longitude_deg, entry.elevation)?;
    let request: Request = args.view.scene.request();
    let reading = Reading {
        zone: request.timezone.as_deref().or(entry.timezone.as_deref()),
        site: Some(&site),
        fold: request.fold,
        scale: request.time_scale,
        delta_t: request.delta_t,
    };
    let date = match (&args.date, &scene.time) {
        (Some(text), _) => match civil::date_alone(text)? {
            None => {
                return Err(Error::input(
                    format!("--date {text}"),
                    "it is no date",
                    "write YYYY-MM-DD",
                ));
            }
            date => date,
        },
        // An end that is a time has its own.
        (None, Some(time)) if when::is_of_day(&args.from) && when::is_of_day(&args.to) => {
            let moment = civil::resolve_with(time, &reading)?;
            Some(moment.local().date_naive())
        }
        _ => None,
    };
    let count = match (args.frames, args.every) {
        (Some(frames), _) => Count::Frames(frames),
        (None, Some(every)) => Count::Every(every),
        (None, None) => Count::Frames(1),
    };
    let asked = when::Asked {
        from: &args.from,
        to: &args.to,
        date,
        count,
    };
    let observer = Observer {
        site: &site,
        reading,
        tier: request.tier,
    };
    When::new(&asked, &observer)
}

fn say_when(when: &When) -> Result<()> {
    let ends = [0, when.count() - 1].map(|number| when.get(number));
    let [from, to] = ends;
    let (from, to) = (when.local_text(from?), when.local_text(to?));
    let count = when.count();
    tell::line(
        "frames",
        format!("{count}, from {from} to {to}, {}", when.step()),
    );
    Ok(())
}

/// A run of this process.
struct Run<'a> {
    args: &'a TimelapseArgs,
    sequence: &'a Sequence,
    plan_file: &'a Path,
    limits: &'a Limits<'a>,
    warnings: &'a [Warning],
}

/// What it takes to do some frames.
#[derive(Default)]
struct Work {
    frames: Vec<u64>,
    there: u64,
    /// Predicted, of those frames [s].
    seconds: f64,
}

/// What has come of them.
#[derive(Default)]
struct Done {
    made: u64,
    there: u64,
    /// The frame that is furthest from the reference, if they are measured.
    worst: Option<(u64, Check)>,
    /// What that reference has found that other frames need too.
    kept: Kept,
}

impl Run<'_> {
    /// The plan file, which is written if it is not there.
    fn planned(&self, backend: &mut Backend) -> Result<Reader> {
        if let Some(reader) = self.sequence.planned(self.plan_file, backend)? {
            tell::line("plan", format!("{}, as it was", self.plan_file.display()));
            return Ok(reader);
        }
        let planned = self.plan(backend)?;
        let stopped = || {
            self.limits
                .stop
                .is_some_and(|stop| stop.load(Ordering::Relaxed))
        };
        let lines = self.sequence.lines(&planned).map(|line| match stopped() {
            true => Err(Error::Stopped),
            false => line,
        });
        plan::write(self.plan_file, &planned.header, lines)?;
        tell::line("plan", self.plan_file.display());
        Reader::open(self.plan_file)
    }

    fn plan(&self, backend: &mut Backend) -> Result<tyndall::timelapse::Planned> {
        let bar = tell::bar();
        let mut told = |done: usize, of: usize| {
            let share = done as f64 / of.max(1) as f64;
            bar.step(Step {
                stage: "key frames, for the exposure",
                share,
                turn: None,
            });
        };
        self.sequence.plan(backend, self.limits, &|_| {}, &mut told)
    }

    /// What is to be done of these lines.
    fn work(&self, lines: impl Iterator<Item = Result<FrameLine>>) -> Result<Work> {
        let mut work = Work::default();
        let mut read = 0;
        for line in lines {
            let line = line?;
            read += 1;
            let (only, shard) = (self.args.only.as_ref(), self.args.shard);
            if !self.sequence.is_wanted(line.index, only, shard) {
                continue;
            }
            match self.sequence.outputs().are_of(line.index, &line.key) {
                true => work.there += 1,
                false => {
                    work.frames.push(line.index);
                    work.seconds += line.predicted_seconds;
                }
            }
        }
        let count = self.sequence.when().count();
        if read != count {
            return Err(Error::input(
                self.plan_file.display().to_string(),
                format!("it has {read} frames and speaks of {count}"),
                "delete it, and plan again",
            ));
        }
        Ok(work)
    }

    fn dry(&self, backend: &mut Backend) -> Result<()> {
        let (header, work) = match self.sequence.planned(self.plan_file, backend)? {
            Some(reader) => (reader.header.clone(), self.work(reader)?),
            None => {
                let planned = self.plan(backend)?;
                let work = self.work(self.sequence.lines(&planned))?;
                (planned.header, work)
            }
        };
        let odd = self.sequence.odd_exposures(&header.exposure)?;
        tell::warnings(&odd);
        let bytes = self.sequence.bytes() * work.frames.len() as u64;
        self.report(&json!({
            "schema": 1,
            "plan": header,
            "to_make": work.frames.len(),
            "there": work.there,
            "predicted_seconds": work.seconds,
            "bytes_at_most": bytes,
            "warnings": self.warnings.iter().chain(&odd).collect::<Vec<_>>(),
        }))?;
        if self.args.json {
            return Ok(());
        }
        let Work { frames, there, .. } = &work;
        let (count, seconds) = (frames.len(), duration(work.seconds));
        stdout::print(format!(
            "to make      {count} of {} frames; {there} are there\n\
             exposure     {}\n\
             time         about {seconds} on this machine\n\
             disk         at most {:.3} GiB\n",
            header.frames,
            exposure(&header),
            bytes as f64 / f64::from(1 << 30),
        ))
    }

    fn render(&self, reader: Reader, backend: &mut Backend) -> Result<()> {
        let start = Instant::now();
        tell::line("exposure", exposure(&reader.header));
        let odd = self.sequence.odd_exposures(&reader.header.exposure)?;
        tell::warnings(&odd);
        let work = self.work(reader)?;
        self.sequence.outputs().sweep(work.frames.iter().copied());
        tell::line(
            "to make",
            format!(
                "{} frames, about {}; {} are there",
                work.frames.len(),
                duration(work.seconds),
                work.there
            ),
        );
        let mut done = Done {
            there: work.there,
            ..Done::default()
        };
        let ended = self.frames(&work, backend, &mut done);
        let made = done.made;
        if ended.is_err() {
            tell::line(
                "made",
                format!("{made} frames, which are whole; the same command goes on"),
            );
        }
        ended?;
        let seconds = start.elapsed().as_secs_f64();
        tell::line("made", format!("{made} frames in {}", duration(seconds)));
        let film = self.film()?;
        let worst = done.worst.as_ref();
        self.report(&json!({
            "schema": 1,
            "plan": self.plan_file.to_string_lossy(),
            "made": made,
            "there": done.there,
            "seconds": seconds,
            "warnings": self.warnings.iter().chain(&odd).collect::<Vec<_>>(),
            "check": worst.map(|(frame, check)| json!({ "worst_frame": frame, "check": check })),
            "assembled": film,
        }))
    }

    /// Writes and prints what was done, as it was asked for.
    fn report(&self, report: &serde_json::Value) -> Result<()> {
        if let Some(path) = &self.args.check.report {
            output::report::write(path, report)?;
        }
        match self.args.json {
            true => stdout::print_json(report),
            false => Ok(()),
        }
    }

    /// Measures a frame, if that was asked for, and keeps the worst.
    ///
    /// # Errors
    /// Those of rendering by the reference; [`Error::Failed`] for a frame that is further off than it may be.
    fn measure(&self, index: u64, seen: &Conditions, frame: &Frame, done: &mut Done) -> Result<()> {
        let checked = (seen, self.sequence.overrules());
        let check = &self.args.check;
        let found = tell::watched(self.limits.stop, |task| {
            check.measure(checked, frame, &done.kept, task)
        })?;
        let Some(found) = found else {
            return Ok(());
        };
        let error = |check: &Check| check.picture().relative_rmse;
        tell::line(
            "check",
            format!("frame {index}: relative RMSE {:.3e}", error(&found)),
        );
        check.judge(&format!("frame {index}"), &found)?;
        let is_worse = |(_, worst): &(u64, Check)| error(&found).total_cmp(&error(worst)).is_gt();
        if done.worst.as_ref().is_none_or(is_worse) {
            done.worst = Some((index, found));
        }
        Ok(())
    }

    /// Film, sheet, curves and page, of frames that are all there.
    fn film(&self) -> Result<serde_json::Value> {
        let make = |task: Task| self.args.film.make(self.plan_file, self.warnings, task);
        tell::watched(self.limits.stop, make)
    }

    /// The same, once they are known to be there and to be those of this command.
    fn assemble(&self, backend: &Backend) -> Result<()> {
        let reader = self.sequence.planned(self.plan_file, backend)?;
        let left = match reader {
            Some(reader) => self.work(reader)?.frames,
            // Frames without a plan, or with another one, are of other settings.
            None => (0..self.sequence.when().count())
                .map(|number| self.args.start_number + number)
                .collect(),
        };
        if !left.is_empty() {
            let (count, of) = (left.len(), self.sequence.when().count());
            let list = Only::text(left);
            stdout::print(format!("--only {list}\n"))?;
            return Err(Error::Unfinished {
                problem: format!("{count} of {of} frames are missing, or of other settings"),
                remedy: format!("make them with --only {list}, and assemble again"),
            });
        }
        let made = self.film()?;
        self.report(&json!({ "schema": 1, "assembled": made }))
    }

    fn frames(&self, work: &Work, backend: &mut Backend, done: &mut Done) -> Result<()> {
        let start = Instant::now();
        let bar = tell::bar();
        let (mut predicted, mut todo) = (0.0, work.frames.iter().copied().peekable());
        let plan = self.sequence.planned(self.plan_file, backend)?;
        let plan = plan.ok_or_else(|| {
            Error::failed(
                format!(
                    "{}: another run has put its plan in the place of this one's",
                    self.plan_file.display()
                ),
                "give its frames other names, or wait for its end",
            )
        })?;
        for line in plan {
            let line = line?;
            if todo.next_if_eq(&line.index).is_none() {
                continue;
            }
            // Another process may have made it in the meantime.
            if self.sequence.outputs().are_of(line.index, &line.key) {
                done.there += 1;
                continue;
            }
            let left = |predicted: f64| match predicted > 0.0 {
                true => start.elapsed().as_secs_f64() * (work.seconds / predicted - 1.0),
                false => work.seconds,
            };
            let before = predicted;
            let words = format!(
                "frame {}, {} of {}, {} left",
                line.index,
                done.made + 1,
                work.frames.len(),
                duration(left(before))
            );
            let share = |share: f64| (before + share * line.predicted_seconds) / work.seconds;
            bar.show(&words, share(0.0));
            let progress = |step: Step| {
                if step.stage == tyndall::backend::PICTURE {
                    bar.show(&words, share(step.share));
                }
            };
            let begun = Instant::now();
            let mut accept = |seen: &Conditions, frame: &Frame| {
                bar.apart(|| self.measure(line.index, seen, frame, done))
            };
            self.sequence
                .render_if(&line, backend, self.limits, &progress, &mut accept)?;
            done.made += 1;
            predicted += line.predicted_seconds;
            if bar.takes_lines() {
                bar.spoke();
                tell::line(
                    "frame",
                    format!(
                        "{}, {} of {}, {:.2} s; {} left",
                        line.index,
                        done.made,
                        work.frames.len(),
                        begun.elapsed().as_secs_f64(),
                        duration(left(predicted))
                    ),
                );
            }
        }
        Ok(())
    }
}

/// How a sequence is exposed, in words.
fn exposure(header: &Header) -> String {
    match &header.exposure {
        ExposurePlan::Fixed(ev100) => format!("EV100 {ev100:.2}"),
        ExposurePlan::Curve(frames) => {
            let all = frames.iter().map(|frame| frame.ev100);
            let (least, most) = (
                all.clone().fold(f64::INFINITY, f64::min),
                all.fold(f64::NEG_INFINITY, f64::max),
            );
            let count = frames.len();
            format!("EV100 {least:.2} to {most:.2}, a curve through {count} key frames")
        }
    }
}

/// The command line that makes the frames of the whole sequence: without what chooses a part of it, how it is told, and what is made of
/// them.
fn command(arguments: &[OsString]) -> String {
    const PARTS: [(&str, bool); 11] = [
        ("--check", true),
        ("--fail-above", true),
        ("--report", true),
        ("--only", true),
        ("--quiet", false),
        ("-q", false),
        ("--verbose", false),
        ("-v", false),
        ("--shard", true),
        ("--dry-run", false),
        ("--json", false),
    ];
    let words = arguments.iter().skip(1);
    let words: Vec<String> = words.map(|w| w.to_string_lossy().into_owned()).collect();
    let words = timelapse_film::without(&words, &PARTS);
    let words = timelapse_film::without(&words, &timelapse_film::FLAGS);
    format!("tyndall {}", cluster::shell_line(&words))
}

fn every(text: &str) -> Result<Every, String> {
    text.parse().map_err(|e: Error| e.remedy())
}

fn only(text: &str) -> Result<Only, String> {
    text.parse().map_err(|e: Error| e.remedy())
}

fn shard(text: &str) -> Result<Shard, String> {
    text.parse().map_err(|e: Error| e.remedy())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_of_a_whole_sequence() {
        let of = |words: &[&str]| command(&words.iter().map(OsString::from).collect::<Vec<_>>());
        let words = [
            "/usr/bin/tyndall",
            "timelapse",
            "my scene.toml",
            "--shard",
            "1/3",
            "-o",
            "out/{frame:04}.exr",
            "--only=2",
            "--dry-run",
            "--film",
            "a film.mp4",
            "--fps=25",
            "--assemble",
            "--from",
            "sunrise-20m",
        ];
        assert_eq!(
            of(&words),
            "tyndall timelapse 'my scene.toml' -o 'out/{frame:04}.exr' --from sunrise-20m"
        );
    }
}
