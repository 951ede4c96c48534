//! Assemble: the events of one scan joined into one frame, and what is missing counted.
//!
//! A board sends what was selected of a scan as events of their own, each with the scan's sequence number, except the
//! scope's samples, which follow the other events of their scan. A link keeps their order, so an event of a later scan
//! means that the scan before is over: whatever of it has not come by then is missing.
//!
//! Nothing here knows a link or a clock: events go in, frames come out.

mod parts;
#[cfg(test)]
mod tests;

pub use parts::Parts;

use dermatome_shared::{
    contact::Contacts,
    health::{Health, Vitals},
    pipeline::reflex::Reflexes,
    protocol::{Event, FrameStamp, PackedImage, Selection, SlotSamples},
    units::AdcCode,
};
use std::collections::VecDeque;

/// A frame that is at most so far behind is an old one; farther behind, the board has started anew.
const LATE_FRAMES: u32 = 64;

/// One scan: of what was selected, the parts that came.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScanFrame {
    /// Which scan; none for samples of the scope alone, which do not say of which scan they are.
    pub at: Option<FrameStamp>,
    /// Raw codes.
    pub measurements: Option<Measurements>,
    /// Image.
    pub image: Option<PackedImage>,
    /// Contacts, strongest first.
    pub contacts: Option<Contacts>,
    /// What the scan says about the board and its skin.
    pub health: Option<HealthReport>,
    /// Samples of the slot that the scope watches.
    pub scope: Option<SlotSamples>,
    /// What the patch's reflexes say, as far as the board has told; none without reflexes.
    pub reflexes: Option<Reflexes>,
    /// Parts that were due and did not come: lost on the way, or not made by the board, which has no image and no
    /// contacts while it tares.
    pub missing: Parts,
}

/// Raw codes of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurements {
    /// The part of each voltage that goes into the image: `[step]`.
    pub codes: Vec<AdcCode>,
    /// The part in quadrature: `[step]`; empty where it is not measured.
    pub quadrature: Vec<AdcCode>,
}

/// What one frame says about the board and its skin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HealthReport {
    /// Electrodes and current.
    pub health: Health,
    /// The board itself.
    pub vitals: Vitals,
    /// Drift of all voltages that is taken out of the images, relative.
    pub drift: f32,
    /// Times since the board's start at which samples were lost.
    pub missed: u32,
}

/// What has come of a stream so far. No event is used without being counted here or in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Frames put together, complete or not.
    pub frames: u64,
    /// Frames of them in which something is missing.
    pub incomplete: u64,
    /// Parts that are missing in them.
    pub parts_missing: u64,
    /// Frames that were due and of which nothing came.
    pub frames_missing: u64,
    /// Parts that came when their frame was complete or over.
    pub parts_unused: u64,
    /// New references that the board made meanwhile.
    pub tares: u64,
}

/// Joins the events of one stream.
#[derive(Debug)]
pub struct Assembler {
    selection: Selection,
    /// First sequence number that is not over.
    next: u32,
    arriving: Option<ScanFrame>,
    /// Number of the event that came last.
    last_number: Option<u32>,
    /// What the reflexes said last.
    reflexes: Option<Reflexes>,
    ready: VecDeque<ScanFrame>,
    totals: Totals,
}

impl Assembler {
    /// For a stream of this selection, whose first frame has this sequence number.
    #[must_use]
    pub fn new(selection: Selection, first_sequence: u32) -> Self {
        Self {
            selection,
            next: first_sequence,
            arriving: None,
            last_number: None,
            reflexes: None,
            // One event ends two frames at most: the one before, and its own.
            ready: VecDeque::with_capacity(2),
            totals: Totals::default(),
        }
    }

    /// Frames have other parts from now on.
    pub fn reselect(&mut self, selection: Selection) {
        self.selection = selection;
    }

    /// Takes the next event, with its running number.
    pub fn take(&mut self, number: u32, event: Event) {
        let follows = self.last_number.replace(number) == Some(number.wrapping_sub(1));
        match event {
            Event::Tared { .. } => self.totals.tares += 1,
            Event::Image { at, image } => self.add(at, Parts::IMAGE, |frame| frame.image = Some(image)),
            Event::Contacts { at, contacts } => {
                self.add(at, Parts::CONTACTS, |frame| frame.contacts = Some(contacts));
            }
            Event::Measurements { at, codes, quadrature } => {
                let measurements = Measurements { codes: codes.to_vec(), quadrature: quadrature.to_vec() };
                self.add(at, Parts::MEASUREMENTS, |frame| frame.measurements = Some(measurements));
            }
            Event::Health { at, health, vitals, drift, missed } => {
                let report = HealthReport { health, vitals, drift, missed };
                self.add(at, Parts::HEALTH, |frame| frame.health = Some(report));
            }
            Event::Scope(samples) => self.add_samples(samples, follows),
            Event::Reflexes { reflexes, .. } => self.reflexes = Some(reflexes),
        }
    }

    /// The next frame that is complete or over.
    pub fn pop(&mut self) -> Option<ScanFrame> {
        self.ready.pop_front()
    }

    /// Whether a frame is complete or over.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        !self.ready.is_empty()
    }

    /// The frame that is arriving is over: nothing more will come.
    pub fn finish(&mut self) {
        let Some(frame) = self.arriving.take() else { return };
        self.totals.frames += 1;
        self.totals.incomplete += u64::from(!frame.missing.is_empty());
        self.totals.parts_missing += u64::from(frame.missing.count());
        self.ready.push_back(frame);
    }

    /// Whether a part of a frame has come whose other parts are still to come.
    #[must_use]
    pub fn is_arriving(&self) -> bool {
        self.arriving.is_some()
    }

    /// What has come so far.
    #[must_use]
    pub fn totals(&self) -> Totals {
        self.totals
    }

    /// A part of the scan `at`, which `put` puts into its frame.
    fn add(&mut self, at: FrameStamp, part: Parts, put: impl FnOnce(&mut ScanFrame)) {
        if self.arriving.as_ref().is_none_or(|frame| frame.at != Some(at)) && !self.begin(at) {
            self.totals.parts_unused += 1;
            return;
        }
        let Some(frame) = &mut self.arriving else { return };
        if frame.parts().contains(part) {
            self.totals.parts_unused += 1;
            return;
        }
        put(frame);
        frame.missing.remove(part);
        self.finish_if_complete();
    }

    /// Another scan's first part has come; false if that scan is over.
    fn begin(&mut self, at: FrameStamp) -> bool {
        if (1..=LATE_FRAMES).contains(&self.next.wrapping_sub(at.sequence)) {
            return false;
        }
        self.finish();
        let ahead = at.sequence.wrapping_sub(self.next);
        if ahead <= u32::MAX / 2 {
            self.totals.frames_missing += self.due_in(self.next, ahead);
        }
        self.next = at.sequence.wrapping_add(1);
        let missing = Parts::due(&self.selection, at.sequence);
        let reflexes = self.reflexes.clone();
        self.arriving = Some(ScanFrame { at: Some(at), reflexes, missing, ..ScanFrame::default() });
        true
    }

    /// Samples belong to the scan whose event they follow, if that still waits for them.
    fn add_samples(&mut self, samples: SlotSamples, follows: bool) {
        match &mut self.arriving {
            Some(frame) if follows && frame.missing.contains(Parts::SCOPE) => {
                frame.scope = Some(samples);
                frame.missing.remove(Parts::SCOPE);
                self.finish_if_complete();
            }
            _ => {
                self.finish();
                self.arriving = Some(ScanFrame { scope: Some(samples), ..ScanFrame::default() });
                self.finish();
            }
        }
    }

    fn finish_if_complete(&mut self) {
        if self.arriving.as_ref().is_some_and(|frame| frame.missing.is_empty()) {
            self.finish();
        }
    }

    /// Frames of so many from `first` on that have something due that says of which scan it is.
    fn due_in(&self, first: u32, count: u32) -> u64 {
        let is_due = |ahead: &u32| Parts::due(&self.selection, first.wrapping_add(*ahead)).is_stamped();
        if Parts::is_due_each_frame(&self.selection) {
            return count.into();
        }
        (0..count).filter(is_due).count() as u64
    }
}
