//! Finished frames in their order, and how fast they are shown.

use super::template::Template;
use crate::error::{Error, Result};
use crate::scene::texels;
use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Frames a second, a fraction: 24, or 24000/1001 as television has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rate {
    frames: u32,
    seconds: u32,
}

impl Rate {
    /// What films have been shown at for a century.
    pub const CINEMA: Rate = Rate {
        frames: 24,
        seconds: 1,
    };

    /// So many frames in so many seconds.
    ///
    /// # Errors
    /// [`Error::Domain`] outside 1/10 to 1000 a second, and for parts beyond 1 000 000, which containers cannot hold.
    pub fn new(frames: u32, seconds: u32) -> Result<Self> {
        let rate = f64::from(frames) / f64::from(seconds);
        if frames > 1_000_000 || seconds > 1_000_000 || !(0.1..=1000.0).contains(&rate) {
            return Err(Error::domain(
                "the film's rate",
                format!("{frames}/{seconds} frames a second"),
                "0.1 to 1000 frames a second, as a fraction of numbers up to 1000000",
                "choose 24, 25, 30 or 60, or 24000/1001, 30000/1001 or 60000/1001",
            ));
        }
        Ok(Rate { frames, seconds })
    }

    /// Reads `24` or `24000/1001`.
    ///
    /// # Errors
    /// [`Error::Input`] for what is no such fraction, with the fraction that a decimal number stands for; those of [`Rate::new`].
    pub fn parse(text: &str) -> Result<Self> {
        let (frames, seconds) = text.split_once('/').unwrap_or((text, "1"));
        match (frames.trim().parse(), seconds.trim().parse()) {
            (Ok(frames), Ok(seconds)) => Rate::new(frames, seconds),
            _ => Err(Error::input(
                format!("--fps {text}"),
                "it is neither a whole number nor a fraction of two",
                "write 24, 25, 30 or 60; 23.976 is 24000/1001, 29.97 is 30000/1001, 59.94 is 60000/1001",
            )),
        }
    }

    /// Numerator and denominator.
    pub fn fraction(self) -> [u32; 2] {
        [self.frames, self.seconds]
    }

    /// Frames a second.
    pub fn per_second(self) -> f64 {
        f64::from(self.frames) / f64::from(self.seconds)
    }
}

impl fmt::Display for Rate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.seconds {
            1 => write!(f, "{}", self.frames),
            seconds => write!(f, "{}/{seconds}", self.frames),
        }
    }
}

/// Finished frames, one after the other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frames {
    /// The names of their PNG files.
    pub template: Template,
    /// Their indices.
    pub indices: Range<u64>,
}

impl Frames {
    /// The files.
    pub fn paths(&self) -> impl Iterator<Item = PathBuf> {
        self.indices.clone().map(|index| self.template.path(index))
    }

    /// How many they are.
    pub fn count(&self) -> u64 {
        self.indices.end.saturating_sub(self.indices.start)
    }

    /// The width and height of all of them [pixels].
    ///
    /// # Errors
    /// [`Error::Input`] when there are none, when one is missing (a gap would shift all frames after it), is no PNG or has another size than
    /// the first.
    pub fn size(&self) -> Result<[u32; 2]> {
        let mut first: Option<(PathBuf, [u32; 2])> = None;
        for path in self.paths() {
            let size = size_of(&path)?;
            match &first {
                None => first = Some((path, size)),
                Some((named, expected)) if *expected != size => {
                    return Err(Error::input(
                        path.display().to_string(),
                        format!(
                            "it is {} x {} pixels, {} is {} x {}",
                            size[0],
                            size[1],
                            named.display(),
                            expected[0],
                            expected[1]
                        ),
                        "make all frames of a film at one size",
                    ));
                }
                Some(_) => {}
            }
        }
        first.map(|(_, size)| size).ok_or_else(|| {
            Error::input(
                self.template.text(),
                "there are no frames",
                "a film has one at least",
            )
        })
    }
}

/// The size of a PNG, from its header.
fn size_of(path: &Path) -> Result<[u32; 2]> {
    let file = File::open(path).map_err(|e| Error::reading(path, e))?;
    let read = png::Decoder::new(BufReader::new(file)).read_info();
    let reader = read.map_err(|e| broken(path, &e))?;
    let info = reader.info();
    Ok([info.width, info.height])
}

/// The error of a frame that cannot be read.
fn broken(path: &Path, error: &dyn fmt::Display) -> Error {
    Error::input(
        path.display().to_string(),
        format!("it is no whole PNG: {error}"),
        "delete it and make it again with `--only missing`",
    )
}

/// The pixels of a frame, three bytes each from the top left.
///
/// # Errors
/// [`Error::File`] for one that is missing, [`Error::Input`] for one that is no whole PNG, or of another size.
pub fn read_pixels(path: &Path, size: [u32; 2]) -> Result<Vec<u8>> {
    let bytes = std::fs::read(path).map_err(|e| Error::reading(path, e))?;
    let most = size.map(u64::from).iter().product();
    let read = size_of(path).and_then(|found| match found == size {
        true => texels::decode(&bytes, most).map_err(|e| broken(path, &e)),
        false => Err(Error::input(
            path.display().to_string(),
            "its size changed while the film was made",
            "make the film again",
        )),
    })?;
    Ok(read
        .pixels
        .iter()
        .flat_map(|[r, g, b, _]| [*r, *g, *b])
        .collect())
}

/// The next even number.
pub(super) fn even(side: u32) -> u32 {
    side.next_multiple_of(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_fractions() {
        for (text, fraction) in [
            ("24", [24, 1]),
            ("24000/1001", [24000, 1001]),
            ("1/2", [1, 2]),
        ] {
            let rate = Rate::parse(text).expect(text);
            assert_eq!((rate.fraction(), rate.to_string()), (fraction, text.into()));
        }
        assert!((Rate::parse("30000/1001").unwrap().per_second() - 29.97).abs() < 1e-4);
        for text in ["23.976", "24/", "x", "", "-24", "24/1/1"] {
            let error = Rate::parse(text).expect_err(text);
            assert!(error.remedy().contains("24000/1001"), "{error}");
        }
        for text in ["0", "24/0", "1001", "1/11", "2000000/100000"] {
            assert!(Rate::parse(text).is_err_and(|e| e.is_input()), "{text}");
        }
    }

    #[test]
    fn frames_of_a_film_are_all_there_and_of_one_size() {
        let folder = tempfile::tempdir().unwrap();
        let text = format!("{}/#.png", folder.path().display());
        let frames = Frames {
            template: Template::new(&text).unwrap(),
            indices: 1..4,
        };
        let write = |index, width, height| {
            let rgb = vec![7; 3 * width as usize * height as usize];
            crate::output::png::write(&frames.template.path(index), width, height, &rgb)
        };
        for index in [1, 2, 3] {
            write(index, 5, 3).unwrap();
        }
        assert_eq!(frames.size().unwrap(), [5, 3]);
        assert_eq!(
            read_pixels(&frames.template.path(2), [5, 3]).unwrap(),
            [7; 45]
        );
        write(3, 4, 3).unwrap();
        assert!(frames.size().unwrap_err().problem().contains("it is 4 x 3"));
        std::fs::write(frames.template.path(3), "no picture").unwrap();
        assert!(frames.size().is_err_and(|e| e.is_input()));
        std::fs::remove_file(frames.template.path(2)).unwrap();
        let error = frames.size().unwrap_err();
        assert!(error.to_string().contains("2.png"), "{error}");
        let none = Frames {
            indices: 1..1,
            ..frames
        };
        assert!(none.size().is_err_and(|e| e.is_input()));
    }
}
