//! What is said on standard error: what was understood, decided and done.

use crate::progress::Bar;
use serde_json::json;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;
use tyndall::Error;
use tyndall::backend::convergence::Convergence;
use tyndall::backend::{Rendered, Step};
use tyndall::conditions::Conditions;
use tyndall::effect::{Contribution, Paid};
use tyndall::plan::{self, Overrules, Plan};
use tyndall::task::Task;
use tyndall::timelapse::cluster;
use tyndall::timelapse::film::Maker;
use tyndall::warning::Warning;

/// How much is said beside warnings and errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Talk {
    /// Nothing.
    Quiet,
    /// What people want to know.
    #[default]
    Usual,
    /// All there is.
    Verbose,
}

static TALK: OnceLock<Talk> = OnceLock::new();

/// Says once, at the beginning, how much is said.
pub fn set(talk: Talk) {
    // Who comes second has no say.
    let _ = TALK.set(talk);
}

fn talk() -> Talk {
    TALK.get().copied().unwrap_or_default()
}

/// A line of what is said, with what it is about in front.
pub fn line(label: &str, text: impl std::fmt::Display) {
    if talk() != Talk::Quiet {
        always(label, text);
    }
}

/// A line that is said however little else is.
fn always(label: &str, text: impl std::fmt::Display) {
    eprintln!("{label:<11}{}", clean(&text.to_string()));
}

/// A text in one line, without what a terminal would obey: names come out of files of strangers.
pub fn clean(text: &str) -> String {
    let obeyed =
        |c: char| c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    text.chars()
        .map(|c| match c {
            '\t' => ' ',
            c if obeyed(c) => char::REPLACEMENT_CHARACTER,
            c => c,
        })
        .collect()
}

/// What went wrong and what to do about it.
pub fn error(error: &Error) {
    let (problem, remedy) = (clean(&error.problem()), clean(&error.remedy()));
    eprintln!("error: {problem}\n  help: {remedy}");
}

/// Place, time, sun, sky, camera and warnings.
pub fn conditions(conditions: &Conditions) {
    conditions_without(conditions, &[]);
}

/// The same without the lines of some labels.
pub fn conditions_without(conditions: &Conditions, left_out: &[&str]) {
    for (label, text) in conditions.lines() {
        if !left_out.contains(&label) {
            line(label, text);
        }
    }
    let chosen = &*conditions.view.chosen;
    let suggested = match chosen {
        "" => Some("none given; this one frames the scene:".to_owned()),
        found if found.starts_with("found") => Some(format!("{found}:")),
        _ => None,
    };
    if let Some(words) = suggested {
        line("camera", words);
        for part in conditions.view.camera.to_toml().lines() {
            line("", part);
        }
    }
    warnings(&conditions.warnings);
}

/// What was left out, is doubtful or approximate, and what can be done about it.
pub fn warnings(warnings: &[Warning]) {
    for warning in warnings {
        always("warning", warning);
        if let Some(advice) = warning.advice() {
            always("", format!("help: {advice}"));
        }
    }
}

/// Warnings about many moments: each kind once, with the first of its moments.
pub fn warnings_since(warnings: impl Iterator<Item = (String, Warning)>) {
    let mut said = Vec::new();
    for (moment, warning) in warnings {
        let kind = std::mem::discriminant(&warning);
        if !said.contains(&kind) {
            said.push(kind);
            always("warning", format!("from {moment} on: {warning}"));
            if let Some(advice) = warning.advice() {
                always("", format!("help: {advice}"));
            }
        }
    }
}

/// Which effects run, and which do not that one might have expected: all of them with `--verbose`.
///
/// Expected is what could run and is left out, what the sun would do if it shone, and what a knob is set of.
pub fn plan(plan: &Plan, overrules: &Overrules, backend: &str) {
    line("backend", backend);
    let running: Vec<&str> = plan.running().map(|step| step.effect.name).collect();
    line("effects", running.join(", "));
    // Of a sun that was given no light, nobody expects any.
    let is_unlit = plan.conditions.scene.sun.as_ref();
    let is_unlit = is_unlit.is_some_and(|sun| sun.illuminance == Some(0.0));
    let missing = plan.conditions.sun.missing().filter(|_| !is_unlit);
    let is_set = |step: &plan::Step| {
        let mut names = overrules
            .set
            .iter()
            .filter_map(|(target, _)| target.split_once('.'));
        let served = |name: &str| plan.running().any(|other| other.effect.is_called(name));
        names.any(|(name, _)| step.effect.is_called(name) && !served(name))
    };
    let is_expected = |step: &&plan::Step| {
        let reason = &*step.decision.reason;
        talk() == Talk::Verbose || step.decision.possible || is_set(step) || missing == Some(reason)
    };
    // Those of one reason share a line.
    let mut skipped: Vec<(&str, Vec<&str>)> = Vec::new();
    let left_out = plan.steps.iter().filter(|step| !step.decision.run);
    for step in left_out.filter(is_expected) {
        let (name, reason) = (step.effect.name, &*step.decision.reason);
        match skipped.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, names)) => names.push(name),
            None => skipped.push((reason, vec![name])),
        }
    }
    for (reason, names) in skipped {
        line("skipped", format!("{}: {reason}", names.join(", ")));
    }
}

/// The quality that was chosen by measuring.
pub fn chosen(why: &str) {
    line("quality", why);
}

/// The plan for scripts.
pub fn plan_json(plan: &Plan) -> serde_json::Value {
    plan.steps
        .iter()
        .map(|step| {
            let (kind, value) = match step.decision.contribution {
                Contribution::Bound(value) => ("bound", finite(value)),
                Contribution::Estimate(value) => ("estimate", finite(value)),
                Contribution::Everything => ("everything", None),
            };
            json!({
                "effect": step.effect.name,
                "summary": step.effect.summary,
                "run": step.decision.run,
                "reason": step.decision.reason,
                "contribution": { "kind": kind, "cd_per_m2": value },
                "settings": step.settings.iter().map(|(k, v)| (k.to_string(), json!(v)))
                    .collect::<serde_json::Map<_, _>>(),
            })
        })
        .collect()
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Shows how far the work is, unless nothing is to be said.
pub fn bar() -> Bar {
    match talk() {
        Talk::Quiet => Bar::Silent,
        _ => Bar::new(|words| line("progress", words)),
    }
}

/// Shows what a task is doing, until `stop` is set.
pub fn watched<T>(stop: Option<&AtomicBool>, work: impl FnOnce(Task) -> T) -> T {
    let bar = bar();
    let progress = |step: Step| bar.step(step);
    work(Task::new(&progress, stop))
}

/// How long the stages of the work took.
pub fn stages(stages: &[(String, f64)]) {
    let total: f64 = stages.iter().map(|(_, seconds)| seconds).sum();
    let parts: Vec<String> = stages
        .iter()
        .filter(|(_, seconds)| *seconds >= 0.05)
        .map(|(name, seconds)| format!("{name} {seconds:.1}"))
        .collect();
    line("time", format!("{total:.1} s ({})", parts.join(", ")));
}

/// How long it took.
pub fn rendered(rendered: &Rendered, ev100: f64, stages: &[(String, f64)]) {
    self::stages(stages);
    if rendered.refined > 0 {
        line(
            "samples",
            format!("{} pixels at edges resampled", rendered.refined),
        );
    }
    for step in &rendered.steps {
        if let Some(Paid { rays, met, pairs }) = step.paid {
            let name = step.effect.name;
            line(
                "lamps",
                format!(
                    "{name}: {met} of {rays} rays met the light of one, {pairs} of lamps in all"
                ),
            );
        }
    }
    for note in &rendered.notes {
        line("light", note);
    }
    line("exposure", format!("EV100 {ev100:.2}"));
}

/// How far points of the sun's disc are from converged.
pub fn convergence(convergence: &Convergence) {
    let layers = convergence.layers.iter();
    let layers: Vec<String> = layers
        .map(|layer| {
            let [_, high] = layer.interval;
            format!(
                "{} by {:.1e} RMS (at most {high:.1e})",
                layer.layer, layer.relative_rmse
            )
        })
        .collect();
    line(
        "converged",
        format!(
            "{} points of the sun's disc: half as many change {}, on {} pixels",
            convergence.points,
            layers.join(", "),
            convergence.pixels
        ),
    );
}

/// What makes a film, with its line where it is another program.
pub fn film(maker: &Maker, program: &[OsString]) {
    line("film", maker);
    if !program.is_empty() {
        let words: Vec<_> = program.iter().map(|word| word.to_string_lossy()).collect();
        line("", cluster::shell_line(&words));
    }
}

/// What was written.
pub fn files(files: &[PathBuf]) {
    if files.is_empty() {
        return;
    }
    let names: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
    line("wrote", names.join(", "));
}

/// The measured error: a result, which is said however little else is.
pub fn check(lines: &[String]) {
    for (i, text) in lines.iter().enumerate() {
        always(if i == 0 { "check" } else { "" }, text);
    }
}
