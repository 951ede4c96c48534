//! How fast the board is, and what it takes of the chip. All in virtual time, which the core's cycles make.

use super::{
    super::{Failure, ensure_complete},
    ensure, next_with,
    session::{Session, stamps, tare},
    traced::{packets, scan_ends, taken},
};
use crate::{
    chip::{RAM_START, time::Time},
    rig::Rig,
};
use dermatome::{
    link::{Link, Subscription},
    simulate::Press,
    skin::{FoundIn, ImageLayout, Reciprocal, Skin},
};
use dermatome_shared::{
    health::Vitals,
    protocol::{BoardPacket, Event, Selection},
};
use std::ops::Range;

/// Contacts alone, as robots take them.
const CONTACTS: Selection =
    Selection { images: 0, contacts: 1, measurements: 0, health: 0, scope: 0, scope_slot: 0 };
/// A press, so that there is a contact to find: a wide one, which may be two.
const PRESS: Press = Press::finger([0.03, 0.02], 0.025, 0.6);
/// Three at once, which take longer to tell apart.
const THREE: [Press; 3] =
    [PRESS, Press::finger([-0.05, 0.03], 0.02, 0.6), Press::finger([0.0, -0.06], 0.02, 0.6)];
/// Two that go round the middle, m from it, by so many radians a frame: at 400 frames a second 0.25 m/s.
const ROUND: f64 = 0.05;
const TURN: f64 = 0.012;
/// Settling of both patterns, s.
const SETTLING: f64 = 10e-6;
/// Columns of pixels across the skin. The data of 16 electrodes tell some 80 things apart; 256 pixels find contacts as
/// well as 812 do, and a third of the products leaves time for everything else at these rates.
const COLUMNS: u8 = 18;
/// Temperatures of the emulated chip, degrees Celsius.
const ROOM: Range<f32> = 15.0..50.0;
/// In this time the board looks at all of its stack.
const STACK_LOOKS: Time = Time::from_millis(3000);
/// Static memory with the stack that the firmware may take, of 128 KiB.
const LIMIT: usize = 121 * 1024;
/// By how much of time the board may be wrong in what it says of its load: it looks five times a second.
const LOAD_ERROR: f64 = 0.03;
/// So many loads of the board's are averaged.
const LOADS: u32 = 6;
/// Frames in which presses come and what follows settles.
const COMES: usize = 60;
/// Frames over which rate and load are measured then.
const WATCHED: u32 = 200;
/// By this share a finger stretches the skin.
const STRETCH: f64 = 0.01;
/// Flash that it may take, of 140 KiB: other compilers take some more.
const FLASH_LIMIT: usize = 140 * 1024 - 512;

/// How a skin is measured, and how fast it has to be.
struct Speed {
    reciprocal: Reciprocal,
    /// Carrier frequency, Hz.
    frequency: f64,
    /// Time to settle, s.
    settling: f64,
    contacts_found_in: FoundIn,
    /// Every how many frames there is an image; 0 without.
    images: u16,
    /// Least frames a second.
    least: f64,
    /// Largest share of time in which the CPU works.
    most_load: f64,
    /// Longest time from the last sample of a frame to the first byte of its contacts, s: of one, and of three.
    longest_latency: [f64; 2],
}

/// 10 us would be half a period; a quarter is enough for what the carrier settles to.
const MEASURED_TWICE: Speed = Speed {
    reciprocal: Reciprocal::Combined,
    frequency: 50e3,
    settling: SETTLING / 2.0,
    contacts_found_in: FoundIn::Image,
    images: 0,
    least: 150.0,
    most_load: 0.6,
    longest_latency: [1.25e-3, 1.5e-3],
};
const MEASURED_ONCE: Speed = Speed {
    reciprocal: Reciprocal::Once,
    frequency: 100e3,
    settling: SETTLING,
    least: 400.0,
    most_load: 0.65,
    ..MEASURED_TWICE
};
/// With as many images as a screen shows.
const IN_VOLTAGES: Speed = Speed {
    contacts_found_in: FoundIn::Voltages,
    images: 8,
    most_load: 0.75,
    longest_latency: [4e-3, 15e-3],
    ..MEASURED_ONCE
};

pub(super) fn measured_twice(rig: &Rig) -> Result<String, Failure> {
    measure(rig, &MEASURED_TWICE)
}

pub(super) fn measured_once(rig: &Rig) -> Result<String, Failure> {
    measure(rig, &MEASURED_ONCE)
}

pub(super) fn in_voltages(rig: &Rig) -> Result<String, Failure> {
    measure(rig, &IN_VOLTAGES)
}

fn measure(rig: &Rig, speed: &Speed) -> Result<String, Failure> {
    let (session, mut link) = Session::open(rig, |skin| {
        skin.drive.reciprocal = speed.reciprocal;
        skin.drive.frequency = speed.frequency;
        skin.drive.settling = speed.settling * speed.frequency;
        skin.contacts_found_in = speed.contacts_found_in;
        skin.drive.frame_rate = 10_000.0;
        skin.image = ImageLayout::Grid { columns: COLUMNS };
    })?;
    tare(&mut link, 20)?;
    let mut stream = link.subscribe(Selection { images: speed.images, ..CONTACTS })?;
    let mut watched = Vec::new();
    let mut latencies = Vec::new();
    for (name, presses, longest) in [
        ("untouched", &[][..], None),
        ("pressed once", &[PRESS][..], Some(speed.longest_latency[0])),
        ("three times", &THREE[..], Some(speed.longest_latency[1])),
        ("twice", &THREE[..2], None),
    ] {
        drop(taken(&session));
        session.world.press(presses);
        stamps(&mut stream, COMES)?;
        watched.push((name, watch(&session, &mut stream, |_| {})?));
        let Some(longest) = longest else { continue };
        let latency = latency(&session, stream.link())?;
        ensure(latency <= longest, || {
            format!("{name}: {:.3} ms from the last sample to the contacts", 1e3 * latency)
        })?;
        latencies.push(1e3 * latency);
    }
    let moved = watch(&session, &mut stream, |frame| {
        let (y, x) = (TURN * f64::from(frame)).sin_cos();
        let at = |away: f64| Press::finger([away * x, away * y], 0.02, 0.6);
        session.world.press(&[at(ROUND), at(-ROUND)]);
    })?;
    watched.push(("by two that move", moved));
    session.world.press(&[PRESS]);
    session.world.stretch(STRETCH).map_err(Failure::wrong)?;
    watched.push(("stretched as well", watch(&session, &mut stream, |_| {})?));
    let said =
        watched.iter().map(|(name, (rate, load))| format!("{name} {rate:.1} and {:.1} %", 100.0 * load));
    let said = format!("frames a second and CPU load: {}", said.collect::<Vec<_>>().join(", "));
    let is_met = |(rate, load): &(f64, f64)| *rate >= speed.least && *load <= speed.most_load;
    ensure(watched.iter().all(|(_, watched)| is_met(watched)), || said.clone())?;
    session.world.press(&[PRESS]);
    stream.stop()?;
    check_vitals(&session, &mut link, speed.images)?;
    let pixels = session.patch().header.pixels;
    Ok(format!(
        "{pixels} pixels and contacts; {said}; last sample to one contact at \
         most {:.2} ms, to three {:.2} ms",
        latencies[0], latencies[1]
    ))
}

/// Frames a second, and the CPU's load, while frames with contacts come, before each of which something may happen.
fn watch(
    session: &Session,
    stream: &mut Subscription<'_>,
    mut before_each: impl FnMut(u32),
) -> Result<(f64, f64), Failure> {
    let start = stamps(stream, 1)?[0];
    let before = clocks(session);
    let mut end = start;
    for frame in 0..WATCHED {
        before_each(frame);
        end = stamps(stream, 1)?[0];
    }
    let load = load_since(session, before);
    ensure_complete(stream)?;
    let frames = end.sequence - start.sequence;
    Ok((f64::from(frames) / ((end.timestamp_us - start.timestamp_us) as f64 * 1e-6), load))
}

/// Holds what the board says of itself against what it is, while its stream, with so many images, goes on.
fn check_vitals(session: &Session, link: &mut Link, images: u16) -> Result<(), Failure> {
    let mut stream = link.subscribe(Selection { health: 100, images, ..CONTACTS })?;
    session.run(Time::from_millis(500))?;
    let mut next = || -> Result<Vitals, Failure> {
        let (_, report) = next_with(&mut stream, |frame| frame.health)?;
        let warm = report.vitals.temperature.is_some_and(|celsius| ROOM.contains(&celsius));
        ensure(warm, || format!("the chip is said to be at {:?} degrees", report.vitals.temperature))?;
        Ok(report.vitals)
    };
    // Those that were sent meanwhile.
    for _ in 0..2 {
        next()?;
    }
    let before = clocks(session);
    let mut said = 0.0;
    for _ in 0..LOADS {
        said += f64::from(next()?.load) / f64::from(LOADS);
    }
    let load = load_since(session, before);
    stream.stop()?;
    ensure((said - load).abs() <= LOAD_ERROR, || {
        format!("the board says a load of {:.1} %, it is {:.1} %", 100.0 * said, 100.0 * load)
    })
}

/// The board's time, and how long its CPU has slept.
fn clocks(session: &Session) -> [Time; 2] {
    session.board.with(|machine| [machine.now(), machine.slept()])
}

/// Share of the time since then in which the CPU worked.
fn load_since(session: &Session, before: [Time; 2]) -> f64 {
    let [now, slept] = clocks(session);
    1.0 - slept.since(before[1]).seconds() / now.since(before[0]).seconds()
}

/// Longest time from the last sample of a frame to the first byte of its contacts on the line.
fn latency(session: &Session, link: &mut Link) -> Result<f64, Failure> {
    let events = taken(session);
    let ends = scan_ends(session, &events);
    let started = session.started(link)?;
    let mut longest: f64 = 0.0;
    for (sent, packet) in packets(&events) {
        let BoardPacket::Event { event: Event::Contacts { at, .. }, .. } = packet else { continue };
        let taken = at.timestamp_us as f64 * 1e-6 + started;
        let near = |end: &&f64| (**end - taken).abs();
        let Some(end) = ends.iter().min_by(|a, b| near(a).total_cmp(&near(b))) else { continue };
        longest = longest.max(sent.seconds() - end);
    }
    ensure(longest > 0.0, || "no contacts were sent".to_owned())?;
    Ok(longest)
}

/// Uses everything once, and measures what is left.
pub(super) fn memory(rig: &Rig) -> Result<String, Failure> {
    let firmware = &rig.emulated_rig().firmware;
    let in_voltages = |skin: &mut Skin| skin.contacts_found_in = FoundIn::Voltages;
    let (session, mut link) = Session::open(rig, in_voltages)?;
    tare(&mut link, 20)?;
    // A finger that moves electrodes takes the longest way.
    session.world.press(&[PRESS]);
    session.world.stretch(STRETCH).map_err(Failure::wrong)?;
    let mut stream = link.subscribe(CONTACTS)?;
    stamps(&mut stream, 50)?;
    stream.stop()?;
    session.world.press(&THREE);
    let all = Selection { images: 1, contacts: 1, measurements: 1, health: 1, scope: 1, scope_slot: 3 };
    let mut stream = link.subscribe(all)?;
    stamps(&mut stream, 50)?;
    stream.stop()?;
    // The board looks at a part of its stack at a time.
    session.run(STACK_LOOKS)?;
    let mut stream = link.subscribe(Selection { health: 1, ..CONTACTS })?;
    let (_, report) = next_with(&mut stream, |frame| frame.health)?;
    let free = report.vitals.free_stack as usize;
    let symbol = |name| firmware.symbol(name).ok_or_else(|| Failure::wrong(format!("no symbol `{name}`")));
    // The stack ends where the memory begins, so that an overflow faults; statics lie behind it.
    let [bottom, top, end] = [symbol("_stack_end")?, symbol("_stack_start")?, symbol("__euninit")?];
    ensure(bottom == u64::from(RAM_START), || {
        format!("the stack ends at {bottom:#x}, not where RAM begins")
    })?;
    let (flash, stack, statics) = (firmware.size(), (top - bottom) as usize, (end - top) as usize);
    let used = statics + stack - free;
    ensure(flash <= FLASH_LIMIT, || format!("{flash} bytes of flash"))?;
    ensure(used <= LIMIT, || format!("{used} bytes of memory, {statics} of them static"))?;
    ensure(free * 4 >= stack, || format!("{free} of {stack} bytes of stack are free"))?;
    Ok(format!(
        "flash {flash} bytes; static {statics} and stack {} of {stack} bytes, {:.0} % of it free; limits {FLASH_LIMIT} and {LIMIT}",
        stack - free,
        100.0 * free as f64 / stack as f64
    ))
}
