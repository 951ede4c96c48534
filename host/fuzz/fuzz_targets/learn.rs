//! Any bytes as presses to learn from: as many places as presses, or an error.
#![no_main]

use dermatome::{learn::presses::{Layout, Recording}, skin::Skin};
use libfuzzer_sys::fuzz_target;
use std::{io::Write, path::Path, sync::LazyLock};

static SKIN: LazyLock<Skin> = LazyLock::new(|| {
    let text = include_str!("../../tests/data/tiny.toml");
    Skin::parse(Path::new("skin.toml"), text).and_then(Skin::made).unwrap()
});

fuzz_target!(|input: (bool, &[u8])| {
    let (is_archive, bytes) = input;
    // The name decides how the file is read.
    let ending = if is_archive { ".npz" } else { ".csv" };
    let mut file = tempfile::Builder::new().suffix(ending).tempfile().unwrap();
    file.write_all(bytes).unwrap();
    if let Ok(recording) = Recording::read(file.path(), None, &Layout::default(), &SKIN) {
        assert!(recording.pressed.frames > 0);
    }
});
