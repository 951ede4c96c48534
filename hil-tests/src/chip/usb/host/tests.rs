use super::*;
use crate::chip::{
    peripheral::{Moment, Peripheral},
    tests::bus::Bus,
    usb::{Usb, UsbClocks},
};

/// A host whose program has the port of a configured device open, whose endpoint 2 is on.
fn open() -> Bus<Usb> {
    let mut bus = Bus::new(Usb::default());
    bus.model.run_at(UsbClocks { kernel: 48_000_000, is_exact: true, bus: 170_000_000 });
    bus.write("CNTR", 1);
    bus.now = Time::from_micros(2);
    bus.write("CNTR", 0x9C00);
    bus.write("DADDR", 0x80 | u32::from(ADDRESS));
    for (place, half) in [(0x10, 0x240), (0x12, 64), (0x14, 0x280), (0x16, 0x8400)] {
        bus.model.device.memory.put_half(place, half);
    }
    bus.write_at("EPR", 2, 0x2022).unwrap();
    let host = &mut bus.model.host;
    (host.is_plugged, host.sees_device, host.phase) = (true, true, Phase::Running);
    (host.is_configured, host.address, host.frame_started) = (true, ADDRESS, bus.now);
    host.port.open();
    bus.write("BCDR", 0x8000);
    bus
}

/// Lets time pass with a firmware that is always ready.
fn serve(bus: &mut Bus<Usb>, until: Time) {
    while bus.now < until {
        let next = bus.model.next_event().max(bus.now);
        bus.now = next;
        let at = Moment { now: next, ..bus.moment() };
        bus.model.advance(at).unwrap();
        let state = bus.read_at("EPR", 2);
        // Each direction that refuses is made ready; what was told is cleared.
        let ready =
            [4, 12].into_iter().filter(|shift| state >> shift & 3 == 2).map(|shift| 1 << shift).sum::<u32>();
        bus.write_at("EPR", 2, 2 | ready).unwrap();
    }
}

#[test]
fn as_many_packets_fit_a_frame_as_the_standard_says() {
    let mut bus = open();
    bus.model.host.write(&[5; 20_000]);
    serve(&mut bus, Time::from_millis(10));
    assert_eq!(bus.model.host.take_most_packets(), 19);
    let (left, read) = (bus.model.host.port.to_board.len(), bus.model.host.take_read().len());
    assert!((13_000..15_500).contains(&left), "{left} bytes are still to be sent");
    // Two full packets make what the driver asked for.
    assert!(read % 128 == 0 && (4_500..7_000).contains(&read), "{read} bytes have come");
    assert_eq!(bus.model.host.repeated(), 0);
}

#[test]
fn one_direction_alone_meets_a_refusal_after_each_packet() {
    let mut bus = open();
    serve(&mut bus, Time::from_millis(10));
    // 51 us for a packet, 6 for the refusal, and 10 until it is asked for again.
    assert_eq!(bus.model.host.take_most_packets(), 15);
}

#[test]
fn what_the_program_gets_ends_with_a_short_packet() {
    let mut bus = open();
    // One full packet, and then nothing: the driver waits for more.
    bus.write_at("EPR", 2, 0x8092).unwrap();
    bus.pass(Time::from_millis(2));
    assert!(!bus.model.host.has_read());
    bus.model.device.memory.put_half(0x12, 0);
    bus.write_at("EPR", 2, 0x8092).unwrap();
    bus.pass(Time::from_millis(2));
    assert_eq!(bus.model.host.take_read().len(), 64);
}

#[test]
fn a_toggle_that_does_not_turn_loses_a_packet() {
    let mut bus = open();
    bus.model.device.memory.put_half(0x12, 3);
    bus.write_at("EPR", 2, 0x8092).unwrap();
    bus.pass(Time::from_millis(2));
    assert_eq!(bus.model.host.take_read().len(), 3);
    // The firmware turns it back: the host takes the next packet for the one that it has.
    bus.write_at("EPR", 2, 0x80D2).unwrap();
    bus.pass(Time::from_millis(2));
    assert_eq!((bus.model.host.take_read().len(), bus.model.host.repeated()), (0, 1));
}

#[test]
fn a_cable_that_comes_out_takes_the_port_along() {
    let mut bus = open();
    let now = bus.now;
    bus.model.host.unplug(now);
    bus.pass(Time::from_millis(1));
    assert!(!bus.model.host.has_port() && !bus.model.host.is_open());
    bus.pass(Time::from_millis(3));
    assert_eq!(bus.get("ISTR", "SUSP"), 1, "there are no frames any more");
    let now = bus.now;
    bus.model.host.plug(now);
    bus.pass(Time::from_millis(99));
    assert_eq!(bus.get("ISTR", "RESET"), 0);
    bus.pass(Time::from_millis(2));
    assert_eq!(bus.get("ISTR", "RESET"), 1);
}

#[test]
fn a_device_that_never_answers_is_given_up() {
    let mut bus = open();
    let now = bus.now;
    bus.model.host.reset_bus(now);
    bus.pass(Time::from_millis(400));
    assert_eq!(bus.model.host.problems(), [Refused::Silence; 3]);
    assert!(!bus.model.host.has_port());
}
