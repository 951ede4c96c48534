use super::{super::multiplexers::word, Chip, ENABLED, LARGE, analogue, handle};
use crate::chip::{time::Time, world::World};

/// Of a chip's pins; the multiplexers' enable alone.
const ENABLE: u16 = ENABLED & !LARGE;

#[test]
fn a_low_pin_takes_the_source_to_its_small_range_after_the_switchs_time() {
    let handle = handle(analogue());
    handle.press(&[]);
    let mut chip = Chip::new(&handle, 80, 1500.0);
    let word = word([0, 1, 3, 4]);
    chip.run(1_000_000);
    chip.select(word);
    chip.run(400 - 2);
    let large = chip.demodulate(4);
    chip.world.pins('C', 0, chip.now());
    chip.run(990);
    assert!(!handle.conditions().in_small_range, "after 495 us");
    chip.run(20);
    assert!(handle.conditions().in_small_range, "after 505 us");
    chip.world.pins('C', ENABLE, chip.now());
    chip.run(1600 - 1010);
    let (found, expected) = (chip.demodulate(4), handle.expected(word, 1.0, &chip.carrier));
    assert!((found - expected).norm() < 1e-5 * large.norm(), "{found} for {expected}");
    let ratio = (found / large).norm() / (20.52e-6 / 714.3e-6);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    assert!(!handle.take_drive_record().ranged_while_enabled);
}

#[test]
fn a_range_that_changes_while_the_multiplexers_are_on_is_recorded() {
    for (before, after) in [(ENABLED, ENABLE), (ENABLED, 0), (LARGE, ENABLE)] {
        let handle = handle(analogue());
        let mut chip = Chip::new(&handle, 20, 1500.0);
        chip.world.pins('C', before, chip.now());
        chip.run(10);
        chip.world.pins('C', after, chip.now());
        chip.run(2000);
        // Both pins at once, as a reset moves them: the multiplexers are off before the range begins to change.
        let is_reset = after == 0;
        assert_eq!(handle.take_drive_record().ranged_while_enabled, !is_reset, "{before:x} {after:x}");
    }
}

#[test]
fn what_the_source_still_has_of_the_dacs_start_when_the_multiplexers_come_on_is_recorded() {
    for (millis, most) in [(0, 2.0), (20, 0.7), (100, 0.05), (300, 1e-3)] {
        let handle = handle(analogue());
        let mut world = super::AnalogueWorld::new(handle.clone());
        world.pins('C', LARGE, Time::ZERO);
        world.dac(1, 0, Some(2048), Time::from_millis(1));
        world.pins('C', ENABLED, Time::from_millis(6 + millis));
        let first = handle.take_drive_record().first_current;
        assert!(first < most && first > most / 50.0, "{first} after {millis} ms");
    }
}
