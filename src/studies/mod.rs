//! What accuracy costs: measurements of this program by itself.

pub mod ephemeris;
pub mod sky;
