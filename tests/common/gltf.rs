//! Small glTF files, made in code.

use super::files::{Folder, glb, picture};
use serde_json::{Value, json};
use tyndall::scene::Scene;

/// A glTF file in the making: JSON and one buffer.
#[derive(Clone)]
pub struct Gltf {
    pub json: Value,
    pub bin: Vec<u8>,
}

pub const FLOAT: u32 = 5126;
pub const BYTE: u32 = 5121;
pub const SHORT: u32 = 5123;

pub const QUAD: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 2.0, 0.0],
    [1.0, 2.0, 0.5],
];

pub fn le(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

impl Gltf {
    /// A sheet of two triangles, lambertian, under one node.
    pub fn quad() -> Self {
        let mut file = Gltf {
            json: json!({
                "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                "meshes": [{"primitives": [{"attributes": {}, "material": 0}]}],
                "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0}}],
                "accessors": [], "bufferViews": [], "buffers": [{}],
            }),
            bin: Vec::new(),
        };
        let positions = file.floats("VEC3", &QUAD.concat());
        let normals = file.floats("VEC3", &[0.0, 0.6, 0.8].repeat(4));
        let indices = file.accessor("SCALAR", BYTE, 6, &[0, 1, 2, 2, 1, 3]);
        let primitive = file.primitive();
        primitive["attributes"] = json!({"POSITION": positions, "NORMAL": normals});
        primitive["indices"] = json!(indices);
        file
    }

    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    fn push(&mut self, list: &str, entry: Value) -> usize {
        let list = self.json[list].as_array_mut().expect("it is a list");
        list.push(entry);
        list.len() - 1
    }

    /// A view of its own for some bytes.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let at = self.bin.len();
        self.bin.extend(bytes);
        self.json["buffers"][0]["byteLength"] = json!(self.bin.len());
        self.push(
            "bufferViews",
            json!({"buffer": 0, "byteOffset": at, "byteLength": bytes.len()}),
        )
    }

    pub fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind,
                "normalized": component != FLOAT && kind != "SCALAR"}),
        )
    }

    /// An accessor of floats.
    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        self.accessor(kind, FLOAT, values.len() / width, &le(values))
    }

    /// Joints that the four vertices of the quad are bound to, with weights.
    pub fn bind(&mut self, set: usize, joints: [[u8; 4]; 4], weights: [[f32; 4]; 4]) {
        let joints = self.accessor("VEC4", BYTE, 4, &joints.concat());
        self.json["accessors"][joints]["normalized"] = json!(false);
        let weights = self.floats("VEC4", &weights.concat());
        let attributes = &mut self.primitive()["attributes"];
        attributes[format!("JOINTS_{set}")] = json!(joints);
        attributes[format!("WEIGHTS_{set}")] = json!(weights);
    }

    /// The same sheet with a skin of two joints, morph targets, a texture, colours, instances, a lamp and two cameras.
    pub fn rich() -> Self {
        let mut file = Gltf::quad();
        let uvs = file.accessor("VEC2", BYTE, 4, &[0, 0, 255, 0, 0, 255, 255, 255]);
        let colors = file.accessor(
            "VEC4",
            BYTE,
            4,
            &[
                255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 0, 51, 51, 51, 255,
            ],
        );
        let up = file.floats("VEC3", &[0.0, 0.5, 0.0].repeat(4));
        let slant = file.floats("VEC3", &[0.0, 0.1, 0.0].repeat(4));
        let places = file.floats("VEC3", &[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]);
        let scales = file.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 1.0, 1.0]);
        let turns = file.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.6, 0.8]);
        let inverse = file.floats("MAT4", &identities(2));
        let png = file.view(&picture());
        {
            let primitive = file.primitive();
            primitive["attributes"]["TEXCOORD_0"] = json!(uvs);
            primitive["attributes"]["COLOR_0"] = json!(colors);
            primitive["targets"] = json!([{"POSITION": up, "NORMAL": slant}, {"POSITION": slant}]);
        }
        let plain = file.json["meshes"][0].clone();
        let binding = [
            [1.0, 0.0, 0.0, 0.0],
            [0.25, 0.75, 0.0, 0.0],
            [0.5, 0.5, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
        ];
        file.bind(0, [[0, 1, 0, 0]; 4], binding);
        let json = &mut file.json;
        json["meshes"][0]["weights"] = json!([0.5, 0.25]);
        json["meshes"].as_array_mut().expect("a list").push(plain);
        json["nodes"] = json!([
            {"name": "all", "children": [1, 2, 3, 4, 5, 6], "translation": [1, 2, 3]},
            {"mesh": 0, "skin": 0},
            {"translation": [0, 1, 0], "children": [7]},
            {"mesh": 1, "weights": [1, 0], "rotation": [0, 0.6, 0, 0.8], "scale": [1, 2, 1],
                "extensions": {"EXT_mesh_gpu_instancing": {"attributes":
                    {"TRANSLATION": places, "SCALE": scales, "ROTATION": turns}}}},
            {"name": "eye", "camera": 0, "matrix": [0,0,-1,0, 0,1,0,0, 1,0,0,0, 7,8,9,1]},
            {"name": "plan", "camera": 1},
            {"extensions": {"KHR_lights_punctual": {"light": 0}, "KHR_node_visibility": {"visible": true}}},
            {"translation": [0, 0.5, 0]},
        ]);
        json["skins"] = json!([{"joints": [2, 7], "inverseBindMatrices": inverse, "skeleton": 2}]);
        json["materials"][0] = json!({
            "name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.25,
            "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.5, 0.25, 0.125, 0.75],
                "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {
                    "offset": [0.5, -0.25], "rotation": 0.5, "scale": [2.0, 3.0], "texCoord": 0}}}},
        });
        json["textures"] = json!([{"source": 0, "sampler": 0}]);
        json["samplers"] = json!([{"wrapS": 33_648, "wrapT": 33_071}]);
        json["images"] = json!([{"bufferView": png, "mimeType": "image/png"}]);
        json["cameras"] = json!([
            {"type": "perspective", "perspective": {"yfov": 0.75, "znear": 0.1}},
            {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2.5, "znear": 0, "zfar": 1}},
        ]);
        json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
            {"type": "spot", "name": "lamp", "color": [1, 0.5, 0.25], "intensity": 40, "spot": {"outerConeAngle": 0.5}}]}});
        file
    }

    pub fn glb(&self) -> Vec<u8> {
        glb(&self.json, &self.bin)
    }

    pub fn load(&self) -> tyndall::Result<Scene> {
        Folder::new().load("it.glb", self.glb())
    }

    /// The scene of a file that must load without a word.
    pub fn silent(&self) -> Scene {
        let scene = self.load().expect("it loads");
        assert_eq!(scene.warnings, [], "nothing is to be said");
        scene
    }
}

/// Identity matrices, column by column.
pub fn identities(count: usize) -> Vec<f32> {
    let one = |i: usize| if (i % 16).is_multiple_of(5) { 1.0 } else { 0.0 };
    (0..16 * count).map(one).collect()
}

/// All that is seen of a scene, to compare.
pub fn seen(scene: &Scene) -> String {
    let (mesh, materials) = (&scene.mesh, &scene.materials);
    let pictures: Vec<_> = scene
        .textures
        .iter()
        .map(|t| (&t.pixels, t.width, t.wrap))
        .collect();
    format!(
        "{mesh:?} {materials:?} {pictures:?} {:?} {:?} {:?}",
        scene.cameras, scene.lights, scene.emissions
    )
}

/// That two meshes are the same to the rounding of a few products.
pub fn assert_same(one: &Scene, other: &Scene) {
    let (one, other) = (&one.mesh, &other.mesh);
    assert_eq!(one.triangles, other.triangles);
    let near = |a: &[glam::DVec3], b: &[glam::DVec3]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.distance(*b) < 1e-7)
    };
    assert!(
        near(&one.positions, &other.positions),
        "{:?} {:?}",
        one.positions,
        other.positions
    );
    assert!(
        near(&one.normals, &other.normals),
        "{:?} {:?}",
        one.normals,
        other.normals
    );
    assert_eq!((&one.uvs, &one.colors), (&other.uvs, &other.colors));
}
