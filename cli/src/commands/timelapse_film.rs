//! What `tyndall timelapse` makes of finished frames: film, contact sheet, curves, page; and jobs for clusters.

use crate::plots::{contact_sheet, timelapse_curves, timelapse_page};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::ffi::OsString;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use tyndall::output::{self, Format, atomic};
use tyndall::task::Task;
use tyndall::timelapse::cluster::Job;
use tyndall::timelapse::film::{self, Film, Maker};
use tyndall::timelapse::frames::{Frames, Rate};
use tyndall::timelapse::plan::Outline;
use tyndall::timelapse::template::{self, Template};
use tyndall::warning::Warning;
use tyndall::{Error, Result};

/// Film, sheet, curves and page; jobs.
#[derive(Debug, Args)]
pub struct FilmArgs {
    /// Make a film of the frames' PNGs: H.264 in MP4, by ffmpeg where it is found, else by an encoder that is built in
    #[arg(long, value_name = "FILE.mp4")]
    film: Option<PathBuf>,
    /// Frames a second of the film: 24, or a fraction such as 24000/1001
    #[arg(long, value_name = "RATE", default_value = "24", value_parser = Rate::parse)]
    fps: Rate,
    /// Put a contact sheet of the frames' PNGs together
    #[arg(long, value_name = "FILE.png")]
    sheet: Option<PathBuf>,
    /// Draw the sun's path and the exposure curve (.svg or .png)
    #[arg(long, value_name = "FILE")]
    curves: Option<PathBuf>,
    /// Write one HTML page of the run, with sheet and curves in it
    #[arg(long, value_name = "FILE.html")]
    page: Option<PathBuf>,
    /// Render nothing: make film, sheet, curves and page of finished frames; where some are missing or stale, print the --only that makes
    /// them and exit with 75
    #[arg(long, conflicts_with_all = ["emit", "shard", "only", "check"])]
    assemble: bool,
    /// Print a job that makes the frames in shards on a cluster and puts them together, and render nothing
    #[arg(long, value_name = "ENGINE", value_enum, conflicts_with_all = ["shard", "only", "report"])]
    emit: Option<Engine>,
    /// With --emit: how many shards
    #[arg(long, value_name = "N", default_value_t = 8)]
    shards: u64,
}

/// What spreads work over a cluster.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Engine {
    /// A batch file: `bash FILE` submits it
    Slurm,
    /// Manifests: `kubectl apply -f FILE`
    Kubernetes,
}

/// The flags of this file, and whether each has a value: what they say changes no frame.
pub const FLAGS: [(&str, bool); 8] = [
    ("--film", true),
    ("--fps", true),
    ("--sheet", true),
    ("--curves", true),
    ("--page", true),
    ("--assemble", false),
    ("--emit", true),
    ("--shards", true),
];

/// Those of a command that prints a job which the job's last command does not have.
const OF_EMIT: [(&str, bool); 5] = [
    ("--assemble", false),
    ("--emit", true),
    ("--shards", true),
    ("--dry-run", false),
    ("--json", false),
];

/// How many frames sheet, curves and page tell of at most; of longer sequences every so many, so that memory does not grow with them.
const MOST_LINES: u64 = 10_000;

/// What is made.
#[derive(Debug, Default, PartialEq)]
struct Wanted {
    film: Option<PathBuf>,
    sheet: Option<PathBuf>,
    curves: Option<PathBuf>,
    page: Option<PathBuf>,
}

impl FilmArgs {
    /// Whether finished frames are put together, and nothing is rendered.
    pub fn assembles(&self) -> bool {
        self.assemble
    }

    /// Whether a job is printed, and nothing is rendered.
    pub fn emits(&self) -> bool {
        self.emit.is_some()
    }

    /// What is made of frames of these names, whose plan file is `plan`: what the flags say; with --assemble and none of them, everything, by
    /// names beside the plan.
    fn wanted(&self, plan: &Path, outputs: &[Template]) -> Wanted {
        let wanted = Wanted {
            film: self.film.clone(),
            sheet: self.sheet.clone(),
            curves: self.curves.clone(),
            page: self.page.clone(),
        };
        if !self.assemble || wanted != Wanted::default() {
            return wanted;
        }
        let name = plan.file_name().unwrap_or_default().to_string_lossy();
        let name = name.split(".plan.").next().unwrap_or_default();
        let beside = |ending: &str| Some(plan.with_file_name(format!("{name}{ending}")));
        let shown = png_of(outputs).is_some();
        Wanted {
            film: beside(".mp4").filter(|_| shown),
            sheet: beside("-sheet.png").filter(|_| shown),
            curves: beside("-curves.svg"),
            page: beside(".html"),
        }
    }

    /// Whether all that is wanted can be made of frames of these indices: to be asked before they are rendered. `partial` says that this
    /// process renders a part of them only; `in_use` are files that are read or written otherwise.
    ///
    /// # Errors
    /// [`Error::Input`] for a film or sheet of frames without PNGs or of a part of them, for endings of other files and for files that are in
    /// use; those of [`atomic::check`].
    pub fn check(
        &self,
        plan: &Path,
        outputs: &[Template],
        indices: &Range<u64>,
        partial: bool,
        in_use: &[(PathBuf, &str)],
    ) -> Result<()> {
        let wanted = self.wanted(plan, outputs);
        if partial && wanted != Wanted::default() {
            return Err(Error::input(
                "--film, --sheet, --curves and --page",
                "they are made of all frames, and this process makes a part of them",
                "leave them out, and run the command once more with --assemble instead of --shard or --only",
            ));
        }
        if (wanted.film.is_some() || wanted.sheet.is_some()) && png_of(outputs).is_none() {
            return Err(Error::input(
                "--film and --sheet",
                "they are made of PNGs, and no -o names any",
                "add -o with a name in .png, such as out/frame_{frame:04}.png",
            ));
        }
        let mut in_use = in_use.to_vec();
        in_use.push((plan.to_owned(), "the plan"));
        let files = [
            ("--film", wanted.film, &["mp4"][..], "the film"),
            ("--sheet", wanted.sheet, &["png"], "the sheet"),
            ("--curves", wanted.curves, &["svg", "png"], "the curves"),
            ("--page", wanted.page, &["html"], "the page"),
        ];
        for (flag, file, endings, what) in files {
            let Some(file) = file else { continue };
            let ending = file.extension().unwrap_or_default();
            if !endings
                .iter()
                .any(|known| ending.eq_ignore_ascii_case(known))
            {
                return Err(Error::input(
                    format!("{flag} {}", file.display()),
                    "its name has another ending",
                    format!("let it end in .{}", endings.join(" or .")),
                ));
            }
            output::check_apart(flag, &file, &in_use)?;
            template::check_apart(outputs, indices, &[(file.clone(), what)])?;
            // A job runs elsewhere.
            if !self.emits() {
                atomic::check(&file)?;
            }
            in_use.push((file, what));
        }
        Ok(())
    }

    /// Makes what is wanted of frames that are all there, and says what that was, for the report.
    ///
    /// # Errors
    /// Those of reading the plan and the frames, of [`film::make`], and of writing files.
    pub fn make(&self, plan: &Path, warnings: &[Warning], task: Task) -> Result<Value> {
        let outline = Outline::read(plan, MOST_LINES)?;
        let outputs = outline.header.templates()?;
        let wanted = self.wanted(plan, &outputs);
        if wanted == Wanted::default() {
            return Ok(Value::Null);
        }
        let frames = png_of(&outputs).map(|template| Frames {
            template: template.clone(),
            indices: outline.header.indices(),
        });
        let title = timelapse_page::title(&outline);
        let film = match (&wanted.film, &frames) {
            (Some(path), Some(frames)) => Some(self.film(path, frames, task)?),
            _ => None,
        };
        let sheet = match &frames {
            Some(frames) if wanted.sheet.is_some() || wanted.page.is_some() => {
                task.check()?;
                let sheet = contact_sheet::draw(&title, frames, &outline)?;
                Some(sheet.png()?)
            }
            _ => None,
        };
        if let (Some(path), Some(sheet)) = (&wanted.sheet, &sheet) {
            atomic::write(path, |file| file.write_all(sheet))?;
        }
        let curves = timelapse_curves::draw(&title, &outline);
        if let Some(path) = &wanted.curves {
            curves.save(path)?;
        }
        if let Some(path) = &wanted.page {
            let warnings: Vec<String> = warnings.iter().map(Warning::to_string).collect();
            let address = film
                .as_ref()
                .map(|film| timelapse_page::address(path, &film.file));
            let page = timelapse_page::Page {
                outline: &outline,
                warnings: &warnings,
                film: film.as_ref().zip(address.as_deref()),
                sheet: sheet.as_deref(),
                curves: &curves.svg(),
                plan,
            };
            atomic::write(path, |file| file.write_all(page.html().as_bytes()))?;
        }
        let made = [wanted.film, wanted.sheet, wanted.curves, wanted.page];
        let made: Vec<PathBuf> = made.into_iter().flatten().collect();
        crate::tell::files(&made);
        Ok(json!({ "film": film, "files": made }))
    }

    /// Makes the film, and says how.
    fn film(&self, path: &Path, frames: &Frames, task: Task) -> Result<Film> {
        let maker = Maker::find();
        let line = maker.line(path, frames, frames.size()?, self.fps);
        crate::tell::film(&maker, &line);
        film::make(path, frames, self.fps, &maker, task)
    }

    /// Prints the job for a cluster: `arguments` are those of this process, its program first.
    ///
    /// # Errors
    /// Those of [`Job::new`]; [`Error::Input`] for an argument that is not UTF-8; [`Error::File`] where standard output cannot be written, or
    /// the folder is not known.
    pub fn emit(&self, name: &str, arguments: &[OsString], frames: u64) -> Result<()> {
        let Some(engine) = self.emit else {
            return Ok(());
        };
        let here = |e| Error::reading(Path::new("."), e);
        let folder = std::env::current_dir().map_err(here)?;
        let words = arguments.get(1..).unwrap_or_default();
        let words = words.iter().map(|word| {
            let text = word.to_str().ok_or_else(|| {
                Error::input(
                    format!("{}", word.display()),
                    "it is not UTF-8, which no job holds",
                    "rename the file or folder",
                )
            });
            text.map(str::to_owned)
        });
        let words = &words.collect::<Result<Vec<_>>>()?[..];
        let program = match engine {
            // The one that is running; the image has its own.
            Engine::Slurm => std::env::current_exe().map_err(here)?.display().to_string(),
            Engine::Kubernetes => "tyndall".into(),
        };
        let command = |words: Vec<String>, more: &[&str]| {
            let more = more.iter().map(|word| (*word).to_owned());
            [program.clone()]
                .into_iter()
                .chain(before_flags(words))
                .chain(more)
                .collect::<Vec<_>>()
        };
        let job = Job::new(
            name,
            &folder.display().to_string(),
            &command(without(&without(words, &FLAGS), &OF_EMIT), &[]),
            &command(without(words, &OF_EMIT), &["--assemble"]),
            self.shards.min(frames.max(1)),
        )?;
        let text = match engine {
            Engine::Slurm => job.slurm(),
            Engine::Kubernetes => job.kubernetes("tyndall:latest", "frames"),
        };
        let mut out = std::io::stdout().lock();
        let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
        written.map_err(|e| Error::writing(Path::new("standard output"), e))
    }
}

/// The first names of PNGs.
fn png_of(outputs: &[Template]) -> Option<&Template> {
    let png = |template: &&Template| template.format().is_ok_and(|f| f == Format::Png);
    outputs.iter().find(png)
}

/// Words of a command line that flags may follow: without a `--`, behind which they would be none. Of what is behind it, the scene's file, a
/// name that begins like a flag is written as a path.
fn before_flags(mut words: Vec<String>) -> Vec<String> {
    if let Some(at) = words.iter().position(|word| word == "--") {
        words.remove(at);
        for word in &mut words[at..] {
            if word.starts_with('-') {
                word.insert_str(0, "./");
            }
        }
    }
    words
}

/// Words of a command line without some flags and their values.
pub fn without(words: &[String], flags: &[(&str, bool)]) -> Vec<String> {
    let mut kept = Vec::new();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        if word == "--" {
            kept.push(word.clone());
            break;
        }
        let name = word.split_once('=').map_or(&**word, |(name, _)| name);
        match flags.iter().find(|(flag, _)| *flag == name) {
            None => kept.push(word.clone()),
            Some((_, true)) if name == word => {
                words.next();
            }
            Some(_) => {}
        }
    }
    // No flags are behind a `--`.
    kept.extend(words.cloned());
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_has_the_flags_of_the_whole_but_its_own() {
        let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let all = words(
            "timelapse a.toml --film day.mp4 -o out/#.png --page=day.html --emit slurm --fps 25 --shards 3 --dry-run --size 9x9",
        );
        assert_eq!(
            without(&without(&all, &FLAGS), &OF_EMIT),
            words("timelapse a.toml -o out/#.png --size 9x9")
        );
        assert_eq!(
            without(&words("timelapse --json -- --json"), &OF_EMIT),
            words("timelapse -- --json")
        );
        assert_eq!(
            before_flags(words("timelapse --size 9x9 -- -a.toml")),
            words("timelapse --size 9x9 ./-a.toml")
        );
        assert_eq!(
            without(&all, &OF_EMIT),
            words(
                "timelapse a.toml --film day.mp4 -o out/#.png --page=day.html --fps 25 --size 9x9"
            )
        );
    }
}
