//! The view out of rooms: how wide, how far, and what is in it (EN 17037:2018, 5.2 and annex C, told from memory: not read in print).
//!
//! An eye 1.2 m above the floor at each sensor looks to all sides. A direction leads out where it meets a pane that leads outside before
//! anything opaque; openings without glass are not told from rooms without walls.
//!
//! - *Horizontal sight angle*: all degrees of azimuth together in which some direction leads out.
//! - *Outside distance*: from the pane to what stands there, of level directions that lead out; the median, so that half of the level
//!   view reaches at least so far. No farther than [`FAR`] is told.
//! - *Layers*: sky; landscape, which is what stands [`NEAREST`] or more from the pane; ground, which is the endless one or a level face at
//!   about its height: without a ground that of the scene's lowest point. Those of the opening that shows most of them.
//!
//! Distance and layers are not assessed where the model has nothing outside: there is no landscape, and most of the level view through each
//! opening ends at nothing, seen from all sensors together. A reveal, which ends some of it, is nothing.

use super::grid::Sensors;
use super::opening::sheets;
use crate::conditions::Conditions;
use crate::error::Result;
use crate::scene::Ray;
use crate::task::Task;
use crate::units::DEG;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Levels: least sight angle [degrees], distance [m] and [`View::layers`] (EN 17037, table A.5).
pub const LEVELS: [(&str, f64, f64, f64); 3] = [
    ("minimum", 14.0, 6.0, 1.0),
    ("medium", 28.0, 20.0, 2.0),
    ("high", 54.0, 50.0, 3.0),
];

/// The share of a plane on which they are asked for [1].
pub const ON_PLANE: f64 = 0.75;

/// Height of a sitting person's eyes above the floor [m].
pub const EYES: f64 = 1.2;

/// What is farther is not told apart [m].
pub const FAR: f64 = 1000.0;

/// What is nearer to the pane is no landscape [m].
pub const NEAREST: f64 = 6.0;

/// Why a plane has no view.
pub const NO_FLOOR: &str = "sensors are on surfaces, not above a floor";

/// Faces so far above the ground at most are ground [m].
const GROUND: f64 = 0.5;

/// Steps of azimuth in a full turn, and of elevation to either side, by so many degrees.
const AZIMUTHS: u32 = 360;
const ELEVATIONS: (i32, f64) = (15, 4.0);

const SKY: u8 = 1;
const LANDSCAPE: u8 = 2;
const EARTH: u8 = 4;

/// What one place has of the view; NaN: not assessed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Horizontal sight angle [degrees].
    pub sight_deg: f64,
    /// Outside distance [m]; 0 where no level direction leads out.
    pub distance: f64,
    /// 3: all layers in one opening, 2: landscape and another one, 1: landscape, 0: no landscape.
    pub layers: f64,
}

/// The views of all sensors.
#[derive(Debug, Clone, PartialEq)]
pub struct Views {
    /// They, in the order of the sensors.
    pub points: Vec<View>,
    /// Why no angle, and why no distances and layers are assessed, where that is so.
    pub unknown: [Option<&'static str>; 2],
}

/// What stands outside of openings.
#[derive(Default)]
struct Outside {
    has_landscape: bool,
    /// Of each opening the level directions that end at something, and all of them.
    level: HashMap<u32, [usize; 2]>,
}

impl Outside {
    fn add(&mut self, other: &Outside) {
        self.has_landscape |= other.has_landscape;
        for (opening, [ended, all]) in &other.level {
            let own = self.level.entry(*opening).or_default();
            own[0] += ended;
            own[1] += all;
        }
    }

    fn is_something(&self) -> bool {
        self.has_landscape || self.level.values().any(|[ended, all]| 2 * ended > *all)
    }
}

/// What one direction that leads out shows.
struct Seen {
    opening: u32,
    distance: f64,
    layer: u8,
}

impl Views {
    /// Those from the sensors above the floors of a scene.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] when the work was stopped.
    pub fn new(conditions: &Conditions, sensors: &Sensors, task: Task<'_>) -> Result<Self> {
        let Conditions {
            scene, geometry, ..
        } = conditions;
        let panes = geometry.panes();
        let panes: Vec<u32> = panes.map_or(Vec::new(), |panes| panes.triangles().to_vec());
        let (outer, _) = sheets(scene, geometry, &panes);
        let mut opening_of: HashMap<u32, (u32, DVec3)> = HashMap::new();
        for (number, sheet) in (0..).zip(&outer) {
            let own = sheet.triangles.iter();
            opening_of.extend(own.map(|triangle| (*triangle, (number, sheet.outward))));
        }
        let pieces = task.stage("view out").pieces(sensors.points.len());
        let found: Result<Vec<Option<(View, Outside)>>> = (sensors.points.par_iter())
            .map(|sensor| {
                pieces.begin()?;
                let plane = &sensors.planes[sensor.plane];
                let is_told = plane.is_over_floor && !opening_of.is_empty();
                let eye = sensor.receiver.position + (EYES - plane.above) * DVec3::Y;
                Ok(is_told.then(|| view(conditions, &opening_of, eye)))
            })
            .collect();
        let found = found?;
        let mut outside = Outside::default();
        for (_, own) in found.iter().flatten() {
            outside.add(own);
        }
        let is_something = outside.is_something();
        let points = found.iter().map(|found| match (found, is_something) {
            (None, _) => View {
                sight_deg: f64::NAN,
                distance: f64::NAN,
                layers: f64::NAN,
            },
            (Some((view, _)), true) => *view,
            (Some((view, _)), false) => View {
                distance: f64::NAN,
                layers: f64::NAN,
                ..*view
            },
        });
        let angle = match (opening_of.is_empty(), found.iter().all(Option::is_none)) {
            (true, _) => Some("no pane leads outside ([[pane]] makes a material glass)"),
            (_, true) => Some(NO_FLOOR),
            _ => None,
        };
        let beyond = "the model has nothing outside of its windows";
        Ok(Views {
            points: points.collect(),
            unknown: [angle, angle.or((!is_something).then_some(beyond))],
        })
    }
}

/// The view of an eye, and what stands outside of it.
fn view(
    conditions: &Conditions,
    opening_of: &HashMap<u32, (u32, DVec3)>,
    eye: DVec3,
) -> (View, Outside) {
    let (steps, step) = ELEVATIONS;
    let mut wide = 0;
    let mut distances = Vec::new();
    let mut layers: HashMap<u32, u8> = HashMap::new();
    let mut outside = Outside::default();
    for azimuth in 0..AZIMUTHS {
        let azimuth = (f64::from(azimuth) + 0.5) / f64::from(AZIMUTHS) * std::f64::consts::TAU;
        let mut leads_out = false;
        for k in -steps + 1..steps {
            let (sin, cos) = (f64::from(k) * step * DEG).sin_cos();
            let ray = Ray {
                origin: eye,
                direction: DVec3::new(cos * azimuth.sin(), sin, -cos * azimuth.cos()),
            };
            let Some(seen) = look(conditions, opening_of, &ray) else {
                continue;
            };
            leads_out = true;
            *layers.entry(seen.opening).or_default() |= seen.layer;
            outside.has_landscape |= seen.layer == LANDSCAPE;
            if k == 0 {
                let level = outside.level.entry(seen.opening).or_default();
                level[0] += usize::from(seen.distance.is_finite());
                level[1] += 1;
                distances.push(seen.distance.min(FAR));
            }
        }
        wide += u32::from(leads_out);
    }
    distances.sort_by(f64::total_cmp);
    let of = |layers: u8| match layers & LANDSCAPE {
        0 => 0,
        _ => layers.count_ones(),
    };
    let layers = layers.into_values().map(of).max().unwrap_or(0);
    let view = View {
        sight_deg: 360.0 * f64::from(wide) / f64::from(AZIMUTHS),
        distance: distances.get(distances.len() / 2).copied().unwrap_or(0.0),
        layers: f64::from(layers),
    };
    (view, outside)
}

/// What a direction shows, if it leads out.
fn look(
    conditions: &Conditions,
    opening_of: &HashMap<u32, (u32, DVec3)>,
    ray: &Ray,
) -> Option<Seen> {
    let geometry = &conditions.geometry;
    let met = geometry.panes()?.met(ray, 0.0, f64::INFINITY);
    let (pane, opening) = met.into_iter().find_map(|(distance, triangle)| {
        let (opening, outward) = opening_of.get(&triangle)?;
        (outward.dot(ray.direction) > 0.0).then_some((distance, *opening))
    })?;
    let hit = geometry.closest(ray, 0.0, f64::INFINITY);
    if hit.is_some_and(|hit| hit.distance < pane) {
        return None;
    }
    let lowest = || geometry.bounds().0.y;
    let ground = match conditions.ground {
        Some(ground) => ground.height,
        None => (conditions.scene.ground.height).unwrap_or_else(lowest),
    };
    let (distance, layer) = match hit {
        Some(hit) => {
            let distance = hit.distance - pane;
            let [a, b, c] = conditions.scene.mesh.corners(hit.triangle);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let is_low = ray.at(hit.distance).y <= ground + GROUND;
            let layer = match distance {
                _ if is_low && normal.y.abs() > std::f64::consts::FRAC_1_SQRT_2 => EARTH,
                near if near < NEAREST => 0,
                _ => LANDSCAPE,
            };
            (distance, layer)
        }
        None if ray.direction.y < 0.0 && conditions.ground.is_some() => {
            let way = (ray.origin.y - ground) / -ray.direction.y;
            (way - pane, EARTH)
        }
        None if ray.direction.y >= 0.0 => (f64::INFINITY, SKY),
        None => (f64::INFINITY, 0),
    };
    Some(Seen {
        opening,
        distance,
        layer,
    })
}
