//! The program from the outside: what the tests of flags, files and exit statuses share.

#![allow(dead_code)] // not every test needs each

pub mod timelapse;

use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Output};

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

/// Gives a program whose streams are piped a head and then `block` so many times, and lets it end: the most memory that it had by
/// then [KiB], and the bytes that it printed.
#[cfg(target_os = "linux")]
pub fn peak_memory(mut child: Child, head: &str, block: &str, times: usize) -> (u64, u64) {
    let mut stdin = child.stdin.take().expect("it is piped");
    let mut stdout = child.stdout.take().expect("it is piped");
    let reader = std::thread::spawn(move || std::io::copy(&mut stdout, &mut std::io::sink()));
    stdin.write_all(head.as_bytes()).expect("it reads");
    for _ in 0..times {
        stdin.write_all(block.as_bytes()).expect("it reads");
    }
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id()));
    let status = status.expect("it runs");
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let peak = peak.and_then(|rest| rest.split_whitespace().next()?.parse::<u64>().ok());
    drop(stdin);
    assert!(child.wait().expect("it ends").success());
    let bytes = reader.join().expect("it reads").expect("all comes");
    (peak.expect("KiB"), bytes)
}
