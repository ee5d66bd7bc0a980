//! What a file holds beside the scene that is shown: other scenes, and what nothing uses. It is named, with how often.

use super::container::Gltf;
use super::document::{Light, LightRef, Lod};
use super::light;
use super::material::extension;
use super::notes::Notes;
use super::tree::Tree;
use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// Names all of it.
pub(super) fn name(gltf: &Gltf, tree: &Tree, lights: &[Light], notes: &mut Notes) {
    let json = &gltf.json;
    let shown: BTreeSet<usize> = tree.nodes.iter().map(|&(node, _)| node).collect();
    let elsewhere = below(gltf, json.scenes.iter().flat_map(|scene| &scene.nodes));
    // Coarser levels of detail are named by the extension that holds them.
    let lods = json.nodes.iter().filter_map(|node| {
        let lod: Option<Lod> = extension(gltf, &node.extensions, "MSFT_lod", "nodes").ok()?;
        Some(lod?.ids)
    });
    let coarser = below(gltf, lods.flatten().collect::<Vec<_>>().iter());

    let mut used = [const { BTreeSet::new() }; 4];
    for (index, node) in json.nodes.iter().enumerate() {
        let lamp: Option<LightRef> = extension(gltf, &node.extensions, light::NAME, "nodes")
            .ok()
            .flatten();
        let held = [node.mesh, node.camera, lamp.map(|lamp| lamp.light)];
        if node.skin.is_some() && node.mesh.is_none() {
            notes.leave_out("skin of a node without a mesh");
        }
        for (i, what) in ["mesh", "camera", "lamp"].into_iter().enumerate() {
            let Some(which) = held[i] else { continue };
            used[i].insert(which);
            if !shown.contains(&index) && !coarser.contains(&index) {
                let place = if elsewhere.contains(&index) {
                    "in a scene that is not shown"
                } else {
                    "that is in no scene"
                };
                notes.leave_out(format!("{what} of a node {place}"));
            }
        }
        used[3].extend(node.skin);
    }
    let kinds = [
        ("mesh that no node uses", json.meshes.len()),
        ("camera that no node uses", json.cameras.len()),
        ("lamp that no node uses", lights.len()),
        ("skin that no node uses", json.skins.len()),
    ];
    for ((what, count), used) in kinds.into_iter().zip(used) {
        leave_out_others(what, count, &used, notes);
    }
    pictures(gltf, notes);
}

/// Textures that no material names, pictures that no texture does.
fn pictures(gltf: &Gltf, notes: &mut Notes) {
    let json = &gltf.json;
    let mut textures = BTreeSet::new();
    for material in &json.materials {
        let pbr = &material.pbr_metallic_roughness;
        textures.extend(pbr.base_color_texture.as_ref().map(|texture| texture.index));
        let others = [
            &pbr.metallic_roughness_texture,
            &material.normal_texture,
            &material.occlusion_texture,
        ];
        textures.extend(
            material
                .emissive_texture
                .as_ref()
                .map(|texture| texture.index),
        );
        for texture in others.into_iter().flatten() {
            numbers_of("index", texture, &mut textures);
        }
        numbers_below("index", &material.extensions, &mut textures);
    }
    let mut images = BTreeSet::new();
    for texture in &json.textures {
        images.extend(texture.source);
        numbers_below("source", &texture.extensions, &mut images);
    }
    leave_out_others(
        "texture that no material uses",
        json.textures.len(),
        &textures,
        notes,
    );
    leave_out_others(
        "picture that no texture uses",
        json.images.len(),
        &images,
        notes,
    );
}

fn leave_out_others(what: &str, count: usize, used: &BTreeSet<usize>, notes: &mut Notes) {
    let unused = (0..count).filter(|i| !used.contains(i)).count();
    notes.leave_out_all(what, unused);
}

/// The nodes `roots` and all below them.
fn below<'a>(gltf: &'a Gltf, roots: impl Iterator<Item = &'a usize>) -> BTreeSet<usize> {
    let mut open: Vec<usize> = roots.copied().collect();
    let mut met = BTreeSet::new();
    while let Some(index) = open.pop() {
        if let Some(node) = gltf.json.nodes.get(index).filter(|_| met.insert(index)) {
            open.extend(&node.children);
        }
    }
    met
}

/// Gathers the whole numbers that stand under `key`, at any depth.
fn numbers_of(key: &str, value: &Value, found: &mut BTreeSet<usize>) {
    match value {
        Value::Object(map) => numbers_below(key, map, found),
        Value::Array(list) => list.iter().for_each(|one| numbers_of(key, one, found)),
        _ => {}
    }
}

fn numbers_below(key: &str, map: &Map<String, Value>, found: &mut BTreeSet<usize>) {
    for (name, value) in map {
        if name == key {
            found.extend(value.as_u64().map(|number| number as usize));
        }
        numbers_of(key, value, found);
    }
}
