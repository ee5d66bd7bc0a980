//! The flags that choose how results are printed.

use clap::Args;

/// How results are printed: for people unless a flag says otherwise.
#[derive(Args, Clone, Copy, Debug)]
pub struct FormArgs {
    /// Print JSON
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
    /// Print CSV
    #[arg(long)]
    pub csv: bool,
}
