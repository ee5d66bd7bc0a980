//! `--max-memory`: how much rendering may use.

use clap::Args;
use tyndall::backend::Limits;

/// The flag.
#[derive(Args, Clone, Copy, Debug)]
pub struct MemoryArgs {
    /// The most memory that rendering may use, in GiB
    #[arg(long, value_name = "GIB", default_value_t = 8.0)]
    max_memory: f64,
}

impl MemoryArgs {
    /// What the library is told.
    pub fn limits(self) -> Limits<'static> {
        Limits::memory((self.max_memory * f64::from(1 << 30)) as u64)
    }
}
