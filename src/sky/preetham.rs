//! The daylight of Preetham, Shirley & Smits 1999: Perez's function refitted to Y, x and y, from turbidity alone.
//!
//! This is what the ReLiShaft paper calls the Perez sky colour. Its chromaticities are close to those of better models;
//! its luminance is 1.5 to 2.8 times too high (diffuse horizontal illuminance against Hosek & Wilkie 2012 at turbidity 2
//! to 3; Radiance's genssky and Perez side with the latter), and it breaks outside turbidity 2 to 10: F(0, theta_s)
//! changes sign at 1.64, and a low sun gives a negative zenith luminance above 12.

use super::gradation::Gradation;
use crate::error::{Error, Result};
use glam::{DVec3, Vec3Swizzles};
use std::f64::consts::{FRAC_PI_2, PI};

/// Turbidities for which the fit can be used.
pub const TURBIDITY: std::ops::RangeInclusive<f64> = 2.0..=10.0;

/// Slope and offset in turbidity of A, B, C, D, E, for Y, x and y (appendix A.2, as printed: four digits).
///
/// The authors' program carries a fifth digit; the two differ by up to 3.6e-3 in x, y at turbidity 10.
const DISTRIBUTION: [[[f64; 2]; 5]; 3] = [
    [
        [0.1787, -1.4630],
        [-0.3554, 0.4275],
        [-0.0227, 5.3251],
        [0.1206, -2.5771],
        [-0.0670, 0.3703],
    ],
    [
        [-0.0193, -0.2592],
        [-0.0665, 0.0008],
        [-0.0004, 0.2125],
        [-0.0641, -0.8989],
        [-0.0033, 0.0452],
    ],
    [
        [-0.0167, -0.2608],
        [-0.0950, 0.0092],
        [-0.0079, 0.2102],
        [-0.0441, -1.6537],
        [-0.0109, 0.0529],
    ],
];

/// Zenith x: rows for T^2, T, 1; columns for theta_s^3, theta_s^2, theta_s, 1.
const ZENITH_X: [[f64; 4]; 3] = [
    [0.00166, -0.00375, 0.00209, 0.0],
    [-0.02903, 0.06377, -0.03202, 0.00394],
    [0.11693, -0.21196, 0.06052, 0.25886],
];

/// Zenith y, laid out as [`ZENITH_X`].
const ZENITH_Y: [[f64; 4]; 3] = [
    [0.00275, -0.00610, 0.00317, 0.0],
    [-0.04214, 0.08970, -0.04153, 0.00516],
    [0.15346, -0.26756, 0.06670, 0.26688],
];

/// The model for one turbidity and one height of the sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preetham {
    /// Y [cd/m2], x, y of the zenith over F(0, theta_s).
    scale: [f64; 3],
    form: [Gradation; 3],
}

impl Preetham {
    /// The model for a turbidity and a solar zenith angle [rad], 0 to pi/2.
    ///
    /// Errors: [`Error::Domain`] for a turbidity outside 2 to 10 or a sun below the horizon.
    pub fn new(turbidity: f64, sun_zenith_angle: f64) -> Result<Self> {
        check_turbidity(turbidity)?;
        if !(0.0..=FRAC_PI_2).contains(&sun_zenith_angle) {
            return Err(Error::domain(
                "the sun's elevation for the Preetham sky",
                format!("{} degrees", 90.0 - sun_zenith_angle.to_degrees()),
                "0 to 90 degrees",
                "the model as published has no sky for a sun below the horizon",
            ));
        }
        let (t, s) = (turbidity, sun_zenith_angle);
        let form = DISTRIBUTION
            .map(|rows| Gradation::perez(rows.map(|[slope, offset]| slope * t + offset)));
        let zenith = [
            zenith_luminance(t, s),
            polynomial(&ZENITH_X, t, s),
            polynomial(&ZENITH_Y, t, s),
        ];
        let scale = std::array::from_fn(|i| zenith[i] / form[i].value(1.0, s, s.cos()));
        Ok(Preetham { scale, form })
    }

    /// (x, y, Y [cd/m2]) toward a direction of zenith-angle cosine `cos_theta` at angle `gamma` [rad] from the sun.
    pub fn xyy(&self, cos_theta: f64, gamma: f64, cos_gamma: f64) -> DVec3 {
        let factors = self.over_height(cos_theta) * self.around_sun(gamma, cos_gamma);
        factors.yzx()
    }

    /// What depends on height alone: factors of Y [cd/m2], x, y.
    pub fn over_height(&self, cos_theta: f64) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|i| {
            self.scale[i] * self.form[i].gradation(cos_theta)
        }))
    }

    /// Coefficients of what depends on height, of Y, x, y, as those of the Hosek-Wilkie sky.
    pub(super) fn coefficients(&self) -> [[f64; 6]; 3] {
        std::array::from_fn(|i| {
            let [s, a, b, o, c] = self.form[i].coefficients();
            [s * self.scale[i], a, b, o, c, 0.0]
        })
    }

    /// What depends on the angle from the sun [rad] alone: factors of Y, x, y [1].
    pub fn around_sun(&self, gamma: f64, cos_gamma: f64) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|i| {
            self.form[i].indicatrix(gamma, cos_gamma)
        }))
    }
}

/// [`Error::Domain`] for a turbidity outside 2 to 10.
pub fn check_turbidity(turbidity: f64) -> Result<()> {
    if TURBIDITY.contains(&turbidity) {
        return Ok(());
    }
    Err(Error::domain(
        "the turbidity of the Preetham sky",
        turbidity,
        "2 to 10",
        "its fit turns negative outside: take 2 for a very clear day, or `--sky hosek`, which holds from 1",
    ))
}

/// Zenith luminance [cd/m2] (appendix A.2).
fn zenith_luminance(t: f64, s: f64) -> f64 {
    let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * s);
    1000.0 * ((4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192)
}

fn polynomial(rows: &[[f64; 4]; 3], t: f64, s: f64) -> f64 {
    let in_s = rows.map(|[c3, c2, c1, c0]| ((c3 * s + c2) * s + c1) * s + c0);
    (in_s[0] * t + in_s[1]) * t + in_s[2]
}
