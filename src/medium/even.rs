//! Air that is the same all the way: from where a ray enters it over every place of a part of the ray to a place.

use super::body::Body;
use super::phase::Phase;
use super::{Air, FARTHEST};
use glam::DVec3;

/// Air that is the same on all ways from the eye over a part of a ray to a place, and scatters alike in all directions: there light of
/// the place has closed forms ([`super::Airlight`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Even {
    /// Where the ray enters it [m].
    pub enter: f64,
    /// Scattering coefficient [1/m].
    pub scattering: DVec3,
    /// Extinction coefficient [1/m].
    pub extinction: DVec3,
}

impl Even {
    /// That of a part of a ray and a place, if the air there is such.
    pub fn of(
        air: &Air,
        origin: DVec3,
        direction: DVec3,
        [from, to]: [f64; 2],
        place: DVec3,
    ) -> Option<Even> {
        let mut even: Option<Even> = None;
        for medium in &air.media {
            // Regions are convex: what goes from a place inside to another stays inside.
            let Some(Body::Region(region)) = air.body(medium) else {
                return None;
            };
            let (enter, leave) = region.chord(origin, direction);
            let is_within = from >= enter && to <= leave.min(FARTHEST) && region.holds(place);
            let scatters_alike =
                medium.phase == Phase::Isotropic || medium.scattering == DVec3::ZERO;
            if !is_within || !scatters_alike || even.is_some_and(|even| even.enter != enter) {
                return None;
            }
            let before = even.unwrap_or(Even {
                enter,
                scattering: DVec3::ZERO,
                extinction: DVec3::ZERO,
            });
            even = Some(Even {
                scattering: before.scattering + medium.scattering,
                extinction: before.extinction + medium.extinction(),
                ..before
            });
        }
        even
    }
}
