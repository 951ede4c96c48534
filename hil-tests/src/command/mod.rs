//! The command line: one file for each command, and what `run` and `trace` have in common.

mod boot;
mod cases;
mod mutants;
mod run;
mod trace;

use clap::{Parser, Subcommand};
use std::{error::Error, process::ExitCode};

/// Runs the firmware on an emulated board, or cases against any board.
#[derive(Parser)]
#[command(version, about)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs the cases against the board of a rig.
    Cases(cases::Cases),
    /// Builds the firmware with one fault after the other, and says which cases notice.
    Mutants(mutants::Mutants),
    /// Boots the firmware on an emulated board and exposes its link.
    Run(run::Run),
    /// Boots the firmware and prints what happens when.
    Trace(trace::Trace),
}

impl Arguments {
    pub(crate) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        match self.command {
            Command::Cases(cases) => cases.run(),
            Command::Mutants(mutants) => mutants.run(),
            Command::Run(run) => run.run(),
            Command::Trace(trace) => trace.run(),
        }
    }
}
