//! What a rendering did and how long that took, for people and for reports.

use serde_json::{Value, json};
use std::time::Duration;
use tyndall::backend::check::Check;
use tyndall::backend::{Backend, Rendered, StepTime};
use tyndall::effect::{Effect, Paid};

/// Stages for a report.
pub fn stages_json(stages: &[(String, f64)]) -> Value {
    let stage = |(name, seconds): &(String, f64)| json!({"name": name, "seconds": seconds});
    stages.iter().map(stage).collect()
}

/// The stages of the work and their wall time [s].
pub fn stages(backend: &Backend, rendered: &Rendered) -> Vec<(String, f64)> {
    let start_up = rendered.start_up.stages();
    let mut stages: Vec<(String, f64)> = start_up
        .map(|(name, time)| (name.to_owned(), time.as_secs_f64()))
        .collect();
    stages.extend(rays(backend, rendered));
    stages
}

/// The stages between the first ray and the last.
fn rays(backend: &Backend, rendered: &Rendered) -> Vec<(String, f64)> {
    let wall = rendered.elapsed.as_secs_f64();
    let seconds = |step: &StepTime| step.time.as_ref().map(Duration::as_secs_f64);
    if let Backend::Reference(_) = backend {
        let cpu: f64 = rendered.steps.iter().filter_map(seconds).sum();
        let share = |step: &StepTime| seconds(step).unwrap_or(0.0) / cpu.max(f64::MIN_POSITIVE);
        let steps = rendered.steps.iter();
        return steps
            .map(|step| (plain(step.effect).to_owned(), share(step) * wall))
            .collect();
    }
    let mut stages: Vec<(String, f64)> = rendered
        .steps
        .iter()
        .filter_map(|step| {
            let name = format!("{}.{}", step.effect.name, step.pass);
            Some((name, seconds(step)?))
        })
        .collect();
    let known: f64 = stages.iter().map(|(_, seconds)| seconds).sum();
    stages.push(("transfer and waiting".into(), (wall - known).max(0.0)));
    stages
}

/// The reference knows none of the methods by which a GPU integrates sunlight in the air.
fn plain(effect: &Effect) -> &str {
    match effect.method {
        Some(_) => "shafts",
        None => effect.name,
    }
}

/// Rays that effects with lamps paid for, for the report.
pub fn paid(rendered: &Rendered) -> Value {
    let steps = rendered.steps.iter();
    let paid = steps.filter_map(|step| Some((step.effect.name, step.paid?)));
    let row = |(effect, Paid { rays, met, pairs }): (&str, Paid)| json!({"effect": effect, "rays": rays, "met": met, "pairs": pairs});
    paid.map(row).collect()
}

/// What was done, for the report.
pub fn details(backend: &Backend, rendered: &Rendered) -> Value {
    let Backend::Gpu(gpu) = backend else {
        return json!({ "backend": "reference", "words": backend.describe() });
    };
    let passes: Vec<Value> = rendered
        .steps
        .iter()
        .map(|step| {
            json!({
                "effect": step.effect.name,
                "pass": step.pass,
                "on": if step.on_cpu { "cpu" } else { "gpu" },
                "runs": step.runs,
                "seconds": step.time.map(|t| t.as_secs_f64()),
            })
        })
        .collect();
    let on_gpu = rendered.steps.iter().filter(|step| !step.on_cpu);
    let mut pipelines: Vec<String> = on_gpu
        .map(|step| format!("{}.{}", step.effect.name, step.pass))
        .collect();
    pipelines.dedup();
    let traffic = rendered.traffic;
    json!({
        "backend": "gpu",
        "adapter": gpu.device().adapter,
        "passes": passes,
        "pipelines": pipelines,
        "compiled": rendered.made.pipelines,
        "bytes": {
            "allocated": traffic.allocated,
            "uploaded": traffic.uploaded,
            "downloaded": traffic.downloaded,
        },
    })
}

/// The measured error as lines of a table.
pub fn check_lines(check: &Check) -> Vec<String> {
    let mut lines = vec![format!(
        "{} pixels against the reference: relative RMSE, its 95 % interval, 99th percentile",
        check.pixels
    )];
    lines.extend(check.layers.iter().map(|layer| {
        let [low, high] = layer.interval;
        format!(
            "{:<17}{:.3e}  [{low:.3e}, {high:.3e}]  {:.3e}",
            layer.layer, layer.relative_rmse, layer.percentile_99
        )
    }));
    lines
}
