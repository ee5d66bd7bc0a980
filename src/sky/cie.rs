//! The CIE standard general skies, CIE S 011/E:2003 (ISO 15469:2004), and the traditional overcast sky.
//!
//! L / Lz = phi(Z) f(chi) / (phi(0) f(Zs)). The standard says nothing about level. A diffuse irradiance gives it; without
//! one it is the diffuse illuminance that Kittler & Darula find typical of the type: Dv = (Dv/Ev) 133.8 klx sin(elevation).
//! Differs: the sky is scaled to Dv by an exact integral rather than through their zenith luminance formula, which
//! agrees within 4.2 % from 5 to 75 degrees and has a pole at 90.

use super::gradation::Gradation;
use crate::error::{Error, Result};

/// a and b of the six gradation groups.
const GRADATION: [[f64; 2]; 6] = [
    [4.0, -0.70],
    [1.1, -0.80],
    [0.0, -1.00],
    [-1.0, -0.55],
    [-1.0, -0.32],
    [-1.0, -0.15],
];

/// c, d and e of the six indicatrix groups.
const INDICATRIX: [[f64; 3]; 6] = [
    [0.0, -1.0, 0.00],
    [2.0, -1.5, 0.15],
    [5.0, -2.5, 0.30],
    [10.0, -3.0, 0.45],
    [16.0, -3.0, 0.30],
    [24.0, -2.8, 0.15],
];

/// Gradation and indicatrix group (from 1) of types 1 to 15, and the typical Dv/Ev (Kittler, Perez & Darula 1998).
const TYPES: [(usize, usize, f64); 15] = [
    (1, 1, 0.10),
    (1, 2, 0.18),
    (2, 1, 0.15),
    (2, 2, 0.22),
    (3, 1, 0.20),
    (3, 2, 0.38),
    (3, 3, 0.42),
    (3, 4, 0.41),
    (4, 2, 0.40),
    (4, 3, 0.36),
    (4, 4, 0.23),
    (5, 4, 0.10),
    (5, 5, 0.28),
    (6, 5, 0.28),
    (6, 6, 0.30),
];

/// Illuminance of the sun outside the atmosphere [lx], as Kittler & Darula have it.
pub const SOLAR_ILLUMINANCE: f64 = 133_800.0;

/// A CIE sky type, 1 to 16.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind(u8);

impl Kind {
    /// The type of that number; 16 is the traditional overcast sky.
    ///
    /// Errors: [`Error::Domain`] outside 1 to 16.
    pub fn new(number: u8) -> Result<Self> {
        if (1..=16).contains(&number) {
            return Ok(Kind(number));
        }
        Err(Error::domain(
            "the CIE sky type",
            number,
            "1 to 16",
            "1 is overcast, 5 uniform, 12 clear, 16 the traditional overcast sky",
        ))
    }

    /// The relative luminance distribution; not normalised.
    pub fn gradation(self) -> Gradation {
        match TYPES.get(usize::from(self.0) - 1) {
            Some((gradation, indicatrix, _)) => {
                let [a, b] = GRADATION[gradation - 1];
                let [c, d, e] = INDICATRIX[indicatrix - 1];
                Gradation::cie([a, b, c, d, e])
            }
            None => Gradation::traditional_overcast(),
        }
    }

    /// Diffuse over extraterrestrial horizontal illuminance [1] typical of the type; the traditional overcast sky has type 1's.
    pub fn typical_diffuse_share(self) -> f64 {
        TYPES
            .get(usize::from(self.0) - 1)
            .map_or(TYPES[0].2, |t| t.2)
    }

    /// Whether clouds hide the sun's disc: types 1 to 6 and 16.
    pub fn hides_sun(self) -> bool {
        self.0 <= 6 || self.0 == 16
    }

    /// How much of the sky's light comes from clouds [1]: 1 overcast, 0 cloudless. It sets how grey the sky is.
    pub fn cloud_share(self) -> f64 {
        match self.0 {
            1..=5 | 16 => 1.0,
            6 => 0.8,
            7 | 8 => 0.5,
            9 | 10 => 0.4,
            _ => 0.0,
        }
    }
}
