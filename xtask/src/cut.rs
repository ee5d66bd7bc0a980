//! Copies of the sources to work on: the whole, or the part of the library that some modules and suites need.
//!
//! A module uses few others, and a package of these alone is compiled in seconds, not in half a minute.

use crate::paths::{code, paths_after};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Paths from the root with `/`, and what stands there.
type Files = BTreeMap<String, Vec<u8>>;

/// What of the sources is wanted.
#[derive(Debug, Clone, Copy)]
pub enum Part<'a> {
    Whole,
    /// These modules and suites (files of `tests` without `.rs`) with all that they use.
    Cut {
        modules: &'a [&'a str],
        suites: &'a [&'a str],
    },
}

/// Copies `part` of what git knows of `root` to `folder`, as it stands there now. What has not changed keeps its time, so that little
/// is built anew; other sources there go.
///
/// # Errors
/// In words, where git does not start, or something cannot be read or written.
pub fn copy(root: &Path, folder: &Path, part: Part<'_>) -> Result<(), String> {
    let mut files = sources(root)?;
    if let Part::Cut { modules, suites } = part {
        files = cut(&files, modules, suites)?;
    }
    for stale in ["src", "tests"] {
        remove_others(&folder.join(stale), stale, &files)?;
    }
    for (name, text) in files {
        let to = folder.join(&name);
        if fs::read(&to).is_ok_and(|there| there == text) {
            continue;
        }
        let parent = to.parent().unwrap_or(folder);
        fs::create_dir_all(parent).map_err(|e| format!("{}: {e}", parent.display()))?;
        fs::write(&to, text).map_err(|e| format!("{}: {e}", to.display()))?;
    }
    Ok(())
}

/// Whether some modules and suites need the whole library, or nearly.
///
/// # Errors
/// In words, where git does not start or a file cannot be read.
pub fn is_whole(root: &Path, modules: &[&str], suites: &[&str]) -> Result<bool, String> {
    let files = sources(root)?;
    Ok(needed(&files, modules, suites).0.contains("backend"))
}

/// What git knows of `root`.
fn sources(root: &Path) -> Result<Files, String> {
    let listed = Command::new("git")
        .args([
            "ls-files",
            "--cached",
            "--others",
            "--exclude-standard",
            "-z",
        ])
        .current_dir(root)
        .output()
        .map_err(|e| format!("git does not start: {e}"))?;
    let mut files = Files::new();
    for name in String::from_utf8_lossy(&listed.stdout).split('\0') {
        let path = root.join(name);
        if !name.is_empty() && path.is_file() {
            let text = fs::read(&path).map_err(|e| format!("{name}: {e}"))?;
            files.insert(name.to_owned(), text);
        }
    }
    Ok(files)
}

/// Deletes what lies in `folder`, which is `name` from the root, and is not among `files`.
fn remove_others(folder: &Path, name: &str, files: &Files) -> Result<(), String> {
    let Ok(entries) = folder.read_dir() else {
        return Ok(());
    };
    for entry in entries.flatten() {
        let path = entry.path();
        let name = format!("{name}/{}", entry.file_name().to_string_lossy());
        if path.is_dir() {
            remove_others(&path, &name, files)?;
        } else if !files.contains_key(&name) {
            fs::remove_file(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        }
    }
    Ok(())
}

/// The package of some modules and suites, and of all that they use.
fn cut(files: &Files, modules: &[&str], suites: &[&str]) -> Result<Files, String> {
    let (modules, shared) = needed(files, modules, suites);
    let mut kept = Files::new();
    for (name, text) in files {
        let parts: Vec<&str> = name.split('/').collect();
        let keep = match parts[..] {
            ["src", "lib.rs"] | ["tests", "common", "mod.rs"] => {
                let inside = if parts[0] == "src" { &modules } else { &shared };
                let text = without(&String::from_utf8_lossy(text), inside);
                kept.insert(name.clone(), text.into_bytes());
                continue;
            }
            ["src", ..] => modules.contains(stem(parts[1])),
            ["tests", file] if file.ends_with(".rs") => suites.contains(&stem(file)),
            ["tests", "common", ..] => shared.contains(stem(parts[2])),
            ["cli" | "xtask" | "benches" | "examples", ..] => false,
            _ => true,
        };
        if keep {
            kept.insert(name.clone(), text.clone());
        }
    }
    if let Some(whole) = files.get("Cargo.toml") {
        let rust = kept.iter().filter(|(name, _)| name.ends_with(".rs"));
        let texts: String = rust
            .map(|(_, text)| code(&String::from_utf8_lossy(text)))
            .collect();
        kept.insert("Cargo.toml".into(), manifest(whole, &texts)?.into_bytes());
    }
    Ok(kept)
}

/// All modules that some modules and suites use, directly or not, and the files of `tests/common`.
fn needed(
    files: &Files,
    modules: &[&str],
    suites: &[&str],
) -> (BTreeSet<String>, BTreeSet<String>) {
    let below = |folder: &str, name: &str| {
        let file = format!("{folder}/{name}.rs");
        let inner = format!("{folder}/{name}/");
        let texts = files
            .iter()
            .filter(move |(path, _)| **path == file || path.starts_with(&inner));
        texts
            .map(|(_, text)| code(&String::from_utf8_lossy(text)))
            .collect::<String>()
    };
    let mut shared = BTreeSet::new();
    let mut used: BTreeSet<String> = modules.iter().map(|name| (*name).to_owned()).collect();
    let mut open: Vec<String> = suites.iter().map(|suite| below("tests", suite)).collect();
    while let Some(text) = open.pop() {
        used.extend(paths_after(&text, "tyndall::"));
        let common = ["common::", "super::"].map(|prefix| paths_after(&text, prefix));
        for name in common.into_iter().flatten() {
            let text = below("tests/common", &name);
            if !text.is_empty() && shared.insert(name) {
                open.push(text);
            }
        }
    }
    if !suites.is_empty() {
        // What all tests share stands in the file that names the others.
        used.extend(paths_after(&below("tests/common", "mod"), "tyndall::"));
    }
    let mut all = BTreeSet::new();
    let mut open: Vec<String> = used.into_iter().collect();
    while let Some(name) = open.pop() {
        let name = match name.as_str() {
            "Error" | "Result" => "error".to_owned(),
            "Warning" => "warning".to_owned(),
            _ => name,
        };
        let text = below("src", &name);
        if !text.is_empty() && all.insert(name) {
            open.extend(paths_after(&text, "crate::"));
        }
    }
    (all, shared)
}

/// A file's name without its ending.
fn stem(file: &str) -> &str {
    file.split('.').next().unwrap_or_default()
}

/// A file that names modules (`mod`, `pub use`) without those that are not `kept`, and without its documentation, which names them too.
fn without(text: &str, kept: &BTreeSet<String>) -> String {
    let is_kept = |line: &&str| {
        let named = line
            .strip_prefix("pub mod ")
            .or_else(|| line.strip_prefix("pub use "));
        let name = named.map(|rest| rest.split([';', ':']).next().unwrap_or_default());
        name.is_none_or(|name| kept.contains(name)) && !line.starts_with("//!")
    };
    let lines: Vec<&str> = text.lines().filter(is_kept).collect();
    lines.join("\n") + "\n"
}

/// The manifest of the library alone, with the dependencies that `code` names.
fn manifest(text: &[u8], code: &str) -> Result<String, String> {
    let text = String::from_utf8_lossy(text);
    let wrong = |e: &dyn std::fmt::Display| format!("Cargo.toml: {e}");
    let mut all: toml::Table = toml::from_str(&text).map_err(|e| wrong(&e))?;
    if let Some(toml::Value::Table(workspace)) = all.get_mut("workspace") {
        workspace.insert("members".into(), vec!["."].into());
        workspace.remove("default-members");
    }
    all.remove("bench");
    all.remove("target");
    for kind in ["dependencies", "dev-dependencies"] {
        if let Some(toml::Value::Table(all)) = all.get_mut(kind) {
            all.retain(|name, _| {
                let used = format!("{}::", name.replace('-', "_"));
                let begins = |at: usize| {
                    !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':')
                };
                code.match_indices(&used).any(|(at, _)| begins(at))
            });
        }
    }
    toml::to_string(&all).map_err(|e| wrong(&e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_holds_what_is_used_and_no_more() {
        let files: Files = [
            ("Cargo.toml", "[workspace]\nmembers = [\".\", \"cli\"]\n"),
            ("src/lib.rs", "//! [`b`]\npub mod a;\npub mod b;\npub mod c;\npub mod error;\npub use error::{Error};\n"),
            ("src/a.rs", "use crate::{Error, b::{X, Y}};\n// crate::c\n"),
            ("src/b/mod.rs", "mod inner;"),
            ("src/b/inner.rs", "pub struct X;"),
            ("src/c.rs", ""),
            ("src/error.rs", "pub struct Error;"),
            ("tests/x.rs", "mod common;\nuse common::{one, two};\nuse tyndall::a;\n"),
            ("tests/y.rs", "use tyndall::c;"),
            ("tests/common/mod.rs", "pub mod one;\npub mod three;\npub fn two() {}\n"),
            ("tests/common/one.rs", "pub fn one() {}"),
            ("tests/common/three.rs", "use tyndall::c;"),
            ("cli/main.rs", ""),
            ("data/d.csv", "1"),
        ]
        .map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()))
        .into();
        let kept = cut(&files, &[], &["x"]).expect("it is cut");
        let names: Vec<&str> = kept.keys().map(String::as_str).collect();
        let expected = [
            "Cargo.toml",
            "data/d.csv",
            "src/a.rs",
            "src/b/inner.rs",
            "src/b/mod.rs",
            "src/error.rs",
            "src/lib.rs",
            "tests/common/mod.rs",
            "tests/common/one.rs",
            "tests/x.rs",
        ];
        assert_eq!(names, expected);
        let text = |name: &str| String::from_utf8_lossy(&kept[name]).into_owned();
        let lib = "pub mod a;\npub mod b;\npub mod error;\npub use error::{Error};\n";
        assert_eq!(text("src/lib.rs"), lib);
        assert_eq!(
            text("tests/common/mod.rs"),
            "pub mod one;\npub fn two() {}\n"
        );
    }
}
