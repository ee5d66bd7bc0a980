//! The nave: seven bays of a small pointed-arch church with aisles, open to the west, a rose window in the east.
//!
//! Metres; the nave runs along Z from the west front at 0 to the east wall at -35, +X is south. Walls are closed solids:
//! light comes through windows and the west portal alone.

use super::mesh::{Frame, Mesh, Outline};
use super::texture::noise;
use glam::{DVec2, DVec3, dvec2, dvec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Materials by number; [`super::MATERIALS`] says what they are.
pub mod material {
    pub const STONE: usize = 0;
    pub const VAULT: usize = 1;
    pub const FLOOR: usize = 2;
    pub const WOOD: usize = 3;
    pub const ROOF: usize = 4;
    pub const CLOTH: usize = 5;
}
use material::*;

pub const BAYS: usize = 7;
/// Length of a bay.
pub const BAY: f64 = 5.0;
const LENGTH: f64 = BAY * BAYS as f64;
/// Half the nave's width between the arcade walls.
const NAVE: f64 = 4.5;
/// Thickness of walls.
const WALL: f64 = 1.2;
/// Thickness of the clerestory's wall, above the aisle's roof.
const CLERESTORY: f64 = 0.6;
const LEDGE: f64 = 8.2;
/// The aisles' outer walls, inner face.
const AISLE: f64 = 9.0;
/// Tops of the capitals: arcade arches and aisle vaults spring here.
const CAPITAL: f64 = 4.6;
/// Where the nave's vault springs, and its rise.
const SPRING: f64 = 9.8;
const RISE: f64 = 5.2;
const EAVES: f64 = 16.6;
const AISLE_EAVES: f64 = 7.3;
const FOOTING: f64 = -0.2;

/// Facets of a pillar.
const ROUND: usize = 16;

const WHITE: DVec3 = DVec3::ONE;

/// A stone's own tint: a little lighter or darker, warmer or cooler.
fn tint(a: usize, b: usize) -> DVec3 {
    let (light, warm) = (noise(a, b, 21) - 0.5, noise(a, b, 22) - 0.5);
    DVec3::splat(0.9 + 0.14 * light) + dvec3(0.03, 0.0, -0.04) * warm
}

/// Both long sides: frames with `x` along the nave (toward the west) and `depth` outward.
fn sides(distance: f64) -> [Frame; 2] {
    [1.0, -1.0].map(|side| Frame {
        origin: dvec3(side * distance, 0.0, 0.0),
        x: DVec3::Z,
        depth: dvec3(side, 0.0, 0.0),
    })
}

/// One bay from -BAY/2 to BAY/2 along Z: arcade, clerestory, aisles, vaults, roofs.
pub fn bay() -> Mesh {
    let mut mesh = Mesh::of(STONE);
    let half = BAY / 2.0;
    for frame in sides(NAVE) {
        arcade_and_clerestory(&mut mesh, frame, half);
    }
    for frame in sides(AISLE) {
        aisle_wall(&mut mesh, frame, half);
    }
    vault(&mut mesh, 0.0, NAVE, SPRING, RISE, 0.13);
    for side in [1.0, -1.0] {
        let middle = side * (NAVE + WALL + AISLE) / 2.0;
        vault(
            &mut mesh,
            middle,
            (AISLE - NAVE - WALL) / 2.0,
            CAPITAL,
            2.3,
            0.08,
        );
    }
    // Roofs keep the light out above the vaults.
    mesh.material = ROOF;
    for side in [1.0, -1.0] {
        for (inner, outer) in [
            (
                dvec2(0.0, 20.3),
                dvec2(NAVE + CLERESTORY + 0.4, EAVES - 0.3),
            ),
            (
                dvec2(NAVE + WALL - 0.02, 8.15),
                dvec2(AISLE + WALL + 0.3, AISLE_EAVES - 0.05),
            ),
        ] {
            let corner = |p: DVec2, z: f64| dvec3(side * p.x, p.y, z);
            let corners = [
                corner(inner, half),
                corner(outer, half),
                corner(outer, -half),
                corner(inner, -half),
            ];
            let uvs = corners.map(|p| dvec2(p.z, p.x));
            mesh.quad_toward(corners, uvs, DVec3::Y);
        }
    }
    mesh
}

fn arcade_and_clerestory(mesh: &mut Mesh, frame: Frame, half: f64) {
    mesh.material = STONE;
    mesh.color = WHITE;
    let arch = |w: f64| Outline::arch(0.0, w, CAPITAL, CAPITAL, 0.45, 6);
    let (inner_order, outer_order) = (arch(1.72), arch(2.0));
    let window = |w: f64, sill: f64| Outline::arch(0.0, w, sill, 11.3, 0.3, 4);
    let (splay, light) = (window(0.95, 9.2), window(0.55, 10.1));
    let wall = Outline::rectangle(-half, half, CAPITAL, EAVES);
    frame.sheet(mesh, &wall, &[&outer_order, &splay], 0.0, -1.0);
    // Above the aisle's roof the wall is thinner.
    let (low, high) = (
        Outline::rectangle(-half, half, CAPITAL, LEDGE),
        Outline::rectangle(-half, half, LEDGE, EAVES),
    );
    frame.sheet(mesh, &low, &[&outer_order], WALL, 1.0);
    frame.sheet(mesh, &high, &[&light], CLERESTORY, 1.0);
    let ledge = [
        (-half, CLERESTORY),
        (half, CLERESTORY),
        (half, WALL),
        (-half, WALL),
    ]
    .map(|(x, depth)| frame.at(dvec2(x, LEDGE), depth));
    mesh.quad_toward(ledge, ledge.map(|p| dvec2(p.x, p.z)), DVec3::Y);
    // Arch in two orders.
    for (front, back, outward) in [(0.0, 0.3, -1.0), (WALL, WALL - 0.3, 1.0)] {
        let ring_wall =
            |mesh: &mut Mesh| frame.reveal(mesh, (&outer_order, front), (&outer_order, back));
        ring_wall(mesh);
        mesh.color = DVec3::splat(0.93);
        frame.sheet(mesh, &outer_order, &[&inner_order], back, outward);
        mesh.color = WHITE;
    }
    frame.reveal(mesh, (&inner_order, 0.3), (&inner_order, WALL - 0.3));
    // The wall's underside on the capitals.
    for (from, to) in [(-half, -1.72), (1.72, half)] {
        let corners = [
            dvec2(from, 0.0),
            dvec2(to, 0.0),
            dvec2(to, WALL),
            dvec2(from, WALL),
        ]
        .map(|p| frame.at(dvec2(p.x, CAPITAL), p.y));
        mesh.quad_toward(corners, corners.map(|p| dvec2(p.x, p.z)), DVec3::NEG_Y);
    }
    // The clerestory's lancet, splayed inside: narrow, so that its beam stands apart from the next.
    frame.reveal(mesh, (&splay, 0.0), (&light, CLERESTORY - 0.12));
    frame.reveal(mesh, (&light, CLERESTORY - 0.12), (&light, CLERESTORY));
    mesh.color = WHITE;
    // String course below the windows, and a label mould over the arch.
    let course = [
        (0.0, 7.35),
        (0.13, 7.35),
        (0.13, 7.5),
        (0.2, 7.5),
        (0.2, 7.65),
        (0.0, 7.65),
    ];
    moulding(mesh, frame, half, &course);
    let label = arch(2.12).around();
    let curve: Vec<DVec3> = label[2..].iter().map(|&p| frame.at(p, 0.0)).collect();
    let section = [
        dvec2(-0.07, 0.0),
        dvec2(-0.06, 0.09),
        dvec2(0.06, 0.09),
        dvec2(0.07, 0.0),
    ];
    mesh.sweep(&curve, -frame.depth, &section);
}

/// Two lancets and an eye, 0.18 m deep; nobody sees the back.
fn tracery(
    mesh: &mut Mesh,
    frame: Frame,
    light: &Outline,
    sill: f64,
    spring: f64,
    w: f64,
    depth: f64,
) {
    let lancet = |side: f64| {
        let pointed = 0.2 * w;
        Outline::arch(
            side * 0.5 * w,
            0.41 * w,
            sill + 0.1,
            spring - 0.15 * w,
            pointed,
            3,
        )
    };
    let eye = Outline::circle(dvec2(0.0, spring + 0.68 * w), 0.37 * w, 6);
    let (left, right) = (lancet(-1.0), lancet(1.0));
    frame.sheet(mesh, light, &[&left, &right, &eye], depth, -1.0);
    for hole in [&left, &right, &eye] {
        frame.reveal(mesh, (hole, depth), (hole, depth + 0.18));
    }
}

fn aisle_wall(mesh: &mut Mesh, frame: Frame, half: f64) {
    mesh.material = STONE;
    mesh.color = DVec3::splat(0.97);
    let window = |w: f64, sill: f64| Outline::arch(0.0, w, sill, 4.75, 0.5, 4);
    let (splay, light) = (window(1.3, 1.8), window(1.0, 2.3));
    let wall = Outline::rectangle(-half, half, FOOTING, AISLE_EAVES);
    frame.sheet(mesh, &wall, &[&splay], 0.0, -1.0);
    frame.sheet(mesh, &wall, &[&light], WALL, 1.0);
    frame.reveal(mesh, (&splay, 0.0), (&light, 0.6));
    frame.reveal(mesh, (&light, 0.6), (&light, WALL));
    tracery(mesh, frame, &light, 2.3, 4.75, 1.0, 0.65);
    // A stone bench runs along the wall.
    mesh.color = DVec3::splat(0.9);
    moulding(mesh, frame, half, &[(0.4, 0.0), (0.4, 0.45), (0.0, 0.45)]);
}

/// A bar along a wall; `profile` is (out of the wall, height), from below.
fn moulding(mesh: &mut Mesh, frame: Frame, half: f64, profile: &[(f64, f64)]) {
    for pair in profile.windows(2) {
        let [(p, low), (q, high)] = [pair[0], pair[1]];
        let corners = [
            (-half, low, p),
            (half, low, p),
            (half, high, q),
            (-half, high, q),
        ]
        .map(|(x, y, out)| frame.at(dvec2(x, y), -out));
        let uvs = corners.map(|c| dvec2(c.z, -c.y - c.x.abs()));
        mesh.quad_toward(
            corners,
            uvs,
            frame.depth * (low - high) + DVec3::Y * (p - q),
        );
    }
}

/// Height of a pointed arch over -1 to 1, from 0 at its ends to 1 in the middle.
fn profile(t: f64) -> f64 {
    let k = 0.5;
    let square = (1.0 + k) * (1.0 + k) - (t.abs() + k) * (t.abs() + k);
    (square.max(0.0) / (1.0 + 2.0 * k)).sqrt()
}

/// Places along -1 to 1 that follow the arch at even angles.
fn stations(steps: usize) -> Vec<f64> {
    let first = (0.5f64 / 1.5).asin();
    let half: Vec<f64> = (0..=steps)
        .map(|i| 1.5 * (first + (FRAC_PI_2 - first) * i as f64 / steps as f64).sin() - 0.5)
        .map(|t| if t < 1e-12 { 0.0 } else { t })
        .collect();
    half.iter()
        .rev()
        .map(|t| -t)
        .chain(half[1..].iter().copied())
        .collect()
}

/// A groin vault over a bay, with ribs along its groins and across the bay's western end.
fn vault(mesh: &mut Mesh, middle: f64, width: f64, spring: f64, rise: f64, rib: f64) {
    let (steps, facets) = if width > 3.0 { (5, 4) } else { (3, 3) };
    let stations = stations(steps);
    let at = |s: f64, t: f64| {
        dvec3(
            middle + width * s,
            spring + rise * profile(s).max(profile(t)),
            BAY / 2.0 * t,
        )
    };
    mesh.material = VAULT;
    mesh.color = WHITE;
    for s in stations.windows(2) {
        for t in stations.windows(2) {
            let corners = [(s[0], t[0]), (s[1], t[0]), (s[1], t[1]), (s[0], t[1])];
            // Cells on a groin are cut along it.
            let order = if (s[0] + s[1]) * (t[0] + t[1]) > 0.0 {
                [0, 1, 2, 3]
            } else {
                [1, 2, 3, 0]
            };
            let [a, b, c, d] = order.map(|k| corners[k]);
            for web in [[a, b, c], [a, c, d]] {
                let (s, t) = web
                    .iter()
                    .fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
                // Courses of stone run along each web's own axis.
                let uv = |(u, v): (f64, f64)| {
                    if s.abs() < t.abs() {
                        dvec2(width * u, 1.3 * BAY / 2.0 * t.signum() * (1.0 - profile(v)))
                    } else {
                        dvec2(BAY / 2.0 * v, 1.3 * width * s.signum() * (1.0 - profile(u)))
                    }
                };
                let mut corners = web;
                let normal = |w: [(f64, f64); 3]| {
                    let [a, b, c] = w.map(|(s, t)| at(s, t));
                    (b - a).cross(c - a)
                };
                if normal(corners).y > 0.0 {
                    corners.reverse();
                }
                mesh.polygon_with(&corners.map(|(s, t)| at(s, t)), &corners.map(uv));
            }
        }
    }
    mesh.material = STONE;
    mesh.color = DVec3::splat(0.92);
    let round: Vec<DVec2> = (0..=facets)
        .map(|i| PI * f64::from(i) / f64::from(facets))
        .map(|angle| rib * dvec2(-1.4 * angle.sin(), angle.cos()))
        .collect();
    for sign in [1.0, -1.0] {
        let curve: Vec<DVec3> = stations.iter().map(|&s| at(s, sign * s)).collect();
        let across = dvec3(BAY / 2.0, 0.0, -sign * width).normalize();
        mesh.sweep(&curve, flipped(&curve, across), &round);
    }
    // The transverse arch: a flat band with chamfered edges.
    let (w, d) = (2.3 * rib, 2.6 * rib);
    let band = [
        dvec2(0.05, -w),
        dvec2(-0.6 * d, -w),
        dvec2(-d, -0.6 * w),
        dvec2(-d, 0.6 * w),
        dvec2(-0.6 * d, w),
        dvec2(0.05, w),
    ];
    let curve: Vec<DVec3> = stations.iter().map(|&s| at(s, 1.0)).collect();
    mesh.sweep(&curve, flipped(&curve, DVec3::Z), &band);
    if rib > 0.1 {
        // A boss where the groins meet; the aisles' are too small to be seen.
        let crown = dvec3(middle, spring + rise - 2.6 * rib, 0.0);
        mesh.lathe(
            crown,
            &[
                dvec2(0.0, 0.0),
                dvec2(1.2 * rib, 0.1 * rib),
                dvec2(2.2 * rib, 2.6 * rib),
            ],
            8,
        );
    }
}

/// `binormal`, or its opposite, such that the normal of [`Mesh::sweep`] points up, out of the vault.
fn flipped(curve: &[DVec3], binormal: DVec3) -> DVec3 {
    let middle = curve.len() / 2;
    let tangent = curve[middle + 1] - curve[middle - 1];
    if binormal.cross(tangent).y > 0.0 {
        binormal
    } else {
        -binormal
    }
}

/// What stands on the line between two bays, both sides: pillar, shafts up the wall, respond in the aisle.
pub fn pillars() -> Mesh {
    let mut mesh = Mesh::of(STONE);
    for side in [1.0, -1.0] {
        // Angles that face the nave, and those that face the aisle's window.
        let nave = if side > 0.0 {
            [FRAC_PI_2, 3.0 * FRAC_PI_2]
        } else {
            [-FRAC_PI_2, FRAC_PI_2]
        };

        let foot = dvec3(side * (NAVE + WALL / 2.0), 0.0, 0.0);
        mesh.color = DVec3::splat(0.88);
        mesh.block(
            foot + dvec3(-0.82, FOOTING, -0.82),
            foot + dvec3(0.82, 0.22, 0.82),
        );
        mesh.color = DVec3::splat(0.95);
        let mut base = vec![dvec2(0.78, 0.22)];
        base.extend([dvec2(0.79, 0.32), dvec2(0.7, 0.41)]);
        base.extend([dvec2(0.58, 0.46), dvec2(0.6, 0.54), dvec2(0.52, 0.64)]);
        mesh.lathe(foot, &base, ROUND);
        // Drums, each a stone of its own.
        for (i, drum) in [0.64, 1.66, 2.7, 3.62].windows(2).enumerate() {
            mesh.color = tint(i, if side > 0.0 { 1 } else { 2 });
            let ring = |y: f64| dvec2(0.52 - 0.03 * (y - 0.64) / 3.0, y);
            mesh.lathe(foot, &[ring(drum[0]), ring(drum[1])], ROUND);
        }
        capital(
            &mut mesh,
            foot,
            [3.62, CAPITAL],
            [0.49, 0.8],
            [0.0, TAU],
            ROUND,
        );

        // Three shafts from the capital up to the vault.
        let wall = dvec3(side * NAVE, 0.0, 0.0);
        for (z, out, radius, segments) in [
            (0.0, 0.1, 0.17, 6),
            (0.27, 0.02, 0.11, 4),
            (-0.27, 0.02, 0.11, 4),
        ] {
            mesh.color = tint(7, segments);
            let line = [
                dvec2(radius + 0.09, CAPITAL),
                dvec2(radius + 0.09, CAPITAL + 0.12),
                dvec2(radius, CAPITAL + 0.2),
                dvec2(radius, 9.2),
                dvec2(radius + 0.03, 9.26),
                dvec2(radius + 0.01, 9.34),
                dvec2(radius + 0.06, 9.55),
                dvec2(radius + 0.17, SPRING - 0.08),
            ];
            let foot = wall + dvec3(-side * out, 0.0, z);
            mesh.turned(foot, nave, segments, line.len(), |row, _| line[row]);
        }
        mesh.color = DVec3::splat(0.9);
        let slab = [
            wall + dvec3(-side * 0.42, SPRING - 0.08, -0.52),
            wall + dvec3(side * 0.1, SPRING + 0.06, 0.52),
        ];
        mesh.block(slab[0].min(slab[1]), slab[0].max(slab[1]));

        // The respond: a half shaft on the aisle's wall.
        let foot = dvec3(side * AISLE, 0.0, 0.0);
        mesh.color = DVec3::splat(0.9);
        mesh.block(
            foot + dvec3(-0.46, FOOTING, -0.46),
            foot + dvec3(0.46, 0.6, 0.46),
        );
        mesh.color = tint(9, 9);
        let line = [
            dvec2(0.38, 0.6),
            dvec2(0.38, 0.72),
            dvec2(0.3, 0.8),
            dvec2(0.29, 3.85),
        ];
        mesh.turned(foot, nave, 7, line.len(), |row, _| line[row]);
        capital(&mut mesh, foot, [3.85, CAPITAL], [0.29, 0.46], nave, 8);
    }
    mesh
}

/// A bell from a round shaft to a square slab, with leaves at the corners.
fn capital(
    mesh: &mut Mesh,
    foot: DVec3,
    [from, to]: [f64; 2],
    [radius, half]: [f64; 2],
    arc: [f64; 2],
    segments: usize,
) {
    mesh.color = DVec3::splat(0.98);
    let slab = 0.2 * (to - from) + 0.04;
    // Share of the way up and of the way out; first the ring at the neck.
    let rows = [
        (0.0, 0.0),
        (0.03, 0.17),
        (0.1, 0.17),
        (0.13, 0.0),
        (0.4, 0.1),
        (0.7, 0.4),
        (1.0, 1.0),
    ];
    mesh.turned(foot, arc, segments, rows.len(), |row, angle| {
        let (up, out) = rows[row];
        // Distance to a rounded square in this direction.
        let (c, s) = (angle.cos().abs(), angle.sin().abs());
        let square = if row < 4 {
            half
        } else {
            0.96 * half / (c.powi(8) + s.powi(8)).powf(0.125)
        };
        let leaf = if row < 4 {
            0.0
        } else {
            0.1 * half * (8.0 * angle).cos() * (PI * up).sin()
        };
        dvec2(
            radius + (square - radius) * out + leaf,
            from + (to - slab - from) * up,
        )
    });
    mesh.color = DVec3::splat(0.92);
    mesh.block(
        foot + dvec3(-half, to - slab, -half),
        foot + dvec3(half, to - 0.06, half),
    );
    mesh.block(
        foot + dvec3(-half - 0.05, to - 0.06, -half - 0.05),
        foot + dvec3(half + 0.05, to, half + 0.05),
    );
}

/// The ends: east wall with lancets and rose, west wall with the open portal, gables.
pub fn ends() -> Mesh {
    let mut mesh = Mesh::of(STONE);
    let breadth = AISLE + WALL;
    let wall = Outline::rectangle(-breadth, breadth, FOOTING, EAVES);

    let east = Frame {
        origin: dvec3(0.0, 0.0, -LENGTH),
        x: DVec3::X,
        depth: DVec3::NEG_Z,
    };
    let lancet = |middle: f64, w: f64, sill: f64, spring: f64| {
        Outline::arch(middle, w, sill, spring, 0.8, 7)
    };
    let rose_at = dvec2(0.0, 11.35);
    let mut holes = Vec::new();
    for (middle, spring) in [(-2.35, 6.1), (0.0, 6.7), (2.35, 6.1)] {
        holes.push((
            lancet(middle, 0.95, 2.7, spring),
            lancet(middle, 0.72, 3.1, spring),
        ));
    }
    for middle in [-7.35, 7.35] {
        holes.push((
            lancet(middle, 1.0, 1.7, 4.2),
            lancet(middle, 0.75, 2.1, 4.2),
        ));
    }
    holes.push((
        Outline::circle(rose_at, 2.6, 16),
        Outline::circle(rose_at, 2.3, 16),
    ));
    let (inner, outer): (Vec<&Outline>, Vec<&Outline>) = holes.iter().map(|(a, b)| (a, b)).unzip();
    east.sheet(&mut mesh, &wall, &inner, 0.0, -1.0);
    east.sheet(&mut mesh, &wall, &outer, WALL, 1.0);
    for (inner, outer) in &holes {
        east.reveal(&mut mesh, (inner, 0.0), (outer, 0.55));
        east.reveal(&mut mesh, (outer, 0.55), (outer, WALL));
    }
    // The rose: an eye, eight petals, eight sparks.
    let mut petals = vec![Outline::circle(rose_at, 0.52, 8)];
    for k in 0..8 {
        let toward = |angle: f64| dvec2(angle.cos(), angle.sin());
        let angle = TAU * (f64::from(k) + 0.5) / 8.0;
        petals.push(Outline::circle(rose_at + 1.3 * toward(angle), 0.46, 6));
        petals.push(Outline::circle(
            rose_at + 1.93 * toward(angle + TAU / 16.0),
            0.24,
            4,
        ));
    }
    let petals: Vec<&Outline> = petals.iter().collect();
    mesh.color = DVec3::splat(0.95);
    east.sheet(&mut mesh, &holes[5].1, &petals, 0.6, -1.0);
    for petal in petals {
        east.reveal(&mut mesh, (petal, 0.6), (petal, 0.82));
    }

    let west = Frame {
        origin: DVec3::ZERO,
        x: DVec3::X,
        depth: DVec3::Z,
    };
    mesh.color = WHITE;
    let portal = Outline::arch(0.0, 2.8, FOOTING, 6.2, 1.4, 6);
    west.plate(&mut mesh, &wall, &[&portal], 0.0, WALL);

    for (frame, depth) in [(east, WALL), (west, WALL)] {
        let corners = [
            dvec2(-NAVE - WALL, EAVES),
            dvec2(NAVE + WALL, EAVES),
            dvec2(0.0, 20.3),
        ]
        .map(|p| frame.at(p, depth - 0.3));
        mesh.polygon(&corners);
    }
    // Steps and altar in the last bay but one.
    mesh.material = FLOOR;
    for step in 0..3 {
        let inset = 0.38 * f64::from(step);
        mesh.color = DVec3::splat(0.97);
        mesh.block(
            dvec3(-4.0 + inset, FOOTING, -LENGTH),
            dvec3(4.0 - inset, 0.16 * f64::from(step + 1), -27.0 - inset),
        );
    }
    mesh.material = STONE;
    mesh.color = DVec3::ONE;
    mesh.block(dvec3(-1.1, 0.4, -31.6), dvec3(1.1, 1.4, -30.8));
    mesh.block(dvec3(-1.3, 1.4, -31.75), dvec3(1.3, 1.52, -30.65));
    mesh
}

/// The floor, a slab under everything.
pub fn floor() -> Mesh {
    let mut mesh = Mesh::of(FLOOR);
    let breadth = AISLE + WALL;
    for i in 0..BAYS {
        let east = if i + 1 == BAYS {
            -LENGTH - WALL
        } else {
            -BAY * (i + 1) as f64
        };
        let west = if i == 0 { WALL } else { -BAY * i as f64 };
        for (from, to) in [
            (-breadth, -NAVE),
            (-NAVE, 0.0),
            (0.0, NAVE),
            (NAVE, breadth),
        ] {
            mesh.polygon(&[
                dvec3(from, 0.0, west),
                dvec3(to, 0.0, west),
                dvec3(to, 0.0, east),
                dvec3(from, 0.0, east),
            ]);
        }
    }
    mesh
}

/// A bench of 2.5 m, looking east.
pub fn bench() -> Mesh {
    let mut mesh = Mesh::of(WOOD);
    for side in [-1.0, 1.0] {
        mesh.color = DVec3::splat(0.85);
        let x = side * 1.22;
        mesh.block(dvec3(x - 0.03, 0.0, -0.24), dvec3(x + 0.03, 0.42, 0.22));
        mesh.block(dvec3(x - 0.03, 0.42, 0.12), dvec3(x + 0.03, 0.98, 0.22));
    }
    mesh.color = WHITE;
    mesh.block(dvec3(-1.19, 0.4, -0.22), dvec3(1.19, 0.44, 0.2));
    mesh.block(dvec3(-1.19, 0.56, 0.15), dvec3(1.19, 0.92, 0.18));
    mesh.block(dvec3(-1.25, 0.92, 0.09), dvec3(1.25, 0.96, 0.23));
    mesh
}

/// Someone in a long coat, 1.72 m tall.
pub fn figure() -> Mesh {
    let mut mesh = Mesh::of(CLOTH);
    let coat = [
        (0.27, 0.03),
        (0.25, 0.2),
        (0.215, 0.6),
        (0.19, 0.95),
        (0.185, 1.1),
        (0.21, 1.3),
        (0.2, 1.4),
        (0.12, 1.47),
        (0.06, 1.5),
    ];
    let narrow = |angle: f64| 1.0 - 0.32 * angle.sin().powi(2);
    mesh.turned(DVec3::ZERO, [0.0, TAU], 12, coat.len(), |row, angle| {
        let fold = 1.0 + 0.05 * (7.0 * angle).sin() * (1.0 - coat[row].1 / 1.5);
        dvec2(coat[row].0 * narrow(angle) * fold, coat[row].1)
    });
    mesh.color = dvec3(1.0, 0.8, 0.65) * 0.9;
    let head: Vec<DVec2> = (0..=5)
        .map(|i| -FRAC_PI_2 + PI * f64::from(i) / 5.0)
        .map(|angle| dvec2(0.095 * angle.cos(), 1.6 + 0.125 * angle.sin()))
        .collect();
    mesh.lathe(DVec3::ZERO, &head, 10);
    mesh
}
