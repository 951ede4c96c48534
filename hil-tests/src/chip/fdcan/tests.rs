use super::{frame::Format, node::LineError, *};
use crate::chip::{
    fdcan::frame::Frame,
    tests::{
        bus::Bus,
        probe::{chip, run_at_170_mhz},
    },
};

const CRYSTAL: CanClock = CanClock { hertz: 24_000_000, is_crystal: true, bus: 170_000_000 };

/// A filter that puts one identifier into the first FIFO.
const OWN: u32 = 1 << 30 | 1 << 27 | 0x103 << 16 | 0x103;

/// A controller that is set up for 1 and 2 Mbit/s and has not joined.
fn set_up() -> Bus<Fdcan> {
    let mut bus = Bus::new(Fdcan::new("FDCAN1", "FDCANRAM1"));
    bus.model.clock = CRYSTAL;
    bus.model.wire([true; 2]);
    bus.fields("CCCR", &[("INIT", 1), ("CCE", 1)]);
    bus.fields("NBTP", &[("NTSEG1", 17), ("NTSEG2", 4), ("NSJW", 4)]);
    bus.fields("DBTP", &[("DTSEG1", 8), ("DTSEG2", 1), ("DSJW", 1), ("TDC", 1)]);
    bus.fields("CCCR", &[("INIT", 1), ("CCE", 1), ("FDOE", 1), ("BRSE", 1)]);
    bus.fields("RXGFC", &[("LSS", 1), ("ANFS", 2), ("ANFE", 2)]);
    bus.fields("IE", &[("RFNE[0]", 1), ("TCE", 1), ("BOE", 1), ("EPE", 1)]);
    bus.fields("ILE", &[("EINT0", 1)]);
    bus.write("TXBTIE", 7);
    remember(&mut bus, "FLSSA", 0, OWN);
    bus
}

/// One that takes part.
fn joined() -> Bus<Fdcan> {
    let mut bus = set_up();
    join(&mut bus);
    assert!(bus.model.is_on());
    bus
}

fn join(bus: &mut Bus<Fdcan>) {
    bus.fields("CCCR", &[("FDOE", 1), ("BRSE", 1)]);
    tell(bus, News::Quiet(Time::from_micros(11)));
}

fn tell(bus: &mut Bus<Fdcan>, news: News) {
    let now = bus.now;
    bus.model.hear(now, news);
    bus.pass(Time::ZERO);
}

fn remember(bus: &mut Bus<Fdcan>, register: &str, place: usize, value: u32) {
    let at = bus.moment();
    let map = bus.model.ram.bank().map;
    bus.model.ram.write(map.element(register, place), value, at).unwrap();
}

/// Puts a frame into a buffer and asks for it.
fn send(bus: &mut Bus<Fdcan>, buffer: usize, identifier: u32) {
    remember(bus, "TXBUF", 18 * buffer, identifier << 18);
    remember(bus, "TXBUF", 18 * buffer + 1, 3 << 20 | 9 << 16);
    (0..3).for_each(|word| remember(bus, "TXBUF", 18 * buffer + 2 + word, 0x0403_0201));
    bus.write("TXBAR", 1 << buffer);
}

fn frame(identifier: u16) -> Frame {
    Frame { identifier, format: Format::Switching, data: vec![1, 2, 3, 4, 5] }
}

#[test]
fn bit_rates_follow_from_the_crystal_and_the_registers() {
    let rates = set_up().model.rates();
    assert_eq!((rates.nominal, rates.data), (1_000_000, 2_000_000));
}

#[test]
fn settings_change_only_while_it_is_off_the_bus_and_told_that_they_may() {
    let mut bus = joined();
    for register in ["NBTP", "DBTP", "RXGFC", "TXBC", "TDCR"] {
        assert!(bus.refused(register, 1).contains("CCE is 0"), "{register}");
    }
    assert!(bus.refused("CCCR", 2).contains("CCE is set while INIT is 0"));
    bus.fields("CCCR", &[("INIT", 1), ("FDOE", 1), ("BRSE", 1)]);
    assert!(bus.refused("CCCR", 1).contains("FDOE changes while CCE is 0"));
    assert!(bus.refused("PSR", 0).contains("cannot be written"));
}

#[test]
fn what_is_not_modelled_is_refused() {
    let mut bus = set_up();
    for (register, field) in
        [("CCCR", "MON"), ("CCCR", "DAR"), ("TEST", "LBCK"), ("TSCC", "TSS"), ("RXGFC", "F0OM")]
    {
        let map = bus.model.bank().map.register(register);
        let value = map.with(bus.model.bank().value(map), field, 1);
        assert!(bus.refused(register, value).contains("not modelled"), "{register}.{field}");
    }
    remember(&mut bus, "TXBUF", 0, 1 << 30);
    bus.fields("CCCR", &[("FDOE", 1), ("BRSE", 1)]);
    assert!(bus.refused("TXBAR", 1).contains("long identifiers"));
}

#[test]
fn it_joins_with_a_clock_that_is_exact_enough_and_after_eleven_recessive_bits() {
    for (clock, message) in [
        (CanClock::default(), "its clock is off"),
        (CanClock { is_crystal: false, ..CRYSTAL }, "HSI16"),
        (CanClock { bus: 16_000_000, ..CRYSTAL }, "faster than its bus"),
    ] {
        let mut bus = set_up();
        bus.model.clock = clock;
        let refusal = bus.refused("CCCR", 0x300);
        assert!(refusal.contains(message), "{refusal}");
    }
    let mut bus = set_up();
    bus.fields("CCCR", &[("FDOE", 1), ("BRSE", 1)]);
    tell(&mut bus, News::Quiet(Time::from_micros(10)));
    assert!(bus.model.is_joining() && bus.get("PSR", "ACT") == 0);
    tell(&mut bus, News::Quiet(Time::from_micros(1)));
    assert!(bus.model.is_on() && bus.get("PSR", "ACT") == 1);
}

#[test]
fn the_fifo_of_frames_to_send_keeps_their_order_and_says_when_each_is_sent() {
    let mut bus = joined();
    assert_eq!((bus.get("TXFQS", "TFFL"), bus.get("TXFQS", "TFQPI")), (3, 0));
    (0..3).for_each(|buffer| send(&mut bus, buffer, 0x203 - buffer as u32));
    assert_eq!((bus.get("TXFQS", "TFFL"), bus.get("TXFQS", "TFQF"), bus.read("TXBRP")), (0, 1, 7));
    assert!(bus.refused("TXBAR", 1).contains("still to be sent"));
    let (_, first) = bus.model.request().unwrap();
    assert_eq!((first.identifier, first.data.len(), &first.data[..5]), (0x203, 12, &[1, 2, 3, 4, 1][..]));
    bus.model.begin();
    tell(&mut bus, News::Sent);
    assert_eq!((bus.read("TXBRP"), bus.read("TXBTO"), bus.get("IR", "TC")), (6, 1, 1));
    assert!(bus.model.interrupts("IT0") && !bus.model.interrupts("IT1"));
    bus.write("IR", 0x80);
    assert!(!bus.model.interrupts("IT0"));
    assert_eq!(bus.model.request().unwrap().1.identifier, 0x202);
    send(&mut bus, 0, 0x200);
    assert_eq!((bus.get("TXFQS", "TFGI"), bus.get("TXFQS", "TFQPI")), (1, 1));
}

#[test]
fn a_queue_sends_the_lowest_identifier_first() {
    let mut bus = set_up();
    bus.fields("TXBC", &[("TFQM", 1)]);
    join(&mut bus);
    [0x203, 0x201, 0x202].into_iter().enumerate().for_each(|(buffer, id)| send(&mut bus, buffer, id));
    assert_eq!(bus.model.request().unwrap().1.identifier, 0x201);
}

#[test]
fn a_frame_that_is_on_the_bus_is_finished_before_it_is_cancelled() {
    let mut bus = joined();
    send(&mut bus, 0, 0x203);
    send(&mut bus, 1, 0x203);
    bus.model.begin();
    bus.write("TXBCR", 3);
    assert_eq!((bus.read("TXBRP"), bus.read("TXBCF")), (1, 2));
    tell(&mut bus, News::Failed(LineError::Bit));
    assert_eq!((bus.read("TXBRP"), bus.read("TXBCF"), bus.get("PSR", "LEC")), (0, 3, 4));
    assert_eq!(bus.get("PSR", "LEC"), 7, "what was read is forgotten");
}

#[test]
fn filters_choose_frames_and_the_fourth_one_is_lost() {
    let mut bus = joined();
    tell(&mut bus, News::Received(frame(0x102)));
    assert_eq!((bus.get("RXFS", "FFL"), bus.get("IR", "RFN[0]")), (0, 0));
    for count in 1..=3 {
        tell(&mut bus, News::Received(frame(0x103)));
        assert_eq!(bus.get("RXFS", "FFL"), count);
    }
    assert_eq!((bus.get("IR", "RFF[0]"), bus.get("IR", "RFL[0]")), (1, 0));
    tell(&mut bus, News::Received(frame(0x103)));
    assert_eq!((bus.get("RXFS", "FFL"), bus.get("RXFS", "RFL")), (3, 1));
    let words = [0, 1, 2, 3].map(|word| bus.model.ram.bank().word("RXFIFO0", word));
    assert_eq!(words, [0x103 << 18, 3 << 20 | 5 << 16, 0x0403_0201, 5]);
    bus.write_at("RXFA", 0, 0).unwrap();
    assert_eq!((bus.get("RXFS", "FFL"), bus.get("RXFS", "FGI"), bus.get("RXFS", "FPI")), (2, 1, 0));
    let nothing = bus.write_at("RXFA", 0, 0).unwrap_err().to_string();
    assert!(nothing.contains("no frame lies there"), "{nothing}");
}

#[test]
fn alone_it_becomes_passive_and_waits_longer_before_it_tries_again() {
    let mut bus = joined();
    send(&mut bus, 0, 0x203);
    for _ in 0..40 {
        bus.model.begin();
        tell(&mut bus, News::Failed(LineError::Acknowledge));
    }
    assert_eq!((bus.get("ECR", "TEC"), bus.get("PSR", "EP"), bus.get("PSR", "BO")), (128, 1, 0));
    assert_eq!(bus.get("IR", "EP"), 1);
    assert_eq!(bus.model.request().unwrap().0, bus.now + Time::from_micros(11));
}

#[test]
fn off_the_bus_it_waits_to_be_told_and_then_for_129_times_11_bits() {
    let mut bus = joined();
    send(&mut bus, 0, 0x203);
    for _ in 0..32 {
        bus.model.begin();
        tell(&mut bus, News::Failed(LineError::Bit));
    }
    assert_eq!((bus.get("CCCR", "INIT"), bus.get("PSR", "BO"), bus.get("IR", "BO")), (1, 1, 1));
    assert!(!bus.model.is_on() && bus.model.request().is_none());
    bus.write("IR", 1 << 19);
    bus.fields("CCCR", &[("INIT", 1), ("CCE", 1), ("FDOE", 1), ("BRSE", 1)]);
    assert_eq!((bus.read("TXBRP"), bus.get("TXFQS", "TFFL")), (0, 3), "what was to be sent is forgotten");
    bus.fields("CCCR", &[("FDOE", 1), ("BRSE", 1)]);
    tell(&mut bus, News::Quiet(Time::from_micros(129 * 11 - 1)));
    assert!(!bus.model.is_on());
    tell(&mut bus, News::Quiet(Time::from_micros(1)));
    assert!(bus.model.is_on());
    assert_eq!((bus.get("PSR", "BO"), bus.get("ECR", "TEC"), bus.get("IR", "BO")), (0, 0, 1));
}

#[test]
fn a_listener_counts_what_it_does_not_understand() {
    let mut bus = joined();
    tell(&mut bus, News::Disturbed(true));
    tell(&mut bus, News::Disturbed(false));
    assert_eq!(bus.get("ECR", "REC"), 9);
    assert_eq!(bus.get("ECR", "CEL"), 0, "errors since it was read last");
    tell(&mut bus, News::Received(frame(0x103)));
    assert_eq!(bus.get("ECR", "REC"), 8);
}

#[test]
fn a_reset_leaves_the_bus_and_the_memory_keeps_its_words() {
    let mut bus = joined();
    send(&mut bus, 0, 0x203);
    bus.model.reset();
    assert!(!bus.model.is_on() && bus.read("TXBRP") == 0 && bus.read("CCCR") == 1);
    assert_eq!(bus.model.ram.filter(0), OWN);
}

#[test]
fn a_buffer_that_is_to_be_sent_is_not_written() {
    let mut bus = joined();
    send(&mut bus, 0, 0x203);
    let at = bus.moment();
    let word = bus.model.ram.bank().map.element("TXBUF", 3);
    let refusal = bus.model.ram.write(word, 0, at).unwrap_err().to_string();
    assert!(refusal.contains("while it is to be sent"), "{refusal}");
}

#[test]
fn the_chip_gives_it_the_crystal_and_its_memory_a_clock() {
    let mut chip = chip();
    let refusal = chip.refused("FDCANRAM1", "FLSSA", &[]);
    assert!(refusal.contains("APB1ENR1.FDCANEN is 0"), "{refusal}");
    run_at_170_mhz(&mut chip, true, 4).unwrap();
    assert_eq!(chip.fdcan.clock, CanClock { hertz: 0, is_crystal: false, bus: 170_000_000 });
    chip.modify("RCC", "CR", &[("HSEON", 1)]);
    assert_eq!(chip.fdcan.clock, CRYSTAL);
    chip.modify("RCC", "CCIPR", &[("FDCANSEL", 2)]);
    assert_eq!(chip.fdcan.clock, CanClock { hertz: 170_000_000, is_crystal: false, bus: 170_000_000 });
}
