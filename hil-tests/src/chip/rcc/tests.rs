use super::*;
use crate::chip::tests::bus::Bus;

/// HSI16 / 4 * 85 / 2.
const PLL_170: [(&str, u32); 5] = [("PLLSRC", 2), ("PLLM", 3), ("PLLN", 85), ("PLLREN", 1), ("PLLR", 0)];

fn with_pll() -> Bus<Rcc> {
    let mut bus = Bus::new(Rcc::default());
    bus.fields("PLLCFGR", &PLL_170);
    bus.fields("CR", &[("HSION", 1), ("PLLON", 1)]);
    bus
}

#[test]
fn everything_runs_from_the_hsi_after_reset() {
    assert_eq!(Rcc::default().clocks(), Clocks::RESET);
}

#[test]
fn the_pll_gives_170_mhz_and_prescalers_divide_it() {
    let mut bus = with_pll();
    assert_eq!(bus.get("CR", "PLLRDY"), 1);
    bus.fields("CFGR", &[("SW", 3), ("HPRE", 8), ("PPRE1", 5)]);
    assert_eq!(bus.get("CFGR", "SWS"), 3);
    let clocks = bus.model.clocks();
    let expected = Clocks { system: 170_000_000, core: 85_000_000, apb1: 21_250_000, apb2: 85_000_000 };
    assert_eq!(clocks, expected);
    assert_eq!((clocks.timer(clocks.apb1), clocks.timer(clocks.apb2)), (42_500_000, 85_000_000));
}

#[test]
fn converters_have_the_systems_clock_or_a_divided_pll() {
    let mut bus = with_pll();
    assert_eq!(bus.model.adc_clock("ADC12SEL"), 0);
    for (fields, clock) in [([("PLLP", 6), ("PLLPBIT", 0)], 340), ([("PLLP", 0), ("PLLPBIT", 1)], 120)] {
        bus.fields("PLLCFGR", &[&PLL_170[..], &[("PLLPEN", 1)], &fields].concat());
        bus.fields("CCIPR", &[("ADC12SEL", 1)]);
        assert_eq!(bus.model.adc_clock("ADC12SEL"), clock * 1_000_000 / 6);
    }
    bus.fields("CCIPR", &[("ADC12SEL", 2)]);
    assert_eq!(bus.model.adc_clock("ADC12SEL"), HSI);
}

#[test]
fn a_clock_that_is_not_ready_is_not_switched_to() {
    let mut bus = Bus::new(Rcc::default());
    for (switch, name) in [(3, "PLL"), (2, "HSE"), (0, "none")] {
        assert!(bus.refused("CFGR", switch).contains("CFGR.SW"), "{name}");
    }
}

#[test]
fn a_running_pll_keeps_its_factors() {
    let mut bus = with_pll();
    assert!(bus.refused("PLLCFGR", 0).contains("PLL runs"));
}

#[test]
fn reset_flags_add_up_until_they_are_removed() {
    let mut bus = Bus::new(Rcc::default());
    let flags = ["BORRSTF", "SFTRSTF", "IWDGRSTF", "PINRSTF"];
    let mut after = |cause: ResetCause| {
        bus.model.restart(cause);
        flags.map(|flag| bus.get("CSR", flag))
    };
    assert_eq!(after(ResetCause::Power), [1, 0, 0, 1]);
    assert_eq!(after(ResetCause::Software), [1, 1, 0, 1]);
    assert_eq!(after(ResetCause::Watchdog), [1, 1, 1, 1]);
    assert_eq!(after(ResetCause::Power), [1, 0, 0, 1]);
    bus.fields("CSR", &[("RMVF", 1)]);
    assert_eq!(flags.map(|flag| bus.get("CSR", flag)), [0; 4]);
    bus.model.restart(ResetCause::Pin);
    assert_eq!(flags.map(|flag| bus.get("CSR", flag)), [0, 0, 0, 1]);
}

#[test]
fn the_usb_runs_from_the_hsi48_or_from_the_pll() {
    let mut bus = with_pll();
    assert_eq!(bus.model.usb_clock().0, 0, "the HSI48 is off");
    bus.fields("CRRCR", &[("HSI48ON", 1)]);
    assert_eq!(bus.model.usb_clock(), (48_000_000, true));
    bus.fields("CCIPR", &[("CLK48SEL", 2)]);
    assert_eq!(bus.model.usb_clock().0, 0, "the PLL has no such output");
    let mut bus = Bus::new(Rcc::default());
    bus.fields("PLLCFGR", &[("PLLSRC", 2), ("PLLM", 3), ("PLLN", 72), ("PLLQEN", 1), ("PLLQ", 2)]);
    bus.fields("CR", &[("HSION", 1), ("PLLON", 1)]);
    bus.fields("CCIPR", &[("CLK48SEL", 2)]);
    assert_eq!(bus.model.usb_clock(), (48_000_000, false));
    assert!(!bus.model.pll_is_exact());
}
