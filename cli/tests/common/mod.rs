//! The program from the outside: what the tests of flags, files and exit statuses share.

use std::path::Path;
use std::process::{Command, Output};

/// Runs the program in a folder.
pub fn tyndall(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("tyndall starts")
}

/// What it has said on standard error.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
