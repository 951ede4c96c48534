//! Modes: a network with source and amplifiers, taken apart into parts that each only decay.
//!
//! Between two changes (of the DAC, of a switch) everything is linear, so the whole chain
//!
//! ```text
//! drive d (decays through the coupling) -> DAC's and source's poles -> node voltages -> amplifier, filter, PGA
//! ```
//!
//! is a sum of exponentials. The network's own come from the eigenvectors of C^-1 G: v = M x with
//! M'CM = 1 and M'GM = diag(rates). A cascade of poles driven by exponentials is again one of
//! exponentials: a pole p responds to e^(-rt) with p/(p - r) e^(-rt), and adds its own e^(-pt). So
//! the physical values are w = T z, where every part `z[k]` decays at `rates[k]` alone, and T is lower
//! triangular with ones on its diagonal. A step of any length is one product for each part, and exact.

use super::{
    multiplexers::Closed,
    network::{NODES, Network, Nodal, SOURCE},
    parameters::Analogue,
};
use crate::chip::time::Time;
use nalgebra::{SVector, SymmetricEigen};
use std::f64::consts::{PI, TAU};

/// Parts of the state; physical values have the same order.
pub const PARTS: usize = NODES + 7;
/// A constant: 1, -1 or 0 while the source's output is held at its limit, or not.
pub const LIMIT: usize = 0;
/// Current that the drive asks for, A; falls to zero through the coupling capacitor.
pub const DRIVE: usize = 1;
/// The same as the DAC's buffer lets it through, A.
pub const SETTLED: usize = 2;
/// Current of the source, A.
pub const CURRENT: usize = 3;
/// First of the network's modes.
pub const MODES: usize = 4;
/// Output of the instrumentation amplifier, V, against half the supply.
pub const AMPLIFIER: usize = MODES + NODES;
/// Output of the PGA, V, against half the supply; the filter's lies between.
pub const OUTPUT: usize = AMPLIFIER + 2;

/// Frequency below which the source's input capacitor takes the drive away, Hz: 2.2 uF and 14 kohm.
pub const COUPLING: f64 = 5.2;
/// Poles as close as this are moved apart, as a share of their rate.
const CLOSE: f64 = 1e-6;
/// Steps whose decays are kept.
const KEPT_STEPS: usize = 16;

/// Physical values: `[part]`, and with node voltages in place of modes where they pass from one network to
/// another.
pub type Parts = [f64; PARTS];

/// Modes of the network alone.
#[derive(Clone, Debug)]
pub struct Modes {
    /// How fast each decays, 1/s.
    rates: [f64; NODES],
    /// Node voltages of modes: `[node][mode]`.
    voltages: Nodal,
    /// Modes of node voltages: `[mode][node]`.
    amplitudes: Nodal,
    /// What the amplifier sees of each.
    sensed: [f64; NODES],
    /// Noise before the amplifier, V/sqrt(Hz).
    noise: f64,
    /// Conductance that holds the source at its limit, S, and the voltage behind it, V.
    limit: Option<(f64, f64)>,
}

impl Modes {
    /// Modes of a network with these switches closed; `limit` as in [`Modes`], and noise as at a frequency, Hz.
    #[must_use]
    pub fn new(network: &Network, closed: Closed, limit: Option<(f64, f64)>, frequency: f64) -> Self {
        let mut conductance = network.conductance(closed);
        if let Some((siemens, _)) = limit {
            conductance[(SOURCE, SOURCE)] += siemens;
        }
        let (capacitance, whitening) = (network.capacitance(), network.whitening());
        let whitened = whitening * conductance * whitening.transpose();
        let eigen = SymmetricEigen::new((whitened + whitened.transpose()) / 2.0);
        let voltages = whitening.transpose() * eigen.eigenvectors;
        let sensed = voltages.transpose() * network.sensed();
        Self {
            rates: eigen.eigenvalues.map(|rate| rate.max(0.0)).into(),
            amplitudes: voltages.transpose() * capacitance,
            sensed: sensed.into(),
            noise: network.noise(closed, frequency),
            voltages,
            limit,
        }
    }
}

/// The whole chain with one network and one gain.
#[derive(Clone, Debug)]
pub struct Chain {
    modes: Modes,
    rates: Parts,
    /// Physical values of parts: lower triangle.
    physical: Box<[Parts; PARTS]>,
    /// What a drive of 1 A more does to the parts.
    jump: Parts,
    /// Voltage of the source's output.
    source: Parts,
    /// Whether the source may reach its limit.
    pub may_clamp: bool,
    /// Standard deviation of the noise of skin and amplifiers at the output, V.
    pub noise: f64,
    /// The amplifiers' slowest pole, 1/s.
    pub slowest_pole: f64,
    decays: Vec<(Time, Parts)>,
    oldest: usize,
}

impl Chain {
    /// The chain with this network and this gain of the PGA.
    #[must_use]
    pub fn new(modes: Modes, analogue: &Analogue, gain: f64, may_clamp: bool) -> Self {
        let mut chain = Self {
            rates: rates(&modes, analogue, gain),
            physical: Box::new([[0.0; PARTS]; PARTS]),
            jump: [0.0; PARTS],
            source: [0.0; PARTS],
            noise: analogue.noise(gain, modes.noise),
            slowest_pole: TAU * poles(analogue, gain).into_iter().fold(f64::INFINITY, f64::min),
            modes,
            may_clamp,
            decays: Vec::new(),
            oldest: 0,
        };
        chain.fill_drive();
        chain.fill_modes();
        chain.fill_poles(analogue, gain);
        chain.source = chain.combination(MODES, |mode| chain.modes.voltages[(SOURCE, mode)]);
        let mut drive = [0.0; PARTS];
        drive[DRIVE] = 1.0;
        chain.jump = chain.parts_of(&drive);
        chain
    }

    /// Lets time pass.
    pub fn decay(&mut self, parts: &mut Parts, step: Time) {
        let place = self.decays.iter().position(|(known, _)| *known == step);
        let place = place.unwrap_or_else(|| self.learn(step));
        let factors = &self.decays[place].1;
        parts.iter_mut().zip(factors).for_each(|(part, factor)| *part *= factor);
    }

    /// Changes the drive, A.
    pub fn drive(&self, parts: &mut Parts, change: f64) {
        parts.iter_mut().zip(&self.jump).for_each(|(part, jump)| *part += jump * change);
    }

    /// Output of the PGA against half the supply, V, if nothing limited it.
    #[must_use]
    pub fn output(&self, parts: &Parts) -> f64 {
        dot(&self.physical[OUTPUT], parts)
    }

    /// Voltage at the output of the current source.
    #[must_use]
    pub fn source_voltage(&self, parts: &Parts) -> f64 {
        dot(&self.source, parts)
    }

    /// Current of the source, A, if nothing limited it.
    #[must_use]
    pub fn current(&self, parts: &Parts) -> f64 {
        dot(&self.physical[CURRENT], parts)
    }

    /// Physical values, with node voltages in place of modes.
    #[must_use]
    pub fn values(&self, parts: &Parts) -> Parts {
        let mut values = [0.0; PARTS];
        values.iter_mut().zip(self.physical.iter()).for_each(|(value, row)| *value = dot(row, parts));
        let modes = SVector::<f64, NODES>::from_column_slice(&values[MODES..AMPLIFIER]);
        values[MODES..AMPLIFIER].copy_from_slice((self.modes.voltages * modes).as_slice());
        values
    }

    /// Parts of physical values with node voltages.
    #[must_use]
    pub fn parts(&self, values: &Parts) -> Parts {
        let voltages = SVector::<f64, NODES>::from_column_slice(&values[MODES..AMPLIFIER]);
        let mut with_modes = *values;
        with_modes[MODES..AMPLIFIER].copy_from_slice((self.modes.amplitudes * voltages).as_slice());
        self.parts_of(&with_modes)
    }

    /// Solves T z = w.
    fn parts_of(&self, values: &Parts) -> Parts {
        let mut parts = [0.0; PARTS];
        for row in 0..PARTS {
            parts[row] = values[row] - dot(&self.physical[row], &parts);
        }
        parts
    }

    fn learn(&mut self, step: Time) -> usize {
        let factors = self.rates.map(|rate| (-rate * step.seconds()).exp());
        if self.decays.len() < KEPT_STEPS {
            self.decays.push((step, factors));
            return self.decays.len() - 1;
        }
        self.oldest = (self.oldest + 1) % KEPT_STEPS;
        self.decays[self.oldest] = (step, factors);
        self.oldest
    }

    fn fill_drive(&mut self) {
        self.physical[LIMIT][LIMIT] = 1.0;
        self.physical[DRIVE][DRIVE] = 1.0;
        let mut input = self.physical[DRIVE];
        for part in [SETTLED, CURRENT] {
            self.follow(&mut input, part, 1.0);
        }
    }

    /// A pole behind `input`, which becomes its output: the row of `part`.
    fn follow(&mut self, input: &mut Parts, part: usize, gain: f64) {
        let pole = self.rates[part];
        for (earlier, value) in input.iter_mut().enumerate().take(part) {
            *value *= gain * pole / apart(pole, self.rates[earlier]);
        }
        input[part] = 1.0;
        self.physical[part] = *input;
    }

    /// x' = -rate x + (current and limit at the source's node).
    fn fill_modes(&mut self) {
        let (siemens, volts) = self.modes.limit.unwrap_or_default();
        for mode in 0..NODES {
            let (rate, at_source) = (self.rates[MODES + mode], self.modes.voltages[(SOURCE, mode)]);
            let current = self.physical[CURRENT];
            let row = &mut self.physical[MODES + mode];
            row[LIMIT] = at_source * siemens * volts / rate.max(f64::MIN_POSITIVE);
            for part in [DRIVE, SETTLED, CURRENT] {
                row[part] = at_source * current[part] / apart(rate, self.rates[part]);
            }
            row[MODES + mode] = 1.0;
        }
    }

    fn fill_poles(&mut self, analogue: &Analogue, gain: f64) {
        let mut input = self.combination(MODES, |mode| self.modes.sensed[mode]);
        let gains = [analogue.amplifier.gain, 1.0, analogue.pga.gain(gain)];
        for (place, gain) in gains.into_iter().enumerate() {
            self.follow(&mut input, AMPLIFIER + place, gain);
        }
    }

    /// The row of a sum over modes.
    fn combination(&self, first: usize, weight: impl Fn(usize) -> f64) -> Parts {
        let mut row = [0.0; PARTS];
        for mode in 0..NODES {
            let from = &self.physical[first + mode];
            row.iter_mut().zip(from).for_each(|(sum, value)| *sum += weight(mode) * value);
        }
        row
    }
}

fn rates(modes: &Modes, analogue: &Analogue, gain: f64) -> Parts {
    let mut rates = [0.0; PARTS];
    rates[DRIVE] = TAU * COUPLING;
    rates[SETTLED] = TAU * analogue.dac.bandwidth;
    rates[CURRENT] = TAU * analogue.source.bandwidth;
    rates[MODES..AMPLIFIER].copy_from_slice(&modes.rates);
    for (place, pole) in poles(analogue, gain).into_iter().enumerate() {
        rates[AMPLIFIER + place] = TAU * pole;
    }
    rates
}

/// Poles of amplifier, filter and PGA, Hz.
#[must_use]
pub fn poles(analogue: &Analogue, gain: f64) -> [f64; 3] {
    [analogue.amplifier.bandwidth, analogue.amplifier.filter, analogue.pga.gain_bandwidth / gain]
}

impl Analogue {
    /// Standard deviation of the noise at the chip's amplifier's output, V; `circuit` is that before the first amplifier,
    /// V/sqrt(Hz).
    #[must_use]
    pub fn noise(&self, gain: f64, circuit: f64) -> f64 {
        let density = (self.amplifier.gain * self.amplifier.noise.hypot(circuit)).hypot(self.pga.noise);
        gain * density * bandwidth(poles(self, gain)).sqrt()
    }
}

/// Noise bandwidth of three poles in a row, Hz: the residues of 1 / prod(1 + (f/p)^2), integrated.
#[must_use]
pub fn bandwidth(poles: [f64; 3]) -> f64 {
    // Equal poles would divide by zero.
    let poles = [poles[0], poles[1] * (1.0 + 1e-6), poles[2] * (1.0 - 1e-6)].map(|pole| pole * pole);
    let residue = |k: usize| {
        let others = (0..3).filter(|&other| other != k);
        poles[k].sqrt() * others.map(|other| poles[other] / (poles[other] - poles[k])).product::<f64>()
    };
    PI / 2.0 * (0..3).map(residue).sum::<f64>()
}

/// Difference of two rates, kept away from zero.
fn apart(pole: f64, rate: f64) -> f64 {
    let least = CLOSE * pole.max(rate);
    let difference = pole - rate;
    if difference.abs() < least { least } else { difference }
}

/// Four sums side by side, which a processor does at once.
fn dot(a: &Parts, b: &Parts) -> f64 {
    let (a, a_rest) = a.as_chunks::<4>();
    let (b, b_rest) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        (0..4).for_each(|lane| sums[lane] += a[lane] * b[lane]);
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}
