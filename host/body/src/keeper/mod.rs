//! Keeper: holds one board, whatever happens to it.
//!
//! A thread of its own opens the port, makes sure that the board holds this skin's patch, gives it back the drive that
//! it had, and streams. A board that is lost is tried again until it answers; one that has lost its reference gets a new one
//! once nothing presses, and with it a new drive that was asked for. What it does, and what comes, it [tells](Told).

mod averaging;
mod presses;
mod told;
mod trouble;

use crate::{driven::Driven, file::Patch, surface::is_same};
use averaging::{Averaging, Taken};
use dermatome_link::{
    Link, LinkError, LinkErrorKind, Untouched, frame_timeout, is_tared, silence_timeout,
    tables::SurfaceTables,
};
use dermatome_messages::clock::now_ns;
use dermatome_shared::{
    acquire::FrontEnd,
    drive::Drive,
    patch::PatchView,
    protocol::{FrameSource, PatchInfo, Request, Selection},
};
use dermatome_simulate::port::{Port, open};
use presses::Presses;
use std::{
    io,
    ops::ControlFlow,
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};
pub(crate) use told::{DRIVE_WAITS, WAITS};
pub use told::{Phase, Reference, State, Told};
use trouble::Trouble;

/// Time until a board is tried again, which doubles up to the longest.
const FIRST_PAUSE: Duration = Duration::from_millis(50);
const LONGEST_PAUSE: Duration = Duration::from_millis(500);
/// Until a board is tried again whose line carries no more.
const FULL_PAUSE: Duration = Duration::from_secs(10);
/// Longest a keeper waits for a frame without looking what it is asked.
const LOOK: Duration = Duration::from_millis(20);
/// How often a skin that is pressed is looked at again.
const LOOK_AGAIN: Duration = Duration::from_millis(300);

/// What is said of a board that makes a reference.
const AVERAGING: &str = "averaging the untouched skin";

/// What a keeper may be asked to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Asked {
    /// Make a new reference, once nothing presses.
    Tare,
    /// Drive the skin like this, once nothing presses, and after every restart of the board.
    Drive(Drive),
}

/// What comes to its thread.
#[derive(Debug)]
enum Order {
    Do(Asked),
    Stop,
}

/// Holds a board until it is dropped.
pub struct Keeper {
    orders: Sender<Order>,
    thread: Option<JoinHandle<()>>,
}

impl Keeper {
    /// Begins to hold the board of this patch of a body, whose skin has these pixels, and to tell what happens.
    pub fn start(
        patch: &Patch,
        surface: SurfaceTables,
        selection: Selection,
        tell: impl FnMut(Told) + Send + 'static,
    ) -> io::Result<Self> {
        let (orders, receiver) = channel();
        let board = Board {
            port: patch.port.clone(),
            on_bus: patch.on_bus,
            skin: patch.skin.name.clone(),
            surface,
            selection,
            orders: receiver,
            tell: Box::new(tell),
            known: None,
            drive: None,
            front_end: None,
            untouched: None,
            reference_made: None,
            made_now: false,
            has_come: false,
            wants_tare: false,
            wants_drive: None,
            is_asked: false,
        };
        let thread = thread::Builder::new().name(patch.name.clone()).spawn(move || board.keep())?;
        Ok(Self { orders, thread: Some(thread) })
    }

    /// Asks it to do this.
    pub fn ask(&self, asked: Asked) {
        self.send(Order::Do(asked));
    }

    /// Asks it to end, which dropping it waits for.
    pub fn stop(&self) {
        self.send(Order::Stop);
    }

    fn send(&self, order: Order) {
        // Fails if the keeper has ended, which it has told.
        let _ = self.orders.send(order);
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.stop();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A keeper's thread is to end.
struct Stop;

struct Board {
    port: Port,
    /// Boards of the body on its bus.
    on_bus: usize,
    /// Name of the skin.
    skin: String,
    surface: SurfaceTables,
    selection: Selection,
    orders: Receiver<Order>,
    tell: Box<dyn FnMut(Told) + Send>,
    /// Id of the patch that was found to be of this skin.
    known: Option<u32>,
    /// How the skin is to be driven: as it was first found, or as it was asked for.
    drive: Option<Drive>,
    front_end: Option<FrontEnd>,
    /// The skin by its last reference.
    untouched: Option<Untouched>,
    /// When that was made, by this computer's clock, ns since 1970; none where it was not made from here.
    reference_made: Option<u64>,
    /// Whether one was made that is not known yet.
    made_now: bool,
    has_come: bool,
    wants_tare: bool,
    /// A drive that waits until nothing presses.
    wants_drive: Option<Drive>,
    /// Whether something was asked for, and who asked has not been told yet that it waits.
    is_asked: bool,
}

impl Board {
    fn keep(mut self) {
        let mut pause = FIRST_PAUSE;
        loop {
            let begun = Instant::now();
            match self.attend() {
                Ok(Stop) => break,
                Err(trouble) => {
                    let phase = trouble.phase(self.has_come);
                    self.state(phase, trouble.to_string());
                    if phase == Phase::Ended {
                        break;
                    }
                    if trouble.is_full_line() {
                        // Asking again and again takes more of it.
                        pause = FULL_PAUSE;
                    }
                }
            }
            if self.pause(pause).is_some() {
                break;
            }
            pause =
                if begun.elapsed() > LONGEST_PAUSE { FIRST_PAUSE } else { (2 * pause).min(LONGEST_PAUSE) };
        }
    }

    fn state(&mut self, phase: Phase, text: impl Into<String>) {
        (self.tell)(Told::State(State { phase, text: text.into() }));
    }

    /// Waits, and takes what is asked meanwhile.
    fn pause(&mut self, time: Duration) -> Option<Stop> {
        let until = Instant::now() + time;
        loop {
            match self.orders.recv_timeout(until.saturating_duration_since(Instant::now())) {
                Ok(Order::Do(asked)) => self.want(asked),
                Ok(Order::Stop) | Err(RecvTimeoutError::Disconnected) => return Some(Stop),
                Err(RecvTimeoutError::Timeout) => return None,
            }
        }
    }

    /// Something is asked for. Of drives the last one counts.
    fn want(&mut self, asked: Asked) {
        self.is_asked = true;
        match asked {
            Asked::Tare => self.wants_tare = true,
            Asked::Drive(drive) => {
                let before = self.wants_drive.replace(drive);
                if let Some(before) = before.filter(|before| *before != drive) {
                    (self.tell)(Told::GivenUp(before));
                }
            }
        }
    }

    /// Holds a board until it is lost.
    fn attend(&mut self) -> Result<Stop, Trouble> {
        let mut link = open(&self.port)?;
        link.share_bus(self.on_bus);
        loop {
            let mut patch = self.meet(&mut link)?;
            let is_lost = Untouched::is_lost(self.untouched.as_ref(), &mut link, &patch)?;
            if is_lost && let Some(stop) = self.wait_untouched(&mut link, &patch)? {
                return Ok(stop);
            }
            let is_tared_in_stream = is_lost && self.shows_tares();
            if !is_tared_in_stream {
                if is_lost && let Some(stop) = self.make_reference(&mut link, &mut patch)? {
                    return Ok(stop);
                }
                self.know_reference(Untouched::of(&mut link, &patch)?);
            }
            if let Some(stop) = self.stream(&mut link, &mut patch, is_tared_in_stream)? {
                return Ok(stop);
            }
        }
    }

    /// Makes sure that a board that has been found, or has perhaps started anew, holds this skin's patch and has the drive
    /// that it had.
    fn meet(&mut self, link: &mut Link) -> Result<PatchInfo, Trouble> {
        let info = link.info()?;
        let mut patch = info.patch.ok_or(Trouble::NoPatch)?;
        self.greet(link, &patch, info.frame_source)?;
        self.front_end = info.front_end;
        // One that was asked for before lasts until the board starts anew.
        patch.drive = info.drive.unwrap_or(patch.drive);
        let drive = self.drive.unwrap_or(patch.drive);
        self.change_drive(link, &mut patch, drive)?;
        self.has_come = true;
        Ok(patch)
    }

    fn drives(&mut self, drive: Drive) {
        self.drive = Some(drive);
        (self.tell)(Told::Driven(Box::new(Driven { drive, front_end: self.front_end })));
    }

    /// Takes what has been asked for, with a board that is there; the drive changes if the skin is free. Says whether it is
    /// driven otherwise now.
    fn obey(
        &mut self,
        link: &mut Link,
        patch: &mut PatchInfo,
        is_free: bool,
    ) -> Result<ControlFlow<Stop, bool>, LinkError> {
        loop {
            match self.orders.try_recv() {
                Ok(Order::Do(asked)) => self.want(asked),
                Ok(Order::Stop) | Err(TryRecvError::Disconnected) => return Ok(ControlFlow::Break(Stop)),
                Err(TryRecvError::Empty) => break,
            }
        }
        let drive = self.wants_drive.filter(|drive| is_free || *drive == patch.drive);
        let is_changed = drive.map_or(Ok(false), |drive| self.change_drive(link, patch, drive))?;
        // One for which the link has failed still waits when the board is back.
        self.wants_drive = self.wants_drive.filter(|_| drive.is_none());
        Ok(ControlFlow::Continue(is_changed))
    }

    /// Has the skin driven like this; the board may refuse. Says whether it is driven otherwise now.
    fn change_drive(
        &mut self,
        link: &mut Link,
        patch: &mut PatchInfo,
        drive: Drive,
    ) -> Result<bool, LinkError> {
        let is_other = drive != patch.drive;
        if is_other {
            match link.request(&Request::Drive(Some(drive))) {
                Ok(_) => patch.drive = drive,
                Err(LinkError { kind: LinkErrorKind::Refused(refusal), .. }) => {
                    (self.tell)(Told::NotDriven { drive, why: refusal.to_string() });
                }
                Err(error) => return Err(error),
            }
        }
        self.drives(patch.drive);
        Ok(is_other && patch.drive == drive)
    }

    /// Makes sure that the board's patch is of this skin.
    fn greet(
        &mut self,
        link: &mut Link,
        patch: &PatchInfo,
        frame_source: FrameSource,
    ) -> Result<(), Trouble> {
        if self.known == Some(patch.crc) {
            return Ok(());
        }
        if patch.skin.as_str() != self.skin {
            return Err(Trouble::OtherSkin(patch.skin.as_str().to_owned()));
        }
        let bytes = link.patch()?;
        let tables = SurfaceTables::read(&PatchView::validate(&bytes).map_err(Trouble::Patch)?);
        if !is_same(&tables, &self.surface) {
            return Err(Trouble::OtherPixels);
        }
        self.known = Some(patch.crc);
        let identity = link.identity();
        let board = identity.board.as_str().to_owned();
        let firmware = identity.firmware.as_str().to_owned();
        (self.tell)(Told::Patch { bytes, tables: Box::new(tables), board, firmware, frame_source });
        Ok(())
    }

    /// A board that has lost its reference waits until nothing presses, by the reference that it had.
    fn wait_untouched(&mut self, link: &mut Link, patch: &PatchInfo) -> Result<Option<Stop>, LinkError> {
        let Some(untouched) = self.untouched.clone().filter(|it| it.is_of(patch)) else { return Ok(None) };
        let mut is_said = false;
        while untouched.is_pressed(link, silence_timeout(patch))? {
            if !std::mem::replace(&mut is_said, true) {
                self.state(Phase::NotTared, WAITS);
            }
            if let Some(stop) = self.pause(LOOK_AGAIN) {
                return Ok(Some(stop));
            }
        }
        Ok(None)
    }

    /// Has the board make a reference, which takes long where frames come seldom.
    fn make_reference(&mut self, link: &mut Link, patch: &mut PatchInfo) -> Result<Option<Stop>, LinkError> {
        self.state(Phase::Taring, AVERAGING);
        let mut averaging = Averaging::begin(link, patch)?;
        // Who asks from here on gets one of its own.
        self.wants_tare = false;
        while !is_tared(link, LOOK)? {
            if let Some(why) = averaging.too_late() {
                return Err(link.error(why));
            }
            match self.obey(link, patch, true)? {
                ControlFlow::Break(stop) => return Ok(Some(stop)),
                ControlFlow::Continue(true) => averaging = Averaging::begin(link, patch)?,
                ControlFlow::Continue(false) => {}
            }
        }
        self.made_now = true;
        Ok(None)
    }

    /// Whether frames of a tare are told as well, as somebody wants raw codes: then it is made in the stream.
    fn shows_tares(&self) -> bool {
        self.selection.measurements > 0
    }

    /// The board has this reference; one that it had not before was made by somebody else.
    fn know_reference(&mut self, untouched: Untouched) {
        let is_other =
            self.untouched.as_ref().is_some_and(|before| before.voltages() != untouched.voltages());
        if std::mem::take(&mut self.made_now) {
            self.reference_made = Some(now_ns());
        } else if is_other {
            self.reference_made = None;
        }
        let voltages = untouched.voltages().to_vec();
        self.untouched = Some(untouched);
        (self.tell)(Told::Reference(Box::new(Reference { made_ns: self.reference_made, voltages })));
    }

    /// Streams until it is to stop, or to make a reference.
    fn stream(
        &mut self,
        link: &mut Link,
        patch: &mut PatchInfo,
        begins_with_tare: bool,
    ) -> Result<Option<Stop>, LinkError> {
        let mut silence = frame_timeout(patch);
        let mut stream = link.subscribe(self.selection)?;
        let thinned_out = stream.thinned_out(self.selection).unwrap_or_default();
        let mut averaging = None;
        if begins_with_tare {
            averaging = Some(Averaging::begin(stream.link(), patch)?);
        } else {
            self.state(Phase::Live, thinned_out.as_str());
        }
        let mut heard = Instant::now();
        let mut presses = Presses::new(patch.drive.frame_rate);
        // What is said to wait for a free skin, in words.
        let mut said = "";
        loop {
            let now = Instant::now();
            let is_free = averaging.is_some() || presses.is_free(now);
            let mut is_to_tare = self.wants_tare && averaging.is_none() && presses.is_untouched(now);
            match self.obey(stream.link(), patch, is_free)? {
                ControlFlow::Break(stop) => {
                    // A board that does not answer any more keeps nobody from ending.
                    let _ = stream.stop();
                    return Ok(Some(stop));
                }
                // The board begins that of a tare anew, and all may take longer now.
                ControlFlow::Continue(true) => {
                    (is_to_tare, silence) = (true, frame_timeout(patch));
                    presses = Presses::new(patch.drive.frame_rate);
                }
                // It waits no more, as it was refused or is that which the skin has.
                ControlFlow::Continue(false) if said == DRIVE_WAITS && self.wants_drive.is_none() => {
                    self.state(Phase::Live, thinned_out.as_str());
                    said = "";
                }
                ControlFlow::Continue(false) => {}
            }
            if is_to_tare {
                if self.shows_tares() {
                    (averaging, said) = (Some(Averaging::begin(stream.link(), patch)?), "");
                    self.wants_tare = false;
                    continue;
                }
                stream.stop()?;
                return self.make_reference(link, patch);
            }
            let Some(frame) = stream.next(LOOK)? else {
                if heard.elapsed() > silence {
                    // What it said before is over, while it is asked whether it has started anew on the same link.
                    self.state(Phase::Lost, format!("no frame came for {:.1} s", silence.as_secs_f32()));
                    if stream.link().info()?.streaming.any() {
                        return Err(stream.link().error(LinkErrorKind::NoAnswer { timeout: silence }));
                    }
                    return Ok(None);
                }
                continue;
            };
            heard = Instant::now();
            presses.take(&frame, heard);
            if let Some(tare) = &mut averaging {
                match tare.take(&frame) {
                    Taken::First => {
                        // Who asks from here on gets one of its own.
                        self.wants_tare = false;
                        self.state(Phase::Taring, AVERAGING);
                    }
                    Taken::More => {}
                    Taken::Last => {
                        (averaging, self.made_now) = (None, true);
                        self.know_reference(Untouched::of(stream.link(), patch)?);
                        self.state(Phase::Live, thinned_out.as_str());
                    }
                    Taken::TooLate(why) => return Err(stream.link().error(why)),
                }
            }
            let waits = if self.wants_drive.is_some() {
                presses.is_pressed().then_some(DRIVE_WAITS)
            } else {
                (self.wants_tare && presses.is_touched()).then_some(WAITS)
            };
            if let Some(words) = waits
                && (std::mem::take(&mut self.is_asked) || words != said)
            {
                said = words;
                self.state(Phase::Live, words);
            }
            let missing = stream.totals().frames_missing;
            (self.tell)(Told::Frame { frame: Box::new(frame), received_ns: now_ns(), missing });
        }
    }
}
