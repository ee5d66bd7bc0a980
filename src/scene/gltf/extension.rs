//! Extensions of glTF: what each is, and whether a scene can do without it.

/// What an extension means to a scene.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Role {
    /// It is read.
    Read,
    /// It says nothing about the picture.
    Silent,
    /// The scene is there without it; where it stands it is named as left out.
    Dispensable,
    /// The scene is not there without it, unless the file holds a plain copy.
    Vital,
}

/// An extension that has a name of its own here.
struct Extension {
    name: &'static str,
    /// What it is, in words.
    what: &'static str,
    role: Role,
}

const fn extension(name: &'static str, what: &'static str, role: Role) -> Extension {
    Extension { name, what, role }
}

/// The extensions that are known one by one.
const KNOWN: [Extension; 30] = [
    extension("EXT_mesh_gpu_instancing", "mesh instancing", Role::Read),
    extension("KHR_lights_punctual", "lamps", Role::Read),
    extension(
        "KHR_materials_pbrSpecularGlossiness",
        "specular-glossiness",
        Role::Read,
    ),
    extension(
        "KHR_materials_emissive_strength",
        "strength of emission",
        Role::Read,
    ),
    extension("KHR_materials_transmission", "panes", Role::Read),
    extension("KHR_mesh_quantization", "quantized vertices", Role::Read),
    extension("KHR_node_visibility", "visibility of nodes", Role::Read),
    extension("KHR_texture_transform", "moved textures", Role::Read),
    extension("CESIUM_primitive_outline", "outlines", Role::Silent),
    extension("EXT_mesh_features", "names of features", Role::Silent),
    extension("EXT_mesh_manifold", "manifold meshes", Role::Silent),
    extension("EXT_structural_metadata", "metadata", Role::Silent),
    extension("FB_ngon_encoding", "polygons", Role::Silent),
    extension("GODOT_single_root", "a single root", Role::Silent),
    extension("KHR_node_hoverability", "hovering", Role::Silent),
    extension("KHR_node_selectability", "selection", Role::Silent),
    extension("KHR_xmp", "metadata", Role::Silent),
    extension("KHR_xmp_json_ld", "metadata", Role::Silent),
    extension(
        "EXT_lights_image_based",
        "image-based light",
        Role::Dispensable,
    ),
    extension(
        "KHR_animation_pointer",
        "animation of any property",
        Role::Dispensable,
    ),
    extension("KHR_audio", "sound", Role::Dispensable),
    extension("KHR_interactivity", "interactivity", Role::Dispensable),
    extension(
        "KHR_materials_unlit",
        "unlit materials, lit here as all others are",
        Role::Dispensable,
    ),
    extension(
        "KHR_materials_variants",
        "variants of materials, of which the default is shown",
        Role::Dispensable,
    ),
    extension(
        "MSFT_lod",
        "levels of detail, of which the finest is shown",
        Role::Dispensable,
    ),
    extension(
        "EXT_meshopt_compression",
        "meshopt compression",
        Role::Vital,
    ),
    extension(
        "KHR_meshopt_compression",
        "meshopt compression",
        Role::Vital,
    ),
    extension(
        "KHR_draco_mesh_compression",
        "Draco mesh compression",
        Role::Vital,
    ),
    extension("KHR_gaussian_splatting", "Gaussian splats", Role::Vital),
    extension("KHR_implicit_shapes", "shapes without a mesh", Role::Vital),
];

/// Families that a scene can do without: light and what surfaces look like, and what moves.
const DISPENSABLE: [&str; 8] = [
    "_materials_",
    "_texture_",
    "_lights_",
    "_animation",
    "_physics_",
    "_rigid_bod",
    "_audio",
    "_collision",
];

/// What an extension means to a scene.
pub(super) fn role(name: &str) -> Role {
    match KNOWN.iter().find(|known| known.name == name) {
        Some(known) => known.role,
        None if DISPENSABLE.iter().any(|part| name.contains(part)) => Role::Dispensable,
        None => Role::Vital,
    }
}

/// What an extension is, with its name.
pub(super) fn named(name: &str) -> String {
    match KNOWN.iter().find(|known| known.name == name) {
        Some(known) => format!("{} ({name})", known.what),
        None => super::notes::shown(name),
    }
}

/// What an exporter can do about an extension that is needed.
pub(super) fn remedy(name: &str) -> &'static str {
    match name {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "export it again without mesh compression"
        }
        "KHR_gaussian_splatting" | "KHR_implicit_shapes" => "export it again as a mesh",
        _ => "export it again without that extension",
    }
}
