//! Board: a board that is open, and streams or does not.

use crate::{
    codes,
    failure::Failure,
    records::{Counts, Drive, Frame, Identity, Options, Skin},
};
use dermatome_link::{
    Link, NotBegun, PolledStream, Port, frame_timeout, open,
    shared::{
        drive::Drive as BoardDrive,
        protocol::{Info, PackedImage, PatchInfo, Request, Selection},
    },
    tables::SurfaceTables,
    tare, tare_timeout,
};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::{
    os::fd::{BorrowedFd, RawFd},
    time::{Duration, Instant},
};

/// So long a wait takes the system at most; then the board is shown that its host is there.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

const STREAMS: Failure = Failure::State("a stream is under way; stop it first");
const STREAMS_NOT: Failure = Failure::State("no stream is under way; start one first");

/// A board that is open.
pub struct Board {
    /// None only while one becomes the other, or after a panic in between.
    link: Option<Phase>,
    silence: Duration,
    image: Option<PackedImage>,
    failure: Option<Failure>,
}

/// Whether it streams.
enum Phase {
    Open(Box<Link>),
    Streaming(Box<PolledStream>),
}

impl Board {
    /// Opens a port; allocates and waits.
    pub fn open(port: &str) -> Result<Self, Failure> {
        let port: Port = port.parse()?;
        let link = Some(Phase::Open(Box::new(open(&port)?)));
        Ok(Self { link, silence: Duration::ZERO, image: None, failure: None })
    }

    /// Keeps why a call failed.
    pub fn failed(&mut self, failure: Failure) {
        self.failure = Some(failure);
    }

    /// Why the last call that failed did.
    #[must_use]
    pub fn failure(&self) -> Option<&Failure> {
        self.failure.as_ref()
    }

    /// Whether it can only be closed.
    #[must_use]
    pub fn is_faulty(&self) -> bool {
        matches!(self.failure, Some(Failure::Fault))
    }

    /// Who the board is.
    pub fn identity(&self) -> Result<Identity, Failure> {
        let link = match self.link.as_ref().ok_or(Failure::Fault)? {
            Phase::Open(link) => link,
            Phase::Streaming(stream) => stream.link(),
        };
        Ok(Identity::new(link.identity()))
    }

    /// The skin of its patch.
    pub fn skin(&mut self) -> Result<Skin, Failure> {
        let info = self.open_link()?.info()?;
        Ok(Skin::new(&info, patch(&info)?))
    }

    /// Pixels of its images.
    pub fn surface(&mut self) -> Result<SurfaceTables, Failure> {
        Ok(self.open_link()?.surface()?)
    }

    /// Makes a reference, and waits for it.
    pub fn tare(&mut self, frames: u16) -> Result<(), Failure> {
        let link = self.open_link()?;
        let info = link.info()?;
        let timeout = tare_timeout(patch(&info)?, frames);
        Ok(tare(link, frames, timeout)?)
    }

    /// Changes the drive, and waits for the board to have done it.
    pub fn set_drive(&mut self, drive: Option<Drive>) -> Result<(), Failure> {
        let drive = drive.map(Drive::read).transpose()?;
        self.open_link()?.request(&Request::Drive(drive))?;
        Ok(())
    }

    /// Has it stream; allocates all that polling needs.
    pub fn start(&mut self, options: Options) -> Result<(), Failure> {
        let info = self.open_link()?.info()?;
        let patch = patch(&info)?;
        if options.patch_crc != 0 && options.patch_crc != patch.crc {
            return Err(Failure::WrongPatch { found: patch.crc, expected: options.patch_crc });
        }
        let selection = selection(options)?;
        let silence = Duration::from_millis(options.silence_ms.into());
        self.silence = if silence.is_zero() { frame_timeout(patch) } else { silence };
        let Some(Phase::Open(link)) = self.link.take() else { return Err(Failure::Fault) };
        let (phase, begun) = match PolledStream::begin(*link, selection) {
            Ok(stream) => (Phase::Streaming(Box::new(stream)), Ok(())),
            Err(NotBegun { link, error }) => (Phase::Open(link), Err(error.into())),
        };
        self.link = Some(phase);
        begun
    }

    /// The next frame that is there.
    pub fn poll(&mut self) -> Result<Option<Frame>, Failure> {
        match self.next()? {
            None => self.unless_silent(),
            frame => Ok(frame),
        }
    }

    /// The next frame, waiting for it so long.
    pub fn wait(&mut self, timeout: Duration) -> Result<Option<Frame>, Failure> {
        let begun = Instant::now();
        loop {
            if let Some(frame) = self.next()? {
                return Ok(Some(frame));
            }
            let left = timeout.saturating_sub(begun.elapsed());
            if left.is_zero() {
                return self.unless_silent();
            }
            wait_for(self.descriptor()?, left.min(LONGEST_WAIT))?;
        }
    }

    /// The image of the frame that came last.
    pub fn image(&self) -> Result<&PackedImage, Failure> {
        self.image.as_ref().ok_or(Failure::State("the last frame has no image"))
    }

    /// What has come of the stream.
    pub fn counts(&mut self) -> Result<Counts, Failure> {
        let stream = self.stream()?;
        Ok(Counts::new(stream.totals(), stream.selection().images, stream.link()))
    }

    /// What becomes readable when something comes.
    pub fn descriptor(&mut self) -> Result<RawFd, Failure> {
        self.stream()?.descriptor().ok_or(Failure::State("this port has no file descriptor"))
    }

    /// Asks for a reference.
    pub fn ask_tare(&mut self, frames: u16) -> Result<(), Failure> {
        self.ask(&Request::Tare { frames })
    }

    /// Asks for another drive.
    pub fn ask_drive(&mut self, drive: Option<Drive>) -> Result<(), Failure> {
        let drive: Option<BoardDrive> = drive.map(Drive::read).transpose()?;
        self.ask(&Request::Drive(drive))
    }

    /// What became of what was asked, as a code.
    pub fn answer(&mut self) -> Result<i32, Failure> {
        let stream = self.stream()?;
        match stream.answer() {
            None if stream.is_asking() => Ok(codes::DERMATOME_PENDING),
            None => Ok(codes::DERMATOME_OK),
            Some(reply) => Ok(reply.map(|_| codes::DERMATOME_OK)?),
        }
    }

    /// Ends the stream, and waits for the board to have done so.
    pub fn stop(&mut self) -> Result<(), Failure> {
        self.stream()?;
        let Some(Phase::Streaming(stream)) = self.link.take() else { return Err(Failure::Fault) };
        let (link, stopped) = stream.stop();
        self.link = Some(Phase::Open(Box::new(link)));
        self.image = None;
        stopped?;
        Ok(())
    }

    fn next(&mut self) -> Result<Option<Frame>, Failure> {
        let stream = self.stream()?;
        let Some(scan) = stream.poll()? else { return Ok(None) };
        let counts = Counts::new(stream.totals(), stream.selection().images, stream.link());
        let frame = Frame::new(&scan, counts);
        self.image = scan.image;
        Ok(Some(frame))
    }

    fn unless_silent(&mut self) -> Result<Option<Frame>, Failure> {
        let longest = self.silence;
        let silence = self.stream()?.silence();
        if silence < longest {
            return Ok(None);
        }
        Err(Failure::Silent { milliseconds: silence.as_millis() as u64 })
    }

    fn ask(&mut self, request: &Request) -> Result<(), Failure> {
        if self.stream()?.ask(request)? {
            return Ok(());
        }
        Err(Failure::State(
            "an earlier request is still on its way, or its answer waits for dermatome_answer",
        ))
    }

    fn open_link(&mut self) -> Result<&mut Link, Failure> {
        match &mut self.link {
            Some(Phase::Open(link)) => Ok(link),
            Some(Phase::Streaming(_)) => Err(STREAMS),
            None => Err(Failure::Fault),
        }
    }

    fn stream(&mut self) -> Result<&mut PolledStream, Failure> {
        match &mut self.link {
            Some(Phase::Streaming(stream)) => Ok(stream),
            Some(Phase::Open(_)) => Err(STREAMS_NOT),
            None => Err(Failure::Fault),
        }
    }
}

fn patch(info: &Info) -> Result<&PatchInfo, Failure> {
    info.patch.as_ref().ok_or(Failure::NoPatch)
}

fn selection(options: Options) -> Result<Selection, Failure> {
    let Options { contacts_every, images_every, .. } = options;
    let selection = Selection { contacts: contacts_every, images: images_every, ..Selection::default() };
    if selection.any() {
        return Ok(selection);
    }
    Err(Failure::Argument("options.contacts_every and options.images_every are both 0: nothing to stream"))
}

/// Waits until a descriptor is readable, so long at most, or until a signal comes.
#[expect(unsafe_code, reason = "the link hands out a bare number")]
fn wait_for(descriptor: RawFd, timeout: Duration) -> Result<(), Failure> {
    // SAFETY: the board's link holds it open, and is not closed meanwhile.
    let descriptor = unsafe { BorrowedFd::borrow_raw(descriptor) };
    let timeout = Timespec { tv_sec: 0, tv_nsec: timeout.subsec_nanos().into() };
    match poll(&mut [PollFd::from_borrowed_fd(descriptor, PollFlags::IN)], Some(&timeout)) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(_) => Err(Failure::State("the system does not wait on this port")),
    }
}
