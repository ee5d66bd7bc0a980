//! Correlated colour temperature and distance from the Planckian locus.

use super::cie1931::xyz_from_spectrum;
use glam::DVec3;
use std::sync::LazyLock;

/// Correlated colour temperature and its sign-carrying distance from the Planckian locus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Temperature {
    /// Correlated colour temperature [K], 1 000 to 100 000.
    pub cct: f64,
    /// Distance from the Planckian locus in CIE 1960 u, v; above it (greenish) positive.
    pub duv: f64,
}

/// Distance from the locus [1] beyond which a colour has no correlated temperature (CIE 015:2018, 9.5).
pub const DUV_LIMIT: f64 = 0.05;

const COLDEST: f64 = 1000.0;
const HOTTEST: f64 = 100_000.0;

/// Ratio of neighbouring temperatures in the table; the parabola through three points then errs by less than 0.01 mired.
const STEP: f64 = 1.01;

/// T, u, v along the Planckian locus.
static LOCUS: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| {
    let count = ((HOTTEST / COLDEST).ln() / STEP.ln()).ceil() as i32;
    (-1..=count + 1)
        .map(|i| {
            let t = COLDEST * STEP.powi(i);
            let [u, v] = uv(xyz_from_spectrum(|nm| planck(nm, t)));
            [t, u, v]
        })
        .collect()
});

/// Spectral radiance of a black body, relative, at a wavelength [nm] and temperature [K]; c2 = 1.4388e-2 m K (ITS-90, as CIE 015).
fn planck(nm: f64, t: f64) -> f64 {
    (560.0 / nm).powi(5) / (1.4388e7 / (nm * t)).exp_m1()
}

/// CIE 1960 u, v of an XYZ that is not black.
pub fn uv(xyz: DVec3) -> [f64; 2] {
    let sum = xyz.x + 15.0 * xyz.y + 3.0 * xyz.z;
    [4.0 * xyz.x / sum, 6.0 * xyz.y / sum]
}

/// CCT and Duv of an XYZ; `None` for black, outside 1 000 to 100 000 K, or further than 0.05 from the locus.
///
/// Error: 0.02 % of the temperature and 4e-6 in Duv, 1 500 to 25 000 K. Many blue skies have no CCT: no number is given then.
/// Source: Ohno 2013 (LEUKOS 10, 47): triangular solution where |Duv| < 0.002, parabolic elsewhere, on a 1 % table.
pub fn temperature(xyz: DVec3) -> Option<Temperature> {
    if !(xyz.is_finite() && xyz.y > 0.0) {
        return None;
    }
    let [u, v] = uv(xyz);
    let distance = |p: &[f64; 3]| (u - p[1]).hypot(v - p[2]);
    let (nearest, _) = LOCUS
        .iter()
        .enumerate()
        .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
    if nearest == 0 || nearest == LOCUS.len() - 1 {
        return None;
    }
    let [before, at, after] = [nearest - 1, nearest, nearest + 1].map(|i| LOCUS[i]);
    let (d0, d1, d2) = (distance(&before), distance(&at), distance(&after));
    // Triangle: the foot of the perpendicular on the chord between the neighbours.
    let chord = (after[1] - before[1]).hypot(after[2] - before[2]);
    let x = (d0 * d0 - d2 * d2 + chord * chord) / (2.0 * chord);
    let foot_v = before[2] + (after[2] - before[2]) * x / chord;
    let sign = if v >= foot_v { 1.0 } else { -1.0 };
    let triangle = (
        before[0] + (after[0] - before[0]) * x / chord,
        sign * (d0 * d0 - x * x).max(0.0).sqrt(),
    );
    // Parabola through the three distances.
    let (t0, t1, t2) = (before[0], at[0], after[0]);
    let spread = (t2 - t1) * (t0 - t2) * (t1 - t0);
    let a = (t0 * (d2 - d1) + t1 * (d0 - d2) + t2 * (d1 - d0)) / spread;
    let b = -(t0 * t0 * (d2 - d1) + t1 * t1 * (d0 - d2) + t2 * t2 * (d1 - d0)) / spread;
    let c =
        -(d0 * (t2 - t1) * t1 * t2 + d1 * (t0 - t2) * t0 * t2 + d2 * (t1 - t0) * t0 * t1) / spread;
    let (cct, duv) = if triangle.1.abs() < 0.002 {
        triangle
    } else {
        let t = -b / (2.0 * a);
        (t, sign * (a * t * t + b * t + c))
    };
    ((COLDEST..=HOTTEST).contains(&cct) && duv.abs() <= DUV_LIMIT)
        .then_some(Temperature { cct, duv })
}
