//! Where people can be: `--camera inside` stands on a floor with light in sight, and sensors of grids where daylight comes to, in halls made
//! here and in rooms by others.

mod common;

use common::build::{cuboid, scene};
use common::grids::{built, grid, level, solid};
use common::night::lamp;
use common::rooms::panel;
use glam::{DVec3, dvec3};
use tyndall::backend::{Backend, Limits, Wanted};
use tyndall::colour::luminance;
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::daylight::grid::{GridSpec, Sensors};
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

/// A room of sheets, 6 by 4 and 3 high, with a window to the south or without one, and behind a door a closet, 2 deep; voids below the
/// floor, above the ceiling and behind a wall, all higher than a person.
fn house(window: &[[f64; 4]]) -> Scene {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let mut room = level([0.0, -6.0], [6.0, 0.0], 0.0);
    room.extend(level([0.0, -6.0], [6.0, 0.0], 3.0));
    room.extend(panel(DVec3::ZERO, x, y, [6.0, 3.0], window));
    room.extend(panel(-4.0 * z, x, y, [6.0, 3.0], &[[1.0, 1.9, 0.0, 2.0]]));
    room.extend(panel(-6.0 * z, x, y, [6.0, 3.0], &[]));
    room.extend(panel(DVec3::ZERO, -z, y, [6.0, 3.0], &[]));
    room.extend(panel(6.0 * x, -z, y, [6.0, 3.0], &[]));
    built(&[
        ("Room", room),
        (
            "Cellar",
            solid(dvec3(0.0, -2.3, -6.0), dvec3(6.0, -0.2, 0.0)),
        ),
        ("Attic", solid(dvec3(0.0, 3.2, -6.0), dvec3(6.0, 5.5, 0.0))),
        ("Shaft", solid(dvec3(6.1, 0.0, -6.0), dvec3(7.2, 2.9, 0.0))),
    ])
}

#[test]
fn voids_that_no_daylight_comes_to_have_no_sensors() {
    let window = [[2.0, 4.0, 0.9, 2.1]];
    let sensors = grid(&house(&window), "plane=0.85,spacing=0.5");
    let names: Vec<&str> = sensors.planes.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["Room"]);
    // The closet too, which sees no window.
    assert_eq!(sensors.points.len(), 12 * 12);
    let mut left_out: Vec<String> = sensors.left_out.iter().map(ToString::to_string).collect();
    left_out.sort();
    eprintln!("{left_out:#?}");
    let why = "left out: they are closed in where no daylight comes to";
    assert_eq!(
        left_out,
        [
            format!("Attic: 144 sensors (36 m2) {why}"),
            format!("Cellar: 144 sensors (36 m2) {why}"),
            format!("Shaft: 36 sensors (6.6 m2) {why}"),
        ]
    );
    // Who names a void means it, and lamps may light any.
    let specs = ["Room", "Attic"].map(|room| {
        GridSpec::parse(&format!("room={room},plane=0.85,spacing=0.5")).expect("it can be read")
    });
    let scene = house(&window);
    let both = Sensors::new(&scene, &Geometry::new(&scene), &specs).expect("both have sensors");
    assert_eq!(both.points.len(), 2 * 144);
    let mut lit = house(&window);
    lit.lamps = vec![lamp(dvec3(3.0, 2.5, -2.0), 100.0, Distribution::Isotropic)];
    assert_eq!(grid(&lit, "plane=0.85,spacing=0.5").planes.len(), 4);
    // Where no daylight comes to any, voids and rooms are alike; that is said.
    let sensors = grid(&house(&[]), "plane=0.85,spacing=0.5");
    assert_eq!(sensors.planes.len(), 4);
    assert!(sensors.notes[0].contains("[[pane]]"), "{:?}", sensors.notes);
}

#[test]
fn rooms_by_others_have_sensors_in_the_light() {
    let Some(folder) = common::data("rooms_by_others_have_sensors_in_the_light") else {
        return;
    };
    // Sensors, and the area of those that voids would have [m2].
    for (name, count, voids) in [
        ("living_room/living_room.glb", 238, 90.0),
        ("room/room.glb", 384, 0.0),
        ("volumetric_fog/VolumetricFogExample.glb", 300, 0.0),
    ] {
        let scene = load(&folder.join("scenes").join(name)).expect("the scene is sound");
        let sensors = grid(&scene, "plane=0.85,spacing=0.5");
        let is_void = |why: &str| why.contains("daylight");
        let left_out = sensors.left_out.iter().filter(|l| is_void(l.why));
        let area: f64 = left_out.filter_map(|left| left.area).sum();
        eprintln!(
            "{name}: {} sensors, {area} m2 in voids",
            sensors.points.len()
        );
        assert_eq!(sensors.points.len(), count, "{name}");
        assert!((area - voids).abs() < 1.0, "{name}: {area} m2");
    }
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
