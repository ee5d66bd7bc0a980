//! Daylight for architects: sensors on grids, daylight factors, hours of sun, a year of weather and its metrics.
//!
//! - [`grid`]: sensors on floors, rooms and surfaces, from what a user asks for
//! - [`floor`], [`inside`], [`outline`]: where floors are, what stands in walls, areas

pub mod floor;
pub mod grid;
pub mod inside;
pub mod outline;
mod plane;
mod spec;
