//! What the tests of time-lapses share: a small sequence, and the Python of the test environment.

use std::process::{Command, Stdio};

/// What a script prints in the Python of the test environment; nothing without it, or where it has not what the script imports.
pub fn python(script: &str, input: &str) -> Option<String> {
    let python = std::env::var_os("TYNDALL_PYTHON")?;
    let mut child = Command::new(python)
        .args(["-c", script])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python starts");
    use std::io::Write;
    let mut stdin = child.stdin.take().expect("it is piped");
    stdin.write_all(input.as_bytes()).expect("it reads");
    drop(stdin);
    let output = child.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    output.status.success().then_some(said)
}

/// A sequence of five small frames through sunset.
pub const SEQUENCE: [&str; 15] = [
    "timelapse",
    "--date",
    "2026-06-21",
    "--from",
    "sunset-20m",
    "--to",
    "sunset+40m",
    "--frames",
    "5",
    "-o",
    "out/f_##.png",
    "--size",
    "48x30",
    "--backend",
    "reference",
];
