//! Real scenes by others, another reader, and files that were damaged.

mod common;

use common::files::*;
use common::gltf::Gltf;
use glam::{DAffine3, DQuat, DVec3};
use serde_json::json;
use tyndall::scene;

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
        let warned = scene.warnings.iter().any(|w| {
            w.message()
                .contains(&format!("{degenerate} triangles without an area"))
        });
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
    // Damage to an OBJ file costs lines, seldom the file.
    assert!(
        refused > rounds / 8 || name.ends_with(".obj") && refused > 0,
        "{name}: the damage does no harm: {loaded} load, {refused} do not"
    );
}

#[test]
fn damaged_files_never_panic() {
    let folder = Folder::new();
    let (json, bin) = example();
    survives_damage(&folder, "a.glb", &glb(&json, &bin), 800);
    survives_damage(&folder, "rich.glb", &Gltf::rich().glb(), 800);
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
