//! The all-weather sky of Perez, Seals & Michalsky 1993: luminance from two measured irradiances.
//!
//! Direct-normal and diffuse-horizontal irradiance give a clearness epsilon and a brightness Delta; epsilon picks one of
//! eight sets of coefficients, Delta and the sun's zenith angle Z make a to e of the [`Gradation`] from it. The sky is
//! scaled so that its horizontal illuminance is the diffuse irradiance times the diffuse luminous efficacy of Perez et
//! al. 1990, by an exact integral. (Radiance's gendaylit sums 145 patches instead and is 0.2 to 3 % dimmer.)
//!
//! The eight sets meet in steps: a pixel jumps by up to 1.6 times. [`Bins::Blended`], for pictures, goes from one set's
//! sky to its neighbour's over a quarter of each bin on both sides of the edge; [`Bins::Published`] does not.

use super::gradation::Gradation;
use super::model::Irradiance;
use crate::error::{Error, Result};
use crate::units::DEG;
use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

/// Whether the clearness bins are steps, as published, or blended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bins {
    /// Steps.
    Published,
    /// Continuous in clearness.
    Blended,
}

/// Lower edges of the eight clearness bins, and the upper edge of the last one (Radiance's limit).
pub const EDGES: [f64; 9] = [1.0, 1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2, 12.01];

/// The solar constant of the model [W/m2].
pub const SOLAR_CONSTANT: f64 = 1367.0;

/// Precipitable water that the efficacies take when nothing is known [cm].
pub const WATER_CM: f64 = 2.0;

/// x1 to x4 of a to e, eight bins.
static COEFFICIENTS: LazyLock<Vec<[[f64; 4]; 5]>> = LazyLock::new(|| {
    include_str!("../../data/perez1993_coefficients.csv")
        .lines()
        .skip(1)
        .map(|line| {
            let mut cells = line
                .split(',')
                .skip(3)
                .map(|c| c.parse().unwrap_or(f64::NAN));
            [(); 5].map(|()| [(); 4].map(|()| cells.next().unwrap_or(f64::NAN)))
        })
        .collect()
});

/// a to d of the diffuse luminous efficacy (Perez et al. 1990, table 4).
const DIFFUSE_EFFICACY: [[f64; 4]; 8] = [
    [97.24, -0.46, 12.00, -8.91],
    [107.22, 1.15, 0.59, -3.95],
    [104.97, 2.96, -5.53, -8.77],
    [102.39, 5.59, -13.95, -13.90],
    [100.71, 5.94, -22.75, -23.74],
    [106.42, 3.83, -36.15, -28.83],
    [141.88, 1.90, -53.24, -14.03],
    [152.23, 0.35, -45.27, -7.98],
];

/// a to d of the direct luminous efficacy (Perez et al. 1990, table 4).
const DIRECT_EFFICACY: [[f64; 4]; 8] = [
    [57.20, -4.55, -2.98, 117.12],
    [98.99, -3.46, -1.21, 12.38],
    [109.83, -4.90, -1.71, -8.81],
    [110.34, -5.84, -1.99, -4.56],
    [106.36, -3.97, -1.75, -6.16],
    [107.19, -1.25, -1.51, -26.73],
    [105.75, 0.77, -1.26, -34.44],
    [101.18, 1.58, -1.10, -8.29],
];

/// The state of the sky that two irradiances describe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Clearness [1], 1 (overcast) to 12.01 (very clear).
    pub clearness: f64,
    /// Brightness [1], 0.01 to 0.6.
    pub brightness: f64,
    /// The sun's zenith angle [rad], 3 to 90 degrees.
    pub zenith_angle: f64,
    /// Whether a limit of the model (clearness, brightness, or 87 degrees of elevation) was met.
    pub limited: bool,
    bins: [(usize, f64); 2],
}

impl State {
    /// The state for an irradiance, a solar zenith angle [rad] below pi/2 and a distance [au].
    ///
    /// epsilon = ((Edh + Ebn) / Edh + 1.041 Z^3) / (1 + 1.041 Z^3), Delta = m Edh / (1367 / R^2), m by Kasten 1965.
    ///
    /// Limits are Radiance's: epsilon 1 to 12.01, Delta 0.01 to 0.6, Z at least 3 degrees; all are continuous.
    /// Errors: [`Error::Domain`] for an irradiance that is negative, not finite, or without diffuse part, or a sun that is down.
    pub fn new(
        irradiance: Irradiance,
        zenith_angle: f64,
        distance_au: f64,
        bins: Bins,
    ) -> Result<Self> {
        let Irradiance {
            direct_normal,
            diffuse_horizontal,
        } = irradiance;
        if !(0.0..=1500.0).contains(&direct_normal) {
            return Err(Error::domain(
                "the direct-normal irradiance",
                format!("{direct_normal} W/m2"),
                "0 to 1500 W/m2",
                "give what falls on a plane that faces the sun",
            ));
        }
        if !(diffuse_horizontal > 0.0 && diffuse_horizontal <= 1500.0) {
            return Err(Error::domain(
                "the diffuse-horizontal irradiance",
                format!("{diffuse_horizontal} W/m2"),
                "above 0, to 1500 W/m2",
                "by day the sky always gives some: check the row and the time",
            ));
        }
        if !(0.0..FRAC_PI_2).contains(&zenith_angle) {
            return Err(Error::domain(
                "the sun's elevation for the Perez sky",
                format!("{} degrees", 90.0 - zenith_angle / DEG),
                "above 0, to 90 degrees",
                "the model as published has no sky for a sun below the horizon",
            ));
        }
        let z = zenith_angle.max(3.0 * DEG);
        let z3 = 1.041 * z.powi(3);
        let clearness =
            ((diffuse_horizontal + direct_normal) / diffuse_horizontal + z3) / (1.0 + z3);
        let brightness = kasten_1965(zenith_angle) * diffuse_horizontal
            / (SOLAR_CONSTANT / (distance_au * distance_au));
        let state = State {
            clearness: clearness.clamp(1.0, 12.01),
            brightness: brightness.clamp(0.01, 0.6),
            zenith_angle: z,
            limited: false,
            bins: [(0, 0.0); 2],
        };
        Ok(State {
            limited: state.clearness != clearness
                || state.brightness != brightness
                || z != zenith_angle,
            bins: weigh(state.clearness, bins),
            ..state
        })
    }

    /// The one or two gradations that make the sky, with their weights, which sum to 1; and whether b > 0 had to be made 0.
    pub fn gradations(&self) -> ([(Gradation, f64); 2], bool) {
        let mut lifted = false;
        let parts = self.bins.map(|(bin, weight)| {
            let mut c = coefficients(bin, self.zenith_angle, self.brightness);
            // With b > 0 the horizon diverges; at b = 0 it is only brighter by 1 + a.
            if c[1] > 0.0 {
                lifted |= weight > 0.0;
                c[1] = 0.0;
            }
            (Gradation::perez(c), weight)
        });
        (parts, lifted)
    }

    /// Diffuse luminous efficacy [lm/W] for precipitable water [cm]: a + b W + c cos Z + d ln Delta.
    pub fn diffuse_efficacy(&self, water_cm: f64) -> f64 {
        self.weighted(|bin| {
            let [a, b, c, d] = DIFFUSE_EFFICACY[bin];
            a + b * water_cm + c * self.zenith_angle.cos() + d * self.brightness.ln()
        })
    }

    /// Direct luminous efficacy [lm/W] for precipitable water [cm]: a + b W + c e^(5.73 Z - 5) + d Delta, not negative.
    pub fn direct_efficacy(&self, water_cm: f64) -> f64 {
        self.weighted(|bin| {
            let [a, b, c, d] = DIRECT_EFFICACY[bin];
            a + b * water_cm + c * (5.73 * self.zenith_angle - 5.0).exp() + d * self.brightness
        })
        .max(0.0)
    }

    fn weighted(&self, f: impl Fn(usize) -> f64) -> f64 {
        self.bins.iter().map(|(bin, weight)| f(*bin) * weight).sum()
    }
}

/// a to e of one clearness bin (0 to 7) for a solar zenith angle [rad] and a brightness [1] (Perez et al. 1993, equations 6 to 8).
///
/// Differs: between clearness 1.065 and 2.8 brightness is at least 0.2, as in Radiance: the fit has no data below.
pub fn coefficients(bin: usize, z: f64, brightness: f64) -> [f64; 5] {
    let delta = if (1..=4).contains(&bin) {
        brightness.max(0.2)
    } else {
        brightness
    };
    let table = &COEFFICIENTS[bin];
    let mut c = table.map(|[x1, x2, x3, x4]| x1 + x2 * z + delta * (x3 + x4 * z));
    if bin == 0 {
        let [c1, c2, c3, c4] = table[2];
        let [d1, d2, d3, d4] = table[3];
        c[2] = (delta * (c1 + c2 * z)).powf(c3).exp() - c4;
        c[3] = -(delta * (d1 + d2 * z)).exp() + d3 + delta * d4;
    }
    c
}

/// Relative optical air mass [1] of Kasten 1965 for a zenith angle [rad] up to 93 degrees: the one of the model.
pub fn kasten_1965(zenith_angle: f64) -> f64 {
    1.0 / (zenith_angle.cos() + 0.15 * (93.885 - zenith_angle / DEG).powf(-1.253))
}

/// The bins that a clearness draws from and their weights.
fn weigh(clearness: f64, bins: Bins) -> [(usize, f64); 2] {
    let bin = (1..8).take_while(|i| clearness >= EDGES[*i]).count();
    if bins == Bins::Published {
        return [(bin, 1.0), (bin, 0.0)];
    }
    let quarter = |bin: usize| 0.25 * (EDGES[bin + 1].min(8.0) - EDGES[bin]);
    for edge in [bin, bin + 1] {
        if !(1..=7).contains(&edge) {
            continue;
        }
        let (low, high) = (EDGES[edge] - quarter(edge - 1), EDGES[edge] + quarter(edge));
        if (low..high).contains(&clearness) {
            let above = super::twilight::smoothstep(low, high, clearness);
            return [(edge - 1, 1.0 - above), (edge, above)];
        }
    }
    [(bin, 1.0), (bin, 0.0)]
}

/// Irradiance under a clear sky, by Ineichen & Perez 2002 (Solar Energy 73, 151).
///
/// `elevation` is the sun's apparent elevation [rad] above 0, `linke` the Linke turbidity at air mass 2 (1 to 10),
/// `site_elevation` in metres (-500 to 9000), `distance_au` about 1.
pub fn clear_sky(elevation: f64, linke: f64, site_elevation: f64, distance_au: f64) -> Irradiance {
    let extraterrestrial = SOLAR_CONSTANT / (distance_au * distance_au);
    // The standard atmosphere's pressure over that at sea level.
    let pressure = (1.0 - 2.255_77e-5 * site_elevation).powf(5.255_88);
    let mass = super::sun::relative_air_mass(elevation) * pressure;
    let fh1 = (-site_elevation / 8000.0).exp();
    let fh2 = (-site_elevation / 1250.0).exp();
    let cg1 = 5.09e-5 * site_elevation + 0.868;
    let cg2 = 3.92e-5 * site_elevation + 0.0387;
    let global = cg1
        * extraterrestrial
        * elevation.sin()
        * (-cg2 * mass * (fh1 + fh2 * (linke - 1.0))).exp();
    let b = 0.664 + 0.163 / fh1;
    let direct = extraterrestrial * b * (-0.09 * mass * (linke - 1.0)).exp();
    let most =
        global * (1.0 - (0.1 - 0.2 * (-linke).exp()) / (0.1 + 0.882 / fh1)) / elevation.sin();
    let direct_normal = direct.min(most);
    Irradiance {
        direct_normal,
        diffuse_horizontal: global - direct_normal * elevation.sin(),
    }
}
