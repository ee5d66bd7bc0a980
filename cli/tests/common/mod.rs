//! The program from the outside: what the tests of flags, files and exit statuses share.

#![allow(dead_code)] // not every test needs each

pub mod timelapse;

use std::io::Write;
use std::path::{Path, PathBuf};
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

/// A table under a slatted roof, in haze, with a place and a time, of so many pixels.
pub fn slats(folder: &Path, size: [u32; 2]) -> PathBuf {
    let mut obj = String::from("v -4 0 -4\nv -4 0 4\nv 4 0 4\nv 4 0 -4\nf 1 2 3 4\n");
    for i in 0..4 {
        let (x, first) = (-4.0 + 2.0 * f64::from(i), 5 + 4 * i);
        obj += &format!(
            "v {x} 3 -4\nv {x} 3 4\nv {x1} 3 4\nv {x1} 3 -4\nf {first} {} {} {}\n",
            first + 1,
            first + 2,
            first + 3,
            x1 = x + 1.2,
        );
    }
    std::fs::write(folder.join("slats.obj"), obj).expect("the mesh is written");
    let path = folder.join("slats.toml");
    let [width, height] = size;
    let text = format!(
        r#"mesh = "slats.obj"
time = "2026-06-21T18:30"
[site]
latitude = 48.8584
longitude = 2.2945
elevation = 35.0
[camera]
eye = [0.0, 1.2, 6.0]
target = [0.0, 1.4, 0.0]
fov_y = 60.0
[picture]
size = [{width}, {height}]
[[medium]]
shape = "haze"
top = 3.0
scattering = 0.02
"#
    );
    std::fs::write(&path, text).expect("the scene is written");
    path
}

/// The OBJ file of quads of four corners each.
pub fn quads_obj(quads: &[[[f64; 3]; 4]]) -> String {
    let mut mesh = String::new();
    for corner in quads.iter().flatten() {
        mesh += &format!("v {} {} {}\n", corner[0], corner[1], corner[2]);
    }
    for i in 0..quads.len() {
        let first = 4 * i + 1;
        mesh += &format!("f {} {} {} {}\n", first, first + 1, first + 2, first + 3);
    }
    mesh
}
