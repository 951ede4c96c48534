//! What a device does about its patch's reflexes: it briefs whoever watches frames by them, and tells what they say.

use super::{Arrival, Device, PatchStore};
use crate::{
    frame::Frame,
    pipeline::{PipelineState, reflex::Watch},
    protocol::{BoardPacket, Event, FrameStamp},
};
use core::borrow::BorrowMut;

/// Every so many frames of a stream a host is told again.
const REMINDER: u32 = 64;

impl<S: PatchStore, P: BorrowMut<PipelineState>> Device<S, P> {
    /// Whether the patch has rules by which the board acts by itself.
    pub fn has_reflexes(&self) -> bool {
        self.header.as_ref().is_some_and(|header| header.reflexes > 0)
    }

    /// The watch looks by the patch's rules from now on: when a scan begins.
    pub fn begin_watch(&self, watch: &mut Watch) {
        watch.begin(self.patch().filter(|_| self.has_reflexes()).as_ref());
        self.brief(watch);
    }

    /// Tells the watch what the pipeline knows: after each frame.
    pub fn brief(&self, watch: &mut Watch) {
        if let Some(patch) = self.patch().filter(|_| watch.has_rules()) {
            watch.brief(&patch, self.pipeline(), self.next_frame);
        }
    }

    /// Says what the rules say, when that changes, ahead of all that takes time.
    pub(super) fn tell_reflexes(
        &mut self,
        frame: &Frame,
        arrival: &Arrival,
        emit: &mut impl FnMut(&BoardPacket),
    ) {
        let (now, before) = (&arrival.reflexes, &self.reflexes);
        let is_same = (now.tripped, now.is_blind) == (before.tripped, before.is_blind);
        // Again now and then, as an event may be lost.
        let is_due = self.streaming.any() && self.next_frame.is_multiple_of(REMINDER);
        if !self.has_reflexes() || is_same && self.reflexes_are_told && !is_due {
            return;
        }
        (self.reflexes, self.reflexes_are_told) = (now.clone(), true);
        let at =
            FrameStamp { sequence: self.next_frame, timestamp_us: arrival.timestamp_us, flags: frame.flags };
        let event = Event::Reflexes { at, reflexes: now.clone() };
        emit(&BoardPacket::Event { number: self.take_number(), event });
    }
}
