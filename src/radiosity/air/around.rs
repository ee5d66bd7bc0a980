//! What the air at any place sends toward the eye: near the scene by what stands there, far from it as in the open.

use super::enclosed::{Enclosed, smooth};
use super::open::OpenAir;
use crate::conditions::Conditions;
use glam::DVec3;

/// So many diagonals of the bounds away from them the scene begins to be left out, and so many farther it is.
const FAR: [f64; 2] = [1.0, 2.0];

/// J everywhere.
pub struct Around {
    enclosed: Enclosed,
    open: OpenAir,
    bounds: Option<[DVec3; 2]>,
}

impl Around {
    pub fn new(conditions: &Conditions, enclosed: Enclosed, open: OpenAir) -> Self {
        Around {
            enclosed,
            open,
            bounds: bounds(conditions),
        }
    }

    /// J of each kind of media at a place that the eye sees in this direction [cd/m2].
    pub fn source(&self, place: DVec3, direction: DVec3) -> Vec<DVec3> {
        let far = match self.bounds {
            Some([low, high]) => {
                let outside = (place - place.clamp(low, high)).length();
                smooth((outside / (high - low).length() - FAR[0]) / FAR[1])
            }
            None => 1.0,
        };
        if far <= 0.0 {
            return self.enclosed.source(place, direction);
        }
        let mut open = self.open.source(place.y, direction);
        if far < 1.0 {
            let near = self.enclosed.source(place, direction);
            for (open, near) in open.iter_mut().zip(near) {
                *open = far * *open + (1.0 - far) * near;
            }
        }
        open
    }
}

/// The least box around everything that stands in the air, triangles and bounded media; `None` if nothing does.
pub fn bounds(conditions: &Conditions) -> Option<[DVec3; 2]> {
    let geometry = &conditions.geometry;
    let is_there = geometry.triangle_count() > 0 || geometry.panes().is_some();
    let mut bounds = is_there.then(|| {
        let (low, high) = geometry.bounds();
        [low, high]
    });
    for medium in &conditions.air.media {
        if let Some([min, max]) = medium.bounds() {
            let [low, high] = bounds.unwrap_or([min, max]);
            bounds = Some([low.min(min), high.max(max)]);
        }
    }
    bounds.filter(|[low, high]| (*high - *low).length() > 0.0)
}
