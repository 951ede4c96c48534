//! Queue: frames on their way from the desk's thread to Python.

use crate::{error::raised, waiting::POLL};
use dermatome_link::{LinkError, ScanFrame};
use pyo3::prelude::*;
use std::{
    collections::VecDeque,
    mem,
    sync::{
        Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::SystemTime,
};

/// Most frames that wait for Python: five seconds of a fast board.
const MOST_WAITING: usize = 2048;

/// What becomes of frames that nobody fetches.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum WhenFull {
    /// The oldest are dropped: a board goes on.
    DropOldest,
    /// The board waits: a simulated one that goes as fast as it can.
    Wait,
}

/// Frames on their way to Python.
pub(crate) struct Queue {
    state: Mutex<State>,
    changed: Condvar,
    /// Nobody fetches any more.
    is_left: AtomicBool,
    when_full: WhenFull,
}

#[derive(Default)]
struct State {
    frames: VecDeque<(ScanFrame, SystemTime)>,
    /// Frames that did not come, as the board's numbers tell.
    lost: u64,
    /// Frames that came and were dropped here.
    dropped: u64,
    /// In words, where less comes than was asked for, until somebody has been told.
    warning: Option<String>,
    /// How it ended, once it has.
    ended: Option<Result<(), LinkError>>,
}

impl Queue {
    pub(super) fn new(when_full: WhenFull) -> Self {
        Self { state: Mutex::default(), changed: Condvar::new(), is_left: AtomicBool::new(false), when_full }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn put(&self, frame: ScanFrame, lost: u64) {
        let mut state = self.state();
        while state.frames.len() >= MOST_WAITING && !self.is_left() {
            if self.when_full == WhenFull::DropOldest {
                state.frames.pop_front();
                state.dropped += 1;
            } else {
                state = self.wait(state);
            }
        }
        state.frames.push_back((frame, SystemTime::now()));
        state.lost = lost;
        self.changed.notify_all();
    }

    /// Less comes than was asked for, in words.
    pub(super) fn warn(&self, words: String) {
        self.state().warning = Some(words);
    }

    /// The same, once.
    pub(crate) fn take_warning(&self) -> Option<String> {
        self.state().warning.take()
    }

    pub(super) fn end(&self, ended: Result<(), LinkError>) {
        self.state().ended = Some(ended);
        self.changed.notify_all();
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        self.changed.wait_timeout(state, POLL).unwrap_or_else(PoisonError::into_inner).0
    }

    /// The next frame and when it came; none at the stream's end. Ctrl-C ends the wait.
    pub(crate) fn take(&self, py: Python<'_>) -> PyResult<Option<(ScanFrame, SystemTime)>> {
        loop {
            let taken = py.detach(|| {
                let mut state = self.state();
                if state.frames.is_empty() && state.ended.is_none() {
                    state = self.wait(state);
                }
                let frame = state.frames.pop_front();
                self.changed.notify_all();
                match frame {
                    Some(frame) => Some(Ok(Some(frame))),
                    // An error is raised once.
                    None => state.ended.as_mut().map(|ended| mem::replace(ended, Ok(())).map(|()| None)),
                }
            });
            match taken {
                Some(taken) => return taken.map_err(raised),
                None => py.check_signals()?,
            }
        }
    }

    /// Nobody fetches any more: the board is to stop.
    pub(crate) fn leave(&self) {
        self.is_left.store(true, Ordering::Relaxed);
        self.changed.notify_all();
    }

    pub(super) fn is_left(&self) -> bool {
        self.is_left.load(Ordering::Relaxed)
    }

    /// Frames that did not come, and frames that were dropped here.
    pub(crate) fn losses(&self) -> [u64; 2] {
        let state = self.state();
        [state.lost, state.dropped]
    }
}
