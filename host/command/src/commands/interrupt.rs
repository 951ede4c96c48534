//! Ctrl-C in commands that run on: the first one asks them to stop cleanly, the second ends the process
//! at once. Other commands end at the first: files are written whole or not at all, and a board
//! that is being flashed keeps the patch it had.

use anyhow::Context;
use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

/// Signals within this time count as one.
const ONE_REQUEST: Duration = Duration::from_millis(500);
/// How often a sleeper looks whether it should stop.
const POLL: Duration = Duration::from_millis(20);

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Starts to watch for Ctrl-C and the termination signal.
pub(crate) fn install() -> anyhow::Result<()> {
    let mut first: Option<Instant> = None;
    ctrlc::set_handler(move || {
        REQUESTED.store(true, Ordering::Relaxed);
        // Some programs that stop others send the signal twice at once; that is one request.
        if first.get_or_insert_with(Instant::now).elapsed() > ONE_REQUEST {
            std::process::exit(130);
        }
    })
    .context("cannot watch for Ctrl-C")
}

/// Whether the user has asked to stop. Long loops look at this once per step.
#[must_use]
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// Sleeps for `duration`; false if the user asks to stop meanwhile.
pub(crate) fn sleep(duration: Duration) -> bool {
    let end = Instant::now() + duration;
    while !requested() {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return true;
        }
        std::thread::sleep(left.min(POLL));
    }
    false
}
