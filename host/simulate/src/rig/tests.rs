use super::*;
use crate::instrument::Instrument;
use dermatome_shared::{frame::Frame, units::AdcCode};
use std::path::Path;

fn square() -> Skin {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/square-50mm/skin.toml");
    let mut skin = Skin::load(Path::new(path)).unwrap().made().unwrap();
    skin.edges = skin.edges.scaled(2.0);
    skin
}

#[test]
fn a_press_is_one_contact_to_an_observer_that_was_tared() {
    let skin = square();
    let mut observer = Observer::new(&skin).unwrap();
    let mut rig = Rig::new(&skin, &observer.patch(), Noise { snr_db: 60.0, seed: 1 }).unwrap();
    let untouched = rig.truth().conductivity(&[]);
    observer.tare(&rig.tare(&untouched));
    let frame = rig.press(&[Press::finger([0.006, -0.004], 0.006, 1.0)]);
    assert_eq!(frame.sequence, u32::from(DEFAULT_TARE_FRAMES));
    let glance = observer.glance(std::slice::from_ref(&frame)).contacts().to_vec();
    let [contact] = &glance[..] else { panic!("{glance:?}") };
    let [x, y] = contact.from_above();
    assert!((x - 0.006).hypot(y + 0.004) < 0.003, "{x} {y}");
    assert_eq!(observer.observe(&frame).contacts().to_vec(), glance);
}

#[test]
fn numbered_scans_come_next_and_depend_on_their_number_only() {
    let skin = square();
    let observer = Observer::new(&skin).unwrap();
    let noise = Noise { snr_db: 60.0, seed: 1 };
    let mut rig = Rig::new(&skin, &observer.patch(), noise).unwrap();
    let pressed = rig.solve(&rig.truth().conductivity(&[Press::finger([0.006, -0.004], 0.006, 1.0)]));
    rig.scan(&pressed);
    let [first, second] = [1, 2].map(|number| rig.numbered_scans(&pressed, 3, number));
    assert_eq!(rig.numbered_scans(&pressed, 3, 1), first);
    assert_ne!(first[0].codes, second[0].codes);
    assert_ne!(first[0].codes, first[1].codes);
    // Noise of its own apart, they are the rig's next frames.
    let itself = rig.numbered_scans(&pressed, 3, 0);
    rig.change_noise(noise);
    assert_eq!(rig.scans(&pressed, 3), itself);
}

/// Counts its scans.
struct Counter(i32);

impl Instrument for Counter {
    fn scan(&mut self, _: &ScanTable, _: Option<f64>) -> Frame {
        self.0 += 1;
        Frame { codes: [AdcCode(self.0)].into_iter().collect(), ..Frame::default() }
    }
}

#[test]
fn frames_are_numbered_from_zero_and_end_a_period_after_each_other() {
    let skin = square();
    let observer = Observer::new(&skin).unwrap();
    let table = ScanTable::of_patch(&observer.patch());
    let mut scanner = Scanner::new(Counter(0));
    let frames: Vec<_> = (0..3).map(|_| scanner.scan(&table, None)).collect();
    let period_us = (1e6 / table.frame_rate()).round() as u64;
    for (number, frame) in (0..).zip(&frames) {
        assert_eq!(frame.sequence, number);
        assert_eq!(frame.timestamp_us, period_us * u64::from(number + 1));
        assert_eq!(frame.codes[0].0, number as i32 + 1);
    }
}
