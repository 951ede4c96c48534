//! Polled: frames of a board for a control loop, which waits for nothing and allocates nothing.
//!
//! All memory is there once the stream has begun. From then on [`PolledStream::poll`] and [`PolledStream::ask`] take as
//! long as it takes to read, check and put together what has come, and allocate nothing, with two exceptions: raw codes
//! (`Selection::measurements`), and a serial port that has gone or takes nothing any more.

use super::{DROP_TIMEOUT, Presence};
use crate::{
    assemble::{Assembler, ScanFrame, Totals},
    error::{LinkError, LinkErrorKind},
    link::{Arrived, Link, PARTS_TIMEOUT, REPLY_TIMEOUT},
};
use dermatome_shared::protocol::{Reply, Request, Selection};
use std::time::{Duration, Instant};

/// Most packets that one poll takes; a longer backlog is taken by the next ones.
const MOST_PACKETS: usize = 64;

/// A stream of frames that is polled, and holds its link.
pub struct PolledStream {
    link: Link,
    selection: Selection,
    assembler: Assembler,
    presence: Presence,
    /// When the last frame came.
    heard: Instant,
    asked: Option<Asked>,
}

/// A request whose reply has not come, or that nobody has fetched.
struct Asked {
    sequence: u16,
    at: Instant,
    reply: Option<Reply>,
}

/// A stream that did not begin.
pub struct NotBegun {
    /// The link, as it was.
    pub link: Box<Link>,
    /// Why not.
    pub error: LinkError,
}

impl PolledStream {
    /// Has the board stream what `selection` names, instead of what was streamed before; waits for its answer.
    pub fn begin(mut link: Link, selection: Selection) -> Result<Self, NotBegun> {
        let begun = link.fitting(selection).and_then(|selection| {
            let first = link.begin_stream(selection)?;
            let polled = link.set_waiting(false);
            if polled.is_err() {
                // Where the link is cut, the board stops by itself.
                let _ = link.select(Selection::default(), DROP_TIMEOUT, drop);
            }
            polled.map(|()| (first, selection))
        });
        match begun {
            Ok((first, selection)) => Ok(Self {
                link,
                selection,
                assembler: Assembler::new(selection, first),
                presence: Presence::shown(),
                heard: Instant::now(),
                asked: None,
            }),
            Err(error) => Err(NotBegun { link: Box::new(link), error }),
        }
    }

    /// The next frame that is there, or `None`: poll again once the [descriptor](Self::descriptor) is readable, or in the next
    /// turn of the loop. Poll until `None`, as one read takes more than one frame.
    pub fn poll(&mut self) -> Result<Option<ScanFrame>, LinkError> {
        self.show_presence()?;
        for _ in 0..MOST_PACKETS {
            if let Some(frame) = self.assembler.pop() {
                self.presence.see(&frame);
                self.heard = Instant::now();
                return Ok(Some(frame));
            }
            match self.link.arrived()? {
                Arrived::Event(number, event) => self.assembler.take(number, event),
                Arrived::Reply(sequence, reply) => self.answered(sequence, reply),
                Arrived::Nothing if self.link.silence() < PARTS_TIMEOUT => return Ok(None),
                Arrived::Nothing if !self.assembler.is_arriving() => return Ok(None),
                Arrived::Nothing => self.assembler.finish(),
            }
        }
        Ok(None)
    }

    /// Asks the board, whose reply [`Self::poll`] takes. False, and nothing is asked, as long as an earlier request waits for
    /// the line, for its reply, or for that to be [fetched](Self::answer).
    pub fn ask(&mut self, request: &Request) -> Result<bool, LinkError> {
        if self.asked.is_some() || !self.link.flush()? {
            return Ok(false);
        }
        let sequence = self.link.begin_to_ask(request)?;
        self.asked = Some(Asked { sequence, at: Instant::now(), reply: None });
        Ok(true)
    }

    /// The reply to what was asked, once; `None` until it has come, and where nothing was asked. A refusal is an error, and so
    /// is none within [`REPLY_TIMEOUT`].
    pub fn answer(&mut self) -> Option<Result<Reply, LinkError>> {
        let asked = self.asked.as_mut()?;
        let reply = asked.reply.take();
        if reply.is_none() && asked.at.elapsed() < REPLY_TIMEOUT {
            return None;
        }
        self.asked = None;
        Some(match reply {
            Some(reply) => self.link.unless_refused(reply),
            None => Err(self.link.error(LinkErrorKind::NoAnswer { timeout: REPLY_TIMEOUT })),
        })
    }

    /// Whether something was asked whose reply nobody has fetched.
    #[must_use]
    pub fn is_asking(&self) -> bool {
        self.asked.is_some()
    }

    /// What is streamed: on a bus with other boards, images as often as it carries them.
    #[must_use]
    pub fn selection(&self) -> Selection {
        self.selection
    }

    /// How long no frame has come.
    #[must_use]
    pub fn silence(&self) -> Duration {
        self.heard.elapsed()
    }

    /// What has come so far.
    #[must_use]
    pub fn totals(&self) -> Totals {
        self.assembler.totals()
    }

    /// The link, for what it counts.
    #[must_use]
    pub fn link(&self) -> &Link {
        &self.link
    }

    /// What poll(2) says is readable when something has come; none for a transport that has no such thing.
    #[cfg(unix)]
    #[must_use]
    pub fn descriptor(&self) -> Option<std::os::fd::RawFd> {
        self.link.descriptor()
    }

    /// Ends the stream, which is waited for; gives the link, and what came of the stream.
    pub fn stop(mut self) -> (Link, Result<Totals, LinkError>) {
        let stopped = self.end();
        (self.link, stopped)
    }

    fn end(&mut self) -> Result<Totals, LinkError> {
        self.link.set_waiting(true)?;
        let assembler = &mut self.assembler;
        self.link
            .select(Selection::default(), REPLY_TIMEOUT, |(number, event)| assembler.take(number, event))?;
        self.assembler.finish();
        Ok(self.assembler.totals())
    }

    fn show_presence(&mut self) -> Result<(), LinkError> {
        if self.link.flush()? && self.presence.is_due() {
            self.presence = Presence::shown();
            self.link.begin_to_ask(&Request::Info)?;
        }
        Ok(())
    }

    fn answered(&mut self, sequence: u16, reply: Reply) {
        let asked = self.asked.as_mut().filter(|asked| asked.sequence == sequence);
        if let Some(asked) = asked {
            asked.reply = Some(reply);
        }
    }
}
