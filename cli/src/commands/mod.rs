//! The commands, one file each; what studies of scenes share stands in `study`.

pub mod accuracy;
pub mod accuracy_lamps;
pub mod accuracy_radiosity;
pub mod accuracy_shafts;
pub mod completions;
pub mod daylight;
pub mod daylight_files;
pub mod daylight_grid;
pub mod daylight_variants;
pub mod daylight_year;
pub mod doctor;
pub mod photometry;
pub mod plan;
pub mod render;
pub mod render_args;
mod render_range;
pub mod scene;
pub mod schema;
pub mod sky;
pub mod study;
pub mod sun;
pub mod sun_events;
pub mod sun_place;
pub mod timelapse;
pub mod timelapse_film;
