//! What a place receives from lamps, with exact shadows.
//!
//! A point is one shadow ray in f64. A line, a rectangle or a sphere is divided: cells are halved each way until what they differ by
//! is below a share of the lamp's light, so that penumbrae have no noise and no steps wider than that share.
//!
//! Surfaces that shine are divided too, from clusters of triangles down to parts of one (see `super::faces`): first until each is
//! small as seen from the place, then where shadows fall between them.
//!
//! Lamps are gone through by the light that they would give if nothing stood in the way; the last, which together could add less than
//! a share of what the others do, are left out, most of them in groups ([`super::volumes`]) that are never looked into.

use super::faces::{Faces, Part};
use super::lamps::{Lamp, Spot};
use super::volumes::{self, Bounds, Queue, Volume, Volumes};
use super::{Conditions, GroundPlane};
use crate::colour::luminance;
use crate::scene::{Geometry, Ray};
use glam::DVec3;
use std::collections::VecDeque;

/// How far lamps are divided, and how many left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Care {
    /// Parts of a lamp with an extent, each way, before they are divided; at least 1.
    pub cells: u32,
    /// Share of a lamp's light by which its finest parts may differ [1].
    pub share: f64,
    /// Share of the light that the weakest lamps together could add and are left out for [1].
    pub left_out: f64,
}

impl Care {
    /// For means over patches, which many places add up to.
    pub const COARSE: Care = Care {
        cells: 1,
        share: 5e-2,
        left_out: 1e-3,
    };
}

/// Where all lamps shine, on a world of surfaces.
#[derive(Debug, Clone)]
pub(crate) struct Lit {
    volumes: Volumes,
    /// The box around the scene and the ground: of a place outside of it nothing is known.
    world: Bounds,
}

impl Lit {
    pub fn new(lamps: &[Lamp], geometry: &Geometry, ground: Option<GroundPlane>) -> Self {
        let (low, high) = geometry.bounds();
        let slack = 1e-6 * (geometry.extent() + low.abs().max(high.abs()).max_element());
        let mut world = [low - slack, high + slack];
        if let Some(GroundPlane { height, .. }) = ground {
            let [mut low, mut high] = volumes::EVERYWHERE;
            (low.y, high.y) = (height - slack, height + slack);
            world = volumes::joined(&world, &[low, high]);
        }
        let of = |lamp: &Lamp| Volume::new(lamp, lamp.middle(), lamp.extent(), 1.0, &world);
        let volumes: Vec<Volume> = lamps.iter().map(of).collect();
        Lit {
            volumes: Volumes::new(&volumes),
            world,
        }
    }
}

/// A place that receives light.
pub struct Place {
    /// Where it is [m].
    pub position: DVec3,
    /// From where shadow rays leave it [m].
    pub origin: DVec3,
    /// What shadow rays meet nearer than this is the place itself [m].
    pub near: f64,
    /// Unit normal of the triangle.
    pub facet: DVec3,
    /// Unit normal that shading uses.
    pub normal: DVec3,
}

impl Place {
    /// The cosine of the angle at which light from a way away comes in, 0 from behind.
    fn cosine(&self, toward: DVec3) -> f64 {
        match self.facet.dot(toward) > 0.0 {
            true => self.normal.dot(toward).max(0.0),
            false => 0.0,
        }
    }
}

/// What a place receives from all lamps [lx, RGB], and how many it was asked of.
pub fn received(
    conditions: &Conditions,
    place: &Place,
    care: &Care,
    queue: &mut Queue<usize>,
) -> (DVec3, u64) {
    let lamps = &conditions.lamps;
    if let [lamp] = &lamps[..] {
        let asked = at_most(lamp, place) > 0.0;
        return (of_lamp(conditions, lamp, place, care), u64::from(asked));
    }
    let Lit { volumes, world } = &*conditions.lit;
    let is_known = volumes::holds(world, place.position);
    let (mut sum, mut asked) = (DVec3::ZERO, 0);
    volumes.strongest_first(
        queue,
        0.0,
        |group| match is_known && !volumes::holds(&group.reach, place.position) {
            true => 0.0,
            false => of_group(group, place),
        },
        |index| Some((at_most(&lamps[index], place), index)),
        |index| {
            sum += of_lamp(conditions, &lamps[index], place, care);
            asked += 1;
            care.left_out * luminance(sum)
        },
    );
    (sum, asked)
}

/// The most that a place receives from a group of lamps [lx, luminance].
fn of_group(group: &Volume, place: &Place) -> f64 {
    let [low, high] = group.places;
    let highest = |axis: usize| {
        let [a, b] = [low, high].map(|corner| (corner - place.position)[axis]);
        (place.facet[axis] * a).max(place.facet[axis] * b)
    };
    if highest(0) + highest(1) + highest(2) <= 0.0 {
        return 0.0;
    }
    group.power / group.distance(place.position).powi(2)
}

/// The most that a place receives from a lamp [lx, luminance].
fn at_most(lamp: &Lamp, place: &Place) -> f64 {
    let way = lamp.middle() - place.position;
    if lamp.dimensions() == 0 {
        let spot = lamp.spot([0.5; 2], 1.0, place.position);
        let toward = way.normalize_or_zero();
        return place.cosine(toward) * luminance(lamp.illuminance(&spot, place.position));
    }
    let nearest = way.length() - lamp.extent();
    match nearest > 0.1 * lamp.extent() {
        true => lamp.greatest_intensity() / (nearest * nearest),
        // Beside a part of it there is no bound.
        false => f64::INFINITY,
    }
}

/// What a place receives from one lamp [lx, RGB].
fn of_lamp(conditions: &Conditions, lamp: &Lamp, place: &Place, care: &Care) -> DVec3 {
    if let Some(faces) = &lamp.faces {
        return of_faces(conditions, lamp, faces, place, care);
    }
    let of_part = |at: [f64; 2], size: f64| {
        let spot = lamp.spot(at, size, place.position);
        of_spot(conditions, lamp, &spot, place)
    };
    let count = match lamp.dimensions() {
        0 => return of_part([0.5; 2], 1.0),
        1 => 2,
        _ => 4,
    };
    // A cell by its Gauss nodes: two each way.
    let cell = |low: [f64; 2], size: f64| {
        let half = 0.5 * size;
        let mut values = [DVec3::ZERO; 4];
        for (i, value) in values[..count].iter_mut().enumerate() {
            let at = [i % 2, i / 2].map(|k| half + half * [-NODE, NODE][k]);
            *value = of_part([low[0] + at[0], low[1] + at[1]], half);
        }
        (low, size, values)
    };
    let size = 1.0 / f64::from(care.cells);
    let down = if count == 2 { 1 } else { care.cells };
    let mut open: Vec<_> = (0..down)
        .flat_map(|j| (0..care.cells).map(move |i| [i, j]))
        .map(|at| cell(at.map(|k| size * f64::from(k)), size))
        .collect();
    let strength = |values: &[DVec3]| values.iter().map(|v| v.max_element()).sum::<f64>();
    let mut scale: f64 = open.iter().map(|(_, _, values)| strength(values)).sum();
    let mut sum = DVec3::ZERO;
    while let Some((low, size, values)) = open.pop() {
        let values = &values[..count];
        if range(values) <= care.share * scale || size < FINEST {
            sum += values.iter().sum::<DVec3>();
            continue;
        }
        let half = 0.5 * size;
        for i in 0..count {
            let finer = cell(
                [
                    low[0] + half * (i % 2) as f64,
                    low[1] + half * (i / 2) as f64,
                ],
                half,
            );
            // A part that is brighter than the first look promised is measured by what there is.
            scale = scale.max(strength(&finer.2));
            open.push(finer);
        }
    }
    sum
}

/// Gauss-Legendre nodes of two points lie so far from the middle, in halves of the whole: 1 / sqrt(3).
const NODE: f64 = 0.577_350_269_189_625_8;

/// No part of a lamp is smaller than this, as a share of it each way.
const FINEST: f64 = 1.0 / 512.0;

/// Of surfaces that shine a place tells no more parts than this: of thousands that look all ways, clusters stand for the rest.
const MOST_PARTS: usize = 4096;

/// What a place receives from surfaces that shine [lx, RGB].
fn of_faces(
    conditions: &Conditions,
    lamp: &Lamp,
    faces: &Faces,
    place: &Place,
    care: &Care,
) -> DVec3 {
    // By one place the error of a cluster is about the square of its size over its distance, by three that of a triangle its cube.
    let reach = |part: &Part| match part {
        Part::Cluster(_) => care.share.sqrt().min(0.4),
        Part::Piece { .. } => care.share.cbrt().min(0.4),
    };
    let same_way = 1.0 - 0.9 * care.share.sqrt();
    let is_dark = |part: &Part| {
        faces.is_behind(part, place.position, place.facet) || faces.looks_away(part, place.position)
    };
    // What a spot would give if nothing stood in the way.
    let bare = |spot: &Spot| {
        let toward = (spot.position - place.position).normalize_or_zero();
        place.cosine(toward) * lamp.illuminance(spot, place.position)
    };
    let bare_part = |part: &Part| {
        let mut sum = 0.0;
        faces.spots(part, |spot| sum += luminance(bare(&spot)));
        sum
    };
    let mut open = VecDeque::from([faces.whole()]);
    let mut small = Vec::new();
    let mut scale = 0.0;
    // All alike, so that where there are too many all are coarse alike.
    while let Some(part) = open.pop_front() {
        if is_dark(&part) {
            continue;
        }
        let is_small = faces.is_small(&part, place.position, reach(&part), same_way);
        let is_full = small.len() + open.len() >= MOST_PARTS;
        if is_small || is_full || is_finest(&part) {
            let light = bare_part(&part);
            scale += light;
            small.push((part, light));
        } else {
            faces.divided(&part, |part| open.push_back(part));
        }
    }
    let largest = (1.0 + 1e-9) * scale / f64::from(care.cells * care.cells);
    let mut sum = DVec3::ZERO;
    while let Some((part, light)) = small.pop() {
        if light == 0.0 {
            continue;
        }
        let divide = |small: &mut Vec<(Part, f64)>| {
            faces.divided(&part, |part| small.push((part, bare_part(&part))));
        };
        if light > largest && !is_finest(&part) {
            divide(&mut small);
            continue;
        }
        // The shadow on what adds less than the share is that on one place of it.
        let one = light <= care.share * scale;
        let (mut found, mut through) = (DVec3::ZERO, Vec::with_capacity(4));
        faces.spots(&part, |spot| {
            let bare = bare(&spot);
            if bare == DVec3::ZERO {
                return;
            }
            match through.first() {
                Some(share) if one => found += *share * bare,
                _ => {
                    let light = of_spot(conditions, lamp, &spot, place);
                    through.push(light / bare.max(DVec3::splat(f64::MIN_POSITIVE)));
                    found += light;
                }
            }
        });
        if range(&through) * light > care.share * scale && !is_finest(&part) {
            divide(&mut small);
        } else {
            sum += found;
        }
    }
    sum
}

/// By how much values differ, in the channel in which they do most: behind coloured glass in hue alone.
fn range(values: &[DVec3]) -> f64 {
    let most = values.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let least = values.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    (most - least).max_element()
}

/// Whether a part is divided no further.
fn is_finest(part: &Part) -> bool {
    matches!(part, Part::Piece { share, .. } if *share < FINEST * FINEST)
}

/// What a place receives from one spot of a lamp [lx, RGB].
fn of_spot(conditions: &Conditions, lamp: &Lamp, spot: &Spot, place: &Place) -> DVec3 {
    // The ground stops the light of what lies under it, as it does that of the sun.
    let ground = conditions.ground.map(|ground| ground.height);
    if ground.is_some_and(|height| spot.position.y < height && place.position.y >= height) {
        return DVec3::ZERO;
    }
    let way = spot.position - place.position;
    let distance = way.length();
    let Some(toward) = way.try_normalize() else {
        return DVec3::ZERO;
    };
    let cosine = place.cosine(toward);
    if cosine == 0.0 {
        return DVec3::ZERO;
    }
    let light = cosine * lamp.illuminance(spot, place.position);
    if light == DVec3::ZERO {
        return DVec3::ZERO;
    }
    let ray = Ray {
        origin: place.origin,
        direction: toward,
    };
    let geometry = lamp.geometry(&conditions.geometry);
    // A lamp on a surface is not behind it.
    let far = distance * (1.0 - ON_SURFACE) - place.near;
    let through = geometry.transmittance(&ray, place.near, far);
    if through == DVec3::ZERO {
        return DVec3::ZERO;
    }
    let depth = conditions
        .air
        .optical_depth(place.position, toward, distance);
    through * light * (-depth).exp()
}

/// What is nearer to a lamp than this share of its distance does not shade it.
const ON_SURFACE: f64 = 1e-9;
