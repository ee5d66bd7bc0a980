//! The plan file of a time-lapse: JSON lines, a header and then one line for each frame.
//!
//! It says everything that whoever assembles, resumes or spreads the frames needs to know. It holds all frames of the sequence, whichever of
//! them a process renders, and every process of the same sequence finds the same (but for predicted times, which are those of the machine
//! that wrote it).

use super::template::Template;
use crate::error::{Error, Result};
use crate::output::atomic;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Lines, Write};
use std::path::{Path, PathBuf};

/// The version of the file's format.
pub const FORMAT: u32 = 1;

/// The first line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// [`FORMAT`].
    pub format: u32,
    /// The version of tyndall that planned.
    pub version: String,
    /// The scene's name.
    pub scene: String,
    /// Hash of everything that the scene was read from: its file, meshes, textures, photometry (SHA-256, hexadecimal).
    pub scene_hash: String,
    /// Hash of all settings that change pictures: view, quality, layers, colour space, backend (SHA-256, hexadecimal).
    pub settings_hash: String,
    /// The time zone database by its name.
    pub time_zones: String,
    /// Hash of the time zone database (SHA-256, hexadecimal).
    pub time_zones_hash: String,
    /// Where the frames are seen.
    pub site: Place,
    /// The names of the frames' files, as [`Template`] reads them; relative to the folder in which the command was run.
    pub outputs: Vec<String>,
    /// The instant of the first frame, UTC (RFC 3339).
    pub from: String,
    /// The instant of the last frame, UTC (RFC 3339).
    pub to: String,
    /// The step from frame to frame, in words: `every 30s`, `every 1d`, `240 frames`.
    pub step: String,
    /// The index of the first frame.
    pub first: u64,
    /// The number of frames.
    pub frames: u64,
    /// Width and height of the frames [pixels].
    pub size: [u32; 2],
    /// How the exposure was planned.
    pub exposure: ExposurePlan,
    /// The command line that makes the whole sequence.
    pub command: String,
}

/// A place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// [degrees north]
    pub latitude_deg: f64,
    /// [degrees east]
    pub longitude_deg: f64,
    /// [m above sea level]
    pub elevation: f64,
}

/// Where the exposure of the frames comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExposurePlan {
    /// One exposure for all, which the user or the scene gives [EV100].
    Fixed(f64),
    /// A smooth curve through key frames, in order of time.
    Curve(Vec<KeyFrame>),
}

/// A low-resolution picture that was metered for the exposure curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeyFrame {
    /// The index of the frame at whose instant it is.
    pub index: u64,
    /// Its instant, UTC (RFC 3339).
    pub instant: String,
    /// The sun's apparent elevation [degrees].
    pub sun_elevation_deg: f64,
    /// What was metered [EV100]; of a black picture what its neighbours give.
    pub ev100: f64,
    /// Whether the picture was black.
    #[serde(default)]
    pub is_black: bool,
}

/// The line of a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameLine {
    /// Its index: those of a sequence are consecutive.
    pub index: u64,
    /// Its instant, UTC (RFC 3339).
    pub instant: String,
    /// The same by the site's clock, with its offset.
    pub local: String,
    /// The sun's azimuth, from north through east [degrees].
    pub sun_azimuth_deg: f64,
    /// The sun's apparent elevation [degrees].
    pub sun_elevation_deg: f64,
    /// Its exposure [EV100].
    pub ev100: f64,
    /// The effects that run.
    pub run: Vec<String>,
    /// The effects that are skipped.
    pub skipped: Vec<String>,
    /// Predicted time on the machine that planned [s].
    pub predicted_seconds: f64,
    /// Hash of everything that changes the picture (SHA-256, hexadecimal). The frame's files hold it too.
    pub key: String,
}

impl Header {
    /// The names of the frames' files.
    ///
    /// # Errors
    /// [`Error::Input`] for a name without a place for the index.
    pub fn templates(&self) -> Result<Vec<Template>> {
        self.outputs
            .iter()
            .map(|text| Template::new(text))
            .collect()
    }

    /// Whether both are of one sequence under the same settings: whatever its command was, and in whichever words.
    pub fn is_of_the_same(&self, other: &Header) -> bool {
        let Header {
            format,
            version,
            scene: _,
            scene_hash,
            settings_hash,
            time_zones: _,
            time_zones_hash,
            // The scene's own.
            site: _,
            outputs: _,
            from,
            to,
            step: _,
            first,
            frames,
            size,
            exposure,
            command: _,
        } = self;
        let names = |header: &Header| {
            // Of one index many ways to write it are the same.
            let of = |template: Template| [0, u64::MAX].map(|index| template.path(index));
            let mut names = header
                .templates()
                .map(|all| all.into_iter().map(of).collect::<Vec<_>>());
            if let Ok(names) = &mut names {
                names.sort();
            }
            names.ok()
        };
        *format == other.format
            && *version == other.version
            && *scene_hash == other.scene_hash
            && *settings_hash == other.settings_hash
            && *time_zones_hash == other.time_zones_hash
            && *from == other.from
            && *to == other.to
            && *first == other.first
            && *frames == other.frames
            && *size == other.size
            && *exposure == other.exposure
            && names(self).is_some()
            && names(self) == names(other)
    }

    /// The indices of the frames.
    pub fn indices(&self) -> std::ops::Range<u64> {
        self.first..self.first.saturating_add(self.frames)
    }
}

/// The plan file that belongs to frames of this name: `out/day.plan.jsonl` beside `out/day_0001.exr`.
pub fn beside(template: &Template) -> PathBuf {
    let name = match template.stem() {
        "" => "timelapse",
        stem => stem,
    };
    template.folder().join(format!("{name}.plan.jsonl"))
}

/// Writes a plan file. The lines are taken one by one, so that any number of them needs no memory.
///
/// # Errors
/// [`Error::File`] when it cannot be written; those of the lines.
pub fn write(
    path: &Path,
    header: &Header,
    lines: impl IntoIterator<Item = Result<FrameLine>>,
) -> Result<()> {
    let mut failed = None;
    let written = atomic::write(path, |file| {
        let mut file = BufWriter::new(file);
        serde_json::to_writer(&mut file, header)?;
        writeln!(file)?;
        for line in lines {
            match line {
                Ok(line) => serde_json::to_writer(&mut file, &line)?,
                Err(error) => {
                    failed = Some(error);
                    return Err(std::io::ErrorKind::Other.into());
                }
            }
            writeln!(file)?;
        }
        file.flush()
    });
    match failed {
        Some(error) => Err(error),
        None => written,
    }
}

/// A plan file that is read line by line.
#[derive(Debug)]
pub struct Reader {
    /// The header.
    pub header: Header,
    path: PathBuf,
    lines: Lines<BufReader<File>>,
    /// The number of the line that was read last, from 1.
    line: usize,
}

impl Reader {
    /// Opens a plan file and reads its header.
    ///
    /// # Errors
    /// [`Error::File`] when it cannot be read; [`Error::Input`] when it is no plan file of this format.
    pub fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(|e| Error::reading(path, e))?;
        let mut lines = BufReader::new(file).lines();
        let first = lines.next().unwrap_or_else(|| Ok(String::new()));
        let first = first.map_err(|e| Error::reading(path, e))?;
        let header: Header = parse(path, 1, &first)?;
        if header.format != FORMAT {
            return Err(Error::input(
                format!("{}, line 1", path.display()),
                format!("it is of format {}, not {FORMAT}", header.format),
                "plan again with this version of tyndall",
            ));
        }
        Ok(Reader {
            header,
            path: path.to_owned(),
            lines,
            line: 1,
        })
    }
}

impl Iterator for Reader {
    type Item = Result<FrameLine>;

    fn next(&mut self) -> Option<Self::Item> {
        let line = self.lines.next()?;
        self.line += 1;
        let line = line.map_err(|e| Error::reading(&self.path, e));
        Some(line.and_then(|line| parse(&self.path, self.line, &line)))
    }
}

/// A plan file in so few lines that they can be held and drawn, however many frames it has.
#[derive(Debug, Clone)]
pub struct Outline {
    /// The header.
    pub header: Header,
    /// The line of every so many frames, from the first, and that of the last; not empty.
    pub lines: Vec<FrameLine>,
    /// From which frame to which next one `lines` go: 1 where all are there.
    pub every: u64,
    /// Predicted time of all frames on the machine that planned [s].
    pub predicted_seconds: f64,
}

impl Outline {
    /// Reads a plan file and keeps `most` lines and that of the last frame, or all where there are no more.
    ///
    /// # Errors
    /// Those of [`Reader`]; [`Error::Input`] where it has more or fewer frames than its header says, or none.
    pub fn read(path: &Path, most: u64) -> Result<Self> {
        let reader = Reader::open(path)?;
        let header = reader.header.clone();
        let every = header.frames.div_ceil(most.max(1)).max(1);
        let (mut lines, mut last, mut predicted_seconds) = (Vec::new(), None, 0.0);
        let mut count = 0;
        for line in reader {
            let line = line?;
            predicted_seconds += line.predicted_seconds;
            last = match count % every {
                0 => {
                    lines.push(line);
                    None
                }
                _ => Some(line),
            };
            count += 1;
        }
        lines.extend(last);
        if count != header.frames || count == 0 {
            return Err(Error::input(
                path.display().to_string(),
                format!("it has {count} frames and speaks of {}", header.frames),
                "plan again",
            ));
        }
        Ok(Outline {
            header,
            lines,
            every,
            predicted_seconds,
        })
    }
}

fn parse<T: DeserializeOwned>(path: &Path, number: usize, line: &str) -> Result<T> {
    serde_json::from_str(line).map_err(|error| {
        Error::input(
            format!("{}, line {number}", path.display()),
            format!("it is no line of a plan: {error}"),
            "plan again",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header() -> Header {
        Header {
            format: FORMAT,
            version: "0.1.0".into(),
            scene: "nave".into(),
            scene_hash: "ab".into(),
            settings_hash: "cd".into(),
            time_zones: "IANA 2026a".into(),
            time_zones_hash: "ef".into(),
            site: Place {
                // A number that is read back as another one by a parser that is not exact.
                latitude_deg: 46.063718908910516,
                longitude_deg: 2.0,
                elevation: 35.5,
            },
            outputs: vec!["out/####.exr".into()],
            from: "2026-06-21T18:00:00Z".into(),
            to: "2026-06-21T18:00:30Z".into(),
            step: "every 30s".into(),
            first: 1,
            frames: 2,
            size: [320, 200],
            exposure: ExposurePlan::Curve(vec![KeyFrame {
                index: 1,
                instant: "2026-06-21T18:00:00Z".into(),
                sun_elevation_deg: 0.1,
                ev100: 11.0 / 3.0,
                is_black: false,
            }]),
            command: "tyndall timelapse".into(),
        }
    }

    fn line(index: u64) -> FrameLine {
        FrameLine {
            index,
            instant: "2026-06-21T18:00:00.125Z".into(),
            local: "2026-06-21T20:00:00.125+02:00".into(),
            sun_azimuth_deg: 300.0,
            sun_elevation_deg: 1.0 / 3.0,
            ev100: 0.1 + 0.2,
            run: vec!["sky_dome".into()],
            skipped: vec![],
            predicted_seconds: 0.5,
            key: "00".into(),
        }
    }

    #[test]
    fn a_plan_is_read_as_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = beside(&Template::new(&format!("{}/#.png", folder.path().display())).unwrap());
        for exposure in [header().exposure, ExposurePlan::Fixed(-3.25)] {
            let header = Header {
                exposure,
                ..header()
            };
            write(&path, &header, [Ok(line(1)), Ok(line(2))]).unwrap();
            let reader = Reader::open(&path).unwrap();
            assert_eq!(reader.header, header);
            assert_eq!(
                reader.collect::<Result<Vec<_>>>().unwrap(),
                [line(1), line(2)]
            );
        }
        // A line that fails leaves the plan that was there.
        let fails = [Ok(line(1)), Err(Error::Stopped)];
        assert!(matches!(
            write(&path, &header(), fails),
            Err(Error::Stopped)
        ));
        assert_eq!(Reader::open(&path).unwrap().count(), 2);
    }

    #[test]
    fn an_outline_of_any_length_is_short() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan");
        let of = |frames: u64, most| {
            let header = Header { frames, ..header() };
            write(&path, &header, (1..=frames).map(|index| Ok(line(index)))).unwrap();
            let outline = Outline::read(&path, most).unwrap();
            assert_eq!(outline.predicted_seconds, 0.5 * frames as f64);
            let indices = outline.lines.iter().map(|line| line.index);
            (outline.every, indices.collect::<Vec<_>>())
        };
        assert_eq!(of(1, 4), (1, vec![1]));
        assert_eq!(of(4, 4), (1, vec![1, 2, 3, 4]));
        assert_eq!(of(7, 4), (2, vec![1, 3, 5, 7]));
        assert_eq!(of(10, 4), (3, vec![1, 4, 7, 10]));
        assert_eq!(of(12, 4), (3, vec![1, 4, 7, 10, 12]));
        let (every, long) = of(2001, 40);
        assert!(every == 51 && long.len() == 41 && long.last() == Some(&2001));
        // One frame fewer than its header says.
        write(&path, &header(), [Ok(line(1))]).unwrap();
        assert!(Outline::read(&path, 4).is_err_and(|e| e.is_input()));
    }

    #[test]
    fn a_sequence_is_the_same_in_other_words() {
        let of = |change: &dyn Fn(&mut Header)| {
            let mut other = header();
            change(&mut other);
            header().is_of_the_same(&other)
        };
        assert!(of(&|other| {
            other.command = "tyndall timelapse --max-memory 2GiB".into();
            other.step = "2 frames".into();
            other.outputs = vec!["out/{frame:04}.exr".into()];
        }));
        let changes: [&dyn Fn(&mut Header); 6] = [
            &|other| other.outputs = vec!["out/#.exr".into()],
            &|other| other.outputs.push("out/#.png".into()),
            &|other| other.settings_hash.clear(),
            &|other| other.to = "2026-06-21T18:00:31Z".into(),
            &|other| other.frames = 3,
            &|other| other.exposure = ExposurePlan::Fixed(0.0),
        ];
        for (number, change) in changes.iter().enumerate() {
            assert!(!of(change), "change {number}");
        }
    }

    #[test]
    fn what_is_no_plan_is_refused_by_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan");
        let future = Header {
            format: FORMAT + 1,
            ..header()
        };
        write(&path, &future, []).unwrap();
        let error = Reader::open(&path).unwrap_err();
        assert!(error.to_string().contains("line 1"), "{error}");
        write(&path, &header(), [Ok(line(1))]).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, &text[..text.len() - 10]).unwrap();
        let error = Reader::open(&path).unwrap().next().unwrap().unwrap_err();
        assert!(error.is_input() && error.to_string().contains("line 2"));
        std::fs::write(&path, "").unwrap();
        assert!(Reader::open(&path).is_err_and(|e| e.is_input()));
    }
}
