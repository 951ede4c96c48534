//! Any text as a body file beside a skin file, `tiny.toml`. What passes has names for topics, each once, and places that are
//! numbers.
#![no_main]

use dermatome::body::file::{BodyFile, is_part_of_topic};
use libfuzzer_sys::fuzz_target;
use std::{collections::HashSet, path::Path};

fuzz_target!(|text: &str| {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/robot.toml");
    let Ok(body) = BodyFile::parse(&path, text) else { return };
    assert!(is_part_of_topic(&body.name) && !body.patches.is_empty());
    let mut names = HashSet::new();
    for patch in &body.patches {
        assert!(is_part_of_topic(&patch.name) && names.insert(&patch.name));
        assert!(patch.pose.position.iter().all(|length| length.is_finite()));
        let length: f64 = patch.pose.orientation.iter().map(|part| part * part).sum();
        assert!((length - 1.0).abs() < 1e-9, "{length}");
    }
});
