//! `tyndall accuracy --effect lamps`: what the accuracy of the light of lamps in the air costs, integrator by integrator.

use crate::arguments::form::FormArgs;
use crate::commands::study::{StudyArgs, by_pixels, error_over_time};
use crate::plots::plot::{Plot, Point, Series};
use crate::tables::columns::{Columns, columns, print};
use crate::tables::stdout::Out;
use serde_json::json;
use tyndall::Result;
use tyndall::effect::air_lamps::Integrator;
use tyndall::studies::lamp_scenes;
use tyndall::studies::lamps::{Outcome, measure, sweeps, truth};
use tyndall::studies::pareto;

/// Their size [pixels].
const SIZE: [u32; 2] = [120, 80];

/// What a frame of a setting takes in one of them, on two cores of a server [s].
const SECONDS: f64 = 0.1;

/// All measurements of a scene.
struct Study {
    scene: String,
    size: [u32; 2],
    outcomes: Vec<Outcome>,
    front: Vec<bool>,
}

/// Runs the study.
pub fn run(flags: &StudyArgs, form: FormArgs) -> Result<()> {
    let mut studies = Vec::new();
    let scenes = flags.scenes(&lamp_scenes::NAMES, SIZE)?;
    let mut watch = flags.watch(&scenes, sweeps().len(), by_pixels(&scenes, (SIZE, SECONDS)));
    for (scene, conditions) in scenes {
        watch.next(&scene, "the reference");
        let truth = truth(&conditions)?;
        let mut outcomes = Vec::new();
        for trial in sweeps() {
            watch.next(&scene, &trial.words());
            let (set, frames) = (&flags.set, flags.frames);
            outcomes.push(measure(&conditions, &trial, set, &truth, frames)?);
        }
        let pairs: Vec<[f64; 2]> = outcomes
            .iter()
            .map(|o| [milliseconds(o), o.relative_rmse])
            .collect();
        let study = Study {
            scene,
            size: conditions.view.size,
            front: pareto::front(&pairs),
            outcomes,
        };
        watch.apart(|| flags.save(&study.scene, || plot(&study)))?;
        studies.push(study);
    }
    drop(watch);
    let rows = studies.iter().flat_map(rows);
    print(form, rows.collect(), |out| {
        table(out, &studies, flags.frames)
    })
}

fn milliseconds(outcome: &Outcome) -> f64 {
    1e3 * outcome.whole().as_secs_f64()
}

fn rows(study: &Study) -> impl Iterator<Item = Columns> + '_ {
    study.outcomes.iter().zip(&study.front).map(move |(o, on)| {
        let mut row = columns([
            ("scene", json!(study.scene)),
            ("width", json!(study.size[0])),
            ("height", json!(study.size[1])),
            ("integrator", json!(o.trial.integrator.name())),
            ("ms", json!(milliseconds(o))),
            ("prepared_ms", json!(1e3 * o.prepared.as_secs_f64())),
            ("relative_rmse", json!(o.relative_rmse)),
            ("percentile_99", json!(o.percentile_99)),
            ("bias", json!(o.bias)),
            ("front_by_time", json!(on)),
        ]);
        for knob in ["error", "nodes", "rows", "planes", "lattice", "map"] {
            let set = o.trial.set.iter().find(|(name, _)| *name == knob);
            row.insert(knob.to_owned(), json!(set.map(|(_, value)| value)));
        }
        row
    })
}

fn table(out: &mut Out, studies: &[Study], frames: usize) -> Result<()> {
    out.line(&format!(
        "the CPU, f64; medians of {frames} frames; ms: of the light of lamps in the air, all cores together, and of that what comes before \
         the first ray; errors against exact lit runs to 1e-9; T: on the front of the error by time"
    ))?;
    for study in studies {
        let [w, h] = study.size;
        out.line("")?;
        out.line(&format!("{}, {w} x {h}", study.scene))?;
        out.line(&format!(
            "{:<44}{:>10}{:>10}{:>14}{:>12}{:>12}",
            "integrator", "ms", "before", "relative RMSE", "99 %", "bias"
        ))?;
        for (o, on) in study.outcomes.iter().zip(&study.front) {
            out.line(&format!(
                "{:<44}{:>10.1}{:>10.1}{:>14.2e}{:>12.2e}{:>+12.2e} {}",
                o.trial.words(),
                milliseconds(o),
                1e3 * o.prepared.as_secs_f64(),
                o.relative_rmse,
                o.percentile_99,
                o.bias,
                if *on { 'T' } else { ' ' },
            ))?;
        }
    }
    Ok(())
}

fn plot(study: &Study) -> Plot {
    let series = Integrator::ALL
        .into_iter()
        .map(|integrator| Series {
            name: integrator.name().to_owned(),
            points: study
                .outcomes
                .iter()
                .zip(&study.front)
                .filter(|(o, _)| o.trial.integrator == integrator)
                .filter(|(o, _)| o.relative_rmse > 0.0 && milliseconds(o) > 0.0)
                .map(|(o, on)| Point {
                    x: milliseconds(o),
                    y: o.relative_rmse,
                    label: o
                        .trial
                        .set
                        .first()
                        .map_or(String::new(), |(_, v)| v.to_string()),
                    on_front: *on,
                })
                .collect(),
        })
        .filter(|series: &Series| !series.points.is_empty())
        .collect();
    let [w, h] = study.size;
    error_over_time(
        format!("Light of lamps in the air: {}", study.scene),
        format!("{w} x {h} pixels, CPU, f64, all cores together"),
        "median time",
        series,
    )
}
