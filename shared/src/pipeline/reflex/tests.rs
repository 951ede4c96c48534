use super::*;
use crate::{
    patch::tests::{flat_frame, patch_with_reflexes, row, rule},
    pipeline::{Outcome, sense},
    units::AdcCode,
};
use proptest::prelude::*;
use std::vec::Vec as List;

/// What the small patch's first measurement reads, ten times over.
const FIRST: [f32; 40] = {
    let mut weights = [0.0; 40];
    weights[0] = 10.0;
    weights
};

fn tared(patch: &PatchView<'_>, frame: &Frame) -> PipelineState {
    let mut state = PipelineState::default();
    state.start_tare(2);
    assert_eq!(sense(patch, &mut state, frame), Outcome::Taring);
    assert_eq!(sense(patch, &mut state, frame), Outcome::Tared);
    state
}

/// Of all rows.
fn brief(watch: &mut Watch, patch: &PatchView<'_>, state: &PipelineState) {
    (0..=patch.reflex_rows().count()).for_each(|_| watch.brief(patch, state));
}

/// A watch of a skin whose voltages are all 1000.
fn briefed(bytes: &[u8]) -> Watch {
    let patch = PatchView::validate(bytes).unwrap();
    let mut watch = Watch::new();
    watch.begin(Some(&patch));
    brief(&mut watch, &patch, &tared(&patch, &flat_frame(1000)));
    watch
}

/// A frame in which the first voltage has changed by this share.
fn pressed(change: f32) -> Frame {
    let mut frame = flat_frame(1000);
    frame.codes[0] = AdcCode((1000.0 * (1.0 + change)).round() as i32);
    frame
}

#[test]
fn a_load_above_the_limit_trips_and_one_below_its_share_releases() {
    let bytes = patch_with_reflexes(&[rule(Limit::Strength(0.5))], &[row(&FIRST)]);
    let mut watch = briefed(&bytes);
    for (change, tripped) in [(0.0, 0), (0.049, 0), (0.051, 1), (0.03, 1), (0.024, 0), (0.049, 0), (-0.2, 0)]
    {
        let reflexes = watch.see(&pressed(change), 0);
        assert_eq!((reflexes.tripped, reflexes.is_blind), (tripped, false), "{change}");
        assert!((reflexes.values[0] - 10.0 * change).abs() < 1e-4, "{reflexes:?}");
        assert_eq!(watch.high_pins(), 1 - tripped);
    }
}

#[test]
fn a_rule_waits_for_its_frames_and_holds_for_its_time() {
    let waits = ReflexRule { frames: 3, hold: 0.1, ..rule(Limit::Force(5.0)) };
    let mut watch = briefed(&patch_with_reflexes(&[waits], &[row(&FIRST)]));
    let mut see = |change: f32, ms: u64| watch.see(&pressed(change), 1000 * ms).tripped;
    assert_eq!(see(0.0, 200), 0);
    // 5 N are a strength of 0.5. What is not above for three frames in turn is noise.
    assert_eq!([see(0.06, 210), see(0.06, 220), see(0.0, 230), see(0.06, 240), see(0.06, 250)], [0; 5]);
    assert_eq!(see(0.06, 260), 1);
    assert_eq!([see(0.0, 270), see(0.0, 359), see(0.0, 360)], [1, 1, 0]);
}

#[test]
fn pressed_cells_add_up_to_an_area() {
    let of = |m: usize| core::array::from_fn::<f32, 40, _>(|n| if n == m { 10.0 } else { 0.0 });
    let cells = [of(0), of(1), of(2)];
    let rows: List<_> = cells.iter().map(|weights| row(weights)).collect();
    let area = ReflexRule { rows: 3, ..rule(Limit::Area { area: 1.5e-4, strength: 0.5 }) };
    let mut watch = briefed(&patch_with_reflexes(&[area], &rows));
    let mut frame = flat_frame(1000);
    for (pressed, expected) in [(0, 0.0), (1, 1e-4), (2, 2e-4), (3, 3e-4)] {
        frame.codes.iter_mut().take(pressed).for_each(|code| *code = AdcCode(1060));
        let reflexes = watch.see(&frame, 0);
        assert!((reflexes.values[0] - expected).abs() < 1e-9, "{reflexes:?}");
        assert_eq!(reflexes.is_tripped(0), expected > 1.5e-4);
    }
}

#[test]
fn where_a_board_cannot_tell_a_rule_trips_unless_it_shall_not() {
    let ignores = ReflexRule { pin: 2, trips_blind: false, ..rule(Limit::Strength(0.5)) };
    let bytes = patch_with_reflexes(&[rule(Limit::Strength(0.5)), ignores], &[row(&FIRST), row(&FIRST)]);
    let patch = PatchView::validate(&bytes).unwrap();
    let (mut clipped, mut short) = (pressed(0.0), pressed(0.0));
    clipped.clipped.insert(7);
    short.codes.pop();
    for (blinds, what) in [
        (flat_frame(0), "no current"),
        (flat_frame(-1000), "another current"),
        (flat_frame(2500), "a sheet that is another"),
        (clipped, "the end of the range"),
        (short, "a frame of another scan"),
    ] {
        let mut watch = briefed(&bytes);
        assert_eq!(watch.see(&pressed(0.0), 0).tripped, 0);
        let reflexes = watch.see(&blinds, 1);
        assert_eq!((reflexes.tripped, reflexes.is_blind, watch.high_pins()), (1, true, 2), "{what}");
        // What was pressed before is so still, for all that one knows.
        assert_eq!(watch.see(&pressed(0.1), 2).tripped, 3);
        assert_eq!(watch.see(&blinds, 3).tripped, 3, "{what}");
        assert_eq!(watch.see(&pressed(0.0), 4).tripped, 0);
    }
    // Before it is briefed, and once frames have ended.
    let mut watch = Watch::new();
    watch.begin(Some(&patch));
    assert_eq!((watch.see(&pressed(0.0), 0).tripped, watch.high_pins()), (1, 2));
    let mut watch = briefed(&bytes);
    watch.blind();
    assert!(watch.see(&pressed(0.0), 0).is_blind);
    watch.begin(None);
    assert_eq!((watch.see(&pressed(0.1), 0), watch.high_pins()), (Reflexes::default(), 0));
}

#[test]
fn a_pin_of_two_rules_is_high_while_neither_is_tripped() {
    let of = |m: usize| core::array::from_fn::<f32, 40, _>(|n| if n == m { 10.0 } else { 0.0 });
    let (first, second) = (of(0), of(1));
    let limit = rule(Limit::Strength(0.5));
    let mut watch = briefed(&patch_with_reflexes(&[limit.clone(), limit], &[row(&first), row(&second)]));
    let mut frame = flat_frame(1000);
    assert_eq!((watch.see(&frame, 0).tripped, watch.high_pins()), (0, 1));
    frame.codes[1] = AdcCode(1060);
    assert_eq!((watch.see(&frame, 0).tripped, watch.high_pins()), (2, 0));
}

#[test]
fn an_electrode_that_has_become_bad_blinds() {
    let bytes = patch_with_reflexes(&[rule(Limit::Strength(0.5))], &[row(&FIRST)]);
    let patch = PatchView::validate(&bytes).unwrap();
    let (mut watch, mut state) = (briefed(&bytes), tared(&patch, &flat_frame(1000)));
    let mut bad = crate::health::ElectrodeSet::default();
    bad.insert(3);
    state.wiring.take(bad);
    watch.brief(&patch, &state);
    assert!(watch.see(&pressed(0.0), 0).is_blind);
    state = tared(&patch, &flat_frame(1000));
    watch.brief(&patch, &state);
    assert!(watch.see(&pressed(0.0), 0).is_blind, "one row is not all");
    watch.brief(&patch, &state);
    assert!(!watch.see(&pressed(0.0), 0).is_blind);
}

proptest! {
    #[test]
    fn a_load_is_the_weighted_sum_of_relative_changes(
        weights in prop::collection::vec(-20.0_f32..20.0, 40),
        before in prop::collection::vec(prop_oneof![-9_000_000..-100_000, 100_000..9_000_000], 40),
        changes in prop::collection::vec(-0.3_f64..0.3, 40),
    ) {
        let bytes = patch_with_reflexes(&[rule(Limit::Strength(1e3))], &[row(&weights)]);
        let patch = PatchView::validate(&bytes).unwrap();
        let frame = |change: &dyn Fn(usize) -> f64| {
            let code = |(m, &code): (usize, &i32)| AdcCode((f64::from(code) * (1.0 + change(m))).round() as i32);
            Frame { codes: before.iter().enumerate().map(code).collect(), ..Frame::default() }
        };
        let mut watch = Watch::new();
        watch.begin(Some(&patch));
        brief(&mut watch, &patch, &tared(&patch, &frame(&|_| 0.0)));
        let reflexes = watch.see(&frame(&|m| changes[m]), 0);
        let expected: f64 = weights.iter().zip(&changes).map(|(weight, change)| f64::from(*weight) * change).sum();
        // Half a step of the largest factor for each code, and codes are whole numbers.
        let factors = weights.iter().zip(&before).map(|(weight, &code)| (f64::from(*weight) / f64::from(code)).abs());
        let step = factors.fold(0.0, f64::max) / 32_767.0;
        let codes: f64 = changes.iter().zip(&before).map(|(change, &code)| (change * f64::from(code)).abs()).sum();
        prop_assert!(!reflexes.is_blind);
        prop_assert!((f64::from(reflexes.values[0]) - expected).abs() < 0.5 * step * codes + 5e-4, "{reflexes:?} {expected}");
    }
}

#[test]
fn codes_that_no_converter_gives_do_no_harm() {
    let bytes = patch_with_reflexes(&[rule(Limit::Strength(0.5))], &[row(&FIRST)]);
    let mut watch = briefed(&bytes);
    for code in [i32::MIN, i32::MAX] {
        assert!(watch.see(&flat_frame(code), 0).is_blind);
    }
    let patch = PatchView::validate(&bytes).unwrap();
    brief(&mut watch, &patch, &tared(&patch, &flat_frame(i32::MIN)));
    let _ = watch.see(&flat_frame(i32::MIN), 1);
}
