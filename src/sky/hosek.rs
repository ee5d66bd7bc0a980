//! The sky of Hosek & Wilkie 2012: a fit to path-traced skies, for turbidity 1 to 10, ground albedo 0 to 1 and a sun that is up.
//!
//! The RGB data set (linear Rec. 709) of the authors, evaluated in f64. Its values times 683.002 lm/W are cd/m2.

use crate::error::{Error, Result};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

/// What the data set has for each of 2 albedos x 10 turbidities x 6 knots.
const ROWS: usize = 2 * 10 * 6;

/// Nine parameters of each channel's distribution, then the three radiances: what is mixed stands side by side.
static DATA: LazyLock<Vec<[f64; 30]>> = LazyLock::new(|| {
    // The file has them channel by channel: all parameters, then all radiances.
    let values = include_bytes!("../../data/hosek2012_rgb.bin")
        .as_chunks::<4>()
        .0;
    let value = |i: usize| f64::from(f32::from_le_bytes(values[i]));
    (0..ROWS)
        .map(|row| {
            std::array::from_fn(|i| match i {
                0..27 => value(9 * (i / 9 * ROWS + row) + i % 9),
                _ => value(i * ROWS + row),
            })
        })
        .collect()
});

/// cd/m2 of one unit of the data set: the luminous efficacy, since the set's matching functions are the CIE's [lm/W].
const UNIT: f64 = crate::units::LUMINOUS_EFFICACY;

/// The model for one turbidity, albedo and height of the sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hosek {
    parameters: [[f64; 9]; 3],
    radiance: [f64; 3],
}

impl Hosek {
    /// The model for turbidity [1], 1 to 10, ground albedo [1], 0 to 1, and solar elevation [rad], 0 to pi/2.
    ///
    /// Errors: [`Error::Domain`] outside these.
    pub fn new(turbidity: f64, albedo: f64, elevation: f64) -> Result<Self> {
        if !(1.0..=10.0).contains(&turbidity) {
            return Err(Error::domain(
                "the turbidity",
                turbidity,
                "1 to 10",
                "2 is a very clear day, 10 is haze",
            ));
        }
        if !(0.0..=1.0).contains(&albedo) {
            return Err(Error::domain(
                "the ground's albedo",
                albedo,
                "0 to 1",
                "0.2 is usual",
            ));
        }
        if !(0.0..=FRAC_PI_2).contains(&elevation) {
            return Err(Error::domain(
                "the sun's elevation for the Hosek-Wilkie sky",
                format!("{} degrees", elevation.to_degrees()),
                "0 to 90 degrees",
                "the model as published has no sky for a sun below the horizon",
            ));
        }
        let knots = bernstein((elevation / FRAC_PI_2).cbrt());
        // Linear in turbidity between the ten of the data, and in albedo between its two.
        let below = (turbidity.floor() as usize).clamp(1, 9);
        let part = turbidity - below as f64;
        let corners = [
            (below - 1, (1.0 - albedo) * (1.0 - part)),
            (below, (1.0 - albedo) * part),
            (10 + below - 1, albedo * (1.0 - part)),
            (10 + below, albedo * part),
        ];
        let mut sums = [0.0; 30];
        for (set, weight) in corners {
            for (row, knot) in DATA[6 * set..6 * set + 6].iter().zip(knots) {
                for (sum, value) in sums.iter_mut().zip(row) {
                    *sum += weight * knot * value;
                }
            }
        }
        Ok(Hosek {
            parameters: std::array::from_fn(|c| std::array::from_fn(|i| sums[9 * c + i])),
            radiance: std::array::from_fn(|c| sums[27 + c] * UNIT),
        })
    }

    /// Linear Rec. 709 [cd/m2] toward zenith-angle cosine `cos_theta` >= 0 at angle `gamma` [rad] from the sun.
    pub fn rec709(&self, cos_theta: f64, gamma: f64, cos_gamma: f64) -> DVec3 {
        let (factor, addend) = self.over_height(cos_theta);
        factor * (self.around_sun(gamma, cos_gamma) + addend)
    }

    /// What depends on height alone: a factor [cd/m2], and an addend to [`Self::around_sun`] [1].
    pub fn over_height(&self, cos_theta: f64) -> (DVec3, DVec3) {
        let cos_theta = cos_theta.max(0.0);
        let zenith = cos_theta.sqrt();
        let channels = |f: &dyn Fn(usize) -> f64| DVec3::new(f(0), f(1), f(2));
        let factor = channels(&|c| {
            let [a, b, ..] = self.parameters[c];
            self.radiance[c] * (1.0 + a * (b / (cos_theta + 0.01)).exp())
        });
        (factor, channels(&|c| self.parameters[c][7] * zenith))
    }

    /// Coefficients of what depends on height, per channel: s, a, b, o, c as of [`super::gradation::Gradation`], and h of the
    /// addend h sqrt(x).
    pub(super) fn coefficients(&self) -> [[f64; 6]; 3] {
        std::array::from_fn(|c| {
            let [a, b, .., h, _] = self.parameters[c];
            [self.radiance[c], a, b, 0.01, 0.0, h]
        })
    }

    /// What depends on the angle from the sun [rad] alone [1].
    pub fn around_sun(&self, gamma: f64, cos_gamma: f64) -> DVec3 {
        let cos2 = cos_gamma * cos_gamma;
        let channel = |c: usize| {
            let [_, _, base, d, e, f, g, _, i] = self.parameters[c];
            let base_of_mie = 1.0 + i * i - 2.0 * i * cos_gamma;
            let mie = (1.0 + cos2) / (base_of_mie * base_of_mie.sqrt());
            base + d * (e * gamma).exp() + f * cos2 + g * mie
        };
        DVec3::new(channel(0), channel(1), channel(2))
    }
}

/// Bernstein polynomials of degree 5 at t.
fn bernstein(t: f64) -> [f64; 6] {
    let s = 1.0 - t;
    [
        s.powi(5),
        5.0 * s.powi(4) * t,
        10.0 * s.powi(3) * t * t,
        10.0 * s * s * t.powi(3),
        5.0 * s * t.powi(4),
        t.powi(5),
    ]
}
