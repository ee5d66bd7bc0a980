//! The examples that an engineer begins with, run: each is the program of `examples/` itself.

#[allow(dead_code)] // not all of it is needed here
#[path = "common/files.rs"]
mod files;
#[path = "../examples/own_scene.rs"]
mod own_scene;
#[path = "../examples/roof.rs"]
mod roof;
#[path = "../examples/sun_position.rs"]
mod sun_position;

use glam::DVec3;
use serde_json::json;
use tyndall::sky::Irradiance;

#[test]
fn the_suns_position_is_that_of_the_algorithms_paper() {
    // Reda & Andreas 2004, table A5.1, whose elevation without refraction is 39.872046 and azimuth 194.340241 degrees.
    let said = sun_position::sun(39.742476, -105.1786, "2003-10-17T12:30:30-07:00").expect("a sun");
    assert!(
        said.starts_with("azimuth 194.340, elevation 39.872 degrees"),
        "{said}"
    );
    // By pvlib 0.16 (sun_rise_set_transit_spa, whose sunset is that of the day in universal time): 7:12:43.5 and 18:18:51.7 by the clock there.
    assert!(said.contains("sunrise 07:12:4"), "{said}");
    assert!(said.contains("sunset 18:18:5"), "{said}");
    // No sunrise at 78 degrees north in June, and a place that is none.
    let said = sun_position::sun(78.2, 15.6, "2026-06-21T12:00").expect("a sun");
    assert!(
        said.ends_with("sunrise none (AboveAllDay), sunset none (AboveAllDay)"),
        "{said}"
    );
    assert!(sun_position::sun(91.0, 0.0, "2026-06-21T12:00Z").is_err_and(|e| e.is_input()));
}

#[test]
fn a_roof_receives_what_another_model_gives_it() {
    let measured = Irradiance {
        direct_normal: 620.0,
        diffuse_horizontal: 140.0,
    };
    let toward_sun = roof::direction(225.0, 40.0);
    let on = |normal| roof::on_a_plane(measured, toward_sun, normal).expect("an irradiance");
    // A level roof has what was measured, one that faces the sun all of the direct light.
    let level = on(DVec3::Y);
    assert!((level[0] - 620.0 * 40f64.to_radians().sin()).abs() < 1e-9);
    assert!((level[1] - 140.0).abs() < 1e-9 && level[2] == 0.0);
    assert!((on(toward_sun)[0] - 620.0).abs() < 1e-9);
    // pvlib 0.16: get_ground_diffuse, beam_component, and perez, whose sky is two bands and a spot in place of a dome (Perez et al. 1990).
    for (azimuth, [sun, sky, ground]) in [
        (0.0, [133.83, 97.66, 9.74]),
        (180.0, [519.08, 175.45, 9.74]),
    ] {
        let found = on(roof::direction(azimuth, 55.0));
        assert!((found[0] - sun).abs() < 0.01, "{found:?}");
        assert!((found[1] / sky - 1.0).abs() < 0.1, "{found:?}");
        assert!((found[2] - ground).abs() < 0.01, "{found:?}");
    }
}

#[test]
fn ones_own_glb_becomes_a_picture() {
    // A wall that faces south-west, without normals or a material.
    let corners = [
        [-2.0f32, 0.0, 0.0],
        [2.0, 0.0, -4.0],
        [2.0, 3.0, -4.0],
        [-2.0, 3.0, 0.0],
    ];
    let mut bin: Vec<u8> = corners
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bin.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let json = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-2, 0, -4], "max": [2, 3, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": bin.len()}],
    });
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("wall.glb");
    std::fs::write(&scene, files::glb(&json, &bin)).expect("room for it");
    let ev100 =
        own_scene::render(&scene, &folder.path().join("wall"), [48, 30]).expect("a picture");
    // A summer afternoon outdoors, by any light meter.
    assert!((11.0..16.0).contains(&ev100), "EV100 {ev100}");
    let picture = image::open(folder.path().join("wall.png"))
        .expect("a PNG")
        .into_rgb8();
    assert_eq!(picture.dimensions(), (48, 30));
    let codes: Vec<u8> = picture.pixels().map(|p| p.0[1]).collect();
    assert!(codes.iter().min() < Some(&120) && codes.iter().max() > Some(&120));
    let exr = exr::prelude::read_first_flat_layer_from_file(folder.path().join("wall.exr"))
        .expect("an EXR");
    assert_eq!(exr.layer_data.size.0, 48);
}
