//! What stands in the way of light: triangles in f64 below bounding volumes in f32.
//!
//! Boxes are f32 around a local origin and inflated by more than f32 rounds away; rays are moved to the scene's bounds in
//! f64 before they meet a box; which triangles are hit is decided in f64 (`wide.rs` finds those that may be). So nothing is
//! lost from a far camera or a far origin.
//! Edges are tested by signed volumes that are exact negatives for two triangles that share the edge (Woop, Benthin & Wald
//! 2013), so no ray slips between neighbours.

use super::cut_out::{AlphaMap, CutOut};
use super::glazing::Glazing;
use super::opacity::{Opacities, Opacity};
use super::wide::{BoxRay, Wide};
use super::{Ray, Scene};
use crate::split_mix::SplitMix;
use crate::warning::Warning;
use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};
use std::collections::{HashMap, HashSet};
use std::sync::OnceLock;
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

impl Hit {
    /// Whether it comes first; of two at one distance the triangle that the scene has first.
    pub(crate) fn is_before(&self, other: &Hit) -> bool {
        self.distance < other.distance
            || self.distance == other.distance && self.triangle < other.triangle
    }
}

/// The triangles of a scene that stop light or a part of it, in bounding volumes.
pub struct Geometry {
    /// Middle of the bounds; corners are relative to it.
    pub(super) origin: DVec3,
    min: DVec3,
    max: DVec3,
    pub(super) corners: Vec<[DVec3; 3]>,
    /// The scene's number of each kept triangle.
    pub(super) scene_triangle: Vec<u32>,
    /// Those with holes: which of `cut_outs` each kept triangle is, from 1; 0 for one without. Empty where none has any.
    holes: Vec<u32>,
    cut_outs: Vec<CutOut>,
    alpha_maps: Vec<AlphaMap>,
    /// What the scene's materials are, and what is said of it.
    opacities: Opacities,
    /// Those that let light through: which of `passes` each kept triangle is, from 1; 0 for one that does not. Empty where none
    /// does.
    veils: Vec<u32>,
    /// The share of light that each material that lets light through does let through.
    passes: Vec<f64>,
    /// The panes, which stand in no one's way but colour light.
    pub(super) panes: Option<Box<Geometry>>,
    /// What the triangles let through, where these are the panes.
    pub(super) glazing: Option<Glazing>,
    rays: Wide,
    pub(super) nodes: Vec<Node>,
    /// The triangles beside each, as far as someone has asked.
    pub(super) neighbours: OnceLock<Vec<[u32; 3]>>,
    /// Diagonal of the bounds [m].
    pub(super) extent: f64,
    /// Box units in a metre, a power of two: see [`BOX_EXTENT`].
    scale: f64,
}

/// Boxes are scaled so that the bounds' diagonal is 1 to 2 times this, far from the limits of f32 whatever the scene's unit of
/// length.
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

/// A surface that lets a part of the light through, where a ray meets it.
#[derive(Clone, Copy)]
pub(crate) struct Veil {
    pub hit: Hit,
    /// Which of the materials that let light through, from 1.
    pub kind: u32,
    /// The share of light that it lets through.
    pub pass: f64,
}

/// What is within this share of its distance from another veil of the same material is the same: the edge of two triangles.
pub(super) const SAME_PLACE: f64 = 1e-12;

struct Inflated(Aabb);

impl Boundable for Inflated {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl Geometry {
    /// Takes the triangles of a scene that stop light or a part of it ([`super::opacity`] says which).
    pub fn new(scene: &Scene) -> Self {
        let opacities = Opacities::new(scene);
        let panes = Self::of_panes(scene, &opacities);
        Geometry {
            panes: panes.map(Box::new),
            ..Self::of(scene, opacities, |all| &all.of_material)
        }
    }

    /// The panes of a scene, with what they let through; `None` where there are none.
    fn of_panes(scene: &Scene, opacities: &Opacities) -> Option<Self> {
        let is_pane = |material: u32| opacities.of_panes[material as usize].share > 0.0;
        let mut triangles = scene.mesh.triangles.iter();
        if !triangles.any(|t| is_pane(t.material)) {
            return None;
        }
        let own = Opacities {
            of_material: Vec::new(),
            of_panes: opacities.of_panes.clone(),
            warnings: Vec::new(),
        };
        let mut tree = Self::of(scene, own, |all| &all.of_panes);
        tree.glazing = Some(Glazing::new(scene, opacities, &tree.scene_triangle));
        Some(tree)
    }

    /// The triangles of materials of which something is there.
    fn of(scene: &Scene, opacities: Opacities, which: fn(&Opacities) -> &Vec<Opacity>) -> Self {
        let (min, max) = scene.mesh.bounds().unwrap_or_default();
        let origin = 0.5 * (min + max);
        let extent = (max - min).length();
        let opacity = |triangle: u32| {
            let material = scene.mesh.triangles[triangle as usize].material;
            which(&opacities)[material as usize]
        };
        let mut twice = HashSet::new();
        let mut corners = Vec::new();
        let mut scene_triangle = Vec::new();
        for (index, triangle) in (0..).zip(&scene.mesh.triangles) {
            let opacity = opacity(index);
            let places = triangle
                .vertices
                .map(|v| scene.mesh.positions[v as usize] - origin);
            // A pane whose sides are drawn one upon the other is one pane; of whole surfaces one hides the others.
            let again = opacity.least.is_none() && !twice.insert((triangle.material, same(places)));
            if opacity.share > 0.0 && !again {
                corners.push(places);
                scene_triangle.push(index);
            }
        }
        let scale = match (BOX_EXTENT / extent).log2().ceil().exp2() {
            scale if scale.is_normal() => scale,
            _ => 1.0,
        };
        let margin = (4.0 * f64::from(f32::EPSILON) * extent * scale) as f32;
        let inflate = |(index, triangle): (usize, &[DVec3; 3])| {
            let [a, b, c] = triangle.map(|p| (scale * p).as_vec3a());
            Inflated(Aabb {
                min: a.min(b).min(c) - margin * uneven(2 * index),
                max: a.max(b).max(c) + margin * uneven(2 * index + 1),
            })
        };
        let boxes =
            |corners: &[[DVec3; 3]]| corners.iter().enumerate().map(inflate).collect::<Vec<_>>();
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
        let (holes, cut_outs, alpha_maps) = cut_outs(scene, &scene_triangle, opacity);
        let (veils, passes) = veils(scene, &scene_triangle, opacity);
        let rays = Wide::new(&boxes(&corners), &corners, scale, extent);
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
            holes,
            cut_outs,
            alpha_maps,
            opacities,
            veils,
            passes,
            panes: None,
            glazing: None,
            rays,
            nodes,
            neighbours: OnceLock::new(),
            extent,
            scale,
        }
    }

    /// Number of triangles that stop light or a part of it.
    pub fn triangle_count(&self) -> usize {
        self.corners.len()
    }

    /// The triangles that stop light or a part of it: their number in the scene, and how much of them is there, and where.
    pub fn casters(&self) -> impl Iterator<Item = (u32, Opacity)> + '_ {
        let opacity = |index: usize| Opacity {
            share: self.veil(index).map_or(1.0, |(_, pass)| 1.0 - pass),
            least: self.cut_out(index).map(|(_, map)| map.least() / 255.0),
        };
        let opacities = (0..self.corners.len()).map(opacity);
        self.scene_triangle.iter().copied().zip(opacities)
    }

    /// Whether anything lets a part of the light through.
    pub fn has_veils(&self) -> bool {
        !self.passes.is_empty()
    }

    /// What is not there of the scene's materials, or not as the file has it.
    pub fn warnings(&self) -> &[Warning] {
        &self.opacities.warnings
    }

    /// The least box around everything [m].
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.min + self.origin, self.max + self.origin)
    }

    /// Diagonal of the bounds [m].
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// The first triangle that a ray meets between the distances `near` and `far` [m], whether or not it lets light through.
    pub fn closest(&self, ray: &Ray, near: f64, far: f64) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.visit(ray, near, far, |_, hit| {
            if best.is_none_or(|b| hit.is_before(&b)) {
                best = Some(hit);
            }
            hit.distance
        });
        best
    }

    /// What a ray shows: of surfaces that let light through the one that `choice`, a number of 0 to below 1, falls to (see
    /// [`super::opacity::choice`]), otherwise what stands behind them.
    pub fn seen(&self, ray: &Ray, choice: f64) -> Option<Hit> {
        if !self.has_veils() {
            return self.closest(ray, 0.0, f64::INFINITY);
        }
        let (solid, veils) = self.met(ray, 0.0, f64::INFINITY);
        let mut through = 1.0;
        for veil in veils {
            through *= veil.pass;
            if choice < 1.0 - through {
                return Some(veil.hit);
            }
        }
        solid
    }

    /// Whether the first thing on a ray lets light through.
    pub fn is_veiled(&self, ray: &Ray) -> bool {
        self.has_veils() && !self.met(ray, 0.0, f64::INFINITY).1.is_empty()
    }

    /// Whether anything that stops all light stands on a ray between the distances `near` and `far` [m].
    pub fn occluded(&self, ray: &Ray, near: f64, far: f64) -> bool {
        let mut any = false;
        self.visit(ray, near, far, |index, _| {
            any |= self.veil(index).is_none();
            if any { 0.0 } else { f64::INFINITY }
        });
        any
    }

    /// What a ray lets through of light between the distances `near` and `far` [m], by channel of the working space [1]: the product
    /// over the surfaces and panes that it crosses.
    pub fn transmittance(&self, ray: &Ray, near: f64, far: f64) -> DVec3 {
        let share = match self.has_veils() {
            false => f64::from(u8::from(!self.occluded(ray, near, far))),
            true => match self.met(ray, near, far) {
                (Some(_), _) => 0.0,
                (None, veils) => veils.iter().map(|veil| veil.pass).product(),
            },
        };
        match self.panes() {
            Some(panes) if share > 0.0 => share * panes.transmittance(ray, near, far),
            _ => DVec3::splat(share),
        }
    }

    /// The first surface on a ray that stops all light, and those before it that let a part through, in order. A ray that meets
    /// two triangles of one pane at the edge between them meets the pane once.
    pub(crate) fn met(&self, ray: &Ray, near: f64, far: f64) -> (Option<Hit>, Vec<Veil>) {
        let mut solid: Option<Hit> = None;
        let mut veils = Vec::new();
        self.visit(ray, near, far, |index, hit| match self.veil(index) {
            None => {
                if solid.is_none_or(|s| hit.is_before(&s)) {
                    solid = Some(hit);
                }
                hit.distance
            }
            Some((kind, pass)) => {
                veils.push(Veil { hit, kind, pass });
                f64::INFINITY
            }
        });
        let end = solid.map_or(far, |s| s.distance);
        veils.retain(|veil| veil.hit.distance < end);
        veils.sort_unstable_by(|a, b| {
            let by_distance = a.hit.distance.total_cmp(&b.hit.distance);
            by_distance.then(a.hit.triangle.cmp(&b.hit.triangle))
        });
        let reach = (ray.origin - self.origin).length() + self.extent;
        veils.dedup_by(|b, a| {
            a.kind == b.kind && b.hit.distance - a.hit.distance <= SAME_PLACE * reach
        });
        (solid, veils)
    }

    /// Which of the materials that let light through a kept triangle has, from 1, and the share that it lets through.
    pub(super) fn veil(&self, index: usize) -> Option<(u32, f64)> {
        let kind = *self.veils.get(index)?;
        let pass = self.passes.get((kind as usize).checked_sub(1)?)?;
        Some((kind, *pass))
    }

    /// Calls `found` for the triangles between `near` and `far`; it returns the distance beyond which none is wanted any more: 0
    /// for none at all.
    pub(super) fn visit(
        &self,
        ray: &Ray,
        near: f64,
        far: f64,
        mut found: impl FnMut(usize, Hit) -> f64,
    ) {
        if self.corners.is_empty() {
            return;
        }
        let origin = ray.origin - self.origin;
        let is_inside = origin.cmpge(self.min).all() && origin.cmple(self.max).all();
        let mut skip = 0.0;
        if !is_inside {
            let Some(enter) = self.entry(origin, ray.direction) else {
                return;
            };
            if enter > far {
                return;
            }
            skip = (enter - 0.01 * self.extent).max(0.0);
        }
        let start = origin + skip * ray.direction;
        let reach = origin.length() + self.extent;
        let box_ray = BoxRay::new(self.scale * start, ray.direction, self.scale * reach);
        // A distance in f32 that is certainly not less than the f64 one from where the box ray starts.
        let beyond = |distance: f64| {
            let d = (self.scale * (distance - skip)) as f32;
            d + d.abs() * 4.0 * f32::EPSILON + 1e-6 * BOX_EXTENT as f32
        };
        self.rays.walk(&box_ray, beyond(far), |index, wanted| {
            let is_wanted = |hit: &Hit| {
                hit.distance > near && hit.distance < far && self.solid_at(index, hit.barycentric)
            };
            let hit = intersect(&self.corners[index], origin, ray.direction);
            let Some(hit) = hit.filter(is_wanted) else {
                return Some(wanted);
            };
            let triangle = self.scene_triangle[index];
            match found(index, Hit { triangle, ..hit }) {
                0.0 => None,
                distance => Some(wanted.min(beyond(distance))),
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

    /// Whether a kept triangle is solid there: it always is unless alpha cuts a hole.
    fn solid_at(&self, index: usize, barycentric: [f64; 2]) -> bool {
        self.cut_out(index)
            .is_none_or(|(cut, map)| map.is_solid(cut.spot(barycentric)))
    }

    /// Whether any triangle that stops light has holes.
    pub fn has_holes(&self) -> bool {
        !self.holes.is_empty()
    }

    /// The holes of a kept triangle, if it has any, and the alpha map of its material.
    pub(super) fn cut_out(&self, index: usize) -> Option<(&CutOut, &AlphaMap)> {
        let number = *self.holes.get(index)?;
        let cut = self.cut_outs.get((number as usize).checked_sub(1)?)?;
        Some((cut, &self.alpha_maps[cut.map]))
    }
}

/// The corners of a triangle, whatever their order, as bits.
fn same(mut corners: [DVec3; 3]) -> [[u64; 3]; 3] {
    let bits = |p: DVec3| (p + 0.0).to_array().map(f64::to_bits);
    corners.sort_unstable_by_key(|p| bits(*p));
    corners.map(bits)
}

/// Three factors of 1 to 2, others for each number. Boxes that are all the same would be paired one after another in each pass
/// over all of them, which takes the square of their number in time.
fn uneven(number: usize) -> Vec3A {
    let mut random = SplitMix(number as u64);
    Vec3A::from_array(std::array::from_fn(|_| {
        1.0 + (random.bits() >> 40) as f32 / (1 << 24) as f32
    }))
}

/// Which of the listed triangles have holes (from 1, 0 for none; empty where none has any), those, and their alpha maps.
fn cut_outs(
    scene: &Scene,
    triangles: &[u32],
    opacity: impl Fn(u32) -> Opacity,
) -> (Vec<u32>, Vec<CutOut>, Vec<AlphaMap>) {
    let mesh = &scene.mesh;
    let mut map_of: HashMap<(Option<usize>, u64), usize> = HashMap::new();
    let (mut holes, mut cut_outs, mut maps) = (Vec::new(), Vec::new(), Vec::new());
    for (index, number) in triangles.iter().enumerate() {
        let Some(least) = opacity(*number).least else {
            continue;
        };
        let triangle = &mesh.triangles[*number as usize];
        let texture = scene.materials[triangle.material as usize].texture;
        let map = *map_of.entry((texture, least.to_bits())).or_insert_with(|| {
            let texture = texture.map(|index| &scene.textures[index]);
            maps.push(AlphaMap::new(texture, 255.0 * least));
            maps.len() - 1
        });
        cut_outs.push(CutOut {
            map,
            uvs: triangle.vertices.map(|v| mesh.uvs[v as usize]),
            alphas: triangle
                .vertices
                .map(|v| mesh.colors.get(v as usize).map_or(1.0, |color| color.w)),
        });
        holes.resize(triangles.len(), 0);
        holes[index] = cut_outs.len() as u32;
    }
    (holes, cut_outs, maps)
}

/// Which of the materials that let light through the listed triangles have (from 1, 0 for another one; empty where none has),
/// and the share that each of them lets through.
fn veils(
    scene: &Scene,
    triangles: &[u32],
    opacity: impl Fn(u32) -> Opacity,
) -> (Vec<u32>, Vec<f64>) {
    let mut kind_of: HashMap<u32, u32> = HashMap::new();
    let (mut veils, mut passes) = (Vec::new(), Vec::new());
    for (index, number) in triangles.iter().enumerate() {
        let opacity = opacity(*number);
        if opacity.is_veil() {
            let material = scene.mesh.triangles[*number as usize].material;
            veils.resize(triangles.len(), 0);
            veils[index] = *kind_of.entry(material).or_insert_with(|| {
                passes.push(1.0 - opacity.share);
                passes.len() as u32
            });
        }
    }
    (veils, passes)
}

/// Where a ray meets a triangle, from either side; `None` where it misses or runs in its plane.
#[inline]
pub(crate) fn intersect(corners: &[DVec3; 3], origin: DVec3, direction: DVec3) -> Option<Hit> {
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
