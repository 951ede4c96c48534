//! The command line: one file for each command, and what `run` and `trace` have in common.

/// [`println!`] that [`say`] prints.
macro_rules! say {
    ($($words:tt)*) => {
        $crate::command::say(format_args!($($words)*))
    };
}

mod boards;
mod boot;
mod cases;
mod fingers;
mod mutants;
mod power_cuts;
mod run;
mod soak;
mod trace;

use clap::{Parser, Subcommand};
use std::{
    error::Error,
    fmt,
    io::{self, Write},
    process::{self, ExitCode},
};

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
    /// Draws boards from their parts' tolerances: errors of their voltages, before and after a trim.
    Boards(boards::Boards),
    /// Cuts the power at every flash operation of a full-size upload.
    PowerCuts(power_cuts::PowerCuts),
    /// Builds the firmware with one fault after the other, and says which cases notice.
    Mutants(mutants::Mutants),
    /// Boots the firmware on an emulated board and exposes its link.
    Run(run::Run),
    /// Lets something go wrong again and again, for a long virtual time.
    Soak(soak::Soak),
    /// Boots the firmware and prints what happens when.
    Trace(trace::Trace),
}

impl Arguments {
    pub(crate) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        match self.command {
            Command::Cases(cases) => cases.run(),
            Command::Boards(boards) => boards.run(),
            Command::PowerCuts(cuts) => cuts.run(),
            Command::Mutants(mutants) => mutants.run(),
            Command::Run(run) => run.run(),
            Command::Soak(soak) => soak.run(),
            Command::Trace(trace) => trace.run(),
        }
    }
}

/// Prints a line. Where nobody reads any more (`dermatome-hil ... | head -1`) the command goes on quietly; where the
/// line cannot be written for another reason, it ends with an error.
fn say(words: fmt::Arguments<'_>) {
    let Err(error) = writeln!(io::stdout(), "{words}") else { return };
    if error.kind() != io::ErrorKind::BrokenPipe {
        eprintln!("error: cannot write to standard output: {error}");
        process::exit(1);
    }
}
