//! Patches with reflexes.

use super::*;
use crate::{contact::calibration::CalibrationPoint, patch::reflexes::*};

/// A rule of one row: pin 1, released at half the limit, at once.
pub(crate) fn rule(limit: Limit) -> ReflexRule {
    ReflexRule {
        name: "bumper".try_into().unwrap(),
        pin: 1,
        limit,
        release: 0.5,
        frames: 1,
        hold: 0.0,
        trips_blind: true,
        rows: 1,
    }
}

/// A row of 1 cm^2 with these weights.
pub(crate) fn row(weights: &[f32]) -> ReflexRow<&[f32]> {
    ReflexRow { area: 1e-4, places: [0xA5; 32], weights }
}

/// As the small patch of normalised data, with these rules; its calibration: 100 kPa for each 1, and a load of 1 cm^2.
pub(crate) fn patch_with_reflexes(rules: &[ReflexRule], rows: &[ReflexRow<&[f32]>]) -> std::vec::Vec<u8> {
    let point = CalibrationPoint { strength: 1.0, pressure: 100e3 };
    calibrated(rules, rows, Calibration { points: [point].into_iter().collect(), load_share: Some(1.0) })
}

fn calibrated(
    rules: &[ReflexRule],
    rows: &[ReflexRow<&[f32]>],
    calibration: Calibration,
) -> std::vec::Vec<u8> {
    let bytes = small_patch(Difference::Normalised);
    let patch = PatchView::validate(&bytes).unwrap();
    let (pixels, neighbours) = square(2).tables();
    let (steps, combination): (std::vec::Vec<_>, std::vec::Vec<_>) =
        patch.steps().zip(patch.combination()).unzip();
    let (reflexes, reflex_rows) = (rules.len() as u8, rows.len() as u8);
    let mut header = PatchHeader { calibration, reflexes, reflex_rows, ..patch.header.clone() };
    header.detection.radius = (1e-4 / core::f32::consts::PI).sqrt();
    written_with(&PatchContents {
        play_operators: &[],
        reflexes: ReflexTables { rules, rows },
        header: &header,
        steps: &steps,
        combination: &combination,
        pixels: &pixels,
        neighbours: &neighbours,
        matrix: diagonal(2, 1 << 14).tables(),
        places: Default::default(),
    })
}

#[test]
fn rules_and_their_rows_read_back() {
    let weights: std::vec::Vec<f32> = (0..80).map(|n| 0.25 * n as f32 - 7.0).collect();
    let area = Limit::Area { area: 1e-3, strength: 0.2 };
    let rules = [
        ReflexRule { name: "sixteen bytes ok".try_into().unwrap(), pin: 4, ..rule(Limit::Force(5.0)) },
        ReflexRule { hold: 0.25, frames: 3, trips_blind: false, rows: 2, ..rule(area) },
    ];
    let rows = [row(&weights[..40]), row(&weights[40..]), row(&weights[..40])];
    let bytes = patch_with_reflexes(&rules, &rows);
    let patch = PatchView::validate(&bytes).unwrap();
    assert!(patch.reflex_rules().eq(rules));
    for (read, written) in patch.reflex_rows().zip(&rows) {
        assert_eq!((read.area, read.places), (written.area, written.places));
        assert!(read.weights.iter().eq(written.weights.iter().copied()));
        assert_eq!((read.weights.get(3), read.weights.get(40)), (written.weights[3], 0.0));
    }
    assert_eq!(patch.reflex_rows().count(), 3);
}

#[test]
fn rules_that_no_board_can_follow_are_refused() {
    let weights = [1.0; 40];
    let good = rule(Limit::Strength(0.5));
    let bad = [
        ReflexRule { pin: 0, ..good.clone() },
        ReflexRule { pin: 5, ..good.clone() },
        ReflexRule { frames: 0, ..good.clone() },
        ReflexRule { release: 1.5, ..good.clone() },
        ReflexRule { release: f32::NAN, ..good.clone() },
        ReflexRule { hold: -1.0, ..good.clone() },
        ReflexRule { limit: Limit::Strength(0.0), ..good.clone() },
        ReflexRule { limit: Limit::Force(f32::INFINITY), ..good.clone() },
        ReflexRule { limit: Limit::Area { area: 1e-3, strength: -1.0 }, ..good.clone() },
    ];
    for (number, bad) in bad.into_iter().enumerate() {
        let bytes = patch_with_reflexes(&[good.clone(), bad], &[row(&weights), row(&weights)]);
        let refused = PatchView::validate(&bytes).map(|_| ());
        assert_eq!(refused, Err(PatchError::ReflexRule { rule: 1 }), "{number}");
    }
    let too_few = patch_with_reflexes(&[good.clone(), good.clone()], &[row(&weights)]);
    assert_eq!(PatchView::validate(&too_few).map(|_| ()), Err(PatchError::ReflexRows { rows: 2 }));
    let not_finite = patch_with_reflexes(&[good], &[row(&[f32::NAN; 40])]);
    assert_eq!(PatchView::validate(&not_finite).map(|_| ()), Err(PatchError::ReflexRows { rows: 1 }));
}

#[test]
fn a_force_needs_a_calibration() {
    let bytes = patch_with_reflexes(&[rule(Limit::Force(5.0))], &[row(&[1.0; 40])]);
    let patch = PatchView::validate(&bytes).unwrap();
    // 100 kPa for each 1, on 1 cm^2.
    assert!((force_of(&patch.header, 0.5).unwrap() - 5.0).abs() < 1e-5);
    assert!((strength_of(&patch.header, 5.0) - 0.5).abs() < 1e-5);
    for calibration in [
        Calibration { points: Default::default(), ..patch.header.calibration.clone() },
        Calibration { load_share: None, ..patch.header.calibration.clone() },
    ] {
        let uncalibrated = PatchHeader { calibration: calibration.clone(), ..patch.header.clone() };
        assert!(strength_of(&uncalibrated, 5.0) > 1e5, "no strength is one");
        let bytes = calibrated(&[rule(Limit::Force(5.0))], &[row(&[1.0; 40])], calibration);
        assert_eq!(PatchView::validate(&bytes).map(|_| ()), Err(PatchError::ReflexRule { rule: 0 }));
    }
}
