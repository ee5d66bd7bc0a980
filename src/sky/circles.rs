//! The sky along circles of equal elevation: many directions at the cost of a few.
//!
//! The models are products of what depends on the height of a direction alone and what depends on its angle from the sun
//! alone. On a circle the first is computed once; the second is read from a table, made once for the whole sky.

use super::Sky;
use super::angles::elevation_of;
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
            sun_elevation: elevation_of(sky.toward_sun),
            table: sky.blend.day.as_ref().map(|(day, _)| Table::new(day)),
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
        let even = sky.blend.uniform + sky.blend.cloud * (1.0 + 2.0 * sine);
        let day = sky
            .blend
            .day
            .as_ref()
            .zip(self.table.as_ref())
            .map(|((day, scale), table)| (day, *scale, table, day.over_height(sine)));
        let twilight = sky
            .blend
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

/// Octaves of the table, and pieces in each: down to 2^-52, an angle of 3e-8.
const OCTAVES: u32 = 52;
const STEPS: u32 = 16;

/// What depends on the angle from the sun, as cubic curves over the haversine m of the angle from the sun or from the point
/// opposite, whichever is near.
///
/// At both the models have a cusp in the haversine: as the angle does, they go with its root. So the pieces are as wide as
/// a sixteenth of what m is from there, and a piece is found from the bits of m.
struct Table {
    /// First those of the sun's half, then those of the other, each with m rising.
    pieces: Vec<[[f64; 5]; 4]>,
}

impl Table {
    fn new(day: &Day) -> Self {
        let value = |m: f64, opposite: bool| {
            let haversine = if opposite { 1.0 - m } else { m };
            let half = haversine.sqrt().atan2((1.0 - haversine).sqrt());
            let cos = if opposite {
                2.0 * m - 1.0
            } else {
                1.0 - 2.0 * m
            };
            day.around_sun(2.0 * half, cos).to_array()
        };
        let mut pieces = Vec::with_capacity((2 * OCTAVES * STEPS) as usize);
        for opposite in [false, true] {
            for octave in (1..=OCTAVES as i32).rev() {
                let scale = 2.0_f64.powi(-octave);
                for step in 0..STEPS {
                    let at = |third: f64| {
                        let m = scale * (1.0 + (f64::from(step) + third / 3.0) / f64::from(STEPS));
                        value(m, opposite)
                    };
                    pieces.push(cubic([at(0.0), at(1.0), at(2.0), at(3.0)]));
                }
            }
        }
        Table { pieces }
    }

    /// At the haversine of an angle, 0 to 1.
    #[inline(always)]
    fn read(&self, haversine: f64) -> Around {
        let opposite = haversine > 0.5;
        let m = if opposite { 1.0 - haversine } else { haversine };
        // The exponent and the first four bits of the mantissa number the piece; the rest is the way through it.
        let bits = m.max(f64::EPSILON).to_bits();
        let first = (1023 - OCTAVES) << 4;
        let half = if opposite { OCTAVES * STEPS } else { 0 };
        let index = (((bits >> 48) as u32).wrapping_sub(first) + half) as usize;
        let share = f64::from_bits((bits & ((1 << 48) - 1)) << 4 | 1.0_f64.to_bits()) - 1.0;
        let [c0, c1, c2, c3] = &self.pieces[index];
        Around::from_array(std::array::from_fn(|k| {
            c0[k] + share * (c1[k] + share * (c2[k] + share * c3[k]))
        }))
    }
}

/// Powers of the cubics through values at 0, 1/3, 2/3 and 1.
fn cubic(values: [[f64; 5]; 4]) -> [[f64; 5]; 4] {
    let mut powers = [[0.0; 5]; 4];
    for k in 0..5 {
        let v = values.map(|value| value[k]);
        // Newton's differences over 0, 1, 2, 3, as powers of x; then x is three times the share.
        let d1 = v[1] - v[0];
        let d2 = 0.5 * (v[2] - 2.0 * v[1] + v[0]);
        let d3 = (v[3] - 3.0 * v[2] + 3.0 * v[1] - v[0]) / 6.0;
        powers[0][k] = v[0];
        powers[1][k] = 3.0 * (d1 - d2 + 2.0 * d3);
        powers[2][k] = 9.0 * (d2 - 3.0 * d3);
        powers[3][k] = 27.0 * d3;
    }
    powers
}
