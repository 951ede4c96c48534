use super::{super::*, analogue, ideal};
use crate::world::{
    multiplexers::{selected, word},
    network::{MINUS, Network, PLUS, SOURCE},
    skin::{Admittance, LEADS, with_resistance},
};
use num_complex::Complex64;

/// Sixteen equal resistors in a ring, one electrode at each joint.
fn ring(ohms: f64) -> Admittance {
    let mut admittance = [[Complex64::default(); LEADS]; LEADS];
    for a in 0..LEADS {
        let b = (a + 1) % LEADS;
        admittance[a][a] += 1.0 / ohms;
        admittance[b][b] += 1.0 / ohms;
        admittance[a][b] -= 1.0 / ohms;
        admittance[b][a] -= 1.0 / ohms;
    }
    admittance
}

fn sensed(analogue: &Analogue, skin: &Admittance, faults: &[Fault], channels: [u8; 4]) -> Complex64 {
    let network = Network::new(analogue, skin, faults, 50e3, 1);
    let voltages = network.phasors(selected(word(channels)), 50e3);
    voltages[PLUS] - voltages[MINUS]
}

fn assert_near(value: Complex64, expected: Complex64, tolerance: f64) {
    assert!((value - expected).norm() <= tolerance, "{value} is not {expected}");
}

#[test]
fn a_ring_of_resistors_divides_the_current_as_by_hand() {
    // 1/16 of the current takes the long way, from electrode 5 to electrode 4.
    let volts = sensed(&ideal(), &ring(100.0), &[], [0, 1, 4, 5]);
    assert_near(volts, Complex64::from(-100.0 / 16.0), 1e-5);
    // Opposite drive: half of it each way.
    let volts = sensed(&ideal(), &ring(100.0), &[], [0, 8, 2, 3]);
    assert_near(volts, Complex64::from(50.0), 1e-4);
}

#[test]
fn a_source_with_an_output_resistance_drives_less_into_a_load() {
    let mut analogue = ideal();
    analogue.source.output_resistance = 1000.0;
    // 200 ohm in each switch and 50 || 50 * 8 ... = 400 ohm of the ring.
    let load = 400.0 + 400.0;
    let volts = sensed(&analogue, &ring(100.0), &[], [0, 8, 2, 3]);
    assert_near(volts, Complex64::from(50.0 * 1000.0 / (1000.0 + load)), 1e-4);
}

#[test]
fn a_capacitor_at_the_source_takes_its_share_in_quadrature() {
    let mut analogue = ideal();
    analogue.source.output_capacitance = 1e-9;
    let susceptance = Complex64::new(0.0, std::f64::consts::TAU * 50e3 * 1e-9);
    let volts = sensed(&analogue, &ring(100.0), &[], [0, 8, 2, 3]);
    assert_near(volts, 50.0 / (1.0 + 800.0 * susceptance), 1e-4);
}

#[test]
fn a_bad_contact_adds_its_resistance_and_an_open_one_leaves_the_rest() {
    let skin = with_resistance(&ring(100.0), 3, 50.0);
    let volts = sensed(&ideal(), &skin, &[], [3, 11, 3, 11]);
    assert_near(volts, Complex64::from(450.0), 1e-3);
    // Without electrode 3 the ring is still a ring.
    let open = [Fault::ElectrodeOpen(3)];
    assert_near(sensed(&ideal(), &ring(100.0), &open, [0, 8, 1, 2]), Complex64::from(50.0), 1e-3);
    assert_near(sensed(&ideal(), &ring(100.0), &open, [0, 8, 2, 4]), Complex64::from(100.0), 1e-3);
}

#[test]
fn a_shorted_pair_has_next_to_no_voltage() {
    let volts = sensed(&ideal(), &ring(100.0), &[Fault::PairShorted(2, 3)], [0, 8, 2, 3]);
    assert!(volts.norm() < 1.0, "{volts}");
}

#[test]
fn the_real_front_end_is_passive_and_loses_a_little() {
    let network = Network::new(&analogue(), &ring(100.0), &[], 50e3, 1);
    assert!(network.capacitance().cholesky().is_some());
    let source = network.phasors(selected(word([0, 8, 2, 3])), 50e3)[SOURCE];
    assert!(source.re > 700.0 && source.re < 900.0 && source.im < 0.0, "{source}");
}
