//! Acquisition: samples of a scan in, frames out, and the gain of each slot.
//!
//! ```text
//! samples -> demodulate -> reading of a slot -> code -> frame
//!                             peak of a slot -> gain of that slot
//! ```
//!
//! Gains are found before the first frame and whenever a tare asks for it, and stay as they are
//! otherwise: the programmable amplifier's gains are right to a per cent, so a new one would look like a press.

use crate::{
    demodulate::{CLIPPED, Demodulator, Reading, Reference},
    drive::{Component, Drive, GAINS, Gain},
    frame::{ElectrodeTest, Frame, FrameFlags},
    patch::PatchView,
    protocol::SlotSamples,
    scan::{self, MAX_SLOTS, Timing},
    stimulation::Step,
    trigonometry::{cosine, length, sine},
    units::AdcCode,
};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Codes of a frame have so many steps in one step of the converter at gain 1.
pub const FINENESS: f32 = 4096.0;
/// A reference of 1 in the lock-in's table.
const LOCK_IN_ONE: f32 = 16_384.0;
/// Lowest bits of the lock-in's sums that are left out, so that the rest fits 32 bits: they are worth less
/// than a thousandth of a step of the converter.
const SPARE_BITS: u32 = 8;
/// An automatic gain brings a slot's peak up to this many steps of the converter, of 2047: room for a
/// press that doubles the voltage.
pub const PEAK_GOAL: u32 = 900;
/// Largest gain after the first look, which sees small voltages badly.
const FIRST_GAIN_LIMIT: u8 = 8;

/// What a board's analogue front end does to a voltage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct FrontEnd {
    /// Samples per second.
    pub sample_rate: u32,
    /// Volts between two electrodes for one step of a code.
    pub volts_per_code: f32,
    /// Current amplitude at 100 %, A.
    pub full_scale_current: f32,
    /// Gain-bandwidth product of the programmable amplifier, Hz.
    pub gain_bandwidth: f32,
    /// Largest gain of the programmable amplifier.
    pub largest_gain: u8,
    /// Bandwidths of current source, amplifier and filter, one pole each, Hz.
    pub bandwidths: [f32; 3],
    /// Corner of the high-pass that the capacitance of all leads makes of a channel, Hz; infinite without leads.
    pub lead_corner: f32,
    /// Values per second of the current's waveform, each held until the next.
    pub waveform_rate: u32,
    /// Time from a crest of the current, as it is asked for, to the first sample of a scan, s.
    pub lead: f32,
}

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
        let demodulator = Demodulator::new(Reference::new(timing.period, drive.phase, lead), timing);
        let first_gain = match drive.gain {
            Gain::Automatic => 0,
            Gain::Fixed(gain) => GAINS.iter().position(|&known| known == gain)? as u8,
        };
        let assembly = Assembly {
            steps: patch.steps().count(),
            component: drive.component,
            gains: slots.iter().map(|_| first_gain).collect(),
            factors: factors(drive.frequency, timing.integration, front_end),
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
        let settling = self.timing.settling;
        self.scope = slot.map(|slot| SlotSamples { slot, settling, ..SlotSamples::default() });
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

    /// Keeps those of `samples`, which begin at `self.position` of a frame, that the scope watches.
    fn keep_for_scope(&mut self, samples: &[u16]) {
        let Some(scope) = &mut self.scope else { return };
        let slot = self.timing.slot_samples();
        let start = usize::from(scope.slot) * slot;
        if (self.position..self.position + samples.len()).contains(&start) {
            scope.samples.clear();
        }
        let from = start.saturating_sub(self.position).min(samples.len());
        let to = (start + slot).saturating_sub(self.position).min(samples.len());
        // Where the slot lies before or behind the samples, `from` is not before `to`.
        let room = scope.samples.capacity() - scope.samples.len();
        for &sample in samples.get(from..to).unwrap_or_default().iter().take(room) {
            let _ = scope.samples.push(sample);
        }
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
        self.keep_for_scope(samples);
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
        } else {
            let test = ElectrodeTest { in_phase: real, quadrature: imaginary, is_clipped: peak >= CLIPPED };
            let _ = self.frame.tests.push(test);
        }
        // A test that is clipped says so itself: its electrode is open.
        self.frame.flags.insert_if(FrameFlags::SATURATED, slot < self.steps && peak >= CLIPPED);
        if self.peaks.len() < self.slots { Slot::Inner } else { self.finish() }
    }

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

/// What multiplies in-phase and quadrature sum to give the real code, and the imaginary one.
type Factors = [[f32; 2]; 2];

/// Images of the carrier on each side that [`factors`] counts: those further off are too small to matter.
const IMAGES: i8 = 3;

/// From sums of the lock-in to codes at gain 1: undoes what amplifier, poles and waveform do to the carrier.
///
/// The waveform's values are held, so it has images of the carrier beside it; those that lie a multiple of
/// the sampling rate away read as the carrier itself. The leads, which take current from the skin, pass
/// images otherwise than the carrier: at frequency f a channel passes `v + w g(f)`, where g is a high-pass of
/// one pole, [`FrontEnd::lead_corner`], and v and w are real. So the lock-in's sums are those of `response (v +
/// w g)` over the images: two equations for v and w, and so for what the channel passes at the carrier.
fn factors(frequency: f32, integration: u16, front_end: &FrontEnd) -> [Factors; GAINS.len()] {
    let spare = (1 << SPARE_BITS) as f32;
    let amplitude = spare * 2.0 / f32::from(integration.max(1)) / LOCK_IN_ONE * FINENESS;
    // One rate is a multiple of the other.
    let apart = front_end.waveform_rate.max(front_end.sample_rate) as f32;
    GAINS.map(|gain| {
        let (mut of_v, mut of_w) = ([0.0; 2], [0.0; 2]);
        for image in -IMAGES..=IMAGES {
            let away = f32::from(image) * apart;
            let turns = away * front_end.lead;
            let response = product(front_end.response(frequency + away, gain), [cosine(turns), sine(turns)]);
            let high = product(response, front_end.through_leads(frequency + away));
            of_v = [of_v[0] + response[0], of_v[1] + response[1]];
            of_w = [of_w[0] + high[0], of_w[1] + high[1]];
        }
        let scale = amplitude / (of_v[0] * of_w[1] - of_w[0] * of_v[1]);
        let [v, w] = [[of_w[1], -of_w[0]], [-of_v[1], of_v[0]]];
        let [real, imaginary] = front_end.through_leads(frequency);
        [[v[0] + real * w[0], v[1] + real * w[1]], [imaginary * w[0], imaginary * w[1]]]
            .map(|row| row.map(|part| part * scale))
    })
}

impl FrontEnd {
    /// What becomes of a wave of the current, from its values to the converter; frequency in Hz, and negative
    /// for one that turns the other way. The amplifier has one pole, `g / (1 + j f g / gain_bandwidth)`.
    fn response(&self, frequency: f32, gain: u8) -> [f32; 2] {
        let half_turns = frequency / self.waveform_rate as f32;
        let held = sine(half_turns / 2.0) / (core::f32::consts::PI * half_turns);
        let amplifier = [1.0 / f32::from(gain), frequency / self.gain_bandwidth];
        let poles = self.bandwidths.map(|bandwidth| [1.0, frequency / bandwidth]);
        let [real, imaginary] = poles.into_iter().fold(amplifier, product);
        let scale = held / (real * real + imaginary * imaginary);
        [real * scale, -imaginary * scale]
    }

    /// The high-pass of the leads, j f / (f_c + j f), times f_c so that its corner may be infinite.
    fn through_leads(&self, frequency: f32) -> [f32; 2] {
        let ratio = frequency / self.lead_corner;
        let scale = frequency / (1.0 + ratio * ratio);
        [ratio * scale, scale]
    }
}

/// Nearest integer, halves away from zero; beyond the ends the end.
fn nearest(value: f32) -> i32 {
    (value + 0.5_f32.copysign(value)) as i32
}

/// Product of two complex numbers.
fn product([a, b]: [f32; 2], [c, d]: [f32; 2]) -> [f32; 2] {
    [a * c - b * d, a * d + b * c]
}

#[cfg(test)]
pub(crate) mod tests;
