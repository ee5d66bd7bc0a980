//! What computes pictures: a GPU, or the reference on the CPU. One interface for whoever renders: the command line, studies, a
//! time-lapse, a viewer.
//!
//! A backend lasts over plans. Opening a device and compiling happen once a process; what a plan needs and the one before it had
//! is used again, as far as what it was made of is the same ([`Made`] tells what was not). So many pictures are rendered by one
//! backend over conditions that share what they can ([`Conditions::at`], [`Conditions::seen_from`]).
//!
//! | module | what |
//! |---|---|
//! | [`reference`] | every effect in f64 on all cores, by its own exact way: the yardstick |
//! | [`gpu`] | the effects' passes on a device |
//! | `film` | the picture as it grows |
//! | [`check`] | how far a picture is from the reference |
//! | [`choose`] | the quality and the method that an error or a time asks for, measured |

pub mod check;
pub mod choose;
mod film;
pub mod gpu;
pub mod reference;

use crate::conditions::Conditions;
use crate::effect::{Effect, Kept};
use crate::error::{Error, Result};
use crate::frame::Frame;
use crate::plan::{Overrules, Plan};
use gpu::{Choice, Gpu, OnDevice, adapters};
use reference::Reference;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Called with the share of the work that is done, 0 to 1.
pub type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// What a rendering may take.
#[derive(Debug, Clone, Copy)]
pub struct Limits<'a> {
    /// The most that the finished frame may hold [bytes].
    pub memory: u64,
    /// Set by whoever wants the rendering to stop: it ends within a tile or a band of rows with [`Error::Stopped`].
    pub stop: Option<&'a AtomicBool>,
}

impl Limits<'_> {
    /// A frame of at most so many bytes.
    pub fn memory(bytes: u64) -> Self {
        Limits {
            memory: bytes,
            stop: None,
        }
    }

    /// Whether to go on.
    fn check(&self) -> Result<()> {
        match self.stop {
            Some(stop) if stop.load(Ordering::Relaxed) => Err(Error::Stopped),
            _ => Ok(()),
        }
    }
}

impl Default for Limits<'_> {
    /// Frames of at most 8 GiB.
    fn default() -> Self {
        Limits::memory(8 << 30)
    }
}

/// A finished rendering.
#[derive(Debug, Clone, Default)]
pub struct Rendered {
    /// The picture.
    pub frame: Frame,
    /// What ran, in order.
    pub steps: Vec<StepTime>,
    /// Bytes allocated on a device so far, and moved for this picture.
    pub traffic: Traffic,
    /// Pixels that were resampled with more rays.
    pub refined: usize,
    /// What had to be made for this picture and is kept.
    pub made: Made,
    /// From the first ray to the last.
    pub elapsed: Duration,
}

/// A part of the work.
#[derive(Clone)]
pub struct StepTime {
    /// The effect.
    pub effect: &'static Effect,
    /// The pass's entry point, or `reference` for what the CPU did.
    pub pass: &'static str,
    /// Whether the CPU did it.
    pub on_cpu: bool,
    /// How often it ran.
    pub runs: u32,
    /// Reads of shadow maps and leaves, and of nodes of trees, when they were counted ([`Gpu::count`]).
    pub counted: Option<[u64; 2]>,
    /// Its time: summed over cores under [`Backend::Reference`]; else the device's own clock, or the CPU's wall clock for what that
    /// did, a software adapter too. `None` when the device has no clock.
    pub time: Option<Duration>,
}

impl std::fmt::Debug for StepTime {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = format!("{}.{}", self.effect.name, self.pass);
        let told = (self.on_cpu, self.runs, self.counted, self.time);
        f.debug_tuple(&name).field(&told).finish()
    }
}

/// Bytes that were allocated and moved.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traffic {
    /// In buffers and textures on the device.
    pub allocated: u64,
    /// To the device.
    pub uploaded: u64,
    /// From the device.
    pub downloaded: u64,
}

/// What had to be made for a picture and is kept for those that follow.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Made {
    /// Pipelines that were compiled.
    pub pipelines: usize,
    /// Whether the scene came onto the device.
    pub scene: bool,
    /// Shadow maps that were drawn.
    pub maps: u32,
    /// Results of effects, by name.
    pub products: Vec<&'static str>,
}

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
    /// Those of [`gpu::Device::open`] when a GPU is wanted.
    pub fn open(wanted: Wanted) -> Result<Self> {
        let choice = match wanted {
            Wanted::Reference => return Ok(Backend::Reference(Kept::default())),
            Wanted::Auto if adapters::automatic(&adapters::report()).is_none() => {
                return Ok(Backend::Reference(Kept::default()));
            }
            Wanted::Auto => Choice::Hardware,
            Wanted::Gpu => Choice::Any,
        };
        Ok(Backend::Gpu(Box::new(Gpu::open(choice)?)))
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

    /// Renders a plan.
    ///
    /// # Errors
    /// Those of [`Gpu::render`] and [`Reference::render`].
    pub fn render(&mut self, plan: &Plan, limits: &Limits, progress: Progress) -> Result<Rendered> {
        match self {
            Backend::Gpu(gpu) => gpu.render(plan, limits, progress),
            Backend::Reference(kept) => {
                let mut rendered = Reference::keeping(plan, kept).render(limits, progress)?;
                rendered.made.products = kept.take_made();
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
    pub fn render_on_device(&mut self, plan: &Plan, limits: &Limits) -> Result<OnDevice> {
        match self {
            Backend::Gpu(gpu) => gpu.render_on_device(plan, limits),
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
