//! Standard output: reports behind the words, a reader who has gone, a full disk.
#![cfg(unix)]

mod program;

use program::{Desk, Running};
use std::fs::File;

#[test]
fn a_report_on_standard_output_follows_the_words() {
    let desk = Desk::with_patch();
    let inspect = ["inspect", "skin.dermatome", "--json", "/dev/stdout"];
    let done = desk.run(&inspect).success();
    let (words, report) = done.out.split_at(done.out.find('{').unwrap());
    assert!(words.starts_with("skin "), "{words}");
    assert!(serde_json::from_str::<serde_json::Value>(report).unwrap().is_object());
    // And the same where standard output is a file.
    let file = File::create(desk.path("out.txt")).unwrap();
    Running::start(desk.command(&inspect).stdout(file)).finish().success();
    assert_eq!(String::from_utf8(desk.read("out.txt")).unwrap(), done.out);
}

#[test]
fn a_reader_who_has_gone_is_no_error() {
    let desk = Desk::with_patch();
    let (read, write) = std::io::pipe().unwrap();
    drop(read);
    let mut command = desk.command(&["inspect", "skin.dermatome"]);
    let done = Running::start(command.stdout(write)).finish().success();
    assert_eq!(done.err, "");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_standard_output_is_an_error() {
    let desk = Desk::with_patch();
    let full = File::options().write(true).open("/dev/full").unwrap();
    let done = Running::start(desk.command(&["inspect", "skin.dermatome"]).stdout(full)).finish();
    assert_eq!(
        done.refused(),
        "error: cannot write to standard output: No space left on device (os error 28)\n"
    );
}
