//! A sky as plain numbers, for a device that evaluates it in f32: what shaders/common/sky_table.wgsl reads.
//!
//! What depends on the height of a direction goes over as coefficients, since every model has one form there; what depends
//! on the angle from the sun as a table; twilight as its grid.

use super::Sky;
use super::day::{Day, FORM_LUMINANCE, FORM_XYY};
use super::gradation::COSINE_FLOOR;
use super::twilight;
use crate::colour::LUMINANCE;

/// Pieces of the table over the angle from the sun, which is read along straight lines.
const PIECES: usize = 4096;

/// The parts of the table in order, and how many numbers each takes; the grid of twilight follows.
const LAYOUT: [(&str, usize); 15] = [
    ("FORM", 1),
    ("TOWARD_SUN", 3),
    ("TOWARD_AZIMUTH", 2),
    ("UNIFORM", 3),
    ("CLOUD", 3),
    ("DAY_SCALE", 1),
    ("GREY", 1),
    ("DUSK_SCALE", 1),
    ("PIECES", 1),
    ("DUSK_SIZE", 2),
    ("LUMINANCE", 3),
    ("OVERCAST", 3),
    ("COLOURS", 9),
    ("FACTORS", 6 * 5),
    ("ANGLES", 5 * (PIECES + 1)),
];

/// Offsets into the table and the numbers that the models share, as constants of a shader.
pub(crate) fn constants() -> String {
    let mut at = 0;
    let mut text = String::new();
    for (name, length) in LAYOUT {
        text += &format!("const {name} = {at}u;\n");
        at += length;
    }
    text + &format!(
        "const COSINE_FLOOR = {COSINE_FLOOR:?};\nconst AEROSOL_G = {:?};\n\
         const FORM_XYY = {FORM_XYY:?};\nconst FORM_LUMINANCE = {FORM_LUMINANCE:?};\n",
        twilight::AEROSOL_G
    )
}

impl Sky {
    /// The numbers. Read back in f32, they give [`Sky::radiance`] within 1e-4.
    pub(crate) fn table(&self) -> Vec<f32> {
        let whole = LAYOUT.iter().map(|(_, length)| length).sum();
        let mut table = vec![0.0; whole];
        let mut put = |name: &str, values: &[f64]| {
            let before = LAYOUT.iter().take_while(|(other, _)| *other != name);
            let at: usize = before.map(|(_, length)| length).sum();
            for (place, value) in table[at..].iter_mut().zip(values) {
                *place = *value as f32;
            }
        };
        put("TOWARD_SUN", &self.toward_sun.to_array());
        put(
            "TOWARD_AZIMUTH",
            &[self.toward_azimuth.x, self.toward_azimuth.z],
        );
        put("UNIFORM", &self.blend.uniform.to_array());
        put("CLOUD", &self.blend.cloud.to_array());
        put("PIECES", &[PIECES as f64]);
        put("DUSK_SIZE", &twilight::GRID.map(|n| n as f64));
        put("LUMINANCE", &LUMINANCE.to_array());
        if let Some((day, scale)) = &self.blend.day {
            put("FORM", &[day.form_number()]);
            put("DAY_SCALE", &[*scale]);
            put("GREY", &[day.grey]);
            put("OVERCAST", &day.overcast().to_array());
            put("COLOURS", &day.working_from_own().to_cols_array());
            put("FACTORS", day.factors().as_flattened());
            put("ANGLES", angles(day, PIECES).as_flattened());
        }
        if let Some((twilight, scale)) = &self.blend.twilight {
            put("DUSK_SCALE", &[*scale]);
            let grid = twilight.grid().flat_map(|part| part.to_array());
            table.extend(grid.map(|v| v as f32));
        }
        table
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
