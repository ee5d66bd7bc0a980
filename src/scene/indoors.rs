//! A camera inside a building: where a person can stand and see light, and the way that shows most from there.
//!
//! Columns over a lattice of the bounds are followed down. Each level surface with room above it is a floor, and so is the open ground;
//! on it stands an eye at a person's height (or half of what is there, in a model of another size). Rays to all sides from it say what
//! it sees. An eye that light reaches by no ray stands in a sealed void, and is left out. Of the others, those under a roof come first,
//! and of these the one whose best view is widest: it looks far, and has openings in it without looking at nothing else.

use super::{Camera, Geometry, Ray, Scene};
use crate::sky::sun::fibonacci_sphere;
use crate::units::DEG;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Columns along each side of the bounds.
const COLUMNS: usize = 24;

/// Surfaces that a column is followed through, at most: leaves of trees have no end.
const LEVELS: usize = 64;

/// Rays to all sides from an eye.
const RAYS: usize = 512;

/// Directions that an eye looks in.
const TURNS: usize = 24;

/// Height of a person's eyes [m].
const EYES: f64 = 1.6;

/// Vertical field of view [rad].
const FOV_Y: f64 = 60.0 * DEG;

/// Share of the rays of a view through openings from where on more of them make it no better [1].
const OPEN: f64 = 0.15;

/// An eye with the best of its views.
struct View {
    eye: DVec3,
    toward: DVec3,
    /// Whether most of what is above is covered.
    is_under_a_roof: bool,
    value: f64,
}

/// A place for a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standpoint {
    /// On a floor or the ground, looking level.
    pub camera: Camera,
    /// Whether most of what is above is covered.
    pub is_under_a_roof: bool,
}

/// A camera that stands on a floor of a scene with light in sight: under a roof where there is such a place, in the open where there is
/// none, `None` where no floor has light in sight. `ground` is the height of the endless ground [m], where there is one. The same for the
/// same scene.
pub fn indoors(scene: &Scene, geometry: &Geometry, ground: Option<f64>) -> Option<Standpoint> {
    let (min, max) = scene.mesh.bounds()?;
    let size = max - min;
    let height = EYES.min(0.5 * size.y);
    let place = |i: usize| {
        let share = |k: usize| (k as f64 + 0.5) / COLUMNS as f64;
        let (x, z) = (share(i % COLUMNS), share(i / COLUMNS));
        DVec3::new(min.x + x * size.x, max.y, min.z + z * size.z)
    };
    let columns = (0..COLUMNS * COLUMNS).into_par_iter();
    let views: Vec<View> = columns
        .flat_map_iter(|i| floors(scene, geometry, place(i), ground, height))
        .filter_map(|floor| {
            view(
                scene,
                geometry,
                floor + height * DVec3::Y,
                height,
                ground.is_some(),
            )
        })
        .collect();
    // In the order of columns, so that the first of equals is always the same.
    let better = |a: &View, b: &View| (a.is_under_a_roof, a.value) > (b.is_under_a_roof, b.value);
    let best = views
        .into_iter()
        .reduce(|best, next| if better(&next, &best) { next } else { best })?;
    Some(Standpoint {
        camera: Camera::look_at(best.eye, best.eye + best.toward, FOV_Y),
        is_under_a_roof: best.is_under_a_roof,
    })
}

/// Level surfaces below the top of a column, and the ground, over each of which a person has room.
fn floors(
    scene: &Scene,
    geometry: &Geometry,
    top: DVec3,
    ground: Option<f64>,
    height: f64,
) -> Vec<DVec3> {
    let room = 1.25 * height;
    let slack = 1e-6 * geometry.extent();
    let mut floors = Vec::new();
    let mut above = f64::INFINITY;
    let mut from = top + slack * DVec3::Y;
    for _ in 0..LEVELS {
        let down = Ray {
            origin: from,
            direction: DVec3::NEG_Y,
        };
        let Some(hit) = geometry.closest(&down, 0.0, f64::INFINITY) else {
            break;
        };
        let place = down.at(hit.distance);
        let [a, b, c] = scene.mesh.triangles[hit.triangle as usize]
            .vertices
            .map(|vertex| scene.mesh.positions[vertex as usize]);
        let normal = (b - a).cross(c - a);
        let is_level = normal.y.abs() > 0.9 * normal.length();
        if is_level && above - place.y >= room {
            floors.push(place);
        }
        above = place.y;
        from = place - slack * DVec3::Y;
    }
    if let Some(ground) = ground
        && ground < above
        && above - ground >= room
    {
        floors.push(DVec3::new(top.x, ground, top.z));
    }
    floors
}

/// The best view from an eye, if it has room around it and light in sight.
fn view(scene: &Scene, geometry: &Geometry, eye: DVec3, height: f64, ground: bool) -> Option<View> {
    let far = geometry.extent();
    // How far each ray sees, and whether it meets nothing.
    let sights: Vec<(DVec3, f64, bool)> = (0..RAYS)
        .map(|i| {
            let ray = Ray {
                origin: eye,
                direction: fibonacci_sphere(i, RAYS),
            };
            // What lets some light through is in nobody's way.
            let (met, _) = geometry.met(&ray, 0.0, f64::INFINITY);
            let falls = ray.direction.y < 0.0 && ground;
            let distance = met.map_or(far, |hit| hit.distance.min(far));
            (ray.direction, distance, met.is_none() && !falls)
        })
        .collect();
    if sights
        .iter()
        .any(|(_, distance, _)| *distance < 0.2 * height)
    {
        return None;
    }
    let overhead = sights.iter().filter(|(d, ..)| d.y > 0.0);
    let (count, open) = overhead.fold((0, 0), |(count, open), (_, _, is_open)| {
        (count + 1, open + usize::from(*is_open))
    });
    let lamps = scene.lamps.iter().map(|lamp| lamp.position);
    let sees_a_lamp = lamps.into_iter().any(|lamp| {
        let way = lamp - eye;
        let distance = way.length().max(f64::MIN_POSITIVE);
        let ray = Ray {
            origin: eye,
            direction: way / distance,
        };
        !geometry.occluded(&ray, 0.0, 0.99 * distance)
    });
    if open == 0 && !sees_a_lamp {
        return None;
    }
    let turned = |turn: usize| {
        let (sin, cos) = (TAU * turn as f64 / TURNS as f64).sin_cos();
        DVec3::new(sin, 0.0, -cos)
    };
    let value = |toward: DVec3| {
        let within = sights
            .iter()
            .filter(|(d, ..)| d.dot(toward) > (0.6 * FOV_Y).cos());
        let (mut count, mut open, mut sum) = (0.0, 0.0, 0.0);
        for (_, distance, is_open) in within {
            count += 1.0;
            match is_open {
                true => open += 1.0,
                false => sum += (distance / far).sqrt(),
            }
        }
        let count: f64 = f64::max(count, 1.0);
        sum / count + 2.0 * f64::min(open / count, OPEN)
    };
    let (toward, value) = (0..TURNS)
        .map(|turn| (turned(turn), value(turned(turn))))
        .reduce(|best, next| if next.1 > best.1 { next } else { best })?;
    Some(View {
        eye,
        toward,
        is_under_a_roof: 2 * open < count,
        value,
    })
}
