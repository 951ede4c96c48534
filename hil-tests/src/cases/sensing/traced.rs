//! Traced: what a board did, read from its trace.

use super::session::Session;
use crate::chip::{time::Time, trace::Event as TraceEvent};
use dermatome_shared::protocol::{BoardPacket, decode};

/// What happened since this was asked last.
pub(super) fn taken(session: &Session) -> Vec<(Time, TraceEvent)> {
    session.board.with(|machine| machine.chip(|chip| chip.trace.take()))
}

/// When each scan's last sample was taken, s.
pub(super) fn scan_ends(session: &Session, events: &[(Time, TraceEvent)]) -> Vec<f64> {
    let drive = &session.skin.drive;
    let slot = (drive.settling + f64::from(drive.integration)) / drive.frequency;
    // The word of the last slot goes to the multiplexers when that slot begins.
    let is_end =
        |(_, event): &&(Time, TraceEvent)| *event == TraceEvent::DmaComplete { controller: 1, channel: 4 };
    events.iter().filter(is_end).map(|(time, _)| time.seconds() + slot).collect()
}

/// What the board sent, and when the first byte of each packet left.
pub(super) fn packets(events: &[(Time, TraceEvent)]) -> Vec<(Time, BoardPacket)> {
    let mut packets = Vec::new();
    let (mut begun, mut bytes) = (None, Vec::new());
    for &(time, event) in events {
        match event {
            TraceEvent::Sent(0) => {
                let packet = decode(&mut std::mem::take(&mut bytes));
                packets.extend(begun.take().zip(packet.ok()));
            }
            TraceEvent::Sent(byte) => {
                begun = begun.or(Some(time));
                bytes.push(byte);
            }
            _ => {}
        }
    }
    packets
}
