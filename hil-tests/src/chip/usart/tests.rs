use super::*;
use crate::chip::tests::bus::{Bus, nanos};

/// A link at 2 Mbaud at both ends: five microseconds a byte.
fn link(fifo: u32) -> Bus<Usart> {
    let mut bus = Bus::new(Usart::new("LPUART1", 2_000_000));
    bus.model.clock = 170_000_000;
    bus.model.wire([true, true, false], Time::ZERO);
    bus.write("BRR", 21_760);
    bus.fields("CR1", &[("UE", 1), ("TE", 1), ("RE", 1), ("FIFOEN", fifo)]);
    bus
}

fn receive(bus: &mut Bus<Usart>, values: &[u8]) {
    let now = bus.now;
    bus.model.receive(Symbol::undamaged(values), now);
}

#[test]
fn bytes_leave_one_after_the_other_at_the_set_baud() {
    let mut bus = link(0);
    assert_eq!(bus.model.baud(), 2_000_000);
    bus.write("TDR", 0x41);
    assert_eq!((bus.get("ISR", "TC"), bus.get("ISR", "TXE")), (0, 1), "the first goes on at once");
    bus.write("TDR", 0x42);
    assert_eq!(bus.get("ISR", "TXE"), 0);
    bus.pass(nanos(4_999));
    assert!(!bus.model.has_sent());
    bus.pass(nanos(1));
    assert_eq!((bus.get("ISR", "TXE"), bus.get("ISR", "TC")), (1, 0));
    bus.pass(nanos(5_000));
    assert_eq!(bus.get("ISR", "TC"), 1);
    let sent = bus.model.take_sent();
    assert_eq!(sent, [(nanos(5_000), 0x41), (nanos(10_000), 0x42)]);
}

#[test]
fn the_transmit_fifo_holds_eight_beside_the_byte_on_the_line() {
    let mut bus = link(1);
    for byte in 0..9 {
        assert_eq!(bus.get("ISR", "TXE"), 1, "before byte {byte}");
        bus.write("TDR", byte);
    }
    assert_eq!(bus.get("ISR", "TXE"), 0);
    bus.pass(nanos(45_000));
    assert_eq!(bus.model.take_sent().len(), 9);
}

#[test]
fn the_ninth_byte_that_nobody_reads_overruns_the_fifo() {
    let mut bus = link(1);
    receive(&mut bus, &[1, 2, 3, 4, 5, 6, 7, 8, 9]);
    bus.pass(nanos(40_000));
    assert_eq!((bus.get("ISR", "RXFF"), bus.get("ISR", "ORE")), (1, 0));
    bus.pass(nanos(5_000));
    assert_eq!(bus.get("ISR", "ORE"), 1);
    let read: Vec<u32> = (0..8).map(|_| bus.read("RDR")).collect();
    assert_eq!(read, [1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(bus.get("ISR", "RXNE"), 0);
    bus.fields("ICR", &[("ORE", 1)]);
    assert_eq!(bus.get("ISR", "ORE"), 0);
}

#[test]
fn a_byte_arrives_when_its_stop_bit_ends() {
    let mut bus = link(0);
    receive(&mut bus, &[0x5A]);
    bus.pass(nanos(4_999));
    assert_eq!(bus.get("ISR", "RXNE"), 0);
    bus.pass(nanos(1));
    assert_eq!((bus.get("ISR", "RXNE"), bus.read("RDR")), (1, 0x5A));
}

#[test]
fn the_line_is_idle_one_frame_after_the_last_byte_and_not_between_bytes() {
    let mut bus = link(1);
    receive(&mut bus, &[1, 2, 3]);
    bus.pass(nanos(19_999));
    assert_eq!(bus.get("ISR", "IDLE"), 0, "bytes follow each other, then less than a frame of silence");
    bus.pass(nanos(1));
    assert_eq!(bus.get("ISR", "IDLE"), 1);
    bus.fields("ICR", &[("IDLE", 1)]);
    bus.pass(Time::from_millis(5));
    assert_eq!(bus.get("ISR", "IDLE"), 0, "it is told once");
}

#[test]
fn a_byte_that_starts_within_a_frame_of_the_last_ends_the_silence() {
    let mut bus = link(1);
    receive(&mut bus, &[1]);
    bus.pass(nanos(8_000));
    receive(&mut bus, &[2]);
    bus.pass(nanos(9_999));
    assert_eq!(bus.get("ISR", "IDLE"), 0);
    bus.pass(nanos(1));
    assert_eq!(bus.get("ISR", "IDLE"), 1);
}

#[test]
fn a_wrong_baud_and_a_damaged_byte_are_framing_errors() {
    let mut bus = link(1);
    bus.fields("CR1", &[]);
    bus.write("BRR", 21_760 * 11 / 10);
    bus.fields("CR1", &[("UE", 1), ("RE", 1), ("FIFOEN", 1)]);
    receive(&mut bus, &[0x55]);
    bus.pass(nanos(5_000));
    assert_eq!(bus.get("ISR", "FE"), 1);
    assert_ne!(bus.read("RDR"), 0x55);
    let mut bus = link(1);
    bus.model.receive([Symbol { byte: 7, damaged: true }], Time::ZERO);
    bus.pass(nanos(5_000));
    assert_eq!((bus.get("ISR", "FE"), bus.read("RDR")), (1, 7));
}

#[test]
fn without_pins_nothing_arrives_and_sending_is_refused() {
    let mut bus = link(1);
    bus.model.wire([false; 3], Time::ZERO);
    receive(&mut bus, &[1]);
    bus.pass(nanos(5_000));
    assert_eq!(bus.get("ISR", "RXNE"), 0);
    assert!(bus.refused("TDR", 1).contains("alternate function"));
    bus.fields("CR1", &[("UE", 1)]);
    assert!(bus.refused("TDR", 1).contains("TE"));
}

#[test]
fn it_asks_the_dma_while_there_is_something_to_move() {
    let mut bus = link(1);
    assert!(!bus.model.requests("TX") && !bus.model.requests("RX"));
    bus.fields("CR3", &[("DMAT", 1), ("DMAR", 1)]);
    assert!(bus.model.requests("TX") && !bus.model.requests("RX"));
    receive(&mut bus, &[1]);
    bus.pass(nanos(5_000));
    assert!(bus.model.requests("RX"));
    bus.read("RDR");
    assert!(!bus.model.requests("RX"));
}

#[test]
fn each_interrupt_follows_its_flag_and_its_switch() {
    let mut bus = link(0);
    let on = [("UE", 1), ("TE", 1), ("RE", 1)];
    receive(&mut bus, &[1]);
    bus.pass(nanos(10_000));
    for (switch, raised) in
        [("RXNEIE", true), ("IDLEIE", true), ("TXEIE", true), ("TCIE", true), ("PEIE", false)]
    {
        bus.fields("CR1", &[on[0], on[1], on[2], (switch, 1)]);
        assert_eq!(bus.model.interrupts("GLOBAL"), raised, "{switch}");
    }
    bus.read("RDR");
    bus.fields("CR1", &[on[0], on[1], on[2], ("RXNEIE", 1)]);
    assert!(!bus.model.interrupts("GLOBAL"));
}

#[test]
fn settings_that_the_chip_or_the_model_does_not_have_are_refused() {
    let mut bus = link(0);
    assert!(bus.refused("BRR", 0x400).contains("UE is 1"));
    bus.fields("CR1", &[]);
    assert!(bus.refused("BRR", 0x2FF).contains("0x300"));
    let parity = bus.model.bank().map.register("CR1").mask("PCE");
    assert!(bus.refused("CR1", parity).contains("parity"));
}

/// A link at 2 Mbaud over a shared line, with this time before the first byte and after the last one, in sixteenths of a
/// bit: 31.25 ns.
fn shared(driver_time: u32) -> Bus<Usart> {
    let mut bus = Bus::new(Usart::new("USART1", 2_000_000));
    bus.model.clock = 170_000_000;
    bus.model.wire([true; 3], Time::ZERO);
    bus.write("BRR", 85);
    bus.fields("CR3", &[("DEM", 1)]);
    let times = [("DEAT", driver_time), ("DEDT", driver_time)];
    bus.fields("CR1", &[&[("UE", 1), ("TE", 1), ("RE", 1), ("FIFOEN", 1)], &times[..]].concat());
    bus
}

#[test]
fn the_driver_is_on_from_before_the_first_byte_until_after_the_last_one() {
    let mut bus = shared(16);
    assert_eq!(bus.model.baud(), 2_000_000);
    bus.write("TDR", 0x41);
    assert!(bus.model.drives());
    bus.write("TDR", 0x42);
    bus.pass(nanos(10_999));
    assert_eq!(bus.get("ISR", "TC"), 1);
    assert!(bus.model.drives(), "the last stop bit ended half a microsecond ago");
    bus.pass(nanos(1));
    assert_eq!(bus.model.take_edges(), [(Time::ZERO, true), (nanos(11_000), false)]);
    assert_eq!(bus.model.take_driven(), [(nanos(5_500), 0x41), (nanos(10_500), 0x42)]);
}

#[test]
fn a_byte_that_comes_while_the_driver_is_to_go_off_waits_for_both_times() {
    let mut bus = shared(16);
    bus.write("TDR", 0x41);
    bus.pass(nanos(5_800));
    bus.write("TDR", 0x42);
    bus.pass(nanos(10_000));
    assert_eq!(bus.model.take_driven(), [(nanos(5_500), 0x41), (nanos(11_500), 0x42)]);
    let edges = [(0, true), (6_000, false), (6_000, true), (12_000, false)];
    assert_eq!(bus.model.take_edges(), edges.map(|(time, is_on)| (nanos(time), is_on)));
}

#[test]
fn without_its_mode_or_its_pin_a_uart_drives_no_shared_line() {
    let mut bus = shared(0);
    bus.model.wire([true, true, false], Time::ZERO);
    bus.write("TDR", 0x41);
    bus.pass(nanos(5_000));
    assert_eq!(bus.model.take_sent(), [(nanos(5_000), 0x41)]);
    assert!(bus.model.take_driven().is_empty() && bus.model.take_edges().is_empty());
    let mut bus = link(1);
    bus.model.wire([true; 3], Time::ZERO);
    bus.write("TDR", 0x41);
    bus.pass(nanos(5_000));
    assert!(bus.model.take_driven().is_empty() && bus.model.take_edges().is_empty());
}

#[test]
fn the_driver_goes_off_with_the_uart_its_pin_and_a_reset() {
    type Change = fn(&mut Bus<Usart>);
    let changes: [Change; 3] = [
        |bus| bus.fields("CR1", &[("DEAT", 16), ("DEDT", 16)]),
        |bus| bus.model.wire([true, true, false], bus.now),
        |bus| {
            bus.model.reset();
            // As the chip does: all pins are analogue then.
            bus.model.wire([false; 3], bus.now);
        },
    ];
    for change in changes {
        let mut bus = shared(16);
        bus.write("TDR", 0x41);
        bus.pass(nanos(3_000));
        change(&mut bus);
        assert!(!bus.model.drives());
        bus.pass(nanos(10_000));
        assert_eq!(bus.model.take_edges(), [(Time::ZERO, true), (nanos(3_000), false)]);
        assert!(bus.model.take_driven().is_empty());
    }
}

#[test]
fn symbols_with_times_of_their_own_are_idle_between_where_a_byte_fits() {
    let mut bus = link(1);
    for (byte, at) in [(1, 10_000), (2, 15_000), (3, 24_999), (4, 34_999)] {
        bus.model.hear(Symbol { byte, damaged: false }, nanos(at));
    }
    bus.pass(nanos(29_998));
    assert_eq!(bus.get("ISR", "IDLE"), 0, "the third begins just before");
    bus.pass(nanos(1));
    assert_eq!(bus.get("ISR", "IDLE"), 1);
    bus.pass(nanos(10_000));
    let read: Vec<u32> = (0..4).map(|_| bus.read("RDR")).collect();
    assert_eq!(read, [1, 2, 3, 4]);
}

#[test]
fn the_two_kinds_of_uart_divide_their_clock_differently_and_settings_wait_until_they_are_off() {
    let mut bus = shared(0);
    let register = bus.model.bank().map.register("CR1");
    let changed = bus.read("CR1") | register.mask("DEAT");
    assert!(bus.refused("CR1", changed).contains("USART1: DEAT changes while UE is 1"));
    assert!(bus.refused("CR3", 0).contains("DEM changes while UE is 1"));
    bus.fields("CR1", &[]);
    assert!(bus.refused("BRR", 15).contains("0x10"));
    assert!(bus.refused("BRR", 0x1_0000).contains("0x10"));
    bus.write("BRR", 16);
}
