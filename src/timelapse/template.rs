//! Names of files with the frame's index in them: `frame_{frame:04}.exr`, `frame_####.exr` or `frame_%04d.exr`.

use crate::error::{Error, Result};
use crate::output::Format;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The widest index that a name may ask for [digits]: that of the largest there is.
const MOST_DIGITS: usize = 20;

/// The name of a file for each frame.
///
/// The place of the index is written as `{frame:04}` (or `{frame}`), `####` or `%04d` (or `%d`), once and in the file's name, not in a
/// folder's. The index is padded with zeros to the digits that are asked for, and longer where it has more.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Template {
    text: String,
    before: String,
    digits: usize,
    after: String,
}

impl Template {
    /// Reads the name that a user wrote.
    ///
    /// # Errors
    /// [`Error::Input`] when there is no place for the index, more than one, or one in a folder's name.
    pub fn new(text: &str) -> Result<Self> {
        let wrong = |problem: &str| {
            Err(Error::input(
                format!("-o {text}"),
                problem,
                "write the frame's place once, in the file's name: frame_{frame:04}.exr, frame_####.exr or frame_%04d.exr",
            ))
        };
        let mut found: Option<(usize, usize, usize)> = None;
        let mut at = 0;
        while at < text.len() {
            match place(&text[at..]) {
                Some((length, digits)) => {
                    if found.is_some() {
                        return wrong("the frame's index stands in it more than once");
                    }
                    if digits > MOST_DIGITS {
                        return wrong("no index has so many digits");
                    }
                    found = Some((at, length, digits));
                    at += length;
                }
                None => at += text[at..].chars().next().map_or(1, char::len_utf8),
            }
        }
        let Some((start, length, digits)) = found else {
            return wrong("the frame's index does not stand in it");
        };
        let (before, after) = (&text[..start], &text[start + length..]);
        if after.contains(std::path::is_separator) {
            return wrong("the frame's index stands in the name of a folder");
        }
        Ok(Template {
            text: text.to_owned(),
            before: before.to_owned(),
            digits,
            after: after.to_owned(),
        })
    }

    /// The file of a frame.
    pub fn path(&self, index: u64) -> PathBuf {
        let Template {
            before,
            digits,
            after,
            ..
        } = self;
        format!("{before}{index:0digits$}{after}").into()
    }

    /// The index of the frame whose file this is, by whatever name of its folder; nothing where it is no frame's.
    pub fn index_of(&self, file: &Path) -> Option<u64> {
        let of = |file: &Path| {
            let before = self.before.rsplit(std::path::is_separator).next()?;
            let name = file.file_name()?.to_str()?;
            let digits = name.strip_prefix(before)?.strip_suffix(&*self.after)?;
            let index = digits.parse().ok()?;
            // Fewer digits than are asked for, or a sign, would be read too.
            let named = self.path(index).file_name() == file.file_name();
            (named && place_of(&self.folder()) == place_of(&folder_of(file))).then_some(index)
        };
        // What a link leads to may be a frame too.
        of(file).or_else(|| of(&file.canonicalize().ok()?))
    }

    /// As ffmpeg reads it: `frame_%04d.png`, with `%%` for a percent sign.
    pub fn printf(&self) -> String {
        let [before, after] = [&self.before, &self.after].map(|text| text.replace('%', "%%"));
        format!("{before}%0{}d{after}", self.digits)
    }

    /// As it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What the files' names begin with, before the index, without what sets that apart.
    pub fn stem(&self) -> &str {
        let name = self.before.rsplit(std::path::is_separator).next();
        name.unwrap_or_default()
            .trim_end_matches(['_', '-', '.', ' '])
    }

    /// The folder in which the files are; `.` for a name without one.
    pub fn folder(&self) -> PathBuf {
        folder_of(&self.path(0))
    }

    /// The kind of picture that it names.
    ///
    /// # Errors
    /// Those of [`Format::of`].
    pub fn format(&self) -> Result<Format> {
        Format::of(Path::new(&self.text))
    }
}

/// Refuses files that a frame of these indices would be written over, or that would be written over a frame: `files` are given with what
/// they are, in words.
///
/// # Errors
/// [`Error::Input`] for the first of them.
pub fn check_apart(
    templates: &[Template],
    indices: &Range<u64>,
    files: &[(PathBuf, &str)],
) -> Result<()> {
    for template in templates {
        for (file, what) in files {
            let index = template.index_of(file);
            if let Some(index) = index.filter(|index| indices.contains(index)) {
                return Err(Error::input(
                    format!("-o {}", template.text()),
                    format!("frame {index} and {what} are one file: {}", file.display()),
                    "give one of them another name or folder",
                ));
            }
        }
    }
    Ok(())
}

/// The folder of a file; `.` for a name without one.
fn folder_of(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// One name of a folder, which need not exist, for all of its names.
fn place_of(folder: &Path) -> PathBuf {
    let found = folder.canonicalize();
    found
        .or_else(|_| std::path::absolute(folder))
        .unwrap_or_else(|_| folder.to_owned())
}

/// The place of an index at the beginning of a text: its length, and the digits that it asks for.
fn place(text: &str) -> Option<(usize, usize)> {
    let digits = |text: &str| match text {
        "" => Some(1),
        text if text.bytes().all(|b| b.is_ascii_digit()) => text.parse().ok(),
        _ => None,
    };
    if let Some(rest) = text.strip_prefix("{frame") {
        let (inside, _) = rest.split_once('}')?;
        let width = match inside {
            "" => "",
            inside => inside.strip_prefix(':')?,
        };
        return Some(("{frame".len() + inside.len() + 1, digits(width)?));
    }
    if let Some(rest) = text.strip_prefix('%') {
        let (width, _) = rest.split_once('d')?;
        return Some((1 + width.len() + 1, digits(width)?));
    }
    let hashes = text.bytes().take_while(|b| *b == b'#').count();
    (hashes > 0).then_some((hashes, hashes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_ways_to_write_an_index() {
        for (text, seven, many) in [
            (
                "out/f_{frame:04}.exr",
                "out/f_0007.exr",
                "out/f_1234567.exr",
            ),
            ("out/f_####.exr", "out/f_0007.exr", "out/f_1234567.exr"),
            ("out/f_%04d.exr", "out/f_0007.exr", "out/f_1234567.exr"),
            ("{frame}.png", "7.png", "1234567.png"),
            ("%d.png", "7.png", "1234567.png"),
            ("50%/#.png", "50%/7.png", "50%/1234567.png"),
            ("ünï%3d.hdr", "ünï007.hdr", "ünï1234567.hdr"),
        ] {
            let template = Template::new(text).expect(text);
            assert_eq!(template.path(7), Path::new(seven), "{text}");
            assert_eq!(template.path(1_234_567), Path::new(many), "{text}");
            assert_eq!(template.text(), text);
        }
        let printf = |text: &str| Template::new(text).expect(text).printf();
        assert_eq!(printf("50%/f_{frame:04}.png"), "50%%/f_%04d.png");
        assert_eq!(printf("#.png"), "%01d.png");
        let folder = |text: &str| Template::new(text).expect(text).folder();
        assert_eq!(folder("a/b/#.png"), Path::new("a/b"));
        assert_eq!(folder("#.png"), Path::new("."));
    }

    #[test]
    fn a_file_is_a_frame_by_its_index_in_its_folder() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(folder.path().join("o")).expect("a folder in it");
        let of = |text: &str, file: &str| {
            let template = Template::new(&folder.path().join(text).to_string_lossy());
            template
                .expect(text)
                .index_of(&folder.path().join("o/..").join(file))
        };
        assert_eq!(of("o/t_{frame}.png", "o/t_2.png"), Some(2));
        assert_eq!(of("o/t_##.png", "o/t_02.png"), Some(2));
        assert_eq!(of("o/t_##.png", "o/t_123.png"), Some(123));
        for other in [
            "o/t_2.png",
            "o/t_+2.png",
            "o/t_002.png",
            "t_02.png",
            "o/t_.png",
            "o/t_02.exr",
            "o/t_99999999999999999999.png",
        ] {
            assert_eq!(of("o/t_##.png", other), None, "{other}");
        }
        #[cfg(unix)]
        {
            std::fs::write(folder.path().join("o/t_03.png"), "").expect("a frame");
            let link = folder.path().join("link.png");
            std::os::unix::fs::symlink("o/t_03.png", link).expect("a link");
            assert_eq!(of("o/t_##.png", "link.png"), Some(3));
        }
    }

    #[test]
    fn what_belongs_to_a_sequence_is_named_like_it() {
        for (text, stem) in [
            ("out/day_{frame:04}.exr", "day"),
            ("day.%d.png", "day"),
            ("a.b/####.exr", ""),
        ] {
            assert_eq!(Template::new(text).expect(text).stem(), stem);
        }
    }

    #[test]
    fn names_without_one_place_for_the_index_are_refused() {
        for text in [
            "out/frame.exr",
            "f_##_##.exr",
            "{frame:04}/%d.exr",
            "{frame:04}/a.exr",
            "{frame:x}.exr",
            "%4x.exr",
            "{frame:21}.exr",
            "",
        ] {
            let error = Template::new(text).expect_err(text);
            assert!(
                error.is_input() && error.remedy().contains("%04d"),
                "{error}"
            );
        }
    }
}
