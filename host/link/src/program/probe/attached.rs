//! A board at a debug probe, through the library probe-rs: identify, program, verify, reset, read its log.

use super::{ChipError, ChipIdentity, DebugProbe};
use crate::{
    program::{
        firmware::Firmware,
        log::{DamagedLog, Log},
    },
    words::escaped,
};
use probe_rs::{
    Core, MemoryInterface, Permissions, Session,
    flashing::{DownloadOptions, FlashProgress, ProgressEvent, ProgressOperation},
    probe::{
        DebugProbeInfo,
        list::{Accessibility, Lister},
    },
    rtt::{self, Rtt, ScanRegion},
};
use std::{
    thread,
    time::{Duration, Instant},
};

/// The board's chip, as probe-rs calls it.
const CHIP: &str = "STM32G474RETx";

/// `DBGMCU_IDCODE`, `FLASH_SIZE` and `FLASH_OPTR` (RM0440).
const IDCODE: u64 = 0xE004_2000;
const FLASH_SIZE: u64 = 0x1FFF_75E0;
const FLASH_OPTR: u64 = 0x4002_2020;

/// How long a firmware may take from its reset until it announces its log.
const LOG_APPEARS: Duration = Duration::from_secs(3);

/// Time between two looks at an empty log.
const LOG_PAUSE: Duration = Duration::from_millis(10);

/// A board attached to a probe.
pub struct Board {
    session: Session,
}

/// How far programming is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// So many bytes more to erase, program or verify.
    Ahead(u64),
    /// Now doing this.
    Doing(&'static str),
    /// So many bytes more are done.
    Done(u64),
}

/// What probe-rs says. Its own errors are large.
type Cause = Box<dyn std::error::Error + Send + Sync>;

/// Why a board could not be programmed, or its log not read.
#[derive(Debug, thiserror::Error)]
pub enum ProbeError {
    /// The probe was there a moment ago.
    #[error("debug probe {probe} has gone; nothing was erased")]
    Gone {
        /// Which one.
        probe: DebugProbe,
    },
    /// The probe does not open.
    #[error("cannot open debug probe {probe}: is another program using it? Nothing was erased")]
    Open {
        /// Which one.
        probe: DebugProbe,
        /// What probe-rs says.
        source: Cause,
    },
    /// No chip, or none of this kind, answers.
    #[error(
        "no {CHIP} answers at debug probe {probe}: is the board powered, is it a NUCLEO-G474RE? Nothing was \
         erased"
    )]
    Attach {
        /// Which one.
        probe: DebugProbe,
        /// What probe-rs says.
        source: Cause,
    },
    /// The chip does not say what it is.
    #[error("the chip at the probe cannot be identified: is it a {CHIP}? Nothing was erased")]
    Identify(#[source] Cause),
    /// The firmware cannot run on the chip.
    #[error(transparent)]
    Chip(#[from] ChipError),
    /// probe-rs knows other memory, or the ELF's segments overlap.
    #[error("the firmware does not fit the chip's memory. Nothing was erased")]
    Layout(#[source] Cause),
    /// Erasing, programming or verifying failed.
    #[error("the board was not programmed: it may hold part of the firmware; run the command again")]
    Program(#[source] Cause),
    /// The firmware is on the board, but does not run.
    #[error("the firmware is programmed and verified, but the board did not restart: press its reset button")]
    Reset(#[source] Cause),
    /// The log did not come, or stopped coming.
    #[error("the board's log cannot be read")]
    Log(#[source] Cause),
    /// The log is not this firmware's.
    #[error(transparent)]
    DamagedLog(#[from] DamagedLog),
}

/// The debug probes of this machine.
#[must_use]
pub fn probes() -> Vec<DebugProbe> {
    found().into_iter().map(|(probe, _)| probe).collect()
}

fn found() -> Vec<(DebugProbe, DebugProbeInfo)> {
    let items = Lister::new().list_all_with_access().into_iter();
    let known = items.map(|item| {
        let probe = DebugProbe {
            name: escaped(&item.info.identifier),
            vendor_id: item.info.vendor_id,
            product_id: item.info.product_id,
            serial_number: item.info.serial_number.clone().filter(|serial| !serial.is_empty()),
            accessible: item.accessibility == Accessibility::Accessible,
        };
        (probe, item.info)
    });
    known.collect()
}

impl Board {
    /// Attaches to the board's chip through `probe` and checks that it is one. Changes nothing in its flash.
    pub fn attach(probe: &DebugProbe) -> Result<Self, ProbeError> {
        let at = || probe.clone();
        let same = found().into_iter().find(|(candidate, _)| candidate == probe);
        let (_, info) = same.ok_or_else(|| ProbeError::Gone { probe: at() })?;
        let open = info.open().map_err(|source| ProbeError::Open { probe: at(), source: source.into() })?;
        let attached = open.attach(CHIP, Permissions::new());
        let session = attached.map_err(|source| ProbeError::Attach { probe: at(), source: source.into() })?;
        let mut board = Self { session };
        board.identity().map_err(|error| ProbeError::Identify(error.into()))?.check()?;
        Ok(board)
    }

    fn identity(&mut self) -> Result<ChipIdentity, probe_rs::Error> {
        let mut core = self.session.core(0)?;
        Ok(ChipIdentity {
            idcode: core.read_word_32(IDCODE)?,
            flash_kib: core.read_word_16(FLASH_SIZE)?,
            options: core.read_word_32(FLASH_OPTR)?,
        })
    }

    /// Erases the pages of the firmware, programs them, and reads them back to compare.
    pub fn program(
        &mut self,
        firmware: &Firmware,
        mut progress: impl FnMut(Progress),
    ) -> Result<(), ProbeError> {
        let mut loader = self.session.target().flash_loader();
        for segment in firmware.segments() {
            loader
                .add_data(segment.address, &segment.bytes)
                .map_err(|error| ProbeError::Layout(error.into()))?;
        }
        let mut options = DownloadOptions::new();
        options.verify = true;
        options.progress = FlashProgress::new(move |event| {
            if let Some(event) = in_our_words(&event) {
                progress(event);
            }
        });
        loader.commit(&mut self.session, options).map_err(|error| ProbeError::Program(error.into()))
    }

    /// Lets the chip start anew. With `log`, the one of an earlier start is forgotten.
    pub fn reset(&mut self, log: Option<&Log>) -> Result<(), ProbeError> {
        let mut core = self.session.core(0).map_err(|error| ProbeError::Reset(error.into()))?;
        if let Some(log) = log {
            Rtt::clear_control_block(&mut core, &ScanRegion::Exact(log.control_block()))
                .map_err(|error| ProbeError::Log(error.into()))?;
        }
        core.reset().map_err(|error| ProbeError::Reset(error.into()))
    }

    /// Hands the lines of the log to `line` until `stop` says so, also after the board has restarted.
    pub fn follow(
        &mut self,
        log: &Log,
        stop: impl Fn() -> bool,
        mut line: impl FnMut(&str),
    ) -> Result<(), ProbeError> {
        let mut core = self.session.core(0).map_err(|error| ProbeError::Log(error.into()))?;
        let Some(mut channels) = find(log, &mut core, &stop)? else { return Ok(()) };
        let mut decoder = log.decoder(true);
        let mut bytes = [0; 1024];
        while !stop() {
            match read(&mut channels, &mut core, &mut bytes) {
                Ok(0) => thread::sleep(LOG_PAUSE),
                Ok(count) => decoder.push(&bytes[..count], &mut line)?,
                Err(error) if means_restart(&error) => {
                    line("(the board has restarted)");
                    let Some(anew) = find(log, &mut core, &stop)? else { return Ok(()) };
                    (channels, decoder) = (anew, log.decoder(true));
                }
                Err(error) => return Err(ProbeError::Log(error.into())),
            }
        }
        Ok(())
    }
}

/// Waits until the firmware announces its log; `None` if it is to stop.
fn find(log: &Log, core: &mut Core<'_>, stop: impl Fn() -> bool) -> Result<Option<Rtt>, ProbeError> {
    let started = Instant::now();
    while !stop() {
        match Rtt::attach_at(core, log.control_block()) {
            Ok(rtt) if !rtt.up_channels.is_empty() => return Ok(Some(rtt)),
            Err(error) if started.elapsed() > LOG_APPEARS => return Err(ProbeError::Log(error.into())),
            Ok(_) if started.elapsed() > LOG_APPEARS => {
                return Err(ProbeError::Log(rtt::Error::ControlBlockNotFound.into()));
            }
            _ => thread::sleep(LOG_PAUSE),
        }
    }
    Ok(None)
}

fn read(channels: &mut Rtt, core: &mut Core<'_>, bytes: &mut [u8]) -> Result<usize, rtt::Error> {
    // defmt-rtt has one channel.
    let channel = channels.up_channel(0).ok_or(rtt::Error::MissingChannel(0))?;
    channel.read(core, bytes)
}

/// A starting firmware writes the log's control block anew, under our eyes.
fn means_restart(error: &rtt::Error) -> bool {
    matches!(error, rtt::Error::ReadPointerChanged | rtt::Error::ControlBlockCorrupted(_))
}

fn in_our_words(event: &ProgressEvent) -> Option<Progress> {
    match event {
        ProgressEvent::AddProgressBar { total, .. } => total.map(Progress::Ahead),
        ProgressEvent::Started(operation) => Some(Progress::Doing(name(*operation))),
        ProgressEvent::Progress { size, .. } => Some(Progress::Done(*size)),
        _ => None,
    }
}

fn name(operation: ProgressOperation) -> &'static str {
    match operation {
        ProgressOperation::Fill => "reading",
        ProgressOperation::Erase => "erasing",
        ProgressOperation::Program => "programming",
        ProgressOperation::Verify => "verifying",
    }
}
