//! The nodes of a glTF scene: which are in it, where they stand, and whether they are seen.

use super::container::Gltf;
use super::document::{Lod, Node, Visibility};
use super::material::extension;
use super::notes::Notes;
use crate::error::Result;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use std::collections::BTreeSet;

/// So many nodes above one another give names to what is in the lowest.
const DEEPEST: usize = 32;

/// The nodes of the scene, and where all nodes of the file stand.
pub(super) struct Tree {
    /// The scene's nodes in the file's order, and whether each is seen.
    pub nodes: Vec<(usize, bool)>,
    /// Meshes that several nodes have.
    pub shared: BTreeSet<usize>,
    /// The node above each, of all nodes of the file.
    parents: Vec<Option<usize>>,
    /// From the axes of each node that is in the scene to those of the scene.
    to_scene: Vec<Option<DAffine3>>,
}

impl Tree {
    /// Walks the tree from the scene's roots.
    pub fn read(gltf: &Gltf, notes: &mut Notes) -> Result<Tree> {
        let nodes = &gltf.json.nodes;
        let mut parents = vec![None; nodes.len()];
        for (index, node) in nodes.iter().enumerate() {
            for &child in &node.children {
                if let Some(parent) = parents.get_mut(child) {
                    *parent = Some(index);
                }
            }
        }
        let mut tree = Tree {
            nodes: Vec::new(),
            shared: BTreeSet::new(),
            to_scene: vec![None; nodes.len()],
            parents,
        };
        // A stack gives depth first; reversed, so that things come in the file's order.
        let roots = tree.roots(gltf)?;
        let mut stack: Vec<(usize, Option<usize>, bool)> =
            roots.iter().rev().map(|&root| (root, None, true)).collect();
        while let Some((index, parent, seen)) = stack.pop() {
            let by = parent.map_or("scenes".to_owned(), |parent| format!("nodes[{parent}]"));
            let node = gltf.get(nodes, "nodes", index, by)?;
            let place = format!("nodes[{index}]");
            if tree.to_scene[index].is_some() {
                return Err(gltf.error(
                    &place,
                    "it is in the tree twice, or below itself",
                    "export the scene again",
                ));
            }
            let above = parent.and_then(|parent| tree.to_scene[parent]);
            tree.to_scene[index] =
                Some(above.unwrap_or(DAffine3::IDENTITY) * transform(gltf, node, &place, notes)?);
            let visibility: Option<Visibility> =
                extension(gltf, &node.extensions, "KHR_node_visibility", &place)?;
            let seen = seen && visibility.and_then(|v| v.visible).unwrap_or(true);
            tree.nodes.push((index, seen));
            let children = node.children.iter().rev();
            stack.extend(children.map(|&child| (child, Some(index), seen)));
        }
        tree.beside(gltf, notes);
        let mut met = BTreeSet::new();
        let meshes = tree
            .nodes
            .iter()
            .filter_map(|&(index, _)| nodes[index].mesh);
        tree.shared = meshes.filter(|mesh| !met.insert(*mesh)).collect();
        Ok(tree)
    }

    /// The roots of the file's default scene, else of its first, else all that are below no other.
    fn roots(&self, gltf: &Gltf) -> Result<Vec<usize>> {
        let json = &gltf.json;
        if let Some(scene) = json.scene {
            return Ok(gltf
                .get(&json.scenes, "scenes", scene, "scene")?
                .nodes
                .clone());
        }
        if let Some(scene) = json.scenes.first() {
            return Ok(scene.nodes.clone());
        }
        let mut is_root: Vec<bool> = self.parents.iter().map(Option::is_none).collect();
        // Coarser levels of detail stand beside the tree.
        for (i, node) in json.nodes.iter().enumerate() {
            let lod: Option<Lod> =
                extension(gltf, &node.extensions, "MSFT_lod", &format!("nodes[{i}]"))?;
            for coarser in lod.map(|lod| lod.ids).unwrap_or_default() {
                if let Some(root) = is_root.get_mut(coarser) {
                    *root = false;
                }
            }
        }
        Ok((0..json.nodes.len()).filter(|&n| is_root[n]).collect())
    }

    /// Finds where the nodes beside the scene stand: skeletons may. One that stands nowhere is an error only if it is needed.
    fn beside(&mut self, gltf: &Gltf, notes: &mut Notes) {
        let nodes = &gltf.json.nodes;
        let roots = (0..nodes.len()).filter(|&n| self.parents[n].is_none());
        let mut open: Vec<usize> = roots.collect();
        let mut met = vec![false; nodes.len()];
        while let Some(index) = open.pop() {
            let node = &nodes[index];
            if std::mem::replace(&mut met[index], true) {
                continue;
            }
            if self.to_scene[index].is_none() {
                let above = self.parents[index].and_then(|parent| self.to_scene[parent]);
                let own = transform(gltf, node, "", notes).ok();
                self.to_scene[index] = own.map(|own| above.unwrap_or(DAffine3::IDENTITY) * own);
            }
            // Each node once, by the parent that is held to be its own.
            let children = node.children.iter().copied();
            open.extend(children.filter(|&child| self.parents.get(child) == Some(&Some(index))));
        }
    }

    /// The names of the nodes from the root down to one with a mesh, then the mesh's own. Of very deep trees the lowest nodes count.
    pub fn names(&self, gltf: &Gltf, index: usize) -> Vec<String> {
        let nodes = &gltf.json.nodes;
        let above = std::iter::successors(Some(index), |node| self.parents[*node]);
        let above = above
            .take(DEEPEST)
            .filter_map(|node| nodes[node].name.clone());
        let mut names: Vec<String> = above.collect();
        names.reverse();
        let mesh = nodes[index]
            .mesh
            .and_then(|mesh| gltf.json.meshes.get(mesh));
        names.extend(mesh.and_then(|mesh| mesh.name.clone()));
        names.dedup();
        names
    }

    /// From the axes of a node to those of the scene, whether it is in the scene or, like some skeletons, beside it.
    pub fn to_scene(&self, gltf: &Gltf, index: usize, by: &str) -> Result<DAffine3> {
        let known = *gltf.get(&self.to_scene, "nodes", index, by)?;
        known.ok_or_else(|| {
            let problem = format!("nodes[{index}] stands nowhere, or below itself");
            gltf.error(by, problem, "export the scene again")
        })
    }
}

/// From a node's own axes to those of the node above.
fn transform(gltf: &Gltf, node: &Node, place: &str, notes: &mut Notes) -> Result<DAffine3> {
    let local = match node.matrix {
        Some(m) => {
            if node.translation.is_some() || node.rotation.is_some() || node.scale.is_some() {
                notes.leave_out("translation, rotation and scale of a node that has a matrix");
            }
            if [m[3], m[7], m[11], m[15] - 1.0]
                .iter()
                .any(|x| x.abs() > 1e-3)
            {
                notes.leave_out("last row of a node's matrix that is not 0 0 0 1");
            }
            DAffine3 {
                matrix3: DMat3::from_cols(
                    DVec3::new(m[0], m[1], m[2]),
                    DVec3::new(m[4], m[5], m[6]),
                    DVec3::new(m[8], m[9], m[10]),
                ),
                translation: DVec3::new(m[12], m[13], m[14]),
            }
        }
        None => {
            let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
            if !rotation.is_finite() || rotation.length_squared() == 0.0 {
                return Err(gltf.error(
                    format_args!("{place}.rotation"),
                    "it is no rotation",
                    "export the scene again",
                ));
            }
            notes.leave_out_length(rotation);
            DAffine3::from_scale_rotation_translation(
                node.scale.unwrap_or([1.0; 3]).into(),
                rotation.normalize(),
                node.translation.unwrap_or_default().into(),
            )
        }
    };
    if local.is_finite() {
        Ok(local)
    } else {
        Err(gltf.error(
            place,
            "its transform has a number that is not finite",
            "export the scene again",
        ))
    }
}
