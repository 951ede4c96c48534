use super::*;
use crate::chip::tests::bus::{Bus, nanos};

/// RLR = 0xFFF and PR = 0 after reset: 4 * 4096 periods of 32 kHz are 512 ms.
fn running() -> Bus<Iwdg> {
    let mut bus = Bus::new(Iwdg::default());
    bus.write("KR", 0xCCCC);
    bus
}

#[test]
fn it_bites_when_its_time_is_out_and_not_a_nanosecond_before() {
    let mut bus = running();
    bus.pass(Time::from_millis(512) - nanos(1));
    assert!(!bus.model.take_bite());
    bus.pass(nanos(1));
    assert!(bus.model.take_bite());
    assert!(!bus.model.take_bite(), "once");
}

#[test]
fn a_reload_starts_the_time_again() {
    let mut bus = running();
    bus.pass(Time::from_millis(400));
    bus.write("KR", 0xAAAA);
    assert_eq!(bus.model.next_event(), Time::from_millis(912));
}

#[test]
fn prescaler_and_reload_value_need_the_key() {
    let mut bus = Bus::new(Iwdg::default());
    assert!(bus.refused("PR", 3).contains("locked"));
    bus.write("KR", 0x5555);
    bus.write("PR", 3);
    bus.write("RLR", 999);
    bus.write("KR", 0xAAAA);
    assert_eq!(bus.model.next_event(), Time::NEVER, "it does not run yet");
    bus.write("KR", 0xCCCC);
    assert_eq!(bus.model.next_event(), Time::from_millis(1000));
    assert!(bus.refused("RLR", 1).contains("locked"));
}
