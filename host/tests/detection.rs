//! Contacts found in the voltages: what a board says of random presses, by its own code.

use dermatome::{
    patch::places::FixedPlaces,
    simulate::{Noise, Press, Rig, rig::Observer},
    skin::{FoundIn, Skin},
};
use dermatome_shared::{contact::Contact, patch::PatchView};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::path::Path;

/// A shipped skin, its contacts found in the voltages, on a rig with this noise and this seed.
struct Trial {
    board: Observer,
    rig: Rig,
    random: Pcg64Mcg,
    /// Larger side of the skin, m.
    size: f64,
    is_square: bool,
}

/// In so many frames all fingers are found.
const FRAMES: usize = 6;

/// A number that the environment gives, to try others by hand.
fn given<T: std::str::FromStr>(name: &str, otherwise: T) -> T {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

fn shipped(name: &str) -> Skin {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name).join("skin.toml");
    let skin = Skin::load(&file).unwrap().made().unwrap();
    Skin { contacts_found_in: FoundIn::Voltages, ..skin }
}

impl Trial {
    fn new(name: &str, snr_db: f64) -> Self {
        let skin = shipped(name);
        let board = Observer::new(&skin).unwrap();
        let mut random = Pcg64Mcg::seed_from_u64(given("DERMATOME_SEED", 15) + snr_db as u64);
        let rig = Rig::new(&skin, &board.patch(), Noise { snr_db, seed: random.random() }).unwrap();
        let size = board.model().pixels.larger_side();
        Self { board, rig, random, size, is_square: name.contains("square") }
    }

    /// Places within this share of the radius, at least this share of the size from each other.
    fn places(&mut self, count: usize, within: f64, apart: f64) -> Vec<[f64; 2]> {
        let mut places: Vec<[f64; 2]> = Vec::new();
        while places.len() < count {
            let place = [0, 1].map(|_| self.random.random_range(-0.5..0.5) * self.size);
            let [x, y] = place;
            let far = if self.is_square { x.abs().max(y.abs()) } else { x.hypot(y) };
            let is_apart = places.iter().all(|[u, v]| (u - x).hypot(v - y) > apart * self.size);
            if far < within * self.size / 2.0 && is_apart {
                places.push(place);
            }
        }
        places
    }

    fn tare(&mut self) {
        let untouched = self.rig.truth().conductivity(&[]);
        let frames = self.rig.tare(&untouched);
        self.board.tare(&frames);
    }

    /// Contacts in each of some frames with fingers of this radius, a share of the size, which are lifted then.
    fn press(&mut self, places: &[[f64; 2]], radius: f64) -> Vec<Vec<Contact>> {
        let presses: Vec<_> =
            places.iter().map(|&place| Press::finger(place, radius * self.size, 1.0)).collect();
        let phasors = self.rig.solve(&self.rig.truth().conductivity(&presses));
        let frames = self.rig.scans(&phasors, FRAMES as u16);
        let contacts = frames.iter().map(|frame| self.board.observe(frame).contacts().to_vec()).collect();
        assert_eq!(self.false_frames(3), 0, "a contact is left of fingers at {places:?}");
        contacts
    }

    /// Frames of the untouched skin with a contact.
    fn false_frames(&mut self, frames: usize) -> usize {
        let untouched = self.rig.solve(&self.rig.truth().conductivity(&[]));
        let frames = (0..frames).map(|_| self.rig.scan(&untouched));
        frames.filter(|frame| !self.board.observe(frame).contacts().is_empty()).count()
    }
}

#[test]
fn an_untouched_skin_has_no_contact_whatever_the_noise() {
    for name in ["disc-210mm", "hemisphere-210mm"] {
        for snr_db in [70.0, 50.0, 40.0] {
            let mut trial = Trial::new(name, snr_db);
            trial.tare();
            let frames = given("DERMATOME_FRAMES", 500);
            let found = trial.false_frames(frames);
            eprintln!("{name}, {snr_db} dB: {found} of {frames} frames with a contact");
            assert_eq!(found, 0, "{name} at {snr_db} dB");
        }
    }
}

#[test]
fn one_finger_is_one_contact_where_it_is_and_as_strong_everywhere() {
    for (name, snr_db, least) in
        [("disc-210mm", 60.0, 0.98), ("disc-210mm", 50.0, 0.95), ("square-210mm", 60.0, 0.95)]
    {
        let mut trial = Trial::new(name, snr_db);
        trial.tare();
        let scenes = given("DERMATOME_SCENES", 60);
        let (mut right, mut errors, mut strengths) = (0, Vec::new(), Vec::new());
        for _ in 0..scenes {
            let places = trial.places(1, 0.9, 0.0);
            let frames = trial.press(&places, 0.04);
            right += usize::from(frames.iter().all(|contacts| contacts.len() == 1));
            if let Some(contact) = frames[FRAMES - 1].first() {
                let [x, y] = contact.from_above();
                errors.push((x - places[0][0]).hypot(y - places[0][1]) / trial.size);
                strengths.push(f64::from(contact.strength));
                let evidence = contact.evidence.unwrap();
                assert!(evidence.significance > 5.0 && evidence.position_deviation > 0.0, "{contact:?}");
            }
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let strength = mean(&strengths);
        let spread =
            mean(&strengths.iter().map(|s| (s - strength).powi(2)).collect::<Vec<_>>()).sqrt() / strength;
        let worst = errors.iter().copied().fold(0.0, f64::max);
        eprintln!(
            "{name}, {snr_db} dB: {right} of {scenes} right, errors mean {:.2} % of the size, worst {:.2} %, strength \
             {strength:.3} with a variation of {spread:.3}",
            100.0 * mean(&errors),
            100.0 * worst
        );
        assert!(right as f64 >= least * scenes as f64, "{name} at {snr_db} dB: {right} of {scenes}");
        assert!(mean(&errors) <= 0.02 && worst <= 0.06 && spread <= 0.14, "{name} at {snr_db} dB");
    }
}

#[test]
fn two_and_three_fingers_are_counted() {
    for snr_db in [60.0, 50.0] {
        let mut trial = Trial::new("disc-210mm", snr_db);
        trial.tare();
        let scenes = given("DERMATOME_SCENES", 60);
        for count in [2, 3] {
            let right = (0..scenes)
                .filter(|_| {
                    let places = trial.places(count, 0.88, 0.25);
                    trial.press(&places, 0.06)[FRAMES - 1].len() == count
                })
                .count();
            eprintln!("{count} fingers on the disc, {snr_db} dB: {right} of {scenes} counted");
            assert!(
                right as f64 >= 0.95 * scenes as f64,
                "{count} fingers at {snr_db} dB: {right} of {scenes}"
            );
        }
    }
}

#[test]
fn an_indenter_is_one_contact_and_as_strong_as_it_is_large() {
    for name in ["disc-210mm", "square-210mm"] {
        let mut trial = Trial::new(name, 60.0);
        trial.tare();
        let scenes = given("DERMATOME_SCENES", 30);
        let mut by_area = Vec::new();
        for (radius, least) in [(0.03, 0.95), (0.06, 0.95), (0.1, 0.9), (0.12, 0.8)] {
            let (mut right, mut strength) = (0, 0.0);
            for _ in 0..scenes {
                let places = trial.places(1, 0.88, 0.0);
                let frames = trial.press(&places, radius);
                let contacts = &frames[FRAMES - 1];
                right += usize::from(contacts.len() == 1);
                strength += contacts.iter().map(|contact| f64::from(contact.strength)).sum::<f64>();
            }
            by_area.push(strength / scenes as f64 / (radius / 0.045_f64).powi(2));
            eprintln!(
                "{name}, 60 dB, radius {:.0} % of the size: {right} of {scenes} are one contact, strength over area {:.3}",
                100.0 * radius,
                by_area[by_area.len() - 1]
            );
            assert!(right as f64 >= least * scenes as f64, "{name}, {radius}: {right} of {scenes}");
        }
        let (least, most) = by_area.iter().fold((f64::MAX, 0.0_f64), |(a, b), &s| (a.min(s), b.max(s)));
        assert!(most / least < 1.3, "{name}: {by_area:?}");
    }
}

#[test]
fn a_finger_that_stays_and_moves_stays_one_contact_and_goes_when_it_is_lifted() {
    let mut trial = Trial::new("disc-210mm", 60.0);
    trial.tare();
    for frame in 0..40 {
        let place = [-0.06 + 0.003 * f64::from(frame), 0.02];
        let scan = trial.rig.press(&[Press::finger(place, 0.0084, 1.0)]);
        let contacts = trial.board.observe(&scan).contacts().clone();
        let [contact] = contacts.as_slice() else { panic!("frame {frame}: {contacts:?}") };
        let [x, y] = contact.from_above();
        assert!((x - place[0]).hypot(y - place[1]) < 0.0126, "frame {frame}: {contact:?}, at {place:?}");
    }
    assert_eq!(trial.false_frames(20), 0);
}

#[test]
fn a_sheet_that_drifts_as_a_whole_has_no_contact_and_hides_none() {
    for rate in [0.1, -0.1] {
        let mut trial = Trial::new("disc-210mm", 60.0);
        trial.tare();
        let finger = Press::finger([0.03, -0.02], 0.0084, 1.0);
        // A minute and a half, of which the second third is pressed.
        for second in 0..90 {
            let presses = if (30..60).contains(&second) { std::slice::from_ref(&finger) } else { &[] };
            let drift = 1.0 + rate * f64::from(second) / 60.0;
            let conductivity = trial.rig.truth().conductivity(presses);
            let phasors =
                trial.rig.solve(&conductivity.iter().map(|value| drift * value).collect::<Vec<_>>());
            for frame in trial.rig.scans(&phasors, 50) {
                let contacts = trial.board.observe(&frame).contacts();
                assert_eq!(contacts.len(), presses.len(), "{rate}, second {second}: {contacts:?}");
            }
        }
    }
}

#[test]
fn a_sheet_that_conducts_better_at_once_has_no_contact() {
    let mut trial = Trial::new("disc-210mm", 60.0);
    trial.tare();
    let better: Vec<f64> = trial.rig.truth().conductivity(&[]).iter().map(|value| 1.05 * value).collect();
    let phasors = trial.rig.solve(&better);
    for frame in 0..5 {
        let scan = trial.rig.scan(&phasors);
        assert!(trial.board.observe(&scan).contacts().is_empty(), "frame {frame}");
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
    assert!(board.patch_bytes().len() <= plain.patch_bytes().len() + 64 * 1024);
}
