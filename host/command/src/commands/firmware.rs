//! `dermatome firmware`.

use dermatome_link::program::firmware::Firmware;
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
    let firmware = Firmware::load(&args.elf)?;
    program(args, &firmware)
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
        Args,
    };
    use dermatome_link::program::{
        firmware::Firmware,
        log::Log,
        probe::{
            DebugProbe,
            attached::{self, Board, ProbeError, Progress},
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
        let log = args.logs.then(|| Log::new(firmware)).transpose().map_err(ProbeError::NoLog)?;
        let probes = attached::probes();
        let probe = choose(&probes, args.probe.as_deref())?;
        let mut board = Board::attach(probe)?;
        let started = Instant::now();
        write(&mut board, firmware)?;
        board.reset(log.as_ref())?;
        report(args, firmware, probe, started.elapsed())?;
        log.map_or(Ok(()), |log| follow(&mut board, &log))
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
        Ok(board.follow(log, interrupt::requested, |line| say!("{line}"))?)
    }
}
