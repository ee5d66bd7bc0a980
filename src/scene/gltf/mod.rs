//! Scenes from glTF 2.0 and GLB.
//!
//! Of a material its base colour counts: factor, texture (nearest texel; KHR_texture_transform goes into the texture
//! coordinates here), vertex colours, alpha; and its emission: factor, texture, strength. Node transforms are composed in f64 from the JSON's own numbers. Meshes are
//! morphed by the file's weights, then posed by their skins as the file leaves them. Whatever else a file holds is named in
//! a warning.
//!
//! Memory stays below a multiple of the file and what it names: about 500 bytes a byte for the JSON, 16 bytes for each
//! component of an accessor while it is read, and what [`Assembly`] and the pictures allow themselves.

mod accessor;
mod audit;
mod camera;
mod container;
mod document;
mod extension;
mod instances;
mod light;
mod material;
mod notes;
mod piece;
mod skin;
mod tree;
mod unused;
mod uri;

use super::assembly::{Assembly, Piece};
use super::text::shortened;
use super::{NamedNode, Scene};
use crate::error::Result;
use camera::Cameras;
use container::Gltf;
use document::Node;
use glam::DAffine3;
use material::Materials;
use notes::Notes;
use skin::Skin;
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;
use tree::Tree;

/// Reads `bytes`, the content of `path`.
pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Scene> {
    let mut notes = Notes::default();
    let gltf = Gltf::read(path, bytes, &mut notes)?;
    let materials = Materials::read(&gltf, &mut notes)?;
    let tree = Tree::read(&gltf, &mut notes)?;
    let lights = light::read(&gltf)?;
    unused::name(&gltf, &tree, &lights, &mut notes);
    let mut scene = Scene::default();
    let mut cameras = Cameras::default();
    let mut meshes = Meshes {
        gltf: &gltf,
        tree: &tree,
        materials: &materials,
        assembly: Assembly::of_file(bytes.len().saturating_add(gltf.size())),
        skins: BTreeMap::new(),
        pieces: BTreeMap::new(),
    };
    for &(index, seen) in &tree.nodes {
        let node = &gltf.json.nodes[index];
        let place = format!("nodes[{index}]");
        let to_scene = tree.to_scene(&gltf, index, &place)?;
        if seen {
            if node.mesh.is_some() {
                meshes.assembly.begin_part(tree.names(&gltf, index));
            }
            meshes.add(node, to_scene, &place, &mut notes)?;
            let lamp = light::of_node(&gltf, &lights, node, to_scene, &place, &mut notes)?;
            scene.lights.extend(lamp);
            if let Some(name) = &node.name {
                let instances = match node.extensions.contains_key(instances::NAME) {
                    true => instances::read(&gltf, node, &place, &mut notes)?,
                    false => vec![DAffine3::IDENTITY],
                };
                scene
                    .nodes
                    .extend(instances.iter().map(|instance| NamedNode {
                        name: name.clone(),
                        to_scene: to_scene * *instance,
                    }));
            }
        }
        if let Some(camera) = node.camera {
            cameras.add(&gltf, camera, node, to_scene, &place, &mut notes)?;
        }
    }
    cameras.name_doubles(&gltf, &mut notes);

    let file = path.display().to_string();
    scene.warnings = notes.into_warnings(&file);
    (scene.mesh, scene.parts) = meshes.assembly.finish(&file, &mut scene.warnings)?;
    scene.cameras = cameras.0;
    scene.materials = materials.list;
    scene.textures = materials.textures;
    scene.emissions = materials.emissions;
    let last = scene.materials.len() - 1;
    let is_used = |material: usize| {
        let mut triangles = scene.mesh.triangles.iter();
        triangles.any(|t| t.material as usize == material)
    };
    if last > 0 && !is_used(last) {
        scene.materials.pop();
    } else {
        scene.no_material = Some(last as u32);
    }
    Ok(scene)
}

/// The meshes of a file on their way into the scene.
struct Meshes<'a> {
    gltf: &'a Gltf<'a>,
    tree: &'a Tree,
    materials: &'a Materials,
    assembly: Assembly,
    /// What several nodes share, read once.
    skins: BTreeMap<usize, Rc<Skin>>,
    pieces: BTreeMap<usize, Rc<Pieces>>,
}

/// The primitives of a mesh that have triangles: number, name, triangles.
type Pieces = Vec<(usize, String, Piece)>;

impl Meshes<'_> {
    /// Adds a node's mesh, in each of its places.
    fn add(&mut self, node: &Node, to_scene: DAffine3, by: &str, notes: &mut Notes) -> Result<()> {
        let gltf = self.gltf;
        let Some(mesh) = node.mesh else {
            return Ok(());
        };
        let entry = gltf.get(&gltf.json.meshes, "meshes", mesh, by)?;
        let skin = node.skin.map(|skin| self.skin(skin, by)).transpose()?;
        let instances = instances::read(gltf, node, by, notes)?;
        let pieces = self.pieces(mesh, node, notes)?;
        for (i, place, piece) in pieces.iter() {
            let full = || gltf.at(place);
            let attributes = &entry.primitives[*i].attributes;
            if skin.is_none() && attributes.contains_key("JOINTS_0") {
                notes.leave_out("joints and weights of a mesh whose node has no skin");
            }
            if let Some(skin) = &skin {
                let mut posed = piece.clone();
                let primitive = &entry.primitives[*i];
                if let Some(unbound) = skin.pose(gltf, primitive, &mut posed, place)? {
                    self.assembly.count_odd(unbound);
                    self.assembly.add(&posed, DAffine3::IDENTITY, &full)?;
                    if node.extensions.contains_key(instances::NAME) {
                        notes.leave_out("instances of a mesh with a skin");
                    }
                    continue;
                }
                notes.leave_out("skin of a primitive that is not bound to joints");
            }
            self.assembly.check_room(piece, instances.len(), &full)?;
            for instance in &instances {
                self.assembly.add(piece, to_scene * *instance, &full)?;
            }
        }
        Ok(())
    }

    fn skin(&mut self, index: usize, by: &str) -> Result<Rc<Skin>> {
        if let Some(known) = self.skins.get(&index) {
            return Ok(known.clone());
        }
        let skin = Rc::new(Skin::read(self.gltf, self.tree, index, by)?);
        self.skins.insert(index, skin.clone());
        Ok(skin)
    }

    /// The primitives of a mesh as a node morphs them; kept if it does so by the mesh's own weights and others may follow.
    fn pieces(&mut self, mesh: usize, node: &Node, notes: &mut Notes) -> Result<Rc<Pieces>> {
        if let (None, Some(known)) = (&node.weights, self.pieces.get(&mesh)) {
            return Ok(known.clone());
        }
        let gltf = self.gltf;
        let entry = &gltf.json.meshes[mesh];
        let weights = node.weights.as_ref().unwrap_or(&entry.weights);
        let named = entry
            .name
            .as_deref()
            .map(|n| format!(" ({})", shortened(n)));
        let named = named.as_deref().unwrap_or("");
        let mut pieces = Vec::new();
        for (i, primitive) in entry.primitives.iter().enumerate() {
            let place = format!("meshes[{mesh}]{named}.primitives[{i}]");
            let piece = piece::read(gltf, primitive, weights, self.materials, &place, notes)?;
            if let Some(piece) = piece {
                self.assembly.check_room(&piece, 1, &|| gltf.at(&place))?;
                pieces.push((i, place, piece));
            }
        }
        let pieces = Rc::new(pieces);
        if node.weights.is_none() && self.tree.shared.contains(&mesh) {
            self.pieces.insert(mesh, pieces.clone());
        }
        Ok(pieces)
    }
}
