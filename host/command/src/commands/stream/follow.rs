//! Follow: the frames of a stream, through all times in which the board is lost.

use super::{
    Args, Ended,
    display::Display,
    fingers::Fingers,
    gap::Gap,
    patience::Patience,
    session::{Restored, Session, may_pass},
    tally::Tally,
};
use crate::commands::{contact_lines::is_read, interrupt, outlets::Outlets};
use anyhow::{Context, bail};
use dermatome_link::{LinkError, LinkErrorKind, ScanFrame, Subscription};
use dermatome_shared::{pipeline::reflex::Reflexes, protocol::Selection};
use std::time::{Instant, SystemTime};

/// Follows a board.
pub(super) struct Follower<'a> {
    args: &'a Args,
    pub(super) session: Session<'a>,
    pub(super) received: Received<'a>,
}

/// What has come, and where it goes.
pub(super) struct Received<'a> {
    pub(super) display: Display<'a>,
    fingers: Option<Fingers>,
    pub(super) tally: Tally,
    /// Times in which the board was lost, and came back.
    pub(super) gaps: Vec<Gap>,
    /// What reflexes said in the last frame.
    reflexes: Option<Reflexes>,
    /// Number of the last frame.
    sequence: Option<u32>,
    /// When it came, or the stream began.
    heard: Instant,
    /// What the board needed when it was back, until its first frame comes.
    restored: Option<Restored>,
    /// Where frames go beside.
    pub(super) outlets: Option<Outlets>,
    /// Whether a new reference is to be made in the stream, for a recording.
    is_to_tare: bool,
}

impl<'a> Follower<'a> {
    pub(super) fn new(
        args: &'a Args,
        session: Session<'a>,
        display: Display<'a>,
        fingers: Option<Fingers>,
        outlets: Option<Outlets>,
    ) -> Self {
        Self { args, session, received: Received::new(display, fingers, outlets) }
    }

    /// Shows the stream until it ends. A board that is lost is waited for.
    pub(super) fn run(&mut self) -> anyhow::Result<Ended> {
        loop {
            let before = self.received.tally.received();
            let ended = self.follow();
            let has_come = self.received.tally.received() > before;
            let back = match ended {
                Ok(Ended::Board) if self.may_wait() => match self.begin_again()? {
                    // It has nothing more to say: it has not even started anew.
                    Some(restored) if !has_come && !restored.tared => return self.ended_by_board(),
                    back => back,
                },
                Ok(Ended::Board) => return self.ended_by_board(),
                Ok(ended) => return Ok(ended),
                Err(error) if may_pass(&error) && self.may_wait() => self.wait_for_board(&error)?,
                Err(error) => return Err(error),
            };
            let Some(restored) = back else { return Ok(Ended::Interrupt) };
            self.received.begin(restored);
        }
    }

    fn may_wait(&self) -> bool {
        self.session.may_come_back() && self.give_up().is_none_or(|time| Instant::now() < time)
    }

    /// A board that has ended its stream may have started anew, or not have heard of its host.
    fn begin_again(&mut self) -> anyhow::Result<Option<Restored>> {
        match self.session.prepare(self.give_up()) {
            Err(error) if may_pass(&error) => self.wait_for_board(&error),
            prepared => prepared,
        }
    }

    fn wait_for_board(&mut self, error: &anyhow::Error) -> anyhow::Result<Option<Restored>> {
        eprintln!("lost the board: {error:#}; trying again");
        let heard = self.received.heard;
        let lost = || format!("the board has sent no frame for {:.1} s", heard.elapsed().as_secs_f64());
        self.session.come_back(self.give_up()).with_context(lost)
    }

    fn give_up(&self) -> Option<Instant> {
        self.args.give_up_after.and_then(|time| self.received.heard.checked_add(time))
    }

    fn ended_by_board(&self) -> anyhow::Result<Ended> {
        let received = self.received.tally.received();
        match self.args.frames {
            Some(frames) => bail!("the board ended its stream after {received} of {frames} frames"),
            None => Ok(Ended::Board),
        }
    }

    /// Starts the stream, shows it until it ends, and stops it.
    fn follow(&mut self) -> anyhow::Result<Ended> {
        let (received, drive) = (&mut self.received, self.session.patch.drive);
        let mut patience = Patience::new(&self.session.patch);
        let wanted = received.selection();
        let mut stream = self.session.link.as_mut().context("the board is lost")?.subscribe(wanted)?;
        if let Some(words) = stream.thinned_out(wanted) {
            eprintln!("warning: {words}");
        }
        if let Some(outlets) = received.outlets.as_mut().filter(|_| std::mem::take(&mut received.is_to_tare))
        {
            outlets.drive(&drive, None);
            outlets.tare(stream.link())?;
        }
        let ended = loop {
            if let Some(ended) = asked_to_end(self.args, &received.tally) {
                break ended;
            }
            let frame = match next(&mut stream, &mut patience)? {
                Next::Frame(frame) => frame,
                Next::None(ended) => break ended,
            };
            if !received.take(&frame, &mut stream, drive.frame_rate.into())? {
                break Ended::Pipe;
            }
        };
        stream.stop()?;
        Ok(ended)
    }
}

impl<'a> Received<'a> {
    fn new(display: Display<'a>, fingers: Option<Fingers>, outlets: Option<Outlets>) -> Self {
        let (tally, heard) = (Tally::default(), Instant::now());
        let is_to_tare = outlets.is_some();
        let (gaps, sequence, reflexes, restored) = (Vec::new(), None, None, None);
        Self { display, fingers, tally, gaps, reflexes, sequence, heard, restored, outlets, is_to_tare }
    }

    /// The next stream begins, after what the board needed for it.
    fn begin(&mut self, restored: Restored) {
        let Restored { drive, tared } = self.restored.unwrap_or_default();
        self.restored = Some(Restored { drive: drive || restored.drive, tared: tared || restored.tared });
        self.tally.begin();
        self.is_to_tare |= restored.tared && self.outlets.is_some();
        if let Some(fingers) = &mut self.fingers {
            fingers.forget_reference();
        }
    }

    fn selection(&self) -> Selection {
        let is_recorded = u16::from(self.outlets.is_some());
        let images = is_recorded.max(self.display.wants_images().into());
        let measurements = is_recorded.max(self.fingers.is_some().into());
        Selection { images, contacts: 1, measurements, health: is_recorded, ..Selection::default() }
    }

    /// Counts and shows a frame; false if nobody reads any more.
    fn take(
        &mut self,
        frame: &ScanFrame,
        stream: &mut Subscription<'_>,
        frame_rate: f64,
    ) -> anyhow::Result<bool> {
        let now = SystemTime::now();
        if let Some(outlets) = &mut self.outlets {
            let is_averaged = outlets.is_taring() && frame.contacts.is_none();
            outlets.frame(frame, None);
            outlets.warn();
            if is_averaged {
                return Ok(true);
            }
        }
        self.display.reflexes(self.reflexes.as_ref(), frame.reflexes.as_ref());
        self.reflexes.clone_from(&frame.reflexes);
        let new = self.tally.count(frame, stream.totals(), Instant::now());
        self.display.warn(frame, &new);
        if let Some(at) = frame.at.filter(|_| frame.contacts.is_some()) {
            let heard = std::mem::replace(&mut self.heard, Instant::now());
            let before = self.sequence.replace(at.sequence);
            if let Some(restored) = self.restored.take() {
                self.back(Gap::new(before, self.heard - heard, frame_rate, restored));
            }
        }
        let fingers = match (self.fingers.as_mut(), &frame.measurements) {
            (Some(fingers), Some(measurements)) => fingers.of_frame(&measurements.codes, stream.link())?,
            _ => None,
        };
        Ok(is_read(self.display.show(frame, fingers.as_deref(), now))?)
    }

    /// The first frame is there after the board was lost.
    fn back(&mut self, gap: Gap) {
        eprintln!("connected again after {:.1} s, about {} frames missed", gap.seconds, gap.frames_missed);
        self.display.gap(&gap);
        self.gaps.push(gap);
    }
}

/// A frame, or why there is none.
enum Next {
    Frame(Box<ScanFrame>),
    None(Ended),
}

/// Waits for the next frame. A board that is silent is asked whether it still streams.
fn next(stream: &mut Subscription<'_>, patience: &mut Patience) -> Result<Next, LinkError> {
    loop {
        match stream.next_while(patience.silence, || !interrupt::requested()) {
            Ok(Some(frame)) => {
                patience.see(&frame);
                patience.check(stream.link())?;
                return Ok(Next::Frame(Box::new(frame)));
            }
            Ok(None) => return Ok(Next::None(Ended::Interrupt)),
            Err(LinkError { kind: LinkErrorKind::NoAnswer { .. }, .. }) => {
                if !stream.link().info()?.streaming.any() {
                    return Ok(Next::None(Ended::Board));
                }
                patience.check(stream.link())?;
            }
            Err(error) => return Err(error),
        }
    }
}

fn asked_to_end(args: &Args, tally: &Tally) -> Option<Ended> {
    if interrupt::requested() {
        return Some(Ended::Interrupt);
    }
    args.frames.is_some_and(|frames| tally.received() >= frames).then_some(Ended::Frames)
}
