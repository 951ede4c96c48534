//! Front end: what a board does to a voltage before it is a code, and how that is undone.

use super::{
    trigonometry::{cosine, sine},
    trim::{Factor, Trim, product},
};
use crate::drive::{Drive, GAINS};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// What a board's analogue front end does to a voltage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct FrontEnd {
    /// Samples per second.
    pub sample_rate: u32,
    /// Volts between two electrodes for one step of a code.
    pub volts_per_code: f32,
    /// Current amplitude at 100 %, A.
    pub full_scale_current: f32,
    /// The current source's range for small currents, if it has one.
    pub small_range: Option<CurrentRange>,
    /// Gain-bandwidth product of the programmable amplifier, Hz.
    pub gain_bandwidth: f32,
    /// Largest gain of the programmable amplifier.
    pub largest_gain: u8,
    /// Bandwidths of DAC, current source (up to 100 %), amplifier and filter, one pole each, Hz.
    pub bandwidths: [f32; 4],
    /// Corner of the high-pass that the capacitance of all leads makes of a channel, Hz; infinite without leads.
    pub lead_corner: f32,
    /// Values per second of the current's waveform, each held until the next.
    pub waveform_rate: u32,
    /// Time from a crest of the current, as it is asked for, to the first sample of a scan, s.
    pub lead: f32,
    /// What this board does otherwise.
    pub trim: Trim,
}

/// A range of the current source. All share their parts but a resistor of 0.1 %, so one [`Trim`] goes for all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct CurrentRange {
    /// Largest amplitude, A.
    pub full_current: f32,
    /// Bandwidth of the current source, Hz.
    pub bandwidth: f32,
}

/// What multiplies in-phase and quadrature sum to give the real code, and the imaginary one.
pub(super) type Factors = [[f32; 2]; 2];

/// An amplitude that rounding lifts above a range is within it.
const WITHIN: f32 = 1.0001;
/// Images of the carrier on each side that [`FrontEnd::factors`] counts: those further off are too small to matter.
const IMAGES: i8 = 3;

impl FrontEnd {
    /// Whether the current source makes this amplitude, A, in its small range: wherever that reaches it, for there the DAC's
    /// steps are finer.
    #[must_use]
    pub fn uses_small_range(&self, amplitude: f32) -> bool {
        self.small_range.is_some_and(|range| amplitude <= range.full_current * WITHIN)
    }

    /// Share of the range that makes it, for an amplitude, A.
    #[must_use]
    pub fn share_of_range(&self, amplitude: f32) -> f32 {
        amplitude / self.range_of(amplitude).full_current
    }

    fn range_of(&self, amplitude: f32) -> CurrentRange {
        let large = CurrentRange { full_current: self.full_scale_current, bandwidth: self.bandwidths[1] };
        self.small_range.filter(|_| self.uses_small_range(amplitude)).unwrap_or(large)
    }

    /// Whether the current source makes this amplitude, A.
    #[must_use]
    pub fn reaches(&self, amplitude: f32) -> bool {
        amplitude <= self.full_scale_current * WITHIN
    }

    /// From sums of the lock-in to codes at gain 1: undoes what amplifier, poles and waveform do to the carrier.
    ///
    /// The waveform's values are held (a zero-order hold), so it has images of the carrier beside it; those that lie a multiple of
    /// the sampling rate away read as the carrier itself. The leads, which take current from the skin, pass
    /// images otherwise than the carrier: at frequency f a channel passes `v + w g(f)`, where g is a high-pass of
    /// one pole, [`Self::lead_corner`], and v and w are real. So the lock-in's sums are those of `response (v +
    /// w g)` over the images: two equations for v and w, and so for what the channel passes at the carrier.
    ///
    /// `unit` is what a sum of 1 would be worth, in codes, through a channel that changes nothing.
    pub(super) fn factors(&self, drive: &Drive, unit: f32) -> [Factors; GAINS.len()] {
        let mut factors = self.designed(drive, unit);
        for (factors, [real, imaginary]) in factors.iter_mut().zip(self.trim.at(drive.frequency)) {
            *factors = factors.map(|[x, y]| [x * real + y * imaginary, y * real - x * imaginary]);
        }
        factors
    }

    /// What the trim of this gain at this drive's frequency has to be multiplied with, so that a voltage that reads as `measured`
    /// reads as `truth`, in the same unit: a resistor's, whose voltage no lead changes. None for what reads as nothing.
    #[must_use]
    pub fn correction(
        &self,
        drive: &Drive,
        gain: usize,
        measured: [f32; 2],
        truth: [f32; 2],
    ) -> Option<Factor> {
        let designed = *self.designed(drive, 1.0).get(gain)?;
        let [[real, imaginary], [true_real, true_imaginary]] =
            [measured, truth].map(|voltage| solve(designed, voltage));
        let size = real * real + imaginary * imaginary;
        let factor = product([true_real, true_imaginary], [real / size, -imaginary / size]);
        factor.iter().all(|part| part.is_finite()).then_some(factor)
    }

    /// What reads as `measured` with this trim, once that is multiplied with `by`.
    #[must_use]
    pub fn corrected(&self, drive: &Drive, gain: usize, measured: [f32; 2], by: Factor) -> [f32; 2] {
        let Some(&designed) = self.designed(drive, 1.0).get(gain) else { return measured };
        let [x, y] = product(solve(designed, measured), by);
        designed.map(|[of_x, of_y]| of_x * x + of_y * y)
    }

    /// The factors of a board as designed.
    fn designed(&self, drive: &Drive, unit: f32) -> [Factors; GAINS.len()] {
        let (frequency, source) = (drive.frequency, self.range_of(drive.amplitude).bandwidth);
        // One rate is a multiple of the other.
        let apart = self.waveform_rate.max(self.sample_rate) as f32;
        GAINS.map(|gain| {
            let (mut of_v, mut of_w) = ([0.0; 2], [0.0; 2]);
            for image in -IMAGES..=IMAGES {
                let away = f32::from(image) * apart;
                let turns = away * self.lead;
                let response =
                    product(self.response(frequency + away, gain, source), [cosine(turns), sine(turns)]);
                let high = product(response, self.through_leads(frequency + away));
                of_v = [of_v[0] + response[0], of_v[1] + response[1]];
                of_w = [of_w[0] + high[0], of_w[1] + high[1]];
            }
            let scale = unit / (of_v[0] * of_w[1] - of_w[0] * of_v[1]);
            let [v, w] = [[of_w[1], -of_w[0]], [-of_v[1], of_v[0]]];
            let [real, imaginary] = self.through_leads(frequency);
            [[v[0] + real * w[0], v[1] + real * w[1]], [imaginary * w[0], imaginary * w[1]]]
                .map(|row| row.map(|part| part * scale))
        })
    }

    /// What becomes of a wave of the current, from its values to the converter; frequency in Hz, and negative
    /// for one that turns the other way. The amplifier has one pole, `g / (1 + j f g / gain_bandwidth)`.
    fn response(&self, frequency: f32, gain: u8, source: f32) -> [f32; 2] {
        let half_turns = frequency / self.waveform_rate as f32;
        let hold = sine(half_turns / 2.0) / (core::f32::consts::PI * half_turns);
        let amplifier = [1.0 / f32::from(gain), frequency / self.gain_bandwidth];
        let [dac, _, instrumentation, filter] = self.bandwidths;
        let poles = [dac, source, instrumentation, filter].map(|bandwidth| [1.0, frequency / bandwidth]);
        let [real, imaginary] = poles.into_iter().fold(amplifier, product);
        let scale = hold / (real * real + imaginary * imaginary);
        [real * scale, -imaginary * scale]
    }

    /// The high-pass of the leads, j f / (f_c + j f), times f_c so that its corner may be infinite.
    fn through_leads(&self, frequency: f32) -> [f32; 2] {
        let ratio = frequency / self.lead_corner;
        let scale = frequency / (1.0 + ratio * ratio);
        [ratio * scale, scale]
    }
}

/// The lock-in's sums that factors turn into a voltage.
pub(super) fn solve([[a, b], [c, d]]: Factors, [real, imaginary]: [f32; 2]) -> [f32; 2] {
    let determinant = a * d - b * c;
    [(d * real - b * imaginary) / determinant, (a * imaginary - c * real) / determinant]
}
