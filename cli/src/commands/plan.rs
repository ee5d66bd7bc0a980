//! `tyndall plan`: which effects a scene calls for, and why not the others.

use crate::arguments::form::FormArgs;
use crate::arguments::scene::{PlanArgs, ViewArgs};
use crate::tables::rows::Rows;
use crate::tables::stdout;
use crate::tell;
use clap::Args;
use serde_json::json;
use std::time::Duration;
use tyndall::Result;
use tyndall::backend::StepTime;
use tyndall::backend::predict::predict;
use tyndall::backend::reference::Reference;
use tyndall::effect::{Contribution, Kept};
use tyndall::error::with_short_numbers;
use tyndall::plan::{Plan, Step};

/// List the effects that a scene calls for, and why not the others
#[derive(Debug, Args)]
pub struct PlanCommand {
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    plan: PlanArgs,
    #[command(flatten)]
    form: FormArgs,
}

/// The time in which it is judged how long a picture takes.
const ALLOWED: Duration = Duration::from_secs(1);

/// Plans.
pub fn run(args: &PlanCommand) -> Result<()> {
    let conditions = args.view.conditions()?;
    let plan = Plan::new(&conditions, &args.plan.overrules())?;
    tell::conditions(&conditions);
    let kept = Kept::default();
    let reference = tell::watched(None, |task| Reference::keeping(&plan, &kept, task))?;
    let seconds = predict(&reference, ALLOWED);
    let in_seconds = |step: &StepTime| step.time.unwrap_or_default().as_secs_f64();
    let seconds_of = |step: &Step| {
        let name = step.effect.name;
        let found = seconds.iter().find(|s| s.effect.name == name);
        found.map(in_seconds)
    };
    if args.form.json {
        let mut steps = tell::plan_json(&plan);
        if let Some(list) = steps.as_array_mut() {
            for (entry, step) in list.iter_mut().zip(&plan.steps) {
                entry["predicted_seconds"] = json!(seconds_of(step));
            }
        }
        return stdout::print_json(&json!({
            "schema": 1,
            "size": conditions.view.size,
            "tolerance": plan.tolerance,
            "typical_luminance_cd_per_m2": conditions.typical_luminance(),
            "least_luminance_cd_per_m2": conditions.least_luminance(),
            "effects": steps,
            "warnings": conditions.warnings,
        }));
    }
    let rows: Vec<[String; 5]> = plan
        .steps
        .iter()
        .map(|step| {
            let settings: Vec<String> = step
                .settings
                .iter()
                .filter(|_| step.decision.run)
                .map(|(knob, value)| format!("{knob} {value}"))
                .collect();
            let reason = match settings.is_empty() {
                true => step.decision.reason.clone(),
                false => format!("{} ({})", step.decision.reason, settings.join(", ")),
            };
            [
                step.effect.name.to_owned(),
                if step.decision.run { "run" } else { "skip" }.to_owned(),
                contribution(step.decision.contribution),
                seconds_of(step).map_or(String::new(), |s| format!("{s:.1} s")),
                reason,
            ]
        })
        .collect();
    let header = ["effect", "", "adds at most [cd/m2]", "predicted", "why"].map(str::to_owned);
    if args.form.csv {
        let mut csv = Rows::with_capacity(0);
        for row in std::iter::once(&header).chain(&rows) {
            csv.row(row);
        }
        return stdout::print(csv.into_bytes());
    }
    let mut text = String::new();
    let widths: Vec<usize> = (0..4)
        .map(|i| {
            let cells = std::iter::once(&header).chain(&rows);
            cells.map(|row| row[i].chars().count()).max().unwrap_or(0)
        })
        .collect();
    for row in std::iter::once(&header).chain(&rows) {
        for (cell, &width) in row[..4].iter().zip(&widths) {
            text += &format!("{cell:<width$}  ");
        }
        text += &(row[4].clone() + "\n");
    }
    let total: f64 = seconds.iter().map(in_seconds).sum();
    text += &with_short_numbers(format!(
        "\nabout {total:.0} s for {} x {} pixels on {} threads, judged by some of them; left out: what is certain to add less than {} of {} cd/m2\n",
        conditions.view.size[0],
        conditions.view.size[1],
        rayon::current_num_threads(),
        plan.tolerance,
        significant(conditions.least_luminance()),
    ));
    stdout::print(&text)
}

fn contribution(contribution: Contribution) -> String {
    match contribution {
        Contribution::Bound(value) => significant(value),
        Contribution::Estimate(value) => format!("about {} (estimate)", significant(value)),
        Contribution::Everything => "all".into(),
    }
}

/// Two significant digits.
fn significant(value: f64) -> String {
    match value {
        0.0 => "0".into(),
        v if !(0.01..1e7).contains(&v) => format!("{v:.1e}"),
        v if v < 10.0 => format!("{v:.2}"),
        v => format!("{v:.0}"),
    }
}
