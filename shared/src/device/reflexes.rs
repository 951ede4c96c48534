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
        let patch = if self.has_reflexes() { self.patch() } else { None };
        watch.begin(patch.as_ref());
        self.brief(watch);
    }

    /// Tells the watch what the pipeline knows: after each frame.
    pub fn brief(&self, watch: &mut Watch) {
        if watch.has_rules()
            && let Some(patch) = self.patch()
        {
            watch.brief(&patch, self.pipeline());
        }
    }

    /// Says what the rules say, when that changes, ahead of all that takes time.
    pub(super) fn tell_reflexes(
        &mut self,
        frame: &Frame,
        arrival: &Arrival,
        emit: &mut impl FnMut(&BoardPacket),
    ) {
        let reflexes = arrival.reflexes.clone();
        let now = Some(reflexes.state());
        // Again now and then, as an event may be lost.
        let is_due = self.streaming.any() && self.next_frame.is_multiple_of(REMINDER);
        if !self.has_reflexes() || now == self.reflexes_told && !is_due {
            return;
        }
        self.reflexes_told = now;
        let at =
            FrameStamp { sequence: self.next_frame, timestamp_us: arrival.timestamp_us, flags: frame.flags };
        let event = Event::Reflexes { at, reflexes };
        emit(&BoardPacket::Event { number: self.take_number(), event });
    }
}
