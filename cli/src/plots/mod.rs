//! Diagrams, written as SVG, PNG or HTML.

pub mod contact_sheet;
pub mod labels;
pub mod plot;
pub mod sun_path;
pub mod timelapse_curves;
pub mod timelapse_page;
