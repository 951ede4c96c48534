//! `cases`: runs the cases against a rig and says of each whether it passes.

use super::boot::Firmware;
use dermatome_hil::{
    cases::{self, Case},
    rig::{Capability, Rig, VirtualRig},
};
use std::{
    collections::BTreeMap,
    error::Error,
    panic::{AssertUnwindSafe, catch_unwind},
    process::ExitCode,
    sync::{
        atomic::{AtomicUsize, Ordering},
        mpsc,
    },
    thread::{self, available_parallelism},
    time::Instant,
};

/// Options of `cases`.
#[derive(clap::Args)]
pub(super) struct Cases {
    #[command(flatten)]
    firmware: Firmware,
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
        let rig = self.firmware.open()?;
        let chosen = self.chosen(&rig);
        if chosen.is_empty() {
            return Err(format!("no case is called like that: {}", self.names.join(", ")).into());
        }
        let count = run_all(&rig, &chosen);
        let repeats = !self.twice || count.repeats_in(&run_all(&rig, &chosen));
        say!("{} passed, {} failed, {} not run", count.passed, count.failed, count.not_run);
        Ok(if count.failed == 0 && repeats { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    /// Boards on one line, on one CAN bus and on USB have cases of their own.
    fn chosen(&self, rig: &Rig) -> Vec<Case> {
        let wanted =
            |case: &Case| self.names.is_empty() || self.names.iter().any(|name| case.name.contains(name));
        let all = if rig.can(Capability::SharedLine) {
            cases::on_a_bus()
        } else if rig.can(Capability::CanBus) {
            cases::on_can()
        } else if rig.can(Capability::Usb) {
            cases::on_usb()
        } else {
            cases::all()
        };
        all.into_iter().filter(wanted).collect()
    }
}

impl Count {
    fn shown(&self) -> usize {
        self.passed + self.failed + self.not_run
    }

    fn show(&mut self, name: &'static str, outcome: Outcome) {
        match outcome {
            Outcome::Passed { measured, seconds, hash } => {
                let measured = if measured.is_empty() { measured } else { format!(": {measured}") };
                say!("ok       {name}{measured} ({seconds:.1} s)");
                self.hashes.extend(hash.map(|hash| (name, hash)));
                self.passed += 1;
            }
            Outcome::Failed(error) => {
                say!("FAILED   {name}: {error}");
                self.failed += 1;
            }
            Outcome::NotRun(missing) => {
                say!("not run  {name}: this rig cannot {missing}");
                self.not_run += 1;
            }
        }
    }

    /// Whether the same happened on the boards of a second run; prints what differs.
    fn repeats_in(&self, again: &Self) -> bool {
        let mut repeats = true;
        for ((name, first), (_, second)) in self.hashes.iter().zip(&again.hashes) {
            if first != second {
                say!("DIFFERS  {name}: {first:016x} and {second:016x}");
                repeats = false;
            }
        }
        say!("{} traces compared with those of a second run", again.hashes.len());
        repeats
    }
}

/// Runs the cases, on emulated boards as many side by side as there are cores; prints them in order.
fn run_all(rig: &Rig, cases: &[Case]) -> Count {
    let workers = match rig {
        Rig::Virtual(_) | Rig::Bus(_) => available_parallelism().map_or(1, usize::from),
        Rig::Board { .. } => 1,
    };
    let next = AtomicUsize::new(0);
    let (done, results) = mpsc::channel();
    let mut count = Count::default();
    thread::scope(|scope| {
        for _ in 0..workers {
            let (done, next) = (done.clone(), &next);
            scope.spawn(move || {
                while let Some((place, case)) = take_next(cases, next) {
                    // Whoever waits for it is there until all are done.
                    let _ = done.send((place, run_one(rig, case)));
                }
            });
        }
        drop(done);
        let mut early = BTreeMap::new();
        for (place, outcome) in results {
            early.insert(place, outcome);
            while let Some(outcome) = early.remove(&count.shown()) {
                count.show(cases[count.shown()].name, outcome);
            }
        }
    });
    count
}

fn take_next<'a>(cases: &'a [Case], next: &AtomicUsize) -> Option<(usize, &'a Case)> {
    let place = next.fetch_add(1, Ordering::Relaxed);
    cases.get(place).map(|case| (place, case))
}

/// What became of one case.
enum Outcome {
    Passed {
        measured: String,
        seconds: f64,
        /// Hash of what happened on an emulated board.
        hash: Option<u64>,
    },
    Failed(String),
    NotRun(String),
}

fn run_one(rig: &Rig, case: &Case) -> Outcome {
    let missing: Vec<String> =
        case.needs.iter().filter(|&&need| !rig.can(need)).map(ToString::to_string).collect();
    if !missing.is_empty() {
        return Outcome::NotRun(missing.join(", "));
    }
    let start = Instant::now();
    let on_a_fresh_board = || -> Result<_, cases::Failure> {
        let board = rig.fresh()?;
        let measured = (case.run)(&board)?;
        let hash = |rig: &VirtualRig| rig.board.with(|machine| machine.chip(|chip| chip.trace.hash()));
        Ok((measured, if let Rig::Virtual(rig) = &board { Some(hash(rig)) } else { None }))
    };
    // A board of its own is all that a case can leave half done.
    let result = catch_unwind(AssertUnwindSafe(on_a_fresh_board));
    let seconds = start.elapsed().as_secs_f64();
    match result {
        Ok(Ok((measured, hash))) => Outcome::Passed { measured, seconds, hash },
        Ok(Err(error)) => Outcome::Failed(format!("{error} ({seconds:.1} s)")),
        Err(_) => Outcome::Failed(format!("it panicked ({seconds:.1} s)")),
    }
}
