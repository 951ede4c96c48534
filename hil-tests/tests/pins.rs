//! The pin table of docs/hardware.md against the chip's own description, and against the firmware's board.

use std::{collections::BTreeSet, path::Path};
use stm32_metapac::metadata::METADATA;

fn read(path: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    std::fs::read_to_string(root.join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Pins that a board of the firmware uses: those that its source names as types, which alone can be handed to
/// a driver, and all of the one port that it names.
fn pins_of(board: &str, files: &[&str]) -> BTreeSet<String> {
    let source: String =
        files.iter().map(|file| read(&format!("firmware/src/board/{board}/{file}"))).collect();
    let named = named(&source);
    let ports: BTreeSet<_> = after(&source, "pac::GPIO").collect();
    assert_eq!(ports.len(), 1, "{board}: the multiplexers have one port: {ports:?}");
    let whole = ports.iter().flat_map(|port| (0..16).map(move |bit| format!("P{port}{bit}")));
    named.into_iter().chain(whole).collect()
}

/// Pins that a type names, and those that a board takes as they are.
fn named(source: &str) -> BTreeSet<String> {
    let taken = ["peripherals::", "chip."].into_iter().flat_map(|prefix| after(source, prefix));
    taken.filter(|name| is_pin(name)).map(str::to_owned).collect()
}

/// The names that follow a prefix.
fn after<'a>(source: &'a str, prefix: &'a str) -> impl Iterator<Item = &'a str> {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    source.split(prefix).skip(1).map(move |rest| rest.split(|c| !is_name(c)).next().unwrap_or(rest))
}

/// `PA0` to `PK15`.
fn is_pin(name: &str) -> bool {
    let Some(place) = name.strip_prefix('P') else { return false };
    place.starts_with(|c: char| ('A'..='K').contains(&c))
        && place.get(1..).is_some_and(|bit| bit.parse::<u8>().is_ok_and(|bit| bit < 16))
}

/// Pin and peripheral of each row of the board's table.
fn rows() -> Vec<(String, String)> {
    rows_of("pins")
}

/// Where boards share a line or a bus: what its table of what is other is called, and the file of the link.
const SHARED: [(&str, &str); 2] = [("rs485 pins", "link_rs485.rs"), ("can pins", "link_can.rs")];

/// The same of a link over USB.
fn rows_on_usb() -> Vec<(String, String)> {
    rows_of("usb pins")
}

fn rows_of(name: &str) -> Vec<(String, String)> {
    let text = read("docs/hardware.md");
    let (_, after) = text.split_once(&format!("<!-- {name}: begin -->\n")).expect("the table's begin");
    let (table, _) = after.split_once(&format!("<!-- {name}: end -->")).expect("the table's end");
    let cells = |row: &str| row.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    table.lines().skip(2).map(cells).map(|row| (row[1].clone(), row[3].clone())).collect()
}

/// Whether the chip has this: "GPIO output", "TIM3_CH1, AF2" or "DAC1_OUT1, analogue".
fn exists(pin: &str, peripheral: &str) -> bool {
    let Some((function, kind)) = peripheral.split_once(", ") else {
        return ["GPIO output", "GPIO input"].contains(&peripheral)
            && METADATA.pins.iter().any(|known| known.name == pin);
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
    let others = SHARED.into_iter().flat_map(|(table, _)| rows_of(table));
    for (pin, peripheral) in rows().into_iter().chain(others).chain(rows_on_usb()) {
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

#[test]
fn the_firmware_uses_the_pins_of_the_table_and_no_others() {
    let table: BTreeSet<_> = rows().into_iter().map(|(pin, _)| pin).collect();
    assert_eq!(pins_of("nucleo_g474re", &["mod.rs", "sensing.rs", "link.rs"]), table);
}

#[test]
fn on_a_bus_the_link_has_pins_that_are_free_and_all_else_stays() {
    let table: BTreeSet<_> = rows().into_iter().map(|(pin, _)| pin).collect();
    let common = pins_of("nucleo_g474re", &["mod.rs", "sensing.rs"]);
    for (name, file) in SHARED {
        let on_a_bus = rows_of(name);
        let pins: BTreeSet<_> = on_a_bus.iter().map(|(pin, _)| pin.clone()).collect();
        assert_eq!(pins.len(), on_a_bus.len());
        assert!(pins.is_disjoint(&table) && common.is_disjoint(&pins));
        // High, they would switch the pull-downs of USB-C's pins on, which are addresses.
        assert!(["PA9", "PA10"].iter().all(|pin| !pins.contains(*pin)));
        let source = |file| read(&format!("firmware/src/board/nucleo_g474re/{file}"));
        assert_eq!(named(&(source(file) + &source("straps.rs"))), pins);
    }
    let link: BTreeSet<_> = table.difference(&common).map(String::as_str).collect();
    assert_eq!(link, BTreeSet::from(["PA2", "PA3"]), "the other link's");
}

#[test]
fn on_usb_the_link_has_its_two_pins_and_all_else_stays() {
    let pins: BTreeSet<_> = rows_on_usb().into_iter().map(|(pin, _)| pin).collect();
    assert_eq!(pins, BTreeSet::from(["PA11", "PA12"].map(str::to_owned)));
    assert_eq!(named(&read("firmware/src/board/nucleo_g474re/link_usb.rs")), pins);
    assert!(pins_of("nucleo_g474re", &["mod.rs", "sensing.rs"]).is_disjoint(&pins));
}

#[test]
fn the_second_board_uses_another_port_and_its_own_link() {
    let pins = pins_of("nucleo_l496zg", &["mod.rs", "sensing.rs"]);
    let others: Vec<_> = pins.iter().filter(|pin| !pin.starts_with("PF")).map(String::as_str).collect();
    assert_eq!(others, ["PA4", "PA7", "PC0", "PC1", "PC2", "PC3", "PC6", "PC8", "PG7", "PG8"]);
    assert_eq!(pins.len() - others.len(), 16);
}
