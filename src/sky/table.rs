//! A sky as plain numbers, for a device that evaluates it in f32: what shaders/common/sky_table.wgsl reads.
//!
//! What depends on the height of a direction goes over as coefficients, since every model has one form there; what depends
//! on the angle from the sun as a table; twilight as its grid.

use super::Sky;
use super::day::Day;
use super::twilight;
use crate::colour::{LUMINANCE, WORKING_FROM_XYZ};
use glam::DVec3;

/// Pieces of the table over the angle from the sun, which is read along straight lines.
const PIECES: usize = 4096;

impl Sky {
    /// The numbers. Read back in f32, they give [`Sky::radiance`] within 1e-4.
    pub(crate) fn table(&self) -> Vec<f32> {
        let mut table: Vec<f64> = Vec::new();
        let vector = |table: &mut Vec<f64>, v: DVec3| table.extend(v.to_array());
        let day = self.blend.day.as_ref();
        let dusk = self.blend.twilight.as_ref();
        // The order is that of the constants in the shader.
        table.push(day.map_or(0.0, |(day, _)| day.form_number()));
        vector(&mut table, self.toward_sun);
        table.extend([self.toward_azimuth.x, self.toward_azimuth.z]);
        vector(&mut table, self.blend.uniform);
        vector(&mut table, self.blend.cloud);
        table.push(day.map_or(0.0, |(_, scale)| *scale));
        table.push(day.map_or(0.0, |(day, _)| day.grey));
        table.push(dusk.map_or(0.0, |(_, scale)| *scale));
        table.push(PIECES as f64);
        table.extend([twilight::GRID[0], twilight::GRID[1]].map(|n| n as f64));
        vector(&mut table, LUMINANCE);
        if let Some((day, _)) = day {
            vector(&mut table, day.overcast());
            table.extend(day.working_from_own().to_cols_array());
            table.extend(day.factors().as_flattened());
            table.extend(angles(day, PIECES).as_flattened());
        } else {
            let (matrix, factors) = (WORKING_FROM_XYZ.to_cols_array().len(), 6 * 5);
            table.resize(table.len() + 3 + matrix + factors + 5 * (PIECES + 1), 0.0);
        }
        if let Some((twilight, _)) = dusk {
            table.extend(twilight.grid().flat_map(|part| part.to_array()));
        }
        table.into_iter().map(|v| v as f32).collect()
    }
}

/// What depends on the angle from the sun, at evenly spaced t = tan(angle/2) / (1 + tan(angle/2)), 0 to 1.
fn angles(day: &Day, pieces: usize) -> Vec<[f64; 5]> {
    (0..=pieces)
        .map(|i| {
            let t = i as f64 / pieces as f64;
            let angle = 2.0 * t.atan2(1.0 - t);
            day.around_sun(angle, angle.cos()).to_array()
        })
        .collect()
}
