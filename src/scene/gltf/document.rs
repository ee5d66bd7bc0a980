//! The JSON of glTF 2.0: the properties that a scene needs, under their own names (Khronos, glTF 2.0, chapter 5).
//!
//! Own structs instead of the `gltf` crate's: that crate rounds transforms to f32, refuses files for texture
//! extensions, and panics on some damaged ones. The tests hold this reader to it.

use serde::Deserialize;
use serde_json::{Map, Value};

macro_rules! json {
    ($($(#[$doc:meta])* $name:ident { $($field:ident: $type:ty),* $(,)? })*) => {$(
        $(#[$doc])*
        #[derive(Debug, Default, Deserialize)]
        #[serde(rename_all = "camelCase", default)]
        pub(in crate::scene) struct $name { $(pub $field: $type),* }
    )*};
}

json! {
    /// The root.
    Document {
        asset: Asset, scene: Option<usize>, scenes: Vec<SceneRoots>, nodes: Vec<Node>, meshes: Vec<MeshEntry>,
        accessors: Vec<Accessor>, buffer_views: Vec<View>, buffers: Vec<Buffer>, materials: Vec<MaterialEntry>,
        textures: Vec<TextureEntry>, images: Vec<ImageEntry>, samplers: Vec<Sampler>, cameras: Vec<CameraEntry>,
        skins: Vec<SkinEntry>, extensions: Map<String, Value>,
    }
    Asset { version: String, min_version: Option<String> }
    SceneRoots { nodes: Vec<usize> }
    Node {
        name: Option<String>, children: Vec<usize>, matrix: Option<[f64; 16]>, translation: Option<[f64; 3]>,
        rotation: Option<[f64; 4]>, scale: Option<[f64; 3]>, mesh: Option<usize>, camera: Option<usize>,
        skin: Option<usize>, weights: Option<Vec<f64>>, extensions: Map<String, Value>,
    }
    MeshEntry { name: Option<String>, primitives: Vec<Primitive>, weights: Vec<f64> }
    Primitive {
        attributes: Map<String, Value>, indices: Option<usize>, material: Option<usize>, mode: Option<u32>,
        targets: Vec<Map<String, Value>>, extensions: Map<String, Value>,
    }
    SkinEntry { inverse_bind_matrices: Option<usize>, joints: Vec<usize> }
    Accessor {
        buffer_view: Option<usize>, byte_offset: usize, component_type: u32, normalized: bool, count: usize,
        r#type: String, sparse: Option<Sparse>,
    }
    Sparse { count: usize, indices: SparseSlice, values: SparseSlice }
    SparseSlice { buffer_view: usize, byte_offset: usize, component_type: u32 }
    View { buffer: usize, byte_offset: usize, byte_length: usize, byte_stride: Option<usize> }
    Buffer { uri: Option<String>, byte_length: usize, extensions: Map<String, Value> }
    MaterialEntry {
        name: Option<String>, pbr_metallic_roughness: Pbr, alpha_mode: Option<String>, alpha_cutoff: Option<f64>,
        normal_texture: Option<Value>, occlusion_texture: Option<Value>, emissive_texture: Option<TextureRef>,
        emissive_factor: [f64; 3], double_sided: bool, extensions: Map<String, Value>,
    }
    Pbr {
        base_color_factor: Option<[f64; 4]>, base_color_texture: Option<TextureRef>, metallic_factor: Option<f64>,
        roughness_factor: Option<f64>, metallic_roughness_texture: Option<Value>,
    }
    /// KHR_materials_pbrSpecularGlossiness.
    SpecularGlossiness {
        diffuse_factor: Option<[f64; 4]>, diffuse_texture: Option<TextureRef>, specular_factor: Option<[f64; 3]>,
        specular_glossiness_texture: Option<Value>,
    }
    /// KHR_materials_emissive_strength.
    EmissiveStrength { emissive_strength: Option<f64> }
    /// KHR_materials_transmission.
    Transmission { transmission_factor: f64, transmission_texture: Option<TextureRef> }
    TextureRef { index: usize, tex_coord: u32, extensions: Map<String, Value> }
    TextureEntry { name: Option<String>, sampler: Option<usize>, source: Option<usize>, extensions: Map<String, Value> }
    ImageEntry { name: Option<String>, uri: Option<String>, buffer_view: Option<usize> }
    Sampler { mag_filter: Option<u32>, min_filter: Option<u32>, wrap_s: Option<u32>, wrap_t: Option<u32> }
    CameraEntry { name: Option<String>, perspective: Option<Perspective>, orthographic: Option<Orthographic> }
    Perspective { yfov: f64 }
    Orthographic { ymag: f64 }
    /// KHR_lights_punctual of the root.
    Lights { lights: Vec<Light> }
    Light { name: Option<String>, color: Option<[f64; 3]>, intensity: Option<f64>, r#type: String, spot: Spot,
        range: Option<f64>,
    }
    Spot { inner_cone_angle: Option<f64>, outer_cone_angle: Option<f64> }
    /// KHR_lights_punctual of a node.
    LightRef { light: usize }
    /// KHR_texture_transform.
    TextureTransform { offset: [f64; 2], rotation: f64, scale: Option<[f64; 2]>, tex_coord: Option<u32> }
    /// EXT_mesh_gpu_instancing.
    Instancing { attributes: Map<String, Value> }
    /// KHR_node_visibility.
    Visibility { visible: Option<bool> }
    /// MSFT_lod.
    Lod { ids: Vec<usize> }
}
