//! `tyndall timelapse` from the outside: shards, resuming, being killed and asked to end, what is said.

#![cfg(unix)]

mod common;

use common::{slats, stderr, tyndall};
use std::collections::BTreeMap;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

/// A table under a slatted roof, in haze, with a place and a time; 16 x 10 pixels.
fn scene() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    slats(folder.path(), [16, 10]);
    folder
}

/// From before sunset into the night.
fn words<'a>(frames: &'a str, output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut words = vec![
        "timelapse",
        "slats.toml",
        "--from",
        "sunset-1h",
        "--to",
        "sunset+1h",
    ];
    words.extend([
        "--quality",
        "draft",
        "--backend",
        "reference",
        "--frames",
        frames,
    ]);
    words.extend(["-o", output]);
    words.extend(more);
    words
}

/// Runs it and takes it that it went well; what it has said.
fn run(folder: &Path, words: &[&str]) -> String {
    let output = tyndall(folder, words);
    let said = stderr(&output);
    assert!(output.status.success(), "{words:?}: {said}");
    said
}

/// The frames in a folder and what is in them.
fn frames(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in folder.read_dir().expect("the folder is there") {
        let path = entry.expect("an entry").path();
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        if !name.ends_with(".jsonl") {
            found.insert(name, std::fs::read(&path).expect("it is a file"));
        }
    }
    found
}

fn times(folder: &Path) -> BTreeMap<String, SystemTime> {
    let names = frames(folder).into_keys();
    let time = |name: &String| folder.join(name).metadata().and_then(|m| m.modified());
    names
        .map(|name| (name.clone(), time(&name).expect("a time")))
        .collect()
}

fn start(folder: &Path, words: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .current_dir(folder)
        .args(words)
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts")
}

fn wait_for(path: &Path) {
    let begun = Instant::now();
    while !path.exists() {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "{} does not come",
            path.display()
        );
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn shards_in_any_number_make_the_same_bytes() {
    let folder = scene();
    let folder = folder.path();
    let both = ["-o", "whole/f_%04d.png"];
    let said = run(folder, &words("8", "whole/f_{frame:04}.exr", &both));
    // The count is said first.
    let first = said.lines().next().unwrap_or_default();
    assert!(
        first.starts_with("frames") && first.contains(" 8, from 2026-06-21T20:58:06"),
        "{said}"
    );
    let whole = frames(&folder.join("whole"));
    assert_eq!(whole.len(), 16);
    // With sixteen, half of them have nothing to do.
    for shards in [3, 16] {
        let name = format!("in_{shards}");
        let outputs = [format!("{name}/f_####.exr"), format!("{name}/f_####.png")];
        for shard in (1..=shards).rev() {
            let shard = format!("{shard}/{shards}");
            let more = ["-o", &outputs[1], "--shard", &shard];
            run(folder, &words("8", &outputs[0], &more));
        }
        assert_eq!(frames(&folder.join(&name)), whole, "{shards} shards");
    }
    // Every frame has the same channels, whichever effects ran.
    let channels = |index: u32| -> Vec<String> {
        let path = folder.join(format!("whole/f_{index:04}.exr"));
        let image = exr::prelude::read_first_flat_layer_from_file(path).expect("an EXR");
        let list = image.layer_data.channel_data.list;
        list.iter().map(|c| c.name.to_string()).collect()
    };
    assert!(channels(1).contains(&"inscatter_sun.R".to_owned()));
    assert!((2..=8).all(|index| channels(index) == channels(1)));
    // The plan knows them all.
    let plan = std::fs::read_to_string(folder.join("whole/f.plan.jsonl")).expect("a plan");
    let lines: Vec<serde_json::Value> = plan
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    assert_eq!(lines[0]["frames"], 8);
    assert_eq!(lines.len(), 9);
    let ev100 = |line: usize| lines[line]["ev100"].as_f64().expect("a number");
    assert!(ev100(1) > ev100(8) + 5.0);
    assert_eq!(lines[8]["index"], 8);
}

#[test]
fn what_is_there_stays_and_what_is_not_or_differs_is_made() {
    let folder = scene();
    let folder = folder.path();
    let out = folder.join("out");
    let both = |more: &[&'static str]| {
        let mut all = vec!["-o", "out/f_####.png"];
        all.extend(more);
        words("5", "out/f_####.exr", &all)
    };
    run(folder, &both(&[]));
    let (made, begun) = (frames(&out), times(&out));
    let again = run(folder, &both(&[]));
    assert!(
        again.contains("0 frames") && again.contains("5 are there"),
        "{again}"
    );
    assert_eq!(times(&out), begun);
    // In other words it is the same.
    let mut otherwise = both(&["--max-memory", "2", "--assemble", "--curves", "c.svg"]);
    otherwise[8..].rotate_left(2);
    let output = tyndall(folder, &otherwise);
    assert!(output.status.success(), "{}", stderr(&output));
    // One is lost, one is cut off, one is of something else; one of two files of a frame is enough.
    std::fs::remove_file(out.join("f_0002.exr")).expect("it is there");
    std::fs::write(out.join("f_0003.exr"), &made["f_0003.exr"][..2000]).expect("it is cut off");
    std::fs::copy(out.join("f_0001.png"), out.join("f_0005.png")).expect("it is another");
    let json = tyndall(folder, &both(&["--json"]));
    let told: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    assert_eq!((&told["made"], &told["there"]), (&3.into(), &2.into()));
    assert_eq!(frames(&out), made);
    let after = times(&out);
    for name in ["f_0001.exr", "f_0001.png", "f_0004.exr", "f_0004.png"] {
        assert_eq!(after[name], begun[name], "{name}");
    }
    // Only what has no file, whatever the settings.
    std::fs::remove_file(out.join("f_0004.png")).expect("it is there");
    let missing = run(folder, &both(&["--only", "missing", "--samples", "2"]));
    assert!(missing.contains("1 frames"), "{missing}");
    // A setting that changes pictures makes all of them again, and the same setting none.
    for setting in [
        ["--turbidity", "4"],
        ["--exposure", "9"],
        ["--layers", "sun"],
    ] {
        let before = frames(&out);
        run(folder, &both(&setting));
        let now = frames(&out);
        for (name, bytes) in &now {
            // The light of the sun's clear air is not in a PNG's layers, but its key is.
            assert_ne!(*bytes, before[name], "{setting:?} {name}");
        }
        assert!(run(folder, &both(&setting)).contains("0 frames"));
    }
}

#[test]
fn killed_at_any_time_it_loses_a_frame_at_most() {
    let folder = scene();
    let folder = folder.path();
    run(folder, &words("30", "whole/f_####.exr", &[]));
    let whole = frames(&folder.join("whole"));
    let broken = words("30", "out/f_####.exr", &[]);
    let out = folder.join("out");
    let mut there = 0;
    // Times of no pattern, from the first file to the last.
    let waits = [
        5, 330, 70, 90, 160, 25, 210, 1, 120, 50, 280, 15, 190, 35, 100, 240, 60, 140, 10, 300,
    ];
    for (number, wait) in waits.into_iter().enumerate() {
        let mut child = start(folder, &broken);
        if number > 0 {
            wait_for(&out.join("f.plan.jsonl"));
        }
        std::thread::sleep(Duration::from_millis(wait));
        // Nobody can answer to this.
        let _ = child.kill();
        let status = child.wait().expect("it ends");
        assert!(status.success() || status.signal() == Some(9), "{status}");
        if !out.exists() {
            continue;
        }
        let found = frames(&out);
        let frames = found.iter().filter(|(name, _)| !name.starts_with('.'));
        let mut count = 0;
        for (name, bytes) in frames {
            assert_eq!(bytes, &whole[name], "{name} is whole");
            count += 1;
        }
        assert!(count >= there, "none is lost again");
        there = count;
    }
    // What a process leaves that is killed while it writes.
    std::fs::write(out.join(".f_0030.exr.AbC123"), "half of one").expect("it is written");
    let _ = std::fs::remove_file(out.join("f_0030.exr"));
    let said = run(folder, &broken);
    assert!(said.contains("are there"), "{said}");
    assert_eq!(
        frames(&out),
        whole,
        "nothing is missing and nothing else is left"
    );
}

#[test]
fn asked_to_end_it_ends_with_what_is_whole_and_goes_on() {
    let folder = scene();
    let folder = folder.path();
    let out = folder.join("out");
    let all = words("1000", "out/f_####.exr", &["--only", "1-200"]);
    for (signal, status, waited) in [("TERM", 75, "f_0003.exr"), ("INT", 130, "f_0012.exr")] {
        let mut child = start(folder, &all);
        wait_for(&out.join(waited));
        let pid = child.id().to_string();
        let sent = Command::new("kill").args(["-s", signal, &pid]).status();
        assert!(sent.is_ok_and(|sent| sent.success()));
        let asked = Instant::now();
        let ended = child.wait().expect("it ends");
        assert_eq!(ended.code(), Some(status), "{signal}");
        assert!(asked.elapsed() < Duration::from_secs(5));
        let left = frames(&out);
        assert!((3..200).contains(&left.len()), "{}", left.len());
        assert!(
            left.keys().all(|name| !name.starts_with('.')),
            "{:?}",
            left.keys()
        );
    }
    let begun = times(&out);
    let rest = words("1000", "out/f_####.exr", &["--only", "1-20"]);
    run(folder, &rest);
    let now = times(&out);
    assert!(begun.iter().all(|(name, time)| now[name] == *time));
    assert!(now.len() >= 20);
}

#[test]
fn a_disk_that_is_full_ends_it_with_a_word_and_it_goes_on_afterwards() {
    let folder = scene();
    let folder = folder.path();
    // A limit on the size of files is one of the disk to whoever writes.
    run(folder, &words("3", "out/f_####.exr", &["--only", "1"]));
    let line = words("3", "out/f_####.exr", &[]).join(" ");
    let limited = format!("ulimit -f 1; exec {} {line}", env!("CARGO_BIN_EXE_tyndall"));
    let output = Command::new("bash")
        .current_dir(folder)
        .args(["-c", &limited])
        .output()
        .expect("there is a shell");
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("cannot write") && said.contains("has room"),
        "{said}"
    );
    assert!(said.contains("the same command goes on"), "{said}");
    let names: Vec<String> = frames(&folder.join("out")).into_keys().collect();
    assert_eq!(names, ["f_0001.exr"]);
    run(folder, &words("3", "out/f_####.exr", &[]));
    assert_eq!(frames(&folder.join("out")).len(), 3);
}

#[test]
fn a_dry_run_says_what_would_be_done_and_writes_nothing() {
    let folder = scene();
    let folder = folder.path();
    let output = tyndall(
        folder,
        &words("7", "out/f_####.exr", &["--dry-run", "--shard", "2/2"]),
    );
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(said.contains("3 of 7 frames; 0 are there"), "{said}");
    for word in ["exposure", "time", "disk"] {
        assert!(
            said.lines().any(|line| line.starts_with(word)),
            "{word}: {said}"
        );
    }
    let left: Vec<PathBuf> = folder
        .read_dir()
        .expect("it is there")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

#[test]
fn what_cannot_be_is_refused_before_anything_is_made() {
    let folder = scene();
    let folder = folder.path();
    let mut north = words(
        "2",
        "out/f_####.exr",
        &["--date", "2026-12-21", "--at", "69.65,18.96"],
    );
    let refused = |words: &[&str], expected: &str| {
        let output = tyndall(folder, words);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {said}");
        assert!(said.contains(expected), "{words:?}: {said}");
    };
    refused(&north, "there is no sunset here on 2026-12-21");
    refused(&north, "the nearest day with one is 20");
    north.extend(["--shard", "3/2"]);
    refused(&north, "I/N");
    for (more, expected) in [
        (&["--time", "2026-06-21T12:00"] as &[&str], "leave it out"),
        (&["--sun", "180,30"], "stands still"),
        (&["--within", "100"], "--quality"),
        (&["--only", "3-1"], "2,4,10-20"),
        (&["-o", "out/same.exr"], "%04d"),
        (&["-o", "out/f_%04d.exr"], "named twice"),
        (&["--without", "shado"], "did you mean"),
    ] {
        refused(&words("2", "out/f_####.exr", more), expected);
    }
    refused(
        &[
            "timelapse",
            "slats.toml",
            "--from",
            "sunrise",
            "--to",
            "sunset",
            "-o",
            "f#.exr",
        ],
        "--every",
    );
    refused(
        &words("2", "out/f_####.png", &["--multiply", "2"]),
        "no -o has a format that they concern",
    );
    let made = || folder.join("out").exists();
    assert!(!made());
    let emit = ["--emit", "slurm", "--shards", "2", "--", "slats.toml"];
    let emitted = tyndall(folder, &{
        let mut words = words("2", "out/f_####.exr", &emit);
        words.remove(1);
        words
    });
    let job = String::from_utf8_lossy(&emitted.stdout).into_owned();
    assert!(
        job.contains("f_####.exr' slats.toml --shard \"$shard/$shards\""),
        "{job}{}",
        stderr(&emitted)
    );
    assert!(job.contains("f_####.exr' slats.toml --assemble") && !made());
    let sheet = ["-o", "f_{frame}.png", "--sheet", "f_2.png"];
    refused(
        &words("2", "f_{frame}.exr", &sheet),
        "frame 2 and the sheet are one file",
    );
}

#[test]
fn frames_that_are_made_are_measured_and_the_worst_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    // Open ground under the sky: cheap even at the finest.
    let scene = "[site]\nlatitude = 47.0\nlongitude = 4.0\ntimezone = \"UTC\"\n\n[ground]\nheight = 0.0\n\n\
                 [camera]\neye = [0.0, 2.0, 0.0]\ntarget = [0.0, 1.5, -5.0]\n";
    std::fs::write(folder.join("plain.toml"), scene).expect("the scene");
    let words = |more: &[&'static str]| {
        let mut words = vec![
            "timelapse",
            "plain.toml",
            "--size",
            "24x16",
            "--frames",
            "3",
        ];
        words.extend(["--from", "2026-06-21T10:00", "--to", "2026-06-21T12:00"]);
        words.extend(["--backend", "reference", "--quality", "draft"]);
        words.extend(["-o", "f_#.png", "--check", "32", "--report", "r.json"]);
        words.extend(more);
        words
    };
    let output = tyndall(folder, &words(&["--json", "--fail-above", "0.5"]));
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stderr(&output).matches("relative RMSE").count(), 3);
    let report = std::fs::read(folder.join("r.json")).expect("the report");
    assert_eq!(report, output.stdout);
    let told: serde_json::Value = serde_json::from_slice(&report).expect("JSON");
    let worst = told["check"]["worst_frame"].as_u64();
    assert!(
        worst.is_some_and(|frame| (1..=3).contains(&frame)),
        "{told}"
    );
    // What is there already is not measured; a picture that is too far off is not written, however often it is tried.
    std::fs::remove_file(folder.join("f_2.png")).expect("it is there");
    for _ in 0..2 {
        let output = tyndall(folder, &words(&["--fail-above", "0"]));
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("frame 2's relative RMSE"), "{said}");
        assert!(!folder.join("f_2.png").exists());
    }
    // The plan is not written over.
    let mut words = words(&[]);
    let report = words.iter().position(|word| *word == "r.json");
    words[report.expect("it is there")] = "f.plan.jsonl";
    assert_eq!(tyndall(folder, &words).status.code(), Some(2));
}
