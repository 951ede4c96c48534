use super::*;
use crate::patch::{
    Difference,
    tests::{flat_frame, patch_with_hysteresis, small_patch},
};
use crate::{contact::hysteresis::PlayOperator, units::AdcCode};

fn tared(patch: &PatchView<'_>, value: i32, frames: u16) -> PipelineState {
    let mut state = PipelineState::default();
    state.start_tare(frames);
    for _ in 1..frames {
        assert_eq!(process(patch, &mut state, &flat_frame(value)), Outcome::Taring);
    }
    assert_eq!(process(patch, &mut state, &flat_frame(value)), Outcome::Tared);
    state
}

#[test]
fn normalised_data_is_the_change_over_the_reference_of_each_measurement() {
    let bytes = small_patch(Difference::Normalised);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut state = tared(&patch, -2000, 20);
    let mut frame = flat_frame(-2000);
    frame.codes[1] = AdcCode(-2500);
    frame.codes[3] = AdcCode(-1900);
    assert_eq!(process(&patch, &mut state, &frame), Outcome::Image);
    let image: std::vec::Vec<_> = state.image().iter().map(|value| value.to_f64()).collect();
    for (value, expected) in image.iter().zip([0.0, 0.25, 0.0, -0.05]) {
        assert!((value - expected).abs() < 1e-5, "{image:?}");
    }
    assert_eq!(state.contacts().len(), 1);
    assert!((state.contacts()[0].position[0] - 0.005).abs() < 1e-6);
}

#[test]
fn plain_data_is_the_change_over_the_mean_reference() {
    let bytes = small_patch(Difference::Plain);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut uneven = flat_frame(1000);
    uneven.codes[0] = AdcCode(-5000);
    let mut state = PipelineState::default();
    state.start_tare(1);
    assert_eq!(process(&patch, &mut state, &uneven), Outcome::Tared);
    uneven.codes[0] = AdcCode(-5220);
    assert_eq!(process(&patch, &mut state, &uneven), Outcome::Image);
    // Mean of |v_ref|: (5000 + 39 * 1000) / 40 = 1100.
    assert!((state.image()[0].to_f64() + 0.2).abs() < 1e-5);
}

#[test]
fn strengths_are_averaged_within_half_the_threshold_and_count_at_once_beyond() {
    let bytes = patch_with_hysteresis(&[PlayOperator::from_f64(10.0, 1.5)]);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut state = tared(&patch, 1000, 20);
    // 100 kPa for each 1, and a first press passes unchanged. The threshold is 0.01: of a step of 0.015, all but
    // the last 0.005 counts at once, and an eighth of that.
    for (code, pressure) in [(1100, 10_000.0 - 7.0 / 8.0 * 500.0), (1115, 9562.5 + 1437.5 + 62.5)] {
        assert_eq!(process(&patch, &mut state, &flat_frame(code)), Outcome::Image);
        let found = state.contacts()[0].pressure.unwrap();
        assert!((found - pressure).abs() < 100.0, "{code}: {found} Pa");
    }
}

#[test]
fn a_frame_of_the_wrong_length_is_dropped_and_nothing_changes() {
    let bytes = small_patch(Difference::Plain);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut state = tared(&patch, 700, 2);
    let mut frame = flat_frame(700);
    frame.codes.pop();
    assert_eq!(process(&patch, &mut state, &frame), Outcome::WrongLength);
}

#[test]
fn without_a_reference_twenty_steady_frames_make_one() {
    let bytes = small_patch(Difference::Plain);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut state = PipelineState::default();
    let mut steps = (0..25).map(|n| if n < 5 { 1000 + 100 * n } else { 2000 });
    let outcomes: std::vec::Vec<_> =
        steps.by_ref().map(|value| process(&patch, &mut state, &flat_frame(value))).collect();
    assert!(outcomes[..24].iter().all(|outcome| *outcome == Outcome::Taring));
    assert_eq!(outcomes[24], Outcome::Tared);
    assert_eq!(state.reference().unwrap().sums()[7], 20 * 2000);
}

#[test]
fn frames_without_current_make_no_reference() {
    let bytes = small_patch(Difference::Plain);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut state = PipelineState::default();
    state.start_tare(1);
    let dead = Frame { flags: FrameFlags::NO_CURRENT, ..flat_frame(3) };
    assert_eq!(process(&patch, &mut state, &dead), Outcome::Taring);
    assert_eq!(process(&patch, &mut state, &flat_frame(700)), Outcome::Tared);
}

#[test]
fn saturated_frames_make_no_reference_and_frames_without_current_no_contact() {
    let bytes = small_patch(Difference::Normalised);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut state = PipelineState::default();
    state.start_tare(1);
    let saturated = Frame { flags: FrameFlags::SATURATED, ..flat_frame(900) };
    assert_eq!(process(&patch, &mut state, &saturated), Outcome::Taring);
    assert_eq!(process(&patch, &mut state, &flat_frame(-700)), Outcome::Tared);
    let pressed = flat_frame(-1400);
    assert_eq!(process(&patch, &mut state, &pressed), Outcome::Image);
    assert_eq!(state.contacts().len(), 1);
    let dead = Frame { flags: FrameFlags::NO_CURRENT, ..pressed };
    assert_eq!(process(&patch, &mut state, &dead), Outcome::Image);
    assert!(state.contacts().is_empty() && state.image().iter().all(|value| value.0 == 0));
}

#[test]
fn drift_is_followed_beside_a_bad_electrode_whose_measurements_stay() {
    let bytes = crate::patch::tests::drifting_patch(30.0);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut state = tared(&patch, 1_000_000, 2);
    state.wiring.see(ElectrodeSet(1 << 3), &[]);
    let mut parts = Changes::new();
    parts.resize(patch.header.measurements.into(), 0.0).unwrap();
    mask_measurements(&patch, ElectrodeSet(1 << 3), UNKNOWN, &mut parts);
    let values = drifting(&patch, &mut state, 10.0, [0.0, 300.0], 0.0);
    assert!(values.iter().all(|value| value.abs() < 0.008), "{:?}", values.last());
    assert!(state.contacts().is_empty());
    assert_eq!(state.flags(), FrameFlags::MASKED);
    assert!(parts.iter().any(|part| part.is_nan()) && !parts.iter().all(|part| part.is_nan()));
    for (sum, part) in state.reference().unwrap().sums().iter().zip(&parts) {
        assert_eq!(*sum == 2_000_000, part.is_nan(), "{sum}");
    }
}

#[test]
fn voltages_that_no_press_explains_are_flagged() {
    let bytes = small_patch(Difference::Normalised);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut state = tared(&patch, 1000, 2);
    let mut frame = flat_frame(1000);
    frame.codes.iter_mut().step_by(6).for_each(|code| code.0 = 0);
    process(&patch, &mut state, &frame);
    assert_eq!(state.flags(), FrameFlags::IMPLAUSIBLE);
    frame = flat_frame(1000);
    frame.codes.iter_mut().step_by(10).for_each(|code| code.0 = 0);
    process(&patch, &mut state, &frame);
    assert_eq!(state.flags(), FrameFlags::default());
}

/// Frames for `seconds`, so many a second: all voltages drift by 1 % a minute, and measurement 1 is
/// pressed by `press`.
fn drifting(
    patch: &PatchView<'_>,
    state: &mut PipelineState,
    rate: f64,
    [start, seconds]: [f64; 2],
    press: f64,
) -> std::vec::Vec<f64> {
    let mut values = std::vec::Vec::new();
    for n in 0..(seconds * rate) as usize {
        let time = start + n as f64 / rate;
        let drift = 1.0 - time / 6000.0;
        let mut frame = flat_frame((1e6 * drift) as i32);
        frame.codes[1] = AdcCode((1e6 * drift * (1.0 + press)) as i32);
        frame.timestamp_us = (time * 1e6) as u64;
        process(patch, state, &frame);
        values.push(state.image()[1].to_f64());
    }
    values
}

#[test]
fn drift_is_followed_and_a_held_press_is_not() {
    let bytes = crate::patch::tests::drifting_patch(30.0);
    let patch = PatchView::validate(&bytes).unwrap();
    for rate in [10.0, 1.0, 0.5] {
        let mut state = tared(&patch, 1_000_000, 2);
        let untouched = drifting(&patch, &mut state, rate, [0.0, 300.0], 0.0);
        assert!(untouched.iter().all(|value| value.abs() < 0.008), "{:?}", untouched.last());
        assert!(state.contacts().is_empty());
        let pressed = drifting(&patch, &mut state, rate, [300.0, 600.0], 0.2);
        let (first, last) = (pressed[2], pressed[pressed.len() - 1]);
        assert!((first - 0.2).abs() < 0.01 && (last - first).abs() < 0.02 * first, "{first} {last}");
        assert_eq!(state.contacts().len(), 1);
        let released = drifting(&patch, &mut state, rate, [900.0, 100.0], 0.0);
        assert!(released[5..].iter().all(|value| value.abs() < 0.01), "{:?}", released.last());
    }
}

#[test]
fn without_a_drift_time_nothing_is_followed() {
    let bytes = small_patch(Difference::Normalised);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut state = tared(&patch, 1_000_000, 2);
    let last = drifting(&patch, &mut state, 10.0, [0.0, 300.0], 0.0).pop().unwrap();
    assert!((last + 0.05).abs() < 1e-3, "{last}");
}

#[test]
fn a_dead_measurement_reads_zero_instead_of_infinity() {
    let bytes = small_patch(Difference::Normalised);
    let patch = PatchView::validate(&bytes).unwrap();
    let mut state = tared(&patch, 0, 2);
    assert_eq!(process(&patch, &mut state, &flat_frame(90)), Outcome::Image);
    assert!(state.image().iter().all(|value| value.0 == 0));
}
