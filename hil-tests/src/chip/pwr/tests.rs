use super::*;
use crate::chip::tests::bus::Bus;

#[test]
fn range_and_boost_set_the_fastest_core_clock() {
    let mut bus = Bus::new(Pwr::default());
    assert_eq!(bus.model.fastest_core(), 150_000_000);
    bus.fields("CR5", &[("R1MODE", 0)]);
    assert_eq!(bus.model.fastest_core(), 170_000_000);
    bus.fields("CR1", &[("VOS", 2)]);
    assert_eq!(bus.model.fastest_core(), 26_000_000);
    assert!(bus.refused("CR1", 0).contains("VOS"));
}
