//! A Preisach neural network: the compensator that thesis section 6.2 suggests. It stays on the host.
//!
//! Its first layer is fixed: the strength, and play operators of it, which hold what a Preisach operator
//! remembers. A hidden layer of tanh units and a linear output learn the pressure from them (after Adly and
//! Abd-El-Hafiz, IEEE Trans. Magnetics 34, 1998, who feed a network from elementary hysteresis operators). Weights
//! follow from whole batches by Adam, from a fixed seed.

use super::Reading;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Thresholds of the play operators, shares of the largest strength.
const WIDTHS: [f64; 7] = [0.01, 0.03, 0.06, 0.12, 0.2, 0.3, 0.45];
const INPUTS: usize = WIDTHS.len() + 2;
const UNITS: usize = 10;
const ROUNDS: usize = 6000;
const RATE: f64 = 0.01;
/// Price of large weights.
const DECAY: f64 = 1e-4;

/// A trained network.
#[derive(Clone, Debug)]
pub struct Network {
    /// `[unit][input]`; the last input is 1.
    hidden: DMatrix<f64>,
    /// `[unit]`, and the offset.
    output: DVector<f64>,
    largest: Reading,
}

impl Network {
    /// Learns from sequences of readings, each of which starts on an untouched place.
    #[must_use]
    pub fn train(sequences: &[&[Reading]], seed: u64) -> Self {
        let largest = largest(sequences.iter().copied().flatten());
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut normal = |scale: f64| -> f64 {
            let value: f64 = StandardNormal.sample(&mut random);
            scale * value
        };
        let mut network = Self {
            hidden: DMatrix::from_fn(UNITS, INPUTS, |_, _| normal(0.7)),
            output: DVector::from_fn(UNITS + 1, |_, _| normal(0.3)),
            largest,
        };
        let (mut inputs, mut wanted) = (Vec::new(), Vec::new());
        for sequence in sequences {
            let strengths: Vec<f64> = sequence.iter().map(|reading| reading.strength).collect();
            inputs.extend(network.inputs(&strengths));
            wanted.extend(sequence.iter().map(|reading| reading.pressure_kpa / largest.pressure_kpa));
        }
        network.descend(&DMatrix::from_columns(&inputs), &DVector::from_vec(wanted));
        network
    }

    /// Pressures of a sequence that starts on an untouched place, kPa.
    #[must_use]
    pub fn pressures(&self, strengths: &[f64]) -> Vec<f64> {
        let inputs = self.inputs(strengths);
        let pressure = |input: &DVector<f64>| {
            let units = (&self.hidden * input).map(f64::tanh).push(1.0);
            (units.dot(&self.output) * self.largest.pressure_kpa).max(0.0)
        };
        inputs.iter().map(pressure).collect()
    }

    /// The fixed layer: `[reading]` of `[input]`.
    fn inputs(&self, strengths: &[f64]) -> Vec<DVector<f64>> {
        let mut states = [0.0_f64; WIDTHS.len()];
        let input = |strength: &f64| {
            let x = strength / self.largest.strength;
            for (state, width) in states.iter_mut().zip(WIDTHS) {
                *state = state.clamp(x - width, x + width);
            }
            let differences = states.iter().map(|state| x - state);
            DVector::from_iterator(INPUTS, [x].into_iter().chain(differences).chain([1.0]))
        };
        strengths.iter().map(input).collect()
    }

    /// Adam (Kingma and Ba, 2015) on the mean square error of all readings.
    fn descend(&mut self, inputs: &DMatrix<f64>, wanted: &DVector<f64>) {
        let count = wanted.len() as f64;
        let mut of_hidden = Moments::new(UNITS, INPUTS);
        let mut of_output = Moments::new(UNITS + 1, 1);
        for round in 1..=ROUNDS {
            let units = (&self.hidden * inputs).map(f64::tanh);
            let with_offset = units.clone().insert_row(UNITS, 1.0);
            let errors = with_offset.transpose() * &self.output - wanted;
            let output_slope = &with_offset * &errors / count + DECAY * &self.output;
            let back = self.output.rows(0, UNITS) * errors.transpose();
            let back = back.component_mul(&units.map(|unit| 1.0 - unit * unit));
            let hidden_slope = back * inputs.transpose() / count + DECAY * &self.hidden;
            self.hidden -= of_hidden.step(&hidden_slope, round);
            let output_slope = DMatrix::from_column_slice(UNITS + 1, 1, output_slope.as_slice());
            self.output -= of_output.step(&output_slope, round).column(0);
        }
    }
}

fn largest<'a>(readings: impl Iterator<Item = &'a Reading>) -> Reading {
    let tiny = f64::MIN_POSITIVE;
    let least = Reading { pressure_kpa: tiny, strength: tiny, deviation: 0.0, area_mm2: None, place: None };
    readings.fold(least, |max, reading| Reading {
        pressure_kpa: max.pressure_kpa.max(reading.pressure_kpa),
        strength: max.strength.max(reading.strength),
        ..max
    })
}

/// Running means of a slope and of its square.
struct Moments([DMatrix<f64>; 2]);

impl Moments {
    fn new(rows: usize, columns: usize) -> Self {
        Self([DMatrix::zeros(rows, columns), DMatrix::zeros(rows, columns)])
    }

    fn step(&mut self, slope: &DMatrix<f64>, round: usize) -> DMatrix<f64> {
        let [mean, square] = &mut self.0;
        *mean = &*mean * 0.9 + slope * 0.1;
        *square = &*square * 0.999 + slope.component_mul(slope) * 0.001;
        let [fresh, fresh_square] = [0.9_f64, 0.999].map(|keep| 1.0 - keep.powi(round as i32));
        let rate = RATE * (1.0 - round as f64 / ROUNDS as f64).max(0.05);
        mean.zip_map(square, |m, s| rate * (m / fresh) / ((s / fresh_square).sqrt() + 1e-8))
    }
}
