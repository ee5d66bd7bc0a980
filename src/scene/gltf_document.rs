//! The glTF 2.0 container: JSON, buffers, accessors, each range checked before it is read.
//!
//! Own structs instead of the `gltf` crate's: that crate rounds transforms to f32, refuses files for texture
//! extensions, and panics on some damaged ones. The tests hold this reader to it.

use super::file;
use crate::error::{Error, Result};
use serde::Deserialize;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// What an exporter can do about a file that contradicts itself.
const DAMAGED: &str = "the file is damaged: export it again";

/// A glTF file with its buffers in memory.
pub(super) struct Gltf {
    /// The file, for messages.
    pub path: PathBuf,
    /// The JSON.
    pub json: Document,
    buffers: Vec<Vec<u8>>,
}

macro_rules! json {
    ($($(#[$doc:meta])* $name:ident { $($field:ident: $type:ty),* $(,)? })*) => {$(
        $(#[$doc])*
        #[derive(Debug, Default, Deserialize)]
        #[serde(rename_all = "camelCase", default)]
        pub(super) struct $name { $(pub $field: $type),* }
    )*};
}

json! {
    /// The properties of glTF 2.0 that a scene needs, under their own names (Khronos, glTF 2.0, chapter 5).
    Document {
        asset: Asset, scene: Option<usize>, scenes: Vec<SceneRoots>, nodes: Vec<Node>, meshes: Vec<MeshEntry>,
        accessors: Vec<Accessor>, buffer_views: Vec<View>, buffers: Vec<Buffer>, materials: Vec<MaterialEntry>,
        textures: Vec<TextureEntry>, images: Vec<ImageEntry>, samplers: Vec<Sampler>, cameras: Vec<CameraEntry>,
        extensions: Map<String, Value>, extensions_required: Vec<String>,
    }
    Asset { version: String }
    SceneRoots { nodes: Vec<usize> }
    Node {
        name: Option<String>, children: Vec<usize>, matrix: Option<[f64; 16]>, translation: Option<[f64; 3]>,
        rotation: Option<[f64; 4]>, scale: Option<[f64; 3]>, mesh: Option<usize>, camera: Option<usize>,
        skin: Option<usize>, extensions: Map<String, Value>,
    }
    MeshEntry { name: Option<String>, primitives: Vec<Primitive> }
    Primitive {
        attributes: Map<String, Value>, indices: Option<usize>, material: Option<usize>, mode: Option<u32>,
        targets: Vec<Value>, extensions: Map<String, Value>,
    }
    Accessor {
        buffer_view: Option<usize>, byte_offset: usize, component_type: u32, normalized: bool, count: usize,
        r#type: String, sparse: Option<Sparse>,
    }
    Sparse { count: usize, indices: SparseSlice, values: SparseSlice }
    SparseSlice { buffer_view: usize, byte_offset: usize, component_type: u32 }
    View { buffer: usize, byte_offset: usize, byte_length: usize, byte_stride: Option<usize> }
    Buffer { uri: Option<String>, byte_length: usize }
    MaterialEntry {
        name: Option<String>, pbr_metallic_roughness: Pbr, alpha_mode: Option<String>, alpha_cutoff: Option<f64>,
        normal_texture: Option<Value>, occlusion_texture: Option<Value>, emissive_texture: Option<Value>,
        emissive_factor: [f64; 3], extensions: Map<String, Value>,
    }
    Pbr {
        base_color_factor: Option<[f64; 4]>, base_color_texture: Option<TextureRef>, metallic_factor: Option<f64>,
        metallic_roughness_texture: Option<Value>,
    }
    TextureRef { index: usize, tex_coord: u32, extensions: Map<String, Value> }
    TextureEntry { name: Option<String>, sampler: Option<usize>, source: Option<usize>, extensions: Map<String, Value> }
    ImageEntry { name: Option<String>, uri: Option<String>, buffer_view: Option<usize> }
    Sampler { wrap_s: Option<u32>, wrap_t: Option<u32> }
    CameraEntry { name: Option<String>, perspective: Option<Perspective>, orthographic: Option<Orthographic> }
    Perspective { yfov: f64 }
    Orthographic { ymag: f64 }
    /// KHR_lights_punctual.
    Light { name: Option<String>, color: Option<[f64; 3]>, intensity: Option<f64>, r#type: String, spot: Spot }
    Spot { inner_cone_angle: Option<f64>, outer_cone_angle: Option<f64> }
    /// KHR_texture_transform.
    TextureTransform { offset: [f64; 2], rotation: f64, scale: Option<[f64; 2]>, tex_coord: Option<u32> }
}

impl Gltf {
    /// Reads `bytes`, the content of `path`; files that it names are looked for beside it.
    pub fn read(path: &Path, bytes: &[u8]) -> Result<Gltf> {
        let name = path.display();
        let (json, blob) = if bytes.starts_with(b"glTF") {
            split_glb(path, bytes)?
        } else {
            (bytes, None)
        };
        let json: Document = serde_json::from_slice(json).map_err(|e| {
            let remedy = match e.classify() {
                serde_json::error::Category::Eof => {
                    "the file is cut short: copy or export it again"
                }
                _ => DAMAGED,
            };
            Error::input(format!("{name}, JSON"), e.to_string(), remedy)
        })?;
        if !json.asset.version.starts_with("2.") {
            return Err(Error::input(
                format!("{name}, asset.version"),
                match json.asset.version.as_str() {
                    "" => "there is none: this is not a glTF file".to_owned(),
                    other => format!("it is glTF {other}, which this program does not read"),
                },
                "export the scene as glTF 2.0",
            ));
        }
        let mut gltf = Gltf {
            path: path.to_owned(),
            json,
            buffers: Vec::new(),
        };
        for (i, buffer) in gltf.json.buffers.iter().enumerate() {
            let mut bytes = match (&buffer.uri, blob) {
                (Some(uri), _) => gltf.fetch(uri, &format!("buffers[{i}].uri"))?,
                (None, Some(blob)) if i == 0 => blob.to_vec(),
                (None, _) => {
                    return Err(gltf.error(
                        format_args!("buffers[{i}]"),
                        "there is no data for it",
                        DAMAGED,
                    ));
                }
            };
            if bytes.len() < buffer.byte_length {
                return Err(gltf.error(
                    format_args!("buffers[{i}]"),
                    format!("{} bytes of {} are there", bytes.len(), buffer.byte_length),
                    "the file is cut short: copy or export it again",
                ));
            }
            bytes.truncate(buffer.byte_length);
            gltf.buffers.push(bytes);
        }
        Ok(gltf)
    }

    /// An error at `place` in this file.
    pub fn error(
        &self,
        place: impl std::fmt::Display,
        problem: impl Into<String>,
        remedy: &str,
    ) -> Error {
        Error::input(format!("{}, {place}", self.path.display()), problem, remedy)
    }

    /// `list[index]`, or an error that says what names what.
    pub fn get<'a, T>(
        &self,
        list: &'a [T],
        name: &str,
        index: usize,
        by: impl std::fmt::Display,
    ) -> Result<&'a T> {
        list.get(index).ok_or_else(|| {
            self.error(
                by,
                format!("it names {name}[{index}], but there are {}", list.len()),
                DAMAGED,
            )
        })
    }

    /// What stands at a URI: a file beside this one, or a `data:` URI.
    pub fn fetch(&self, uri: &str, place: &str) -> Result<Vec<u8>> {
        if let Some(data) = uri.strip_prefix("data:") {
            return data
                .split_once(";base64,")
                .and_then(|(_, text)| decode_base64(text))
                .ok_or_else(|| self.error(place, "the data: URI is not base64", DAMAGED));
        }
        let file = percent_decode(uri)
            .filter(|file| !file.contains("://"))
            .ok_or_else(|| {
                self.error(
                    place,
                    format!("`{uri}` is not the name of a file"),
                    "put the file beside this one and name it",
                )
            })?;
        let beside = self.path.parent().unwrap_or(Path::new("")).join(file);
        file::read(&beside, file::LARGEST).map_err(|e| {
            self.error(
                place,
                e.problem(),
                "put the file where the scene names it, or export the scene as one GLB",
            )
        })
    }

    /// The bytes of a buffer view.
    pub fn view(&self, index: usize, by: &str) -> Result<&[u8]> {
        let view = self.get(&self.json.buffer_views, "bufferViews", index, by)?;
        let buffer = self.get(
            &self.buffers,
            "buffers",
            view.buffer,
            format_args!("bufferViews[{index}]"),
        )?;
        view.byte_offset
            .checked_add(view.byte_length)
            .and_then(|end| buffer.get(view.byte_offset..end))
            .ok_or_else(|| {
                self.error(
                    format_args!("bufferViews[{index}]"),
                    format!(
                        "bytes {} to {} lie outside its buffer of {}",
                        view.byte_offset,
                        view.byte_offset.saturating_add(view.byte_length),
                        buffer.len()
                    ),
                    DAMAGED,
                )
            })
    }

    /// An accessor's elements, row by row, and the number of components of each, which must be one of `widths`.
    ///
    /// Normalised integers become fractions (glTF 2.0, 3.6.2.2).
    pub fn numbers(&self, index: usize, widths: &[usize], by: &str) -> Result<(usize, Vec<f64>)> {
        let accessor = self.get(&self.json.accessors, "accessors", index, by)?;
        let place = format!("accessors[{index}]");
        let width = match accessor.r#type.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 0,
        };
        if !widths.contains(&width) {
            return Err(self.error(
                &place,
                format!("type `{}` does not fit {by}", accessor.r#type),
                DAMAGED,
            ));
        }
        let component = Component::new(accessor.component_type).ok_or_else(|| {
            self.error(
                &place,
                format!("there is no componentType {}", accessor.component_type),
                DAMAGED,
            )
        })?;
        let mut numbers = match accessor.buffer_view {
            Some(view) => self.slice(
                view,
                accessor.byte_offset,
                accessor.count,
                width,
                component,
                &place,
            )?,
            None if accessor.sparse.is_some() && accessor.count <= MOST_IMPLIED => {
                vec![0.0; accessor.count * width]
            }
            None => {
                return Err(self.error(
                    &place,
                    "there is no data behind it (compressed geometry?)",
                    "export without mesh compression",
                ));
            }
        };
        if let Some(sparse) = &accessor.sparse {
            let kind = Component::new(sparse.indices.component_type).ok_or_else(|| {
                self.error(
                    &place,
                    "the sparse indices have no valid componentType",
                    DAMAGED,
                )
            })?;
            let rows = self.slice(
                sparse.indices.buffer_view,
                sparse.indices.byte_offset,
                sparse.count,
                1,
                kind,
                &place,
            )?;
            let values = self.slice(
                sparse.values.buffer_view,
                sparse.values.byte_offset,
                sparse.count,
                width,
                component,
                &place,
            )?;
            for (row, value) in rows.into_iter().zip(values.chunks_exact(width)) {
                numbers
                    .chunks_exact_mut(width)
                    .nth(row as usize)
                    .ok_or_else(|| {
                        self.error(
                            &place,
                            format!(
                                "sparse index {row} is beyond its {} elements",
                                accessor.count
                            ),
                            DAMAGED,
                        )
                    })?
                    .copy_from_slice(value);
            }
        }
        if accessor.normalized && component != Component::F32 {
            let most = component.most();
            numbers.iter_mut().for_each(|x| *x = (*x / most).max(-1.0));
        }
        Ok((width, numbers))
    }

    /// An accessor's whole numbers, as indices.
    pub fn indices(&self, index: usize, by: &str) -> Result<Vec<u32>> {
        let kind = self
            .get(&self.json.accessors, "accessors", index, by)?
            .component_type;
        if !matches!(kind, 5121 | 5123 | 5125) {
            return Err(self.error(
                format_args!("accessors[{index}]"),
                format!("componentType {kind} cannot count {by}"),
                DAMAGED,
            ));
        }
        // Every u32 is an f64.
        Ok(self
            .numbers(index, &[1], by)?
            .1
            .into_iter()
            .map(|x| x as u32)
            .collect())
    }

    fn slice(
        &self,
        view: usize,
        offset: usize,
        count: usize,
        width: usize,
        component: Component,
        by: &str,
    ) -> Result<Vec<f64>> {
        let bytes = self.view(view, by)?;
        let size = width * component.size();
        let stride = self.json.buffer_views[view].byte_stride.unwrap_or(size);
        let end = count.checked_sub(1).and_then(|last| {
            last.checked_mul(stride)?
                .checked_add(size)?
                .checked_add(offset)
        });
        if stride < size || count > 0 && end.is_none_or(|end| end > bytes.len()) {
            return Err(self.error(
                by,
                format!("{count} elements of {size} bytes, {stride} apart from byte {offset} on, do not fit the {} bytes of bufferViews[{view}]", bytes.len()),
                DAMAGED,
            ));
        }
        let mut numbers = Vec::with_capacity(count * width);
        for row in 0..count {
            let row = &bytes[offset + row * stride..][..size];
            numbers.extend(
                row.chunks_exact(component.size())
                    .map(|c| component.read(c)),
            );
        }
        Ok(numbers)
    }
}

/// Elements of an accessor without data of its own that are believed: a guard against a damaged count.
const MOST_IMPLIED: usize = 1 << 24;

#[derive(Clone, Copy, PartialEq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn new(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// What stands for 1 when normalised.
    fn most(self) -> f64 {
        match self {
            Component::I8 => 127.0,
            Component::U8 => 255.0,
            Component::I16 => 32_767.0,
            Component::U16 => 65_535.0,
            Component::U32 => 4_294_967_295.0,
            Component::F32 => 1.0,
        }
    }

    /// The number in `bytes`, which are as many as [`Component::size`].
    fn read(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Component::I8, &[a]) => f64::from(a as i8),
            (Component::U8, &[a]) => f64::from(a),
            (Component::I16, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
            (Component::U16, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
            (Component::U32, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
            (Component::F32, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            _ => f64::NAN,
        }
    }
}

/// The JSON and the binary chunk of a GLB (glTF 2.0, 4.4).
fn split_glb<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>)> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let error = |at: usize, problem: String| {
        Error::input(
            format!("{}, byte {at}", path.display()),
            problem,
            "the file is cut short or damaged: copy or export it again",
        )
    };
    match word(4) {
        Some(2) => {}
        Some(version) => {
            return Err(error(
                4,
                format!("it is GLB version {version}; only version 2 is known"),
            ));
        }
        None => return Err(error(bytes.len(), "the GLB header ends here".into())),
    }
    let (mut json, mut blob) = (None, None);
    let mut at = 12;
    while let (Some(length), Some(kind)) = (word(at), word(at + 4)) {
        let chunk = bytes
            .get(at + 8..at.saturating_add(8).saturating_add(length as usize))
            .ok_or_else(|| {
                error(
                    at,
                    format!(
                        "a chunk of {length} bytes begins, but {} follow",
                        bytes.len() - at - 8
                    ),
                )
            })?;
        match kind {
            0x4E4F_534A => json = json.or(Some(chunk)),
            0x004E_4942 => blob = blob.or(Some(chunk)),
            _ => {}
        }
        at += 8 + length as usize;
    }
    let json = json.ok_or_else(|| error(at.min(bytes.len()), "there is no JSON chunk".into()))?;
    Ok((json, blob))
}

fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut held) = (0u32, 0);
    for c in text.trim_end_matches('=').bytes() {
        let six = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(six);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    Some(bytes)
}

fn percent_decode(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&c, tail)) = rest.split_first() {
        rest = tail;
        let code = (c == b'%')
            .then(|| {
                std::str::from_utf8(tail.get(..2)?)
                    .ok()
                    .and_then(|hex| u8::from_str_radix(hex, 16).ok())
            })
            .flatten();
        if code.is_some() {
            rest = &tail[2..];
        }
        bytes.push(code.unwrap_or(c));
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_and_percent_signs() {
        // RFC 4648, section 10.
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(decode_base64(text).unwrap(), bytes.as_bytes());
        }
        assert_eq!(decode_base64("Zm9*"), None);
        assert_eq!(percent_decode("a%20b%C3%A9%").unwrap(), "a bé%");
        assert_eq!(percent_decode("%FF"), None);
    }
}
