//! Offsets of channels and instruments that do not settle, alone and with something else wrong.

use super::*;
use crate::recorded::check::{findings::Level, reading::Misplacement};

/// An instrument that adds to a body's voltages, in shares of their median magnitude.
#[derive(Clone, Copy)]
struct Adds {
    common: f64,
    /// Standard deviation of the channels' offsets.
    apart: f64,
    kept: f64,
}

/// Voltages of a body that the model knows only roughly, at 60 dB: the first model is the body's, the second the file's.
fn bodies(seed: u64) -> (Expected, Expected) {
    (adjacent(seed), disc_of(16, pattern(16, 1, 1, Driven::Skipped).collect(), seed, 0.02))
}

/// Frames of voltages `[step]` as such an instrument records them, and the offsets of its channels.
fn recorded(body: &Expected, clean: &[f64], adds: Adds, seed: u64) -> (Frames, Vec<f64>) {
    let mut random = Pcg64::seed_from_u64(seed);
    let size = crate::recorded::statistics::median(clean.iter().map(|value| value.abs()));
    let offsets: Vec<f64> = (0..16)
        .map(|_| {
            let normal: f64 = (0..12).map(|_| random.random_range(-0.5..0.5)).sum();
            size * (adds.common + adds.apart * normal)
        })
        .collect();
    let mut values: Vec<Complex64> = Vec::new();
    let mut before = offsets[0];
    for _ in 0..20 {
        for (step, voltage) in body.steps.iter().zip(clean) {
            let noise = 0.001 * size * random.random_range(-1.0..1.0);
            let value = voltage + offsets[usize::from(step.sense_plus)];
            before = (1.0 - adds.kept) * value + adds.kept * before;
            values.push((before + noise).into());
        }
    }
    (Frames { values, frames: 20, measurements: clean.len(), complex: false }, offsets)
}

fn voltages(body: &Expected) -> Vec<f64> {
    body.steps.iter().map(|&step| body.voltage(step)).collect()
}

fn faults(check: &Check) -> Vec<About> {
    check.findings.iter().filter(|it| it.level == Level::Fault).map(|it| it.about).collect()
}

const ALL: [Adds; 7] = [
    Adds { common: 0.0, apart: 0.0, kept: 0.05 },
    Adds { common: 0.0, apart: 0.0, kept: 0.12 },
    Adds { common: 0.0, apart: 0.0, kept: 0.3 },
    Adds { common: 20.0, apart: 0.2, kept: 0.0 },
    Adds { common: 20.0, apart: 1.0, kept: 0.0 },
    Adds { common: 20.0, apart: 0.4, kept: 0.12 },
    Adds { common: 5.0, apart: 0.3, kept: 0.3 },
];

#[test]
fn offsets_of_channels_and_what_is_kept_of_the_value_before_are_measured() {
    for (case, adds) in ALL.into_iter().enumerate() {
        for seed in 1..6 {
            let (body, model) = bodies(seed);
            let (frames, offsets) = recorded(&body, &voltages(&body), adds, seed);
            let found = check(&model, &frames, PLAIN).unwrap();
            let mut expected = Vec::new();
            expected.extend((adds.common > 0.0).then_some(About::Offset));
            expected.extend((adds.apart > 0.0).then_some(About::ChannelOffsets));
            expected.extend((adds.kept > 0.0).then_some(About::Settling));
            assert_eq!(faults(&found), expected, "{case}, {seed}: {:#?}", found.findings);
            let error = found.kept_percent - 100.0 * adds.kept;
            assert!(error.abs() < 1.0, "{case}, {seed}: kept {}", found.kept_percent);
            let spread = |values: &[f64]| {
                let mean = values.iter().sum::<f64>() / 16.0;
                values.iter().map(|value| value - mean).collect::<Vec<_>>()
            };
            let told: Vec<f64> = found.channel_offsets.iter().map(|it| it.value).collect();
            let size = crate::recorded::statistics::median(voltages(&body).into_iter().map(f64::abs));
            for (told, offset) in spread(&told).iter().zip(spread(&offsets)) {
                assert!((told - offset).abs() < 0.05 * size, "{case}, {seed}: {told} instead of {offset}");
            }
        }
    }
}

#[test]
fn good_frames_of_a_body_that_the_model_knows_only_roughly_blame_no_channel() {
    for seed in 1..20 {
        let (body, model) = bodies(seed);
        let mut random = Pcg64::seed_from_u64(seed);
        let gains: Vec<f64> = (0..16).map(|_| 1.0 + random.random_range(-0.03..0.03)).collect();
        let clean: Vec<f64> =
            body.steps.iter().map(|&step| body.voltage(step) * gains[usize::from(step.sense_plus)]).collect();
        let none = Adds { common: 0.0, apart: 0.0, kept: 0.0 };
        let found = check(&model, &recorded(&body, &clean, none, seed).0, PLAIN).unwrap();
        assert_eq!(faults(&found), [], "{seed}: {:#?}", found.findings);
    }
}

const RAW: Adds = Adds { common: 20.0, apart: 0.3, kept: 0.12 };
const OF_INSTRUMENT: [About; 3] = [About::Offset, About::ChannelOffsets, About::Settling];

/// Faults besides those of the instrument.
fn others(check: &Check) -> Vec<About> {
    let faults = faults(check).into_iter();
    faults.filter(|about| !OF_INSTRUMENT.contains(about) && *about != About::Reciprocity).collect()
}

#[test]
fn exchanged_electrodes_are_named_although_the_instrument_adds_to_each_value() {
    for (seed, electrodes) in [(1, [2, 3]), (2, [4, 11]), (3, [0, 15]), (4, [7, 9])] {
        let (body, model) = bodies(seed);
        let exchange = Exchange { electrodes, role: Role::Both };
        let wiring = Wiring::new(PLAIN, 16).with(exchange);
        let clean: Vec<f64> = body.steps.iter().map(|&step| body.voltage(wiring.step(step))).collect();
        let found = check(&model, &recorded(&body, &clean, RAW, seed).0, PLAIN).unwrap();
        assert_eq!(found.numbering.exchanged, [exchange], "{seed}: {:#?}", found.findings);
        assert_eq!(others(&found), [About::Exchange], "{seed}: {:#?}", found.findings);
    }
}

#[test]
fn values_in_other_places_are_named_although_the_instrument_adds_to_each_value() {
    for seed in 1..4 {
        let (body, model) = bodies(seed);
        let (frames, _) = recorded(&body, &voltages(&body), RAW, seed);
        let mut shifted = frames.clone();
        shifted.values.chunks_exact_mut(208).for_each(|frame| frame.rotate_right(5));
        let found = check(&model, &shifted, PLAIN).unwrap();
        assert_eq!(found.misplaced, [Misplacement::Shifted(5)], "{seed}: {:#?}", found.findings);
        assert_eq!(others(&found), [About::Shift], "{seed}: {:#?}", found.findings);
        let mut exchanged = frames;
        for frame in exchanged.values.chunks_exact_mut(208) {
            (0..13).for_each(|column| frame.swap(13 * 3 + column, 13 * 8 + column));
        }
        let found = check(&model, &exchanged, PLAIN).unwrap();
        assert_eq!(found.misplaced, [Misplacement::Rows([3, 8])], "{seed}: {:#?}", found.findings);
        assert_eq!(others(&found), [About::Rows], "{seed}: {:#?}", found.findings);
    }
}

#[test]
fn a_gain_is_named_although_the_instrument_adds_to_each_value() {
    for seed in 1..6 {
        let (body, model) = bodies(seed);
        let pair = (3 * seed % 16) as u8;
        let gain = |step: Step| if step.sense_plus == pair { 1.3 } else { 1.0 };
        let clean: Vec<f64> = body.steps.iter().map(|&step| body.voltage(step) * gain(step)).collect();
        let found = check(&model, &recorded(&body, &clean, RAW, seed).0, PLAIN).unwrap();
        let [only] = &found.gains[..] else { panic!("{seed}: {:#?}", found.findings) };
        assert_eq!(only.electrodes, [pair, (pair + 1) % 16], "{seed}: {:#?}", found.findings);
        assert!((only.gain - 1.3).abs() < 0.1, "{seed}: {}", only.gain);
    }
}
