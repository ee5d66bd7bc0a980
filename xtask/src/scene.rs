//! `cargo xtask scene`: makes the built-in scene, `data/nave`.

mod mesh;
mod nave;
mod texture;

use mesh::{Mesh, Part};
use serde_json::{Value, json};
use std::process::ExitCode;

/// Name, base colour (linear Rec. 709), texture, metres that the texture covers.
const MATERIALS: [(&str, [f64; 3], Option<usize>, f64); 6] = [
    ("limestone", [0.86, 0.76, 0.62], Some(0), 4.0),
    ("vault", [0.92, 0.86, 0.76], Some(0), 4.0),
    ("floor", [0.80, 0.70, 0.58], Some(1), 4.8),
    ("oak", [0.16, 0.085, 0.045], None, 1.0),
    ("slate", [0.10, 0.10, 0.11], None, 1.0),
    ("wool", [0.075, 0.028, 0.024], None, 1.0),
];

/// Writes the files of the scene.
pub fn run() -> ExitCode {
    let folder = crate::root().join("data/nave");
    for (name, bytes) in [("nave.glb", glb()), ("nave.toml", TOML.into())] {
        let path = folder.join(name);
        if let Err(e) =
            std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, &bytes))
        {
            eprintln!("xtask: cannot write {}: {e}", path.display());
            return ExitCode::FAILURE;
        }
        println!("{} ({} bytes)", path.display(), bytes.len());
    }
    ExitCode::SUCCESS
}

const TOML: &str = include_str!("scene/nave.toml");

/// The buffer of a GLB and the JSON that describes it.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    fn view(&mut self, bytes: impl IntoIterator<Item = u8>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        self.views.push(
            json!({"buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() - offset}),
        );
        self.views.len() - 1
    }

    fn accessor(&mut self, bytes: Vec<u8>, count: usize, kind: (u32, &str), extra: Value) -> usize {
        let view = self.view(bytes);
        let mut accessor =
            json!({"bufferView": view, "componentType": kind.0, "count": count, "type": kind.1});
        for (key, value) in extra.as_object().into_iter().flatten() {
            accessor[key] = value.clone();
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn primitive(&mut self, material: usize, part: &Part) -> Value {
        let floats = |list: &mut dyn Iterator<Item = f32>| {
            list.flat_map(f32::to_le_bytes).collect::<Vec<u8>>()
        };
        let count = part.positions.len();
        let bound = |pick: fn(f32, f32) -> f32| {
            let fold = |k: usize| {
                part.positions
                    .iter()
                    .map(|p| p[k])
                    .reduce(pick)
                    .unwrap_or(0.0)
            };
            json!([fold(0), fold(1), fold(2)])
        };
        let limits = json!({"min": bound(f32::min), "max": bound(f32::max)});
        let positions = floats(&mut part.positions.iter().flatten().copied());
        let normals = floats(&mut part.normals.iter().flatten().copied());
        let uvs = floats(&mut part.uvs.iter().flatten().copied());
        let indices: Vec<u8> = match u16::try_from(count) {
            Ok(_) => part
                .indices
                .iter()
                .flat_map(|&i| (i as u16).to_le_bytes())
                .collect(),
            Err(_) => part.indices.iter().flat_map(|i| i.to_le_bytes()).collect(),
        };
        let kind = if indices.len() == 2 * part.indices.len() {
            5123
        } else {
            5125
        };
        let mut attributes = json!({
            "POSITION": self.accessor(positions, count, (5126, "VEC3"), limits),
            "NORMAL": self.accessor(normals, count, (5126, "VEC3"), json!({})),
            "COLOR_0": self.accessor(part.colors.concat(), count, (5121, "VEC4"), json!({"normalized": true})),
        });
        if MATERIALS[material].2.is_some() {
            attributes["TEXCOORD_0"] = self.accessor(uvs, count, (5126, "VEC2"), json!({})).into();
        }
        let indices = self.accessor(indices, part.indices.len(), (kind, "SCALAR"), json!({}));
        json!({"attributes": attributes, "indices": indices, "material": material})
    }
}

/// The scene as a GLB.
fn glb() -> Vec<u8> {
    let mut buffer = Buffer::default();
    let metres = MATERIALS.map(|m| m.3);
    let meshes: Vec<Value> = [
        ("bay", nave::bay()),
        ("pillars", nave::pillars()),
        ("ends", nave::ends()),
        ("floor", nave::floor()),
        ("bench", nave::bench()),
        ("figure", nave::figure()),
    ]
    .into_iter()
    .map(|(name, mesh): (&str, Mesh)| {
        let primitives: Vec<Value> = mesh
            .finish(&metres)
            .iter()
            .map(|(material, part)| buffer.primitive(*material, part))
            .collect();
        json!({"name": name, "primitives": primitives})
    })
    .collect();

    let mut nodes = vec![
        json!({"name": "ends", "mesh": 2}),
        json!({"name": "floor", "mesh": 3}),
    ];
    for i in 0..nave::BAYS {
        let z = -nave::BAY * (i as f64 + 0.5);
        nodes.push(json!({"name": format!("bay {}", i + 1), "mesh": 0, "translation": [0, 0, z]}));
    }
    for i in 0..=nave::BAYS {
        nodes.push(json!({"name": format!("pillars {}", i + 1), "mesh": 1, "translation": [0, 0, -nave::BAY * i as f64]}));
    }
    for row in 0..13 {
        for x in [-2.75, 2.75] {
            nodes.push(json!({"name": "bench", "mesh": 4, "translation": [x, 0, -9.5 - 1.15 * f64::from(row)]}));
        }
    }
    nodes.push(json!({"name": "visitor", "mesh": 5, "translation": [0.8, 0, -14.2]}));

    let images: Vec<Value> = [("ashlar", texture::ashlar()), ("slabs", texture::slabs())]
        .into_iter()
        .map(|(name, png)| json!({"name": name, "mimeType": "image/png", "bufferView": buffer.view(png)}))
        .collect();
    let materials: Vec<Value> = MATERIALS
        .iter()
        .map(|(name, color, texture, _)| {
            let mut pbr = json!({"baseColorFactor": [color[0], color[1], color[2], 1], "metallicFactor": 0, "roughnessFactor": 1});
            if let Some(index) = texture {
                pbr["baseColorTexture"] = json!({"index": index});
            }
            json!({"name": name, "pbrMetallicRoughness": pbr})
        })
        .collect();
    let json = json!({
        "asset": {"version": "2.0", "generator": "tyndall, cargo xtask scene"},
        "scene": 0,
        "scenes": [{"name": "nave", "nodes": (0..nodes.len()).collect::<Vec<_>>()}],
        "nodes": nodes, "meshes": meshes, "materials": materials,
        "textures": [{"source": 0}, {"source": 1}], "images": images,
        "accessors": buffer.accessors, "bufferViews": buffer.views,
        "buffers": [{"byteLength": buffer.bytes.len()}],
    });

    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    buffer
        .bytes
        .resize(buffer.bytes.len().next_multiple_of(4), 0);
    let mut out = b"glTF".to_vec();
    out.extend(2u32.to_le_bytes());
    out.extend((28 + text.len() as u32 + buffer.bytes.len() as u32).to_le_bytes());
    for (chunk, kind) in [(text, b"JSON"), (buffer.bytes, b"BIN\0")] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_in_the_repository_are_what_the_generator_makes() {
        for (name, bytes) in [("nave.glb", glb()), ("nave.toml", TOML.into())] {
            let path = crate::root().join("data/nave").join(name);
            let there = std::fs::read(&path).unwrap_or_default();
            assert!(
                there == bytes,
                "{} is not what the generator makes: run `cargo xtask scene`",
                path.display()
            );
        }
    }

    #[test]
    fn every_material_is_used() {
        let used: std::collections::BTreeSet<usize> = [
            nave::bay(),
            nave::pillars(),
            nave::ends(),
            nave::floor(),
            nave::bench(),
            nave::figure(),
        ]
        .iter()
        .flat_map(|m| {
            m.finish(&[1.0; 6])
                .into_iter()
                .map(|(material, _)| material)
        })
        .collect();
        assert_eq!(used, (0..MATERIALS.len()).collect());
        assert_eq!(MATERIALS[nave::material::WOOD].0, "oak");
    }
}
