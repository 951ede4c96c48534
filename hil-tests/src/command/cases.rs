//! `cases`: runs the cases against a rig and says of each whether it passes.

use dermatome_hil::{
    cases::{self, Case},
    rig::{Capability, Rig},
};
use std::{error::Error, path::PathBuf, process::ExitCode, time::Instant};

/// Options of `cases`.
#[derive(clap::Args)]
pub(super) struct Cases {
    /// Rig file: which board.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/rigs/virtual.toml"))]
    rig: PathBuf,
    /// Firmware to run instead of the rig's.
    #[arg(long)]
    elf: Option<PathBuf>,
    /// Runs every case twice and compares what happened on the board, by the hash of its trace.
    #[arg(long)]
    twice: bool,
    /// Only cases whose name contains one of these.
    names: Vec<String>,
}

/// What became of the cases.
#[derive(Default)]
struct Count {
    passed: usize,
    failed: usize,
    not_run: usize,
    /// Hash of what happened on each emulated board.
    hashes: Vec<(&'static str, u64)>,
}

impl Cases {
    pub(super) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        let rig = Rig::open(&self.rig, self.elf.as_deref())?;
        let chosen = self.chosen();
        if chosen.is_empty() {
            return Err(format!("no case is called like that: {}", self.names.join(", ")).into());
        }
        let count = run_all(&rig, &chosen);
        let repeats = !self.twice || count.repeats_in(&run_all(&rig, &chosen));
        println!("{} passed, {} failed, {} not run", count.passed, count.failed, count.not_run);
        Ok(if count.failed == 0 && repeats { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    fn chosen(&self) -> Vec<Case> {
        let wanted =
            |case: &Case| self.names.is_empty() || self.names.iter().any(|name| case.name.contains(name));
        cases::all().into_iter().filter(wanted).collect()
    }
}

impl Count {
    /// Whether the same happened on the boards of a second run; prints what differs.
    fn repeats_in(&self, again: &Self) -> bool {
        let mut repeats = true;
        for ((name, first), (_, second)) in self.hashes.iter().zip(&again.hashes) {
            if first != second {
                println!("DIFFERS  {name}: {first:016x} and {second:016x}");
                repeats = false;
            }
        }
        println!("{} traces compared with those of a second run", again.hashes.len());
        repeats
    }
}

fn run_all(rig: &Rig, cases: &[Case]) -> Count {
    let mut count = Count::default();
    for case in cases {
        let missing: Vec<Capability> = case.needs.iter().copied().filter(|&need| !rig.can(need)).collect();
        if missing.is_empty() {
            run_one(rig, case, &mut count);
        } else {
            let missing: Vec<String> = missing.iter().map(ToString::to_string).collect();
            println!("not run  {}: this rig cannot {}", case.name, missing.join(", "));
            count.not_run += 1;
        }
    }
    count
}

fn run_one(rig: &Rig, case: &Case, count: &mut Count) {
    let start = Instant::now();
    let result = rig.fresh().map_err(cases::Failure::from).and_then(|board| {
        let measured = (case.run)(&board)?;
        if let Rig::Virtual(rig) = &board {
            count.hashes.push((case.name, rig.board.with(|machine| machine.chip(|chip| chip.trace.hash()))));
        }
        Ok(measured)
    });
    let seconds = start.elapsed().as_secs_f64();
    match &result {
        Ok(measured) if measured.is_empty() => println!("ok       {} ({seconds:.1} s)", case.name),
        Ok(measured) => println!("ok       {}: {measured} ({seconds:.1} s)", case.name),
        Err(error) => println!("FAILED   {}: {error} ({seconds:.1} s)", case.name),
    }
    if result.is_ok() {
        count.passed += 1;
    } else {
        count.failed += 1;
    }
}
