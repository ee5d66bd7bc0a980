//! What glTF files are written like, and that all ways of writing one scene give that scene.

mod common;

use common::files::*;
use common::gltf::*;
use glam::{DVec3, DVec4};
use serde_json::{Value, json};
use tyndall::Warning;
use tyndall::conditions::{Conditions, Request};
use tyndall::scene::{self, AlphaMode};

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let word = chunk
            .iter()
            .enumerate()
            .fold(0u32, |w, (i, &b)| w | u32::from(b) << (16 - 8 * i));
        for i in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * i)) as usize & 63] as char;
            text.push(if i <= chunk.len() { digit } else { '=' });
        }
    }
    text
}

fn percent(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("%{b:02X}")).collect()
}

/// A message that a person reads to its end.
fn is_readable(message: &str) -> bool {
    message.len() < 400 && !message.lines().skip(1).any(|line| !line.is_empty())
}

#[test]
fn data_uris_in_every_form() {
    let mut file = Gltf::rich();
    let plain = seen(&file.silent());
    let picture_view = file.json["images"][0]["bufferView"]
        .take()
        .as_u64()
        .expect("a view") as usize;
    let at = &file.json["bufferViews"][picture_view];
    let at = at["byteOffset"].as_u64().expect("a place") as usize..;
    let png = file.bin[at].to_vec();
    type Form = fn(&[u8]) -> String;
    let forms: [Form; 9] = [
        |b| format!("data:application/octet-stream;base64,{}", base64(b)),
        |b| {
            format!(
                "data:application/octet-stream;base64,{}",
                base64(b)
                    .replace('+', "%2B")
                    .replace('/', "%2f")
                    .replace('=', "%3D")
            )
        },
        |b| format!("data:application/octet-stream,{}", percent(b)),
        |b| format!("DATA:application/octet-stream;BASE64,{}", base64(b)),
        |b| format!("data:;base64,{}", base64(b).trim_end_matches('=')),
        |b| {
            format!(
                "data:application/gltf-buffer;charset=utf-8;base64,{}",
                base64(b)
            )
        },
        |b| {
            let lines: Vec<String> = base64(b)
                .as_bytes()
                .chunks(76)
                .map(|l| String::from_utf8_lossy(l).into_owned())
                .collect();
            format!("data:;base64,\n{}\r\n ", lines.join("\r\n "))
        },
        |b| {
            format!(
                "data:;base64,{}",
                base64(b).replace('+', "-").replace('/', "_")
            )
        },
        |b| format!("data:,{}", percent(b)),
    ];
    let folder = Folder::new();
    for (i, form) in forms.into_iter().enumerate() {
        let mut json = file.json.clone();
        json["buffers"][0]["uri"] = json!(form(&file.bin));
        json["images"][0] = json!({"uri": form(&png)});
        let scene = folder
            .load("uri.gltf", json.to_string())
            .unwrap_or_else(|e| panic!("form {i}: {e}"));
        assert_eq!(scene.warnings, [], "form {i}");
        assert_eq!(seen(&scene), plain, "form {i}");
    }
    for bad in [
        format!(
            "data:application/octet-stream;base64,{}*",
            base64(&file.bin)
        ),
        format!("data:application/octet-stream;base64{}", base64(&file.bin)),
        format!("datum:{}", base64(&file.bin)),
    ] {
        let mut json = file.json.clone();
        json["buffers"][0]["uri"] = json!(bad);
        let text = folder.refused("uri.gltf", json.to_string());
        assert!(
            is_readable(&text) && text.contains("buffers[0].uri"),
            "{text}"
        );
        let mut json = file.json.clone();
        json["images"][0] = json!({"uri": bad});
        json["nodes"] = json!(bad);
        let text = folder.refused("uri.gltf", json.to_string());
        assert!(is_readable(&text), "a type error quotes the file: {text}");
    }
}

#[test]
fn marks_padding_and_lengths_of_the_container() {
    let file = Gltf::rich();
    let plain = seen(&file.silent());
    let folder = Folder::new();
    let silent = |name: &str, bytes: &[u8]| {
        let scene = folder.load(name, bytes).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(scene.warnings, [], "{name}");
        assert_eq!(seen(&scene), plain, "{name}");
    };
    let chunk = |kind: &[u8; 4], bytes: &[u8]| {
        let length = (bytes.len() as u32).to_le_bytes();
        [&length[..], kind, bytes].concat()
    };
    let whole = |chunks: &[Vec<u8>], length: Option<u32>| {
        let chunks = chunks.concat();
        let length = length.unwrap_or(12 + chunks.len() as u32).to_le_bytes();
        [b"glTF".as_slice(), &2u32.to_le_bytes(), &length, &chunks].concat()
    };
    let text = file.json.to_string().into_bytes();
    let fill = |with: u8| [&text[..], &vec![with; 4 - text.len() % 4]].concat();
    let mark = b"\xEF\xBB\xBF".to_vec();
    let (json, bin) = (chunk(b"JSON", &fill(b' ')), chunk(b"BIN\0", &file.bin));
    silent(
        "nul.glb",
        &whole(&[chunk(b"JSON", &fill(0)), bin.clone()], None),
    );
    silent(
        "bom.glb",
        &whole(
            &[chunk(b"JSON", &[&mark[..], &text].concat()), bin.clone()],
            None,
        ),
    );
    silent(
        "zeros.glb",
        &whole(&[json.clone(), bin.clone(), vec![0; 13]], None),
    );
    silent(
        "short_length.glb",
        &whole(&[json.clone(), bin.clone()], Some(12)),
    );
    silent(
        "long_length.glb",
        &whole(&[json.clone(), bin.clone()], Some(1 << 30)),
    );
    silent("turned.glb", &whole(&[bin.clone(), json.clone()], None));
    silent(
        "long_bin.glb",
        &whole(
            &[
                json.clone(),
                chunk(b"BIN\0", &[&file.bin[..], &[9; 40]].concat()),
            ],
            None,
        ),
    );
    let mut longer = file.json.clone();
    longer["buffers"][0]["byteLength"] = json!(file.bin.len() + 3);
    let longer = chunk(b"JSON", longer.to_string().as_bytes());
    silent("short_bin.glb", &whole(&[longer, bin.clone()], None));
    // A last chunk that says that it is filled up, and is not.
    let mut unfilled = whole(
        &[
            json.clone(),
            chunk(b"BIN\0", &[&file.bin[..], &[0; 3]].concat()),
        ],
        None,
    );
    unfilled.truncate(unfilled.len() - 3);
    silent("unfilled.glb", &unfilled);

    let mut beside = file.json.clone();
    folder.put("it.bin", &file.bin);
    beside["buffers"][0]["uri"] = json!("it.bin");
    let beside = beside.to_string().into_bytes();
    silent("plain.gltf", &beside);
    silent("bom.gltf", &[&mark[..], &beside].concat());
    silent("nul.gltf", &[&beside[..], &[0, 0, 10, 0]].concat());
    for garbage in [vec![7u8; 5], vec![7; 400], chunk(b"FOO\0", b"unknown!")] {
        let bytes = whole(&[json.clone(), bin.clone(), garbage], None);
        let scene = folder.load("garbage.glb", bytes).expect("it loads");
        assert_eq!(seen(&scene), plain);
        assert!(
            scene.warnings[0]
                .message()
                .contains("neither its JSON nor its buffer"),
            "{:?}",
            scene.warnings
        );
    }

    let wide: Vec<u8> = String::from_utf8_lossy(&beside)
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    for (name, bytes) in [
        ("wide.gltf", [&[0xFF, 0xFE], &wide[..]].concat()),
        ("markless.gltf", wide),
    ] {
        assert!(folder.refused(name, bytes).contains("UTF-16"), "{name}");
    }
    let cut = whole(&[json, bin], None);
    assert!(
        folder
            .refused("cut.glb", &cut[..cut.len() - 40])
            .contains("follow")
    );
}

#[test]
fn extensions_that_are_only_used_fall_back() {
    let plain = Gltf::quad();
    let expected = seen(&plain.silent());
    let mut draco = plain.clone();
    draco.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    let packed =
        json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    draco.primitive()["extensions"] = packed.clone();
    assert_eq!(seen(&draco.silent()), expected);
    draco.json["accessors"][0]
        .as_object_mut()
        .expect("an object")
        .remove("bufferView");
    let text = Folder::new().refused("draco.glb", draco.glb());
    assert!(
        text.contains("Draco mesh compression") && text.contains("primitives[0]"),
        "{text}"
    );

    let mut meshopt = plain.clone();
    let buffer = json!({"byteLength": plain.bin.len(), "extensions": {"EXT_meshopt_compression": {"fallback": true}}});
    meshopt.json["buffers"]
        .as_array_mut()
        .expect("a list")
        .push(buffer);
    for view in meshopt.json["bufferViews"].as_array_mut().expect("a list") {
        view["extensions"] =
            json!({"EXT_meshopt_compression": {"buffer": 0, "mode": "ATTRIBUTES"}});
    }
    assert_eq!(
        seen(&meshopt.silent()),
        expected,
        "the fallback is not needed"
    );
    meshopt.json["bufferViews"][0]["buffer"] = json!(1);
    let text = Folder::new().refused("meshopt.glb", meshopt.glb());
    assert!(text.contains("meshopt compression"), "{text}");

    let mut basis = Gltf::rich();
    let with_picture = seen(&basis.silent());
    basis.json["textures"][0]["extensions"] = json!({"KHR_texture_basisu": {"source": 7}});
    assert_eq!(
        seen(&basis.silent()),
        with_picture,
        "it has a plain picture"
    );

    // What is shown as less than it is, or not at all, is named.
    for (pointer, extension, says) in [
        (
            "/materials/0",
            json!({"KHR_materials_unlit": {}}),
            "unlit materials",
        ),
        (
            "/materials/0",
            json!({"KHR_materials_sheen": {}}),
            "KHR_materials_sheen",
        ),
        (
            "/meshes/0/primitives/0",
            json!({"KHR_materials_variants": {"mappings": []}}),
            "variants of materials",
        ),
        (
            "/nodes/0",
            json!({"MSFT_lod": {"ids": []}}),
            "levels of detail",
        ),
        (
            "/nodes/0",
            json!({"KHR_physics_rigid_bodies": {}}),
            "KHR_physics_rigid_bodies",
        ),
        (
            "/scenes/0",
            json!({"EXT_lights_image_based": {"light": 0}}),
            "image-based light",
        ),
        ("/nodes/0", json!({"ACME_anything": {}}), "ACME_anything"),
    ] {
        let mut file = plain.clone();
        file.json.pointer_mut(pointer).expect("it is there")["extensions"] = extension;
        let scene = file.load().expect("it loads");
        assert_eq!(seen(&scene), expected);
        assert!(
            scene.warnings[0].message().contains(says),
            "{says}: {:?}",
            scene.warnings
        );
    }
}

#[test]
fn what_a_file_needs_is_named_before_anything_fails() {
    for (name, says) in [
        ("KHR_draco_mesh_compression", "Draco mesh compression"),
        ("EXT_meshopt_compression", "meshopt compression"),
        ("KHR_gaussian_splatting", "Gaussian splats"),
        ("ACME_anything", "ACME_anything"),
    ] {
        let mut file = Gltf::quad();
        file.json["extensionsRequired"] = json!(["KHR_mesh_quantization", name]);
        file.json["buffers"] = json!([{"byteLength": 1_000_000, "uri": "gone.bin"}]);
        file.json["nodes"][0]["mesh"] = json!("seven");
        let text = Folder::new().refused("it.glb", file.glb());
        assert!(
            text.contains(says) && text.contains("extensionsRequired"),
            "{text}"
        );
    }
    for name in [
        "KHR_mesh_quantization",
        "KHR_node_visibility",
        "EXT_mesh_gpu_instancing",
        "KHR_materials_unlit",
        "KHR_xmp_json_ld",
    ] {
        let mut file = Gltf::rich();
        file.json["extensionsRequired"] = json!([name]);
        file.silent();
    }
    let mut file = Gltf::quad();
    file.json["asset"]["minVersion"] = json!("2.1");
    assert!(Folder::new().refused("it.glb", file.glb()).contains("2.1"));
}

#[test]
fn accessors_without_data_are_zeros() {
    // The same sheet, its positions and indices as sparse values over zeros.
    let plain = Gltf::quad();
    let mut file = plain.clone();
    let rows = file.view(&[1, 2, 3]);
    let values = file.view(&le(&QUAD[1..].concat()));
    file.json["accessors"][0] = json!({"componentType": FLOAT, "count": 4, "type": "VEC3", "sparse": {"count": 3,
        "indices": {"bufferView": rows, "componentType": BYTE}, "values": {"bufferView": values}}});
    assert_eq!(seen(&file.silent()), seen(&plain.silent()));
    let mut black = plain.clone();
    black.json["accessors"]
        .as_array_mut()
        .expect("a list")
        .push(json!({"componentType": FLOAT, "count": 4, "type": "VEC4"}));
    black.primitive()["attributes"]["COLOR_0"] = json!(3);
    assert_eq!(black.silent().mesh.colors, [DVec4::ZERO; 4]);
    for count in [1usize << 24, 1 << 40, usize::MAX] {
        let mut file = black.clone();
        file.json["accessors"][3]["count"] = json!(count);
        let text = Folder::new().refused("huge.glb", file.glb());
        assert!(
            text.contains("accessors[3]") && text.contains("more than the file has bytes"),
            "{text}"
        );
    }
}

#[test]
fn a_tiny_file_makes_no_endless_scene() {
    // 100 000 instances of 1 000 sheets, in some 300 kB.
    let mut file = Gltf::quad();
    let indices = file.accessor("SCALAR", BYTE, 6000, &[0, 1, 2, 2, 1, 3].repeat(1000));
    file.primitive()["indices"] = json!(indices);
    file.view(&vec![0; 300_000]);
    let count = json!({"componentType": FLOAT, "count": 100_000, "type": "VEC3"});
    file.json["accessors"]
        .as_array_mut()
        .expect("a list")
        .push(count);
    file.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": indices + 1}}});
    let text = Folder::new().refused("many.glb", file.glb());
    assert!(text.contains("fewer instances"), "{text}");
    // One picture of a thousand names is decoded once.
    let mut file = Gltf::rich();
    file.json["textures"] = (0..1000).map(|_| json!({"source": 0})).collect();
    file.json["materials"] = (0..1000)
        .map(|i| json!({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": i}}}))
        .collect();
    assert_eq!(file.silent().textures.len(), 1);
}

#[test]
fn vertex_colours_carry_their_alpha() {
    let alphas = [0u8, 51, 102, 255];
    let expected: Vec<DVec4> = alphas
        .iter()
        .map(|&a| DVec4::new(1.0, 0.2, 0.0, f64::from(a) / 255.0))
        .collect();
    let rows: Vec<[u8; 4]> = alphas.iter().map(|&a| [255, 51, 0, a]).collect();
    let mut file = Gltf::quad();
    file.json["materials"][0]["alphaMode"] = json!("MASK");
    let bytes = file.accessor("VEC4", BYTE, 4, &rows.concat());
    let wide: Vec<u8> = rows
        .concat()
        .iter()
        .flat_map(|&b| (u16::from(b) * 257).to_le_bytes())
        .collect();
    let shorts = file.accessor("VEC4", SHORT, 4, &wide);
    for accessor in [bytes, shorts] {
        file.primitive()["attributes"]["COLOR_0"] = json!(accessor);
        let scene = file.silent();
        assert_eq!(scene.mesh.colors, expected);
        assert_eq!(
            scene.materials[0].alpha_mode,
            AlphaMode::Mask { cutoff: 0.5 }
        );
    }
}

#[test]
fn specular_glossiness_has_a_base_colour() {
    let mut file = Gltf::rich();
    let plain = file.silent();
    let texture = file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"].clone();
    file.json["materials"][0]["pbrMetallicRoughness"] = json!({});
    file.json["materials"][0]["extensions"] = json!({"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 0.25, 0.125, 0.75], "diffuseTexture": texture, "specularFactor": [0, 0, 0]}});
    assert_eq!(seen(&file.silent()), seen(&plain));
    file.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"]["specularFactor"] =
        json!([0.2, 0.2, 0.2]);
    let scene = file.load().expect("it loads");
    assert!(
        scene.warnings[0].message().contains("specular (1)"),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn numbers_out_of_range_cost_themselves_alone() {
    type Change = fn(&mut Value);
    let cases: [(Change, &[&str]); 8] = [
        (
            |j| {
                j["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] =
                    json!([1.000_000_1, 1, 1, 1])
            },
            &["(leaf)", "red", "1.0000001", "held at 1"],
        ),
        (
            |j| {
                j["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] =
                    json!([1, 1.01, 1, 1])
            },
            &["green", "1.01", "held at 1"],
        ),
        (
            |j| {
                j["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] =
                    json!([1, 1, -0.5, 1])
            },
            &["blue", "-0.5", "held at 0"],
        ),
        (
            |j| {
                j["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] =
                    json!([1, 1, 1, 1e300])
            },
            &["alpha", "1e300", "held at 1"],
        ),
        (
            |j| j["materials"][0]["alphaCutoff"] = json!(1.000_1),
            &["alphaCutoff", "1.0001", "held at 1"],
        ),
        (
            |j| j["materials"][0]["alphaCutoff"] = json!(2),
            &["alphaCutoff", "nothing of the material"],
        ),
        (
            |j| j["materials"][0]["alphaMode"] = json!("mask"),
            &["(leaf)", "`mask`", "OPAQUE"],
        ),
        (
            |j| j["cameras"][0]["perspective"]["yfov"] = json!(4),
            &["cameras[0]", "yfov is 4", "left out"],
        ),
    ];
    let plain = Gltf::rich();
    for (change, says) in cases {
        let mut file = plain.clone();
        change(&mut file.json);
        let scene = file.load().expect("it loads");
        let [warning] = &scene.warnings[..] else {
            panic!("{:?}", scene.warnings)
        };
        for what in says {
            assert!(
                warning.message().contains(what) && is_readable(&warning.message()),
                "{what}: {warning}"
            );
        }
        let material = &scene.materials[0];
        assert!(
            material.base_color.cmple(DVec3::ONE).all()
                && material.base_color.cmpge(DVec3::ZERO).all()
        );
        assert!((0.0..=1.0).contains(&material.alpha));
    }
}

#[test]
fn cameras_of_one_name_and_of_none() {
    let mut file = Gltf::rich();
    file.json["nodes"][4]["name"] = json!("eye");
    file.json["nodes"][5]["name"] = json!("eye");
    let scene = file.load().expect("it loads");
    let [Warning::SameCameraName { name, count, .. }] = &scene.warnings[..] else {
        panic!("{:?}", scene.warnings)
    };
    assert_eq!((&name[..], *count), ("eye", 2));
    assert!(scene.warnings[0].message().contains("the first"));
    for node in [4, 5] {
        file.json["nodes"][node]
            .as_object_mut()
            .expect("an object")
            .remove("name");
        file.json["nodes"][node]["camera"] = json!(0);
    }
    let cameras = file.json["cameras"].as_array_mut().expect("a list");
    cameras.truncate(1);
    let scene = file.silent();
    let names: Vec<&str> = scene.cameras.iter().map(|c| &c.name[..]).collect();
    assert_eq!(names, ["camera 0", "camera 1"], "each can be chosen");
}

#[test]
fn files_outside_the_folder_are_said() {
    let mut file = Gltf::quad();
    let expected = seen(&file.silent());
    let folder = Folder::new();
    std::fs::create_dir(folder.0.path().join("below")).expect("a folder");
    let buffer = folder.put("it.bin", &file.bin);
    folder.put("below/it.bin", &file.bin);
    let absolute = buffer.to_string_lossy().into_owned();
    for (uri, outside) in [
        ("it.bin".to_owned(), false),
        ("./it.bin".into(), false),
        ("../below/it.bin".into(), true),
        ("../it.bin".into(), true),
        ("..%2Fit.bin".into(), true),
        ("..\\it.bin".into(), true),
        (absolute.clone(), true),
        (format!("file://{absolute}"), true),
    ] {
        file.json["buffers"][0]["uri"] = json!(uri);
        let scene = folder
            .load("below/it.gltf", file.json.to_string())
            .unwrap_or_else(|e| panic!("{uri}: {e}"));
        assert_eq!(seen(&scene), expected);
        let said = matches!(&scene.warnings[..], [Warning::OutsideFolder { file, .. }] if file.ends_with("it.gltf"));
        assert_eq!(said, outside, "{uri}: {:?}", scene.warnings);
    }
    for uri in ["/dev/zero", "/dev/null", "/", "http://example.org/it.bin"] {
        file.json["buffers"][0]["uri"] = json!(uri);
        let text = folder.refused("it.gltf", file.json.to_string());
        assert!(text.contains(uri), "{text}");
    }
    for device in ["/dev/zero", "/dev/null"] {
        let error = scene::load(std::path::Path::new(device)).expect_err("it is a device");
        assert!(error.to_string().contains("a device or a pipe"), "{error}");
    }
}

#[test]
fn without_a_mesh_a_camera_is_needed() {
    let scene = Folder::new()
        .load("nocam.toml", "[sun]\nazimuth = 120\nelevation = 30\n")
        .expect("it loads");
    let Err(error) = Conditions::new(scene, &Request::default()) else {
        panic!("nothing is to be seen")
    };
    assert!(
        error.problem().contains("there is no mesh to frame"),
        "{error}"
    );
    assert!(
        error.remedy().contains("[camera]") && is_readable(&error.to_string()),
        "{error}"
    );
}
