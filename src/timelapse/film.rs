//! A film of finished frames: H.264 in MP4, which every browser plays.
//!
//! ffmpeg makes it where it is installed with x264; otherwise an encoder in Rust does ([`Maker`]). Both get the same colours: the codes of
//! the PNGs through the matrix of ITU-R BT.709 in limited range, 4:2:0, and the file says so (`colr`, and the stream's own VUI). Sides of an
//! odd length get one more row or column, a copy of the last: 4:2:0 has none of odd lengths.

use super::frames::{Frames, Rate, even};
use super::h264;
use crate::error::{Error, Result};
use crate::output::atomic;
use crate::task::Task;
use std::ffi::{OsStr, OsString};
use std::fmt;
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

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
    let words = "-c:v libx264 -preset slow -crf 10 -pix_fmt yuv420p -colorspace bt709 -color_primaries bt709 -color_trc bt709 \
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
    use super::super::template::Template;
    use super::*;

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
    fn a_film_has_the_ending_of_one() {
        assert!(check(Path::new("day.mkv")).is_err_and(|e| e.remedy().contains(".mp4")));
        assert!(check(Path::new("no-such-folder/day.mp4")).is_err());
        let folder = tempfile::tempdir().unwrap();
        assert!(check(&folder.path().join("day.MP4")).is_ok());
    }
}
