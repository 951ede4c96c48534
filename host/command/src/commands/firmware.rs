//! `dermatome firmware`.

use dermatome_link::program::firmware::{Firmware, FirmwareError};
#[cfg(any(test, feature = "probe"))]
use dermatome_link::program::probe::{ChoiceError, table};
use std::path::PathBuf;

/// Where `firmware/build` leaves the firmware, seen from a checkout.
const BUILT: &str = "firmware/target/thumbv7em-none-eabihf/release/dermatome-firmware";

/// Program the firmware of a board through its debug probe, and verify it.
///
/// ELF and chip are checked before anything is erased. Patches stay, and the board restarts.
/// It has not been tried on a real board yet.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome firmware\n  \
    dermatome firmware --probe 004200123456 --logs\n  \
    dermatome firmware --elf dermatome-firmware --json firmware.json\n\n\
    Needs a program built with `--features probe`; without, it only checks the ELF.")]
pub(super) struct Args {
    /// Firmware to program, an ELF file as `firmware/build` makes it.
    #[arg(long, value_name = "FILE", default_value = BUILT)]
    elf: PathBuf,
    /// Debug probe to use, if there are several: its ID, as `dermatome devices` shows it.
    #[arg(long, value_name = "ID")]
    probe: Option<String>,
    /// Then print the firmware's log, until Ctrl-C.
    #[arg(long)]
    logs: bool,
    #[command(flatten)]
    json: super::JsonReport,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let firmware = Firmware::load(&args.elf).map_err(|error| match error {
        FirmwareError::Read { .. } => anyhow::anyhow!("{error}, `--elf FILE` names another"),
        error => error.into(),
    })?;
    program(args, &firmware)
}

/// Why no probe was chosen, with the option that chooses one.
#[cfg(any(test, feature = "probe"))]
fn unchosen(error: ChoiceError) -> anyhow::Error {
    match error {
        ChoiceError::Several { probes } => anyhow::anyhow!(
            "{} debug probes fit: choose one with `--probe ID`; there are\n{}",
            probes.len(),
            table(&probes)
        ),
        error => error.into(),
    }
}

#[cfg(not(feature = "probe"))]
fn program(args: &Args, firmware: &Firmware) -> anyhow::Result<()> {
    anyhow::bail!(
        "`{}` is sound ({} bytes to program), but this `dermatome` was built without debug probes; in a \
         checkout, run `cargo run --release --features probe -- firmware`, or install it with `cargo install \
         --path host --features probe`",
        args.elf.display(),
        firmware.size()
    )
}

#[cfg(feature = "probe")]
use with_probe::program;

#[cfg(feature = "probe")]
mod with_probe {
    use super::{
        super::{interrupt, progress},
        Args, unchosen,
    };
    use dermatome_link::program::{
        firmware::Firmware,
        log::{Log, NoLog},
        probe::{
            DebugProbe,
            attached::{self, Board, Progress},
            choose,
        },
    };
    use serde::Serialize;
    use std::time::{Duration, Instant};

    #[derive(Serialize)]
    struct Report<'a> {
        elf: String,
        probe: &'a DebugProbe,
        bytes: usize,
        duration_s: f64,
    }

    pub(super) fn program(args: &Args, firmware: &Firmware) -> anyhow::Result<()> {
        let log = args.logs.then(|| Log::new(firmware)).transpose().map_err(no_log)?;
        let probes = attached::probes();
        let probe = choose(&probes, args.probe.as_deref()).map_err(unchosen)?;
        let mut board = Board::attach(probe)?;
        let started = Instant::now();
        write(&mut board, firmware)?;
        board.reset(log.as_ref())?;
        report(args, firmware, probe, started.elapsed())?;
        log.map_or(Ok(()), |log| follow(&mut board, &log))
    }

    fn no_log(error: NoLog) -> anyhow::Error {
        anyhow::anyhow!("{error}: leave `--logs` away. Nothing was erased")
    }

    fn write(board: &mut Board, firmware: &Firmware) -> anyhow::Result<()> {
        let bar = progress::counting();
        let result = board.program(firmware, |progress| match progress {
            Progress::Ahead(bytes) => bar.inc_length(bytes),
            Progress::Doing(what) => bar.set_message(what),
            Progress::Done(bytes) => bar.inc(bytes),
        });
        bar.finish_and_clear();
        Ok(result?)
    }

    fn report(args: &Args, firmware: &Firmware, probe: &DebugProbe, took: Duration) -> anyhow::Result<()> {
        let (elf, bytes) = (args.elf.display().to_string(), firmware.size());
        say!("`{elf}` ({bytes} bytes) is programmed and verified through {probe}; the board has restarted");
        args.json.write(&Report { elf, probe, bytes, duration_s: took.as_secs_f64() })
    }

    fn follow(board: &mut Board, log: &Log) -> anyhow::Result<()> {
        interrupt::install()?;
        Ok(board.follow(log, interrupt::requested, super::super::print_line)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_link::program::probe::{DebugProbe, choose};

    #[test]
    fn of_several_probes_one_must_be_chosen_by_its_option() {
        let probe = |serial: &str| DebugProbe {
            name: "STLink V3".to_owned(),
            vendor_id: 0x0483,
            product_id: 0x374E,
            serial_number: Some(serial.to_owned()),
            accessible: true,
        };
        let probes = [probe("0042"), probe("00AB")];
        assert_eq!(
            unchosen(choose(&probes, None).unwrap_err()).to_string(),
            "2 debug probes fit: choose one with `--probe ID`; there are\n  0042  STLink V3\n  00AB  STLink V3"
        );
        assert!(unchosen(choose(&[], None).unwrap_err()).to_string().contains("connect the board's ST-LINK"));
    }
}
