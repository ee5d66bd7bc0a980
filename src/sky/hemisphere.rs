//! Integrals over the sky dome: relative error 1e-4 for every model by day, 1e-3 in deep twilight, whose arch is thin.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

const NODES: usize = 24;

static GAUSS: LazyLock<[(f64, f64); NODES]> = LazyLock::new(gauss_legendre);

/// Integral over the upper hemisphere of f(w) (w . up) dw: the horizontal illuminance of radiance f.
///
/// `f` is given unit directions in a frame with +Y up in which the sun stands over +X (or, with `sun_zenith_angle` above
/// pi/2, under it), and must be symmetric about the XY plane. Gauss-Legendre in zenith angle and azimuth, both split at
/// and crowded toward the sun, where the skies have a cusp.
pub fn horizontal_integral(sun_zenith_angle: f64, f: impl Fn(DVec3) -> DVec3) -> DVec3 {
    let split = sun_zenith_angle.clamp(0.0, FRAC_PI_2);
    let mut sum = DVec3::ZERO;
    for (start, end) in [(split, 0.0), (split, FRAC_PI_2)] {
        let width: f64 = end - start;
        if width == 0.0 {
            continue;
        }
        for (u, du) in *GAUSS {
            let theta = start + width * u * u;
            let (sin, cos) = theta.sin_cos();
            let ring = sin * cos * 2.0 * u * du * width.abs();
            for (v, dv) in *GAUSS {
                let (sin_phi, cos_phi) = (PI * v * v).sin_cos();
                let w = ring * 2.0 * v * dv * PI * 2.0;
                sum += f(DVec3::new(sin * cos_phi, cos, sin * sin_phi)) * w;
            }
        }
    }
    sum
}

/// The same of a product of what depends on height, by the cosine of the zenith angle, and of what depends on the angle from the
/// sun [rad] and its cosine; `held` makes of the product what is summed.
///
/// Half the exponentials of [`horizontal_integral`], and a quarter of the time.
pub fn product_integral(
    sun_zenith_angle: f64,
    over_height: impl Fn(f64) -> f64,
    around_sun: impl Fn(f64, f64) -> f64,
    held: impl Fn(f64) -> f64,
) -> f64 {
    let split = sun_zenith_angle.clamp(0.0, FRAC_PI_2);
    let (sin_sun, cos_sun) = sun_zenith_angle.sin_cos();
    let mut sum = 0.0;
    for (start, end) in [(split, 0.0), (split, FRAC_PI_2)] {
        let width: f64 = end - start;
        if width == 0.0 {
            continue;
        }
        for (u, du) in *GAUSS {
            let (sin, cos) = (start + width * u * u).sin_cos();
            let height = over_height(cos);
            let ring: f64 = TURNS
                .iter()
                .map(|(cos_phi, weight)| {
                    let cos_gamma = (cos * cos_sun + sin * sin_sun * cos_phi).clamp(-1.0, 1.0);
                    held(height * around_sun(cos_gamma.acos(), cos_gamma)) * weight
                })
                .sum();
            sum += ring * (sin * cos * 2.0 * u * du * width.abs());
        }
    }
    sum
}

/// Cosine of the azimuth and weight of each place on a ring.
static TURNS: LazyLock<[(f64, f64); NODES]> =
    LazyLock::new(|| GAUSS.map(|(v, dv)| ((PI * v * v).cos(), 2.0 * v * dv * PI * 2.0)));

/// Abscissae and weights on 0 to 1.
fn gauss_legendre() -> [(f64, f64); NODES] {
    std::array::from_fn(|i| {
        let n = NODES as f64;
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..100 {
            let (mut p0, mut p1) = (1.0, x);
            for k in 2..=NODES {
                let k = k as f64;
                (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
            }
            slope = n * (x * p1 - p0) / (x * x - 1.0);
            let step = p1 / slope;
            x -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
}
