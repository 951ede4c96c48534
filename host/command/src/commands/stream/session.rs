//! Session: one stream over as many links as it takes.
//!
//! A board that restarts, or whose cable is pulled, comes back on a new link. It must hold the same patch. What the
//! stream needs is restored: the drive that was in effect, a reference if the board has none, and the stream itself.

use crate::commands::{
    BoardReport,
    board::open,
    current::Current,
    interrupt,
    tare::{patch_of, tare_with_spinner},
};
use anyhow::{Context, bail};
use dermatome_link::{Link, LinkError, Untouched, silence_timeout};
use dermatome_shared::{
    protocol::{Identity, PatchInfo, Request},
    reference::DEFAULT_TARE_FRAMES,
};
use dermatome_simulate::port::{self, OpenError, Port};
use std::{
    sync::mpsc::{RecvTimeoutError, channel},
    thread,
    time::{Duration, Instant},
};

/// Time until a port is opened again, which doubles up to the longest.
const FIRST_PAUSE: Duration = Duration::from_millis(100);
const LONGEST_PAUSE: Duration = Duration::from_millis(500);
/// How often whoever waits looks for Ctrl-C.
const POLL: Duration = Duration::from_millis(20);

/// How often a skin that is pressed is looked at again.
const LOOK_AGAIN: Duration = Duration::from_millis(300);

/// A board, its link, and what was lost with links before.
pub(in crate::commands) struct Session<'a> {
    port: &'a Port,
    /// None while the board is lost.
    pub(in crate::commands) link: Option<Link>,
    identity: Identity,
    /// With the drive that was in effect when the session began.
    pub(in crate::commands) patch: PatchInfo,
    /// The skin by its reference when the session began.
    untouched: Option<Untouched>,
    events_lost: u64,
    packets_damaged: u64,
}

/// What a board needed when it was back.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Restored {
    pub(super) drive: bool,
    pub(super) tared: bool,
}

impl<'a> Session<'a> {
    /// Opens the port for the first time.
    pub(in crate::commands) fn open(port: &'a Port) -> anyhow::Result<Self> {
        let mut link = open(port)?;
        let patch = patch_of(&mut link)?;
        let identity = link.identity().clone();
        let (events_lost, packets_damaged) = (0, 0);
        Ok(Self { port, link: Some(link), identity, patch, untouched: None, events_lost, packets_damaged })
    }

    /// The link, unless the board is lost.
    pub(in crate::commands) fn link(&mut self) -> anyhow::Result<&mut Link> {
        self.link.as_mut().context("the board is lost")
    }

    /// Whether the board may come back: a simulated one lives as long as its link.
    pub(in crate::commands) fn may_come_back(&self) -> bool {
        matches!(self.port, Port::Board(_))
    }

    pub(super) fn events_lost(&self) -> u64 {
        self.events_lost + self.link.as_ref().map_or(0, Link::events_lost)
    }

    pub(in crate::commands) fn packets_damaged(&self) -> u64 {
        self.packets_damaged + self.link.as_ref().map_or(0, Link::packets_damaged)
    }

    /// Which board it is.
    pub(super) fn report<'b>(&'b self, port: &'b str) -> BoardReport<'b> {
        BoardReport::of(port, &self.identity, &self.patch)
    }

    /// Closes the link, so that it can be opened anew.
    fn close(&mut self) {
        (self.events_lost, self.packets_damaged) = (self.events_lost(), self.packets_damaged());
        self.link = None;
    }

    /// Tries until the board is back and ready to stream, or until `give_up`; `None` if Ctrl-C ends it.
    pub(super) fn come_back(&mut self, give_up: Option<Instant>) -> anyhow::Result<Option<Restored>> {
        let mut pause = FIRST_PAUSE;
        loop {
            self.close();
            let error = match self.try_once(give_up) {
                Ok(restored) => return Ok(restored),
                Err(error) => error,
            };
            if !may_pass(&error) || give_up.is_some_and(|time| Instant::now() + pause >= time) {
                return Err(error);
            }
            if !interrupt::sleep(pause) {
                return Ok(None);
            }
            pause = (2 * pause).min(LONGEST_PAUSE);
        }
    }

    fn try_once(&mut self, give_up: Option<Instant>) -> anyhow::Result<Option<Restored>> {
        let Some(link) = open_interruptibly(self.port) else { return Ok(None) };
        self.link = Some(link?);
        self.prepare(give_up)
    }

    /// Makes a board ready to stream as before, and says what it needs; `None` if Ctrl-C ends it.
    pub(super) fn prepare(&mut self, give_up: Option<Instant>) -> anyhow::Result<Option<Restored>> {
        let drive = self.restore_drive()?;
        let tared = self.needs_tare()?;
        if tared {
            if !self.wait_untouched(give_up)? {
                return Ok(None);
            }
            self.tare()?;
        }
        Ok(Some(Restored { drive, tared }))
    }

    fn restore_drive(&mut self) -> anyhow::Result<bool> {
        let (drive, crc) = (self.patch.drive, self.patch.crc);
        let link = self.link()?;
        let found = patch_of(link)?;
        if found.crc != crc {
            bail!("the board holds another patch than before, `{}`: start anew", found.skin)
        }
        if found.drive == drive {
            return Ok(false);
        }
        eprintln!("the board's drive is not what it was: setting it again");
        link.request(&Request::Drive(Some(drive)))?;
        Ok(true)
    }

    /// Without a reference there are no images: makes one, with a current that fits, and says so. What the skin is like
    /// then is kept.
    pub(super) fn tare_first(&mut self, current: &Current) -> anyhow::Result<bool> {
        let tared = self.needs_tare()?;
        if tared {
            let link = self.link.as_mut().context("the board is lost")?;
            current.fit(link, &mut self.patch, || !interrupt::requested())?;
            self.tare()?;
        }
        // A board that does not tell cannot be compared later.
        let link = self.link.as_mut().context("the board is lost")?;
        self.untouched = Untouched::of(link, &self.patch).ok();
        Ok(tared)
    }

    /// A board that has lost its reference waits for a skin that nothing presses; false if Ctrl-C ends that.
    fn wait_untouched(&mut self, give_up: Option<Instant>) -> anyhow::Result<bool> {
        let Some(untouched) = &self.untouched else { return Ok(true) };
        let link = self.link.as_mut().context("the board is lost")?;
        let timeout = silence_timeout(&self.patch);
        let mut is_said = false;
        while untouched.is_pressed(link, timeout)? {
            if !is_said {
                eprintln!(
                    "something presses on the skin: the board waits with its new reference until it is free"
                );
            }
            is_said = true;
            if give_up.is_some_and(|time| Instant::now() >= time) {
                bail!("something presses on the skin, or it has changed: free it and use `dermatome tare`")
            }
            if !interrupt::sleep(LOOK_AGAIN) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn needs_tare(&mut self) -> anyhow::Result<bool> {
        let link = self.link.as_mut().context("the board is lost")?;
        Ok(Untouched::is_lost(self.untouched.as_ref(), link, &self.patch)?)
    }

    fn tare(&mut self) -> anyhow::Result<()> {
        let frames = DEFAULT_TARE_FRAMES;
        eprintln!("the board has no reference: averaging {frames} frames, do not touch the skin");
        let link = self.link.as_mut().context("the board is lost")?;
        Ok(tare_with_spinner(link, &self.patch, frames)?)
    }
}

/// Whether trying again may help.
pub(super) fn may_pass(error: &anyhow::Error) -> bool {
    error.downcast_ref::<LinkError>().is_some_and(LinkError::may_pass)
}

/// Opens a port, which may take seconds; `None` if Ctrl-C ends it, at once.
fn open_interruptibly(port: &Port) -> Option<anyhow::Result<Link>> {
    let (sender, opened) = channel();
    let port = port.clone();
    thread::spawn(move || {
        // Fails if Ctrl-C came first: then the program ends, and this with it.
        let _ = sender.send(port::open(&port));
    });
    loop {
        match opened.recv_timeout(POLL) {
            Ok(Ok(link)) => return Some(Ok(link)),
            Ok(Err(OpenError::Link(error))) => return Some(Err(error.into())),
            Ok(Err(error)) => return Some(Err(error.into())),
            Err(RecvTimeoutError::Disconnected) => return None,
            Err(RecvTimeoutError::Timeout) if interrupt::requested() => return None,
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}
