//! The sun's shadows and patches on surfaces, as what lies beside them sees them: a surface that the sun lights in part sends its
//! light from there.

mod common;

use common::build::{cuboid, quad};
use common::receive::*;
use common::rooms::panel;
use glam::{DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::conditions::Receiver;
use tyndall::studies::scenes::Corners;

fn grey(triangles: impl IntoIterator<Item = Corners>, reflectance: f64) -> Vec<(Corners, f64)> {
    triangles.into_iter().map(|t| (t, reflectance)).collect()
}

/// Rays for single points whose light nothing but rays finds.
const MANY_RAYS: Settings = &[("radiosity.rays", 16_384.0)];

const SUN: f64 = 1e5;
const ELEVATION_DEG: f64 = 10.0;
/// The radiance of the sky, even all over.
const SKY: f64 = 1000.0;
const ALBEDO: f64 = 0.3;

/// A black tower on open ground, its middle at the origin, the sun low in the south.
struct Tower {
    low: DVec3,
    high: DVec3,
}

impl Tower {
    fn new(width: f64, depth: f64, height: f64) -> Self {
        let half = 0.5 * dvec3(width, 0.0, depth);
        Tower {
            low: -half,
            high: half + height * DVec3::Y,
        }
    }

    /// Whether a ray meets it.
    fn stops(&self, origin: DVec3, direction: DVec3) -> bool {
        let (a, b) = (
            (self.low - origin) / direction,
            (self.high - origin) / direction,
        );
        let enters = a.min(b).max_element();
        let leaves = a.max(b).min_element();
        leaves > enters.max(0.0)
    }

    /// What a point of the ground receives from sun and sky [lx]: the tower's walls take their form factors of the sky.
    fn on_ground(&self, point: DVec3) -> f64 {
        let up = at(point, DVec3::Y);
        let (size, east, south) = (
            self.high - self.low,
            dvec3(self.high.x, 0.0, self.low.z),
            dvec3(self.low.x, 0.0, self.high.z),
        );
        let (x, y, z) = (size.x * DVec3::X, size.y * DVec3::Y, size.z * DVec3::Z);
        let walls = [
            (point.x > self.high.x, rectangle(east, z, y)),
            (point.x < self.low.x, rectangle(self.low, z, y)),
            (point.z > self.high.z, rectangle(south, x, y)),
            (point.z < self.low.z, rectangle(self.low, x, y)),
        ];
        let walls = walls.iter().filter(|(is_seen, _)| *is_seen);
        let taken: f64 = walls.map(|(_, wall)| form_factor(&up, wall)).sum();
        let (sin, cos) = ELEVATION_DEG.to_radians().sin_cos();
        let lit = !self.stops(point, dvec3(0.0, sin, cos));
        PI * SKY * (1.0 - taken) + if lit { SUN * sin } else { 0.0 }
    }

    /// What a point receives from the ground [lx], by the midpoint rule over its hemisphere.
    fn truth(&self, point: &Receiver) -> f64 {
        const SIDE: usize = 400;
        let (tangent, bitangent) = point.normal.any_orthonormal_pair();
        let mut sum = 0.0;
        for k in 0..SIDE * SIDE {
            let [u, v] = [k % SIDE, k / SIDE].map(|i| (i as f64 + 0.5) / SIDE as f64);
            let (sin, cos) = (2.0 * PI * v).sin_cos();
            let direction =
                u.sqrt() * (cos * tangent + sin * bitangent) + (1.0 - u).sqrt() * point.normal;
            if direction.y < 0.0 && !self.stops(point.position, direction) {
                let way = -point.position.y / direction.y;
                sum += self.on_ground(point.position + way * direction);
            }
        }
        ALBEDO * sum / (SIDE * SIDE) as f64
    }

    /// What points receive from the ground as it is found.
    fn found(&self, points: &[Receiver], set: Settings) -> Vec<f64> {
        let parts = grey(cuboid(self.low, self.high), 0.0);
        let scene = sun(surfaces(&parts), [180.0, ELEVATION_DEG], SUN);
        let scene = ground(sky(scene, &format!("uniform:{SKY}")), 0.0, ALBEDO);
        y(&receive_by(scene, points, set).indirect)
    }
}

#[test]
fn the_ground_is_dark_in_the_far_shadow_of_a_tower() {
    let mut off = Deviations::default();
    // The shadows are 340 and 850 m long.
    for (width, height, distances) in [
        (30.0, 60.0, [50.0, 150.0, 300.0]),
        (16.0, 150.0, [200.0, 450.0, 700.0]),
    ] {
        let tower = Tower::new(width, 6.0, height);
        let mut points = Vec::new();
        for north in distances {
            // In the middle, and on both sides of the edge.
            let edge = 0.5 * width;
            let beside = 1.0 + 0.01 * north;
            for x in [0.0, edge - beside, edge + beside, -edge - 4.0 * beside] {
                let place = dvec3(x, 0.5, -north);
                let ways = [DVec3::NEG_Y, DVec3::X, DVec3::NEG_X, DVec3::NEG_Z];
                points.extend(ways.map(|normal| at(place, normal)));
            }
        }
        let truth: Vec<f64> = points.iter().map(|p| tower.truth(p)).collect();
        // What a point in the shadow has from the side comes from beyond the edge, by few rays near the horizon: more of them leave
        // what the tiles are wide. Were the shadow taken for the mean of its patch, it would be six times as bright.
        for (set, allowed) in [(&[][..], 0.08), (MANY_RAYS, 0.04)] {
            let found = tower.found(&points, set);
            for ((point, found), truth) in points.iter().zip(&found).zip(&truth) {
                let Receiver { position, normal } = point;
                eprintln!(
                    "{position} {normal}: {found:.0} lx, {truth:.0}, {:.3}",
                    found / truth
                );
            }
            let what = format!("the shadow of {width} by {height} m");
            off.near(&what, &found, &truth, allowed);
        }
    }
    off.end();
}

#[test]
fn a_wall_is_lit_by_the_sun_on_the_floor_beside_it() {
    let mut off = Deviations::default();
    // A room of 4 by 6 and 3 high, black but for its floor, and no sky: the sun at 45 degrees lights on the floor what the window
    // lets through.
    let hole = [0.1, 2.1, 1.0, 2.0];
    let mut parts = grey(
        panel(DVec3::ZERO, DVec3::X, DVec3::Y, [4.0, 3.0], &[hole]),
        0.0,
    );
    let (x, y_, z) = (4.0 * DVec3::X, 3.0 * DVec3::Y, -6.0 * DVec3::Z);
    for (corner, a, b) in [(y_, x, z), (z, x, y_), (DVec3::ZERO, z, y_), (x, z, y_)] {
        parts.extend(grey(quad(corner, a, b), 0.0));
    }
    let reflectance = 0.5;
    parts.extend(grey(quad(DVec3::ZERO, x, z), reflectance));
    let scene = sun(surfaces(&parts), [180.0, 45.0], SUN);
    let lit = rectangle(
        dvec3(hole[0], 0.0, -hole[2]),
        (hole[1] - hole[0]) * DVec3::X,
        (hole[2] - hole[3]) * DVec3::Z,
    );
    let sends = reflectance * SUN * 45f64.to_radians().sin();
    let points: Vec<Receiver> = [
        // On the wall beside, low and higher, along and past the patch.
        ([1e-3, 0.05, -1.5], DVec3::X),
        ([1e-3, 0.1, -1.1], DVec3::X),
        ([1e-3, 0.3, -1.9], DVec3::X),
        ([1e-3, 0.3, -2.3], DVec3::X),
        ([1e-3, 0.2, -0.8], DVec3::X),
        ([1e-3, 1.0, -1.5], DVec3::X),
        // Above the floor: over the patch, over its edge, beside it.
        ([1.0, 0.1, -1.5], DVec3::NEG_Y),
        ([1.0, 0.1, -2.0], DVec3::NEG_Y),
        ([1.0, 0.1, -2.15], DVec3::NEG_Y),
        ([2.25, 0.1, -1.5], DVec3::NEG_X),
    ]
    .map(|(p, normal)| at(DVec3::from_array(p), normal))
    .to_vec();
    let truth: Vec<f64> = (points.iter())
        .map(|p| sends * form_factor(p, &lit))
        .collect();
    let found = y(&receive(scene, &points).indirect);
    for ((found, truth), point) in found.iter().zip(&truth).zip(&points) {
        eprintln!("{} {:.4}", point.position, found / truth);
    }
    // The finest tiles are 5 cm wide: half as far as the nearest points are from the edge.
    off.near("beside the sun on a floor", &found, &truth, 0.05);
    off.end();
}
