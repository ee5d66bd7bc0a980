//! What does not change with the time of day: who sees whom, and through what.

use super::arrival::{Arrival, Source, all_round, cosine_law};
use super::dome::Dome;
use crate::conditions::Conditions;
use crate::error::Result;
use crate::scene::Ray;
use crate::sky::patches::Subdivision;
use glam::{DVec3, Vec3};

/// How finely light is carried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detail {
    /// Each of Tregenza's 145 patches of the sky is split this many times each way.
    pub sky: u32,
    /// Rays from a point before outlines are refined.
    pub rays: usize,
}

/// Who sees whom in a scene, and through what.
pub struct Transport {
    pub(super) conditions: Conditions,
    pub(super) dome: Dome,
    detail: Detail,
}

impl Transport {
    /// Prepares it for a scene: of the conditions, geometry, materials, media and ground count.
    ///
    /// # Errors
    /// [`crate::Error::Domain`] for a detail out of range.
    pub fn new(conditions: &Conditions, detail: Detail) -> Result<Self> {
        Ok(Transport {
            conditions: conditions.clone(),
            dome: Dome::new(Subdivision::Reinhart(detail.sky))?,
            detail,
        })
    }

    /// What a point of the air receives from all directions; the solid angles sum to 4 pi.
    pub fn around(&self, point: DVec3) -> Vec<Arrival> {
        self.gather(point, &all_round, 4.0 * std::f64::consts::PI)
    }

    /// What a surface receives at a point; the shares sum to 1. `normal` is that of the cosine law, `facet` the side on which
    /// the point is.
    pub fn before(&self, point: DVec3, normal: DVec3, facet: DVec3) -> Vec<Arrival> {
        let geometry = &self.conditions.geometry;
        let near = 1e-9 * geometry.extent() + 1e-12 * point.length();
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let direction = |x: f64, y: f64| {
            let d = cosine_law(x, y);
            tangent * d.x + bitangent * d.y + normal * d.z
        };
        self.gather(point + near * facet, &direction, 1.0)
    }

    fn gather(
        &self,
        origin: DVec3,
        direction: &dyn Fn(f64, f64) -> DVec3,
        whole: f64,
    ) -> Vec<Arrival> {
        let n = (self.detail.rays as f64).sqrt().round().max(2.0) as usize;
        let share = (whole / (n * n) as f64) as f32;
        let at = |i: usize| (i as f64 + 0.5) / n as f64;
        (0..n * n)
            .map(|k| {
                let toward = direction(at(k % n), at(k / n));
                let (source, through) = self.look(origin, toward);
                Arrival {
                    toward: toward.as_vec3(),
                    share,
                    through,
                    source,
                }
            })
            .collect()
    }

    /// What a ray meets, and what is let through on the way.
    fn look(&self, origin: DVec3, direction: DVec3) -> (Source, Vec3) {
        let Conditions {
            geometry,
            air,
            ground,
            ..
        } = &self.conditions;
        let ray = Ray { origin, direction };
        let through = |depth: DVec3| (-depth).exp().as_vec3();
        if let Some(hit) = geometry.closest(&ray, 0.0, f64::INFINITY) {
            let depth = air.optical_depth(origin, direction, hit.distance);
            return (Source::Patch(0), through(depth));
        }
        if direction.y >= 0.0 {
            let depth = air.sky_optical_depth(origin, direction);
            return (Source::Sky(self.dome.patch_of(direction)), through(depth));
        }
        match ground {
            Some(ground) if origin.y >= ground.height => {
                let distance = (origin.y - ground.height) / -direction.y;
                let depth = air.optical_depth(origin, direction, distance);
                (Source::OpenGround, through(depth))
            }
            _ => (Source::Nothing, Vec3::ZERO),
        }
    }
}
