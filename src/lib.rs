//! tyndall: an outdoor sky and light-shaft simulator.
pub mod accuracy;
pub mod colour;
pub mod conditions;
pub mod effect;
pub mod ephemeris;
pub mod error;
pub mod frame;
pub mod gpu;
pub mod medium;
pub mod output;
pub mod plan;
pub mod reference;
pub mod scene;
pub mod sky;
pub mod studies;
pub mod units;

pub use error::{Error, Result};
