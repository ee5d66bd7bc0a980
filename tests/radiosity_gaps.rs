//! Light through pinholes and slits: held to the form factors of what they leave open, and to what comes through them.

mod common;

use common::build::{cuboid, quad};
use common::receive::*;
use common::rooms::{Room, WEATHER, panel};
use common::weather::{ULM, made_up};
use glam::{DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::backend::Wanted;
use tyndall::conditions::Receiver;
use tyndall::daylight::hours::{Hour, Hours};
use tyndall::daylight::year::{self, Fineness, Year};
use tyndall::plan::Quality;
use tyndall::scene::Scene;
use tyndall::studies::scenes::Corners;
use tyndall::task::Task;

/// Luminance of the sky [cd/m2].
const SKY: f64 = 5000.0;
const ALBEDO: f64 = 0.5;

/// What is allowed at a quality.
const QUALITIES: [(Quality, f64); 2] = [(Quality::High, 0.03), (Quality::Preview, 0.1)];

fn grey(triangles: impl IntoIterator<Item = Corners>) -> Vec<(Corners, f64)> {
    triangles.into_iter().map(|t| (t, ALBEDO)).collect()
}

/// A rectangle from a corner, with its sides.
type Side = (DVec3, DVec3, DVec3);

/// A room: its lid with holes (along, from, to; up, from, to), and its other sides.
struct Box {
    lid: Side,
    holes: Vec<[f64; 4]>,
    others: Vec<Side>,
}

impl Box {
    /// A cube of a size with holes in its roof.
    fn cube(size: f64, holes: &[[f64; 4]]) -> Self {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| size * axis);
        Box {
            lid: (y, x, z),
            holes: holes.to_vec(),
            others: vec![
                (DVec3::ZERO, x, z),
                (DVec3::ZERO, x, y),
                (z, x, y),
                (DVec3::ZERO, z, y),
                (x, z, y),
            ],
        }
    }

    fn surfaces(&self) -> Vec<(Corners, f64)> {
        let (corner, a, b) = self.lid;
        let size = [a, b].map(DVec3::length);
        let [along, up] = [a, b].map(DVec3::normalize);
        let mut parts = grey(panel(corner, along, up, size, &self.holes));
        for (corner, a, b) in &self.others {
            parts.extend(grey(quad(*corner, *a, *b)));
        }
        parts
    }

    fn scene(&self) -> Scene {
        sky(surfaces(&self.surfaces()), &format!("uniform:{SKY}"))
    }

    /// The holes' corners.
    fn rims(&self) -> Vec<[DVec3; 4]> {
        let (corner, a, b) = self.lid;
        let [along, up] = [a, b].map(DVec3::normalize);
        let rim = |h: &[f64; 4]| {
            let from = corner + h[0] * along + h[2] * up;
            rectangle(from, (h[1] - h[0]) * along, (h[3] - h[2]) * up)
        };
        self.holes.iter().map(rim).collect()
    }

    /// What a point receives straight from the sky [lx].
    fn truth(&self, point: &Receiver) -> f64 {
        let seen = self
            .rims()
            .iter()
            .map(|rim| form_factor(point, rim))
            .sum::<f64>();
        PI * SKY * seen
    }

    /// Notes by how much points are off.
    fn direct(&self, off: &mut Deviations, what: &str, points: &[Receiver]) {
        let conditions = conditions(self.scene(), points);
        let truth: Vec<f64> = points.iter().map(|point| self.truth(point)).collect();
        for (quality, allowed) in QUALITIES {
            let found = y(&received_at(quality, &conditions, Wanted::Reference, &[]).sky);
            eprintln!("{what}, {quality:?}: {found:.3?} lx of {truth:.3?}");
            off.near(&format!("{what}, {quality:?}"), &found, &truth, allowed);
        }
    }
}

fn up(places: &[[f64; 3]]) -> Vec<Receiver> {
    places
        .iter()
        .map(|p| at(DVec3::from_array(*p), DVec3::Y))
        .collect()
}

#[test]
fn a_pinhole_lights_what_sees_it() {
    let mut off = Deviations::default();
    let pinhole = Box::cube(2.0, &[[0.99, 1.01, 0.99, 1.01]]);
    let mut points = up(&[
        [1.0, 0.001, 1.0],
        [0.3, 0.001, 1.2],
        [1.9, 0.001, 0.1],
        [0.7, 1.5, 1.1],
    ]);
    points.push(at(dvec3(0.001, 0.8, 1.3), DVec3::X));
    pinhole.direct(&mut off, "2 cm in 2 m", &points);
    let smaller = Box::cube(4.0, &[[3.1, 3.105, 0.7, 0.705]]);
    smaller.direct(
        &mut off,
        "5 mm in 4 m",
        &up(&[[2.0, 0.5, 2.0], [3.9, 0.1, 0.2]]),
    );
    off.end();
}

#[test]
fn a_slit_lights_what_sees_it() {
    let mut off = Deviations::default();
    let slit = Box::cube(2.0, &[[0.5, 1.5, 0.8, 0.802]]);
    let points = up(&[[1.0, 0.001, 1.0], [0.2, 0.3, 1.7], [1.1, 1.6, 0.7]]);
    slit.direct(&mut off, "2 mm x 1 m", &points);
    let through = Box::cube(2.0, &[[0.0, 2.0, 0.8, 0.802]]);
    through.direct(&mut off, "from wall to wall", &points);
    let many: Vec<[f64; 4]> = (0..12)
        .map(f64::from)
        .map(|i| {
            [
                0.3 + 0.1 * i,
                0.31 + 0.1 * i,
                0.4 + 0.07 * i,
                0.41 + 0.07 * i,
            ]
        })
        .collect();
    Box::cube(2.0, &many).direct(&mut off, "a dozen of 1 cm", &points);
    off.end();
}

#[test]
fn a_pinhole_in_a_tilted_roof_lights_what_sees_it() {
    let mut off = Deviations::default();
    // A shed: 3 wide, 4 deep, its roof from 2 m up to 3.5.
    let [x, z] = [3.0 * DVec3::X, 4.0 * DVec3::Z];
    let rise = dvec3(3.0, 1.5, 0.0);
    let gable = |z: f64| {
        let [a, b] = [dvec3(0.0, 0.0, z), dvec3(3.0, 0.0, z)];
        let [c, d] = [b + 3.5 * DVec3::Y, a + 2.0 * DVec3::Y];
        [[a, b, c], [a, c, d]]
    };
    let shed = Box {
        lid: (2.0 * DVec3::Y, rise, z),
        holes: vec![[1.6, 1.62, 2.3, 2.31]],
        others: vec![
            (DVec3::ZERO, x, z),
            (DVec3::ZERO, z, 2.0 * DVec3::Y),
            (x, z, 3.5 * DVec3::Y),
        ],
    };
    let mut parts = shed.surfaces();
    parts.extend(grey([gable(0.0), gable(4.0)].concat()));
    let scene = sky(surfaces(&parts), &format!("uniform:{SKY}"));
    let points = up(&[[1.4, 0.8, 2.3], [2.5, 0.8, 0.6]]);
    let truth: Vec<f64> = points.iter().map(|point| shed.truth(point)).collect();
    for (quality, allowed) in QUALITIES {
        let conditions = conditions(scene.clone(), &points);
        let found = y(&received_at(quality, &conditions, Wanted::Reference, &[]).sky);
        eprintln!("{quality:?}: {found:.4?} lx of {truth:.4?}");
        off.near(&format!("{quality:?}"), &found, &truth, allowed);
    }
    off.end();
}

#[test]
fn a_thick_wall_cuts_off_what_comes_through_a_hole() {
    // A hole of 4 cm through a roof of 20 cm: from below one sees as much of the sky as the upper rim and the lower one leave.
    let (size, thick) = (2.0, 0.2);
    let hole = [0.98, 1.02, 0.98, 1.02];
    let cube = Box::cube(size, &[hole]);
    let above = Box {
        lid: ((size + thick) * DVec3::Y, size * DVec3::X, size * DVec3::Z),
        holes: vec![hole],
        others: Vec::new(),
    };
    let mut parts = cube.surfaces();
    parts.extend(above.surfaces());
    let [lower] = cube.rims()[..] else {
        panic!("there is one hole")
    };
    for k in 0..4 {
        let side = lower[(k + 1) % 4] - lower[k];
        parts.extend(grey(quad(lower[k], side, thick * DVec3::Y)));
    }
    let points = up(&[[1.0, 0.2, 1.0], [1.1, 0.2, 1.05]]);
    let truth = |point: &Receiver| {
        let mut seen = above.rims()[0].to_vec();
        let middle = lower.iter().sum::<DVec3>() / 4.0;
        for k in 0..4 {
            let (a, b) = (
                lower[k] - point.position,
                lower[(k + 1) % 4] - point.position,
            );
            let normal = a.cross(b);
            let inward = normal.dot(middle - point.position).signum() * normal;
            seen = clipped(&seen, point.position, inward);
        }
        PI * SKY * form_factor(point, &seen)
    };
    let truth: Vec<f64> = points.iter().map(truth).collect();
    let scene = sky(surfaces(&parts), &format!("uniform:{SKY}"));
    let mut off = Deviations::default();
    for (quality, allowed) in QUALITIES {
        let conditions = conditions(scene.clone(), &points);
        let found = y(&received_at(quality, &conditions, Wanted::Reference, &[]).sky);
        eprintln!("{quality:?}: {found:.4?} lx of {truth:.4?}");
        off.near(&format!("{quality:?}"), &found, &truth, allowed);
    }
    off.end();
}

#[test]
fn what_comes_through_a_pinhole_is_absorbed() {
    let mut off = Deviations::default();
    for (what, size, hole) in [
        ("2 cm in 2 m", 2.0, [0.99, 1.01, 0.99, 1.01]),
        ("2 mm x 1 m in 2 m", 2.0, [0.5, 1.5, 0.8, 0.802]),
    ] {
        let cube = Box::cube(size, &[hole]);
        // What enters is absorbed, but for the hole's share: (1 - r) sum of E A = pi L a, where a is the hole's area.
        let mut all = Vec::new();
        let middle = DVec3::splat(0.5 * size);
        for (corner, a, b) in cube.others.iter().chain([&cube.lid]) {
            let normal = a.cross(*b).normalize();
            let normal = normal.dot(middle - *corner).signum() * normal;
            all.extend(over_rectangle(corner + 1e-4 * normal, *a, *b, normal, 8));
        }
        let points: Vec<Receiver> = all.iter().map(|(p, _)| *p).collect();
        let conditions = conditions(cube.scene(), &points);
        let entered = PI * SKY * (hole[1] - hole[0]) * (hole[3] - hole[2]);
        for (quality, allowed) in QUALITIES {
            let found = received_at(quality, &conditions, Wanted::Reference, &[]);
            let totals = y(&found.total());
            let received = totals
                .iter()
                .zip(&all)
                .map(|(total, (_, weight))| weight * total);
            let absorbed = (1.0 - ALBEDO) * size * size * received.sum::<f64>();
            eprintln!("{what}, {quality:?}: {absorbed:.4} lm of {entered:.4}");
            off.near(
                &format!("{what}, {quality:?}"),
                &[absorbed],
                &[entered],
                allowed,
            );
        }
    }
    off.end();
}

#[test]
fn what_a_wall_has_around_it_is_no_hole() {
    // A hole as large as nothing: the same room without one, whose gable is no rectangle, is black.
    let [x, z] = [3.0 * DVec3::X, 4.0 * DVec3::Z];
    let mut parts = Vec::new();
    for (corner, a, b) in [
        (DVec3::ZERO, x, z),
        (DVec3::ZERO, z, 2.0 * DVec3::Y),
        (x, z, 3.5 * DVec3::Y),
        (2.0 * DVec3::Y, dvec3(3.0, 1.5, 0.0), z),
    ] {
        parts.extend(grey(quad(corner, a, b)));
    }
    for z in [0.0, 4.0] {
        let [a, b] = [dvec3(0.0, 0.0, z), dvec3(3.0, 0.0, z)];
        let [c, d] = [b + 3.5 * DVec3::Y, a + 2.0 * DVec3::Y];
        parts.extend(grey([[a, b, c], [a, c, d]]));
    }
    let scene = sky(surfaces(&parts), &format!("uniform:{SKY}"));
    let found = y(&receive(scene, &up(&[[1.4, 0.8, 2.3], [0.1, 0.01, 0.1]])).total());
    assert_eq!(found, [0.0; 2]);
}

/// The sun comes through a roof light 0.3 m wide, far narrower than patches of the sky are apart: what surfaces send on of it is what a
/// moment's light has, which asks each patch for the sun.
#[test]
fn sun_through_a_small_opening_is_not_lost() {
    let (low, high) = (DVec3::ZERO, dvec3(4.0, 3.0, 4.0));
    let is_ceiling = |corners: &[DVec3; 3]| corners.iter().all(|corner| corner.y == high.y);
    let mut triangles: Vec<_> = cuboid(low, high).into_iter().collect();
    triangles.retain(|corners| !is_ceiling(corners));
    let (a, b) = (1.85, 2.15);
    for [x, z] in [
        [[0.0, a], [0.0, 4.0]],
        [[b, 4.0], [0.0, 4.0]],
        [[a, b], [0.0, a]],
        [[a, b], [b, 4.0]],
    ] {
        let corner = dvec3(x[0], high.y, z[0]);
        triangles.extend(quad(
            corner,
            DVec3::X * (x[1] - x[0]),
            DVec3::Z * (z[1] - z[0]),
        ));
    }
    let room = Room {
        name: "roof light",
        triangles: triangles.into_iter().map(|t| (t, 0)).collect(),
        reflectances: vec![DVec3::splat(0.5)],
        ground: 0.2,
        points: vec![dvec3(0.7, 1.0, 0.6), dvec3(3.4, 0.85, 3.1)],
    };
    let file = made_up(ULM).read();
    let all = Hours::new(&file, 0.0, None, None).expect("it is sound");
    let high = all.lit.iter().filter(|hour| {
        let is_clear = hour.sun.shines() && hour.sun.illuminance_lux() > 3e4;
        is_clear && hour.sun.toward.y > 0.8
    });
    let high: Vec<&Hour> = high.collect();
    let mut count = 0;
    for patches in [1, 2, 4] {
        let fineness = Fineness {
            patches,
            ..Fineness::new(Quality::Preview, &[])
        };
        let sensors: Vec<Receiver> = room.points.iter().map(|p| at(*p, DVec3::Y)).collect();
        let base = year::conditions(room.under(&WEATHER[1]), &Default::default(), &file);
        let base = base.expect("it is sound");
        let year = Year::new(&base, sensors, &fineness, Task::unwatched()).expect("it works");
        for hour in high.iter().step_by(high.len().div_ceil(4)) {
            let [total, straight] = year.hour(hour);
            let set = [("radiosity.sky", f64::from(patches))];
            let now = year.at(hour);
            let same = received_at(Quality::Preview, &now, Wanted::Reference, &set);
            let all = y(&same.total());
            for ((total, straight), all) in total.iter().zip(&straight).zip(&all) {
                eprintln!(
                    "{patches} patches, sun at {:.0} degrees: {total:.1} lx, at the moment {all:.1}",
                    hour.sun.toward.y.asin() / tyndall::units::DEG
                );
                assert!((total / all - 1.0).abs() < 0.01, "{total} {all}");
                assert!(*straight == 0.0 && *total > 5.0);
                count += 1;
            }
        }
    }
    assert!(count >= 18, "{count}");
}
