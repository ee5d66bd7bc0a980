//! `tyndall accuracy --effect shafts`: what accuracy costs in the air, method by method.

use crate::arguments::form::FormArgs;
use crate::arguments::hinted::hinted;
use crate::arguments::scene::{METHODS, MethodFlag, method};
use crate::commands::study::{StudyArgs, by_pixels, error_over_time};
use crate::plots::plot::{Plot, Point, Series};
use crate::tables::columns::{Columns, columns, print};
use crate::tables::stdout::Out;
use crate::tell;
use clap::Args;
use glam::{DVec3, Vec3};
use serde_json::json;
use std::path::{Path, PathBuf};
use tyndall::backend::gpu::{Choice, Gpu};
use tyndall::colour::{display, exposure, luminance};
use tyndall::effect::Method;
use tyndall::output::png;
use tyndall::studies::pareto;
use tyndall::studies::shafts::{Outcome, cost_at, measure, sweeps, truth};
use tyndall::{Error, Result};

/// The flags of the study of shafts.
#[derive(Args, Debug)]
pub struct ShaftsArgs {
    /// With --effect shafts: only this method, besides march, with which all are compared
    #[arg(long, value_name = "METHOD", default_value = "auto", value_parser = hinted(method, METHODS), hide_possible_values = true)]
    method: MethodFlag,
    /// With --effect shafts: a folder for pictures: the truth, the games' usual march, ours, and their errors
    #[arg(long, value_name = "FOLDER")]
    pictures: Option<PathBuf>,
}

/// The methods that the summary and the pictures put beside march; virtual planes are others' as march is.
const OURS: [Method; 3] = [Method::Rectified, Method::Epipolar, Method::Prefiltered];

/// Scenes of the study unless others are named.
const SCENES: [&str; 3] = ["slats", "colonnade", "forest"];

/// Their size [pixels].
const SIZE: [u32; 2] = [512, 512];

/// What a frame of a setting takes in one of them on a software adapter of two cores [s]; a graphics card takes a hundredth.
const SECONDS: f64 = 2.5;

/// All measurements of a scene.
struct Study {
    scene: String,
    size: [u32; 2],
    truth: Vec<Vec3>,
    outcomes: Vec<Outcome>,
    by_time: Vec<bool>,
    by_reads: Vec<bool>,
}

/// Runs the study.
pub fn run(flags: &StudyArgs, own: &ShaftsArgs, form: FormArgs) -> Result<()> {
    // The best there is, of software too.
    let mut gpu = Gpu::open(Choice::Any)?;
    let adapter = &gpu.device().adapter;
    let adapter = format!("{}, {}", adapter.name, adapter.kind.words());
    let mut extra = vec![("shadow.resolution".to_owned(), 4096.0)];
    extra.extend(flags.set.iter().cloned());
    let mut studies = Vec::new();
    let is_wanted = |method| {
        let only = own.method.0;
        only.is_none_or(|only| method == only || method == Method::March)
    };
    let trials = || -> Vec<_> {
        let all = sweeps().into_iter();
        all.filter(|trial| is_wanted(trial.method)).collect()
    };
    let scenes = flags.scenes(&SCENES, SIZE)?;
    let mut watch = flags.watch(&scenes, trials().len(), by_pixels(&scenes, (SIZE, SECONDS)));
    for (scene, conditions) in scenes {
        watch.next(&scene, "the reference");
        let truth = truth(&conditions)?;
        let mut outcomes = Vec::new();
        for trial in trials() {
            watch.next(&scene, &trial.words());
            let frames = flags.frames;
            outcomes.push(measure(
                &mut gpu,
                &conditions,
                &trial,
                &extra,
                &truth,
                frames,
            )?);
        }
        let front = |cost: fn(&Outcome) -> f64| {
            let pairs: Vec<[f64; 2]> = outcomes
                .iter()
                .map(|o| [cost(o), o.relative_rmse])
                .collect();
            pareto::front(&pairs)
        };
        let study = Study {
            scene,
            size: conditions.view.size,
            by_time: front(milliseconds),
            by_reads: front(reads),
            truth,
            outcomes,
        };
        watch.apart(|| {
            flags.save(&study.scene, || plot(&study, &adapter))?;
            match &own.pictures {
                Some(folder) => pictures(&study, folder),
                None => Ok(()),
            }
        })?;
        studies.push(study);
    }
    drop(watch);
    let rows = studies
        .iter()
        .flat_map(|study| rows(study, &adapter))
        .collect();
    print(form, rows, |out| {
        table(out, &studies, &adapter, flags.frames)
    })
}

fn milliseconds(outcome: &Outcome) -> f64 {
    1e3 * outcome.in_scatter.as_secs_f64()
}

fn reads(outcome: &Outcome) -> f64 {
    outcome.reads + outcome.nodes
}

/// A cost of march at the error of another method's setting, over that setting's cost.
fn ratio(study: &Study, outcome: &Outcome, cost: fn(&Outcome) -> f64) -> f64 {
    let march = study.outcomes.iter().filter(|o| {
        o.trial.method == Method::March && o.trial.set.iter().all(|(knob, _)| *knob == "steps")
    });
    let curve: Vec<[f64; 2]> = march.map(|o| [cost(o), o.relative_rmse]).collect();
    cost_at(&curve, outcome.relative_rmse) / cost(outcome)
}

fn rows(study: &Study, adapter: &str) -> Vec<Columns> {
    let marks = study.by_time.iter().zip(&study.by_reads);
    study
        .outcomes
        .iter()
        .zip(marks)
        .map(|(o, (by_time, by_reads))| {
            let passes: serde_json::Map<_, _> = o
                .passes
                .iter()
                .map(|(name, time)| (name.to_string(), json!(1e3 * time.as_secs_f64())))
                .collect();
            columns([
                ("scene", json!(study.scene)),
                ("adapter", json!(adapter)),
                ("width", json!(study.size[0])),
                ("height", json!(study.size[1])),
                ("setting", json!(o.trial.words())),
                ("method", json!(o.trial.method.name())),
                ("baseline", json!(o.trial.baseline)),
                ("in_scatter_ms", json!(milliseconds(o))),
                (
                    "passes_ms",
                    json!(serde_json::Value::Object(passes).to_string()),
                ),
                ("shadow_maps_ms", json!(1e3 * o.maps.as_secs_f64())),
                ("reads_per_pixel", json!(o.reads)),
                ("nodes_per_pixel", json!(o.nodes)),
                ("relative_rmse", json!(o.relative_rmse)),
                ("percentile_99", json!(o.percentile_99)),
                ("bias", json!(o.bias)),
                ("hdr_flip", json!(o.flip)),
                ("front_by_time", json!(by_time)),
                ("front_by_reads", json!(by_reads)),
                (
                    "march_time_at_equal_error",
                    json!(ratio(study, o, milliseconds)),
                ),
                ("march_reads_at_equal_error", json!(ratio(study, o, reads))),
            ])
        })
        .collect()
}

fn table(out: &mut Out, studies: &[Study], adapter: &str, frames: usize) -> Result<()> {
    out.line(&format!(
        "{adapter}; medians of {frames} frames; a point sun; T, R: on the front of error by time, by reads and nodes"
    ))?;
    out.line("march/: what march costs at the same error, in time and in reads, over what this costs; * the games' usual setting")?;
    for study in studies {
        let [w, h] = study.size;
        let maps = study
            .outcomes
            .first()
            .map_or(0.0, |o| 1e3 * o.maps.as_secs_f64());
        out.line("")?;
        out.line(&format!(
            "{}, {w} x {h}; shadow maps {maps:.0} ms, not included",
            study.scene
        ))?;
        out.line(&format!(
            "{:<66}{:>9}{:>8}{:>8}{:>10}{:>9}{:>10}{:>9}    {:>8}{:>8}",
            "setting",
            "ms",
            "reads",
            "nodes",
            "rel. RMSE",
            "99 %",
            "bias",
            "FLIP",
            "march/ms",
            "reads"
        ))?;
        for (i, o) in study.outcomes.iter().enumerate() {
            let mark = |on: bool, letter| if on { letter } else { ' ' };
            out.line(&format!(
                "{:<65}{}{:>9.1}{:>8.1}{:>8.1}{:>10.5}{:>9.4}{:>+10.5}{:>9.5} {}{} {:>8.1}{:>8.1}",
                o.trial.words(),
                mark(o.trial.baseline, '*'),
                milliseconds(o),
                o.reads,
                o.nodes,
                o.relative_rmse,
                o.percentile_99,
                o.bias,
                o.flip,
                mark(study.by_time[i], 'T'),
                mark(study.by_reads[i], 'R'),
                ratio(study, o, milliseconds),
                ratio(study, o, reads),
            ))?;
        }
    }
    out.line("")?;
    out.line("march at equal error, best of the settings within 1 %: time / reads")?;
    let mut best: Vec<[f64; 2]> = Vec::new();
    for study in studies {
        let mut line = format!("{:<12}", study.scene);
        let mut most = [0.0_f64; 2];
        for method in OURS {
            let good = |cost: fn(&Outcome) -> f64| {
                let good = study
                    .outcomes
                    .iter()
                    .filter(|o| o.trial.method == method && o.relative_rmse <= 0.01);
                good.map(|o| ratio(study, o, cost)).fold(0.0, f64::max)
            };
            let found = [good(milliseconds), good(reads)];
            if found[0] > 0.0 {
                line += &format!("  {} {:.1} / {:.1}", method.name(), found[0], found[1]);
            }
            most = [most[0].max(found[0]), most[1].max(found[1])];
        }
        if most[0] > 0.0 {
            best.push(most);
        } else {
            line += "  none";
        }
        out.line(&line)?;
    }
    if best.is_empty() {
        return Ok(());
    }
    let mean = |k: usize| (best.iter().map(|b| b[k].ln()).sum::<f64>() / best.len() as f64).exp();
    out.line(&format!(
        "geometric mean of the best method of each of {} scenes: {:.1} in time, {:.1} in reads and nodes",
        best.len(),
        mean(0),
        mean(1)
    ))
}

fn plot(study: &Study, adapter: &str) -> Plot {
    let series = Method::ALL
        .into_iter()
        .map(|method| Series {
            name: method.name().to_owned(),
            points: study
                .outcomes
                .iter()
                .enumerate()
                .filter(|(_, o)| o.trial.method == method)
                .filter(|(_, o)| o.relative_rmse.is_finite() && milliseconds(o) > 0.0)
                .map(|(i, o)| Point {
                    x: milliseconds(o),
                    y: o.relative_rmse,
                    label: if o.trial.baseline {
                        "games: 64 steps".to_owned()
                    } else {
                        o.trial
                            .set
                            .first()
                            .map_or(String::new(), |(_, v)| v.to_string())
                    },
                    on_front: study.by_time[i],
                })
                .collect(),
        })
        .filter(|series: &Series| !series.points.is_empty())
        .collect();
    let [w, h] = study.size;
    error_over_time(
        format!("Sunlight in the air: {}", study.scene),
        format!("{w} x {h} pixels, {adapter}; shadow maps apart"),
        "median time of rows, trees and integration",
        series,
    )
}

/// The truth, the games' usual setting and the best of the others at no more than its time, with their errors four times
/// brighter, all at the truth's exposure.
fn pictures(study: &Study, folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| Error::writing(folder, error))?;
    let lights = study.truth.iter().map(|rgb| luminance(rgb.as_dvec3()));
    let ev100 = exposure::auto(lights).unwrap_or(0.0);
    let write = |name: &str, value: &dyn Fn(usize) -> DVec3| -> Result<()> {
        let [w, h] = study.size;
        let bytes: Vec<u8> = (0..study.truth.len())
            .flat_map(|i| display::encode(value(i), ev100, [i as u32 % w, i as u32 / w], true))
            .collect();
        png::write(
            &folder.join(format!("{}-{name}.png", study.scene)),
            w,
            h,
            &bytes,
        )
    };
    write("truth", &|i| study.truth[i].as_dvec3())?;
    let baseline = study.outcomes.iter().find(|o| o.trial.baseline);
    let limit = baseline.map_or(f64::INFINITY, milliseconds);
    let ours = study
        .outcomes
        .iter()
        .filter(|o| OURS.contains(&o.trial.method) && milliseconds(o) <= limit)
        .min_by(|a, b| a.relative_rmse.total_cmp(&b.relative_rmse));
    for (name, outcome) in [("march-64", baseline), ("ours", ours)] {
        let Some(outcome) = outcome else { continue };
        write(name, &|i| outcome.inscatter[i].as_dvec3())?;
        write(&format!("{name}-error-x4"), &|i| {
            4.0 * (outcome.inscatter[i] - study.truth[i]).abs().as_dvec3()
        })?;
        let words = outcome.trial.words();
        tell::line("picture", format!("{}-{name}.png: {words}", study.scene));
    }
    Ok(())
}
