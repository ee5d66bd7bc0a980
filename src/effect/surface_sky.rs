//! Sky light on surfaces: an estimate, from the share of the sky that points of each surface see.
//!
//! On a lattice over each triangle that the picture shows, and on a grid on the ground, rays spread by the cosine law find what
//! part of the sky is visible; in between, the irradiance is interpolated. E = pi / N sum L_sky(w) V(w) e^-tau(w). The
//! directions are the centres of equal cells of the hemisphere; a cell that a neighbour disagrees with about seeing the light
//! is divided into four, so that the outline of a window counts more finely than its inside, and where little light is
//! found all cells are smaller. The ground is seen as if it
//! lay open to the sky (without the shadows of what stands on it). Light that surfaces reflect to each other is missing, so
//! interiors come out darker than they are.
//!
//! A convex white body under a uniform sky on a white ground neither gains nor loses: E = pi L everywhere.

use super::{
    Contribution, Decision, Effect, Field, Keep, Knob, Source, Surface, surface_sun::clearance,
};
use crate::colour::luminance;
use crate::conditions::{Conditions, Input};
use crate::scene::Ray;
use crate::sky::Sky;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// Sky light reflected by surfaces.
pub const SURFACE_SKY: Effect = Effect {
    name: "surface_sky",
    summary: "sky light reflected by surfaces (estimate: visible share of the sky)",
    reads: &[Field::Surface],
    writes: &[Field::Sky],
    keeps: &[&SHARE],
    knobs: &[
        Knob {
            name: "rays",
            meaning: "rays from each lattice point, before outlines are refined",
            values: [36.0, 64.0, 144.0, 1024.0],
            range: [4.0, 65536.0],
        },
        Knob {
            name: "spacing",
            meaning: "distance between lattice points, as a share of the scene's diagonal",
            values: [0.04, 0.02, 0.01, 0.005],
            range: [1e-4, 1.0],
        },
    ],
    decide: |conditions| match &conditions.sky {
        None => Decision::nothing("no sky was asked for"),
        Some(sky) => Decision::run(
            format!(
                "the sky gives {:.0} lx on open ground; an estimate without light from surface to surface",
                luminance(sky.horizontal_illuminance())
            ),
            Contribution::Estimate(0.5 * luminance(sky.horizontal_illuminance()) / PI),
        ),
    },
    reference: |conditions, settings, kept| {
        let Some(sky) = &conditions.sky else {
            return Box::new(|_| {});
        };
        let share = kept.get(&SHARE, conditions, settings, || {
            SkyShare::new(
                conditions.clone(),
                sky.clone(),
                settings.get("rays") as usize,
                settings.get("spacing") * conditions.geometry.extent(),
            )
        });
        Box::new(move |fields| {
            fields.update(Field::Sky, |_, _, surface, present| match surface.source {
                Source::Nothing => present,
                _ => present + surface.albedo / PI * share.irradiance(surface),
            });
        })
    },
    passes: &[],
    ..Effect::NOTHING
};

/// The irradiance where the picture needed it so far.
const SHARE: Keep = Keep {
    name: "the sky's light on surfaces",
    reads: &[Input::Geometry, Input::Materials, Input::Media, Input::Sky],
};

/// Irradiance from the sky [lx, RGB], found where the picture needs it and kept.
struct SkyShare {
    conditions: Conditions,
    sky: Arc<Sky>,
    /// Cells of the hemisphere along each side of the square that is mapped to it.
    cells: usize,
    spacing: f64,
    /// One lattice for each side of each triangle of the scene.
    lattices: Vec<OnceLock<Lattice>>,
    /// The first triangle of each vertex that has a normal of its own: there all its triangles share one value.
    first_triangles: Vec<Option<u32>>,
    /// One value for each side of each such vertex.
    corners: Vec<OnceLock<DVec3>>,
    ground: GroundGrid,
    /// What an open ground reflects [cd/m2, RGB].
    ground_radiance: DVec3,
}

/// Points of a triangle: `(i, j)` has the barycentric weights `i / steps` and `j / steps` of the second and third vertex.
struct Lattice {
    steps: usize,
    points: Vec<OnceLock<DVec3>>,
}

struct GroundGrid {
    min: DVec3,
    cell: f64,
    points: Vec<OnceLock<DVec3>>,
}

const GRID: usize = 192;

impl SkyShare {
    fn new(conditions: Conditions, sky: Arc<Sky>, rays: usize, spacing: f64) -> Self {
        let scene = conditions.scene.clone();
        let mesh = &scene.mesh;
        let mut first_triangles = vec![None; mesh.positions.len()];
        for (index, triangle) in mesh.triangles.iter().enumerate().rev() {
            for vertex in triangle.vertices.map(|v| v as usize) {
                if mesh.normals[vertex] != DVec3::ZERO {
                    first_triangles[vertex] = Some(index as u32);
                }
            }
        }
        let (min, max) = conditions.geometry.bounds();
        let extent = conditions.geometry.extent();
        let cell = 3.0 * extent / GRID as f64;
        let middle = 0.5 * (min + max);
        let ground_radiance = conditions.ground.map_or(DVec3::ZERO, |g| {
            g.albedo / PI * sky.horizontal_illuminance()
        });
        SkyShare {
            conditions,
            sky,
            cells: (rays as f64).sqrt().round().max(2.0) as usize,
            spacing,
            lattices: std::iter::repeat_with(OnceLock::new)
                .take(2 * mesh.triangles.len())
                .collect(),
            first_triangles,
            corners: std::iter::repeat_with(OnceLock::new)
                .take(2 * mesh.positions.len())
                .collect(),
            ground: GroundGrid {
                min: middle - 1.5 * DVec3::splat(extent),
                cell,
                points: std::iter::repeat_with(OnceLock::new)
                    .take((GRID + 1) * (GRID + 1))
                    .collect(),
            },
            ground_radiance,
        }
    }

    fn irradiance(&self, surface: &Surface) -> DVec3 {
        match surface.source {
            Source::Nothing => DVec3::ZERO,
            Source::Ground => self.on_ground(surface.position),
            Source::Receiver => self.gather(surface.position, surface.normal, surface.facet, true),
            Source::Triangle(triangle, barycentric) => {
                self.on_triangle(triangle as usize, barycentric, surface.facet)
            }
        }
    }

    fn on_triangle(&self, index: usize, [v, w]: [f64; 2], facet: DVec3) -> DVec3 {
        let mesh = &self.conditions.scene.mesh;
        let triangle = &mesh.triangles[index];
        let corners = triangle.vertices.map(|i| mesh.positions[i as usize]);
        let outward = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let front = outward.dot(facet) >= 0.0;
        let lattice = self.lattices[2 * index + usize::from(front)].get_or_init(|| {
            let longest = (0..3)
                .map(|i| corners[i].distance(corners[(i + 1) % 3]))
                .fold(0.0, f64::max);
            let steps = (longest / self.spacing).ceil().clamp(1.0, 256.0) as usize;
            Lattice {
                steps,
                points: std::iter::repeat_with(OnceLock::new)
                    .take((steps + 1) * (steps + 2) / 2)
                    .collect(),
            }
        });
        let steps = lattice.steps as f64;
        let value = |i: usize, j: usize| {
            let corner = match (i, j) {
                (0, 0) => Some(0),
                (i, 0) if i == lattice.steps => Some(1),
                (0, j) if j == lattice.steps => Some(2),
                _ => None,
            };
            if let Some(corner) = corner {
                let vertex = triangle.vertices[corner] as usize;
                if let Some(first) = self.first_triangles[vertex] {
                    return *self.corners[2 * vertex + usize::from(front)]
                        .get_or_init(|| self.at_vertex(first as usize, vertex as u32, front));
                }
            }
            // Row j of the lattice has steps + 1 - j points.
            let row = j * (2 * lattice.steps + 3 - j) / 2;
            *lattice.points[row + i].get_or_init(|| {
                let (b, c) = (i as f64 / steps, j as f64 / steps);
                self.at_point(index, [1.0 - b - c, b, c], front)
            })
        };
        // The lattice cell is split into two triangles.
        let (x, y) = ((v * steps).clamp(0.0, steps), (w * steps).clamp(0.0, steps));
        let i = (x as usize).min(lattice.steps - 1);
        let j = (y as usize).min(lattice.steps - 1 - i);
        let (f, g) = (x - i as f64, y - j as f64);
        if f + g <= 1.0 || i + j + 2 > lattice.steps {
            value(i, j) * (1.0 - f - g) + value(i + 1, j) * f + value(i, j + 1) * g
        } else {
            value(i + 1, j + 1) * (f + g - 1.0)
                + value(i, j + 1) * (1.0 - f)
                + value(i + 1, j) * (1.0 - g)
        }
        .max(DVec3::ZERO)
    }

    /// Irradiance at a vertex, taken on the first triangle that has it.
    fn at_vertex(&self, triangle: usize, vertex: u32, front: bool) -> DVec3 {
        let vertices = self.conditions.scene.mesh.triangles[triangle].vertices;
        let weights = vertices.map(|v| f64::from(u8::from(v == vertex)));
        self.at_point(triangle, weights, front)
    }

    /// Irradiance at a point of a triangle on one of its sides.
    fn at_point(&self, triangle: usize, weights: [f64; 3], front: bool) -> DVec3 {
        let mesh = &self.conditions.scene.mesh;
        let vertices = mesh.triangles[triangle].vertices.map(|v| v as usize);
        let corners = vertices.map(|v| mesh.positions[v]);
        let outward = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let facet = outward.normalize_or_zero() * if front { 1.0 } else { -1.0 };
        // A little inside, so that points on an edge do not lie in the neighbouring wall.
        let weights = weights.map(|w| 1.0 / 3.0 + (w - 1.0 / 3.0) * (1.0 - 2e-3));
        let mix = |values: [DVec3; 3]| {
            values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
        };
        let normal = match mix(vertices.map(|v| mesh.normals[v])).try_normalize() {
            Some(n) if n.dot(facet) < 0.0 => -n,
            Some(n) => n,
            None => facet,
        };
        self.gather(mix(corners), normal, facet, true)
    }

    fn on_ground(&self, position: DVec3) -> DVec3 {
        let at = (position - self.ground.min) / self.ground.cell;
        let value = |i: usize, j: usize| {
            *self.ground.points[j * (GRID + 1) + i].get_or_init(|| {
                let mut point =
                    self.ground.min + self.ground.cell * DVec3::new(i as f64, 0.0, j as f64);
                point.y = position.y;
                // The border lies open, so that the grid ends without a seam.
                let inner = (1..GRID).contains(&i) && (1..GRID).contains(&j);
                self.gather(point, DVec3::Y, DVec3::Y, inner)
            })
        };
        let (x, y) = (at.x.clamp(0.0, GRID as f64), at.z.clamp(0.0, GRID as f64));
        let (i, j) = ((x as usize).min(GRID - 1), (y as usize).min(GRID - 1));
        let (f, g) = (x - i as f64, y - j as f64);
        (value(i, j) * (1.0 - f) + value(i + 1, j) * f) * (1.0 - g)
            + (value(i, j + 1) * (1.0 - f) + value(i + 1, j + 1) * f) * g
    }

    /// Irradiance at a point, with or without regard to what stands around.
    fn gather(&self, point: DVec3, normal: DVec3, facet: DVec3, occluded: bool) -> DVec3 {
        let near = clearance(&self.conditions, point);
        let origin = point + 1e3 * near * facet;
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let look = |x: f64, y: f64| {
            let d = cosine_law(x, y);
            let direction = tangent * d.x + bitangent * d.y + normal * d.z;
            let radiance = self.open_radiance(point, direction);
            let ray = Ray { origin, direction };
            let through = match (radiance == DVec3::ZERO, occluded) {
                (true, _) => 0.0,
                (_, true) => self
                    .conditions
                    .geometry
                    .transmittance(&ray, 0.0, f64::INFINITY),
                (_, false) => 1.0,
            };
            (through * radiance, through)
        };
        let cells = |n: usize| -> Vec<(DVec3, f64)> {
            let at = |i: usize| (i as f64 + 0.5) / n as f64;
            (0..n * n).map(|k| look(at(k % n), at(k / n))).collect()
        };
        let mut n = self.cells;
        let mut coarse = cells(n);
        // Where little light is found, windows are smaller than cells, and many may have been missed.
        if occluded
            && 16 * coarse.iter().filter(|(_, through)| *through > 0.0).count() < coarse.len()
        {
            n *= 2;
            coarse = cells(n);
        }
        let through = |i: usize, j: usize| coarse[j * n + i].1;
        let mut sum = DVec3::ZERO;
        for j in 0..n {
            for i in 0..n {
                let here = through(i, j);
                let outline = i > 0 && through(i - 1, j) != here
                    || i + 1 < n && through(i + 1, j) != here
                    || j > 0 && through(i, j - 1) != here
                    || j + 1 < n && through(i, j + 1) != here;
                sum += if outline {
                    let fine = |k: usize, m: usize| (k as f64 + (m as f64 + 0.5) / 2.0) / n as f64;
                    (0..4)
                        .map(|m| look(fine(i, m % 2), fine(j, m / 2)).0)
                        .sum::<DVec3>()
                        / 4.0
                } else {
                    coarse[j * n + i].0
                };
            }
        }
        sum * PI / (n * n) as f64
    }

    /// What comes from a direction if nothing stands there: the sky, or the ground that it lights.
    fn open_radiance(&self, point: DVec3, direction: DVec3) -> DVec3 {
        let air = &self.conditions.air;
        if direction.y >= 0.0 {
            let depth = air.sky_optical_depth(point, direction);
            return self.sky.radiance(direction) * (-depth).exp();
        }
        match &self.conditions.ground {
            Some(ground) if point.y >= ground.height => {
                let distance = (point.y - ground.height) / -direction.y;
                self.ground_radiance * (-air.optical_depth(point, direction, distance)).exp()
            }
            _ => DVec3::ZERO,
        }
    }
}

/// The direction around +Z of a point of the unit square, equal areas for equal shares of cos(theta) dw: the concentric map
/// of Shirley & Chiu 1997 onto the disc, raised to the hemisphere.
fn cosine_law(x: f64, y: f64) -> DVec3 {
    let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec3::Z;
    }
    let (radius, angle) = if a.abs() > b.abs() {
        (a, PI / 4.0 * (b / a))
    } else {
        (b, PI / 2.0 - PI / 4.0 * (a / b))
    };
    let (sin, cos) = angle.sin_cos();
    DVec3::new(
        radius * cos,
        radius * sin,
        (1.0 - radius * radius).max(0.0).sqrt(),
    )
}
