//! The CIE 1931 2 degree observer: from spectra to XYZ.

use crate::units::LUMINOUS_EFFICACY;
use glam::DVec3;
use std::sync::LazyLock;

/// First wavelength of the table [nm].
pub const FIRST_NM: f64 = 360.0;

/// Last wavelength of the table [nm].
pub const LAST_NM: f64 = 830.0;

/// Step of the table [nm].
pub const STEP_NM: f64 = 5.0;

static TABLE: LazyLock<Vec<DVec3>> = LazyLock::new(|| {
    include_str!("../../data/cie1931_2deg.csv")
        .lines()
        .skip(1)
        .map(|line| {
            let mut cells = line
                .split(',')
                .skip(1)
                .map(|c| c.parse().unwrap_or(f64::NAN));
            DVec3::from_array([(); 3].map(|()| cells.next().unwrap_or(f64::NAN)))
        })
        .collect()
});

/// The colour-matching functions x, y, z [1] at a wavelength [nm], linear between the table's 5 nm; zero outside 360 to 830 nm.
///
/// Source: CIE 018:2019 (the table of CIE 1931), `data/cie1931_2deg.csv`.
pub fn matching_functions(wavelength_nm: f64) -> DVec3 {
    let at = (wavelength_nm - FIRST_NM) / STEP_NM;
    if !(0.0..=(TABLE.len() - 1) as f64).contains(&at) {
        return DVec3::ZERO;
    }
    let below = (at.floor() as usize).min(TABLE.len() - 2);
    TABLE[below].lerp(TABLE[below + 1], at - below as f64)
}

/// XYZ of a spectrum given per nm: photometric (Y in lm/m2 for W/(m2 nm), in cd/m2 for W/(m2 sr nm)).
///
/// `spectrum` is read at every 5 nm from 360 to 830 nm and summed: within 0.009 Delta E 2000 of a 1 nm sum for daylight.
///
/// Source: CIE 015:2018, equation 7.1, with 683.002 lm/W.
pub fn xyz_from_spectrum(spectrum: impl Fn(f64) -> f64) -> DVec3 {
    let sum: DVec3 = TABLE
        .iter()
        .enumerate()
        .map(|(i, bar)| *bar * spectrum(FIRST_NM + STEP_NM * i as f64))
        .sum();
    sum * (LUMINOUS_EFFICACY * STEP_NM)
}
