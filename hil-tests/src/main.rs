//! `dermatome-hil`: runs the firmware on an emulated board, for people and for tests.

mod common;
mod serve;
mod suite;
mod timeline;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Runs the firmware on an emulated board, or cases against any board.
#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs the cases against the board of a rig.
    Cases(suite::Cases),
    /// Boots the firmware on an emulated board and exposes its link.
    Run(serve::Run),
    /// Boots the firmware and prints what happens when.
    Trace(timeline::Trace),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Cases(cases) => cases.run(),
        Command::Run(run) => run.run(),
        Command::Trace(trace) => trace.run(),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
