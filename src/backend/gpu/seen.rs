//! How far a picture's rays see: up to the first surface, the end of the air, or where the air hides all that is behind.
//!
//! Shadow maps are fitted to that and not to the bounds of the scene, as sample distribution shadow maps are to the depths of a
//! picture (Lauritzen, Salvi & Lefohn 2011). Where they take all depths from the device, some thousand rays are traced on the CPU
//! here: the air between eye and surface needs maps too, and how far it reaches is known in f64 before anything is drawn.

use crate::conditions::Conditions;
use crate::scene::Ray;
use glam::{DVec2, UVec2};
use rayon::prelude::*;

/// Rays across and down, at most.
const RAYS: UVec2 = UVec2::new(64, 48);

/// Light from behind such an optical depth is not seen: e^-10 of it comes through.
const DEEPEST: f64 = 10.0;

/// A ray and the part of it that is seen [m].
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    pub ray: Ray,
    pub near: f64,
    pub far: f64,
}

/// How far the rays of a picture see.
#[derive(Debug, Clone, Default)]
pub struct Seen {
    pub sights: Vec<Sight>,
}

impl Seen {
    /// Rays evenly over the picture, its borders among them; those that see nothing are left out.
    pub fn of(conditions: &Conditions) -> Self {
        let size = UVec2::from(conditions.view.size);
        let count = match conditions.view.points() {
            Some(_) => size,
            None => RAYS.min(size.max(UVec2::splat(2))),
        };
        let sights = (0..count.x * count.y).into_par_iter().filter_map(|i| {
            let at = UVec2::new(i % count.x, i / count.x).as_dvec2();
            let at = match conditions.view.points() {
                Some(_) => at + 0.5,
                None => at / (count - 1).as_dvec2() * size.as_dvec2(),
            };
            sight(conditions, at)
        });
        Seen {
            sights: sights.collect(),
        }
    }

    /// The greatest distance that is seen [m]; 0 where nothing is.
    pub fn farthest(&self) -> f64 {
        self.sights
            .iter()
            .map(|sight| sight.far)
            .fold(0.0, f64::max)
    }

    /// The distance within which a share of the rays ends [m]; 0 where nothing is seen.
    pub fn quantile(&self, share: f64) -> f64 {
        let mut ends: Vec<f64> = self.sights.iter().map(|sight| sight.far).collect();
        ends.sort_by(f64::total_cmp);
        let index = share * ends.len().saturating_sub(1) as f64;
        ends.get(index.round() as usize).copied().unwrap_or(0.0)
    }
}

fn sight(conditions: &Conditions, at: DVec2) -> Option<Sight> {
    let ray = conditions.view.ray(at);
    let hit = conditions.geometry.closest(&ray, 0.0, f64::INFINITY);
    let mut far = hit.map_or(f64::INFINITY, |hit| hit.distance);
    if let Some(ground) = conditions.ground {
        let down = (ray.origin.y - ground.height) / -ray.direction.y;
        if ray.direction.y < 0.0 && down > 0.0 {
            far = far.min(down);
        }
    }
    let air = &conditions.air;
    if air.media.is_empty() {
        // Whoever asks maps there asks them for surfaces.
        return far.is_finite().then_some(Sight {
            ray,
            near: far,
            far,
        });
    }
    let end = far.min(air.end(ray.origin, ray.direction));
    let hidden = |t: f64| {
        air.optical_depth(ray.origin, ray.direction, t)
            .min_element()
            >= DEEPEST
    };
    let far = if end > 0.0 && hidden(end) {
        let mut ends = (0.0, end);
        for _ in 0..40 {
            let middle = 0.5 * (ends.0 + ends.1);
            if hidden(middle) {
                ends.1 = middle;
            } else {
                ends.0 = middle;
            }
        }
        ends.1
    } else {
        end
    };
    (far > 0.0).then_some(Sight {
        ray,
        near: 0.0,
        far,
    })
}

/// Width of a pixel in the middle of the picture at a distance [m]; 0 for points, which have no pixels.
pub fn pixel_width(conditions: &Conditions, distance: f64) -> f64 {
    let view = &conditions.view;
    if view.points().is_some() {
        return 0.0;
    }
    let middle = 0.5 * UVec2::from(view.size).as_dvec2();
    let at = |x: f64, y: f64| {
        view.camera
            .ray(middle + DVec2::new(x, y), view.size)
            .at(distance)
    };
    let here = at(0.0, 0.0);
    (at(1.0, 0.0) - here)
        .length()
        .min((at(0.0, 1.0) - here).length())
}
