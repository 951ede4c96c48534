use super::*;
use crate::chip::tests::bus::{Bus, nanos};

/// A timer at 1 MHz that starts again after 100 ticks.
fn timer(name: &str, bits: u32, enabled: &[(&str, u32)]) -> Bus<Timer> {
    let mut bus = Bus::new(Timer::new(name, if name == "TIM6" { 0 } else { 4 }, bits));
    bus.model.run_at(1_000_000);
    bus.write("ARR", 99);
    bus.fields("DIER", enabled);
    bus
}

fn start(bus: &mut Bus<Timer>) {
    bus.fields("CR1", &[("CEN", 1)]);
}

#[test]
fn the_counter_updates_after_arr_plus_one_ticks() {
    let mut bus = timer("TIM2", 32, &[("UIE", 1)]);
    start(&mut bus);
    bus.pass(nanos(99_999));
    assert_eq!((bus.read("CNT"), bus.get("SR", "UIF")), (99, 0));
    assert!(!bus.model.interrupts("UP"));
    assert_eq!(bus.model.next_event(), Time::from_micros(100));
    bus.pass(nanos(1));
    assert_eq!((bus.read("CNT"), bus.get("SR", "UIF")), (0, 1));
    assert!(bus.model.interrupts("UP"));
    bus.write("SR", !1);
    assert!(!bus.model.interrupts("UP"));
}

#[test]
fn a_compare_value_is_met_once_in_each_round() {
    let mut bus = timer("TIM2", 32, &[("CCIE[1]", 1)]);
    bus.write_at("CCR", 1, 30).unwrap();
    start(&mut bus);
    for at in [30, 130, 230] {
        assert_eq!(bus.model.next_event(), Time::from_micros(at));
        let now = bus.now;
        bus.pass(Time::from_micros(at) - now);
        assert_eq!((bus.get("SR", "CCIF[1]"), bus.get("SR", "CCIF[0]")), (1, u32::from(at > 100)));
        bus.write("SR", !4);
    }
}

#[test]
fn the_prescaler_is_taken_over_at_an_update() {
    let mut bus = timer("TIM2", 32, &[]);
    start(&mut bus);
    bus.write("PSC", 9);
    bus.pass(Time::from_micros(100));
    assert_eq!(bus.read("CNT"), 0, "still one tick a microsecond");
    bus.pass(Time::from_micros(50));
    assert_eq!(bus.read("CNT"), 5);
    bus.write("PSC", 4);
    bus.fields("EGR", &[("UG", 1)]);
    bus.pass(Time::from_micros(50));
    assert_eq!(bus.read("CNT"), 10);
}

#[test]
fn one_pulse_stops_at_the_update() {
    let mut bus = timer("TIM6", 16, &[]);
    bus.fields("CR1", &[("CEN", 1), ("OPM", 1)]);
    bus.pass(Time::from_micros(500));
    assert_eq!((bus.get("CR1", "CEN"), bus.read("CNT"), bus.get("SR", "UIF")), (0, 0, 1));
}

#[test]
fn sixteen_bits_wrap_and_thirty_two_do_not() {
    for (name, bits, count) in [("TIM3", 16, 65_537 - 65_536), ("TIM2", 32, 65_537)] {
        let mut bus = timer(name, bits, &[]);
        bus.write("ARR", u32::MAX >> (32 - bits));
        start(&mut bus);
        bus.pass(Time::from_micros(65_537));
        assert_eq!(bus.read("CNT"), count, "{name}");
    }
}

#[test]
fn an_update_asks_the_dma_once() {
    let mut bus = timer("TIM6", 16, &[("UDE", 1)]);
    start(&mut bus);
    assert!(!bus.model.requests("UP"));
    bus.pass(Time::from_micros(100));
    assert!(bus.model.requests("UP"));
    bus.model.acknowledge("UP");
    assert!(!bus.model.requests("UP"));
    bus.pass(Time::from_micros(100));
    assert!(bus.model.requests("UP"));
}

#[test]
fn ug_starts_again_and_urs_keeps_its_flag_down() {
    for (urs, flag) in [(0, 1), (1, 0)] {
        let mut bus = timer("TIM2", 32, &[]);
        bus.fields("CR1", &[("CEN", 1), ("URS", urs)]);
        bus.pass(Time::from_micros(42));
        bus.fields("EGR", &[("UG", 1)]);
        assert_eq!((bus.read("CNT"), bus.get("SR", "UIF")), (0, flag));
    }
}

#[test]
fn udis_counts_on_without_updates() {
    let mut bus = timer("TIM2", 32, &[]);
    bus.fields("CR1", &[("CEN", 1), ("UDIS", 1)]);
    bus.pass(Time::from_micros(150));
    assert_eq!((bus.read("CNT"), bus.get("SR", "UIF")), (50, 0));
}

/// Two hours at 1 MHz are 72 million rounds: stepping through them would take minutes.
#[test]
fn hours_are_caught_up_at_once() {
    let mut bus = timer("TIM2", 32, &[]);
    bus.write_at("CCR", 3, 70).unwrap();
    start(&mut bus);
    let begun = std::time::Instant::now();
    bus.pass(Time::from_millis(7_200_000) + Time::from_micros(42));
    assert_eq!((bus.read("CNT"), bus.get("SR", "UIF"), bus.get("SR", "CCIF[3]")), (42, 1, 1));
    assert!(begun.elapsed() < std::time::Duration::from_millis(100));
}

#[test]
fn what_is_not_modelled_is_refused() {
    let mut bus = timer("TIM2", 32, &[]);
    for (register, value) in [("CR1", 1 << 4), ("SMCR", 4), ("CCER", 1)] {
        assert!(bus.refused(register, value).contains("modelled"), "{register}");
    }
}

/// CR2.MMS: 0 reset, 1 enable, 2 update, 3 compare of channel 1.
#[test]
fn the_trigger_output_fires_for_what_mms_says() {
    for (mode, at) in [(0, None), (1, Some(0)), (2, Some(100)), (3, Some(40))] {
        let mut bus = timer("TIM2", 32, &[]);
        bus.fields("CR2", &[("MMS", mode)]);
        bus.write_at("CCR", 0, 40).unwrap();
        start(&mut bus);
        let mut fired = None;
        for micros in 0..140 {
            if bus.model.take_trigger() {
                assert_eq!(fired.replace(micros), None, "mode {mode} fires twice");
            }
            bus.pass(Time::from_micros(1));
        }
        assert_eq!(fired, at, "mode {mode}");
        bus.model.take_trigger();
        bus.fields("EGR", &[("UG", 1)]);
        assert_eq!(bus.model.take_trigger(), matches!(mode, 0 | 2), "mode {mode}");
    }
    let mut bus = timer("TIM2", 32, &[]);
    assert!(bus.refused("CR2", 4 << 4).contains("MMS"));
}

/// A slave of TIM4 that starts again after three of its triggers.
fn slave(fields: &[(&str, u32)]) -> Bus<Timer> {
    let mut bus = timer("TIM2", 32, &[]);
    bus.write("ARR", 2);
    bus.fields("SMCR", fields);
    bus
}

/// "External clock mode 1": RM0440, "Using one timer as prescaler for another timer".
#[test]
fn a_slave_in_external_clock_mode_counts_its_masters_triggers_only() {
    let mut bus = slave(&[("TS", 3), ("SMS", 7)]);
    assert!(!bus.model.trigger(4, nanos(0)));
    assert_eq!(bus.read("CNT"), 0, "it is off");
    start(&mut bus);
    bus.pass(Time::from_micros(50));
    assert_eq!((bus.read("CNT"), bus.model.next_event()), (0, Time::NEVER), "time does not clock it");
    for (master, count, updates) in [(4, 1, 0), (3, 1, 0), (4, 2, 0), (4, 0, 1), (4, 1, 1)] {
        let now = bus.now;
        bus.model.trigger(master, now);
        assert_eq!((bus.read("CNT"), bus.get("SR", "UIF")), (count, updates));
    }
    assert_eq!(bus.get("SR", "TIF"), 1);
}

#[test]
fn a_slaves_prescaler_divides_the_triggers() {
    let mut bus = slave(&[("TS", 3), ("SMS", 7)]);
    bus.write("PSC", 1);
    bus.fields("EGR", &[("UG", 1)]);
    start(&mut bus);
    for count in [0, 1, 1, 2] {
        bus.model.trigger(4, nanos(0));
        assert_eq!(bus.read("CNT"), count);
    }
}

#[test]
fn in_trigger_mode_the_master_starts_the_counter() {
    let mut bus = slave(&[("TS", 2), ("SMS", 6)]);
    bus.pass(Time::from_micros(7));
    assert!(!bus.model.trigger(4, bus.now), "its master is TIM3");
    let now = bus.now;
    assert!(bus.model.trigger(3, now));
    bus.pass(Time::from_micros(2));
    assert_eq!((bus.get("CR1", "CEN"), bus.read("CNT")), (1, 2));
}

#[test]
fn slave_modes_and_masters_that_are_not_modelled_are_refused() {
    let mut bus = slave(&[("TS", 3), ("SMS", 7)]);
    let register = bus.model.bank().map.register("SMCR");
    let with = |ts, sms| register.with(register.with(0, "TS", ts), "SMS", sms);
    assert!(bus.refused("SMCR", with(2, 7)).contains("TS changes"));
    bus.write("SMCR", 0);
    assert!(bus.refused("SMCR", with(0, 7)).contains("trigger 0 (SMCR.TS)"), "TIM1");
    assert!(bus.refused("SMCR", with(1, 7)).contains("trigger 1 (SMCR.TS)"), "itself");
    assert!(bus.refused("SMCR", with(3, 5)).contains("slave modes"), "gated mode");
}

/// "PWM mode": OC1REF is high below CCR1 in mode 1, low in mode 2; CCP turns it round.
#[test]
fn pwm_outputs_follow_the_compare_value() {
    for (mode, turned, below) in [(6, 0, true), (7, 0, false), (6, 1, false), (7, 1, true)] {
        let mut bus = timer("TIM3", 16, &[]);
        bus.write_at("CCR", 0, 30).unwrap();
        bus.fields("CCMR_INPUT", &[("OCM[0]", mode)]);
        assert_eq!(bus.model.output(0), None);
        bus.fields("CCER", &[("CCE[0]", 1), ("CCP[0]", turned)]);
        start(&mut bus);
        for (at, is_below) in [(29, true), (30, false), (99, false), (100, true), (130, false)] {
            let now = bus.now;
            bus.pass(Time::from_micros(at) - now);
            assert_eq!(bus.model.output(0), Some(below == is_below), "mode {mode} at {at}");
        }
        assert_eq!(bus.model.next_event(), Time::from_micros(200), "each edge is an event");
    }
}

#[test]
fn forced_levels_stay_and_modes_without_a_model_are_refused() {
    let mut bus = timer("TIM3", 16, &[]);
    bus.fields("CCMR_INPUT", &[("OCM[1]", 5)]);
    bus.fields("CCER", &[("CCE[1]", 1)]);
    assert_eq!((bus.model.output(0), bus.model.output(1)), (None, Some(true)));
    assert!(bus.refused("CCMR_INPUT", 3 << 12).contains("channel 2"), "toggle");
    assert!(bus.refused("CCMR_INPUT", 1 << 8).contains("channel 2"), "capture");
    let mut compare = Bus::new(Timer::new("TIM15", 2, 16));
    assert!(compare.refused("CCER", 1).contains("BDTR"));
}

/// CR1.ARPE and CCMR.OCPE: "the preload register is transferred at each update event".
#[test]
fn preloaded_values_wait_for_the_update() {
    for (preload, counts) in [(1, [60, 20]), (0, [10, 20])] {
        let mut bus = timer("TIM3", 16, &[]);
        bus.write_at("CCR", 0, 50).unwrap();
        bus.fields("CCMR_INPUT", &[("OCM[0]", 6), ("OCPE[0]", preload)]);
        bus.fields("CCER", &[("CCE[0]", 1)]);
        bus.fields("EGR", &[("UG", 1)]);
        bus.fields("CR1", &[("CEN", 1), ("ARPE", preload)]);
        bus.pass(Time::from_micros(20));
        bus.write("ARR", 49);
        bus.write_at("CCR", 0, 10).unwrap();
        assert_eq!(bus.model.output(0), Some(preload == 1));
        bus.pass(Time::from_micros(40));
        assert_eq!(bus.read("CNT"), counts[0]);
        bus.pass(Time::from_micros(60));
        assert_eq!(bus.read("CNT"), counts[1]);
        assert_eq!(bus.model.output(0), Some(false));
    }
}

#[test]
fn a_counter_whose_top_is_zero_stands_still() {
    let mut bus = timer("TIM2", 32, &[("UIE", 1)]);
    bus.write("ARR", 0);
    start(&mut bus);
    assert_eq!(bus.model.next_event(), Time::NEVER);
    bus.pass(Time::from_micros(5));
    assert_eq!((bus.read("CNT"), bus.get("SR", "UIF")), (0, 0));
}
