//! Measured frames of real instruments, which are no part of the project: not run where absent.
//!
//! The model is a homogeneous disc with point electrodes, in closed form.

use dermatome::measured::{
    diagnose::{Diagnosis, diagnose},
    order::{Arrangement, SenseOrder},
    read::{Frames, Source, read},
};
use dermatome_shared::stimulation::{Step, pattern};
use num_complex::Complex64;
use std::{ffi::OsString, path::Path};

const PLAIN: Arrangement = Arrangement { sense: SenseOrder::Absolute, rotation: 0, mirrored: false };
const RELATIVE: Arrangement = Arrangement { sense: SenseOrder::Relative, rotation: 0, mirrored: false };

/// Frames of a file with its key; `None`, and says so, where the file is absent.
fn frames(name_and_key: &str) -> Option<Frames> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/real");
    let (name, _) = name_and_key.split_once(':').unwrap();
    if !Path::new(folder).join(name).exists() {
        println!("not run: {name} is absent");
        return None;
    }
    Some(read(&Source::new(&OsString::from(format!("{folder}/{name_and_key}")))).unwrap())
}

/// Point electrodes on a homogeneous unit disc: potential -ln(r) / pi round each, with its current.
fn disc_voltage(step: &Step) -> f64 {
    let distance = |a: u8, b: u8| (std::f64::consts::PI * f64::from(a.abs_diff(b)) / 16.0).sin();
    let [p, q, a, b] = step.to_bytes();
    (distance(a, q) * distance(b, p) / (distance(a, p) * distance(b, q))).ln() / std::f64::consts::PI
}

fn check(reference: &[Complex64], drive_distance: u8, used: Arrangement) -> Diagnosis {
    let steps: Vec<_> = pattern(16, drive_distance, 1).collect();
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
        println!("{name}: {diagnosis:?}");
        assert!(diagnosis.correlation > 0.97, "{name}: {}", diagnosis.correlation);
        assert!(diagnosis.warnings().is_empty(), "{name}: {:?}", diagnosis.warnings());
        let wrong = check(&frames.mean(), 1, RELATIVE);
        assert_eq!(wrong.best, PLAIN, "{name}");
        assert!(wrong.warnings()[0].contains("leave out --order relative"), "{name}");
    }
}

#[test]
fn the_hydrogel_skin_lists_its_sense_pairs_from_the_driven_one_onwards() {
    let Some(frames) = frames("hydrogel_skin_wam.npz:v_unpressed") else { return };
    assert_eq!((frames.frames, frames.measurements), (400, 192));
    let diagnosis = check(&frames.mean(), 8, PLAIN);
    println!("{diagnosis:?}\n{:?}", diagnosis.warnings());
    assert_eq!(diagnosis.best.sense, SenseOrder::Relative);
    assert!(diagnosis.magnitudes_only);
}

#[test]
fn the_carbon_black_skin_is_read_as_full_squares() {
    let Some(frames) = frames("black_sensor_ert_skin.npz:expX_150mm_8p5wt_7") else { return };
    assert_eq!((frames.frames, frames.measurements), (69, 256));
    let diagnosis = check(&frames.mean(), 1, PLAIN);
    println!("{diagnosis:?}\n{:?}", diagnosis.warnings());
    // Raw converter counts with an offset: the U-shape is there, squeezed.
    assert_eq!(diagnosis.best.sense, SenseOrder::Absolute);
}
