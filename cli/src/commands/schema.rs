//! `tyndall schema`: the JSON Schema of the scene file.

use crate::tables::stdout;
use clap::Args;

/// Print the JSON Schema of the scene file
#[derive(Debug, Args)]
pub struct SchemaArgs {}

/// Prints it.
pub fn run(_: &SchemaArgs) -> tyndall::Result<()> {
    stdout::print_json(&tyndall::scene::schema())
}
