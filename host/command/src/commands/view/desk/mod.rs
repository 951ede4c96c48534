//! Desk: a board and all that the page asks of it.
//!
//! One thread holds the link: it takes frames as they come, gives them to the page and the recording, and between two
//! frames does what was asked. A board that is lost, or was never there, is tried again until it answers.

mod asked;
mod greeting;

use super::{
    calls::{CALIBRATE, CHECK, RECORD, TARE},
    look::Source,
    numbers::{Numbers, signal_to_noise},
    prepared::Prepared,
};
use crate::commands::{
    board::advise,
    current::Current,
    interrupt,
    outlets::{LIVE, Outlets, recorded_in_words},
    stream::session::Session as Board,
};
use anyhow::{Context, ensure};
use dermatome_link::{self as link, ScanFrame, Untouched, frame_timeout, pose::Pose, words};
use dermatome_messages::{clock::now_ns, dermatome::Status, skin::Look};
use dermatome_page::{Call, Server};
use dermatome_recording::{session::Session, write::Recorder};
use dermatome_shared::{
    drive::Drive,
    patch::{PatchView, reflexes::ReflexRule},
    pipeline::reflex::Reflexes,
    protocol::{PatchInfo, Refusal, Selection},
    stimulation::Step,
};
use dermatome_simulate::port::Port;
use serde_json::json;
use std::{
    collections::VecDeque,
    path::Path,
    time::{Duration, Instant},
};

/// How often the page is told how the session stands.
const STATUS_PERIOD: Duration = Duration::from_millis(500);
/// Time until a board is tried again.
const PAUSE: Duration = Duration::from_millis(500);
/// Frames without contacts after which a board has no reference: those of fewer may have been lost on the way.
const SURELY: u32 = 3;
/// How often a skin that is pressed is looked at again.
const LOOK_AGAIN: Duration = Duration::from_millis(300);
/// Longest the desk waits for a frame without looking who asks for something.
const LOOK: Duration = Duration::from_millis(20);
/// Bytes a second that a serial port leaves for raw codes and images: of its 200,000, what contacts and health need not.
const SERIAL_BYTES: f64 = 150e3;

/// What a desk is to do.
pub(in crate::commands) struct Task<'a> {
    /// Where the board is; none for recordings alone.
    pub(in crate::commands) port: Option<&'a Port>,
    /// Other patches that stand ready, with their names.
    pub(in crate::commands) patches: &'a [(String, PatchView<'a>)],
    /// What is known of the skin.
    pub(in crate::commands) look: Source,
    /// Skin file to check the board against.
    pub(in crate::commands) skin: Option<&'a Path>,
    /// File to record to.
    pub(in crate::commands) record: Option<&'a Path>,
    /// What to do about a current that clips.
    pub(in crate::commands) current: &'a Current,
}

/// A board and its page.
pub(in crate::commands) struct Desk<'a> {
    task: Task<'a>,
    server: Server,
    outlets: Outlets,
    status: Status,
    told: Instant,
    numbers: Numbers,
    /// Which patch makes the images: the board's, or one of `patches` from 1 on.
    chosen: usize,
    prepared: Option<Prepared<'a>>,
    threshold: f32,
    /// Of the board's patch, and what they said last; none while that would be stale.
    rules: Vec<ReflexRule>,
    reflexes: Option<Reflexes>,
    slot: Option<u16>,
    /// The drive that was asked for, for a board that comes back without it.
    drive: Option<Drive>,
    /// Frames without contacts, one after the other.
    without_contacts: u32,
    /// Who waits for a reference.
    waiting: VecDeque<Call>,
    /// The skin by its last reference.
    untouched: Option<Untouched>,
    /// Whether the recording that `--record` asks for has begun.
    has_recorded: bool,
    /// Whether the next stream begins with a new reference. A board that comes back with the one that it had keeps it:
    /// something may press.
    wants_tare: bool,
}

/// What a desk knows of the board that is there.
struct Present {
    session: Session,
    pose: Option<Pose>,
    look: Look,
    steps: Vec<Step>,
    largest_amplitude: f32,
    sample_rate: Option<u32>,
}

/// Why a stream was left.
enum Left {
    /// The user asks to stop.
    Interrupt,
    /// The board has ended it, or has another patch.
    Anew,
    /// Something is to be done that takes the link alone.
    Do(Call),
}

impl<'a> Desk<'a> {
    /// For those who look on at this server.
    pub(in crate::commands) fn new(task: Task<'a>, server: Server) -> Self {
        let state = if task.port.is_some() { "no_board" } else { "ended" };
        let port = task.port.map_or(String::new(), Port::to_string);
        // Other patches begin with the frames of a tare.
        let wants_tare = !task.patches.is_empty();
        Self {
            task,
            outlets: Outlets::telling(server.speaker(0)),
            server,
            status: Status { state: state.to_owned(), port, signal_to_noise: f32::NAN, ..Status::default() },
            told: Instant::now(),
            numbers: Numbers::default(),
            chosen: 0,
            prepared: None,
            threshold: 0.0,
            rules: Vec::new(),
            reflexes: None,
            without_contacts: 0,
            slot: None,
            drive: None,
            waiting: VecDeque::new(),
            untouched: None,
            has_recorded: false,
            wants_tare,
        }
    }

    /// Until the user asks to stop.
    pub(in crate::commands) fn run(mut self) -> anyhow::Result<()> {
        let Some(port) = self.task.port else {
            self.state(
                "ended",
                "no board was named",
                "start again with `--port`, such as `dermatome view --port /dev/ttyACM0`, or open a recording",
            );
            while self.wait(STATUS_PERIOD, "there is no board") {}
            return Ok(());
        };
        while !interrupt::requested() {
            let attended = match Board::open(port) {
                Ok(board) => self.attend(board),
                Err(error) => Err(error),
            };
            match attended {
                Ok(()) => {}
                Err(error) if is_fatal(&error, port) => {
                    self.end()?;
                    return Err(advise(error));
                }
                Err(error) => self.explain(&error),
            }
            self.numbers.begin();
            self.reflexes = None;
            self.refuse_waiting("the board is lost");
            self.wait(PAUSE, "the board does not answer");
        }
        self.end()
    }

    /// Ends the recording, and says what is in it.
    fn end(&mut self) -> anyhow::Result<()> {
        let recorded = self.outlets.finish_recording()?;
        recorded.iter().for_each(|(file, recorded)| eprintln!("{}", recorded_in_words(file, recorded)));
        Ok(())
    }

    /// Says why there is no stream.
    fn explain(&mut self, error: &anyhow::Error) {
        let words = format!("{error:#}");
        let was_there = self.numbers.frames > 0;
        if matches!(error.downcast_ref(), Some(Refusal::NoPatch)) {
            let advice = format!("send it one: `dermatome flash SKIN.dermatome --port {}`", self.status.port);
            self.state("no_patch", "the board holds no patch, so that it cannot measure", &advice);
        } else if was_there {
            self.state("lost", &words, "plug it in again; the page goes on by itself when it answers");
        } else {
            self.state(
                "no_board",
                &words,
                "plug the board in, and close other programs that use its port; `dermatome devices` lists the ports",
            );
        }
    }

    fn state(&mut self, state: &str, text: &str, advice: &str) {
        let status = &mut self.status;
        if [&status.state, &status.text, &status.advice] != [state, text, advice] {
            log::info!("{state}: {text}");
            (status.state, status.text, status.advice) =
                (state.to_owned(), text.to_owned(), advice.to_owned());
            self.tell();
        }
    }

    /// Tells the page how the session stands.
    fn tell(&mut self) {
        self.told = Instant::now();
        let status = &mut self.status;
        status.warnings = self.numbers.warnings();
        let reflexes = self.reflexes.as_ref().map(|now| words::reflexes(&self.rules, now));
        status.warnings.extend(reflexes.unwrap_or_default());
        status.frames = self.numbers.frames;
        status.frames_lost = self.numbers.lost();
        status.frames_per_second = self.numbers.per_second();
        status.patch = self.chosen as u16;
        let recorder = self.outlets.recorder();
        let recorded = recorder.map(Recorder::recorded).unwrap_or_default();
        status.recording = recorder.map_or(String::new(), |recorder| recorder.path().display().to_string());
        (status.recorded_bytes, status.recorded_frames) = (recorded.bytes, recorded.frames);
        status.warnings.extend(recorded.failure.map(|reason| format!("the recording has ended: {reason}")));
        let status = status.clone();
        self.outlets.status(status);
    }

    /// Waits for so long and refuses all that is asked meanwhile; false if the user asks to stop.
    fn wait(&mut self, time: Duration, why_not: &str) -> bool {
        let until = Instant::now() + time;
        while Instant::now() < until && interrupt::sleep(LOOK) {
            while let Some(call) = self.server.call() {
                match call.service {
                    RECORD => self.stop_recording(call),
                    TARE if self.status.state == "not_tared" => self.waiting.push_back(call),
                    _ => call.answer(Err(why_not.to_owned())),
                }
            }
        }
        self.tell();
        !interrupt::requested()
    }

    fn refuse_waiting(&mut self, why: &str) {
        self.waiting.drain(..).for_each(|call| call.answer(Err(why.to_owned())));
    }

    /// Serves a board until it is lost.
    fn attend(&mut self, mut board: Board<'_>) -> anyhow::Result<()> {
        let present = self.greet(&mut board)?;
        loop {
            match self.stream(&mut board, &present)? {
                Left::Interrupt | Left::Anew => return Ok(()),
                Left::Do(call) if call.service == CHECK => {
                    let found = self.check(&mut board);
                    call.answer(found.map_err(|error| format!("{error:#}")));
                }
                Left::Do(call) => {
                    let done = self.calibrate(&call, &mut board, &present);
                    let has_changed = done.is_ok();
                    call.answer(done.map_err(|error| format!("{error:#}")));
                    if has_changed {
                        return Ok(());
                    }
                }
            }
        }
    }

    /// What is streamed of a board with this patch: on a serial line no more than it carries.
    fn selection(&self, patch: &PatchInfo) -> Selection {
        let is_serial =
            matches!(self.task.port, Some(Port::Board(link::Port::Serial(_) | link::Port::Bus(..))));
        let is_raw = !is_serial
            || self.outlets.recorder().is_some()
            || self.chosen > 0
            || !self.task.patches.is_empty();
        // postcard: up to four bytes a code, and about two a pixel.
        let raw = if is_raw { 7.0 * f64::from(patch.steps) } else { 0.0 };
        let left = SERIAL_BYTES / f64::from(patch.drive.frame_rate) - raw;
        let every = (2.2 * f64::from(patch.pixels) / left.max(1.0)).ceil().clamp(1.0, 20.0);
        Selection {
            images: if is_serial { every as u16 } else { 1 },
            contacts: 1,
            measurements: is_raw.into(),
            health: 1,
            scope: self.slot.is_some().into(),
            scope_slot: self.slot.unwrap_or(0),
        }
    }

    /// Shows a stream until it ends or is left.
    fn stream(&mut self, board: &mut Board<'_>, present: &Present) -> anyhow::Result<Left> {
        if let Some(file) = self.task.record.filter(|_| !self.has_recorded) {
            self.outlets.record(file, &present.session)?;
            (self.has_recorded, self.wants_tare) = (true, true);
        }
        let (silence, damaged) = (frame_timeout(&board.patch), board.packets_damaged());
        let Board { link, patch, .. } = board;
        let mut stream = link.as_mut().context("the board is lost")?.subscribe(self.selection(patch))?;
        if std::mem::take(&mut self.wants_tare) {
            self.outlets.tare(stream.link())?;
        }
        let mut heard = Instant::now();
        self.without_contacts = 0;
        let left = loop {
            if interrupt::requested() {
                break Left::Interrupt;
            }
            match stream.next(LOOK)? {
                Some(frame) => {
                    heard = Instant::now();
                    if self.take(&frame, stream.totals().frames_missing) {
                        self.untouched = Untouched::of(stream.link(), patch).ok();
                    }
                }
                None if heard.elapsed() > silence => {
                    if !stream.link().info()?.streaming.any() {
                        break Left::Anew;
                    }
                    ensure!(
                        heard.elapsed() < 3 * silence,
                        "the board says that it streams, and sends no frame"
                    );
                }
                None => {}
            }
            if self.told.elapsed() >= STATUS_PERIOD {
                self.status.packets_damaged = damaged + stream.link().packets_damaged();
                self.tell();
                self.outlets.warn();
            }
            if let Some(call) = self.server.call() {
                match call.service {
                    CHECK | CALIBRATE => break Left::Do(call),
                    TARE => {
                        self.outlets.tare(stream.link())?;
                        self.waiting.push_back(call);
                    }
                    _ => {
                        let done = self.answer(&call, &mut stream, patch, present);
                        call.answer(done.map_err(|error| format!("{error:#}")));
                        stream.reselect(self.selection(patch))?;
                        self.tell();
                    }
                }
            }
        };
        if !matches!(left, Left::Anew) {
            stream.stop()?;
        }
        Ok(left)
    }

    /// A frame has come. Says whether the board has a new reference with it.
    fn take(&mut self, frame: &ScanFrame, missing: u64) -> bool {
        self.numbers.count(frame, missing);
        self.watch(frame);
        let shown = self.shown(frame);
        let is_tared = self.outlets.frame(frame, shown.as_ref());
        self.without_contacts += u32::from(frame.at.is_some());
        if frame.contacts.is_some() {
            self.without_contacts = 0;
            self.state(LIVE, "", "");
        } else if self.outlets.is_taring() {
            self.state(
                "taring",
                "the board averages the untouched skin",
                "do not touch the skin until it is done; if it takes long, look at `check`",
            );
        } else if self.without_contacts >= SURELY && (frame.measurements.is_some() || frame.health.is_some())
        {
            self.state(
                "not_tared",
                "the board has no reference: it makes one as soon as the skin is steady",
                "do not touch the skin; if it takes long, look at `check`",
            );
        }
        if is_tared {
            self.tared();
        }
        is_tared
    }

    /// What the reflexes say is told at once where it changes.
    fn watch(&mut self, frame: &ScanFrame) {
        let said = self.reflexes.take();
        self.reflexes.clone_from(&frame.reflexes);
        if said.as_ref().map(Reflexes::state) != self.reflexes.as_ref().map(Reflexes::state) {
            self.tell();
        }
    }

    /// The board has a new reference.
    fn tared(&mut self) {
        let tare = self.outlets.last_tare();
        self.status.signal_to_noise = signal_to_noise(tare).unwrap_or(f32::NAN);
        if let Some(prepared) = &mut self.prepared
            && let Err(error) = prepared.tare(tare)
        {
            log::warn!("{error:#}");
        }
        if !self.outlets.is_taring() {
            self.waiting.drain(..).for_each(|call| call.answer(Ok(json!({}))));
        }
    }

    /// The frame that those see who look on, where it is not the board's own.
    fn shown(&mut self, frame: &ScanFrame) -> Option<ScanFrame> {
        let mut shown = None;
        if let Some(prepared) = &mut self.prepared {
            match prepared.frame(frame, now_ns()) {
                Ok(frame) => shown = Some(frame),
                Err(error) => log::warn!("{error:#}"),
            }
        }
        if self.threshold > 0.0 {
            let mut weaker = shown.unwrap_or_else(|| frame.clone());
            if let Some(contacts) = &mut weaker.contacts {
                contacts.retain(|contact| contact.strength >= self.threshold);
            }
            shown = Some(weaker);
        }
        shown
    }
}

/// Whether no second attempt helps: there is no board to wait for.
fn is_fatal(error: &anyhow::Error, port: &Port) -> bool {
    !matches!(port, Port::Board(_)) && error.downcast_ref::<link::LinkError>().is_none()
}
