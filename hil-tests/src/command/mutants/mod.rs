//! `mutants`: builds the firmware with each fault of the table in it, and says which cases notice.

mod trial;
mod workshop;

use dermatome_hil::{
    cases::{self, Case},
    mutants::{self, Mutant},
};
use std::{error::Error, path::PathBuf, process::ExitCode, time::Instant};
use trial::Verdict;
use workshop::Workshop;

/// Cases that a mutant has to name, or `--all` to ask for: they take minutes, or wait by the host's clock, so that
/// a busy machine fails them.
const LEFT_OUT: [&str; 5] =
    ["a million bytes", "power is cut at", "a thousand images", "held for ten minutes", "on a full line"];

/// Options of `mutants`.
#[derive(clap::Args)]
pub(super) struct Mutants {
    /// Rig file of an emulated board.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/rigs/virtual.toml"))]
    rig: PathBuf,
    /// Prints the table, and runs nothing.
    #[arg(long)]
    list: bool,
    /// Where the cases that a mutant names do not notice it, tries those that take minutes, or fail on a busy machine,
    /// as well.
    #[arg(long)]
    all: bool,
    /// Only mutants whose name contains one of these.
    names: Vec<String>,
}

/// What became of one mutant.
enum Outcome {
    Caught(String),
    Survived,
    DoesNotBuild(String),
}

/// What became of all of them.
#[derive(Default)]
struct Count {
    caught: usize,
    explained: usize,
    unexplained: usize,
    unbuilt: usize,
}

impl Mutants {
    pub(super) fn run(self) -> Result<ExitCode, Box<dyn Error>> {
        let (chosen, cases) = (self.chosen()?, cases::all());
        chosen.iter().try_for_each(|mutant| mutant.check_cases(&cases))?;
        if self.list {
            chosen.iter().for_each(list);
            return Ok(ExitCode::SUCCESS);
        }
        let workshop = Workshop::open()?;
        self.try_unchanged(&workshop, &chosen, &cases)?;
        let mut count = Count::default();
        for mutant in &chosen {
            let start = Instant::now();
            let outcome = self.try_out(&workshop, mutant, &cases)?;
            count.show(mutant, &outcome, start);
        }
        say!("{count}");
        Ok(if count.unexplained == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    fn chosen(&self) -> Result<Vec<Mutant>, Box<dyn Error>> {
        let wanted = |mutant: &Mutant| {
            self.names.is_empty() || self.names.iter().any(|name| mutant.name.contains(name))
        };
        let chosen: Vec<Mutant> = mutants::all()?.into_iter().filter(wanted).collect();
        if chosen.is_empty() {
            return Err(format!("no mutant is called like that: {}", self.names.join(", ")).into());
        }
        Ok(chosen)
    }

    /// A case that fails without any mutant would notice them all.
    fn try_unchanged(
        &self,
        workshop: &Workshop,
        mutants: &[Mutant],
        cases: &[Case],
    ) -> Result<(), Box<dyn Error>> {
        workshop.build()?.map_err(|error| format!("the firmware does not build without mutants: {error}"))?;
        let named: Vec<Case> =
            cases.iter().filter(|case| mutants.iter().any(|mutant| mutant.expects(case))).copied().collect();
        match trial::run(&self.rig, &workshop.elf(), &named)? {
            Verdict::Passed => Ok(()),
            Verdict::Failed(failure) => Err(format!("a case fails without any mutant: {failure}").into()),
        }
    }

    fn try_out(
        &self,
        workshop: &Workshop,
        mutant: &Mutant,
        cases: &[Case],
    ) -> Result<Outcome, Box<dyn Error>> {
        if let Err(error) = workshop.build_with(mutant)? {
            return Ok(Outcome::DoesNotBuild(error));
        }
        let is_left_out = |case: &Case| !self.all && LEFT_OUT.iter().any(|words| case.name.contains(words));
        let (expected, others): (Vec<Case>, Vec<Case>) =
            cases.iter().copied().partition(|case| mutant.expects(case));
        let others: Vec<Case> = others.into_iter().filter(|case| !is_left_out(case)).collect();
        for cases in [expected, others] {
            if let Verdict::Failed(failure) = trial::run(&self.rig, &workshop.elf(), &cases)? {
                return Ok(Outcome::Caught(failure));
            }
        }
        Ok(Outcome::Survived)
    }
}

fn list(mutant: &Mutant) {
    say!("{}: {} ({})", mutant.name, mutant.why, mutant.file.display());
    if let Some(reason) = &mutant.survives {
        say!("    survives: {reason}");
    }
}

impl Count {
    fn show(&mut self, mutant: &Mutant, outcome: &Outcome, start: Instant) {
        let (what, more) = match (outcome, &mutant.survives) {
            (Outcome::Caught(failure), _) => ("caught", failure.as_str()),
            (Outcome::Survived, Some(reason)) => ("survived", reason.as_str()),
            (Outcome::Survived, None) => ("SURVIVED", mutant.why.as_str()),
            (Outcome::DoesNotBuild(error), _) => ("no build", error.as_str()),
        };
        let place = match what {
            "caught" => &mut self.caught,
            "survived" => &mut self.explained,
            "SURVIVED" => &mut self.unexplained,
            _ => &mut self.unbuilt,
        };
        *place += 1;
        say!("{what:8} {}: {more} ({:.0} s)", mutant.name, start.elapsed().as_secs_f64());
    }
}

impl std::fmt::Display for Count {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { caught, explained, unexplained, unbuilt } = self;
        let all = caught + explained + unexplained;
        let share = 100.0 * *caught as f64 / all.max(1) as f64;
        write!(
            formatter,
            "{caught} of {all} caught ({share:.1} %), {explained} survived and explained, {unexplained} not, \
             {unbuilt} do not build and do not count"
        )
    }
}
