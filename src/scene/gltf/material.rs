//! Materials of glTF: of each its base colour counts (factor, texture, alpha), and the light that it gives. What else it holds is
//! named.

use super::container::Gltf;
use super::document::{
    EmissiveStrength, MaterialEntry, SpecularGlossiness, TextureRef, TextureTransform, Transmission,
};
use super::notes::{Notes, number, shown};
use crate::error::Result;
use crate::scene::assembly::{decode_image, most_texels};
use crate::scene::emission::MOST_LUMINANCE;
use crate::scene::text::shortened;
use crate::scene::{AlphaMode, Emission, Material, Pane, Texture, Wrap};
use crate::warning::Warning;
use glam::{DAffine2, DMat2, DVec2, DVec3};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The materials of a file, and last the one of surfaces without any.
pub(super) struct Materials {
    pub list: Vec<Material>,
    /// The texture of each by which its texture coordinates go: the base colour's, otherwise that of what it lets through, otherwise the
    /// emissive one.
    pub uses: Vec<Option<TextureUse>>,
    pub textures: Vec<Texture>,
    /// Of those that shine.
    pub emissions: BTreeMap<u32, Emission>,
}

/// Which texture coordinates a texture is read at.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct TextureUse {
    pub set: u32,
    offset: DVec2,
    rotation: f64,
    scale: DVec2,
}

impl TextureUse {
    /// KHR_texture_transform: scale, then rotation, then offset.
    pub fn apply(&self, uv: DVec2) -> DVec2 {
        let (sin, cos) = self.rotation.sin_cos();
        let uv = uv * self.scale;
        DVec2::new(cos * uv.x + sin * uv.y, cos * uv.y - sin * uv.x) + self.offset
    }

    /// From the coordinates that these have become to those of another texture, if they can be told from them.
    fn to(self, other: TextureUse) -> Option<DAffine2> {
        let affine = |used: TextureUse| DAffine2 {
            matrix2: DMat2::from_angle(-used.rotation) * DMat2::from_diagonal(used.scale),
            translation: used.offset,
        };
        let back = affine(self);
        let is_told = self.set == other.set && back.matrix2.determinant().abs() > 1e-12;
        is_told.then(|| affine(other) * back.inverse())
    }
}

/// The extension `name`, if it is there.
pub(super) fn extension<T: DeserializeOwned>(
    gltf: &Gltf,
    all: &Map<String, Value>,
    name: &str,
    by: &str,
) -> Result<Option<T>> {
    let read = |value: &Value| {
        T::deserialize(value).map_err(|e: serde_json::Error| {
            gltf.error(
                format_args!("{by}.extensions.{name}"),
                shown(&e.to_string()),
                "export the file again",
            )
        })
    };
    all.get(name).map(read).transpose()
}

/// A material in words.
fn named(i: usize, entry: &MaterialEntry) -> String {
    match &entry.name {
        Some(name) => format!("materials[{i}] ({})", shortened(name)),
        None => format!("materials[{i}]"),
    }
}

impl Materials {
    pub fn read(gltf: &Gltf, notes: &mut Notes) -> Result<Materials> {
        let mut reader = Reader {
            gltf,
            notes,
            pictures: Pictures::default(),
        };
        let (mut list, mut uses) = (Vec::new(), Vec::new());
        let mut emissions = BTreeMap::new();
        for (i, entry) in gltf.json.materials.iter().enumerate() {
            let (material, mut used) = reader.material(i, entry)?;
            if let Some(emission) = reader.emission(i, entry, &mut used)? {
                emissions.insert(i as u32, emission);
            }
            list.push(material);
            uses.push(used);
        }
        // What primitives without a material get (glTF 2.0, 3.7.2.1), last so that the file's own keep their numbers.
        uses.push(None);
        list.push(Material {
            name: "default".into(),
            base_color: DVec3::ONE,
            alpha: 1.0,
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            pane: None,
        });
        Ok(Materials {
            list,
            uses,
            emissions,
            textures: reader.pictures.textures,
        })
    }
}

/// The pictures that are decoded, each once for each way in which it goes on outside.
#[derive(Default)]
struct Pictures {
    textures: Vec<Texture>,
    /// Image and wrapping -> texture of the scene; `None` for one that could not be read.
    known: BTreeMap<(usize, [u8; 2]), Option<usize>>,
    texels: u64,
    /// Of files beside the scene's.
    bytes: usize,
}

struct Reader<'a, 'b> {
    gltf: &'a Gltf<'a>,
    notes: &'b mut Notes,
    pictures: Pictures,
}

impl Reader<'_, '_> {
    fn material(
        &mut self,
        i: usize,
        entry: &MaterialEntry,
    ) -> Result<(Material, Option<TextureUse>)> {
        let gltf = self.gltf;
        let place = named(i, entry);
        let pbr = &entry.pbr_metallic_roughness;
        let gloss: Option<SpecularGlossiness> = extension(
            gltf,
            &entry.extensions,
            "KHR_materials_pbrSpecularGlossiness",
            &place,
        )?;
        let reflective = match &gloss {
            Some(gloss) => [
                (
                    gloss.specular_factor.unwrap_or([1.0; 3]) != [0.0; 3],
                    "specular",
                ),
                (
                    gloss.specular_glossiness_texture.is_some(),
                    "specular-glossiness texture",
                ),
                (false, ""),
            ],
            None => [
                (pbr.metallic_factor.unwrap_or(1.0) > 0.0, "metallic"),
                (
                    pbr.roughness_factor.unwrap_or(1.0) < 1.0,
                    "roughness below 1",
                ),
                (
                    pbr.metallic_roughness_texture.is_some(),
                    "metallic-roughness texture",
                ),
            ],
        };
        let other = [
            (entry.normal_texture.is_some(), "normal texture"),
            (entry.occlusion_texture.is_some(), "occlusion texture"),
        ];
        for (present, what) in reflective.into_iter().chain(other) {
            if present {
                self.notes.of_material(what);
            }
        }
        let transmission: Option<Transmission> = extension(
            gltf,
            &entry.extensions,
            "KHR_materials_transmission",
            &place,
        )?;
        let transmission =
            transmission.filter(|transmission| transmission.transmission_factor != 0.0);
        if transmission.is_some() && pbr.roughness_factor.unwrap_or(1.0) > 0.0 {
            self.notes
                .of_material("roughness of a pane, which blurs what is behind it");
        }

        let (key, factor, reference) = match &gloss {
            Some(gloss) => (
                "diffuseFactor",
                gloss.diffuse_factor,
                &gloss.diffuse_texture,
            ),
            None => (
                "baseColorFactor",
                pbr.base_color_factor,
                &pbr.base_color_texture,
            ),
        };
        let factor = factor.unwrap_or([1.0; 4]);
        let [r, g, b, alpha] = std::array::from_fn(|channel| {
            let what = format!(
                "the {} of {key}",
                ["red", "green", "blue", "alpha"][channel]
            );
            self.held(factor[channel], &what, &place)
        });
        let alpha_mode = match entry.alpha_mode.as_deref() {
            None | Some("OPAQUE") => AlphaMode::Opaque,
            Some("MASK") => AlphaMode::Mask {
                cutoff: self.cutoff(entry.alpha_cutoff.unwrap_or(0.5), &place),
            },
            Some("BLEND") => AlphaMode::Blend,
            Some(other) => {
                let problem = format!("there is no alphaMode `{}`", shown(other));
                self.notes.mend(
                    gltf.at(format_args!("{place}: {problem}")),
                    "taken as OPAQUE",
                );
                AlphaMode::Opaque
            }
        };
        let mut used = None;
        let mut texture = None;
        if let Some(reference) = reference {
            used = Some(self.texture_use(reference, &place)?);
            texture = self.texture(reference.index, &place, "base colour texture")?;
        }
        let pane = match &transmission {
            Some(transmission) => self.pane(transmission, &place, &mut used)?,
            None => None,
        };
        let material = Material {
            name: entry
                .name
                .as_ref()
                .map(|name| shortened(name))
                .unwrap_or_else(|| format!("material {i}")),
            base_color: DVec3::new(r, g, b),
            alpha,
            texture,
            alpha_mode,
            pane,
        };
        Ok((material, used))
    }

    /// The light that a material gives, if it gives any. Without a base colour texture the texture coordinates go by the emissive
    /// one, which becomes `used`.
    fn emission(
        &mut self,
        i: usize,
        entry: &MaterialEntry,
        used: &mut Option<TextureUse>,
    ) -> Result<Option<Emission>> {
        let place = named(i, entry);
        let factor = std::array::from_fn(|channel| {
            let channel_name = ["red", "green", "blue"][channel];
            let what = format!("the {channel_name} of emissiveFactor");
            self.held(entry.emissive_factor[channel], &what, &place)
        });
        let extension: Option<EmissiveStrength> = extension(
            self.gltf,
            &entry.extensions,
            "KHR_materials_emissive_strength",
            &place,
        )?;
        let asked = extension.and_then(|e| e.emissive_strength).unwrap_or(1.0);
        let strength = asked.clamp(0.0, MOST_LUMINANCE);
        if strength != asked {
            let problem = format!("{place}: emissiveStrength is {}", number(asked));
            let instead = format!("held at {} cd/m2", number(strength));
            self.notes.mend(self.gltf.at(problem), instead);
        }
        let luminance = strength * DVec3::from_array(factor);
        if luminance == DVec3::ZERO {
            if entry.emissive_texture.is_some() {
                self.notes
                    .of_material("emissive texture whose factor or strength is 0");
            }
            return Ok(None);
        }
        let mut emission = Emission {
            both_sides: entry.double_sided,
            ..Emission::plain(luminance)
        };
        let Some(reference) = &entry.emissive_texture else {
            return Ok(Some(emission));
        };
        let own = self.texture_use(reference, &place)?;
        let texture = self.texture(reference.index, &place, "emissive texture")?;
        match used.get_or_insert(own).to(own) {
            Some(uvs) => {
                emission.uvs = uvs;
                emission.texture = texture;
            }
            None => {
                let what = "emissive texture on other coordinates than the base colour texture, \
                     taken as its mean";
                self.notes.of_material(what);
                emission.luminance *=
                    texture.map_or(DVec3::ONE, |t| self.pictures.textures[t].mean());
            }
        }
        Ok(Some(emission))
    }

    /// What a material lets through; a texture is read at the coordinates of the base colour's, which are the only ones.
    fn pane(
        &mut self,
        transmission: &Transmission,
        place: &str,
        used: &mut Option<TextureUse>,
    ) -> Result<Option<Pane>> {
        let factor = self.held(
            transmission.transmission_factor,
            "transmissionFactor",
            place,
        );
        if factor == 0.0 {
            return Ok(None);
        }
        let mut red = None;
        if let Some(reference) = &transmission.transmission_texture {
            let own = self.texture_use(reference, place)?;
            if own == *used.get_or_insert(own) {
                red = self.texture(reference.index, place, "transmission texture")?;
            } else {
                self.notes.of_material(
                    "transmission texture that is laid otherwise than the base colour's",
                );
            }
        }
        if factor < 1.0 || red.is_some() {
            self.notes
                .of_material("reflection of a material that lets a part of the light through");
        }
        Ok(Some(Pane {
            transmittance: DVec3::splat(factor),
            is_tinted: true,
            red,
            ..Pane::CLEAR
        }))
    }

    /// A share of the light that arrives, held in 0 to 1.
    fn held(&mut self, value: f64, what: &str, place: &str) -> f64 {
        let held = value.clamp(0.0, 1.0);
        if held != value {
            let problem = format!("{place}: {what} is {}, outside 0 to 1", number(value));
            self.notes
                .mend(self.gltf.at(problem), format!("held at {held}"));
        }
        held
    }

    /// A cutoff far over 1 says that there is no surface at all (glTF 2.0, 5.19.11); a hair over, rounding.
    fn cutoff(&mut self, value: f64, place: &str) -> f64 {
        if value <= 1.01 {
            return self.held(value, "alphaCutoff", place);
        }
        let problem = format!("{place}: alphaCutoff is {}, above 1", number(value));
        self.notes.mend(
            self.gltf.at(problem),
            "nothing of the material is a surface",
        );
        value
    }

    fn texture_use(&self, reference: &TextureRef, by: &str) -> Result<TextureUse> {
        let transform: TextureTransform = extension(
            self.gltf,
            &reference.extensions,
            "KHR_texture_transform",
            by,
        )?
        .unwrap_or_default();
        Ok(TextureUse {
            set: transform.tex_coord.unwrap_or(reference.tex_coord),
            offset: transform.offset.into(),
            rotation: transform.rotation,
            scale: transform.scale.unwrap_or([1.0; 2]).into(),
        })
    }

    /// Decodes a texture into the scene. One that cannot be read is a warning: the scene's shape is there without it.
    fn texture(&mut self, index: usize, by: &str, what: &str) -> Result<Option<usize>> {
        let gltf = self.gltf;
        let by = format!("{by}, {what}");
        let entry = gltf.get(&gltf.json.textures, "textures", index, by)?;
        let place = format!("textures[{index}]");
        let mut wraps = [Wrap::Repeat; 2];
        let mut smooth = false;
        if let Some(sampler) = entry.sampler {
            let sampler = gltf.get(&gltf.json.samplers, "samplers", sampler, &place)?;
            wraps = [sampler.wrap_s, sampler.wrap_t].map(|mode| match mode {
                Some(33_071) => Wrap::Clamp,
                Some(33_648) => Wrap::Mirror,
                None | Some(10_497) => Wrap::Repeat,
                Some(_) => {
                    let what = "wrapS or wrapT that glTF 2.0 does not know, taken as REPEAT";
                    self.notes.leave_out(what);
                    Wrap::Repeat
                }
            });
            smooth = sampler.mag_filter.is_some_and(|filter| filter != 9728)
                || sampler.min_filter.is_some_and(|filter| filter != 9728);
        }
        let Some(source) = entry.source else {
            self.notes.warn(Warning::UnsupportedTextureFormat {
                place: gltf.at(&place),
                extensions: entry.extensions.keys().map(|name| shown(name)).collect(),
            });
            return Ok(None);
        };
        let key = (source, wraps.map(|wrap| wrap as u8));
        if let Some(&known) = self.pictures.known.get(&key) {
            return Ok(known);
        }
        let image = gltf.get(&gltf.json.images, "images", source, &place)?;
        let place = format!("images[{source}]");
        let name = entry
            .name
            .as_ref()
            .or(image.name.as_ref())
            .map(|name| shown(name));
        let (name, bytes) = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                let inside = uri
                    .get(..5)
                    .is_some_and(|start| start.eq_ignore_ascii_case("data:"));
                let own = if inside { place.clone() } else { shown(uri) };
                (
                    name.filter(|_| inside).unwrap_or(own),
                    gltf.fetch(uri, &place, self.notes).map(Cow::Owned),
                )
            }
            (None, Some(view)) => (
                name.unwrap_or_else(|| place.clone()),
                gltf.view(view, &place).map(Cow::Borrowed),
            ),
            (None, None) => (
                place.clone(),
                Err(gltf.error(&place, "it names no picture", "export the scene again")),
            ),
        };
        let most = most_texels(gltf.size().saturating_add(self.pictures.bytes));
        let picture = bytes.and_then(|bytes| {
            let wrong = |problem| gltf.error(&place, problem, "save the picture as PNG or JPEG");
            let many = format!("the pictures have more than {most} pixels");
            if self.pictures.texels > most {
                return Err(gltf.error(&place, many, "use smaller pictures"));
            }
            let picture = decode_image(&name, &bytes, wraps).map_err(wrong)?;
            self.pictures.bytes = self.pictures.bytes.saturating_add(bytes.len());
            self.pictures.texels += picture.pixels.len() as u64;
            Ok(picture)
        });
        let texture = match picture {
            Ok(picture) => {
                if smooth {
                    self.notes.of_material("smooth texture filter");
                }
                self.pictures.textures.push(picture);
                Some(self.pictures.textures.len() - 1)
            }
            Err(error) => {
                self.notes.warn(Warning::MissingTexture {
                    problem: error.problem(),
                    remedy: error.remedy(),
                });
                None
            }
        };
        self.pictures.known.insert(key, texture);
        Ok(texture)
    }
}
