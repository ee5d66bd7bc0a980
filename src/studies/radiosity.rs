//! What the accuracy of light from sky and surfaces costs: the knobs of the effects that find it, one after the other, and the
//! qualities, against a finer picture.
//!
//! Each knob is swept while all others stand as at [`OTHERS`], so that what changes of the error is its own. Times are those of
//! pictures of these effects alone, medians of repeated frames, each of which starts afresh: what is kept for the next picture (who sees
//! whom, by rays or by hemicubes) is made anew, and that is a part of them.

use super::{ANY, median};
use crate::accuracy::{self, LayerError};
use crate::backend::predict::predict;
use crate::backend::reference::Reference;
use crate::backend::{Backend, Rendered};
use crate::colour::luminance;
use crate::conditions::Conditions;
use crate::effect::{ALL, Effect, Field};
use crate::error::Result;
use crate::frame::Frame;
use crate::plan::{Overrules, Plan, Quality};
use std::time::{Duration, Instant};

/// What is measured: light that surfaces and the air receive from the sky and from surfaces.
pub const LAYERS: [Field; 3] = [Field::Sky, Field::Indirect, Field::InscatterSky];

/// The quality at which all knobs stand that are not swept.
pub const OTHERS: Quality = Quality::Preview;

/// Effects, their knobs, and the values over which each is swept.
const SWEEPS: &[(&str, &str, &[f64])] = &[
    // 145, 577, 2 305 and 36 865 patches.
    ("radiosity", "sky", &[1.0, 2.0, 4.0, 16.0]),
    ("radiosity", "rays", &[16.0, 64.0, 256.0]),
    ("radiosity", "patch", &[0.5, 0.125, 0.0625]),
    ("radiosity", "patches", &[100.0, 1e3, 1e4]),
    ("radiosity", "patch_rays", &[1e4, 1e5, 1e6]),
    ("radiosity", "hemicube", &[8.0, 16.0, 32.0, 64.0]),
    ("radiosity", "bend", &[0.2, 0.06, 0.02]),
    ("radiosity", "unshot", &[0.1, 1e-2, 1e-3]),
    ("air_sky", "spacing", &[0.4, 0.25, 0.16]),
    ("air_sky", "columns", &[32.0, 16.0, 8.0]),
];

/// How much finer than `high` the yardstick is.
const TRUTH: &[(&str, f64)] = &[
    ("radiosity.rays", 1024.0),
    ("radiosity.outline", 1e-3),
    ("radiosity.bend", 0.01),
    ("air_sky.rays", 1024.0),
    ("air_sky.outline", 0.005),
    ("air_sky.difference", 0.002),
];

/// One setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trial {
    /// All knobs as at a quality.
    Quality(Quality),
    /// One knob of an effect at a value.
    Knob {
        /// The effect.
        effect: &'static str,
        /// Its knob.
        knob: &'static str,
        /// The value.
        value: f64,
    },
}

/// What a trial cost and gave.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was tried.
    pub trial: Trial,
    /// Median time of the whole by the clock on the wall.
    pub time: Duration,
    /// Of that what comes before the first pixel: who sees whom, and how bright all patches are.
    pub prepared: Duration,
    /// The errors of [`LAYERS`], in their order.
    pub layers: [LayerError; LAYERS.len()],
    /// The error of their sum.
    pub all: LayerError,
}

/// The luminance of [`LAYERS`] at every pixel [cd/m2].
pub type Truth = Vec<[f64; LAYERS.len()]>;

impl Trial {
    /// What is varied: `quality`, or effect and knob.
    pub fn subject(&self) -> String {
        match self {
            Trial::Quality(_) => "quality".into(),
            Trial::Knob { effect, knob, .. } => format!("{effect}.{knob}"),
        }
    }

    /// What it is set to.
    pub fn setting(&self) -> String {
        match self {
            Trial::Quality(quality) => quality.name().into(),
            Trial::Knob { value, .. } => value.to_string(),
        }
    }
}

/// All trials: the qualities, then the knobs.
pub fn trials() -> Vec<Trial> {
    let qualities = [Quality::Draft, Quality::Preview, Quality::High].map(Trial::Quality);
    let knobs = SWEEPS.iter().flat_map(|&(effect, knob, values)| {
        values.iter().map(move |&value| Trial::Knob {
            effect,
            knob,
            value,
        })
    });
    qualities.into_iter().chain(knobs).collect()
}

/// Whether an effect makes what is measured.
fn is_ours(effect: &Effect) -> bool {
    effect.writes.iter().any(|field| LAYERS.contains(field))
}

/// The plan of a trial: of all layers only those that are measured.
fn plan<'c>(
    conditions: &'c Conditions,
    trial: &Trial,
    extra: &[(String, f64)],
) -> Result<Plan<'c>> {
    let makes_others = |effect: &&&Effect| effect.writes.iter().any(|field| field.is_layer());
    let without = ALL.iter().filter(makes_others).filter(|e| !is_ours(e));
    let mut set = extra.to_vec();
    let quality = match *trial {
        Trial::Quality(quality) => quality,
        Trial::Knob { value, .. } => {
            set.push((trial.subject(), value));
            OTHERS
        }
    };
    Plan::new(
        conditions,
        &Overrules {
            quality,
            set,
            without: without.map(|effect| effect.name.to_owned()).collect(),
            ..Overrules::default()
        },
    )
}

/// What a frame that starts afresh takes on the CPU as at [`OTHERS`] [s], by preparing it and judging its rays.
///
/// # Errors
/// Those of [`Plan::new`] and [`Reference::new`].
pub fn frame_seconds(conditions: &Conditions, extra: &[(String, f64)]) -> Result<f64> {
    let begun = Instant::now();
    let plan = plan(conditions, &Trial::Quality(OTHERS), extra)?;
    let reference = Reference::new(&plan)?;
    let prepared = begun.elapsed().as_secs_f64();
    let steps = predict(&reference, Duration::from_millis(500));
    let rays = steps.iter().filter_map(|step| step.time);
    Ok(prepared + rays.sum::<Duration>().as_secs_f64())
}

/// What the reference makes of the layers when it looks more closely than in any trial: at `high` with more rays, finer
/// outlines and finer lattices. Knobs of `extra` stand as they do in the trials.
///
/// # Errors
/// Those of [`Plan::new`] and [`Reference::render`].
pub fn truth(conditions: &Conditions, extra: &[(String, f64)]) -> Result<Truth> {
    let finer = TRUTH.iter().map(|(knob, v)| (knob.to_string(), *v));
    let finer: Vec<_> = finer.chain(extra.iter().cloned()).collect();
    let plan = plan(conditions, &Trial::Quality(Quality::High), &finer)?;
    Ok(found(&Reference::new(&plan)?.render(&ANY, &|_| {})?.frame))
}

fn found(frame: &Frame) -> Truth {
    let layers = LAYERS.map(|field| frame.layer(field.name()));
    let value = |i: usize| {
        layers.map(|layer| layer.map_or(0.0, |layer| luminance(layer.rgb[i].as_dvec3())))
    };
    (0..frame.pixels()).map(value).collect()
}

/// Measures one trial over `frames` frames; `extra` are knobs of these and of other effects, as `radiosity.rays`.
///
/// # Errors
/// Those of [`Plan::new`] and [`Backend::render`].
pub fn measure(
    backend: &mut Backend,
    conditions: &Conditions,
    trial: Trial,
    extra: &[(String, f64)],
    truth: &Truth,
    frames: usize,
) -> Result<Outcome> {
    let plan = plan(conditions, &trial, extra)?;
    let runs = (0..frames.max(1))
        .map(|_| {
            backend.forget();
            let start = Instant::now();
            let rendered = backend.render(&plan, &ANY, &|_| {})?;
            Ok((start.elapsed(), rendered))
        })
        .collect::<Result<Vec<(Duration, Rendered)>>>()?;
    let prepared = |(whole, run): &(Duration, Rendered)| whole.saturating_sub(run.elapsed);
    let found = found(&runs[0].1.frame);
    let error = |name: &'static str, of: &dyn Fn(&[f64; LAYERS.len()]) -> f64| {
        let pairs: Vec<[f64; 2]> = found
            .iter()
            .zip(truth)
            .map(|(f, t)| [of(f), of(t)])
            .collect();
        accuracy::error(name, &pairs)
    };
    Ok(Outcome {
        trial,
        time: median(runs.iter().map(|(whole, _)| *whole).collect()),
        prepared: median(runs.iter().map(prepared).collect()),
        layers: std::array::from_fn(|k| error(LAYERS[k].name(), &move |pixel| pixel[k])),
        all: error("all", &|pixel| pixel.iter().sum()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_knob_of_the_sweeps_is_there_and_takes_its_values() {
        for (name, knob, values) in SWEEPS {
            let effect = ALL.iter().find(|effect| effect.name == *name);
            let effect = effect.unwrap_or_else(|| panic!("there is no effect {name}"));
            assert!(is_ours(effect), "{name}");
            let found = effect.knobs.iter().find(|k| k.name == *knob);
            let [low, high] = found
                .unwrap_or_else(|| panic!("{name} has no {knob}"))
                .range;
            assert!(values.iter().all(|v| (low..=high).contains(v)), "{knob}");
        }
    }
}
