//! The sky along circles of equal elevation: many directions for the price of few.
//!
//! The models are products of what depends on the height of a direction alone and what depends on its angle from the sun
//! alone. On a circle the first is computed once; the second is read from a table, made once for the whole sky.

use super::Sky;
use super::day::{Around, Day};
use super::twilight;
use glam::Vec3;
use std::f64::consts::TAU;

/// A sky and the azimuths at which its circles are asked.
pub struct Circles<'s> {
    sky: &'s Sky,
    sun_elevation: f64,
    table: Option<Table>,
    columns: Vec<Column>,
}

/// An azimuth.
struct Column {
    /// The haversine of its angle from the sun's azimuth, sin^2(angle / 2).
    haversine: f64,
    /// Where it falls in a twilight's circle.
    cell: (usize, f64),
}

impl<'s> Circles<'s> {
    /// For the azimuths [rad] from -Z toward +X.
    pub fn new(sky: &'s Sky, azimuths: impl Iterator<Item = f64>) -> Self {
        let sun = sky.toward_azimuth.x.atan2(-sky.toward_azimuth.z);
        let columns = azimuths.map(|azimuth| {
            let turn = (azimuth - sun).rem_euclid(TAU);
            Column {
                haversine: (0.5 * turn).sin().powi(2),
                cell: twilight::azimuth_cell(turn.min(TAU - turn)),
            }
        });
        Circles {
            sun_elevation: super::elevation_of(sky.toward_sun),
            table: sky.day.as_ref().map(|(day, _)| Table::new(day)),
            columns: columns.collect(),
            sky,
        }
    }

    /// Radiances at an elevation [rad] of 0 to pi/2, one an azimuth: [`Sky::radiance`] within 1e-6 of it.
    ///
    /// `out` has as many places as there are azimuths.
    pub fn radiances(&self, elevation: f64, out: &mut [Vec3]) {
        let sky = self.sky;
        let sine = elevation.sin();
        // hav(angle from the sun) = hav(difference in height) + cos cos hav(difference in azimuth): exact near the sun.
        let least = (0.5 * (elevation - self.sun_elevation)).sin().powi(2);
        let factor = elevation.cos() * self.sun_elevation.cos();
        let even = sky.uniform + sky.cloud * (1.0 + 2.0 * sine);
        let day = sky
            .day
            .as_ref()
            .zip(self.table.as_ref())
            .map(|((day, scale), table)| (day, *scale, table, day.over_height(sine)));
        let twilight = sky
            .twilight
            .as_ref()
            .map(|(twilight, scale)| (twilight.circle(sine), *scale));
        for (column, out) in self.columns.iter().zip(out) {
            let haversine = least + factor * column.haversine;
            let mut sum = even;
            if let Some((day, scale, table, height)) = &day {
                sum += day.seen_at(height, &table.read(haversine)) * *scale;
            }
            if let Some((circle, scale)) = &twilight {
                sum += twilight::read(circle, column.cell, 1.0 - 2.0 * haversine) * *scale;
            }
            *out = sum.as_vec3();
        }
    }
}

/// Pieces of the table.
const PIECES: usize = 2048;

/// What depends on the angle from the sun, at evenly spaced t = tan(angle/2) / (1 + tan(angle/2)), 0 to 1.
pub(super) fn angles(day: &Day, pieces: usize) -> Vec<[f64; 5]> {
    (0..=pieces)
        .map(|i| {
            let t = i as f64 / pieces as f64;
            let angle = 2.0 * t.atan2(1.0 - t);
            day.around_sun(angle, angle.cos()).to_array()
        })
        .collect()
}

/// What depends on the angle from the sun, as cubic curves over t = tan(angle/2) / (1 + tan(angle/2)).
///
/// t runs from 0 at the sun to 1 opposite and is a smooth function of the angle, also at the sun, where the models have a
/// cusp in the cosine.
struct Table {
    pieces: Vec<[[f64; 5]; 4]>,
}

impl Table {
    fn new(day: &Day) -> Self {
        let values = angles(day, PIECES);
        let pieces = (0..PIECES)
            .map(|i| {
                // The cubic through the four values about the piece, or the four nearest at an end.
                let first = i.saturating_sub(1).min(PIECES - 3);
                let start = i as f64 - first as f64;
                let mut piece = [[0.0; 5]; 4];
                for k in 0..5 {
                    let v = |n: usize| values[first + n][k];
                    // Newton's differences over 0, 1, 2, 3, as powers of x = start + share.
                    let d1 = v(1) - v(0);
                    let d2 = 0.5 * (v(2) - 2.0 * v(1) + v(0));
                    let d3 = (v(3) - 3.0 * v(2) + 3.0 * v(1) - v(0)) / 6.0;
                    let c = [v(0), d1 - d2 + 2.0 * d3, d2 - 3.0 * d3, d3];
                    let s = start;
                    piece[0][k] = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
                    piece[1][k] = c[1] + s * (2.0 * c[2] + s * 3.0 * c[3]);
                    piece[2][k] = c[2] + 3.0 * s * c[3];
                    piece[3][k] = c[3];
                }
                piece
            })
            .collect();
        Table { pieces }
    }

    /// At the haversine of an angle, 0 to 1.
    #[inline]
    fn read(&self, haversine: f64) -> Around {
        let (sin, cos) = (haversine.max(0.0).sqrt(), (1.0 - haversine).max(0.0).sqrt());
        let x = sin / (sin + cos) * PIECES as f64;
        let index = (x as i32 as usize).min(PIECES - 1);
        let share = x - index as f64;
        let [c0, c1, c2, c3] = &self.pieces[index];
        Around::from_array(std::array::from_fn(|k| {
            c0[k] + share * (c1[k] + share * (c2[k] + share * c3[k]))
        }))
    }
}
