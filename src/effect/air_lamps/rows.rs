//! Rows in the plane of eye and lamp: half-planes around the line from the eye to the lamp, around whose image they lie like
//! spokes.
//!
//! Of a row it is found once what cuts it ([`crate::scene::half_plane`]); that shades all rays of the row, exactly for its own plane. A ray
//! belongs to the row in whose share of the turn it lies, so that edges of shadows are off by up to half of a row. Rays from elsewhere
//! than the eye (of a parallel view) and those on which the lamp lies are left to the exact way.

use super::met::Met;
use crate::conditions::Conditions;
use crate::error::{Error, Result};
use crate::scene::half_plane::HalfPlane;
use crate::scene::shade::{Run, Shade};
use crate::scene::{Projection, Ray};
use glam::DVec3;
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// Rays within this angle of the lamp have no row [rad].
const ON_LAMP: f64 = 1e-6;

/// The rows of all spots, cut when a ray first asks for one.
pub(super) struct Rows<'c> {
    conditions: &'c Conditions,
    spots: Vec<Vec<OnceLock<HalfPlane>>>,
}

/// No more rows are kept, for all lamps together.
const MOST_ROWS: usize = 1 << 22;

impl<'c> Rows<'c> {
    /// So many rows for each of some spots.
    pub fn new(conditions: &'c Conditions, spots: usize, rows: usize) -> Result<Self> {
        let all = rows.saturating_mul(spots);
        if all > MOST_ROWS {
            return Err(Error::input(
                "air_lamps.rows",
                format!("{all} rows for all lamps, more than {MOST_ROWS}"),
                "set fewer rows, or another air_lamps.integrator",
            ));
        }
        let empty = || (0..rows).map(|_| OnceLock::new()).collect();
        Ok(Rows {
            conditions,
            spots: (0..spots).map(|_| empty()).collect(),
        })
    }

    /// The runs of a ray that the light of a spot reaches [m], and the share of it that does; `None` of a ray that has no row.
    pub fn lit_runs(
        &self,
        met: &Met<'_>,
        ray: &Ray,
        shade: &mut Shade,
    ) -> Option<Vec<(Run, DVec3)>> {
        let camera = &self.conditions.view.camera;
        if let Projection::Orthographic { .. } = camera.projection {
            return None;
        }
        let toward = met.spot.position - ray.origin;
        let distance = toward.length();
        let way = Ray {
            origin: ray.origin,
            direction: toward.try_normalize()?,
        };
        let aside = ray.direction.cross(way.direction).length();
        if aside < ON_LAMP {
            return None;
        }
        let (u, v) = way.direction.any_orthonormal_pair();
        let turn = ray
            .direction
            .dot(v)
            .atan2(ray.direction.dot(u))
            .rem_euclid(TAU)
            / TAU;
        let rows = &self.spots[met.number];
        let number = ((turn * rows.len() as f64) as usize).min(rows.len() - 1);
        let row = rows[number].get_or_init(|| {
            let (y, x) = (TAU * (number as f64 + 0.5) / rows.len() as f64).sin_cos();
            let across: DVec3 = x * u + y * v;
            let geometry = met.lamp.geometry(&self.conditions.geometry);
            geometry.half_plane(&way, distance, across)
        });
        let [from, to] = met.span;
        row.shade([ray.direction.dot(way.direction), aside], to, shade);
        let within = |([a, b], pass): (Run, DVec3)| {
            let run = [a.max(from), b.min(to)];
            (run[1] > run[0]).then_some((run, pass))
        };
        Some(shade.lit(to).into_iter().filter_map(within).collect())
    }
}
