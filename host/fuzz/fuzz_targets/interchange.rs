//! Any bytes as a file of conductivities, or as a stimulation table. What is read keeps its promises:
//! conductivities are finite, above zero and one for each element; steps name electrodes of the skin,
//! and a table that is written again is the same.
#![no_main]

use dermatome::{
    interchange::conductivity,
    recorded::read::Source,
    skin::Skin,
    stimulation::{report, table_csv},
};
use libfuzzer_sys::fuzz_target;
use std::{fs, path::Path};

const ELEMENTS: usize = 5;
const SKIN: &str = include_str!("../../tests/data/tiny.toml");

fn conductivities(folder: &Path, name: &str, bytes: &[u8]) {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    if let Ok(values) = conductivity::read(&Source::new(path.as_os_str()), ELEMENTS) {
        assert_eq!(values.len(), ELEMENTS);
        assert!(values.iter().all(|value| value.is_finite() && value.re > 0.0));
    }
}

fn table(folder: &Path, bytes: &[u8]) -> Option<Skin> {
    fs::write(folder.join("stimulation.csv"), bytes).unwrap();
    let text = SKIN.replace("pattern = \"adjacent\"", "pattern = \"table\"\ntable = \"stimulation.csv\"");
    Skin::parse(&folder.join("skin.toml"), &text).ok()?.made().ok()
}

/// Puts a right magic number and header length before the first line of `text`.
fn with_prefix(text: &[u8]) -> Vec<u8> {
    let header = text.iter().position(|&byte| byte == b'\n').map_or(text.len(), |end| end + 1);
    [b"\x93NUMPY\x01\x00", &(header as u16).to_le_bytes()[..], text].concat()
}

fuzz_target!(|input: (u8, &[u8])| {
    let (kind, bytes) = input;
    let folder = tempfile::tempdir().unwrap();
    match kind % 4 {
        0 => conductivities(folder.path(), "c.csv", bytes),
        1 => conductivities(folder.path(), "c.npy", &with_prefix(bytes)),
        _ => {
            let with_header = [b"drive_plus,drive_minus,sense_plus,sense_minus\n", bytes].concat();
            let Some(skin) = table(folder.path(), if kind % 4 == 2 { bytes } else { &with_header }) else {
                return;
            };
            let steps = skin.steps();
            assert!(!steps.is_empty() && steps.iter().all(|step| step.is_valid(skin.electrodes.count)));
            let told = report(&steps, skin.electrodes.count);
            assert!(
                told.rank <= told.distinct && told.distinct <= told.steps && told.rank <= told.largest_rank
            );
            let again = table(folder.path(), table_csv(&steps).as_bytes()).expect("what is written is read");
            assert_eq!(again.steps(), steps);
        }
    }
});
