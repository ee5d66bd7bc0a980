//! What lamps give to each patch.
//!
//! By points all over it: few, and many where these differ by more than a few percent, as in a cone of light or at the edge of a shadow.

use super::arrival::spread;
use super::patches::Patch;
use crate::conditions::Conditions;
use crate::conditions::received::{Care, Place, received};
use crate::conditions::volumes::Queue;
use glam::DVec3;

/// Points of a patch: first, and where they differ.
const SPOTS: [usize; 2] = [16, 128];

/// What differs by more of the mean is not alike [1].
const ALIKE: f64 = 0.05;

/// The mean illuminance of a patch by lamps [lx, RGB]; `near` is how far from it shadow rays leave it [m], `turn` tells it from the others.
pub(super) fn lamps_on(conditions: &Conditions, patch: &Patch, near: f64, turn: u64) -> DVec3 {
    if conditions.lamps.is_empty() {
        return DVec3::ZERO;
    }
    let mut of = at_points(conditions, patch, near, turn);
    let [few, many] = SPOTS;
    let found: Vec<DVec3> = (0..few).map(&mut of).collect();
    let sum: DVec3 = found.iter().sum();
    let mean = sum / few as f64;
    let off = |v: &DVec3| (*v - mean).abs().max_element();
    let most = found.iter().map(off).fold(0.0, f64::max);
    // A narrow beam may fall between the first.
    let is_dark = mean == DVec3::ZERO;
    if !is_dark && most <= ALIKE * mean.max_element() {
        return mean;
    }
    (sum + (few..many).map(of).sum::<DVec3>()) / many as f64
}

/// Whether any lamp reaches a patch: whether [`lamps_on`] is more than nothing, as the first lit point tells.
pub(super) fn is_reached(conditions: &Conditions, patch: &Patch, near: f64, turn: u64) -> bool {
    let mut of = at_points(conditions, patch, near, turn);
    (0..SPOTS[1]).any(|i| of(i) != DVec3::ZERO)
}

/// What the points of a patch receive, by number [lx, RGB].
fn at_points<'a>(
    conditions: &'a Conditions,
    patch: &'a Patch,
    near: f64,
    turn: u64,
) -> impl FnMut(usize) -> DVec3 + 'a {
    let mut queue = Queue::default();
    move |i| {
        let spot = patch.spot(&spread(i, turn));
        let place = Place {
            position: spot.point,
            origin: spot.point + near * spot.normal,
            near: 0.0,
            facet: spot.normal,
            normal: spot.normal,
        };
        received(conditions, &place, &Care::COARSE, &mut queue).0
    }
}
