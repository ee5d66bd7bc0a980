//! Which sensors stand where nobody can: in walls and furniture, and on top of a roof that comes down to their height.
//!
//! Meshes are not always closed, and their faces do not always show their front to the air. So no one ray decides.
//!
//! Sensors that see their neighbours on the grid with nothing between them, glass neither, stand together. The largest such group is
//! in the air, whatever the faces around it look like. Of the others a sensor **stands in something solid** if more than 60 % of 26
//! directions all round (of a surface: those before it) end at the back of a face. Where most of the sensors see backs, the faces of
//! the model are turned, and tell nothing: there it does if what is free about it is less than 0.8 m wide, in the narrowest of eight
//! level directions.
//!
//! A group is **outside** if most of its sensors have open sky above and something between them and the floor, while most of the floor
//! is covered: they stand on what covers it.
//!
//! Groups of what is left are **closed in** if no daylight comes to them (`reached`): a crawl space, a void in a wall or above a
//! ceiling. Where that holds for all sensors of all grids, none is left out for it; nor is one of what was named, or where lamps shine.

use super::floor::Above;
use super::plane::{Plane, Sensor};
use super::reached::is_reached;
use crate::scene::{Geometry, Ray, Scene};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::{PI, TAU};

/// Where a sensor stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// In the air.
    Free,
    /// In a wall or a piece of furniture.
    InSolid,
    /// Outside, on what covers the floor.
    Outside,
    /// Where no daylight comes to.
    ClosedIn,
}

impl Standing {
    /// A phrase that follows a number of sensors.
    pub fn phrase(self) -> &'static str {
        match self {
            Standing::Free => "stand in the air",
            Standing::InSolid => "stand in walls or furniture",
            Standing::Outside => "stand outside, on top of what covers the floor",
            Standing::ClosedIn => "are closed in where no daylight comes to",
        }
    }
}

/// Directions that a sensor looks along.
const DIRECTIONS: u32 = 26;
/// Share of them that end at the back of a face, above which it is in something.
const IN_SOLID: f64 = 0.6;
/// What people are in is wider than this [m].
const NARROW: f64 = 0.8;
/// Faces nearer than this to a sensor are those that it lies on [m].
const NEAR: f64 = 1e-6;

/// How a sensor of a plane stands, for each.
pub fn standing(
    scene: &Scene,
    geometry: &Geometry,
    plane: &Plane,
    sensors: &[Sensor],
) -> Vec<Standing> {
    if sensors.is_empty() {
        return Vec::new();
    }
    let groups = groups(geometry, plane, sensors);
    let mut sizes: HashMap<usize, usize> = HashMap::new();
    for group in &groups {
        *sizes.entry(*group).or_default() += 1;
    }
    // Of two alike the one that comes first.
    let largest = sizes
        .iter()
        .max_by_key(|(group, size)| (**size, usize::MAX - **group));
    let largest = largest.map(|(group, _)| *group);

    let looks: Vec<Look> = (sensors.par_iter())
        .map(|sensor| Look::of(scene, geometry, plane, sensor))
        .collect();
    let backs = |look: &&Look| look.backs > 0.5;
    let is_turned = 2 * looks.iter().filter(backs).count() > looks.len();
    let is_roofed = 2 * looks.iter().filter(|look| look.floor_is_covered).count() > looks.len();
    let mut on_top: HashMap<usize, usize> = HashMap::new();
    for (group, look) in groups.iter().zip(&looks) {
        *on_top.entry(*group).or_default() += usize::from(look.is_on_top);
    }
    let each = groups.iter().zip(&looks).zip(sensors);
    let standing = each.map(|((group, look), sensor)| {
        let is_outside = is_roofed && 2 * on_top[group] > sizes[group];
        let is_in_solid = || match is_turned {
            false => look.backs > IN_SOLID,
            true => width(geometry, sensor) < NARROW,
        };
        match () {
            () if is_outside => Standing::Outside,
            () if Some(*group) != largest && is_in_solid() => Standing::InSolid,
            () => Standing::Free,
        }
    });
    let mut standing: Vec<Standing> = standing.collect();
    let mut free: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, group) in groups.iter().enumerate() {
        if standing[i] == Standing::Free {
            free.entry(*group).or_default().push(i);
        }
    }
    for together in free.values() {
        let own: Vec<&Sensor> = together.iter().map(|i| &sensors[*i]).collect();
        if !is_reached(scene, geometry, &own) {
            for i in together {
                standing[*i] = Standing::ClosedIn;
            }
        }
    }
    standing
}

/// What a sensor sees around it.
struct Look {
    /// Share of its directions that end at the back of a face.
    backs: f64,
    /// Whether something lies between it and its floor, and nothing between it and the sky.
    is_on_top: bool,
    /// Whether anything lies above the floor below it.
    floor_is_covered: bool,
}

impl Look {
    fn of(scene: &Scene, geometry: &Geometry, plane: &Plane, sensor: &Sensor) -> Self {
        let (place, normal) = (sensor.receiver.position, sensor.receiver.normal);
        let (mut all, mut backs) = (0, 0);
        for i in 0..DIRECTIONS {
            let direction = around(i);
            // A surface is looked at from the front.
            if !plane.is_level() && direction.dot(normal) < 0.1 {
                continue;
            }
            all += 1;
            let ray = Ray {
                origin: place,
                direction,
            };
            if let Some(hit) = geometry.closest(&ray, NEAR, f64::INFINITY) {
                let vertices = scene.mesh.triangles[hit.triangle as usize].vertices;
                let [a, b, c] = vertices.map(|v| scene.mesh.positions[v as usize]);
                backs += u32::from((b - a).cross(c - a).dot(direction) > 0.0);
            }
        }
        let (mut is_on_top, mut floor_is_covered) = (false, false);
        if plane.is_level() && plane.above > 0.0 {
            let floor = place - plane.above * normal;
            let above = Above::of(geometry, floor + 1e-3 * normal);
            floor_is_covered = above.is_covered;
            is_on_top = above.air < plane.above && !Above::of(geometry, place).is_covered;
        }
        Look {
            backs: f64::from(backs) / f64::from(all.max(1)),
            is_on_top,
            floor_is_covered,
        }
    }
}

/// One of the directions all round, evenly spread along a spiral that no edge of a building follows.
fn around(i: u32) -> DVec3 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(DIRECTIONS);
    let (sin, cos) = (TAU * (f64::from(i) * GOLDEN + 0.037)).sin_cos();
    let r = (1.0 - y * y).sqrt();
    DVec3::new(r * cos, y, r * sin)
}

/// The free way through a sensor [m] along the narrowest of eight level directions.
fn width(geometry: &Geometry, sensor: &Sensor) -> f64 {
    let free = |direction: DVec3| {
        let ray = Ray {
            origin: sensor.receiver.position,
            direction,
        };
        let hit = geometry.closest(&ray, NEAR, f64::INFINITY);
        hit.map_or(f64::INFINITY, |hit| hit.distance)
    };
    let both = |i: u32| {
        let (sin, cos) = (PI * (f64::from(i) + 0.013) / 8.0).sin_cos();
        let direction = DVec3::new(cos, 0.0, sin);
        free(direction) + free(-direction)
    };
    (0..8).map(both).fold(f64::INFINITY, f64::min)
}

/// A number for each sensor that it shares with those that it stands together with.
fn groups(geometry: &Geometry, plane: &Plane, sensors: &[Sensor]) -> Vec<usize> {
    // Off the face that sensors lie on.
    let lift = (1e-3 - plane.above).max(0.0) * plane.normal();
    let number: HashMap<[u32; 2], usize> = sensors
        .iter()
        .enumerate()
        .map(|(i, s)| (s.cell, i))
        .collect();
    let sees = |i: usize, cell: [u32; 2]| {
        let other = *number.get(&cell)?;
        let from = sensors[i].receiver.position;
        let way = sensors[other].receiver.position - from;
        let length = way.length();
        let ray = Ray {
            origin: from + lift,
            direction: way / length,
        };
        let is_free = geometry.transmittance(&ray, 0.0, length) == DVec3::ONE;
        is_free.then_some(other)
    };
    let links: Vec<[Option<usize>; 2]> = (0..sensors.len())
        .into_par_iter()
        .map(|i| {
            let [x, y] = sensors[i].cell;
            [sees(i, [x + 1, y]), sees(i, [x, y + 1])]
        })
        .collect();
    // Union by the lower number, with paths halved.
    let mut above: Vec<usize> = (0..sensors.len()).collect();
    fn root(above: &mut [usize], mut i: usize) -> usize {
        while above[i] != i {
            above[i] = above[above[i]];
            i = above[i];
        }
        i
    }
    for (i, links) in links.iter().enumerate() {
        for other in links.iter().flatten() {
            let (a, b) = (root(&mut above, i), root(&mut above, *other));
            above[a.max(b)] = a.min(b);
        }
    }
    (0..sensors.len()).map(|i| root(&mut above, i)).collect()
}
