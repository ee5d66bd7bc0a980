//! Daylight for architects: sensors on grids, daylight factors, hours of sun, a year of weather and its metrics.
//!
//! - [`grid`]: sensors on floors, rooms and surfaces, from what a user asks for
//! - [`floor`], [`inside`], [`outline`], [`section`]: where floors are, what stands in walls, areas, where a plane cuts the model
//! - [`assumed`]: reflectances where the mesh has none
//! - [`factor`]: daylight factors, and what is said of the values of a grid
//! - [`map`]: a grid's values as a drawing

pub mod assumed;
pub mod factor;
pub mod floor;
pub mod grid;
pub mod inside;
pub mod map;
pub mod outline;
mod plane;
pub mod section;
mod spec;
