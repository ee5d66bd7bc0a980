//! What an effect is: data and functions, no state.

use super::fields::Fields;
use super::kept::{Keep, Keeper};
use super::method::Method;
use super::pass::{Over, Pass, RasterView};
use super::settings::{Knob, Settings};
use crate::conditions::Conditions;
use crate::error::Result;
use crate::frame::Field;

/// What light does in one respect: data and functions, no state.
pub struct Effect {
    /// Its name, the same in the plan, the flags and the report; the stem of its file.
    pub name: &'static str,
    /// What it adds to the picture, in a few words.
    pub summary: &'static str,
    /// The fields that effects before it must have written.
    pub reads: &'static [Field],
    /// The fields it writes or adds to.
    pub writes: &'static [Field],
    /// The fields it changes where effects before it wrote them; one that nobody wrote is left alone.
    pub alters: &'static [Field],
    /// What its reference keeps from ray to ray and frame to frame, so that later ones cost less.
    pub keeps: &'static [&'static Keep],
    /// Which way of integrating sunlight in the air it is: of all that are one, a plan runs one.
    pub method: Option<Method>,
    /// What can be set by `--set <name>.<knob>=<value>`.
    pub knobs: &'static [Knob],
    /// Whether the scene calls for it, and what would be missing without it.
    pub decide: fn(&Conditions) -> Decision,
    /// The slow and exact way on the CPU, in f64: prepared once a frame, then run on batches of rays on all cores. Preparing it ends
    /// with an error when it was stopped.
    pub reference: for<'a> fn(&'a Conditions, &Settings<'_>, &Keeper<'_>) -> Result<Batch<'a>>,
    /// What a user may want to know of how a GPU does it; the reference tells its [`Keeper`].
    pub note: fn(&Conditions, &Settings<'_>) -> Option<String>,
    /// What it does on a GPU; empty: `reference` does it on the CPU there too.
    pub passes: &'static [Pass],
}

impl Effect {
    /// One that does nothing: what an effect does not say is as here.
    pub const NOTHING: Effect = Effect {
        name: "nothing",
        summary: "",
        reads: &[],
        writes: &[],
        alters: &[],
        keeps: &[],
        method: None,
        knobs: &[],
        decide: |_| Decision::nothing("there is nothing to do"),
        reference: |_, _, _| Ok(Box::new(|_| {})),
        note: |_, _| None,
        passes: &[],
    };

    /// Whether it draws the shadow maps of beams.
    pub fn draws_maps(&self) -> bool {
        let beam = |pass: &Pass| matches!(pass.over, Over::Raster(RasterView::Beam(_)));
        self.passes.iter().any(beam)
    }

    /// Whether a user who writes `name` means it: its own name, or `shafts` for all methods of integrating sunlight in air.
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name || (name == "shafts" && self.method.is_some())
    }
}

/// What an effect does to a batch of rays.
pub type Batch<'a> = Box<dyn Fn(&mut Fields) + Send + Sync + 'a>;

/// Whether a scene calls for an effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// Whether it runs.
    pub run: bool,
    /// Whether it could run at all (a skipped effect can be forced only then).
    pub possible: bool,
    /// Why.
    pub reason: String,
    /// The most that it can contribute to a pixel [cd/m2 of luminance].
    pub contribution: Contribution,
}

/// How much an effect can contribute to a pixel's luminance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Contribution {
    /// No pixel gets more [cd/m2].
    Bound(f64),
    /// A typical pixel gets about this much [cd/m2]; not a bound.
    Estimate(f64),
    /// Without it there is no picture.
    Everything,
}

impl Contribution {
    /// No pixel gets more than `bound`; where that is infinite, a typical one of these conditions.
    pub fn at_most(bound: f64, conditions: &Conditions) -> Self {
        match bound.is_finite() {
            true => Contribution::Bound(bound),
            false => Contribution::Estimate(conditions.typical_luminance()),
        }
    }
}

impl Decision {
    /// It runs.
    pub fn run(reason: impl Into<String>, contribution: Contribution) -> Self {
        Decision {
            run: true,
            possible: true,
            reason: reason.into(),
            contribution,
        }
    }

    /// There is nothing for it to do: it would add exactly nothing.
    pub fn nothing(reason: impl Into<String>) -> Self {
        Decision {
            run: false,
            possible: false,
            reason: reason.into(),
            contribution: Contribution::Bound(0.0),
        }
    }

    /// It adds nothing that this picture shows, though it could be run.
    pub fn skip(reason: impl Into<String>, contribution: Contribution) -> Self {
        Decision {
            run: false,
            possible: true,
            reason: reason.into(),
            contribution,
        }
    }
}
