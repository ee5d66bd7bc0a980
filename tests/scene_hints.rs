//! Whether a mesh looks as if its unit were not the metre, or its Z axis pointed up, and what is asked for.

mod common;

use common::files::*;
use common::gltf::*;
use common::grids::{self, built, level};
use common::rooms::panel;
use glam::DVec3;
use std::path::Path;
use tyndall::Warning;
use tyndall::scene::{self, Geometry, Mesh, Placement, Scene, Up, hints::of_points};

/// A mesh as an OBJ file, with its vertices moved.
fn obj(mesh: &Mesh, moved: impl Fn(DVec3) -> DVec3) -> String {
    let mut text = String::new();
    for p in mesh.positions.iter().map(|p| moved(*p)) {
        text += &format!("v {} {} {}\n", p.x, p.y, p.z);
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.vertices.map(|v| v + 1);
        text += &format!("f {a} {b} {c}\n");
    }
    text
}

fn hints(scene: &Scene) -> Vec<String> {
    let is_hint = |w: &&Warning| matches!(w, Warning::OddSize { .. } | Warning::OnItsSide { .. });
    scene
        .warnings
        .iter()
        .filter(is_hint)
        .map(Warning::message)
        .collect()
}

/// What CAD and GIS write: the scene's -Z is their Y.
fn z_up(p: DVec3) -> DVec3 {
    DVec3::new(p.x, -p.z, p.y)
}

/// A grid of hills, so wide, as high as a fiftieth of that.
fn hills(wide: f64) -> Mesh {
    let at = |i: usize| wide * (i as f64 / 40.0 - 0.5);
    let height = |x: f64, z: f64| {
        wide / 50.0 * (1.0 + (9.0 * x / wide).sin() * (7.0 * z / wide).cos()) / 2.0
    };
    let mut mesh = Mesh::default();
    for (i, j) in (0..41 * 41).map(|n| (n % 41, n / 41)) {
        mesh.positions
            .push(DVec3::new(at(i), height(at(i), at(j)), at(j)));
    }
    for (i, j) in (0..40 * 40).map(|n| (n % 40, n / 40)) {
        let corner = (j * 41 + i) as u32;
        for vertices in [
            [corner, corner + 41, corner + 1],
            [corner + 1, corner + 41, corner + 42],
        ] {
            mesh.triangles.push(scene::Triangle {
                vertices,
                material: 0,
            });
        }
    }
    mesh
}

/// Blocks on a slab, as a city is modelled: a square so wide, streets of a third, towers up to `tall`.
fn city(wide: f64, slab: f64, tall: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let mut block = |low: DVec3, high: DVec3| {
        let base = mesh.positions.len() as u32;
        for n in 0..8u32 {
            let pick = |bit: u32, axis: usize| {
                if n >> bit & 1 == 1 {
                    high[axis]
                } else {
                    low[axis]
                }
            };
            mesh.positions
                .push(DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2)));
        }
        for [a, b, c, d] in [
            [0, 1, 3, 2],
            [4, 6, 7, 5],
            [0, 4, 5, 1],
            [2, 3, 7, 6],
            [0, 2, 6, 4],
            [1, 5, 7, 3],
        ] {
            for corners in [[a, b, c], [a, c, d]] {
                mesh.triangles.push(scene::Triangle {
                    vertices: corners.map(|v: u32| v + base),
                    material: 0,
                });
            }
        }
    };
    block(DVec3::new(-slab, -1.0, -slab), DVec3::new(slab, 0.0, slab));
    for n in 0..400 {
        let (x, z) = (
            f64::from(n % 20) / 20.0 - 0.5,
            f64::from(n / 20) / 20.0 - 0.5,
        );
        let low = DVec3::new(x * wide, 0.0, z * wide);
        let height = if n % 57 == 0 {
            tall
        } else {
            10.0 + f64::from(n * 37 % 50)
        };
        block(low, low + DVec3::new(wide / 30.0, height, wide / 30.0));
    }
    mesh
}

#[test]
fn right_models_get_no_hint() {
    let folder = Folder::new();
    for (name, mesh) in [
        ("terrain of 20 km", hills(20_000.0)),
        ("terrain of 2 m", hills(2.0)),
        ("city", city(5000.0, 2500.0, 300.0)),
        ("city on a slab of 40 km", city(3000.0, 20_000.0, 800.0)),
        ("village", city(200.0, 2000.0, 30.0)),
    ] {
        let scene = folder
            .load("right.obj", obj(&mesh, |p| p))
            .expect("it loads");
        assert_eq!(hints(&scene), [""; 0], "{name}");
        let far = folder.load(
            "right.obj",
            obj(&mesh, |p| p + DVec3::new(5e5, 120.0, -4e6)),
        );
        assert_eq!(
            hints(&far.expect("it loads")),
            [""; 0],
            "{name}, on the grid of a map"
        );
    }
    let prop = obj(&city(0.1, 0.05, 30.0), |p| p * DVec3::new(1.0, 1e-3, 1.0));
    assert_eq!(
        hints(&folder.load("prop.obj", prop).expect("it loads")),
        [""; 0],
        "a prop of 10 cm"
    );
    assert_eq!(hints(&Gltf::quad().silent()), [""; 0]);
    let nave = Scene::builtin("nave").expect("it loads");
    assert_eq!(hints(&nave), [""; 0]);
}

#[test]
fn models_in_other_units_and_axes_get_a_hint() {
    let folder = Folder::new();
    let nave = Scene::builtin("nave").expect("it loads").mesh;
    let loaded = |mesh: &Mesh, moved: &dyn Fn(DVec3) -> DVec3| {
        hints(&folder.load("odd.obj", obj(mesh, moved)).expect("it loads"))
    };
    for (factor, says) in [
        (1000.0, "millimetres (--scale 0.001)"),
        (100.0, "centimetres (--scale 0.01)"),
        (0.0005, "--scale 1000"),
    ] {
        let said = loaded(&nave, &|p| factor * p);
        assert!(
            said.len() == 1 && said[0].contains(says),
            "{factor}: {said:?}"
        );
    }
    // On the grid of a map, with the land's own height, or around the origin.
    for mesh in [hills(20_000.0), city(5000.0, 2500.0, 300.0), hills(2.0)] {
        let said = loaded(&mesh, &z_up);
        assert!(said.len() == 1 && said[0].contains("--up z"), "{said:?}");
    }
    for mesh in [hills(20_000.0), city(5000.0, 2500.0, 300.0)] {
        let said = loaded(&mesh, &|p| z_up(p) + DVec3::new(5e5, 4e6, 120.0));
        assert!(said.len() == 1 && said[0].contains("--up z"), "{said:?}");
    }
}

/// A room of a few triangles, its corner at the origin, with a window to the south.
fn room(names: [&str; 2]) -> Scene {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let window = [1.0, 3.0, 0.9, 2.1];
    let mut walls = panel(DVec3::ZERO, x, y, [4.0, 3.0], &[window]);
    walls.extend(panel(-6.0 * z, x, y, [4.0, 3.0], &[]));
    walls.extend(panel(DVec3::ZERO, -z, y, [6.0, 3.0], &[]));
    walls.extend(panel(4.0 * x, -z, y, [6.0, 3.0], &[]));
    let mut floor = level([0.0, -6.0], [4.0, 0.0], 0.0);
    floor.extend(level([0.0, -6.0], [4.0, 0.0], 3.0));
    built(&[(names[0], walls), (names[1], floor)])
}

#[test]
fn rooms_of_few_triangles_get_a_hint_too() {
    let folder = Folder::new();
    let right = room(["a", "b"]);
    assert!(right.mesh.triangles.len() < 32);
    assert_eq!(hints(&right), [""; 0]);
    let turned = folder.load("turned.obj", obj(&right.mesh, z_up));
    let said = hints(&turned.expect("it loads"));
    assert!(said.len() == 1 && said[0].contains("--up z"), "{said:?}");
    // Without a window the names alone tell.
    let blank = |name: &str, moved: fn(DVec3) -> DVec3| {
        let parts = [
            (
                "Walls",
                panel(DVec3::ZERO, DVec3::X, DVec3::Y, [4.0, 3.0], &[]),
            ),
            (name, level([0.0, -6.0], [4.0, 0.0], 0.0)),
        ];
        let turned = parts.map(|(name, t)| (name, t.into_iter().map(|t| t.map(moved)).collect()));
        hints(
            &folder
                .load("named.obj", grids::obj(&turned))
                .expect("it loads"),
        )
    };
    assert_eq!(blank("01_Floor", |p| p), [""; 0]);
    assert_eq!(blank("01_Board", z_up), [""; 0]);
    let said = blank("01_Floor", z_up);
    assert!(said.len() == 1 && said[0].contains("--up z"), "{said:?}");
}

#[test]
fn points_in_millimetres_get_a_hint() {
    let geometry = Geometry::new(&room(["a", "b"]));
    let points = [[1.2, 0.85, -3.0], [3.1, 0.85, -5.0], [2.0, 1.0, -1.0]].map(DVec3::from_array);
    let said = |factor: f64, more: &[DVec3]| {
        let points: Vec<DVec3> = points.iter().chain(more).map(|p| factor * *p).collect();
        of_points(&geometry, &points).map(|w| w.to_string())
    };
    assert_eq!(said(1.0, &[]), None);
    // Outdoors, and far from everything: points that lie nowhere in another unit either.
    assert_eq!(said(1.0, &[DVec3::new(200.0, 0.0, 0.0)]), None);
    assert_eq!(said(1e7, &[]), None);
    let millimetres = said(1000.0, &[]).expect("they are far away");
    assert_eq!(
        millimetres,
        "3 of 3 points lie far outside the scene: are they in millimetres?"
    );
    assert!(said(100.0, &[]).expect("they are").contains("centimetres"));
}

#[test]
fn real_scenes_get_the_right_hints() {
    let Some(data) = common::data("real_scenes_get_the_right_hints") else {
        return;
    };
    let folder = Folder::new();
    for file in [
        "living_room/living_room.glb",
        "room/room.glb",
        "volumetric_fog/VolumetricFogExample.glb",
        "palm_tree/PalmTree.gltf",
        "terrain/Mountains.gltf",
        "gazebo/gazebo.obj",
    ] {
        let scene = scene::load(&data.join("scenes").join(file)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(hints(&scene), [""; 0], "{file}");
        let turned = folder
            .load("turned.obj", obj(&scene.mesh, z_up))
            .expect("it loads");
        let said = hints(&turned);
        assert!(
            said.len() == 1 && said[0].contains("--up z"),
            "{file}, turned: {said:?}"
        );
        let large = hints(
            &folder
                .load("large.obj", obj(&scene.mesh, |p| 1000.0 * p))
                .expect("it loads"),
        );
        // A terrain of 2 m would be one of 2 km, which is right.
        let right = file.starts_with("terrain");
        assert_eq!(large.is_empty(), right, "{file}, enlarged: {large:?}");
        let small = hints(
            &folder
                .load("small.obj", obj(&scene.mesh, |p| 5e-5 * p))
                .expect("it loads"),
        );
        assert!(
            small.len() == 1 && small[0].contains("--scale 1000"),
            "{file}, made smaller: {small:?}"
        );
    }
}

#[test]
fn unit_and_axes_that_are_asked_for_win() {
    let folder = Folder::new();
    let mesh = city(5000.0, 2500.0, 300.0);
    let path = folder.put("city.obj", obj(&mesh, |p| 1000.0 * z_up(p)));
    let right = folder
        .load("right.obj", obj(&mesh, |p| p))
        .expect("it loads");
    let asked = |scale, up| Placement { scale, up };
    let both = asked(Some(0.001), Some(Up::Z));
    let same = |path: &Path, placement| {
        let scene = scene::load_placed(path, placement).expect("it loads");
        assert_eq!(hints(&scene), [""; 0]);
        let pairs = scene.mesh.positions.iter().zip(&right.mesh.positions);
        pairs.fold(0.0, |worst: f64, (a, b)| worst.max(a.distance(*b)))
    };
    assert!(same(&path, both) < 1e-9);
    // Keys of a scene file give way, one by one.
    let toml = folder.put(
        "city.toml",
        "mesh = \"city.obj\"\nscale = 5.0\nup = \"y\"\norigin = [0, 1, 0]\n",
    );
    assert!((same(&toml, both) - 1.0).abs() < 1e-9, "the origin stays");
    let toml = folder.put("half.toml", "mesh = \"city.obj\"\nup = \"z\"\n");
    assert!(same(&toml, asked(Some(0.001), None)) < 1e-9);
    // What is given is not doubted.
    assert_eq!(
        hints(&scene::load_placed(&path, asked(Some(1.0), Some(Up::Y))).expect("it loads")),
        [""; 0]
    );
    let toml = folder.put(
        "given.toml",
        "mesh = \"city.obj\"\nscale = 1.0\nup = \"y\"\n",
    );
    assert_eq!(hints(&scene::load(&toml).expect("it loads")), [""; 0]);
    let empty = folder.put("empty.toml", "north = 0.0\n");
    for (path, placement) in [
        (&empty, both),
        (&path, asked(Some(0.0), None)),
        (&path, asked(Some(1e300), None)),
    ] {
        let error = scene::load_placed(path, placement).expect_err("it has no meaning");
        assert!(
            error.is_input() && !error.to_string().contains("000000"),
            "{error}"
        );
    }
}
