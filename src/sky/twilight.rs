//! From day into night: the illuminance that the sky follows below 10 degrees, and what it looks like there.

use super::gradation::Gradation;
use super::preetham::Preetham;
use crate::colour::{into_gamut, working_from_xyz, xyz_from_xyy};
use crate::error::Result;
use crate::units::DEG;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// True elevation of the sun [rad] above which a sky is its model alone.
pub const BEGIN: f64 = 10.0 * DEG;

/// True elevation of the sun [rad] at and below which the sky's illuminance is the published curve's alone.
pub const LEVEL: f64 = 5.0 * DEG;

/// True elevation of the sun [rad] at and below which the sky's distribution and colour are the twilight's alone.
pub const SHAPE: f64 = 0.0;

/// True elevation of the sun [rad] below which the night shows.
pub const NIGHTFALL: f64 = -12.0 * DEG;

/// True elevation of the sun [rad] at and below which it is night.
pub const END: f64 = -18.0 * DEG;

/// Pieces of log10 E = l0 + l1 x + l2 x^2 + l3 x^3, x = elevation / 90 degrees, and where each begins [degrees].
const PIECES: [(f64, [f64; 4]); 6] = [
    (20.0, [3.74, 3.97, -4.07, 1.47]),
    (5.0, [3.05, 13.28, -45.98, 64.33]),
    (-0.8, [2.88, 22.26, -207.64, 1034.30]),
    (-5.0, [2.88, 21.81, -258.11, -858.36]),
    (-12.0, [2.70, 12.17, -431.69, -1899.83]),
    (-18.0, [13.84, 262.72, 1447.42, 2797.93]),
];

/// Half the width [degrees] over which two pieces, which meet within 1.5 %, are blended into one smooth curve.
const JOIN_DEG: f64 = 0.4;

/// Horizontal illuminance [lx] of sun and clear sky at sea level against the sun's true elevation [rad].
///
/// Domain: -90 to 90 degrees; below -18 degrees it stays at what the stars and the airglow give, 6.4e-4 lx.
/// Source: Janiczek & DeYoung 1987, US Naval Observatory Circular 171.
/// Differs: neighbouring pieces are blended over 0.8 degrees, so that the curve has no step.
pub fn clear_illuminance(elevation: f64) -> f64 {
    let degrees = (elevation / DEG).clamp(-18.0, 90.0);
    let x = degrees / 90.0;
    let piece = |l: &[f64; 4]| ((l[3] * x + l[2]) * x + l[1]) * x + l[0];
    let mut log = piece(&PIECES[0].1);
    for pair in PIECES.windows(2) {
        let above = smoothstep(pair[0].0 - JOIN_DEG, pair[0].0 + JOIN_DEG, degrees);
        if above == 1.0 {
            break;
        }
        log = piece(&pair[1].1) * (1.0 - above) + log * above;
    }
    10f64.powf(log)
}

/// What the sky looks like when the sun is low or down, as radiance of no particular level.
#[derive(Debug, Clone, PartialEq)]
pub struct Twilight {
    form: Preetham,
}

impl Twilight {
    /// The twilight for a sun at a true elevation [rad] below 10 degrees.
    pub fn new(elevation: f64) -> Result<Self> {
        let _ = Gradation::perez([0.0; 5]);
        Ok(Twilight {
            form: Preetham::new(2.5, FRAC_PI_2 - elevation.max(2.0 * DEG))?,
        })
    }

    /// Relative radiance, RGB in the working space, toward a direction of zenith-angle cosine `cos_theta` at angle `gamma` [rad] from the sun.
    pub fn radiance(&self, cos_theta: f64, gamma: f64, cos_gamma: f64) -> DVec3 {
        into_gamut(working_from_xyz(xyz_from_xyy(
            self.form.xyy(cos_theta, gamma, cos_gamma),
        )))
    }
}

/// 0 below `low`, 1 above `high`, 3 t^2 - 2 t^3 between.
pub(crate) fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
