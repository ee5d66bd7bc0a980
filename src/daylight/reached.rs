//! Whether daylight comes to where sensors stand: voids in walls, below floors and above ceilings are as high as rooms sometimes.
//!
//! Light that would come in goes the same way as light that would get out. So ways are followed from the sensors that stand together; each
//! turns at every surface, by the cosine law and losing nothing, until it comes out under the sky. Panes are in nobody's way, see-through
//! surfaces neither. Of a closet whose door stands open to a corridor with a window, a tenth of them and more come out; of a void they
//! do at most where walls do not quite meet.

use super::plane::Sensor;
use crate::scene::{Geometry, Ray, Scene};
use crate::split_mix::SplitMix;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Ways from each sensor.
const WAYS: usize = 64;
/// Ways from all sensors that stand together: at least, and at most.
const ALL_WAYS: [usize; 2] = [256, 2048];
/// How often a way turns.
const TURNS: usize = 64;
/// One of so many ways must come out.
const OF: usize = 500;

/// Whether daylight comes to one of some sensors.
pub fn is_reached(scene: &Scene, geometry: &Geometry, sensors: &[&Sensor]) -> bool {
    let [least, most] = ALL_WAYS;
    let count = (WAYS * sensors.len()).clamp(least, most);
    let comes_out = |number: &usize| {
        // All over them, in the order of the grid.
        let sensor = sensors[number * sensors.len() / count];
        comes_out(scene, geometry, sensor, *number as u64)
    };
    let out = (0..count).into_par_iter().filter(comes_out).count();
    out * OF >= count
}

/// Whether a way from a sensor comes out.
fn comes_out(scene: &Scene, geometry: &Geometry, sensor: &Sensor, number: u64) -> bool {
    let lift = 1e-6 * geometry.extent();
    let ground = scene.ground.height.unwrap_or(geometry.bounds().0.y);
    let mut chance = SplitMix(number);
    let mut normal = sensor.receiver.normal;
    let mut place = sensor.receiver.position;
    for _ in 0..TURNS {
        let ray = Ray {
            origin: place + lift * normal,
            direction: by_cosine(normal, &mut chance),
        };
        match geometry.met(&ray, 0.0, f64::INFINITY).0 {
            Some(hit) => {
                let [a, b, c] = scene.mesh.corners(hit.triangle);
                let facet = (b - a).cross(c - a).normalize_or_zero();
                place = ray.at(hit.distance);
                normal = match facet.dot(ray.direction) > 0.0 {
                    true => -facet,
                    false => facet,
                };
            }
            None if ray.direction.y >= 0.0 => return true,
            None if scene.ground.enabled && ray.origin.y > ground => {
                place = ray.at((ground - ray.origin.y) / ray.direction.y);
                normal = DVec3::Y;
            }
            None => return false,
        }
    }
    false
}

/// A direction before a surface by the cosine law: from a point of the unit sphere that stands on it.
fn by_cosine(normal: DVec3, chance: &mut SplitMix) -> DVec3 {
    let height = 2.0 * chance.unit() - 1.0;
    let (sin, cos) = (TAU * chance.unit()).sin_cos();
    let r = (1.0 - height * height).sqrt();
    let toward = normal + DVec3::new(r * cos, height, r * sin);
    toward.try_normalize().unwrap_or(normal)
}
