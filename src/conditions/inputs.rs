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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditions::{CameraChoice, Request};
    use crate::photometry::Distribution;
    use crate::scene::{Camera, LampEntry, LampForm, SunEntry};
    use glam::DVec3;

    fn lamp(x: f64) -> LampEntry {
        LampEntry {
            name: "lamp".into(),
            position: DVec3::new(x, 3.0, 0.0),
            toward: DVec3::NEG_Y,
            around: None,
            intensity: DVec3::splat(1e5),
            distribution: Distribution::Isotropic,
            form: LampForm::Point,
            ignore: None,
        }
    }

    /// A change of the conditions.
    type Change = fn(&mut Conditions);

    #[test]
    fn what_has_changed_holds_no_longer_and_all_else_does() {
        let scene = Scene {
            sun: Some(SunEntry {
                azimuth_deg: 180.0,
                elevation_deg: 30.0,
                illuminance: None,
                diameter_deg: None,
            }),
            lamps: vec![lamp(0.0), lamp(1.0)],
            ..Scene::default()
        };
        let request = Request {
            camera: CameraChoice::Given(Camera::look_at(DVec3::Y, DVec3::NEG_Z, 0.8)),
            ..Request::default()
        };
        let before = Conditions::new(scene, &request).expect("it is sound");
        assert_eq!(before.lamps.len(), 2);
        let all = [
            Input::Geometry,
            Input::Materials,
            Input::Media,
            Input::Extinction,
            Input::Sky,
            Input::Sun,
            Input::Lamps,
            Input::View,
        ];
        let changes: [(&[Input], Change); 11] = [
            (&[], |_| {}),
            (&[Input::Sun], |now| now.sun.toward = DVec3::Y),
            (&[Input::Geometry, Input::Materials], |now| {
                let ground = now.ground.as_mut().expect("there is a ground");
                ground.height -= 1.0;
            }),
            (&[Input::Materials], |now| {
                let ground = now.ground.as_mut().expect("there is a ground");
                ground.albedo *= 0.5;
            }),
            (&[Input::Lamps], |now| now.lamps = now.lamps[..1].into()),
            (&[Input::Lamps], |now| {
                now.lamps = [1, 0].map(|i| now.lamps[i].clone()).into()
            }),
            (&[Input::Media, Input::Extinction], |now| {
                now.air.ground += 1.0
            }),
            (&[Input::Geometry], |now| {
                now.geometry = Arc::new(Geometry::new(&now.scene))
            }),
            (&[Input::View], |now| now.view.size[0] += 1),
            (&[Input::Sky], |now| now.sky = None),
            (&[Input::Materials], |now| {
                now.scene = Arc::new((*now.scene).clone())
            }),
        ];
        for (stale, change) in changes {
            let mut now = before.clone();
            change(&mut now);
            for input in all {
                let holds = before.snapshot(&[input]).still_holds(&now, &[input]);
                assert_eq!(holds, !stale.contains(&input), "{input:?} of {stale:?}");
            }
            let is_of_scene = before.snapshot(&all).is_of_scene(&now);
            let is_same_geometry = Arc::ptr_eq(&before.geometry, &now.geometry);
            let is_same_scene = Arc::ptr_eq(&before.scene, &now.scene);
            assert_eq!(is_of_scene, is_same_geometry && is_same_scene);
        }
        assert!(
            !before
                .snapshot(&[Input::Sun])
                .still_holds(&before, &[Input::View])
        );
    }
}
