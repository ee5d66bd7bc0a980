//! What results are made of, so that they are made again only when that has changed.

use super::lamps::Lamp;
use super::{Conditions, GroundPlane, Sun, View};
use crate::medium::Air;
use crate::scene::{Geometry, Scene};
use crate::sky::Sky;
use std::sync::Arc;

/// A part of the conditions, or of the work on a picture, that a result may depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Input {
    /// Triangles that stand in the way of light, and the height of the ground.
    Geometry,
    /// Materials, textures, normals; the albedo of the ground.
    Materials,
    /// The media.
    Media,
    /// What the media take from light between places of the scene: not how much of the clear air the sun shines through.
    Extinction,
    /// The sky.
    Sky,
    /// Where the sun stands and what light it gives.
    Sun,
    /// The lamps that give light.
    Lamps,
    /// The camera and its picture, or the points that receive.
    View,
    /// The tile of the picture that a GPU works on, and the sample of its pixels.
    Tile,
    /// The beam of light that a GPU works on.
    Beam,
}

/// The state of some inputs, to be compared with a later one. What is shared is compared by identity, the rest by value.
#[derive(Clone)]
pub struct Snapshot(Vec<State>);

#[derive(Clone)]
enum State {
    Geometry(Arc<Geometry>, Option<f64>),
    Materials(Arc<Scene>, Option<GroundPlane>),
    Media(Air),
    Sky(Option<Arc<Sky>>),
    Sun(Sun),
    Lamps(Arc<[Lamp]>),
    View(View),
}

/// Whether two selections of a scene's lamps are the same. That of a moment leaves out which surfaces shine too faintly then.
fn same_lamps(a: &Arc<[Lamp]>, b: &Arc<[Lamp]>) -> bool {
    let same = |a: &Lamp, b: &Lamp| {
        a.name == b.name && a.position == b.position && a.intensity == b.intensity
    };
    Arc::ptr_eq(a, b) || a.len() == b.len() && a.iter().zip(b.iter()).all(|(a, b)| same(a, b))
}

impl PartialEq for State {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (State::Geometry(a, c), State::Geometry(b, d)) => Arc::ptr_eq(a, b) && c == d,
            (State::Materials(a, c), State::Materials(b, d)) => Arc::ptr_eq(a, b) && c == d,
            (State::Media(a), State::Media(b)) => a == b,
            (State::Sky(None), State::Sky(None)) => true,
            (State::Sky(Some(a)), State::Sky(Some(b))) => Arc::ptr_eq(a, b),
            (State::Sun(a), State::Sun(b)) => a == b,
            (State::Lamps(a), State::Lamps(b)) => same_lamps(a, b),
            (State::View(a), State::View(b)) => a == b,
            _ => false,
        }
    }
}

impl Conditions {
    /// The present state of inputs. [`Input::Tile`] and [`Input::Beam`] are no part of the conditions and left out.
    pub fn snapshot(&self, inputs: &[Input]) -> Snapshot {
        let state = |input: &Input| match input {
            Input::Geometry => Some(State::Geometry(
                self.geometry.clone(),
                self.ground.map(|ground| ground.height),
            )),
            Input::Materials => Some(State::Materials(self.scene.clone(), self.ground)),
            Input::Media => Some(State::Media(self.air.clone())),
            Input::Extinction => Some(State::Media(self.air.without_sun())),
            Input::Sky => Some(State::Sky(self.sky.clone())),
            Input::Sun => Some(State::Sun(self.sun)),
            Input::Lamps => Some(State::Lamps(self.lamps.clone())),
            Input::View => Some(State::View(self.view.clone())),
            Input::Tile | Input::Beam => None,
        };
        Snapshot(inputs.iter().filter_map(state).collect())
    }
}

impl Snapshot {
    /// Whether what was shared is that of the same scene; else nothing of it will be asked for again.
    pub fn is_of_scene(&self, conditions: &Conditions) -> bool {
        self.0.iter().all(|state| match state {
            State::Geometry(geometry, _) => Arc::ptr_eq(geometry, &conditions.geometry),
            State::Materials(scene, _) => Arc::ptr_eq(scene, &conditions.scene),
            _ => true,
        })
    }

    /// Whether nothing has changed since.
    pub fn still_holds(&self, conditions: &Conditions, inputs: &[Input]) -> bool {
        self.0 == conditions.snapshot(inputs).0
    }
}
