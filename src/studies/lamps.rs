//! What accuracy costs for lamps in the air: every way of integrating their light, swept over its own knobs, against the exact one.
//!
//! The study of Dobashi, Yamamoto and Nishita (2000, section 5.4 and Table 1), repeated and extended: numbers of planes and of lattice
//! points, beside exact lit runs, closed forms and equi-angular nodes. Their errors were for the eye; ours are measured. All of it
//! is done by the CPU, in f64: times are those of the air's light alone, all cores together, without what finds surfaces.

use super::{ANY, median};
use crate::accuracy;
use crate::backend::reference::Reference;
use crate::colour::luminance;
use crate::conditions::Conditions;
use crate::effect::air_lamps::Integrator;
use crate::effect::{ALL, Contribution, Field};
use crate::error::Result;
use crate::frame::Frame;
use crate::plan::{Overrules, Plan, Quality};
use std::time::Duration;

/// What is measured.
const EFFECT: &str = "air_lamps";

/// One setting of one integrator.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The integrator.
    pub integrator: Integrator,
    /// Its knobs, where they differ from those at the quality `high`.
    pub set: Vec<(&'static str, f64)>,
}

/// What a trial cost and gave.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was tried.
    pub trial: Trial,
    /// Median time of the integration.
    pub time: Duration,
    /// Median time of what comes before the first ray: light maps and lattices.
    pub prepared: Duration,
    /// Relative RMSE of the luminance.
    pub relative_rmse: f64,
    /// 99th percentile over pixels of |L - R| / max(R, mean(R) / 100).
    pub percentile_99: f64,
    /// sum(L) / sum(R) - 1.
    pub bias: f64,
}

impl Outcome {
    /// All of its time.
    pub fn whole(&self) -> Duration {
        self.time + self.prepared
    }
}

impl Trial {
    /// Integrator and knobs in words.
    pub fn words(&self) -> String {
        let knobs: Vec<String> = self.set.iter().map(|(k, v)| format!("{k} {v}")).collect();
        format!("{} {}", self.integrator.name(), knobs.join(", "))
    }
}

/// The sweeps: each integrator over its own knobs, the coarsest first.
pub fn sweeps() -> Vec<Trial> {
    let mut trials = Vec::new();
    let mut add = |integrator, set: &[(&'static str, f64)]| {
        let set = set.to_vec();
        trials.push(Trial { integrator, set });
    };
    for error in [1e-2, 1e-3, 3e-4, 1e-6] {
        add(Integrator::Exact, &[("error", error)]);
    }
    for error in [1e-2, 1e-3] {
        add(Integrator::Glow, &[("error", error)]);
    }
    add(Integrator::Airlight, &[("error", 1e-3)]);
    for nodes in [1.0, 2.0, 4.0, 8.0, 16.0, 64.0] {
        add(Integrator::Equiangular, &[("nodes", nodes)]);
    }
    for rows in [64.0, 256.0, 1024.0, 4096.0] {
        add(Integrator::Rows, &[("rows", rows)]);
    }
    // Figures 5 and 6 and Table 1.
    for (planes, lattice) in [
        (15.0, 40.0),
        (30.0, 40.0),
        (75.0, 5.0),
        (75.0, 20.0),
        (75.0, 40.0),
        (75.0, 80.0),
        (150.0, 20.0),
        (150.0, 80.0),
        (600.0, 80.0),
    ] {
        let map = if planes > 150.0 { 512.0 } else { 64.0 };
        let set = [("planes", planes), ("lattice", lattice), ("map", map)];
        add(Integrator::Planes, &set);
    }
    trials
}

/// The plan of a trial: nothing but what the light of lamps in the air needs.
fn plan<'c>(
    conditions: &'c Conditions,
    trial: &Trial,
    extra: &[(String, f64)],
) -> Result<Plan<'c>> {
    let chosen = Integrator::ALL.iter().position(|i| *i == trial.integrator);
    let chosen = ("integrator", chosen.unwrap_or(0) as f64);
    let own = trial.set.iter().chain([&chosen]);
    let set = own.map(|(knob, value)| (format!("{EFFECT}.{knob}"), *value));
    let is_other = |effect: &&&crate::effect::Effect| {
        let decision = (effect.decide)(conditions);
        effect.name != EFFECT && !matches!(decision.contribution, Contribution::Everything)
    };
    let without = ALL.iter().filter(is_other).map(|e| e.name.to_owned());
    Plan::new(
        conditions,
        &Overrules {
            quality: Quality::High,
            set: set.chain(extra.iter().cloned()).collect(),
            without: without.collect(),
            ..Overrules::default()
        },
    )
}

/// The light of lamps in the air by the exact way at its finest [cd/m2, luminance].
///
/// # Errors
/// Those of [`Plan::new`] and [`Reference::render`].
pub fn truth(conditions: &Conditions) -> Result<Vec<f64>> {
    let finest = Trial {
        integrator: Integrator::Exact,
        set: vec![("error", 1e-9), ("left_out", 0.0)],
    };
    let plan = plan(conditions, &finest, &[])?;
    Ok(found(&Reference::new(&plan)?.render(&ANY, &|_| {})?.frame))
}

fn found(frame: &Frame) -> Vec<f64> {
    match frame.layer(Field::InscatterLights.name()) {
        Some(layer) => layer
            .rgb
            .iter()
            .map(|rgb| luminance(rgb.as_dvec3()))
            .collect(),
        None => vec![0.0; frame.pixels()],
    }
}

/// Measures one trial over `frames` frames. `extra` are knobs of these and of other effects, as `air_lamps.points`.
///
/// # Errors
/// Those of [`Plan::new`] and [`Reference::render`].
pub fn measure(
    conditions: &Conditions,
    trial: &Trial,
    extra: &[(String, f64)],
    truth: &[f64],
    frames: usize,
) -> Result<Outcome> {
    let plan = plan(conditions, trial, extra)?;
    let runs = (0..frames.max(1))
        .map(|_| Reference::new(&plan)?.render(&ANY, &|_| {}))
        .collect::<Result<Vec<_>>>()?;
    let times = runs.iter().map(|run| {
        let own = run.steps.iter().filter(|step| step.effect.name == EFFECT);
        own.filter_map(|step| step.time).sum()
    });
    let prepared = runs.iter().map(|run| {
        let stages = run.start_up.stages();
        let own = stages.filter(|(name, _)| *name == "air_lamps.prepare");
        own.map(|(_, time)| time).sum()
    });
    let found = found(&runs[0].frame);
    let pairs: Vec<[f64; 2]> = found.iter().zip(truth).map(|(f, t)| [*f, *t]).collect();
    let (off, light) = pairs
        .iter()
        .fold((0.0, 0.0), |(off, light), [f, t]| (off + f - t, light + t));
    Ok(Outcome {
        trial: trial.clone(),
        time: median(times.collect()),
        prepared: median(prepared.collect()),
        relative_rmse: accuracy::relative_rmse(pairs.iter().copied()),
        percentile_99: accuracy::percentile_99(&pairs),
        bias: if off == 0.0 { 0.0 } else { off / light },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_knob_of_the_sweeps_is_there_and_takes_its_values() {
        let effect = ALL.iter().find(|effect| effect.name == EFFECT);
        let knobs = effect.expect("it is an effect").knobs;
        for (name, value) in sweeps().iter().flat_map(|trial| &trial.set) {
            let knob = knobs.iter().find(|knob| knob.name == *name);
            let [low, high] = knob.expect("it is a knob").range;
            assert!((low..=high).contains(value), "{name} {value}");
        }
    }
}
