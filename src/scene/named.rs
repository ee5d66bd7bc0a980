//! Finding the files that another file names.
//!
//! Names were written elsewhere: with backslashes, in a system that does not tell `Tex.PNG` from `tex.png`, or as a whole
//! path of another machine.

use super::text::shown_path;
use crate::error::Error;
use crate::file;
use crate::warning::Warning;
use std::collections::{BTreeMap, HashMap};
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

/// How many of a kind get a message of their own.
pub(super) const MOST: usize = 8;

/// The files beside a scene, and what was odd about their names.
pub(super) struct Beside {
    /// The folder of the scene.
    folder: PathBuf,
    /// What was looked for: who names it, and the name.
    found: HashMap<(PathBuf, String), PathBuf>,
    /// What folders hold, by their names in lower case.
    listings: HashMap<PathBuf, HashMap<String, OsString>>,
    /// For each file that names others: those found elsewhere, and those outside.
    odd: BTreeMap<String, Odd>,
}

#[derive(Default)]
struct Odd {
    elsewhere: usize,
    first: Vec<(String, String)>,
    outside: Vec<String>,
}

impl Beside {
    pub fn new(scene: &Path) -> Self {
        Beside {
            folder: scene.parent().unwrap_or(Path::new("")).to_owned(),
            found: HashMap::new(),
            listings: HashMap::new(),
            odd: BTreeMap::new(),
        }
    }

    /// The file that `by` calls `name`: as it is written; with the system's separators; without regard to case; or, of
    /// a name with folders, the last part alone. The plain one, which does not exist, when there is none of these.
    pub fn find(&mut self, by: &Path, name: &str) -> PathBuf {
        let key = (by.to_owned(), name.to_owned());
        if let Some(path) = self.found.get(&key) {
            return path.clone();
        }
        let path = self.look_for(by, name);
        self.found.insert(key, path.clone());
        path
    }

    fn look_for(&mut self, by: &Path, name: &str) -> PathBuf {
        let folder = by.parent().unwrap_or(Path::new("")).to_owned();
        let name = name.trim_matches('"');
        let slashed = name.replace('\\', "/");
        let there = |path: PathBuf| std::fs::metadata(&path).is_ok().then_some(path);
        let mut plain = there(folder.join(name));
        if plain.is_none() && slashed != name {
            plain = there(folder.join(&slashed));
        }
        let mut found = plain.clone();
        if found.is_none() {
            found = self.in_any_case(&folder, &slashed);
        }
        if let (None, Some((_, last))) = (&found, slashed.rsplit_once('/')) {
            found = there(folder.join(last)).or_else(|| self.in_any_case(&folder, last));
        }
        let Some(path) = found else {
            return folder.join(slashed);
        };
        let outside = !is_below(&path, &self.folder) && !is_below(&path, &folder);
        let odd = self.odd.entry(by.display().to_string()).or_default();
        if plain.is_none() {
            odd.elsewhere += 1;
            if odd.first.len() < MOST {
                let taken = path.strip_prefix(&folder).unwrap_or(&path);
                odd.first
                    .push((shown_path(name), shown_path(&taken.display().to_string())));
            }
        }
        if outside {
            odd.outside.push(shown_path(name));
        }
        path
    }

    /// The file below `folder` whose name is the same but for the case of its letters.
    fn in_any_case(&mut self, folder: &Path, name: &str) -> Option<PathBuf> {
        let mut path = folder.to_owned();
        for part in Path::new(name).components() {
            match part {
                Component::CurDir => {}
                Component::Normal(part) => {
                    let listing = self.listings.entry(path.clone()).or_insert_with(|| {
                        let folder = if path.as_os_str().is_empty() {
                            Path::new(".")
                        } else {
                            &path
                        };
                        let entries = folder.read_dir().into_iter().flatten().flatten();
                        let mut names: Vec<OsString> = entries.map(|e| e.file_name()).collect();
                        names.sort();
                        names
                            .into_iter()
                            .map(|name| (name.to_string_lossy().to_lowercase(), name))
                            .collect()
                    });
                    path.push(listing.get(&part.to_string_lossy().to_lowercase())?);
                }
                Component::ParentDir => path.push(".."),
                Component::Prefix(_) | Component::RootDir => return None,
            }
        }
        Some(path)
    }

    pub fn into_warnings(self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        for (file, odd) in self.odd {
            if odd.elsewhere > 0 {
                warnings.push(Warning::FoundElsewhere {
                    file: file.clone(),
                    count: odd.elsewhere,
                    first: odd.first,
                });
            }
            let more = odd.outside.len().saturating_sub(MOST);
            let named = odd.outside.into_iter().take(MOST);
            let rest = (more > 0).then(|| format!("another file, and {} more", more - 1));
            warnings.extend(named.chain(rest).map(|named| Warning::OutsideFolder {
                file: file.clone(),
                named,
            }));
        }
        warnings
    }
}

/// The content of a file that was found, or which it is and why it cannot be read.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, String> {
    file::read(path, file::LARGEST).map_err(|error| {
        let name = shown_path(&path.display().to_string());
        match error {
            Error::File { source, .. } => format!("cannot read {name}: {source}"),
            Error::Input { problem, .. } => format!("cannot read {name}: {problem}"),
            error => error.problem(),
        }
    })
}

/// Whether a path leads to below a folder, by their names alone.
fn is_below(path: &Path, folder: &Path) -> bool {
    let settled = |path: &Path| {
        let mut settled = PathBuf::new();
        for part in std::path::absolute(path)
            .unwrap_or_else(|_| path.to_owned())
            .components()
        {
            match part {
                Component::ParentDir => {
                    settled.pop();
                }
                part => settled.push(part),
            }
        }
        settled
    };
    // An empty path is the current folder.
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    settled(path).starts_with(settled(folder))
}
