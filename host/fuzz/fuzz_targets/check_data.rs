//! Any finite values as frames of a small skin, and as those from when all was well. The check never fails on frames of the
//! right length, and its shares and correlations stay in range.
#![no_main]

use dermatome::recorded::{
    check::{Expected, check},
    order::{Arrangement, SenseOrder},
    read::Frames,
};
use dermatome_shared::stimulation::{Driven, pattern};
use libfuzzer_sys::fuzz_target;
use num_complex::Complex64;

const ELECTRODES: u8 = 8;

#[derive(arbitrary::Arbitrary, Debug)]
struct Input {
    relative: bool,
    rotation: u8,
    mirrored: bool,
    square: bool,
    measured: bool,
    complex: bool,
    values: Vec<f64>,
    good: Vec<f64>,
}

/// Point electrodes on a disc, each with a contact.
fn disc(driven: Driven) -> Expected {
    let transfer = |at: usize, driven: usize| {
        let angle = std::f64::consts::PI * at.abs_diff(driven) as f64 / f64::from(ELECTRODES);
        if at == driven { 2.0 } else { -angle.sin().ln() }
    };
    Expected::new(pattern(ELECTRODES, 1, 1, driven).collect(), ELECTRODES, transfer)
}

/// Frames of as many whole ones as the values make; none of less than one.
fn frames(values: &[f64], measurements: usize, complex: bool) -> Option<Frames> {
    let mut values: Vec<Complex64> = values
        .chunks(if complex { 2 } else { 1 })
        .map(|parts| Complex64::new(parts[0], parts.get(1).copied().unwrap_or(0.0)))
        .filter(|value| value.is_finite())
        .collect();
    let frames = values.len() / measurements;
    values.truncate(frames * measurements);
    (frames > 0).then_some(Frames { values, frames, measurements, complex })
}

fuzz_target!(|input: Input| {
    let model = disc(if input.measured { Driven::Measured } else { Driven::Skipped });
    let measurements = if input.square { 64 } else { model.steps.len() };
    let sense = if input.relative { SenseOrder::Relative } else { SenseOrder::Absolute };
    let used = Arrangement { sense, rotation: input.rotation % ELECTRODES, mirrored: input.mirrored };
    let expected = match frames(&input.good, measurements, input.complex) {
        // Of zeros alone they say nothing.
        Some(good) => model.clone().measured(&good, used).unwrap_or(model),
        None => model,
    };
    let Some(frames) = frames(&input.values, measurements, input.complex) else { return };
    let found = check(&expected, &frames, used).unwrap();
    let percent =
        found.electrodes.iter().flat_map(|e| [e.drive_off_percent, e.sense_off_percent, e.noisy_percent]);
    assert!(percent.flatten().all(|percent| (0.0..=100.0).contains(&percent)));
    assert!(found.numbering.correlation.abs() <= 1.0 || found.numbering.correlation.is_nan());
    assert!(found.findings.iter().all(|finding| !finding.advice.to_string().is_empty()));
});
