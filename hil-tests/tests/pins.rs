//! The pin table of docs/hardware.md against the chip's own description.

use std::{collections::BTreeSet, path::Path};
use stm32_metapac::metadata::METADATA;

/// Pin and peripheral of each row of the table.
fn rows() -> Vec<(String, String)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/hardware.md");
    let text = std::fs::read_to_string(path).unwrap();
    let (_, after) = text.split_once("<!-- pins: begin -->\n").expect("the table's begin");
    let (table, _) = after.split_once("<!-- pins: end -->").expect("the table's end");
    let cells = |row: &str| row.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    table.lines().skip(2).map(cells).map(|row| (row[1].clone(), row[3].clone())).collect()
}

/// Whether the chip has this: "GPIO output", "TIM3_CH1, AF2" or "DAC1_OUT1, analogue".
fn exists(pin: &str, peripheral: &str) -> bool {
    let Some((function, kind)) = peripheral.split_once(", ") else {
        return peripheral == "GPIO output" && METADATA.pins.iter().any(|known| known.name == pin);
    };
    let af = kind.strip_prefix("AF").map(|number| number.parse::<u8>().unwrap());
    assert!(
        af.is_some() || kind == "analogue",
        "{pin}: `{kind}` is neither analogue nor an alternate function"
    );
    let (name, signal) = function.split_once('_').unwrap();
    METADATA
        .peripherals
        .iter()
        .filter(|known| known.name == name)
        .flat_map(|known| known.pins)
        .any(|known| known.pin == pin && known.signal == signal && known.af == af)
}

#[test]
fn every_pin_can_do_what_the_table_says() {
    for (pin, peripheral) in rows() {
        assert!(exists(&pin, &peripheral), "{pin} has no {peripheral}");
    }
}

#[test]
fn no_pin_is_used_twice_and_port_b_is_all_addresses() {
    let rows = rows();
    let pins: BTreeSet<_> = rows.iter().map(|(pin, _)| pin.clone()).collect();
    assert_eq!(pins.len(), rows.len());
    let port: BTreeSet<_> = rows.iter().filter(|(pin, _)| pin.starts_with("PB")).cloned().collect();
    let whole = (0..16).map(|bit| (format!("PB{bit}"), "GPIO output".to_owned())).collect();
    assert_eq!(port, whole);
}
