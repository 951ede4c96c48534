use super::*;
use crate::{
    contact::{Contact, Contacts},
    patch::PatchView,
};
use proptest::prelude::*;

const QUIET: RelativeConductivity = RelativeConductivity(0);

fn operators() -> std::vec::Vec<PlayOperator> {
    [(2.5, 0.3), (1.4, 0.5), (1.1, 2.0)]
        .map(|(threshold, weight)| PlayOperator::from_f64(threshold, weight))
        .to_vec()
}

/// The formula at the top of the module in f64.
fn exact(strengths: &[f64], operators: &[PlayOperator]) -> std::vec::Vec<f64> {
    let mut states = std::vec![0.0_f64; operators.len()];
    let step = |&x: &f64| {
        let mut excess = 0.0;
        for (h, operator) in states.iter_mut().zip(operators) {
            *h = h.min(x * f64::from(operator.threshold) / 4096.0).max(x);
            excess += (*h - x) * f64::from(operator.weight) / 2048.0;
        }
        if excess > x {
            states.iter_mut().for_each(|h| *h = x + (*h - x) * x / excess);
        }
        (x - excess).max(0.0)
    };
    strengths.iter().map(step).collect()
}

fn fixed(strengths: &[f64], operators: &[PlayOperator]) -> std::vec::Vec<f64> {
    let mut memory = Memory::default();
    let step = |&x: &f64| {
        memory.compensate(&operators.iter().copied(), RelativeConductivity::from_f64(x), QUIET).to_f64()
    };
    strengths.iter().map(step).collect()
}

#[test]
fn a_first_press_passes_unchanged_and_a_release_reads_less() {
    let read = fixed(&[0.1, 0.2, 0.4, 0.35, 0.3, 0.4, 0.5], &operators());
    for (value, strength) in read.iter().zip([0.1, 0.2, 0.4]) {
        assert!((value - strength).abs() < 2e-6, "{read:?}");
    }
    assert!(read[3] < 0.3 && read[4] < read[3] && read[4] > 0.0, "{read:?}");
    // Back where it turned, a loop is closed.
    assert!((read[5] - 0.4).abs() < 2e-6 && (read[6] - 0.5).abs() < 2e-6, "{read:?}");
}

#[test]
fn what_the_last_press_left_reads_as_nothing_and_a_new_press_starts_from_there() {
    let operators = [PlayOperator::from_f64(10.0, 1.5)];
    let read = fixed(&[1.0, 0.3, 0.3, 0.1, 0.0, 0.2, 1.0], &operators);
    assert!(read[1..5].iter().all(|value| *value < 2e-6), "{read:?}");
    assert!((read[5] - 0.2).abs() < 1e-5, "nothing is left to remember: {read:?}");
    let at_rest = fixed(&[1.0, 0.3, 0.4], &operators);
    assert!((0.2..0.3).contains(&at_rest[2]), "the skin still holds the old press: {at_rest:?}");
}

#[test]
fn noise_is_averaged_and_a_press_counts_at_once() {
    let mut memory = Memory::default();
    let mut step = |value: f64, noise: f64| {
        let [value, noise] = [value, noise].map(RelativeConductivity::from_f64);
        memory.compensate(&operators().into_iter(), value, noise).to_f64()
    };
    assert!(step(0.5, 0.02) > 0.48);
    let mut read = std::vec::Vec::new();
    for n in 0..60 {
        read.push(step(if n % 2 == 0 { 0.51 } else { 0.49 }, 0.02));
    }
    assert!(read[40..].iter().all(|value| (value - 0.5).abs() < 0.012), "{read:?}");
}

#[test]
fn contacts_use_the_memory_of_their_place() {
    let bytes = crate::patch::tests::patch_with_hysteresis(&[PlayOperator::from_f64(10.0, 1.5)]);
    let patch = PatchView::validate(&bytes).unwrap();
    assert_eq!(patch.play_operators().count(), 1);
    let mut places = Places::default();
    let mut pressure = |presses: &[(f32, f32)]| {
        let contact = |&(x, strength)| Contact {
            position: [x, 0.0, 0.0],
            normal: [0.0, 0.0, 1.0],
            area: 1e-4,
            strength,
            peak: strength,
            pressure: None,
            load_area: None,
            evidence: None,
            identity: None,
        };
        let mut contacts: Contacts = presses.iter().map(contact).collect();
        let noise = RelativeConductivity(patch.header.contact_threshold.0 / 2);
        let level = || RelativeConductivity::from_f64(0.02);
        let strengths = places.compensate(&patch.play_operators(), &contacts, noise, level);
        patch.header.calibration.apply(&mut contacts, &strengths);
        contacts.iter().map(|contact| contact.pressure.unwrap()).collect::<std::vec::Vec<_>>()
    };
    for _ in 0..100 {
        pressure(&[(0.0, 0.4)]);
    }
    let at_old_place = pressure(&[(0.001, 0.3)])[0];
    let both = pressure(&[(0.05, 0.3), (0.001, 0.3)]);
    assert!(at_old_place < 20e3 && (both[0] - 29.5e3).abs() < 1e3 && both[1] < 20e3, "{both:?}");
    for _ in 0..100 {
        pressure(&[]);
    }
    assert!((pressure(&[(0.0, 0.3)])[0] - 29.5e3).abs() < 1.5e3);
}

#[test]
fn damaged_operators_are_refused() {
    use crate::patch::{PatchError, tests::patch_with_hysteresis};
    let bad = patch_with_hysteresis(&[PlayOperator { threshold: 4095, weight: 1 }]);
    assert_eq!(PatchView::validate(&bad).unwrap_err(), PatchError::PlayOperator { operator: 0 });
    let many = patch_with_hysteresis(&[PlayOperator::from_f64(2.0, 1.0); MAX_PLAY_OPERATORS + 1]);
    assert!(matches!(
        PatchView::validate(&many),
        Err(PatchError::Range { field: "play_operators", value: 7, .. })
    ));
}

proptest! {
    #[test]
    fn fixed_point_follows_the_formula_to_a_ten_thousandth(
        strengths in prop::collection::vec(0.0_f64..2.0, 1..40),
        numbers in prop::collection::vec((1.0_f64..15.0, 0.0_f64..2.0), 0..=MAX_PLAY_OPERATORS),
    ) {
        let operators: std::vec::Vec<_> = numbers.iter().map(|&(r, w)| PlayOperator::from_f64(r, w)).collect();
        for (a, b) in fixed(&strengths, &operators).into_iter().zip(exact(&strengths, &operators)) {
            prop_assert!((a - b).abs() < 1e-4, "{a} {b}");
        }
    }

    #[test]
    fn no_numbers_make_it_panic_or_read_below_nothing(
        strengths in prop::collection::vec(any::<i32>(), 1..30),
        bytes in prop::collection::vec(any::<[u8; 4]>(), 0..8),
        noise in any::<i32>(),
    ) {
        let operators = bytes.iter().map(|&b| PlayOperator::from_bytes(b));
        let mut memory = Memory::default();
        for strength in strengths {
            let read = memory.compensate(&operators, RelativeConductivity(strength), RelativeConductivity(noise));
            prop_assert!(read.0 >= 0);
        }
    }
}
