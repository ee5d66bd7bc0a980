//! What the machine lacks is our error: memory, room in files, names that are no text; and drivers keep quiet.
#![cfg(unix)]

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::{Command, Output};

const SCENE: &str =
    "[sun]\nazimuth = 1\nelevation = 40\n[camera]\neye = [0, 1, 0]\ntarget = [0, 1, 9]\n";

/// Runs `tyndall ARGUMENTS` in a folder with that scene, under a limit of the shell.
fn limited(folder: &Path, limit: &str, arguments: &str) -> Output {
    std::fs::write(folder.join("tiny.toml"), SCENE).expect("it is written");
    Command::new("sh")
        .arg("-c")
        .arg(format!("{limit}; exec \"$0\" {arguments}"))
        .arg(env!("CARGO_BIN_EXE_tyndall"))
        .current_dir(folder)
        .output()
        .expect("sh starts")
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let names = entries.map(|entry| {
        entry
            .expect("a name")
            .file_name()
            .to_string_lossy()
            .into_owned()
    });
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

#[cfg(target_os = "linux")]
#[test]
fn too_little_memory_is_an_error_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    for (limit, arguments) in [
        (
            "ulimit -v 400000",
            "sky --sun 1,40 --size 8192x4096 -o s.exr",
        ),
        (
            "ulimit -v 900000",
            "sky --sun 1,40 --size 16384x8192 -o s.exr",
        ),
        (
            "ulimit -v 60000",
            "render tiny.toml --backend reference --size 16x10 -o s.png",
        ),
        (
            "ulimit -v 800000",
            "render tiny.toml --backend gpu --size 16x10 -o s.png",
        ),
        (
            "ulimit -v 600000",
            "render tiny.toml --backend reference --size 8000x8000 -o s.exr",
        ),
    ] {
        let output = limited(folder.path(), limit, arguments);
        let text = errors(&output);
        assert_eq!(output.status.code(), Some(1), "{arguments}: {text}");
        assert!(text.contains("not enough memory"), "{arguments}: {text}");
        assert!(!text.contains("panicked"), "{arguments}: {text}");
        assert_eq!(names(folder.path()), ["tiny.toml"], "{arguments}");
    }
}

#[test]
fn a_file_that_may_not_grow_is_an_error_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = limited(
        folder.path(),
        "ulimit -f 1",
        "sky --sun 1,40 --size 512x256 -o s.exr",
    );
    let text = errors(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("cannot write s.exr"), "{text}");
    assert_eq!(names(folder.path()), ["tiny.toml"]);
}

#[test]
fn a_folder_that_may_not_be_written_names_the_file_that_was_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = limited(
        folder.path(),
        "true",
        "sky --sun 1,40 --size 8x4 -o /proc/s.exr",
    );
    let text = errors(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.contains("/proc/s.exr") && !text.contains("/."),
        "{text}"
    );
}

#[test]
fn a_name_that_is_no_text_can_be_written() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("tiny.toml"), SCENE).expect("it is written");
    for ending in ["png", "exr", "hdr"] {
        let name = [b"o\xfe.".as_slice(), ending.as_bytes()].concat();
        let output = Command::new(env!("CARGO_BIN_EXE_tyndall"))
            .args([
                "render",
                "tiny.toml",
                "--backend",
                "reference",
                "--size",
                "16x10",
                "--json",
                "-o",
            ])
            .arg(OsStr::from_bytes(&name))
            .current_dir(folder.path())
            .output()
            .expect("tyndall starts");
        assert!(output.status.success(), "{}", errors(&output));
        let size = std::fs::metadata(folder.path().join(OsStr::from_bytes(&name)));
        assert!(size.expect("it is there").len() > 0);
    }
}

#[test]
fn drivers_keep_quiet_where_all_goes_well() {
    let folder = tempfile::tempdir().expect("a folder");
    for backend in ["auto", "gpu"] {
        let arguments = format!("render tiny.toml --backend {backend} --size 16x10 -o s.png");
        let output = limited(
            folder.path(),
            "unset XDG_RUNTIME_DIR DISPLAY WAYLAND_DISPLAY",
            &arguments,
        );
        let text = errors(&output);
        if backend == "gpu" && !output.status.success() {
            assert!(text.contains("no graphics adapter"), "{text}");
            continue;
        }
        assert!(output.status.success(), "{text}");
        let ours = [
            "scene", "sun", "sky", "camera", "backend", "effects", "skipped", "samples", "time",
            "exposure", "wrote", "light",
        ];
        for line in text.lines() {
            assert!(ours.iter().any(|label| line.starts_with(label)), "{line}");
        }
    }
    let doctor = limited(folder.path(), "unset XDG_RUNTIME_DIR", "doctor");
    assert!(
        doctor.status.success() && doctor.stderr.is_empty(),
        "{}",
        errors(&doctor)
    );
}

#[test]
fn devices_and_pipes_are_no_scenes() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["z.toml", "z.glb", "z.gltf", "z.obj"] {
        std::os::unix::fs::symlink("/dev/zero", folder.path().join(name)).expect("a link");
    }
    let fifo = Command::new("mkfifo")
        .arg(folder.path().join("p.glb"))
        .status();
    let mut scenes = vec!["/dev/zero", "z.toml", "z.glb", "z.gltf", "z.obj"];
    if fifo.is_ok_and(|status| status.success()) {
        scenes.push("p.glb");
    }
    for scene in scenes {
        let output = limited(folder.path(), "true", &format!("plan {scene}"));
        let text = errors(&output);
        assert_eq!(output.status.code(), Some(2), "{scene}: {text}");
        assert!(
            text.contains("a device or a pipe, not a file"),
            "{scene}: {text}"
        );
    }
}
