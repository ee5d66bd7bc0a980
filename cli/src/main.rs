//! The command line of tyndall.

#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable
    )
)]

mod arguments;
mod commands;
mod machine;
mod plots;
mod progress;
mod signals;
mod tables;
mod targets;
mod tell;

use crate::commands::{
    accuracy, completions, daylight, doctor, photometry, plan, render, scene, schema, sky, sun,
    timelapse,
};
use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Parser, Subcommand};
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;
use tell::Talk;
use tyndall::Error;

/// Where the sun stands, what the sky looks like, what light does in the air
#[derive(Debug, Parser)]
#[command(name = "tyndall", version)]
struct Cli {
    /// Say nothing on standard error but warnings and errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Say more on standard error: every effect that does not run, and why
    #[arg(short, long, global = true)]
    verbose: bool,
    #[command(subcommand)]
    command: Command,
}

impl Cli {
    fn talk(&self) -> Talk {
        match (self.quiet, self.verbose) {
            (true, _) => Talk::Quiet,
            (_, true) => Talk::Verbose,
            _ => Talk::Usual,
        }
    }
}

#[derive(Debug, Subcommand)]
enum Command {
    Render(Box<commands::render_args::RenderArgs>),
    // Its times are between its ends.
    #[command(mut_arg("time", |time| time.hide(true)))]
    Timelapse(Box<timelapse::TimelapseArgs>),
    Plan(plan::PlanCommand),
    // A meter is read where a picture is looked at.
    #[command(mut_arg("quality", |quality| quality.default_value("high")))]
    Daylight(Box<daylight::DaylightArgs>),
    /// Sun position, rise, set, noon and twilights
    Sun(Box<sun::SunArgs>),
    Sky(Box<sky::SkyArgs>),
    /// What accuracy costs in time
    Accuracy(accuracy::AccuracyArgs),
    Photometry(photometry::PhotometryArgs),
    Doctor(doctor::DoctorArgs),
    Scene(scene::SceneCommand),
    Schema(schema::SchemaArgs),
    Completions(completions::CompletionsArgs),
    Man(completions::ManArgs),
}

/// Flags whose values may begin with a minus sign, so that clap would take a flag for their value.
const SIGNED: [&str; 8] = [
    "--at", "--time", "--from", "--to", "--tz", "--sun", "--eye", "--target",
];

/// Ends the program where one of [`SIGNED`] is followed by a flag instead of a value.
fn check_values(arguments: &[String]) {
    for pair in arguments.windows(2) {
        if SIGNED.contains(&&*pair[0]) && pair[1].starts_with("--") {
            let text = format!("{} needs a value, found the flag {}", pair[0], pair[1]);
            Cli::command()
                .error(clap::error::ErrorKind::InvalidValue, text)
                .exit();
        }
    }
}

fn main() -> ExitCode {
    let arguments = std::env::args_os().map(|a| a.to_string_lossy().into_owned());
    check_values(&arguments.collect::<Vec<_>>());
    match Cli::try_parse() {
        Ok(cli) => {
            tell::set(cli.talk());
            signals::prepare();
            machine::run(move || run(cli.command))
        }
        Err(said) => print(said),
    }
}

/// More names than these, such as those of time zones, are no help where one is missing.
const MOST_NAMES: usize = 30;

/// Prints what is wrong with the flags, or the help that was asked for, and says whether that went well.
fn print(mut said: clap::Error) -> ExitCode {
    if let Some(ContextValue::Strings(names)) = said.get(ContextKind::ValidValue)
        && names.len() > MOST_NAMES
    {
        said.remove(ContextKind::ValidValue);
    }
    let printed = said.print().and_then(|()| std::io::stdout().flush());
    match printed {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            tell::error(&Error::writing(Path::new("standard output"), error));
            ExitCode::FAILURE
        }
        _ => ExitCode::from(u8::try_from(said.exit_code()).unwrap_or(2)),
    }
}

fn run(command: Command) -> ExitCode {
    let result = machine::prepare().and_then(|()| match command {
        Command::Render(args) => render::run(&args),
        Command::Timelapse(args) => timelapse::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Daylight(args) => daylight::run(&args),
        Command::Sun(args) => sun::run(&args),
        Command::Sky(args) => sky::run(&args),
        Command::Accuracy(args) => accuracy::run(&args),
        Command::Photometry(args) => photometry::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Scene(args) => scene::run(&args),
        Command::Schema(args) => schema::run(&args),
        Command::Completions(args) => completions::run(&args, Cli::command()),
        Command::Man(args) => completions::man(&args, Cli::command()),
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            tell::error(&error);
            let asked = match error {
                Error::Stopped => signals::exit_status(),
                Error::Unfinished { .. } => Some(signals::TRY_AGAIN),
                _ => None,
            };
            ExitCode::from(asked.unwrap_or(if error.is_input() { 2 } else { 1 }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::error::ErrorKind;

    #[test]
    fn every_flag_takes_the_names_that_complete_it() {
        let mut count = 0;
        let refused = |command: &str, flag: &str, value: &str| {
            // Other flags may be missing, which is told after values are read.
            let words = ["tyndall", command, &format!("--{flag}={value}")];
            let read = Cli::command().try_get_matches_from(words);
            let kind = read.err().map(|error| error.kind());
            matches!(
                kind,
                Some(ErrorKind::ValueValidation | ErrorKind::InvalidValue)
            )
        };
        let mut all = Cli::command();
        all.build();
        for command in all.get_subcommands() {
            for flag in command
                .get_arguments()
                .filter(|a| a.get_action().takes_values())
            {
                let Some(long) = flag.get_long() else {
                    continue;
                };
                for name in flag.get_possible_values() {
                    let (command, name) = (command.get_name(), name.get_name());
                    assert!(!refused(command, long, name), "{command} --{long} {name}");
                    count += 1;
                }
            }
        }
        assert!(count > 100, "{count}");
        for (command, flag) in [("sky", "color-space"), ("sun", "tier"), ("render", "fold")] {
            assert!(
                refused(command, flag, "nothing-like-it"),
                "{command} --{flag}"
            );
        }
    }
}
