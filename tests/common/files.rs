//! Scene files for tests, written to a folder that goes with them.

use serde_json::{Value, json};
use std::path::PathBuf;
use tyndall::scene::{self, Scene};

/// A folder that goes with the test.
pub struct Folder(pub tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Folder(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).expect("the file is written");
        path
    }

    pub fn load(&self, name: &str, bytes: impl AsRef<[u8]>) -> tyndall::Result<Scene> {
        scene::load(&self.put(name, bytes))
    }

    /// The error of a file that must not load; it must name the file and a remedy.
    pub fn refused(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        match self.load(name, bytes) {
            Ok(_) => panic!("{name} loads"),
            Err(error) => {
                let text = error.to_string();
                assert!(
                    text.contains(name),
                    "the error does not name {name}: {text}"
                );
                assert!(!error.remedy().is_empty(), "no remedy: {text}");
                assert!(error.is_input(), "not the user's to fix: {text}");
                text
            }
        }
    }
}

/// A GLB of its two chunks.
pub fn glb(json: &Value, bin: &[u8]) -> Vec<u8> {
    let pad = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let (json, bin) = (pad(json.to_string().as_bytes(), b' '), pad(bin, 0));
    let mut out = b"glTF".to_vec();
    out.extend(2u32.to_le_bytes());
    out.extend((28 + json.len() as u32 + bin.len() as u32).to_le_bytes());
    for (chunk, kind) in [(&json, b"JSON"), (&bin, b"BIN\0")] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    out
}

pub const CORNERS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 2.0, 0.0],
    [1.0, 2.0, 0.5],
];
pub const INDICES: [u16; 6] = [0, 1, 2, 2, 1, 3];

/// Two triangles with normals, texture coordinates and colours, under two nodes; a light and two cameras.
pub fn example() -> (Value, Vec<u8>) {
    let mut bin = Vec::new();
    for p in CORNERS {
        bin.extend(p.iter().flat_map(|x| x.to_le_bytes()));
    }
    for _ in 0..4 {
        bin.extend([0.0f32, 0.6, 0.8].iter().flat_map(|x| x.to_le_bytes()));
    }
    for uv in [[0u16, 0], [65_535, 0], [0, 65_535], [65_535, 65_535]] {
        bin.extend(uv.iter().flat_map(|x| x.to_le_bytes()));
    }
    for color in [
        [255u8, 0, 0, 255],
        [0, 255, 0, 255],
        [0, 0, 255, 255],
        [51, 51, 51, 255],
    ] {
        bin.extend(color);
    }
    bin.extend(INDICES.iter().flat_map(|i| i.to_le_bytes()));
    let png = picture();
    let picture_at = bin.len();
    bin.extend(&png);
    let json = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [
            {"name": "far", "translation": [1e6, -2e6, 5e5], "children": [1, 2, 3]},
            {"name": "near", "mesh": 0, "rotation": [0.1, 0.2, 0.3, 0.927_361_849_549_570_4], "scale": [0.001, 0.002, 0.003]},
            {"name": "eye", "camera": 0, "matrix": [0,0,-1,0, 0,1,0,0, 1,0,0,0, 7,8,9,1]},
            {"camera": 1, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "meshes": [{"name": "sheet", "primitives": [{
            "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_1": 2, "COLOR_0": 3}, "indices": 4, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 4, "type": "VEC2", "normalized": true},
            {"bufferView": 2, "componentType": 5121, "count": 4, "type": "VEC4", "normalized": true},
            {"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 16},
            {"buffer": 0, "byteOffset": 112, "byteLength": 16},
            {"buffer": 0, "byteOffset": 128, "byteLength": 12},
            {"buffer": 0, "byteOffset": picture_at, "byteLength": png.len()},
        ],
        "buffers": [{"byteLength": bin.len()}],
        "materials": [{
            "name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.25,
            "normalTexture": {"index": 0}, "emissiveFactor": [1, 0, 0],
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.5}},
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.5, 0.25, 0.125, 0.75], "metallicFactor": 0,
                "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {
                    "offset": [0.5, -0.25], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2.0, 3.0], "texCoord": 1}}},
            },
        }],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"wrapS": 33_648, "wrapT": 33_071}],
        "images": [{"bufferView": 4, "mimeType": "image/png", "name": "leaf.png"}],
        "cameras": [
            {"type": "perspective", "perspective": {"yfov": 0.75, "znear": 0.1}},
            {"type": "orthographic", "name": "plan", "orthographic": {"xmag": 3, "ymag": 2.5, "znear": 0, "zfar": 1}},
        ],
        "extensionsRequired": ["KHR_texture_transform", "KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "spot", "name": "lamp", "color": [1, 0.5, 0.25], "intensity": 40, "spot": {"outerConeAngle": 0.5}}]}},
    });
    (json, bin)
}

/// Two texels: opaque red, transparent blue.
pub fn picture() -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 0, 255, 0])
        .expect("two texels")
        .write_to(&mut png, image::ImageFormat::Png)
        .expect("a PNG");
    png.into_inner()
}

/// The scene file of the design, as it is documented.
pub const EXAMPLE_TOML: &str = r#"
mesh = "room.obj"
scale = 1.0
up = "y"
origin = [0, 0, 0]
north = 0.0
time = "2026-06-21T18:30:00+02:00"
[site]
latitude = 48.8584
longitude = 2.2945
elevation = 35.0
timezone = "Europe/Paris"
[camera]
eye = [0.0, 1.6, 5.0]
target = [0.0, 1.5, 0.0]
up = [0, 1, 0]
fov_y = 60.0
projection = "perspective"
shift = [0.25, 0]
[sun]
azimuth = 120.0
elevation = 30.0
illuminance = 1.0
diameter = 0.0
[sky]
model = "cie:12"
turbidity = 3
direct_normal = 800
diffuse_horizontal = 100.0
[ground]
enabled = true
height = 0.0
albedo = 0.2
[[medium]]
shape = "box"
min = [-4.0, 0.0, -5.0]
max = [4.0, 4.0, 5.0]
scattering = 0.04
absorption = 0.0
phase = { kind = "henyey-greenstein", g = 0.7 }
[[medium]]
shape = "haze"
top = 60.0
scattering = [0.001, 0.002, 0.003]
[[medium]]
shape = "height"
base = 0.0
scale_height = 1200.0
far = 60000.0
scattering = 6e-5
absorption = 4e-6
phase = { kind = "rayleigh" }
[[medium]]
shape = "air"
turbidity = 2.5
base = 10.0
far = 80000.0
scale_height = 8000.0
aerosol_scale_height = 1500.0
aerosol_albedo = 0.95
phase = { kind = "fog", droplet_um = 1.0 }
[[light]]
name = "desk"
position = [0.5, 1.2, 0.5]
toward = [0.2, -1, 0]
around = [0, 0, 1.0]
intensity = [40.0, 30, 20.0]
to = [0.9, 1.2, 0.5]
ignore = "default"
distribution = { kind = "polka-dots", spread = 40.0, sharpness = 0.2, petals = 8, ratio = -0.3, rings = 4 }
[[light]]
position = [0, 2, 0]
intensity = 5
radius = 0.1
distribution = { kind = "elliptical", spread = [20, 8.0], sharpness = 0.2 }
[[light]]
position = [0, 2, 0]
intensity = 5
edges = [[1, 0, 0], [0, 0, 1]]
[picture]
size = [960, 600]
samples = 8
exposure = 9.5
"#;

pub const ROOM: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";

/// xorshift64*: the same damage on every machine.
pub struct Dice(pub u64);

impl Dice {
    pub fn roll(&mut self, sides: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize % sides.max(1)
    }
}
