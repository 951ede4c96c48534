//! Turns that come when a board's CPU stands still or has something else to do.

use super::{checked_clean, millis};
use crate::{
    bus::{Line, master::Turn},
    cases::{Failure, ensure},
    chip::time::Time,
    machine::Halt,
    rig::Rig,
};
use dermatome_shared::protocol::{self, MAX_PACKET_BYTES, Request, RequestPacket, Version, bus::Mark};

pub(super) fn stands_still(rig: &Rig) -> Result<String, Failure> {
    const STANDS: u64 = 60;
    let stands = |step| Time::from_micros(250 * step);
    let bus = rig.bus().start(&[0, 1], &rig.bus().flash())?;
    let mut answered = Vec::new();
    for step in 0..STANDS {
        let stands = stands(step);
        bus.with(Line::take_record);
        bus.with(move |line| {
            // Some time after the line was looked at last, another one each time.
            line.run_until(line.now() + Time::from_micros(1000 + 130 * step))?;
            line.stop_cpu(0, stands);
            line.say(&[&[0][..], &Mark::Turn.block(0)].concat());
            line.run_until(line.host_free() + Time::from_millis(11))?;
            line.say(&[&[0][..], &Mark::Turn.block(1)].concat());
            line.run_until(line.host_free() + Time::from_millis(11))
        })?;
        let findings = checked_clean(&bus, &[0, 1])?;
        ensure(findings.turns == 2, || format!("{} turns", findings.turns))?;
        if findings.latencies.len() == 2 {
            answered.push(stands);
        }
    }
    let lapsed = |stands: &Time| !answered.contains(stands);
    let shortest_lapsed = (0..STANDS).map(stands).find(lapsed).unwrap_or(Time::NEVER);
    let longest_answered = answered.last().copied().unwrap_or_default();
    ensure(shortest_lapsed > Time::from_millis(5), || {
        format!("a turn lapses where the CPU stands for {shortest_lapsed}")
    })?;
    ensure(longest_answered < Time::from_millis(10), || {
        format!("a turn is answered where the CPU stands for {longest_answered}")
    })?;
    let [longest, shortest] = [longest_answered, shortest_lapsed].map(millis);
    Ok(format!("answered where it stands for up to {longest:.2} ms, lapsed from {shortest:.2} on"))
}

pub(super) fn follows_at_once(rig: &Rig) -> Result<String, Failure> {
    // More zero bytes make a turn begin at another time of a slice.
    const ZEROS: usize = 8;
    const STANDS: Time = Time::from_micros(400);
    let give = |line: &mut Line, zeros: usize, stands_from: Option<usize>| {
        let block = [&vec![0; zeros][..], &Mark::Turn.block(0)].concat();
        Turn::give(line, 0, &block, |line, slice| {
            if stands_from == Some(slice) {
                line.stop_cpu(0, STANDS);
            }
        })
    };
    let bus = rig.bus().start(&[0], &rig.bus().flash())?;
    let hello = RequestPacket { sequence: 1, request: Request::Hello(Version::current()) };
    let mut room = [0; MAX_PACKET_BYTES];
    let hello = protocol::encode(&hello, &mut room).map_err(Failure::wrong)?;
    let ask = [&[0][..], &Mark::Request.head(0), hello].concat();
    // A turn with a reply, perhaps one in which the CPU stands, and one after it.
    let turns = |zeros, stands_from| {
        let ask = ask.clone();
        bus.with(move |line| {
            line.say(&ask);
            line.run_until(line.host_free() + Time::from_millis(3))?;
            let both = (give(line, zeros, stands_from)?, give(line, 1, None)?);
            // Its driver goes off.
            line.run_until(line.now() + Time::from_millis(1))?;
            Ok::<_, Halt>(both)
        })
    };
    bus.with(Line::take_record);
    let mut latencies = Vec::new();
    for hears_itself in [false, true] {
        bus.with(move |line| line.let_hear_itself(0, hears_itself));
        for zeros in 1..=ZEROS {
            let slices = turns(zeros, None)?.0.slices;
            for from in slices.saturating_sub(6)..slices {
                let (first, second) = turns(zeros, Some(from))?;
                ensure(!first.heard.is_empty() && first.ended && second.ended, || {
                    format!(
                        "no reply or no end: of {slices} slices the CPU stands from {from} on, {zeros} zeros"
                    )
                })?;
            }
            latencies.extend(checked_clean(&bus, &[0])?.latencies);
        }
    }
    let waited = latencies.iter().filter(|&&latency| latency > Time::from_micros(100)).count();
    ensure(waited >= ZEROS, || format!("{waited} turns came while the CPU stood still"))?;
    Ok(format!("{waited} turns came while the CPU stood still"))
}

/// Of what comes in one read: 128 bytes, the last of them those of a turn.
pub(super) fn fills_a_read(rig: &Rig) -> Result<String, Failure> {
    let bus = rig.bus().start(&[0], &rig.bus().flash())?;
    let turn = [&[0; 125][..], &Mark::Turn.block(0)].concat();
    for (block, answers) in [(turn.clone(), true), ([turn, Mark::Turn.block(1).to_vec()].concat(), false)] {
        bus.with(Line::take_record);
        let ended = bus.with(move |line| {
            let turn = Turn::give(line, 0, &block, |line, slice| {
                if slice == 0 {
                    line.stop_cpu(0, Time::from_millis(2));
                }
            })?;
            // What it says where it should not.
            line.run_until(line.now() + Time::from_millis(3))?;
            Ok::<_, Halt>(turn.ended)
        })?;
        ensure(ended == answers, || format!("answered: {ended}, and not {answers}"))?;
        checked_clean(&bus, &[0])?;
    }
    Ok("answered where it was the last, lapsed where another board's came after it".to_owned())
}
