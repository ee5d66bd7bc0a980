//! Lamps of scene files: what `[[light]]` says, and what is wrong with it.

mod common;

use common::files::*;
use glam::{DVec3, dvec3};
use serde_json::json;
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::photometry::Distribution;
use tyndall::scene::{Camera, LampForm, Scene};

const ALL: &str = r#"
[[light]]
name = "lamp"
position = [0.0, 3.5, 0.0]
toward = [0.0, -2.0, 0.0]
around = [1.0, 0.0, 0.0]
intensity = 1000.0
distribution = { kind = "nishita-spot", spread = 28.0, sharpness = 0.25 }
[[light]]
position = [1.0, 3.5, 0.0]
intensity = [10.0, 20.0, 30.0]
to = [4.0, 3.5, 0.0]
[[light]]
position = [1, 3.5, 0]
intensity = 5
edges = [[1.0, 0.0, 0.0], [0.0, 0.0, 2.0]]
distribution = { kind = "daisy", spread = 60, sharpness = 0.2, petals = 9, ratio = -0.3 }
[[light]]
position = [1.0, 3.5, 0.0]
intensity = 5.0
radius = 0.05
distribution = { kind = "polka-dots", spread = 60.0, sharpness = 0.2, petals = 8, ratio = -0.3, rings = 4 }
[[light]]
position = [1.0, 0.6, 0.0]
toward = [0.0, -0.1, -1.0]
intensity = 2e4
distribution = { kind = "elliptical", spread = [20.0, 8.0], sharpness = 0.2 }
[[light]]
position = [0.0, 3.0, 0.0]
distribution = { kind = "file", path = "lamp.ies" }
"#;

const IES: &str =
    "IESNA:LM-63-2002\nTILT=NONE\n1 -1 2.0 3 1 1 2 0 0 0\n1 1 10\n0 45 90\n0\n100 50 0\n";

#[test]
fn a_scene_file_has_lamps_of_every_kind() {
    let folder = Folder::new();
    folder.put("lamp.ies", IES);
    let scene = folder.load("night.toml", ALL).expect("it loads");
    let [spot, line, rectangle, sphere, headlight, file] = &scene.lamps[..] else {
        panic!("{} lamps", scene.lamps.len());
    };
    assert_eq!(
        (spot.name.as_str(), line.name.as_str()),
        ("lamp", "light 2")
    );
    assert_eq!(spot.toward.normalize(), DVec3::NEG_Y);
    assert_eq!(spot.around, Some(DVec3::X));
    let Distribution::NishitaSpot { spread, sharpness } = spot.distribution else {
        panic!("{:?}", spot.distribution);
    };
    assert_eq!((spread, sharpness), (28f64.to_radians(), 0.25));
    assert_eq!(
        line.form,
        LampForm::Line {
            to: dvec3(4.0, 3.5, 0.0)
        }
    );
    assert_eq!(line.intensity, dvec3(10.0, 20.0, 30.0));
    assert_eq!(line.toward, DVec3::NEG_Y);
    assert_eq!(
        rectangle.form,
        LampForm::Rectangle {
            edges: [DVec3::X, 2.0 * DVec3::Z]
        }
    );
    assert_eq!(sphere.form, LampForm::Sphere { radius: 0.05 });
    let Distribution::Elliptical { spread: [a, b], .. } = headlight.distribution else {
        panic!("{:?}", headlight.distribution);
    };
    assert_eq!((a, b), (20f64.to_radians(), 8f64.to_radians()));
    // A file has its own candela; the multiplier is its own too.
    let Distribution::Table(table) = &file.distribution else {
        panic!("{:?}", file.distribution);
    };
    assert_eq!(file.intensity, DVec3::ONE);
    assert!((table.intensity(0.0, 0.0) - 200.0).abs() < 1e-9);
    assert!((table.intensity(45f64.to_radians(), 1.0) - 100.0).abs() < 1e-9);
}

#[test]
fn what_is_wrong_with_a_lamp_is_named_with_its_line() {
    let folder = Folder::new();
    let head = "position = [0.0, 3.0, 0.0]\nintensity = 10.0\n";
    let cases = [
        ("intensity = 1.0\n", "position", "stands nowhere"),
        ("position = [0.0, 1.0, 0.0]\n", "intensity", "has none"),
        (
            &format!("{head}toward = [0.0, 0.0, 0.0]\n"),
            "toward",
            "no direction",
        ),
        (
            &format!("{head}to = [0.0, 3.0, 0.0]\n"),
            "to",
            "where the lamp begins",
        ),
        (
            &format!("{head}edges = [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]\n"),
            "edges",
            "no area",
        ),
        (
            &format!("{head}edges = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]\n"),
            "edges",
            "axis lies in the rectangle",
        ),
        (
            &format!("{head}radius = 0.1\nto = [1.0, 1.0, 1.0]\n"),
            "position",
            "more than one",
        ),
        (&format!("{head}radius = 0.0\n"), "radius", "0"),
        (
            &format!("{head}intensty = 1.0\n"),
            "intensty",
            "did you mean",
        ),
        (
            &format!("{head}node = \"Lamp\"\n"),
            "position",
            "has a node",
        ),
        ("node = \"Lamp\"\nintensity = 1.0\n", "node", "no node"),
        (
            &format!("{head}distribution = {{ kind = \"spot\" }}\n"),
            "distribution",
            "",
        ),
        (
            &format!(
                "{head}distribution = {{ kind = \"polka-dots\", spread = 20.0, sharpness = 0.1, petals = 7, ratio = 0.0, rings = 2 }}\n"
            ),
            "petals",
            "even",
        ),
        (
            &format!(
                "{head}distribution = {{ kind = \"nishita-spot\", spread = 200.0, sharpness = 0.1 }}\n"
            ),
            "spread",
            "180",
        ),
        (
            &format!("{head}distribution = {{ kind = \"file\", path = \"no.ies\" }}\n"),
            "path",
            "cannot read",
        ),
    ];
    for (body, key, says) in cases {
        let text = folder.refused("night.toml", format!("[[light]]\n{body}"));
        assert!(text.contains(key), "{body}: {text}");
        assert!(text.contains(says), "{body}: {text}");
        assert!(text.contains("night.toml:"), "no line in {text}");
    }
    // A lamp beyond where places are told apart, as the library is given it.
    let mut scene = folder
        .load("far.toml", format!("[[light]]\n{head}"))
        .expect("it loads");
    scene.lamps[0].position = dvec3(1e10, 0.0, 0.0);
    let request = Request {
        camera: CameraChoice::Given(Camera::look_at(DVec3::ZERO, DVec3::X, 1.0)),
        ..Request::default()
    };
    let error = Conditions::new(scene, &request)
        .err()
        .expect("it is too far");
    assert!(error.to_string().contains("-1e9 to 1e9"), "{error}");
}

/// A mesh with two nodes of one name, one of them below a node that turns and moves it.
fn nodes() -> Vec<u8> {
    let (mut json, bin) = example();
    let nodes = json["nodes"].as_array_mut().expect("it has nodes");
    let count = nodes.len();
    nodes.push(json!({ "name": "Lamp.003", "translation": [1.0, 2.0, 3.0] }));
    // A quarter turn about X: -Z of the node points to +Y.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    nodes.push(json!({
        "children": [count + 2],
        "translation": [0.0, 10.0, 0.0],
        "rotation": [half, 0.0, 0.0, half]
    }));
    nodes.push(json!({ "name": "Lamp.003" }));
    let roots = json["scenes"][0]["nodes"]
        .as_array_mut()
        .expect("it has roots");
    roots.push(json!(count));
    roots.push(json!(count + 1));
    glb(&json, &bin)
}

#[test]
fn a_lamp_stands_where_a_node_does_and_points_as_it_does() {
    let folder = Folder::new();
    folder.put("nodes.glb", nodes());
    let text = "mesh = \"nodes.glb\"\nscale = 2.0\norigin = [0.0, 0.0, 1.0]\n[[light]]\nnode = \"Lamp.003\"\nintensity = 7.0\nname = \"bulb\"\n";
    let scene: Scene = folder.load("nodes.toml", text).expect("it loads");
    let [first, second] = &scene.lamps[..] else {
        panic!("{} lamps", scene.lamps.len());
    };
    assert_eq!(
        (first.name.as_str(), second.name.as_str()),
        ("bulb 1", "bulb 2")
    );
    assert!(
        first.position.distance(dvec3(2.0, 4.0, 7.0)) < 1e-12,
        "{}",
        first.position
    );
    assert!(first.toward.distance(DVec3::NEG_Z) < 1e-12);
    assert!(second.position.distance(dvec3(0.0, 20.0, 1.0)) < 1e-12);
    assert!(
        second.toward.distance(DVec3::Y) < 1e-12,
        "{}",
        second.toward
    );
    let text = folder.refused("typo.toml", text.replace("Lamp.003", "Lamp.03"));
    assert!(text.contains("did you mean `Lamp.003`?"), "{text}");
}

#[test]
fn the_quadrants_of_a_file_lie_where_radiance_has_them() {
    // C turns by the right-hand rule about minus the axis: a hanging lamp with `around` +X has C90 at -Z.
    let mut ies =
        "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1.0 3 5 1 2 0 0 0\n1 1 10\n0 45 90\n0 90 180 270 360\n"
            .to_owned();
    for c in [10.0, 20.0, 30.0, 40.0, 10.0] {
        ies += &format!("100 {c} 0\n");
    }
    let folder = Folder::new();
    folder.put("lamp.ies", ies);
    let text = "[[light]]\nposition = [0.0, 3.0, 0.0]\naround = [1.0, 0.0, 0.0]\ndistribution = { kind = \"file\", path = \"lamp.ies\" }\n[camera]\neye = [0.0, 1.0, 5.0]\ntarget = [0.0, 1.0, 0.0]\n";
    let scene = folder.load("lamp.toml", text).expect("it loads");
    let seen = Conditions::new(scene, &Request::default()).expect("it is sound");
    let lamp = &seen.lamps[0];
    let along = |v: DVec3| {
        lamp.distribution
            .intensity(&lamp.pose, (v + DVec3::NEG_Y).normalize())
    };
    for (side, candela) in [
        (DVec3::X, 10.0),
        (DVec3::NEG_Z, 20.0),
        (DVec3::NEG_X, 30.0),
        (DVec3::Z, 40.0),
    ] {
        assert!(
            (along(side) - candela).abs() < 1e-9,
            "{side}: {}",
            along(side)
        );
    }
}

#[test]
fn a_spot_of_a_right_angle_in_f32_is_a_spot() {
    let (mut json, bin) = example();
    let spot = |angle: f64| json!({ "lights": [{ "type": "spot", "intensity": 5.0, "spot": { "outerConeAngle": angle } }] });
    let nodes = json["nodes"].as_array_mut().expect("it has nodes");
    let index = nodes.len();
    nodes.push(json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
    let roots = json["scenes"][0]["nodes"]
        .as_array_mut()
        .expect("it has roots");
    roots.push(json!(index));
    let folder = Folder::new();
    json["extensions"]["KHR_lights_punctual"] = spot(f64::from(std::f32::consts::FRAC_PI_2));
    let scene = folder.load("spot.glb", glb(&json, &bin)).expect("it loads");
    let seen = Conditions::new(scene, &Request::default()).expect("it is sound");
    assert!(!seen.lamps.is_empty());
    // A wider one is no cone: it is named and left out.
    json["extensions"]["KHR_lights_punctual"] = spot(2.0);
    let scene = folder.load("wide.glb", glb(&json, &bin)).expect("it loads");
    assert!(scene.lights.is_empty());
    let said: Vec<String> = scene.warnings.iter().map(|w| w.to_string()).collect();
    assert!(
        said.iter()
            .any(|text| text.contains("its cone from 0 to 2 rad")),
        "{said:?}"
    );
}
