//! Every property that stands in a glTF file, held against what is read: nothing is left out in silence.
//!
//! The tables below are the schema of glTF 2.0 (chapter 5). What they do not list is named in a warning.

use super::extension::{self, Role};
use super::notes::{Notes, shown};
use crate::error::{Error, Result};
use serde_json::Value;
use std::path::Path;

/// A kind of object, and what is known of its properties. Every object may have `extensions` and `extras`.
struct Kind {
    /// Its name, for messages.
    name: &'static str,
    /// Properties that hold objects, alone or in a list.
    holds: &'static [(&'static str, &'static Kind)],
    /// Properties that are read, or named as left out by whoever reads the object.
    read: &'static [&'static str],
    /// Properties that say nothing about the picture.
    silent: &'static [&'static str],
}

const fn kind(
    name: &'static str,
    holds: &'static [(&'static str, &'static Kind)],
    read: &'static [&'static str],
    silent: &'static [&'static str],
) -> Kind {
    Kind {
        name,
        holds,
        read,
        silent,
    }
}

static ROOT: Kind = kind(
    "file",
    &[
        ("asset", &ASSET),
        ("accessors", &ACCESSOR),
        ("bufferViews", &BUFFER_VIEW),
        ("buffers", &BUFFER),
        ("cameras", &CAMERA),
        ("images", &IMAGE),
        ("materials", &MATERIAL),
        ("meshes", &MESH),
        ("nodes", &NODE),
        ("samplers", &SAMPLER),
        ("scenes", &SCENE),
        ("skins", &SKIN),
        ("textures", &TEXTURE),
    ],
    &["animations", "extensionsRequired", "scene"],
    &["extensionsUsed"],
);
static ASSET: Kind = kind(
    "asset",
    &[],
    &["version", "minVersion"],
    &["copyright", "generator"],
);
static ACCESSOR: Kind = kind(
    "accessor",
    &[("sparse", &SPARSE)],
    &[
        "bufferView",
        "byteOffset",
        "componentType",
        "normalized",
        "count",
        "type",
    ],
    &["name", "min", "max"],
);
static SPARSE: Kind = kind(
    "accessor.sparse",
    &[("indices", &SPARSE_SLICE), ("values", &SPARSE_SLICE)],
    &["count"],
    &[],
);
static SPARSE_SLICE: Kind = kind(
    "accessor.sparse",
    &[],
    &["bufferView", "byteOffset", "componentType"],
    &[],
);
static BUFFER_VIEW: Kind = kind(
    "bufferView",
    &[],
    &["buffer", "byteOffset", "byteLength", "byteStride"],
    &["name", "target"],
);
static BUFFER: Kind = kind("buffer", &[], &["uri", "byteLength"], &["name"]);
static CAMERA: Kind = kind(
    "camera",
    &[
        ("perspective", &PERSPECTIVE),
        ("orthographic", &ORTHOGRAPHIC),
    ],
    &["name"],
    &["type"],
);
// The picture's own size gives its proportions, and nothing is clipped away.
static PERSPECTIVE: Kind = kind(
    "perspective",
    &[],
    &["yfov"],
    &["aspectRatio", "znear", "zfar"],
);
static ORTHOGRAPHIC: Kind = kind("orthographic", &[], &["ymag"], &["xmag", "znear", "zfar"]);
// What a picture is says its content.
static IMAGE: Kind = kind("image", &[], &["uri", "bufferView", "name"], &["mimeType"]);
// Surfaces have two sides, whatever the file says; light of their own goes by doubleSided.
static MATERIAL: Kind = kind(
    "material",
    &[
        ("pbrMetallicRoughness", &PBR),
        ("normalTexture", &OTHER_TEXTURE),
        ("occlusionTexture", &OTHER_TEXTURE),
        ("emissiveTexture", &EMISSIVE_TEXTURE),
    ],
    &[
        "name",
        "alphaMode",
        "alphaCutoff",
        "emissiveFactor",
        "doubleSided",
    ],
    &[],
);
static PBR: Kind = kind(
    "pbrMetallicRoughness",
    &[
        ("baseColorTexture", &BASE_TEXTURE),
        ("metallicRoughnessTexture", &OTHER_TEXTURE),
    ],
    &["baseColorFactor", "metallicFactor", "roughnessFactor"],
    &[],
);
static BASE_TEXTURE: Kind = kind("baseColorTexture", &[], &["index", "texCoord"], &[]);
static EMISSIVE_TEXTURE: Kind = kind("emissiveTexture", &[], &["index", "texCoord"], &[]);
// Textures that are left out as a whole.
static OTHER_TEXTURE: Kind = kind(
    "texture",
    &[],
    &["index", "texCoord", "scale", "strength"],
    &[],
);
static MESH: Kind = kind(
    "mesh",
    &[("primitives", &PRIMITIVE)],
    &["name", "weights"],
    &[],
);
static PRIMITIVE: Kind = kind(
    "primitive",
    &[],
    &["attributes", "indices", "material", "mode", "targets"],
    &[],
);
static NODE: Kind = kind(
    "node",
    &[],
    &[
        "name",
        "children",
        "matrix",
        "translation",
        "rotation",
        "scale",
        "mesh",
        "camera",
        "skin",
        "weights",
    ],
    &[],
);
static SAMPLER: Kind = kind(
    "sampler",
    &[],
    &["magFilter", "minFilter", "wrapS", "wrapT"],
    &["name"],
);
static SCENE: Kind = kind("scene", &[], &["nodes"], &["name"]);
static SKIN: Kind = kind(
    "skin",
    &[],
    &["inverseBindMatrices", "joints"],
    &["name", "skeleton"],
);
static TEXTURE: Kind = kind("texture", &[], &["name", "sampler", "source"], &[]);

/// Names all that `json`, the content of `path`, holds and nobody reads.
///
/// # Errors
/// [`Error::Input`] for a file that needs what this program has not.
pub(super) fn audit(path: &Path, json: &Value, notes: &mut Notes) -> Result<()> {
    let required = json.get("extensionsRequired").and_then(Value::as_array);
    let missing: Vec<&str> = required
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .filter(|name| extension::role(name) == Role::Vital)
        .collect();
    if let Some(first) = missing.first() {
        let list: Vec<String> = missing.iter().map(|name| extension::named(name)).collect();
        return Err(Error::input(
            format!("{}, extensionsRequired", path.display()),
            format!(
                "the file needs {}, which this program does not read",
                list.join(", ")
            ),
            extension::remedy(first),
        ));
    }
    if let Some(animations) = json.get("animations").and_then(Value::as_array) {
        for _ in animations {
            notes.leave_out("animation, of which the pose at rest is shown");
        }
    }
    object(json, &ROOT, notes);
    Ok(())
}

fn object(value: &Value, kind: &Kind, notes: &mut Notes) {
    let Some(map) = value.as_object() else {
        return;
    };
    for (key, value) in map {
        if key == "extensions" {
            let extensions = value.as_object().into_iter().flatten();
            extensions.for_each(|(name, _)| extension(name, kind, notes));
        } else if let Some((_, held)) = kind.holds.iter().find(|(name, _)| name == key) {
            match value {
                Value::Array(list) => list.iter().for_each(|one| object(one, held, notes)),
                one => object(one, held, notes),
            }
        } else if key != "extras"
            && !kind.read.contains(&&key[..])
            && !kind.silent.contains(&&key[..])
        {
            notes.leave_out(format!(
                "{}.{}, which is not glTF 2.0",
                kind.name,
                shown(key)
            ));
        }
    }
}

/// An extension of an object of some kind.
fn extension(name: &str, kind: &Kind, notes: &mut Notes) {
    let read_here = match name {
        "EXT_mesh_gpu_instancing" | "KHR_node_visibility" => kind.name == "node",
        "KHR_lights_punctual" => matches!(kind.name, "node" | "file"),
        "KHR_materials_pbrSpecularGlossiness"
        | "KHR_materials_emissive_strength"
        | "KHR_materials_transmission" => kind.name == "material",
        "KHR_texture_transform" => {
            matches!(
                kind.name,
                "baseColorTexture" | "emissiveTexture" | "texture"
            )
        }
        // Stand-ins with a plain copy beside them, without which the reader of the object fails.
        "KHR_draco_mesh_compression" => kind.name == "primitive",
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            matches!(kind.name, "bufferView" | "buffer")
        }
        // Pictures in other formats, of which a texture without a plain one is named.
        _ => kind.name == "texture" && name.contains("_texture_"),
    };
    if read_here || extension::role(name) == Role::Silent {
        return;
    }
    match kind.name {
        "material" | "pbrMetallicRoughness" | "baseColorTexture" | "emissiveTexture" => {
            notes.of_material(extension::named(name))
        }
        _ => notes.leave_out(extension::named(name)),
    }
}
