//! Scan: the slots of one frame, and what each slot needs of the board.
//!
//! A frame is the patch's stimulation steps followed by one test per electrode. Each slot is one word
//! for the multiplexers, one gain, some samples to settle, and whole carrier periods of samples. A
//! board builds its tables from this once, and its timers and DMA run them without the CPU.

use crate::{
    drive::{Drive, stimulation::Step},
    limits::{MAX_PERIOD, MAX_SLOTS},
    patch::PatchView,
};
use heapless::Vec;
use micromath::F32Ext;

/// Fewest samples in a carrier period.
const MIN_PERIOD: u32 = 8;

/// Samples of a slot. All slots have the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Samples in a carrier period, even.
    pub period: u16,
    /// Samples that are left out while a switched voltage settles.
    pub settling: u16,
    /// Samples that are measured: whole periods.
    pub integration: u16,
}

impl Timing {
    /// The timing of a drive on a board that takes `sample_rate` samples a second; none if the carrier
    /// is not an even number of samples long, 8 to 160.
    #[must_use]
    pub fn new(drive: &Drive, sample_rate: u32) -> Option<Self> {
        let period = (sample_rate as f32 / drive.frequency + 0.5) as u32;
        let fits = (sample_rate as f32 - drive.frequency * period as f32).abs() <= 1e-3 * drive.frequency;
        if !fits || period % 2 == 1 || !(MIN_PERIOD..=MAX_PERIOD as u32).contains(&period) {
            return None;
        }
        let settling = F32Ext::ceil(drive.settling * period as f32 - 1e-3) as u32;
        Some(Self {
            period: period as u16,
            // The sample during which the multiplexers switch never counts.
            settling: settling.clamp(1, u16::MAX.into()) as u16,
            integration: (period * u32::from(drive.integration)) as u16,
        })
    }

    /// Samples in a slot.
    #[must_use]
    pub fn slot_samples(&self) -> usize {
        usize::from(self.settling) + usize::from(self.integration)
    }
}

/// The slots of a patch, in order: its steps, then a test per electrode.
#[must_use]
pub fn slots(patch: &PatchView<'_>) -> Vec<Step, MAX_SLOTS> {
    let electrodes = patch.header.electrodes;
    let tests = (0..electrodes).map(|electrode| test_step(electrode, electrodes));
    patch.steps().chain(tests).take(MAX_SLOTS).collect()
}

/// The test of an electrode: current out of it and into the next one, and the voltage from the one
/// before, which carries no current, to it.
///
/// That voltage is the current times the contact impedance of this electrode alone, and a part that
/// the sheet adds and a model knows. An electrode that is open reads far too much or nothing, one
/// that is shorted to a neighbour nearly nothing.
#[must_use]
pub fn test_step(electrode: u8, electrodes: u8) -> Step {
    let around = electrodes.max(1);
    let before = (electrode + around - 1) % around;
    Step {
        drive_plus: (electrode + 1) % around,
        drive_minus: electrode,
        sense_plus: before,
        sense_minus: electrode,
    }
}

/// The word that switches all four multiplexers: a nibble each, from the lowest: I+, I-, V+, V-.
#[must_use]
pub fn multiplexer_word(step: Step) -> u16 {
    step.to_bytes().iter().rev().fold(0, |word, &electrode| word << 4 | u16::from(electrode & 0xF))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::{Difference, tests::small_patch};

    fn timing(frequency: f32, settling: f32) -> Option<Timing> {
        Timing::new(&Drive { settling, ..Drive::new(frequency, 1e-3, 50.0) }, 2_000_000)
    }

    #[test]
    fn the_five_carriers_have_whole_even_periods_at_two_megasamples() {
        for (frequency, period) in [(12.5e3, 160), (20e3, 100), (50e3, 40), (100e3, 20), (200e3, 10)] {
            let timing = timing(frequency, 0.5).unwrap();
            assert_eq!(timing, Timing { period, settling: period / 2, integration: period });
        }
        assert_eq!(timing(50e3, 0.25).unwrap().slot_samples(), 50);
        assert_eq!(timing(50e3, 0.0).unwrap().settling, 1);
        for frequency in [51e3, 80e3, 1e6, 5e3, 1.0] {
            assert_eq!(timing(frequency, 0.5), None, "{frequency}");
        }
    }

    #[test]
    fn a_frame_is_the_steps_and_a_test_of_each_electrode() {
        let bytes = small_patch(Difference::Plain);
        let patch = PatchView::validate(&bytes).unwrap();
        let slots = slots(&patch);
        assert_eq!(slots.len(), 40 + 8);
        assert_eq!(slots[40].to_bytes(), [1, 0, 7, 0]);
        assert_eq!(slots[47].to_bytes(), [0, 7, 6, 7]);
        assert!(slots.iter().all(|step| step.is_valid(8)));
    }

    #[test]
    fn a_word_has_a_nibble_for_each_multiplexer() {
        assert_eq!(multiplexer_word(Step::from_bytes([1, 2, 3, 15])), 0xF321);
    }
}
