//! A plane that is divided into cells, and the sensors in their middles.

use super::outline::Outline;
use crate::conditions::Receiver;
use glam::{DVec2, DVec3, dvec2};

/// A plane with a grid on it.
#[derive(Debug, Clone)]
pub struct Plane {
    /// The room, floor or surface, as it is shown; of several of a name with a number.
    pub name: String,
    /// The corner from which cells count, on the plane [m], scene axes.
    pub origin: DVec3,
    /// Unit vector along rows.
    pub u: DVec3,
    /// Unit vector from row to row; `u` x `v` is the normal.
    pub v: DVec3,
    /// Height above the floor, or distance in front of the surface [m].
    pub above: f64,
    /// Whether it lies over a floor, where people are.
    pub is_over_floor: bool,
    /// Distances between columns and between rows [m].
    pub step: [f64; 2],
    /// How many columns and rows there are.
    pub cells: [u32; 2],
    /// What is divided into cells, without the band along walls: in metres from the origin along `u` and `v`.
    pub outline: Outline,
    /// The whole floor or surface, in the same coordinates.
    pub whole: Outline,
}

impl Plane {
    /// Unit normal: the side that receives.
    pub fn normal(&self) -> DVec3 {
        self.u.cross(self.v)
    }

    /// A place on the plane [m] by its coordinates along `u` and `v`.
    pub fn at(&self, place: DVec2) -> DVec3 {
        self.origin + place.x * self.u + place.y * self.v
    }

    /// The corners of a cell in the plane's coordinates [m].
    pub fn cell(&self, [column, row]: [u32; 2]) -> [DVec2; 4] {
        let step = DVec2::from(self.step);
        let low = step * dvec2(column.into(), row.into());
        [
            low,
            low + dvec2(step.x, 0.0),
            low + step,
            low + dvec2(0.0, step.y),
        ]
    }

    /// Whether it is level.
    pub fn is_level(&self) -> bool {
        self.normal().y > 1.0 - 1e-6
    }
}

/// A point of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Where it is and the side that receives, in scene axes.
    pub receiver: Receiver,
    /// The part of its plane's outline that lies in its cell [m2], above 0.
    pub area: f64,
    /// Which of the planes it is on.
    pub plane: usize,
    /// Its column and row there, from 0.
    pub cell: [u32; 2],
}
