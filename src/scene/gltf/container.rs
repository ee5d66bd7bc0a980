//! The container of a glTF 2.0 file: JSON, GLB chunks (glTF 2.0, 4.4), buffers and the files that they name.

use super::document::Document;
use super::notes::{Notes, shown};
use super::{audit, extension, uri};
use crate::error::{Error, Result};
use crate::file;
use crate::warning::Warning;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What an exporter can do about a file that contradicts itself.
pub(super) const DAMAGED: &str = "the file is damaged: export it again";

/// What can be done about a file that ends too early.
const CUT_SHORT: &str = "the file is cut short: copy or export it again";

/// Bytes that a buffer may lack at its end, where writers forget to fill up to a multiple of four.
const PADDING: usize = 3;

/// A glTF file with its buffers in memory.
pub(super) struct Gltf<'a> {
    /// The file, for messages.
    pub path: PathBuf,
    /// The JSON.
    pub json: Document,
    /// What buffers are made of, each file once.
    sources: Vec<Cow<'a, [u8]>>,
    /// For each buffer its source and its length; `None` where only compressed data is.
    buffers: Vec<Option<(usize, usize)>>,
}

impl<'a> Gltf<'a> {
    /// Reads `bytes`, the content of `path`; files that it names are looked for beside it.
    pub fn read(path: &Path, bytes: &'a [u8], notes: &mut Notes) -> Result<Gltf<'a>> {
        let (json, blob) = if bytes.starts_with(b"glTF") {
            split_glb(path, bytes, notes)?
        } else {
            (bytes, None)
        };
        let json = trimmed(json);
        let wrong = |e: serde_json::Error| {
            let (problem, remedy) = match (e.classify(), json) {
                (_, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] | [_, 0, ..] | [0, _, ..]) => (
                    "it is not UTF-8 (UTF-16 text?)".to_owned(),
                    "save it as UTF-8",
                ),
                (serde_json::error::Category::Eof, _) => (middle_cut(&e.to_string()), CUT_SHORT),
                _ => (middle_cut(&e.to_string()), DAMAGED),
            };
            Error::input(format!("{}, JSON", path.display()), problem, remedy)
        };
        // As it stands first: what the file needs and holds is said before anything of it fails.
        audit::audit(path, &serde_json::from_slice(json).map_err(wrong)?, notes)?;
        let json: Document = serde_json::from_slice(json).map_err(wrong)?;

        let least = json.asset.min_version.as_deref();
        let least = least.filter(|least| *least != "2.0");
        let version = least.unwrap_or(&json.asset.version);
        if least.is_some() || !version.starts_with("2.") {
            return Err(Error::input(
                format!("{}, asset.version", path.display()),
                match version {
                    "" => "there is none: this is not a glTF file".to_owned(),
                    other => format!(
                        "it is glTF {}, which this program does not read",
                        shown(other)
                    ),
                },
                "export the scene as glTF 2.0",
            ));
        }
        let mut gltf = Gltf {
            path: path.to_owned(),
            json,
            sources: Vec::new(),
            buffers: Vec::new(),
        };
        let mut known: BTreeMap<&str, usize> = BTreeMap::new();
        for (i, buffer) in gltf.json.buffers.iter().enumerate() {
            let place = format!("buffers[{i}]");
            let source = match (&buffer.uri, blob) {
                (Some(uri), _) => match known.get(uri.as_str()) {
                    Some(&source) => source,
                    None => {
                        let bytes = gltf.fetch(uri, &format!("{place}.uri"), notes)?;
                        gltf.sources.push(Cow::Owned(bytes));
                        known.insert(uri, gltf.sources.len() - 1);
                        gltf.sources.len() - 1
                    }
                },
                (None, Some(blob)) if i == 0 => {
                    gltf.sources.push(Cow::Borrowed(blob));
                    gltf.sources.len() - 1
                }
                // A stand-in for compressed data: an error only if something plain is to be read from it.
                (None, _) if !buffer.extensions.is_empty() => {
                    gltf.buffers.push(None);
                    continue;
                }
                (None, _) => return Err(gltf.error(place, "there is no data for it", DAMAGED)),
            };
            let present = gltf.sources[source].len();
            if present < buffer.byte_length {
                if present.saturating_add(PADDING) < buffer.byte_length {
                    let problem = format!("{present} bytes of {} are there", buffer.byte_length);
                    return Err(gltf.error(place, problem, CUT_SHORT));
                }
                gltf.sources[source].to_mut().resize(buffer.byte_length, 0);
            }
            gltf.buffers.push(Some((source, buffer.byte_length)));
        }
        Ok(gltf)
    }

    /// An error at `place` in this file.
    pub fn error(
        &self,
        place: impl std::fmt::Display,
        problem: impl Into<String>,
        remedy: &str,
    ) -> Error {
        Error::input(self.at(place), problem, remedy)
    }

    /// `place` in this file.
    pub fn at(&self, place: impl std::fmt::Display) -> String {
        format!("{}, {place}", self.path.display())
    }

    /// Bytes of the file and of its buffers: what bounds the memory that it may take.
    pub fn size(&self) -> usize {
        self.sources.iter().map(|source| source.len()).sum()
    }

    /// `list[index]`, or an error that says what names what.
    pub fn get<'b, T>(
        &self,
        list: &'b [T],
        name: &str,
        index: usize,
        by: impl std::fmt::Display,
    ) -> Result<&'b T> {
        list.get(index).ok_or_else(|| {
            self.error(
                by,
                format!("it names {name}[{index}], but there are {}", list.len()),
                DAMAGED,
            )
        })
    }

    /// What stands at a URI: a file, beside this one as a rule, or a `data:` URI.
    pub fn fetch(&self, uri: &str, place: &str, notes: &mut Notes) -> Result<Vec<u8>> {
        if let Some(data) = uri::data(uri) {
            return data.map_err(|problem| {
                self.error(place, format!("`{}`: {problem}", shown(uri)), DAMAGED)
            });
        }
        let Some(name) = uri::file(uri) else {
            return Err(self.error(
                place,
                format!("`{}` is not the name of a file", shown(uri)),
                "put the file beside this one and name it",
            ));
        };
        let folder = self.path.parent().unwrap_or(Path::new(""));
        // Some writers leave their system's backslashes, or percent signs that mean themselves.
        let slashed = name.to_string_lossy().replace('\\', "/");
        let spellings = [name.clone(), PathBuf::from(slashed), PathBuf::from(uri)];
        let name = spellings
            .into_iter()
            .find(|name| folder.join(name).exists())
            .unwrap_or(name);
        let bytes = file::read(&folder.join(&name), file::LARGEST).map_err(|e| {
            let problem = match e {
                Error::File { source, .. } => {
                    format!("cannot read `{}`: {source}", shown(&name.to_string_lossy()))
                }
                Error::Input { problem, .. } => {
                    format!("`{}`: {problem}", shown(&name.to_string_lossy()))
                }
                other => other.problem(),
            };
            self.error(
                place,
                problem,
                "put the file where the scene names it, or export the scene as one GLB",
            )
        })?;
        if uri::leads_out(&name) {
            notes.warn(Warning::OutsideFolder {
                file: self.path.display().to_string(),
                named: shown(&name.to_string_lossy()),
            });
        }
        Ok(bytes)
    }

    /// The bytes of a buffer view.
    pub fn view(&self, index: usize, by: &str) -> Result<&[u8]> {
        let view = self.get(&self.json.buffer_views, "bufferViews", index, by)?;
        let place = format!("bufferViews[{index}]");
        let Some((source, length)) = *self.get(&self.buffers, "buffers", view.buffer, &place)?
        else {
            let buffer = self.get(&self.json.buffers, "buffers", view.buffer, &place)?;
            let names = buffer.extensions.keys().map(|name| extension::named(name));
            let names: Vec<String> = names.collect();
            return Err(self.error(
                place,
                format!("its data is there only as {}", names.join(", ")),
                "export the scene without compression",
            ));
        };
        let buffer = &self.sources[source][..length];
        view.byte_offset
            .checked_add(view.byte_length)
            .and_then(|end| buffer.get(view.byte_offset..end))
            .ok_or_else(|| {
                self.error(
                    place,
                    format!(
                        "bytes {} to {} lie outside its buffer of {length}",
                        view.byte_offset,
                        view.byte_offset.saturating_add(view.byte_length),
                    ),
                    DAMAGED,
                )
            })
    }
}

/// JSON without the mark of UTF-8 before it and what fills it up behind.
fn trimmed(json: &[u8]) -> &[u8] {
    let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
    let end = json
        .iter()
        .rposition(|&b| b != 0 && !b.is_ascii_whitespace());
    &json[..end.map_or(0, |last| last + 1)]
}

/// A parser's message, which may quote the file at length.
fn middle_cut(text: &str) -> String {
    let ends: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
    match ends.len() {
        0..=160 => text.to_owned(),
        n => format!("{}...{}", &text[..ends[60]], &text[ends[n - 60]..]),
    }
}

/// Kinds of chunks.
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// The JSON and the binary chunk of a GLB, which come in this order as a rule.
fn split_glb<'a>(
    path: &Path,
    bytes: &'a [u8],
    notes: &mut Notes,
) -> Result<(&'a [u8], Option<&'a [u8]>)> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let error = |at: usize, problem: String| {
        Error::input(
            format!("{}, byte {at}", path.display()),
            problem,
            "the file is cut short or damaged: copy or export it again",
        )
    };
    match word(4) {
        Some(2) => {}
        Some(version) => {
            return Err(error(
                4,
                format!("it is GLB version {version}; only version 2 is known"),
            ));
        }
        None => return Err(error(bytes.len(), "the GLB header ends here".into())),
    }
    let (mut json, mut blob, mut unread) = (None, None, false);
    let mut at = 12;
    while let (Some(length), Some(kind)) = (word(at), word(at + 4)) {
        let (length, rest) = (length as usize, &bytes[at + 8..]);
        let chunk = &rest[..length.min(rest.len())];
        match kind {
            _ if length.saturating_sub(PADDING) > rest.len() => {
                // Behind the scene there may be anything.
                if json.is_some() && (blob.is_some() || kind != BIN) {
                    break;
                }
                let problem = format!(
                    "a chunk of {length} bytes begins, but {} follow",
                    rest.len()
                );
                return Err(error(at, problem));
            }
            JSON if json.is_none() => json = Some(chunk),
            BIN if blob.is_none() => blob = Some(chunk),
            _ => unread |= length > 0,
        }
        at = (at + 8 + length).min(bytes.len());
    }
    let Some(json) = json else {
        return Err(error(at, "there is no JSON chunk".into()));
    };
    if unread || bytes[at..].iter().any(|&b| b != 0) {
        notes.leave_out("bytes of the GLB that are neither its JSON nor its buffer");
    }
    Ok((json, blob))
}
