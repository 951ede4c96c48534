//! Port: the serial port that the host's driver makes of the device (cdc_acm), and the program that has it open.

use super::control::Request;
use crate::chip::time::Time;
use std::collections::VecDeque;

/// Bytes of a bulk packet.
pub(super) const PACKET: usize = 64;
/// Bytes that the driver asks for at once: they reach the program when they are all there, or a short packet ends them.
const READ_AT_ONCE: usize = 2 * PACKET;

/// The port, and both of its endpoints.
#[derive(Clone, Debug, Default)]
pub(super) struct Port {
    pub(super) is_open: bool,
    /// Whether the program has the driver read.
    pub(super) reads: bool,
    pub(super) to_board: VecDeque<u8>,
    pub(super) out_toggle: bool,
    pub(super) in_toggle: bool,
    /// What has come of what the driver asked for.
    coming: Vec<u8>,
    came: Vec<(Time, u8)>,
    /// Packets that were taken for ones that had come before.
    pub(super) repeated: usize,
}

impl Port {
    /// As after the device was configured.
    pub(super) fn begin(&mut self) {
        *self = Self { came: std::mem::take(&mut self.came), repeated: self.repeated, ..Self::default() };
    }

    /// A program opens it: DTR and RTS.
    pub(super) fn open(&mut self) -> [Request; 2] {
        (self.is_open, self.reads) = (true, true);
        self.came.clear();
        let coding = [0x00, 0xC2, 0x01, 0x00, 0, 0, 8];
        [Request::new(0x21, 0x22, 3, 0, 0), Request::with(0x21, 0x20, 0, 0, &coding)]
    }

    /// It closes it, and what it has written and not read is gone.
    pub(super) fn close(&mut self) -> Request {
        (self.is_open, self.reads) = (false, false);
        self.to_board.clear();
        self.coming.clear();
        self.came.clear();
        Request::new(0x21, 0x22, 0, 0, 0)
    }

    pub(super) fn wants_packet(&self) -> bool {
        self.is_open && self.reads
    }

    /// The next packet to the board.
    pub(super) fn packet(&self) -> Vec<u8> {
        self.to_board.iter().copied().take(PACKET).collect()
    }

    pub(super) fn packet_taken(&mut self) {
        let length = self.to_board.len().min(PACKET);
        self.to_board.drain(..length);
        self.out_toggle = !self.out_toggle;
    }

    /// A packet has come; one of the wrong toggle is dropped.
    pub(super) fn take(&mut self, toggle: bool, bytes: &[u8], now: Time) -> bool {
        if toggle != self.in_toggle {
            self.repeated += 1;
            return false;
        }
        self.in_toggle = !toggle;
        self.coming.extend_from_slice(bytes);
        if bytes.len() < PACKET || self.coming.len() == READ_AT_ONCE {
            self.came.extend(self.coming.drain(..).map(|byte| (now, byte)));
        }
        true
    }

    pub(super) fn take_came(&mut self) -> Vec<(Time, u8)> {
        std::mem::take(&mut self.came)
    }

    pub(super) fn has_come(&self) -> bool {
        !self.came.is_empty()
    }
}
