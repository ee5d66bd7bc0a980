//! Rooms as text, and the sensors of their grids.

use super::build::{cuboid, quad};
use super::files::Folder;
use glam::{DVec3, dvec2, dvec3};
use std::fmt::Write;
use tyndall::daylight::grid::{GridSpec, Sensors};
use tyndall::scene::{Geometry, Scene};
use tyndall::studies::scenes::Corners;

/// Named objects of an OBJ file.
pub type Objects<'a> = [(&'a str, Vec<Corners>)];

pub fn obj(objects: &Objects) -> String {
    let mut text = String::new();
    let mut count = 0;
    for (name, triangles) in objects {
        writeln!(text, "o {name}").expect("text");
        for corners in triangles {
            for p in corners {
                writeln!(text, "v {} {} {}", p.x, p.y, p.z).expect("text");
            }
            writeln!(text, "f {} {} {}", count + 1, count + 2, count + 3).expect("text");
            count += 3;
        }
    }
    text
}

pub fn built(objects: &Objects) -> Scene {
    let folder = Folder::new();
    folder.load("a.obj", obj(objects)).expect("it loads")
}

pub fn grid(scene: &Scene, spec: &str) -> Sensors {
    let spec = GridSpec::parse(spec).expect("it can be read");
    Sensors::new(scene, &Geometry::new(scene), &[spec]).expect("there are sensors")
}

/// Places of sensors in plan, in millimetres.
pub fn places(sensors: &Sensors) -> Vec<[i64; 2]> {
    let place = |p: DVec3| [p.x, p.z].map(|v| (1e3 * v).round() as i64);
    (sensors.points.iter())
        .map(|s| place(s.receiver.position))
        .collect()
}

/// A level rectangle.
pub fn level(low: [f64; 2], high: [f64; 2], height: f64) -> Vec<Corners> {
    let size = dvec2(high[0] - low[0], high[1] - low[1]);
    quad(
        dvec3(low[0], height, low[1]),
        DVec3::Z * size.y,
        DVec3::X * size.x,
    )
    .to_vec()
}

/// A closed box that shows its front to the outside.
pub fn solid(low: DVec3, high: DVec3) -> Vec<Corners> {
    let middle = 0.5 * (low + high);
    let outward = |[a, b, c]: Corners| match (b - a).cross(c - a).dot(a - middle) > 0.0 {
        true => [a, b, c],
        false => [a, c, b],
    };
    cuboid(low, high).into_iter().map(outward).collect()
}

/// A closed box that shows its front to the inside: a room of sheets.
pub fn hollow(low: DVec3, high: DVec3) -> Vec<Corners> {
    solid(low, high)
        .into_iter()
        .map(|[a, b, c]| [a, c, b])
        .collect()
}
