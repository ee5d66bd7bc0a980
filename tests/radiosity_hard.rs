//! Light between surfaces where it is hard: meshes that touch, lie in each other, are needles or of all sizes; reflectances of 0
//! and 1; rooms that nothing lights; very many triangles; sheets, carpets and pictures close upon
//! other surfaces. Each is held to a plain scene with the same light, or to a law.

mod common;

use common::build::{self, cuboid, quad};
use common::receive::*;
use common::rooms::{Opening, Shell, plan};
use glam::{DQuat, DVec3, dvec2, dvec3};
use std::f64::consts::PI;
use std::time::Instant;
use tyndall::conditions::Receiver;
use tyndall::effect::Field;
use tyndall::plan::Quality;
use tyndall::scene::{Camera, Scene};
use tyndall::studies::scenes::Corners;

type Surfaces = Vec<(Corners, f64)>;

/// What the same room may differ by, drawn in another way.
const SAME: f64 = 0.005;

/// Rays for single points that see a lit surface far away, whose outline nothing but rays finds.
const MANY_RAYS: Settings = &[("radiosity.rays", 65_536.0)];

const FLOOR: f64 = 0.3;
const WALLS: f64 = 0.5;
const CEILING: f64 = 0.8;

fn grey(triangles: impl IntoIterator<Item = Corners>, reflectance: f64) -> Surfaces {
    triangles.into_iter().map(|t| (t, reflectance)).collect()
}

/// A room, 4 by 6 and 3 high, with a window to the south.
fn shell(thickness: f64) -> Shell {
    Shell {
        outline: plan(4.0, 6.0),
        height: 3.0,
        thickness,
        openings: vec![Opening {
            wall: 0,
            along: [0.8, 3.2],
            height: [0.9, 2.4],
        }],
        reflectances: [FLOOR, WALLS, CEILING],
    }
}

fn study(thickness: f64) -> Surfaces {
    let room = shell(thickness).room("study", 1.0);
    let reflectance = |material: u32| room.reflectances[material as usize].x;
    room.triangles
        .iter()
        .map(|(corners, m)| (*corners, reflectance(*m)))
        .collect()
}

/// Points in the room: on the workplane, before the walls, under the ceiling.
fn points() -> Vec<Receiver> {
    let mut points = Vec::new();
    for z in [-0.7, -2.1, -3.6, -5.2] {
        for x in [0.6, 2.1, 3.3] {
            points.push(at(dvec3(x, 0.85, z), DVec3::Y));
        }
        points.push(at(dvec3(0.05, 1.4, z), DVec3::X));
        points.push(at(dvec3(2.0, 2.9, z), DVec3::NEG_Y));
    }
    points.push(at(dvec3(1.7, 1.2, -5.9), DVec3::Z));
    points
}

/// The sky, sun and ground that all these rooms stand under: the sun comes through the window.
fn outside(scene: Scene) -> Scene {
    let scene = sun(sky(scene, "cie:12"), [200.0, 35.0], 6e4);
    ground(scene, -0.2, 0.2)
}

/// What the points receive in all.
fn light(parts: &Surfaces) -> Vec<f64> {
    y(&receive(outside(surfaces(parts)), &points()).total())
}

/// Notes how far one drawing of a room is from another.
fn same(off: &mut Deviations, what: &str, found: &[f64], plain: &[f64], allowed: f64) {
    assert!(
        plain.iter().all(|v| *v > 10.0),
        "{what}: the room is dark: {plain:?}"
    );
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    off.note(
        &format!("{what}, the mean"),
        (mean(found) / mean(plain) - 1.0).abs(),
        allowed.min(SAME),
    );
    off.near(what, found, plain, allowed);
}

#[test]
fn coplanar_and_touching_patches_change_nothing() {
    let mut off = Deviations::default();
    let plain = light(&study(0.0));
    // Every triangle twice, the second turned over.
    let mut twice = study(0.0);
    twice.extend(study(0.0).into_iter().map(|([a, b, c], r)| ([a, c, b], r)));
    same(
        &mut off,
        "every surface twice",
        &light(&twice),
        &plain,
        SAME,
    );

    // A carpet of the floor's colour that lies in the floor, and a poster in the wall.
    let mut carpet = study(0.0);
    carpet.extend(grey(
        quad(dvec3(1.0, 0.0, -5.0), DVec3::X * 2.0, DVec3::Z * 3.0),
        FLOOR,
    ));
    carpet.extend(grey(
        quad(dvec3(0.0, 0.7, -4.0), DVec3::Y * 1.5, DVec3::Z * 2.3),
        WALLS,
    ));
    // The carpet's edges divide patches elsewhere: points close to a wall see that, the room as a whole does not.
    let found = light(&carpet);
    same(&mut off, "coplanar patches", &found, &plain, 8.0 * SAME);

    // Walls of 0.3 as boxes that touch, with faces that lie against each other, and walls as one surface with reveals.
    let plain = light(&study(0.3));
    let mut boxes = Surfaces::new();
    let mut block = |low: [f64; 3], high: [f64; 3]| {
        boxes.extend(grey(cuboid(DVec3::from(low), DVec3::from(high)), WALLS));
    };
    block([-0.3, -0.2, 0.0], [0.8, 3.3, 0.3]);
    block([3.2, -0.2, 0.0], [4.3, 3.3, 0.3]);
    block([0.8, -0.2, 0.0], [3.2, 0.9, 0.3]);
    block([0.8, 2.4, 0.0], [3.2, 3.3, 0.3]);
    block([-0.3, -0.2, -6.3], [4.3, 3.3, -6.0]);
    block([-0.3, -0.2, -6.0], [0.0, 3.3, 0.0]);
    block([4.0, -0.2, -6.0], [4.3, 3.3, 0.0]);
    boxes.extend(grey(
        quad(dvec3(0.0, 0.0, -6.0), DVec3::X * 4.0, DVec3::Z * 6.0),
        FLOOR,
    ));
    boxes.extend(grey(
        quad(dvec3(0.0, 3.0, -6.0), DVec3::X * 4.0, DVec3::Z * 6.0),
        CEILING,
    ));
    boxes.extend(grey(
        quad(dvec3(0.0, 3.3, -6.0), DVec3::X * 4.0, DVec3::Z * 6.0),
        WALLS,
    ));
    same(
        &mut off,
        "boxes that touch",
        &light(&boxes),
        &plain,
        4.0 * SAME,
    );
    off.end();
}

/// A triangle in `count` slivers from its first corner.
fn slivers([a, b, c]: Corners, count: usize) -> Vec<Corners> {
    let along = |i: usize| b.lerp(c, i as f64 / count as f64);
    (0..count).map(|i| [a, along(i), along(i + 1)]).collect()
}

/// A triangle in `4^depth` of its own shape.
fn quarters(triangle: Corners, depth: u32) -> Vec<Corners> {
    if depth == 0 {
        return vec![triangle];
    }
    let [a, b, c] = triangle;
    let (d, e, f) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
    [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        .into_iter()
        .flat_map(|t| quarters(t, depth - 1))
        .collect()
}

#[test]
fn needles_and_fine_meshes_change_nothing() {
    let mut off = Deviations::default();
    let plain = light(&study(0.0));
    for count in [7, 40] {
        let cut = |(t, r): &(Corners, f64)| grey(slivers(*t, count), *r);
        let needles: Surfaces = study(0.0).iter().flat_map(cut).collect();
        same(
            &mut off,
            &format!("{count} needles a triangle"),
            &light(&needles),
            &plain,
            SAME,
        );
    }
    let cut = |(t, r): &(Corners, f64)| grey(quarters(*t, 4), *r);
    let fine: Surfaces = study(0.0).iter().flat_map(cut).collect();
    same(
        &mut off,
        "256 parts a triangle",
        &light(&fine),
        &plain,
        SAME,
    );
    off.end();
}

/// Files hold positions as f32 or with six digits, so that triangles of one wall lie a little above and below each other.
#[test]
fn positions_rounded_as_in_files_change_nothing() {
    let turn = DQuat::from_rotation_y(0.5);
    let turned = points().into_iter().map(|p| Receiver {
        position: turn * p.position,
        normal: turn * p.normal,
    });
    let turned: Vec<Receiver> = turned.collect();
    let light = |round: fn(DVec3) -> DVec3| {
        let cut = |(t, r): &(Corners, f64)| {
            let parts = quarters(*t, 2).into_iter();
            grey(parts.map(|t| t.map(|p| round(turn * p))), *r)
        };
        let parts: Surfaces = study(0.0).iter().flat_map(cut).collect();
        y(&receive(outside(surfaces(&parts)), &turned).total())
    };
    let plain = light(|p| p);
    let mut off = Deviations::default();
    // All of a wall is one plane yet.
    let found = light(|p| p.as_vec3().as_dvec3());
    same(&mut off, "rounded to f32", &found, &plain, 2.0 * SAME);
    let found = light(|p| (1e6 * p).round() / 1e6);
    same(&mut off, "six digits", &found, &plain, 2.0 * SAME);
    off.end();
}

#[test]
fn a_speck_and_a_plain_in_one_scene_change_nothing() {
    let mut off = Deviations::default();
    let plain = light(&study(0.0));
    // A millionth of a metre, in the middle of the room; a plain of 10 km and one of 30 km in the place of the ground.
    let mut parts = study(0.0);
    let low = dvec3(2.03, 1.31, -3.02);
    parts.extend(grey(
        [[low, low + 1e-6 * DVec3::X, low + 1e-6 * DVec3::Y]],
        0.5,
    ));
    same(&mut off, "a speck", &light(&parts), &plain, SAME);
    for size in [1e4, 3e4] {
        let corner = dvec3(-0.5 * size, -0.2, -0.5 * size);
        let slab = quad(corner, DVec3::X * size, DVec3::Z * size);
        let parts = [parts.clone(), grey(slab, 0.2)].concat();
        let mut scene = outside(surfaces(&parts));
        scene.ground.enabled = false;
        let found = y(&receive(scene, &points()).total());
        // Patches of the slab grow with their distance from the room as those of the ground do, but other ones: single points see
        // the edge of the house's shade on it by patches of another size.
        let what = format!("on a slab of {size} m");
        same(&mut off, &what, &found, &plain, 6.0 * SAME);
    }
    off.end();
}

#[test]
fn black_surfaces_send_nothing() {
    let mut off = Deviations::default();
    let black: Surfaces = study(0.0).into_iter().map(|(t, _)| (t, 0.0)).collect();
    let mut scene = outside(surfaces(&black));
    scene.ground.albedo = 0.0;
    let found = receive(scene, &points());
    assert!(
        found.indirect.iter().all(|v| *v == DVec3::ZERO),
        "{:?}",
        found.indirect
    );
    assert!(found.sky.iter().any(|v| v.y > 100.0));
    // The same without a ground: black or nothing is one.
    let mut scene = outside(surfaces(&black));
    scene.ground.enabled = false;
    let without = receive(scene, &points());
    assert!(without.indirect.iter().all(|v| *v == DVec3::ZERO));
    // The ceiling sees no sky.
    let (found, without) = (y(&found.sky), y(&without.sky));
    let lit = |v: &[f64]| v.iter().copied().filter(|v| *v > 10.0).collect::<Vec<_>>();
    same(&mut off, "no ground", &lit(&without), &lit(&found), SAME);
    off.end();
}

#[test]
fn the_sun_at_zenith_and_at_the_horizon() {
    let mut off = Deviations::default();
    // A wall that the sun grazes or meets, and points that see it.
    let wall = quad(dvec3(-1.0, 0.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0);
    let corners = rectangle(dvec3(-1.0, 0.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0);
    let before = [
        at(dvec3(0.2, 0.5, 1.0), DVec3::NEG_Z),
        at(dvec3(0.0, 0.3, 0.4), DVec3::Y),
    ];
    for (elevation, cosine) in [(90.0, 0.0), (0.01, 1.0), (45.0, 0.5f64.sqrt())] {
        let scene = sun(surfaces(&grey(wall, 0.7)), [180.0, elevation], 1e5);
        let found = y(&receive_by(scene, &before, MANY_RAYS).indirect);
        for (found, point) in found.iter().zip(&before) {
            let truth = 0.7 * 1e5 * cosine * form_factor(point, &corners);
            let what = format!("sun at {elevation} degrees: {found:.3} lx, {truth:.3}");
            off.note(&what, (found - truth).abs() / (truth + 0.1), 0.01);
        }
    }
    // A floor under the zenith lights the underside of a slab that does not shade it.
    let floor = quad(dvec3(-1.0, 0.0, -1.0), DVec3::X * 2.0, DVec3::Z * 2.0);
    let corners = rectangle(dvec3(-1.0, 0.0, -1.0), DVec3::X * 2.0, DVec3::Z * 2.0);
    let scene = sun(surfaces(&grey(floor, 0.7)), [0.0, 90.0], 1e5);
    let above = at(dvec3(0.1, 1.5, 0.2), DVec3::NEG_Y);
    let found = y(&receive_by(scene, &[above], MANY_RAYS).indirect)[0];
    let truth = 0.7e5 * form_factor(&above, &corners);
    off.note("sun at the zenith", (found / truth - 1.0).abs(), 0.01);
    // On and below the horizon there is no sun.
    for elevation in [0.0, -0.01, -30.0] {
        let scene = sun(surfaces(&grey(wall, 0.7)), [180.0, elevation], 1e5);
        let found = receive(scene, &before);
        assert!(
            found.total().iter().all(|v| *v == DVec3::ZERO),
            "{elevation}"
        );
    }
    off.end();
}

#[test]
fn a_single_triangle_has_its_form_factor() {
    let mut off = Deviations::default();
    let triangle = [DVec3::ZERO, dvec3(1.0, 0.0, 0.2), dvec3(0.3, 0.1, 1.1)];
    let normal = (triangle[1] - triangle[0])
        .cross(triangle[2] - triangle[0])
        .normalize();
    let toward_sun = tyndall::conditions::toward(2.0, 0.9, 0.0);
    let azimuth_elevation = [2f64.to_degrees(), 0.9f64.to_degrees()];
    let scene = sun(surfaces(&grey([triangle], 0.6)), azimuth_elevation, 1e5);
    let lit = 0.6e5 * normal.dot(toward_sun).abs();
    // On the side that the sun lights, off its way, and on the other.
    let side = if normal.dot(toward_sun) > 0.0 {
        1.0
    } else {
        -1.0
    };
    let middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
    let lit_side: Vec<Receiver> = [0.2, 0.8, 3.0]
        .map(|h| at(middle + side * h * normal, -side * normal))
        .to_vec();
    let found = y(&receive_by(scene.clone(), &lit_side, MANY_RAYS).indirect);
    for (found, point) in found.iter().zip(&lit_side) {
        let truth = lit * form_factor(point, &triangle);
        let what = format!("one triangle: {found:.2} lx, {truth:.2}");
        off.note(&what, (found / truth - 1.0).abs(), 0.01);
    }
    let dark = at(middle - side * normal, side * normal);
    assert_eq!(receive(scene, &[dark]).indirect[0], DVec3::ZERO);
    off.end();
}

#[test]
fn a_room_without_openings_is_black() {
    for thickness in [0.0, 0.3] {
        let shut = Shell {
            openings: Vec::new(),
            ..shell(thickness)
        };
        let room = shut.room("shut", 1.0);
        let parts: Surfaces = (room.triangles.iter())
            .map(|(corners, _)| (*corners, 0.9))
            .collect();
        let found = receive(outside(surfaces(&parts)), &points());
        for (point, total) in points().iter().zip(found.total()) {
            assert_eq!(
                total,
                DVec3::ZERO,
                "thickness {thickness}, {}",
                point.position
            );
        }
    }
}

#[test]
fn without_a_sky_the_sun_alone_lights_a_room() {
    let mut scene = surfaces(&study(0.0));
    scene = ground(sun(scene, [200.0, 35.0], 6e4), -0.2, 0.2);
    let found = receive(scene, &points());
    assert!(found.sky.iter().all(|v| *v == DVec3::ZERO));
    // What enters is absorbed or leaves again; every point sees some of it.
    assert!(
        found.indirect.iter().all(|v| v.y > 10.0),
        "{:?}",
        y(&found.indirect)
    );
    // Without a sun too there is nothing.
    let nothing = ground(surfaces(&study(0.0)), -0.2, 0.2);
    let found = receive(nothing, &points());
    assert!(found.total().iter().all(|v| *v == DVec3::ZERO));
}

/// Light is linear: twice the sky and twice the sun give twice of everything, sky and sun alone sum to both together.
#[test]
fn light_is_a_sum() {
    let mut off = Deviations::default();
    let all = |sky_level: f64, lux: f64| {
        let scene = surfaces(&study(0.0));
        let scene = sky(scene, &format!("uniform:{sky_level}"));
        let scene = ground(sun(scene, [200.0, 35.0], lux), -0.2, 0.2);
        y(&receive(scene, &points()).total())
    };
    let both = all(4000.0, 6e4);
    let parts: Vec<f64> = (all(4000.0, 0.0).iter().zip(all(0.0, 6e4)))
        .map(|(a, b)| a + b)
        .collect();
    same(&mut off, "sky and sun", &parts, &both, 1e-3);
    let twice: Vec<f64> = all(8000.0, 12e4).iter().map(|v| 0.5 * v).collect();
    same(&mut off, "twice the light", &twice, &both, 1e-3);
    off.end();
}

#[test]
fn no_light_leaks_from_a_bright_room_into_a_dark_one() {
    for thickness in [0.0, 0.12] {
        // Two white rooms wall to wall under an open sky: one without a ceiling, one closed.
        let mut parts = Surfaces::new();
        for (x, open) in [(0.0, true), (3.0 + thickness, false)] {
            let corner = dvec3(x, 0.0, -3.0);
            parts.extend(grey(quad(corner, DVec3::X * 3.0, DVec3::Z * 3.0), 0.9));
            for (from, side) in [
                (corner, DVec3::X * 3.0),
                (corner + DVec3::Z * 3.0, DVec3::X * 3.0),
                (corner, DVec3::Z * 3.0),
                (corner + DVec3::X * 3.0, DVec3::Z * 3.0),
            ] {
                parts.extend(grey(quad(from, side, DVec3::Y * 2.5), 0.9));
            }
            if !open {
                parts.extend(grey(
                    quad(corner + DVec3::Y * 2.5, DVec3::X * 3.0, DVec3::Z * 3.0),
                    0.9,
                ));
            }
        }
        let dark: Vec<Receiver> = [
            at(dvec3(3.001 + thickness, 0.001, -1.5), DVec3::X),
            at(dvec3(3.01 + thickness, 0.01, -0.01), DVec3::Y),
            at(dvec3(4.5 + thickness, 1.2, -1.5), DVec3::NEG_X),
            at(dvec3(3.002 + thickness, 2.498, -2.998), DVec3::NEG_Y),
        ]
        .to_vec();
        let lit = at(dvec3(1.5, 0.5, -1.5), DVec3::Y);
        let all = [dark, vec![lit]].concat();
        let total = receive(outside(surfaces(&parts)), &all).total();
        let (bright, dark) = total.split_last().expect("there are points");
        assert!(bright.y > 5e3, "{bright}");
        for (value, point) in dark.iter().zip(&all) {
            assert_eq!(
                *value,
                DVec3::ZERO,
                "thickness {thickness}: {}",
                point.position
            );
        }
    }
}

/// The most memory that the process has had [MiB], where the system tells.
fn peak() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib / 1024.0)
}

#[test]
fn two_hundred_thousand_triangles_take_bounded_memory() {
    let mut off = Deviations::default();
    let plain = light(&study(0.0));
    let before = peak();
    // Depth 6: 4 096 parts of each of the 26 triangles, twice as many of the floor and the ceiling.
    let mut fine = Surfaces::new();
    for (triangle, reflectance) in study(0.0) {
        let depth = if reflectance == WALLS { 6 } else { 7 };
        fine.extend(grey(quarters(triangle, depth), reflectance));
    }
    let count = fine.len();
    assert!(count > 150_000, "{count}");
    let begin = Instant::now();
    let found = light(&fine);
    let seconds = begin.elapsed().as_secs_f64();
    eprintln!(
        "{count} triangles: {seconds:.1} s, memory {before:.0?} to {:.0?} MiB",
        peak()
    );
    same(&mut off, "very many triangles", &found, &plain, SAME);
    if let Some(peak) = peak() {
        assert!(peak < 2048.0, "{peak} MiB");
    }
    off.end();
}

/// The size of pictures [pixels].
const SIZE: [u32; 2] = [48, 32];

/// The radiance of a sky that is even all over.
const EVEN: f64 = 1000.0;

/// What each pixel that shows a surface receives straight from the sky in a picture at `preview` [lx], and where it is: `normal` is that of
/// all surfaces.
fn seen(scene: Scene, camera: Camera, normal: DVec3) -> (Vec<f64>, Vec<Receiver>) {
    let conditions = build::conditions(scene, camera, SIZE);
    let frame = build::render_at(&conditions, Quality::Preview, &[]);
    let received = y(&build::layer(&frame, Field::Sky));
    let (mut found, mut places) = (Vec::new(), Vec::new());
    for (number, radiance) in (0..).zip(received) {
        let [x, y] = [number % SIZE[0], number / SIZE[0]].map(f64::from);
        let pixel = dvec2(x + 0.5, y + 0.5);
        let ray = conditions.view.ray(pixel);
        let hit = conditions.geometry.closest(&ray, 0.0, f64::INFINITY);
        if let Some(hit) = hit {
            found.push(PI / WALLS * radiance);
            places.push(at(ray.at(hit.distance) + 1e-7 * normal, normal));
        }
    }
    (found, places)
}

/// The shares of pixels that receive less than 0.8 of what single points there do, and more than 1.25 of it.
fn off(scene: impl Fn() -> Scene, camera: Camera, normal: DVec3) -> [f64; 2] {
    let (found, places) = seen(scene(), camera, normal);
    let truth = y(&receive(scene(), &places).sky);
    assert!(found.len() > 1000, "{} pixels show a surface", found.len());
    let whole = PI * EVEN;
    let ratios = found.iter().zip(&truth).filter(|(_, t)| **t > 0.05 * whole);
    let ratios: Vec<f64> = ratios.map(|(f, t): (&f64, &f64)| f / t).collect();
    let share = |is: fn(&f64) -> bool| {
        ratios.iter().copied().filter(is).count() as f64 / ratios.len() as f64
    };
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let most = ratios.iter().copied().fold(0.0, f64::max);
    let off = [share(|r| *r < 0.8), share(|r| *r > 1.25)];
    eprintln!("{:.2} to {:.2} of the truth; {off:?}", least, most);
    off
}

fn uniform(parts: &[(Corners, f64)]) -> Scene {
    sky(surfaces(parts), &format!("uniform:{EVEN}"))
}

/// A hilly sheet of 2 by 2 m in triangles of 5 cm.
fn hills(shift: DVec3) -> Vec<(Corners, f64)> {
    let height = |x: f64, z: f64| {
        0.06 * (5.1 * x).sin() * (4.3 * z + 1.0).cos() + 0.03 * (9.7 * (x + z)).sin()
    };
    let corner = |i: i32, j: i32| {
        let (x, z) = (0.05 * f64::from(i), 0.05 * f64::from(j));
        dvec3(x, height(x, z), z) + shift
    };
    let square = |k: i32| {
        let (i, j) = (k % 40 - 20, k / 40 - 20);
        let [a, b, c, d] = [
            corner(i, j),
            corner(i + 1, j),
            corner(i + 1, j + 1),
            corner(i, j + 1),
        ];
        [([a, c, b], WALLS), ([a, d, c], WALLS)]
    };
    (0..1600).flat_map(square).collect()
}

#[test]
fn sheets_that_cross_have_no_black_facets() {
    // Two of one terrain, a little shifted: each dips below the other by a few millimetres.
    let scene = || {
        let mut scene = uniform(&[hills(DVec3::ZERO), hills(dvec3(0.004, 0.0, 0.0027))].concat());
        // One normal for all: facets are bent.
        scene.mesh.normals = vec![DVec3::Y; scene.mesh.positions.len()];
        scene
    };
    let camera = Camera::look_at(dvec3(0.4, 0.8, 0.9), dvec3(0.0, 0.0, -0.1), 0.7);
    let [dark, bright] = off(scene, camera, DVec3::Y);
    let mut all = Deviations::default();
    all.note("dark pixels", dark, 0.01);
    all.note("bright pixels", bright, 0.01);
    all.end();
}

#[test]
fn a_carpet_sends_what_the_floor_below_it_would() {
    let mut off = Deviations::default();
    let plain = light(&study(0.0));
    // Half of the floor, turned, so that it covers parts of cells.
    let turn = DQuat::from_rotation_y(0.4);
    let corner = dvec3(-0.9, 0.0, -2.0);
    let carpet = quad(corner, 4.0 * DVec3::Z, 1.8 * DVec3::X);
    let moved = carpet.map(|t| t.map(|p| turn * p + dvec3(2.0, 0.02, -3.0)));
    let found = light(&[study(0.0), grey(moved, FLOOR)].concat());
    // Patches that it covers in part send the mean of both parts from both.
    same(&mut off, "2 cm above", &found, &plain, 8.0 * SAME);
    off.end();
}

#[test]
fn a_carpet_and_a_picture_leave_what_is_beside_them_alone() {
    let turn = DQuat::from_rotation_y(0.3);
    let mut all = Deviations::default();
    // On a floor, and on a wall.
    let wall = DQuat::from_rotation_x(0.5 * PI);
    for (way, normal, gap) in [
        (DQuat::IDENTITY, DVec3::Y, 0.001),
        (DQuat::IDENTITY, DVec3::Y, 0.01),
        (DQuat::IDENTITY, DVec3::Y, 0.05),
        (wall, DVec3::Z, 0.01),
    ] {
        let scene = || {
            let rectangle = |half: [f64; 2], height: f64| {
                let corner = dvec3(-half[0], height, -half[1]);
                quad(corner, 2.0 * half[1] * DVec3::Z, 2.0 * half[0] * DVec3::X)
            };
            let carpet = rectangle([0.83, 0.61], gap);
            let carpet = carpet.map(|t| t.map(|p| way * (turn * p)));
            let floor = rectangle([3.0, 3.0], 0.0).map(|t| t.map(|p| way * p));
            let all = floor.into_iter().chain(carpet);
            uniform(&all.map(|t| (t, WALLS)).collect::<Vec<_>>())
        };
        let eye = way * dvec3(0.3, 2.2, 1.3);
        let camera = Camera::look_at(eye, way * dvec3(0.1, 0.0, 0.1), 0.9);
        let [dark, bright] = off(scene, camera, normal);
        all.note(&format!("{gap} m, {normal}: dark pixels"), dark, 0.01);
        all.note(&format!("{gap} m, {normal}: bright pixels"), bright, 0.01);
    }
    all.end();
}
