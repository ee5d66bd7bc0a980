//! The scene as the shaders read it: triangles relative to the eye, materials, texels, media.

use super::device::Device;
use super::shared::{self, Attributes, Material};
use crate::conditions::Conditions;
use crate::effect::Resource;
use crate::error::Result;
use crate::medium::{Fog, Phase, Shape};
use crate::scene::{Geometry, Ray, Wrap};
use glam::{DVec3, UVec2, Vec3};
use std::collections::{BTreeMap, HashMap};
use wgpu::{Buffer, BufferUsages};

/// Which triangles are drawn, and in which order: the solid ones first.
pub struct Triangles {
    /// Numbers in the scene.
    pub numbers: Vec<u32>,
    /// How many of them have no holes.
    pub solid: u32,
    /// Least solid alpha of those with holes.
    least_alpha: Vec<Option<f64>>,
    /// The number in the picture, from 1, of each of the scene's triangles; 0 for one that is not drawn.
    drawn: Vec<u32>,
}

/// Corners in a row of the texture of them, as in shaders/common/light.wgsl: a multiple of 3 that every device takes.
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
            .partition(|(_, least)| least.is_some());
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
            least_alpha: all.iter().map(|(_, least)| *least).collect(),
        }
    }

    /// The number in the picture of the triangle that a ray meets first, from 1; 0 for none.
    pub fn number_met(&self, geometry: &Geometry, ray: &Ray) -> u32 {
        let hit = geometry.closest(ray, 0.0, f64::INFINITY);
        hit.map_or(0, |hit| self.drawn[hit.triangle as usize])
    }

    /// The planes in which they lie.
    pub fn planes(&self, conditions: &Conditions) -> Vec<Plane> {
        self.corners(conditions)
            .chunks_exact(3)
            .map(|p| Plane {
                point: p[0],
                normal: (p[1] - p[0]).cross(p[2] - p[0]),
            })
            .collect()
    }

    /// Corners relative to the eye [m], three texels a triangle, in rows of [`CORNERS`]; each with the number, from 1, of the
    /// triangle beyond the edge that begins there, 0 for none.
    pub fn corner_texture(&self, device: &Device, conditions: &Conditions) -> wgpu::Texture {
        let eye = conditions.camera.eye;
        let corners = self.corners(conditions);
        let beyond = beyond_edges(&corners[..3 * self.solid as usize]);
        // Whole numbers up to 2^24 are exact; the others' edges end at nothing.
        let number = |corner: usize| match beyond.get(corner) {
            Some(Some(triangle)) if *triangle < 1 << 24 => (triangle + 1) as f32,
            _ => 0.0,
        };
        let texels = corners
            .iter()
            .enumerate()
            .map(|(i, p)| (*p - eye).as_vec3().extend(number(i)));
        device.vectors("corners of casters", CORNERS, texels.collect())
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

/// For each edge of triangles, that from corner i to the next one of its triangle, the triangle on its other side; where more
/// than two meet, the next of them in turn.
fn beyond_edges(corners: &[DVec3]) -> Vec<Option<u32>> {
    let bits = |p: DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let mut beyond = vec![None; corners.len()];
    // The first and the last edge between two places so far.
    let mut met: HashMap<[[u64; 3]; 2], [usize; 2]> = HashMap::with_capacity(corners.len() / 2);
    for i in 0..corners.len() {
        let next = if i % 3 == 2 { i - 2 } else { i + 1 };
        let mut ends = [bits(corners[i]), bits(corners[next])];
        ends.sort_unstable();
        let [first, last] = met.entry(ends).or_insert([i, i]);
        if *last != i {
            beyond[*last] = Some((i / 3) as u32);
            beyond[i] = Some((*first / 3) as u32);
            *last = i;
        }
    }
    beyond
}

/// Buffers made when a pass first names them.
#[derive(Default)]
pub struct SceneBuffers {
    made: BTreeMap<&'static str, Buffer>,
}

impl SceneBuffers {
    /// A buffer of the scene.
    pub fn get(
        &mut self,
        device: &Device,
        conditions: &Conditions,
        triangles: &Triangles,
        resource: &Resource,
    ) -> Result<Option<Buffer>> {
        let name = match resource {
            Resource::Corners => "the scene's triangles",
            Resource::Attributes => "normals and texture coordinates",
            Resource::MaterialOf => "the triangles' materials",
            Resource::Materials => "the materials",
            Resource::Texels => "the textures",
            _ => return Ok(None),
        };
        if let Some(buffer) = self.made.get(name) {
            return Ok(Some(buffer.clone()));
        }
        let bytes = match resource {
            Resource::Corners => corners(conditions, triangles),
            Resource::Attributes => shared::list(&attributes(conditions, triangles)),
            Resource::MaterialOf => {
                bytemuck::cast_slice(&material_of(conditions, triangles)).to_vec()
            }
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

fn corners(conditions: &Conditions, triangles: &Triangles) -> Vec<u8> {
    let eye = conditions.camera.eye;
    let relative: Vec<[f32; 3]> = triangles
        .corners(conditions)
        .iter()
        .map(|p| (*p - eye).as_vec3().to_array())
        .collect();
    bytemuck::cast_slice(&relative).to_vec()
}

fn attributes(conditions: &Conditions, triangles: &Triangles) -> Vec<Attributes> {
    let mesh = &conditions.scene.mesh;
    triangles
        .numbers
        .iter()
        .flat_map(|n| mesh.triangles[*n as usize].vertices)
        .map(|v| {
            let v = v as usize;
            Attributes {
                normal: mesh.normals[v].as_vec3(),
                u: mesh.uvs[v].x as f32,
                color: mesh.colors.get(v).map_or(Vec3::ONE, |c| c.as_vec3()),
                v: mesh.uvs[v].y as f32,
            }
        })
        .collect()
}

fn material_of(conditions: &Conditions, triangles: &Triangles) -> Vec<u32> {
    let mesh = &conditions.scene.mesh;
    let number = |n: &u32| mesh.triangles[*n as usize].material;
    triangles.numbers.iter().map(number).collect()
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
        Wrap::Repeat => 0,
        Wrap::Mirror => 1,
        Wrap::Clamp => 2,
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
    for (number, least) in triangles.numbers.iter().zip(&triangles.least_alpha) {
        if let Some(least) = least {
            let material = scene.mesh.triangles[*number as usize].material;
            materials[material as usize].least_alpha = *least as f32;
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

/// The media, relative to the eye.
pub fn media(conditions: &Conditions) -> Vec<shared::Medium> {
    let eye = conditions.camera.eye;
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
                Shape::Box { min, max } => {
                    shared.least = (min - eye).as_vec3();
                    shared.greatest = (max - eye).as_vec3();
                }
                Shape::Haze { top } => {
                    shared.shape = 1;
                    shared.least.y = (air.ground - eye.y) as f32;
                    shared.greatest.y = (top - eye.y) as f32;
                }
                Shape::Height {
                    base,
                    scale_height,
                    far,
                } => {
                    shared.shape = 2;
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
                    shared.shape = 2;
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
        Phase::Isotropic => (0, Fog::default()),
        Phase::Rayleigh => (1, Fog::default()),
        Phase::HenyeyGreenstein { g } => {
            let fog = Fog {
                g,
                ..Fog::default()
            };
            (2, fog)
        }
        Phase::CornetteShanks { g } => (3, Fog::of_draine(g, 1.0)),
        Phase::NishitaHazy => (4, Fog::default()),
        Phase::NishitaMurky => (5, Fog::default()),
        Phase::Draine { g, a } => (3, Fog::of_draine(g, a)),
        Phase::Fog { droplet } => (3, Fog::of_droplet(droplet)),
    };
    shared.phase = formula;
    shared.g = fog.g as f32;
    shared.g_draine = fog.g_draine as f32;
    shared.a = fog.a as f32;
    shared.weight = fog.weight as f32;
}
