//! The patches: what of the scene's surfaces sends the same light everywhere.

use super::arrival::{Source, cosine_law, spread};
use super::cells::{Face, GROUND_TRIANGLE, Part, faces};
use super::planes::{Home, Surfaces};
use super::tiles::Tile;
use crate::colour::Space;
use crate::conditions::Conditions;
use crate::error::Result;
use crate::scene::{AlphaMode, Hit, Ray};
use crate::task::Task;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Parts of surfaces that send the same light everywhere, each on one side.
pub(super) struct Patches {
    pub homes: Vec<Home>,
    /// Two of each plane, then the ground's if there is one.
    pub faces: Vec<Face>,
    /// Of each triangle the normal, twice its area long.
    facets: Vec<DVec3>,
    /// Triangles whose vertices have normals that are not the plane's.
    bent: Vec<bool>,
    /// Of each vertex the first corner of a triangle that stands there with about its normal: all such receive the same.
    pub first_alike: Vec<(u32, u8)>,
    /// The patch of each cluster.
    of_cluster: Vec<u32>,
    /// All of them, first those of the faces.
    pub all: Vec<Patch>,
    /// The face, the cell and the part of each patch that has one.
    parts: Vec<[u32; 3]>,
    ground: std::ops::Range<u32>,
    /// Whether there are too few for the shape of the scene.
    pub coarse: bool,
}

/// One patch.
pub(super) struct Patch {
    /// What of it is there [m2]: without holes, and of see-through surfaces the share that is not.
    pub area: f64,
    /// Mean reflectance, RGB in the working space.
    pub albedo: DVec3,
    /// Triangles that it is made of, and the area up to and with each [m2].
    pieces: Vec<(Piece, f64)>,
}

#[derive(Clone, Copy)]
struct Piece {
    corners: [DVec3; 3],
    /// On the side that it is a patch of.
    normal: DVec3,
    triangle: u32,
}

impl Piece {
    fn is_area(&self) -> bool {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a) != DVec3::ZERO
    }

    /// The foot of a point on it, where that has one, else its middle.
    fn nearly(&self, point: DVec3) -> DVec3 {
        let [a, b, c] = self.corners;
        let (e, f, p) = (b - a, c - a, point - a);
        let normal = e.cross(f);
        let square = normal.length_squared();
        let v = p.cross(f).dot(normal) / square;
        let w = e.cross(p).dot(normal) / square;
        match v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
            true => a + v * e + w * f,
            false => (a + b + c) / 3.0,
        }
    }
}

/// The cosine of the angle [8 degrees] up to which a vertex's normal is taken for its plane's.
const FLAT: f64 = 0.99;

/// A place on a patch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    pub point: DVec3,
    pub normal: DVec3,
    /// Its number in the scene; the ground's is [`GROUND_TRIANGLE`].
    pub triangle: u32,
}

impl Spot {
    /// Where rays begin that leave from it: `near` [m] above the surface.
    pub fn lifted(&self, near: f64) -> DVec3 {
        self.point + near * self.normal
    }
}

impl Patches {
    /// Divides all surfaces of a scene. A patch is at most `share` as large as what stands next to it, if `most` allows.
    pub fn new(conditions: &Conditions, share: f64, most: usize, task: Task<'_>) -> Result<Self> {
        let surfaces = Surfaces::new(conditions, 0.5 * share, most / 2, task.part(0.0, 0.4))?;
        let room = most.saturating_sub(surfaces.clusters.len()).max(most / 4);
        let (mut faces, coarse) = faces(conditions, &surfaces, share, room, task.part(0.4, 0.8))?;
        let mut raw: Vec<(Vec<Piece>, f64)> = Vec::new();
        let mut ground = 0..0;
        let mut parts = Vec::new();
        for (f, face) in (0..).zip(&mut faces) {
            ground.start = raw.len() as u32;
            let plane = &face.plane;
            for (c, cell) in (0..).zip(&mut face.cells) {
                for (p, part) in (0..).zip(&mut cell.parts) {
                    parts.push([f, c, p]);
                    part.patch = raw.len() as u32;
                    let mut pieces = Vec::new();
                    for (triangle, polygon) in &part.pieces {
                        let at: Vec<DVec3> = polygon.iter().map(|p| plane.point(*p)).collect();
                        for i in 1..at.len() - 1 {
                            pieces.push(Piece {
                                corners: [at[0], at[i], at[i + 1]],
                                normal: plane.normal,
                                triangle: *triangle,
                            });
                        }
                    }
                    raw.push((pieces, part.area));
                }
            }
        }
        ground.end = raw.len() as u32;
        if conditions.ground.is_none() {
            ground = 0..0;
        }
        let mut of_cluster = Vec::with_capacity(surfaces.clusters.len());
        for cluster in &surfaces.clusters {
            of_cluster.push(raw.len() as u32);
            let piece = |(triangle, side): &(u32, usize)| {
                let corners = conditions.scene.mesh.corners(*triangle);
                let [a, b, c] = corners;
                let normal = (b - a).cross(c - a).normalize_or_zero();
                Piece {
                    corners,
                    normal: if *side == 0 { normal } else { -normal },
                    triangle: *triangle,
                }
            };
            raw.push((cluster.iter().map(piece).collect(), f64::INFINITY));
        }
        let mut opacity = vec![1.0; conditions.scene.mesh.triangles.len()];
        for (triangle, o) in conditions.geometry.casters() {
            opacity[triangle as usize] = o.share;
        }
        let working = Space::Rec709.to_working();
        let all: Result<Vec<Patch>> = raw
            .into_par_iter()
            .map(|(pieces, area)| {
                task.check()?;
                Ok(Patch::new(conditions, pieces, area, &opacity, working))
            })
            .collect();
        let mesh = &conditions.scene.mesh;
        let facet = |triangle: u32| {
            let [a, b, c] = conditions.scene.mesh.corners(triangle);
            (b - a).cross(c - a)
        };
        let facets: Vec<DVec3> = (0..mesh.triangles.len() as u32).map(facet).collect();
        let bent = mesh.triangles.iter().zip(&facets).map(|(triangle, facet)| {
            let facet = facet.normalize_or_zero();
            let normals = triangle.vertices.map(|v| mesh.normals[v as usize]);
            let off = |n: &DVec3| *n != DVec3::ZERO && n.dot(facet).abs() < FLAT;
            normals.iter().any(off)
        });
        let mut alike = HashMap::new();
        let mut first_alike = vec![(0, 0); mesh.positions.len()];
        for (number, triangle) in (0..).zip(&mesh.triangles) {
            for (corner, vertex) in (0..).zip(triangle.vertices.map(|v| v as usize)) {
                let place = (mesh.positions[vertex] + 0.0).to_array().map(f64::to_bits);
                let normal = (32.0 * mesh.normals[vertex]).round().to_array();
                let key = (place, normal.map(|x| x as i8));
                first_alike[vertex] = *alike.entry(key).or_insert((number, corner));
            }
        }
        Ok(Patches {
            first_alike,
            bent: bent.collect(),
            facets,
            homes: surfaces.homes,
            faces,
            of_cluster,
            all: all?,
            parts,
            ground,
            coarse,
        })
    }

    /// The face of a patch, and the part of a cell that it is; `None` of clusters.
    pub fn part(&self, patch: usize) -> Option<(&Face, &Part)> {
        let [face, cell, part] = self.parts.get(patch)?.map(|i| i as usize);
        let face = &self.faces[face];
        Some((face, &face.cells[cell].parts[part]))
    }

    /// The patch that a ray so wide [rad] meets on a triangle.
    pub fn of_hit(&self, ray: &Ray, hit: &Hit, width: f64) -> Source {
        let back = self.facets[hit.triangle as usize].dot(ray.direction) > 0.0;
        match self.homes[hit.triangle as usize] {
            Home::Absent => Source::Nothing,
            Home::Cluster(sides) => {
                let cluster = sides[usize::from(back)] as usize;
                Source::Patch(self.of_cluster[cluster], Tile::WHOLE)
            }
            Home::Plane(plane, front) => {
                let face = 2 * plane as usize + usize::from(back == front);
                self.on_face(face, ray.at(hit.distance), width * hit.distance)
                    .unwrap_or(Source::Nothing)
            }
        }
    }

    /// The patch of the ground around a point as far as `width` [m]; `None` far from everything.
    pub fn of_ground(&self, point: DVec3, width: f64) -> Option<Source> {
        self.on_face(self.faces.len() - 1, point, width)
    }

    /// Whether a triangle's vertices have normals that are not its own.
    pub fn is_bent(&self, triangle: u32) -> bool {
        self.bent[triangle as usize]
    }

    /// One side of each plane.
    pub fn sides(&self) -> impl Iterator<Item = &Face> {
        let (planes, _) = self.faces.as_chunks::<2>();
        planes.iter().map(|[side, _]| side)
    }

    /// Whether a patch is one of the ground.
    pub fn is_ground(&self, patch: u32) -> bool {
        self.ground.contains(&patch)
    }

    fn on_face(&self, face: usize, point: DVec3, width: f64) -> Option<Source> {
        let face = &self.faces[face];
        let at = face.plane.flat(point);
        let (_, cell) = face.cell(at)?;
        let part = cell.part(at)?;
        Some(Source::Patch(part.patch, part.tile(at, width)))
    }
}

impl Patch {
    fn new(
        conditions: &Conditions,
        pieces: Vec<Piece>,
        most: f64,
        opacity: &[f64],
        working_from_rec709: glam::DMat3,
    ) -> Self {
        let mut sum = 0.0;
        let pieces: Vec<(Piece, f64)> = pieces
            .into_iter()
            .map(|piece| {
                let [a, b, c] = piece.corners;
                sum += 0.5 * (b - a).cross(c - a).length();
                (piece, sum)
            })
            .collect();
        let mut patch = Patch {
            area: sum.min(most),
            albedo: DVec3::ZERO,
            pieces,
        };
        // Colour and coverage by points on it.
        let uniform = patch.pieces.iter().all(|(piece, _)| {
            piece.triangle == GROUND_TRIANGLE
                || is_plain(conditions, piece.triangle)
                    && opacity[piece.triangle as usize] == 1.0
                    && same_material(conditions, piece.triangle, patch.pieces[0].0.triangle)
        });
        let points = if uniform { 1 } else { 64 };
        let (mut covered, mut colour) = (0.0, DVec3::ZERO);
        for i in 0..points {
            let spot = patch.spot(&spread(i, 0));
            if spot.triangle == GROUND_TRIANGLE {
                covered += 1.0;
                colour += conditions.ground.map_or(DVec3::ZERO, |g| g.albedo);
                continue;
            }
            let share = opacity[spot.triangle as usize];
            let share = if is_there(conditions, &spot) {
                share
            } else {
                0.0
            };
            let weights = weights(conditions, spot.triangle, spot.point);
            let own = conditions.scene.base_color(spot.triangle, weights);
            covered += share;
            colour += share * (working_from_rec709 * own).max(DVec3::ZERO);
        }
        if covered > 0.0 {
            patch.albedo = colour / covered;
        }
        patch.area *= covered / points as f64;
        patch
    }

    /// A place on it, from three numbers of 0 to 1.
    pub fn spot(&self, by: &[f64]) -> Spot {
        let whole = self.pieces.last().map_or(0.0, |(_, until)| *until);
        let wanted = by[0] * whole;
        let at = self.pieces.partition_point(|(_, until)| *until <= wanted);
        let (piece, _) = self.pieces[at.min(self.pieces.len() - 1)];
        let [a, b, c] = piece.corners;
        let root = by[1].sqrt();
        Spot {
            point: a + root * (1.0 - by[2]) * (b - a) + root * by[2] * (c - a),
            normal: piece.normal,
            triangle: piece.triangle,
        }
    }

    /// The place on it that is about its middle: where what it is made of reaches the centre of area, that; else the middle of the
    /// nearest piece.
    pub fn middle(&self) -> Spot {
        let (mut before, mut centre) = (0.0, DVec3::ZERO);
        for (piece, until) in &self.pieces {
            centre += (until - before) / 3.0 * piece.corners.iter().sum::<DVec3>();
            before = *until;
        }
        centre /= before.max(f64::MIN_POSITIVE);
        let spot = |piece: &Piece| Spot {
            point: piece.nearly(centre),
            normal: piece.normal,
            triangle: piece.triangle,
        };
        let there = self.pieces.iter().filter(|(piece, _)| piece.is_area());
        let spots = there.map(|(piece, _)| spot(piece));
        let off = |spot: &Spot| spot.point.distance_squared(centre);
        let nearest = spots.min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.unwrap_or_else(|| self.spot(&[0.5; 5]))
    }

    /// A ray that leaves it by the cosine law, from five numbers of 0 to 1.
    pub fn ray(&self, by: &[f64; 5], near: f64) -> Ray {
        let spot = self.spot(by);
        let (tangent, bitangent) = spot.normal.any_orthonormal_pair();
        let d = cosine_law(by[3], by[4]);
        Ray {
            origin: spot.lifted(near),
            direction: tangent * d.x + bitangent * d.y + spot.normal * d.z,
        }
    }
}

fn material(conditions: &Conditions, triangle: u32) -> usize {
    conditions.scene.mesh.triangles[triangle as usize].material as usize
}

fn same_material(conditions: &Conditions, a: u32, b: u32) -> bool {
    a == b || b != GROUND_TRIANGLE && material(conditions, a) == material(conditions, b)
}

/// Whether a triangle has one colour and no holes.
fn is_plain(conditions: &Conditions, triangle: u32) -> bool {
    let scene = &conditions.scene;
    let material = &scene.materials[material(conditions, triangle)];
    material.texture.is_none()
        && material.alpha_mode == AlphaMode::Opaque
        && scene.mesh.colors.is_empty()
}

/// Whether something is there of a triangle that may have holes.
fn is_there(conditions: &Conditions, spot: &Spot) -> bool {
    let scene = &conditions.scene;
    if scene.materials[material(conditions, spot.triangle)].alpha_mode == AlphaMode::Opaque {
        return true;
    }
    let lift = 1e-6 * conditions.geometry.extent();
    let ray = Ray {
        origin: spot.point + lift * spot.normal,
        direction: -spot.normal,
    };
    conditions.geometry.closest(&ray, 0.0, 2.0 * lift).is_some()
}

/// The weights of the second and third vertex at a point of a triangle.
fn weights(conditions: &Conditions, triangle: u32, point: DVec3) -> [f64; 2] {
    let [a, b, c] = conditions.scene.mesh.corners(triangle);
    let (e, f, p) = (b - a, c - a, point - a);
    let normal = e.cross(f);
    let square = normal.length_squared();
    if square == 0.0 {
        return [0.0, 0.0];
    }
    let v = (p.cross(f).dot(normal) / square).clamp(0.0, 1.0);
    let w = (e.cross(p).dot(normal) / square).clamp(0.0, 1.0 - v);
    [v, w]
}
