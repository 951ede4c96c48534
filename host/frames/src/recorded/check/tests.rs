use super::*;
use crate::recorded::{
    check::{
        findings::{About, Level},
        wiring::{Exchange, Role, Wiring},
    },
    diagnose::TIE,
    order::SenseOrder,
};
use dermatome_model::skin::Skin;
use dermatome_shared::stimulation::{Driven, pattern};
use proptest::prelude::*;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::{PI, TAU};

/// A homogeneous unit disc with point electrodes at uneven distances, so that no two rotations look
/// alike: potential -ln(r) / pi, and a contact of its own under each electrode.
fn disc(electrodes: u8, steps: Vec<Step>, seed: u64) -> Expected {
    let mut random = Pcg64::seed_from_u64(seed);
    let places: Vec<[f64; 2]> = (0..electrodes)
        .map(|k| {
            let angle = TAU / f64::from(electrodes) * (f64::from(k) + random.random_range(-0.3..0.3));
            [angle.sin(), angle.cos()]
        })
        .collect();
    let contacts: Vec<f64> = places.iter().map(|_| random.random_range(1.2..1.6)).collect();
    let distance = |a: usize, b: usize| (places[a][0] - places[b][0]).hypot(places[a][1] - places[b][1]);
    Expected::new(steps, electrodes, |at, driven| {
        if at == driven { contacts[at] } else { -distance(at, driven).ln() / PI }
    })
}

fn adjacent(seed: u64) -> Expected {
    disc(16, pattern(16, 1, 1, Driven::Skipped).collect(), seed)
}

/// An instrument that measures a body with some of its wires in wrong places.
struct Instrument<'a> {
    body: &'a Expected,
    wiring: Wiring,
    square: bool,
}

impl<'a> Instrument<'a> {
    fn new(body: &'a Expected, made: Arrangement) -> Self {
        Self { body, wiring: Wiring::new(made, body.electrodes), square: false }
    }

    /// One frame without noise, in the file's order; a square holds 9 where nothing is measured.
    fn frame(&self) -> Vec<Complex64> {
        let steps = &self.body.steps;
        let length = if self.square { usize::from(self.body.electrodes).pow(2) } else { steps.len() };
        let indices = self.wiring.arrangement.file_indices(steps, self.body.electrodes, length).unwrap();
        let mut frame = vec![Complex64::new(9.0, 0.0); length];
        for (step, index) in steps.iter().zip(indices) {
            frame[index] = self.body.voltage(self.wiring.step(*step)).into();
        }
        frame
    }

    /// Frames with noise of this share of each value.
    fn frames(&self, count: usize, noise: f64) -> Frames {
        let mut random = Pcg64::seed_from_u64(9);
        let clean = self.frame();
        let values = (0..count)
            .flat_map(|_| clean.clone())
            .map(|value| value * (1.0 + noise * random.random_range(-1.0..1.0)))
            .collect();
        Frames { values, frames: count, measurements: clean.len(), complex: false }
    }
}

const PLAIN: Arrangement = Arrangement { sense: SenseOrder::Absolute, rotation: 0, mirrored: false };

fn good(body: &Expected) -> Frames {
    Instrument::new(body, PLAIN).frames(20, 0.001)
}

fn about(check: &Check) -> Vec<About> {
    check.findings.iter().map(|finding| finding.about).collect()
}

#[track_caller]
fn only(body: &Expected, frames: &Frames, expected: About) -> Check {
    let check = check(body, frames, PLAIN).unwrap();
    assert_eq!(about(&check), [expected], "{:#?}", check.findings);
    check
}

#[test]
fn good_frames_have_nothing_wrong() {
    let body = adjacent(1);
    let check = check(&body, &good(&body), PLAIN).unwrap();
    assert_eq!(check.findings, []);
    assert!(check.numbering.correlation > 0.9999);
    let reciprocity = check.reciprocity.unwrap();
    assert_eq!(reciprocity.pairs.len(), 104);
    assert!(reciprocity.rms_percent < 0.1, "{}", reciprocity.rms_percent);
    // Noise of +-0.1 %, evenly spread: 0.1 % / sqrt(3).
    let snr = check.steadiness.unwrap().snr_db.unwrap();
    assert!((snr - 64.8).abs() < 1.0, "{snr}");
    assert!(check.reversal.is_none() && check.saturation.is_none() && check.repeats.frames == 0);
}

#[test]
fn exchanged_electrodes_are_named_where_noise_drowns_the_small_voltages() {
    for seed in 20..40 {
        let body = adjacent(seed);
        let [a, b] = [(seed % 16) as u8, ((seed + 1) % 16) as u8];
        let mut instrument = Instrument::new(&body, PLAIN);
        instrument.wiring = instrument.wiring.with(Exchange { electrodes: [a, b], role: Role::Both });
        let clean = instrument.frame();
        let mean_square = clean.iter().map(Complex64::norm_sqr).sum::<f64>() / clean.len() as f64;
        let mut random = Pcg64::seed_from_u64(seed);
        let noise = mean_square.sqrt() * 0.3;
        let values: Vec<_> = clean
            .repeat(10)
            .iter()
            .map(|value| value + noise * (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>())
            .collect();
        let frames = Frames { values, frames: 10, measurements: clean.len(), complex: false };
        let check = check(&body, &frames, PLAIN).unwrap();
        // Drive and sense exchanged differ by the noise.
        let is_of_wires =
            |about| matches!(about, About::Order | About::Exchange | About::Polarity | About::Electrode);
        let faults: Vec<_> = check.findings.iter().filter(|it| is_of_wires(it.about)).collect();
        let [only] = &faults[..] else { panic!("{seed}: {faults:#?}") };
        let words = format!("electrodes {} and {} seem exchanged", a.min(b) + 1, a.max(b) + 1);
        assert!(only.found.starts_with(&words), "{seed}: {only:?}");
    }
}

#[test]
fn exchanged_electrodes_are_named_with_the_side_they_are_exchanged_on() {
    let body = adjacent(2);
    for (electrodes, role, words) in [
        ([2, 3], Role::Both, "electrodes 3 and 4 seem exchanged"),
        ([0, 9], Role::Drive, "the drive side of electrodes 1 and 10"),
        ([5, 6], Role::Sense, "the sense side of electrodes 6 and 7"),
    ] {
        let mut instrument = Instrument::new(&body, PLAIN);
        let exchange = Exchange { electrodes, role };
        instrument.wiring = instrument.wiring.with(exchange);
        let check = check(&body, &instrument.frames(20, 0.001), PLAIN).unwrap();
        assert_eq!(check.numbering.exchanged, [exchange]);
        assert!(check.findings[0].found.contains(words), "{:#?}", check.findings);
        assert!(check.numbering.exchanged_correlation > 0.999);
    }
}

#[test]
fn frames_of_noise_fit_nothing_and_no_order_is_advised() {
    let body = adjacent(21);
    for seed in 0..10 {
        let mut random = Pcg64::seed_from_u64(seed);
        let values: Vec<_> = (0..208).map(|_| Complex64::from(random.random_range(-1.0..1.0))).collect();
        let frames = Frames { values, frames: 1, measurements: 208, complex: false };
        let check = check(&body, &frames, PLAIN).unwrap();
        assert!(check.numbering.best_correlation < 0.5, "{}", check.numbering.best_correlation);
        let about = about(&check);
        assert!(about.contains(&About::Resemblance) && !about.contains(&About::Order), "{about:?}");
        let words = &check.findings.iter().find(|f| f.about == About::Resemblance).unwrap().found;
        assert!(words.starts_with("nothing fits: no order of the measurements"), "{words}");
    }
}

#[test]
fn two_exchanges_are_both_found() {
    let body = adjacent(3);
    let mut instrument = Instrument::new(&body, PLAIN);
    for electrodes in [[2, 3], [8, 12]] {
        instrument.wiring = instrument.wiring.with(Exchange { electrodes, role: Role::Both });
    }
    let check = check(&body, &instrument.frames(20, 0.001), PLAIN).unwrap();
    let mut found: Vec<_> = check.numbering.exchanged.iter().map(|exchange| exchange.electrodes).collect();
    found.sort_unstable();
    assert_eq!(found, [[2, 3], [8, 12]], "{:#?}", check.numbering);
}

#[test]
fn an_electrode_without_contact_is_named() {
    let body = adjacent(4);
    let mut frames = good(&body);
    let mut random = Pcg64::seed_from_u64(1);
    let uses = |step: &Step| step.to_bytes().contains(&11);
    // An open input picks up anything, an open drive leaves noise.
    for frame in frames.values.chunks_exact_mut(208) {
        for (step, value) in body.steps.iter().zip(frame).filter(|(step, _)| uses(step)) {
            let size = if step.drive_plus == 11 || step.drive_minus == 11 { 1e-4 } else { 3.0 };
            *value = Complex64::from(size * random.random_range(0.3..1.0));
        }
    }
    let check = check(&body, &frames, PLAIN).unwrap();
    let electrode: Vec<_> = check.findings.iter().filter(|f| f.about == About::Electrode).collect();
    assert_eq!(electrode.len(), 1, "{:#?}", check.findings);
    assert!(
        electrode[0].found.starts_with("electrode 12: nearly all measurements that use it"),
        "{electrode:?}"
    );
    assert!(!about(&check).contains(&About::Resemblance), "the others resemble the model");
    assert!(!about(&check).contains(&About::Order));
}

#[test]
fn a_drive_switch_that_stays_open_is_named() {
    let body = adjacent(5);
    let mut frames = good(&body);
    for frame in frames.values.chunks_exact_mut(208) {
        for (step, value) in body.steps.iter().zip(frame) {
            if step.drive_plus == 6 || step.drive_minus == 6 {
                *value = Complex64::ZERO;
            }
        }
    }
    let check = check(&body, &frames, PLAIN).unwrap();
    assert!(check.electrodes[6].drive_is_off() && !check.electrodes[6].sense_is_off());
    assert!(!check.electrodes[5].drive_is_off() && !check.electrodes[7].drive_is_off());
    assert_eq!(check.dead_steps.len(), 26);
    assert!(
        check.findings.iter().any(|f| f.found.starts_with("electrode 7: nearly all measurements that drive"))
    );
    assert!(!about(&check).contains(&About::Dead), "the electrode explains them");
}

#[test]
fn a_noisy_contact_is_named() {
    let body = adjacent(6);
    let mut frames = good(&body);
    let mut random = Pcg64::seed_from_u64(2);
    for frame in frames.values.chunks_exact_mut(208) {
        for (step, value) in body.steps.iter().zip(frame) {
            if step.to_bytes().contains(&3) {
                *value += random.random_range(-0.001..0.001);
            }
        }
    }
    let check = only(&body, &frames, About::Electrode);
    assert!(
        check.findings[0]
            .found
            .starts_with("electrode 4: nearly all measurements that use it are far noisier")
    );
}

#[test]
fn an_offset_is_measured_and_once_subtracted_all_is_well() {
    let body = adjacent(7);
    let frames = good(&body).minus(-3.0);
    let found = check(&body, &frames, PLAIN).unwrap();
    let offset = found.offset.unwrap();
    assert!((offset.value - 3.0).abs() < 0.05, "{offset:?}");
    assert!(about(&found).contains(&About::Offset));
    assert_eq!(check(&body, &frames.minus(3.0), PLAIN).unwrap().findings, []);
}

#[test]
fn clipped_values_are_counted() {
    let body = adjacent(8);
    let mut frames = good(&body);
    let limit = 0.9 * body.steps.iter().map(|&step| body.voltage(step)).fold(0.0, f64::max);
    frames.values.iter_mut().for_each(|value| value.re = value.re.min(limit));
    let clipped = frames.values.iter().filter(|value| value.re == limit).count();
    let check = only(&body, &frames, About::Saturation);
    let saturation = check.saturation.unwrap();
    assert_eq!((saturation.limit, saturation.values, saturation.frames), (limit, clipped, 20));
}

#[test]
fn repeated_frames_are_counted() {
    let body = adjacent(9);
    let mut frames = good(&body);
    frames.values.copy_within(3 * 208..4 * 208, 4 * 208);
    frames.values.copy_within(3 * 208..4 * 208, 9 * 208);
    let check = only(&body, &frames, About::Repeats);
    assert_eq!(check.repeats, Repeats { in_a_row: vec![4], frames: 2 });
}

#[test]
fn a_reversed_sense_pair_is_named_and_all_reversed_is_only_noted() {
    let body = adjacent(10);
    let mut frames = good(&body);
    frames.values.iter_mut().for_each(|value| *value *= -1.0);
    let found = only(&body, &frames, About::Polarity);
    assert_eq!(found.findings[0].level, Level::Note);
    assert!((found.polarity.phase_degrees.abs() - 180.0).abs() < 1e-9);
    for frame in frames.values.chunks_exact_mut(208) {
        for (step, value) in body.steps.iter().zip(frame) {
            *value *= if step.sense_plus == 5 { -1.0 } else { 1.0 };
        }
    }
    let found = check(&body, &frames, PLAIN).unwrap();
    assert_eq!(found.polarity.reversed_senses, [[5, 6]]);
    assert_eq!(found.findings[0].found, "the signs of sense pairs 6-7 are reversed");
    assert!(found.reciprocity.unwrap().rms_percent < 0.1, "signs are left to the polarity");
}

#[test]
fn magnitudes_of_an_opposite_pattern_are_noted() {
    let body = disc(16, pattern(16, 8, 1, Driven::Skipped).collect(), 11);
    let mut frames = good(&body);
    frames.values.iter_mut().for_each(|value| *value = value.norm().into());
    let check = only(&body, &frames, About::Polarity);
    assert!(check.polarity.magnitudes_only && check.findings[0].level == Level::Note);
    assert!(check.reciprocity.is_none());
    assert_eq!(check.reversal.unwrap().pairs.len(), 96);
}

#[test]
fn gains_that_differ_between_channels_show_as_reciprocity_error() {
    let body = adjacent(12);
    let mut frames = good(&body);
    for frame in frames.values.chunks_exact_mut(208) {
        for (step, value) in body.steps.iter().zip(frame) {
            *value *= if step.sense_plus % 2 == 0 { 1.3 } else { 1.0 };
        }
    }
    let check = check(&body, &frames, PLAIN).unwrap();
    // Half of the pairs of steps join an even and an odd sense pair: 0.3 / 1.15.
    let error = check.reciprocity.unwrap();
    let found = error.pairs.iter().map(|pair| pair.error_percent).fold(0.0, f64::max);
    assert!((found - 26.1).abs() < 0.5, "{found}");
    let share = error.pairs.iter().filter(|pair| pair.error_percent > 20.0).count();
    assert!((45..60).contains(&share), "{share}");
}

#[test]
fn potentials_of_electrodes_are_told_from_differences() {
    let body = adjacent(13);
    let at = |drive: usize, electrode: u8| {
        // Against the middle of the sheet, far from all electrodes.
        let [plus, minus] = [((drive + 1) % 16) as u8, drive as u8];
        let step = Step {
            drive_plus: plus,
            drive_minus: minus,
            sense_plus: electrode,
            sense_minus: (minus + 8) % 16,
        };
        if step.is_valid(16) { body.voltage(step) } else { 0.0 }
    };
    let square: Vec<Complex64> = (0..256).map(|place| at(place / 16, (place % 16) as u8).into()).collect();
    let frames = Frames { values: square, frames: 1, measurements: 256, complex: false };
    let check = only(&body, &frames, About::SingleEnded);
    assert!(check.single_ended && check.numbering.correlation > 0.999);
}

#[test]
fn a_table_in_other_electrode_numbers_is_not_to_be_read_but_told() {
    let steps =
        [[0, 1, 2, 3], [0, 1, 3, 4], [0, 2, 4, 5], [1, 3, 5, 0], [2, 5, 3, 1], [4, 0, 1, 2], [3, 1, 4, 2]];
    let body = disc(6, steps.map(Step::from_bytes).to_vec(), 14);
    let made = Arrangement { rotation: 2, ..PLAIN };
    let check = check(&body, &Instrument::new(&body, made).frames(20, 0.0001), PLAIN).unwrap();
    assert_eq!(check.numbering.best, made, "{:#?}", check.numbering);
    assert!(check.findings[0].advice.to_string().contains("`electrodes.first`"), "{:#?}", check.findings);
}

#[test]
fn frames_of_another_length_are_refused() {
    let body = adjacent(15);
    let frames = Frames { values: vec![Complex64::ONE; 192], frames: 1, measurements: 192, complex: false };
    assert!(matches!(check(&body, &frames, PLAIN), Err(OrderError::Length { found: 192, .. })));
}

#[test]
fn the_model_of_a_skin_expects_its_own_voltages() {
    let text = include_str!("../../../../tests/data/tiny.toml");
    let skin = Skin::parse(std::path::Path::new("skin.toml"), text).unwrap().made().unwrap();
    let model = dermatome_model::model::Model::build(&skin, |_| ()).unwrap();
    let expected = Expected::of(&skin).unwrap();
    for (step, voltage) in model.steps.iter().zip(&model.voltages) {
        assert!((expected.voltage(*step) - voltage).abs() < 1e-12);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn every_arrangement_is_found_again(
        seed: u64,
        electrodes in 6_u8..=20,
        kind in 0_u8..3,
        measured: bool,
        rotation: u8,
        relative: bool,
        mirrored: bool,
        square: bool,
    ) {
        let (drive, sense) = [(1, 1), (electrodes / 2, 1), (2, 2)][usize::from(kind)];
        let driven = if measured { Driven::Measured } else { Driven::Skipped };
        let body = disc(electrodes, pattern(electrodes, drive, sense, driven).collect(), seed);
        let sense = if relative { SenseOrder::Relative } else { SenseOrder::Absolute };
        let made = Arrangement { sense, rotation: rotation % electrodes, mirrored };
        let frames = Instrument { square, ..Instrument::new(&body, made) }.frames(5, 0.0005);
        let found = check(&body, &frames, PLAIN).unwrap();
        prop_assert!(found.numbering.best_correlation > 0.99, "{:?}", found.numbering);
        prop_assert!(found.numbering.exchanged.is_empty(), "{:?}", found.numbering);
        // Another arrangement is taken only where it fits as well: some discs are nearly symmetric, and
        // opposite drives look the same half a turn further.
        let ties = found.numbering.best_correlation > 1.0 - TIE - 0.001;
        prop_assert!(found.numbering.best == made || ties, "{:?}", found.numbering);
        let reread = check(&body, &frames, made).unwrap();
        let faults = reread.findings.iter().filter(|finding| finding.level == Level::Fault).count();
        prop_assert_eq!(faults, 0, "{:?}", reread.findings);
    }

    #[test]
    fn an_exchanged_pair_is_found_in_every_arrangement(
        seed: u64,
        a in 0_u8..16,
        b in 0_u8..16,
        rotation in 0_u8..16,
        mirrored: bool,
        opposite: bool,
    ) {
        prop_assume!(a != b);
        let drive = if opposite { 8 } else { 1 };
        let body = disc(16, pattern(16, drive, 1, Driven::Skipped).collect(), seed);
        let made = Arrangement { rotation, mirrored, ..PLAIN };
        let mut instrument = Instrument::new(&body, made);
        let exchange = Exchange { electrodes: [a.min(b), a.max(b)], role: Role::Both };
        instrument.wiring = instrument.wiring.with(exchange);
        let found = check(&body, &instrument.frames(5, 0.0005), made).unwrap();
        prop_assert_eq!(found.numbering.exchanged, [exchange]);
    }

    #[test]
    fn no_values_make_the_check_panic(
        values in prop::collection::vec(prop_oneof![
            any::<f64>().prop_filter("finite", |value| value.is_finite()),
            Just(0.0),
            Just(1.0),
            -10.0..10.0,
        ], 40 * 4),
        complex: bool,
        rotation in 0_u8..8,
        square: bool,
    ) {
        let body = disc(8, pattern(8, 1, 1, Driven::Skipped).collect(), 1);
        let measurements = if square { 64 } else { 40 };
        let frames = values.len() / measurements;
        let mut values: Vec<Complex64> =
            values.chunks(2).flat_map(|pair| [Complex64::new(pair[0], if complex { pair[1] } else { 0.0 }); 2]).collect();
        values.truncate(frames * measurements);
        let frames = Frames { values, frames, measurements, complex };
        let check = check(&body, &frames, Arrangement { rotation, ..PLAIN }).unwrap();
        prop_assert!(check.numbering.correlation.abs() <= 1.0 || check.numbering.correlation.is_nan());
        serde_json::to_string(&check).unwrap();
    }
}
