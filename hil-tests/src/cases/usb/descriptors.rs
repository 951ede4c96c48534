//! What the board says of itself, against USB 2.0 (chapter 9) and CDC 1.2 (5.2 and 6.3).

use super::{Failure, ToDevice, VirtualBoard, ensure, host};
use crate::{
    chip::{
        time::Time,
        usb::host::{Described, Refused},
    },
    rig::Rig,
};
use std::collections::BTreeMap;

/// Kinds of descriptors.
const INTERFACE: u8 = 4;
const ENDPOINT: u8 = 5;
const FUNCTIONAL: u8 = 0x24;

pub(super) fn enumerates(rig: &Rig) -> Result<String, Failure> {
    let board = rig.emulated();
    board.run(Time::from_millis(600))?;
    let (problems, described, enumerations) =
        host(board, |host, _| (host.problems().to_vec(), host.described().clone(), host.enumerations()));
    ensure(problems.is_empty() && enumerations == 1, || format!("{problems:?}"))?;
    check_device(&described)?;
    check_configuration(&described.configuration)?;
    check_requests(board)?;
    Ok(described.strings.join(", "))
}

fn check_device(described: &Described) -> Result<(), Failure> {
    let &[18, 1, 0x00, 0x02, class, subclass, protocol, 64, ..] = &described.device[..] else {
        return Err(Failure::wrong(format!("descriptor of the device: {:x?}", described.device)));
    };
    ensure((class, subclass, protocol) == (2, 0, 0), || format!("class {class}, {subclass}, {protocol}"))?;
    ensure(described.device[8..12] == [0x09, 0x12, 0x01, 0x00], || "vendor and product".to_owned())?;
    ensure(described.device[17] == 1, || "one configuration".to_owned())?;
    let [manufacturer, product, serial] = &described.strings[..] else {
        return Err(Failure::wrong(format!("{:?}", described.strings)));
    };
    ensure(manufacturer == "Dermatome" && product == "nucleo-g474re-usb", || {
        format!("{manufacturer} {product}")
    })?;
    // The chip's 96 bits.
    let is_number = serial.len() == 24 && serial.chars().all(|letter| letter.is_ascii_hexdigit());
    ensure(is_number, || format!("serial number {serial}"))
}

fn check_configuration(bytes: &[u8]) -> Result<(), Failure> {
    let wrong = |what: &str| Failure::wrong(format!("{what}: {bytes:x?}"));
    let &[9, 2, low, high, interfaces, number, 0, attributes, power, ..] = bytes else {
        return Err(wrong("configuration"));
    };
    ensure(usize::from(u16::from_le_bytes([low, high])) == bytes.len(), || "total length".to_owned())?;
    // Supplied by itself: it takes nothing of the bus, and does not wake the host.
    ensure((interfaces, number, attributes, power) == (2, 1, 0xC0, 0), || "configuration".to_owned())?;
    let mut rest = &bytes[9..];
    let (mut of_interface, mut functional, mut endpoints) = (Vec::new(), Vec::new(), BTreeMap::new());
    while let Some((&length, _)) = rest.split_first() {
        let Some((descriptor, after)) = rest.split_at_checked(length.max(2).into()) else {
            return Err(wrong("a descriptor is longer than all"));
        };
        rest = after;
        match *descriptor {
            [9, INTERFACE, number, 0, endpoints, class, subclass, protocol, _] => {
                of_interface.push([number, endpoints, class, subclass, protocol]);
            }
            [7, ENDPOINT, address, kind, low, high, interval] => {
                endpoints.insert(address, (kind, u16::from_le_bytes([low, high]), interval));
            }
            [_, FUNCTIONAL, ..] if of_interface.len() == 1 => functional.push(descriptor[2..].to_vec()),
            _ => return Err(wrong("a descriptor that is not known")),
        }
    }
    ensure(of_interface == [[0, 1, 2, 2, 0], [1, 2, 0x0A, 0, 0]], || format!("interfaces {of_interface:?}"))?;
    // Header, call management, abstract control model, union; the header is the first.
    let expected = [vec![0, 0x20, 0x01], vec![1, 0, 1], vec![2, 2], vec![6, 0, 1]];
    ensure(functional == expected, || format!("functional descriptors {functional:x?}"))?;
    ensure(
        endpoints.get(&0x81).is_some_and(|&(kind, bytes, interval)| kind == 3 && bytes <= 64 && interval > 0),
        || "endpoint of notifications".to_owned(),
    )?;
    for bulk in [0x02, 0x82] {
        ensure(endpoints.get(&bulk).is_some_and(|&(kind, bytes, _)| (kind, bytes) == (2, 64)), || {
            format!("endpoint {bulk:#x}")
        })?;
    }
    Ok(())
}

/// What any host may ask, and what it is refused.
fn check_requests(board: &VirtualBoard) -> Result<(), Failure> {
    let get = |kind, number, length| ToDevice::new(0x80, 6, u16::from_le_bytes([number, kind]), 0, length);
    let coding = [0x80, 0x25, 0, 0, 2, 1, 7];
    let answered = [
        (ToDevice::new(0x80, 0, 0, 0, 2), vec![1, 0]),
        (ToDevice::new(0x81, 0, 0, 1, 2), vec![0, 0]),
        (ToDevice::new(0x82, 0, 0, 0x82, 2), vec![0, 0]),
        (ToDevice::new(0x82, 0, 0, 0, 2), vec![0, 0]),
        (ToDevice::new(0x80, 8, 0, 0, 1), vec![1]),
        (ToDevice::new(0x81, 10, 0, 1, 1), vec![0]),
        (ToDevice::new(0x01, 11, 0, 1, 0), vec![]),
        (get(1, 0, 8), vec![18, 1, 0, 2, 2, 0, 0, 64]),
        // As much as a packet holds, and no empty one after it.
        (get(2, 0, 64), host(board, |host, _| host.described().configuration[..64].to_vec())),
        (get(1, 0, 0), vec![]),
        (ToDevice::with(0x21, 0x20, 0, 0, &coding), vec![]),
        (ToDevice::new(0xA1, 0x21, 0, 0, 7), coding.to_vec()),
    ];
    let refused = [
        // Descriptors of devices that know high speed, of BOS, of a string and a configuration that there is not.
        get(6, 0, 10),
        get(15, 0, 5),
        get(3, 4, 255),
        get(2, 1, 9),
        ToDevice::new(0x00, 9, 2, 0, 0),
        ToDevice::new(0x01, 11, 1, 1, 0),
        ToDevice::new(0x82, 0, 0, 0x83, 2),
        // To wake the host, to break, and of a vendor.
        ToDevice::new(0x00, 3, 1, 0, 0),
        ToDevice::new(0x21, 0x23, 0, 0, 0),
        ToDevice::new(0xC0, 1, 0, 0, 4),
        ToDevice::with(0x21, 0x20, 0, 0, &[0; 64]),
    ];
    let results = answered.into_iter().map(|(request, answer)| (request, Ok(answer)));
    let refusals = refused.into_iter().map(|request| (request, Err(Refused::Stall)));
    for (request, expected) in results.chain(refusals) {
        let asked = request.clone();
        host(board, |host, _| host.ask(asked));
        board.run(Time::from_millis(3))?;
        let answers = host(board, |host, _| host.take_answers());
        ensure(answers == [expected], || format!("{request:x?}: {answers:x?}"))?;
    }
    Ok(())
}
