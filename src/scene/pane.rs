//! What makes a material a pane: the table `[[pane]]` of a scene file, and what it says of a material.

use super::assembly::decode_image;
use super::files::{SceneFiles, file_of};
use super::filling::Wrong;
use super::glass::MOST_PANES;
use super::share::Share;
use super::{Scene, Texture, Wrap};
use crate::error::{Error, Result, nearest};
use crate::file;
use crate::warning::Warning;
use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;
use std::borrow::Cow;
use std::path::Path;

/// The most texels of a picture each way; of finer ones the mean of so many stands for them.
pub(super) const FINEST: u32 = 512;

/// Glass: a material that lets light straight through, by its angle ([`super::glass`]), and shows nothing of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Pane {
    /// Transmittance at normal incidence, linear Rec. 709, 0 to 1. What follows multiplies it.
    pub transmittance: DVec3,
    /// Whether the base colour, its texture and the vertices' colours do, as glTF has it.
    pub is_tinted: bool,
    /// Index into [`Scene::textures`]: one whose red channel does, without decoding (glTF's transmissionTexture).
    pub red: Option<usize>,
    /// The same: a picture whose colours do, linear after decoding sRGB.
    pub image: Option<usize>,
    /// Panes one behind the other that all of this is the transmittance of, 1 to [`MOST_PANES`].
    pub count: u32,
}

impl Pane {
    /// One clear pane.
    pub const CLEAR: Pane = Pane {
        transmittance: DVec3::ONE,
        is_tinted: false,
        red: None,
        image: None,
        count: 1,
    };
}

/// A material that is glass. Where the mesh says what it lets through (KHR_materials_transmission), both multiply.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PaneTable {
    /// The material's name in the mesh.
    material: String,
    /// Transmittance at normal incidence, a number or linear Rec. 709; 1 when absent.
    transmittance: Option<Share>,
    /// A picture (PNG or JPEG, relative to this file) that multiplies it, laid by the mesh's texture coordinates; linear light after decoding
    /// sRGB.
    image: Option<String>,
    /// Panes one behind the other, which together let that much through; 1 when absent.
    #[schemars(range(min = 1, max = 3))]
    panes: Option<u32>,
}

/// Reads the tables of `scene_file` into the materials that they name; `wrong` names a key of one of them.
pub(super) fn read(
    tables: Vec<PaneTable>,
    scene_file: &Path,
    within: Option<SceneFiles>,
    scene: &mut Scene,
    wrong: Wrong,
) -> Result<()> {
    for (i, table) in tables.iter().enumerate() {
        let wrong = |key: &str, problem: String, remedy: &str| {
            wrong(&format!("pane[{i}].{key}"), problem, remedy)
        };
        let name = &table.material;
        if tables[..i].iter().any(|before| before.material == *name) {
            let problem = format!("there is a table for `{name}` already");
            return Err(wrong("material", problem, "put both into one table"));
        }
        table.read(scene_file, within, scene, &wrong)?;
    }
    Ok(())
}

impl PaneTable {
    fn read(
        &self,
        scene_file: &Path,
        within: Option<SceneFiles>,
        scene: &mut Scene,
        wrong: Wrong,
    ) -> Result<()> {
        let materials = &scene.materials;
        let named: Vec<usize> = (0..materials.len())
            .filter(|k| materials[*k].name == self.material)
            .collect();
        if named.is_empty() {
            let names = materials.iter().map(|m| m.name.as_str());
            let remedy = match nearest(&self.material, names) {
                Some(near) => format!("did you mean `{near}`?"),
                None => "the scene has no materials (an OBJ has those of the MTL files that its `mtllib` lines name)".to_owned(),
            };
            let problem = format!("the scene has no material `{}`", self.material);
            return Err(wrong("material", problem, &remedy));
        }
        let mesh = &scene.mesh;
        let is_own = |material: u32| named.contains(&(material as usize));
        let own = || mesh.triangles.iter().filter(|t| is_own(t.material));
        let mend = |problem: &str, instead: &str| Warning::Mended {
            problem: format!(
                "{}, pane[{}]: {problem}",
                scene_file.display(),
                self.material
            ),
            instead: instead.to_owned(),
        };
        if own().next().is_none() {
            let warning = mend("no triangle has the material", "the pane is not there");
            scene.warnings.push(warning);
        } else if self.image.is_some() {
            let mut uvs = own().flat_map(|t| t.vertices.map(|v| mesh.uvs[v as usize]));
            if uvs.all(|uv| uv == DVec2::ZERO) {
                let what = "its triangles have no texture coordinates by which the image is laid";
                let warning = mend(what, "the image's first pixel stands for all of it");
                scene.warnings.push(warning);
            }
        }
        let image = match &self.image {
            Some(image) => {
                let texture = self.image(scene_file, within, image, wrong)?;
                if texture.pixels.iter().any(|pixel| pixel[3] < 255) {
                    let warning = mend("its image has an alpha channel", "alpha is left out");
                    scene.warnings.push(warning);
                }
                scene.textures.push(texture);
                Some(scene.textures.len() - 1)
            }
            None => None,
        };
        for index in named {
            let pane = scene.materials[index].pane.get_or_insert(Pane::CLEAR);
            pane.transmittance *= self.transmittance.map_or(DVec3::ONE, Share::rgb);
            pane.image = image;
            pane.count = self.panes.unwrap_or(1).clamp(1, MOST_PANES);
        }
        Ok(())
    }

    fn image(
        &self,
        scene_file: &Path,
        within: Option<SceneFiles>,
        image: &str,
        wrong: Wrong,
    ) -> Result<Texture> {
        let path = scene_file.with_file_name(image);
        let read = || {
            file::read(&path, file::LARGEST).map_err(|error| {
                let problem = match error {
                    Error::File { source, .. } => {
                        format!("cannot read {}: {source}", path.display())
                    }
                    error => error.problem(),
                };
                let remedy = "the name is relative to the scene file: check its spelling";
                wrong("image", problem, remedy)
            })
        };
        let bytes = match within.and_then(|files| file_of(files, image)) {
            Some(bytes) => Cow::Borrowed(bytes),
            None => Cow::Owned(read()?),
        };
        decode_image(image, &bytes, [Wrap::Repeat; 2])
            .map_err(|problem| wrong("image", problem, "save the picture as PNG or JPEG"))
    }
}
