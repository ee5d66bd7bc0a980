//! What the studies of scenes share: their flags, their scenes, the names of their plots, how far they are.

use crate::arguments::hinted::{hinted, text};
use crate::arguments::scene::{ViewArgs, setting};
use crate::arguments::size::{SizeFlag, size};
use crate::plots::plot::{Axis, Plot, Series};
use crate::progress::{Bar, duration};
use crate::tell;
use clap::Args;
use std::path::{Path, PathBuf};
use std::time::Instant;
use tyndall::conditions::Conditions;
use tyndall::error::nearest;
use tyndall::studies::{lamp_scenes, scenes};
use tyndall::{Error, Result};

/// The flags of studies of scenes.
#[derive(Args, Debug)]
pub struct StudyArgs {
    #[command(flatten)]
    view: ViewArgs,
    /// With --effect shafts, lamps or radiosity: scenes of the study, separated by commas, or `scene` for the one that is named
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = hinted(text, studies()), hide_possible_values = true)]
    study: Vec<String>,
    /// With --effect shafts, lamps or radiosity: the number of frames; the median of their times is reported
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub frames: usize,
    /// With --effect shafts, lamps or radiosity: set a knob that is not swept, as shadow.resolution=8192 [default: 4096]
    #[arg(long, value_name = "EFFECT.KNOB=VALUE", value_parser = setting)]
    pub set: Vec<(String, f64)>,
    /// With --effect shafts, lamps or radiosity: the picture's size in pixels, for scenes of the study [default: 512x512; lamps 120x80, radiosity 48x32]
    #[arg(long, value_name = "WxH", value_parser = size)]
    study_size: Option<SizeFlag>,
    /// With --effect shafts, lamps or radiosity: plot error against time (.svg, .png or .html, repeatable); each scene's name is added to the file's
    #[arg(long, value_name = "FILE")]
    plot: Vec<PathBuf>,
}

/// What a frame of a study takes in its scenes [s], where one of `size` takes `seconds` on two cores: by pixels.
pub fn by_pixels(
    scenes: &[(String, Conditions)],
    (size, seconds): ([u32; 2], f64),
) -> impl Iterator<Item = f64> {
    let pixels = |[width, height]: [u32; 2]| f64::from(width) * f64::from(height);
    let cores = rayon::current_num_threads() as f64;
    let own = scenes.iter().map(move |(_, c)| pixels(c.view.size));
    own.map(move |own| own / pixels(size) * seconds * 2.0 / cores)
}

/// Scenes of the studies.
fn studies() -> impl Iterator<Item = &'static str> {
    let scenes = scenes::NAMES.into_iter().chain(lamp_scenes::NAMES);
    scenes.chain(["scene"])
}

impl StudyArgs {
    /// The scenes that are asked for, with their names: those of `--study`, else the scene that is named, else `usual` ones of the
    /// study, at `size` unless the flags say otherwise.
    ///
    /// # Errors
    /// [`Error::Input`] for a scene that is not there, and for `--study-size` beside the scene that is named alone; those of [`ViewArgs::conditions`].
    pub fn scenes(&self, usual: &[&str], size: [u32; 2]) -> Result<Vec<(String, Conditions)>> {
        let named = self.view.scene.scene.is_some();
        let names = match (self.study.is_empty(), named) {
            (true, true) => vec!["scene".to_owned()],
            (true, false) => usual.iter().map(|name| (*name).to_owned()).collect(),
            (false, _) => self.study.clone(),
        };
        if self.study_size.is_some() && names.iter().all(|name| name == "scene") {
            return Err(Error::input(
                "--study-size",
                "it is the size of the study's own scenes, and none of them is asked for",
                "give the size of the scene that is named with --size",
            ));
        }
        names
            .into_iter()
            .map(|name| {
                if name == "scene" {
                    let conditions = self.view.conditions()?;
                    return Ok((conditions.scene.name.clone(), conditions));
                }
                // Names that somebody has in a script have spaces.
                let name = name.trim().replace(' ', "-");
                let view = scenes::named(&name).or_else(|| lamp_scenes::named(&name));
                let view = view.ok_or_else(|| {
                    let remedy = match nearest(&name, studies()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => {
                            let names: Vec<&str> = studies().collect();
                            format!("there are {}", names.join(", "))
                        }
                    };
                    Error::input(format!("--study {name}"), "there is no such scene", remedy)
                })?;
                Ok((
                    name,
                    view.conditions(self.study_size.map_or(size, |own| own.in_shape_of(size)))?,
                ))
            })
            .collect()
    }

    /// Says what a study will measure and for about how long, where a frame of a usual setting takes so many `seconds` in each of the
    /// scenes, and begins.
    pub fn watch(
        &self,
        scenes: &[(String, Conditions)],
        settings: usize,
        seconds: impl Iterator<Item = f64>,
    ) -> Watch {
        // A truth takes about as long as the settings that are compared with it.
        let runs = settings as f64 * (1.0 + self.frames as f64);
        let names = scenes.iter().map(|(name, conditions)| {
            let [width, height] = conditions.view.size;
            format!("{name} ({width} x {height})")
        });
        tell::line(
            "study",
            format!(
                "{settings} settings, {} frames of each, in {}; roughly {}",
                self.frames,
                names.collect::<Vec<_>>().join(", "),
                duration(runs * seconds.sum::<f64>()),
            ),
        );
        Watch {
            bar: tell::bar(),
            begun: Instant::now(),
            runs: scenes.len() * (settings + 1),
            done: 0,
        }
    }

    /// Refuses a plot for a study that has none.
    ///
    /// # Errors
    /// [`Error::Input`] where one is asked for.
    pub fn refuse_plot(&self, effect: &str) -> Result<()> {
        match self.plot.is_empty() {
            true => Ok(()),
            false => Err(Error::input(
                "--plot",
                format!("the study `{effect}` has no plot, only a table"),
                "leave it out, or choose --effect shafts, lamps or radiosity",
            )),
        }
    }

    /// Saves the plot of a scene's study, if one was asked for.
    pub fn save(&self, scene: &str, plot: impl FnOnce() -> Plot) -> Result<()> {
        if self.plot.is_empty() {
            return Ok(());
        }
        let plot = plot();
        if plot.series.is_empty() {
            tell::line(
                "note",
                format!("{scene} has none of the light that is measured: no plot"),
            );
            return Ok(());
        }
        let mut paths = self.plot.iter();
        paths.try_for_each(|path| plot.save(&named(path, scene)))
    }
}

/// How far a study is.
pub struct Watch {
    bar: Bar,
    begun: Instant,
    runs: usize,
    done: usize,
}

impl Watch {
    /// Does what writes lines, while nothing is drawn over them.
    pub fn apart<T>(&self, work: impl FnOnce() -> T) -> T {
        self.bar.apart(work)
    }

    /// The next of its runs begins: a truth, or a setting.
    pub fn next(&mut self, scene: &str, what: &str) {
        let share = self.done as f64 / self.runs as f64;
        let left = match self.done {
            0 => String::new(),
            _ => {
                let gone = self.begun.elapsed().as_secs_f64();
                format!(", about {} left", duration(gone * (1.0 - share) / share))
            }
        };
        self.done += 1;
        let (done, of) = (self.done, self.runs);
        self.bar
            .show(&format!("{scene}, {what}: {done} of {of}{left}"), share);
    }
}

fn named(path: &Path, scene: &str) -> PathBuf {
    let text =
        |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    let (stem, ending) = (text(path.file_stem()), text(path.extension()));
    path.with_file_name(format!("{stem}-{scene}.{ending}"))
}

/// Errors over times [ms], of series of settings.
pub fn error_over_time(title: String, caption: String, time: &str, series: Vec<Series>) -> Plot {
    Plot {
        title,
        caption,
        x: Axis {
            label: time.into(),
            unit: "ms".into(),
        },
        y: Axis {
            label: "relative RMSE".into(),
            unit: String::new(),
        },
        series,
        rivals: Vec::new(),
    }
}
