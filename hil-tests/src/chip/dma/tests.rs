use super::*;
use crate::chip::tests::bus::Bus;

const THERE: u32 = 0x4000_8024;
const HERE: u32 = 0x2000_0100;

/// Channel 3 (index 2) from a peripheral to memory, so many beats.
fn channel(beats: u32, fields: &[(&str, u32)]) -> Bus<Dma> {
    let mut bus = Bus::new(Dma::new("DMA1"));
    bus.write_at("CH.PAR", 2, THERE).unwrap();
    bus.write_at("CH.MAR", 2, HERE).unwrap();
    bus.write_at("CH.NDTR", 2, beats).unwrap();
    let register = bus.model.bank().map.element("CH.CR", 2);
    let all = fields.iter().chain(&[("EN", 1), ("MINC", 1)]);
    let value = all.fold(0, |value, &(field, content)| register.with(value, field, content));
    bus.write_at("CH.CR", 2, value).unwrap();
    bus
}

fn flags(bus: &mut Bus<Dma>) -> u32 {
    bus.read("ISR") >> 8 & 0xF
}

#[test]
fn each_width_moves_its_bytes_and_steps_by_them() {
    for (size, bytes) in [(0, 1), (1, 2), (2, 4)] {
        let mut bus = channel(4, &[("PSIZE", 2), ("MSIZE", size)]);
        for beat in 0..4 {
            let expected = Beat { from: THERE, from_bytes: 4, to: HERE + beat * bytes, to_bytes: bytes };
            assert_eq!(bus.model.beat(2), expected);
            bus.model.count(2);
        }
    }
}

#[test]
fn dir_turns_the_transfer_round() {
    let bus = channel(4, &[("DIR", 1), ("PINC", 1)]);
    assert_eq!(bus.model.beat(2), Beat { from: HERE, from_bytes: 1, to: THERE, to_bytes: 1 });
}

#[test]
fn half_and_end_raise_their_flags_and_the_channel_stops() {
    let mut bus = channel(4, &[("HTIE", 1)]);
    let mut seen = Vec::new();
    for _ in 0..4 {
        assert!(bus.model.is_on(2));
        let last = bus.model.count(2);
        seen.push((flags(&mut bus), bus.read_at("CH.NDTR", 2), last));
    }
    // GIF 1, TCIF 2, HTIF 4.
    assert_eq!(seen, [(0, 3, None), (5, 2, Some(Mark::Half)), (5, 1, None), (7, 0, Some(Mark::End))]);
    assert!(!bus.model.is_on(2));
    assert!(bus.model.interrupts("CH3") && !bus.model.interrupts("CH2"));
    bus.write("IFCR", 4 << 8);
    assert_eq!(flags(&mut bus), 3);
    assert!(!bus.model.interrupts("CH3"), "the end is not enabled");
    bus.write("IFCR", 1 << 8);
    assert_eq!(flags(&mut bus), 0);
}

#[test]
fn a_circular_channel_starts_again() {
    let mut bus = channel(3, &[("CIRC", 1)]);
    for _ in 0..3 {
        bus.model.count(2);
    }
    assert_eq!((bus.read_at("CH.NDTR", 2), bus.model.beat(2).to), (3, HERE));
    assert!(bus.model.is_on(2));
}

#[test]
fn count_and_addresses_are_frozen_while_the_channel_is_on() {
    let mut bus = channel(3, &[]);
    for register in ["CH.NDTR", "CH.PAR", "CH.MAR"] {
        assert!(bus.write_at(register, 2, 8).unwrap_err().to_string().contains("is on"), "{register}");
    }
    bus.write_at("CH.CR", 2, 0).unwrap();
    bus.write_at("CH.NDTR", 2, 8).unwrap();
    assert_eq!(bus.read_at("CH.NDTR", 2), 8);
}

#[test]
fn a_transfer_error_stops_its_channel() {
    let mut bus = channel(3, &[("TEIE", 1)]);
    bus.model.fail(2);
    assert_eq!(flags(&mut bus), 9);
    assert!(bus.model.interrupts("CH3") && !bus.model.is_on(2));
}

#[test]
fn the_multiplexer_knows_who_has_a_request_number() {
    let mut bus = Bus::new(Dmamux::default());
    let receiver = Source { block: Block::Link, signal: "RX" };
    bus.write_at("CCR", 9, 34).unwrap();
    assert_eq!((bus.model.source(9), bus.model.source(0)), (Some(receiver), None));
    bus.write_at("CCR", 9, 0).unwrap();
    assert_eq!(bus.model.source(9), None);
    assert!(bus.refused("CCR", 1 << 16).contains("synchronisation"));
}
