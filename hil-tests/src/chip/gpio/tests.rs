use super::*;
use crate::chip::tests::bus::Bus;

fn port_with(mode: u32, pull: u32) -> Bus<Gpio> {
    let mut bus = Bus::new(Gpio::new('C'));
    bus.write("MODER", mode);
    bus.write("PUPDR", pull);
    bus
}

#[test]
fn setting_wins_over_resetting() {
    let mut bus = port_with(0x5555_5555, 0);
    bus.write("ODR", 0x00F0);
    bus.write("BSRR", 0x0030_0011);
    assert_eq!(bus.read("ODR"), 0x00D1);
    bus.write("BSRR", 0x00C0_0000);
    assert_eq!(bus.model.outputs(), 0x0011);
    assert_eq!(bus.read("IDR"), 0x0011);
}

#[test]
fn inputs_read_their_pulls_or_what_the_world_drives() {
    let mut bus = port_with(0, 0b10_01);
    assert_eq!(bus.read("IDR"), 1);
    bus.model.driven[0] = Some(false);
    bus.model.driven[1] = Some(true);
    bus.model.driven[7] = Some(true);
    assert_eq!(bus.read("IDR"), 0x82);
}

#[test]
fn analogue_pins_read_zero() {
    let mut bus = port_with(u32::MAX, 0x5555_5555);
    bus.model.driven = [Some(true); 16];
    assert_eq!(bus.read("IDR"), 0);
}

#[test]
fn each_pin_has_its_mode_and_its_alternate_function() {
    let mut bus = port_with(0b11_10_01_00, 0);
    bus.write_at("AFR", 0, 0x0C00).unwrap();
    let modes: Vec<PinMode> = (0..4).map(|pin| bus.model.mode(pin)).collect();
    assert_eq!(modes, [PinMode::Input, PinMode::Output, PinMode::Alternate(12), PinMode::Analogue]);
    bus.write("MODER", 2 << 18);
    bus.write_at("AFR", 1, 0x70).unwrap();
    assert_eq!(bus.model.mode(9), PinMode::Alternate(7));
}

#[test]
fn the_debug_pins_are_alternate_after_reset() {
    let port = Gpio::new('A');
    assert_eq!((port.mode(13), port.mode(14)), (PinMode::Alternate(0), PinMode::Alternate(0)));
    assert_eq!(port.mode(5), PinMode::Analogue);
}

#[test]
fn an_open_drain_pin_is_high_only_where_something_pulls_it_up() {
    for (pull, driven, level) in [(0, None, 0), (0, Some(true), 1), (1, None, 1), (1, Some(false), 0)] {
        let mut bus = port_with(1, pull);
        bus.write("OTYPER", 1);
        bus.model.driven[0] = driven;
        bus.write("ODR", 1);
        assert_eq!((bus.read("IDR"), bus.model.driven_levels()), (level, pull as u16), "{pull} {driven:?}");
        bus.write("ODR", 0);
        assert_eq!((bus.read("IDR"), bus.model.driven_levels()), (0, 0));
    }
}
