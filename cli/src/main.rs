//! The command line of tyndall.

mod completions;
mod doctor;
mod place_time;
mod stdout;
mod sun;

use clap::{CommandFactory, Parser, Subcommand};
use std::process::ExitCode;

/// Where the sun stands, what the sky looks like, what light does in the air
#[derive(Debug, Parser)]
#[command(name = "tyndall", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Sun position, rise, set, noon and twilights
    Sun(sun::SunArgs),
    Doctor(doctor::DoctorArgs),
    Completions(completions::CompletionsArgs),
    Man(completions::ManArgs),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Sun(args) => sun::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Completions(args) => completions::run(&args, Cli::command()),
        Command::Man(args) => completions::man(&args, Cli::command()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}\n  help: {}", error.problem(), error.remedy());
            ExitCode::from(if error.is_input() { 2 } else { 1 })
        }
    }
}
