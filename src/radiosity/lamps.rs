//! What lamps give to each patch, and where on it.
//!
//! On part of a plane tile by tile; around the axis of a beam and beside a lamp tiles are as fine as its light may be narrow there. On
//! other patches by points all over them: few, and many where these differ by more than a few percent.

use super::arrival::spread;
use super::cells::{Face, Part};
use super::direct::{Direct, Look, Watched};
use super::transport::Transport;
use crate::conditions::Conditions;
use crate::conditions::received::{Care, Place, received};
use crate::conditions::volumes::Queue;
use glam::{DVec2, DVec3};
use std::cell::RefCell;
use std::f64::consts::{FRAC_PI_2, PI};

/// Points of a patch that is no part of a plane: first, and where they differ.
const SPOTS: [usize; 2] = [16, 128];

/// What differs by more of the mean, or of the brightest tile, is not alike [1].
const ALIKE: f64 = 0.05;

/// Surfaces that shine have no narrow beams: where they alone give light, so many points are enough if they differ by less than this
/// share of the mean.
const SMOOTH: (usize, f64) = (4, 0.01);

/// The level of tiles that is looked at first; that where surfaces that shine alone give light, which have no narrow beams.
const FIRST: [u32; 2] = [2, 1];

/// Shadow rays to all of a patch's finest tiles where light is uneven, and to each of them at most.
const EDGE: [usize; 2] = [512, 16];

/// Finds it for the lamps of `conditions`.
pub(super) fn lamps_on(transport: &Transport, conditions: &Conditions, patch: usize) -> Direct {
    if conditions.lamps.is_empty() || !transport.exchange.sees(patch) {
        return Direct::default();
    }
    let near = transport.near(DVec3::ZERO);
    if let Some((face, part)) = transport.patches.part(patch) {
        let queue = RefCell::new(Queue::default());
        let look = Look {
            face,
            part,
            arrives: |point| {
                let place = place(point, face.plane.normal, near);
                received(conditions, &place, &Care::COARSE, &mut queue.borrow_mut()).0
            },
            alike: ALIKE,
            most: None,
            level: FIRST[usize::from(are_smooth(conditions))],
            depth: part.depth,
            edge: EDGE,
            watched: watched(conditions, face, part),
        };
        if let Some(direct) = look.direct(DVec3::ONE) {
            return direct;
        }
    }
    Direct {
        mean: by_points(transport, conditions, patch),
        tiles: Vec::new(),
    }
}

/// Whether any lamp reaches a patch, as the first lit point tells.
pub(super) fn is_reached(transport: &Transport, conditions: &Conditions, patch: usize) -> bool {
    let mut of = at_points(transport, conditions, patch);
    if (0..SPOTS[1]).any(|i| of(i) != DVec3::ZERO) {
        return true;
    }
    let near = transport.near(DVec3::ZERO);
    transport.patches.part(patch).is_some_and(|(face, part)| {
        watched(conditions, face, part).iter().any(|watched| {
            let place = place(face.plane.point(watched.at), face.plane.normal, near);
            let mut queue = Queue::default();
            let (arrives, _) = received(conditions, &place, &Care::COARSE, &mut queue);
            part.covers(watched.at) && arrives != DVec3::ZERO
        })
    })
}

/// Where on a part of a plane light may be narrow: where the axes of beams meet it, and nearest to lamps.
fn watched(conditions: &Conditions, face: &Face, part: &Part) -> Vec<Watched> {
    let plane = &face.plane;
    let mut watched = Vec::new();
    // Where it is, and how far it reaches on each side: its middle may lie beyond the border.
    let mut add = |at: DVec2, width: f64| {
        let reach = DVec2::splat(0.5 * width);
        if (at + reach).cmpge(part.low).all() && (at - reach).cmple(part.high).all() {
            // On the rim, and in the middle.
            let rim = (0..8).map(|k| DVec2::from_angle(0.25 * PI * f64::from(k)));
            watched.extend(rim.chain([DVec2::ZERO]).map(|to| Watched {
                at: (at + reach * to).clamp(part.low, part.high),
                width,
            }));
        }
    };
    for lamp in conditions.lamps.iter() {
        let middle = lamp.middle();
        let height = plane.height(middle);
        if height <= 0.0 {
            continue;
        }
        let extent = lamp.extent();
        add(plane.flat(middle), height + extent);
        let (axis, cone) = (lamp.pose.toward, lamp.distribution.cone());
        let down = -axis.dot(plane.normal);
        if down > 0.0 && cone < FRAC_PI_2 {
            let way = height / down;
            add(
                plane.flat(middle + way * axis),
                2.0 * way * cone.tan() + extent,
            );
        }
    }
    watched
}

/// The mean illuminance of a patch by points all over it [lx, RGB].
fn by_points(transport: &Transport, conditions: &Conditions, patch: usize) -> DVec3 {
    let mut of = at_points(transport, conditions, patch);
    let [few, many] = SPOTS;
    let (least, smooth) = SMOOTH;
    let mut found: Vec<DVec3> = (0..least).map(&mut of).collect();
    if are_smooth(conditions)
        && let Some(mean) = alike(&found, smooth)
    {
        return mean;
    }
    found.extend((least..few).map(&mut of));
    if let Some(mean) = alike(&found, ALIKE) {
        return mean;
    }
    (found.iter().sum::<DVec3>() + (few..many).map(of).sum::<DVec3>()) / many as f64
}

/// Whether surfaces that shine alone give light.
fn are_smooth(conditions: &Conditions) -> bool {
    conditions.lamps.iter().all(|lamp| lamp.glow().is_some())
}

/// The mean of values that differ from it by no more than a share of it; of dark ones none, between which a narrow beam may fall.
fn alike(found: &[DVec3], share: f64) -> Option<DVec3> {
    let mean = found.iter().sum::<DVec3>() / found.len() as f64;
    let off = |v: &DVec3| (*v - mean).abs().max_element();
    let most = found.iter().map(off).fold(0.0, f64::max);
    (mean != DVec3::ZERO && most <= share * mean.max_element()).then_some(mean)
}

/// What the points of a patch receive, by number [lx, RGB].
fn at_points<'a>(
    transport: &'a Transport,
    conditions: &'a Conditions,
    patch: usize,
) -> impl FnMut(usize) -> DVec3 + 'a {
    let own = &transport.patches.all[patch];
    let near = transport.near(DVec3::ZERO);
    let mut queue = Queue::default();
    move |i| {
        let spot = own.spot(&spread(i, patch as u64));
        let place = place(spot.point, spot.normal, near);
        received(conditions, &place, &Care::COARSE, &mut queue).0
    }
}

/// A point of a patch, which shadow rays leave `near` [m] above it.
fn place(point: DVec3, normal: DVec3, near: f64) -> Place {
    Place {
        position: point,
        origin: point + near * normal,
        near: 0.0,
        facet: normal,
        normal,
    }
}
