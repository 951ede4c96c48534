use super::*;
use crate::chip::tests::bus::Bus;

fn dac(fields: &[(&str, u32)]) -> Bus<Dac> {
    let mut bus = Bus::new(Dac::new("DAC1"));
    bus.fields("CR", fields);
    bus
}

#[test]
fn without_a_trigger_the_output_follows_each_holding_register() {
    let mut bus = dac(&[("EN[0]", 1)]);
    for (register, value, code) in
        [("DHR12R", 0x123, 0x123), ("DHR12L", 0xABC0, 0xABC), ("DHR8R", 0x5A, 0x5A0)]
    {
        bus.write(register, value);
        assert_eq!((bus.model.output(0), bus.read("DOR")), (Some(code), code.into()), "{register}");
    }
    assert_eq!(bus.model.output(1), None, "the other channel is off");
    assert_eq!((bus.get("SR", "DACRDY[0]"), bus.get("SR", "DACRDY[1]")), (1, 0));
}

#[test]
fn a_trigger_takes_the_held_value_over_if_it_is_the_one_that_was_chosen() {
    let mut bus = dac(&[("EN[1]", 1), ("TEN[1]", 1), ("TSEL[1]", 7)]);
    bus.write_at("DHR12R", 1, 0x800).unwrap();
    assert_eq!(bus.model.output(1), Some(0));
    bus.model.trigger(Trigger::Timer(2));
    bus.write("SWTRIGR", 2);
    assert_eq!(bus.model.output(1), Some(0));
    bus.model.trigger(Trigger::Timer(6));
    assert_eq!(bus.model.output(1), Some(0x800));
}

#[test]
fn software_triggers_the_channels_that_it_names() {
    let both = [("EN[0]", 1), ("TEN[0]", 1), ("EN[1]", 1), ("TEN[1]", 1)];
    let mut bus = dac(&both);
    bus.write_at("DHR12R", 0, 11).unwrap();
    bus.write_at("DHR12R", 1, 22).unwrap();
    bus.write("SWTRIGR", 2);
    assert_eq!((bus.model.output(0), bus.model.output(1)), (Some(0), Some(22)));
}

#[test]
fn each_trigger_asks_the_dma_and_one_unserved_is_an_underrun() {
    let mut bus = dac(&[("EN[0]", 1), ("TEN[0]", 1), ("TSEL[0]", 4), ("DMAEN[0]", 1), ("DMAUDRIE[0]", 1)]);
    assert!(!bus.model.requests("CH1"));
    bus.model.trigger(Trigger::Timer(2));
    assert!(bus.model.requests("CH1") && !bus.model.requests("CH2"));
    bus.model.acknowledge("CH1");
    bus.model.trigger(Trigger::Timer(2));
    assert!(!bus.model.interrupts("GLOBAL"));
    bus.model.trigger(Trigger::Timer(2));
    assert_eq!((bus.get("SR", "DMAUDR[0]"), bus.model.requests("CH1")), (1, false));
    assert!(bus.model.interrupts("GLOBAL"));
    bus.fields("SR", &[("DMAUDR[0]", 1)]);
    bus.model.trigger(Trigger::Timer(2));
    assert!(bus.model.requests("CH1") && !bus.model.interrupts("GLOBAL"));
}

#[test]
fn what_is_not_modelled_is_refused() {
    let mut bus = dac(&[]);
    let register = bus.model.bank().map.register("CR");
    let wave = register.mask("WAVE[0]");
    let hrtim = register.with(register.mask("TEN[0]"), "TSEL[0]", 9);
    assert!(bus.refused("CR", wave).contains("WAVE"));
    assert!(bus.refused("CR", hrtim).contains("trigger 9"));
    assert!(bus.refused("MCR", 1 << 8).contains("double"));
}
