//! `cargo xtask pictures`: renders the scenes that are built in into the documentation, `docs/scenes`.

use std::process::{Command, ExitCode};

/// The scenes, in the order in which the documentation shows them.
const SCENES: [&str; 6] = ["teapot", "stage", "street", "dry-ice", "smoke", "window"];

/// Renders all of them, or those named.
pub fn run(named: Vec<String>) -> ExitCode {
    let folder = crate::root().join("docs/scenes");
    if let Err(e) = std::fs::create_dir_all(&folder) {
        eprintln!("xtask: cannot make {}: {e}", folder.display());
        return ExitCode::FAILURE;
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    for name in SCENES {
        if !named.is_empty() && !named.iter().any(|one| one == name) {
            continue;
        }
        let status = Command::new(&cargo)
            .current_dir(crate::root())
            .args([
                "run",
                "--release",
                "--locked",
                "--quiet",
                "--package",
                "tyndall-cli",
                "--",
            ])
            .args(["render", "--scene", name, "--backend", "reference"])
            .args(["--size", "480x300", "--samples", "4", "--output"])
            .arg(folder.join(name).with_extension("png"))
            .status();
        if !status.is_ok_and(|status| status.success()) {
            eprintln!("xtask: `{name}` cannot be rendered");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
