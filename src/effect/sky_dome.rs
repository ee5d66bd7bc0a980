//! The sky behind everything, on rays that meet nothing and do not point below the horizon.
//!
//! The models live in [`crate::sky`]; this effect only asks them. Below the horizon a scene without a ground is black.

use super::{Contribution, Decision, Effect, Field, Kind, Pass, Resource, Settings};
use crate::colour::luminance;
use crate::conditions::Conditions;
use crate::sky::gradation::COSINE_FLOOR;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// The sky seen directly.
pub const SKY_DOME: Effect = Effect {
    name: "sky_dome",
    summary: "the sky where nothing stands before it",
    reads: &[Field::Surface],
    writes: &[Field::Background],
    remembers: false,
    method: None,
    knobs: &[],
    decide: |conditions| match &conditions.sky {
        None => Decision::nothing("no sky was asked for"),
        Some(sky) => Decision::run(
            sky.describe(),
            Contribution::Estimate(luminance(sky.horizontal_illuminance()) / PI),
        ),
    },
    reference: |conditions, _| {
        let sky = conditions.sky.as_ref();
        Box::new(move |fields| {
            fields.update(Field::Background, |ray, _, surface, present| match sky {
                Some(sky) if !surface.is_met() && ray.direction.y >= 0.0 => {
                    present + sky.radiance(ray.direction)
                }
                _ => present + DVec3::ZERO,
            });
        })
    },
    passes: &[Pass {
        shader: include_str!("../../shaders/sky_dome.wgsl"),
        entry: "shine",
        kind: Kind::Pixels,
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::Background),
            Resource::Table(table),
        ],
        scratch: &[],
    }],
};

const COLUMNS: usize = 512;

/// The sky for the GPU: logarithms of its RGB over elevation and angle to the sun, on which alone the models depend.
///
/// A row is an elevation; its columns divide evenly the angles to the sun that this elevation knows, so that the cusp at the
/// sun and the edge of what is possible lie on grid lines. Rows are closest at the horizon, and one stands at the sun's own
/// elevation. Bilinear interpolation leaves less than 1e-4 of the value (tested for every model).
fn table(conditions: &Conditions, _: &Settings<'_>) -> Vec<f32> {
    let Some(sky) = &conditions.sky else {
        return vec![0.0];
    };
    let sun = sky.toward_sun();
    let sun_elevation = sun.y.atan2(sun.x.hypot(sun.z));
    let ahead = DVec3::new(sun.x, 0.0, sun.z)
        .try_normalize()
        .unwrap_or(DVec3::X);
    let aside = ahead.cross(DVec3::Y);
    let mut rows = vec![0.0, COSINE_FLOOR.asin()];
    loop {
        let last = rows[rows.len() - 1];
        let next = last + (0.02 * last).min(0.006);
        if next >= FRAC_PI_2 {
            break;
        }
        rows.push(next);
    }
    rows.push(FRAC_PI_2);
    if sun_elevation > 0.0 {
        rows.push(sun_elevation);
        rows.sort_unstable_by(f64::total_cmp);
        rows.dedup();
    }
    let value = |elevation: f64, column: usize| {
        let least = (elevation - sun_elevation).abs();
        let greatest = PI - (elevation + sun_elevation).abs();
        let angle = least + (greatest - least) * column as f64 / (COLUMNS - 1) as f64;
        // The azimuth from the sun at which this angle is found, by half angles so that nothing cancels.
        let product = sun_elevation.cos() * elevation.cos();
        let sine2 = (0.5 * (angle - least)).sin() * (0.5 * (angle + least)).sin() / product;
        let half = sine2.clamp(0.0, 1.0).sqrt().asin();
        let (sin, cos) = if product > 0.0 {
            (2.0 * half).sin_cos()
        } else {
            (0.0, 1.0)
        };
        let flat = elevation.cos() * (cos * ahead + sin * aside);
        let direction = DVec3::new(flat.x, elevation.sin(), flat.z);
        sky.radiance(direction).max(DVec3::splat(1e-20))
    };
    let values: Vec<[f32; 3]> = rows
        .par_iter()
        .flat_map_iter(|elevation| {
            (0..COLUMNS)
                .map(move |column| value(*elevation, column).to_array().map(|v| v.ln() as f32))
        })
        .collect();
    let mut table = vec![rows.len() as f32, COLUMNS as f32];
    table.extend(sun.to_array().map(|v| v as f32));
    table.extend(rows.iter().map(|e| *e as f32));
    table.extend(values.iter().flatten());
    table
}
