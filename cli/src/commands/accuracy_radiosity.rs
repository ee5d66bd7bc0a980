//! `tyndall accuracy --effect radiosity`: what the accuracy of light from sky and surfaces costs, knob by knob.

use crate::arguments::backend::BackendFlag;
use crate::arguments::form::FormArgs;
use crate::commands::study::{StudyArgs, error_over_time};
use crate::machine;
use crate::plots::plot::{Plot, Point, Series};
use crate::tables::columns::{Columns, columns, print};
use crate::tables::stdout::Out;
use crate::tell;
use clap::Args;
use serde_json::json;
use tyndall::Result;
use tyndall::accuracy::LayerError;
use tyndall::studies::pareto;
use tyndall::studies::radiosity::{LAYERS, OTHERS, Outcome, frame_seconds, measure, trials, truth};

/// The flags of the study of light from sky and surfaces.
#[derive(Args, Debug)]
pub struct RadiosityArgs {
    /// With --effect radiosity: what renders; the truth is always the reference's
    #[arg(long, value_name = "BACKEND", default_value = "auto", value_enum)]
    backend: BackendFlag,
}

/// Scenes of the study unless others are named.
const SCENES: [&str; 3] = ["room", "court", "hills"];

/// Their size [pixels].
const SIZE: [u32; 2] = [48, 32];

/// What frames of all settings take on average, over one of usual settings: fine ones take longest.
const FINER: f64 = 1.5;

/// All measurements of a scene.
struct Study {
    scene: String,
    size: [u32; 2],
    outcomes: Vec<Outcome>,
    front: Vec<bool>,
}

/// Runs the study.
pub fn run(flags: &StudyArgs, own: &RadiosityArgs, form: FormArgs) -> Result<()> {
    let mut backend = machine::open(own.backend.wanted())?;
    let described = backend.describe();
    let mut studies = Vec::new();
    let scenes = flags.scenes(&SCENES, SIZE)?;
    let names: Vec<&str> = scenes.iter().map(|(scene, _)| scene.as_str()).collect();
    tell::line(
        "study",
        format!(
            "{} settings of {}; first how long a frame of usual ones takes",
            trials().len(),
            names.join(", ")
        ),
    );
    let seconds = scenes.iter().map(|(_, c)| frame_seconds(c, &flags.set));
    let seconds = seconds.collect::<Result<Vec<f64>>>()?;
    let seconds = seconds.into_iter().map(|seconds| FINER * seconds);
    let mut watch = flags.watch(&scenes, trials().len(), seconds);
    for (scene, conditions) in scenes {
        watch.next(&scene, "the reference");
        let truth = truth(&conditions, &flags.set)?;
        let mut outcomes = Vec::new();
        for trial in trials() {
            watch.next(&scene, &format!("{} {}", trial.subject(), trial.setting()));
            let (set, frames) = (&flags.set, flags.frames);
            outcomes.push(measure(
                &mut backend,
                &conditions,
                trial,
                set,
                &truth,
                frames,
            )?);
        }
        let pairs: Vec<[f64; 2]> = outcomes
            .iter()
            .map(|o| [milliseconds(o), o.all.relative_rmse])
            .collect();
        let study = Study {
            scene,
            size: conditions.view.size,
            front: pareto::front(&pairs),
            outcomes,
        };
        watch.apart(|| flags.save(&study.scene, || plot(&study, &described)))?;
        studies.push(study);
    }
    drop(watch);
    let rows = studies.iter().flat_map(|study| rows(study, &described));
    print(form, rows.collect(), |out| {
        table(out, &studies, &described, flags.frames)
    })
}

/// An error in the table; of a layer without light there is none.
fn relative_rmse(error: &LayerError) -> String {
    match error.mean > 0.0 || error.relative_rmse > 0.0 {
        true => format!("{:>14.5}", error.relative_rmse),
        false => format!("{:>14}", "-"),
    }
}

fn milliseconds(outcome: &Outcome) -> f64 {
    1e3 * outcome.time.as_secs_f64()
}

fn rows<'s>(study: &'s Study, backend: &'s str) -> impl Iterator<Item = Columns> + 's {
    study.outcomes.iter().zip(&study.front).map(move |(o, on)| {
        let mut row = columns([
            ("scene", json!(study.scene)),
            ("backend", json!(backend)),
            ("width", json!(study.size[0])),
            ("height", json!(study.size[1])),
            ("knob", json!(o.trial.subject())),
            ("setting", json!(o.trial.setting())),
            ("ms", json!(milliseconds(o))),
            ("prepared_ms", json!(1e3 * o.prepared.as_secs_f64())),
        ]);
        for error in o.layers.iter().chain([&o.all]) {
            let name = error.layer;
            row.insert(format!("{name}_mean"), json!(error.mean));
            row.insert(format!("{name}_relative_rmse"), json!(error.relative_rmse));
            row.insert(format!("{name}_percentile_99"), json!(error.percentile_99));
        }
        row.insert("front_by_time".to_owned(), json!(on));
        row
    })
}

fn table(out: &mut Out, studies: &[Study], backend: &str, frames: usize) -> Result<()> {
    out.line(&format!(
        "{backend}; medians of {frames} frames that start afresh; relative RMSE against the reference with more rays"
    ))?;
    out.line(&format!(
        "one knob at a time, the others as at `{}`; ms: of a picture of these layers by the clock on the wall, and of that what comes \
         before the first pixel, who sees whom above all; T: on the front of the error of all layers by time",
        OTHERS.name()
    ))?;
    let layers: String = LAYERS.map(|field| format!("{:>14}", field.name())).concat();
    for study in studies {
        let [w, h] = study.size;
        out.line("")?;
        out.line(&format!("{}, {w} x {h}", study.scene))?;
        out.line(&format!(
            "{:<24}{:>12}{:>10}{:>10}{layers}{:>14}{:>9}",
            "knob", "setting", "ms", "before", "all", "99 %"
        ))?;
        for (o, on) in study.outcomes.iter().zip(&study.front) {
            let errors = o.layers.iter().chain([&o.all]);
            let errors: String = errors.map(relative_rmse).collect();
            out.line(&format!(
                "{:<24}{:>12}{:>10.1}{:>10.1}{errors}{:>9.4} {}",
                o.trial.subject(),
                o.trial.setting(),
                milliseconds(o),
                1e3 * o.prepared.as_secs_f64(),
                o.all.percentile_99,
                if *on { 'T' } else { ' ' },
            ))?;
        }
    }
    Ok(())
}

fn plot(study: &Study, backend: &str) -> Plot {
    let mut series: Vec<Series> = Vec::new();
    for (o, on) in study.outcomes.iter().zip(&study.front) {
        let (x, y) = (milliseconds(o), o.all.relative_rmse);
        if !(x > 0.0 && y.is_finite()) {
            continue;
        }
        let point = Point {
            x,
            y,
            label: o.trial.setting(),
            on_front: *on,
        };
        let name = o.trial.subject();
        match series.iter_mut().find(|known| known.name == name) {
            Some(known) => known.points.push(point),
            None => series.push(Series {
                name,
                points: vec![point],
            }),
        }
    }
    let [w, h] = study.size;
    error_over_time(
        format!("Light from sky and surfaces: {}", study.scene),
        format!("{w} x {h} pixels, {backend}"),
        "median time of the picture",
        series,
    )
}
