//! The header that is checked in is what the sources make: `UPDATE_HEADER=1 cargo test -p dermatome-c --test header`.

use std::{env, fs, path::Path};

fn made() -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let mut header = Vec::new();
    cbindgen::generate_with_config(folder, config).unwrap().write(&mut header);
    String::from_utf8(header).unwrap()
}

#[test]
fn the_header_is_that_of_the_sources() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/dermatome.h");
    let made = made();
    if env::var_os("UPDATE_HEADER").is_some() {
        fs::write(&path, &made).unwrap();
    }
    let there = fs::read_to_string(&path).unwrap_or_default();
    assert!(there == made, "run UPDATE_HEADER=1 cargo test -p dermatome-c --test header");
}

/// C has one room for all names.
#[test]
fn every_name_has_the_prefix() {
    let header = made();
    let defined = header.lines().filter_map(|line| line.strip_prefix("#define "));
    let lines = header.lines().filter(|line| !line.starts_with(['/', ' ']));
    let functions = lines.filter_map(|line| line.split_once('(')).map(|(before, _)| before);
    let types = header.lines().filter_map(|line| line.strip_prefix("typedef struct "));
    assert_eq!((defined.clone().count(), functions.clone().count(), types.clone().count()), (36, 22, 10));
    for name in defined.chain(functions).chain(types) {
        assert!(name.contains("DERMATOME_") || name.contains("dermatome_"), "{name}");
    }
}
