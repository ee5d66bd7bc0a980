//! glTF meshes that are bent, moved, multiplied and hidden: each stands as a plain mesh in the same place does.

mod common;

use common::files::*;
use common::gltf::*;
use serde_json::json;
use tyndall::scene::Scene;

/// The sheet with its corners moved by `change`, and its normals turned by the inverse transpose of what that is.
fn plain(change: impl Fn([f32; 3]) -> [f32; 3], normal: [f32; 3]) -> Scene {
    let mut file = Gltf::quad();
    let positions = file.floats("VEC3", &QUAD.map(change).concat());
    let normals = file.floats("VEC3", &normal.repeat(4));
    file.primitive()["attributes"] = json!({"POSITION": positions, "NORMAL": normals});
    file.silent()
}

const NORMAL: [f32; 3] = [0.0, 0.6, 0.8];
const FIRST: [[f32; 4]; 4] = [[1.0, 0.0, 0.0, 0.0]; 4];

#[test]
fn skins_stand_where_their_joints_are() {
    let unmoved = Gltf::quad().silent();
    // As Mixamo and Blender write it: a mesh in centimetres under an armature scaled by 0.01.
    let mut armature = Gltf::quad();
    let large = armature.floats("VEC3", &QUAD.map(|p| p.map(|x| 100.0 * x)).concat());
    armature.primitive()["attributes"]["POSITION"] = json!(large);
    armature.bind(0, [[0; 4]; 4], FIRST);
    armature.json["nodes"] =
        json!([{"scale": [0.01, 0.01, 0.01], "children": [1, 2]}, {"mesh": 0, "skin": 0}, {}]);
    armature.json["skins"] = json!([{"joints": [2]}]);
    assert_same(&armature.silent(), &unmoved);

    // The node that has the mesh plays no part, nor does what is above it.
    let mut file = Gltf::quad();
    file.bind(0, [[0; 4]; 4], FIRST);
    file.json["nodes"] = json!([{"children": [1], "translation": [0, 50, 0]}, {"mesh": 0, "skin": 0, "scale": [7, 7, -7]}, {}]);
    file.json["scenes"][0]["nodes"] = json!([0, 2]);
    file.json["skins"] = json!([{"joints": [2]}]);
    assert_same(&file.silent(), &unmoved);
    // A skeleton beside the scene counts with all that is above it.
    file.json["scenes"][0]["nodes"] = json!([0]);
    file.json["nodes"]
        .as_array_mut()
        .expect("a list")
        .push(json!({"translation": [3, 0, 0], "children": [2]}));
    assert_same(&file.silent(), &plain(|[x, y, z]| [x + 3.0, y, z], NORMAL));
    // The inverse bind matrix comes first: here it moves back and halves.
    let bind = [
        0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, -1.5, 0.0, 0.0, 1.0,
    ];
    let bind = file.floats("MAT4", &bind);
    file.json["skins"][0]["inverseBindMatrices"] = json!(bind);
    assert_same(
        &file.silent(),
        &plain(|[x, y, z]| [0.5 * x + 1.5, 0.5 * y, 0.5 * z], NORMAL),
    );
    // A mirroring joint keeps the front in front.
    file.json["skins"][0]
        .as_object_mut()
        .expect("an object")
        .remove("inverseBindMatrices");
    file.json["nodes"][3] = json!({"scale": [-1, 1, 1], "children": [2]});
    let mirrored = file.silent();
    let mut node = Gltf::quad();
    node.json["nodes"][0]["scale"] = json!([-1, 1, 1]);
    assert_same(&mirrored, &node.silent());
}

#[test]
fn several_joints_share_a_vertex_by_their_weights() {
    let mut file = Gltf::quad();
    file.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"translation": [0, 4, 0]}, {}]);
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    file.json["skins"] = json!([{"joints": [1, 2]}]);
    let quarter = plain(|[x, y, z]| [x, y + 1.0, z], NORMAL);
    let mut halves = file.clone();
    halves.bind(0, [[0, 1, 9, 9]; 4], [[0.25, 0.75, 0.0, 0.0]; 4]);
    assert_same(&halves.silent(), &quarter);
    // Weights that do not add up to one are shares all the same.
    let mut shares = file.clone();
    shares.bind(0, [[0, 1, 0, 0]; 4], [[0.5, 1.5, 0.0, 0.0]; 4]);
    assert_same(&shares.silent(), &quarter);
    // Eight joints a vertex.
    let mut sets = file.clone();
    sets.bind(0, [[1; 4]; 4], [[0.25, 0.25, 0.125, 0.125]; 4]);
    sets.bind(1, [[0, 0, 1, 1]; 4], [[0.125, 0.125, 0.0, 0.0]; 4]);
    assert_same(&sets.silent(), &quarter);
    // Bytes that stand for fractions: 51 / 255 and 153 / 255.
    let mut bytes = file.clone();
    bytes.bind(0, [[0, 1, 0, 0]; 4], FIRST);
    let weights = bytes.accessor("VEC4", BYTE, 4, &[51, 153, 0, 0].repeat(4));
    bytes.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    assert_same(&bytes.silent(), &quarter);
    // Without a weight a vertex goes with its first joint, and that is said.
    let mut none = file.clone();
    none.bind(0, [[1; 4]; 4], [[0.0; 4]; 4]);
    let scene = none.load().expect("it loads");
    assert_same(&scene, &Gltf::quad().silent());
    assert!(
        scene.warnings[0].message().contains("4 vertex attributes"),
        "{:?}",
        scene.warnings
    );
    // A mesh that no joint holds stands where its node is, and that is said.
    let mut unbound = file.clone();
    unbound.json["nodes"][0]["translation"] = json!([0, 1, 0]);
    let scene = unbound.load().expect("it loads");
    assert_same(&scene, &quarter);
    assert!(
        scene.warnings[0].message().contains("not bound to joints"),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn damaged_skins_are_named() {
    let mut file = Gltf::rich();
    let short = file.floats("MAT4", &identities(1));
    let flat = file.floats("MAT4", &[0.0; 32]);
    let mut infinite = identities(2);
    infinite[20] = f32::NAN;
    let infinite = file.floats("MAT4", &infinite);
    let vectors = file.floats("VEC3", &[0.0; 6]);
    for (matrices, says) in [
        (short, "1 for 2 joints"),
        (flat, "matrix 0"),
        (infinite, "matrix 1"),
        (vectors, "VEC3"),
        (99, "99"),
    ] {
        file.json["skins"][0]["inverseBindMatrices"] = json!(matrices);
        let text = Folder::new().refused("it.glb", file.glb());
        assert!(
            text.contains("skins[0].inverseBindMatrices") || matrices == vectors,
            "{text}"
        );
        assert!(text.contains(says), "{text}");
    }
    let good = Gltf::rich();
    for (joints, says) in [(json!([2]), "joint 1"), (json!([2, 99]), "nodes[99]")] {
        let mut file = good.clone();
        file.json["skins"][0]["joints"] = joints;
        let text = Folder::new().refused("it.glb", file.glb());
        assert!(text.contains(says), "{text}");
    }
    let mut file = good.clone();
    file.json["nodes"][1]["skin"] = json!(3);
    assert!(
        Folder::new()
            .refused("it.glb", file.glb())
            .contains("skins[3]")
    );
    // A joint below itself, beside the scene.
    let mut file = good;
    file.json["nodes"]
        .as_array_mut()
        .expect("a list")
        .push(json!({"children": [8]}));
    file.json["skins"][0]["joints"] = json!([8, 8]);
    assert!(
        Folder::new()
            .refused("it.glb", file.glb())
            .contains("below itself")
    );
}

#[test]
fn morph_targets_go_by_their_weights() {
    let raised = plain(|[x, y, z]| [x, y + 0.5, z], NORMAL);
    let mut file = Gltf::quad();
    let up = file.floats("VEC3", &[0.0, 1.0, 0.0].repeat(4));
    let turned = file.floats("VEC3", &[0.0, 0.0, -1.6].repeat(4));
    let colors = file.floats("VEC3", &[1.0; 12]);
    let red = file.floats("VEC3", &[0.0, -0.5, -1.0].repeat(4));
    file.primitive()["targets"] = json!([{"POSITION": up}, {"NORMAL": turned}, {"COLOR_0": red}]);
    assert_same(&file.silent(), &Gltf::quad().silent());
    file.json["meshes"][0]["weights"] = json!([0.5]);
    assert_same(&file.silent(), &raised);
    // The node's own weights come before the mesh's.
    file.json["meshes"][0]["weights"] = json!([9, 9, 9]);
    file.json["nodes"][0]["weights"] = json!([0.5, 0, 0]);
    assert_same(&file.silent(), &raised);
    file.json["nodes"][0]["weights"] = json!([0.5, 1]);
    assert_same(
        &file.silent(),
        &plain(|[x, y, z]| [x, y + 0.5, z], [0.0, 0.6, -0.8]),
    );
    file.primitive()["attributes"]["COLOR_0"] = json!(colors);
    file.json["nodes"][0]["weights"] = json!([0, 0, 1]);
    assert_eq!(
        file.silent().mesh.colors[3].to_array(),
        [1.0, 0.5, 0.0, 1.0]
    );

    // Displacements of two corners alone, over zeros.
    let mut sparse = Gltf::quad();
    let rows = sparse.view(&[2, 3]);
    let values = sparse.view(&le(&[0.0, 1.0, 0.0, 0.0, 1.0, 0.0]));
    let accessor = json!({"componentType": FLOAT, "count": 4, "type": "VEC3", "sparse": {"count": 2,
        "indices": {"bufferView": rows, "componentType": BYTE}, "values": {"bufferView": values}}});
    sparse.json["accessors"]
        .as_array_mut()
        .expect("a list")
        .push(accessor);
    sparse.primitive()["targets"] = json!([{"POSITION": 3}]);
    sparse.json["meshes"][0]["weights"] = json!([-0.5]);
    let lowered = plain(
        |[x, y, z]| [x, if y > 1.0 { y - 0.5 } else { y }, z],
        NORMAL,
    );
    assert_same(&sparse.silent(), &lowered);

    // Before the skin: what is raised by half a metre is then doubled.
    let mut both = file.clone();
    both.json["nodes"] = json!([{"mesh": 0, "skin": 0, "weights": [0.5]}, {"scale": [2, 2, 2]}]);
    both.json["skins"] = json!([{"joints": [1]}]);
    both.bind(0, [[0; 4]; 4], FIRST);
    both.primitive()["attributes"]
        .as_object_mut()
        .expect("an object")
        .remove("COLOR_0");
    assert_same(
        &both.silent(),
        &plain(|[x, y, z]| [2.0 * x, 2.0 * (y + 0.5), 2.0 * z], NORMAL),
    );

    let mut long = file.clone();
    long.json["nodes"][0]["weights"] = json!([0, 0, 0, 1]);
    assert!(
        long.load().expect("it loads").warnings[0]
            .message()
            .contains("morph weight without a target")
    );
    let short = file.floats("VEC3", &[0.0; 9]);
    file.primitive()["targets"][0]["POSITION"] = json!(short);
    file.json["nodes"][0]["weights"] = json!([1]);
    assert!(
        Folder::new()
            .refused("it.glb", file.glb())
            .contains("targets[0]")
    );
}

#[test]
fn hidden_nodes_hide_what_is_below_them() {
    let hide = |value| json!({"KHR_node_visibility": value});
    let mut file = Gltf::quad();
    let seen_alone = file.silent();
    file.json["nodes"] = json!([
        {"mesh": 0},
        {"translation": [0, 9, 0], "children": [2], "mesh": 0, "extensions": hide(json!({"visible": false}))},
        {"mesh": 0, "extensions": hide(json!({"visible": true}))},
    ]);
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    assert_same(&file.silent(), &seen_alone);
    for shown in [json!({"visible": true}), json!({})] {
        file.json["nodes"][1]["extensions"] = hide(shown);
        assert_eq!(file.silent().mesh.triangles.len(), 6);
    }
    // Lamps too are hidden; joints and cameras have nothing to show.
    let mut rich = Gltf::rich();
    let shown = rich.silent();
    for node in [2, 4, 5, 6] {
        rich.json["nodes"][node]["extensions"]["KHR_node_visibility"] = json!({"visible": false});
    }
    let hidden = rich.silent();
    assert_same(&hidden, &shown);
    assert_eq!((hidden.cameras, hidden.lights.len()), (shown.cameras, 0));
    let text = {
        rich.json["nodes"][0]["extensions"] = hide(json!({"visible": false}));
        Folder::new().refused("it.glb", rich.glb())
    };
    assert!(text.contains("no triangles"), "{text}");
}

#[test]
fn instances_stand_as_nodes_do() {
    let places = [[1.0f32, 2.0, 3.0], [-4.0, 0.5, 0.0]];
    let turns = [[0.0f32, 0.0, 0.6, 0.8], [0.6, 0.0, 0.0, 0.8]];
    let scales = [[1.0f32, 2.0, 3.0], [-1.0, 1.0, 1.0]];
    let mut nodes = Gltf::quad();
    let children = places
        .iter()
        .zip(turns)
        .zip(scales)
        .map(|((t, r), s)| json!({"mesh": 0, "translation": t, "rotation": r, "scale": s}));
    let list: Vec<_> = [json!({"children": [1, 2], "scale": [2, 2, 2]})]
        .into_iter()
        .chain(children)
        .collect();
    nodes.json["nodes"] = json!(list);
    let mut file = Gltf::quad();
    let (t, r) = (
        file.floats("VEC3", &places.concat()),
        file.floats("VEC4", &turns.concat()),
    );
    let s = file.floats("VEC3", &scales.concat());
    let attributes = json!({"TRANSLATION": t, "ROTATION": r, "SCALE": s, "_ID": 0});
    file.json["nodes"] = json!([{"mesh": 0, "scale": [2, 2, 2], "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}}]);
    assert_same(&file.silent(), &nodes.silent());
    let attributes =
        &mut file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes["SCALE"] = json!(0);
    assert!(
        Folder::new()
            .refused("it.glb", file.glb())
            .contains("differ in length")
    );
}
