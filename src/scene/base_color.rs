//! The colour of a surface at a place: material, vertices and texture.

use super::Scene;
use super::cut_out::texel;
use crate::colour::srgb_decode;
use glam::{DVec2, DVec3};

impl Scene {
    /// The base colour of a triangle at the weights of its second and third vertex: linear Rec. 709, 0 to 1. A texture is read at
    /// its nearest texel.
    pub fn base_color(&self, triangle: u32, [v, w]: [f64; 2]) -> DVec3 {
        let mesh = &self.mesh;
        let triangle = &mesh.triangles[triangle as usize];
        let weights = [1.0 - v - w, v, w];
        let material = &self.materials[triangle.material as usize];
        let mut color = material.base_color;
        if !mesh.colors.is_empty() {
            let [a, b, c] = triangle
                .vertices
                .map(|i| mesh.colors[i as usize].truncate());
            color *= a * weights[0] + b * weights[1] + c * weights[2];
        }
        if let Some(index) = material.texture {
            let uvs = triangle.vertices.map(|i| mesh.uvs[i as usize]);
            let uv: DVec2 = uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2];
            let texture = &self.textures[index];
            let x = texel(uv.x, texture.width, texture.wrap[0]);
            let y = texel(uv.y, texture.height, texture.wrap[1]);
            let [r, g, b, _] = texture.pixels[(y * texture.width + x) as usize];
            let linear = |c: u8| srgb_decode(f64::from(c) / 255.0);
            color *= DVec3::new(linear(r), linear(g), linear(b));
        }
        color
    }
}
