//! Light of lamps in the air on virtual planes across the view, with a projected, shadowed light map: the first method that ran on
//! graphics hardware.
//!
//! L = sum over k of I_k xi_k Delta t_k, xi = sum over i of sigma_s,i p_i(mu) e^-(tau_eye + tau_lamp) / r^2 (equations 5 and 6), over planes at
//! even depths (of a panorama: at even distances) up to the farthest air that the picture shows, or an optical depth of 9 before the eye.
//! I_k, intensity and shadow in the direction of plane k, is read from the lamp's light map, bilinearly of texels each of which is
//! wholly lit or dark; the smooth factor xi is found at the points of a coarse lattice on each plane and interpolated between them.
//!
//! Source: Y. Dobashi, T. Yamamoto, T. Nishita, "Interactive Rendering Method for Displaying Shafts of Light", Proc. Pacific
//! Graphics 2000, with the misprints of its equations 2 and 6 put right as in [`crate::effect::shafts_planes`].
//!
//! Differs: a lamp that shines all around has six maps, the sides of a cube. Delta t_k is the length of ray inside the slab, before the
//! surface and in the air, and the map is read in the middle of that. A texel is compared with the distance of the point, not with that of
//! the plane in the texel's direction. A lamp is no nearer to a plane than the planes' distance over pi, where a plane that goes right
//! through it is as bright as the ray beside it is. What lets light through stops none of it. There is no sum in 8 bits.

use crate::colour::luminance;
use crate::conditions::lamps::{Lamp, Spot};
use crate::conditions::{Conditions, spread};
use crate::effect::visibility::first_surface;
use crate::error::{Error, Result};
use crate::scene::{Camera, Projection, Ray};
use glam::{DMat3, DVec2, DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// An optical depth before the eye behind which no plane stands: 1.2e-4 of the light comes through.
const DEEP: f64 = 9.0;

/// So many rays tell how far the picture's air goes.
const PROBES: usize = 1024;

/// Wider cones have the six sides of a cube for a light map [rad].
const ONE_MAP: f64 = PI / 3.0;

/// No more lattice points and texels are kept, for all lamps together.
const MOST_POINTS: usize = 1 << 26;

/// Planes, and what they hold of each spot.
pub(super) struct Planes<'c> {
    conditions: &'c Conditions,
    count: usize,
    /// Lattice points along each side of a plane.
    side: usize,
    /// How far apart the planes are [m].
    apart: f64,
    spots: Vec<OnPlanes>,
}

/// What planes hold of a spot.
struct OnPlanes {
    maps: Vec<LightMap>,
    /// xi [1/(m3 sr)], plane by plane, row by row.
    lattice: Vec<Vec3>,
}

/// Intensity and depth in the directions of a square across an axis.
struct LightMap {
    /// Its axes: right, up and the middle's direction.
    axes: [DVec3; 3],
    /// How far it goes to each side at a distance of 1.
    half: f64,
    side: usize,
    /// Shape of the intensity [1], and how far the light goes [m].
    texels: Vec<(f64, f64)>,
}

impl<'c> Planes<'c> {
    /// Prepares so many planes with lattices and light maps of so many points and texels along each side.
    pub fn new(
        conditions: &'c Conditions,
        spots: &[(&Lamp, Spot)],
        [planes, lattice, map]: [usize; 3],
    ) -> Result<Self> {
        let points = (planes * lattice * lattice + 6 * map * map).saturating_mul(spots.len());
        if points > MOST_POINTS {
            return Err(Error::input(
                "air_lamps.planes, air_lamps.lattice, air_lamps.map",
                format!("{points} points and texels for all lamps, more than {MOST_POINTS}"),
                "set fewer planes, lattice points or texels, or another air_lamps.integrator",
            ));
        }
        let mut all = Planes {
            conditions,
            count: planes,
            side: lattice,
            apart: farthest(conditions) / planes as f64,
            spots: Vec::new(),
        };
        let on_planes = |(lamp, spot): &(&Lamp, Spot)| OnPlanes {
            maps: light_maps(conditions, lamp, spot, map),
            lattice: all.lattice(spot),
        };
        all.spots = spots.iter().map(on_planes).collect();
        Ok(all)
    }

    /// xi at all points of all lattices.
    fn lattice(&self, spot: &Spot) -> Vec<Vec3> {
        let view = &self.conditions.view;
        let air = &self.conditions.air;
        let size = DVec2::new(f64::from(view.size[0]), f64::from(view.size[1]));
        let last = (self.side - 1) as f64;
        let least = spot.radius.max(self.apart / PI);
        let mut values = Vec::with_capacity(self.count * self.side * self.side);
        for k in 0..self.count {
            let depth = self.apart * (k as f64 + 0.5);
            for row in 0..self.side {
                for column in 0..self.side {
                    let at = DVec2::new(column as f64 / last, row as f64 / last);
                    let ray = view.camera.ray(at * size, view.size);
                    let t = depth / slope(&view.camera, ray.direction);
                    let point = ray.at(t);
                    let way = spot.position - point;
                    let distance = way.length();
                    let toward = way.try_normalize().unwrap_or(DVec3::Y);
                    let one_minus_mu = 0.5 * (ray.direction - toward).length_squared();
                    let source = air.scattered_at(point, one_minus_mu);
                    let depth = air.optical_depth(ray.origin, ray.direction, t)
                        + air.optical_depth(point, toward, distance);
                    let square = distance.max(least).powi(2);
                    values.push((source * (-depth).exp() / square).as_vec3());
                }
            }
        }
        values
    }

    /// What a spot of 1 cd adds on a part of a ray [1/(m2 sr)].
    pub fn light(&self, number: usize, spot: &Spot, ray: &Ray, [from, to]: [f64; 2]) -> DVec3 {
        let OnPlanes { maps, lattice } = &self.spots[number];
        let view = &self.conditions.view;
        let slope = slope(&view.camera, ray.direction);
        let slab = |t: f64| ((t * slope / self.apart) as usize).min(self.count);
        let (first, last) = (slab(from), (slab(to) + 1).min(self.count));
        // The four lattice points around the ray, the same on all planes.
        let at = position(&view.camera, view.size, ray) * (self.side - 1) as f64;
        let (column, x) = cell(at.x, self.side);
        let (row, y) = cell(at.y, self.side);
        let corner = row * self.side + column;
        let mut sum = DVec3::ZERO;
        for k in first..last {
            let begin = (self.apart * k as f64 / slope).max(from);
            let end = (self.apart * (k + 1) as f64 / slope).min(to);
            if end <= begin {
                continue;
            }
            let way = ray.at(0.5 * (begin + end)) - spot.position;
            let Some(shape) = maps.iter().find_map(|map| map.read(way)) else {
                continue;
            };
            if shape == 0.0 {
                continue;
            }
            let values = &lattice[k * self.side * self.side + corner..];
            let line = |at: usize| values[at].as_dvec3().lerp(values[at + 1].as_dvec3(), x);
            let xi = line(0).lerp(line(self.side), y);
            sum += (end - begin) * shape * xi;
        }
        sum
    }
}

/// The cell of a lattice in which a coordinate lies, and where in it from 0 to 1.
fn cell(at: f64, side: usize) -> (usize, f64) {
    let cell = (at.max(0.0) as usize).min(side - 2);
    (cell, (at - cell as f64).clamp(0.0, 1.0))
}

/// The depth by which a metre of a ray goes [1]; of a panorama distances count.
fn slope(camera: &Camera, direction: DVec3) -> f64 {
    match camera.projection {
        Projection::Panorama => 1.0,
        _ => direction.dot(camera.axes()[2]),
    }
}

/// Where on the picture a ray is, each way from 0 to 1: the inverse of [`Camera::ray`].
fn position(camera: &Camera, size: [u32; 2], ray: &Ray) -> DVec2 {
    let [right, up, forward] = camera.axes();
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let across = |v: DVec3| DVec2::new(v.dot(right), v.dot(up));
    let at = match camera.projection {
        Projection::Perspective { fov_y } => {
            let half = (0.5 * fov_y).tan();
            across(ray.direction) / (ray.direction.dot(forward) * half * DVec2::new(aspect, 1.0))
        }
        Projection::Orthographic { height } => {
            across(ray.origin - camera.eye) / (0.5 * height * DVec2::new(aspect, 1.0))
        }
        Projection::Panorama => {
            let [right, up, forward] = camera.level_axes();
            let d = ray.direction;
            let around = d.dot(right).atan2(d.dot(forward)) / PI;
            DVec2::new(around, d.dot(up).clamp(-1.0, 1.0).asin() / FRAC_PI_2)
        }
    };
    DVec2::new(0.5 * (at.x + 1.0), 0.5 * (1.0 - at.y)) + DVec2::new(-camera.shift.x, camera.shift.y)
}

/// The depth of the farthest air that the picture shows [m].
fn farthest(conditions: &Conditions) -> f64 {
    let (view, air) = (&conditions.view, &conditions.air);
    let depth = |pixel: glam::UVec2| {
        let ray = view.ray(pixel.as_dvec2() + 0.5);
        let surface = first_surface(conditions, &ray, 0.5, DMat3::IDENTITY);
        let end = air.end(ray.origin, ray.direction).min(surface.distance);
        let is_seen = |t: f64| luminance(air.optical_depth(ray.origin, ray.direction, t)) < DEEP;
        let (mut near, mut far) = (0.0, end);
        for _ in 0..if is_seen(end) { 0 } else { 60 } {
            let middle = 0.5 * (near + far);
            match is_seen(middle) {
                true => near = middle,
                false => far = middle,
            }
        }
        far * slope(&view.camera, ray.direction)
    };
    let depths = spread(view.size, PROBES).into_iter().map(depth);
    depths.fold(0.0, f64::max).max(f64::MIN_POSITIVE)
}

/// The light maps of a spot.
fn light_maps(conditions: &Conditions, lamp: &Lamp, spot: &Spot, side: usize) -> Vec<LightMap> {
    let pose = &lamp.pose;
    let (x, y, z) = (pose.around, pose.third, pose.toward);
    let cone = lamp.distribution.cone();
    let faces = match cone <= ONE_MAP {
        true => vec![([x, y, z], cone.tan().max(1e-6))],
        false => [
            [x, y, z],
            [y, x, -z],
            [y, z, x],
            [z, y, -x],
            [z, x, y],
            [x, z, -y],
        ]
        .map(|axes| (axes, 1.0))
        .to_vec(),
    };
    let geometry = lamp.geometry(&conditions.geometry);
    let map = |(axes, half): ([DVec3; 3], f64)| {
        let texel = |i: usize| {
            let coordinate = |i: usize| half * ((2 * i + 1) as f64 / side as f64 - 1.0);
            let [right, up, middle] = axes;
            let way = middle + coordinate(i % side) * right + coordinate(i / side) * up;
            let ray = Ray {
                origin: spot.position,
                direction: way.normalize(),
            };
            // Its own face does not stop the light of a lamp.
            let hit = geometry.closest(&ray, 1e-9 * geometry.extent(), f64::INFINITY);
            let depth = hit.map_or(f64::INFINITY, |hit| hit.distance);
            (lamp.shape(spot, ray.direction), depth)
        };
        LightMap {
            axes,
            half,
            side,
            texels: (0..side * side).map(texel).collect(),
        }
    };
    faces.into_iter().map(map).collect()
}

impl LightMap {
    /// What it holds in a direction, for a point so far away; `None` beside it.
    fn read(&self, way: DVec3) -> Option<f64> {
        let [right, up, middle] = self.axes;
        let depth = way.dot(middle);
        if depth <= 0.0 {
            return None;
        }
        let at = DVec2::new(way.dot(right), way.dot(up)) / (depth * self.half);
        if at.abs().max_element() > 1.0 {
            return None;
        }
        let at = 0.5 * (at + 1.0) * self.side as f64 - 0.5;
        let distance = way.length();
        let low = at.floor();
        let share = at - low;
        let texel = |x: f64, y: f64| {
            let last = (self.side - 1) as f64;
            let index = y.clamp(0.0, last) as usize * self.side + x.clamp(0.0, last) as usize;
            let (shape, reach) = self.texels[index];
            match distance < reach {
                true => shape,
                false => 0.0,
            }
        };
        let line = |y: f64| {
            let (a, b) = (texel(low.x, y), texel(low.x + 1.0, y));
            a + share.x * (b - a)
        };
        let (a, b) = (line(low.y), line(low.y + 1.0));
        Some(a + share.y * (b - a))
    }
}
