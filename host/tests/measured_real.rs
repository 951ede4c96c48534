//! Measured frames of real instruments, which are no part of the project: not run where absent.
//!
//! Orders are checked against a homogeneous disc with point electrodes, in closed form; images are
//! made with the shipped disc.

use dermatome::{
    model::Model,
    recorded::{
        check::{
            Check, Expected, check as check_frames,
            findings::{About, Level},
            reading::Misplacement,
            wiring::{Exchange, Role},
        },
        diagnose::{Diagnosis, diagnose},
        order::{Arrangement, SenseOrder},
        read::{Frames, Source, read},
        reconstruct::{FrameResult, Polarity, Reference, reconstruct},
        wording::Plain,
    },
    skin::Skin,
};
use dermatome_shared::stimulation::{Driven, Step, pattern};
use num_complex::Complex64;
use std::{ffi::OsString, path::Path};

const PLAIN: Arrangement = Arrangement { sense: SenseOrder::Absolute, rotation: 0, mirrored: false };
const RELATIVE: Arrangement = Arrangement { sense: SenseOrder::Relative, rotation: 0, mirrored: false };

/// Measured frames of a file with its key.
fn frames(name_and_key: &str) -> Option<Frames> {
    frames_in("real", name_and_key)
}

/// Frames of a file with its key; `None`, and says so, where the file is absent.
fn frames_in(folder: &str, name_and_key: &str) -> Option<Frames> {
    let folder = format!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/{}"), folder);
    let (name, _) = name_and_key.split_once(':').unwrap();
    if !Path::new(&folder).join(name).exists() {
        println!("not run: {name} is absent");
        return None;
    }
    let frames = read(&Source::new(&OsString::from(format!("{folder}/{name_and_key}")))).unwrap();
    Some(frames.with_square(16, 208))
}

/// Point electrodes on a homogeneous unit disc: potential -ln(r) / pi round each, with its current.
fn disc_voltage(step: &Step) -> f64 {
    let distance = |a: u8, b: u8| (std::f64::consts::PI * f64::from(a.abs_diff(b)) / 16.0).sin();
    let [p, q, a, b] = step.to_bytes();
    (distance(a, q) * distance(b, p) / (distance(a, p) * distance(b, q))).ln() / std::f64::consts::PI
}

fn check(reference: &[Complex64], drive_distance: u8, used: Arrangement) -> Diagnosis {
    let steps: Vec<_> = pattern(16, drive_distance, 1, Driven::Skipped).collect();
    let voltages: Vec<_> = steps.iter().map(disc_voltage).collect();
    diagnose(&steps, 16, &voltages, reference, used).unwrap()
}

#[test]
fn canonical_tank_data_resemble_a_disc_and_only_in_canonical_order() {
    for (name, shape) in [
        ("iirc_2006.npz:v_ref", (1, 208)),
        ("iirc_2006.npz:v_ref_256", (1, 256)),
        ("ottawa_2005_planeA.npz:vvRef", (1, 208)),
        ("sciospec_tank_adjacent.npz:v", (255, 208)),
    ] {
        let Some(frames) = frames(name) else { continue };
        assert_eq!((frames.frames, frames.measurements), shape, "{name}");
        let diagnosis = check(&frames.mean(), 1, PLAIN);
        assert!(diagnosis.correlation > 0.97, "{name}: {}", diagnosis.correlation);
        assert!(diagnosis.warnings(&Plain).is_empty(), "{name}: {:?}", diagnosis.warnings(&Plain));
        let wrong = check(&frames.mean(), 1, RELATIVE);
        assert_eq!(wrong.best, PLAIN, "{name}");
        assert!(wrong.warnings(&Plain)[0].contains("leave out relative order"), "{name}");
    }
}

#[test]
fn the_hydrogel_skins_magnitudes_are_nothing_like_a_disc_and_the_user_is_told() {
    let Some(frames) = frames("hydrogel_skin_wam.npz:v_unpressed") else { return };
    assert_eq!((frames.frames, frames.measurements), (400, 192));
    let diagnosis = check(&frames.mean(), 8, PLAIN);
    assert!(diagnosis.magnitudes_only);
    assert!(diagnosis.warnings(&Plain)[0].contains("nothing fits"), "{:?}", diagnosis.warnings(&Plain));
}

#[test]
fn the_carbon_black_skin_is_read_as_full_squares() {
    let Some(frames) = frames("black_sensor_ert_skin.npz:expX_150mm_8p5wt_7") else { return };
    assert_eq!((frames.frames, frames.measurements), (69, 256));
    let diagnosis = check(&frames.mean(), 1, PLAIN);
    // Raw converter counts with an offset: the U-shape is there, squeezed.
    assert!((0.7..0.9).contains(&diagnosis.correlation), "{}", diagnosis.correlation);
    assert_eq!(diagnosis.best, PLAIN);
}

/// Images of measured frames with the shipped disc, whose 16 electrodes lie like the tanks'.
fn images(reference: &Frames, frames: &Frames) -> Vec<FrameResult> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/disc-210mm/skin.toml");
    let skin = Skin::load(&path).unwrap().made().unwrap();
    let model = Model::build(&skin, |_| ()).unwrap();
    reconstruct(&model, Reference::Mean(reference), frames, &PLAIN, Polarity::Auto).unwrap()
}

/// Centre of the strongest object as shares of the radius.
fn place(result: &FrameResult) -> [f64; 2] {
    [result.objects[0].x_mm / 105.0, result.objects[0].y_mm / 105.0]
}

/// Where EIDORS' pictures of these frames show the object, read off as shares of the radius.
fn assert_places(name: &str, results: &[FrameResult], expected: &[(usize, [f64; 2])]) {
    for &(frame, [x, y]) in expected {
        let [found_x, found_y] = place(&results[frame]);
        let error = (found_x - x).hypot(found_y - y);
        println!("{name} frame {frame}: {error:.3} of the radius away");
        assert!(error < 0.1, "{name} frame {frame}: ({found_x:.2}, {found_y:.2}) against ({x}, {y})");
        assert_eq!(results[frame].polarity, Polarity::Down, "{name} frame {frame}: the object insulates");
    }
}

#[test]
fn the_rod_that_goes_round_turns_one_way_at_a_steady_radius() {
    let (Some(reference), Some(moving)) = (frames("iirc_2006.npz:v_ref"), frames("iirc_2006.npz:v_rotate"))
    else {
        return;
    };
    let results = images(&reference, &moving);
    assert_places(
        "iirc",
        &results,
        &[
            (0, [0.22, 0.46]),
            (12, [0.27, -0.38]),
            (25, [-0.51, 0.17]),
            (37, [0.38, 0.35]),
            (50, [-0.33, -0.36]),
            (62, [-0.32, 0.37]),
            (75, [0.51, -0.11]),
            (87, [-0.41, -0.35]),
        ],
    );
    let turn = |pair: &[FrameResult]| {
        let [a, b] = [pair[0].objects[0].angle_degrees, pair[1].objects[0].angle_degrees];
        (b - a + 540.0).rem_euclid(360.0) - 180.0
    };
    let turns: Vec<f64> = results.windows(2).map(turn).collect();
    // In five places two frames in a row hold the same scene (their voltages differ by noise only):
    // there the rod stands still, and half a degree either way is noise.
    let still = turns.iter().filter(|turn| turn.abs() < 0.5).count();
    assert_eq!(still, 5, "{turns:?}");
    assert!(turns.iter().all(|&turn| turn < 0.5), "the angle turns back: {turns:?}");
    assert!(
        turns.iter().sum::<f64>() < -900.0,
        "the rod goes round more than two and a half times, clockwise"
    );
    // The rod was led by hand: EIDORS' own matrix gives a mean of 46.4 % and a spread of 4.5 %.
    let radii: Vec<f64> = results.iter().map(|result| result.objects[0].radius_percent).collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let spread =
        (radii.iter().map(|radius| (radius - mean).powi(2)).sum::<f64>() / radii.len() as f64).sqrt();
    println!("iirc: radius {mean:.1} % of the tank's, standard deviation {spread:.1} %");
    assert!((mean - 46.4).abs() < 2.0, "mean radius {mean:.1} %");
    assert!(spread < 5.0, "the radius is not steady: {spread:.1} %");
}

#[test]
fn the_cup_in_the_sciospec_tank_is_where_eidors_shows_it() {
    let Some(all) = frames("sciospec_tank_adjacent.npz:v") else { return };
    let part = |from: usize, to: usize| Frames {
        values: all.values[from * 208..to * 208].to_vec(),
        frames: to - from,
        ..all
    };
    let results = images(&part(0, 20), &part(0, 255));
    assert_places(
        "sciospec",
        &results,
        &[
            (90, [0.13, 0.38]),
            (120, [0.11, 0.38]),
            (150, [0.44, -0.37]),
            (180, [-0.56, -0.17]),
            (200, [-0.27, 0.53]),
            (220, [-0.25, 0.53]),
        ],
    );
}

#[test]
fn the_golf_balls_in_ottawas_tank_are_where_eidors_shows_them() {
    let Some(reference) = frames("ottawa_2005_planeA.npz:vvRef") else { return };
    let result =
        |key: &str| images(&reference, &frames(&format!("ottawa_2005_planeA.npz:{key}")).unwrap()).remove(0);
    assert_places("ottawa middle", &[result("vvAvg1")], &[(0, [0.0, 0.0])]);
    assert_places("ottawa one ball", &[result("vvAvg2")], &[(0, [0.62, -0.02])]);
    let two = result("vvAvg3");
    assert!(two.objects.len() >= 2, "two balls are one object");
    let near = |x: f64, y: f64| {
        two.objects[..2].iter().any(|o| (o.x_mm / 105.0 - x).hypot(o.y_mm / 105.0 - y) < 0.12)
    };
    assert!(near(0.61, -0.02) && near(-0.01, -0.65), "{:?}", two.objects);
}

/// What the shipped disc should measure with this drive pattern.
fn expected(pattern: &str) -> Expected {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/disc-210mm/skin.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let text = text.replace("\"adjacent\"", &format!("\"{pattern}\""));
    Expected::of(&Skin::parse(&path, &text).unwrap().made().unwrap()).unwrap()
}

fn faults(check: &Check) -> Vec<About> {
    check
        .findings
        .iter()
        .filter(|finding| finding.level == Level::Fault)
        .map(|finding| finding.about)
        .collect()
}

#[test]
fn tanks_pass_the_check_and_turned_or_miswired_ones_are_told() {
    let disc = expected("adjacent");
    for (name, reversed) in [
        ("iirc_2006.npz:v_ref", true),
        ("iirc_2006.npz:v_ref_256", true),
        ("ottawa_2005_planeA.npz:vvRef", false),
        ("sciospec_tank_adjacent.npz:v", true),
    ] {
        let Some(frames) = frames(name) else { continue };
        let found = check_frames(&disc, &frames, PLAIN).unwrap();
        assert_eq!(faults(&found), [], "{name}: {:?}", found.findings);
        assert_eq!(found.polarity.reversed, reversed, "{name}");
        let reciprocity = found.reciprocity.unwrap();
        println!("{name}: reciprocity {:.2} %, {:.2} %", reciprocity.median_percent, reciprocity.rms_percent);
        assert!((2.0..5.2).contains(&reciprocity.median_percent) && reciprocity.rms_percent < 6.5);
        let mut wrong = found.numbering.used;
        (wrong.sense, wrong.mirrored) = (SenseOrder::Relative, true);
        assert_eq!(faults(&check_frames(&disc, &frames, wrong).unwrap()), [About::Order], "{name}");
    }
}

#[test]
fn potentials_of_the_sciospec_tank_are_told_from_differences() {
    let Some(frames) = frames("sciospec_tank_adjacent.npz:v_single_ended") else { return };
    let found = check_frames(&expected("adjacent"), &frames, PLAIN).unwrap();
    assert_eq!(faults(&found), [About::SingleEnded], "{:?}", found.findings);
    assert!(found.numbering.correlation > 0.99);
}

#[test]
fn exchanged_sense_wires_of_the_sciospec_tank_are_found() {
    let Some(mut frames) = frames("sciospec_tank_adjacent.npz:v_single_ended") else { return };
    frames.values.chunks_exact_mut(16).for_each(|row| row.swap(2, 3));
    let found = check_frames(&expected("adjacent"), &frames, PLAIN).unwrap();
    let exchange = Exchange { electrodes: [2, 3], role: Role::Sense };
    assert_eq!(found.numbering.exchanged, [exchange], "{:?}", found.findings);
    let numbering = &found.numbering;
    // 0.997 instead of 0.932.
    assert!(numbering.exchanged_correlation > 0.995 && numbering.best_correlation < 0.94, "{numbering:?}");
}

#[test]
fn the_offset_of_the_carbon_black_skins_counts_is_found() {
    let disc = expected("adjacent");
    for (run, low, high) in
        [("expABCX_150mm_8p5wt_6", 6_700.0, 7_400.0), ("expX_150mm_8p5wt_7", 7_300.0, 8_300.0)]
    {
        let Some(frames) = frames(&format!("black_sensor_ert_skin.npz:{run}")) else { return };
        let found = check_frames(&disc, &frames, PLAIN).unwrap();
        let offset = found.offset.expect("an offset");
        println!("{run}: offset {:.0}", offset.value);
        assert!((low..high).contains(&offset.value), "{run}: {offset:?}");
        assert!(faults(&found).contains(&About::Offset), "{run}");
        assert!(found.saturation.is_none() && found.repeats.frames == 0, "{run}");
    }
}

#[test]
fn the_hydrogel_skins_reversed_drives_disagree() {
    let opposite = expected("opposite");
    for key in ["v_unpressed", "damage"] {
        let Some(frames) = frames(&format!("hydrogel_skin_wam.npz:{key}")) else { return };
        let found = check_frames(&opposite, &frames, PLAIN).unwrap();
        assert!(faults(&found).contains(&About::Reversal), "{:?}", found.findings);
        let reversal = found.reversal.unwrap();
        println!("{key}: {:.0} % over {} pairs", reversal.median_percent, reversal.pairs.len());
        assert!(reversal.median_percent > 70.0 && reversal.pairs.len() == 96);
    }
}

/// Neither skin fits a model; each fits what it measured before, and a row in another's place is named.
#[test]
fn skins_that_no_model_fits_are_checked_against_their_good_frames() {
    let runs = [
        ("hydrogel_skin_wam.npz:v_unpressed", "opposite", 0.0),
        ("black_sensor_ert_skin.npz:expABCX_150mm_8p5wt_6", "adjacent", 7000.0),
        ("black_sensor_ert_skin.npz:expABX_100mm_9p5wt_5", "adjacent", 94.0),
    ];
    for (run, pattern, offset) in runs {
        let Some(all) = frames(run) else { return };
        let all = all.minus(offset);
        let (early, late) = all.values.split_at(all.frames / 2 * all.measurements);
        let part = |values: &[Complex64]| Frames {
            values: values.to_vec(),
            frames: values.len() / all.measurements,
            ..all.clone()
        };
        let (good, mut later) = (part(early), part(late));
        let model = expected(pattern);
        assert!(!faults(&check_frames(&model, &later, PLAIN).unwrap()).is_empty(), "{run}");
        let expected = model.measured(&good, PLAIN).unwrap();
        assert_eq!(faults(&check_frames(&expected, &later, PLAIN).unwrap()), [], "{run}");
        let row = later.measurements / 16;
        for frame in later.values.chunks_exact_mut(16 * row) {
            let (front, back) = frame.split_at_mut(9 * row);
            front[3 * row..4 * row].swap_with_slice(&mut back[..row]);
        }
        let found = check_frames(&expected, &later, PLAIN).unwrap();
        assert_eq!(found.misplaced, [Misplacement::Rows([3, 9])], "{run}");
    }
    // The hydrogel skin once it was damaged.
    let whole = frames("hydrogel_skin_wam.npz:v_unpressed").unwrap();
    let damaged = frames("hydrogel_skin_wam.npz:damage").unwrap();
    let expected = expected("opposite").measured(&whole, PLAIN).unwrap();
    assert_eq!(faults(&check_frames(&expected, &damaged, PLAIN).unwrap()), [About::Reversal]);
}
