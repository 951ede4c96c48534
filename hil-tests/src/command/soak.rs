//! `soak`: faults at random for a long virtual time, and a right state after each.

use super::boot::Firmware;
use dermatome_hil::{cases, chip::time::Time, fault::parse_time, rig::Rig};
use std::{error::Error, process::ExitCode, time::Instant};

/// Options of `soak`.
#[derive(clap::Args)]
pub(super) struct Soak {
    #[command(flatten)]
    firmware: Firmware,
    /// How long, in virtual time.
    #[arg(long = "for", default_value = "3600s", value_parser = parse_time)]
    time: Time,
    /// What happens when, at random.
    #[arg(long, default_value = "1")]
    seed: u64,
    /// Also prints each thing as it has happened.
    #[arg(long)]
    verbose: bool,
}

impl Soak {
    pub(super) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        let rig = self.firmware.open()?;
        if matches!(rig, Rig::Board { .. }) {
            return Err(format!(
                "rig `{}` is a real board, to which nothing can happen",
                self.firmware.rig_file().display()
            )
            .into());
        }
        let start = Instant::now();
        let seen = cases::soak(&rig, self.time, self.seed, |what| {
            if self.verbose {
                say!("{what}");
            }
        })?;
        say!("{seen} ({:.0} s on the clock on the wall)", start.elapsed().as_secs_f64());
        Ok(ExitCode::SUCCESS)
    }
}
