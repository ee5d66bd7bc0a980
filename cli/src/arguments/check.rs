//! Flags that have pictures measured by the reference, and a file to report in.

use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};
use std::path::{Path, PathBuf};
use tyndall::backend::check::{Check, Yardstick};
use tyndall::conditions::Conditions;
use tyndall::effect::Kept;
use tyndall::frame::Frame;
use tyndall::plan::{Overrules, Plan};
use tyndall::task::Task;
use tyndall::{Error, Result};

/// How pictures are measured, and where that is written.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Compare about N random pixels of a picture with the reference at its finest, and report the measured error
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    check: Option<u64>,
    /// With --check: fail (exit status 1) when a picture's relative RMSE is above X
    #[arg(long, value_name = "X", requires = "check", value_parser = share)]
    fail_above: Option<f64>,
    /// Write what was done to a JSON file
    #[arg(long, value_name = "FILE.json", value_parser = PathBufValueParser::new().try_map(report_file))]
    pub report: Option<PathBuf>,
}

impl CheckArgs {
    /// Whether pictures are to be measured.
    pub fn is_asked(&self) -> bool {
        self.check.is_some()
    }

    /// The measured error of a picture, if it was asked for. It is compared with the reference at its finest, with the same effects; what is
    /// kept of earlier pictures serves this one.
    pub fn measure(
        &self,
        (conditions, overrules): (&Conditions, &Overrules),
        frame: &Frame,
        kept: &Kept,
        task: Task,
    ) -> Result<Option<Check>> {
        let Some(count) = self.check else {
            return Ok(None);
        };
        let finest = Plan::new(conditions, &overrules.finest())?;
        let yardstick = Yardstick::keeping(&finest, count as usize, kept, task)?;
        yardstick.check(frame).map(Some)
    }

    /// Whether a picture, called this, is as right as it was asked to be.
    ///
    /// # Errors
    /// [`Error::Failed`] where it is not.
    pub fn judge(&self, picture: &str, check: &Check) -> Result<()> {
        let error = check.picture().relative_rmse;
        match self.fail_above {
            // Also where it is no number.
            Some(most) if !error.le(&most) => Err(Error::failed(
                format!("{picture}'s relative RMSE is {error:.3e}, above {most}"),
                "use a higher --quality, or allow more with --fail-above",
            )),
            _ => Ok(()),
        }
    }
}

/// A report's file: what standard output has is asked for otherwise.
fn report_file(path: PathBuf) -> Result<PathBuf, &'static str> {
    match path == Path::new("-") {
        true => Err("a file is named here; --json prints the same on standard output"),
        false => Ok(path),
    }
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if share >= 0.0 && share.is_finite() => Ok(share),
        _ => Err("a share of 0 or more was expected, as in 0.02".into()),
    }
}
