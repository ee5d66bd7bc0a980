//! The command line of tyndall.

mod accuracy;
mod draw;
mod output;
mod place_time;
mod sun;
mod sun_batch;
mod sun_path;

use std::process::ExitCode;

use clap::Parser;

/// An outdoor sky and light-shaft simulator
#[derive(Parser)]
#[command(name = "tyndall", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Sun position, rise, set, noon and twilights
    Sun(Box<sun::SunArgs>),
    /// What accuracy costs in time
    Accuracy(accuracy::AccuracyArgs),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Sun(args) => sun::run(&args),
        Command::Accuracy(args) => accuracy::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}\n  help: {}", error.problem(), error.remedy());
            ExitCode::from(if error.is_input() { 2 } else { 1 })
        }
    }
}
