//! Any bytes as a path file: presses that are read are finite, at any time.
#![no_main]

use dermatome::{outline::Outline, simulate::Script};
use libfuzzer_sys::fuzz_target;
use std::io::Write;

fuzz_target!(|bytes: &[u8]| {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(bytes).unwrap();
    let Ok(script) = Script::load(file.path(), &Outline::disc(0.1)) else { return };
    for time in [0.0, 0.5, 1e9] {
        assert!(script.presses(time).iter().all(|press| press.position.iter().all(|x| x.is_finite())));
    }
});
