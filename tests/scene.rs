//! Scene files: what comes out of good ones, and what is said about bad ones.

mod common;

use common::files::*;
use common::scenes;
use glam::{DMat3, DVec2, DVec3, DVec4};
use serde_json::{Value, json};
use tyndall::Warning;
use tyndall::scene::{self, AlphaMode, Geometry, Projection, PunctualKind, Ray, Scene, Wrap};

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
    assert_eq!((leaf.alpha, leaf.pane.is_some()), (0.75, true));
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
    assert_eq!(scene.mesh.colors[1], DVec4::new(0.0, 1.0, 0.0, 1.0));
    assert_eq!(scene.mesh.colors[3].truncate(), DVec3::splat(0.2));

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
    assert_eq!(scene.warnings.len(), 2, "{:?}", scene.warnings);
    assert!(
        matches!(scene.warnings[1], Warning::OddSize { .. }),
        "it is 4 mm high"
    );
    for what in [
        "example.glb",
        "normal texture (1)",
        "reflection of a material that lets a part of the light through (1)",
    ] {
        assert!(
            scene.warnings[0].message().contains(what),
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
            .any(|w| w.message().contains("webp.glb, textures[0]")
                && w.message().contains("EXT_texture_webp"))
    );

    let (mut json, bin) = example();
    json["images"][0] = json!({"uri": "gone%20away.png"});
    let scene = folder
        .load("gone.glb", glb(&json, &bin))
        .expect("it loads without");
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.message().contains("gone away.png")),
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
            .any(|w| w.message().contains("texture left out")),
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
    let cases: [(&str, Change, &[&str]); 17] = [
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
            "scale",
            |j| j["nodes"][1]["scale"] = json!([0, 0, 0]),
            &["none of the 2 triangles has an area"],
        ),
        (
            "points",
            |j| j["meshes"][0]["primitives"][0]["mode"] = json!(0),
            &["there are no triangles"],
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
            .any(|w| w.message().contains("some.obj") && w.message().contains("2 triangles")),
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
        scene
            .warnings
            .iter()
            .any(|w| w.message().contains("Ks (1)")),
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
        scene
            .warnings
            .iter()
            .any(|w| w.message().contains("gone.mtl")),
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

#[test]
fn the_built_in_scene_stands_on_its_own() {
    let nave = Scene::builtin("nave").expect("it loads");
    assert_eq!(nave.warnings, [], "nothing is left out or doubtful");
    assert!((10_000..=40_000).contains(&nave.mesh.triangles.len()));
    assert!(nave.time.is_some() && nave.site.is_some() && nave.camera.is_some());
    assert_eq!(nave.textures.len(), 2);
    assert_eq!(nave.picture.size, Some([960, 600]));
    // Rounded to 0.1 mm and to 1/255 in the file.
    for normal in nave.mesh.normals {
        assert!((normal.length() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn light_enters_the_nave_through_its_openings_alone() {
    let nave = Scene::builtin("nave").expect("it loads");
    let geometry = Geometry::new(&nave);
    let mut dice = Dice(11);
    let mut within =
        |from: f64, to: f64| from + (to - from) * dice.roll(1 << 20) as f64 / f64::from(1 << 20);
    let (mut below_the_sills, mut out) = (0, 0);
    for _ in 0..40_000 {
        let origin = DVec3::new(within(-1.0, 1.0), within(0.3, 1.7), within(-30.0, -6.0));
        let (azimuth, height) = (within(0.0, std::f64::consts::TAU), within(0.0, 1.0));
        let flat = (1.0 - height * height).sqrt();
        let direction = DVec3::new(flat * azimuth.cos(), height, flat * azimuth.sin());
        let free = !geometry.occluded(&Ray { origin, direction }, 0.0, f64::INFINITY);
        out += usize::from(free);
        // The highest opening, 12.3 m up in a wall 3.5 m away or more, is seen at 74 degrees: nothing is above.
        assert!(
            !free || height.asin().to_degrees() < 74.0,
            "through the roof from {origin} toward {direction}"
        );
        // At less than the sills' height at the aisles' walls, only the portal in the west is open.
        let at_wall = origin.y + 10.0 / direction.x.abs() * direction.y;
        if at_wall < 1.8 && direction.x.abs() > direction.z.abs() {
            below_the_sills += 1;
            assert!(!free, "through a wall from {origin} toward {direction}");
        }
    }
    assert!(below_the_sills > 100, "{below_the_sills} rays is no test");
    assert!(
        (800..8000).contains(&out),
        "{out} of 40 000 directions are open"
    );
}

#[test]
fn scenes_made_in_code_are_what_they_say() {
    let sun = [150.0, 30.0];
    for (scene, triangles) in [
        (scenes::slit_room(0.1, sun), 12 * (4 + 1 + 2 + 2)),
        (scenes::slatted_roof(20, sun), 12 * (2 + 2 + 1 + 20)),
        (scenes::gates(5, sun), 12 * 15),
        (scenes::colonnade(6, 16, sun), 6 * 2 * 32 + 24),
        (scenes::terrain(32, 100.0, sun), 32 * 32 * 2),
        (scenes::soup(1000, 0.1, 3, sun), 1000),
    ] {
        assert_eq!(scene.mesh.triangles.len(), triangles);
        assert!(scene.mesh.positions.iter().all(|p| p.is_finite()));
    }
    // The slit lets a ray in; beside it there is none.
    let geometry = Geometry::new(&scenes::slit_room(0.1, sun));
    let open = |z: f64| {
        !geometry.occluded(
            &Ray {
                origin: DVec3::new(0.0, 2.0, z),
                direction: DVec3::X,
            },
            0.0,
            100.0,
        )
    };
    assert!(open(0.0) && open(0.049) && !open(0.051) && !open(-0.2));
    // Terrain faces up.
    let terrain = scenes::terrain(32, 100.0, sun);
    for t in &terrain.mesh.triangles {
        let [a, b, c] = t.vertices.map(|v| terrain.mesh.positions[v as usize]);
        assert!((b - a).cross(c - a).y > 0.0);
    }
}
