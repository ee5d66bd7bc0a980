//! tyndall: an outdoor sky and light-shaft simulator.
pub mod colour;
pub mod ephemeris;
pub mod error;
pub mod medium;
pub mod scene;
pub mod sky;
pub mod studies;
pub mod units;

pub use error::{Error, Result};
