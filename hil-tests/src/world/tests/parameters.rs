use super::analogue;
use crate::world::Analogue;
use std::path::Path;

fn text() -> String {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/rigs/analogue.toml")).unwrap()
}

#[test]
fn the_rigs_front_ends_are_read_in_si_units() {
    let parts = analogue();
    assert!((parts.source.full_current() - 1e-3).abs() < 1e-5);
    assert!((parts.in_range(true).source.full_current() - 28.73e-6).abs() < 1e-8);
    assert_eq!((parts.in_range(false).source, parts.ranges.switching), (parts.source, 0.5e-3));
    assert!((parts.dac.lsb - 3.3 / 4096.0).abs() < 1e-12);
    assert!((parts.adc.noise - 0.8 * 3.3 / 4096.0).abs() < 1e-9);
    assert!((parts.amplifier.common_mode - 10_f64.powf(-82.0 / 20.0)).abs() < 1e-12);
    let cheap = concat!(env!("CARGO_MANIFEST_DIR"), "/rigs/analogue-cheap.toml");
    Analogue::load(Path::new(cheap)).unwrap();
}

#[test]
fn wrong_values_are_refused_with_file_field_value_and_what_is_allowed() {
    for (from, to, parts) in [
        ("\"200 ohm\"", "\"200 mm\"", ["multiplexer.on_resistance", "\"200 mm\"", "ohm, kohm"]),
        ("\"200 ohm\"", "-3", ["multiplexer.on_resistance", "-3 ohm", "0.1 to 10000 ohm"]),
        ("\"200 ohm\"", "nan", ["multiplexer.on_resistance", "NaN", "0.1 to"]),
        ("\"3.1 V\"", "\"0.1 V\"", ["dac.highest", "0.1 V", "0.2 to 3.3 V"]),
        ("\"3.386 V\"", "\"2 V\"", ["large_range.open_voltage", "2 V", "to 200 V"]),
        ("\"3.222 V\"", "\"3 V\"", ["small_range.open_voltage", "3 V", "to 200 V"]),
        ("\"0.5 ms\"", "\"2 s\"", ["current_source.range_switching", "2 s", "0 to 1 s"]),
        ("bits = 12", "bits = 16", ["dac.bits", "16", "12 to 12"]),
        ("\ngain = ", "\ngain = 0.0#", ["amplifier.gain", "0", "0.1 to 1000"]),
    ] {
        let text = text();
        assert!(text.contains(from), "{from}");
        let error = Analogue::parse(Path::new("some.toml"), &text.replacen(from, to, 1)).unwrap_err();
        let message = error.to_string();
        assert!(message.contains("some.toml"), "{message}");
        parts.iter().for_each(|part| assert!(message.contains(part), "{part}: {message}"));
    }
}

#[test]
fn unknown_and_missing_fields_and_files_are_refused() {
    let unknown = text().replacen("[adc]", "[adc]\ncolour = 3", 1);
    let message = Analogue::parse(Path::new("some.toml"), &unknown).unwrap_err().to_string();
    assert!(message.contains("colour") && message.contains("some.toml"), "{message}");
    let missing = text().replacen("filter = ", "# filter = ", 1);
    let message = Analogue::parse(Path::new("some.toml"), &missing).unwrap_err().to_string();
    assert!(message.contains("filter"), "{message}");
    let message = Analogue::load(Path::new("nowhere.toml")).unwrap_err().to_string();
    assert!(message.contains("nowhere.toml"), "{message}");
}
