//! One interface to both backends.

use super::gpu::{Choice, Device, Gpu, OnDevice};
use super::reference::Reference;
use super::rendering::{Limits, Rendered};
use crate::conditions::Conditions;
use crate::effect::Kept;
use crate::error::{Error, Result};
use crate::frame::Record;
use crate::plan::{Overrules, Plan};
use crate::task::Progress;

/// Which backend is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wanted {
    /// A hardware adapter, else the reference.
    #[default]
    Auto,
    /// A graphics adapter, of software if there is no other.
    Gpu,
    /// The reference.
    Reference,
}

/// What computes.
pub enum Backend {
    /// A device.
    Gpu(Box<Gpu>),
    /// The CPU, with what effects keep there.
    Reference(Kept),
}

impl Backend {
    /// Opens what is wanted.
    ///
    /// # Errors
    /// Those of [`Device::open`] when a GPU is wanted, of [`Device::open_if_any`] when one is found.
    pub fn open(wanted: Wanted) -> Result<Self> {
        let device = match wanted {
            Wanted::Reference => None,
            // The drivers are asked once.
            Wanted::Auto => Device::open_if_any(Choice::Hardware)?,
            Wanted::Gpu => Some(Device::open(Choice::Any)?),
        };
        Ok(match device {
            Some(device) => Backend::Gpu(Box::new(Gpu::new(device))),
            None => Backend::Reference(Kept::default()),
        })
    }

    /// In words.
    pub fn describe(&self) -> String {
        match self {
            Backend::Gpu(gpu) => {
                let adapter = &gpu.device().adapter;
                format!(
                    "gpu ({}, {}, {})",
                    adapter.name,
                    adapter.kind.words(),
                    adapter.backend
                )
            }
            Backend::Reference(_) => {
                format!(
                    "reference (CPU, f64, {} threads)",
                    rayon::current_num_threads()
                )
            }
        }
    }

    /// What computes, as far as pictures depend on it: two of the same identity make the same picture to the last bit. How many
    /// threads there are does not count.
    pub fn identity(&self) -> String {
        match self {
            Backend::Gpu(gpu) => {
                let adapter = &gpu.device().adapter;
                format!("{} {} {}", adapter.backend, adapter.name, adapter.driver)
            }
            Backend::Reference(_) => "reference".to_owned(),
        }
    }

    /// Says in a picture's record how it came about, beside what its rendering has said already.
    pub fn record(&self, plan: &Plan, record: &mut Record) {
        record.set("version", env!("CARGO_PKG_VERSION"));
        for (name, value) in plan.conditions.facts() {
            record.set(name, value);
        }
        let method = plan.running().find_map(|step| step.effect.method);
        let method = match self {
            // It is exact and knows none of the methods.
            Backend::Reference(_) => "exact lit runs (reference)",
            Backend::Gpu(_) => method.map_or("none", |method| method.name()),
        };
        record.set("method", method);
        // Those that do not run now too: no attribute of a file comes and goes in a sequence.
        for step in plan.counted() {
            for (knob, value) in &step.settings {
                record.set(format!("{}.{knob}", step.effect.name), *value);
            }
        }
    }

    /// Renders a plan.
    ///
    /// # Errors
    /// Those of [`Gpu::render`] and [`Reference::render`].
    pub fn render(&mut self, plan: &Plan, limits: &Limits, progress: Progress) -> Result<Rendered> {
        match self {
            Backend::Gpu(gpu) => gpu.render(plan, limits, progress),
            Backend::Reference(kept) => {
                // What a rendering that was stopped has made is not made for this one.
                kept.take_made();
                kept.take_notes();
                let mut rendered = Reference::keeping(plan, kept, limits.task(progress))?
                    .render(limits, progress)?;
                rendered.made.products = kept.take_made();
                rendered.notes.extend(kept.take_notes());
                Ok(rendered)
            }
        }
    }

    /// Renders many moments or views one after the other; `each` is given every one's number, plan and picture, and says whether
    /// to go on. `progress` is that of the picture at hand.
    ///
    /// # Errors
    /// Those of the conditions, of [`Plan::new`], of [`Backend::render`], and of `each`; what was rendered before is with `each`
    /// already.
    pub fn render_all(
        &mut self,
        moments: impl IntoIterator<Item = Result<Conditions>>,
        overrules: &Overrules,
        limits: &Limits,
        progress: Progress,
        mut each: impl FnMut(usize, &Plan, Rendered) -> Result<std::ops::ControlFlow<()>>,
    ) -> Result<()> {
        for (number, conditions) in moments.into_iter().enumerate() {
            let conditions = conditions?;
            let plan = Plan::new(&conditions, overrules)?;
            let rendered = self.render(&plan, limits, progress)?;
            if each(number, &plan, rendered)?.is_break() {
                break;
            }
        }
        Ok(())
    }

    /// Renders a plan and leaves the picture where it is shown.
    ///
    /// # Errors
    /// Those of [`Gpu::render_on_device`]; [`Error::Failed`] without a device.
    pub fn render_on_device(
        &mut self,
        plan: &Plan,
        limits: &Limits,
        progress: Progress,
    ) -> Result<(OnDevice, Rendered)> {
        match self {
            Backend::Gpu(gpu) => gpu.render_on_device(plan, limits, progress),
            Backend::Reference(_) => Err(Error::failed(
                "the reference has no device on which a picture could stay",
                "open the backend `gpu`, or take the frame",
            )),
        }
    }

    /// Drops all results that are kept, so that the next picture starts afresh.
    pub fn forget(&mut self) {
        match self {
            Backend::Gpu(gpu) => gpu.forget(),
            Backend::Reference(kept) => kept.forget(),
        }
    }
}
