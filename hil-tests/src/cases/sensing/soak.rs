//! Soak: for a long virtual time, something goes wrong again and again, at random moments; after each time the board
//! must come back to a right state.
//!
//! Right is: it holds a patch that it may hold, whole; its stream comes; frames are without flags and, nobody touching
//! the skin, without contacts. And at no time may a frame without flags show a contact that is not there.

use super::{
    super::{Failure, TIMEOUT},
    ensure,
    session::Session,
};
use crate::{
    chip::{time::Time, usart::Symbol},
    fault::What,
    machine::{Halt, Machine},
    rig::Rig,
    world::Fault,
};
use dermatome::{
    link::{self, Link, ScanFrame, Subscription},
    model::Model,
    quantize,
    simulate::Press,
    skin::{ImageLayout, Skin},
};
use dermatome_shared::{
    drive::Drive,
    frame::FrameFlags,
    patch::PatchView,
    protocol::{
        BoardPacket, Info, MAX_CHUNK_BYTES, MAX_PACKET_BYTES, PacketReader, Reply, Request, RequestPacket,
        Selection, Version, encode,
    },
};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::{collections::BTreeMap, fmt, time::Duration};

/// Longest that the board may take to be right again, in virtual time: two seconds until the watchdog bites, the start,
/// and a new reference.
const RECOVERY: Time = Time::from_millis(6000);
/// Frames in a row that must be right.
const RIGHT_FRAMES: u32 = 5;
/// Silence of the stream, by the clock on the wall, after which the link is looked at again.
const SILENCE: Duration = Duration::from_millis(500);
/// Columns of pixels of the patches that take turns: small ones, so that uploads are short.
const COLUMNS: [u8; 3] = [8, 9, 10];
/// Frames a second that the patches ask for.
const FRAME_RATES: [f64; 3] = [10.0, 12.0, 15.0];
/// A finger that is found.
const PRESS: Press = Press::finger([0.03, 0.02], 0.025, 0.6);
/// What is taken from the stream.
const WATCHED: Selection =
    Selection { images: 0, contacts: 1, measurements: 0, health: 5, scope: 0, scope_slot: 0 };

/// What goes wrong, or happens, at random.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Trial {
    Power,
    PowerInUpload,
    Reset,
    Noise,
    Late,
    Hang,
    Crash,
    Overflow,
    Broken,
    HostGone,
    NewPatch,
    NewDrive,
    Tare,
    Touch,
}

impl Trial {
    /// Whether the board may not answer what is asked right after.
    fn is_deaf(self) -> bool {
        !matches!(
            self,
            Self::Late | Self::Broken | Self::NewPatch | Self::NewDrive | Self::Tare | Self::Touch
        )
    }
}

const TRIALS: [Trial; 14] = [
    Trial::Power,
    Trial::PowerInUpload,
    Trial::Reset,
    Trial::Noise,
    Trial::Late,
    Trial::Hang,
    Trial::Crash,
    Trial::Overflow,
    Trial::Broken,
    Trial::HostGone,
    Trial::NewPatch,
    Trial::NewDrive,
    Trial::Tare,
    Trial::Touch,
];

/// What a soak has seen.
#[derive(Clone, Debug, Default)]
pub struct Soaked {
    /// How often each thing happened.
    happened: BTreeMap<Trial, u32>,
    frames: u64,
    flagged: u64,
    /// Contacts in frames that have a flag, nobody touching the skin.
    marked_contacts: u64,
    /// Slowest return to a right state, s of virtual time, and after what.
    slowest: (f64, Option<Trial>),
    /// Virtual time, s.
    seconds: f64,
}

impl fmt::Display for Soaked {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count: u32 = self.happened.values().sum();
        let (slowest, after) = self.slowest;
        let after = after.map(|trial| format!(", after {trial:?}")).unwrap_or_default();
        write!(
            formatter,
            "{:.0} s, {count} times something happened: {:?}; right again within {slowest:.2} s{after}; {} frames, {} \
             of them flagged, which had {} contacts that were not there",
            self.seconds, self.happened, self.frames, self.flagged, self.marked_contacts
        )
    }
}

/// Runs a fresh board for so much virtual time; `tell` hears of each thing that happens.
pub fn soak(rig: &Rig, time: Time, seed: u64, mut tell: impl FnMut(&str)) -> Result<Soaked, Failure> {
    let mut soak = Soak::start(rig, seed)?;
    let start = soak.now();
    while soak.now().since(start) < time {
        let trial = TRIALS[soak.random.random_range(0..TRIALS.len())];
        let at = soak.now().since(start);
        let wrong = |failure| Failure::wrong(format!("{at} into it, {trial:?}, seed {seed}: {failure}"));
        soak.run(trial).map_err(wrong)?;
        tell(&format!("{at} {trial:?}"));
    }
    soak.seen.seconds = soak.now().since(start).seconds();
    Ok(soak.seen)
}

struct Soak {
    session: Session,
    patches: Vec<Vec<u8>>,
    /// CRCs of the patches that the board may hold.
    allowed: Vec<u32>,
    random: Pcg64,
    seen: Soaked,
}

impl Soak {
    fn start(rig: &Rig, seed: u64) -> Result<Self, Failure> {
        let (session, _) = Session::open(rig, |skin| change(skin, 0))?;
        let patches = (0..COLUMNS.len()).map(|which| patch(&session.skin, which));
        let patches = patches.collect::<Result<Vec<_>, _>>()?;
        let (random, seen) = (Pcg64::seed_from_u64(seed), Soaked::default());
        let allowed = vec![session.patch().crc()];
        let mut soak = Self { session, patches, allowed, random, seen };
        soak.recover(None)?;
        Ok(soak)
    }

    fn now(&self) -> Time {
        self.session.board.with(|machine| machine.now())
    }

    /// Something happens at a random moment of a stream, and then the board must be right again.
    fn run(&mut self, trial: Trial) -> Result<(), Failure> {
        let mut link = self.session.reconnect()?;
        let mut stream = link.subscribe(WATCHED)?;
        self.watch(&mut stream, 1, false)?;
        let phase = self.random.random_range(0..200_000);
        self.session.run(Time::from_micros(phase))?;
        self.happen(trial, &mut stream)?;
        // A host stops its stream, or goes without a word: it has to where the board did not hear it out.
        if !trial.is_deaf() && self.random.random() {
            stream.stop()?;
        } else {
            std::mem::forget(stream);
        }
        // Nobody reads what is kept.
        self.session.board.with(|machine| machine.chip(|chip| drop(chip.trace.take())));
        *self.seen.happened.entry(trial).or_default() += 1;
        self.recover(Some(trial))
    }

    fn happen(&mut self, trial: Trial, stream: &mut Subscription<'_>) -> Result<(), Failure> {
        match trial {
            Trial::Power => self.machine(Machine::cut_power)?,
            Trial::Reset => self.machine(Machine::press_reset)?,
            Trial::Hang => self.machine(|machine| {
                machine.hang();
                Ok(())
            })?,
            Trial::Crash => self.machine(|machine| {
                machine.inject_fault();
                Ok(())
            })?,
            Trial::Overflow => self.machine(|machine| {
                machine.overflow_stack();
                Ok(())
            })?,
            Trial::PowerInUpload => return self.cut_upload(stream.link()),
            Trial::Noise => return self.disturb(stream),
            Trial::Late => return self.be_late(stream),
            Trial::Broken => return self.break_something(stream),
            Trial::HostGone => {
                let seconds = self.random.random_range(1..45);
                self.session.run(Time::from_millis(1000 * seconds))?;
            }
            Trial::NewPatch => {
                let which = self.random.random_range(0..self.patches.len());
                let patch = &self.patches[which];
                upload_requests(patch).try_for_each(|request| ask(stream.link(), &request).map(drop))?;
                self.allowed = vec![crc(patch)];
            }
            Trial::NewDrive => return self.drive(stream.link()),
            Trial::Tare => link::tare(stream.link(), self.random.random_range(1..30), TIMEOUT)?,
            Trial::Touch => return self.touch(stream),
        }
        Ok(())
    }

    fn machine(
        &self,
        work: impl FnOnce(&mut Machine) -> Result<(), Halt> + Send + 'static,
    ) -> Result<(), Failure> {
        Ok(self.session.board.with(work)?)
    }

    /// Power fails at some operation of the flash in an upload. Either patch is right then.
    fn cut_upload(&mut self, link: &mut Link) -> Result<(), Failure> {
        let which = self.random.random_range(0..self.patches.len());
        let patch = &self.patches[which];
        let operations = patch.len() as u64 / 8 + patch.len() as u64 / 2048;
        let after = self.random.random_range(0..operations);
        self.allowed.push(crc(patch));
        let requests = upload_requests(patch);
        let start = self.session.board.with(|machine| machine.chip(|chip| chip.flash.operations()));
        for request in requests {
            ask(link, &request)?;
            let now = self.session.board.with(|machine| machine.chip(|chip| chip.flash.operations()));
            if now - start >= after {
                break;
            }
        }
        self.session.run(Time::from_micros(self.random.random_range(0..100)))?;
        self.machine(Machine::cut_power)
    }

    /// Bits flip on their way to the board, while a host asks.
    fn disturb(&mut self, stream: &mut Subscription<'_>) -> Result<(), Failure> {
        let bytes = self.random.random_range(1..400);
        self.session.board.with(move |machine| machine.chip(|chip| chip.uart.disturb(bytes)));
        // The board hears none of this, or refuses it; a host would greet it again.
        let link = stream.link();
        while self.session.board.with(|machine| machine.chip(|chip| chip.uart.is_disturbed())) {
            let _ = link.request_within(&Request::Info, Duration::from_millis(60));
        }
        Ok(())
    }

    /// The DMA comes too late for a sample, or for a value of the current.
    fn be_late(&mut self, stream: &mut Subscription<'_>) -> Result<(), Failure> {
        let what = if self.random.random() { What::LostSample } else { What::LostValue };
        self.machine(move |machine| what.happen(machine))?;
        self.watch(stream, 4, false)
    }

    /// Electrodes come off or touch each other, lines and converters break: all is mended after a while.
    fn break_something(&mut self, stream: &mut Subscription<'_>) -> Result<(), Failure> {
        for _ in 0..self.random.random_range(1..3) {
            let electrode = self.random.random_range(0..16);
            let fault = match self.random.random_range(0..6) {
                0 => Fault::ElectrodeOpen(electrode),
                1 => Fault::PairShorted(electrode, (electrode + 1) % 16),
                2 => Fault::LineStuck { line: electrode as u8, high: self.random.random() },
                3 => Fault::DacDead,
                4 => Fault::AdcSaturated,
                _ => Fault::BadContact { electrode, ohms: 5000 },
            };
            self.session.world.inject(fault).map_err(Failure::wrong)?;
            let frames = self.random.random_range(1..8);
            self.watch(stream, frames, false)?;
        }
        self.session.world.mend();
        Ok(())
    }

    /// The skin is driven in another way.
    fn drive(&mut self, link: &mut Link) -> Result<(), Failure> {
        let Reply::Info(Info { drive: Some(usual), .. }) = ask(link, &Request::Info)? else {
            return Err(Failure::wrong("the board has no drive"));
        };
        let frequency = [12.5e3, 20e3, 50e3, 100e3][self.random.random_range(0..4)];
        let amplitude = [0.25e-3, 0.5e-3, 1e-3][self.random.random_range(0..3)];
        ask(link, &Request::Drive(Some(Drive { frequency, amplitude, ..usual })))?;
        Ok(())
    }

    /// A finger presses for a while, is found, and goes.
    fn touch(&mut self, stream: &mut Subscription<'_>) -> Result<(), Failure> {
        self.session.world.press(&[PRESS]);
        let mut found = false;
        for _ in 0..10 {
            let frame = self.next(stream)?;
            found |= frame.contacts.is_some_and(|contacts| contacts.len() == 1);
        }
        ensure(found, || "a finger is not found".to_owned())?;
        self.session.world.press(&[]);
        // The frames that the board measured before.
        for _ in 0..4 {
            self.next(stream)?;
        }
        Ok(())
    }

    /// Reads frames of a skin that nobody touches; `in_a_row` wants them right.
    fn watch(&mut self, stream: &mut Subscription<'_>, count: u32, in_a_row: bool) -> Result<(), Failure> {
        let (mut right, mut seen) = (0, 0);
        while (if in_a_row { right } else { seen }) < count {
            let frame = self.next(stream)?;
            let Some((at, contacts)) = frame.at.zip(frame.contacts) else { continue };
            let is_flagged = at.flags != FrameFlags::default();
            seen += 1;
            self.seen.frames += 1;
            if is_flagged {
                self.seen.flagged += 1;
                self.seen.marked_contacts += contacts.len() as u64;
            }
            ensure(is_flagged || contacts.is_empty(), || {
                format!("{} contacts on an untouched skin, in a frame without flags", contacts.len())
            })?;
            right = if is_flagged { 0 } else { right + 1 };
            ensure(seen < 10_000, || "frames stay flagged".to_owned())?;
        }
        Ok(())
    }

    fn next(&self, stream: &mut Subscription<'_>) -> Result<ScanFrame, Failure> {
        let end = self.now() + RECOVERY;
        loop {
            match stream.next(SILENCE)? {
                Some(frame) => return Ok(frame),
                None if self.now() < end => {}
                None => return Err(Failure::wrong(format!("no frame within {RECOVERY}"))),
            }
        }
    }

    /// The board is right again, in time.
    fn recover(&mut self, trial: Option<Trial>) -> Result<(), Failure> {
        let start = self.now();
        self.wait_for_reply()?;
        // A link waits for two seconds by the clock on the wall, in which this machine may get nothing done.
        while let Err(failure) = self.is_right() {
            ensure(matches!(failure, Failure::Link(_)) && self.now().since(start) <= RECOVERY, || {
                failure.to_string()
            })?;
        }
        let took = self.now().since(start);
        ensure(took <= RECOVERY, || format!("it was right again after {took} only"))?;
        if trial.is_some() && took.seconds() > self.seen.slowest.0 {
            self.seen.slowest = (took.seconds(), trial);
        }
        Ok(())
    }

    /// Greets the board until it replies. A [`Link`] would wait by the clock on the wall, in which a board that does
    /// nothing passes minutes.
    fn wait_for_reply(&self) -> Result<(), Failure> {
        let hello = RequestPacket { sequence: 1, request: Request::Hello(Version::current()) };
        let mut buffer = [0; MAX_PACKET_BYTES];
        let packet = encode(&hello, &mut buffer).map_err(Failure::wrong)?;
        let (end, mut reader) = (self.now() + RECOVERY, PacketReader::default());
        while self.now() < end {
            self.session.board.send(Symbol::undamaged(&[0]));
            self.session.board.send(Symbol::undamaged(packet));
            for byte in self.session.board.receive(Time::from_millis(20))? {
                if let Some(Ok(BoardPacket::Reply { sequence: 1, .. })) = reader.push(byte) {
                    return Ok(());
                }
            }
        }
        Err(Failure::wrong(format!("the board does not reply within {RECOVERY}")))
    }

    fn is_right(&mut self) -> Result<(), Failure> {
        let mut link = self.session.reconnect()?;
        let held = link.info()?.patch.map(|patch| patch.crc);
        let allowed = &mut self.allowed;
        ensure(held.is_some_and(|crc| allowed.contains(&crc)), || {
            format!("it holds {held:x?}, not one of {allowed:x?}")
        })?;
        *allowed = held.into_iter().collect();
        let mut stream = link.subscribe(WATCHED)?;
        self.watch(&mut stream, RIGHT_FRAMES, true)
    }
}

fn change(skin: &mut Skin, which: usize) {
    skin.image = ImageLayout::Grid { columns: COLUMNS[which] };
    skin.drive.frame_rate = FRAME_RATES[which];
}

fn patch(skin: &Skin, which: usize) -> Result<Vec<u8>, Failure> {
    let mut skin = skin.clone();
    change(&mut skin, which);
    let model = Model::build(&skin, |_| ()).map_err(Failure::wrong)?;
    quantize::patch(&skin, &model).map_err(Failure::wrong)
}

fn crc(patch: &[u8]) -> u32 {
    PatchView::open(patch).map_or(0, |view| view.crc())
}

/// Asks a board that is there, however slow this machine is.
fn ask(link: &mut Link, request: &Request) -> Result<Reply, Failure> {
    Ok(link.request_within(request, TIMEOUT)?)
}

fn upload_requests(patch: &[u8]) -> impl Iterator<Item = Request> {
    let begin = Request::BeginUpload { length: patch.len() as u32, crc: crc(patch) };
    let chunks = patch.chunks(MAX_CHUNK_BYTES).enumerate().map(|(place, piece)| Request::UploadChunk {
        offset: (place * MAX_CHUNK_BYTES) as u32,
        bytes: heapless::Vec::from_slice(piece).unwrap_or_default(),
    });
    std::iter::once(begin).chain(chunks).chain([Request::CommitUpload])
}
