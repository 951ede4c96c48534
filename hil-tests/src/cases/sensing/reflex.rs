//! Reflexes: pins that fall when a skin is pressed, with no host, and how soon after the end of a scan.

use super::{
    super::Failure,
    ensure, next_with,
    session::{Session, stamps, tare},
    traced::{packets, scan_ends, taken},
};
use crate::{
    chip::{time::Time, trace::Event as TraceEvent},
    fault::What,
    rig::Rig,
    world::Fault,
};
use dermatome::{
    simulate::Press,
    skin::{ImageLayout, Reciprocal, Reflex, Region},
};
use dermatome_shared::{
    patch::reflexes::Limit,
    pipeline::reflex::Reflexes,
    protocol::{BoardPacket, Event, Selection},
};
use nalgebra::Point3;

/// Longest time from the last sample of a scan to a pin that falls, s.
const LONGEST: f64 = 1e-3;
/// In this time the board makes its reference by itself; a press comes, and is gone again.
const BEGINS: Time = Time::from_millis(400);
const PRESSED: Time = Time::from_millis(40);
const LIFTED: Time = Time::from_millis(160);
/// Where fingers press, m: under the first rule all of them, under the second the last two.
const PLACES: [[f64; 2]; 6] =
    [[0.0, 0.0], [-0.06, 0.03], [0.01, -0.07], [-0.03, -0.05], [0.05, 0.02], [0.06, -0.01]];
const SECOND: usize = 4;

/// A rule well above noise, which is some 0.15 in its worst cell, that trips after so many frames and holds for no time.
fn rule(name: &str, pin: u8, frames: u8, region: Region) -> Reflex {
    Reflex {
        name: name.to_owned(),
        pin,
        limit: Limit::Strength(0.8),
        region,
        release: 0.8,
        frames,
        hold: 0.0,
        trips_blind: true,
    }
}

fn finger([x, y]: [f64; 2]) -> Press {
    Press::finger([x, y], 0.016, 0.8)
}

/// Levels of the first two reflex pins through time.
fn pins(events: &[(Time, TraceEvent)]) -> Vec<(f64, [bool; 2])> {
    let of = |(time, event): &(Time, TraceEvent)| match event {
        TraceEvent::Pins { port: 'C', levels } => {
            Some((time.seconds(), [0, 1].map(|pin| levels >> pin & 1 == 1)))
        }
        _ => None,
    };
    events.iter().filter_map(of).collect()
}

/// What the board said of its reflexes.
fn told(events: &[(Time, TraceEvent)]) -> Vec<Reflexes> {
    let of = |(_, packet)| match packet {
        BoardPacket::Event { event: Event::Reflexes { reflexes, .. }, .. } => Some(reflexes),
        _ => None,
    };
    packets(events).into_iter().filter_map(of).collect()
}

/// Virtual time, s.
fn now(session: &Session) -> f64 {
    session.board.with(|machine| machine.now()).seconds()
}

/// Whether the pins fell that had to, pressed then, s, and how long after the end of a scan the first fall of each was, s.
fn falls(session: &Session, before: &mut [bool; 2], place: usize, pressed: f64) -> Result<f64, Failure> {
    let events = taken(session);
    let ends = scan_ends(session, &events);
    let mut fallen = [None; 2];
    for (time, levels) in pins(&events) {
        for pin in 0..2 {
            if before[pin] && !levels[pin] && fallen[pin].is_none() {
                fallen[pin] = Some(time);
            }
        }
        *before = levels;
    }
    let wanted = [true, place >= SECOND];
    ensure(fallen.map(|time| time.is_some()) == wanted, || {
        let told = told(&events);
        format!(
            "pressed at {:?} m pins fell: {fallen:?}, wanted: {wanted:?}; the board said {told:?}",
            PLACES[place]
        )
    })?;
    // The scan that it comes in may not show a press yet; and the second rule waits for one more.
    for (time, scans) in fallen.into_iter().zip([2, 3]) {
        let seen = ends.iter().copied().filter(|&end| end > pressed).nth(scans - 1);
        let is_late = time.zip(seen).is_some_and(|(time, seen)| time > seen + LONGEST);
        ensure(!is_late, || {
            format!("pressed at {pressed} s a pin falls at {time:?} s, later than {scans} scans: {ends:?}")
        })?;
    }
    let late = |time: f64| {
        let end = ends.iter().copied().filter(|&end| end <= time).fold(f64::NEG_INFINITY, f64::max);
        time - end
    };
    Ok(fallen.into_iter().flatten().map(late).fold(0.0, f64::max))
}

pub(super) fn falls_in_time(rig: &Rig) -> Result<String, Failure> {
    let (session, mut link) = Session::open(rig, |skin| {
        skin.drive.reciprocal = Reciprocal::Once;
        skin.drive.frequency = 100e3;
        skin.drive.settling = 1.0;
        skin.drive.frame_rate = 10_000.0;
        skin.image = ImageLayout::Grid { columns: 18 };
        // What comes or goes within a scan is another press in that frame.
        let second = Region::Around { centre: Point3::new(0.055, 0.005, 0.0), radius: 0.03 };
        skin.reflexes = vec![rule("all", 1, 1, Region::Whole), rule("right", 2, 2, second)];
    })?;
    session.run(BEGINS)?;
    let mut levels = pins(&taken(&session)).last().map_or([false; 2], |(_, levels)| *levels);
    ensure(levels == [true; 2], || format!("untouched, with no host, the pins are {levels:?}"))?;
    let alone = pressed_everywhere(&session, &mut levels)?;
    // With all that else takes time: images, and contacts that are looked for.
    tare(&mut link, 20)?;
    let mut stream = link.subscribe(Selection { images: 8, contacts: 1, ..Selection::default() })?;
    stamps(&mut stream, 20)?;
    levels = pins(&taken(&session)).last().map_or(levels, |(_, levels)| *levels);
    ensure(levels == [true; 2], || format!("untouched, with a host, the pins are {levels:?}"))?;
    let mut streamed: f64 = 0.0;
    for (place, at) in PLACES.into_iter().enumerate() {
        let pressed = now(&session);
        session.world.press(&[finger(at), finger([-0.04, 0.06]), finger([-0.05, -0.03])]);
        stamps(&mut stream, 12)?;
        session.world.press(&[]);
        stamps(&mut stream, 60)?;
        streamed = streamed.max(falls(&session, &mut levels, place, pressed)?);
    }
    session.world.press(&[finger(PLACES[0])]);
    let (_, told) = next_with(&mut stream, |frame| frame.reflexes.filter(|told| told.tripped == 1))?;
    ensure(!told.is_blind, || "a press is said to blind".to_owned())?;
    session.world.press(&[]);
    stamps(&mut stream, 60)?;
    let blind = blinded(&session, &mut levels)?;
    ensure(alone.max(streamed) <= LONGEST, || {
        format!("a pin falls {:.3} ms after the end of a scan", 1e3 * alone.max(streamed))
    })?;
    Ok(format!(
        "a pin falls at most {:.3} ms after the last sample of a scan with no host, {:.3} ms under three fingers with contacts \
         and images; {blind}",
        1e3 * alone,
        1e3 * streamed
    ))
}

/// Presses at each place in turn, with nobody who asks for frames.
fn pressed_everywhere(session: &Session, levels: &mut [bool; 2]) -> Result<f64, Failure> {
    let mut latest: f64 = 0.0;
    for (place, at) in PLACES.into_iter().enumerate() {
        let pressed = now(session);
        session.world.press(&[finger(at)]);
        session.run(PRESSED)?;
        session.world.press(&[]);
        session.run(LIFTED)?;
        latest = latest.max(falls(session, levels, place, pressed)?);
        ensure(*levels == [true; 2], || format!("after the press at {at:?} m the pins are {levels:?}"))?;
    }
    Ok(latest)
}

/// What breaks lets the pins fall, and so does a core that hangs: how long that takes. The electrode comes last: once it is
/// mended the reference is that of one frame, and pins may stay low.
fn blinded(session: &Session, levels: &mut [bool; 2]) -> Result<String, Failure> {
    let mut said = Vec::new();
    for fault in [Fault::DacDead, Fault::AdcSaturated, Fault::ElectrodeOpen(3)] {
        *levels = pins(&taken(session)).last().map_or(*levels, |(_, levels)| *levels);
        ensure(*levels == [true; 2], || format!("before `{fault}` the pins are {levels:?}"))?;
        let begun = now(session);
        session.world.inject(fault).map_err(Failure::wrong)?;
        session.run(PRESSED)?;
        let fallen = pins(&taken(session)).into_iter().find(|(_, levels)| *levels == [false; 2]);
        let (time, _) = fallen.ok_or_else(|| Failure::wrong(format!("`{fault}` lets no pin fall")))?;
        said.push(format!("{:.1} ms after `{fault}`", 1e3 * (time - begun)));
        session.world.mend();
        session.run(BEGINS)?;
    }
    let begun = now(session);
    session.board.with(|machine| What::Hang.happen(machine))?;
    session.run(Time::from_millis(1500))?;
    let events = taken(session);
    let reset = events.iter().find(|(_, event)| matches!(event, TraceEvent::Reset(_)));
    let (time, _) = reset.ok_or_else(|| Failure::wrong("a core that hangs is not reset"))?;
    let after = pins(&events).into_iter().find(|(at, _)| *at >= time.seconds());
    ensure(after.is_some_and(|(_, levels)| levels == [false; 2]), || {
        format!("a reset leaves the pins at {after:?}")
    })?;
    said.push(format!("{:.0} ms after the core hangs", 1e3 * (time.seconds() - begun)));
    Ok(format!("both fall {}", said.join(", ")))
}
