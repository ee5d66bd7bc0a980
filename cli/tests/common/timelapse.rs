//! What the tests of time-lapses share: a small sequence, and the Python of the test environment.

use std::process::{Command, Stdio};

/// Notes that a test could not run and why, as the library's tests do.
pub fn not_run(test: &str, reason: &str) {
    eprintln!("not run: {test}: {reason}");
    if let Some(path) = std::env::var_os("TYNDALL_NOT_RUN") {
        use std::io::Write;
        let file = std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(path);
        let written = file.and_then(|mut file| writeln!(file, "{test}\t{reason}"));
        written.expect("the list of tests not run can be written");
    }
}

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
