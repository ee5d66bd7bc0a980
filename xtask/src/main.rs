//! Tasks of the project itself: `cargo xtask breaks`, `cargo xtask mutants`, `cargo xtask pictures`, `cargo xtask scene`, `cargo xtask same`, `cargo xtask test`.

mod breaks;
mod cut;
mod mutants;
mod paths;
mod pictures;
mod same;
mod scene;
mod test;

use serde::de::DeserializeOwned;
use std::path::PathBuf;
use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask COMMAND

  breaks [--built FOLDER] [WORDS]
                     put small breaks into a copy of the sources, one at a time, and see whether the tests notice (tests/breaks.toml);
                     those in shaders into copies of the test programs in FOLDER, such as target/release/deps, if it is named
  mutants MODULE [ARGUMENTS]
                     change the code of a module in all small ways that cargo-mutants knows, one at a time, and see whether its
                     suites notice (tests/mutants.toml); ARGUMENTS go to `cargo mutants`
  pictures [NAMES]   render the built-in scenes into the documentation, docs/scenes
  same BINARY        compare ten pictures of another build of `tyndall` with those of this one, under both backends: nave,
                     nave-epipolar, nave-prefiltered, nave-march, nave-planes, court, panorama, orthographic, peaks, sunward
  scene              make the first of the built-in scenes, data/nave (`python data/scenes.py` makes the others)
  test [ARGUMENTS]   set up what the tests need and run all of them; ARGUMENTS go to `cargo test`
";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    match arguments.next().as_deref() {
        Some("breaks") => status(breaks::run(arguments.collect())),
        Some("mutants") => status(mutants::run(arguments.collect())),
        Some("pictures") => pictures::run(arguments.collect()),
        Some("same") => same::run(arguments.collect()),
        Some("scene") => scene::run(),
        Some("test") => status(test::run(arguments.collect())),
        Some("help" | "--help" | "-h") => {
            print!("{USAGE}");
            ExitCode::SUCCESS
        }
        other => {
            if let Some(command) = other {
                eprintln!("xtask: there is no command `{command}`\n");
            }
            eprint!("{USAGE}");
            ExitCode::from(2)
        }
    }
}

/// What a command ends with: whether all was as it should be, or what went wrong.
fn status(done: Result<bool, String>) -> ExitCode {
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(problem) => {
            eprintln!("xtask: {problem}");
            ExitCode::FAILURE
        }
    }
}

/// Reads a list in TOML, `name` from the root.
fn list<T: DeserializeOwned>(name: &str) -> Result<T, String> {
    let text = std::fs::read_to_string(root().join(name)).map_err(|e| format!("{name}: {e}"))?;
    toml::from_str(&text).map_err(|e| format!("{name}: {e}"))
}

/// The folder of the workspace: the current copy of it, when it has been moved since xtask was built.
pub fn root() -> PathBuf {
    let manifest = std::env::var_os("CARGO_MANIFEST_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    manifest.join("..").canonicalize().unwrap_or(manifest)
}

/// The folder of what is built and may be deleted.
pub fn target() -> PathBuf {
    let named = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    root().join(named.unwrap_or_else(|| "target".into()))
}
