//! The scene as the shaders read it: triangles relative to an anchor, materials, texels, media.
//!
//! The anchor is where the eye stood when the scene came onto the device. Corners are made relative to it in f64 and stored in
//! f32; shaders subtract the eye's place from there. That costs the digits of the way that the eye has gone since: within
//! [`REACH`] they are less than the width of a hair. Beyond it the scene gets a new anchor.

use super::beams::Slots;
use super::device::Device;
use super::ends;
use super::shared::{self, Attributes, Material};
use crate::conditions::{Conditions, DiscInAir};
use crate::effect::Resource;
use crate::error::{Error, Result};
use crate::medium::{Fog, Phase, Shape};
use crate::scene::edges::in_turn;
use crate::scene::opacity::Opacity;
use crate::scene::{Geometry, Ray, Scene, Wrap};
use glam::{DVec3, DVec4, UVec2, Vec4};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};
use wgpu::{Buffer, BufferUsages, Texture, TextureFormat};

/// Which triangles are drawn, and in which order: the solid ones first.
pub struct Triangles {
    /// Numbers in the scene.
    pub numbers: Vec<u32>,
    /// How many of them have no holes.
    pub solid: u32,
    /// How much of each is there, and where.
    opacities: Vec<Opacity>,
    /// The number in the picture, from 1, of each of the scene's triangles; 0 for one that is not drawn.
    drawn: Vec<u32>,
}

/// Corners in a row of the texture of them: a multiple of 3 that every device takes.
const CORNERS: u32 = 6144;

/// A triangle's plane.
pub struct Plane {
    point: DVec3,
    /// Of any length.
    normal: DVec3,
}

impl Plane {
    /// Distance along a ray [m], not finite for a ray that runs beside it.
    pub fn distance(&self, ray: &Ray) -> f64 {
        self.normal.dot(self.point - ray.origin) / self.normal.dot(ray.direction)
    }
}

impl Triangles {
    pub fn new(conditions: &Conditions) -> Self {
        let (mut cut_out, solid): (Vec<_>, Vec<_>) = conditions
            .geometry
            .casters()
            .partition(|(_, opacity)| opacity.least.is_some());
        let count = solid.len() as u32;
        let mut all = solid;
        all.append(&mut cut_out);
        let mut drawn = vec![0; conditions.scene.mesh.triangles.len()];
        for ((number, _), i) in all.iter().zip(1..) {
            drawn[*number as usize] = i;
        }
        Triangles {
            drawn,
            numbers: all.iter().map(|(number, _)| *number).collect(),
            solid: count,
            opacities: all.iter().map(|(_, opacity)| *opacity).collect(),
        }
    }

    /// How many have no holes, and how many there are.
    pub fn counts(&self) -> [u32; 2] {
        [self.solid, self.numbers.len() as u32]
    }

    /// Whether the triangle of a number in the picture lets light through.
    pub fn is_veil(&self, number: u32) -> bool {
        number > 0 && self.opacities[number as usize - 1].is_veil()
    }

    /// The number in the picture of the triangle that a ray shows first, from 1; 0 for none.
    pub fn number_met(&self, geometry: &Geometry, ray: &Ray, choice: f64) -> u32 {
        let hit = geometry.seen(ray, choice);
        hit.map_or(0, |hit| self.drawn[hit.triangle as usize])
    }

    /// Corners of all of them [m], scene axes.
    pub fn corners(&self, conditions: &Conditions) -> Vec<DVec3> {
        let mesh = &conditions.scene.mesh;
        self.numbers
            .iter()
            .flat_map(|n| mesh.triangles[*n as usize].vertices)
            .map(|v| mesh.positions[v as usize])
            .collect()
    }
}

/// How far the eye may go from the anchor [m], and as a share of the scene's diagonal if that is less.
const REACH: (f64, f64) = (64.0, 0.25);

/// A scene on a device, kept over frames.
pub struct SceneOnDevice {
    scene: Arc<Scene>,
    geometry: Arc<Geometry>,
    /// What stored positions are relative to [m].
    pub anchor: DVec3,
    pub triangles: Triangles,
    /// Corners of all triangles [m], scene axes, as they are drawn.
    pub casters: Vec<DVec3>,
    planes: OnceLock<Vec<Plane>>,
    /// Buffers made when a pass first names them.
    made: BTreeMap<&'static str, Buffer>,
    caster_corners: Option<Texture>,
    caster_tree: Option<Texture>,
    /// Where surfaces end as a disc sees them.
    ends: Option<(Arc<DiscInAir>, Texture)>,
    /// Shadow maps of beams.
    pub slots: Slots,
}

impl SceneOnDevice {
    pub fn new(conditions: &Conditions) -> Self {
        let triangles = Triangles::new(conditions);
        SceneOnDevice {
            scene: conditions.scene.clone(),
            geometry: conditions.geometry.clone(),
            anchor: conditions.view.camera.eye,
            casters: triangles.corners(conditions),
            triangles,
            planes: OnceLock::new(),
            made: BTreeMap::new(),
            caster_corners: None,
            caster_tree: None,
            ends: None,
            slots: Slots::default(),
        }
    }

    /// Whether it is the scene of these conditions.
    pub fn is_of(&self, conditions: &Conditions) -> bool {
        Arc::ptr_eq(&self.scene, &conditions.scene)
            && Arc::ptr_eq(&self.geometry, &conditions.geometry)
    }

    /// Takes a new anchor if the eye has gone too far from the present one.
    pub fn follow(&mut self, conditions: &Conditions) {
        let eye = conditions.view.camera.eye;
        let reach = REACH.0.min(REACH.1 * conditions.geometry.extent());
        if eye.distance(self.anchor) <= reach {
            return;
        }
        self.anchor = eye;
        self.made.remove(CORNERS_NAME);
        self.made.remove(FACETS_NAME);
        self.caster_corners = None;
        self.caster_tree = None;
        self.ends = None;
        self.slots = Slots::default();
    }

    /// The triangles, the planes in which they lie if these are wanted, and the shadow maps.
    pub fn parts(&mut self, planes: bool) -> (&Triangles, &[Plane], &mut Slots) {
        let casters = &self.casters;
        let make = || {
            let corners = casters.chunks_exact(3);
            let plane = |p: &[DVec3]| Plane {
                point: p[0],
                normal: (p[1] - p[0]).cross(p[2] - p[0]),
            };
            corners.map(plane).collect()
        };
        let planes: &[Plane] = match planes {
            true => self.planes.get_or_init(make),
            false => &[],
        };
        (&self.triangles, planes, &mut self.slots)
    }

    /// Corners relative to the anchor [m], three texels a triangle, in rows of [`CORNERS`]; each with the number, from 1, of the
    /// triangle beyond the edge that begins there, 0 for none.
    pub fn caster_corners(&mut self, device: &Device) -> Result<Texture> {
        if let Some(texture) = &self.caster_corners {
            return Ok(texture.clone());
        }
        let next = in_turn(&self.casters[..3 * self.triangles.solid as usize]);
        // Whole numbers up to 2^24 are exact; the others' edges end at nothing.
        let number = |corner: usize| match next.get(corner) {
            Some(other) if *other as usize != corner && other / 3 < 1 << 24 => {
                (other / 3 + 1) as f32
            }
            _ => 0.0,
        };
        let texels = self
            .casters
            .iter()
            .enumerate()
            .map(|(i, p)| (*p - self.anchor).as_vec3().extend(number(i)));
        let texture = device.texels(
            "corners of casters",
            CORNERS,
            TextureFormat::Rgba32Float,
            texels.collect::<Vec<Vec4>>(),
        )?;
        self.caster_corners = Some(texture.clone());
        Ok(texture)
    }

    /// The tree of casters, as `shaders/common/caster_tree.wgsl` reads it.
    pub fn caster_tree(&mut self, device: &Device) -> Result<Texture> {
        if let Some(texture) = &self.caster_tree {
            return Ok(texture.clone());
        }
        let bounds = self.geometry.in_order();
        let mut texels = Vec::with_capacity(2 * bounds.len() + 2);
        texels.extend([[bounds.len() as u32 + 1, 0, 0, 0], [0; 4]]);
        for bound in &bounds {
            // Rounded to the outside.
            let (min, max) = (bound.min - self.anchor, bound.max - self.anchor);
            let slack = 4.0 * f64::from(f32::EPSILON) * min.abs().max(max.abs());
            let bits = |p: DVec3| p.as_vec3().to_array().map(f32::to_bits);
            let ([ax, ay, az], [bx, by, bz]) = (bits(min - slack), bits(max + slack));
            let triangle = bound
                .triangle
                .map_or(0, |n| self.triangles.drawn[n as usize]);
            texels.extend([[ax, ay, az, bound.skip + 1], [bx, by, bz, triangle]]);
        }
        let texture = device.texels(
            "the tree of casters",
            shared::TREE_WIDTH,
            TextureFormat::Rgba32Uint,
            texels,
        )?;
        self.caster_tree = Some(texture.clone());
        Ok(texture)
    }

    /// Where surfaces end as the sun's disc sees them, as `shaders/soft_edges.wgsl` reads it.
    pub fn ends(&mut self, device: &Device, conditions: &Conditions) -> Result<Texture> {
        let disc = conditions.disc_in_air().ok_or_else(|| {
            Error::failed(
                "an effect asks for the edges of shadows where a point stands for the sun",
                "mend the effect: its pass runs where the conditions have a disc in the air",
            )
        })?;
        if let Some((of, texture)) = &self.ends
            && Arc::ptr_eq(of, &disc)
        {
            return Ok(texture.clone());
        }
        let texture = device.texels(
            "the edges of shadows",
            shared::TREE_WIDTH,
            TextureFormat::Rgba32Uint,
            ends::texels(&disc.edges, &self.geometry, self.anchor),
        )?;
        self.ends = Some((disc, texture.clone()));
        Ok(texture)
    }

    /// Planes relative to the anchor, and materials.
    fn facets(&self, conditions: &Conditions) -> Vec<shared::Facet> {
        let mesh = &conditions.scene.mesh;
        let corners = self.casters.par_chunks_exact(3);
        let numbers = self.triangles.numbers.par_iter();
        let facet = |(corners, number): (&[DVec3], &u32)| {
            let [a, b, c] = [0, 1, 2].map(|i| corners[i] - self.anchor);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            // The normal is rounded; its plane is right where the triangle comes nearest to the anchor.
            let normal = normal.as_vec3();
            let nearest = nearest_to_origin([a, b, c]);
            shared::Facet {
                plane: normal.extend(normal.as_dvec3().dot(nearest) as f32),
                material: mesh.triangles[*number as usize].material,
            }
        };
        corners.zip(numbers).map(facet).collect()
    }

    /// A buffer of the scene.
    pub fn buffer(
        &mut self,
        device: &Device,
        conditions: &Conditions,
        resource: &Resource,
    ) -> Result<Option<Buffer>> {
        let name = match resource {
            Resource::Corners => CORNERS_NAME,
            Resource::Attributes => "normals and texture coordinates",
            Resource::Facets => FACETS_NAME,
            Resource::Materials => "the materials",
            Resource::Texels => "the textures",
            _ => return Ok(None),
        };
        if let Some(buffer) = self.made.get(name) {
            return Ok(Some(buffer.clone()));
        }
        let triangles = &self.triangles;
        let bytes = match resource {
            Resource::Corners => {
                let relative = self
                    .casters
                    .iter()
                    .map(|p| (*p - self.anchor).as_vec3().to_array());
                bytemuck::cast_slice(&relative.collect::<Vec<_>>()).to_vec()
            }
            Resource::Attributes => shared::list(&attributes(conditions, triangles)),
            Resource::Facets => shared::list(&self.facets(conditions)),
            Resource::Materials => shared::list(&materials(conditions, triangles)),
            _ => bytemuck::cast_slice(&texels(conditions)).to_vec(),
        };
        let mut usage = BufferUsages::STORAGE;
        if matches!(resource, Resource::Corners) {
            usage |= BufferUsages::VERTEX;
        }
        let buffer = device.filled(name, &bytes, usage)?;
        self.made.insert(name, buffer.clone());
        Ok(Some(buffer))
    }
}

/// Alpha is interpolated over a triangle, also where it is the same at all corners: what is met by so little is met, in 0 to 255.
const ROUNDING: f64 = 1e-3;

const CORNERS_NAME: &str = "the scene's triangles";
const FACETS_NAME: &str = "the triangles' planes and materials";

fn attributes(conditions: &Conditions, triangles: &Triangles) -> Vec<Attributes> {
    let mesh = &conditions.scene.mesh;
    triangles
        .numbers
        .iter()
        .flat_map(|n| mesh.triangles[*n as usize].vertices)
        .map(|v| {
            let v = v as usize;
            let color = mesh.colors.get(v).unwrap_or(&DVec4::ONE);
            Attributes {
                normal: mesh.normals[v].as_vec3().to_array(),
                color: color.as_vec4().to_array(),
                uv: mesh.uvs[v].as_vec2().to_array(),
            }
        })
        .collect()
}

fn materials(conditions: &Conditions, triangles: &Triangles) -> Vec<Material> {
    let scene = &conditions.scene;
    let mut first = Vec::with_capacity(scene.textures.len());
    let mut texels = 0;
    for texture in &scene.textures {
        first.push(texels);
        texels += texture.pixels.len() as u32;
    }
    let wrap = |wrap: Wrap| match wrap {
        Wrap::Repeat => shared::REPEAT,
        Wrap::Mirror => shared::MIRROR,
        Wrap::Clamp => shared::CLAMP,
    };
    let mut materials: Vec<Material> = scene
        .materials
        .iter()
        .map(|material| {
            let mut shared = Material {
                color: material.base_color.as_vec3(),
                least_alpha: -1.0,
                ..Material::default()
            };
            if let Some(index) = material.texture {
                let texture = &scene.textures[index];
                shared.texel = first[index];
                shared.size = UVec2::new(texture.width, texture.height);
                shared.wrap = UVec2::from(texture.wrap.map(wrap));
            }
            shared
        })
        .collect();
    for (number, opacity) in triangles.numbers.iter().zip(&triangles.opacities) {
        if let Some(least) = opacity.least {
            let material = scene.mesh.triangles[*number as usize].material;
            materials[material as usize].least_alpha = (255.0 * least - ROUNDING) as f32;
        }
    }
    materials
}

fn texels(conditions: &Conditions) -> Vec<u32> {
    let textures = conditions.scene.textures.iter();
    textures
        .flat_map(|texture| texture.pixels.iter().map(|p| u32::from_le_bytes(*p)))
        .collect()
}

/// The point of a triangle that is nearest to the origin, to the precision of f64 relative to its corners (Ericson 2005, 5.1.5).
fn nearest_to_origin([a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (-ab.dot(a), -ac.dot(a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (-ab.dot(b), -ac.dot(b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let (d5, d6) = (-ab.dot(c), -ac.dot(c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    let (to_c, to_b) = (d4 - d3, d5 - d6);
    if va <= 0.0 && to_c >= 0.0 && to_b >= 0.0 {
        return b + (c - b) * (to_c / (to_c + to_b).max(f64::MIN_POSITIVE));
    }
    let sum = va + vb + vc;
    if sum <= 0.0 {
        return a;
    }
    a + ab * (vb / sum) + ac * (vc / sum)
}

/// The media, relative to the eye.
pub fn media(conditions: &Conditions) -> Vec<shared::Medium> {
    let eye = conditions.view.camera.eye;
    let air = &conditions.air;
    air.media
        .iter()
        .map(|medium| {
            let mut shared = shared::Medium {
                scattering: medium.scattering.as_vec3(),
                extinction: medium.extinction().as_vec3(),
                ..shared::Medium::default()
            };
            put_phase(&mut shared, &medium.phase);
            match medium.shape {
                // What asks for these is done by the reference.
                Shape::Layer { .. } | Shape::Ellipsoid { .. } => {
                    shared = shared::Medium::default();
                }
                Shape::Box { min, max } => {
                    shared.shape = shared::BOX;
                    shared.least = (min - eye).as_vec3();
                    shared.greatest = (max - eye).as_vec3();
                }
                Shape::Haze { top } => {
                    shared.shape = shared::HAZE;
                    shared.least.y = (air.ground - eye.y) as f32;
                    shared.greatest.y = (top - eye.y) as f32;
                }
                Shape::Height {
                    base,
                    scale_height,
                    far,
                } => {
                    shared.shape = shared::HEIGHT;
                    shared.start = ((eye.y - base) / scale_height) as f32;
                    shared.scale_height = scale_height as f32;
                    shared.far = far as f32;
                }
                Shape::Air {
                    base,
                    scale_height,
                    far,
                    overhead,
                } => {
                    shared.shape = shared::HEIGHT;
                    shared.start = ((eye.y - base) / scale_height) as f32;
                    shared.scale_height = scale_height as f32;
                    shared.far = far as f32;
                    shared.clear = 1;
                    shared.overhead = overhead.as_vec3();
                }
            }
            shared
        })
        .collect()
}

/// A phase function in numbers: which formula, and its parameters. A droplet's fit is made here.
fn put_phase(shared: &mut shared::Medium, phase: &Phase) {
    let (formula, fog) = match *phase {
        Phase::Isotropic => (shared::ISOTROPIC, Fog::default()),
        Phase::Rayleigh => (shared::RAYLEIGH, Fog::default()),
        Phase::HenyeyGreenstein { g } => {
            let fog = Fog {
                g,
                ..Fog::default()
            };
            (shared::HENYEY_GREENSTEIN, fog)
        }
        Phase::CornetteShanks { g } => (shared::DRAINE, Fog::of_draine(g, 1.0)),
        Phase::NishitaHazy => (shared::NISHITA_HAZY, Fog::default()),
        Phase::NishitaMurky => (shared::NISHITA_MURKY, Fog::default()),
        Phase::Draine { g, a } => (shared::DRAINE, Fog::of_draine(g, a)),
        Phase::Fog { droplet } => (shared::DRAINE, Fog::of_droplet(droplet)),
    };
    shared.phase = formula;
    shared.g = fog.g as f32;
    shared.g_draine = fog.g_draine as f32;
    shared.a = fog.a as f32;
    shared.weight = fog.weight as f32;
}
