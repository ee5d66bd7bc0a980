//! Form factors by hemicubes, found by rays of the CPU and drawn by the GPU: against closed forms, and against each other.

mod common;

use common::build::{material, quad};
use common::receive::*;
use common::rooms::{Opening, Shell, panel, plan};
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};
use std::time::Instant;
use tyndall::backend::Wanted;
use tyndall::backend::gpu::{Choice, Device, Hemicubes};
use tyndall::conditions::{Conditions, Receiver};
use tyndall::error::{Error, Result};
use tyndall::medium::{Phase, Shape};
use tyndall::radiosity::{Care, Detail, Dome, Drawer, Eye, Light, Source, Target, Tile, Transport};
use tyndall::scene::{AlphaMode, Material, Scene, Texture, Wrap};
use tyndall::sky::patches::Subdivision;
use tyndall::studies::scenes::{Corners, cuboid, fog};
use tyndall::task::Task;

type Surfaces = Vec<(Corners, f64)>;

/// Hemicubes of so many texels on a side, one in the middle of each patch, and nothing else.
fn detail(hemicube: usize, patch: f64) -> Detail {
    Detail {
        sky: 1,
        care: Care {
            rays: 64,
            outline: 0.05,
        },
        patch,
        patches: 4000,
        patch_rays: 100_000,
        hemicube,
        hemicube_spots: 1,
        patch_spots: 0,
    }
}

fn drawer() -> &'static Hemicubes {
    static DRAWER: OnceLock<Hemicubes> = OnceLock::new();
    DRAWER.get_or_init(|| {
        let device = Device::open(Choice::Any).expect("there is an adapter");
        Hemicubes::new(Arc::new(device))
    })
}

fn by_cpu(conditions: &Conditions, detail: Detail) -> Transport {
    Transport::new(conditions, detail, None, Task::unwatched()).expect("nothing stops it")
}

fn by_gpu(conditions: &Conditions, detail: Detail) -> Transport {
    let transport = Transport::new(
        conditions,
        detail,
        Some(drawer() as &dyn Drawer),
        Task::unwatched(),
    )
    .expect("nothing stops it");
    assert_eq!(transport.notes(), [""; 0]);
    transport
}

fn grey(triangles: impl IntoIterator<Item = Corners>, reflectance: f64) -> Surfaces {
    triangles.into_iter().map(|t| (t, reflectance)).collect()
}

fn seen(scene: Scene) -> Conditions {
    conditions(scene, &[at(DVec3::Y, DVec3::Y)])
}

/// The share of what some patches send that goes to some others.
fn share(
    transport: &Transport,
    from: impl Fn(DVec3, DVec3) -> bool,
    to: impl Fn(DVec3, DVec3) -> bool,
) -> f64 {
    let patches: Vec<(f64, DVec3, DVec3)> = transport.patches().collect();
    let (mut sent, mut area) = (0.0, 0.0);
    for (i, (own, place, normal)) in patches.iter().enumerate() {
        if !from(*place, *normal) {
            continue;
        }
        area += own;
        for (source, share, _) in transport.form_factors(i) {
            if let Source::Patch(j, _) = source
                && to(patches[j as usize].1, patches[j as usize].2)
            {
                sent += own * f64::from(share);
            }
        }
    }
    sent / area
}

/// How far what patches send, or what arrives of it, is apart in two transports, as a sum over all where it goes: the mean over
/// patches and the most.
fn apart(one: &Transport, other: &Transport) -> [f64; 2] {
    let count = one.patches().count();
    assert_eq!(count, other.patches().count());
    let (mut sum, mut worst) = (0.0, 0.0f64);
    for patch in 0..count {
        let (a, b) = (one.form_factors(patch), other.form_factors(patch));
        let mut all: Vec<(Source, f64, f64)> = Vec::new();
        let signed = [(a, 1.0), (b, -1.0)];
        for (row, sign) in signed {
            let part = |(source, share, through): (Source, f32, glam::Vec3)| {
                (source, sign * f64::from(share), sign * f64::from(through.y))
            };
            all.extend(row.into_iter().map(part));
        }
        all.sort_by_key(|(source, ..)| *source);
        all.dedup_by(|next, sum| {
            let same = next.0 == sum.0;
            if same {
                sum.1 += next.1;
                sum.2 += next.2;
            }
            same
        });
        let off: f64 = all.iter().map(|(_, s, t)| s.abs().max(t.abs())).sum();
        sum += off;
        worst = worst.max(off);
    }
    [sum / count as f64, worst]
}

/// Notes how far what is drawn is from what rays find: by rounding, but for a few texels in a million. In these an edge passes within the
/// rounding of a rasteriser (1/256 of a texel) of the middle, of something so thin that no other texel beside it shows it.
fn same_rows(
    off: &mut Deviations,
    what: &str,
    side: usize,
    by_rays: &Transport,
    drawn: &Transport,
) {
    let [mean, worst] = apart(by_rays, drawn);
    let texel = 4.0 / (PI * (side * side) as f64);
    off.note(&format!("{what}, drawn, the mean"), mean, 2e-5);
    off.note(
        &format!("{what}, drawn, the worst patch"),
        worst,
        2.0 * texel,
    );
}

#[test]
fn rectangles_send_each_other_what_closed_forms_say() {
    let mut off = Deviations::default();
    let square = quad(DVec3::ZERO, DVec3::X, DVec3::Z);
    // Unit squares one apart, and two that share an edge (Howell: C-11, C-14).
    for (name, exact, other, normal) in [
        (
            "parallel",
            0.199_824_9,
            quad(DVec3::Y, DVec3::X, DVec3::Z),
            DVec3::NEG_Y,
        ),
        (
            "perpendicular",
            0.200_043_8,
            quad(DVec3::ZERO, DVec3::Y, DVec3::Z),
            DVec3::X,
        ),
    ] {
        let scene = sky(
            surfaces(&grey([square, other].concat(), 0.5)),
            "uniform:5000",
        );
        let conditions = seen(scene);
        let upward = |_: DVec3, n: DVec3| n.dot(DVec3::Y) > 0.9;
        for (side, allowed) in [(8, 0.03), (32, 0.005), (128, 0.001)] {
            let found = by_cpu(&conditions, detail(side, 0.1));
            let low = |p: DVec3, n: DVec3| upward(p, n) && p.y < 0.5;
            let sent = share(&found, low, |_, n| n.dot(normal) > 0.9);
            off.near(&format!("{name}, {side}"), &[sent], &[exact], allowed);
        }
        // Where patches are coarse their middles speak for too much; several points of each do not.
        let spots = Detail {
            hemicube_spots: 16,
            ..detail(64, 0.5)
        };
        for (what, detail, allowed) in [
            ("coarse, in the middle", detail(64, 0.5), 0.06),
            ("coarse, 16 spots", spots, 0.015),
        ] {
            let found = by_cpu(&conditions, detail);
            let low = |p: DVec3, n: DVec3| upward(p, n) && p.y < 0.5;
            let sent = share(&found, low, |_, n| n.dot(normal) > 0.9);
            off.near(&format!("{name}, {what}"), &[sent], &[exact], allowed);
        }
    }
    off.end();
}

/// A room, 4 by 6 and 3 high, with a window to the south; a table and a screen that stand in it.
fn study() -> Surfaces {
    let shell = Shell {
        outline: plan(4.0, 6.0),
        height: 3.0,
        thickness: 0.2,
        openings: vec![Opening {
            wall: 0,
            along: [0.8, 3.2],
            height: [0.9, 2.4],
        }],
        reflectances: [0.3, 0.5, 0.8],
    };
    let room = shell.room("study", 1.0);
    let reflectance = |material: u32| room.reflectances[material as usize].x;
    let mut parts: Surfaces = (room.triangles.iter())
        .map(|(corners, m)| (*corners, reflectance(*m)))
        .collect();
    let table = cuboid(dvec3(1.0, 0.7, -3.4), dvec3(2.6, 0.75, -2.2));
    parts.extend(grey(table, 0.4));
    let screen = quad(
        dvec3(2.9, 0.0, -4.9),
        dvec3(0.7, 0.0, 0.6),
        dvec3(0.0, 1.7, 0.0),
    );
    parts.extend(grey(screen, 0.6));
    parts
}

fn outside(scene: Scene) -> Scene {
    let scene = sun(sky(scene, "cie:12"), [200.0, 35.0], 6e4);
    ground(scene, -0.2, 0.2)
}

#[test]
fn the_gpu_draws_what_rays_find() {
    if !common::gpu("the_gpu_draws_what_rays_find") {
        return;
    }
    let mut off = Deviations::default();
    let plain = outside(surfaces(&study()));
    let mut hazy = plain.clone();
    hazy.media = vec![fog(Shape::Haze { top: 20.0 }, 0.05, 0.02, Phase::Isotropic)];
    for (name, scene) in [("study", plain), ("in a haze", hazy)] {
        let conditions = seen(scene);
        for (side, spots) in [(16, 1), (46, 1), (16, 3)] {
            let detail = Detail {
                hemicube_spots: spots,
                ..detail(side, 0.25)
            };
            let (cpu, gpu) = (by_cpu(&conditions, detail), by_gpu(&conditions, detail));
            let what = format!("{name}, {side} by {spots}");
            same_rows(&mut off, &what, side, &cpu, &gpu);
        }
    }
    off.end();
}

/// A scene whose triangles from a number on have a second material.
fn with_material(parts: &Surfaces, from: usize, second: Material) -> Scene {
    let mut scene = outside(surfaces(parts));
    let number = scene.materials.len() as u32;
    scene.materials.push(second);
    for triangle in &mut scene.mesh.triangles[from..] {
        triangle.material = number;
    }
    for (i, uv) in scene.mesh.uvs.iter_mut().enumerate() {
        *uv = [
            DVec2::ZERO,
            DVec2::X,
            DVec2::Y,
            DVec2::X,
            DVec2::ONE,
            DVec2::Y,
        ][i % 6];
    }
    scene
}

#[test]
fn holes_and_panes_let_through_what_they_do() {
    let gpu = common::gpu("holes_and_panes_let_through_what_they_do");
    let mut off = Deviations::default();
    // A plate, and a curtain over it of which a quarter is there: texels of a checked texture, or alpha.
    let mut parts = grey(quad(DVec3::ZERO, DVec3::X, DVec3::Z), 0.5);
    let curtain = quad(dvec3(-4.0, 0.5, -4.0), DVec3::X * 9.0, DVec3::Z * 9.0);
    parts.extend(grey(curtain, 0.5));
    let pane = Material {
        name: "pane".into(),
        alpha: 0.25,
        alpha_mode: AlphaMode::Blend,
        ..material(0.5)
    };
    let mut masked = Material {
        name: "leaves".into(),
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..material(0.5)
    };
    masked.texture = Some(0);
    let size = 64;
    let texels = (0..size * size).map(|i| {
        let (x, y) = (i % size, i / size);
        [
            255,
            255,
            255,
            if x % 2 == 0 && y % 2 == 0 { 255 } else { 0 },
        ]
    });
    let leaves = Texture {
        name: "leaves".into(),
        width: size,
        height: size,
        pixels: texels.collect(),
        wrap: [Wrap::Repeat; 2],
    };
    for (name, second) in [("pane", pane), ("leaves", masked)] {
        let mut scene = with_material(&parts, 2, second);
        scene.textures.push(leaves.clone());
        let conditions = seen(scene);
        let detail = detail(64, 0.2);
        let cpu = by_cpu(&conditions, detail);
        // The curtain as it would be without holes: four fifths of a plate's half space and more.
        let curtain = rectangle(dvec3(-4.0, 0.5, -4.0), DVec3::X * 9.0, DVec3::Z * 9.0);
        let nodes = over_rectangle(DVec3::ZERO, DVec3::X, DVec3::Z, DVec3::Y, 6);
        let whole: f64 = nodes
            .iter()
            .map(|(p, w)| w * form_factor(p, &curtain))
            .sum();
        let found = share(
            &cpu,
            |p, n| p.y == 0.0 && n.y > 0.9,
            |p, n| p.y > 0.4 && n.y < -0.9,
        );
        off.near(name, &[found], &[0.25 * whole], 0.02);
        if gpu {
            same_rows(&mut off, name, 64, &cpu, &by_gpu(&conditions, detail));
        }
    }
    off.end();
}

#[test]
fn no_light_leaks_where_walls_meet() {
    let gpu = common::gpu("no_light_leaks_where_walls_meet");
    // Two white rooms wall to wall under an open sky, of which one is closed. Its walls are of two panels, whose corners lie within
    // the edges of floor, roof and each other.
    let mut parts = Surfaces::new();
    let (along, up) = (DVec3::X * 3.0, DVec3::Y * 2.5);
    let deep = DVec3::Z * 3.0;
    for (x, cut) in [(0.0, [1.0, 0.0]), (3.0, [0.37, 0.61])] {
        let corner = dvec3(x, 0.0, -3.0);
        parts.extend(grey(quad(corner, along, deep), 0.9));
        let walls = [
            (corner, along),
            (corner + deep, along),
            (corner, deep),
            (corner + along, deep),
        ];
        for ((from, side), at) in walls.into_iter().zip([cut, cut, [1.0, 0.0], cut]) {
            let [low, across] = at;
            parts.extend(grey(quad(from, side, low * up), 0.9));
            if across > 0.0 {
                let from = from + low * up;
                let up = (1.0 - low) * up;
                parts.extend(grey(quad(from, across * side, up), 0.9));
                parts.extend(grey(
                    quad(from + across * side, (1.0 - across) * side, up),
                    0.9,
                ));
            }
        }
    }
    parts.extend(grey(quad(dvec3(3.0, 2.5, -3.0), along, deep), 0.9));
    let conditions = seen(outside(surfaces(&parts)));
    let (low, high) = (dvec3(3.0, 0.0, -3.0), dvec3(6.0, 2.5, 0.0));
    for side in [8, 32, 64] {
        let detail = detail(side, 0.2);
        let mut all = vec![by_cpu(&conditions, detail)];
        if gpu {
            all.push(by_gpu(&conditions, detail));
        }
        for transport in all {
            let light = Light::new(&transport, &conditions, 1e-3, Task::unwatched())
                .expect("nothing stops it");
            // A patch inside is one on a wall of the room that faces its middle.
            let patches: Vec<_> = transport.patches().collect();
            let is_inside = |i: usize| {
                let (_, p, n) = patches[i];
                let within = (p - low).min(high - p).min_element() > -1e-9;
                within && n.dot(0.5 * (low + high) - p) > 0.0
            };
            let count = (0..patches.len()).filter(|i| is_inside(*i)).count();
            assert!(count > 60, "{count}");
            for (i, (_, place, normal)) in patches.iter().enumerate() {
                let source = Source::Patch(i as u32, Tile::WHOLE);
                if is_inside(i) {
                    assert_eq!(light.radiance(source), DVec3::ZERO, "{side}");
                }
                for (source, share, _) in transport.form_factors(i) {
                    let enters = matches!(source, Source::Patch(j, _) if is_inside(j as usize));
                    assert_eq!(
                        is_inside(i),
                        enters,
                        "{side}: from {place}, {normal}, to {source:?}, {share}"
                    );
                }
            }
        }
    }
}

/// What goes out of a scene's light, by a transport: all of it.
fn account(off: &mut Deviations, name: &str, conditions: &Conditions, transport: &Transport) {
    for i in 0..transport.patches().count() {
        let row = transport.form_factors(i).into_iter();
        let whole: f64 = row.map(|(_, share, _)| f64::from(share)).sum();
        assert!(
            whole == 0.0 || (whole - 1.0).abs() < 2e-3,
            "{name}: {i} {whole}"
        );
    }
    let account = Light::new(transport, conditions, 1e-3, Task::unwatched())
        .expect("nothing stops it")
        .account;
    let gone = account.absorbed + account.escaped + account.taken + account.unshot;
    let share = gone.y / account.received.y;
    off.note(&format!("{name}: the account"), (share - 1.0).abs(), 1e-3);
}

/// The knobs of [`detail`].
const KNOBS: Settings = &[
    ("radiosity.hemicube", 32.0),
    ("radiosity.patch", 0.2),
    ("radiosity.patches", 1500.0),
    ("radiosity.patch_spots", 200.0),
    ("radiosity.unshot", 1e-3),
];

fn backends(test: &str) -> Vec<Wanted> {
    match common::gpu(test) {
        true => vec![Wanted::Reference, Wanted::Gpu],
        false => vec![Wanted::Reference],
    }
}

#[test]
fn energy_is_accounted_for_and_a_white_world_is_white() {
    let mut off = Deviations::default();
    // A room without a wall to the south. Where nothing absorbs, everything has the sky's radiance.
    let mut room = Surfaces::new();
    for (corner, a, b) in [
        (DVec3::ZERO, DVec3::X * 4.0, DVec3::NEG_Z * 5.0),
        (DVec3::Y * 3.0, DVec3::X * 4.0, DVec3::NEG_Z * 5.0),
        (DVec3::ZERO, DVec3::Y * 3.0, DVec3::NEG_Z * 5.0),
        (DVec3::X * 4.0, DVec3::Y * 3.0, DVec3::NEG_Z * 5.0),
        (DVec3::NEG_Z * 5.0, DVec3::X * 4.0, DVec3::Y * 3.0),
    ] {
        room.extend(grey(quad(corner, a, b), 1.0));
    }
    let world = ground(sky(surfaces(&room), "uniform:5000"), -0.5, 1.0);
    let points: Vec<Receiver> = [
        at(dvec3(2.0, 0.8, -4.5), DVec3::Y),
        at(dvec3(0.4, 2.0, -4.5), DVec3::X),
        at(dvec3(3.5, 2.9, -0.2), DVec3::NEG_Y),
        at(dvec3(2.0, 1.5, 1.0), DVec3::NEG_Z),
    ]
    .to_vec();
    for backend in backends("energy_is_accounted_for_and_a_white_world_is_white") {
        let total = received_by(&conditions(world.clone(), &points), backend, KNOBS).total();
        off.near("white", &y(&total), &[5000.0 * PI; 4], 0.01);
    }
    for (name, scene) in [("study", outside(surfaces(&study()))), ("white", world)] {
        let conditions = seen(scene);
        let transport = by_cpu(&conditions, detail(32, 0.25));
        account(&mut off, name, &conditions, &transport);
    }
    off.end();
}

#[test]
fn a_sphere_with_a_port_returns_one_over_one_less_its_albedo() {
    // Ulbricht's sphere: through a port that is a share f of all that its wall sees the sky lights it, and with an albedo r it receives
    // E = pi L f / (1 - r (1 - f)).
    let mut off = Deviations::default();
    let (around, down, open) = (32, 16, 4);
    let edge = (PI * f64::from(open) / f64::from(down)).cos();
    let corner = |i: usize, j: usize| {
        let (sin_a, cos_a) = (2.0 * PI * (i % around) as f64 / around as f64).sin_cos();
        let (sin_z, cos_z) = (PI * j as f64 / f64::from(down)).sin_cos();
        2.0 * dvec3(sin_z * cos_a, cos_z, sin_z * sin_a)
    };
    let mut faces = Vec::new();
    for j in open as usize..down as usize {
        for i in 0..around {
            let [a, b] = [corner(i, j), corner(i + 1, j)];
            let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
            faces.push([a, b, c]);
            if j + 1 < down as usize {
                faces.push([a, c, d]);
            }
        }
    }
    for albedo in [0.2, 0.5, 0.9, 0.999] {
        let scene = sky(surfaces(&grey(faces.clone(), albedo)), "uniform:5000");
        let conditions = seen(scene);
        let transport = by_cpu(&conditions, detail(24, 0.25));
        account(
            &mut off,
            &format!("albedo {albedo}"),
            &conditions,
            &transport,
        );
        let patches: Vec<_> = transport.patches().collect();
        let light =
            Light::new(&transport, &conditions, 1e-4, Task::unwatched()).expect("nothing stops it");
        // Inside: normals to the middle.
        let inside = |(_, p, n): &(f64, DVec3, DVec3)| n.dot(*p) < 0.0;
        let (mut area, mut sent, mut out) = (0.0, 0.0, 0.0);
        for (i, patch) in patches.iter().enumerate().filter(|(_, p)| inside(p)) {
            let radiance = light.radiance(Source::Patch(i as u32, Tile::WHOLE)).y;
            area += patch.0;
            sent += patch.0 * PI * radiance / albedo;
            let row = transport.form_factors(i).into_iter();
            let sky = row.filter(|(source, ..)| matches!(source, Source::Sky(_)));
            out += patch.0 * sky.map(|(_, share, _)| f64::from(share)).sum::<f64>();
        }
        let f = out / area;
        off.near("the port's share", &[f], &[0.5 * (1.0 - edge)], 0.02);
        let truth = 5000.0 * PI * f / (1.0 - albedo * (1.0 - f));
        off.near(&format!("albedo {albedo}"), &[sent / area], &[truth], 0.005);
    }
    off.end();
}

/// How bright the surfaces in the study are by hemicubes and by rays, against many rays; with the time that each takes to find who sees
/// whom.
#[test]
fn hemicubes_and_rays_light_a_room_alike() {
    let gpu = common::gpu("hemicubes_and_rays_light_a_room_alike");
    let mut off = Deviations::default();
    let conditions = seen(outside(surfaces(&study())));
    let rays = |patch_rays: usize| Detail {
        patch_rays,
        ..detail(0, 0.25)
    };
    let lit = |detail: Detail, drawer: Option<&dyn Drawer>| {
        let start = Instant::now();
        let transport = Transport::new(&conditions, detail, drawer, Task::unwatched())
            .expect("nothing stops it");
        let time = start.elapsed();
        let light =
            Light::new(&transport, &conditions, 1e-5, Task::unwatched()).expect("nothing stops it");
        let inside = |p: DVec3, n: DVec3| {
            let to_middle = dvec3(2.0, 1.5, -3.0) - p;
            let size = dvec3(2.0, 1.5, 3.0);
            (to_middle.abs() - size).max_element() < 1e-6 && n.dot(to_middle) > 0.0
        };
        let patches = transport.patches().enumerate();
        let patches = patches.filter(|(_, (_, p, n))| inside(*p, *n));
        let radiance = |i| light.radiance(Source::Patch(i as u32, Tile::WHOLE)).y;
        let values: Vec<[f64; 2]> = patches.map(|(i, (area, ..))| [area, radiance(i)]).collect();
        (values, time)
    };
    let (truth, time) = lit(rays(100_000_000), None);
    eprintln!("many rays: {} patches in the room, {time:.1?}", truth.len());
    let one = |hemicube| detail(hemicube, 0.25);
    let spots = |hemicube, hemicube_spots| Detail {
        hemicube_spots,
        ..one(hemicube)
    };
    let trials = [
        ("rays, 52 a patch", rays(100_000), 0.2),
        ("rays, 520 a patch", rays(1_000_000), 0.06),
        ("hemicubes of 8", one(8), 0.1),
        ("hemicubes of 16", one(16), 0.04),
        ("hemicubes of 32", one(32), 0.03),
        ("hemicubes of 64", one(64), 0.025),
        ("hemicubes of 16, 4 spots", spots(16, 4), 0.05),
    ];
    for (name, detail, allowed) in trials {
        let mut times = Vec::new();
        let mut ways: Vec<Option<&dyn Drawer>> = vec![None];
        ways.extend(gpu.then(|| Some(drawer() as &dyn Drawer)));
        let mut error = 0.0;
        for drawer in ways {
            let (found, time) = lit(detail, drawer);
            let pairs = found.iter().zip(&truth);
            let square: f64 = pairs.map(|(f, t)| t[0] * (f[1] - t[1]).powi(2)).sum();
            let whole: f64 = truth.iter().map(|[area, value]| area * value).sum();
            let area: f64 = truth.iter().map(|[area, _]| area).sum();
            error = (square * area).sqrt() / whole;
            times.push(time);
        }
        off.note(&format!("{name} ({times:.2?})"), error, allowed);
    }
    off.end();
}

/// A device that is lost.
struct Lost;

impl Drawer for Lost {
    fn draw(
        &self,
        _: &[Target],
        _: &[Eye],
        _: usize,
        _: &mut dyn FnMut(&[u32]) -> Result<()>,
    ) -> Result<()> {
        Err(Error::failed("the device was lost", "try again"))
    }
}

#[test]
fn what_is_not_as_it_was_asked_for_is_said() {
    let conditions = seen(outside(surfaces(&study())));
    // What a device does not draw rays find.
    let detail = detail(8, 0.5);
    let transport = Transport::new(&conditions, detail, Some(&Lost), Task::unwatched())
        .expect("nothing stops it");
    let [note] = transport.notes() else {
        panic!("{:?}", transport.notes());
    };
    assert!(note.contains("the device was lost"), "{note}");
    assert_eq!(apart(&transport, &by_cpu(&conditions, detail)), [0.0; 2]);
    // Rows have bounded memory: the 36 865 patches of a fine sky may all be seen.
    let greedy = Detail {
        sky: 16,
        hemicube: 1024,
        ..detail
    };
    let transport = by_cpu(&conditions, greedy);
    let [note] = transport.notes() else {
        panic!("{:?}", transport.notes());
    };
    assert!(note.contains("not 1024"), "{note}");
    let rows = (0..transport.patches().count()).map(|i| transport.form_factors(i).len());
    assert!(rows.sum::<usize>() <= 40_000_000);
}

#[test]
fn a_room_on_a_plain_of_thirty_kilometres_is_as_on_any_ground() {
    let mut off = Deviations::default();
    let points: Vec<Receiver> = [[0.6, -0.7], [2.0, -3.0], [3.3, -5.2]]
        .iter()
        .map(|[x, z]| at(dvec3(*x, 0.85, *z), DVec3::Y))
        .collect();
    let plain = outside(surfaces(&study()));
    let mut parts = study();
    let far = 15e3;
    let slab = quad(
        dvec3(-far, -0.2, -far),
        DVec3::Z * 2.0 * far,
        DVec3::X * 2.0 * far,
    );
    parts.extend(grey(slab, 0.2));
    let mut on_slab = outside(surfaces(&parts));
    on_slab.ground.enabled = false;
    let by = |scene: &Scene, backend| {
        let total = received_by(&conditions(scene.clone(), &points), backend, KNOBS).total();
        y(&total)
    };
    let truth = by(&plain, Wanted::Reference);
    for backend in backends("a_room_on_a_plain_of_thirty_kilometres_is_as_on_any_ground") {
        off.near(
            &format!("{backend:?}"),
            &by(&on_slab, backend),
            &truth,
            0.02,
        );
    }
    if common::gpu("a_room_on_a_plain_of_thirty_kilometres_is_as_on_any_ground") {
        let conditions = seen(on_slab);
        let detail = detail(32, 0.25);
        let (cpu, gpu) = (by_cpu(&conditions, detail), by_gpu(&conditions, detail));
        same_rows(&mut off, "a slab of 30 km", 32, &cpu, &gpu);
    }
    off.end();
}

#[test]
fn a_pinhole_smaller_than_a_texel_is_seen_as_none_or_as_a_texel() {
    // Half a metre of floor, 2 m below a roof of 8 by 8 with a hole of 2 cm: a hemicube's texel is 12 cm wide there. Elsewhere the
    // sky shows low down at the sides.
    let (size, hole) = (8.0, 0.02);
    let edges = [0.5 * (size - hole), 0.5 * (size + hole)];
    let hole_at = [edges[0], edges[1], edges[0], edges[1]];
    let corner = dvec3(-0.5 * size, 2.0, -0.5 * size);
    let roof = panel(corner, DVec3::X, DVec3::Z, [size, size], &[hole_at]);
    let mut parts = grey(roof, 0.5);
    let floor = quad(dvec3(-0.25, 0.0, -0.25), DVec3::X * 0.5, DVec3::Z * 0.5);
    parts.extend(grey(floor, 0.5));
    let conditions = seen(sky(surfaces(&parts), "uniform:5000"));
    let half = 0.5 * hole;
    let rim = rectangle(dvec3(-half, 2.0, -half), hole * DVec3::X, hole * DVec3::Z);
    let detail = detail(32, 0.1);
    let dome = Dome::new(Subdivision::Reinhart(1));
    let high = |source: &Source| match source {
        Source::Sky(patch) => dome.patches()[*patch as usize].direction.y > 0.7,
        _ => false,
    };
    let shares = |transport: &Transport| -> Vec<[f64; 2]> {
        let patches = transport.patches().enumerate();
        let floor = patches.filter(|(_, (_, p, n))| p.y == 0.0 && n.y > 0.0);
        let shares = floor.map(|(i, (_, place, normal))| {
            let row = transport.form_factors(i).into_iter();
            let found = row.filter(|(source, ..)| high(source));
            let found = found.map(|(_, share, _)| f64::from(share)).sum();
            [found, form_factor(&at(place, normal), &rim)]
        });
        shares.collect()
    };
    let alone = shares(&by_cpu(&conditions, detail));
    assert!(alone.len() >= 16, "{}", alone.len());
    let texel = 4.0 / (PI * 32.0 * 32.0);
    for [found, truth] in &alone {
        assert!(*truth < 0.03 * texel, "{truth}");
        assert!(*found == 0.0 || *found > 0.5 * texel, "{found} {texel}");
    }
    let missed = alone.iter().filter(|[found, _]| *found == 0.0).count();
    assert!(missed > alone.len() / 2, "{missed}");
    // Openings are looked for from points of patches whatever finds the rest of a row; they have no more than they are.
    let with_openings = Detail {
        patch_spots: 10_000,
        ..detail
    };
    let found = shares(&by_cpu(&conditions, with_openings));
    let [found, truth] = [0, 1].map(|k| found.iter().map(|pair| pair[k]).sum::<f64>());
    eprintln!(
        "{missed} of {} patches miss it; with openings {found:.6} of {truth:.6}",
        alone.len()
    );
    assert!((0.0..1.2 * truth).contains(&found), "{found} {truth}");
}
