//! The planes that a file leaves out, since they mirror others.

use super::table::{Goniometer, Table};
use crate::error::Result;
use crate::memory;

/// What a distribution does not change under, by the horizontal angles of its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// Any turn about its axis: one plane stands for all.
    Axis,
    /// Mirrors through both planes, C0-C180 and C90-C270: a quarter stands for all.
    Quadrants,
    /// The mirror through the plane of C0 and C180, or of H = 0 for types A and B.
    Across0,
    /// The mirror through the plane of C90 and C270.
    Across90,
    /// Nothing.
    None,
}

impl Symmetry {
    /// As people say it.
    pub fn words(self, goniometer: Goniometer) -> &'static str {
        match (self, goniometer) {
            (Symmetry::Axis, _) => "about its axis",
            (Symmetry::Quadrants, _) => "to the planes C0-C180 and C90-C270",
            (Symmetry::Across0, Goniometer::C) => "to the plane C0-C180",
            (Symmetry::Across0, _) => "to the plane H = 0",
            (Symmetry::Across90, _) => "to the plane C90-C270",
            (Symmetry::None, _) => "none",
        }
    }
}

/// Measured planes: horizontal angles [degrees], and for each its values [cd] at all vertical angles [degrees].
pub(super) struct Measured {
    pub goniometer: Goniometer,
    pub horizontal: Vec<f64>,
    pub vertical: Vec<f64>,
    pub candela: Vec<f64>,
}

impl Measured {
    /// The table of all planes, those that `symmetry` implies and the one that closes the turn included.
    pub fn complete(self, symmetry: Symmetry) -> Result<Table> {
        let first = self.horizontal[0];
        // Angles, each with the measured plane that has its values.
        let mut planes: Vec<(f64, usize)> = self.horizontal.iter().copied().zip(0..).collect();
        match (symmetry, self.goniometer) {
            (Symmetry::Axis, _) => planes = vec![(0.0, 0), (360.0, 0)],
            (Symmetry::Quadrants, _) => {
                mirror(&mut planes, 90.0);
                mirror(&mut planes, 180.0);
            }
            (Symmetry::Across0, Goniometer::C) => mirror(&mut planes, 180.0),
            (Symmetry::Across0, _) => {
                let other = planes.iter().rev().filter(|(h, _)| *h > 0.0);
                let mut both: Vec<_> = other.map(|(h, plane)| (-h, *plane)).collect();
                both.append(&mut planes);
                planes = both;
            }
            (Symmetry::Across90, _) => mirror(&mut planes, first + 180.0),
            (Symmetry::None, Goniometer::C) => {
                if planes
                    .last()
                    .is_some_and(|(h, _)| *h < first + 360.0 - 1e-9)
                {
                    planes.push((first + 360.0, 0));
                }
            }
            (Symmetry::None, _) => {}
        }
        let rows = self.vertical.len();
        let mut candela = memory::filled("the values of a lamp", planes.len() * rows, 0.0)?;
        for (own, (_, plane)) in candela.chunks_exact_mut(rows).zip(&planes) {
            own.copy_from_slice(&self.candela[plane * rows..(plane + 1) * rows]);
        }
        let horizontal = planes.into_iter().map(|(h, _)| h).collect();
        Table::new(self.goniometer, horizontal, self.vertical, candela)
    }
}

/// Adds the mirror images of planes that end at an angle [degrees].
fn mirror(planes: &mut Vec<(f64, usize)>, about: f64) {
    let images: Vec<_> = planes
        .iter()
        .rev()
        .filter(|(h, _)| *h < about)
        .map(|(h, plane)| (2.0 * about - h, *plane))
        .collect();
    planes.extend(images);
}
