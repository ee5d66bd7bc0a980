//! What the tests share: data by others, the Python judge, and the count of what could not run.
#![allow(dead_code)]

pub mod air;
pub mod annual;
pub mod build;
pub mod curved;
pub mod files;
pub mod flat;
pub mod glazed;
pub mod gltf;
pub mod gpu;
pub mod grids;
pub mod judge;
pub mod lamps;
pub mod night;
pub mod obj;
pub mod own_effects;
pub mod panes;
pub mod receive;
pub mod rooms;
pub mod scenes;
pub mod shafts;
pub mod soft;
pub mod views;
pub mod weather;

#[allow(unused_imports)] // not every test asks for one
pub use gpu::gpu;

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Notes that a test could not run and why. `cargo xtask test` counts these apart from the passed ones.
pub fn not_run(test: &str, reason: &str) {
    eprintln!("not run: {test}: {reason}");
    if let Some(path) = std::env::var_os("TYNDALL_NOT_RUN") {
        let mut file = std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(path)
            .expect("the list of tests not run can be written");
        writeln!(file, "{test}\t{reason}").expect("the list of tests not run can be written");
    }
}

/// The folder of real scenes and data by others, from `TYNDALL_DATA`; `None` (and noted) without it.
pub fn data(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("TYNDALL_DATA").map(PathBuf::from);
    if folder.is_none() {
        not_run(test, "TYNDALL_DATA does not name the folder of scenes");
    }
    folder
}

/// What `tests/python/<script>` prints when it is given `input`; `None` (and noted) without `TYNDALL_PYTHON`.
///
/// A script that fails is a failed test, not one that did not run.
pub fn python(test: &str, script: &str, input: &str) -> Option<String> {
    let Some(python) = std::env::var_os("TYNDALL_PYTHON") else {
        not_run(
            test,
            "TYNDALL_PYTHON does not name the Python of the test environment",
        );
        return None;
    };
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/python")
        .join(script);
    let mut child = Command::new(python)
        .arg(path)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the Python of the test environment starts");
    let mut stdin = child.stdin.take().expect("stdin is piped");
    let input = input.to_owned();
    let feed = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    let output = child.wait_with_output().expect("the script ends");
    let _ = feed.join();
    assert!(output.status.success(), "{script} failed");
    Some(String::from_utf8(output.stdout).expect("the script prints UTF-8"))
}
