//! What accuracy costs: measurements of this program by itself.

pub mod ephemeris;
pub mod lamp_scenes;
pub mod lamps;
pub mod pareto;
pub mod radiosity;
pub mod scenes;
pub mod shafts;
pub mod sky;

use crate::backend::Limits;
use std::time::Duration;

/// Studies take the memory that they need.
const ANY: Limits<'static> = Limits {
    memory: u64::MAX,
    stop: None,
};

/// The one in the middle; 0 of none.
fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    times.get(times.len() / 2).copied().unwrap_or_default()
}
