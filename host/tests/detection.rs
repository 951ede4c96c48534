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

    /// Places within this share of the radius, a quarter of the size from each other.
    fn places(&mut self, count: usize, within: f64) -> Vec<[f64; 2]> {
        let mut places: Vec<[f64; 2]> = Vec::new();
        while places.len() < count {
            let place = [0, 1].map(|_| self.random.random_range(-0.5..0.5) * self.size);
            let [x, y] = place;
            let far = if self.is_square { x.abs().max(y.abs()) } else { x.hypot(y) };
            let is_apart = places.iter().all(|[u, v]| (u - x).hypot(v - y) > 0.25 * self.size);
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

    /// Contacts of one frame with fingers of this radius, a share of the size, and depth.
    fn press(&mut self, places: &[[f64; 2]], radius: f64, depth: f64) -> Vec<Contact> {
        let presses: Vec<_> =
            places.iter().map(|&place| Press::finger(place, radius * self.size, depth)).collect();
        let frame = self.rig.press(&presses);
        self.board.glance(&frame).contacts().to_vec()
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
            let places = trial.places(1, 0.9);
            let contacts = trial.press(&places, 0.04, 1.0);
            right += usize::from(contacts.len() == 1);
            if let Some(contact) = contacts.first() {
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
                    let places = trial.places(count, 0.88);
                    trial.press(&places, 0.06, 1.0).len() == count
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
    assert_eq!(FixedPlaces::read(&patch.places()).tables().places.len(), 256);
    let skin = Skin { contacts_found_in: FoundIn::Image, ..shipped("square-50mm") };
    let plain = Observer::new(&skin).unwrap();
    assert_eq!(PatchView::validate(plain.patch_bytes()).unwrap().places().count(), 0);
    assert!(board.patch_bytes().len() <= plain.patch_bytes().len() + 64 * 1024);
}
