//! What is there already: frames by the keys that their files hold, and what a process that was killed has left.
//!
//! A frame's file is written beside its name, brought to the disk, and renamed ([`crate::output::atomic`]), so that it is whole with its key
//! in it, or not there. Whatever is done between two frames may be killed.

use super::template::Template;
use crate::error::{Error, Result};
use crate::output::{self, Format};
use std::collections::HashSet;
use std::ffi::OsString;
use std::path::PathBuf;

/// The files of each frame.
#[derive(Debug, Clone)]
pub struct Outputs(Vec<(Template, Format)>);

impl Outputs {
    /// Those of these names.
    ///
    /// # Errors
    /// [`Error::Input`] where there is none, or one stands twice; those of [`Format::of`].
    pub fn new(templates: Vec<Template>) -> Result<Self> {
        if templates.is_empty() {
            return Err(Error::input(
                "-o",
                "no frame would be written",
                "give -o 'out/frame_{frame:04}.exr'",
            ));
        }
        for (number, template) in templates.iter().enumerate() {
            let mut before = templates[..number].iter();
            if before.any(|other| other.path(0) == template.path(0)) {
                return Err(Error::input(
                    format!("-o {}", template.text()),
                    "the frames are named twice",
                    "name them once",
                ));
            }
        }
        let with_format = |template: Template| Ok((template.clone(), template.format()?));
        let all: Result<_> = templates.into_iter().map(with_format).collect();
        Ok(Outputs(all?))
    }

    /// Their names.
    pub fn templates(&self) -> impl Iterator<Item = &Template> {
        self.0.iter().map(|(template, _)| template)
    }

    /// The files of a frame.
    pub fn of(&self, index: u64) -> impl Iterator<Item = (PathBuf, Format)> + '_ {
        let files = self.0.iter();
        files.map(move |(template, format)| (template.path(index), *format))
    }

    /// Whether all files of a frame are there, whatever is in them.
    pub fn are_there(&self, index: u64) -> bool {
        self.of(index).all(|(path, _)| path.exists())
    }

    /// Whether all files of a frame are there, whole, and of this key.
    pub fn are_of(&self, index: u64, key: &str) -> bool {
        self.of(index).all(|(path, format)| {
            output::picture::key_of(&path, format).is_some_and(|found| found == key)
        })
    }

    /// Deletes what a process that was killed while it wrote one of these frames has left beside it. Nobody else may be writing
    /// them. What cannot be deleted stays.
    pub fn sweep(&self, indices: impl IntoIterator<Item = u64>) {
        let names: HashSet<OsString> = indices
            .into_iter()
            .flat_map(|index| self.of(index))
            .filter_map(|(path, _)| path.file_name().map(ToOwned::to_owned))
            .collect();
        let folders: HashSet<PathBuf> = self.templates().map(Template::folder).collect();
        for entry in folders.iter().filter_map(|f| f.read_dir().ok()).flatten() {
            let Ok(entry) = entry else { continue };
            let left = entry.file_name();
            let left = left.to_str().and_then(|left| output::atomic::name_of(left));
            if left.is_some_and(|name| names.contains(OsString::from(name).as_os_str())) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}
