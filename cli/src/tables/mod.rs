//! Rows in and out: what is printed on standard output, and tables that are read.

pub mod batch;
pub mod columns;
pub mod daylight_batch;
pub mod printer;
pub mod rows;
pub mod sky_batch;
pub mod stdout;
pub mod stream;
pub mod sun_batch;
pub mod sun_columns;
pub mod time_text;
pub mod together;
pub mod work;
