//! The sun's disc as the scene sees it, and the points that stand for it.

use crate::beam::Beam;
use crate::colour::luminance;
use crate::scene::disc::Disc;
use crate::sky::{SunLight, sun};
use glam::{DMat2, DVec2, DVec3};

/// The sun as the scene sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Unit vector toward the centre of its disc (apparent place), scene axes.
    pub toward: DVec3,
    /// Its light before the scene's own media.
    pub light: SunLight,
    /// Whether the disc darkens toward its limb; a disc of given diameter is uniform.
    pub limb_darkening: bool,
}

impl Sun {
    /// That of a scene which is lit by lamps alone: there is none.
    pub const ABSENT: Sun = Sun {
        toward: DVec3::NEG_Y,
        light: SunLight {
            illuminance: DVec3::ZERO,
            full_illuminance: DVec3::ZERO,
            visible_share: 0.0,
            irradiance: None,
            angular_radius: 0.0,
            visible_elevation: 0.0,
            air_mass: None,
        },
        limb_darkening: false,
    };

    /// Whether any part of it is above the horizon and gives light.
    pub fn shines(&self) -> bool {
        self.missing().is_none()
    }

    /// Why it gives no light, if it gives none.
    pub fn missing(&self) -> Option<&'static str> {
        let given = self.light.irradiance.is_none();
        if *self == Sun::ABSENT {
            Some("the scene has no sun")
        } else if given && luminance(self.light.full_illuminance) <= 0.0 {
            Some("it is a sun without light: it was given 0 lx")
        } else if self.toward.y <= -self.angular_radius().sin() || self.light.visible_share == 0.0 {
            Some("the sun is below the horizon")
        } else if luminance(self.light.illuminance) <= 0.0 {
            Some("the sun is up but gives no light: clouds hide it")
        } else {
            None
        }
    }

    /// Illuminance on a plane that faces it [lx].
    pub fn illuminance_lux(&self) -> f64 {
        luminance(self.light.illuminance)
    }

    /// Angular radius of the disc [rad]; 0 is a point.
    pub fn angular_radius(&self) -> f64 {
        self.light.angular_radius
    }

    /// Solid angle of the whole disc [sr].
    pub fn solid_angle(&self) -> f64 {
        self.light.solid_angle()
    }

    /// Its disc; `None` of a point sun.
    pub fn disc(&self) -> Option<Disc> {
        (self.angular_radius() > 0.0)
            .then(|| Disc::new(self.toward, self.angular_radius(), self.limb_exponent()))
    }

    /// Its luminance falls as (1 - rho^2)^(exponent / 2) toward the limb, by channel; 0 of a uniform disc.
    pub fn limb_exponent(&self) -> DVec3 {
        match self.limb_darkening {
            true => sun::LIMB_EXPONENT,
            false => DVec3::ZERO,
        }
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

    /// Places on the disc [its radii] and their weights, for two points or more: a sunflower spiral, each for the same share of
    /// the area, weighted by limb darkening.
    ///
    /// Few points of a spiral lie to one side, and would move all edges of shadows that way: they are moved until their mean
    /// is the middle, and stretched until they spread as far in all directions.
    fn spiral(&self, count: usize) -> Vec<(DVec2, DVec3)> {
        let mut points: Vec<(DVec2, DVec3)> = sun::sunflower(count)
            .map(|(rho, at)| (at, self.limb(rho)))
            .collect();
        let all: f64 = points.iter().map(|(_, w)| luminance(*w)).sum();
        let mean = |of: &dyn Fn(DVec2) -> f64| -> f64 {
            points
                .iter()
                .map(|(p, w)| luminance(*w) * of(*p))
                .sum::<f64>()
                / all
        };
        let middle = DVec2::new(mean(&|p| p.x), mean(&|p| p.y));
        let wanted = 0.5 * mean(&|p| p.length_squared());
        let xx = mean(&|p| (p.x - middle.x).powi(2));
        let xy = mean(&|p| (p.x - middle.x) * (p.y - middle.y));
        let yy = mean(&|p| (p.y - middle.y).powi(2));
        // The inverse square root of a symmetric matrix M of two rows: ((tr M + q) I - M) / (q sqrt(tr M + 2 q)), q^2 = det M.
        let q = (xx * yy - xy * xy).max(0.0).sqrt();
        let t = (xx + yy + 2.0 * q).sqrt();
        // Two points lie on a line, and cannot be spread over it.
        let stretch = if count > 2 {
            let inner = DMat2::from_cols(DVec2::new(yy + q, -xy), DVec2::new(-xy, xx + q));
            inner * (wanted.sqrt() / (q * t))
        } else {
            DMat2::IDENTITY
        };
        for (p, _) in &mut points {
            *p = stretch * (*p - middle);
        }
        points
    }

    /// `count` beams that stand for cells of the part of the disc above the horizon; one for a point sun.
    ///
    /// They lie on a spiral whose mean and spread are the disc's; together they give [`SunLight::illuminance`]. Their extent is
    /// the radius of a circle with as much of the disc as each has.
    pub fn beams(&self, count: usize) -> Vec<Beam> {
        let places = if self.angular_radius() == 0.0 || count < 2 {
            vec![(DVec2::ZERO, DVec3::ONE)]
        } else {
            self.spiral(count)
        };
        let (x, y) = self.toward.any_orthonormal_pair();
        let (sin_radius, _) = self.angular_radius().sin_cos();
        let place = |(at, weight): (DVec2, DVec3)| {
            let offset = sin_radius * at;
            let toward =
                self.toward * (1.0 - offset.length_squared()).sqrt() + offset.x * x + offset.y * y;
            (toward.normalize(), weight)
        };
        let mut points: Vec<_> = places
            .into_iter()
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
        let angular_radius = self.angular_radius() / (points.len() as f64).sqrt();
        points
            .into_iter()
            .map(|(toward, weight)| Beam::Parallel {
                toward,
                illuminance: self.light.illuminance * weight / sum,
                angular_radius,
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sun of an elevation [rad], an illuminance [lx] and a share above the horizon, given by the user or found.
    fn sun(elevation: f64, illuminance: f64, visible_share: f64, given: bool) -> Sun {
        let full_illuminance = DVec3::splat(illuminance);
        Sun {
            toward: DVec3::new(elevation.cos(), elevation.sin(), 0.0),
            light: SunLight {
                illuminance: visible_share * full_illuminance,
                full_illuminance,
                visible_share,
                irradiance: (!given).then_some(0.01 * illuminance),
                angular_radius: 0.0,
                visible_elevation: elevation.max(0.0),
                air_mass: None,
            },
            limb_darkening: false,
        }
    }

    #[test]
    fn why_there_is_no_sunlight() {
        let missing = |sun: Sun| sun.missing().unwrap_or("nothing is missing");
        for (elevation, share) in [(0.5, 1.0), (0.0, 0.0), (-0.3, 0.0)] {
            let dark = missing(sun(elevation, 0.0, share, true));
            assert!(dark.contains("a sun without light"), "{elevation}: {dark}");
            assert!(!dark.contains("horizon") && !dark.contains("clouds"));
        }
        for given in [true, false] {
            assert!(sun(0.5, 1e5, 1.0, given).shines());
            let low = missing(sun(-0.3, 1e5, 0.0, given));
            assert!(low.contains("below the horizon"), "{low}");
        }
        // At night nothing is left of a sun that is found; on an overcast day neither.
        assert!(missing(sun(-0.3, 0.0, 0.0, false)).contains("below the horizon"));
        assert!(missing(sun(0.5, 0.0, 1.0, false)).contains("clouds hide it"));
    }

    #[test]
    fn points_of_the_disc_lie_around_its_middle_and_spread_alike_in_all_directions() {
        for limb_darkening in [false, true] {
            let sun = Sun {
                toward: DVec3::new(0.3, 0.8, -0.2).normalize(),
                light: SunLight {
                    illuminance: DVec3::ONE,
                    full_illuminance: DVec3::ONE,
                    visible_share: 1.0,
                    irradiance: None,
                    angular_radius: 0.00465,
                    visible_elevation: 0.9,
                    air_mass: None,
                },
                limb_darkening,
            };
            let (x, y) = sun.toward.any_orthonormal_pair();
            // Each channel's shares sum to one, which weights them a little differently.
            let near = if limb_darkening { 1e-4 } else { 1e-9 };
            for count in [2, 3, 4, 5, 16, 128] {
                let points = sun.beams(count);
                assert_eq!(points.len(), count);
                let place = |p: &Beam| {
                    let toward = p.toward_from(DVec3::ZERO);
                    DVec2::new(toward.dot(x), toward.dot(y)) / sun.angular_radius().sin()
                };
                let mean = |of: &dyn Fn(DVec2) -> f64| -> f64 {
                    points
                        .iter()
                        .map(|p| luminance(p.strength()) * of(place(p)))
                        .sum()
                };
                let [a, b] = [mean(&|p| p.x), mean(&|p| p.y)];
                assert!(a.abs() < near && b.abs() < near, "{count}: {a} {b}");
                assert!(points.iter().all(|p| place(p).length() < 1.0), "{count}");
                if count > 2 {
                    let [xx, xy, yy] = [
                        mean(&|p| p.x * p.x),
                        mean(&|p| p.x * p.y),
                        mean(&|p| p.y * p.y),
                    ];
                    assert!(xy.abs() < near && (xx - yy).abs() < near, "{count}: {xy}");
                    // A quarter of the radius' square for an even disc, less where the limb is dark.
                    assert!(xx > 0.2 && xx < 0.25 + near, "{count}: {xx}");
                }
            }
        }
    }
}
