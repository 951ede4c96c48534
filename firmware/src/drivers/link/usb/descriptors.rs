//! Descriptors: what the device says of itself (USB 2.0, 9.6; USB CDC 1.2, 5.2).

use embassy_stm32::uid::uid_hex;

use super::BUS_PACKET_BYTES;
use crate::board::NAME;

/// Endpoints by their addresses; the highest bit is set where they go to the host.
pub(super) const NOTIFICATIONS: u8 = 0x81;
/// Requests of our protocol.
pub(super) const FROM_HOST: u8 = 0x02;
/// Replies and events.
pub(super) const TO_HOST: u8 = 0x82;

/// Bytes of a notification: there are none, but the host looks for some.
pub(super) const NOTIFICATION_BYTES: u16 = 8;

/// For tests, of pid.codes: a product needs its own.
const VENDOR: u16 = 0x1209;
const PRODUCT: u16 = 0x0001;

const COMMUNICATIONS: u8 = 0x02;
const ABSTRACT_CONTROL_MODEL: u8 = 0x02;
const DATA: u8 = 0x0A;
const FUNCTIONAL: u8 = 0x24;
/// Kinds of endpoint.
const BULK: u8 = 2;
const INTERRUPT: u8 = 3;

/// Numbers of the strings.
const MANUFACTURER: u8 = 1;
const PRODUCT_NAME: u8 = 2;
const SERIAL_NUMBER: u8 = 3;

/// Languages of strings: English of the United States.
pub(super) static LANGUAGES: [u8; 4] = [4, 3, 0x09, 0x04];

/// The device: USB 2.00, of the communications class, version 1.00.
pub(super) static DEVICE: [u8; 18] = {
    let ([vendor, vendor_high], [product, product_high]) = (VENDOR.to_le_bytes(), PRODUCT.to_le_bytes());
    #[rustfmt::skip]
    let descriptor = [
        18, 1, 0x00, 0x02, COMMUNICATIONS, 0, 0, BUS_PACKET_BYTES as u8,
        vendor, vendor_high, product, product_high, 0x00, 0x01, MANUFACTURER, PRODUCT_NAME, SERIAL_NUMBER, 1,
    ];
    descriptor
};

/// Its one configuration: supplied by itself; interface 0 for control, interface 1 for data.
#[rustfmt::skip]
pub(super) static CONFIGURATION: [u8; 67] = [
    9, 2, 67, 0, 2, 1, 0, 0xC0, 0,
    9, 4, 0, 0, 1, COMMUNICATIONS, ABSTRACT_CONTROL_MODEL, 0, 0,
    // Header of CDC 1.20; no call management; line coding and control lines; interfaces 0 and 1 are one.
    5, FUNCTIONAL, 0x00, 0x20, 0x01,
    5, FUNCTIONAL, 0x01, 0x00, 1,
    4, FUNCTIONAL, 0x02, 0x02,
    5, FUNCTIONAL, 0x06, 0, 1,
    7, 5, NOTIFICATIONS, INTERRUPT, NOTIFICATION_BYTES as u8, 0, 255,
    9, 4, 1, 0, 2, DATA, 0, 0, 0,
    7, 5, FROM_HOST, BULK, BUS_PACKET_BYTES as u8, 0, 0,
    7, 5, TO_HOST, BULK, BUS_PACKET_BYTES as u8, 0, 0,
];

/// A string, in this memory; none has a character that takes more than one byte, or more characters than fit.
pub(super) fn string(number: u8, memory: &mut [u8; BUS_PACKET_BYTES]) -> Option<&[u8]> {
    let text = match number {
        MANUFACTURER => "Dermatome",
        PRODUCT_NAME => NAME,
        SERIAL_NUMBER => uid_hex(),
        _ => return None,
    };
    let length = 2 + 2 * text.len();
    let (descriptor, _) = memory.split_at_mut_checked(length)?;
    descriptor[..2].copy_from_slice(&[length as u8, 3]);
    for (place, character) in descriptor[2..].chunks_exact_mut(2).zip(text.bytes()) {
        place.copy_from_slice(&[character, 0]);
    }
    Some(descriptor)
}
