//! Scene files: what comes out of good ones, and what is said about bad ones.

mod common;

use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::PathBuf;
use tyndall::medium::{Phase, Shape};
use tyndall::scene::{self, AlphaMode, Projection, PunctualKind, Scene, Wrap};

/// A folder that goes with the test.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Folder(tempfile::tempdir().expect("a temporary folder"))
    }

    fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).expect("the file is written");
        path
    }

    fn load(&self, name: &str, bytes: impl AsRef<[u8]>) -> tyndall::Result<Scene> {
        scene::load(&self.put(name, bytes))
    }

    /// The error of a file that must not load; it must name the file and a remedy.
    fn refused(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        match self.load(name, bytes) {
            Ok(_) => panic!("{name} loads"),
            Err(error) => {
                let text = error.to_string();
                assert!(
                    text.contains(name),
                    "the error does not name {name}: {text}"
                );
                assert!(!error.remedy().is_empty(), "no remedy: {text}");
                assert!(error.is_input(), "not the user's to mend: {text}");
                text
            }
        }
    }
}

/// A GLB of its two chunks.
fn glb(json: &Value, bin: &[u8]) -> Vec<u8> {
    let pad = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let (json, bin) = (pad(json.to_string().as_bytes(), b' '), pad(bin, 0));
    let mut out = b"glTF".to_vec();
    out.extend(2u32.to_le_bytes());
    out.extend((28 + json.len() as u32 + bin.len() as u32).to_le_bytes());
    for (chunk, kind) in [(&json, b"JSON"), (&bin, b"BIN\0")] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    out
}

const CORNERS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 2.0, 0.0],
    [1.0, 2.0, 0.5],
];
const INDICES: [u16; 6] = [0, 1, 2, 2, 1, 3];

/// Two triangles with normals, texture coordinates and colours, under two nodes; a light and two cameras.
fn example() -> (Value, Vec<u8>) {
    let mut bin = Vec::new();
    for p in CORNERS {
        bin.extend(p.iter().flat_map(|x| x.to_le_bytes()));
    }
    for _ in 0..4 {
        bin.extend([0.0f32, 0.6, 0.8].iter().flat_map(|x| x.to_le_bytes()));
    }
    for uv in [[0u16, 0], [65_535, 0], [0, 65_535], [65_535, 65_535]] {
        bin.extend(uv.iter().flat_map(|x| x.to_le_bytes()));
    }
    for color in [
        [255u8, 0, 0, 255],
        [0, 255, 0, 255],
        [0, 0, 255, 255],
        [51, 51, 51, 255],
    ] {
        bin.extend(color);
    }
    bin.extend(INDICES.iter().flat_map(|i| i.to_le_bytes()));
    let png = picture();
    let picture_at = bin.len();
    bin.extend(&png);
    let json = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [
            {"name": "far", "translation": [1e6, -2e6, 5e5], "children": [1, 2, 3]},
            {"name": "near", "mesh": 0, "rotation": [0.1, 0.2, 0.3, 0.927_361_849_549_570_4], "scale": [0.001, 0.002, 0.003]},
            {"name": "eye", "camera": 0, "matrix": [0,0,-1,0, 0,1,0,0, 1,0,0,0, 7,8,9,1]},
            {"camera": 1, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "meshes": [{"name": "sheet", "primitives": [{
            "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_1": 2, "COLOR_0": 3}, "indices": 4, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 4, "type": "VEC2", "normalized": true},
            {"bufferView": 2, "componentType": 5121, "count": 4, "type": "VEC4", "normalized": true},
            {"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 16},
            {"buffer": 0, "byteOffset": 112, "byteLength": 16},
            {"buffer": 0, "byteOffset": 128, "byteLength": 12},
            {"buffer": 0, "byteOffset": picture_at, "byteLength": png.len()},
        ],
        "buffers": [{"byteLength": bin.len()}],
        "materials": [{
            "name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.25,
            "normalTexture": {"index": 0}, "emissiveFactor": [1, 0, 0],
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.5}},
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.5, 0.25, 0.125, 0.75], "metallicFactor": 0,
                "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {
                    "offset": [0.5, -0.25], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2.0, 3.0], "texCoord": 1}}},
            },
        }],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"wrapS": 33_648, "wrapT": 33_071}],
        "images": [{"bufferView": 4, "mimeType": "image/png", "name": "leaf.png"}],
        "cameras": [
            {"type": "perspective", "perspective": {"yfov": 0.75, "znear": 0.1}},
            {"type": "orthographic", "name": "plan", "orthographic": {"xmag": 3, "ymag": 2.5, "znear": 0, "zfar": 1}},
        ],
        "extensionsRequired": ["KHR_texture_transform", "KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "spot", "name": "lamp", "color": [1, 0.5, 0.25], "intensity": 40, "spot": {"outerConeAngle": 0.5}}]}},
    });
    (json, bin)
}

/// Two texels: opaque red, transparent blue.
fn picture() -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 0, 255, 0])
        .expect("two texels")
        .write_to(&mut png, image::ImageFormat::Png)
        .expect("a PNG");
    png.into_inner()
}

#[test]
fn gltf_says_all_that_it_holds() {
    let (json, bin) = example();
    let scene = Folder::new()
        .load("example.glb", glb(&json, &bin))
        .expect("it loads");
    assert_eq!(scene.name, "example.glb");
    assert_eq!(scene.mesh.triangles.len(), 2);

    let leaf = &scene.materials[0];
    assert_eq!(scene.materials.len(), 1, "no default material without use");
    assert_eq!(leaf.base_color, DVec3::new(0.5, 0.25, 0.125));
    assert_eq!((leaf.alpha, leaf.transmissive), (0.75, true));
    assert_eq!(leaf.alpha_mode, AlphaMode::Mask { cutoff: 0.25 });
    assert_eq!(leaf.texture, Some(0));
    let texture = &scene.textures[0];
    assert_eq!(
        (texture.width, texture.height, &texture.name[..]),
        (2, 1, "leaf.png")
    );
    assert_eq!(texture.pixels, [[255, 0, 0, 255], [0, 0, 255, 0]]);
    assert_eq!(texture.wrap, [Wrap::Mirror, Wrap::Clamp]);

    // KHR_texture_transform: (u, v) -> offset + R(rotation) scale (u, v); a quarter turn sends (u, v) to (v, -u).
    for (uv, expected) in
        scene
            .mesh
            .uvs
            .iter()
            .zip([[0.5, -0.25], [0.5, -2.25], [3.5, -0.25], [3.5, -2.25]])
    {
        assert!(
            uv.distance(DVec2::from(expected)) < 1e-12,
            "{uv} {expected:?}"
        );
    }
    assert_eq!(scene.mesh.colors[1], DVec3::Y);
    assert_eq!(scene.mesh.colors[3], DVec3::splat(0.2));

    // The node's +90 degrees about +Y turns -Z to -X.
    let eye = &scene.cameras[0];
    assert_eq!(eye.name, "eye");
    assert_eq!(
        eye.camera.eye,
        DVec3::new(1_000_007.0, -1_999_992.0, 500_009.0)
    );
    assert_eq!(
        (eye.camera.forward, eye.camera.up),
        (DVec3::NEG_X, DVec3::Y)
    );
    assert_eq!(
        eye.camera.projection,
        Projection::Perspective { fov_y: 0.75 }
    );
    assert_eq!(scene.cameras[1].name, "plan");
    assert_eq!(
        scene.cameras[1].camera.projection,
        Projection::Orthographic { height: 5.0 }
    );

    let lamp = &scene.lights[0];
    assert_eq!(
        (lamp.color, lamp.direction),
        (DVec3::new(40.0, 20.0, 10.0), DVec3::NEG_Z)
    );
    assert_eq!(
        lamp.kind,
        PunctualKind::Spot {
            inner: 0.0,
            outer: 0.5
        }
    );

    // One warning for all that a material holds beyond a base colour.
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
    for what in [
        "example.glb",
        "emission (1)",
        "normal texture (1)",
        "KHR_materials_transmission (1)",
    ] {
        assert!(
            scene.warnings[0].contains(what),
            "{what}: {}",
            scene.warnings[0]
        );
    }
}

#[test]
fn a_far_node_keeps_its_millimetres() {
    let (json, bin) = example();
    let mesh = Folder::new()
        .load("far.glb", glb(&json, &bin))
        .expect("it loads")
        .mesh;
    // The product once more, from matrices written out by hand instead of glam's quaternion path.
    let [x, y, z, w] = [0.1, 0.2, 0.3, 0.927_361_849_549_570_4_f64];
    let rotation = DMat3::from_cols_array(&[
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y + z * w),
        2.0 * (x * z - y * w),
        2.0 * (x * y - z * w),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z + x * w),
        2.0 * (x * z + y * w),
        2.0 * (y * z - x * w),
        1.0 - 2.0 * (x * x + y * y),
    ]);
    let far = DVec3::new(1e6, -2e6, 5e5);
    let mut worst_f32: f64 = 0.0;
    for (p, corner) in mesh.positions.iter().zip(CORNERS) {
        let local =
            rotation * (DVec3::from(corner.map(f64::from)) * DVec3::new(0.001, 0.002, 0.003));
        // 1e-9 m: four units in the last place at 2e6 m.
        assert!(p.distance(far + local) < 1e-9, "{p}");
        worst_f32 = worst_f32.max((far + local).as_vec3().as_dvec3().distance(*p));
    }
    assert!(worst_f32 > 1e-3, "a loader in f32 would pass: {worst_f32}");
    let normal = rotation * (DVec3::new(0.0, 0.6, 0.8) / DVec3::new(0.001, 0.002, 0.003));
    // 0.6 and 0.8 are f32 in the file.
    assert!(mesh.normals[0].distance(normal.normalize()) < 1e-7);
}

#[test]
fn strips_fans_and_plain_triangles_face_the_same_way() {
    let quad = |mode: u32, indices: &[u8]| {
        let mut bin: Vec<u8> = Vec::new();
        for p in [
            [0.0f32, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ] {
            bin.extend(p.iter().flat_map(|x| x.to_le_bytes()));
        }
        bin.extend(indices);
        let json = json!({
            "asset": {"version": "2.0"}, "nodes": [{"mesh": 0}, {"mesh": 0, "scale": [-1, 1, 1]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}]}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5121, "count": indices.len(), "type": "SCALAR"}],
            "bufferViews": [
                {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": indices.len()}],
            "buffers": [{"byteLength": bin.len()}],
        });
        Folder::new()
            .load("quad.glb", glb(&json, &bin))
            .expect("it loads")
            .mesh
    };
    for mesh in [
        quad(4, &[0, 1, 2, 0, 2, 3]),
        quad(5, &[0, 1, 3, 2]),
        quad(6, &[0, 1, 2, 3]),
    ] {
        assert_eq!(mesh.triangles.len(), 4, "two instances");
        for t in &mesh.triangles {
            let [a, b, c] = t.vertices.map(|v| mesh.positions[v as usize]);
            assert_eq!((b - a).cross(c - a), DVec3::Z);
        }
        assert_eq!(mesh.normals[0], DVec3::ZERO, "no normals in the file");
    }
}

#[test]
fn sparse_accessors_and_quantised_positions() {
    let mut bin: Vec<u8> = [[0i16, 0, 0, 0], [32_767, 0, 0, 0], [0, -32_767, 0, 0]]
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bin.extend([2u8, 0, 0, 0]);
    bin.extend([0i16, 16_384, 0].iter().flat_map(|x| x.to_le_bytes()));
    let json = json!({
        "asset": {"version": "2.0"}, "extensionsRequired": ["KHR_mesh_quantization"], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5122, "normalized": true, "count": 3, "type": "VEC3",
            "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 1, "byteOffset": 4}}}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 24, "byteStride": 8}, {"buffer": 0, "byteOffset": 24, "byteLength": 10}],
        "buffers": [{"byteLength": bin.len()}],
    });
    let mesh = Folder::new()
        .load("sparse.glb", glb(&json, &bin))
        .expect("it loads")
        .mesh;
    assert_eq!(
        mesh.positions,
        [DVec3::ZERO, DVec3::X, DVec3::Y * (16_384.0 / 32_767.0)]
    );
}

#[test]
fn textures_that_cannot_be_read_are_warnings() {
    let (mut json, bin) = example();
    let folder = Folder::new();
    json["extensionsRequired"] = json!(["EXT_texture_webp"]);
    json["textures"][0] = json!({"extensions": {"EXT_texture_webp": {"source": 0}}});
    let scene = folder
        .load("webp.glb", glb(&json, &bin))
        .expect("it loads without");
    assert_eq!(
        (scene.textures.len(), scene.materials[0].texture),
        (0, None)
    );
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.contains("webp.glb, textures[0]") && w.contains("EXT_texture_webp"))
    );

    let (mut json, bin) = example();
    json["images"][0] = json!({"uri": "gone%20away.png"});
    let scene = folder
        .load("gone.glb", glb(&json, &bin))
        .expect("it loads without");
    assert!(
        scene.warnings.iter().any(|w| w.contains("gone away.png")),
        "{:?}",
        scene.warnings
    );

    let (json, mut bin) = example();
    let last = bin.len() - 20;
    bin[140..last].fill(0);
    let scene = folder
        .load("damaged.glb", glb(&json, &bin))
        .expect("it loads without");
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.contains("texture left out")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn gltf_text_with_files_beside_it_and_data_uris() {
    let (mut json, bin) = example();
    let folder = Folder::new();
    folder.put("geometry data.bin", &bin);
    folder.put("leaf.png", picture());
    json["buffers"][0]["uri"] = json!("geometry%20data.bin");
    json["images"][0] = json!({"uri": "leaf.png"});
    let apart = folder
        .load("apart.gltf", json.to_string())
        .expect("it loads");
    let one = folder
        .load("one.glb", {
            let (json, bin) = example();
            glb(&json, &bin)
        })
        .expect("it loads");
    assert_eq!(apart.mesh.positions, one.mesh.positions);
    assert_eq!(apart.textures[0].pixels, one.textures[0].pixels);

    // Python: base64.b64encode(struct.pack('<9f', 0, 0, 0, 1, 0, 0, 0, 1, 0))
    let json = json!({
        "asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri":
            "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    });
    let mesh = folder
        .load("inline.gltf", json.to_string())
        .expect("it loads")
        .mesh;
    assert_eq!(mesh.positions, [DVec3::ZERO, DVec3::X, DVec3::Y]);
}

#[test]
fn damaged_gltf_is_refused_with_its_place() {
    let folder = Folder::new();
    let (good, bin) = example();
    type Change = fn(&mut Value);
    let cases: [(&str, Change, &[&str]); 19] = [
        (
            "index",
            |j| j["accessors"][0]["count"] = json!(3),
            &["meshes[0] (sheet).primitives[0]", "POSITION 3"],
        ),
        (
            "view",
            |j| j["bufferViews"][0]["byteLength"] = json!(100_000),
            &["bufferViews[0]", "outside its buffer"],
        ),
        (
            "count",
            |j| j["accessors"][4]["count"] = json!(7),
            &["accessors[4]", "bufferViews[3]"],
        ),
        (
            "huge",
            |j| j["accessors"][4]["count"] = json!(u64::MAX),
            &["accessors[4]"],
        ),
        (
            "stride",
            |j| j["bufferViews"][0]["byteStride"] = json!(0),
            &["accessors[0]", "0 apart"],
        ),
        (
            "mesh",
            |j| j["nodes"][1]["mesh"] = json!(5),
            &["nodes[1]", "meshes[5]", "there are 1"],
        ),
        (
            "child",
            |j| j["nodes"][0]["children"] = json!([77]),
            &["nodes[0]", "nodes[77]"],
        ),
        (
            "cycle",
            |j| j["nodes"][1]["children"] = json!([0]),
            &["nodes[0]", "twice, or below itself"],
        ),
        (
            "type",
            |j| j["accessors"][0]["type"] = json!("VEC2"),
            &["accessors[0]", "VEC2", "POSITION"],
        ),
        (
            "component",
            |j| j["accessors"][0]["componentType"] = json!(1),
            &["accessors[0]", "componentType 1"],
        ),
        (
            "float_index",
            |j| j["accessors"][4]["componentType"] = json!(5126),
            &["accessors[4]", "cannot count"],
        ),
        (
            "draco",
            |j| j["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]),
            &["extensionsRequired", "compression"],
        ),
        (
            "version",
            |j| j["asset"]["version"] = json!("1.0"),
            &["asset.version", "glTF 2.0"],
        ),
        (
            "buffer",
            |j| j["buffers"][0]["byteLength"] = json!(1_000_000),
            &["buffers[0]", "cut short"],
        ),
        (
            "color",
            |j| j["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][1] = json!(1.5),
            &["materials[0]", "1.5", "0 to 1"],
        ),
        (
            "scale",
            |j| j["nodes"][1]["scale"] = json!([0, 0, 0]),
            &["none of the 2 triangles has an area"],
        ),
        (
            "points",
            |j| j["meshes"][0]["primitives"][0]["mode"] = json!(0),
            &["there are no triangles"],
        ),
        (
            "fov",
            |j| j["cameras"][0]["perspective"]["yfov"] = json!(4.0),
            &["cameras[0]", "yfov is 4"],
        ),
        ("name", |j| j["nodes"] = json!("seven"), &["JSON", "line 1"]),
    ];
    assert!(folder.load("good.glb", glb(&good, &bin)).is_ok());
    for (name, change, expected) in cases {
        let mut json = good.clone();
        change(&mut json);
        let text = folder.refused(&format!("{name}.glb"), glb(&json, &bin));
        for what in expected {
            assert!(text.contains(what), "{name}: `{what}` is not in: {text}");
        }
    }

    let mut nan = bin.clone();
    nan[12..16].copy_from_slice(&f32::NAN.to_le_bytes());
    let text = folder.refused("nan.glb", glb(&good, &nan));
    assert!(
        text.contains("vertex 1") && text.contains("primitives[0]"),
        "{text}"
    );
    let mut beyond = bin;
    beyond[128] = 9;
    let text = folder.refused("beyond.glb", glb(&good, &beyond));
    assert!(
        text.contains("vertex 9") && text.contains("triangle 0"),
        "{text}"
    );
}

#[test]
fn what_is_no_scene_is_refused() {
    let folder = Folder::new();
    let missing = scene::load(&folder.0.path().join("nowhere.glb")).expect_err("it is not there");
    assert!(missing.to_string().contains("nowhere.glb") && missing.is_input());
    for name in [
        "empty.glb",
        "empty.gltf",
        "empty.obj",
        "empty.toml",
        "empty",
    ] {
        assert!(folder.refused(name, "").contains("empty"), "{name}");
    }
    assert!(folder.refused("photo.png", picture()).contains(".png"));
    assert!(
        folder
            .refused("not.glb", picture())
            .contains("neither GLB nor glTF")
    );
    assert!(
        folder
            .refused("other.gltf", "{\"foo\": 1}")
            .contains("not a glTF file")
    );
    assert!(
        folder
            .refused("cut.gltf", "{\"asset\": {")
            .contains("cut short")
    );
    assert!(
        folder
            .refused("not.obj", "Dear diary,\ntoday")
            .contains("OBJ")
    );
    assert!(
        folder
            .refused("points.obj", "v 0 0 0\nv 1 0 0\n")
            .contains("no triangles")
    );
    assert!(
        Scene::builtin("cellar")
            .expect_err("there is none")
            .to_string()
            .contains("nave")
    );
}

#[test]
fn degenerate_triangles_are_counted_and_dropped() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\n";
    let scene = Folder::new().load("some.obj", text).expect("it loads");
    assert_eq!(scene.mesh.triangles.len(), 1);
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.contains("some.obj") && w.contains("2 triangles")),
        "{:?}",
        scene.warnings
    );
    let text = Folder::new().refused("all.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    assert!(
        text.contains("none of the 1 triangles has an area"),
        "{text}"
    );
}

#[test]
fn obj_with_materials() {
    let folder = Folder::new();
    folder.put("leaf.png", picture());
    folder.put(
        "house.mtl",
        "newmtl wall\nKd 0.5 0.4 0.3\nKs 0.1 0.1 0.1\nnewmtl leaf\nmap_Kd leaf.png\nnewmtl glass\nKd 0 0 0\nd 0.1\n",
    );
    let text = "mtllib house.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1000000.001 1 0\nvt 0.25 0.125\n\
        usemtl wall\nf -5 -4 -3 -2\nusemtl leaf\nf 1/1 2/1 3/1\nusemtl glass\nf 1 2 5\n";
    let scene = folder.load("house.obj", text).expect("it loads");
    assert_eq!(scene.mesh.triangles.len(), 4);
    let names: Vec<&str> = scene.materials.iter().map(|m| &m.name[..]).collect();
    assert_eq!(names, ["wall", "leaf", "glass"]);
    assert_eq!(scene.materials[0].base_color, DVec3::new(0.5, 0.4, 0.3));
    assert_eq!(scene.materials[1].texture, Some(0));
    assert_eq!(scene.materials[2].alpha_mode, AlphaMode::Blend);
    let leaf = scene
        .mesh
        .triangles
        .iter()
        .find(|t| t.material == 1)
        .expect("the leaf");
    assert_eq!(
        scene.mesh.uvs[leaf.vertices[0] as usize],
        DVec2::new(0.25, 0.875),
        "v is down inside"
    );
    let (_, most) = scene.mesh.bounds().expect("there are triangles");
    assert_eq!(most.x, 1_000_000.001, "coordinates are read as f64");
    assert!(
        scene.warnings.iter().any(|w| w.contains("Ks (1)")),
        "{:?}",
        scene.warnings
    );

    let scene = folder
        .load(
            "lone.obj",
            "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl x\nf 1 2 3\n",
        )
        .expect("it loads");
    assert!(
        scene.warnings.iter().any(|w| w.contains("gone.mtl")),
        "{:?}",
        scene.warnings
    );
    assert_eq!(scene.materials.len(), 1, "the default");

    for (name, text, expected) in [
        (
            "nan.obj",
            "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n",
            "nan.obj:2",
        ),
        (
            "range.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n",
            "range.obj:5",
        ),
        (
            "zero.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n",
            "zero.obj:4",
        ),
        ("word.obj", "v 0 0 0\nv 1 0 zwei\n", "word.obj:2"),
    ] {
        let error = folder.refused(name, text);
        assert!(error.contains(expected), "{error}");
    }
}

/// The scene file of the design, as it is documented.
const EXAMPLE_TOML: &str = r#"
mesh = "room.obj"
scale = 1.0
up = "y"
origin = [0, 0, 0]
north = 0.0
time = "2026-06-21T18:30:00+02:00"
[site]
latitude = 48.8584
longitude = 2.2945
elevation = 35.0
timezone = "Europe/Paris"
[camera]
eye = [0.0, 1.6, 5.0]
target = [0.0, 1.5, 0.0]
up = [0, 1, 0]
fov_y = 60.0
projection = "perspective"
shift = [0.25, 0]
[sun]
azimuth = 120.0
elevation = 30.0
illuminance = 1.0
diameter = 0.0
[sky]
model = "cie:12"
turbidity = 3
direct_normal = 800
diffuse_horizontal = 100.0
[ground]
enabled = true
height = 0.0
albedo = 0.2
[[medium]]
shape = "box"
min = [-4.0, 0.0, -5.0]
max = [4.0, 4.0, 5.0]
scattering = 0.04
absorption = 0.0
phase = { kind = "henyey-greenstein", g = 0.7 }
[[medium]]
shape = "haze"
top = 60.0
scattering = [0.001, 0.002, 0.003]
[[medium]]
shape = "height"
base = 0.0
scale_height = 1200.0
far = 60000.0
scattering = 6e-5
absorption = 4e-6
phase = { kind = "rayleigh" }
[picture]
size = [960, 600]
samples = 8
exposure = 9.5
"#;

const ROOM: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";

#[test]
fn toml_says_all_that_it_holds() {
    let folder = Folder::new();
    folder.put("room.obj", ROOM);
    let scene = folder.load("room.toml", EXAMPLE_TOML).expect("it loads");
    assert_eq!(scene.name, "room.toml");
    assert_eq!(scene.time.as_deref(), Some("2026-06-21T18:30:00+02:00"));
    let site = scene.site.expect("a site");
    assert_eq!(
        (site.latitude_deg, site.longitude_deg, site.elevation),
        (48.8584, 2.2945, 35.0)
    );
    assert_eq!(site.timezone.as_deref(), Some("Europe/Paris"));
    let camera = scene.camera.expect("a camera");
    assert_eq!(
        (camera.eye, camera.up, camera.shift),
        (DVec3::new(0.0, 1.6, 5.0), DVec3::Y, DVec2::new(0.25, 0.0))
    );
    assert!(camera.forward.distance(DVec3::new(0.0, -0.1, -5.0)) < 1e-12);
    assert_eq!(
        camera.projection,
        Projection::Perspective {
            fov_y: 60f64.to_radians()
        }
    );
    let sun = scene.sun.expect("a sun");
    assert_eq!((sun.azimuth_deg, sun.elevation_deg), (120.0, 30.0));
    assert_eq!((sun.illuminance, sun.diameter_deg), (Some(1.0), Some(0.0)));
    assert_eq!(scene.sky.model.as_deref(), Some("cie:12"));
    assert_eq!(
        (
            scene.sky.turbidity,
            scene.sky.direct_normal,
            scene.sky.diffuse_horizontal
        ),
        (Some(3.0), Some(800.0), Some(100.0))
    );
    assert_eq!(
        (
            scene.ground.enabled,
            scene.ground.height,
            scene.ground.albedo
        ),
        (true, Some(0.0), 0.2)
    );
    assert_eq!(scene.media.len(), 3);
    assert_eq!(
        scene.media[0].shape,
        Shape::Box {
            min: DVec3::new(-4.0, 0.0, -5.0),
            max: DVec3::new(4.0, 4.0, 5.0)
        }
    );
    assert_eq!(scene.media[0].scattering, DVec3::splat(0.04));
    assert_eq!(scene.media[0].phase, Phase::HenyeyGreenstein { g: 0.7 });
    assert_eq!(scene.media[1].shape, Shape::Haze { top: 60.0 });
    assert_eq!(scene.media[1].scattering, DVec3::new(0.001, 0.002, 0.003));
    assert_eq!(
        (scene.media[1].absorption, scene.media[1].phase),
        (DVec3::ZERO, Phase::Isotropic)
    );
    assert_eq!(
        scene.media[2].shape,
        Shape::Height {
            base: 0.0,
            scale_height: 1200.0,
            far: 60_000.0
        }
    );
    assert_eq!(
        (scene.media[2].absorption, scene.media[2].phase),
        (DVec3::splat(4e-6), Phase::Rayleigh)
    );
    assert_eq!(
        (
            scene.picture.size,
            scene.picture.samples,
            scene.picture.exposure_ev100
        ),
        (Some([960, 600]), Some(8), Some(9.5))
    );

    for (kind, phase) in [
        ("\"isotropic\"", Phase::Isotropic),
        (
            "\"cornette-shanks\", g = -0.3",
            Phase::CornetteShanks { g: -0.3 },
        ),
        ("\"nishita-hazy\"", Phase::NishitaHazy),
        ("\"nishita-murky\"", Phase::NishitaMurky),
    ] {
        let text = format!(
            "[[medium]]\nshape = \"haze\"\ntop = 1\nscattering = 1\nphase = {{ kind = {kind} }}\n"
        );
        assert_eq!(
            folder.load("phase.toml", text).expect("it loads").media[0].phase,
            phase
        );
    }
    let scene = folder.load("open.toml", "time = 2026-06-21T18:30:00+02:00\n[camera]\neye=[0,1,0]\ntarget=[0,1,1]\nprojection=\"orthographic\"\nheight=2\n").expect("a scene without a mesh");
    assert_eq!(
        scene.time.as_deref(),
        Some("2026-06-21T18:30:00+02:00"),
        "TOML's own dates do as well"
    );
    assert_eq!(
        scene.camera.map(|c| c.projection),
        Some(Projection::Orthographic { height: 2.0 })
    );
    assert!(scene.mesh.triangles.is_empty());
}

#[test]
fn toml_puts_the_mesh_in_its_place() {
    let folder = Folder::new();
    folder.put("room.obj", ROOM);
    let scene = folder
        .load(
            "room.toml",
            "mesh = \"room.obj\"\nscale = 0.001\nup = \"z\"\norigin = [1e6, 2e6, -3e6]\n",
        )
        .expect("it loads");
    let expected = [DVec3::ZERO, DVec3::X * 0.001, DVec3::NEG_Z * 0.001]
        .map(|p| p + DVec3::new(1e6, 2e6, -3e6));
    assert_eq!(scene.mesh.positions, expected);
    assert_eq!(scene.mesh.normals[0], DVec3::Y, "Z up has become Y up");
    let [a, b, c] = expected;
    assert!(
        (b - a).cross(c - a).y > 0.0,
        "and the front is still in front"
    );
}

#[test]
fn toml_errors_name_file_line_key_and_remedy() {
    let folder = Folder::new();
    folder.put("room.obj", ROOM);
    let base = "mesh = \"room.obj\"\n";
    for (text, expected) in [
        (
            "north = 1\nlatitud = 3",
            &["bad.toml:3: latitud", "no key `latitud`"][..],
        ),
        (
            "[site]\nlatitud = 3",
            &["bad.toml:3: site.latitud", "did you mean `latitude`"],
        ),
        (
            "latitude = 3",
            &["bad.toml:2: latitude", "belongs in [site]"],
        ),
        (
            "[[medium]]\nshape = \"box\"\nmin = [0,0,0]\nmaks = [1,1,1]",
            &["bad.toml:5: medium[0].maks", "did you mean `max`"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = 1\nmin = [0,0,0]",
            &["bad.toml:6: medium[0].min"],
        ),
        (
            "[[medium]]\nshape = \"bocks\"",
            &["bad.toml:3: medium[0].shape", "did you mean \"box\""],
        ),
        (
            "[[medium]]\ntop = 1",
            &["bad.toml:2: medium[0]", "`shape` is missing", "\"haze\""],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3",
            &["bad.toml:2: medium[0]", "`scattering` is missing"],
        ),
        (
            "[medium]\nshape = \"haze\"",
            &["bad.toml:2: medium", "double brackets"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = [1, -1, 1]",
            &["bad.toml:5: medium[0].scattering[1]", "-1"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = 1\nphase = { kind = \"henyey-greenstein\", g = 1 }",
            &["bad.toml:6: medium[0].phase.g", "-1 to 1", "excluded"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = 1\nphase = { kind = \"mie\" }",
            &["bad.toml:6: medium[0].phase.kind", "nishita-hazy"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = 1\nphase = \"rayleigh\"",
            &["bad.toml:6: medium[0].phase", "a table with `kind`"],
        ),
        (
            "[[medium]]\nshape = \"box\"\nmin = [0,0,0]\nmax = [1,0,1]\nscattering = 1",
            &["bad.toml:5: medium[0].max", "holds nothing"],
        ),
        (
            "[site]\nlatitude = 91\nlongitude = 0",
            &[
                "bad.toml:3: site.latitude",
                "91 degrees",
                "-90 to 90 degrees",
            ],
        ),
        (
            "[site]\nlatitude = nan\nlongitude = 0",
            &["bad.toml:3: site.latitude", "nan"],
        ),
        (
            "scale = inf",
            &["bad.toml:2: scale", "inf", "lower end excluded"],
        ),
        ("scale = 0", &["bad.toml:2: scale", "0"]),
        (
            "north = \"east\"",
            &["bad.toml:2: north", "the text \"east\" instead of a number"],
        ),
        (
            "origin = [0, 0]",
            &["bad.toml:2: origin", "2 elements instead of 3"],
        ),
        (
            "origin = [0, true, 0]",
            &["bad.toml:2: origin[1]", "true instead of a number"],
        ),
        ("up = \"x\"", &["bad.toml:2: up", "\"y\", \"z\""]),
        (
            "[sky]\nmodel = \"cie:17\"",
            &["bad.toml:3: sky.model", "cie:1"],
        ),
        (
            "[picture]\nsize = [960.5, 600]",
            &["bad.toml:3: picture.size[0]", "whole number"],
        ),
        (
            "[picture]\nsamples = 0",
            &["bad.toml:3: picture.samples", "1 to 65536"],
        ),
        (
            "[camera]\neye = [0,0,0]\ntarget = [0,0,0]",
            &["bad.toml:4: camera.target", "where the eye is"],
        ),
        (
            "[camera]\neye = [0,0,0]\ntarget = [0,0,1]\nheight = 2",
            &["bad.toml:5: camera.height"],
        ),
        (
            "[camera]\neye = [0,0,0]\ntarget = [0,0,1]\nfov_y = 180",
            &["bad.toml:5: camera.fov_y", "0 to 180 degrees"],
        ),
        (
            "[camera]\neye = [0,0,0]",
            &["bad.toml:2: camera", "`target` is missing"],
        ),
        ("north = = 3", &["bad.toml:2"]),
    ] {
        let error = folder.refused("bad.toml", format!("{base}{text}\n"));
        for what in expected {
            assert!(error.contains(what), "{text}\n`{what}` is not in: {error}");
        }
    }
    let error = folder.refused("gone.toml", "\nmesh = \"gone.glb\"\n");
    assert!(
        error.contains("gone.toml:2: mesh") && error.contains("gone.glb"),
        "{error}"
    );
    let error = folder.refused("self.toml", "mesh = \"self.toml\"\n");
    assert!(error.contains("cannot be the mesh"), "{error}");
    assert!(
        folder
            .refused("latin.toml", b"north = 1\n# \xe9\n")
            .contains("latin.toml:2")
    );
}

/// Every key that a table in TOML holds, with `[]` for each array of tables.
fn keys(value: &toml::Value, path: &str, into: &mut BTreeSet<String>) {
    match value {
        toml::Value::Table(table) => {
            for (name, value) in table {
                let path = format!("{path}.{name}");
                keys(value, &path, into);
                into.insert(path);
            }
        }
        toml::Value::Array(list) => list.iter().for_each(|v| keys(v, path, into)),
        _ => {}
    }
}

/// Every key that a schema knows, likewise.
fn schema_keys(root: &Value, schema: &Value, path: &str, into: &mut BTreeSet<String>) {
    if let Some(pointer) = schema["$ref"].as_str() {
        let target = root
            .pointer(&pointer[1..])
            .unwrap_or_else(|| panic!("{pointer} leads nowhere"));
        schema_keys(root, target, path, into);
    }
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        let path = format!("{path}.{name}");
        schema_keys(root, property, &path, into);
        into.insert(path);
    }
    for one in schema["oneOf"].as_array().into_iter().flatten() {
        schema_keys(root, one, path, into);
    }
    if schema["items"].is_object() {
        schema_keys(root, &schema["items"], path, into);
    }
}

#[test]
fn schema_and_example_know_the_same_keys() {
    let schema = scene::schema();
    let (mut known, mut used) = (BTreeSet::new(), BTreeSet::new());
    schema_keys(&schema, &schema, "", &mut known);
    keys(
        &toml::from_str(EXAMPLE_TOML).expect("valid TOML"),
        "",
        &mut used,
    );
    // An orthographic camera's, which the example's perspective one cannot have.
    used.insert(".camera.height".into());
    assert_eq!(known, used);
    assert!(!schema.to_string().contains("null"), "TOML has no null");
}

#[test]
fn real_scenes_load_with_their_known_sizes() {
    let Some(data) = common::data("real_scenes_load_with_their_known_sizes") else {
        return;
    };
    // Triangles and sizes: NOTICE.md beside the data. Those without an area were counted apart in Python.
    for (file, triangles, degenerate, size, tolerance) in [
        (
            "living_room/living_room.glb",
            5088,
            3537,
            [10.0, 5.5, 14.5],
            1e-5,
        ),
        (
            "volumetric_fog/VolumetricFogExample.glb",
            360,
            0,
            [6.3, 6.3, 13.5],
            0.05,
        ),
        ("terrain/Mountains.gltf", 25_600, 0, [2.0, 0.34, 2.0], 0.01),
        ("gazebo/gazebo.obj", 730, 0, [0.9, 0.9, 0.9], 0.05),
    ] {
        let scene =
            scene::load(&data.join("scenes").join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        assert_eq!(scene.mesh.triangles.len() + degenerate, triangles, "{file}");
        let warned = scene
            .warnings
            .iter()
            .any(|w| w.contains(&format!("{degenerate} triangles without an area")));
        assert_eq!(warned, degenerate > 0, "{file}: {:?}", scene.warnings);
        let (min, max) = scene.mesh.bounds().expect("there are triangles");
        assert!(
            (max - min - DVec3::from(size)).abs().max_element() < tolerance,
            "{file}: {}",
            max - min
        );
        assert!(
            scene
                .mesh
                .triangles
                .iter()
                .all(|t| (t.material as usize) < scene.materials.len())
        );
    }
    let fog = scene::load(&data.join("scenes/volumetric_fog/VolumetricFogExample.glb"))
        .expect("it loads");
    assert_eq!((fog.lights.len(), fog.lights[0].color.x), (1, 68_300.0));
    assert_eq!(
        (fog.textures.len(), fog.materials[0].texture),
        (0, None),
        "its one picture is a normal map"
    );
}

/// Another reader, the gltf crate, sees the same vertices in the same places.
#[test]
fn the_gltf_crate_agrees() {
    let folder = Folder::new();
    let (json, bin) = example();
    let mut files = vec![folder.put("example.glb", glb(&json, &bin))];
    if let Some(data) = common::data("the_gltf_crate_agrees") {
        let names = [
            "living_room/living_room.glb",
            "volumetric_fog/VolumetricFogExample.glb",
            "terrain/Mountains.gltf",
        ];
        files.extend(names.map(|file| data.join("scenes").join(file)));
    }
    for file in files {
        let ours = scene::load(&file).expect("it loads");
        let gltf =
            gltf::Gltf::from_slice_without_validation(&std::fs::read(&file).expect("it is there"))
                .expect("they load it");
        let buffers =
            gltf::import_buffers(&gltf, file.parent(), gltf.blob.clone()).expect("they load it");
        let mut theirs = Vec::new();
        let mut stack: Vec<_> = gltf
            .scenes()
            .next()
            .expect("a scene")
            .nodes()
            .map(|n| (n, DAffine3::IDENTITY))
            .collect();
        stack.reverse();
        while let Some((node, parent)) = stack.pop() {
            let (t, r, s) = node.transform().decomposed();
            let local = DAffine3::from_scale_rotation_translation(
                DVec3::from(s.map(f64::from)),
                DQuat::from_array(r.map(f64::from)).normalize(),
                DVec3::from(t.map(f64::from)),
            );
            let to_scene = parent * local;
            for primitive in node
                .mesh()
                .into_iter()
                .flat_map(|m| m.primitives().collect::<Vec<_>>())
            {
                let reader =
                    primitive.reader(|buffer| buffers.get(buffer.index()).map(|b| &b.0[..]));
                let normals = reader.read_normals().expect("they have normals");
                for (p, n) in reader.read_positions().expect("positions").zip(normals) {
                    let normal =
                        to_scene.matrix3.inverse().transpose() * DVec3::from(n.map(f64::from));
                    theirs.push((
                        to_scene.transform_point3(DVec3::from(p.map(f64::from))),
                        normal.normalize(),
                    ));
                }
            }
            let children: Vec<_> = node.children().map(|c| (c, to_scene)).collect();
            stack.extend(children.into_iter().rev());
        }
        assert_eq!(
            ours.mesh.positions.len(),
            theirs.len(),
            "{}",
            file.display()
        );
        for (i, (position, normal)) in theirs.into_iter().enumerate() {
            // Their transforms are f32: 1e-6 of each number.
            let allowed = 1e-6 * (1.0 + position.abs().max_element());
            assert!(
                ours.mesh.positions[i].distance(position) < allowed,
                "{} vertex {i}",
                file.display()
            );
            assert!(
                ours.mesh.normals[i].distance(normal) < 1e-5,
                "{} normal {i}",
                file.display()
            );
        }
    }
}

/// xorshift64*: the same damage on every machine.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize % sides.max(1)
    }
}

/// Damages a file in `rounds` ways; loading must give a scene that holds together, or an error with a remedy.
fn survives_damage(folder: &Folder, name: &str, good: &[u8], rounds: usize) {
    let mut dice = Dice(0x7_9DA1 + good.len() as u64);
    let (mut loaded, mut refused) = (0, 0);
    for round in 0..rounds {
        let mut bytes = good.to_vec();
        if round % 4 == 0 {
            bytes.truncate(dice.roll(bytes.len()));
        } else {
            // Often in the first bytes, where structure is: JSON, header.
            let reach = if round % 2 == 0 {
                bytes.len()
            } else {
                bytes.len().min(4000)
            };
            for _ in 0..1 + dice.roll(4) {
                let at = dice.roll(reach);
                bytes[at] = match dice.roll(4) {
                    0 => 255,
                    1 => b'0' + dice.roll(10) as u8,
                    2 => bytes[at] ^ 1 << dice.roll(8),
                    _ => dice.roll(256) as u8,
                };
            }
        }
        let path = folder.put(name, &bytes);
        match std::panic::catch_unwind(|| scene::load(&path)) {
            Ok(Ok(scene)) => {
                loaded += 1;
                let count = scene.mesh.positions.len();
                assert!(
                    scene.mesh.positions.iter().all(|p| p.is_finite()),
                    "{name} {round}"
                );
                assert!(
                    [scene.mesh.normals.len(), scene.mesh.uvs.len()]
                        .iter()
                        .all(|&n| n == count),
                    "{name} {round}"
                );
                for t in &scene.mesh.triangles {
                    assert!(
                        t.vertices.iter().all(|&v| (v as usize) < count),
                        "{name} {round}"
                    );
                    assert!(
                        (t.material as usize) < scene.materials.len(),
                        "{name} {round}"
                    );
                }
                assert!(
                    scene
                        .materials
                        .iter()
                        .all(|m| m.texture.is_none_or(|t| t < scene.textures.len()))
                );
            }
            Ok(Err(error)) => {
                refused += 1;
                assert!(
                    error.to_string().contains(name) && !error.remedy().is_empty(),
                    "{name} {round}: {error}"
                );
            }
            Err(_) => panic!(
                "{name}: round {round} panics; the file was {} bytes",
                bytes.len()
            ),
        }
    }
    assert!(
        refused > rounds / 8,
        "{name}: the damage does no harm: {loaded} load, {refused} do not"
    );
}

#[test]
fn damaged_files_never_panic() {
    let folder = Folder::new();
    let (json, bin) = example();
    survives_damage(&folder, "a.glb", &glb(&json, &bin), 800);
    folder.put("bin.bin", &bin);
    folder.put("room.obj", ROOM);
    let mut text = json;
    text["buffers"][0]["uri"] = json!("bin.bin");
    survives_damage(&folder, "b.gltf", text.to_string().as_bytes(), 800);
    survives_damage(&folder, "c.obj", ROOM.repeat(3).as_bytes(), 300);
    survives_damage(&folder, "d.toml", EXAMPLE_TOML.as_bytes(), 800);
    let Some(data) = common::data("damaged_files_never_panic") else {
        return;
    };
    let real = |file: &str| std::fs::read(data.join("scenes").join(file)).expect("it is there");
    folder.put("Mountains.bin", real("terrain/Mountains.bin"));
    survives_damage(&folder, "e.glb", &real("living_room/living_room.glb"), 300);
    survives_damage(
        &folder,
        "f.glb",
        &real("volumetric_fog/VolumetricFogExample.glb"),
        100,
    );
    survives_damage(&folder, "g.gltf", &real("terrain/Mountains.gltf"), 300);
    survives_damage(&folder, "h.obj", &real("gazebo/gazebo.obj"), 200);
}
