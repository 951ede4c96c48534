//! `cases`: runs the cases against a rig and says of each whether it holds.

use dermatome_hil::{
    cases::{self, Case},
    rig::{Capability, Rig},
};
use std::{error::Error, path::PathBuf, process::ExitCode, time::Instant};

/// Options of `cases`.
#[derive(clap::Args)]
pub(crate) struct Cases {
    /// Rig file: which board.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/rigs/virtual.toml"))]
    rig: PathBuf,
    /// Firmware to run instead of the rig's.
    #[arg(long)]
    elf: Option<PathBuf>,
    /// Only cases whose name holds one of these.
    names: Vec<String>,
}

impl Cases {
    pub(crate) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        let rig = Rig::open(&self.rig, self.elf.as_deref())?;
        let wanted =
            |case: &Case| self.names.is_empty() || self.names.iter().any(|name| case.name.contains(name));
        let chosen: Vec<Case> = cases::all().into_iter().filter(wanted).collect();
        if chosen.is_empty() {
            return Err(format!("no case is called like that: {}", self.names.join(", ")).into());
        }
        let (mut passed, mut failed, mut not_run) = (0, 0, 0);
        for case in chosen {
            let missing: Vec<Capability> =
                case.needs.iter().copied().filter(|&need| !rig.can(need)).collect();
            if !missing.is_empty() {
                let missing: Vec<String> = missing.iter().map(ToString::to_string).collect();
                println!("not run  {}: this rig cannot {}", case.name, missing.join(", "));
                not_run += 1;
                continue;
            }
            let start = Instant::now();
            let result = rig.fresh().map_err(cases::Failure::from).and_then(|board| (case.run)(&board));
            let seconds = start.elapsed().as_secs_f64();
            match &result {
                Ok(measured) if measured.is_empty() => println!("ok       {} ({seconds:.1} s)", case.name),
                Ok(measured) => println!("ok       {}: {measured} ({seconds:.1} s)", case.name),
                Err(error) => println!("FAILED   {}: {error} ({seconds:.1} s)", case.name),
            }
            if result.is_ok() { passed += 1 } else { failed += 1 }
        }
        println!("{passed} passed, {failed} failed, {not_run} not run");
        Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}
