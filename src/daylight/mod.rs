//! Daylight for architects: sensors on grids, daylight factors, hours of sun, a year of weather and its metrics.

pub mod epw;
pub mod hours;
