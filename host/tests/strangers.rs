//! What strangers hand in, and what the program says of it: their files stay where they belong, their words are only
//! words, and a refusal names file, field, value and what is allowed.

mod program;
mod testbench;

use dermatome::skin::{Skin, SkinError};
use dermatome_shared::{
    patch::checksum::crc32,
    protocol::{Identity, Reply, Request, Version},
};
use program::{Desk, TINY};
use std::path::Path;
use testbench::{fake_board, info, small_patch};

/// The fields that name a file, each with what it replaces.
const FIELDS: [(&str, &str, &str); 4] = [
    ("drive.table", "pattern = \"adjacent\"", "pattern = \"table\"\ntable = "),
    ("inverse.weights", "normalised = true", "normalised = true\nweights = "),
    (
        "material.conductivity_map",
        "sheet_conductivity = \"5.88 mS\"",
        "sheet_conductivity = 1\nconductivity_map = ",
    ),
    ("shape.file", "kind = \"disc\"\ndiameter = \"100 mm\"", "kind = \"mesh\"\nunit = \"mm\"\nfile = "),
];

fn naming(from: &str, to: &str, file: &str) -> String {
    assert!(TINY.contains(from));
    let text = TINY.replacen(from, &format!("{to}{file:?}"), 1);
    if to.contains("mesh") { text.replacen("[mesh]\nedge_length = \"8 mm\"\n", "", 1) } else { text }
}

fn refusal(folder: &Path, text: &str) -> String {
    let read = Skin::parse(&folder.join("skin.toml"), text).and_then(Skin::made);
    read.map(drop).map_err(|error: SkinError| error.to_string()).unwrap_err()
}

#[test]
fn a_skin_file_reads_no_file_outside_its_own_folder() {
    let desk = tempfile::tempdir().unwrap();
    let folder = desk.path().join("skin");
    std::fs::create_dir(&folder).unwrap();
    let secret = desk.path().join("secret.csv");
    std::fs::write(&secret, "root:x:0:0:very secret\n").unwrap();
    for (field, from, to) in FIELDS {
        for file in [secret.to_str().unwrap(), "../secret.csv", "a/../../secret.csv"] {
            let error = refusal(&folder, &naming(from, to, file));
            for part in ["skin.toml", field, file, "beside the skin file"] {
                assert!(error.contains(part), "{part:?} is not in {error:?}");
            }
            assert!(!error.contains("very secret"), "{error}");
        }
    }
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_not_followed_and_one_within_it_is() {
    use std::os::unix::fs::symlink;
    let desk = tempfile::tempdir().unwrap();
    let folder = desk.path().join("skin");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(desk.path().join("far.csv"), "weight\n1\n").unwrap();
    std::fs::write(folder.join("near.csv"), "weight\n1\n").unwrap();
    symlink("../far.csv", folder.join("out.csv")).unwrap();
    symlink("near.csv", folder.join("in.csv")).unwrap();
    let (_, from, to) = FIELDS[1];
    let error = refusal(&folder, &naming(from, to, "out.csv"));
    assert!(error.contains("`inverse.weights`") && error.contains("beside the skin file"), "{error}");
    assert!(Skin::parse(&folder.join("skin.toml"), &naming(from, to, "in.csv")).is_ok());
}

#[test]
fn a_file_that_is_no_table_is_not_quoted() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.csv"), "root:x:0:0:very secret\nsecret,too\n").unwrap();
    for (field, from, to) in &FIELDS[..3] {
        let error = refusal(folder.path(), &naming(from, to, "a.csv"));
        assert!(error.contains(field) && error.contains("has no column"), "{error}");
        assert!(!error.contains("secret"), "{error}");
    }
}

/// Sets a window's title, clears the screen.
const STEERING: &str = "\x1b]0;me\x07\x1b[2J";

fn is_plain(text: &str) -> bool {
    text.chars().all(|c| !c.is_control() || c == '\n')
}

#[test]
fn words_of_a_board_never_steer_the_terminal() {
    let board = fake_board(|request| match request {
        Request::Hello(_) => {
            let identity =
                Identity { board: STEERING.try_into().unwrap(), firmware: "\x1b[2J1.0".try_into().unwrap() };
            Some(Reply::Hello { version: Version::current(), identity })
        }
        _ => Some(info(8, 1000)),
    });
    let port = format!("tcp:{board}");
    let said = Desk::empty().run(&["devices", "--port", &port]).success();
    assert!(is_plain(&said.out) && said.out.contains("\\u{1b}]0;me\\u{7}"), "{:?}", said.out);
}

#[test]
fn names_in_files_and_of_files_never_steer_the_terminal() {
    let desk = Desk::empty();
    let mut patch = small_patch(&STEERING[..8], 1.0);
    let body = patch.len() - 4;
    let crc = crc32(&[&patch[..body]]);
    patch[body..].copy_from_slice(&crc.to_le_bytes());
    desk.write("patch", patch);
    let said = desk.run(&["inspect", "patch"]).success();
    assert!(is_plain(&said.out) && said.out.contains("\\u{1b}]0;me"), "{:?}", said.out);
    let name = format!("a{STEERING}.toml");
    desk.write(&name, format!("{STEERING} = 1\n"));
    let error = desk.run(&["build", &name]).refused();
    assert!(is_plain(&error) && error.contains("a\\u{1b}]0;me"), "{error:?}");
}

#[test]
fn refusals_say_what_is_wrong_in_the_users_words() {
    let desk = Desk::with_patch();
    let change = |name: &str, from: &str, to: &str| desk.write(name, TINY.replacen(from, to, 1));
    change("half.toml", "count = 8", "count = 8.5");
    change("word.toml", "threshold = 0.05", "threshold = \"a\"");
    change("rows.toml", "pattern = \"adjacent\"", "pattern = \"table\"\ntable = [[1, 2, 3]]");
    change("fine.toml", "columns = 16", "columns = 64");
    desk.write("header.csv", "pressure,strength\n0,0\n2,0.1\n4,0.2\n");
    let cases: [(&[&str], &[&str]); 8] = [
        (&["build", "half.toml"], &["`half.toml`", "count = 8.5", "expected a whole number"]),
        (&["build", "word.toml"], &["threshold = \"a\"", "expected a number"]),
        (&["build", "rows.toml"], &["table = [[1, 2, 3]]", "rows of four whole numbers"]),
        (&["build", "skin.toml", "-o", "missing/x"], &["error: cannot write `missing/x`"]),
        (&["build", "fine.toml"], &["`image.columns` gives 3228 pixels", "1 to 1024"]),
        (
            &["calibrate", "skin.dermatome", "--readings", "header.csv"],
            &["`header.csv`: its first line has no column `pressure_kpa`"],
        ),
        (&["evaluate", "skin.toml", "--seed", "-1"], &["'-1' for '--seed", "whole numbers from 0"]),
        (&["demo", "--noise-db", "5"], &["`--noise-db` is 5", "allowed: less"]),
    ];
    for (arguments, expected) in cases {
        let error = desk.run(arguments).refused();
        for part in expected {
            assert!(error.contains(part), "{arguments:?}: {part:?} is not in {error:?}");
        }
        assert!(!error.contains("dermatome check"), "{error}");
    }
}

#[test]
fn readings_may_have_semicolons_between_them_and_scope_names_its_electrodes() {
    let desk = Desk::with_patch();
    desk.write("readings.csv", "pressure_kpa;strength\n0;0\n2;0.1\n4;0.2\n6;0.3\n");
    desk.run(&["calibrate", "skin.dermatome", "--readings", "readings.csv", "--out", "b"]).success();
    let shown = desk.run(&["scope", "--port", "sim:skin.toml", "--slot", "3"]).success();
    assert!(shown.out.contains("step 3, current 1 -> 2, voltage 6 - 7"), "{}", shown.out);
}

#[cfg(unix)]
#[test]
fn a_device_that_is_no_serial_port_is_said_to_be_none() {
    let error = Desk::empty().run(&["devices", "--port", "/dev/null"]).refused();
    assert!(error.contains("`/dev/null` is no serial port; allowed"), "{error}");
}
