//! Subscription: frames of a board as they come, and a stream that ends with whoever reads it.

mod polled;

pub use polled::{NotBegun, PolledStream};

use crate::{
    assemble::{Assembler, ScanFrame, Totals},
    error::{LinkError, LinkErrorKind},
    link::{Link, PARTS_TIMEOUT, REPLY_TIMEOUT},
};
use dermatome_shared::{
    device::HOST_INTERVAL_US,
    protocol::{PatchInfo, Selection},
};
use std::time::{Duration, Instant};

/// How often whoever waits is asked whether to go on while nothing comes.
const POLL: Duration = Duration::from_millis(100);
/// How long a dropped subscription waits for the board to say that it has stopped.
const DROP_TIMEOUT: Duration = Duration::from_millis(500);

/// Frames that may fail to come before a board is asked whether it still streams.
const TIMEOUT_FRAMES: f64 = 5.0;

/// Longest silence of a stream before its board is asked: five frames, and at least a second.
#[must_use]
pub fn frame_timeout(patch: &PatchInfo) -> Duration {
    let least = Duration::from_secs(1);
    let frames = Duration::try_from_secs_f64(TIMEOUT_FRAMES / f64::from(patch.drive.frame_rate));
    frames.unwrap_or(least).clamp(least, Duration::from_secs(3600))
}

/// Longest silence where a board must send something: five frames, and at least five seconds.
#[must_use]
pub fn silence_timeout(patch: &PatchInfo) -> Duration {
    frame_timeout(patch).max(Duration::from_secs(5))
}

/// A stream of frames. The board stops when this is dropped; [`Self::stop`] also says whether it did.
pub struct Subscription<'a> {
    link: &'a mut Link,
    first_sequence: u32,
    selection: Selection,
    assembler: Assembler,
    presence: Presence,
    is_stopped: bool,
}

impl Link {
    /// Streams what `selection` names, instead of what was streamed before. A refusal is an error. On a bus with other
    /// boards images come as often as it carries them: see [`Subscription::selection`].
    ///
    /// Read it: a board on a serial line stops after [`dermatome_shared::device::HOST_TIMEOUT_MS`] without a sign of its
    /// host, which [`Subscription::next`] gives.
    pub fn subscribe(&mut self, selection: Selection) -> Result<Subscription<'_>, LinkError> {
        let selection = self.fitting(selection)?;
        let first_sequence = self.begin_stream(selection)?;
        let assembler = Assembler::new(selection, first_sequence);
        Ok(Subscription {
            link: self,
            first_sequence,
            selection,
            assembler,
            presence: Presence::shown(),
            is_stopped: false,
        })
    }

    /// Has the board stream; gives the sequence number of the first frame.
    fn begin_stream(&mut self, selection: Selection) -> Result<u32, LinkError> {
        let begun = self.select(selection, REPLY_TIMEOUT, drop);
        if let Err(error) = &begun
            && !matches!(error.kind, LinkErrorKind::Refused(_))
        {
            // The reply may have been lost, and the board may stream. Where the link is cut, it stops by itself.
            let _ = self.select(Selection::default(), DROP_TIMEOUT, drop);
        }
        begun
    }
}

/// How long ago the board was shown that a host is there: by the board's clock, or the host's where no frame comes.
#[derive(Debug)]
struct Presence {
    /// Time of the first and of the last frame since.
    frames_us: Option<(u64, u64)>,
    /// When that last frame came.
    heard: Instant,
}

impl Presence {
    fn shown() -> Self {
        Self { frames_us: None, heard: Instant::now() }
    }

    fn see(&mut self, frame: &ScanFrame) {
        if let Some(at) = frame.at {
            let (first, _) = self.frames_us.unwrap_or((at.timestamp_us, at.timestamp_us));
            (self.frames_us, self.heard) = (Some((first, at.timestamp_us)), Instant::now());
        }
    }

    fn is_due(&self) -> bool {
        let by_board = self.frames_us.map_or(0, |(first, last)| last.saturating_sub(first));
        by_board >= HOST_INTERVAL_US || self.heard.elapsed() >= Duration::from_micros(HOST_INTERVAL_US)
    }
}

impl Subscription<'_> {
    /// Sequence number of the first frame of the stream.
    #[must_use]
    pub fn first_sequence(&self) -> u32 {
        self.first_sequence
    }

    /// What is streamed.
    #[must_use]
    pub fn selection(&self) -> Selection {
        self.selection
    }

    /// In words, where a bus with other boards does not carry all that was `wanted` of all frames.
    #[must_use]
    pub fn thinned_out(&self, wanted: Selection) -> Option<String> {
        let given = self.selection;
        let all = [
            ("images", wanted.images, given.images),
            ("raw frames", wanted.measurements, given.measurements),
            ("the scope", wanted.scope, given.scope),
        ];
        let how = |(what, wanted, given)| match given {
            _ if given == wanted => None,
            0 => Some(format!("no {what}")),
            every => Some(format!("{what} of one frame in {every}")),
        };
        let words: Vec<String> = all.into_iter().filter_map(how).collect();
        (!words.is_empty())
            .then(|| format!("{}: the bus that the board shares carries no more", words.join(", ")))
    }

    /// What has come so far.
    #[must_use]
    pub fn totals(&self) -> Totals {
        self.assembler.totals()
    }

    /// Streams what another selection names from now on, without an end in between.
    pub fn reselect(&mut self, selection: Selection) -> Result<(), LinkError> {
        let selection = self.link.fitting(selection)?;
        let assembler = &mut self.assembler;
        self.link.select(selection, REPLY_TIMEOUT, |(number, event)| assembler.take(number, event))?;
        self.assembler.reselect(selection);
        self.selection = selection;
        Ok(())
    }

    /// The link, for requests while the stream goes on. One that takes longer than
    /// [`dermatome_shared::device::HOST_TIMEOUT_MS`] ends it.
    pub fn link(&mut self) -> &mut Link {
        self.link
    }

    /// The next frame, or `None` if nothing comes for `timeout` (20 ms at least).
    pub fn next(&mut self, timeout: Duration) -> Result<Option<ScanFrame>, LinkError> {
        match self.next_while(timeout, || true) {
            Err(LinkError { kind: LinkErrorKind::NoAnswer { .. }, .. }) => Ok(None),
            next => next,
        }
    }

    /// The next frame, or `None` if `go_on`, asked while nothing comes, says no. Silence for `timeout` is the error
    /// [`LinkErrorKind::NoAnswer`]; events that make no frame, for as long and a second at least, are
    /// [`LinkErrorKind::NoFrame`].
    pub fn next_while(
        &mut self,
        timeout: Duration,
        go_on: impl Fn() -> bool,
    ) -> Result<Option<ScanFrame>, LinkError> {
        let begun = Instant::now();
        let (mut heard, mut events) = (begun, 0);
        loop {
            if let Some(frame) = self.assembler.pop() {
                self.presence.see(&frame);
                return Ok(Some(frame));
            }
            if self.presence.is_due() {
                self.presence = Presence::shown();
                self.link.show_presence()?;
            }
            let left = timeout.saturating_sub(heard.elapsed());
            if let Some((number, event)) = self.link.next_event(left.min(POLL))? {
                (heard, events) = (Instant::now(), events + 1);
                self.assembler.take(number, event);
                if !self.assembler.is_ready() && begun.elapsed() >= timeout.max(PARTS_TIMEOUT) {
                    return Err(self.link.error(LinkErrorKind::NoFrame { timeout, events }));
                }
            } else if self.link.silence() >= PARTS_TIMEOUT && self.assembler.is_arriving() {
                self.assembler.finish();
            } else if heard.elapsed() >= timeout {
                return Err(self.link.error(LinkErrorKind::NoAnswer { timeout }));
            } else if !go_on() {
                return Ok(None);
            }
        }
    }

    /// Ends the stream; gives what came of it, with frames that were under way and that nobody fetched.
    pub fn stop(mut self) -> Result<Totals, LinkError> {
        self.end(REPLY_TIMEOUT)?;
        self.assembler.finish();
        Ok(self.assembler.totals())
    }

    fn end(&mut self, timeout: Duration) -> Result<(), LinkError> {
        self.is_stopped = true;
        let assembler = &mut self.assembler;
        self.link.select(Selection::default(), timeout, |(number, event)| assembler.take(number, event))?;
        Ok(())
    }
}

impl Drop for Subscription<'_> {
    fn drop(&mut self) {
        if !self.is_stopped {
            // Where the link is cut, the board stops by itself.
            let _ = self.end(DROP_TIMEOUT);
        }
    }
}
