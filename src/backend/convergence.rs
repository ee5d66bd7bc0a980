//! How far the points that stand for the sun's disc are from the disc itself, by the points alone.
//!
//! N points make N steps of every soft edge. What changes when half as many stand for the disc says how far N are from
//! converged: the steps of N and of N / 2 points lie in different places, so that their errors add, and the difference is larger
//! than the error of the N. It is measured on some pixels, in f64, and only what goes by points is made for them.

use super::check::stratified;
use super::reference::{Reference, Values};
use crate::accuracy::{LayerError, error};
use crate::colour::luminance;
use crate::effect::{Field, Kept};
use crate::error::Result;
use crate::plan::{Plan, Step};
use crate::task::Task;
use serde::Serialize;

/// The stage in which it is measured.
const STAGE: &str = "points of the sun's disc";

/// How many points a step goes by.
const POINTS: &str = "suns";

/// Whether a step has the disc itself.
const WHOLE: &str = "disc";

/// What changes when half as many points stand for the sun's disc.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Convergence {
    /// How many points there are: the least of all effects that go by them.
    pub points: usize,
    /// Pixels on which it was measured.
    pub pixels: usize,
    /// The change of each layer that goes by points, relative to its mean.
    pub layers: Vec<LayerError>,
}

impl Convergence {
    /// How far a plan is from converged, measured on about `count` pixels, by one ray each; `None` for a plan which does not leave the
    /// sun's disc to several points, as qualities below `reference` do not.
    ///
    /// # Errors
    /// Those of [`Reference::keeping`].
    pub fn of(plan: &Plan, count: usize, task: Task<'_>) -> Result<Option<Self>> {
        let is_left_to_points =
            |step: &&Step| points(step).is_some() && get(step, WHOLE) == Some(0.0);
        let disc = plan.conditions.sun_beams(2).len() > 1;
        if !disc || count == 0 || plan.running().find(is_left_to_points).is_none() {
            return Ok(None);
        }
        let least = plan.running().filter_map(points).reduce(f64::min);
        let changed: Vec<Field> = plan
            .running()
            .filter(|step| points(step).is_some())
            .flat_map(|step| step.effect.writes.iter().chain(step.effect.alters))
            .copied()
            .collect();
        let pixels = stratified(plan.conditions.view.size, count);
        let light = |share: f64| -> Result<Vec<Values>> {
            let plan = only(plan, &changed, share);
            let reference = Reference::keeping(&plan, &Kept::default(), task)?;
            reference.sampled(&pixels, 1, task.stage(STAGE))
        };
        let (whole, half) = (light(1.0)?, light(0.5)?);
        let of = |values: &Values, field: Field| luminance(values[field as usize]);
        let layers = Field::layers().filter(|field| changed.contains(field));
        Ok(Some(Convergence {
            points: least.unwrap_or(0.0) as usize,
            pixels: pixels.len(),
            layers: layers
                .map(|field| {
                    let pairs = half.iter().zip(&whole);
                    let pairs: Vec<[f64; 2]> = pairs
                        .map(|(half, whole)| [of(half, field), of(whole, field)])
                        .collect();
                    error(field.name(), &pairs)
                })
                .collect(),
        }))
    }
}

fn get(step: &Step, knob: &str) -> Option<f64> {
    let setting = step.settings.iter().find(|(name, _)| *name == knob);
    setting.map(|(_, value)| *value)
}

/// The points that stand for the disc in a step, if there are several.
fn points(step: &Step) -> Option<f64> {
    let whole = get(step, WHOLE).is_some_and(|disc| disc > 0.0);
    get(step, POINTS).filter(|count| *count >= 2.0 && !whole)
}

/// The steps of a plan that change some fields, and those that these read from, with a share of the points.
fn only<'c>(plan: &Plan<'c>, fields: &[Field], share: f64) -> Plan<'c> {
    let mut steps: Vec<Step> = plan.running().cloned().collect();
    let mut needed = fields.to_vec();
    // What a step reads was made by steps before it.
    for step in steps.iter_mut().rev() {
        let mut changes = step.effect.writes.iter().chain(step.effect.alters);
        step.decision.run = changes.any(|field| needed.contains(field));
        if step.decision.run {
            needed.extend(step.effect.reads);
        }
    }
    for step in &mut steps {
        if let Some(count) = points(step) {
            let settings = step.settings.iter_mut();
            for (_, value) in settings.filter(|(name, _)| *name == POINTS) {
                *value = (share * count).floor();
            }
        }
    }
    Plan {
        conditions: plan.conditions,
        tolerance: plan.tolerance,
        method: plan.method,
        steps,
    }
}
