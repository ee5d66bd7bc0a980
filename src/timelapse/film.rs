//! A film of finished frames: H.264 in MP4, which every browser plays.
//!
//! ffmpeg makes it where it is installed with x264; otherwise an encoder in Rust does ([`Maker`]). Both get the same colours: the codes of
//! the PNGs through the matrix of ITU-R BT.709 in limited range, 4:2:0, and the file says so (`colr`, and the stream's own VUI). Sides of an
//! odd length get one more row or column, a copy of the last: 4:2:0 has none of odd lengths.

use super::h264;
use super::template::Template;
use crate::error::{Error, Result};
use crate::output::atomic;
use crate::task::Task;
use std::ffi::{OsStr, OsString};
use std::fmt;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

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
pub(super) fn pixels(path: &Path, size: [u32; 2]) -> Result<Vec<u8>> {
    let file = File::open(path).map_err(|e| Error::reading(path, e))?;
    let file = BufReader::new(file);
    let read = image::load(file, image::ImageFormat::Png).map_err(|e| broken(path, &e))?;
    let picture = read.into_rgb8();
    if [picture.width(), picture.height()] != size {
        return Err(Error::input(
            path.display().to_string(),
            "its size changed while the film was made",
            "make the film again",
        ));
    }
    Ok(picture.into_raw())
}

/// What makes films on this machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Maker {
    /// The program of this name, which has x264.
    Ffmpeg(PathBuf),
    /// The encoder that is built in: H.264's constrained baseline, larger files for the same picture.
    BuiltIn,
}

impl Maker {
    /// ffmpeg where it is on `PATH` and has x264, else what is built in.
    pub fn find() -> Self {
        let program = PathBuf::from("ffmpeg");
        let asked = Command::new(&program)
            .args([
                "-hide_banner",
                "-loglevel",
                "error",
                "-h",
                "encoder=libx264",
            ])
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .output();
        match asked {
            Ok(said) if said.stdout.starts_with(b"Encoder libx264") => Maker::Ffmpeg(program),
            _ => Maker::BuiltIn,
        }
    }

    /// The arguments with which ffmpeg makes the film, its own name first; nothing for what is built in.
    ///
    /// They can be given to ffmpeg again by hand, and changed.
    pub fn line(&self, film: &Path, frames: &Frames, size: [u32; 2], rate: Rate) -> Vec<OsString> {
        match self {
            Maker::BuiltIn => Vec::new(),
            Maker::Ffmpeg(program) => ffmpeg_line(program, film, frames, size, rate),
        }
    }
}

impl fmt::Display for Maker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Maker::Ffmpeg(program) => write!(f, "{} with x264", program.display()),
            Maker::BuiltIn => f.write_str("the encoder that is built in (rusty_h264)"),
        }
    }
}

/// The line of ffmpeg.
fn ffmpeg_line(
    program: &Path,
    film: &Path,
    frames: &Frames,
    size: [u32; 2],
    rate: Rate,
) -> Vec<OsString> {
    // 4:4:4 until the last column and row are there twice, so that 4:2:0 has an even number of both.
    let mut filters = String::from(
        "scale=in_range=pc:out_range=tv:out_color_matrix=bt709:flags=bicubic+accurate_rnd+full_chroma_int+full_chroma_inp,\
         format=yuv444p",
    );
    let [right, bottom] = size.map(|side| side % 2);
    if right + bottom > 0 {
        let [width, height] = size.map(even);
        filters +=
            &format!(",pad={width}:{height},fillborders=right={right}:bottom={bottom}:mode=smear");
    }
    filters += ",format=yuv420p";
    let (first, count) = (frames.indices.start.to_string(), frames.count().to_string());
    let pattern = frames.template.printf();
    let rate = rate.to_string();
    let words = [
        "-hide_banner -loglevel error -nostdin -y -nostats -progress pipe:1 -f image2 -framerate",
        &rate,
        "-start_number",
        &first,
        "-i",
    ];
    let mut line = vec![program.as_os_str().to_owned()];
    line.extend(words.iter().flat_map(|w| w.split(' ')).map(OsString::from));
    line.push(as_file(OsStr::new(&pattern)));
    let words = ["-frames:v", &count, "-vf", &filters];
    line.extend(words.map(OsString::from));
    let words = "-c:v libx264 -preset slow -crf 16 -pix_fmt yuv420p -colorspace bt709 -color_primaries bt709 -color_trc bt709 \
         -color_range tv -movflags +faststart -f mp4";
    line.extend(words.split_whitespace().map(OsString::from));
    line.push(as_file(film.as_os_str()));
    line
}

/// A name that ffmpeg takes neither for a flag nor for an address.
fn as_file(name: &OsStr) -> OsString {
    let mut file = OsString::from("file:");
    file.push(name);
    file
}

/// The next even number.
pub(super) fn even(side: u32) -> u32 {
    side.next_multiple_of(2)
}

/// A film that was made.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Film {
    /// The file.
    pub file: PathBuf,
    /// How many frames it has.
    pub frames: u64,
    /// Frames a second, numerator and denominator.
    pub fps: [u32; 2],
    /// Its width and height, even [pixels].
    pub size: [u32; 2],
    /// Its length [bytes].
    pub bytes: u64,
    /// What made it.
    pub maker: String,
    /// The line of ffmpeg, empty where the film was made without.
    pub line: Vec<String>,
}

/// Whether a film can be made under this name, to be asked before frames are.
///
/// # Errors
/// [`Error::Input`] for a name that does not end in .mp4; those of [`atomic::check`].
pub fn check(path: &Path) -> Result<()> {
    let ending = path.extension().unwrap_or_default();
    if !ending.eq_ignore_ascii_case("mp4") {
        return Err(Error::input(
            format!("--film {}", path.display()),
            "a film is an MP4 file",
            "let its name end in .mp4",
        ));
    }
    atomic::check(path)
}

/// Makes a film of frames. The file is there when it is whole, and not before.
///
/// # Errors
/// Those of [`Frames::size`] and [`check`]; [`Error::Domain`] for frames that are too large for the encoder; [`Error::Failed`] with
/// ffmpeg's own words when it fails; [`Error::Stopped`].
pub fn make(path: &Path, frames: &Frames, rate: Rate, maker: &Maker, task: Task) -> Result<Film> {
    check(path)?;
    let size = frames.size()?;
    let task = task.stage("film");
    match maker {
        Maker::BuiltIn => h264::write(path, frames, size, rate, task)?,
        Maker::Ffmpeg(program) => atomic::write_by_name(path, |aside| {
            let line = ffmpeg_line(program, aside, frames, size, rate);
            run(&line, frames.count(), task)
        })?,
    }
    task.tell(1.0);
    let line = maker.line(path, frames, size, rate);
    let bytes = path.metadata().map_err(|e| Error::reading(path, e))?.len();
    Ok(Film {
        file: path.to_owned(),
        frames: frames.count(),
        fps: rate.fraction(),
        size: size.map(even),
        bytes,
        maker: maker.to_string(),
        line: line
            .iter()
            .map(|word| word.to_string_lossy().into_owned())
            .collect(),
    })
}

/// Ends a process that is not waited for.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Runs ffmpeg to its end, or until the task is stopped.
fn run(line: &[OsString], count: u64, task: Task) -> Result<()> {
    let failed = |problem: String| {
        let remedy = "run the line by hand to see more, or take ffmpeg off PATH to use the encoder that is built in";
        Error::failed(problem, remedy)
    };
    let scratch = tempfile::tempfile().map_err(|e| failed(format!("no temporary file: {e}")))?;
    let mut said = scratch;
    let errors = said
        .try_clone()
        .map_err(|e| failed(format!("no temporary file: {e}")))?;
    let child = Command::new(&line[0])
        .args(&line[1..])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(errors)
        .spawn()
        .map_err(|e| failed(format!("ffmpeg does not start: {e}")))?;
    let mut child = Ended(child);
    if let Some(output) = child.0.stdout.take() {
        for line in BufReader::new(output).lines().map_while(|line| line.ok()) {
            task.check()?;
            if let Some(done) = line.strip_prefix("frame=")
                && let Ok(done) = done.trim().parse::<u64>()
            {
                task.tell(done as f64 / count.max(1) as f64);
            }
        }
    }
    let status = child
        .0
        .wait()
        .map_err(|e| failed(format!("ffmpeg is lost: {e}")))?;
    task.check()?;
    if status.success() {
        return Ok(());
    }
    let mut words = Vec::new();
    let _ = said.rewind().and_then(|()| said.read_to_end(&mut words));
    let words = String::from_utf8_lossy(&words).trim().to_owned();
    Err(failed(format!("ffmpeg failed ({status}): {words}")))
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

    fn frames(text: &str) -> Frames {
        Frames {
            template: Template::new(text).expect(text),
            indices: 7..31,
        }
    }

    #[test]
    fn the_line_of_ffmpeg_says_what_it_does() {
        let maker = Maker::Ffmpeg("ffmpeg".into());
        let line = |size| {
            let line = maker.line(
                Path::new("a film.mp4"),
                &frames("100%/f_{frame:04}.png"),
                size,
                Rate::new(24000, 1001).unwrap(),
            );
            let words = line.iter().map(|word| word.to_str().unwrap());
            words.collect::<Vec<_>>().join("|")
        };
        let even = line([320, 200]);
        for part in [
            "|-framerate|24000/1001|-start_number|7|-i|file:100%%/f_%04d.png|-frames:v|24|",
            "out_range=tv:out_color_matrix=bt709",
            "|-pix_fmt|yuv420p|",
            "|-colorspace|bt709|-color_primaries|bt709|-color_trc|bt709|-color_range|tv|",
            "|-movflags|+faststart|",
            "|file:a film.mp4",
        ] {
            assert!(even.contains(part), "{part} in {even}");
        }
        assert!(!even.contains("pad="));
        let odd = line([321, 199]);
        assert!(
            odd.contains("pad=322:200,fillborders=right=1:bottom=1:"),
            "{odd}"
        );
        assert!(line([321, 200]).contains("right=1:bottom=0:"));
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
        assert_eq!(pixels(&frames.template.path(2), [5, 3]).unwrap(), [7; 45]);
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

    #[test]
    fn a_film_has_the_ending_of_one() {
        assert!(check(Path::new("day.mkv")).is_err_and(|e| e.remedy().contains(".mp4")));
        assert!(check(Path::new("no-such-folder/day.mp4")).is_err());
        let folder = tempfile::tempdir().unwrap();
        assert!(check(&folder.path().join("day.MP4")).is_ok());
    }
}
