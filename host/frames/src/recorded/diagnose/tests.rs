use super::*;
use crate::recorded::{difference::difference, order::SenseOrder, wording::Plain};
use dermatome_shared::stimulation::{Driven, pattern};
use proptest::prelude::*;
use rand::{Rng, SeedableRng};

/// Voltages of an adjacent pattern on a disc, times a factor for each electrode touched, so that
/// every rotation looks different.
struct Body {
    steps: Vec<Step>,
    voltages: Vec<f64>,
}

impl Body {
    fn new(seed: u64, drive_distance: u8, spread: f64) -> Self {
        let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
        let factors: Vec<f64> = (0..16).map(|_| 1.0 + spread * random.random_range(-0.6..1.0)).collect();
        let steps: Vec<_> = pattern(16, drive_distance, 1, Driven::Skipped).collect();
        let voltages = steps.iter().map(|step| disc_voltage(step) * touched(step, &factors)).collect();
        Self { steps, voltages }
    }

    fn diagnose(&self, reference: &[Complex64], used: Arrangement) -> Diagnosis {
        diagnose(&self.steps, 16, &self.voltages, reference, used).unwrap()
    }

    /// A frame as a file of this arrangement lists it; `square` files hold 9 where nothing is measured.
    fn filed(&self, values: &[f64], arrangement: Arrangement, square: bool) -> Vec<Complex64> {
        let measurements = if square { 256 } else { self.steps.len() };
        let map = arrangement.index_map(&self.steps, 16, measurements).unwrap();
        let mut file = vec![Complex64::new(9.0, 0.0); measurements];
        for (place, value) in map.iter().zip(values) {
            file[place.index] = Complex64::from(if place.flipped { -value } else { *value });
        }
        file
    }
}

/// Point electrodes on a homogeneous unit disc of unit sheet conductivity: potential -ln(r) / pi.
fn disc_voltage(step: &Step) -> f64 {
    let distance = |a: u8, b: u8| (std::f64::consts::PI * f64::from(a.abs_diff(b)) / 16.0).sin();
    let [p, q, a, b] = step.to_bytes();
    (distance(a, q) * distance(b, p) / (distance(a, p) * distance(b, q))).ln() / std::f64::consts::PI
}

fn touched(step: &Step, factors: &[f64]) -> f64 {
    step.to_bytes().iter().map(|&electrode| factors[usize::from(electrode)]).product()
}

fn arrangement(sense: SenseOrder, rotation: u8, mirrored: bool) -> Arrangement {
    Arrangement { sense, rotation, mirrored }
}

const PLAIN: Arrangement = Arrangement { sense: SenseOrder::Absolute, rotation: 0, mirrored: false };

#[test]
fn a_file_in_the_models_order_gives_no_warning() {
    let body = Body::new(1, 1, 1.0);
    let diagnosis = body.diagnose(&body.filed(&body.voltages, PLAIN, false), PLAIN);
    assert!(diagnosis.warnings(&Plain).is_empty(), "{:?}", diagnosis.warnings(&Plain));
    assert!((diagnosis.correlation - 1.0).abs() < 1e-12);
    assert_eq!(diagnosis.best, PLAIN);
    assert!(!diagnosis.rotation_ambiguous);
}

#[test]
fn each_wrong_order_is_told_with_the_setting_that_mends_it() {
    let body = Body::new(2, 1, 1.0);
    let advice = |made: Arrangement, used: Arrangement| {
        let diagnosis = body.diagnose(&body.filed(&body.voltages, made, false), used);
        assert_eq!(diagnosis.best, made);
        let warnings = diagnosis.warnings(&Plain);
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        warnings[0].split("): ").nth(1).unwrap().to_owned()
    };
    assert_eq!(advice(arrangement(SenseOrder::Relative, 0, false), PLAIN), "use relative order");
    assert_eq!(advice(arrangement(SenseOrder::Absolute, 3, false), PLAIN), "use rotation by 3");
    assert_eq!(advice(arrangement(SenseOrder::Absolute, 0, true), PLAIN), "use mirrored electrodes");
    let all = arrangement(SenseOrder::Relative, 5, true);
    assert_eq!(advice(all, PLAIN), "use relative order, rotation by 5, mirrored electrodes");
    assert_eq!(advice(PLAIN, all), "leave out relative order, rotation by 5, mirrored electrodes");
    let turned = arrangement(SenseOrder::Absolute, 5, false);
    assert_eq!(
        advice(turned, arrangement(SenseOrder::Absolute, 5, true)),
        "use rotation by 5, without mirrored electrodes"
    );
}

#[test]
fn on_a_disc_rotations_cannot_be_told_apart() {
    let disc = Body::new(3, 1, 0.0);
    let relative = arrangement(SenseOrder::Relative, 0, false);
    let diagnosis = disc.diagnose(&disc.filed(&disc.voltages, relative, false), PLAIN);
    assert!(diagnosis.rotation_ambiguous);
    assert_eq!(diagnosis.best, relative, "no needless rotation or mirror is recommended");
    assert!(
        diagnosis.warnings(&Plain)[0].contains("rotation cannot be told"),
        "{:?}",
        diagnosis.warnings(&Plain)
    );
    let right = disc.diagnose(&disc.filed(&disc.voltages, PLAIN, false), PLAIN);
    assert!(right.rotation_ambiguous && right.warnings(&Plain).is_empty());
}

#[test]
fn all_signs_reversed_is_no_fault_but_some_are() {
    let body = Body::new(4, 1, 1.0);
    let mut file = body.filed(&body.voltages, PLAIN, false);
    file.iter_mut().for_each(|value| *value *= Complex64::from_polar(-3.0, 0.7));
    assert!(body.diagnose(&file, PLAIN).warnings(&Plain).is_empty());
    file[5] *= -1.0;
    let diagnosis = body.diagnose(&file, PLAIN);
    assert_eq!(diagnosis.sign_disagreements, [5]);
    assert!((diagnosis.sign_disagreement() - 1.0 / diagnosis.signs_compared as f64).abs() < 1e-12);
    assert!(diagnosis.warnings(&Plain)[0].contains("(steps 5)"), "{:?}", diagnosis.warnings(&Plain));
}

#[test]
fn magnitudes_of_an_opposite_pattern_have_no_wrong_signs() {
    let body = Body::new(5, 8, 1.0);
    assert!(body.voltages.iter().any(|&voltage| voltage < 0.0));
    let magnitudes: Vec<_> = body.voltages.iter().map(|voltage| Complex64::from(voltage.abs())).collect();
    let diagnosis = body.diagnose(&magnitudes, PLAIN);
    assert!(diagnosis.magnitudes_only && diagnosis.warnings(&Plain).is_empty());
}

#[test]
fn dead_measurements_are_listed_and_left_out() {
    let body = Body::new(6, 1, 1.0);
    let mut file = body.filed(&body.voltages, PLAIN, true);
    file[19] = Complex64::from(0.0);
    let diagnosis = body.diagnose(&file, PLAIN);
    assert_eq!(diagnosis.dead, [19], "the file's index, not the step");
    assert!(diagnosis.correlation > 0.999);
    assert!(diagnosis.warnings(&Plain)[0].contains("file indices 19"));
    let all_dead = body.diagnose(&vec![Complex64::from(0.0); 208], PLAIN);
    assert_eq!((all_dead.dead.len(), all_dead.correlation), (208, 0.0));
}

#[test]
fn a_reference_of_something_else_resembles_nothing() {
    let body = Body::new(7, 1, 0.0);
    let mut random = rand_pcg::Pcg64::seed_from_u64(8);
    let noise: Vec<_> = (0..208).map(|_| Complex64::from(random.random_range(0.1..1.0))).collect();
    let diagnosis = body.diagnose(&noise, PLAIN);
    assert!(diagnosis.best_correlation < 0.5);
    let flat = body.diagnose(&vec![Complex64::from(1.0); 208], PLAIN);
    assert!(
        flat.warnings(&Plain)[0].contains("nothing fits")
            && flat.warnings(&Plain)[0].contains("(best 0.000)")
    );
    // Whichever order fits noise best is not recommended, however badly the one in use fits.
    let advised = |random: &mut rand_pcg::Pcg64| {
        let noise: Vec<_> = (0..208).map(|_| Complex64::from(random.random_range(0.1..1.0))).collect();
        body.diagnose(&noise, PLAIN)
    };
    for diagnosis in (0..50).map(|_| advised(&mut random)) {
        assert!(diagnosis.best_correlation < 0.35, "{}", diagnosis.best_correlation);
        let [warning] = &diagnosis.warnings(&Plain)[..] else { panic!("{:?}", diagnosis.warnings(&Plain)) };
        assert!(warning.contains("nothing fits: no order of the measurements"), "{warning}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn every_permutation_is_found_again(
        seed: u64,
        rotation in 0_u8..16,
        relative: bool,
        mirrored: bool,
        square: bool,
        opposite: bool,
    ) {
        let body = Body::new(seed, if opposite { 8 } else { 1 }, 1.0);
        let sense = if relative { SenseOrder::Relative } else { SenseOrder::Absolute };
        let made = arrangement(sense, rotation, mirrored);
        let diagnosis = body.diagnose(&body.filed(&body.voltages, made, square), PLAIN);
        prop_assert!((diagnosis.best_correlation - 1.0).abs() < 1e-9 + TIE);
        // Opposite drives look the same half a turn further.
        let found = diagnosis.best;
        prop_assert!(found == made || (found.sense == made.sense && diagnosis.rotation_ambiguous), "{:?}", found);
        let reread = body.diagnose(&body.filed(&body.voltages, made, square), made);
        prop_assert!(reread.warnings(&Plain).is_empty(), "{:?}", reread.warnings(&Plain));
    }

    #[test]
    fn difference_does_not_depend_on_the_files_arrangement(
        seed: u64,
        rotation in 0_u8..16,
        relative: bool,
        mirrored: bool,
        square: bool,
        opposite: bool,
    ) {
        let body = Body::new(seed, if opposite { 8 } else { 1 }, 1.0);
        let sense = if relative { SenseOrder::Relative } else { SenseOrder::Absolute };
        let made = arrangement(sense, rotation, mirrored);
        let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
        let changed: Vec<_> = body.voltages.iter().map(|v| v * random.random_range(0.9..1.1)).collect();
        let file = |values: &[f64]| body.filed(values, made, square);
        let (reference, frame) = (file(&body.voltages), file(&changed));
        let map = made.index_map(&body.steps, 16, reference.len()).unwrap();
        let found = difference(&reference, &frame, &map, &body.voltages);
        for ((dv, v), r) in found.iter().zip(&changed).zip(&body.voltages) {
            prop_assert!((dv - (v - r)).abs() < 1e-12);
        }
    }
}
