//! Light that surfaces give of themselves: luminance [cd/m2], the same in all directions on the front (Lambert).
//!
//! glTF: emissiveFactor times emissiveTexture (sRGB) times KHR_materials_emissive_strength; on both sides where the material is
//! doubleSided. MTL: `Ke`, on the front side. The front is the side from which the corners go round counter-clockwise.

use super::cut_out::texel;
use super::{Scene, Texture};
use crate::colour::srgb_decode;
use glam::{DAffine2, DVec2, DVec3};

/// No surface of a file is brighter than this [cd/m2]; the sun's disc is.
pub(super) const MOST_LUMINANCE: f64 = 1e9;

/// What a material gives of light.
#[derive(Debug, Clone, PartialEq)]
pub struct Emission {
    /// Luminance [cd/m2], linear Rec. 709; multiplies the texture.
    pub luminance: DVec3,
    /// Index into [`Scene::textures`].
    pub texture: Option<usize>,
    /// From the mesh's texture coordinates to those of this texture.
    pub uvs: DAffine2,
    /// Whether the back shines too.
    pub both_sides: bool,
}

impl Emission {
    /// The same luminance all over the front.
    pub fn plain(luminance: DVec3) -> Self {
        Emission {
            luminance,
            texture: None,
            uvs: DAffine2::IDENTITY,
            both_sides: false,
        }
    }
}

/// The texel at a texture coordinate, linear, and its alpha.
fn at(texture: &Texture, uv: DVec2) -> (DVec3, f64) {
    let x = texel(uv.x, texture.width, texture.wrap[0]);
    let y = texel(uv.y, texture.height, texture.wrap[1]);
    let [r, g, b, a] =
        texture.pixels[(y * texture.width + x) as usize].map(|c| f64::from(c) / 255.0);
    (DVec3::new(r, g, b).map(srgb_decode), a)
}

impl Texture {
    /// The mean of all texels, linear Rec. 709.
    pub(super) fn mean(&self) -> DVec3 {
        let linear = |[r, g, b, _]: &[u8; 4]| {
            DVec3::new(f64::from(*r), f64::from(*g), f64::from(*b)).map(|c| srgb_decode(c / 255.0))
        };
        self.pixels.iter().map(linear).sum::<DVec3>() / self.pixels.len() as f64
    }
}

impl Scene {
    /// The luminance of the front of a triangle at the weights of its second and third vertex [cd/m2], linear Rec. 709.
    pub fn emission(&self, triangle: u32, weights: [f64; 2]) -> DVec3 {
        let material = self.mesh.triangles[triangle as usize].material;
        let Some(emission) = self.emissions.get(&material) else {
            return DVec3::ZERO;
        };
        match emission.texture {
            None => emission.luminance,
            Some(texture) => {
                let uv = emission.uvs.transform_point2(self.uv(triangle, weights));
                emission.luminance * at(&self.textures[texture], uv).0
            }
        }
    }

    /// Whether a place of a triangle is there, where alpha must reach `least` ([`super::opacity`]).
    pub(crate) fn is_solid(&self, triangle: u32, [v, w]: [f64; 2], least: f64) -> bool {
        let corners = self.mesh.triangles[triangle as usize].vertices;
        let material = &self.materials[self.mesh.triangles[triangle as usize].material as usize];
        let of_texture = material.texture.map_or(1.0, |texture| {
            at(&self.textures[texture], self.uv(triangle, [v, w])).1
        });
        let of_vertices = match self.mesh.colors.is_empty() {
            true => 1.0,
            false => {
                let [a, b, c] = corners.map(|i| self.mesh.colors[i as usize].w);
                a * (1.0 - v - w) + b * v + c * w
            }
        };
        of_texture * of_vertices >= least
    }

    /// Texture coordinates of a triangle at the weights of its second and third vertex.
    fn uv(&self, triangle: u32, [v, w]: [f64; 2]) -> DVec2 {
        let vertices = self.mesh.triangles[triangle as usize].vertices;
        let [a, b, c] = vertices.map(|i| self.mesh.uvs[i as usize]);
        a * (1.0 - v - w) + b * v + c * w
    }

    /// How many texels of its emissive texture a triangle's longest edge crosses, about; 0 without one.
    pub(crate) fn emissive_texels(&self, triangle: u32) -> f64 {
        let triangle = &self.mesh.triangles[triangle as usize];
        let Some(emission) = self.emissions.get(&triangle.material) else {
            return 0.0;
        };
        let size = |index: usize| {
            let texture = &self.textures[index];
            DVec2::new(f64::from(texture.width), f64::from(texture.height))
        };
        let uvs = triangle.vertices.map(|i| self.mesh.uvs[i as usize]);
        let longest = |size: DVec2, uvs: [DVec2; 3]| {
            let [a, b, c] = uvs.map(|uv| uv * size);
            a.distance(b).max(b.distance(c)).max(c.distance(a))
        };
        let own = emission.texture.map_or(0.0, |index| {
            let moved = uvs.map(|uv| emission.uvs.transform_point2(uv));
            longest(size(index), moved)
        });
        let holes = self.materials[triangle.material as usize].texture;
        own.max(holes.map_or(0.0, |index| longest(size(index), uvs)))
    }
}
