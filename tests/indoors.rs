//! `--camera inside` stands on a floor with light in sight, in halls made here and in rooms by others.

mod common;

use common::build::{cuboid, scene};
use common::night::lamp;
use glam::{DVec3, dvec3};
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::colour::luminance;
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::photometry::Distribution;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::indoors::indoors;
use tyndall::scene::{Geometry, Scene, SunEntry, load};

/// A hall of 12 x 5 x 8 m whose walls are hollow boxes 3 m thick, with a window in its south wall or without one.
fn hall(window: bool) -> Scene {
    let wall = |a: [f64; 3], b: [f64; 3]| cuboid(a.into(), b.into());
    let mut parts = vec![
        wall([-6.0, -3.0, -4.0], [6.0, 0.0, 4.0]),
        wall([-6.0, 5.0, -4.0], [6.0, 8.0, 4.0]),
        wall([-9.0, -3.0, -7.0], [-6.0, 8.0, 7.0]),
        wall([6.0, -3.0, -7.0], [9.0, 8.0, 7.0]),
        wall([-6.0, -3.0, -7.0], [6.0, 8.0, -4.0]),
    ];
    if window {
        parts.push(wall([-6.0, -3.0, 4.0], [3.0, 8.0, 7.0]));
        parts.push(wall([3.0, -3.0, 4.0], [6.0, 1.0, 7.0]));
        parts.push(wall([3.0, 3.0, 4.0], [6.0, 8.0, 7.0]));
    } else {
        parts.push(wall([-6.0, -3.0, 4.0], [6.0, 8.0, 7.0]));
    }
    scene(&parts.concat(), 180.0, 40.0)
}

#[test]
fn an_eye_stands_in_the_hall_and_not_in_its_walls() {
    let scene = hall(true);
    let found = indoors(&scene, &Geometry::new(&scene), None).expect("there is a place");
    let camera = found.camera;
    let [x, y, z] = camera.eye.to_array();
    assert!(found.is_under_a_roof);
    assert!(x.abs() < 6.0 && z.abs() < 4.0, "{}", camera.eye);
    assert!((y - 1.6).abs() < 1e-5, "{}", camera.eye);
    // The window is in its view.
    let window = dvec3(4.5, 2.0, 4.0) - camera.eye;
    let angle = window.angle_between(camera.forward).to_degrees();
    assert!(angle < 40.0, "{angle}");
}

#[test]
fn a_sealed_void_is_no_place_unless_a_lamp_hangs_in_it() {
    let mut scene = hall(false);
    let geometry = Geometry::new(&scene);
    let found = indoors(&scene, &geometry, None).expect("there is the roof");
    assert!(!found.is_under_a_roof && (found.camera.eye.y - 9.6).abs() < 1e-5);
    scene.lamps = vec![lamp(dvec3(0.0, 4.0, 0.0), 100.0, Distribution::Isotropic)];
    let found = indoors(&scene, &geometry, None).expect("there is the hall");
    assert!(found.is_under_a_roof && (found.camera.eye.y - 1.6).abs() < 1e-5);
    // A wall alone has no floor.
    let mut wall = common::build::scene(
        &cuboid(dvec3(0.0, 0.0, 0.0), dvec3(5.0, 5.0, 1e-3)),
        0.0,
        45.0,
    );
    wall.mesh.triangles.retain(|t| {
        let [a, b, c] = t.vertices.map(|v| wall.mesh.positions[v as usize]);
        (b - a).cross(c - a).normalize().y.abs() < 0.5
    });
    let request = Request {
        camera: CameraChoice::Inside,
        ..Request::default()
    };
    let Err(error) = Conditions::new(wall, &request) else {
        panic!("nobody stands on a wall");
    };
    assert!(error.to_string().contains("--camera inside"), "{error}");
}

#[test]
fn rooms_by_others_are_seen_and_lit() {
    let Some(folder) = common::data("rooms_by_others_are_seen_and_lit") else {
        return;
    };
    for name in [
        "gazebo/gazebo.obj",
        "living_room/living_room.glb",
        "palm_tree/PalmTree.gltf",
        "room/room.glb",
        "terrain/Mountains.gltf",
        "volumetric_fog/VolumetricFogExample.glb",
    ] {
        let mut scene = load(&folder.join("scenes").join(name)).expect("the scene is sound");
        scene.sun = Some(SunEntry {
            azimuth_deg: 150.0,
            elevation_deg: 40.0,
            illuminance: None,
            diameter_deg: None,
        });
        let request = Request {
            size: Some([32, 20]),
            samples: Some(1),
            camera: CameraChoice::Inside,
            ..Request::default()
        };
        let conditions = Conditions::new(scene, &request).expect("there is a place");
        let camera = conditions.view.camera;
        eprintln!(
            "{name}: {}, eye {:.2}, toward {:.2}",
            conditions.view.chosen, camera.eye, camera.forward
        );
        let overrules = Overrules {
            quality: Quality::Preview,
            ..Overrules::default()
        };
        let plan = Plan::new(&conditions, &overrules).expect("the plan is sound");
        let mut backend = Backend::open(Wanted::Reference).expect("it is always there");
        let rendered = backend.render(&plan, &Limits::default(), &|_| {});
        let frame = rendered.expect("it works").frame;
        let lit = (0..frame.pixels()).filter(|i| luminance(frame.picture(*i)) > 1.0);
        let share = lit.count() as f64 / frame.pixels() as f64;
        eprintln!("{name}: {:.0} % of the pixels are lit", 100.0 * share);
        assert!(share > 0.9, "{name}");
        assert_ne!(camera.forward, DVec3::ZERO);
    }
}
