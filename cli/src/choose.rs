//! `--max-error` and `--within`: the quality and the method that this picture needs, measured on this machine.

use crate::arguments::scene::PlanArgs;
use crate::backend::{Backend, BackendFlag};
use std::time::Instant;
use tyndall::accuracy;
use tyndall::conditions::Conditions;
use tyndall::effect::Method;
use tyndall::plan::{Plan, Quality};
use tyndall::reference::{Reference, predict};
use tyndall::{Error, Result};

/// Pixels at which candidates are compared with the reference.
const PIXELS: usize = 200;

/// What was chosen, and the measured reason in words.
pub struct Chosen {
    pub quality: Quality,
    /// How a GPU integrates sunlight in the air; `None` leaves it to the plan.
    pub method: Option<Method>,
    pub why: Option<String>,
}

/// The quality that the flags ask for.
///
/// # Errors
/// [`Error::Failed`] when even the finest quality is further off than `--max-error`, or even the coarsest takes longer than
/// `--within`.
pub fn quality(
    args: &PlanArgs,
    conditions: &Conditions,
    backend: BackendFlag,
    memory: u64,
) -> Result<Chosen> {
    match (args.max_error, args.within) {
        (Some(most), _) => by_error(args, conditions, backend, memory, most),
        (None, Some(limit)) => by_time(args, conditions, backend, memory, limit),
        (None, None) => Ok(Chosen {
            quality: args.quality,
            method: args.method.0,
            why: None,
        }),
    }
}

fn by_error(
    args: &PlanArgs,
    conditions: &Conditions,
    backend: BackendFlag,
    memory: u64,
    most: f64,
) -> Result<Chosen> {
    let yardstick = yardstick(args, conditions)?;
    let candidates = candidates(args, conditions, backend)?;
    let mut least = f64::INFINITY;
    for quality in Quality::ALL {
        let mut cheapest: Option<(f64, f64, Option<Method>)> = None;
        for method in &candidates {
            let plan = Plan::new(conditions, &args.overrules_with(quality, *method))?;
            let (error, seconds) = match Backend::new(backend)? {
                Backend::Reference => (accuracy::compare(&plan, &yardstick, PIXELS)?, 0.0),
                gpu => {
                    let done = gpu.render(&plan, memory, &|_| {})?;
                    let ours = done
                        .stages
                        .iter()
                        .filter(|(name, _)| name.starts_with("shafts_"));
                    let seconds = ours.map(|(_, seconds)| seconds).sum();
                    (accuracy::check(&done.frame, &yardstick, PIXELS)?, seconds)
                }
            };
            let error = error.picture().relative_rmse;
            least = least.min(error);
            if error <= most && cheapest.is_none_or(|(_, best, _)| seconds < best) {
                cheapest = Some((error, seconds, *method));
            }
        }
        if let Some((error, _, method)) = cheapest {
            let why = format!(
                "{}{}: relative RMSE {error:.1e} at {PIXELS} pixels, {most:.1e} asked for",
                quality.name(),
                method_words(method)
            );
            return Ok(Chosen {
                quality,
                method,
                why: Some(why),
            });
        }
    }
    Err(Error::failed(
        format!("no quality comes below --max-error {most}: the best has {least:.1e}"),
        "allow more, or set knobs with --set (`tyndall plan` lists them)",
    ))
}

/// What errors are measured against: the finest quality, without knobs of the user's.
fn yardstick<'c>(args: &PlanArgs, conditions: &'c Conditions) -> Result<Plan<'c>> {
    let mut finest = args.overrules_at(Quality::Reference);
    finest.set.clear();
    Plan::new(conditions, &finest)
}

fn method_words(method: Option<Method>) -> String {
    method.map_or(String::new(), |method| format!(", {}", method.name()))
}

/// The methods that are tried: the one that is asked for, or with `auto` on a GPU those that may be the cheapest.
fn candidates(
    args: &PlanArgs,
    conditions: &Conditions,
    backend: BackendFlag,
) -> Result<Vec<Option<Method>>> {
    let plan = Plan::new(conditions, &args.overrules())?;
    let has_shafts = plan.running().any(|step| step.effect.method.is_some());
    let on_gpu = !matches!(Backend::new(backend)?, Backend::Reference);
    Ok(match args.method.0 {
        None if has_shafts && on_gpu => [Method::Rectified, Method::Epipolar, Method::Prefiltered]
            .map(Some)
            .to_vec(),
        given => vec![given],
    })
}

fn by_time(
    args: &PlanArgs,
    conditions: &Conditions,
    backend: BackendFlag,
    memory: u64,
    limit: f64,
) -> Result<Chosen> {
    let yardstick = yardstick(args, conditions)?;
    let candidates = candidates(args, conditions, backend)?;
    let mut shortest = f64::INFINITY;
    let mut chosen: Option<(f64, Chosen)> = None;
    // From the coarsest on, as long as twice the time is left: a finer one takes about that or more.
    for quality in Quality::ALL {
        let mut best: Option<(f64, f64, Option<Method>)> = None;
        let mut quickest = f64::INFINITY;
        for method in &candidates {
            let plan = Plan::new(conditions, &args.overrules_with(quality, *method))?;
            let (milliseconds, done) = match Backend::new(backend)? {
                Backend::Reference => {
                    let stages = predict(&Reference::new(&plan));
                    let seconds: f64 = stages.iter().map(|s| s.time.as_secs_f64()).sum();
                    (1e3 * seconds, None)
                }
                gpu => {
                    let start = Instant::now();
                    let done = gpu.render(&plan, memory, &|_| {})?;
                    (1e3 * start.elapsed().as_secs_f64(), Some(done))
                }
            };
            quickest = quickest.min(milliseconds);
            shortest = shortest.min(milliseconds);
            if milliseconds > limit {
                continue;
            }
            // Of the methods that are quick enough the most exact one.
            let error = match &done {
                Some(done) => accuracy::check(&done.frame, &yardstick, PIXELS)?,
                None => accuracy::compare(&plan, &yardstick, PIXELS)?,
            };
            let error = error.picture().relative_rmse;
            if best.is_none_or(|(_, least, _)| error < least) {
                best = Some((milliseconds, error, *method));
            }
        }
        if let Some((milliseconds, error, method)) = best {
            let why = format!(
                "{}{}: about {milliseconds:.0} ms for one ray a pixel, {limit} allowed; relative RMSE {error:.1e} at {PIXELS} pixels",
                quality.name(),
                method_words(method)
            );
            // A finer quality by a coarser method may be no better.
            if chosen.as_ref().is_none_or(|(least, _)| error < *least) {
                let why = Some(why);
                let picked = Chosen {
                    quality,
                    method,
                    why,
                };
                chosen = Some((error, picked));
            }
        }
        if 2.0 * quickest > limit {
            break;
        }
    }
    if let Some((_, chosen)) = chosen {
        return Ok(chosen);
    }
    Err(Error::failed(
        format!("no quality stays within {limit} ms: draft takes about {shortest:.0}"),
        "allow more time, make the picture smaller, or leave effects out with --without",
    ))
}
