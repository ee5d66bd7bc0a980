//! What computes the picture: a GPU or the CPU reference.

use clap::ValueEnum;
use serde_json::{Value, json};
use std::time::Duration;
use tyndall::Result;
use tyndall::accuracy::Check;
use tyndall::effect::Method;
use tyndall::frame::Frame;
use tyndall::gpu::{self, Choice, Device, Gpu, adapters};
use tyndall::plan::Plan;
use tyndall::reference::Reference;

/// The flag.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BackendFlag {
    /// A hardware adapter, else the CPU reference.
    Auto,
    /// A graphics adapter, of software if there is no other.
    Gpu,
    /// The CPU reference.
    Reference,
}

/// What will compute.
pub enum Backend {
    Gpu(Box<Device>),
    Reference,
}

/// A picture and what is told about how it was made.
pub struct Done {
    pub frame: Frame,
    /// Stages of the work and their wall time [s].
    pub stages: Vec<(String, f64)>,
    /// Pixels that were taken again with more rays.
    pub refined: usize,
    pub elapsed: Duration,
    /// How sunlight in the air was integrated.
    pub method: &'static str,
    /// For the report.
    pub details: Value,
}

impl Backend {
    /// Chooses.
    ///
    /// # Errors
    /// When a GPU is asked for and there is none.
    pub fn new(flag: BackendFlag) -> Result<Self> {
        let choice = match flag {
            BackendFlag::Reference => return Ok(Backend::Reference),
            BackendFlag::Auto if adapters::automatic(&adapters::report()).is_none() => {
                return Ok(Backend::Reference);
            }
            BackendFlag::Auto => Choice::Hardware,
            BackendFlag::Gpu => Choice::Any,
        };
        Ok(Backend::Gpu(Box::new(Device::open(choice)?)))
    }

    /// In words.
    pub fn describe(&self) -> String {
        match self {
            Backend::Gpu(device) => {
                let adapter = &device.adapter;
                format!(
                    "gpu ({}, {}, {})",
                    adapter.name,
                    adapter.kind.words(),
                    adapter.backend
                )
            }
            Backend::Reference => {
                format!(
                    "reference (CPU, f64, {} threads)",
                    rayon::current_num_threads()
                )
            }
        }
    }

    /// Renders.
    ///
    /// # Errors
    /// Those of [`Gpu::new`], [`Gpu::render`] and [`Reference::render`].
    pub fn render(self, plan: &Plan, memory: u64, progress: &(dyn Fn(f64) + Sync)) -> Result<Done> {
        let words = self.describe();
        match self {
            Backend::Gpu(device) => {
                let mut gpu = Gpu::new(plan, *device)?;
                let rendered = gpu.render(memory, progress)?;
                let mut methods = plan.running().filter_map(|step| step.effect.method);
                Ok(by_gpu(&gpu, rendered, methods.next()))
            }
            Backend::Reference => {
                let rendered = Reference::new(plan).render(memory, progress)?;
                let wall = rendered.elapsed.as_secs_f64();
                let cpu: f64 = rendered.stages.iter().map(|s| s.time.as_secs_f64()).sum();
                let share = |time: Duration| time.as_secs_f64() / cpu.max(f64::MIN_POSITIVE);
                Ok(Done {
                    stages: rendered
                        .stages
                        .iter()
                        .map(|stage| (plain(stage.effect).to_owned(), share(stage.time) * wall))
                        .collect(),
                    refined: rendered.refined,
                    elapsed: rendered.elapsed,
                    method: "exact lit runs (reference)",
                    details: json!({ "backend": "reference", "words": words }),
                    frame: rendered.frame,
                })
            }
        }
    }
}

/// The reference is exact and knows none of the methods by which a GPU integrates sunlight in the air.
fn plain(effect: &str) -> &str {
    match effect.starts_with("shafts_") {
        true => "shafts",
        false => effect,
    }
}

fn by_gpu(gpu: &Gpu, rendered: gpu::Rendered, method: Option<Method>) -> Done {
    let mut stages = Vec::new();
    let mut known = 0.0;
    for pass in &rendered.passes {
        let Some(time) = pass.time else { continue };
        let name = format!("{}.{}", pass.effect, pass.pass);
        stages.push((name, time.as_secs_f64()));
        known += time.as_secs_f64();
    }
    let rest = (rendered.elapsed.as_secs_f64() - known).max(0.0);
    stages.push(("transfer and waiting".into(), rest));
    let passes: Vec<Value> = rendered
        .passes
        .iter()
        .map(|pass| {
            json!({
                "effect": pass.effect,
                "pass": pass.pass,
                "on": if pass.on_cpu { "cpu" } else { "gpu" },
                "runs": pass.runs,
                "seconds": pass.time.map(|t| t.as_secs_f64()),
            })
        })
        .collect();
    let traffic = rendered.traffic;
    Done {
        stages,
        refined: 0,
        elapsed: rendered.elapsed,
        method: method.map_or("none", Method::name),
        details: json!({
            "backend": "gpu",
            "adapter": gpu.device().adapter,
            "passes": passes,
            "pipelines": gpu.pipelines(),
            "bytes": {
                "allocated": traffic.allocated,
                "uploaded": traffic.uploaded,
                "downloaded": traffic.downloaded,
            },
        }),
        frame: rendered.frame,
    }
}

/// The measured error as lines of a table.
pub fn table(check: &Check) -> Vec<String> {
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
