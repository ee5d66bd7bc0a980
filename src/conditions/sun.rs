//! The sun's disc as the scene sees it, and the points that stand for it.

use crate::colour::luminance;
use crate::sky::{SunLight, sun};
use glam::DVec3;
use std::f64::consts::PI;

/// The sun as the scene sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Unit vector toward the centre of its disc (apparent place), scene axes.
    pub toward: DVec3,
    /// Its light before the scene's own media.
    pub light: SunLight,
    /// Angular radius of the disc [rad]; 0 is a point.
    pub angular_radius: f64,
    /// Whether the disc darkens toward its limb; a disc of given diameter is uniform.
    pub limb_darkening: bool,
}

/// One of the points that stand for the sun's disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunPoint {
    /// Unit vector toward it.
    pub toward: DVec3,
    /// Its share of the illuminance on a plane that faces it [lx, RGB].
    pub illuminance: DVec3,
}

impl Sun {
    /// Whether any part of it is above the horizon and gives light.
    pub fn shines(&self) -> bool {
        luminance(self.light.illuminance) > 0.0 && self.toward.y > -self.angular_radius.sin()
    }

    /// Illuminance on a plane that faces it [lx].
    pub fn illuminance_lux(&self) -> f64 {
        luminance(self.light.illuminance)
    }

    /// Solid angle of the whole disc [sr].
    pub fn solid_angle(&self) -> f64 {
        4.0 * PI * (0.5 * self.angular_radius).sin().powi(2)
    }

    fn limb(&self, rho: f64) -> DVec3 {
        if self.limb_darkening {
            sun::limb(rho)
        } else {
            DVec3::ONE
        }
    }

    /// Mean luminance [cd/m2, RGB] between two of the disc's radii, 0 to 1, `inner` below `outer`.
    pub fn ring_luminance(&self, inner: f64, outer: f64) -> DVec3 {
        // The mean over area of mu^alpha, mu^2 = 1 - rho^2: with s = rho^2 it is a power of 1 - s.
        let exponent = if self.limb_darkening {
            0.5 * sun::LIMB_EXPONENT
        } else {
            DVec3::ZERO
        };
        let (a, b) = (1.0 - inner * inner, 1.0 - outer * outer);
        let channel = |i: usize| {
            let n = exponent[i] + 1.0;
            n.recip() * (a.powf(n) - b.max(0.0).powf(n)) / (a - b) * n
        };
        self.light.full_illuminance / self.solid_angle()
            * DVec3::new(channel(0), channel(1), channel(2))
    }

    /// `count` points that stand for the part of the disc above the horizon; one for a point sun.
    ///
    /// They lie on a sunflower spiral, each for the same share of the disc's area, weighted by limb darkening; together they
    /// give [`SunLight::illuminance`].
    pub fn points(&self, count: usize) -> Vec<SunPoint> {
        let count = if self.angular_radius == 0.0 {
            1
        } else {
            count.max(1)
        };
        let (x, y) = self.toward.any_orthonormal_pair();
        let golden = PI * (3.0 - 5.0f64.sqrt());
        let (sin_radius, _) = self.angular_radius.sin_cos();
        let place = |i: usize| {
            let rho = if count == 1 {
                0.0
            } else {
                ((i as f64 + 0.5) / count as f64).sqrt()
            };
            let (sin, cos) = (i as f64 * golden).sin_cos();
            let offset = rho * sin_radius;
            let toward =
                self.toward * (1.0 - offset * offset).sqrt() + offset * (cos * x + sin * y);
            (toward.normalize(), self.limb(rho))
        };
        let mut points: Vec<_> = (0..count)
            .map(place)
            .filter(|(toward, _)| toward.y > 0.0)
            .collect();
        if points.is_empty() {
            // All are below the horizon but a sliver of the disc may not be: its top stands for it.
            let up = DVec3::Y - self.toward * self.toward.y;
            let top = self.toward + sin_radius * up.normalize_or_zero();
            let top = DVec3::new(top.x, top.y.max(1e-9), top.z);
            points.push((top.normalize(), DVec3::ONE));
        }
        let sum: DVec3 = points.iter().map(|(_, weight)| *weight).sum();
        points
            .into_iter()
            .map(|(toward, weight)| SunPoint {
                toward,
                illuminance: self.light.illuminance * weight / sum,
            })
            .collect()
    }
}
