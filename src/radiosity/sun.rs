//! What the sun gives to each patch, and where on it.
//!
//! Shadow rays go from places that are spread over the rectangle around the patch, more of them where patches are large beside the
//! finest of their plane, so that no shadow of what stands there falls between them. Where they differ, an edge runs through: tiles
//! along it are quartered as far as tiles go.

use super::arrival::spread;
use super::cells::Part;
use super::direct::{Direct, Look};
use super::transport::Transport;
use crate::conditions::Conditions;
use crate::scene::Ray;
use glam::DVec3;

/// Shadow rays to a patch that is no part of a plane: first, and where they differ.
const RAYS: [usize; 2] = [16, 128];

/// The least level on which it is found whether the sun lights all of a patch alike; else that of tiles half as large as the plane's
/// finest cells.
const FIRST: u32 = 2;

/// Shadow rays to the finest tiles along an edge: two to each.
const EDGE: [usize; 2] = [0, 2];

/// What differs by more of the sun's light is not alike [1].
const ALIKE: f64 = 0.02;

/// Levels of tiles: the one that is looked at first, and the finest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Levels {
    pub first: u32,
    pub finest: u32,
}

impl Levels {
    /// Those of a part of a plane that is to be seen from anywhere.
    fn of(part: &Part) -> Self {
        Levels {
            first: part.depth.saturating_sub(2).max(FIRST),
            finest: part.depth,
        }
    }
}

/// Finds it for the sun of `conditions`.
pub(super) fn sun_on(transport: &Transport, conditions: &Conditions, patch: usize) -> Direct {
    sun_on_levels(transport, conditions, patch, None)
}

/// The same no more finely than at some levels.
pub(super) fn sun_on_levels(
    transport: &Transport,
    conditions: &Conditions,
    patch: usize,
    most: Option<Levels>,
) -> Direct {
    let sun = &conditions.sun;
    if !sun.shines() || !transport.exchange.sees(patch) {
        return Direct::default();
    }
    if let Some((face, part)) = transport.patches.part(patch) {
        let normal = face.plane.normal;
        let cosine = normal.dot(sun.toward);
        if cosine <= 0.0 {
            return Direct::default();
        }
        let all = Levels::of(part);
        let levels = most.map_or(all, |most| Levels {
            first: all.first.min(most.first),
            finest: all.finest.min(most.finest),
        });
        let look = Look {
            face,
            part,
            arrives: |point| through(transport, conditions, point, normal),
            alike: ALIKE,
            most: Some(1.0),
            level: levels.first,
            depth: levels.finest,
            edge: EDGE,
            watched: Vec::new(),
        };
        if let Some(direct) = look.direct(cosine * sun.light.illuminance) {
            return direct;
        }
    }
    Direct {
        mean: by_spots(transport, conditions, patch),
        tiles: Vec::new(),
    }
}

/// What of the sun's light arrives at a point that rays leave by the normal.
fn through(transport: &Transport, conditions: &Conditions, point: DVec3, normal: DVec3) -> DVec3 {
    let toward = conditions.sun.toward;
    let ray = Ray {
        origin: point + transport.near(DVec3::ZERO) * normal,
        direction: toward,
    };
    let through = conditions.geometry.transmittance(&ray, 0.0, f64::INFINITY);
    if through != DVec3::ZERO {
        through * (-conditions.air.sun_optical_depth(point, toward)).exp()
    } else {
        DVec3::ZERO
    }
}

/// The mean illuminance [lx, RGB] of a patch by points all over it.
fn by_spots(transport: &Transport, conditions: &Conditions, patch: usize) -> DVec3 {
    let own = &transport.patches.all[patch];
    let sun = &conditions.sun;
    let lit = |range: std::ops::Range<usize>| {
        let mut sum = DVec3::ZERO;
        let mut some = [false; 2];
        for i in range {
            let spot = own.spot(&spread(i, patch as u64));
            let cosine = spot.normal.dot(sun.toward);
            if cosine > 0.0 {
                let through = through(transport, conditions, spot.point, spot.normal);
                some[usize::from(through != DVec3::ZERO)] = true;
                sum += cosine * through;
            }
        }
        (sum, some)
    };
    let [few, many] = RAYS;
    let (mut sum, some) = lit(0..few);
    let mut count = few;
    // Behind glass with a picture what is lit differs too.
    let has_panes = conditions.geometry.panes().is_some();
    if some == [true, true] || has_panes && some[1] {
        sum += lit(few..many).0;
        count = many;
    }
    sun.light.illuminance * sum / count as f64
}
