//! Reflectances of materials by name: the table `[[material]]` of a scene file.

use super::filling::Wrong;
use super::share::Share;
use super::{AlphaMode, Material, Scene};
use crate::error::Result;
use crate::warning::Warning;
use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::Path;

/// How much light a material reflects, whatever the mesh says: it takes the place of base colour, texture and the vertices' colours.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialTable {
    /// The name of a material of the mesh, or else of an object or group, whose faces it then is of.
    name: String,
    /// Diffuse reflectance, a number or linear Rec. 709.
    reflectance: Share,
}

/// Reads the tables of `scene_file` into the scene; `wrong` names a key of one of them.
pub(super) fn read(
    tables: Vec<MaterialTable>,
    scene_file: &Path,
    scene: &mut Scene,
    wrong: Wrong,
) -> Result<()> {
    for (i, table) in tables.iter().enumerate() {
        let wrong =
            |problem: String, remedy: &str| wrong(&format!("material[{i}].name"), problem, remedy);
        let name = &table.name;
        if tables[..i].iter().any(|before| before.name == *name) {
            let problem = format!("there is a table for `{name}` already");
            return Err(wrong(problem, "put both into one table"));
        }
        let triangles = scene.triangles_named(name);
        let is_material = scene.materials.iter().any(|m| m.name == *name);
        if triangles.is_empty() && !is_material {
            let remedy = match scene.nearest_name(name) {
                Some(near) => format!("did you mean `{near}`?"),
                None => {
                    "`tyndall daylight --grid floor=NAME` lists the names that there are".into()
                }
            };
            let problem = format!("the scene has no material and no object `{name}`");
            return Err(wrong(problem, &remedy));
        }
        if triangles.is_empty() {
            scene.warnings.push(Warning::Mended {
                problem: format!(
                    "{}, material[{name}]: no triangle has the material",
                    scene_file.display()
                ),
                instead: "the reflectance is that of nothing".into(),
            });
        }
        let is_pane = |material: &Material| material.pane.is_some();
        let is_glass = match is_material {
            true => (scene.materials.iter()).any(|m| m.name == *name && is_pane(m)),
            false => (triangles.iter()).all(|t| is_pane(scene.material_of(*t))),
        };
        if is_glass {
            let problem = format!("`{name}` is glass, which has no reflectance here");
            let remedy = "say in a [[pane]] table what it lets through: transmittance";
            return Err(wrong(problem, remedy));
        }
        let reflectance = table.reflectance.rgb();
        match is_material {
            true => scene.reflect_by_material(name, reflectance),
            false => scene.reflect_by_object(name, &triangles, reflectance),
        }
    }
    Ok(())
}

impl Scene {
    /// Gives the materials of a name a reflectance.
    fn reflect_by_material(&mut self, name: &str, reflectance: DVec3) {
        let is_own: Vec<bool> = self.materials.iter().map(|m| m.name == name).collect();
        for index in (0..is_own.len()).filter(|i| is_own[*i]) {
            self.materials[index] = self.reflecting(index, reflectance);
            if self.no_material == Some(index as u32) {
                self.no_material = None;
            }
        }
        self.whiten(|material| is_own[material as usize]);
    }

    /// Gives the faces of an object materials of that reflectance, but for glass.
    fn reflect_by_object(&mut self, name: &str, triangles: &[u32], reflectance: DVec3) {
        let first = self.materials.len() as u32;
        // The numbers of the materials that were and that are.
        let mut made = std::collections::HashMap::new();
        for triangle in triangles {
            let old = self.mesh.triangles[*triangle as usize].material;
            if self.materials[old as usize].pane.is_some() {
                continue;
            }
            let new = *made.entry(old).or_insert_with(|| {
                let material = self.reflecting(old as usize, reflectance);
                self.materials.push(Material {
                    name: name.to_owned(),
                    ..material
                });
                self.materials.len() as u32 - 1
            });
            self.mesh.triangles[*triangle as usize].material = new;
        }
        self.whiten(|material| material >= first);
    }

    /// A material with another reflectance, whose holes stay.
    fn reflecting(&mut self, index: usize, reflectance: DVec3) -> Material {
        let material = &self.materials[index];
        let texture = match (material.texture, material.alpha_mode) {
            (Some(texture), AlphaMode::Mask { .. } | AlphaMode::Blend) => {
                let mut white = self.textures[texture].clone();
                (white.pixels.iter_mut()).for_each(|p| *p = [255, 255, 255, p[3]]);
                self.textures.push(white);
                Some(self.textures.len() - 1)
            }
            _ => None,
        };
        Material {
            base_color: reflectance,
            texture,
            ..material.clone()
        }
    }

    fn material_of(&self, triangle: u32) -> &Material {
        let number = self.mesh.triangles[triangle as usize].material;
        &self.materials[number as usize]
    }

    /// Takes the colours of vertices away from the triangles of some materials; their alpha stays.
    fn whiten(&mut self, is_own: impl Fn(u32) -> bool) {
        let colors = &mut self.mesh.colors;
        if colors.is_empty() {
            return;
        }
        for triangle in self.mesh.triangles.iter().filter(|t| is_own(t.material)) {
            for vertex in triangle.vertices {
                colors[vertex as usize] = DVec3::ONE.extend(colors[vertex as usize].w);
            }
        }
    }
}

impl Material {
    /// An opaque material of a reflectance, linear Rec. 709.
    pub fn of(name: &str, reflectance: DVec3) -> Self {
        Material {
            name: name.to_owned(),
            base_color: reflectance,
            alpha: 1.0,
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            pane: None,
        }
    }
}
