//! Nothing of a glTF file is left out in silence.

mod common;

use common::gltf::*;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// All properties of glTF 2.0 (Khronos, chapter 5), of lamps and of instances.
const SCHEMA: &str = "
accessor: bufferView byteOffset componentType normalized count type max min sparse name
sparse: count indices values
sparse.indices: bufferView byteOffset componentType
sparse.values: bufferView byteOffset
animation: channels samplers name
asset: copyright generator version minVersion
buffer: uri byteLength name
bufferView: buffer byteOffset byteLength byteStride target name
camera: orthographic perspective type name
orthographic: xmag ymag zfar znear
perspective: aspectRatio yfov zfar znear
glTF: extensionsUsed extensionsRequired accessors animations asset buffers bufferViews cameras images materials meshes nodes samplers scene scenes skins textures
image: uri mimeType bufferView name
material: name pbrMetallicRoughness normalTexture occlusionTexture emissiveTexture emissiveFactor alphaMode alphaCutoff doubleSided
pbrMetallicRoughness: baseColorFactor baseColorTexture metallicFactor roughnessFactor metallicRoughnessTexture
normalTextureInfo: index texCoord scale
occlusionTextureInfo: index texCoord strength
textureInfo: index texCoord
mesh: primitives weights name
primitive: attributes indices material mode targets
attributes: POSITION NORMAL TANGENT TEXCOORD_0 TEXCOORD_1 COLOR_0 COLOR_1 JOINTS_0 WEIGHTS_0 _OWN
target: POSITION NORMAL TANGENT TEXCOORD_0 COLOR_0
node: camera children skin matrix mesh rotation scale translation weights name
sampler: magFilter minFilter wrapS wrapT name
scene: nodes name
skin: inverseBindMatrices skeleton joints name
texture: sampler source name
light: name color intensity type range spot
instancing: TRANSLATION ROTATION SCALE COLOR_0
";

/// A property, where one stands in the example, another value for it, and what becomes of it: the scene changes, a warning
/// says these words, the file is refused, or it says nothing about the picture. Of the silent ones: a camera's `type` and a
/// picture's `mimeType` are told by what they hold, nodes name cameras first, the picture's size gives a camera's proportions
/// and nothing is clipped, surfaces have two sides, tangents belong to normal textures, attributes with an underscore to
/// applications.
const TABLE: &str = r#"
accessor.bufferView | /accessors/0/bufferView | 1 | refused
accessor.byteOffset | /accessors/2/byteOffset | 1 | refused
accessor.componentType | /accessors/0/componentType | 1 | refused
accessor.normalized | /accessors/3/normalized | false | changes
accessor.count | /accessors/0/count | 3 | refused
accessor.type | /accessors/0/type | "VEC4" | refused
accessor.max | /accessors/0/max | [9, 9, 9] | silent
accessor.min | /accessors/0/min | [9, 9, 9] | silent
accessor.name | /accessors/0/name | "it" | silent
accessor.sparse | /accessors/0/sparse | {"count": 1, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 1}} | changes
sparse.count | /accessors/0/sparse | {"count": 7, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 1}} | refused
sparse.indices | /accessors/0/sparse | {"count": 1, "indices": {"bufferView": 99}, "values": {"bufferView": 1}} | refused
sparse.values | /accessors/0/sparse | {"count": 1, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 99}} | refused
sparse.indices.bufferView | /accessors/0/sparse | {"count": 1, "indices": {"bufferView": 4, "componentType": 5121}, "values": {"bufferView": 1}} | refused
sparse.indices.byteOffset | /accessors/0/sparse | {"count": 1, "indices": {"bufferView": 2, "byteOffset": 1, "componentType": 5121}, "values": {"bufferView": 1}} | changes
sparse.indices.componentType | /accessors/0/sparse | {"count": 1, "indices": {"bufferView": 2, "componentType": 1}, "values": {"bufferView": 1}} | refused
sparse.values.bufferView | /accessors/0/sparse | {"count": 1, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 0}} | silent
sparse.values.byteOffset | /accessors/0/sparse | {"count": 1, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 0, "byteOffset": 12}} | changes
animation.channels | /animations | [{"channels": [{}]}] | says animation
animation.samplers | /animations | [{"samplers": [{}]}] | says animation
animation.name | /animations | [{"name": "walk"}] | says animation
asset.copyright | /asset/copyright | "me" | silent
asset.generator | /asset/generator | "it" | silent
asset.version | /asset/version | "1.0" | refused
asset.minVersion | /asset/minVersion | "2.7" | refused
buffer.uri | /buffers/0/uri | "data:,short" | refused
buffer.byteLength | /buffers/0/byteLength | 7 | refused
buffer.name | /buffers/0/name | "it" | silent
bufferView.buffer | /bufferViews/0/buffer | 9 | refused
bufferView.byteOffset | /bufferViews/0/byteOffset | 12 | changes
bufferView.byteLength | /bufferViews/0/byteLength | 7 | refused
bufferView.byteStride | /bufferViews/0/byteStride | 16 | refused
bufferView.target | /bufferViews/0/target | 34962 | silent
bufferView.name | /bufferViews/0/name | "it" | silent
camera.orthographic | /cameras/1/orthographic | {"ymag": 7} | changes
camera.perspective | /cameras/0/perspective | {"yfov": 0.5} | changes
camera.type | /cameras/0/type | "both" | silent
camera.name | /cameras/0/name | "it" | silent
orthographic.xmag | /cameras/1/orthographic/xmag | 9 | silent
orthographic.ymag | /cameras/1/orthographic/ymag | 9 | changes
orthographic.zfar | /cameras/1/orthographic/zfar | 9 | silent
orthographic.znear | /cameras/1/orthographic/znear | 9 | silent
perspective.aspectRatio | /cameras/0/perspective/aspectRatio | 9 | silent
perspective.yfov | /cameras/0/perspective/yfov | 0.5 | changes
perspective.zfar | /cameras/0/perspective/zfar | 9 | silent
perspective.znear | /cameras/0/perspective/znear | 9 | silent
glTF.extensionsUsed | /extensionsUsed | ["ACME_it"] | silent
glTF.extensionsRequired | /extensionsRequired | ["ACME_it"] | refused
glTF.accessors | /accessors | [] | refused
glTF.animations | /animations | [{}] | says animation
glTF.asset | /asset | {} | refused
glTF.buffers | /buffers | [] | refused
glTF.bufferViews | /bufferViews | [] | refused
glTF.cameras | /cameras | [] | refused
glTF.images | /images | [] | refused
glTF.materials | /materials | [] | refused
glTF.meshes | /meshes | [] | refused
glTF.nodes | /nodes | [] | refused
glTF.samplers | /samplers | [] | refused
glTF.scene | /scene | 5 | refused
glTF.scenes | /scenes | [{"nodes": [3]}] | changes
glTF.skins | /skins | [] | refused
glTF.textures | /textures | [] | refused
image.uri | /images/0/uri | "gone.png" | says gone.png
image.mimeType | /images/0/mimeType | "image/jpeg" | silent
image.bufferView | /images/0/bufferView | 0 | says images[0]
image.name | /images/0/name | "it" | silent
material.name | /materials/0/name | "it" | changes
material.pbrMetallicRoughness | /materials/0/pbrMetallicRoughness | {"metallicFactor": 0} | changes
material.normalTexture | /materials/0/normalTexture | {"index": 0} | says normal texture
material.occlusionTexture | /materials/0/occlusionTexture | {"index": 0} | says occlusion texture
material.emissiveTexture | /materials/0/emissiveTexture | {"index": 0} | says emissive texture whose factor
material.emissiveFactor | /materials/0/emissiveFactor | [1, 0, 0] | changes
material.alphaMode | /materials/0/alphaMode | "BLEND" | changes
material.alphaCutoff | /materials/0/alphaCutoff | 0.5 | changes
material.doubleSided | /materials/0/doubleSided | true | silent
pbrMetallicRoughness.baseColorFactor | /materials/0/pbrMetallicRoughness/baseColorFactor | [0, 0, 0, 1] | changes
pbrMetallicRoughness.baseColorTexture | /materials/0/pbrMetallicRoughness/baseColorTexture | {"index": 9} | refused
pbrMetallicRoughness.metallicFactor | /materials/0/pbrMetallicRoughness/metallicFactor | 1 | says metallic
pbrMetallicRoughness.roughnessFactor | /materials/0/pbrMetallicRoughness/roughnessFactor | 0.5 | says roughness
pbrMetallicRoughness.metallicRoughnessTexture | /materials/0/pbrMetallicRoughness/metallicRoughnessTexture | {"index": 0} | says metallic-roughness texture
normalTextureInfo.index | /materials/0/normalTexture | {"index": 0} | says normal texture
normalTextureInfo.texCoord | /materials/0/normalTexture | {"texCoord": 0} | says normal texture
normalTextureInfo.scale | /materials/0/normalTexture | {"scale": 2} | says normal texture
occlusionTextureInfo.index | /materials/0/occlusionTexture | {"index": 0} | says occlusion texture
occlusionTextureInfo.texCoord | /materials/0/occlusionTexture | {"texCoord": 0} | says occlusion texture
occlusionTextureInfo.strength | /materials/0/occlusionTexture | {"strength": 2} | says occlusion texture
textureInfo.index | /materials/0/pbrMetallicRoughness/baseColorTexture/index | 9 | refused
textureInfo.texCoord | /materials/0/pbrMetallicRoughness/baseColorTexture | {"index": 0, "texCoord": 1} | says TEXCOORD_1
mesh.primitives | /meshes/0/primitives | [] | changes
mesh.weights | /meshes/0/weights | [0, 0] | changes
mesh.name | /meshes/0/name | "it" | silent
primitive.attributes | /meshes/0/primitives/0/attributes | {} | says POSITION
primitive.indices | /meshes/0/primitives/0/indices | 99 | refused
primitive.material | /meshes/0/primitives/0/material | 99 | refused
primitive.mode | /meshes/0/primitives/0/mode | 1 | says points or lines
primitive.targets | /meshes/0/primitives/0/targets | [] | says morph weight
attributes.POSITION | /meshes/0/primitives/0/attributes/POSITION | 1 | changes
attributes.NORMAL | /meshes/0/primitives/0/attributes/NORMAL | 0 | changes
attributes.TANGENT | /meshes/0/primitives/0/attributes/TANGENT | 0 | silent
attributes.TEXCOORD_0 | /meshes/0/primitives/0/attributes/TEXCOORD_0 | 0 | refused
attributes.TEXCOORD_1 | /meshes/0/primitives/0/attributes/TEXCOORD_1 | 0 | silent
attributes.COLOR_0 | /meshes/0/primitives/0/attributes/COLOR_0 | 0 | changes
attributes.COLOR_1 | /meshes/0/primitives/0/attributes/COLOR_1 | 0 | says COLOR_1
attributes.JOINTS_0 | /meshes/0/primitives/0/attributes/JOINTS_0 | 0 | refused
attributes.WEIGHTS_0 | /meshes/0/primitives/0/attributes/WEIGHTS_0 | 0 | refused
attributes._OWN | /meshes/0/primitives/0/attributes/_OWN | 0 | silent
target.POSITION | /meshes/0/primitives/0/targets/0/POSITION | 1 | changes
target.NORMAL | /meshes/0/primitives/0/targets/0/NORMAL | 0 | changes
target.TANGENT | /meshes/0/primitives/0/targets/0/TANGENT | 0 | silent
target.TEXCOORD_0 | /meshes/0/primitives/0/targets/0/TEXCOORD_0 | 3 | changes
target.COLOR_0 | /meshes/0/primitives/0/targets/0/COLOR_0 | 0 | changes
node.camera | /nodes/4/camera | 1 | changes
node.children | /nodes/0/children | [1] | changes
node.skin | /nodes/1/skin | 9 | refused
node.matrix | /nodes/4/matrix | [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] | changes
node.mesh | /nodes/3/mesh | 9 | refused
node.rotation | /nodes/3/rotation | [0, 0, 0, 1] | changes
node.scale | /nodes/3/scale | [1, 1, 1] | changes
node.translation | /nodes/0/translation | [0, 0, 0] | changes
node.weights | /nodes/3/weights | [0, 1] | changes
node.name | /nodes/4/name | "it" | changes
sampler.magFilter | /samplers/0/magFilter | 9729 | says smooth texture filter
sampler.minFilter | /samplers/0/minFilter | 9987 | says smooth texture filter
sampler.wrapS | /samplers/0/wrapS | 10497 | changes
sampler.wrapT | /samplers/0/wrapT | 10497 | changes
sampler.name | /samplers/0/name | "it" | silent
scene.nodes | /scenes/0/nodes | [3] | changes
scene.name | /scenes/0/name | "it" | silent
skin.inverseBindMatrices | /skins/0/inverseBindMatrices | 0 | refused
skin.skeleton | /skins/0/skeleton | 0 | silent
skin.joints | /skins/0/joints | [7, 2] | changes
skin.name | /skins/0/name | "it" | silent
texture.sampler | /textures/0/sampler | 9 | refused
texture.source | /textures/0/source | 9 | refused
texture.name | /textures/0/name | "it" | silent
light.name | /extensions/KHR_lights_punctual/lights/0/name | "it" | changes
light.color | /extensions/KHR_lights_punctual/lights/0/color | [1, 1, 1] | changes
light.intensity | /extensions/KHR_lights_punctual/lights/0/intensity | 7 | changes
light.type | /extensions/KHR_lights_punctual/lights/0/type | "point" | changes
light.range | /extensions/KHR_lights_punctual/lights/0/range | 7 | says range of a lamp
light.spot | /extensions/KHR_lights_punctual/lights/0/spot | {} | changes
instancing.TRANSLATION | /nodes/3/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION | 99 | refused
instancing.ROTATION | /nodes/3/extensions/EXT_mesh_gpu_instancing/attributes/ROTATION | 0 | refused
instancing.SCALE | /nodes/3/extensions/EXT_mesh_gpu_instancing/attributes/SCALE | 0 | refused
instancing.COLOR_0 | /nodes/3/extensions/EXT_mesh_gpu_instancing/attributes/COLOR_0 | 0 | says COLOR_0
"#;

#[test]
fn every_property_reaches_the_scene_or_is_named() {
    let good = Gltf::rich();
    let plain = seen(&good.silent());
    let (mut covered, mut complaints) = (BTreeSet::new(), Vec::new());
    for line in TABLE.lines().filter(|line| !line.is_empty()) {
        let [name, at, value, then] = *line.split(" | ").collect::<Vec<_>>() else {
            panic!("{line}")
        };
        covered.insert(name);
        let (object, property) = at.rsplit_once('/').expect("a property of an object");
        let mut file = good.clone();
        file.json.pointer_mut(object).expect("it is in the example")[property] =
            serde_json::from_str(value).unwrap_or_else(|e| panic!("{line}: {e}"));
        let expected = match (file.load(), then) {
            (Err(_), "refused") => true,
            (Ok(scene), "changes") => seen(&scene) != plain,
            (Ok(scene), "silent") => scene.warnings.is_empty() && seen(&scene) == plain,
            (Ok(scene), then) => then.strip_prefix("says ").is_some_and(|what| {
                let mut warnings = scene.warnings.iter();
                warnings.any(|w| w.message().contains(what))
            }),
            (Err(_), _) => false,
        };
        if !expected {
            let outcome = file
                .load()
                .map(|scene| (seen(&scene) == plain, scene.warnings));
            complaints.push(format!("{line}: {outcome:?}"));
        }
    }
    assert_eq!(complaints, [""; 0]);
    for (kind, properties) in SCHEMA.lines().filter_map(|line| line.split_once(": ")) {
        for property in properties.split(' ') {
            let name = format!("{kind}.{property}");
            assert!(covered.contains(&name[..]), "{name} is not in the table");
        }
    }
}

/// Every object of the example, whatever its kind.
fn objects(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            let own = at.rsplit('/').next().unwrap_or_default();
            if !matches!(own, "attributes" | "extensions")
                && !at.contains("/targets/")
                && !at.contains("/extensions/")
            {
                found.push(at.to_owned());
            }
            map.iter()
                .for_each(|(key, value)| objects(value, &format!("{at}/{key}"), found));
        }
        Value::Array(list) => {
            list.iter()
                .enumerate()
                .for_each(|(i, value)| objects(value, &format!("{at}/{i}"), found));
        }
        _ => {}
    }
}

#[test]
fn what_nobody_knows_is_named_in_every_object() {
    let good = Gltf::rich();
    let plain = seen(&good.silent());
    let mut found = Vec::new();
    objects(&good.json, "", &mut found);
    assert!(found.len() > 40);
    for at in found {
        for (key, value, says) in [
            ("specularTint", json!(0.5), Some("specularTint")),
            ("extensions", json!({"ACME_glow": {}}), Some("ACME_glow")),
            ("extras", json!({"note": 7}), None),
        ] {
            let mut file = good.clone();
            let object = file.json.pointer_mut(&at).expect("it was found there");
            match (key, object.get_mut("extensions")) {
                ("extensions", Some(present)) => present["ACME_glow"] = json!({}),
                _ => object[key] = value,
            }
            let scene = file.load().unwrap_or_else(|e| panic!("{at}.{key}: {e}"));
            assert_eq!(seen(&scene), plain, "{at}.{key}");
            match says {
                None => assert_eq!(scene.warnings, [], "{at}.{key}"),
                Some(what) => assert!(
                    scene.warnings.iter().any(|w| w.message().contains(what)),
                    "{at}.{key}: {:?}",
                    scene.warnings
                ),
            }
        }
    }
}

/// A change to the example, and what a warning then says.
type Change = (&'static str, fn(&mut Gltf), &'static str);

/// What no property alone tells: where things stand, and whether anything uses them.
const CHANGES: [Change; 17] = [
    (
        "a mesh of another scene",
        |file| {
            push(file, "nodes", json!({"mesh": 1}));
            push(file, "scenes", json!({"nodes": [8]}));
        },
        "mesh of a node in a scene that is not shown (1)",
    ),
    (
        "a mesh below a node of no scene",
        |file| {
            push(file, "nodes", json!({"mesh": 1}));
            push(file, "nodes", json!({"children": [8]}));
        },
        "mesh of a node that is in no scene (1)",
    ),
    (
        "a camera of no scene",
        |file| push(file, "nodes", json!({"camera": 1})),
        "camera of a node that is in no scene (1)",
    ),
    (
        "a lamp of no scene",
        |file| {
            let lamp = json!({"extensions": {"KHR_lights_punctual": {"light": 0}}});
            push(file, "nodes", lamp);
        },
        "lamp of a node that is in no scene (1)",
    ),
    (
        "a mesh of nobody",
        |file| {
            let mesh = file.json["meshes"][1].clone();
            push(file, "meshes", mesh);
        },
        "mesh that no node uses (1)",
    ),
    (
        "a camera of nobody",
        |file| push(file, "cameras", json!({"perspective": {"yfov": 1}})),
        "camera that no node uses (1)",
    ),
    (
        "a lamp of nobody",
        |file| {
            let lights = &mut file.json["extensions"]["KHR_lights_punctual"]["lights"];
            let lights = lights.as_array_mut().expect("a list");
            lights.push(json!({"type": "point"}));
        },
        "lamp that no node uses (1)",
    ),
    (
        "a skin of nobody",
        |file| push(file, "skins", json!({"joints": [2]})),
        "skin that no node uses (1)",
    ),
    (
        "a skin without a mesh",
        |file| file.json["nodes"][7]["skin"] = json!(0),
        "skin of a node without a mesh (1)",
    ),
    (
        "a texture of nobody",
        |file| push(file, "textures", json!({"source": 0})),
        "texture that no material uses (1)",
    ),
    (
        "a picture of nobody",
        |file| push(file, "images", json!({"bufferView": 0})),
        "picture that no texture uses (1)",
    ),
    (
        "a matrix and more",
        |file| file.json["nodes"][4]["translation"] = json!([1, 1, 1]),
        "translation, rotation and scale of a node that has a matrix (1)",
    ),
    (
        "a matrix that projects",
        |file| file.json["nodes"][4]["matrix"][3] = json!(0.5),
        "last row of a node's matrix that is not 0 0 0 1 (1)",
    ),
    (
        "a rotation of another length",
        |file| file.json["nodes"][3]["rotation"] = json!([0, 1.2, 0, 1.6]),
        "length of a rotation that is not 1 (1)",
    ),
    (
        "an unknown wrapping",
        |file| file.json["samplers"][0]["wrapS"] = json!(7),
        "wrapS or wrapT that glTF 2.0 does not know, taken as REPEAT (1)",
    ),
    (
        "an unknown filter",
        |file| file.json["samplers"][0]["magFilter"] = json!(7),
        "smooth texture filter (1)",
    ),
    (
        "joints without a skin",
        |file| {
            drop(
                file.json["nodes"][1]
                    .as_object_mut()
                    .expect("it")
                    .remove("skin"),
            )
        },
        "joints and weights of a mesh whose node has no skin (1)",
    ),
];

fn push(file: &mut Gltf, list: &str, entry: Value) {
    file.json[list].as_array_mut().expect("a list").push(entry);
}

#[test]
fn what_nothing_shows_is_named() {
    for (what, change, says) in CHANGES {
        let mut file = Gltf::rich();
        change(&mut file);
        let scene = file.load().unwrap_or_else(|e| panic!("{what}: {e}"));
        let mut warnings = scene.warnings.iter();
        let said = warnings.any(|w| w.message().contains(says));
        assert!(said, "{what}: {:?}", scene.warnings);
    }
    // Of what is left out the scene stays the same.
    let plain = seen(&Gltf::rich().silent());
    for (what, change, _) in CHANGES {
        let mut file = Gltf::rich();
        change(&mut file);
        let same = seen(&file.load().expect("it loads")) == plain;
        let changes = ["an unknown wrapping", "joints without a skin"];
        assert_eq!(same, !changes.contains(&what), "{what}");
    }
}

#[test]
fn normals_without_a_length_are_named() {
    let mut file = Gltf::quad();
    let normals = file.floats(
        "VEC3",
        &[[0.0; 3], [0.0, 0.6, 0.8], [0.0; 3], [0.0, 0.6, 0.8]].concat(),
    );
    file.primitive()["attributes"]["NORMAL"] = json!(normals);
    let warnings = file.load().expect("it loads").warnings;
    let said = |w: &tyndall::Warning| {
        w.message()
            .contains("NORMAL without a length, for which stands the triangle's own (2)")
    };
    assert!(warnings.iter().any(said), "{warnings:?}");
}

#[test]
fn names_are_short_and_without_control_characters() {
    let mut file = Gltf::rich();
    let odd = format!("a\u{1b}[31m\nb{}", "x".repeat(1000));
    for name in [
        "/nodes/4/name",
        "/materials/0/name",
        "/extensions/KHR_lights_punctual/lights/0/name",
    ] {
        *file.json.pointer_mut(name).expect("it is there") = json!(odd);
    }
    let scene = file.silent();
    for name in [
        &scene.cameras[0].name,
        &scene.materials[0].name,
        &scene.lights[0].name,
    ] {
        assert!(
            name.starts_with("a [31m b") && name.chars().count() < 70,
            "{name:?}"
        );
        assert!(!name.contains(char::is_control), "{name:?}");
    }
}

#[test]
fn a_node_so_far_away_that_triangles_vanish_is_refused() {
    let mut file = Gltf::quad();
    file.json["nodes"][0]["translation"] = json!([1e20, 0, 0]);
    let error = file.load().expect_err("it is too far away").to_string();
    assert!(error.contains("1e12 m from the origin"), "{error}");
}
