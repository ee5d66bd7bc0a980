//! Panes of files: what `[[pane]]` and KHR_materials_transmission say, and what is wrong with it.

mod common;

use common::files::*;
use common::gltf::Gltf;
use glam::{DVec3, dvec3};
use serde_json::{Value, json};
use tyndall::Warning;
use tyndall::colour::Space;
use tyndall::scene::glass::Incidence;
use tyndall::scene::{Geometry, Ray, Scene};

/// A level sheet at height 1 from 0 to 1 with texture coordinates, and a floor.
const OBJ: &str = "mtllib it.mtl
v 0 1 0
v 1 1 0
v 1 1 1
v 0 1 1
v -5 0 -5
v 5 0 -5
v 5 0 5
v -5 0 5
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl glass
f 1/1 2/2 3/3 4/4
usemtl floor
f 5 6 7 8
";

const MTL: &str = "newmtl glass\nKd 0.5 0.5 0.5\nnewmtl floor\nKd 0.5 0.5 0.5\n";

/// Two texels side by side, without alpha.
fn tiles() -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_raw(2, 1, vec![255, 128, 0, 0, 128, 255])
        .expect("two texels")
        .write_to(&mut png, image::ImageFormat::Png)
        .expect("a PNG");
    png.into_inner()
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.put("it.obj", OBJ);
    folder.put("it.mtl", MTL);
    folder.put("tiles.png", tiles());
    folder
}

fn table(keys: &str) -> String {
    format!("mesh = \"it.obj\"\n[[pane]]\n{keys}\n")
}

/// What is left of light straight down through a place of the sheet, in linear Rec. 709.
fn through(scene: &Scene, x: f64) -> DVec3 {
    let ray = Ray {
        origin: dvec3(x, 2.0, 0.3),
        direction: DVec3::NEG_Y,
    };
    let geometry = Geometry::new(scene);
    Space::Rec709.to_working().inverse() * geometry.transmittance(&ray, 0.0, 1.5)
}

fn is(found: DVec3, truth: DVec3) -> bool {
    (found - truth).abs().max_element() < 1e-6
}

/// What an sRGB value of 128 is in linear light.
const HALF: f64 = 0.215_860_500_113_899_3;

#[test]
fn a_scene_file_makes_a_material_glass() {
    let folder = folder();
    let scene = folder
        .load(
            "it.toml",
            table("material = \"glass\"\ntransmittance = 0.72"),
        )
        .expect("it loads");
    assert!(
        is(through(&scene, 0.3), DVec3::splat(0.72)),
        "not its base colour"
    );
    let keys =
        "material = \"glass\"\ntransmittance = [0.5, 1.0, 0.25]\nimage = \"tiles.png\"\npanes = 2";
    let scene = folder.load("it.toml", table(keys)).expect("it loads");
    assert_eq!(scene.warnings, []);
    for (x, colour) in [(0.2, dvec3(1.0, HALF, 0.0)), (0.8, dvec3(0.0, HALF, 1.0))] {
        let found = through(&scene, x);
        let truth = dvec3(0.5, 1.0, 0.25) * colour;
        // What the working space has no colour for is nothing.
        let held = Space::Rec709.to_working().inverse()
            * (Space::Rec709.to_working() * truth).max(DVec3::ZERO);
        assert!(is(found, held), "{x}: {found} {truth}");
    }
    // Two panes fall off otherwise than one.
    let slant = |count: u32| Incidence::new(0.4).transmittance(0.72, count);
    assert!((slant(1) - slant(2)).abs() > 0.01);
    let geometry = Geometry::new(&scene);
    assert!(
        geometry
            .warnings()
            .iter()
            .any(|w| matches!(w, Warning::Panes { .. }))
    );
    assert!(!geometry.occluded(
        &Ray {
            origin: dvec3(0.2, 2.0, 0.3),
            direction: DVec3::NEG_Y,
        },
        0.0,
        1.5,
    ));
}

#[test]
fn what_is_wrong_with_a_pane_is_named() {
    let folder = folder();
    for (keys, words) in [
        ("material = \"glas\"", "did you mean `glass`?"),
        ("material = \"glass\"\nimage = \"tile.png\"", "tile.png"),
        (
            "material = \"glass\"\nimage = \"it.mtl\"",
            "save the picture as PNG or JPEG",
        ),
        ("material = \"glass\"\ntransmittance = 1.2", "transmittance"),
        (
            "material = \"glass\"\ntransmittance = [0.1, 0.2]",
            "transmittance",
        ),
        ("material = \"glass\"\npanes = 4", "panes"),
        ("material = \"glass\"\npanes = 0", "panes"),
        ("material = \"glass\"\nior = 1.5", "ior"),
        ("transmittance = 0.5", "material"),
        (
            "material = \"glass\"\n[[pane]]\nmaterial = \"glass\"",
            "one table",
        ),
    ] {
        let error = folder.load("it.toml", table(keys)).expect_err(keys);
        let text = format!("{error} {}", error.remedy());
        assert!(text.contains("it.toml:") && text.contains(words), "{text}");
    }
    folder.put("alpha.png", picture());
    folder.put("it.mtl", format!("{MTL}newmtl spare\n"));
    for (keys, words) in [
        (
            "material = \"floor\"\nimage = \"tiles.png\"",
            "no texture coordinates",
        ),
        (
            "material = \"glass\"\nimage = \"alpha.png\"",
            "alpha is left out",
        ),
    ] {
        let scene = folder.load("it.toml", table(keys)).expect(keys);
        let said = scene.warnings.iter().any(|w| w.message().contains(words));
        assert!(said, "{:?}", scene.warnings);
    }
}

fn transmitting(extension: Value) -> Gltf {
    let mut file = Gltf::quad();
    file.json["materials"][0] = json!({
        "name": "glass",
        "pbrMetallicRoughness": {
            "metallicFactor": 0, "roughnessFactor": 0, "baseColorFactor": [0.5, 0.25, 0.75, 1.0]},
        "extensions": {"KHR_materials_transmission": extension},
    });
    file
}

#[test]
fn transmission_of_a_gltf_is_its_factor_times_the_base_colour() {
    let along = |scene: &Scene| {
        let ray = Ray {
            origin: dvec3(0.2, 0.4, 5.0),
            direction: DVec3::NEG_Z,
        };
        Space::Rec709.to_working().inverse() * Geometry::new(scene).transmittance(&ray, 0.0, 9.0)
    };
    let scene = transmitting(json!({"transmissionFactor": 0.8}))
        .load()
        .expect("it loads");
    assert!(
        is(along(&scene), 0.8 * dvec3(0.5, 0.25, 0.75)),
        "{}",
        along(&scene)
    );
    let said = |scene: &Scene, words: &str| {
        let mut all = scene.warnings.iter().map(|w| w.message());
        all.any(|text| text.contains(words))
    };
    assert!(said(&scene, "reflection of a material that lets a part"));
    assert!(!said(&scene, "KHR_materials_transmission"));
    // Without a factor it lets nothing through.
    let scene = transmitting(json!({})).load().expect("it loads");
    assert_eq!(scene.materials[0].pane, None);
    // Both multiply; what volume adds is left out and named.
    let mut file = transmitting(json!({"transmissionFactor": 1.0}));
    file.json["materials"][0]["extensions"]["KHR_materials_volume"] =
        json!({"attenuationColor": [1, 0, 0], "thicknessFactor": 1});
    file.json["materials"][0]["extensions"]["KHR_materials_ior"] = json!({"ior": 1.4});
    file.json["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = json!(0.3);
    let folder = Folder::new();
    folder.put("it.glb", file.glb());
    let text = "mesh = \"it.glb\"\n[[pane]]\nmaterial = \"glass\"\ntransmittance = 0.5\n";
    let scene = folder.load("it.toml", text).expect("it loads");
    assert!(is(along(&scene), 0.5 * dvec3(0.5, 0.25, 0.75)));
    for words in [
        "KHR_materials_volume",
        "KHR_materials_ior",
        "roughness of a pane",
    ] {
        assert!(said(&scene, words), "{words}: {:?}", scene.warnings);
    }
}
