//! What lamps give to each patch.
//!
//! By points all over it: few, and many where these differ by more than a few percent, as in a cone of light or at the edge of a shadow.

use super::arrival::spread;
use super::patches::Patch;
use crate::conditions::Conditions;
use crate::conditions::received::{Care, Place, received};
use glam::DVec3;

/// Points of a patch: first, and where they differ.
const SPOTS: [usize; 2] = [16, 128];

/// What differs by more of the mean is not alike [1].
const ALIKE: f64 = 0.05;

/// Surfaces that shine have no narrow beams: where they alone give light, so many points are enough if they differ by less than this
/// share of the mean.
const SMOOTH: (usize, f64) = (4, 0.01);

/// The mean illuminance of a patch by lamps [lx, RGB]; `near` is how far from it shadow rays leave it [m], `turn` tells it from the others.
pub(super) fn lamps_on(conditions: &Conditions, patch: &Patch, near: f64, turn: u64) -> DVec3 {
    if conditions.lamps.is_empty() {
        return DVec3::ZERO;
    }
    let mut of = at_points(conditions, patch, near, turn);
    let [few, many] = SPOTS;
    let (least, smooth) = SMOOTH;
    let are_smooth = conditions.lamps.iter().all(|lamp| lamp.glow().is_some());
    let mut found: Vec<DVec3> = (0..least).map(&mut of).collect();
    if are_smooth && let Some(mean) = alike(&found, smooth) {
        return mean;
    }
    found.extend((least..few).map(&mut of));
    if let Some(mean) = alike(&found, ALIKE) {
        return mean;
    }
    (found.iter().sum::<DVec3>() + (few..many).map(of).sum::<DVec3>()) / many as f64
}

/// The mean of values that differ from it by no more than a share of it; of dark ones none, between which a narrow beam may fall.
fn alike(found: &[DVec3], share: f64) -> Option<DVec3> {
    let mean = found.iter().sum::<DVec3>() / found.len() as f64;
    let off = |v: &DVec3| (*v - mean).abs().max_element();
    let most = found.iter().map(off).fold(0.0, f64::max);
    (mean != DVec3::ZERO && most <= share * mean.max_element()).then_some(mean)
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
    let mut order = Vec::new();
    move |i| {
        let spot = patch.spot(&spread(i, turn));
        let place = Place {
            position: spot.point,
            origin: spot.point + near * spot.normal,
            near: 0.0,
            facet: spot.normal,
            normal: spot.normal,
        };
        received(conditions, &place, &Care::COARSE, &mut order)
    }
}
