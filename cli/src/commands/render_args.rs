//! The flags of `tyndall render`, of pictures and of ranges.

use crate::arguments::check::CheckArgs;
use crate::arguments::grid::scale;
use crate::arguments::memory::MemoryArgs;
use crate::arguments::picture::PictureArgs;
use crate::arguments::place_time::step;
use crate::arguments::scene::{PlanArgs, ViewArgs};
use crate::targets::FormatArgs;
use chrono::TimeDelta;
use clap::Args;
use std::path::PathBuf;
use tyndall::output::scale::Scale;

/// Make a picture for a place, a date and a time
#[derive(Debug, Args)]
pub struct RenderArgs {
    #[command(flatten)]
    pub view: ViewArgs,
    #[command(flatten)]
    pub plan: PlanArgs,
    /// The end of a range that begins at --time: a row of values for each step instead of pictures; it is not in the table itself
    #[arg(long, value_name = "T", allow_hyphen_values = true, conflicts_with_all = ["sun", "false_colour", "exposure", "units", "multiply", "clamp_half", "color_space", "format"])]
    pub until: Option<String>,
    /// The step of a range: a number of seconds, or with s, min, h or d (24 h), as in 30min [default: 1h]
    #[arg(long, value_name = "STEP", value_parser = step, requires = "until")]
    pub step: Option<TimeDelta>,
    /// A file to write, by its ending .png, .jpg, .exr or .hdr, or - for standard output; may be repeated [default: tyndall.png and tyndall.exr]
    #[arg(short, long, value_name = "FILE|-")]
    pub output: Vec<PathBuf>,
    #[command(flatten)]
    pub format: FormatArgs,
    /// Show luminance [cd/m2] in the PNG as false colours with isolines and a legend, in a range: 0..2000
    #[arg(long, value_name = "LOW..HIGH", value_parser = scale, conflicts_with = "exposure")]
    pub false_colour: Option<Scale>,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub check: CheckArgs,
    /// Print what was done as JSON, or the rows of a range
    #[arg(long)]
    pub json: bool,
    /// Print the rows of a range as CSV
    #[arg(long, requires = "until", conflicts_with = "json")]
    pub csv: bool,
    #[command(flatten)]
    pub memory: MemoryArgs,
}
