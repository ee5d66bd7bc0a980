//! `--backend`: what computes.

use clap::ValueEnum;
use tyndall::backend::Wanted;

/// The flag.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BackendFlag {
    /// A hardware adapter, else the CPU reference.
    Auto,
    /// A graphics adapter, of software if there is no other.
    Gpu,
    /// The CPU reference.
    Reference,
}

impl BackendFlag {
    /// What the library is asked for.
    pub fn wanted(self) -> Wanted {
        match self {
            BackendFlag::Auto => Wanted::Auto,
            BackendFlag::Gpu => Wanted::Gpu,
            BackendFlag::Reference => Wanted::Reference,
        }
    }
}
