//! The quality and the method that a picture needs to come below an error, or to stay within a time: measured on this machine.

use super::check::Yardstick;
use super::interface::Backend;
use super::predict::predict;
use super::reference::Reference;
use super::rendering::{Limits, Rendered};
use crate::conditions::Conditions;
use crate::effect::{Kept, Method};
use crate::error::{Error, Result};
use crate::plan::{Overrules, Plan, Quality};
use crate::task::{Progress, Step, Task};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Pixels at which candidates are compared with the reference.
const PIXELS: usize = 200;

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// A relative RMSE of the picture's luminance of at most this [1].
    MaxError(f64),
    /// A time of at most this, in milliseconds: on a GPU of a frame of one ray a pixel, when all that is kept from frame to frame is
    /// there; on the CPU of the whole picture, from where choosing begins: loading the scene and opening the backend do not count.
    Within(f64),
}

/// What was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// What was asked for, with the quality and the method that were chosen.
    pub overrules: Overrules,
    /// The measured reason, in words.
    pub why: String,
}

/// A quality and a method.
type Choice = (Quality, Option<Method>);

/// The same, and what they were found to be worth.
#[derive(Clone, Copy)]
struct Candidate {
    quality: Quality,
    method: Option<Method>,
    error: f64,
    /// Of the whole picture, and of what integrates sunlight in the air [ms].
    picture: f64,
    air: f64,
}

impl Candidate {
    fn words(&self) -> String {
        let method = self
            .method
            .map_or(String::new(), |m| format!(", {}", m.name()));
        format!("{}{method}", self.quality.name())
    }
}

/// What candidates are measured with.
struct Trials<'t> {
    backend: &'t mut Backend,
    conditions: &'t Conditions,
    overrules: &'t Overrules,
    limits: &'t Limits<'t>,
    progress: Progress<'t>,
    /// The finest quality, without knobs of the user's, and what it makes of some pixels, once that was needed.
    finest: Plan<'t>,
    yardstick: Option<Yardstick>,
}

/// Chooses the quality, and the method where `overrules` leave it open, from the coarsest quality on. What `overrules` say of the
/// quality does not count.
///
/// # Errors
/// [`Error::Failed`] when even the finest quality is further off than asked for, or even the coarsest takes longer;
/// [`Error::Stopped`]; those of [`Plan::new`] and [`Backend::render`].
pub fn choose(
    backend: &mut Backend,
    conditions: &Conditions,
    overrules: &Overrules,
    goal: Goal,
    limits: &Limits,
    progress: Progress,
) -> Result<Chosen> {
    let mut trials = Trials {
        finest: Plan::new(conditions, &overrules.finest())?,
        yardstick: None,
        backend,
        conditions,
        overrules,
        limits,
        progress,
    };
    let ((quality, method), why) = match goal {
        Goal::MaxError(most) => trials.by_error(most)?,
        Goal::Within(limit) => match &*trials.backend {
            Backend::Gpu(_) => trials.by_time(limit)?,
            Backend::Reference(_) => trials.by_deadline(limit)?,
        },
    };
    Ok(Chosen {
        overrules: Overrules {
            quality,
            method,
            ..overrules.clone()
        },
        why,
    })
}

impl Trials<'_> {
    /// The methods that are tried: the one that is asked for, or on a GPU those that may be the cheapest.
    fn methods(&self) -> Result<Vec<Option<Method>>> {
        let plan = Plan::new(self.conditions, self.overrules)?;
        let has_shafts = plan.running().any(|step| step.effect.method.is_some());
        Ok(match (self.overrules.method, &*self.backend) {
            (None, Backend::Gpu(_)) if has_shafts => {
                [Method::Rectified, Method::Epipolar, Method::Prefiltered]
                    .map(Some)
                    .to_vec()
            }
            (given, _) => vec![given],
        })
    }

    /// Measures a candidate: its time, and its error if the time is within `limit` [ms].
    fn measure(
        &mut self,
        quality: Quality,
        method: Option<Method>,
        limit: f64,
    ) -> Result<Candidate> {
        let overrules = Overrules {
            quality,
            method,
            ..self.overrules.clone()
        };
        let plan = Plan::new(self.conditions, &overrules)?;
        let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
        // What candidates before it have left must not make one look quick.
        self.backend.forget();
        let (rendered, picture) = match &mut *self.backend {
            // Asking a part of the pixels is enough, and its time does not count.
            Backend::Reference(_) => (None, 0.0),
            gpu => {
                let rendered = gpu.render(&plan, self.limits, self.progress)?;
                let time = milliseconds(rendered.elapsed);
                (Some(rendered), time)
            }
        };
        let error = match &rendered {
            _ if picture > limit => f64::INFINITY,
            Some(rendered) => {
                let found = self.yardstick()?.check(&rendered.frame)?;
                found.picture().relative_rmse
            }
            None => {
                let task = Task::new(self.progress, self.limits.stop);
                let found = self.yardstick()?.compare(&plan, task)?;
                found.picture().relative_rmse
            }
        };
        let of_air = |rendered: &Rendered| -> Duration {
            let steps = rendered.steps.iter();
            let ours = steps.filter(|step| step.effect.method.is_some());
            ours.filter_map(|step| step.time).sum()
        };
        Ok(Candidate {
            quality,
            method,
            error,
            picture,
            air: milliseconds(rendered.as_ref().map_or(Duration::ZERO, of_air)),
        })
    }

    /// The truth, which is the same for all candidates.
    fn yardstick(&mut self) -> Result<&Yardstick> {
        Ok(match &mut self.yardstick {
            Some(found) => found,
            none => {
                let task = Task::new(self.progress, self.limits.stop);
                none.insert(Yardstick::new(&self.finest, PIXELS, task)?)
            }
        })
    }

    /// The coarsest quality that is exact enough, by its cheapest method.
    fn by_error(&mut self, most: f64) -> Result<(Choice, String)> {
        let methods = self.methods()?;
        let mut least = f64::INFINITY;
        for quality in Quality::ALL {
            let mut cheapest: Option<Candidate> = None;
            for method in &methods {
                let tried = self.measure(quality, *method, f64::INFINITY)?;
                least = least.min(tried.error);
                if tried.error <= most && cheapest.is_none_or(|best| tried.air < best.air) {
                    cheapest = Some(tried);
                }
            }
            if let Some(chosen) = cheapest {
                let why = format!(
                    "{}: relative RMSE {:.1e} at {PIXELS} pixels, {most:.1e} asked for",
                    chosen.words(),
                    chosen.error
                );
                return Ok(((chosen.quality, chosen.method), why));
            }
        }
        Err(Error::failed(
            format!("no quality comes below --max-error {most}: the best has {least:.1e}"),
            "allow more, or set knobs with --set (`tyndall plan` lists them)",
        ))
    }

    /// The most exact of what a device is quick enough for.
    fn by_time(&mut self, limit: f64) -> Result<(Choice, String)> {
        let methods = self.methods()?;
        let mut shortest = f64::INFINITY;
        let mut chosen: Option<Candidate> = None;
        // From the coarsest on, as long as twice the time is left: a finer one takes about that or more.
        for quality in Quality::ALL {
            let mut quickest = f64::INFINITY;
            for method in &methods {
                let tried = self.measure(quality, *method, limit)?;
                quickest = quickest.min(tried.picture);
                // A finer quality by a coarser method may be no better.
                if tried.picture <= limit && chosen.is_none_or(|best| tried.error < best.error) {
                    chosen = Some(tried);
                }
            }
            shortest = shortest.min(quickest);
            if 2.0 * quickest > limit {
                break;
            }
        }
        let Some(chosen) = chosen else {
            return Err(too_slow(limit, &format!("takes about {shortest:.0}")));
        };
        let why = format!(
            "{}: about {:.0} ms for one ray a pixel, {limit} allowed; relative RMSE {:.1e} at {PIXELS} pixels",
            chosen.words(),
            chosen.picture,
            chosen.error
        );
        Ok(((chosen.quality, chosen.method), why))
    }

    /// The finest quality of which the CPU is done in time, from here on: what was prepared for it stays, and a finer one is tried only as
    /// long as there is time for the one before.
    fn by_deadline(&mut self, limit: f64) -> Result<(Choice, String)> {
        let begun = Instant::now();
        let gone = || 1e3 * begun.elapsed().as_secs_f64();
        let allowed = Duration::from_secs_f64((limit / 1e4).min(1.0));
        let is_asked = || self.limits.stop.is_some_and(|s| s.load(Ordering::Relaxed));
        let mut chosen: Option<(Quality, f64, Kept)> = None;
        let mut draft = "is not even prepared by then".to_owned();
        for quality in Quality::ALL {
            let overrules = Overrules {
                quality,
                ..self.overrules.clone()
            };
            let plan = Plan::new(self.conditions, &overrules)?;
            let (tried, kept) = (gone(), Kept::default());
            let needed = chosen.as_ref().map_or(0.0, |(_, rays, _)| *rays);
            let stop = AtomicBool::new(false);
            let watch = |step: Step| {
                (self.progress)(step);
                if is_asked() || gone() + needed > limit {
                    stop.store(true, Ordering::Relaxed);
                }
            };
            let prepared = Reference::keeping(&plan, &kept, Task::new(&watch, Some(&stop)));
            let reference = match prepared {
                Err(Error::Stopped) if !is_asked() => break,
                other => other?,
            };
            let steps = predict(&reference, allowed);
            let rays: f64 = steps
                .iter()
                .filter_map(|step| step.time)
                .map(|t| 1e3 * t.as_secs_f64())
                .sum();
            let done = gone();
            if chosen.is_none() {
                draft = format!("takes about {:.0}", done + rays);
            }
            if done + rays > limit {
                break;
            }
            chosen = Some((quality, rays, kept));
            // A finer one takes about twice that or more.
            if done + 2.0 * (done - tried + rays) > limit {
                break;
            }
        }
        let Some((quality, rays, kept)) = chosen else {
            return Err(too_slow(limit, &draft));
        };
        *self.backend = Backend::Reference(kept);
        let why = format!(
            "{}: about {:.0} ms with what has gone by, {limit} allowed",
            quality.name(),
            gone() + rays
        );
        Ok(((quality, self.overrules.method), why))
    }
}

fn too_slow(limit: f64, draft: &str) -> Error {
    Error::failed(
        format!("no quality stays within {limit} ms: draft {draft}"),
        "allow more time, make the picture smaller, or leave effects out with --without",
    )
}
