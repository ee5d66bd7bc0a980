//! The objects that a mesh consists of, by name.

use super::Scene;
use crate::error::nearest;
use std::collections::BTreeSet;
use std::ops::Range;

/// Triangles of one object of the mesh's file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Names from the outermost group to the object itself: of glTF the nodes from the root and the mesh, of OBJ `o` and `g`. Empty
    /// where the file has none.
    pub names: Vec<String>,
    /// Indices into [`super::Mesh::triangles`].
    pub triangles: Range<u32>,
}

impl Scene {
    /// The triangles of all objects, groups and materials of a name, in order, each once; empty where nothing has it.
    pub fn triangles_named(&self, name: &str) -> Vec<u32> {
        let mut is_own = vec![false; self.mesh.triangles.len()];
        let named = |part: &&Part| part.names.iter().any(|own| own == name);
        for part in self.parts.iter().filter(named) {
            for triangle in part.triangles.clone() {
                is_own[triangle as usize] = true;
            }
        }
        for (own, triangle) in is_own.iter_mut().zip(&self.mesh.triangles) {
            *own |= self.materials[triangle.material as usize].name == name;
        }
        (0..)
            .zip(is_own)
            .filter(|(_, own)| *own)
            .map(|(i, _)| i)
            .collect()
    }

    /// The names of all objects, groups and materials that a face has, in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let mut is_used = vec![false; self.materials.len()];
        for triangle in &self.mesh.triangles {
            is_used[triangle.material as usize] = true;
        }
        let used = self.materials.iter().zip(is_used).filter(|(_, used)| *used);
        let parts = self.parts.iter().flat_map(|part| &part.names);
        let all = parts.chain(used.map(|(material, _)| &material.name));
        let all: BTreeSet<&str> = all.map(String::as_str).collect();
        all.into_iter().filter(|name| !name.is_empty())
    }

    /// The object or material whose name is most like a word, if any is.
    pub fn nearest_name(&self, word: &str) -> Option<&str> {
        nearest(word, self.names())
    }

    /// The innermost name of the object that a triangle belongs to, or else its material's.
    pub fn name_of(&self, triangle: u32) -> &str {
        let after = self
            .parts
            .partition_point(|part| part.triangles.start <= triangle);
        let part = after.checked_sub(1).map(|i| &self.parts[i]);
        let own = part.filter(|part| part.triangles.contains(&triangle));
        let material = self.mesh.triangles[triangle as usize].material;
        let fallback = || &self.materials[material as usize].name;
        own.and_then(|part| part.names.last())
            .unwrap_or_else(fallback)
    }
}
