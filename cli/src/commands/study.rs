//! What the studies of scenes share: their flags, their scenes, the names of their plots.

use crate::arguments::scene::{ViewArgs, setting, size};
use crate::plots::plot::{Axis, Plot, Series};
use clap::Args;
use std::path::{Path, PathBuf};
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
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    study: Vec<String>,
    /// With --effect shafts, lamps or radiosity: the number of frames; the median of their times is reported
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub frames: usize,
    /// With --effect shafts, lamps or radiosity: set a knob that is not swept, as shadow.resolution=8192 [default: 4096]
    #[arg(long, value_name = "EFFECT.KNOB=VALUE", value_parser = setting)]
    pub set: Vec<(String, f64)>,
    /// With --effect shafts, lamps or radiosity: the picture's size in pixels, for scenes of the study [default: 512x512; lamps 120x80, radiosity 48x32]
    #[arg(long, value_name = "WxH", value_parser = size)]
    study_size: Option<[u32; 2]>,
    /// With --effect shafts, lamps or radiosity: plot error against time (.svg, .png or .html); each scene's name is added to the file's
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

impl StudyArgs {
    /// The scenes that are asked for, with their names: those of `--study`, else the scene that is named, else `usual` ones of the
    /// study, at `size` unless the flags say otherwise.
    ///
    /// # Errors
    /// [`Error::Input`] for a scene that is not there; those of [`ViewArgs::conditions`].
    pub fn scenes(&self, usual: &[&str], size: [u32; 2]) -> Result<Vec<(String, Conditions)>> {
        let named = self.view.scene.scene.is_some();
        let names = match (self.study.is_empty(), named) {
            (true, true) => vec!["scene".to_owned()],
            (true, false) => usual.iter().map(|name| (*name).to_owned()).collect(),
            (false, _) => self.study.clone(),
        };
        names
            .into_iter()
            .map(|name| {
                if name == "scene" {
                    let conditions = self.view.conditions()?;
                    return Ok((conditions.scene.name.clone(), conditions));
                }
                let view = scenes::named(&name).or_else(|| lamp_scenes::named(&name));
                let view = view.ok_or_else(|| {
                    let names = [&scenes::NAMES[..], &lamp_scenes::NAMES].concat();
                    let remedy = match nearest(&name, names.iter().copied()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("there are {}", names.join(", ")),
                    };
                    Error::input(format!("--study {name}"), "there is no such scene", remedy)
                })?;
                Ok((name, view.conditions(self.study_size.unwrap_or(size))?))
            })
            .collect()
    }

    /// Saves the plot of a scene's study, if one was asked for.
    pub fn save(&self, scene: &str, plot: impl FnOnce() -> Plot) -> Result<()> {
        let Some(path) = &self.plot else {
            return Ok(());
        };
        let plot = plot();
        if plot.series.is_empty() {
            eprintln!("note: {scene} has none of the light that is measured: no plot");
            return Ok(());
        }
        plot.save(&named(path, scene))
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
