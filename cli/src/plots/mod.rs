//! Diagrams, written as SVG, PNG or HTML.

pub mod labels;
pub mod plot;
pub mod sun_path;
