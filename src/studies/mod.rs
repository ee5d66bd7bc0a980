//! What accuracy costs: measurements of this program by itself.

pub mod ephemeris;
pub mod pareto;
pub mod scenes;
pub mod shafts;
pub mod sky;
