//! The Python of the tests: its own environment under `target`, with the versions of `tests/python/requirements.txt`.
//!
//! It is kept until the pins or the Python change.

use super::{apt, quietly, say};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The packages, with their versions.
const PINS: &str = "tests/python/requirements.txt";

/// The file that says what an environment was made of.
const STAMP: &str = "made-of.txt";

/// The oldest Python for which the pinned packages exist.
const OLDEST: (u32, u32) = (3, 11);

/// What [`prepare`] will make: sizes are those of the pinned packages for Linux on x86-64.
pub fn missing(target: &Path) -> Option<String> {
    let pins = fs::read_to_string(crate::root().join(PINS)).unwrap_or_default();
    let made_of = fs::read_to_string(target.join("python").join(STAMP)).unwrap_or_default();
    let there = std::env::var_os("TYNDALL_PYTHON").is_some() || made_of.ends_with(&pins);
    let folder = target.join("python");
    (!there).then(|| {
        format!(
            "a Python environment in {} (25 packages, 220 MB to fetch, 870 MB on the disk, some minutes)",
            folder.display()
        )
    })
}

/// The Python that runs the test scripts, or why there is none.
///
/// `TYNDALL_PYTHON` wins when the user has set it: then its packages are up to the user.
pub fn prepare(target: &Path) -> Result<PathBuf, String> {
    if let Some(python) = std::env::var_os("TYNDALL_PYTHON") {
        say(&format!("TYNDALL_PYTHON is {}", python.display()));
        return Ok(python.into());
    }
    let pins = crate::root().join(PINS);
    let wanted =
        fs::read_to_string(&pins).map_err(|e| format!("cannot read {}: {e}", pins.display()))?;
    let (base, version) = find().or_else(|problem| {
        apt::install(&["python3", "python3-venv"]).map_err(|apt| format!("{problem}; {apt}"))?;
        find()
    })?;
    let folder = target.join("python");
    let python = match cfg!(windows) {
        true => folder.join("Scripts/python.exe"),
        false => folder.join("bin/python"),
    };
    let stamp = folder.join(STAMP);
    let made_of = format!("{version} at {}\n{wanted}", folder.display());
    let kept = fs::read_to_string(&stamp).is_ok_and(|found| found == made_of);
    if kept && version_of(python.as_os_str()).is_some() {
        return Ok(python);
    }

    say(&format!(
        "making the Python environment of the tests ({version})"
    ));
    make(&base, &folder)?;
    fs::write(&stamp, made_of).map_err(|e| format!("cannot write {}: {e}", stamp.display()))?;
    Ok(python)
}

/// The first Python that is new enough, with its version.
fn find() -> Result<(String, String), String> {
    let mut too_old = Vec::new();
    for name in [
        "python3",
        "python3.14",
        "python3.13",
        "python3.12",
        "python3.11",
        "python",
        "/usr/bin/python3",
    ] {
        match version_of(name.as_ref()) {
            Some((version, text)) if version >= OLDEST => return Ok((name.into(), text)),
            Some((_, text)) => too_old.push(text),
            None => {}
        }
    }
    let (major, minor) = OLDEST;
    Err(match too_old.first() {
        Some(text) => format!("Python {major}.{minor} or newer is wanted, there is {text} only"),
        None => format!("there is no Python; {major}.{minor} or newer is wanted"),
    })
}

/// Major and minor version of a Python, and both in words, if it runs.
fn version_of(python: &std::ffi::OsStr) -> Option<((u32, u32), String)> {
    let script = "import sys; print(*sys.version_info[:2]); print(sys.version.split()[0])";
    let output = Command::new(python)
        .args(["-c", script])
        .stdin(Stdio::null())
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    let mut lines = text.lines();
    let (major, minor) = lines.next()?.split_once(' ')?;
    let version = (major.parse().ok()?, minor.parse().ok()?);
    Some((version, format!("Python {}", lines.next()?)))
}

/// Recreates the environment in `folder` and fills it.
///
/// Debian's python3 comes without ensurepip, which venv needs: that is what python3-venv brings. Where it is not
/// available, virtualenv serves too, or a pip outside that fills an environment without one.
fn make(base: &str, folder: &Path) -> Result<(), String> {
    let path = folder.as_os_str();
    let fill = |python: &Path, pip: &[&std::ffi::OsStr]| {
        quietly(
            Command::new(python)
                .args(["-m", "pip"])
                .args(pip)
                .args(["install", "--quiet", "--no-input"])
                .arg("--disable-pip-version-check")
                // A package that would have to be compiled is a package that is missing.
                .args(["--only-binary", ":all:", "-r"])
                .arg(crate::root().join(PINS)),
        )
    };
    let inside = match cfg!(windows) {
        true => folder.join("Scripts/python.exe"),
        false => folder.join("bin/python"),
    };
    let create = |arguments: &[&str]| {
        let _ = fs::remove_dir_all(folder);
        quietly(Command::new(base).args(arguments).arg(path))
    };
    let with_pip = create(&["-m", "venv"])
        .or_else(|problem| {
            apt::install(&["python3-venv"]).map_err(|_| problem)?;
            create(&["-m", "venv"])
        })
        .or_else(|problem| create(&["-m", "virtualenv"]).map_err(|_| problem));
    match with_pip {
        Ok(()) => fill(&inside, &[]),
        Err(problem) => {
            create(&["-m", "venv", "--without-pip"]).map_err(|_| problem.clone())?;
            fill(Path::new(base), &["--python".as_ref(), inside.as_os_str()]).map_err(|_| {
                format!("{problem}\ninstall python3-venv (Debian, Ubuntu) or virtualenv")
            })
        }
    }
}
