use super::*;
use crate::chip::tests::bus::Bus;

fn lines(rising: u32, falling: u32) -> Bus<Exti> {
    let mut bus = Bus::new(Exti::default());
    bus.write("IMR", 0x1F84_00FF);
    bus.write("RTSR", rising);
    bus.write("FTSR", falling);
    bus
}

#[test]
fn only_the_chosen_edges_pend() {
    let mut bus = lines(0b011, 0b101);
    bus.model.see(0b111);
    assert_eq!(bus.read("PR"), 0b011);
    bus.write("PR", 0b001);
    assert_eq!(bus.read("PR"), 0b010);
    bus.model.see(0b111);
    assert_eq!(bus.read("PR"), 0b010, "a level is no edge");
    bus.write("PR", 0b010);
    bus.model.see(0);
    assert_eq!(bus.read("PR"), 0b101);
}

#[test]
fn a_masked_line_pends_without_an_interrupt() {
    let mut bus = lines(0x8001, 0);
    bus.model.see(0x8001);
    assert!(bus.model.interrupts("EXTI0") && !bus.model.interrupts("EXTI15"));
    assert_eq!(bus.read("PR"), 0x8001);
    bus.write("IMR", 0x1F84_FFFF);
    assert!(bus.model.interrupts("EXTI15") && !bus.model.interrupts("EXTI1"));
}

#[test]
fn software_pends_a_line_once_until_it_is_cleared() {
    let mut bus = lines(0, 0);
    bus.write("SWIER", 0x20);
    assert!(bus.model.interrupts("EXTI5"));
    bus.write("PR", 0x20);
    assert_eq!((bus.read("PR"), bus.read("SWIER")), (0, 0));
    bus.write("SWIER", 0x20);
    assert_eq!(bus.read("PR"), 0x20);
}

#[test]
fn events_and_lines_of_peripherals_are_refused() {
    let mut bus = lines(0, 0);
    assert!(bus.refused("EMR", 1).contains("EMR"));
    assert!(bus.refused("RTSR", 1 << 17).contains("above 15"));
}
