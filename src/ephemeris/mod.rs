//! Where the sun is: four algorithms, one time, one way to an observer.
//!
//! An [`Instant`] holds universal time, which turns the earth, and terrestrial time, which moves the sun; a [`Site`]
//! holds the place; [`Weather`] says how strongly the air bends the light. [`sun_position`] combines them, as exactly as
//! the [`Tier`] asks for. [`Almanac`] does the same for many instants, [`DayEvents`] finds rise, set, noon and twilights, and
//! [`civil`] reads times as people write them.
//!
//! Angles are in radians. Azimuth is from north through east. Elevation is given twice: true, along the straight line,
//! and apparent, with the air's refraction.

mod almanac;
mod arcsecond;
pub mod civil;
mod day;
mod delta_t;
mod directions;
mod events;
pub mod gazetteer;
mod julian;
mod minute;
mod place;
mod position;
mod refraction;
mod series;
mod site;
mod spa;
mod spa_terms;
mod tier;
mod time;
mod trigonometry;
mod vsop87;
mod weather;
mod written;

pub use almanac::Almanac;
pub use delta_t::delta_t;
pub use directions::Directions;
pub use events::{Absence, Crossings, DayEvents, HORIZON, duration_text};
pub use julian::Julian;
pub use position::{SunPosition, sun_position};
pub use refraction::{air_mass, refraction, true_elevation};
pub use site::{Site, coordinates};
pub use tier::Tier;
pub use time::{Instant, TimeScale};
pub use weather::Weather;
pub use written::duration;
