//! Acquisition: samples of a scan in, frames out, and the gain of each slot.
//!
//! ```text
//! samples -> demodulate -> reading of a slot -> code -> frame
//!                             peak of a slot -> gain of that slot
//! ```
//!
//! Gains are found before the first frame and whenever a tare asks for it, and stay as they are
//! otherwise: the programmable amplifier's gains are right to a per cent, so a new one would look like a press.

pub mod demodulate;
mod front_end;
pub mod scan;
mod scope;
pub mod trigonometry;
pub mod trim;

pub use front_end::{CurrentRange, FrontEnd};
pub use scope::{MAX_SCOPE_SAMPLES, SlotSamples};

use crate::{
    drive::{Component, Drive, GAINS, Gain, stimulation::Step},
    frame::{ElectrodeTest, Frame, FrameFlags},
    limits::MAX_SLOTS,
    patch::PatchView,
    units::AdcCode,
};
use demodulate::{CLIPPED, Demodulator, LockInReference, Reading};
use front_end::Factors;
use heapless::Vec;
use scan::Timing;
use trigonometry::length;

/// Steps of a frame's codes in one LSB of the converter at gain 1.
pub const FINENESS: f32 = 4096.0;
/// A reference of 1 in the lock-in's table.
const LOCK_IN_ONE: f32 = 16_384.0;
/// Lowest bits of the lock-in's sums that are left out, so that the rest fits 32 bits: they are worth less
/// than a thousandth of an LSB.
const SPARE_BITS: u32 = 8;
/// An automatic gain brings a slot's peak up to this many LSB, of 2047: room for a press that doubles the
/// voltage.
pub const PEAK_GOAL: u32 = 900;
/// Largest gain after the first look, which sees small voltages badly.
const FIRST_GAIN_LIMIT: u8 = 8;

/// Turns the samples of a scan into frames.
#[derive(Clone, Debug)]
pub struct Acquisition {
    slots: Vec<Step, MAX_SLOTS>,
    timing: Timing,
    demodulator: Demodulator,
    assembly: Assembly,
    scope: Option<SlotSamples>,
    /// Samples of the frame under way so far.
    position: usize,
}

/// The frame being put together, and the gains it is measured with.
#[derive(Clone, Debug)]
struct Assembly {
    steps: usize,
    component: Component,
    /// Place of each slot's gain in [`GAINS`].
    gains: Vec<u8, MAX_SLOTS>,
    /// What turns a reading into codes, by gain.
    factors: [Factors; GAINS.len()],
    largest_gain: u8,
    peaks: Vec<u16, MAX_SLOTS>,
    frame: Frame,
    slots: usize,
    /// Passes of ranging that are left.
    passes: u8,
    /// Frames to leave out: their slots had different gains.
    skip: u8,
    gains_changed: bool,
}

impl Acquisition {
    /// Ready for the first sample of a scan of this patch under this drive; none if the board cannot
    /// make the drive's carrier.
    #[must_use]
    pub fn new(patch: &PatchView<'_>, drive: &Drive, front_end: &FrontEnd) -> Option<Self> {
        let timing = Timing::new(drive, front_end.sample_rate)?;
        let slots = scan::slots(patch);
        let lead = front_end.lead * front_end.sample_rate as f32;
        let demodulator = Demodulator::new(LockInReference::new(timing.period, drive.phase, lead), timing);
        let first_gain = match drive.gain {
            Gain::Automatic => 0,
            Gain::Fixed(gain) => GAINS.iter().position(|&known| known == gain)? as u8,
        };
        let assembly = Assembly {
            steps: patch.steps().count(),
            component: drive.component,
            gains: slots.iter().map(|_| first_gain).collect(),
            factors: front_end.factors(drive, unit_of(timing.integration)),
            largest_gain: front_end.largest_gain,
            peaks: Vec::new(),
            frame: Frame::default(),
            slots: slots.len(),
            passes: if drive.gain == Gain::Automatic { 2 } else { 0 },
            // The current rises during the first frame.
            skip: 1,
            gains_changed: false,
        };
        Some(Self { slots, timing, demodulator, assembly, scope: None, position: 0 })
    }

    /// The slots, in order.
    #[must_use]
    pub fn slots(&self) -> &[Step] {
        &self.slots
    }

    /// Place of each slot's gain in [`GAINS`].
    #[must_use]
    pub fn gains(&self) -> &[u8] {
        &self.assembly.gains
    }

    /// Whether gains have changed since this was asked last: the board has to use the new ones.
    pub fn take_gains_changed(&mut self) -> bool {
        core::mem::take(&mut self.assembly.gains_changed)
    }

    /// Samples of each slot.
    #[must_use]
    pub fn timing(&self) -> Timing {
        self.timing
    }

    /// Samples that are missing until the frame under way is complete.
    #[must_use]
    pub fn missing_samples(&self) -> usize {
        self.frame_samples() - self.position
    }

    fn frame_samples(&self) -> usize {
        self.slots.len() * self.timing.slot_samples()
    }

    /// Keeps the samples of that slot of each frame from now on, or of none.
    pub fn watch(&mut self, slot: Option<u16>) {
        self.scope = slot.map(|slot| SlotSamples::of(slot, self.timing));
    }

    /// Begins anew, with the gains found so far: the next sample is the first of a scan.
    pub fn restart(&mut self) {
        self.demodulator.restart();
        self.position = 0;
        let assembly = &mut self.assembly;
        assembly.begin();
        // The current rises during the first frame.
        assembly.skip = 1;
    }

    /// Takes the next samples; `done` gets each frame that they complete, without number and time, and
    /// what the watched slot showed in it.
    pub fn push(&mut self, mut samples: &[u16], mut done: impl FnMut(&Frame, Option<&SlotSamples>)) {
        // The scope sees one frame at a time.
        while let Some((piece, rest)) = samples.split_at_checked(self.missing_samples()) {
            self.take(piece, &mut done);
            samples = rest;
        }
        self.take(samples, &mut done);
    }

    /// Samples of one frame.
    fn take(&mut self, samples: &[u16], done: &mut impl FnMut(&Frame, Option<&SlotSamples>)) {
        if let Some(scope) = &mut self.scope {
            scope.take(samples, self.position, self.timing.slot_samples());
        }
        self.position = (self.position + samples.len()) % self.frame_samples();
        let (assembly, scope) = (&mut self.assembly, &mut self.scope);
        self.demodulator.push(samples, |reading| {
            match assembly.add(reading) {
                Slot::Inner => return,
                Slot::LastLeftOut => {}
                Slot::Last => {
                    if let Some(scope) = scope {
                        scope.gain = assembly.gain(scope.slot.into());
                    }
                    done(&assembly.frame, scope.as_ref());
                }
            }
            assembly.begin();
        });
    }
}

/// Codes at gain 1 that one unit of the lock-in's sums, without their spare bits, is worth.
fn unit_of(integration: u16) -> f32 {
    let spare = (1 << SPARE_BITS) as f32;
    spare * 2.0 / f32::from(integration.max(1)) / LOCK_IN_ONE * FINENESS
}

/// What a slot was.
enum Slot {
    /// One with others to come.
    Inner,
    /// The last of a frame.
    Last,
    /// The last of one that is left out.
    LastLeftOut,
}

impl Assembly {
    fn gain(&self, slot: usize) -> u8 {
        let place = self.gains.get(slot).map_or(0, |&place| usize::from(place));
        GAINS.get(place).copied().unwrap_or(1)
    }

    fn add(&mut self, reading: &Reading) -> Slot {
        let (slot, peak) = (self.peaks.len(), reading.peak());
        let _ = self.peaks.push(peak);
        let [real, imaginary] = self.convert(slot, reading);
        if slot < self.steps {
            let part = self.component_of(real, imaginary);
            let _ = self.frame.codes.push(part);
            let _ = self.frame.quadrature.push(imaginary);
            if peak >= CLIPPED {
                self.frame.clipped.insert(slot);
            }
        } else {
            let test = ElectrodeTest { in_phase: real, quadrature: imaginary, is_clipped: peak >= CLIPPED };
            let _ = self.frame.tests.push(test);
        }
        if self.peaks.len() < self.slots { Slot::Inner } else { self.finish() }
    }

    // Not inlined, so that slots within a frame find all they go through in the flash's cache.
    #[inline(never)]
    fn finish(&mut self) -> Slot {
        if self.skip > 0 {
            self.skip -= 1;
            return Slot::LastLeftOut;
        }
        if self.passes > 0 {
            self.passes -= 1;
            self.range();
            // The next frame has begun already.
            self.skip = 1;
            return Slot::LastLeftOut;
        }
        Slot::Last
    }

    fn begin(&mut self) {
        self.frame.clear();
        self.frame.flags = FrameFlags::default();
        self.peaks.clear();
    }

    fn range(&mut self) {
        let limit = if self.passes > 0 { FIRST_GAIN_LIMIT } else { u8::MAX }.min(self.largest_gain);
        for (place, &peak) in self.gains.iter_mut().zip(&self.peaks) {
            let gain = GAINS.get(usize::from(*place)).copied().unwrap_or(1);
            let fits = |candidate: u8| {
                u32::from(peak) * u32::from(candidate) <= PEAK_GOAL * u32::from(gain) && candidate <= limit
            };
            *place = GAINS.iter().rposition(|&candidate| fits(candidate)).unwrap_or(0) as u8;
        }
        self.gains_changed = true;
    }

    fn convert(&self, slot: usize, reading: &Reading) -> [AdcCode; 2] {
        let gain = self.gains.get(slot).map_or(0, |&place| usize::from(place));
        let [real, imaginary] = self.factors.get(gain).copied().unwrap_or_default();
        let [x, y] = [reading.in_phase, reading.quadrature].map(|sum| (sum >> SPARE_BITS) as i32 as f32);
        [real, imaginary].map(|[of_x, of_y]| AdcCode(nearest(of_x * x + of_y * y)))
    }

    fn component_of(&self, real: AdcCode, imaginary: AdcCode) -> AdcCode {
        match self.component {
            Component::Real => real,
            Component::Imaginary => imaginary,
            Component::Magnitude => AdcCode(nearest(length(real.0 as f32, imaginary.0 as f32))),
        }
    }
}

/// Nearest integer, halves away from zero; beyond the ends the end. Twice in every slot, so without micromath's way
/// through a float.
fn nearest(value: f32) -> i32 {
    (value + 0.5_f32.copysign(value)) as i32
}

#[cfg(test)]
pub(crate) mod tests;
