//! `power-cuts`: every flash state of a full-size upload, of which the cases take a sample.

use dermatome_hil::{cases, rig::Rig};
use std::{error::Error, num::NonZeroU64, path::PathBuf, process::ExitCode, time::Instant};

/// Options of `power-cuts`.
#[derive(clap::Args)]
pub(super) struct PowerCuts {
    /// Rig file of an emulated board.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/rigs/virtual.toml"))]
    rig: PathBuf,
    /// Firmware to run instead of the rig's.
    #[arg(long)]
    elf: Option<PathBuf>,
    /// Cuts at one operation of so many only; the commit record is cut in all ways regardless.
    #[arg(long, default_value = "1")]
    every: NonZeroU64,
}

impl PowerCuts {
    pub(super) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        let rig = Rig::open(&self.rig, self.elf.as_deref())?;
        if matches!(rig, Rig::Board { .. }) {
            return Err(
                format!("rig `{}` is a real board; its power cannot be cut", self.rig.display()).into()
            );
        }
        let start = Instant::now();
        let found = cases::cut_full_size(&rig, self.every)?;
        say!("{found} of a full-size patch ({:.0} s)", start.elapsed().as_secs_f64());
        Ok(ExitCode::SUCCESS)
    }
}
