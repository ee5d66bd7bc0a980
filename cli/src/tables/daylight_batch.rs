//! `tyndall daylight --points`: the illuminance of every row of a CSV.

use std::path::Path;

use glam::DVec3;
use tyndall::backend::choose::{Goal, choose};
use tyndall::backend::{Backend, Limits};
use tyndall::colour::luminance;
use tyndall::conditions::{Conditions, Receiver, View};
use tyndall::frame::{Field, Frame, Record};
use tyndall::plan::{Overrules, Plan};
use tyndall::scene::hints;
use tyndall::{Error, Result};

use crate::tables::batch::{Batch, Row};
use crate::tables::printer::{Form, Tally};
use crate::tables::together::Together;
use crate::tables::work;
use crate::tell;

/// The columns of a scene without lamps, and with them.
static BATCHES: [Batch; 2] = [
    of_results(&["illuminance", "sun", "sky", "indirect"]),
    of_results(&["illuminance", "sun", "sky", "indirect", "lights"]),
];

const fn of_results(results: &'static [&'static str]) -> Batch {
    Batch {
        known: &["x", "y", "z", "nx", "ny", "nz"],
        words: 0,
        required: 3,
        results,
    }
}

/// The layers that have a column of their own, in the order of the results behind their sum; the last where there are lamps.
pub const LAYERS: [Field; 4] = [Field::Sun, Field::Sky, Field::Indirect, Field::Lights];

/// Finds the illuminance of points, piece by piece with one backend: what the first has made serves all.
pub struct Meter<'a> {
    /// The scene at its moment, from anywhere.
    pub conditions: &'a Conditions,
    /// What computes.
    pub backend: Backend,
    /// The accuracy that is asked for.
    pub overrules: Overrules,
    /// What it is chosen by, if not by the user; it is chosen for the first piece.
    pub goal: Option<Goal>,
    /// The most that a rendering may use.
    pub limits: Limits<'a>,
    /// What has been done so far.
    pub done: Done,
}

/// What has been done.
#[derive(Default)]
pub struct Done {
    /// Points that have their illuminance.
    pub points: usize,
    /// The stages of the work and their wall time so far [s].
    pub stages: Vec<(String, f64)>,
    /// Time of rendering alone [s].
    pub seconds: f64,
    /// What the first piece says of how it came about, of the plan and of the work, which made what the others use again.
    pub first: Option<(Record, serde_json::Value, serde_json::Value)>,
}

impl Meter<'_> {
    /// Reads `path` (`-` is standard input) and prints every row with its illuminance [lx].
    pub fn run(&mut self, path: &Path, form: Form) -> Result<Tally> {
        let [without, with] = &BATCHES;
        match self.conditions.lamps.is_empty() {
            true => without.run_together(path, form, self),
            false => with.run_together(path, form, self),
        }
    }

    /// Chooses the quality, if it is to be chosen, for the points at hand and all that follow.
    fn choose(&mut self, conditions: &Conditions) -> Result<()> {
        if let Some(goal) = self.goal.take() {
            let (backend, limits) = (&mut self.backend, &self.limits);
            let bar = tell::bar();
            let step = |step| bar.step(step);
            let chosen = choose(backend, conditions, &self.overrules, goal, limits, &step)?;
            drop(bar);
            tell::chosen(&chosen.why);
            self.overrules = chosen.overrules;
        }
        Ok(())
    }
}

impl Together for Meter<'_> {
    type Asked = Receiver;

    fn read(row: &Row) -> Result<Receiver> {
        let position = DVec3::new(row.needed(0)?, row.needed(1)?, row.needed(2)?);
        let normal = match [row.number(3)?, row.number(4)?, row.number(5)?] {
            [None, None, None] => DVec3::Y,
            [Some(x), Some(y), Some(z)] => DVec3::new(x, y, z),
            _ => {
                return Err(row.error(
                    "only some of nx, ny, nz are given",
                    "give all three, or none for a point that looks up",
                ));
            }
        };
        Receiver::new(position, normal).map_err(|error| row.here(error))
    }

    fn of(&mut self, points: Vec<Receiver>) -> Result<Vec<f64>> {
        let count = points.len();
        if self.done.first.is_none() {
            let places: Vec<DVec3> = points.iter().map(|point| point.position).collect();
            tell::warnings(hints::of_points(&self.conditions.geometry, &places).as_slice());
        }
        let conditions = self.conditions.seen_from(View::of_points(points))?;
        self.choose(&conditions)?;
        let plan = Plan::new(&conditions, &self.overrules)?;
        if self.done.first.is_none() {
            tell::plan(&plan, &self.overrules, &self.backend.describe());
        }
        let bar = tell::bar();
        let step = |step| bar.step(step);
        let mut rendered = self.backend.render(&plan, &self.limits, &step)?;
        drop(bar);
        let stages = work::stages(&self.backend, &rendered);
        let done = &mut self.done;
        done.points += count;
        done.seconds += rendered.elapsed.as_secs_f64();
        for (name, seconds) in stages {
            match done.stages.iter_mut().find(|(known, _)| *known == name) {
                Some((_, sum)) => *sum += seconds,
                None => done.stages.push((name, seconds)),
            }
        }
        if done.first.is_none() {
            self.backend.record(&plan, &mut rendered.frame.record);
            let details = work::details(&self.backend, &rendered);
            let record = std::mem::take(&mut rendered.frame.record);
            done.first = Some((record, tell::plan_json(&plan), details));
        }
        let columns = LAYERS.len() - usize::from(conditions.lamps.is_empty());
        illuminances(&rendered.frame, count, &LAYERS[..columns])
    }
}

/// The luminance of all layers together and of some, of each point; layers of points are illuminances [lx].
fn illuminances(frame: &Frame, count: usize, columns: &[Field]) -> Result<Vec<f64>> {
    let layers: Vec<_> = columns
        .iter()
        .map(|field| frame.layer(field.name()))
        .collect();
    let values: Vec<f64> = (0..count)
        .flat_map(|i| {
            let of_layers = layers
                .iter()
                .map(move |layer| layer.map_or(0.0, |layer| luminance(layer.rgb[i].as_dvec3())));
            std::iter::once(luminance(frame.picture(i))).chain(of_layers)
        })
        .collect();
    match values.iter().all(|value| value.is_finite()) {
        true => Ok(values),
        false => Err(Error::failed(
            "an illuminance is not a number",
            "please report this defect with the command, the scene and the points",
        )),
    }
}
