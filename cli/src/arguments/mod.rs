//! The flags that several commands share, and what their values mean.

pub mod backend;
pub mod check;
pub mod form;
pub mod grid;
pub mod hinted;
pub mod memory;
pub mod picture;
pub mod place_time;
pub mod scene;
pub mod size;
pub mod steps;
