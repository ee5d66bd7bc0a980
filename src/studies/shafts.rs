//! What accuracy costs in the air: every method of integrating sunlight, swept over its own knobs, against the reference.
//!
//! The sun is a point, so that the methods alone differ. Times are the device's own clock, medians of repeated frames after a
//! first one that does not count; reads and nodes are counted in a separate frame, whose times do not count either. Shadow maps
//! are shared by all methods and reported separately.

use super::{ANY, median};
use crate::accuracy::{self, flip};
use crate::backend::Rendered;
use crate::backend::gpu::Gpu;
use crate::backend::reference::Reference;
use crate::colour::luminance;
use crate::conditions::Conditions;
use crate::effect::{ALL, Contribution, Effect, Field, Method};
use crate::error::Result;
use crate::frame::Frame;
use crate::plan::{Overrules, Plan, Quality};
use glam::{DVec3, Vec3};
use std::time::Duration;

/// One setting of one method.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The method.
    pub method: Method,
    /// Its knobs, where they differ from those at the quality `preview`.
    pub set: Vec<(&'static str, f64)>,
    /// Whether it is what a game would usually do: the baseline.
    pub baseline: bool,
}

/// What a trial cost and gave.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was tried.
    pub trial: Trial,
    /// Median times of the method's passes.
    pub passes: Vec<(&'static str, Duration)>,
    /// Their sum, frame by frame, and its median.
    pub in_scatter: Duration,
    /// Median time of the shadow maps.
    pub maps: Duration,
    /// Reads of shadow maps and leaves a pixel, all passes of the method.
    pub reads: f64,
    /// Nodes of trees visited a pixel.
    pub nodes: f64,
    /// Relative RMSE of the in-scattered sunlight's luminance.
    pub relative_rmse: f64,
    /// 99th percentile over pixels of |L - R| / max(R, mean(R) / 100).
    pub percentile_99: f64,
    /// sum(L) / sum(R) - 1.
    pub bias: f64,
    /// Mean HDR-FLIP of the in-scattered sunlight alone ([`crate::accuracy::flip`]).
    pub flip: f64,
    /// The in-scattered sunlight [cd/m2, working space], for pictures of it.
    pub inscatter: Vec<Vec3>,
}

impl Trial {
    /// Method and knobs in words.
    pub fn words(&self) -> String {
        let knobs: Vec<String> = self.set.iter().map(|(k, v)| format!("{k} {v}")).collect();
        format!("{} {}", self.method.name(), knobs.join(", "))
    }
}

/// The sweeps: each method over its own knobs, the coarsest first.
pub fn sweeps() -> Vec<Trial> {
    let mut trials = Vec::new();
    let mut add = |method, set: &[(&'static str, f64)]| {
        trials.push(Trial {
            method,
            set: set.to_vec(),
            baseline: false,
        });
    };
    for steps in [16.0, 32.0, 64.0, 128.0, 256.0, 512.0] {
        add(Method::March, &[("steps", steps)]);
    }
    add(Method::March, &[("steps", 64.0), ("jitter", 1.0)]);
    for (size, blend, halvings) in [
        (512.0, 1.0, 0.0),
        (512.0, 1.0, 4.0),
        (1024.0, 1.0, 0.0),
        (1024.0, 1.0, 4.0),
        (1024.0, 2.0, 4.0),
        (2048.0, 1.0, 0.0),
        (2048.0, 1.0, 4.0),
        (4096.0, 1.0, 4.0),
        (4096.0, 2.0, 4.0),
    ] {
        add(
            Method::Rectified,
            &[
                ("rows", size),
                ("columns", f64::min(size, 1024.0)),
                ("blend", blend),
                ("halvings", halvings),
            ],
        );
    }
    for (size, samples, tolerance) in [
        (512.0, 256.0, 0.05),
        (1024.0, 256.0, 0.05),
        (1024.0, 512.0, 0.05),
        (1024.0, 512.0, 0.02),
        (2048.0, 512.0, 0.01),
        (2048.0, 1024.0, 0.005),
    ] {
        add(
            Method::Epipolar,
            &[
                ("rows", size),
                ("columns", size),
                ("slices", size),
                ("samples", samples),
                ("tolerance", tolerance),
            ],
        );
    }
    for (size, thresholds, blocks) in [
        (512.0, 32.0, 4.0),
        (1024.0, 32.0, 8.0),
        (1024.0, 60.0, 8.0),
        (1024.0, 60.0, 16.0),
        (512.0, 128.0, 32.0),
    ] {
        add(
            Method::Prefiltered,
            &[
                ("rows", size),
                ("columns", size),
                ("thresholds", thresholds),
                ("blocks", blocks),
            ],
        );
    }
    // The settings of Dobashi et al. 2000, figures 5 and 6.
    for (planes, lattice) in [
        (15.0, 40.0),
        (30.0, 40.0),
        (75.0, 5.0),
        (75.0, 20.0),
        (75.0, 40.0),
        (75.0, 80.0),
    ] {
        add(Method::Planes, &[("planes", planes), ("lattice", lattice)]);
    }
    for trial in &mut trials {
        trial.baseline = trial.method == Method::March && trial.set == [("steps", 64.0)];
    }
    trials
}

/// The plan of a trial: nothing but what sunlight in the air needs.
fn plan<'c>(
    conditions: &'c Conditions,
    trial: &Trial,
    extra: &[(String, f64)],
) -> Result<Plan<'c>> {
    let set = trial
        .set
        .iter()
        .map(|(knob, value)| (format!("shafts_{}.{knob}", trial.method.name()), *value))
        .chain([
            ("shafts.disc".to_owned(), 0.0),
            ("shafts.suns".to_owned(), 1.0),
        ])
        .chain(extra.iter().cloned())
        .collect();
    let without = ALL
        .iter()
        .filter(|effect| effect.method.is_none())
        .filter(|effect| {
            let decision = (effect.decide)(conditions);
            !matches!(decision.contribution, Contribution::Everything)
        })
        .map(|effect| effect.name.to_owned())
        .collect();
    Plan::new(
        conditions,
        &Overrules {
            quality: Quality::Preview,
            method: Some(trial.method),
            set,
            without,
            ..Overrules::default()
        },
    )
}

/// The in-scattered sunlight by the reference, under a point sun.
///
/// # Errors
/// Those of [`Plan::new`] and [`Reference::render`].
pub fn truth(conditions: &Conditions) -> Result<Vec<Vec3>> {
    let trial = Trial {
        method: Method::Rectified,
        set: Vec::new(),
        baseline: false,
    };
    let plan = plan(conditions, &trial, &[])?;
    let rendered = Reference::new(&plan)?.render(&ANY, &|_| {})?;
    Ok(inscatter(&rendered.frame))
}

fn inscatter(frame: &Frame) -> Vec<Vec3> {
    let layer = frame.layer(Field::InscatterSun.name());
    layer.map_or_else(
        || vec![Vec3::ZERO; frame.pixels()],
        |layer| layer.rgb.clone(),
    )
}

/// What the error `error` costs on a curve of costs and errors: between its points along straight lines of logarithms, beyond
/// them as if error times cost stayed the same, as for steps.
pub fn cost_at(curve: &[[f64; 2]], error: f64) -> f64 {
    let mut curve = curve.to_vec();
    curve.sort_unstable_by(|a, b| b[1].total_cmp(&a[1]));
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else {
        return f64::NAN;
    };
    if error >= first[1] {
        return first[0] * first[1] / error;
    }
    if error <= last[1] {
        return last[0] * last[1] / error;
    }
    let next = curve.partition_point(|point| point[1] > error);
    let ([c0, e0], [c1, e1]) = (curve[next - 1], curve[next]);
    let share = (e0 / error).ln() / (e0 / e1).ln();
    c0 * (c1 / c0).powf(share)
}

/// Measures one trial over `frames` frames. `extra` are knobs of other effects, as `shadow.resolution`.
///
/// # Errors
/// Those of [`Plan::new`], [`Gpu::count`] and [`Gpu::render`].
pub fn measure(
    gpu: &mut Gpu,
    conditions: &Conditions,
    trial: &Trial,
    extra: &[(String, f64)],
    truth: &[Vec3],
    frames: usize,
) -> Result<Outcome> {
    let plan = plan(conditions, trial, extra)?;
    let quiet = |_| {};
    let counted = gpu.count(&plan, &ANY, &quiet)?;
    gpu.render(&plan, &ANY, &quiet)?;
    let runs = (0..frames.max(1))
        .map(|_| {
            // Each frame draws its maps.
            gpu.forget();
            gpu.render(&plan, &ANY, &quiet)
        })
        .collect::<Result<Vec<Rendered>>>()?;
    let is_ours = |effect: &Effect| effect.method.is_some();
    let median = |time: &dyn Fn(&Rendered) -> Duration| median(runs.iter().map(time).collect());
    let passes: Vec<(&'static str, Duration)> = runs[0]
        .steps
        .iter()
        .enumerate()
        .filter(|(_, pass)| is_ours(pass.effect))
        .map(|(i, pass)| {
            (
                pass.pass,
                median(&|run| run.steps[i].time.unwrap_or_default()),
            )
        })
        .collect();
    let sum = |run: &Rendered, keep: &dyn Fn(&Effect) -> bool| -> Duration {
        let kept = run.steps.iter().filter(|pass| keep(pass.effect));
        kept.filter_map(|pass| pass.time).sum()
    };
    let pixels = truth.len() as f64;
    let count = |kind: usize| {
        let counts = counted.steps.iter().filter(|pass| is_ours(pass.effect));
        counts
            .filter_map(|pass| pass.counted)
            .map(|c| c[kind])
            .sum::<u64>() as f64
            / pixels
    };
    let found = inscatter(&runs[0].frame);
    let [reference, test] = [truth, &found[..]]
        .map(|picture| -> Vec<DVec3> { picture.iter().map(|rgb| rgb.as_dvec3()).collect() });
    let flip = flip::hdr(
        &reference,
        &test,
        conditions.view.size,
        flip::PIXELS_PER_DEGREE,
    )?
    .mean;
    let (relative_rmse, percentile_99, bias) = errors(&found, truth);
    Ok(Outcome {
        trial: trial.clone(),
        passes,
        in_scatter: median(&|run| sum(run, &is_ours)),
        maps: median(&|run| sum(run, &Effect::draws_maps)),
        reads: count(0),
        nodes: count(1),
        relative_rmse,
        percentile_99,
        bias,
        flip,
        inscatter: found,
    })
}

/// Relative RMSE, 99th percentile and bias of one picture against another.
pub fn errors(found: &[Vec3], truth: &[Vec3]) -> (f64, f64, f64) {
    let pairs: Vec<[f64; 2]> = found
        .iter()
        .zip(truth)
        .map(|(f, t)| [luminance(f.as_dvec3()), luminance(t.as_dvec3())])
        .collect();
    let sum = |of: fn(&[f64; 2]) -> f64| pairs.iter().map(of).sum::<f64>();
    let (off, light) = (sum(|[f, t]| f - t), sum(|p| p[1]));
    let bias = if off == 0.0 { 0.0 } else { off / light };
    let rmse = accuracy::relative_rmse(pairs.iter().copied());
    (rmse, accuracy::percentile_99(&pairs), bias)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_of_steps_tells_what_an_error_costs() {
        let curve: Vec<[f64; 2]> = [16.0, 64.0, 256.0].map(|n| [n, 1.0 / n]).to_vec();
        for error in [0.5, 1.0 / 16.0, 0.03, 1.0 / 64.0, 0.01, 1e-3] {
            assert!(
                (cost_at(&curve, error) * error - 1.0).abs() < 1e-12,
                "{error}"
            );
        }
    }
}
