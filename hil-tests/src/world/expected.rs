//! What a lock-in must find, computed by frequencies and not by time: an oracle for the stepping chain.
//!
//! The DAC holds each word, so its output holds the carrier and images of it at all multiples of the word
//! rate, plus and minus the carrier. Those that the converter's sampling folds onto the carrier count.

use super::{modes::COUPLING, multiplexers::selected, network::Network, parameters::Analogue};
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

/// What a circuit makes of the carrier at one word of the multiplexers, up to the chip's amplifier: at the carrier and
/// at the images that its sampling folds onto it.
#[derive(Clone, Debug)]
pub struct Response {
    /// Multiple of the carrier's frequency, and volts at the chip's pin per volt at the DAC.
    images: Vec<(i32, Complex64)>,
    /// Noise before the amplifier at the carrier, V/sqrt(Hz).
    pub(super) noise: f64,
}

impl Response {
    pub(super) fn new(network: &Network, analogue: &Analogue, word: u16, carrier: &Carrier) -> Self {
        let folds = (-IMAGES..=IMAGES).map(|fold| 1 + fold * carrier.samples_per_period as i32);
        let image = |multiple: i32| {
            let frequency = f64::from(multiple) * carrier.frequency();
            (multiple, before_amplifier(network, analogue, word, frequency))
        };
        let noise = network.noise(selected(word), carrier.frequency());
        Self { images: folds.map(image).collect(), noise }
    }

    /// What a lock-in finds at the converter behind a gain of the chip's amplifier, V.
    #[must_use]
    pub fn demodulated(&self, analogue: &Analogue, gain: f64, carrier: &Carrier) -> Complex64 {
        let frequency = carrier.frequency();
        let image = |&(multiple, response): &(i32, Complex64)| {
            let at = f64::from(multiple) * frequency;
            // e^(j omega t) of the carrier itself is what the lock-in takes off.
            let turned = Complex64::cis(TAU * (at - frequency) * carrier.first_sample);
            carrier.coefficient(multiple) * response * pole(at, analogue.pga.gain_bandwidth / gain) * turned
        };
        let gains = (1.0 + analogue.adc.gain_error) * analogue.pga.gain(gain);
        2.0 * analogue.dac.lsb * gains * self.images.iter().map(image).sum::<Complex64>()
    }
}

fn pole(frequency: f64, corner: f64) -> Complex64 {
    1.0 / Complex64::new(1.0, frequency / corner)
}

/// Volts at the chip's pin per volt at the DAC.
fn before_amplifier(network: &Network, analogue: &Analogue, word: u16, frequency: f64) -> Complex64 {
    let coupling = 1.0 - pole(frequency, COUPLING);
    let sources = [analogue.dac.bandwidth, analogue.source.bandwidth].map(|corner| pole(frequency, corner));
    let drive = coupling * sources[0] * sources[1] * (1.0 + analogue.dac.gain_error);
    let weights = network.sensed();
    let voltages = network.phasors(selected(word), frequency);
    let sensed: Complex64 = voltages.iter().zip(weights.iter()).map(|(v, weight)| v * weight).sum();
    let amplifiers =
        [analogue.amplifier.bandwidth, analogue.amplifier.filter].map(|corner| pole(frequency, corner));
    drive
        * analogue.source.transconductance
        * sensed
        * analogue.amplifier.gain
        * amplifiers[0]
        * amplifiers[1]
}
