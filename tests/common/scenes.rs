//! Scenes that are made in code, with occluders of a known kind and number.
//!
//! `sun` is azimuth and elevation in degrees. Everything is in metres, +Y up, and the same on every machine.
#![allow(dead_code)]

use super::build::{cuboid, scene};
use glam::{DVec3, dvec3};
use std::f64::consts::TAU;
use tyndall::scene::Scene;

type Triangles = Vec<[DVec3; 3]>;

/// A wall in the plane x = `x`, 0.2 thick, over z and y, with openings (z from, z to, y from, y to) in ascending z.
fn wall_with_openings(x: f64, z: [f64; 2], height: f64, openings: &[[f64; 4]]) -> Triangles {
    let slab = |z0: f64, z1: f64, y0: f64, y1: f64| match z1 > z0 && y1 > y0 {
        true => cuboid(dvec3(x - 0.1, y0, z0), dvec3(x + 0.1, y1, z1)),
        false => Vec::new(),
    };
    let mut triangles = Vec::new();
    let mut from = z[0];
    for &[z0, z1, y0, y1] in openings {
        triangles.extend(slab(from, z0, 0.0, height));
        triangles.extend(slab(z0, z1, 0.0, y0));
        triangles.extend(slab(z0, z1, y1, height));
        from = z1;
    }
    triangles.extend(slab(from, z[1], 0.0, height));
    triangles
}

/// A closed room, 8 by 4 by 10, around x = 0 and z = 0, whose wall at x = 4 has one upright slit of `width`.
pub fn slit_room(width: f64, sun: [f64; 2]) -> Scene {
    let opening = [-width / 2.0, width / 2.0, 0.5, 3.5];
    let mut triangles = wall_with_openings(4.0, [-5.0, 5.0], 4.0, &[opening]);
    triangles.extend(wall_with_openings(-4.0, [-5.0, 5.0], 4.0, &[]));
    for z in [-5.0, 5.0] {
        triangles.extend(cuboid(dvec3(-4.1, 0.0, z - 0.1), dvec3(4.1, 4.0, z + 0.1)));
    }
    for y in [0.0, 4.0] {
        triangles.extend(cuboid(dvec3(-4.1, y - 0.1, -5.1), dvec3(4.1, y + 0.1, 5.1)));
    }
    scene(&triangles, sun[0], sun[1])
}

/// A room, 8 by 4 by 10, under `slats` slats with gaps of their own width.
pub fn slatted_roof(slats: usize, sun: [f64; 2]) -> Scene {
    let mut triangles = Triangles::new();
    for x in [-4.0, 4.0] {
        triangles.extend(wall_with_openings(x, [-5.0, 5.0], 4.0, &[]));
    }
    for z in [-5.0, 5.0] {
        triangles.extend(cuboid(dvec3(-4.1, 0.0, z - 0.1), dvec3(4.1, 4.0, z + 0.1)));
    }
    triangles.extend(cuboid(dvec3(-4.1, -0.1, -5.1), dvec3(4.1, 0.0, 5.1)));
    let pitch = 10.0 / slats as f64;
    for i in 0..slats {
        let z = -5.0 + pitch * i as f64;
        triangles.extend(cuboid(
            dvec3(-4.1, 4.0, z),
            dvec3(4.1, 4.05, z + pitch / 2.0),
        ));
    }
    scene(&triangles, sun[0], sun[1])
}

/// `count` walls across the Z axis, one behind the other every 4 m, each with a gate of 2 by 3.
pub fn gates(count: usize, sun: [f64; 2]) -> Scene {
    let mut triangles = Triangles::new();
    for i in 0..count {
        let z = -4.0 * i as f64;
        let slab = |x0, x1, y0, y1| cuboid(dvec3(x0, y0, z - 0.1), dvec3(x1, y1, z + 0.1));
        triangles.extend(slab(-6.0, -1.0, 0.0, 6.0));
        triangles.extend(slab(1.0, 6.0, 0.0, 6.0));
        triangles.extend(slab(-1.0, 1.0, 3.0, 6.0));
    }
    scene(&triangles, sun[0], sun[1])
}

/// Two rows of `pairs` round columns with `facets` sides along the Z axis, under a flat roof.
pub fn colonnade(pairs: usize, facets: usize, sun: [f64; 2]) -> Scene {
    let mut triangles = Triangles::new();
    for i in 0..pairs {
        for x in [-3.0, 3.0] {
            let ring = |k: usize, y: f64| {
                let (sin, cos) = (TAU * (k % facets) as f64 / facets as f64).sin_cos();
                dvec3(x + 0.4 * cos, y, -3.0 * i as f64 - 0.4 * sin)
            };
            for k in 0..facets {
                let [a, b, c, d] = [
                    ring(k, 0.0),
                    ring(k + 1, 0.0),
                    ring(k + 1, 5.0),
                    ring(k, 5.0),
                ];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let end = -3.0 * pairs as f64;
    triangles.extend(cuboid(dvec3(-4.0, 5.0, end), dvec3(4.0, 5.5, 1.0)));
    triangles.extend(cuboid(dvec3(-6.0, -0.1, end), dvec3(6.0, 0.0, 1.0)));
    scene(&triangles, sun[0], sun[1])
}

/// A height field of `side` by `side` quads over `size` by `size`, with hills up to about `size` / 8.
pub fn terrain(side: usize, size: f64, sun: [f64; 2]) -> Scene {
    let at = |i: usize, j: usize| {
        let (u, v) = (i as f64 / side as f64, j as f64 / side as f64);
        let hills = (7.0 * u).sin() * (5.0 * v + 1.0).cos()
            + 0.5 * (17.0 * u + 3.0 * v).sin()
            + 0.25 * (41.0 * v - 13.0 * u).cos();
        size * dvec3(u - 0.5, hills / 14.0, v - 0.5)
    };
    let mut triangles = Triangles::new();
    for i in 0..side {
        for j in 0..side {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    scene(&triangles, sun[0], sun[1])
}

/// `count` triangles of about `size` at random places in the cube from -1 to 1, in random directions.
pub fn soup(count: usize, size: f64, seed: u64, sun: [f64; 2]) -> Scene {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut random = move || {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    let mut point = move || dvec3(random(), random(), random());
    let triangles: Triangles = (0..count)
        .map(|_| {
            let middle = point();
            [0; 3].map(|_| middle + size * point())
        })
        .collect();
    scene(&triangles, sun[0], sun[1])
}
