//! What a lock-in must find, computed by frequencies and not by time: an oracle for the stepping chain.
//!
//! The DAC holds each word, so its output holds the carrier and images of it at all multiples of the word
//! rate, plus and minus the carrier. Those that the converter's sampling folds onto the carrier count.

use super::{
    modes::{self, COUPLING},
    multiplexers::selected,
    network::Network,
    parameters::Analogue,
};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Orders of images that count; the poles of source and amplifier leave nothing of higher ones.
const IMAGES: i32 = 12;

/// A carrier as DAC and ADC make it.
#[derive(Clone, Debug, PartialEq)]
pub struct Carrier {
    /// The DAC's codes over one period.
    pub codes: Vec<u16>,
    /// Words per second.
    pub word_rate: f64,
    /// The ADC's samples in one period.
    pub samples_per_period: usize,
    /// From the first word to a sample, s; others lie whole sample times away.
    pub first_sample: f64,
}

impl Carrier {
    /// A sine round half the range, `amplitude` in codes, with 1,000,000 words and 2,000,000 samples per
    /// second.
    #[must_use]
    pub fn sine(words: usize, amplitude: f64, first_sample: f64) -> Self {
        let code = |word: usize| 2048.0 + amplitude * (TAU * word as f64 / words as f64).sin();
        Self {
            codes: (0..words).map(|word| code(word).round() as u16).collect(),
            word_rate: 1e6,
            samples_per_period: 2 * words,
            first_sample,
        }
    }

    /// Its frequency, Hz.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.word_rate / self.codes.len() as f64
    }

    /// Fourier coefficient of the held words at a multiple of the frequency, in codes.
    fn coefficient(&self, multiple: i32) -> Complex64 {
        let words = self.codes.len() as f64;
        let turn = |word: usize| Complex64::cis(-TAU * f64::from(multiple) * word as f64 / words);
        let sum: Complex64 = self.codes.iter().enumerate().map(|(n, &c)| f64::from(c) * turn(n)).sum();
        let angle = PI * f64::from(multiple) / words;
        sum / words * (angle.sin() / angle) * Complex64::cis(-angle)
    }
}

pub(super) fn demodulated(
    network: &Network,
    analogue: &Analogue,
    word: u16,
    gain: f64,
    carrier: &Carrier,
) -> Complex64 {
    let images = (-IMAGES..=IMAGES).map(|fold| 1 + fold * carrier.samples_per_period as i32);
    let image = |multiple: i32| {
        let frequency = f64::from(multiple) * carrier.frequency();
        // e^(j omega t) of the carrier itself is what the lock-in takes off.
        let turned = Complex64::cis(TAU * (frequency - carrier.frequency()) * carrier.first_sample);
        carrier.coefficient(multiple) * response(network, analogue, word, gain, frequency) * turned
    };
    2.0 * analogue.dac.lsb * images.map(image).sum::<Complex64>()
}

/// Volts at the converter per volt at the DAC.
fn response(network: &Network, analogue: &Analogue, word: u16, gain: f64, frequency: f64) -> Complex64 {
    let pole = |corner: f64| 1.0 / Complex64::new(1.0, frequency / corner);
    let coupling = 1.0 - pole(COUPLING);
    let poles_of_source = pole(analogue.dac.bandwidth) * pole(analogue.source.bandwidth);
    let current = coupling * analogue.source.transconductance * poles_of_source;
    let weights = network.sensed();
    let voltages = network.phasors(selected(word), frequency);
    let sensed: Complex64 = voltages.iter().zip(weights.iter()).map(|(v, weight)| v * weight).sum();
    let poles: Complex64 = modes::poles(analogue, gain).into_iter().map(pole).product();
    let gains = (1.0 + analogue.dac.gain_error) * (1.0 + analogue.adc.gain_error) * analogue.pga.gain(gain);
    current * sensed * analogue.amplifier.gain * gains * poles
}
