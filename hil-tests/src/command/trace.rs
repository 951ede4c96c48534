//! `trace`: what happens on the chip, and when.

use super::boot::{Firmware, boot, check_faults};
use dermatome::link;
use dermatome_hil::{
    chip::{time::Time, trace::Event},
    fault::{Fault, Schedule, parse_time},
    waves,
};
use std::{error::Error, fs, path::PathBuf, process::ExitCode};

/// Options of `trace`.
#[derive(clap::Args)]
pub(super) struct Trace {
    #[command(flatten)]
    firmware: Firmware,
    /// How long, in virtual time, after the start and the upload.
    #[arg(long = "for", default_value = "100ms", value_parser = parse_time)]
    time: Time,
    /// Patch to upload first.
    #[arg(long)]
    upload: Option<PathBuf>,
    /// Also write the events as a VCD file, for GTKWave.
    #[arg(long)]
    vcd: Option<PathBuf>,
    /// What goes wrong, and when (from switching on), e.g. power@150ms. Can be repeated.
    #[arg(long = "fault")]
    faults: Vec<Fault>,
}

impl Trace {
    pub(super) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        let patch = match &self.upload {
            None => None,
            Some(path) => {
                Some(fs::read(path).map_err(|error| format!("cannot read `{}`: {error}", path.display()))?)
            }
        };
        let (board, _) = boot(&self.firmware, true, None)?;
        check_faults(&self.faults, &board)?;
        if let Some(patch) = patch {
            link::upload(&mut board.link()?, &patch, |_| ())?;
        }
        let (mut schedule, time) = (Schedule::new(&self.faults), self.time);
        let result = board.with(move |machine| schedule.run(machine, machine.now() + time));
        let (events, hash) =
            board.with(|machine| machine.chip(|chip| (chip.trace.take(), chip.trace.hash())));
        print(&events, hash);
        if let Some(path) = &self.vcd {
            let bytes = waves::vcd(&events)?;
            dermatome::output::write_whole(path, &bytes)
                .map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
        }
        for (time, what) in result? {
            say!("{:>16} fault       {what}", time.to_string());
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn print(events: &[(Time, Event)], hash: u64) {
    for (time, event) in events {
        say!("{:>16} {event}", time.to_string());
    }
    say!("{} events, hash {hash:016x}", events.len());
}
