//! Faults of electrodes, multiplexers, current and converter: what the board says of them, and how soon.

use super::{
    super::Failure,
    ensure, next_with,
    session::{Session, tare},
};
use crate::{chip::time::Time, fault::What, rig::Rig, world::Fault};
use dermatome::link::{Link, Subscription};
use dermatome_shared::{
    frame::FrameFlags,
    health::Health,
    protocol::{FrameStamp, Selection},
};

/// Frames within which a fault has to be flagged.
const FRAMES: f64 = 2.0;
/// By how much a contact becomes worse, ohm.
const WORSE: [u32; 2] = [100, 500];
/// At this amplitude, A, no electrode's test comes to the end of its range: clipped ones cannot tell that they grow.
const UNCLIPPED: f64 = 0.25e-3;
/// Flags that say that something is broken.
const BROKEN: FrameFlags = FrameFlags(
    FrameFlags::SATURATED.0
        | FrameFlags::OPEN_ELECTRODE.0
        | FrameFlags::SHORTED_ELECTRODE.0
        | FrameFlags::NO_CURRENT.0
        | FrameFlags::NOT_RECIPROCAL.0
        | FrameFlags::IMPLAUSIBLE.0
        | FrameFlags::WORSE_CONTACT.0,
);

pub(super) fn all(rig: &Rig) -> Result<String, Failure> {
    let slowest = slowest_flagged(rig, &every(), 1e-3)?.max(slowest_flagged(rig, &worse(), UNCLIPPED)?);
    Ok(format!(
        "16 electrodes open, 16 shorted, 32 stuck lines, no current, saturated; at a current that clips no test 32 contacts \
         worse: the slowest flagged after {slowest:.2} frames; no contact while an electrode was faulty, or just mended"
    ))
}

/// Frames until the slowest of these faults is flagged, at this amplitude, A; all have to be in time.
fn slowest_flagged(rig: &Rig, faults: &[Fault], amplitude: f64) -> Result<f64, Failure> {
    let (session, mut link) = Session::open(rig, |skin| {
        (skin.drive.frame_rate, skin.drive.amplitude) = (10_000.0, amplitude);
    })?;
    tare(&mut link, 20)?;
    let mut stream = link.subscribe(Selection { health: 1, contacts: 1, ..Selection::default() })?;
    let [first, second] = [next_health(&mut stream)?.0, next_health(&mut stream)?.0];
    let period = (second.timestamp_us - first.timestamp_us) as f64 * 1e-6;
    let (mut slowest, mut missed) = (0.0_f64, Vec::new());
    for &fault in faults {
        let flagged = flagged(&session, &mut stream, fault, period);
        match flagged.map_err(|failure| told(stream.link(), fault, &failure))? {
            Some(frames) => slowest = slowest.max(frames),
            None => missed.push(fault.to_string()),
        }
    }
    let count = faults.len();
    ensure(missed.is_empty(), || format!("{} of {count} are missed: {}", missed.len(), missed.join(", ")))?;
    Ok(slowest)
}

/// Places in a frame at which the DMA comes too late, us after the frame before came.
const LATE: [u64; 6] = [0, 300, 900, 1600, 2100, 2300];

/// A sample or a value of the current is lost, at any moment: a frame is marked, and none has flags of
/// something broken or a contact.
pub(super) fn late(rig: &Rig) -> Result<String, Failure> {
    let (session, mut link) = Session::open(rig, |skin| skin.drive.frame_rate = 10_000.0)?;
    tare(&mut link, 20)?;
    let mut stream = link.subscribe(Selection { health: 1, contacts: 1, ..Selection::default() })?;
    let mut longest = 0;
    for what in [What::LostSample, What::LostValue] {
        for after in LATE {
            let before = next_health(&mut stream)?.0;
            ensure(!before.flags.contains(FrameFlags::MISSED), || "a frame is marked before".to_owned())?;
            session.run(Time::from_micros(after))?;
            session.board.with(move |machine| what.happen(machine))?;
            let mut marked = None;
            for _ in 0..12 {
                let (at, contacts) = next_with(&mut stream, |frame| frame.contacts)?;
                let is_marked = at.flags.contains(FrameFlags::MISSED);
                marked = marked.or(is_marked.then_some(at.timestamp_us - before.timestamp_us));
                let is_wrong = at.flags.intersects(BROKEN) || !contacts.is_empty();
                ensure(!is_wrong, || {
                    format!("{what}, {after} us later: {:?}, {} contacts", at.flags, contacts.len())
                })?;
            }
            let marked = marked.ok_or_else(|| Failure::wrong(format!("{what}: no frame says so")))?;
            longest = longest.max(marked);
        }
    }
    Ok(format!("{} times, a marked frame at most {:.1} ms later", 2 * LATE.len(), longest as f64 * 1e-3))
}

/// A failure with the fault that it came with, and why the board started last.
fn told(link: &mut Link, fault: Fault, failure: &Failure) -> Failure {
    let started = link.info().map(|info| info.started_after.to_string());
    let started = started.unwrap_or_else(|error| error.to_string());
    Failure::wrong(format!("with `{fault}`: {failure}; the board started after: {started}"))
}

fn every() -> Vec<Fault> {
    let open = (0..16).map(Fault::ElectrodeOpen);
    let shorted = (0..16).map(|electrode| Fault::PairShorted(electrode, (electrode + 1) % 16));
    let stuck = (0..16).flat_map(|line| [false, true].map(|high| Fault::LineStuck { line, high }));
    open.chain(shorted).chain(stuck).chain([Fault::DacDead, Fault::AdcSaturated]).collect()
}

fn worse() -> Vec<Fault> {
    let at = |ohms| (0..16).map(move |electrode| Fault::BadContact { electrode, ohms });
    WORSE.into_iter().flat_map(at).collect()
}

/// Frames that it takes until the fault is flagged, and rightly named; none if it is not in time. Mends it.
fn flagged(
    session: &Session,
    stream: &mut Subscription<'_>,
    fault: Fault,
    period: f64,
) -> Result<Option<f64>, Failure> {
    // Anywhere in a frame.
    session.run(Time::from_micros(fault_phase(fault)))?;
    session.world.inject(fault).map_err(Failure::wrong)?;
    let broken = session.board.with(|machine| machine.now()).seconds() - session.started(stream.link())?;
    let mut found = None;
    let is_of_electrodes =
        matches!(fault, Fault::ElectrodeOpen(_) | Fault::PairShorted(..) | Fault::BadContact { .. });
    let next = |stream: &mut Subscription<'_>| next_without_contacts(stream, is_of_electrodes);
    for _ in 0..6 {
        let (at, health) = next(stream)?;
        let frames = (at.timestamp_us as f64 * 1e-6 - broken) / period;
        if found.is_none() && frames > 0.0 && frames <= FRAMES + 0.3 && says(&health, at.flags, fault) {
            found = Some(frames);
        }
    }
    session.world.mend();
    // What is worse is so beside electrodes that are not masked: those of the faults before have to count again.
    let is_worse = matches!(fault, Fault::BadContact { .. });
    let lasts = if is_worse { BROKEN.union(FrameFlags::MASKED) } else { BROKEN };
    for _ in 0..if is_worse { 40 } else { 12 } {
        if !next(stream)?.0.flags.intersects(lasts) {
            return Ok(found);
        }
    }
    Err(Failure::wrong(format!("after `{fault}` is mended, frames stay flagged")))
}

/// Some time within a frame, another for each fault.
fn fault_phase(fault: Fault) -> u64 {
    let number = every().into_iter().chain(worse()).position(|known| known == fault).unwrap_or(0);
    (number as u64 * 997) % 5600
}

fn says(health: &Health, flags: FrameFlags, fault: Fault) -> bool {
    match fault {
        Fault::ElectrodeOpen(electrode) => health.open.contains(electrode as u8),
        Fault::PairShorted(a, b) => health.shorted.contains(a as u8) && health.shorted.contains(b as u8),
        Fault::DacDead => flags.contains(FrameFlags::NO_CURRENT),
        Fault::AdcSaturated => flags.contains(FrameFlags::SATURATED),
        // One that is far worse reads open.
        Fault::BadContact { electrode, .. } => health.bad_electrodes().contains(electrode as u8),
        Fault::LineStuck { .. } => flags.intersects(BROKEN),
    }
}

fn next_health(stream: &mut Subscription<'_>) -> Result<(FrameStamp, Health), Failure> {
    next_without_contacts(stream, false)
}

/// The next frame's health; it has no contacts where no current flows, or ever.
fn next_without_contacts(stream: &mut Subscription<'_>, ever: bool) -> Result<(FrameStamp, Health), Failure> {
    let mut phantoms = 0;
    let (at, report) = next_with(stream, |frame| {
        let has_no_current = frame.at.is_some_and(|at| at.flags.contains(FrameFlags::NO_CURRENT));
        phantoms += frame.contacts.filter(|_| ever || has_no_current).map_or(0, |contacts| contacts.len());
        frame.health
    })?;
    ensure(phantoms == 0, || format!("{phantoms} contacts that are none ({:?})", at.flags))?;
    Ok((at, report.health))
}
