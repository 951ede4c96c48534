//! Queue of encoded packets: bounded, and whole packets or none.

use super::{BoardPacket, PacketError, encode};
use heapless::Deque;
use serde::Serialize;

/// Packets that wait for a link, in order, `BYTES` of them at most.
///
/// A packet ends with the only zero byte it holds, so the queue is just their bytes.
#[derive(Clone, Debug, Default)]
pub struct PacketQueue<const BYTES: usize> {
    bytes: Deque<u8, BYTES>,
}

impl<const BYTES: usize> PacketQueue<BYTES> {
    /// An empty queue.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: Deque::new() }
    }

    /// Adds a message, if there is room for all of its packet; `scratch` is overwritten.
    pub fn push<T: Serialize>(&mut self, message: &T, scratch: &mut [u8]) -> Result<(), PacketError> {
        let packet = encode(message, scratch)?;
        if packet.len() > BYTES - self.bytes.len() {
            return Err(PacketError::TooLong);
        }
        // There is room for all of them.
        self.bytes.extend(packet.iter().copied());
        Ok(())
    }

    /// Moves the oldest packet to the start of `out`, which is as long as the longest one pushed; gives
    /// its length, or `None` if there is none.
    pub fn pop(&mut self, out: &mut [u8]) -> Option<usize> {
        let mut length = 0;
        while let Some(byte) = self.bytes.pop_front() {
            *out.get_mut(length)? = byte;
            length += 1;
            if byte == 0 {
                return Some(length);
            }
        }
        None
    }

    /// The same where `out` may be too short; then the packet stays.
    pub fn pop_fitting(&mut self, out: &mut [u8]) -> Option<usize> {
        let length = self.bytes.iter().position(|&byte| byte == 0)? + 1;
        if length <= out.len() { self.pop(out) } else { None }
    }

    /// Whether no packet waits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }
}

/// Events that wait for a link: those that are short and urgent go ahead of those that are long.
#[derive(Clone, Debug, Default)]
pub struct EventQueue<const URGENT: usize, const LONG: usize> {
    urgent: PacketQueue<URGENT>,
    long: PacketQueue<LONG>,
}

impl<const URGENT: usize, const LONG: usize> EventQueue<URGENT, LONG> {
    /// An empty queue.
    #[must_use]
    pub const fn new() -> Self {
        Self { urgent: PacketQueue::new(), long: PacketQueue::new() }
    }

    /// Adds a packet, if there is room for all of it; `scratch` is overwritten.
    pub fn push(&mut self, packet: &BoardPacket, scratch: &mut [u8]) -> Result<(), PacketError> {
        let is_long = matches!(packet, BoardPacket::Event { event, .. } if event.is_long());
        if is_long { self.long.push(packet, scratch) } else { self.urgent.push(packet, scratch) }
    }

    /// As [`PacketQueue::pop`].
    pub fn pop(&mut self, out: &mut [u8]) -> Option<usize> {
        self.urgent.pop(out).or_else(|| self.long.pop(out))
    }

    /// As [`PacketQueue::pop_fitting`]: a long packet does not overtake a short one that stays.
    pub fn pop_fitting(&mut self, out: &mut [u8]) -> Option<usize> {
        if self.urgent.is_empty() { self.long.pop_fitting(out) } else { self.urgent.pop_fitting(out) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::{Event, MAX_PACKET_BYTES, SlotSamples};
    use std::vec::Vec;

    fn event(number: u32) -> BoardPacket {
        BoardPacket::Event { number, event: Event::Tared { frames: 0 } }
    }

    #[test]
    fn packets_come_out_whole_and_in_order_and_a_full_queue_drops_whole_ones() {
        let (mut scratch, mut out) = ([0; MAX_PACKET_BYTES], [0; MAX_PACKET_BYTES]);
        let mut queue = PacketQueue::<100>::new();
        let mut accepted = Vec::new();
        let mut received = Vec::new();
        for number in 0..1000 {
            if queue.push(&event(number * 1000), &mut scratch).is_ok() {
                accepted.push(number * 1000);
            }
            if number % 3 == 0 {
                let length = queue.pop(&mut out).unwrap();
                received.push(super::super::decode::<BoardPacket>(&mut out[..length - 1]).unwrap());
            }
        }
        while let Some(length) = queue.pop(&mut out) {
            received.push(super::super::decode::<BoardPacket>(&mut out[..length - 1]).unwrap());
        }
        assert!(queue.is_empty());
        assert!((300..400).contains(&accepted.len()), "{}", accepted.len());
        assert_eq!(received, accepted.iter().map(|&number| event(number)).collect::<Vec<_>>());
    }

    #[test]
    fn a_packet_that_does_not_fit_stays_and_nothing_overtakes_it() {
        let (mut scratch, mut out) = ([0; MAX_PACKET_BYTES], [0; MAX_PACKET_BYTES]);
        let mut queue = EventQueue::<100, 200>::new();
        assert_eq!(queue.pop_fitting(&mut out), None);
        let scope = Event::Scope(SlotSamples::default());
        queue.push(&event(1), &mut scratch).unwrap();
        queue.push(&BoardPacket::Event { number: 0, event: scope }, &mut scratch).unwrap();
        let length = queue.clone().pop(&mut out).unwrap();
        assert_eq!(queue.pop_fitting(&mut out[..length - 1]), None);
        assert_eq!(queue.pop_fitting(&mut out[..length]), Some(length));
        let packet = super::super::decode::<BoardPacket>(&mut out[..length - 1]).unwrap();
        assert_eq!(packet, event(1));
        assert_eq!(queue.pop_fitting(&mut out[..1]), None);
        assert!(queue.pop_fitting(&mut out).is_some());
        assert_eq!(queue.pop_fitting(&mut out), None);
    }

    #[test]
    fn what_is_short_goes_ahead_of_what_is_long() {
        let (mut scratch, mut out) = ([0; MAX_PACKET_BYTES], [0; MAX_PACKET_BYTES]);
        let mut queue = EventQueue::<100, 200>::new();
        let scope = Event::Scope(SlotSamples::default());
        queue.push(&BoardPacket::Event { number: 0, event: scope.clone() }, &mut scratch).unwrap();
        queue.push(&event(1), &mut scratch).unwrap();
        let mut numbers = Vec::new();
        while let Some(length) = queue.pop(&mut out) {
            let packet = super::super::decode::<BoardPacket>(&mut out[..length - 1]).unwrap();
            let BoardPacket::Event { number, .. } = packet else { panic!("{packet:?}") };
            numbers.push(number);
        }
        assert_eq!(numbers, [1, 0]);
    }
}
