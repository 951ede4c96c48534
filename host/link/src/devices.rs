//! Devices: the serial ports of this machine, and which of them look like boards.

use crate::words::escaped;
use serialport::SerialPortType;
use std::path::Path;

/// USB vendor number of STMicroelectronics, whose debug adapter is the link of reference boards.
const ST_VENDOR: u16 = 0x0483;
/// USB vendor and product number of boards on their own USB: pid.codes' pair for tests.
const OWN_USB: (u16, u16) = (0x1209, 0x0001);

/// A serial port of this machine.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct SerialPort {
    /// Name to open it by.
    pub port: String,
    /// Whether what is plugged in looks like a Dermatome board.
    pub likely_board: bool,
    /// USB vendor number.
    pub vendor_id: Option<u16>,
    /// USB product number.
    pub product_id: Option<u16>,
    /// Manufacturer, as the device says.
    pub manufacturer: Option<String>,
    /// Product, as the device says.
    pub product: Option<String>,
    /// Serial number, as the device says.
    pub serial_number: Option<String>,
}

/// The system could not list its serial ports.
#[derive(Debug, thiserror::Error)]
#[error("cannot list the serial ports: {reason}")]
pub struct ListError {
    reason: String,
}

/// The serial ports of this machine, likely boards first.
pub fn serial_ports() -> Result<Vec<SerialPort>, ListError> {
    // There the `serialport` crate would panic.
    if cfg!(target_os = "linux") && !Path::new("/sys/class/tty").is_dir() {
        return Err(ListError { reason: "/sys/class/tty is missing".to_owned() });
    }
    let found = serialport::available_ports().map_err(|error| ListError { reason: error.to_string() })?;
    let mut ports: Vec<_> = found.into_iter().map(SerialPort::from).collect();
    ports.sort_by(|a, b| (!a.likely_board, &a.port).cmp(&(!b.likely_board, &b.port)));
    Ok(ports)
}

impl From<serialport::SerialPortInfo> for SerialPort {
    fn from(info: serialport::SerialPortInfo) -> Self {
        let usb = match info.port_type {
            SerialPortType::UsbPort(usb) => Some(usb),
            _ => None,
        };
        let text = |pick: fn(&serialport::UsbPortInfo) -> &Option<String>| {
            usb.as_ref().and_then(|usb| pick(usb).as_deref().map(escaped))
        };
        let product = text(|usb| &usb.product);
        let manufacturer = text(|usb| &usb.manufacturer);
        let (vendor_id, product_id) = (usb.as_ref().map(|usb| usb.vid), usb.as_ref().map(|usb| usb.pid));
        Self {
            likely_board: is_likely_board(
                vendor_id.zip(product_id),
                [manufacturer.as_deref(), product.as_deref()],
            ),
            port: info.port_name,
            vendor_id,
            product_id,
            manufacturer,
            serial_number: text(|usb| &usb.serial_number),
            product,
        }
    }
}

/// By vendor and product number, and what both are called. Windows tells no names but its own.
fn is_likely_board(ids: Option<(u16, u16)>, names: [Option<&str>; 2]) -> bool {
    let named = names.into_iter().flatten().any(|name| {
        let name = name.to_lowercase();
        ["st-link", "stlink", "dermatome"].iter().any(|known| name.contains(known))
    });
    named || ids.is_some_and(|ids| ids.0 == ST_VENDOR || ids == OWN_USB)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serialport::{SerialPortInfo, UsbPortInfo};

    #[test]
    fn a_debug_adapter_is_a_likely_board_and_a_modem_is_not() {
        assert!(is_likely_board(Some((0x0483, 0x374E)), [None, None]));
        assert!(is_likely_board(Some((0x1234, 1)), [None, Some("Dermatome skin")]));
        assert!(!is_likely_board(Some((0x2341, 1)), [Some("Arduino"), Some("Arduino Uno")]));
        assert!(!is_likely_board(None, [None, None]));
    }

    #[test]
    fn a_board_on_its_own_usb_is_a_likely_board_by_either_name_or_number() {
        let test_pair = Some((0x1209, 0x0001));
        assert!(is_likely_board(test_pair, [Some("Dermatome"), Some("nucleo-g474re-usb")]));
        assert!(is_likely_board(test_pair, [Some("Microsoft"), Some("USB Serial Device (COM5)")]));
        assert!(is_likely_board(Some((0x1234, 5)), [Some("Dermatome"), Some("nucleo-g474re-usb")]));
        assert!(!is_likely_board(Some((0x1209, 0x2303)), [Some("Generic"), Some("Gadget")]));
    }

    #[test]
    fn what_usb_tells_is_kept() {
        let usb = UsbPortInfo {
            vid: 0x0483,
            pid: 0x374E,
            serial_number: Some("0042".to_owned()),
            manufacturer: Some("STMicroelectronics".to_owned()),
            product: Some("STLINK-V3".to_owned()),
        };
        let info =
            SerialPortInfo { port_name: "/dev/ttyACM0".to_owned(), port_type: SerialPortType::UsbPort(usb) };
        let port = SerialPort::from(info);
        assert!(port.likely_board);
        assert_eq!((port.vendor_id, port.product_id), (Some(0x0483), Some(0x374E)));
        assert_eq!(port.product.as_deref(), Some("STLINK-V3"));
        assert_eq!(port.serial_number.as_deref(), Some("0042"));
    }
}
