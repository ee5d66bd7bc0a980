//! Maps of the whole sky: where a texel looks, what it sees, and the sun's disc with its full energy.

use super::circles::Circles;
use super::{Sky, SunLight};
use crate::colour::luminance;
use crate::error::{Error, Result};
use crate::memory;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// How directions lie in a map. Texel (0, 0) is at the top left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Projection {
    /// Twice as wide as high: -Z (north by default) in the middle column, +X (east) to its right, the zenith on top.
    Equirectangular,
    /// A square of the upper hemisphere seen from below, zenith angle in proportion to the distance from the middle:
    /// -Z on top, +X to the left, as the sky is drawn.
    Fisheye,
    /// Six squares side by side, +X -X +Y -Y +Z -Z, each laid out as a face of an OpenGL cube map.
    Cube,
}

/// A map's projection and size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Map {
    /// How directions lie in it.
    pub projection: Projection,
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
}

/// The most rows of a map.
const HIGHEST: u32 = 32_768;

/// Points that the sun's disc is made of: a texel that it covers in full gets some hundred of them at 8 192 texels around.
const DISC_POINTS: usize = 1 << 16;

/// Computes the rows of a map, on any number of cores.
pub struct Painter<'s> {
    map: Map,
    sky: &'s Sky,
    ground: Vec3,
    /// The rows of an equirectangular map are circles of equal elevation.
    circles: Option<Circles<'s>>,
}

impl Painter<'_> {
    /// Paints row `y` into as many texels as the map is wide; within 1e-6 of [`Sky::radiance`].
    pub fn row(&self, y: u32, texels: &mut [Vec3]) {
        let middle = f64::from(y) + 0.5;
        if let Some(circles) = &self.circles {
            let elevation = (0.5 - middle / f64::from(self.map.height)) * PI;
            if elevation < 0.0 {
                texels.fill(self.ground);
            } else {
                circles.radiances(elevation, texels);
            }
            return;
        }
        for (x, texel) in texels.iter_mut().enumerate() {
            *texel = match self.map.direction(x as f64 + 0.5, middle) {
                None => Vec3::ZERO,
                Some(d) if d.y < 0.0 => self.ground,
                Some(d) => self.sky.radiance(d).as_vec3(),
            };
        }
    }
}

impl Projection {
    /// The width of its maps over their height, and what their heights are multiples of.
    fn shape(self) -> (u32, u32) {
        match self {
            // The horizon lies between two rows.
            Projection::Equirectangular => (2, 2),
            Projection::Fisheye => (1, 1),
            Projection::Cube => (6, 1),
        }
    }

    /// The size of a map [texels] whose width is nearest to that of `size`.
    pub fn nearest(self, [width, _]: [u32; 2]) -> [u32; 2] {
        let (aspect, multiple) = self.shape();
        let steps = (f64::from(width) / f64::from(aspect * multiple)).round();
        let height = multiple * steps.clamp(1.0, f64::from(HIGHEST / multiple)) as u32;
        [aspect * height, height]
    }
}

impl Map {
    /// A map of that size.
    ///
    /// # Errors
    /// [`Error::Domain`] when the sides do not fit the projection (2:1, 1:1 or 6:1), or exceed 32 768 texels.
    pub fn new(projection: Projection, width: u32, height: u32) -> Result<Self> {
        let shape = match projection {
            Projection::Equirectangular => "twice as wide as high, and even in height",
            Projection::Fisheye => "square",
            Projection::Cube => "six times as wide as high",
        };
        let (aspect, multiple) = projection.shape();
        let is_wide = u64::from(height) * u64::from(aspect) == u64::from(width);
        if !(1..=HIGHEST).contains(&height) || !height.is_multiple_of(multiple) || !is_wide {
            return Err(Error::domain(
                "the map's size",
                format!("{width}x{height}"),
                format!("{shape}, at most {HIGHEST} high"),
                "give such a size",
            ));
        }
        Ok(Map {
            projection,
            width,
            height,
        })
    }

    /// The direction of a point of the map, in texels from the top left corner; `None` outside the fisheye's circle.
    pub fn direction(&self, x: f64, y: f64) -> Option<DVec3> {
        let (w, h) = (f64::from(self.width), f64::from(self.height));
        match self.projection {
            Projection::Equirectangular => {
                let (sa, ca) = ((x / w - 0.5) * 2.0 * PI).sin_cos();
                let (se, ce) = ((0.5 - y / h) * PI).sin_cos();
                Some(DVec3::new(ce * sa, se, -ce * ca))
            }
            Projection::Fisheye => {
                // Whether a texel's middle is within the circle is a question of whole numbers.
                let p = DVec2::new(2.0 * x - w, 2.0 * y - h);
                if p.length_squared() > w * w {
                    return None;
                }
                let (st, ct) = (p.length() / w * FRAC_PI_2).sin_cos();
                let flat = p.normalize_or_zero() * st;
                Some(DVec3::new(-flat.x, ct, flat.y))
            }
            Projection::Cube => {
                let face = ((x / h) as u32).min(5);
                let s = 2.0 * (x / h - f64::from(face)) - 1.0;
                let t = 2.0 * y / h - 1.0;
                let v = match face {
                    0 => DVec3::new(1.0, -t, -s),
                    1 => DVec3::new(-1.0, -t, s),
                    2 => DVec3::new(s, 1.0, t),
                    3 => DVec3::new(s, -1.0, -t),
                    4 => DVec3::new(s, -t, 1.0),
                    _ => DVec3::new(-s, -t, -1.0),
                };
                Some(v.normalize())
            }
        }
    }

    /// The point of the map, in texels from the top left corner, that shows a unit direction; `None` where none does.
    pub fn point(&self, d: DVec3) -> Option<DVec2> {
        let (w, h) = (f64::from(self.width), f64::from(self.height));
        match self.projection {
            Projection::Equirectangular => {
                let elevation = d.y.atan2(d.x.hypot(d.z));
                Some(DVec2::new(
                    (d.x.atan2(-d.z) / (2.0 * PI) + 0.5) * w,
                    (0.5 - elevation / PI) * h,
                ))
            }
            Projection::Fisheye => {
                let flat = DVec2::new(-d.x, d.z);
                let r = flat.length().atan2(d.y) / FRAC_PI_2;
                (r <= 1.0).then(|| (flat.normalize_or_zero() * r + 1.0) * 0.5 * DVec2::new(w, h))
            }
            Projection::Cube => {
                let a = d.abs();
                let (face, m, s, t) = if a.x >= a.y && a.x >= a.z {
                    if d.x > 0.0 {
                        (0, a.x, -d.z, -d.y)
                    } else {
                        (1, a.x, d.z, -d.y)
                    }
                } else if a.y >= a.z {
                    if d.y > 0.0 {
                        (2, a.y, d.x, d.z)
                    } else {
                        (3, a.y, d.x, -d.z)
                    }
                } else if d.z > 0.0 {
                    (4, a.z, d.x, -d.y)
                } else {
                    (5, a.z, -d.x, -d.y)
                };
                Some(DVec2::new(
                    (f64::from(face) + 0.5 * (s / m + 1.0)) * h,
                    0.5 * (t / m + 1.0) * h,
                ))
            }
        }
    }

    /// Solid angle of a texel [sr], exact for the equirectangular map, at its middle for the others.
    pub fn solid_angle(&self, x: u32, y: u32) -> f64 {
        let h = f64::from(self.height);
        match self.projection {
            Projection::Equirectangular => {
                let edge = |y: f64| ((0.5 - y / h) * PI).sin();
                let band = edge(f64::from(y)) - edge(f64::from(y) + 1.0);
                band * 2.0 * PI / f64::from(self.width)
            }
            Projection::Fisheye => {
                let centre = |v: u32| 2.0 * (f64::from(v) + 0.5) / h - 1.0;
                let theta = centre(x).hypot(centre(y)) * FRAC_PI_2;
                let stretch = if theta < 1e-9 {
                    1.0
                } else {
                    theta.sin() / theta
                };
                stretch * (PI / h) * (PI / h)
            }
            Projection::Cube => {
                // Differences of the integral of (1 + s^2 + t^2)^(-3/2).
                let edge = |v: u32, up: u32| 2.0 * f64::from(v % self.height + up) / h - 1.0;
                let corner = |s: f64, t: f64| (s * t).atan2((s * s + t * t + 1.0).sqrt());
                let (s0, s1, t0, t1) = (edge(x, 0), edge(x, 1), edge(y, 0), edge(y, 1));
                corner(s1, t1) - corner(s0, t1) - corner(s1, t0) + corner(s0, t0)
            }
        }
    }

    /// What paints the map's rows, without the sun's disc: RGB in the working space [cd/m2]; `ground` below the horizon,
    /// black outside the circle of a fisheye.
    pub fn painter<'s>(&self, sky: &'s Sky, ground: DVec3) -> Painter<'s> {
        let width = f64::from(self.width);
        let azimuths = (0..self.width).map(|x| ((f64::from(x) + 0.5) / width - 0.5) * 2.0 * PI);
        Painter {
            map: *self,
            sky,
            ground: ground.as_vec3(),
            circles: (self.projection == Projection::Equirectangular)
                .then(|| Circles::new(sky, azimuths)),
        }
    }

    /// The whole map without the sun's disc, row by row, on all cores: see [`Self::painter`].
    ///
    /// # Errors
    /// [`Error::Failed`] when there is not enough memory.
    pub fn paint(&self, sky: &Sky, ground: DVec3) -> Result<Vec<Vec3>> {
        let width = self.width as usize;
        let painter = self.painter(sky, ground);
        let count = width * self.height as usize;
        let bytes = (count * size_of::<Vec3>()) as u64;
        memory::check("the map", bytes)?;
        // Zeroed memory is first touched, which is expensive, by the core that fills it.
        let mut texels = bytemuck::allocation::try_zeroed_vec(count)
            .map_err(|()| memory::not_enough("the map", bytes))?;
        texels
            .par_chunks_mut(width)
            .zip(0..self.height)
            .for_each(|(row, y)| painter.row(y, row));
        Ok(texels)
    }

    /// What the sun's disc adds: texel index (y * width + x) and RGB in the working space [cd/m2].
    ///
    /// The disc's light is shared out over the texels that it covers, by a sunflower of 65 536 points with limb
    /// darkening: radiance times solid angle sums to [`SunLight::illuminance`] however few texels there are. A texel that
    /// the disc covers in part gets that part. What is below the horizon is left out.
    pub fn disc(&self, light: &SunLight, toward_sun: DVec3) -> Vec<(usize, DVec3)> {
        if luminance(light.illuminance) <= 0.0 {
            return Vec::new();
        }
        let (u, v) = toward_sun.any_orthonormal_pair();
        let radius = light.angular_radius.tan();
        let mut texels = std::collections::BTreeMap::<usize, DVec3>::new();
        let mut total = DVec3::ZERO;
        for (rho, at) in super::sun::sunflower(DISC_POINTS) {
            let d = (toward_sun + radius * (at.x * u + at.y * v)).normalize();
            if d.y < 0.0 {
                continue;
            }
            let weight = super::sun::limb(rho);
            total += weight;
            if let Some(p) = self.point(d) {
                let x = (p.x as u32).min(self.width - 1);
                let y = (p.y as u32).min(self.height - 1);
                let index = y as usize * self.width as usize + x as usize;
                *texels.entry(index).or_default() += weight / self.solid_angle(x, y);
            }
        }
        let scale = light.illuminance / total;
        texels
            .into_iter()
            .filter(|_| scale.is_finite())
            .map(|(index, sum)| (index, sum * scale))
            .collect()
    }
}
