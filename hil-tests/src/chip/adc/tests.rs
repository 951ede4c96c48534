use super::*;
use crate::chip::{
    tests::bus::{Bus, nanos},
    world::OpampSetting,
};

/// Volts that grow with the channel; notes when it was asked.
#[derive(Debug, Default)]
struct Ladder(Vec<(usize, usize, Time)>);

impl World for Ladder {
    fn dac(&mut self, _: usize, _: usize, _: Option<u16>, _: Time) {}
    fn pins(&mut self, _: char, _: u16, _: Time) {}
    fn opamp(&mut self, _: usize, _: OpampSetting, _: Time) {}
    fn voltage(&mut self, adc: usize, channel: usize, at: Time) -> f64 {
        self.0.push((adc, channel, at));
        VREF_VOLTS * (channel as f64 / 16.0 + 1e-6)
    }
}

/// A converter at 50 MHz, on and calibrated: 20 ns a clock.
fn ready() -> Bus<Adc> {
    let mut bus = Bus::new(Adc::new(2));
    bus.model.run_at(50_000_000);
    bus.fields("CR", &[("ADVREGEN", 1)]);
    bus.pass(Time::from_micros(20));
    bus.fields("CR", &[("ADVREGEN", 1), ("ADEN", 1)]);
    bus
}

fn start(bus: &mut Bus<Adc>) {
    bus.fields("CR", &[("ADVREGEN", 1), ("ADEN", 1), ("ADSTART", 1)]);
}

fn pass(bus: &mut Bus<Adc>, span: Time, world: &mut Ladder) {
    let end = bus.now + span;
    while bus.model.next_event() <= end {
        bus.now = bus.model.next_event();
        bus.model.sample(bus.now, world);
        let at = bus.moment();
        bus.model.advance(at).unwrap();
    }
    bus.now = end;
}

#[test]
fn it_needs_its_regulator_and_a_clock_that_it_can_follow() {
    let mut bus = Bus::new(Adc::new(1));
    bus.model.run_at(50_000_000);
    let register = bus.model.bank().map.register("CR");
    let on = register.mask("ADVREGEN");
    assert!(bus.refused("CR", on | register.mask("DEEPPWD")).contains("DEEPPWD"));
    bus.write("CR", on);
    bus.pass(nanos(19_999));
    assert!(bus.refused("CR", on | register.mask("ADEN")).contains("20 us"));
    bus.pass(nanos(1));
    bus.model.run_at(85_000_000);
    assert!(bus.refused("CR", on | register.mask("ADEN")).contains("85000000 Hz"));
    bus.model.run_at(50_000_000);
    assert!(bus.refused("CR", on | register.mask("ADSTART")).contains("ADEN is 0"));
    bus.write("CR", on | register.mask("ADEN"));
    assert_eq!(bus.get("ISR", "ADRDY"), 1);
}

#[test]
fn a_calibration_takes_112_clocks() {
    let mut bus = Bus::new(Adc::new(1));
    bus.model.run_at(50_000_000);
    bus.fields("CR", &[("ADVREGEN", 1)]);
    bus.pass(Time::from_micros(20));
    bus.fields("CR", &[("ADVREGEN", 1), ("ADCAL", 1)]);
    bus.pass(nanos(2_239));
    assert_eq!(bus.get("CR", "ADCAL"), 1);
    bus.pass(nanos(1));
    assert_eq!(bus.get("CR", "ADCAL"), 0);
}

#[test]
fn a_conversion_samples_at_the_end_of_its_sampling_time_and_ends_12_and_a_half_clocks_later() {
    let (mut bus, mut world) = (ready(), Ladder::default());
    let begun = bus.now;
    bus.fields("SQR1", &[("SQ[0]", 3)]);
    bus.fields("SMPR", &[("SMP[3]", 2)]);
    start(&mut bus);
    pass(&mut bus, nanos(499), &mut world);
    assert_eq!(bus.get("ISR", "EOC"), 0);
    pass(&mut bus, nanos(1), &mut world);
    assert_eq!((bus.get("ISR", "EOC"), bus.get("ISR", "EOS"), bus.get("CR", "ADSTART")), (1, 1, 0));
    assert_eq!(world.0, [(2, 3, begun + nanos(250))]);
    assert_eq!((bus.read("DR"), bus.get("ISR", "EOC")), (3 * 256, 0));
}

#[test]
fn a_conversion_more_than_a_millisecond_after_the_last_one_is_wrong_and_the_next_one_right() {
    let (mut bus, mut world) = (ready(), Ladder::default());
    bus.fields("SQR1", &[("SQ[0]", 3)]);
    for (pause, code) in [(0, 3 * 256), (990, 3 * 256), (1010, 0), (0, 3 * 256)] {
        pass(&mut bus, Time::from_micros(pause), &mut world);
        start(&mut bus);
        pass(&mut bus, nanos(500), &mut world);
        assert_eq!(bus.read("DR"), code, "after {pause} us");
    }
}

#[test]
fn a_lost_sample_is_an_overrun() {
    let (mut bus, mut world) = (ready(), Ladder::default());
    bus.model.lose_sample();
    start(&mut bus);
    pass(&mut bus, nanos(500), &mut world);
    assert_eq!((bus.get("ISR", "OVR"), bus.get("ISR", "EOC")), (1, 0));
}

#[test]
fn a_sequence_converts_its_ranks_and_one_unread_result_is_an_overrun() {
    for (mode, kept) in [(0, 5), (1, 7)] {
        let (mut bus, mut world) = (ready(), Ladder::default());
        bus.fields("CFGR", &[("JQDIS", 1), ("OVRMOD", mode)]);
        bus.fields("SQR1", &[("L", 4), ("SQ[0]", 5), ("SQ[1]", 6), ("SQ[2]", 12), ("SQ[3]", 1)]);
        bus.fields("SQR2", &[("SQ[0]", 7)]);
        bus.fields("IER", &[("EOSIE", 1)]);
        start(&mut bus);
        pass(&mut bus, nanos(4 * 300), &mut world);
        assert!(!bus.model.interrupts("GLOBAL"));
        pass(&mut bus, nanos(300), &mut world);
        assert!(bus.model.interrupts("GLOBAL"));
        let channels: Vec<usize> = world.0.iter().map(|&(_, channel, _)| channel).collect();
        assert_eq!(channels, [5, 6, 12, 1, 7]);
        assert_eq!((bus.get("ISR", "OVR"), bus.read("DR")), (1, kept * 256));
    }
}

#[test]
fn oversampling_adds_up_and_shifts() {
    let (mut bus, mut world) = (ready(), Ladder::default());
    bus.fields("SQR1", &[("SQ[0]", 9)]);
    bus.fields("CFGR2", &[("ROVSE", 1), ("OVSR", 3), ("OVSS", 1)]);
    start(&mut bus);
    pass(&mut bus, nanos(16 * 300), &mut world);
    assert_eq!((world.0.len(), bus.read("DR")), (16, 9 * 256 * 8));
    assert_eq!(bus.get("ISR", "EOS"), 1);
}

#[test]
fn only_the_chosen_timer_starts_a_sequence_each_time_and_the_dma_is_asked() {
    let (mut bus, mut world) = (ready(), Ladder::default());
    bus.fields("CFGR", &[("EXTEN", 1), ("EXTSEL", 13), ("DMAEN", 1), ("DMACFG", 1)]);
    bus.fields("SQR1", &[("SQ[0]", 2)]);
    start(&mut bus);
    for (timer, converts) in [(2, false), (6, true), (6, true)] {
        let now = bus.now;
        bus.model.trigger(timer, now);
        // Two clocks and a half at most until it begins.
        pass(&mut bus, nanos(349), &mut world);
        assert!(!bus.model.requests("ADC2"));
        pass(&mut bus, nanos(1), &mut world);
        assert_eq!(bus.model.requests("ADC2"), converts, "{timer}");
        assert_eq!(world.0.pop().map(|(.., at)| at), converts.then_some(now + nanos(90)));
        bus.read("DR");
        assert!(!bus.model.requests("ADC2"));
    }
    assert_eq!(bus.get("CR", "ADSTART"), 1, "it waits for the next");
}

#[test]
fn a_stop_takes_some_clocks_in_which_settings_stay() {
    let (mut bus, mut world) = (ready(), Ladder::default());
    bus.fields("CFGR", &[("EXTEN", 1), ("EXTSEL", 13)]);
    start(&mut bus);
    bus.fields("CR", &[("ADVREGEN", 1), ("ADEN", 1), ("ADSTP", 1)]);
    assert_eq!((bus.get("CR", "ADSTART"), bus.get("CR", "ADSTP")), (1, 1));
    assert!(bus.refused("CFGR", 0).contains("ADSTART is 1"));
    let now = bus.now;
    assert!(!bus.model.trigger(6, now), "no conversion begins any more");
    pass(&mut bus, nanos(300), &mut world);
    assert_eq!((bus.get("CR", "ADSTART"), bus.get("CR", "ADSTP")), (0, 0));
    bus.write("CFGR", 0);
}

#[test]
fn codes_are_clamped_and_fewer_bits_take_fewer_clocks() {
    let (mut bus, mut world) = (ready(), Ladder::default());
    bus.fields("CFGR", &[("RES", 2)]);
    bus.fields("SQR1", &[("SQ[0]", 18)]);
    start(&mut bus);
    pass(&mut bus, nanos(219), &mut world);
    assert_eq!(bus.get("ISR", "EOC"), 0);
    pass(&mut bus, nanos(1), &mut world);
    assert_eq!(bus.read("DR"), 255);
}

#[test]
fn what_is_not_modelled_and_changes_while_it_converts_are_refused() {
    let mut bus = ready();
    let register = bus.model.bank().map.register("CFGR");
    assert!(bus.refused("CFGR", register.mask("DISCEN")).contains("CFGR.DISCEN"));
    assert!(bus.refused("CFGR", register.with(0x400, "EXTSEL", 9)).contains("trigger 9"));
    start(&mut bus);
    assert!(bus.refused("SQR1", 0).contains("ADSTART is 1"));
    bus.pass(nanos(10));
    let at = Moment { now: bus.now + nanos(100), ..bus.moment() };
    assert!(bus.model.advance(at).unwrap_err().to_string().contains("no world"));
}

#[test]
fn in_one_shot_mode_the_end_of_the_dmas_buffer_ends_the_conversions() {
    for (circular, goes_on) in [(0, false), (1, true)] {
        let (mut bus, mut world) = (ready(), Ladder::default());
        bus.fields("CFGR", &[("CONT", 1), ("DMAEN", 1), ("DMACFG", circular)]);
        start(&mut bus);
        pass(&mut bus, nanos(301), &mut world);
        assert!(bus.model.requests("ADC2"));
        bus.read("DR");
        bus.model.transfers_ended("ADC2");
        world.0.clear();
        pass(&mut bus, nanos(301), &mut world);
        assert_eq!((bus.model.requests("ADC2"), world.0.is_empty()), (goes_on, !goes_on));
    }
}

/// RM0440, "ADC connectivity".
#[test]
fn some_channels_are_inside_the_chip() {
    let at = Internal::at;
    assert_eq!((at(1, 16), at(2, 16)), (Some(Internal::Temperature), Some(Internal::Opamp(2))));
    assert_eq!((at(1, 18), at(2, 17), at(1, 1)), (Some(Internal::Vrefint), None, None));
}
