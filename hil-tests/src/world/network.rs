//! Network: skin, leads and multiplexers as nodes, conductances and capacitances.
//!
//! C dv/dt + G v = current. The capacitances are always the same ones; which switches are closed only
//! changes the conductances. A skin with capacitance is taken as conductance and capacitance side by side,
//! which is exact at the carrier's frequency.

use super::{
    fault::Fault,
    multiplexers::Closed,
    parameters::{Amplifier, Analogue, Source},
    skin::{Admittance, LEADS, with_resistance},
};
use nalgebra::{SMatrix, SVector};
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// The leads, then the commons of I+ (with the current source), V+ and V- (with the amplifier). That of I-
/// is ground.
pub const NODES: usize = LEADS + 3;
/// Common pin of the multiplexer I+, and output of the current source.
pub const SOURCE: usize = LEADS;
/// Common pin of V+.
pub const PLUS: usize = LEADS + 1;
/// Common pin of V-.
pub const MINUS: usize = LEADS + 2;

/// Every node leaks a little, so that none floats for ever, S.
const LEAK: f64 = 1e-12;
/// Every node has at least this capacitance, F.
const LEAST_CAPACITANCE: f64 = 1e-18;
/// Resistance of a short between two leads, ohm.
const SHORT: f64 = 1.0;

/// Boltzmann's constant times 300 K, J: resistances have a noise of 4 of it per ohm and hertz.
const THERMAL_ENERGY: f64 = 1.380_649e-23 * 300.0;

/// A matrix over all nodes.
pub type Nodal = SMatrix<f64, NODES, NODES>;

/// The network with its switches still open.
#[derive(Clone, Debug)]
pub struct Network {
    conductance: Nodal,
    capacitance: Nodal,
    /// Inverse of the lower triangle L with L L' = capacitance.
    whitening: Nodal,
    /// Conductance of each switch, S: `[I+, I-, V+, V-][channel]`.
    switches: [[f64; LEADS]; 4],
    source: Source,
    amplifier: Amplifier,
}

impl Network {
    /// The network of a skin at a frequency, Hz; `seed` says how the switches differ.
    #[must_use]
    pub fn new(analogue: &Analogue, skin: &Admittance, faults: &[Fault], frequency: f64, seed: u64) -> Self {
        let skin = broken_skin(skin, faults);
        let mut conductance = Nodal::identity() * LEAK;
        let mut capacitance = stray(analogue);
        for (row, values) in skin.iter().enumerate() {
            for (col, value) in values.iter().enumerate() {
                conductance[(row, col)] += value.re;
                capacitance[(row, col)] += value.im / (TAU * frequency);
            }
        }
        conductance[(SOURCE, SOURCE)] += 1.0 / analogue.source.output_resistance;
        for input in [PLUS, MINUS] {
            conductance[(input, input)] += 1.0 / analogue.amplifier.input_resistance;
        }
        short_leads(&mut conductance, faults);
        let (source, amplifier) = (analogue.source, analogue.amplifier);
        let root = capacitance.cholesky().expect("capacitances of a passive network").l();
        let whitening = root.solve_lower_triangular(&Nodal::identity()).expect("its diagonal is above zero");
        let switches = switches(analogue, seed);
        Self { conductance, capacitance, whitening, switches, source, amplifier }
    }

    /// Capacitances, F.
    #[must_use]
    pub fn capacitance(&self) -> &Nodal {
        &self.capacitance
    }

    /// A matrix W with W C W' = 1, C being the capacitances.
    #[must_use]
    pub fn whitening(&self) -> &Nodal {
        &self.whitening
    }

    /// By how much charges, C, change the voltages of the nodes.
    #[must_use]
    pub fn charged(&self, charges: &SVector<f64, NODES>) -> SVector<f64, NODES> {
        self.whitening.tr_mul(&(self.whitening * charges))
    }

    /// Conductances, S, with these switches closed.
    #[must_use]
    pub fn conductance(&self, closed: Closed) -> Nodal {
        let mut conductance = self.conductance;
        for (place, common) in [Some(SOURCE), None, Some(PLUS), Some(MINUS)].into_iter().enumerate() {
            let Some(channel) = closed[place].map(usize::from) else { continue };
            let siemens = self.switches[place][channel];
            match common {
                Some(common) => connect(&mut conductance, channel, common, siemens),
                // The common of I- is ground.
                None => conductance[(channel, channel)] += siemens,
            }
        }
        conductance
    }

    /// Voltage of each node per ampere of the current source, at a frequency, Hz.
    #[must_use]
    pub fn phasors(&self, closed: Closed, frequency: f64) -> SVector<Complex64, NODES> {
        self.voltages(closed, frequency, [SOURCE]).column(0).into_owned()
    }

    /// Density of the noise between the amplifier's inputs at a frequency, Hz, that is not the amplifier's voltage: of all
    /// resistances (4 k T times the impedance's real part, by Nyquist) and of the inputs' currents; V/sqrt(Hz).
    #[must_use]
    pub fn noise(&self, closed: Closed, frequency: f64) -> f64 {
        let voltages = self.voltages(closed, frequency, [PLUS, MINUS]);
        let [of_plus, of_minus] = [0, 1].map(|input| voltages[(PLUS, input)] - voltages[(MINUS, input)]);
        let thermal = 4.0 * THERMAL_ENERGY * (of_plus - of_minus).re;
        let currents = self.amplifier.current_noise.powi(2) * (of_plus.norm_sqr() + of_minus.norm_sqr());
        (thermal + currents).sqrt()
    }

    /// Voltages per ampere into each of these nodes: `[node][into]`.
    fn voltages<const N: usize>(
        &self,
        closed: Closed,
        frequency: f64,
        into: [usize; N],
    ) -> SMatrix<Complex64, NODES, N> {
        let conductance = self.conductance(closed);
        let admittance = SMatrix::<Complex64, NODES, NODES>::from_fn(|row, col| {
            Complex64::new(conductance[(row, col)], TAU * frequency * self.capacitance[(row, col)])
        });
        let currents =
            SMatrix::from_fn(|node, place| Complex64::from(f64::from(u8::from(into[place] == node))));
        admittance.lu().solve(&currents).expect("every node leaks, so that the network has a solution")
    }

    /// What the amplifier makes of node voltages: their difference, and a little of what both have in
    /// common; before its gain.
    #[must_use]
    pub fn sensed(&self) -> SVector<f64, NODES> {
        let mut weights = SVector::zeros();
        weights[PLUS] = 1.0 + self.amplifier.common_mode / 2.0;
        weights[MINUS] = -1.0 + self.amplifier.common_mode / 2.0;
        weights
    }

    /// Whether full current would take the source beyond its compliance.
    #[must_use]
    pub fn may_clamp(&self, closed: Closed, frequency: f64) -> bool {
        let volts = self.phasors(closed, frequency)[SOURCE].norm() * self.source.full_current();
        volts > 0.9 * self.source.compliance
    }
}

fn broken_skin(skin: &Admittance, faults: &[Fault]) -> Admittance {
    faults.iter().fold(*skin, |skin, fault| match *fault {
        Fault::ElectrodeOpen(electrode) => with_resistance(&skin, electrode, f64::INFINITY),
        Fault::BadContact { electrode, ohms } if ohms > 0 => {
            with_resistance(&skin, electrode, f64::from(ohms))
        }
        _ => skin,
    })
}

fn short_leads(conductance: &mut Nodal, faults: &[Fault]) {
    for fault in faults {
        if let Fault::PairShorted(a, b) = *fault {
            connect(conductance, a, b, 1.0 / SHORT);
        }
    }
}

/// An admittance between two nodes.
fn connect(matrix: &mut Nodal, a: usize, b: usize, value: f64) {
    matrix[(a, a)] += value;
    matrix[(b, b)] += value;
    matrix[(a, b)] -= value;
    matrix[(b, a)] -= value;
}

fn stray(analogue: &Analogue) -> Nodal {
    let multiplexer = &analogue.multiplexer;
    let lead = analogue.stray.to_ground + 4.0 * multiplexer.channel_capacitance;
    let input = multiplexer.common_capacitance + analogue.amplifier.input_capacitance;
    let mut capacitance = Nodal::identity() * LEAST_CAPACITANCE;
    (0..LEADS).for_each(|node| capacitance[(node, node)] += lead);
    (1..LEADS).for_each(|node| connect(&mut capacitance, node - 1, node, analogue.stray.between));
    capacitance[(SOURCE, SOURCE)] += multiplexer.common_capacitance + analogue.source.output_capacitance;
    capacitance[(PLUS, PLUS)] += input;
    capacitance[(MINUS, MINUS)] += input;
    capacitance
}

fn switches(analogue: &Analogue, seed: u64) -> [[f64; LEADS]; 4] {
    let mut random = Pcg64::seed_from_u64(seed);
    let (mean, spread) = (analogue.multiplexer.on_resistance, analogue.multiplexer.on_resistance_match);
    [(); 4].map(|()| [(); LEADS].map(|()| 1.0 / (mean + spread * (random.random::<f64>() - 0.5))))
}
