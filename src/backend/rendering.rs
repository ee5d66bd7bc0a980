//! What a rendering may take and what it gives.

use crate::effect::{Effect, Paid};
use crate::frame::Frame;
use crate::task::{Progress, Task};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// The stage in which the picture itself is made, when what it needs is there.
pub const PICTURE: &str = "the picture";

/// What a rendering may take.
#[derive(Debug, Clone, Copy)]
pub struct Limits<'a> {
    /// The most that the finished frame may hold [bytes].
    pub memory: u64,
    /// Set by whoever wants the rendering to stop: it ends with [`crate::Error::Stopped`], at most some
    /// hundred pixels later; what is made for it and not done then is not kept.
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

    /// A rendering within these limits, as work of which `progress` is told.
    pub(super) fn task<'w>(&'w self, progress: Progress<'w>) -> Task<'w> {
        Task::new(progress, self.stop)
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
    /// What was done before the first ray.
    pub start_up: StartUp,
    /// From the first ray to the last, without what compiling took between them.
    pub elapsed: Duration,
    /// What effects say about what they made or used.
    pub notes: Vec<String>,
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
    /// Reads of shadow maps and leaves, and of nodes of trees, when they were counted ([`crate::backend::gpu::Gpu::count`]).
    pub counted: Option<[u64; 2]>,
    /// Rays that an effect with lamps paid for, where the CPU did it.
    pub paid: Option<Paid>,
    /// Its time: summed over cores under [`crate::backend::Backend::Reference`]; else the device's own clock, or the CPU's wall clock for what that
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

/// Wall time of what is done before the first ray: the scene comes onto a device, pipelines are compiled, effects prepare what they
/// keep. Nothing of it is there again for a picture that finds all of it made.
#[derive(Debug, Clone, Default)]
pub struct StartUp {
    stages: Vec<(String, Duration)>,
}

impl StartUp {
    /// Does something and adds the time that it takes to a stage.
    pub(super) fn timed<T>(&mut self, stage: &str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let made = work();
        self.add(stage, start.elapsed());
        made
    }

    /// Adds time to a stage.
    pub(super) fn add(&mut self, stage: &str, time: Duration) {
        match self.stages.iter_mut().find(|(known, _)| known == stage) {
            Some((_, sum)) => *sum += time,
            None => self.stages.push((stage.to_owned(), time)),
        }
    }

    /// The stages and their wall time, in the order in which they began.
    pub fn stages(&self) -> impl Iterator<Item = (&str, Duration)> {
        self.stages.iter().map(|(stage, time)| (&**stage, *time))
    }

    /// The time of all of them.
    pub fn time(&self) -> Duration {
        self.stages.iter().map(|(_, time)| *time).sum()
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
