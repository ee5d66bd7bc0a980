//! The GPU's pictures against the reference's where the scene reaches far: each kind of scene as it is, with a cube of a metre
//! 1.4 km away, and on a slab of 40 km. All pixels are compared, shadow edges among them.

mod common;

use common::build::*;
use common::shafts::gpu;
use common::{scenes, views};
use glam::{DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::backend::Limits;
use tyndall::backend::reference::Reference;
use tyndall::colour::luminance;
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::effect::Field;
use tyndall::frame::Frame;
use tyndall::medium::{Phase, Shape};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{self, Camera, Projection, Scene, Triangle};
use views::{fog, point_sun};

const DEG: f64 = PI / 180.0;
const SIZE: [u32; 2] = [64, 48];

/// A scene seen by a camera.
struct Kind {
    name: String,
    scene: Scene,
    camera: Camera,
}

/// Haze in a box around a scene, as dense as to take a third of the light along its diagonal.
fn hazy(mut scene: Scene) -> Scene {
    let (min, max) = scene.mesh.bounds().expect("it has triangles");
    let size = (max - min).length();
    scene.media = vec![fog(
        Shape::Box {
            min: min - 0.02 * size,
            max: max + 0.02 * size,
        },
        0.4 / size,
        0.02 / size,
        Phase::HenyeyGreenstein { g: 0.5 },
    )];
    scene
}

fn kind(name: &str, scene: Scene, eye: [f64; 3], target: [f64; 3]) -> Kind {
    Kind {
        name: name.into(),
        scene: hazy(scene),
        camera: Camera::look_at(eye.into(), target.into(), 60.0 * DEG),
    }
}

/// A hall with a roof on posts and a wall, as in the smallest case that came out wrong.
fn hall() -> Scene {
    let mut triangles = cuboid(dvec3(-5.0, -0.2, -6.0), dvec3(5.0, 0.0, 9.0));
    triangles.extend(cuboid(dvec3(-5.2, 0.0, -6.0), dvec3(-5.0, 4.0, 9.0)));
    triangles.extend(cuboid(dvec3(-5.2, 0.0, -6.2), dvec3(5.2, 4.0, -6.0)));
    for k in 0..6 {
        let z = -5.0 + 2.4 * f64::from(k);
        triangles.extend(cuboid(dvec3(4.7, 0.0, z), dvec3(5.0, 4.0, z + 0.3)));
    }
    for k in 0..4 {
        let z = -5.0 + 3.5 * f64::from(k);
        triangles.extend(cuboid(dvec3(-5.2, 4.0, z), dvec3(5.2, 4.2, z + 2.6)));
    }
    scene(&triangles, 110.0, 40.0)
}

/// Stairs in a corner: nothing but inner corners.
fn stairs() -> Scene {
    let mut triangles = Vec::new();
    for k in 0..10 {
        let (y, z) = (0.2 * f64::from(k), -0.3 * f64::from(k));
        triangles.extend(cuboid(dvec3(-2.0, y - 0.2, z - 0.3), dvec3(2.0, y, z)));
    }
    triangles.extend(cuboid(dvec3(-2.2, -0.2, -4.0), dvec3(-2.0, 4.0, 2.0)));
    triangles.extend(cuboid(dvec3(-2.0, -0.4, 0.0), dvec3(2.0, -0.2, 2.0)));
    scene(&triangles, 70.0, 50.0)
}

/// Blocks of houses of many heights, with streets between them.
fn city() -> Scene {
    let mut triangles = cuboid(dvec3(-160.0, -1.0, -160.0), dvec3(160.0, 0.0, 160.0));
    for i in 0..12 {
        for j in 0..12 {
            let (x, z) = (26.0 * f64::from(i) - 150.0, 26.0 * f64::from(j) - 150.0);
            let height = 8.0 + f64::from((i * 7 + j * 11) % 13) * 3.5;
            triangles.extend(cuboid(dvec3(x, 0.0, z), dvec3(x + 18.0, height, z + 16.0)));
            triangles.extend(cuboid(
                dvec3(x + 4.0, height, z + 4.0),
                dvec3(x + 8.0, height + 3.0, z + 8.0),
            ));
        }
    }
    scene(&triangles, 140.0, 30.0)
}

/// A room whose only window is a hand wide.
fn tiny_window() -> Scene {
    scenes::slit_room(0.1, [90.0, 35.0])
}

/// A ball of many facets on a floor.
fn ball() -> Scene {
    let at = |i: usize, j: usize| {
        let (theta, phi) = (PI * i as f64 / 24.0, 2.0 * PI * (j % 48) as f64 / 48.0);
        dvec3(
            theta.sin() * phi.cos(),
            1.0 + theta.cos(),
            theta.sin() * phi.sin(),
        )
    };
    let mut triangles = cuboid(dvec3(-4.0, -0.2, -4.0), dvec3(4.0, 0.0, 4.0));
    for i in 0..24 {
        for j in 0..48 {
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    scene(&triangles, 60.0, 35.0)
}

/// What people have, in twenty kinds.
fn kinds() -> Vec<Kind> {
    let mut kinds = vec![
        kind("hall", hall(), [0.0, 1.6, 8.0], [0.0, 1.8, -5.0]),
        kind("stairs", stairs(), [1.5, 1.8, 1.8], [-1.0, 0.8, -2.0]),
        kind("city", city(), [2.0, 1.7, 29.0], [3.0, 12.0, -60.0]),
        kind(
            "city from above",
            city(),
            [-190.0, 120.0, 210.0],
            [0.0, 10.0, 0.0],
        ),
        kind(
            "tiny window",
            tiny_window(),
            [-2.0, 1.6, 3.5],
            [1.0, 1.5, -2.0],
        ),
        kind("ball", ball(), [0.5, 1.6, 5.0], [0.0, 0.9, 0.0]),
        kind(
            "slit room",
            scenes::slit_room(0.3, [80.0, 40.0]),
            [-2.0, 1.6, 4.0],
            [1.0, 1.5, -2.0],
        ),
        kind(
            "slatted roof",
            scenes::slatted_roof(20, [100.0, 60.0]),
            [-2.5, 1.6, 4.2],
            [0.5, 1.6, -3.0],
        ),
        kind(
            "gates",
            scenes::gates(6, [70.0, 25.0]),
            [0.5, 1.7, 8.0],
            [0.0, 1.8, -10.0],
        ),
        kind(
            "colonnade",
            scenes::colonnade(6, 12, [75.0, 30.0]),
            [0.3, 1.7, 2.0],
            [0.0, 1.8, -12.0],
        ),
        kind(
            "hills",
            scenes::terrain(40, 400.0, [110.0, 20.0]),
            [30.0, 60.0, 120.0],
            [0.0, 10.0, -60.0],
        ),
        kind(
            "far mountain",
            scenes::terrain(40, 20_000.0, [110.0, 15.0]),
            [1000.0, 2600.0, 9000.0],
            [0.0, 900.0, -3000.0],
        ),
        kind(
            "soup",
            scenes::soup(300, 0.2, 7, [40.0, 45.0]),
            [0.0, 0.3, 2.8],
            [0.0, 0.0, 0.0],
        ),
        kind(
            "straight walls",
            scenes::gates(3, [90.0, 45.0]),
            [4.0, 2.0, 6.0],
            [-1.0, 1.0, -6.0],
        ),
    ];
    for view in [
        views::slats(1.0),
        views::hills(),
        views::antisolar(),
        views::forest(60),
    ] {
        kinds.push(Kind {
            name: format!("the study {}", view.name),
            scene: view.scene,
            camera: view.camera,
        });
    }
    // By other cameras.
    for (name, projection) in [
        ("hall, panorama", Projection::Panorama),
        (
            "hall, orthographic",
            Projection::Orthographic { height: 9.0 },
        ),
    ] {
        let mut other = kind(name, hall(), [1.0, 1.6, 7.0], [-1.0, 1.8, -5.0]);
        other.camera.projection = projection;
        kinds.push(other);
    }
    // Haze without end over the ground, seen from within and from above.
    let mut open = hall();
    open.media = vec![fog(
        Shape::Haze { top: 60.0 },
        0.004,
        0.0004,
        Phase::HenyeyGreenstein { g: 0.5 },
    )];
    kinds.push(Kind {
        name: "hall in a wide haze".into(),
        scene: open,
        camera: Camera::look_at(dvec3(9.0, 1.7, 12.0), dvec3(-2.0, 2.0, -5.0), 60.0 * DEG),
    });
    let mut fence = scenes::gates(5, [80.0, 20.0]);
    fence.media = vec![fog(
        Shape::Haze { top: 30.0 },
        0.01,
        0.001,
        Phase::Isotropic,
    )];
    kinds.push(Kind {
        name: "gates in a wide haze".into(),
        scene: fence,
        camera: Camera::look_at(dvec3(9.0, 1.7, 5.0), dvec3(-2.0, 2.0, -8.0), 60.0 * DEG),
    });
    kinds
}

/// Adds triangles of the first material.
fn add(scene: &mut Scene, triangles: &[[DVec3; 3]]) {
    let mesh = &mut scene.mesh;
    for corners in triangles {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        mesh.normals.extend([DVec3::ZERO; 3]);
        mesh.uvs.extend([glam::DVec2::ZERO; 3]);
        if !mesh.colors.is_empty() {
            mesh.colors.extend([glam::DVec4::ONE; 3]);
        }
        mesh.triangles.push(Triangle {
            vertices: [first, first + 1, first + 2],
            material: 0,
        });
    }
}

/// A cube of a metre, 1.4 km away.
fn with_far_cube(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let at = dvec3(1000.0, 0.0, -980.0);
    add(&mut scene, &cuboid(at, at + 1.0));
    scene
}

/// A slab of 40 km just below everything.
fn on_a_slab(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let (min, _) = scene.mesh.bounds().expect("it has triangles");
    let top = min.y - 0.01;
    add(
        &mut scene,
        &cuboid(dvec3(-2e4, top - 1.0, -2e4), dvec3(2e4, top, 2e4)),
    );
    scene
}

/// Relative RMSE of a layer's luminance over all pixels, and how many are off by more than a tenth of its mean.
fn error(found: &Frame, truth: &Frame, field: Field) -> (f64, usize) {
    let (found, truth) = (layer(found, field), layer(truth, field));
    let mean = truth.iter().map(|v| luminance(*v)).sum::<f64>() / truth.len() as f64;
    let pairs = found.iter().zip(&truth);
    let off = pairs.map(|(a, b)| (luminance(*a) - luminance(*b)).abs());
    let square: f64 = off.clone().map(|d| d * d).sum();
    if square == 0.0 {
        return (0.0, 0);
    }
    let rmse = (square / truth.len() as f64).sqrt() / mean;
    (rmse, off.filter(|d| *d > 0.1 * mean).count())
}

/// The pictures of a device and of the reference.
fn pictures(scene: Scene, camera: Camera) -> [Frame; 2] {
    let request = Request {
        size: Some(SIZE),
        samples: Some(1),
        camera: CameraChoice::Given(camera),
        ..Request::default()
    };
    let conditions = Conditions::new(scene, &request).expect("the scene is sound");
    let overrules = Overrules {
        quality: Quality::Preview,
        set: [
            ("surface_sun.disc", 0.0),
            ("surface_sun.suns", 1.0),
            ("shafts_rectified.disc", 0.0),
            ("shafts_rectified.suns", 1.0),
            // The light of sky and surfaces is the same code on both, so it only has to be there.
            ("radiosity.rays", 16.0),
            ("radiosity.outline", 1.0),
            ("radiosity.patches", 500.0),
            ("radiosity.patch_rays", 1e4),
            ("radiosity.patch_spots", 0.0),
            ("radiosity.depth", 0.0),
        ]
        .map(|(knob, value)| (knob.to_owned(), value))
        .into_iter()
        .collect(),
        without: vec!["air_sky".into()],
        ..Overrules::default()
    };
    let plan = Plan::new(&conditions, &overrules).expect("the plan is sound");
    let limits = Limits::memory(1 << 30);
    let found = gpu()
        .render(&plan, &limits, &|_| {})
        .expect("the device works")
        .frame;
    let truth = Reference::new(&plan)
        .expect("it can be prepared")
        .render(&limits, &|_| {})
        .expect("there is memory")
        .frame;
    [found, truth]
}

/// Errors of the layers.
fn errors(scene: Scene, camera: Camera) -> [(f64, usize); 3] {
    let [found, truth] = pictures(scene, camera);
    ALLOWED.map(|(field, _)| error(&found, &truth, field))
}

/// What each layer may be off by, relative to its mean.
const ALLOWED: [(Field, f64); 3] = [
    (Field::Sun, 0.01),
    (Field::InscatterSun, 0.005),
    (Field::Sky, 1e-3),
];

#[test]
fn far_things_change_nothing() {
    let test = "far_things_change_nothing";
    if !common::gpu(test) {
        return;
    }
    let mut complaints = Vec::new();
    let mut most = [0f64; 3];
    for Kind {
        name,
        scene,
        camera,
    } in kinds()
    {
        for (with, scene) in [
            ("alone", scene.clone()),
            ("far cube", with_far_cube(&scene)),
            ("on a slab", on_a_slab(&scene)),
        ] {
            let found = errors(scene, camera);
            let row = ALLOWED
                .iter()
                .zip(found)
                .map(|((field, _), (rmse, off))| format!("  {} {rmse:.1e} ({off})", field.name()));
            eprintln!("{name:<24} {with:<10}{}", row.collect::<String>());
            for (((field, allowed), (rmse, _)), most) in ALLOWED.iter().zip(found).zip(&mut most) {
                *most = most.max(rmse);
                if rmse.is_nan() || rmse > *allowed {
                    complaints.push(format!("{name}, {with}: {} {rmse:.1e}", field.name()));
                }
            }
        }
    }
    eprintln!("the most: {most:.1?}");
    assert_eq!(complaints, [""; 0]);
}

#[test]
fn the_comparison_notices_a_turned_sun() {
    if !common::gpu("the_comparison_notices_a_turned_sun") {
        return;
    }
    let scene = on_a_slab(&hazy(hall()));
    let camera = Camera::look_at(dvec3(0.0, 1.6, 8.0), dvec3(0.0, 1.8, -5.0), 60.0 * DEG);
    let truth = pictures(scene.clone(), camera)[1].clone();
    let mut turned = scene;
    if let Some(sun) = &mut turned.sun {
        sun.azimuth_deg += 0.5;
    }
    let [found, _] = pictures(turned, camera);
    for (field, allowed) in &ALLOWED[..2] {
        let (rmse, _) = error(&found, &truth, *field);
        assert!(rmse > *allowed, "{}: {rmse}", field.name());
    }
}

/// Two quads, of which one is 10 000 km away: the near one is where it is.
#[test]
fn something_ten_thousand_kilometres_away_hides_nothing() {
    if !common::gpu("something_ten_thousand_kilometres_away_hides_nothing") {
        return;
    }
    let near = quad(dvec3(-1.0, 0.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0);
    for far in [1e4, 1e6, 1e7] {
        for orthographic in [false, true] {
            let mut all = near.to_vec();
            all.extend(quad(dvec3(far, 0.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0));
            let mut camera =
                Camera::look_at(dvec3(0.4, 1.2, 3.2), dvec3(0.0, 1.0, 0.0), 50.0 * DEG);
            if orthographic {
                camera.projection = Projection::Orthographic { height: 3.0 };
            }
            let [found, truth] = pictures(scene(&all, 150.0, 40.0), camera);
            let seen = truth.depth.iter().filter(|z| **z < 100.0).count();
            assert!(seen > 500, "{far}: {seen} pixels");
            let (rmse, _) = error(&found, &truth, Field::Sun);
            assert!(rmse < 1e-4, "{far}, orthographic {orthographic}: {rmse}");
            for (a, b) in found.depth.iter().zip(&truth.depth) {
                assert!((a / b - 1.0).abs() < 1e-5, "{far}: {a} {b}");
            }
        }
    }
}

/// Inside of a box that light enters nowhere, seen along all its corners: not one pixel is lit. Without one of its walls as many
/// are as by the reference.
#[test]
fn inner_corners_are_dark() {
    if !common::gpu("inner_corners_are_dark") {
        return;
    }
    let walls = cuboid(dvec3(-3.0, 0.0, -4.0), dvec3(3.0, 2.6, 4.0));
    let wall = |x: f64| walls.iter().filter(move |t| t.iter().any(|p| p.x != x));
    let open: Vec<_> = wall(3.0).copied().collect();
    assert_eq!(open.len(), walls.len() - 2);
    let camera = Camera::look_at(dvec3(2.6, 2.3, 3.7), dvec3(-2.9, 0.1, -3.9), 75.0 * DEG);
    let lit = |frame: &Frame| {
        let sun = layer(frame, Field::Sun);
        sun.iter().filter(|v| **v != DVec3::ZERO).count()
    };
    for far in [false, true] {
        for azimuth in [3.0, 48.0, 93.0, 138.0, 183.0, 228.0, 273.0, 318.0] {
            let at = |triangles: &[[DVec3; 3]]| {
                let scene = scene(triangles, azimuth, 41.0);
                let scene = if far { on_a_slab(&scene) } else { scene };
                pictures(scene, camera).map(|frame| lit(&frame))
            };
            assert_eq!(at(&walls), [0, 0], "the sun in azimuth {azimuth}");
            let [found, truth] = at(&open);
            assert_eq!(found, truth, "the sun in azimuth {azimuth}");
            assert!(azimuth != 93.0 || truth > 100);
        }
    }
}

/// Twenty thousand houses along streets, each as high as chance has it.
#[test]
fn a_city_of_many_houses_has_no_holes() {
    if !common::gpu("a_city_of_many_houses_has_no_holes") {
        return;
    }
    let chance = |i: i32, j: i32, k: i32| {
        let x = f64::from(i) * 12.9898 + f64::from(j) * 78.233 + f64::from(k) * 37.719;
        (x.sin() * 43758.5453).rem_euclid(1.0)
    };
    let mut triangles = Vec::new();
    for i in -70..70 {
        for j in -70..70 {
            let (x, z) = (20.0 * f64::from(i), 20.0 * f64::from(j));
            let half = 5.0 + 3.0 * chance(i, j, 0);
            let height =
                5.0 - 12.0 * (1.0 - chance(i, j, 1)).ln() - 12.0 * (1.0 - chance(i, j, 2)).ln();
            triangles.extend(cuboid(
                dvec3(x - half, 0.0, z - half),
                dvec3(x + half, height, z + half),
            ));
        }
    }
    let mut city = scene(&triangles, 200.0, 20.0);
    city.ground.enabled = true;
    city.media = vec![fog(
        Shape::Haze { top: 120.0 },
        0.002,
        0.0,
        Phase::Isotropic,
    )];
    let camera = Camera::look_at(dvec3(10.0, 60.0, 400.0), dvec3(0.0, 20.0, 0.0), 60.0 * DEG);
    let [found, truth] = pictures(city, camera);
    for (field, allowed) in ALLOWED {
        let (rmse, off) = error(&found, &truth, field);
        eprintln!("{} {rmse:.1e} ({off})", field.name());
        assert!(
            rmse <= allowed && off == 0,
            "{}: {rmse} ({off})",
            field.name()
        );
    }
}

/// Scenes by others, as they are and where something far away is added.
#[test]
fn real_scenes_agree_too() {
    let test = "real_scenes_agree_too";
    let Some(folder) = common::data(test) else {
        return;
    };
    if !common::gpu(test) {
        return;
    }
    let mut complaints = Vec::new();
    for name in [
        "gazebo/gazebo.obj",
        "living_room/living_room.glb",
        "palm_tree/PalmTree.gltf",
        "room/room.glb",
        "terrain/Mountains.gltf",
        "volumetric_fog/VolumetricFogExample.glb",
    ] {
        let mut scene = scene::load(&folder.join("scenes").join(name)).expect("the scene is sound");
        scene.sun = Some(point_sun(120.0, 35.0));
        let camera = match scene.cameras.first() {
            Some(named) => named.camera,
            None => {
                let bounds = scene.mesh.bounds().expect("it has triangles");
                Camera::around(bounds, f64::from(SIZE[0]) / f64::from(SIZE[1]))
            }
        };
        let scene = hazy(scene);
        for (with, scene) in [
            ("alone", scene.clone()),
            ("far cube", with_far_cube(&scene)),
            ("on a slab", on_a_slab(&scene)),
        ] {
            let start = std::time::Instant::now();
            let found = errors(scene, camera);
            let row = ALLOWED
                .iter()
                .zip(found)
                .map(|((field, allowed), (rmse, off))| {
                    if rmse.is_nan() || rmse > *allowed {
                        complaints.push(format!("{name}, {with}: {} {rmse:.1e}", field.name()));
                    }
                    format!("  {} {rmse:.1e} ({off})", field.name())
                });
            let row = row.collect::<String>();
            eprintln!(
                "{name:<40} {with:<10}{row}  {:.1} s",
                start.elapsed().as_secs_f64()
            );
        }
    }
    assert_eq!(complaints, [""; 0]);
}
