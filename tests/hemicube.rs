//! Form factors by hemicubes, found by rays of the CPU and drawn by the GPU: against closed forms, and against each other.

mod common;

use common::build::{material, quad};
use common::receive::*;
use common::rooms::{Opening, Shell, panel, plan};
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};
use tyndall::backend::Wanted;
use tyndall::backend::gpu::{Choice, Device, Hemicubes};
use tyndall::conditions::{Conditions, Receiver};
use tyndall::medium::{Phase, Shape};
use tyndall::radiosity::{Care, Detail, Drawer, Light, Source, Transport};
use tyndall::scene::{AlphaMode, Material, Scene, Texture, Wrap};
use tyndall::studies::scenes::{Corners, cuboid, fog};

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
    Transport::new(conditions, detail, None)
}

fn by_gpu(conditions: &Conditions, detail: Detail) -> Transport {
    let transport = Transport::new(conditions, detail, Some(drawer() as &dyn Drawer));
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

/// The most that what any patch sends, or what arrives of it, is apart in two transports: the sum over all where it goes.
fn apart(one: &Transport, other: &Transport) -> f64 {
    let count = one.patches().count();
    assert_eq!(count, other.patches().count());
    let mut worst = 0.0f64;
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
        worst = worst.max(off);
    }
    worst
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
        for (side, allowed) in [(8, 0.08), (32, 0.02), (128, 0.006)] {
            let found = by_cpu(&conditions, detail(side, 0.1));
            let sent = share(
                &found,
                |p, n| upward(p, n) && p.y < 0.5,
                |_, n| n.dot(normal) > 0.9,
            );
            eprintln!(
                "{name}, {side}: {sent:.6}, exact {exact}, {} patches",
                found.patches().count()
            );
            off.near(&format!("{name}, {side}"), &[sent], &[exact], allowed);
        }
        // Where patches are coarse their middles speak for too much; several points of each do not.
        let spots = Detail {
            hemicube_spots: 16,
            ..detail(64, 0.5)
        };
        for (what, detail) in [("middles", detail(64, 0.5)), ("16 spots", spots)] {
            let found = by_cpu(&conditions, detail);
            let sent = share(
                &found,
                |p, n| upward(p, n) && p.y < 0.5,
                |_, n| n.dot(normal) > 0.9,
            );
            eprintln!("{name}, coarse patches, {what}: {sent:.6}");
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
            off.note(&format!("{name}, {side}"), apart(&cpu, &gpu), 1e-6);
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
        *uv = [DVec2::ZERO, DVec2::X, DVec2::Y][i % 3];
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
            off.note(
                &format!("{name}, by the GPU"),
                apart(&cpu, &by_gpu(&conditions, detail)),
                1e-6,
            );
        }
    }
    off.end();
}

#[test]
fn no_light_leaks_where_walls_meet() {
    let gpu = common::gpu("no_light_leaks_where_walls_meet");
    // Two white rooms wall to wall under an open sky, of which one is closed; its walls do not meet at their corners, a wall's foot
    // and its top lie within the other's.
    let mut parts = Surfaces::new();
    let walls = |x: f64, z: f64| {
        let corner = dvec3(x, 0.0, z);
        [
            quad(corner, DVec3::X * 3.0, DVec3::Z * 3.0),
            quad(corner, DVec3::X * 3.0, DVec3::Y * 2.5),
            quad(corner + DVec3::Z * 3.0, DVec3::X * 3.0, DVec3::Y * 2.5),
            quad(corner, DVec3::Z * 3.0, DVec3::Y * 2.5),
            quad(corner + DVec3::X * 3.0, DVec3::Z * 3.0, DVec3::Y * 2.5),
        ]
        .concat()
    };
    parts.extend(grey(walls(0.0, -3.0), 0.9));
    parts.extend(grey(walls(3.0, -3.7), 0.9));
    parts.extend(grey(
        quad(dvec3(2.9, 2.5, -3.9), DVec3::X * 3.3, DVec3::Z * 3.4),
        0.9,
    ));
    let conditions = seen(outside(surfaces(&parts)));
    let inside = |p: &DVec3| {
        let low = dvec3(3.0, 0.0, -3.7) - 1e-9;
        p.cmpge(low).all() && p.cmple(dvec3(6.0, 2.5, -0.7) + 1e-9).all()
    };
    for side in [8, 32, 64] {
        let mut all = vec![by_cpu(&conditions, detail(side, 0.1))];
        if gpu {
            all.push(by_gpu(&conditions, detail(side, 0.1)));
        }
        for transport in all {
            // From inside the closed room nothing goes out; a patch inside is one whose normal points to the middle.
            let middle = dvec3(4.5, 1.25, -2.2);
            let patches: Vec<_> = transport.patches().collect();
            let in_room = |i: usize| {
                let (_, p, n) = patches[i];
                inside(&p) && n.dot(middle - p) > 0.0
            };
            for i in 0..patches.len() {
                for (source, share, _) in transport.form_factors(i) {
                    let goes_in = matches!(source, Source::Patch(j, _) if in_room(j as usize));
                    assert_eq!(
                        in_room(i),
                        goes_in,
                        "{side}: {i} at {} to {source:?}, {share}",
                        patches[i].1
                    );
                }
            }
            let light = Light::new(&transport, &conditions, 1e-4);
            for i in (0..patches.len()).filter(|i| in_room(*i)) {
                let source = Source::Patch(i as u32, tyndall::radiosity::Tile::WHOLE);
                assert_eq!(
                    light.radiance(source),
                    DVec3::ZERO,
                    "{side}: {}",
                    patches[i].1
                );
            }
        }
    }
}

#[test]
fn energy_is_accounted_for_and_a_white_world_is_white() {
    let mut off = Deviations::default();
    // Where nothing absorbs, everything has the sky's radiance.
    let mut white = study();
    white
        .iter_mut()
        .for_each(|(_, reflectance)| *reflectance = 1.0);
    let world = ground(sky(surfaces(&white), "uniform:5000"), -0.2, 1.0);
    let points: Vec<Receiver> = [
        at(dvec3(2.0, 0.8, -4.5), DVec3::Y),
        at(dvec3(0.4, 2.0, -4.5), DVec3::X),
        at(dvec3(3.5, 2.9, -0.2), DVec3::NEG_Y),
        at(dvec3(2.0, 1.5, 1.0), DVec3::NEG_Z),
    ]
    .to_vec();
    let set: Settings = &[
        ("radiosity.hemicube", 32.0),
        ("radiosity.patch", 0.125),
        ("radiosity.patches", 4000.0),
        ("radiosity.patch_spots", 500.0),
    ];
    for backend in [Wanted::Reference, Wanted::Gpu] {
        if backend == Wanted::Gpu
            && !common::gpu("energy_is_accounted_for_and_a_white_world_is_white")
        {
            continue;
        }
        let total = received_by(&conditions(world.clone(), &points), backend, set).total();
        off.near("white", &y(&total), &[5000.0 * PI; 4], 0.01);
    }
    for (name, scene) in [("study", outside(surfaces(&study()))), ("white", world)] {
        let conditions = seen(scene);
        let transport = by_cpu(&conditions, detail(32, 0.2));
        let whole = |i: usize| -> f64 {
            let row = transport.form_factors(i).into_iter();
            row.map(|(_, share, _)| f64::from(share)).sum()
        };
        for i in 0..transport.patches().count() {
            let whole = whole(i);
            assert!(
                whole == 0.0 || (whole - 1.0).abs() < 1e-4,
                "{name}: {i} {whole}"
            );
        }
        let account = Light::new(&transport, &conditions, 1e-4).account;
        let gone = account.absorbed + account.escaped + account.taken + account.unshot;
        off.note(
            &format!("{name}: the account"),
            (gone.y / account.received.y - 1.0).abs(),
            1e-3,
        );
    }
    off.end();
}
