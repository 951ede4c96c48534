use super::{
    device::{Answer, Device, Stat, Wires},
    *,
};
use crate::chip::tests::bus::{Bus, nanos};

const EXACT: UsbClocks = UsbClocks { kernel: 48_000_000, is_exact: true, bus: 170_000_000 };
/// EPR: type control, bulk; states.
const CONTROL: u32 = 1 << 9;
const TX_NAK: u32 = 2 << 4;
const TX_VALID: u32 = 3 << 4;
const RX_NAK: u32 = 2 << 12;
const RX_VALID: u32 = 3 << 12;
/// EPR: neither flag is cleared.
const KEEP: u32 = 0x8080;

/// A device of address 3 that is on, with endpoint 0 and a bulk endpoint 2, each with buffers of 64 bytes.
fn device() -> Bus<Usb> {
    let mut bus = Bus::new(Usb::default());
    bus.model.run_at(EXACT);
    bus.write("CNTR", 1);
    bus.now = Time::from_micros(2);
    bus.write("CNTR", 0x9C00);
    bus.write("DADDR", 0x83);
    for endpoint in [0, 2] {
        let memory = &mut bus.model.device.memory;
        for (place, half) in [(0, 0x40), (2, 0), (4, 0x80), (6, 0x8400)] {
            memory.put_half(
                8 * endpoint + place,
                half + if place % 4 == 0 { 0x100 * endpoint as u16 } else { 0 },
            );
        }
        let kind = if endpoint == 0 { CONTROL } else { 2 };
        bus.write_at("EPR", endpoint, kind | TX_NAK | RX_NAK).unwrap();
    }
    bus
}

fn endpoint(bus: &mut Bus<Usb>, index: usize, field: &str) -> u32 {
    let value = bus.read_at("EPR", index);
    bus.model.bank().map.element("EPR", index).get(value, field)
}

fn inner(bus: &mut Bus<Usb>) -> &mut Device {
    &mut bus.model.device
}

#[test]
fn a_setup_is_taken_though_both_directions_refuse() {
    let mut bus = device();
    let setup = [0x80, 6, 0, 1, 0, 0, 18, 0];
    assert_eq!(inner(&mut bus).setup(3, setup), Ok(Answer::Ack));
    assert_eq!(inner(&mut bus).memory.read(0x80, 8), setup);
    assert_eq!(inner(&mut bus).memory.half(6) & 0x3FF, 8);
    let fields = ["SETUP", "CTR_RX", "STAT_RX", "STAT_TX", "DTOG_RX", "DTOG_TX"]
        .map(|field| endpoint(&mut bus, 0, field));
    assert_eq!(fields, [1, 1, 2, 2, 1, 1], "data begins with DATA1");
    assert_eq!((bus.get("ISTR", "CTR"), bus.get("ISTR", "EP_ID"), bus.get("ISTR", "DIR")), (1, 0, 1));
    assert!(bus.model.interrupts("LP") && !bus.model.interrupts("HP"));
    // Zeros clear both flags and leave the rest.
    bus.write_at("EPR", 0, CONTROL).unwrap();
    assert!(!bus.model.interrupts("LP"));
    assert_eq!(endpoint(&mut bus, 0, "STAT_RX"), 2);
}

#[test]
fn a_packet_goes_out_once_and_its_toggle_turns() {
    let mut bus = device();
    assert_eq!(inner(&mut bus).asked(3, 2), Answer::Nak);
    inner(&mut bus).memory.put(0x240, &[1, 2, 3]);
    inner(&mut bus).memory.put_half(0x12, 3);
    bus.write_at("EPR", 2, 2 | KEEP | (TX_NAK ^ TX_VALID)).unwrap();
    assert_eq!(inner(&mut bus).asked(3, 2), Answer::Data(false, vec![1, 2, 3]));
    assert_eq!(inner(&mut bus).asked(4, 2), Answer::Silence, "to another device");
    assert_eq!(inner(&mut bus).asked(3, 2), Answer::Data(false, vec![1, 2, 3]), "until the host has got it");
    inner(&mut bus).sent(3, 2);
    assert_eq!(inner(&mut bus).asked(3, 2), Answer::Nak);
    assert_eq!(["CTR_TX", "DTOG_TX"].map(|field| endpoint(&mut bus, 2, field)), [1, 1]);
    assert_eq!((bus.get("ISTR", "EP_ID"), bus.get("ISTR", "DIR")), (2, 0));
}

#[test]
fn a_packet_of_the_wrong_toggle_is_acknowledged_and_lost() {
    let mut bus = device();
    bus.write_at("EPR", 2, 2 | KEEP | (RX_NAK ^ RX_VALID)).unwrap();
    assert_eq!(inner(&mut bus).out(3, 2, true, &[7; 5]), Ok(Answer::Ack));
    assert_eq!(["CTR_RX", "STAT_RX"].map(|field| endpoint(&mut bus, 2, field)), [0, 3]);
    assert_eq!(inner(&mut bus).out(3, 2, false, &[7; 5]), Ok(Answer::Ack));
    assert_eq!(["CTR_RX", "STAT_RX", "DTOG_RX"].map(|field| endpoint(&mut bus, 2, field)), [1, 2, 1]);
    assert_eq!(inner(&mut bus).memory.read(0x280, 5), [7; 5]);
    assert_eq!(inner(&mut bus).out(3, 2, true, &[8; 5]), Ok(Answer::Nak), "the first is not read yet");
    let error = {
        bus.write_at("EPR", 2, 2 | 0x80 | (RX_NAK ^ RX_VALID)).unwrap();
        inner(&mut bus).out(3, 2, true, &[8; 65]).unwrap_err().to_string()
    };
    assert!(error.contains("65 bytes comes to endpoint 2, whose buffer has 64"), "{error}");
}

#[test]
fn ones_turn_toggles_and_states_and_stalls_answer() {
    let mut bus = device();
    bus.write_at("EPR", 2, 2 | KEEP | 0x4040 | (TX_NAK ^ 1 << 4) | (RX_NAK ^ 1 << 12)).unwrap();
    assert_eq!(["DTOG_RX", "DTOG_TX"].map(|field| endpoint(&mut bus, 2, field)), [1, 1]);
    assert_eq!(inner(&mut bus).asked(3, 2), Answer::Stall);
    assert_eq!(inner(&mut bus).out(3, 2, true, &[]), Ok(Answer::Stall));
    assert_eq!(Stat::of(inner(&mut bus), 2, "STAT_RX"), Stat::Stall);
}

#[test]
fn a_reset_of_the_bus_disables_all_but_what_was_told() {
    let mut bus = device();
    inner(&mut bus).setup(3, [0; 8]).unwrap();
    let now = bus.now;
    inner(&mut bus).see(Wires::Low, now);
    assert_eq!([0, 2].map(|index| bus.read_at("EPR", index)), [0x8000, 0]);
    assert_eq!((bus.read("DADDR"), bus.get("ISTR", "RESET")), (0, 1));
    assert_eq!(inner(&mut bus).setup(0, [0; 8]), Ok(Answer::Silence));
    // However long it is, it is no rest.
    bus.pass(Time::from_millis(50));
    assert_eq!(bus.get("ISTR", "SUSP"), 0);
    bus.write("ISTR", 0xFFFF_FBFF);
    assert_eq!(bus.get("ISTR", "RESET"), 0, "a zero clears it");
}

#[test]
fn three_frames_without_a_start_are_rest_and_the_host_wakes_it() {
    let mut bus = device();
    let now = bus.now;
    inner(&mut bus).start_of_frame(77, now);
    inner(&mut bus).start_of_frame(78, now);
    assert_eq!((bus.get("FNR", "FN_"), bus.get("FNR", "LCK"), bus.get("ISTR", "SOF")), (78, 1, 1));
    bus.pass(Time::from_micros(2_900));
    assert_eq!((bus.get("ISTR", "ESOF"), bus.get("FNR", "LSOF"), bus.get("ISTR", "SUSP")), (1, 2, 0));
    bus.pass(Time::from_micros(200));
    assert_eq!(bus.get("ISTR", "SUSP"), 1);
    bus.write("CNTR", 0x9C0C);
    bus.write("ISTR", 0);
    assert_eq!(inner(&mut bus).setup(3, [0; 8]), Ok(Answer::Silence), "it sleeps");
    let now = bus.now;
    inner(&mut bus).see(Wires::K, now);
    assert_eq!((bus.get("ISTR", "WKUP"), bus.get("FNR", "RXDM")), (1, 1));
}

#[test]
fn what_is_to_be_sent_is_not_touched() {
    let mut bus = device();
    inner(&mut bus).memory.put_half(0x12, 4);
    bus.write_at("EPR", 2, 2 | KEEP | (TX_NAK ^ TX_VALID)).unwrap();
    let at = bus.moment();
    let mut write = |place: usize| {
        let memory = bus.model.memory_mut();
        let register = memory.bank().map.element("MEM", place / 4 * 2);
        memory.write(register, 0x1234_5678, at)
    };
    assert_eq!(write(0x250), Ok(()));
    for place in [0x240, 0x10] {
        assert!(write(place).unwrap_err().to_string().contains("while endpoint 2 may use it"), "{place:#x}");
    }
}

#[test]
fn the_transceiver_has_its_time_and_the_clock_is_exact() {
    let mut bus = Bus::new(Usb::default());
    bus.write("CNTR", 1);
    bus.now = nanos(900);
    assert!(bus.refused("CNTR", 0x9C00).contains("1 us after CNTR.PDWN"));
    for (clocks, word) in [
        (UsbClocks { kernel: 0, ..EXACT }, "0 Hz, not 48 MHz"),
        (UsbClocks { is_exact: false, ..EXACT }, "trimmed"),
        (UsbClocks { bus: 8_000_000, ..EXACT }, "APB1 runs at 8000000 Hz"),
    ] {
        bus.model.run_at(clocks);
        assert!(inner(&mut bus).check_clocks().unwrap_err().to_string().contains(word));
    }
}

#[test]
fn what_is_not_modelled_is_refused() {
    for value in [3 | 2 << 9 | TX_VALID, 3 | 1 << 8 | TX_VALID] {
        let error = device().write_at("EPR", 3, value).unwrap_err().to_string();
        assert!(error.contains("isochronous and double-buffered"), "{error}");
    }
    let mut bus = device();
    assert!(bus.refused("CNTR", 0x9C10).contains("waking the host"));
    assert!(bus.refused("BCDR", 1).contains("detection of chargers"));
    assert!(!bus.model.models(bus.model.bank().map.register("LPMCSR")));
    let mut off = Bus::new(Usb::default());
    assert!(
        off.write_at("EPR", 0, CONTROL).unwrap_err().to_string().contains("while CNTR.FRES or PDWN is 1")
    );
    // A buffer beyond the memory's end.
    inner(&mut bus).memory.put_half(0x10, 1022);
    inner(&mut bus).memory.put_half(0x12, 4);
    let error = bus.write_at("EPR", 2, 2 | KEEP | (TX_NAK ^ TX_VALID)).unwrap_err().to_string();
    assert!(error.contains("a buffer at 0x3fe of 4 bytes"), "{error}");
}

#[test]
fn packet_memory_takes_half_words_and_needs_the_clock() {
    let mut chip = crate::chip::Chip::new(2_000_000, false);
    let map = crate::chip::map::Map::of_chip();
    let (rcc, memory) = (map.peripheral("RCC"), map.peripheral("USBRAM").base);
    let error = chip.write(memory, 2, 1).unwrap_err().to_string();
    assert!(error.contains("USBRAM.MEM is used while RCC.APB1ENR1.USBEN is 0"), "{error}");
    let enable = rcc.register("APB1ENR1");
    chip.write(rcc.base + enable.offset, 4, enable.mask("USBEN")).unwrap();
    chip.write(memory + 6, 2, 0xABCD).unwrap();
    assert_eq!(
        (chip.read(memory + 6, 2), chip.read(memory + 7, 1), chip.read(memory + 4, 2)),
        (Ok(0xABCD), Ok(0xAB), Ok(0))
    );
    let word = |result: Result<u32, Misuse>| result.unwrap_err().to_string();
    assert!(word(chip.read(memory, 4)).contains("accessed by words"));
    assert!(word(chip.write(memory, 4, 0).map(|()| 0)).contains("accessed by words"));
}
