//! What stands in the way of light: triangles in f64 below bounding volumes in f32.
//!
//! Boxes are f32 around a local origin and inflated by more than f32 rounds away; rays are moved to the scene's bounds in
//! f64 before they meet a box; triangles are always tested in f64. So nothing is lost from a far camera or a far origin.
//! Edges are tested by signed volumes that are exact negatives for two triangles that share the edge (Woop, Benthin & Wald
//! 2013), so no ray slips between neighbours.

use super::{AlphaMode, Ray, Scene, Texture, Wrap};
use glam::{DVec2, DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh};
use obvhs::ray::{Ray as BoxRay, RayHit};
use obvhs::{Boundable, BvhBuildParams};
use std::time::Duration;

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray [m].
    pub distance: f64,
    /// Index into the scene's triangles.
    pub triangle: u32,
    /// Weights of the second and the third vertex.
    pub barycentric: [f64; 2],
}

/// The triangles of a scene that cast shadows, in bounding volumes.
pub struct Geometry {
    /// Middle of the bounds; corners are relative to it.
    pub(super) origin: DVec3,
    min: DVec3,
    max: DVec3,
    pub(super) corners: Vec<[DVec3; 3]>,
    /// The scene's number of each kept triangle.
    pub(super) scene_triangle: Vec<u32>,
    /// The cut-out of each kept triangle, if its material has one.
    pub(super) cut_outs: Vec<Option<CutOut>>,
    textures: Vec<AlphaMap>,
    rays: CwBvh,
    pub(super) nodes: Vec<Node>,
    /// Diagonal of the bounds [m].
    pub(super) extent: f64,
    /// Box units in a metre, a power of two: see [`BOX_EXTENT`].
    scale: f64,
}

/// Boxes are scaled so that the bounds' diagonal is 1 to 2 times this: the box test of the library takes no distance below
/// 1e-4 for a hit, which must be less than the boxes are inflated by, whatever the scene's unit of length.
const BOX_EXTENT: f64 = 1024.0;

/// A bounding volume for the curtain's search.
#[derive(Clone, Copy)]
pub(super) struct Node {
    /// Middle and half diagonal [m].
    pub middle: Vec3A,
    pub half: Vec3A,
    /// A leaf's first triangle, or the first of two children.
    pub first: u32,
    /// Triangles of a leaf; 0 in an inner node.
    pub count: u32,
}

/// A triangle with holes where its texture's alpha is below the cutoff.
#[derive(Debug, Clone, Copy)]
pub(super) struct CutOut {
    pub texture: usize,
    pub uvs: [DVec2; 3],
    /// Alpha of the texel times the material's factor must reach this, in 0 to 255.
    pub least: f64,
}

/// The alpha channel of a texture.
struct AlphaMap {
    size: [u32; 2],
    wrap: [Wrap; 2],
    alpha: Vec<u8>,
}

struct Inflated(Aabb);

impl Boundable for Inflated {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl Geometry {
    /// Takes the triangles of a scene that light cannot pass: not the see-through ones (alpha mode blend, transmission).
    pub fn new(scene: &Scene) -> Self {
        let (min, max) = scene.mesh.bounds().unwrap_or_default();
        let origin = 0.5 * (min + max);
        let extent = (max - min).length();
        let mut corners = Vec::new();
        let mut scene_triangle = Vec::new();
        let mut cut_outs = Vec::new();
        for (index, triangle) in scene.mesh.triangles.iter().enumerate() {
            let material = &scene.materials[triangle.material as usize];
            if material.alpha_mode == AlphaMode::Blend || material.transmissive {
                continue;
            }
            let cut_out = match (material.alpha_mode, material.texture) {
                (AlphaMode::Mask { cutoff }, Some(texture)) => Some(CutOut {
                    texture,
                    uvs: triangle.vertices.map(|v| scene.mesh.uvs[v as usize]),
                    least: 255.0 * cutoff / material.alpha.max(f64::MIN_POSITIVE),
                }),
                (AlphaMode::Mask { cutoff }, None) if material.alpha < cutoff => continue,
                _ => None,
            };
            corners.push(
                triangle
                    .vertices
                    .map(|v| scene.mesh.positions[v as usize] - origin),
            );
            scene_triangle.push(index as u32);
            cut_outs.push(cut_out);
        }
        let scale = match (BOX_EXTENT / extent).log2().ceil().exp2() {
            scale if scale.is_normal() => scale,
            _ => 1.0,
        };
        let margin = (4.0 * f64::from(f32::EPSILON) * extent * scale) as f32;
        let inflate = |triangle: &[DVec3; 3]| {
            let [a, b, c] = triangle.map(|p| (scale * p).as_vec3a());
            Inflated(Aabb {
                min: a.min(b).min(c) - margin,
                max: a.max(b).max(c) + margin,
            })
        };
        let boxes = |corners: &[[DVec3; 3]]| corners.iter().map(inflate).collect::<Vec<_>>();
        let mut time = Duration::default();
        let planes = build_bvh2(&boxes(&corners), BvhBuildParams::medium_build(), &mut time);
        // In the order of the leaves, so that what is visited together lies together in memory.
        let order: Vec<usize> = planes
            .primitive_indices
            .iter()
            .map(|i| *i as usize)
            .collect();
        let corners: Vec<_> = order.iter().map(|i| corners[*i]).collect();
        let scene_triangle: Vec<_> = order.iter().map(|i| scene_triangle[*i]).collect();
        let cut_outs: Vec<_> = order.iter().map(|i| cut_outs[*i]).collect();
        let rays = build_cwbvh(&boxes(&corners), BvhBuildParams::medium_build(), &mut time);
        let nodes = planes
            .nodes
            .iter()
            .map(|node| {
                // Division by a power of two: exact.
                let half = (0.5 / scale) as f32;
                Node {
                    middle: half * (node.aabb.min + node.aabb.max),
                    half: half * (node.aabb.max - node.aabb.min),
                    first: node.first_index,
                    count: node.prim_count,
                }
            })
            .collect();
        Geometry {
            origin,
            min: min - origin,
            max: max - origin,
            corners,
            scene_triangle,
            cut_outs,
            textures: scene.textures.iter().map(AlphaMap::new).collect(),
            rays,
            nodes,
            extent,
            scale,
        }
    }

    /// Number of triangles that cast shadows.
    pub fn triangle_count(&self) -> usize {
        self.corners.len()
    }

    /// The triangles that cast shadows: their number in the scene, and, for a cut-out, the least alpha (0 to 255, of a texel
    /// alone) that is solid.
    pub fn casters(&self) -> impl Iterator<Item = (u32, Option<f64>)> + '_ {
        let least = self.cut_outs.iter().map(|cut| cut.map(|cut| cut.least));
        self.scene_triangle.iter().copied().zip(least)
    }

    /// The least box around everything [m].
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.min + self.origin, self.max + self.origin)
    }

    /// Diagonal of the bounds [m].
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// The first triangle that a ray meets between the distances `near` and `far` [m].
    pub fn closest(&self, ray: &Ray, near: f64, far: f64) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.visit(ray, near, far, |index, hit| {
            if hit.distance < best.map_or(far, |b| b.distance) {
                best = Some(Hit {
                    triangle: self.scene_triangle[index],
                    ..hit
                });
            }
            false
        });
        best
    }

    /// Whether anything stands on a ray between the distances `near` and `far` [m].
    pub fn occluded(&self, ray: &Ray, near: f64, far: f64) -> bool {
        let mut any = false;
        self.visit(ray, near, far, |_, _| {
            any = true;
            true
        });
        any
    }

    /// Calls `found` for the triangles between `near` and `far` until it returns true; those behind the nearest one
    /// found so far may be left out.
    fn visit(&self, ray: &Ray, near: f64, far: f64, mut found: impl FnMut(usize, Hit) -> bool) {
        if self.corners.is_empty() {
            return;
        }
        let origin = ray.origin - self.origin;
        let Some(skip) = self.entry(origin, ray.direction) else {
            return;
        };
        if skip > far {
            return;
        }
        let skip = (skip - 0.01 * self.extent).max(0.0);
        let start = origin + skip * ray.direction;
        let box_ray = BoxRay::new(
            (self.scale * start).as_vec3a(),
            ray.direction.as_vec3a(),
            0.0,
            f32::INFINITY,
        );
        let meet = |slot: usize| {
            let index = self.rays.primitive_indices[slot] as usize;
            let hit = intersect(&self.corners[index], origin, ray.direction)?;
            let solid =
                hit.distance > near && hit.distance < far && self.solid_at(index, hit.barycentric);
            solid.then_some((index, hit))
        };
        // A distance in f32 that is certainly not less than the f64 one from where the box ray starts.
        let beyond = |distance: f64| {
            let d = (self.scale * (distance - skip)) as f32;
            d + d.abs() * 4.0 * f32::EPSILON + 1e-6 * BOX_EXTENT as f32
        };
        let mut done = false;
        let mut nearest = RayHit::none();
        self.rays.ray_traverse(box_ray, &mut nearest, |_, slot| {
            if done {
                return -1.0;
            }
            match meet(slot) {
                Some((index, hit)) => {
                    done = found(index, hit);
                    if done { -1.0 } else { beyond(hit.distance) }
                }
                None => f32::INFINITY,
            }
        });
    }

    /// Distance at which a ray (relative to the local origin) enters the bounds, 0 from inside; `None` if it never does.
    fn entry(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let margin = DVec3::splat(1e-6 * self.extent);
        let (min, max) = (self.min - margin, self.max + margin);
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            if direction[axis] == 0.0 {
                if origin[axis] < min[axis] || origin[axis] > max[axis] {
                    return None;
                }
                continue;
            }
            let a = (min[axis] - origin[axis]) / direction[axis];
            let b = (max[axis] - origin[axis]) / direction[axis];
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter <= leave).then_some(enter)
    }

    /// Whether a kept triangle is solid there: it always is unless its texture cuts a hole.
    pub(super) fn solid_at(&self, index: usize, [v, w]: [f64; 2]) -> bool {
        let Some(cut) = &self.cut_outs[index] else {
            return true;
        };
        let uv = cut.uvs[0] * (1.0 - v - w) + cut.uvs[1] * v + cut.uvs[2] * w;
        self.opaque(cut, uv)
    }

    /// Whether a cut-out is solid at a texture coordinate.
    pub(super) fn opaque(&self, cut: &CutOut, uv: DVec2) -> bool {
        f64::from(self.textures[cut.texture].at(uv)) >= cut.least
    }

    /// Texels of a cut-out's texture.
    pub(super) fn texture_size(&self, cut: &CutOut) -> DVec2 {
        let [w, h] = self.textures[cut.texture].size;
        DVec2::new(f64::from(w), f64::from(h))
    }
}

impl AlphaMap {
    fn new(texture: &Texture) -> Self {
        AlphaMap {
            size: [texture.width, texture.height],
            wrap: texture.wrap,
            alpha: texture.pixels.iter().map(|p| p[3]).collect(),
        }
    }

    fn at(&self, uv: DVec2) -> u8 {
        let x = texel(uv.x, self.size[0], self.wrap[0]);
        let y = texel(uv.y, self.size[1], self.wrap[1]);
        self.alpha[(y * self.size[0] + x) as usize]
    }
}

/// The nearest texel of a coordinate (0 to 1 spans the texture) on one axis.
pub fn texel(coordinate: f64, size: u32, wrap: Wrap) -> u32 {
    let position = (coordinate * f64::from(size)).floor();
    let n = f64::from(size);
    let inside = match wrap {
        Wrap::Repeat => position.rem_euclid(n),
        Wrap::Mirror => {
            let p = position.rem_euclid(2.0 * n);
            if p < n { p } else { 2.0 * n - 1.0 - p }
        }
        Wrap::Clamp => position,
    };
    inside.clamp(0.0, n - 1.0) as u32
}

/// Where a ray meets a triangle, from either side; `None` where it misses or runs in its plane.
fn intersect(corners: &[DVec3; 3], origin: DVec3, direction: DVec3) -> Option<Hit> {
    let [a, b, c] = corners.map(|p| p - origin);
    let u = direction.dot(c.cross(b));
    let v = direction.dot(a.cross(c));
    let w = direction.dot(b.cross(a));
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let volume = u + v + w;
    if volume == 0.0 {
        return None;
    }
    let normal = (b - a).cross(c - a);
    let across = normal.dot(direction);
    if across == 0.0 {
        return None;
    }
    Some(Hit {
        distance: normal.dot(a) / across,
        triangle: 0,
        barycentric: [v / volume, w / volume],
    })
}
