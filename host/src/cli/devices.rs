//! `dermatome devices`.

use crate::board::{SerialPort, serial_ports};
use serde::Serialize;

/// List the serial ports of this machine, likely boards first.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome devices\n  \
    dermatome devices --json devices.json")]
pub(super) struct Args {
    #[command(flatten)]
    json: super::JsonReport,
}

#[derive(Serialize)]
struct Report<'a> {
    ports: &'a [SerialPort],
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let ports = serial_ports()?;
    if ports.is_empty() {
        say!("no serial ports found");
    }
    for port in &ports {
        say!("{}", line(port));
    }
    args.json.write(&Report { ports: &ports })
}

fn line(port: &SerialPort) -> String {
    let mut line = port.port.clone();
    if let (Some(vendor), Some(product)) = (port.vendor_id, port.product_id) {
        line += &format!("  {vendor:04x}:{product:04x}");
    }
    for text in [&port.manufacturer, &port.product].into_iter().flatten() {
        line += &format!("  {text}");
    }
    line + if port.likely_board { "  <- likely a board" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_likely_board_stands_out() {
        let mut port = SerialPort {
            port: "COM5".to_owned(),
            likely_board: true,
            vendor_id: Some(0x0483),
            product_id: Some(0x374e),
            manufacturer: None,
            product: Some("STLINK-V3".to_owned()),
            serial_number: None,
        };
        assert_eq!(line(&port), "COM5  0483:374e  STLINK-V3  <- likely a board");
        port = SerialPort { likely_board: false, vendor_id: None, product: None, ..port };
        assert_eq!(line(&port), "COM5");
    }
}
