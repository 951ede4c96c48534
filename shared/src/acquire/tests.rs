use super::{trim::Trim, *};
use crate::patch::{Difference, tests::small_patch};
use std::vec::Vec;

pub(crate) const FRONT_END: FrontEnd = FrontEnd {
    sample_rate: 2_000_000,
    volts_per_code: 2e-8,
    full_scale_current: 1e-3,
    small_range: Some(CurrentRange { full_current: 28.73e-6, bandwidth: 163.3e3 }),
    gain_bandwidth: 13e6,
    largest_gain: 64,
    bandwidths: [f32::INFINITY; 4],
    lead_corner: f32::INFINITY,
    waveform_rate: 1_000_000_000,
    lead: 0.0,
    trim: Trim::NONE,
};
const DRIVE: Drive = Drive::new(50e3, 1e-3, 50.0);

fn at(frequency: f32) -> Drive {
    Drive { frequency, ..DRIVE }
}

fn acquisition(drive: &Drive) -> Acquisition {
    acquisition_on(drive, &FRONT_END)
}

fn acquisition_on(drive: &Drive, front_end: &FrontEnd) -> Acquisition {
    let bytes = small_patch(Difference::Plain);
    let patch = PatchView::validate(&bytes).unwrap();
    Acquisition::new(&patch, drive, front_end).unwrap()
}

/// Samples of one frame: each slot a wave of that amplitude (steps at gain 1) and phase, through the
/// amplifier with the gains in use.
fn samples(acquisition: &Acquisition, wave: impl Fn(usize) -> (f64, f64)) -> Vec<u16> {
    let mut samples = Vec::new();
    let slot_samples = Timing::new(&DRIVE, 2_000_000).unwrap().slot_samples();
    for (slot, &place) in acquisition.gains().iter().enumerate() {
        let gain = f64::from(GAINS[usize::from(place)]);
        let (amplitude, phase) = wave(slot);
        let lag = 50e3 * gain / 13e6;
        let (amplitude, phase) = (amplitude * gain / lag.hypot(1.0), phase - lag.atan());
        for _ in 0..slot_samples {
            let turns = samples.len() as f64 / 40.0;
            let value = 2048.0 + amplitude * (turns * core::f64::consts::TAU + phase).cos();
            samples.push(value.round().clamp(0.0, 4095.0) as u16);
        }
    }
    samples
}

/// Amplitudes over the range that a skin has.
fn wave(slot: usize) -> (f64, f64) {
    (700.0 / (1.0 + (slot % 13) as f64), 0.3)
}

fn frames(acquisition: &mut Acquisition, count: usize, wave: impl Fn(usize) -> (f64, f64)) -> Vec<Frame> {
    let mut found = Vec::new();
    // The carrier goes on from frame to frame: 48 slots of 50 samples are 60 periods.
    for _ in 0..count {
        let samples = samples(acquisition, &wave);
        acquisition.push(&samples, |frame, _| found.push(frame.clone()));
    }
    found
}

#[test]
#[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
fn codes_are_voltages_whatever_the_gain() {
    let mut acquisition = acquisition(&DRIVE);
    let found = frames(&mut acquisition, 7, wave);
    // The first frame, and two passes of ranging, each with the frame that was under way.
    assert_eq!(found.len(), 2);
    assert!(acquisition.take_gains_changed() && !acquisition.take_gains_changed());
    for frame in &found {
        assert_eq!((frame.codes.len(), frame.tests.len()), (40, 8));
        assert_eq!(frame.flags, FrameFlags::default());
        for (slot, (real, imaginary)) in frame.codes.iter().zip(&frame.quadrature).enumerate() {
            let (amplitude, phase) = wave(slot);
            let error = [
                f64::from(real.0) - 4096.0 * amplitude * phase.cos(),
                f64::from(imaginary.0) - 4096.0 * amplitude * phase.sin(),
            ];
            // Half an LSB at the slot's gain.
            let gain = f64::from(GAINS[usize::from(acquisition.gains()[slot])]);
            assert!(error.iter().all(|error| error.abs() < 2048.0 / gain), "{slot} {error:?}");
        }
    }
}

#[test]
fn a_current_is_made_in_the_small_range_wherever_that_reaches_it() {
    let range = FRONT_END.small_range.unwrap();
    for (amplitude, is_small) in [(1e-9, true), (range.full_current, true), (28.8e-6, false), (1e-3, false)] {
        assert_eq!(FRONT_END.uses_small_range(amplitude), is_small, "{amplitude}");
        let full = if is_small { range.full_current } else { 1e-3 };
        assert_eq!(FRONT_END.share_of_range(amplitude), amplitude / full);
    }
    assert!(FRONT_END.reaches(1e-3) && !FRONT_END.reaches(1.01e-3));
    assert!(!FrontEnd { small_range: None, ..FRONT_END }.uses_small_range(1e-9));
}

#[test]
#[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
fn the_pole_of_the_range_in_use_is_undone_and_no_other() {
    for (amplitude, bandwidth) in [(20e-6, 163.3e3), (1e-3, f64::INFINITY)] {
        let mut acquisition = acquisition(&Drive { gain: Gain::Fixed(1), amplitude, ..DRIVE });
        let found = frames(&mut acquisition, 2, |_| (700.0, 0.0)).remove(0);
        // What the source has made of a larger wave ahead in phase.
        let expected = [700.0, 700.0 * 50e3 / bandwidth];
        for (real, imaginary) in found.codes.iter().zip(&found.quadrature) {
            let error = [real, imaginary].map(|code| f64::from(code.0) / 4096.0);
            assert!((error[0] - expected[0]).hypot(error[1] - expected[1]) < 1.0, "{amplitude} {error:?}");
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
fn automatic_gains_leave_room_for_a_voltage_twice_as_large() {
    let mut acquisition = acquisition(&DRIVE);
    frames(&mut acquisition, 7, wave);
    for (slot, &place) in acquisition.gains().iter().enumerate() {
        let peak = wave(slot).0 * f64::from(GAINS[usize::from(place)]);
        assert!((380.0..=910.0).contains(&peak), "{slot}: {peak}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
fn a_board_without_an_amplifier_never_counts_on_a_gain() {
    let bare = FrontEnd { largest_gain: 1, gain_bandwidth: f32::INFINITY, ..FRONT_END };
    let mut acquisition = acquisition_on(&DRIVE, &bare);
    for _ in 0..7 {
        frames(&mut acquisition, 1, |_| (20.0, 0.3));
        assert!(acquisition.gains().iter().all(|&place| place == 0), "{:?}", acquisition.gains());
    }
}

#[test]
#[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
fn a_fixed_gain_gives_frames_at_once_and_flags_what_it_clips() {
    let mut acquisition = acquisition(&Drive { gain: Gain::Fixed(4), ..DRIVE });
    let found = frames(&mut acquisition, 3, wave);
    assert_eq!(found.len(), 2);
    assert!((0..40).any(|step| found[0].clipped.contains(step)));
    let quiet = frames(&mut acquisition, 1, |slot| (if slot < 40 { 100.0 } else { 800.0 }, 0.0));
    assert!(quiet[0].clipped.is_empty(), "a clipped test is no saturated measurement");
    assert!(quiet[0].tests.iter().all(|test| test.is_clipped));
}

#[test]
#[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
fn imaginary_part_and_magnitude_can_be_the_code() {
    for (component, expected) in [(Component::Imaginary, 0.3_f64.sin()), (Component::Magnitude, 1.0)] {
        let drive = Drive { gain: Gain::Fixed(1), component, ..DRIVE };
        let frame = &frames(&mut acquisition(&drive), 2, |_| (800.0, 0.3))[0];
        for code in &frame.codes {
            assert!((f64::from(code.0) / 4096.0 - 800.0 * expected).abs() < 0.3);
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
fn a_carrier_that_the_board_cannot_make_gives_no_acquisition() {
    let bytes = small_patch(Difference::Plain);
    let patch = PatchView::validate(&bytes).unwrap();
    let drive = Drive { frequency: 47e3, ..DRIVE };
    assert!(Acquisition::new(&patch, &drive, &FRONT_END).is_none());
}

/// The formula of `FrontEnd::factors` in f64: the lock-in's sums of a channel that passes `v + w g`, and what it passes
/// at the carrier.
fn sums_of_channel(front_end: &FrontEnd, frequency: f64, gain: f64, [v, w]: [f64; 2]) -> [[f64; 2]; 2] {
    let product = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
    let inverse = |[a, b]: [f64; 2]| [a / a.hypot(b).powi(2), -b / a.hypot(b).powi(2)];
    let channel = |f: f64| {
        // g = j f / (f_c + j f).
        let high = product([0.0, f], inverse([f64::from(front_end.lead_corner), f]));
        [v + w * high[0], w * high[1]]
    };
    let mut sums = [0.0; 2];
    for image in -3..=3 {
        let away = f64::from(image) * f64::from(front_end.sample_rate);
        let (f, turns) = (frequency + away, away * f64::from(front_end.lead) * core::f64::consts::TAU);
        let half_turn = core::f64::consts::PI * f / f64::from(front_end.waveform_rate);
        let poles = front_end
            .bandwidths
            .iter()
            .fold([1.0, 0.0], |all, &bandwidth| product(all, inverse([1.0, f / f64::from(bandwidth)])));
        let amplifier = inverse([1.0 / gain, f / f64::from(front_end.gain_bandwidth)]);
        let held = [half_turn.sin() / half_turn * turns.cos(), half_turn.sin() / half_turn * turns.sin()];
        let part = product(product(product(poles, amplifier), held), channel(f));
        sums = [sums[0] + part[0], sums[1] + part[1]];
    }
    [sums, channel(frequency)]
}

#[test]
fn what_a_channel_passes_is_told_from_its_sums_with_leads_that_take_current() {
    let bandwidths = FRONT_END.bandwidths.map(|_| 800e3);
    let front_end =
        FrontEnd { bandwidths, lead_corner: 575e3, waveform_rate: 1_000_000, lead: -1.24e-6, ..FRONT_END };
    for frequency in [12.5e3, 100e3, 200e3] {
        for (factors, gain) in front_end.factors(&at(frequency as f32), 100.0).into_iter().zip(GAINS) {
            for parts in [[1.0, 0.0], [0.7, -0.6], [-0.2, 0.9]] {
                let [sums, expected] = sums_of_channel(&front_end, frequency, gain.into(), parts);
                let found = factors.map(|[x, y]| f64::from(x) * sums[0] + f64::from(y) * sums[1]);
                for (found, expected) in found.iter().zip(expected) {
                    assert!((found - 100.0 * expected).abs() < 0.02, "{frequency} {gain} {parts:?}: {found}");
                }
            }
        }
    }
}

/// What a pole makes of a staircase, `[sample]`: its values, each held `steps` long, after time enough.
fn through_pole(staircase: &[f64], bandwidth: f64, step: f64) -> Vec<f64> {
    let part = 1.0 - (-core::f64::consts::TAU * bandwidth * step).exp();
    let mut value = 0.0;
    let mut follow = |target: &f64| {
        value += part * (target - value);
        value
    };
    staircase.iter().map(&mut follow).collect()
}

#[test]
#[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
fn poles_and_held_values_before_the_converter_are_undone_with_the_images_that_read_as_the_carrier() {
    // Steps of a nanosecond are fine enough for poles in turn.
    const STEP: f64 = 1e-9;
    for (frequency, delay) in [(50e3_f32, 153e-9_f64), (100e3, 153e-9), (200e3, 153e-9), (200e3, 410e-9)] {
        let front_end = FrontEnd {
            bandwidths: [840e3, 400e3, 1e6, 8e6],
            waveform_rate: 1_000_000,
            // The middle of the first value is half a microsecond after it begins.
            lead: (delay - 0.5e-6) as f32,
            ..FRONT_END
        };
        let drive = Drive { gain: Gain::Fixed(1), ..Drive::new(frequency, 1e-3, 50.0) };
        let mut acquisition = acquisition_on(&drive, &front_end);
        let turns = |micros: usize| micros as f64 * 1e-6 * f64::from(frequency) * core::f64::consts::TAU;
        let staircase: Vec<f64> = (0..200_000).map(|n| 800.0 * turns(n / 1000).cos()).collect();
        let mut wave = staircase;
        for bandwidth in [840e3, 400e3, 1e6, 8e6, 13e6] {
            wave = through_pole(&wave, bandwidth, STEP);
        }
        // 40 us are whole periods of all carriers, and the second 40 us are settled. Each pole's values are
        // those at the end of a step, less the half by which the one before is early.
        let first = 40_000 + (delay / STEP).round() as usize - 3;
        let period: Vec<u16> = (0..80).map(|n| (2048.0 + wave[first + 500 * n]).round() as u16).collect();
        let mut found = None;
        for _ in 0..200 {
            acquisition.push(&period, |frame, _| found = Some(frame.clone()));
        }
        let found = found.unwrap();
        for (real, imaginary) in found.codes.iter().zip(&found.quadrature) {
            let error = [f64::from(real.0) / 4096.0 - 800.0, f64::from(imaginary.0) / 4096.0];
            assert!(error.iter().all(|error| error.abs() < 0.6), "{frequency} {delay} {error:?}");
        }
    }
}

#[test]
fn a_correction_makes_a_resistor_read_as_what_it_is_at_every_gain() {
    let steep = FrontEnd { bandwidths: [844e3, 157e3, 10e6, 965e3], lead_corner: 575e3, ..FRONT_END };
    for frequency in trim::CARRIERS {
        // The board's amplifier has half the bandwidth that its design says, and it is 3 % weaker.
        let real = FrontEnd { gain_bandwidth: 6.5e6, ..steep };
        let mut front_end = FrontEnd { waveform_rate: 1_000_000, lead: -1.24e-6, ..steep };
        let true_end = FrontEnd { waveform_rate: 1_000_000, lead: -1.24e-6, ..real };
        let carrier = trim::CARRIERS.iter().position(|&carrier| carrier == frequency).unwrap();
        for gain in 0..GAINS.len() {
            let sums = front_end::solve(true_end.factors(&at(frequency), 1.0)[gain], [0.97 * 500.0, 0.0]);
            let read = |front_end: &FrontEnd| {
                front_end.factors(&at(frequency), 1.0)[gain].map(|[x, y]| x * sums[0] + y * sums[1])
            };
            let before = read(&front_end);
            let by = front_end.correction(&at(frequency), gain, before, [500.0, 0.0]).unwrap();
            front_end.trim.multiply(carrier, gain, by);
            let after = read(&front_end);
            assert!((before[0] - 500.0).abs() > 10.0, "{frequency} {gain} {before:?}");
            assert!((after[0] - 500.0).abs() < 0.01 && after[1].abs() < 0.01, "{frequency} {gain} {after:?}");
        }
        assert!(front_end.trim.is_plausible());
        assert_eq!(front_end.correction(&at(frequency), 0, [0.0, 0.0], [500.0, 0.0]), None);
        assert_eq!(front_end.correction(&at(frequency), 7, [1.0, 0.0], [500.0, 0.0]), None);
    }
}

#[test]
#[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
fn the_scope_keeps_the_samples_of_its_slot_whatever_the_pieces() {
    for pieces in [1, 7, 50, 333, 5000] {
        let mut acquisition = acquisition(&Drive { gain: Gain::Fixed(2), ..DRIVE });
        acquisition.watch(Some(3));
        let samples: Vec<u16> = (0..2 * 48 * 50 + 250).map(|n| (n % 4000) as u16).collect();
        let mut shown = None;
        samples.chunks(pieces).for_each(|piece| acquisition.push(piece, |_, scope| shown = scope.cloned()));
        let Some(SlotSamples { slot: 3, gain: 2, settling: 10, samples: seen }) = shown else {
            panic!("no scope: {shown:?}")
        };
        let start = 48 * 50 + 3 * 50;
        assert_eq!(seen[..], samples[start..start + 50]);
    }
}
