//! The clear air of a place as media: molecules and aerosol.
//!
//! Optical depths are those of the sun's model ([`Column`]): a vertical column tau over the site and an exponential profile of
//! scale height H leave the coefficient tau / H at the site.
//! - Molecules: H = R T / (M g) = 8 434 m at 288.15 K, with which both the column and the coefficient are the measured ones (a
//!   smaller H would make the air at the ground too dense); Rayleigh's phase function; no absorption.
//! - Aerosol: H = 1 200 m (Preetham, Shirley & Smits 1999, section 4: 0.8333 per km); of its extinction 0.925 is scattering,
//!   with the Henyey-Greenstein function of g = 0.703: the continental average of OPAC at 550 nm and 80 % humidity (Hess, Koepke
//!   & Schult 1998, table 4).

use super::phase::Phase;
use super::shape::{Medium, Shape};
use crate::error::Result;
use crate::sky::SunLight;
use crate::sky::sun::{Column, SunPath, outside_the_atmosphere};
use glam::DVec3;

/// Scale height of molecules [m].
pub const MOLECULES: f64 = 8_434.0;

/// Scale height of aerosol [m].
pub const AEROSOL: f64 = 1_200.0;

/// Share of the aerosol's extinction that is scattering [1].
pub const AEROSOL_ALBEDO: f64 = 0.925;

/// The aerosol's phase function.
pub const AEROSOL_PHASE: Phase = Phase::HenyeyGreenstein { g: 0.703 };

/// Distance up to which shadows in the air are seen on rays that meet nothing [m].
pub const FAR: f64 = 100e3;

/// What the clear air of a place is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClearAir {
    /// Turbidity [1]; absent: the sky's.
    pub turbidity: Option<f64>,
    /// Height in the scene of the site to which sun and sky belong [m]; absent: the ground's.
    pub base: Option<f64>,
    /// Distance up to which shadows in it are seen on rays that meet nothing [m].
    pub far: f64,
    /// Scale height of the molecules [m].
    pub molecules_scale_height: f64,
    /// Scale height of the aerosol [m].
    pub aerosol_scale_height: f64,
    /// Share of the aerosol's extinction that is scattering, 0 to 1.
    pub aerosol_albedo: f64,
    /// The aerosol's phase function.
    pub aerosol_phase: Phase,
}

impl Default for ClearAir {
    fn default() -> Self {
        ClearAir {
            turbidity: None,
            base: None,
            far: FAR,
            molecules_scale_height: MOLECULES,
            aerosol_scale_height: AEROSOL,
            aerosol_albedo: AEROSOL_ALBEDO,
            aerosol_phase: AEROSOL_PHASE,
        }
    }
}

/// Optical depths toward the sun of molecules and aerosol [1], from the site.
///
/// The column times the relative air mass of Kasten & Young 1989, as the sun's model has it: 38 at the horizon, where 1 / sin
/// diverges. Sunlight above all air is brighter by e^overhead; where the channels' mean coefficients would make it
/// brighter than it is outside the atmosphere (a low sun, of whose light the most penetrating is left), both are taken to the
/// share that gives just that.
///
/// # Errors
/// [`crate::Error::Domain`] when a quantity of `path` is outside its range.
pub fn overhead(column: &Column, path: &SunPath) -> Result<[DVec3; 2]> {
    let light = SunLight::new(path)?;
    let air_mass = light.air_mass.unwrap_or(1.0);
    let [molecules, aerosol] = [column.molecules, column.aerosol].map(|tau| air_mass * tau);
    let outside = outside_the_atmosphere(path.distance_au);
    let share = |i: usize| {
        let lost = (outside[i] / light.full_illuminance[i]).ln();
        (lost.max(0.0) / (molecules[i] + aerosol[i])).min(1.0)
    };
    let share = DVec3::new(share(0), share(1), share(2));
    Ok([share * molecules, share * aerosol])
}

/// The media of the clear air over a site whose height in the scene is `site` [m]; `path` is what its sunlight comes through.
///
/// # Errors
/// [`crate::Error::Domain`] when the turbidity or another quantity of `path` is outside its range.
pub fn media(air: &ClearAir, path: &SunPath, site: f64) -> Result<[Medium; 2]> {
    let column = Column::new(&SunPath {
        turbidity: air.turbidity.unwrap_or(path.turbidity),
        ..*path
    })?;
    let [over_molecules, over_aerosol] = overhead(&column, path)?;
    let shape = |scale_height, overhead| Shape::Air {
        base: air.base.unwrap_or(site),
        scale_height,
        far: air.far,
        overhead,
    };
    let aerosol = column.aerosol / air.aerosol_scale_height;
    Ok([
        Medium {
            shape: shape(air.molecules_scale_height, over_molecules),
            scattering: column.molecules / air.molecules_scale_height,
            absorption: DVec3::ZERO,
            phase: Phase::Rayleigh,
        },
        Medium {
            shape: shape(air.aerosol_scale_height, over_aerosol),
            scattering: air.aerosol_albedo * aerosol,
            absorption: (1.0 - air.aerosol_albedo) * aerosol,
            phase: air.aerosol_phase,
        },
    ])
}
