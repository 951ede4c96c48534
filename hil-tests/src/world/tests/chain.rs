use super::{super::multiplexers::word, Chip, analogue, handle, ideal, words};
use crate::{
    chip::{
        time::Time,
        world::{OpampSetting, World},
    },
    world::{Analogue, AnalogueWorld, Setup, WorldHandle},
};
use dermatome::simulate::Press;
use num_complex::Complex64;

/// Samples until the start of the DAC has left the coupling capacitor.
const SETTLED: usize = 1_000_000;

#[test]
fn a_lock_in_finds_what_the_frequencies_say() {
    let handle = handle(analogue());
    handle.press(&[Press::finger([0.02, 0.05], 0.02, 0.8)]);
    for (words_per_period, amplitude, gain) in [(5, 1500.0, 1.0), (20, 200.0, 16.0), (80, 1500.0, 2.0)] {
        let mut chip = Chip::new(&handle, words_per_period, amplitude);
        chip.gain(gain);
        chip.run(SETTLED);
        for channels in [[0, 1, 3, 4], [0, 1, 8, 9], [6, 7, 14, 15]] {
            let word = word(channels);
            chip.select(word);
            chip.run(400 - 2 + 320);
            let (found, expected) = (chip.demodulate(4), handle.expected(word, gain, &chip.carrier));
            let error = (found - expected).norm() / expected.norm();
            assert!(error < 1e-5, "{words_per_period} words, {channels:?}: {found} for {expected}");
        }
    }
}

/// Largest distance of demodulated voltages from the truth times one complex factor, over the largest
/// voltage.
fn distance_from_truth(analogue: Analogue, words_per_period: usize) -> f64 {
    let handle = handle(analogue);
    let carrier = Chip::new(&handle, words_per_period, 1500.0).carrier;
    handle.set_frequency(carrier.frequency()).unwrap();
    let pairs: Vec<_> =
        words().iter().map(|&word| (handle.truth(word), handle.expected(word, 1.0, &carrier))).collect();
    let energy: f64 = pairs.iter().map(|(truth, _)| truth.norm_sqr()).sum();
    let factor = pairs.iter().map(|(truth, volts)| volts * truth.conj()).sum::<Complex64>() / energy;
    let full = pairs.iter().map(|(_, volts)| volts.norm()).fold(0.0, f64::max);
    let worst = pairs.iter().map(|(truth, volts)| (volts - factor * truth).norm()).fold(0.0, f64::max);
    worst / full
}

#[test]
fn demodulated_voltages_are_in_proportion_to_the_truth() {
    for words_per_period in [5, 10, 20, 50, 80] {
        let mut parts = analogue();
        let real = distance_from_truth(parts.clone(), words_per_period);
        parts.amplifier.common_mode = 0.0;
        let balanced = distance_from_truth(parts, words_per_period);
        let ideal = distance_from_truth(ideal(), words_per_period);
        println!(
            "{words_per_period} words: {real:.2e}, without common mode {balanced:.2e}, ideal {ideal:.2e}"
        );
        // Images of the carrier see the strays at other frequencies than the carrier does.
        assert!(ideal < 1e-7 && balanced < 3e-2 && real < 3e-2);
    }
}

#[test]
fn what_a_switch_leaves_behind_decays() {
    let handle = handle(analogue());
    let mut chip = Chip::new(&handle, 20, 1500.0);
    chip.run(SETTLED);
    let (first, second) = (word([0, 1, 3, 4]), word([8, 9, 0, 15]));
    chip.select(first);
    chip.run(398);
    // The same samples once the word has been there for long, and right after the switch.
    let settled: Vec<f64> = {
        chip.select(second);
        chip.run(398);
        (0..40).map(|_| chip.sample()).collect()
    };
    chip.select(first);
    chip.run(398 - 40);
    chip.select(second);
    chip.run(38);
    let early: Vec<f64> = (0..40).map(|_| chip.sample()).collect();
    let error = |sample: usize| (early[sample] - settled[sample]).abs();
    assert!(error(39) < 1e-4, "{} V after 40 us", error(39));
    chip.select(first);
    chip.run(398);
    chip.select(second);
    let at_once: Vec<f64> = (0..38).map(|_| chip.sample()).collect();
    assert!((at_once[0] - settled[2]).abs() > 1e-3, "{} {}", at_once[0], settled[2]);
}

#[test]
fn the_source_rises_no_further_than_its_limit_while_all_switches_are_open() {
    let handle = handle(analogue());
    let source = handle.setup().analogue.source;
    let mut chip = Chip::new(&handle, 20, 1500.0);
    chip.run(SETTLED / 4);
    let now = chip.now();
    chip.world.pins('C', super::LARGE, now);
    let highest = (0..400).map(|_| {
        chip.sample();
        chip.world.source_voltage().abs()
    });
    let highest = highest.fold(0.0, f64::max);
    assert!(highest > source.compliance, "{highest} V");
    // A step of 59 ns may go a little too far.
    assert!(highest < source.open_voltage + 1.0, "{highest} V");
}

#[test]
fn noise_has_the_spread_that_its_parts_add_up_to() {
    let handle = handle(ideal());
    handle.noise(1.0);
    let mut world = AnalogueWorld::new(handle.clone());
    let parts = handle.setup().analogue.clone();
    world.pins('B', word([0, 1, 3, 8]), Time::ZERO);
    world.pins('C', super::ENABLED, Time::ZERO);
    // Two switches, and the skin as a current through these electrodes sees it; 4 k T at 300 K.
    let resistance = 2.0 * parts.multiplexer.on_resistance + handle.truth(word([3, 8, 3, 8])).re;
    let thermal = (1.657e-20 * resistance).sqrt();
    assert!((2.0e-9..4.0e-9).contains(&thermal), "{thermal}");
    for gain in [1.0, 16.0] {
        world.opamp(2, OpampSetting::Amplifier { input: 0, gain }, Time::ZERO);
        let samples: Vec<f64> =
            (1..200_000).map(|tick| world.voltage(2, 16, Time::from_nanos(500 * tick))).collect();
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        let variance =
            samples.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / samples.len() as f64;
        // Three poles, integrated the slow way.
        let poles = crate::world::modes::poles(&parts, gain);
        let power = |f: f64| poles.iter().map(|pole| 1.0 / (1.0 + (f / pole).powi(2))).product::<f64>();
        let bandwidth: f64 = (0..200_000).map(|k| power(500.0 * (f64::from(k) + 0.5)) * 500.0).sum();
        let density =
            (parts.amplifier.gain * parts.amplifier.noise.hypot(thermal)).hypot(parts.pga.noise) * gain;
        let expected = (density * bandwidth.sqrt()).hypot(parts.adc.noise);
        assert!((mean - 1.65).abs() < 0.02 * expected, "gain {gain}: mean {mean}");
        assert!(
            (variance.sqrt() / expected - 1.0).abs() < 0.02,
            "gain {gain}: {} {expected}",
            variance.sqrt()
        );
    }
}

#[test]
fn the_same_seed_gives_the_same_samples_and_another_seed_others() {
    let record = |seed| {
        let handle = WorldHandle::new(Setup::new(super::skin(), analogue(), 0.0, seed).unwrap());
        let mut chip = Chip::new(&handle, 20, 1500.0);
        chip.select(word([0, 1, 3, 4]));
        (0..2000).map(|_| chip.sample().to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(record(1), record(1));
    assert_ne!(record(1), record(2));
}

#[test]
fn too_much_gain_is_cut_off_at_the_rails() {
    let handle = handle(analogue());
    let mut chip = Chip::new(&handle, 20, 1700.0);
    chip.gain(64.0);
    chip.select(word([0, 1, 2, 3]));
    chip.run(SETTLED);
    let samples: Vec<f64> = (0..400).map(|_| chip.sample()).collect();
    let (low, high) =
        samples.iter().fold((9.0, 0.0), |(low, high): (f64, f64), &v| (low.min(v), high.max(v)));
    let adc = handle.setup().analogue.adc.offset;
    assert!((low - adc - 0.1).abs() < 1e-9 && (high - adc - 3.2).abs() < 1e-9, "{low} to {high}");
}

#[test]
fn the_temperature_sensor_follows_the_datasheet_and_what_is_not_wired_reads_nothing() {
    let handle = handle(analogue());
    let mut world = AnalogueWorld::new(handle.clone());
    handle.temperature(30.0);
    assert!((world.voltage(1, 16, Time::from_millis(1)) - 0.76).abs() < 1e-12);
    handle.temperature(70.0);
    assert!((world.voltage(1, 16, Time::from_millis(2)) - 0.86).abs() < 1e-12);
    // OPAMP2 is off.
    assert_eq!(world.voltage(2, 16, Time::from_millis(3)), 0.0);
}
