//! Tasks that take long: each tells how far it is, and ends early when it is asked to.

use crate::error::{Error, Result};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How far a task is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// What is being done: the picture, or a result that it needs and that is kept for others. Stages follow each other.
    pub stage: &'static str,
    /// How much of the stage is done, 0 to 1.
    pub share: f64,
    /// Where the same stages are done several times: which time it is, from 1, and how many there are.
    pub turn: Option<[usize; 2]>,
}

/// Called now and then, from any thread.
pub type Progress<'a> = &'a (dyn Fn(Step) + Sync);

/// A stage of a task, or a part of one.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    stage: &'static str,
    /// Which part of the stage it is.
    part: [f64; 2],
    turn: Option<[usize; 2]>,
    progress: Progress<'a>,
    stop: Option<&'a AtomicBool>,
}

/// How often a part that is counted tells how far it is.
const TOLD: usize = 128;

impl<'a> Task<'a> {
    /// One that tells `progress` how far it is, and that ends soon after `stop` was set.
    pub fn new(progress: Progress<'a>, stop: Option<&'a AtomicBool>) -> Self {
        Task {
            stage: "all of it",
            part: [0.0, 1.0],
            turn: None,
            progress,
            stop,
        }
    }

    /// One of which nobody wants to know, and that nobody stops.
    pub fn unwatched() -> Self {
        Task::new(&|_| {}, None)
    }

    /// A stage of it, by its name.
    pub fn stage(self, stage: &'static str) -> Self {
        let part = [0.0, 1.0];
        Task {
            stage,
            part,
            ..self
        }
    }

    /// One of several times that the same stages are done, from 1.
    pub fn turn(self, number: usize, of: usize) -> Self {
        let turn = Some([number, of]);
        Task { turn, ..self }
    }

    /// The part of it between two shares, 0 to 1.
    pub fn part(self, from: f64, to: f64) -> Self {
        let [low, high] = self.part;
        let part = [from, to].map(|share| low + share * (high - low));
        Task { part, ..self }
    }

    /// Whether to go on.
    ///
    /// # Errors
    /// [`Error::Stopped`] when it was asked to stop.
    pub fn check(&self) -> Result<()> {
        match self.stop {
            Some(stop) if stop.load(Ordering::Relaxed) => Err(Error::Stopped),
            _ => Ok(()),
        }
    }

    /// Says that a share of it is done, 0 to 1.
    pub fn tell(&self, share: f64) {
        let [low, high] = self.part;
        (self.progress)(Step {
            stage: self.stage,
            share: low + share.clamp(0.0, 1.0) * (high - low),
            turn: self.turn,
        });
    }

    /// It as so many equal pieces, which any thread may do.
    pub fn pieces(self, count: usize) -> Pieces<'a> {
        Pieces {
            task: self,
            count,
            begun: AtomicUsize::new(0),
        }
    }
}

/// Equal pieces of a task.
pub struct Pieces<'a> {
    task: Task<'a>,
    count: usize,
    begun: AtomicUsize,
}

impl Pieces<'_> {
    /// Begins one more.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the work was asked to stop.
    pub fn begin(&self) -> Result<()> {
        self.task.check()?;
        let before = self.begun.fetch_add(1, Ordering::Relaxed);
        let told = |begun: usize| TOLD * begun / self.count.max(1);
        if before == 0 || told(before) > told(before - 1) {
            self.task.tell(before as f64 / self.count.max(1) as f64);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn parts_of_a_stage_go_from_its_beginning_to_its_end() {
        let told = Mutex::new(Vec::new());
        let progress = |step: Step| told.lock().unwrap().push(step);
        let task = Task::new(&progress, None).stage("a stage");
        for part in [task.part(0.0, 0.25), task.part(0.25, 1.0)] {
            let pieces = part.pieces(1000);
            for _ in 0..1000 {
                assert!(pieces.begin().is_ok());
            }
        }
        task.tell(1.0);
        let told = told.into_inner().unwrap();
        assert!(told.iter().all(|step| step.stage == "a stage"));
        assert!(told.is_sorted_by(|a, b| a.share <= b.share));
        let shares = [told[0].share, told[128].share, told[told.len() - 1].share];
        assert_eq!(shares, [0.0, 0.25, 1.0]);
        assert!(told.len() <= 2 * TOLD + 1);
    }

    #[test]
    fn no_piece_begins_after_a_stop() {
        let stop = AtomicBool::new(false);
        let pieces = Task::new(&|_| {}, Some(&stop)).pieces(2);
        assert!(pieces.begin().is_ok());
        stop.store(true, Ordering::Relaxed);
        assert!(matches!(pieces.begin(), Err(Error::Stopped)));
    }
}
