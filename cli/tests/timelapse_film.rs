//! Films, sheets, curves and pages of time-lapses, from the outside: what ffmpeg makes of them, and what is refused.

mod common;

use common::timelapse::{SEQUENCE, python};
use common::{not_run, stderr, tyndall};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;
use tyndall::Error;
use tyndall::output::png;
use tyndall::task::Task;
use tyndall::timelapse::film::{self, Film, Maker};
use tyndall::timelapse::frames::{Frames, Rate};
use tyndall::timelapse::template::Template;

/// An ffmpeg with x264, on `PATH` or in the Python environment; noted without one.
fn ffmpeg(test: &str) -> Option<PathBuf> {
    if let Maker::Ffmpeg(program) = Maker::find() {
        return Some(program);
    }
    let of_python = "import imageio_ffmpeg; print(imageio_ffmpeg.get_ffmpeg_exe())";
    let found = python(of_python, "").map(|said| PathBuf::from(said.trim()));
    if found.is_none() {
        not_run(test, "there is no ffmpeg with x264, nor imageio-ffmpeg");
    }
    found
}

/// Frames of a sky that darkens, with dither, edges of colour, and a square that moves.
fn frames(folder: &Path, size: [u32; 2], count: u64) -> Frames {
    let text = format!("{}/50% of it's_####.png", folder.display());
    let frames = Frames {
        template: Template::new(&text).expect("it is one"),
        indices: 3..3 + count,
    };
    let [width, height] = size;
    for (number, path) in frames.paths().enumerate() {
        let mut rgb = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let dither = (x * 7 + y * 13 + 5 * number as u32) % 3;
                let light = 40 + 180 * y / height - 2 * number as u32 + dither;
                let from = 8 + 3 * number as u32;
                let inside = (from..from + 24).contains(&x) && (30..54).contains(&y);
                rgb.extend(match (inside, x < width / 8) {
                    (true, _) => [200, 30, 40],
                    (_, true) => [30, 160, 60],
                    _ => [light / 2, light * 3 / 4, light].map(|code| code as u8),
                });
            }
        }
        png::write(&path, width, height, &rgb).expect("a frame");
    }
    frames
}

/// The pixels of all frames of a film, as ffmpeg shows them.
fn decoded(ffmpeg: &Path, film: &Path) -> Vec<u8> {
    let shown = Command::new(ffmpeg)
        .args(["-loglevel", "error", "-i"])
        .arg(film)
        .args(["-vf", "scale=flags=accurate_rnd+full_chroma_int"])
        .args(["-pix_fmt", "rgb24", "-f", "rawvideo", "-"])
        .stdin(Stdio::null())
        .output()
        .expect("ffmpeg starts");
    let said = String::from_utf8_lossy(&shown.stderr);
    assert!(shown.status.success() && said.is_empty(), "{said}");
    shown.stdout
}

/// What ffmpeg says of a film.
fn described(ffmpeg: &Path, film: &Path) -> String {
    let mut command = Command::new(ffmpeg);
    command.arg("-hide_banner").arg("-i").arg(film);
    stderr(&command.stdin(Stdio::null()).output().expect("it starts"))
}

/// The mean difference of each frame of a film from a frame's PNG `shift` later [codes of 255].
fn differences(shown: &[u8], film: &Film, frames: &Frames, shift: u64) -> Vec<f64> {
    let wide = film.size[0] as usize;
    let frame = 3 * wide * film.size[1] as usize;
    assert_eq!(shown.len(), frame * film.frames as usize);
    let indices = frames.indices.clone();
    let pairs = indices.clone().zip(shown.chunks_exact(frame));
    pairs
        .map(|(index, shown)| {
            let index = (index + shift).min(indices.end - 1);
            let png = image(&frames.template.path(index));
            let (mut sum, mut count) = (0.0, 0.0);
            for (x, y, pixel) in png.enumerate_pixels() {
                let at = 3 * (y as usize * wide + x as usize);
                for (a, b) in pixel.0.iter().zip(&shown[at..at + 3]) {
                    sum += f64::from(a.abs_diff(*b));
                    count += 1.0;
                }
            }
            sum / count
        })
        .collect()
}

fn image(path: &Path) -> image::RgbImage {
    image::open(path).expect("it is a picture").into_rgb8()
}

#[test]
fn a_film_shows_its_frames_whoever_makes_it() {
    let test = "a_film_shows_its_frames_whoever_makes_it";
    let Some(ffmpeg) = ffmpeg(test) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let rate = Rate::new(24_000, 1001).expect("it is one");
    // Odd and even sides; neither a multiple of the codec's blocks.
    for (size, count) in [([161, 91], 20), ([160, 90], 60)] {
        let frames = frames(folder.path(), size, count);
        for maker in [Maker::Ffmpeg(ffmpeg.clone()), Maker::BuiltIn] {
            let path = folder.path().join("a film.mp4");
            let film = film::make(&path, &frames, rate, &maker, Task::unwatched());
            let film = film.unwrap_or_else(|e| panic!("{maker}: {e}"));
            assert_eq!(film.size, size.map(|side| side.next_multiple_of(2)));
            assert_eq!(film.frames, count);
            assert_eq!(film.bytes, path.metadata().expect("it is there").len());
            let said = described(&ffmpeg, &path);
            for part in ["h264", "yuv420p(tv, bt709", "23.98 fps"] {
                assert!(said.contains(part), "{maker}: {said}");
            }
            let shown = decoded(&ffmpeg, &path);
            let off = differences(&shown, &film, &frames, 0);
            let most = off.iter().copied().fold(0.0, f64::max);
            println!(
                "{maker}, {size:?}: {most:.2} of 255 at most, {} bytes",
                film.bytes
            );
            assert!(most < 2.0, "{maker}: {most}");
            // The next frame but one is told from it.
            let others = differences(&shown, &film, &frames, 2);
            assert!(others[..10].iter().all(|&off| off > 2.0), "{others:?}");
            // The index stands before the pictures.
            let bytes = std::fs::read(&path).expect("it is there");
            let place = |name: &[u8]| bytes.windows(4).position(|w| w == name);
            assert!(place(b"moov") < place(b"mdat"));
            assert!(place(b"colr").is_some(), "{maker}");
        }
    }
}

#[test]
fn a_film_that_is_stopped_or_fails_leaves_what_was_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = frames(folder.path(), [64, 64], 4);
    let path = folder.path().join("day.mp4");
    std::fs::write(&path, "the film of yesterday").expect("a file");
    let stop = AtomicBool::new(true);
    let mut makers = vec![Maker::BuiltIn];
    makers.extend(ffmpeg("a_film_that_is_stopped").map(Maker::Ffmpeg));
    for maker in &makers {
        let task = Task::new(&|_| {}, Some(&stop));
        let stopped = film::make(&path, &frames, Rate::CINEMA, maker, task);
        assert!(matches!(stopped, Err(Error::Stopped)), "{maker}");
    }
    // An ffmpeg that is none.
    let maker = Maker::Ffmpeg("false".into());
    let failed = film::make(&path, &frames, Rate::CINEMA, &maker, Task::unwatched());
    assert!(failed.is_err_and(|e| !e.is_input()));
    let left = std::fs::read_to_string(&path).expect("it is there");
    assert_eq!(left, "the film of yesterday");
    let files = folder.path().read_dir().expect("a folder").count();
    assert_eq!(files, 5, "nothing else is left");
    // More pixels than browsers play, which the header of a frame tells.
    let large = frames.template.path(90);
    png::write(&large, 8192, 1500, &vec![0; 3 * 8192 * 1500]).expect("a frame");
    let frames = Frames {
        indices: 90..91,
        ..frames
    };
    let refused = film::make(
        &path,
        &frames,
        Rate::CINEMA,
        &Maker::BuiltIn,
        Task::unwatched(),
    );
    assert!(refused.is_err_and(|e| e.is_input() && e.remedy().contains("ffmpeg")));
}

#[test]
fn frames_are_put_together_once_they_are_all_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |more: &[&str]| tyndall(folder.path(), &[&SEQUENCE, more].concat());
    let there = |name: &str| folder.path().join(name).exists();
    let text = |output: &std::process::Output| String::from_utf8_lossy(&output.stdout).into_owned();

    // Nothing is there.
    let output = run(&["--quality", "draft", "--assemble"]);
    assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
    assert_eq!(text(&output), "--only 1-5\n");

    // A part makes no film.
    let output = run(&["--quality", "draft", "--shard", "1/2", "--film", "day.mp4"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("--assemble"),
        "{}",
        stderr(&output)
    );

    // All of it at once.
    let made = [
        "--film",
        "day.mp4",
        "--sheet",
        "sheet.png",
        "--curves",
        "curves.png",
        "--page",
        "day.html",
    ];
    let output = run(&[&["--quality", "draft"], &made[..]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        ["day.mp4", "sheet.png", "curves.png", "day.html"]
            .into_iter()
            .all(there)
    );
    let said = stderr(&output);
    assert!(said.contains("x264") || said.contains("built in"), "{said}");

    let page = std::fs::read_to_string(folder.path().join("day.html")).expect("a page");
    for part in [
        "<!DOCTYPE html>",
        "src=\"day.mp4\"",
        "data:image/png;base64,",
        "<svg ",
        "2026-06-21",
        "out/f_##.png",
        "5 frames",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.matches("<tr><td>").count(), 5);
    assert!(!page.contains("<script"));
    // Names of XML are no addresses.
    let names = page.matches("http://www.w3.org/2000/svg").count();
    assert_eq!(page.matches("http").count(), names);
    let sheet = image(&folder.path().join("sheet.png"));
    assert!(sheet.width() > 1000, "{}", sheet.width());
    // The pictures are on it, and they are not white.
    let dark = sheet
        .pixels()
        .filter(|p| p.0.iter().all(|c| *c < 128))
        .count();
    assert!(dark > 1000, "{dark}");

    // One is missing, and one has other settings.
    std::fs::remove_file(folder.path().join("out/f_02.png")).expect("it was there");
    std::fs::copy(
        folder.path().join("out/f_05.png"),
        folder.path().join("out/f_04.png"),
    )
    .expect("both are there");
    let output = run(&["--quality", "draft", "--assemble"]);
    assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
    assert_eq!(text(&output), "--only 2,4\n");
    let output = run(&["--quality", "draft", "--only", "2,4"]);
    assert!(output.status.success(), "{}", stderr(&output));

    // By the names beside the plan, and again at another rate, without ffmpeg.
    let output = Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .current_dir(folder.path())
        .args(SEQUENCE)
        .args(["--quality", "draft", "--assemble", "--fps", "24000/1001"])
        .env("PATH", "")
        .output()
        .expect("tyndall starts");
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("built in"), "{}", stderr(&output));
    for name in ["f.mp4", "f-sheet.png", "f-curves.svg", "f.html"] {
        assert!(there(&format!("out/{name}")), "{name}");
    }

    // Of other settings all are stale.
    let output = run(&["--quality", "preview", "--assemble"]);
    assert_eq!(output.status.code(), Some(75));
    assert_eq!(text(&output), "--only 1-5\n");
}

#[test]
fn what_cannot_be_made_is_refused_before_the_work() {
    let folder = tempfile::tempdir().expect("a folder");
    for (more, word) in [
        (&["--film", "day.mkv"][..], ".mp4"),
        (&["--fps", "23.976", "--film", "day.mp4"], "24000/1001"),
        (&["--sheet", "sheet.jpg"], ".png"),
        (&["--page", "no/such/folder/day.html"], "no/such"),
        (
            &[
                "--film", "day.mp4", "--page", "day.html", "--curves", "day.html",
            ],
            ".svg",
        ),
        (&["--assemble", "--shard", "1/2"], "--shard"),
        (&["--emit", "pbs"], "slurm"),
    ] {
        let output = tyndall(folder.path(), &[&SEQUENCE, more].concat());
        let said = stderr(&output);
        let status = output.status.code();
        assert!(
            matches!(status, Some(1 | 2)) && said.contains(word),
            "{more:?}: {said}"
        );
    }
    let exr: Vec<&str> = SEQUENCE
        .iter()
        .map(|w| {
            if *w == "out/f_##.png" {
                "out/f_##.exr"
            } else {
                w
            }
        })
        .collect();
    let output = tyndall(folder.path(), &[&exr, &["--film", "day.mp4"][..]].concat());
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("add -o"), "{}", stderr(&output));
}
