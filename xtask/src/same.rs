//! `cargo xtask same BINARY`: whether another build of the command line makes the same pictures as this one.
//!
//! Ten pictures, each under both backends: the scene that is built in by every method, and small scenes for what it lacks. The
//! reference must not change by a bit, in no layer of the EXR and no byte of the PNG; a GPU's layers may by 1e-6, relative to
//! the value or to the layer's mean if that is more.
//!
//! | picture | what it is for |
//! |---|---|
//! | `nave` | the built-in scene, several samples |
//! | `nave-epipolar`, `nave-prefiltered`, `nave-march`, `nave-planes` | the other methods |
//! | `court` | a courtyard under slats: a box of haze, open sky, a perspective |
//! | `panorama` | the same all around, in coloured haze |
//! | `orthographic` | the same from above, in parallel rays |
//! | `peaks` | mountains in the clear air of a low sun |
//! | `sunward` | into the sun: its disc, another sky, air that thins with height, two tiles |

mod compare;
mod scenes;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// A picture: its name, its scene file (empty: the built-in scene), and the flags of `tyndall render`.
type Picture = (&'static str, &'static str, &'static str);

const PICTURES: [Picture; 10] = [
    ("nave", "", "--size 96x60 --samples 4"),
    (
        "nave-epipolar",
        "",
        "--size 96x60 --samples 1 --method epipolar",
    ),
    (
        "nave-prefiltered",
        "",
        "--size 96x60 --samples 1 --method prefiltered",
    ),
    (
        "nave-march",
        "",
        "--size 96x60 --samples 1 --method march --set shafts.suns=1",
    ),
    (
        "nave-planes",
        "",
        "--size 96x60 --samples 1 --method planes --set shafts.suns=1",
    ),
    ("court", "court.toml", "--size 120x80 --samples 2"),
    ("panorama", "panorama.toml", "--size 120x60 --samples 1"),
    (
        "orthographic",
        "orthographic.toml",
        "--size 96x72 --samples 1",
    ),
    ("peaks", "peaks.toml", "--size 120x80 --samples 1"),
    (
        "sunward",
        "sunward.toml",
        "--size 600x400 --samples 1 --quality draft",
    ),
];

/// Compares the pictures of the binary that is named with those of this state of the project.
pub fn run(arguments: Vec<String>) -> ExitCode {
    let [other] = &arguments[..] else {
        eprintln!("xtask: name one other binary: cargo xtask same PATH");
        return ExitCode::from(2);
    };
    crate::status(compare_all(Path::new(other)))
}

fn compare_all(other: &Path) -> Result<bool, String> {
    let other =
        std::path::absolute(other).map_err(|e| format!("{} is no path: {e}", other.display()))?;
    if !other.is_file() {
        return Err(format!("there is no {}", other.display()));
    }
    let own = build()?;
    let folder = tempfile::tempdir().map_err(|e| format!("no temporary folder: {e}"))?;
    scenes::write(folder.path())?;
    let mut same = true;
    for picture in PICTURES {
        let compared = ["reference", "gpu"].map(|backend| {
            let render =
                |binary: &Path, by: &str| render(binary, &picture, backend, folder.path(), by);
            let (a, b) = (render(&other, "other")?, render(&own, "own")?);
            compare::difference(&a, &b, backend == "reference")
        });
        let words = compared.map(|found| match found {
            Ok(words) => words,
            Err(problem) => {
                same = false;
                problem
            }
        });
        println!(
            "{:<17} reference: {}; gpu: {}",
            picture.0, words[0], words[1]
        );
    }
    Ok(same)
}

/// Builds the command line; where it is.
fn build() -> Result<PathBuf, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(["build", "--release", "--package", "tyndall-cli"])
        .current_dir(crate::root())
        .status();
    match status {
        Ok(status) if status.success() => {
            let name = format!("tyndall{}", std::env::consts::EXE_SUFFIX);
            Ok(crate::target().join("release").join(name))
        }
        Ok(status) => Err(format!("the command line could not be built ({status})")),
        Err(e) => Err(format!("cargo does not start: {e}")),
    }
}

/// Renders a picture into files; their names without ending.
fn render(
    binary: &Path,
    (name, scene, flags): &Picture,
    backend: &str,
    folder: &Path,
    by: &str,
) -> Result<PathBuf, String> {
    let stem = folder.join(format!("{name}-{backend}-{by}"));
    let mut command = Command::new(binary);
    command.arg("render");
    if !scene.is_empty() {
        command.arg(folder.join(scene));
    }
    command.args(flags.split(' ')).args(["--backend", backend]);
    for ending in ["exr", "png"] {
        command.arg("-o").arg(stem.with_extension(ending));
    }
    let output = command
        .output()
        .map_err(|e| format!("{} does not start: {e}", binary.display()))?;
    match output.status.success() {
        true => Ok(stem),
        false => {
            let errors = String::from_utf8_lossy(&output.stderr);
            let last = errors.trim().lines().last().unwrap_or_default().to_owned();
            Err(format!("FAILED by {}: {last}", binary.display()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_that_is_named_is_written() {
        let folder = tempfile::tempdir().expect("a folder");
        scenes::write(folder.path()).expect("they can be written");
        for (name, scene, _) in PICTURES {
            assert!(
                scene.is_empty() || folder.path().join(scene).is_file(),
                "{name}"
            );
            assert!(crate::USAGE.contains(name), "the help leaves out {name}");
        }
    }
}
