//! `power-cuts`: every flash state of a full-size upload, of which the cases take a sample.

use super::boot::Firmware;
use dermatome_hil::{cases, rig::Rig};
use std::{error::Error, num::NonZeroU64, process::ExitCode, time::Instant};

/// Options of `power-cuts`.
#[derive(clap::Args)]
pub(super) struct PowerCuts {
    #[command(flatten)]
    firmware: Firmware,
    /// Cuts at one operation of so many only; the commit record is cut in all ways regardless.
    #[arg(long, default_value = "1")]
    every: NonZeroU64,
}

impl PowerCuts {
    pub(super) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        let rig = self.firmware.open()?;
        if matches!(rig, Rig::Board { .. }) {
            return Err(format!(
                "rig `{}` is a real board; its power cannot be cut",
                self.firmware.rig_file().display()
            )
            .into());
        }
        let start = Instant::now();
        let found = cases::cut_full_size(&rig, self.every)?;
        say!("{found} of a full-size patch ({:.0} s)", start.elapsed().as_secs_f64());
        Ok(ExitCode::SUCCESS)
    }
}
