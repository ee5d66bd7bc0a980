//! Windows of rooms in daylight: blinds that close while the sun is too much, and the view out.

mod common;

use common::build::quad;
use common::files::Folder;
use common::receive::{self, at, form_factor};
use common::weather::{ULM, made_up};
use glam::{DVec3, dvec3};
use tyndall::conditions::{Conditions, Receiver};
use tyndall::daylight::blinds::{Blinds, Operated, Operator, Rooms};
use tyndall::daylight::grid::{GridSpec, Sensors};
use tyndall::daylight::hours::Hours;
use tyndall::daylight::metrics::Metrics;
use tyndall::daylight::table::Table;
use tyndall::daylight::view::{FAR, Views};
use tyndall::daylight::year::{Fineness, Year, conditions};
use tyndall::plan::Quality;
use tyndall::scene::glass::Incidence;
use tyndall::scene::{Material, Pane, Scene, WindowShade};
use tyndall::studies::scenes::Corners;
use tyndall::task::Task;

/// Half the length of the house, its depth and height [m].
const HOUSE: [f64; 3] = [4.0, 3.0, 2.7];
/// Depths and heights between which the windows are [m].
const WINDOW: [[f64; 2]; 2] = [[0.5, 2.5], [0.9, 2.4]];
/// Transmittance of their glass, and panes.
const GLASS: (f64, u32) = (0.7, 2);

/// The window in the wall at x.
fn window(x: f64) -> Vec<Corners> {
    let [[z0, z1], [y0, y1]] = WINDOW;
    quad(dvec3(x, y0, z0), DVec3::Y * (y1 - y0), DVec3::Z * (z1 - z0)).to_vec()
}

/// Two rooms back to back, to the west and to the east of x = 0, each with a window in its end.
fn two_rooms(reflectance: f64) -> Scene {
    let [a, b, h] = HOUSE;
    let [[z0, z1], [y0, y1]] = WINDOW;
    let mut walls: Vec<Corners> = Vec::new();
    // Their fronts show inward.
    let (x, y, z) = (DVec3::X * 2.0 * a, DVec3::Y * h, DVec3::Z * b);
    walls.extend(quad(dvec3(-a, 0.0, 0.0), z, x));
    walls.extend(quad(dvec3(-a, h, 0.0), x, z));
    walls.extend(quad(dvec3(-a, 0.0, 0.0), x, y));
    walls.extend(quad(dvec3(-a, 0.0, b), y, x));
    walls.extend(quad(DVec3::ZERO, DVec3::Y * h, DVec3::Z * b));
    for x in [-a, a] {
        let mut part = |z: [f64; 2], y: [f64; 2]| {
            let (up, along) = (DVec3::Y * (y[1] - y[0]), DVec3::Z * (z[1] - z[0]));
            let corner = dvec3(x, y[0], z[0]);
            walls.extend(match x > 0.0 {
                true => quad(corner, along, up),
                false => quad(corner, up, along),
            });
        };
        part([0.0, b], [0.0, y0]);
        part([0.0, b], [y1, h]);
        part([0.0, z0], [y0, y1]);
        part([z1, b], [y0, y1]);
    }
    let first = walls.len();
    walls.extend(window(-a));
    walls.extend(window(a));
    let triangles: Vec<(Corners, f64)> = walls.into_iter().map(|t| (t, reflectance)).collect();
    let mut scene = receive::surfaces(&triangles);
    for (number, name) in ["west", "east"].into_iter().enumerate() {
        let material = scene.materials.len() as u32;
        scene.materials.push(Material {
            pane: Some(Pane {
                transmittance: DVec3::splat(GLASS.0),
                count: GLASS.1,
                ..Pane::CLEAR
            }),
            ..Material::of(name, DVec3::ONE)
        });
        for triangle in &mut scene.mesh.triangles[first + 2 * number..first + 2 * number + 2] {
            triangle.material = material;
        }
    }
    scene.ground.enabled = true;
    scene.ground.albedo = 0.2;
    scene
}

fn shade(windows: &str, transmittance: f64, openness: f64, reflectance: f64) -> WindowShade {
    WindowShade {
        windows: vec![windows.into()],
        transmittance,
        openness,
        reflectance,
    }
}

/// Sensors of both rooms, first those in the west, each of one square metre.
fn sensors() -> Vec<Receiver> {
    let of = |side: f64| {
        let along = [0.5, 1.5, 2.5, 3.5].map(|x| side * x);
        along.map(|x| [0.5, 1.5, 2.5].map(|z| at(dvec3(x, 0.8, z), DVec3::Y)))
    };
    [-1.0, 1.0].into_iter().flat_map(of).flatten().collect()
}

/// Some hours of a year in the rooms, with blinds.
struct Run {
    base: Conditions,
    hours: Hours,
    table: Table,
    operated: Operated,
}

/// Every so many lit hours, under a point sun, which can be followed by hand.
fn run(scene: Scene, step: usize) -> Run {
    run_by(scene, step, &fineness(&[]))
}

/// 145 patches of the sky, and some knobs of light from surfaces.
fn fineness(set: &[(&str, f64)]) -> Fineness {
    let set: Vec<(String, f64)> = set.iter().map(|(k, v)| ((*k).into(), *v)).collect();
    Fineness {
        patches: 1,
        ..Fineness::new(Quality::Preview, &set)
    }
}

fn run_by(scene: Scene, step: usize, fineness: &Fineness) -> Run {
    let file = made_up(ULM).read();
    let all = Hours::new(&file, 0.0, None, None).expect("it is sound");
    let lit = all.lit.iter().skip(step / 2).step_by(step).cloned();
    let mut hours = Hours {
        lit: lit.collect(),
        ..all.clone()
    };
    for hour in &mut hours.lit {
        hour.sun.light.angular_radius = 0.0;
    }
    let base = conditions(scene, &Default::default(), &file).expect("it is sound");
    let sensors = sensors();
    let year = Year::new(&base, sensors.clone(), fineness, Task::unwatched()).expect("it works");
    let clock = |hour: &tyndall::daylight::hours::Hour| f64::from(hour.hour) - 0.5;
    let table = year
        .table(&hours, clock, Task::unwatched())
        .expect("it works");
    let blinds = Blinds::new(&base.scene, &base.geometry).expect("they hang");
    let areas = vec![1.0; sensors.len()];
    let planes: Vec<usize> = (0..sensors.len()).map(|i| i / 12).collect();
    let rooms = Rooms {
        sensors: &sensors,
        areas: &areas,
        planes: &planes,
    };
    let mut operator = Operator::new(&blinds, &year, rooms, fineness).expect("they hang");
    let operated = operator.operate(&hours, &table, Task::unwatched());
    Run {
        base,
        hours,
        table,
        operated: operated.expect("it works"),
    }
}

/// Whether the sun of an hour gives more than 2 % of one of the rooms 1 000 lx or more through the window at x: by a line to the sun.
fn is_sunny(run: &Run, number: usize, x: f64) -> bool {
    let sun = &run.hours.lit[number].sun;
    let toward = sun.toward;
    let through = |sensor: &Receiver| {
        let way = (x - sensor.position.x) / toward.x;
        let place = sensor.position + way * toward;
        let [[z0, z1], [y0, y1]] = WINDOW;
        let is_own = sensor.position.x * x > 0.0 && toward.x * x > 0.0;
        let is_in = (z0..z1).contains(&place.z) && (y0..y1).contains(&place.y);
        if !(is_own && is_in) {
            return 0.0;
        }
        let left = Incidence::new(toward.x).transmittance(GLASS.0, GLASS.1);
        sun.illuminance_lux() * left * toward.y
    };
    let sunny = sensors().iter().filter(|s| through(s) >= 1000.0).count();
    // One of twelve is 8 % of a room.
    sunny > 0
}

#[test]
fn blinds_close_in_the_hours_and_rooms_that_have_the_sun() {
    let mut scene = two_rooms(0.5);
    scene.shades = vec![shade("west", 0.05, 0.0, 0.4), shade("east", 0.2, 0.0, 0.3)];
    let run = run(scene, 37);
    let (mut closed, mut open) = ([0; 2], [0; 2]);
    for (number, stamp) in run.table.stamps.iter().enumerate() {
        let states: Vec<bool> = (run.operated.groups.iter())
            .map(|(_, hours)| hours[number])
            .collect();
        for (side, x) in [-HOUSE[0], HOUSE[0]].into_iter().enumerate() {
            let by_hand = stamp.is_occupied() && is_sunny(&run, number, x);
            assert_eq!(states[side], by_hand, "hour {number}, window at {x}");
            closed[side] += usize::from(by_hand);
            let room = 12 * side..12 * (side + 1);
            let sum = |row: &[f32]| row[room.clone()].iter().sum::<f32>();
            let (without, with) = (run.table.row(number), run.operated.table.row(number));
            let ratio = sum(with) / sum(without);
            if by_hand {
                assert!(ratio < 0.6, "{ratio} in hour {number}, window at {x}");
            } else if states[1 - side] {
                // The other room's blind changes nothing here.
                open[side] += 1;
                assert!((ratio - 1.0).abs() < 0.02, "{ratio} in hour {number}");
            } else {
                assert_eq!(with, without);
            }
        }
    }
    eprintln!("closed in {closed:?} hours, the other one alone in {open:?}");
    assert!(closed.iter().chain(&open).all(|hours| *hours >= 5));
    // The metrics have the hours by name, and autonomy with them is lower; the rest is as it was.
    let without = Metrics::new(&run.table, &[0.02; 24]);
    let with = without.clone().with_blinds(&run.operated);
    let all: Vec<usize> = (0..24).collect();
    let value = |metrics: &Metrics, key: &str| {
        let figures = metrics.figures(&all, &[1.0; 24]);
        let found = figures.into_iter().find(|figure| figure.key == key);
        found.map(|figure| (figure.name, figure.value.expect("a value")))
    };
    let (name, hours) = value(&with, "closed_h:east").expect("a figure");
    assert!(name.contains("east") && hours == closed[1] as f64);
    assert_eq!(value(&with, "sda").expect("a figure").0, "sDA300/50%");
    assert!(with.open.is_empty(), "both windows have blinds");
    let none = value(&without, "sda").expect("a figure");
    assert!(none.0.ends_with("no blinds"));
    assert_eq!(value(&with, "sda_no_blinds"), Some(none));
    assert_eq!(value(&with, "ase"), value(&without, "ase"));
    for (with, without) in with.points.iter().zip(&without.points) {
        assert!(with.da300_blinds_pct <= without.da300_pct);
        assert_eq!(with.mean_lx, without.mean_lx);
    }
    let lower = with
        .points
        .iter()
        .filter(|p| p.da300_blinds_pct < p.da300_pct);
    assert!(lower.count() > 0, "no sensor loses an hour");
}

/// Holds what a closed western blind gives in a black room before a black ground to a closed form: its window is a polygon of exitance
/// tau E, where E is on the back of it what stands behind the middle of the glass gets of the same patches of the sky and the same sun, and
/// of all that comes without blinds its openness is let through.
fn is_matt(black: &Run, shade: &WindowShade, fineness: &Fineness) {
    let [a, ..] = HOUSE;
    let [[z0, z1], [y0, y1]] = WINDOW;
    let corner = dvec3(-a, y0, z0);
    let polygon = receive::rectangle(corner, DVec3::Z * (z1 - z0), DVec3::Y * (y1 - y0));
    // Facing outward: as on all of it, since nothing stands before it.
    let behind = corner + dvec3(1e-4, 0.5 * (y1 - y0), 0.5 * (z1 - z0));
    let behind = Year::new(
        &black.base,
        vec![at(behind, DVec3::NEG_X)],
        fineness,
        Task::unwatched(),
    );
    let behind = behind.expect("it works");
    let mut count = 0;
    for (number, hour) in black.hours.lit.iter().enumerate() {
        if !black.operated.groups[0].1[number] {
            continue;
        }
        let [on_blind, _] = behind.hour(hour);
        count += 1;
        let mut sums = [0.0; 2];
        for (sensor, receiver) in sensors()[..12].iter().enumerate() {
            let scattered = shade.transmittance * on_blind[0] * form_factor(receiver, &polygon);
            let by_hand = scattered + shade.openness * black.table.at(number, sensor);
            let found = black.operated.table.at(number, sensor);
            sums[0] += found;
            sums[1] += by_hand;
            // Outlines of the window are uncertain by a share of all light of a sensor.
            assert!(
                (found / by_hand - 1.0).abs() < 0.02,
                "sensor {sensor}: {found} {by_hand}"
            );
        }
        let mean = sums[0] / sums[1] - 1.0;
        eprintln!(
            "openness {}, hour {number}: off by {:.2} % on the mean",
            shade.openness,
            100.0 * mean
        );
        assert!(mean.abs() < 0.005, "{mean}");
    }
    assert!(count >= 2, "{count} hours");
}

/// What a closed blind lets through wholly is as if it were open; what it scatters comes from a window that is matt.
#[test]
fn a_closed_blind_is_a_matt_window_or_none() {
    let mut scene = two_rooms(0.5);
    scene.shades = vec![shade("west", 0.0, 1.0, 0.0)];
    let open = run(scene, 97);
    assert!(open.operated.hours(0) >= 2);
    assert_eq!(open.operated.table.total, open.table.total);
    // That the eastern window has no blind is said.
    let metrics = Metrics::new(&open.table, &[0.02; 24]).with_blinds(&open.operated);
    let figures = metrics.figures(&[0], &[1.0; 24]);
    let sda = figures.iter().find(|figure| figure.key == "sda");
    let sda = sda.expect("a figure");
    assert!(sda.method.contains("windows of east have no blinds"));
    assert!(sda.verdict.contains("some windows without blinds"));

    let close = fineness(&[("radiosity.rays", 784.0), ("radiosity.outline", 0.001)]);
    let mut scene = two_rooms(0.0);
    scene.ground.albedo = 0.0;
    for (transmittance, openness) in [(0.2, 0.3), (0.3, 0.0)] {
        let own = shade("west", transmittance, openness, 0.0);
        scene.shades = vec![own.clone()];
        is_matt(&run_by(scene.clone(), 97, &close), &own, &close);
    }
    let black = run(scene.clone(), 97);
    // Between white walls there is more of it: it is sent on, though nothing else gives light there.
    let mut grey = scene;
    for (number, material) in grey.materials.iter_mut().enumerate() {
        material.base_color = DVec3::splat(if number == 0 { 0.5 } else { 1.0 });
    }
    let grey = run(grey, 97);
    let closed = (0..black.table.stamps.len()).filter(|hour| black.operated.groups[0].1[*hour]);
    for hour in closed {
        let sum = |run: &Run| run.operated.table.row(hour)[..12].iter().sum::<f32>();
        let more = sum(&grey) / sum(&black);
        assert!((1.3..3.0).contains(&more), "{more}");
    }
}

/// The scene file: what it says of a blind, and what it cannot.
#[test]
fn blinds_are_read_from_the_scene_file() {
    let folder = Folder::new();
    folder.put(
        "a.mtl",
        "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl glass\nKd 1 1 1\n",
    );
    folder.put(
        "a.obj",
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\n\
         o Wall\nusemtl wall\nf 5 6 7\no Window\nusemtl glass\nf 1 2 3\nf 1 3 4\n",
    );
    let file = |shades: &str| {
        format!("mesh = \"a.obj\"\n[[pane]]\nmaterial = \"glass\"\ntransmittance = 0.7\n{shades}")
    };
    let scene = folder
        .load(
            "good.toml",
            file("[[shade]]\nwindows = [\"Window\"]\ntransmittance = 0.2\nopenness = 0.05\n"),
        )
        .expect("it is sound");
    assert_eq!(scene.shades, [shade("Window", 0.2, 0.05, 0.5)]);
    let full = folder.load(
        "full.toml",
        file("[[shade]]\nwindows = [\"glass\"]\ntransmittance = 0.7\nopenness = 0.3\n"),
    );
    assert!(full.expect("it is sound").shades[0].reflectance.abs() < 1e-12);
    for (name, shades, word) in [
        ("none", "windows = []\ntransmittance = 0.1", "names nothing"),
        ("wall", "windows = [\"wall\"]\ntransmittance = 0.1", "glass"),
        (
            "near",
            "windows = [\"Windo\"]\ntransmittance = 0.1",
            "did you mean `Window`",
        ),
        ("lack", "windows = [\"glass\"]", "transmittance"),
        ("range", "windows = [\"glass\"]\ntransmittance = 1.5", "1"),
        (
            "sum",
            "windows = [\"glass\"]\ntransmittance = 0.6\nreflectance = 0.6",
            "more than 1",
        ),
        (
            "twice",
            "windows = [\"glass\", \"Window\"]\ntransmittance = 0.1",
            "in a group already",
        ),
    ] {
        let text = folder.refused(
            &format!("{name}.toml"),
            file(&format!("[[shade]]\n{shades}\n")),
        );
        assert!(
            text.contains(word) && text.contains("shade[0]"),
            "{name}: {text}"
        );
    }
    let mut scene = two_rooms(0.5);
    scene.shades = vec![shade("west", 0.1, 0.0, 0.5)];
    // The wall between the rooms as glass: no sky is free on either side but through other panes.
    let mut closed = scene.clone();
    let material = closed.materials.len() as u32;
    closed.materials.push(Material {
        name: "between".into(),
        ..closed.materials[1].clone()
    });
    for triangle in &mut closed.mesh.triangles[8..10] {
        triangle.material = material;
    }
    closed.shades = vec![shade("between", 0.1, 0.0, 0.5)];
    let hang = |scene: &Scene| Blinds::new(scene, &tyndall::scene::Geometry::new(scene));
    assert_eq!(hang(&scene).expect("it hangs").open, ["east"]);
    let error = hang(&closed).err().expect("it leads nowhere").to_string();
    assert!(error.contains("between"), "{error}");
}

/// A wall as high and as wide as that before the eastern window, so far from it.
fn with_wall(scene: Scene, distance: f64, height: f64) -> Scene {
    let x = HOUSE[0] + distance;
    let corners = quad(dvec3(x, 0.0, -100.0), DVec3::Z * 200.0, DVec3::Y * height);
    with(scene, &corners)
}

/// The reveals beside the eastern window, so deep before the glass.
fn with_reveals(scene: Scene, depth: f64) -> Scene {
    let [[z0, z1], [y0, y1]] = WINDOW;
    let reveal = |z: f64| {
        let corner = dvec3(HOUSE[0], y0, z);
        quad(corner, DVec3::X * depth, DVec3::Y * (y1 - y0))
    };
    with(with(scene, &reveal(z0)), &reveal(z1))
}

/// More triangles of the walls' material.
fn with(mut scene: Scene, triangles: &[Corners]) -> Scene {
    for corners in triangles {
        let first = scene.mesh.positions.len() as u32;
        scene.mesh.positions.extend(*corners);
        scene.mesh.normals.extend([DVec3::ZERO; 3]);
        scene.mesh.uvs.extend([glam::DVec2::ZERO; 3]);
        scene.mesh.triangles.push(tyndall::scene::Triangle {
            vertices: [first, first + 1, first + 2],
            material: 0,
        });
    }
    scene
}

#[test]
fn a_view_is_as_wide_and_as_far_as_its_angles_say() {
    let views_on = |scene: &Scene, grids: &[&str]| {
        let conditions = receive::conditions(scene.clone(), &sensors());
        let specs = grids.iter().map(|spec| GridSpec::parse(spec));
        let specs: Vec<GridSpec> = specs.map(|spec| spec.expect("it can be read")).collect();
        let grid = Sensors::new(scene, &conditions.geometry, &specs).expect("there are floors");
        let found = Views::new(&conditions, &grid, Task::unwatched());
        (grid, found.expect("it works"))
    };
    let views = |scene: &Scene| views_on(scene, &["plane=0.8,spacing=1"]);
    let table_of = |views: &Views| Table {
        hours: 8760,
        points: views.points.len(),
        ..Table::default()
    };
    let open = two_rooms(0.5);
    for (height, layers) in [(5.0, 3.0), (60.0, 2.0)] {
        let (grid, found) = views(&with_wall(open.clone(), 10.0, height));
        assert_eq!(found.unknown, [None, None]);
        let mut east = 0;
        for (sensor, view) in grid.points.iter().zip(&found.points) {
            let p = sensor.receiver.position;
            let way = HOUSE[0] - p.x.abs();
            let [z0, z1] = WINDOW[0].map(|z| f64::atan((z - p.z) / way).to_degrees());
            assert!((view.sight_deg - (z1 - z0)).abs() < 1.5, "{p}: {view:?}");
            if p.x > 0.0 && (p.z - 1.5).abs() < 0.1 {
                // Half of the azimuths are within half of the angle.
                let half = 10.0 / (0.5 * z1).to_radians().cos();
                assert!((view.distance / half - 1.0).abs() < 0.02, "{p}: {view:?}");
                // Beside the glass all of it is seen; from the depth of the room there is no ground.
                east += usize::from(view.layers == layers);
            }
            if p.x < 0.0 {
                assert_eq!((view.distance, view.layers), (FAR, 0.0));
            }
        }
        assert!(east >= 1, "{height}");
    }
    // A wall right before the window is no landscape, and nothing at all is no view that can be assessed.
    let (_, near) = views(&with_wall(open.clone(), 0.5, 60.0));
    assert_eq!(near.unknown, [None, None]);
    assert!(near.points.iter().all(|view| view.layers == 0.0));
    // Reveals, which end some of the level view, are nothing either.
    let (_, reveals) = views(&with_reveals(open.clone(), 0.3));
    assert!(reveals.unknown[0].is_none() && reveals.unknown[1].is_some());
    assert!(reveals.points.iter().all(|view| view.layers.is_nan()));
    // Of a desk's top no view is told, while floors have theirs.
    let desk = quad(dvec3(0.5, 0.7, 1.0), 0.8 * DVec3::Z, 0.5 * DVec3::X);
    let mut with_desk = with(with_wall(open.clone(), 10.0, 5.0), &desk);
    let material = with_desk.materials.len() as u32;
    with_desk
        .materials
        .push(Material::of("desk", DVec3::splat(0.5)));
    let last = with_desk.mesh.triangles.len() - 2;
    for triangle in &mut with_desk.mesh.triangles[last..] {
        triangle.material = material;
    }
    let (grid, both) = views_on(
        &with_desk,
        &["plane=0.8,spacing=1", "plane=0.05,spacing=0.5,surface=desk"],
    );
    assert_eq!(both.unknown, [None, None]);
    let metrics = Metrics::new(&table_of(&both), &[]).with_views(&both);
    for (number, plane) in grid.planes.iter().enumerate() {
        let of_plane = |point: &usize| grid.points[*point].plane == number;
        let own: Vec<usize> = (0..grid.points.len()).filter(of_plane).collect();
        let figures = metrics.figures(&own, &vec![1.0; grid.points.len()]);
        let found = figures.iter().find(|f| f.key == "view_minimum_angle");
        let found = found.expect("a figure");
        assert_eq!(found.value.is_some(), plane.is_over_floor);
        assert_eq!(
            found.verdict.contains("not above a floor"),
            !plane.is_over_floor
        );
    }
    assert!(grid.planes.iter().any(|plane| !plane.is_over_floor));
    let (_, alone) = views(&open);
    assert!(alone.unknown[0].is_none() && alone.unknown[1].is_some());
    assert!(
        alone
            .points
            .iter()
            .all(|v| v.distance.is_nan() && v.sight_deg > 10.0)
    );
    // Holes without glass tell nothing.
    let mut holes = open;
    for material in &mut holes.materials {
        material.pane = None;
    }
    let (_, none) = views(&holes);
    assert!(none.unknown[0].is_some_and(|why| why.contains("no pane")));
    // The figures: the angle is assessed, the rest is not.
    let metrics = Metrics::new(&table_of(&alone), &[]).with_views(&alone);
    let all: Vec<usize> = (0..alone.points.len()).collect();
    let figures = metrics.figures(&all, &vec![1.0; all.len()]);
    let of = |key: &str| figures.iter().find(|f| f.key == key).expect("a figure");
    let wide = alone.points.iter().filter(|v| v.sight_deg >= 54.0).count();
    let share = 100.0 * wide as f64 / all.len() as f64;
    let found = of("view_high_angle").value.expect("a share");
    assert!((found - share).abs() < 1e-9 && share > 0.0 && share < 100.0);
    assert!(
        of("view_medium_distance")
            .verdict
            .contains("nothing outside")
    );
    assert_eq!(of("view_medium").value, None);
}
