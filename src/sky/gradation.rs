//! The form that the Perez, Preetham and CIE skies share: a gradation from zenith to horizon times an indicatrix around the sun.

use std::f64::consts::FRAC_PI_2;

/// Cosine of the zenith angle below which gradations are held at this value.
///
/// 0.57 degrees above the horizon; Radiance's gendaylit has the same floor. exp(B / cos theta) has no limit at the
/// horizon when B > 0 and an infinitely thin layer when B is small.
pub const COSINE_FLOOR: f64 = 0.01;

/// (1 + A e^(B / cos theta)) (1 + C (e^(D gamma) - e0) + E cos^2 gamma): Perez et al. 1993, equation 1.
///
/// theta is the zenith angle of the direction, gamma its angle from the sun. `e0` is 0 for Perez and Preetham and
/// e^(D pi / 2) for the CIE general sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gradation {
    /// Darkening (A < 0) or brightening (A > 0) of the horizon.
    pub a: f64,
    /// Steepness of the gradation near the horizon; negative in a physical sky.
    pub b: f64,
    /// Relative height of the circumsolar region.
    pub c: f64,
    /// Its narrowness [1/rad], negative.
    pub d: f64,
    /// Relative amount of backscattered light.
    pub e: f64,
    e0: f64,
    traditional: bool,
}

impl Gradation {
    /// The form of Perez et al. 1993.
    pub fn perez([a, b, c, d, e]: [f64; 5]) -> Self {
        Gradation {
            a,
            b,
            c,
            d,
            e,
            e0: 0.0,
            traditional: false,
        }
    }

    /// The form of CIE S 011/E:2003, whose indicatrix is 1 at a right angle from the sun.
    pub fn cie([a, b, c, d, e]: [f64; 5]) -> Self {
        Gradation {
            a,
            b,
            c,
            d,
            e,
            e0: (d * FRAC_PI_2).exp(),
            traditional: false,
        }
    }

    /// The traditional CIE overcast sky, (1 + 2 cos theta) / 3 (Moon & Spencer 1942), which has no such form.
    pub fn traditional_overcast() -> Self {
        Gradation {
            traditional: true,
            ..Gradation::perez([0.0; 5])
        }
    }

    /// The value [1], relative: toward a direction of zenith-angle cosine `cos_theta` at angle `gamma` [rad] from the sun.
    pub fn value(&self, cos_theta: f64, gamma: f64, cos_gamma: f64) -> f64 {
        self.gradation(cos_theta) * self.indicatrix(gamma, cos_gamma)
    }

    /// The first factor [1], over the cosine of the zenith angle.
    pub fn gradation(&self, cos_theta: f64) -> f64 {
        if self.traditional {
            return (1.0 + 2.0 * cos_theta.max(0.0)) / 3.0;
        }
        1.0 + self.a * (self.b / cos_theta.max(COSINE_FLOOR)).exp()
    }

    /// Coefficients s, a, b, o, c of the first factor in the form s (1 + a e^(b / max(x + o, [`COSINE_FLOOR`])) + c x), x being
    /// the cosine of the zenith angle.
    pub(super) fn coefficients(&self) -> [f64; 5] {
        if self.traditional {
            [1.0 / 3.0, 0.0, 0.0, 0.0, 2.0]
        } else {
            [1.0, self.a, self.b, 0.0, 0.0]
        }
    }

    /// The second factor [1], over the angle from the sun [rad] and its cosine; 1 for the traditional overcast sky.
    pub fn indicatrix(&self, gamma: f64, cos_gamma: f64) -> f64 {
        1.0 + self.c * ((self.d * gamma).exp() - self.e0) + self.e * cos_gamma * cos_gamma
    }
}
