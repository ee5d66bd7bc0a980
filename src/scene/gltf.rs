//! Scenes from glTF 2.0 and GLB.
//!
//! Of a material its base colour counts: factor, texture (nearest texel; KHR_texture_transform goes into the texture
//! coordinates here), vertex colours, alpha. What else it holds is named in one warning. Node transforms are composed
//! in f64 from the JSON's own numbers. Skins and morph targets stay as modelled.

use super::assembly::{Assembly, Piece, decode_image};
use super::camera::{Camera, Projection};
use super::gltf_document::{Gltf, Light, Node, Primitive, TextureRef, TextureTransform};
use super::{AlphaMode, Material, NamedCamera, PunctualKind, PunctualLight, Scene, Wrap};
use crate::error::Result;
use crate::warning::Warning;
use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3, DVec4};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;

/// Extensions that a scene can do without: pictures in other formats, materials, and what moves or describes.
const DISPENSABLE: [&str; 8] = [
    "KHR_materials_",
    "EXT_texture_",
    "KHR_texture_",
    "MSFT_texture_",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_xmp",
    "KHR_animation",
];

/// Reads `bytes`, the content of `path`.
pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Scene> {
    let gltf = Gltf::read(path, bytes)?;
    let json = &gltf.json;
    if let Some(needed) = json
        .extensions_required
        .iter()
        .find(|e| !DISPENSABLE.iter().any(|d| e.starts_with(d)))
    {
        return Err(gltf.error(
            "extensionsRequired",
            format!("the file needs {needed}, which this program does not read"),
            "export it again without that extension (mesh compression, instancing)",
        ));
    }

    let mut loader = Loader {
        gltf: &gltf,
        scene: Scene::default(),
        assembly: Assembly::default(),
        uses: Vec::new(),
        left_out: BTreeMap::new(),
    };
    loader.materials()?;
    loader.nodes()?;
    loader.finish()
}

struct Loader<'a> {
    gltf: &'a Gltf,
    scene: Scene,
    assembly: Assembly,
    /// The base colour texture of each material, with its transform.
    uses: Vec<Option<TextureUse>>,
    /// What the file holds and the scene does not: how often.
    left_out: BTreeMap<String, usize>,
}

#[derive(Clone, Copy)]
struct TextureUse {
    set: u32,
    offset: DVec2,
    rotation: f64,
    scale: DVec2,
}

impl TextureUse {
    /// KHR_texture_transform: scale, then rotation, then offset.
    fn apply(&self, uv: DVec2) -> DVec2 {
        let (sin, cos) = self.rotation.sin_cos();
        let uv = uv * self.scale;
        DVec2::new(cos * uv.x + sin * uv.y, cos * uv.y - sin * uv.x) + self.offset
    }
}

impl Loader<'_> {
    fn leave_out(&mut self, what: impl Into<String>) {
        *self.left_out.entry(what.into()).or_default() += 1;
    }

    /// The extension `name`, if it is there.
    fn extension<T: DeserializeOwned>(
        &self,
        all: &Map<String, Value>,
        name: &str,
        by: &str,
    ) -> Result<Option<T>> {
        all.get(name)
            .map(|value| {
                T::deserialize(value).map_err(|e| {
                    self.gltf.error(
                        format_args!("{by}.extensions.{name}"),
                        e.to_string(),
                        "export the file again",
                    )
                })
            })
            .transpose()
    }

    fn materials(&mut self) -> Result<()> {
        let json = &self.gltf.json;
        // Texture index in the file -> in the scene; `None` for one that could not be read.
        let mut textures: BTreeMap<usize, Option<usize>> = BTreeMap::new();
        for (i, entry) in json.materials.iter().enumerate() {
            let by = format!("materials[{i}]");
            let pbr = &entry.pbr_metallic_roughness;
            for (present, what) in [
                (pbr.metallic_factor.unwrap_or(1.0) > 0.0, "metallic"),
                (
                    pbr.metallic_roughness_texture.is_some(),
                    "metallic-roughness texture",
                ),
                (entry.normal_texture.is_some(), "normal texture"),
                (entry.occlusion_texture.is_some(), "occlusion texture"),
                (
                    entry.emissive_texture.is_some()
                        || entry.emissive_factor.iter().any(|&e| e > 0.0),
                    "emission",
                ),
            ] {
                if present {
                    self.leave_out(what);
                }
            }
            let mut transmissive = false;
            for (name, value) in &entry.extensions {
                transmissive |= name == "KHR_materials_transmission"
                    && value
                        .get("transmissionFactor")
                        .and_then(Value::as_f64)
                        .unwrap_or(0.0)
                        > 0.0;
                self.leave_out(name);
            }

            let [r, g, b, alpha] = pbr.base_color_factor.unwrap_or([1.0; 4]);
            let cutoff = entry.alpha_cutoff.unwrap_or(0.5);
            for (what, value) in [
                ("baseColorFactor", r),
                ("baseColorFactor", g),
                ("baseColorFactor", b),
                ("baseColorFactor", alpha),
            ] {
                if !(0.0..=1.0).contains(&value) {
                    return Err(self.gltf.error(
                        format_args!("{by}.pbrMetallicRoughness.{what}"),
                        format!("it is {value}, outside 0 to 1"),
                        "give the material a base colour that reflects no more than arrives",
                    ));
                }
            }
            let alpha_mode = match entry.alpha_mode.as_deref() {
                None | Some("OPAQUE") => AlphaMode::Opaque,
                Some("MASK") => AlphaMode::Mask { cutoff },
                Some("BLEND") => AlphaMode::Blend,
                Some(other) => {
                    return Err(self.gltf.error(
                        format_args!("{by}.alphaMode"),
                        format!("there is no mode `{other}`"),
                        "use OPAQUE, MASK or BLEND",
                    ));
                }
            };

            let mut texture = None;
            let mut used = None;
            if let Some(reference) = &pbr.base_color_texture {
                used = Some(self.texture_use(reference, &by)?);
                texture = match textures.get(&reference.index) {
                    Some(&known) => known,
                    None => {
                        let index = self.texture(reference.index, &by)?;
                        textures.insert(reference.index, index);
                        index
                    }
                };
            }
            self.uses.push(used);
            self.scene.materials.push(Material {
                name: entry
                    .name
                    .clone()
                    .unwrap_or_else(|| format!("material {i}")),
                base_color: DVec3::new(r, g, b),
                alpha,
                texture,
                alpha_mode,
                transmissive,
            });
        }
        // What primitives without a material get (glTF 2.0, 3.7.2.1), last so that the file's own keep their numbers.
        self.uses.push(None);
        self.scene.materials.push(Material {
            name: "default".into(),
            base_color: DVec3::ONE,
            alpha: 1.0,
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            transmissive: false,
        });
        Ok(())
    }

    fn texture_use(&self, reference: &TextureRef, by: &str) -> Result<TextureUse> {
        let transform: TextureTransform = self
            .extension(&reference.extensions, "KHR_texture_transform", by)?
            .unwrap_or_default();
        Ok(TextureUse {
            set: transform.tex_coord.unwrap_or(reference.tex_coord),
            offset: transform.offset.into(),
            rotation: transform.rotation,
            scale: transform.scale.unwrap_or([1.0; 2]).into(),
        })
    }

    /// Decodes a texture into the scene. One that cannot be read is a warning: the scene's shape is there without it.
    fn texture(&mut self, index: usize, by: &str) -> Result<Option<usize>> {
        let gltf = self.gltf;
        let entry = gltf.get(
            &gltf.json.textures,
            "textures",
            index,
            format_args!("{by}.baseColorTexture"),
        )?;
        let by = format!("textures[{index}]");
        let wrap = |mode: Option<u32>| match mode {
            Some(33_071) => Wrap::Clamp,
            Some(33_648) => Wrap::Mirror,
            _ => Wrap::Repeat,
        };
        let wrap = match entry.sampler {
            Some(sampler) => {
                let sampler = gltf.get(&gltf.json.samplers, "samplers", sampler, &by)?;
                [wrap(sampler.wrap_s), wrap(sampler.wrap_t)]
            }
            None => [Wrap::Repeat; 2],
        };
        let Some(source) = entry.source else {
            self.scene.warnings.push(Warning::UnsupportedTextureFormat {
                place: format!("{}, {by}", gltf.path.display()),
                extensions: entry.extensions.keys().cloned().collect(),
            });
            return Ok(None);
        };
        let image = gltf.get(&gltf.json.images, "images", source, &by)?;
        let place = format!("images[{source}]");
        let name = entry.name.clone().or_else(|| image.name.clone());
        let (name, bytes) = match (&image.uri, image.buffer_view) {
            (Some(uri), _) if uri.starts_with("data:") => (
                name.unwrap_or_else(|| place.clone()),
                gltf.fetch(uri, &place),
            ),
            (Some(uri), _) => (uri.clone(), gltf.fetch(uri, &place)),
            (None, Some(view)) => (
                name.unwrap_or_else(|| place.clone()),
                gltf.view(view, &place).map(<[u8]>::to_vec),
            ),
            (None, None) => (
                place.clone(),
                Err(gltf.error(&place, "it names no picture", "")),
            ),
        };
        let picture = bytes.and_then(|bytes| {
            decode_image(&name, &bytes, wrap)
                .map_err(|problem| gltf.error(&place, problem, "save the picture as PNG or JPEG"))
        });
        Ok(match picture {
            Ok(picture) => {
                self.scene.textures.push(picture);
                Some(self.scene.textures.len() - 1)
            }
            Err(error) => {
                self.scene.warnings.push(Warning::MissingTexture {
                    problem: error.problem(),
                    remedy: error.remedy(),
                });
                None
            }
        })
    }

    /// Walks the node tree from the scene's roots.
    fn nodes(&mut self) -> Result<()> {
        let gltf = self.gltf;
        let json = &gltf.json;
        let mut stack: Vec<(usize, DAffine3, String)> = Vec::new();
        let roots: Vec<usize> = match json.scene {
            Some(scene) => gltf
                .get(&json.scenes, "scenes", scene, "scene")?
                .nodes
                .clone(),
            None => match json.scenes.first() {
                Some(scene) => scene.nodes.clone(),
                None => {
                    let mut is_child = vec![false; json.nodes.len()];
                    for &child in json.nodes.iter().flat_map(|n| &n.children) {
                        if let Some(c) = is_child.get_mut(child) {
                            *c = true;
                        }
                    }
                    (0..json.nodes.len()).filter(|&n| !is_child[n]).collect()
                }
            },
        };
        // A stack gives depth first; reversed, so that things come in the file's order.
        stack.extend(
            roots
                .iter()
                .rev()
                .map(|&n| (n, DAffine3::IDENTITY, "scenes".to_owned())),
        );
        let mut visited = vec![false; json.nodes.len()];
        while let Some((index, parent, by)) = stack.pop() {
            let node = gltf.get(&json.nodes, "nodes", index, &by)?;
            let place = format!("nodes[{index}]");
            if std::mem::replace(&mut visited[index], true) {
                return Err(gltf.error(
                    &place,
                    "it is in the tree twice, or below itself",
                    "export the scene again",
                ));
            }
            let to_scene = parent * self.transform(node, &place)?;
            if let Some(mesh) = node.mesh {
                if node.skin.is_some() {
                    self.leave_out("skin");
                }
                if node.extensions.contains_key("EXT_mesh_gpu_instancing") {
                    self.leave_out("EXT_mesh_gpu_instancing");
                }
                let mesh_entry = gltf.get(&json.meshes, "meshes", mesh, &place)?;
                for (i, primitive) in mesh_entry.primitives.iter().enumerate() {
                    let named = mesh_entry
                        .name
                        .as_deref()
                        .map(|n| format!(" ({n})"))
                        .unwrap_or_default();
                    let place = format!("meshes[{mesh}]{named}.primitives[{i}]");
                    if let Some(piece) = self.piece(primitive, &place)? {
                        let full = || format!("{}, {place}", gltf.path.display());
                        self.assembly.add(&piece, to_scene, &full)?;
                    }
                }
            }
            if let Some(camera) = node.camera {
                self.camera(camera, node, to_scene, &place)?;
            }
            if let Some(reference) = node.extensions.get("KHR_lights_punctual") {
                self.light(reference, node, to_scene, &place)?;
            }
            stack.extend(
                node.children
                    .iter()
                    .rev()
                    .map(|&child| (child, to_scene, place.clone())),
            );
        }
        Ok(())
    }

    fn transform(&self, node: &Node, place: &str) -> Result<DAffine3> {
        let local = match node.matrix {
            Some(m) => DAffine3 {
                matrix3: DMat3::from_cols(
                    DVec3::new(m[0], m[1], m[2]),
                    DVec3::new(m[4], m[5], m[6]),
                    DVec3::new(m[8], m[9], m[10]),
                ),
                translation: DVec3::new(m[12], m[13], m[14]),
            },
            None => {
                let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
                if !rotation.is_finite() || rotation.length_squared() == 0.0 {
                    return Err(self.gltf.error(
                        format_args!("{place}.rotation"),
                        "it is no rotation",
                        "export the scene again",
                    ));
                }
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
            Err(self.gltf.error(
                place,
                "its transform has a number that is not finite",
                "export the scene again",
            ))
        }
    }

    /// A primitive's triangles; `None` for points and lines.
    fn piece(&mut self, primitive: &Primitive, place: &str) -> Result<Option<Piece>> {
        let gltf = self.gltf;
        let mode = primitive.mode.unwrap_or(4);
        if mode < 4 {
            self.leave_out("points or lines");
            return Ok(None);
        }
        if primitive
            .extensions
            .contains_key("KHR_draco_mesh_compression")
        {
            return Err(gltf.error(
                place,
                "its geometry is compressed (KHR_draco_mesh_compression)",
                "export without mesh compression",
            ));
        }
        if !primitive.targets.is_empty() {
            self.leave_out("morph targets");
        }
        let attribute = |name: &str, widths: &[usize]| {
            primitive
                .attributes
                .get(name)
                .map(|index| {
                    let by = format!("{place}.attributes.{name}");
                    let index = index.as_u64().unwrap_or(u64::MAX) as usize;
                    gltf.numbers(index, widths, &by)
                })
                .transpose()
        };
        let triples = |numbers: (usize, Vec<f64>)| -> Vec<DVec3> {
            numbers
                .1
                .chunks_exact(numbers.0)
                .map(|c| DVec3::new(c[0], c[1], c[2]))
                .collect()
        };
        let Some(positions) = attribute("POSITION", &[3])?.map(triples) else {
            return Err(gltf.error(place, "it has no POSITION", "export the scene again"));
        };
        let normals = attribute("NORMAL", &[3])?.map(triples).unwrap_or_default();
        let (width, numbers) = attribute("COLOR_0", &[3, 4])?.unwrap_or((4, Vec::new()));
        let colors: Vec<DVec4> = numbers
            .chunks_exact(width)
            .map(|c| DVec4::new(c[0], c[1], c[2], c.get(3).copied().unwrap_or(1.0)))
            .collect();
        let material = primitive.material.unwrap_or(self.uses.len() - 1);
        gltf.get(&self.uses, "materials", material, place)?;
        let mut uvs = Vec::new();
        if let Some(used) = self.uses[material]
            && let Some((width, numbers)) = attribute(&format!("TEXCOORD_{}", used.set), &[2])?
        {
            uvs = numbers
                .chunks_exact(width)
                .map(|c| used.apply(DVec2::new(c[0], c[1])))
                .collect();
        }
        let lengths = [
            ("NORMAL", normals.len()),
            ("COLOR_0", colors.len()),
            ("TEXCOORD", uvs.len()),
        ];
        if let Some((name, n)) = lengths
            .into_iter()
            .find(|&(_, n)| n != 0 && n != positions.len())
        {
            return Err(gltf.error(
                place,
                format!("{name} has {n} elements, POSITION {}", positions.len()),
                "the file is damaged: export it again",
            ));
        }

        let indices = match primitive.indices {
            Some(index) => gltf.indices(index, &format!("{place}.indices"))?,
            None => (0..positions.len() as u32).collect(),
        };
        let triangles = match mode {
            4 => indices
                .chunks_exact(3)
                .map(|t| [t[0], t[1], t[2]])
                .collect(),
            // Every second triangle of a strip is wound the other way (glTF 2.0, 3.7.2.1).
            5 => indices
                .windows(3)
                .enumerate()
                .map(|(i, t)| {
                    if i % 2 == 0 {
                        [t[0], t[1], t[2]]
                    } else {
                        [t[0], t[2], t[1]]
                    }
                })
                .collect(),
            6 => indices
                .get(1..)
                .unwrap_or_default()
                .windows(2)
                .map(|t| [t[0], t[1], indices[0]])
                .collect(),
            _ => {
                return Err(gltf.error(
                    place,
                    format!("there is no primitive mode {mode}"),
                    "export the scene again",
                ));
            }
        };
        Ok(Some(Piece {
            positions,
            normals,
            uvs,
            colors,
            triangles,
            material: material as u32,
        }))
    }

    fn camera(&mut self, index: usize, node: &Node, to_scene: DAffine3, place: &str) -> Result<()> {
        let entry = self
            .gltf
            .get(&self.gltf.json.cameras, "cameras", index, place)?;
        let place = format!("cameras[{index}]");
        let wrong = |problem: String| self.gltf.error(&place, problem, "export the camera again");
        let projection = match (&entry.perspective, &entry.orthographic) {
            (Some(p), _) if p.yfov > 0.0 && p.yfov < std::f64::consts::PI => {
                Projection::Perspective { fov_y: p.yfov }
            }
            (Some(p), _) => return Err(wrong(format!("yfov is {}, outside 0 to pi", p.yfov))),
            (None, Some(o)) if o.ymag.abs() > 0.0 => Projection::Orthographic {
                height: 2.0 * o.ymag.abs(),
            },
            (None, Some(_)) => return Err(wrong("ymag is 0".into())),
            (None, None) => return Err(wrong("it is neither perspective nor orthographic".into())),
        };
        let forward = to_scene.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
        let up = to_scene.transform_vector3(DVec3::Y).normalize_or_zero();
        if forward == DVec3::ZERO || up.cross(forward) == DVec3::ZERO {
            return Err(wrong("its node is squashed flat".into()));
        }
        let name = node.name.clone().or_else(|| entry.name.clone());
        self.scene.cameras.push(NamedCamera {
            name: name.unwrap_or_else(|| format!("camera {index}")),
            camera: Camera {
                eye: to_scene.translation,
                forward,
                up,
                projection,
                shift: DVec2::ZERO,
            },
        });
        Ok(())
    }

    fn light(
        &mut self,
        reference: &Value,
        node: &Node,
        to_scene: DAffine3,
        place: &str,
    ) -> Result<()> {
        let gltf = self.gltf;
        let lights: Vec<Light> = match gltf
            .json
            .extensions
            .get("KHR_lights_punctual")
            .and_then(|e| e.get("lights"))
        {
            Some(list) => Vec::deserialize(list).map_err(|e| {
                gltf.error(
                    "extensions.KHR_lights_punctual",
                    e.to_string(),
                    "export the file again",
                )
            })?,
            None => Vec::new(),
        };
        let index = reference
            .get("light")
            .and_then(Value::as_u64)
            .unwrap_or(u64::MAX) as usize;
        let light = gltf.get(&lights, "lights", index, place)?;
        let place = format!("lights[{index}]");
        let (inner, outer) = (
            light.spot.inner_cone_angle.unwrap_or(0.0),
            light
                .spot
                .outer_cone_angle
                .unwrap_or(std::f64::consts::FRAC_PI_4),
        );
        let kind = match light.r#type.as_str() {
            "directional" => PunctualKind::Directional,
            "point" => PunctualKind::Point,
            "spot" => PunctualKind::Spot { inner, outer },
            other => {
                let problem = format!("there is no type `{other}`");
                return Err(gltf.error(place, problem, "use directional, point or spot"));
            }
        };
        let color = DVec3::from(light.color.unwrap_or([1.0; 3])) * light.intensity.unwrap_or(1.0);
        let direction = to_scene.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
        if !(color.min_element() >= 0.0 && color.is_finite()) || direction == DVec3::ZERO {
            return Err(gltf.error(
                place,
                "its colour, intensity or direction is not valid",
                "export the light again",
            ));
        }
        let name = node.name.clone().or_else(|| light.name.clone());
        self.scene.lights.push(PunctualLight {
            name: name.unwrap_or_else(|| format!("light {index}")),
            color,
            position: to_scene.translation,
            direction,
            kind,
        });
        Ok(())
    }

    fn finish(mut self) -> Result<Scene> {
        let file = self.gltf.path.display().to_string();
        if !self.left_out.is_empty() {
            self.scene
                .warnings
                .push(Warning::IgnoredMaterialProperties {
                    file: file.clone(),
                    properties: self.left_out,
                });
        }
        self.scene.mesh = self.assembly.finish(&file, &mut self.scene.warnings)?;
        let last = self.scene.materials.len() - 1;
        if !self
            .scene
            .mesh
            .triangles
            .iter()
            .any(|t| t.material as usize == last)
            && last > 0
        {
            self.scene.materials.pop();
        }
        Ok(self.scene)
    }
}
