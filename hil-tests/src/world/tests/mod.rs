//! The world is poked as the chip pokes it; no firmware runs.

mod chain;
mod faults;
mod network;
mod parameters;
mod range;
mod skin;

use super::{
    Analogue, AnalogueWorld, Carrier, Setup, WorldHandle,
    multiplexers::word,
    parameters::{Adc, Multiplexer, Pga, Ranges, Source, Stray},
};
use crate::chip::{
    time::Time,
    world::{OpampSetting, World},
};
use dermatome::skin::Skin;
use dermatome_shared::stimulation::{Driven, pattern};
use num_complex::Complex64;
use std::{f64::consts::TAU, path::Path};

const CORE: u64 = 170_000_000;

/// A disc like `models/disc-210mm` on a coarse mesh.
fn skin() -> Skin {
    let text = r#"
        name = "coarse-disc"
        [shape]
        kind = "disc"
        diameter = "210 mm"
        [mesh]
        edge_length = "14 mm"
        [material]
        sheet_conductivity = "5.88 mS"
        [electrodes]
        count = 16
        placement = "rim"
        model = "complete"
        width = "11 mm"
        contact_impedance = "0.18 ohm m"
        [drive]
        pattern = "adjacent"
        reciprocal = "combined"
        frequency = "50 kHz"
        amplitude = "1 mA"
        frame_rate = "50 Hz"
        [inverse]
        prior = "laplace"
        hyperparameter = 0.03
        normalised = true
        [image]
        columns = 16
        [contact]
        threshold = 0.05
    "#;
    Skin::parse(Path::new("coarse-disc.toml"), text).unwrap().made().unwrap()
}

/// The front end of the emulated board.
fn analogue() -> Analogue {
    Analogue::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/rigs/analogue.toml"))).unwrap()
}

/// The same with nothing that falsifies: no strays, a source without end, inputs that take nothing.
fn ideal() -> Analogue {
    let real = analogue();
    let endless = |source| Source { output_resistance: 1e15, output_capacitance: 0.0, ..source };
    let (large, small) = (endless(real.ranges.large), endless(real.ranges.small));
    Analogue {
        source: large,
        ranges: Ranges { large, small, ..real.ranges },
        multiplexer: Multiplexer {
            on_resistance_match: 0.0,
            common_capacitance: 0.0,
            channel_capacitance: 0.0,
            charge_injection: 0.0,
            ..real.multiplexer
        },
        amplifier: super::parameters::Amplifier {
            input_capacitance: 0.0,
            input_resistance: 1e15,
            common_mode: 0.0,
            current_noise: 0.0,
            ..real.amplifier
        },
        pga: Pga { offset: 0.0, ..real.pga },
        adc: Adc { offset: 0.0, ..real.adc },
        stray: Stray { to_ground: 0.0, between: 0.0 },
        ..real
    }
}

fn handle(analogue: Analogue) -> WorldHandle {
    let handle = WorldHandle::new(Setup::new(skin(), analogue, 0.0, 7).unwrap());
    handle.noise(0.0);
    handle.set_small_range(false);
    handle
}

/// Pins of port C: the multiplexers' enable, and the large range.
const ENABLED: u16 = 1 << 6 | LARGE;
const LARGE: u16 = 1 << 8;

/// The 208 words of the adjacent pattern.
fn words() -> Vec<u16> {
    pattern(16, 1, 1, Driven::Skipped).map(|step| word(step.to_bytes())).collect()
}

/// A chip that puts out a carrier and samples: 1 MS/s out, 2 MS/s in, on one time base.
struct Chip {
    world: AnalogueWorld,
    carrier: Carrier,
    tick: u64,
}

impl Chip {
    fn new(handle: &WorldHandle, words_per_period: usize, amplitude: f64) -> Self {
        // Some tens of nanoseconds after its trigger.
        let carrier = Carrier::sine(words_per_period, amplitude, 26.0 / CORE as f64);
        let mut chip = Self { world: AnalogueWorld::new(handle.clone()), carrier, tick: 0 };
        chip.gain(1.0);
        chip.world.pins('C', ENABLED, Time::ZERO);
        chip
    }

    fn now(&self) -> Time {
        Time::period(CORE) * (85 * self.tick)
    }

    fn gain(&mut self, gain: f64) {
        let now = self.now();
        self.world.opamp(2, OpampSetting::Amplifier { input: 0, gain }, now);
    }

    /// Switches to a word with the enable pin low for a microsecond, as the board does.
    fn select(&mut self, word: u16) {
        let now = self.now();
        self.world.pins('C', LARGE, now);
        self.world.pins('B', word, now);
        self.sample();
        self.sample();
        let now = self.now();
        self.world.pins('C', ENABLED, now);
    }

    fn sample(&mut self) -> f64 {
        let now = self.now();
        if self.tick.is_multiple_of(2) {
            let place = (self.tick / 2) as usize % self.carrier.codes.len();
            self.world.dac(1, 0, Some(self.carrier.codes[place]), now);
        }
        self.tick += 1;
        self.world.voltage(2, 16, now + Time::period(CORE) * 26)
    }

    fn run(&mut self, samples: usize) {
        for _ in 0..samples {
            self.sample();
        }
    }

    /// Lock-in over whole periods, V.
    fn demodulate(&mut self, periods: usize) -> Complex64 {
        let samples = periods * self.carrier.samples_per_period;
        let mut sum = Complex64::default();
        for _ in 0..samples {
            let time = self.tick as f64 * 0.5e-6 + self.carrier.first_sample;
            sum += self.sample() * Complex64::cis(-TAU * self.carrier.frequency() * time);
        }
        2.0 * sum / samples as f64
    }
}
