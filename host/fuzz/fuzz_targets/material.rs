//! Any bytes as a material file: what is read has a range and a change that are numbers.
#![no_main]

use dermatome::material::Material;
use libfuzzer_sys::fuzz_target;
use std::io::Write;

fuzz_target!(|bytes: &[u8]| {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(bytes).unwrap();
    if let Ok(material) = Material::load(file.path()) {
        assert!(material.range_kpa.is_finite() && material.full_change.is_finite());
    }
});
