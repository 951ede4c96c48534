use super::{super::multiplexers::word, Chip, analogue, handle, words};
use crate::{
    chip::world::World,
    world::{Fault, WorldHandle},
};
use num_complex::Complex64;

/// Largest change of a step against the largest step.
fn change(handle: &WorldHandle, fault: Fault) -> f64 {
    handle.mend();
    let truth =
        |handle: &WorldHandle| words().iter().map(|&word| handle.truth(word)).collect::<Vec<Complex64>>();
    let whole = truth(handle);
    handle.inject(fault).unwrap();
    let broken = truth(handle);
    let full = whole.iter().map(|volts| volts.norm()).fold(0.0, f64::max);
    whole.iter().zip(&broken).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / full
}

#[test]
fn every_broken_electrode_pair_and_line_shows_in_the_frame() {
    let handle = handle(analogue());
    let opens = (0..16).map(Fault::ElectrodeOpen);
    let shorts = (0..16).map(|electrode| Fault::PairShorted(electrode, (electrode + 1) % 16));
    let lines = (0..16).flat_map(|line| [false, true].map(|high| Fault::LineStuck { line, high }));
    for fault in opens.chain(shorts).chain(lines) {
        let change = change(&handle, fault);
        assert!(change > 0.1, "{fault}: {change}");
    }
    let bad = change(&handle, Fault::BadContact { electrode: 4, ohms: 1000 });
    assert!(bad > 1e-3, "{bad}");
}

#[test]
fn a_drive_through_an_open_electrode_takes_the_source_to_its_limit() {
    let handle = handle(analogue());
    let source = handle.setup().analogue.source;
    let peak = |handle: &WorldHandle| {
        let mut chip = Chip::new(handle, 20, 1700.0);
        chip.run(250_000);
        chip.select(word([0, 1, 3, 4]));
        chip.run(400);
        let volts = (0..400).map(|_| {
            chip.sample();
            chip.world.source_voltage().abs()
        });
        volts.fold(0.0, f64::max)
    };
    assert!(peak(&handle) < source.compliance);
    handle.inject(Fault::ElectrodeOpen(0)).unwrap();
    let limited = peak(&handle);
    assert!(limited > source.compliance && limited < source.open_voltage + 0.3, "{limited} V");
    handle.mend();
    assert!(peak(&handle) < source.compliance);
}

#[test]
fn a_dead_dac_gives_silence_and_a_saturated_converter_its_highest_code() {
    let handle = handle(analogue());
    let mut chip = Chip::new(&handle, 20, 1500.0);
    chip.select(word([0, 1, 3, 4]));
    chip.run(400_000 - 2);
    let alive = chip.demodulate(4).norm();
    handle.inject(Fault::DacDead).unwrap();
    chip.run(400_000);
    let dead = chip.demodulate(4).norm();
    assert!(dead < 1e-5 * alive, "{dead} V of {alive} V");
    handle.mend();
    handle.inject(Fault::AdcSaturated).unwrap();
    let now = chip.now();
    assert_eq!(chip.world.voltage(2, 16, now), 3.3);
}

#[test]
fn faults_that_cannot_be_are_refused() {
    let handle = handle(analogue());
    for fault in [
        Fault::ElectrodeOpen(16),
        Fault::PairShorted(3, 3),
        Fault::PairShorted(3, 16),
        Fault::LineStuck { line: 16, high: true },
    ] {
        assert!(handle.inject(fault).unwrap_err().to_string().contains("allowed"));
    }
}
