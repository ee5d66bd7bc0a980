//! Daylight for architects: sensors on grids, daylight factors, hours of sun, a year of weather and its metrics.
//!
//! - [`grid`]: sensors on floors, rooms and surfaces, from what a user asks for
//! - [`floor`], `opening`, [`inside`], `reached`, [`outline`], [`section`]: where floors and openings are, what stands in walls, where daylight comes to, areas, where a plane cuts the model
//! - [`assumed`]: reflectances where the mesh has none
//! - [`factor`]: daylight factors, and what is said of the values of a grid
//! - [`map`]: a grid's values as a drawing
//! - [`raster`]: the same as an OpenEXR file
//! - [`epw`], [`hours`]: weather files, and the sun and the sky of each of their hours
//! - [`year`], [`table`], [`metrics`], [`figures`]: the illuminance of sensors hour by hour, and what standards make of it
//! - [`glazing`]: other glass in the same windows
//! - [`blinds`]: closed by groups of windows while the sun is too much
//! - [`view`]: what is seen through panes from where sensors are
//! - [`report`], [`page`], [`heat_map`]: what is told of it, as numbers and as one page
//! - [`direct_sun`], [`sun_hours`]: what comes straight from the sun, and for how long on a day

pub mod assumed;
pub mod blinds;
pub mod direct_sun;
pub mod epw;
pub mod factor;
pub mod figures;
pub mod floor;
pub mod glazing;
pub mod grid;
pub mod heat_map;
pub mod hours;
pub mod inside;
pub mod map;
pub mod metrics;
mod opening;
pub mod outline;
pub mod page;
mod plane;
pub mod raster;
mod reached;
pub mod report;
pub mod section;
mod spec;
pub mod sun_hours;
pub mod table;
pub mod view;
pub mod year;
