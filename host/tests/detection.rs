//! Contacts found in the voltages: what a board says of random presses, by its own code, as `experiment trust` tries it.

use dermatome::{
    patch::places::FixedPlaces,
    simulate::{Press, rig::Observer},
    skin::{FoundIn, Skin},
    trust::{Bench, Figure, Options, ROWS, Trial, place_of, run},
};
use dermatome_shared::patch::PatchView;
use nalgebra::{Point3, Vector3, distance};
use std::path::Path;

fn shipped(name: &str) -> Skin {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name).join("skin.toml");
    let skin = Skin::load(&file).unwrap().made().unwrap();
    Skin { contacts_found_in: FoundIn::Voltages, ..skin }
}

fn bench(name: &str) -> Bench {
    Bench::new(&shipped(name)).unwrap()
}

fn options(snr_db: &[f64], presses: usize) -> Options {
    Options { seed: 15, snr_db: snr_db.to_vec(), presses, frames: 500 }
}

/// Figures of one row.
fn figures(bench: &Bench, row: &str, options: &Options) -> Vec<Figure> {
    let row = ROWS.into_iter().find(|known| known.name == row).unwrap();
    let [rows] = &run(std::slice::from_ref(bench), &[row], options, || ())[..] else { panic!("one bench") };
    let figures = rows[0].figures.clone().unwrap();
    figures.iter().for_each(|figure| eprintln!("{}: {figure:?}", bench.skin().name));
    figures
}

/// The one of this name at this noise.
#[track_caller]
fn found(figures: &[Figure], what: &str, snr_db: f64) -> f64 {
    let figure = figures.iter().find(|figure| figure.what == what && figure.snr_db == snr_db);
    figure.unwrap_or_else(|| panic!("`{what}` at {snr_db} dB")).found.unwrap()
}

#[test]
fn an_untouched_skin_has_no_contact_whatever_the_noise() {
    for name in ["disc-210mm", "hemisphere-210mm"] {
        let noises = [70.0, 50.0, 40.0];
        let figures = figures(&bench(name), "untouched", &options(&noises, 1));
        for snr_db in noises {
            assert_eq!(found(&figures, "frames with a contact", snr_db), 0.0, "{name} at {snr_db} dB");
        }
    }
}

/// Places are off by twice as much with responses that are linear between places.
#[test]
fn one_finger_is_one_contact_where_it_is() {
    for (name, snr_db, least, mean, largest) in [
        ("disc-210mm", 60.0, 99.0, 0.45, 2.5),
        ("disc-210mm", 50.0, 95.0, 0.8, 5.0),
        ("square-210mm", 60.0, 98.0, 0.7, 6.0),
        ("square-50mm", 60.0, 98.0, 0.6, 6.0),
    ] {
        let figures = figures(&bench(name), "one", &options(&[snr_db], 60));
        let full = |what: &str| found(&figures, &format!("full depth: {what}"), snr_db);
        let exactly_one = full("exactly one contact");
        assert!(exactly_one >= least, "{name} at {snr_db} dB: {exactly_one} %");
        assert_eq!(full("contact left three frames after"), 0.0, "{name} at {snr_db} dB");
        for (what, most) in [("mean", mean), ("largest", largest)] {
            let off = full(&format!("position error to 90 % of the radius, {what}"));
            assert!(off <= most, "{name} at {snr_db} dB: {off} %, {what}");
        }
    }
}

#[test]
fn equal_fingers_are_as_strong_everywhere() {
    for (name, noises) in [("disc-210mm", &[60.0, 50.0][..]), ("square-210mm", &[60.0][..])] {
        let figures = figures(&bench(name), "strength", &options(noises, 60));
        for &snr_db in noises {
            let variation = found(&figures, "coefficient of variation", snr_db);
            assert!(variation <= 0.08, "{name} at {snr_db} dB: {variation}");
        }
    }
}

#[test]
fn two_and_three_fingers_are_counted() {
    let figures = figures(&bench("disc-210mm"), "several", &options(&[60.0, 50.0], 60));
    for snr_db in [60.0, 50.0] {
        for what in ["two fingers counted", "three fingers counted"] {
            assert!(found(&figures, what, snr_db) >= 95.0, "{what} at {snr_db} dB");
        }
    }
}

/// One press halfway explains two well, and what it leaves of them is like neither.
#[test]
fn two_fingers_a_fifth_of_the_size_apart_are_two_contacts() {
    for (name, seed) in [("disc-210mm", 15), ("square-210mm", 7)] {
        let options = Options { seed, ..options(&[60.0], 150) };
        let figures = figures(&bench(name), "pairs", &options);
        let share = found(&figures, "told apart at 20 % of the size", 60.0);
        assert!(share >= 90.0, "{name}: {share} %");
    }
}

/// With responses that are linear between places they are 1.50 and 2.95 % off.
#[test]
fn a_finger_at_the_rim_is_found_there() {
    for (name, most) in [("disc-210mm", 1.3), ("square-210mm", 2.0)] {
        let figures = figures(&bench(name), "rim", &options(&[60.0], 60));
        let mean = found(&figures, "position error, mean", 60.0);
        assert!(mean <= most, "{name}: {mean} %");
    }
}

/// Each of them explains little, they resemble a smooth change of the sheet, and one alone is best taken for a press in a corner.
#[test]
fn three_fingers_at_once_on_a_square_are_neither_drift_nor_one_press_in_a_corner() {
    let options = Options { seed: 61, ..options(&[60.0], 60) };
    let figures = figures(&bench("square-210mm"), "several", &options);
    assert!(found(&figures, "three fingers counted", 60.0) >= 90.0);
}

#[test]
fn an_indenter_is_one_contact_and_as_strong_as_it_is_large() {
    for name in ["disc-210mm", "square-210mm"] {
        let figures = figures(&bench(name), "indenters", &options(&[60.0], 60));
        for (radius, least) in [(3, 95.0), (6, 95.0), (9, 90.0), (12, 80.0)] {
            let share = found(&figures, &format!("radius {radius} %: one contact"), 60.0);
            assert!(share >= least, "{name}, {radius} %: {share} %");
        }
        assert!(found(&figures, "strength over area, largest over smallest", 60.0) < 1.3, "{name}");
    }
}

#[test]
fn a_finger_that_stays_and_moves_stays_one_contact_and_goes_when_it_is_lifted() {
    let bench = bench("disc-210mm");
    let mut trial = Trial::new(&bench, 60.0, 15).unwrap();
    for frame in 0..40 {
        let place = Point3::new(-0.06 + 0.003 * f64::from(frame), 0.02, 0.0);
        let contacts = trial.see(&bench.pressed(&[place], 0.04, 1.0)).contacts().clone();
        let [contact] = contacts.as_slice() else { panic!("frame {frame}: {contacts:?}") };
        assert!(distance(&place_of(contact), &place) < 0.0126, "frame {frame}: {contact:?}, at {place:?}");
        let evidence = contact.evidence.unwrap();
        assert!(evidence.significance > 5.0 && evidence.position_deviation > 0.0, "{contact:?}");
    }
    for frame in 0..20 {
        assert!(trial.see_untouched().contacts().is_empty(), "frame {frame}");
    }
}

#[test]
fn a_sheet_that_drifts_as_a_whole_has_no_contact_and_hides_none() {
    // Where electrodes lie inside a skin, what its contacts do not follow is not common to all voltages.
    for name in ["disc-210mm", "hemisphere-210mm-designed"] {
        let figures = figures(&bench(name), "uniform", &options(&[60.0], 1));
        for rate in ["+10", "-10"] {
            let of = |what: &str| found(&figures, &format!("{rate} % a minute: {what}"), 60.0);
            assert_eq!(of("untouched frames with a contact"), 0.0, "{name}, {rate}");
            assert_eq!(of("pressed frames with exactly one"), 100.0, "{name}, {rate}");
        }
    }
}

#[test]
fn a_sheet_of_which_a_part_warms_has_no_contact_and_then_hides_none() {
    for name in ["disc-210mm", "square-210mm"] {
        let bench = bench(name);
        let mesh = bench.truth().mesh();
        let untouched = bench.truth().conductivity(&[]);
        // A quarter with edges, and a slope: 12 % in a minute.
        let is_in_quarter = |x: f64, y: f64| if x > 0.0 && y > 0.0 { 1.0 } else { 0.0 };
        let parts: [&dyn Fn(f64, f64) -> f64; 2] = [&is_in_quarter, &|x, _| x / 0.105];
        for part in parts {
            let warm = |share: f64, conductivity: &[f64]| {
                let of = |element: usize| {
                    let middle =
                        mesh.corners(element).iter().fold(Vector3::zeros(), |sum, at| sum + at.coords / 3.0);
                    conductivity[element] * (1.0 + 0.12 * share * part(middle.x, middle.y))
                };
                bench.solve(&(0..conductivity.len()).map(of).collect::<Vec<_>>())
            };
            let mut trial = Trial::new(&bench, 60.0, 500).unwrap();
            for second in 0..60 {
                let voltages = warm(f64::from(second) / 60.0, &untouched);
                let next = warm(f64::from(second + 1) / 60.0, &untouched);
                for frame in 0..50 {
                    let share = f64::from(frame) / 50.0;
                    let now: Vec<_> = voltages.iter().zip(&next).map(|(a, b)| a + (b - a) * share).collect();
                    let contacts = trial.see(&now).contacts();
                    assert!(contacts.is_empty(), "{name}, second {second}: {contacts:?}");
                }
            }
            let finger = Press::finger([0.03, -0.02], 0.0084, 1.0);
            let pressed = warm(1.0, &bench.truth().conductivity(&[finger]));
            // What the sheet did may take the finger's place in the first frames.
            let is_seen = (0..10).any(|_| trial.see(&pressed).contacts().len() == 1);
            assert!(is_seen, "{name}: {:?}", trial.see(&pressed).contacts());
        }
    }
}

#[test]
fn a_press_is_found_however_slowly_it_grows() {
    for (name, slowest) in [("disc-210mm", 600), ("square-210mm", 160)] {
        let figures = figures(&bench(name), "slow", &options(&[60.0], 1));
        for seconds in [10, 60, 160, 600].into_iter().filter(|seconds| *seconds <= slowest) {
            let of = |what: &str| found(&figures, &format!("grows over {seconds} s: {what}"), 60.0);
            assert_eq!(of("detected"), 100.0, "{name}, {seconds} s");
            assert!(of("depth over that of the fast one, largest") <= 2.5, "{name}, {seconds} s");
        }
    }
}

#[test]
fn a_finger_under_the_tare_is_forgotten_in_a_second_once_it_lifts() {
    for name in ["disc-210mm", "square-210mm"] {
        let bench = bench(name);
        for place in [[0.085, 0.0], [0.03, 0.02], [0.0, 0.0]] {
            let finger = bench.solve(&bench.truth().conductivity(&[Press::finger(place, 0.0084, 1.0)]));
            let elsewhere = Press::finger([-0.05, 0.02], 0.0084, 1.0);
            let elsewhere = bench.solve(&bench.truth().conductivity(&[elsewhere]));
            let mut trial = Trial::new(&bench, 60.0, 15).unwrap();
            trial.tare(&finger);
            for frame in 0..50 {
                assert!(trial.see_untouched().contacts().is_empty(), "{name}, {place:?}, frame {frame}");
            }
            for voltages in [&finger, &elsewhere] {
                let seen = [0; 3].map(|_| trial.see(voltages).contacts().len());
                assert_eq!(seen[2], 1, "{name}, {place:?}: {seen:?}");
                for _ in 0..50 {
                    trial.see_untouched();
                }
            }
        }
    }
}

#[test]
fn a_skin_that_is_stretched_or_whose_electrodes_slip_has_no_contact_and_hides_none() {
    let stretches = ["stretched by 0.5 %", "stretched by 2 %"];
    let slips = ["electrodes slipped by 1 mm", "electrodes slipped by 0.1 mm"];
    for name in ["disc-210mm", "square-210mm"] {
        let figures = figures(&bench(name), "upset", &options(&[60.0], 100));
        for upset in stretches.iter().chain(&slips) {
            let of = |what: &str| found(&figures, &format!("{upset}: {what}"), 60.0);
            assert_eq!(of("frames with a contact"), 0.0, "{name}, {upset}");
            assert_eq!(of("press seen 30 s later"), 100.0, "{name}, {upset}");
            // Of twenty that come with a slip of 1 mm 17 are.
            let least = if *upset == slips[0] { 50.0 } else { 100.0 };
            assert!(of("press that comes with it seen") >= least, "{name}, {upset}");
            assert!(*upset != slips[0] || of("frames flagged") > 10.0, "{name}, {upset}");
        }
    }
}

/// Where what a stretch does was not known three presses explained it, in one of twenty scenes: contacts that stayed.
#[test]
fn a_skin_with_electrodes_inside_that_is_stretched_has_no_contact_and_hides_none_later() {
    let figures = figures(
        &bench("hemisphere-210mm-designed"),
        "upset",
        &Options { seed: 9301, ..options(&[60.0], 800) },
    );
    for upset in ["stretched by 0.5 %", "stretched by 2 %"] {
        let of = |what: &str| found(&figures, &format!("{upset}: {what}"), 60.0);
        assert_eq!(of("frames with a contact"), 0.0, "{upset}");
        assert_eq!(of("press seen 30 s later"), 100.0, "{upset}");
        assert!(of("press that comes with it seen") >= 50.0, "{upset}");
    }
}

#[test]
fn a_finger_that_comes_as_the_sheet_conducts_better_is_seen() {
    let figures = figures(&bench("square-210mm"), "upset", &options(&[60.0], 1));
    assert_eq!(found(&figures, "conductivity up by 5 % at once: press that comes with it seen", 60.0), 100.0);
}

#[test]
fn two_seconds_after_fingers_no_contact_is_left() {
    for name in ["disc-210mm", "hemisphere-210mm-designed"] {
        let figures = figures(&bench(name), "rest", &options(&[60.0, 50.0], 30));
        for snr_db in [60.0, 50.0] {
            assert_eq!(found(&figures, "contact left 2 s after", snr_db), 0.0, "{name} at {snr_db} dB");
            assert_eq!(found(&figures, "presses in a row that leave one, most", snr_db), 0.0, "{name}");
        }
    }
}

#[test]
fn a_sheet_that_conducts_better_at_once_has_no_contact() {
    let bench = bench("disc-210mm");
    let mut trial = Trial::new(&bench, 60.0, 15).unwrap();
    let better: Vec<f64> = bench.truth().conductivity(&[]).iter().map(|value| 1.05 * value).collect();
    let voltages = bench.solve(&better);
    for frame in 0..5 {
        assert!(trial.see(&voltages).contacts().is_empty(), "frame {frame}");
    }
}

#[test]
fn places_come_back_from_a_patch_as_they_were_and_an_image_patch_has_none() {
    let board = Observer::new(&shipped("square-50mm")).unwrap();
    let patch = board.patch();
    assert_eq!(patch.places().count(), 256);
    assert_eq!(FixedPlaces::read(&patch).tables().places.len(), 256);
    let skin = Skin { contacts_found_in: FoundIn::Image, ..shipped("square-50mm") };
    let plain = Observer::new(&skin).unwrap();
    assert_eq!(PatchView::validate(plain.patch_bytes()).unwrap().places().count(), 0);
    assert!(board.patch_bytes().len() <= plain.patch_bytes().len() + 72 * 1024);
}
