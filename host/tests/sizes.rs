//! Files without end, and skins that no machine can hold, are refused at once.
#![cfg(unix)]

mod program;

use program::{Desk, TINY};

#[test]
fn files_without_end_are_refused_with_the_most_that_is_read() {
    let desk = Desk::with_patch();
    let cases: &[&[&str]] = &[
        &["build", "/dev/zero"],
        &["evaluate", "/dev/zero"],
        &["design", "/dev/zero"],
        &["simulate", "/dev/zero", "--listen", "tcp:127.0.0.1:0"],
        &["simulate", "skin.toml", "--material", "/dev/zero", "--listen", "tcp:127.0.0.1:0"],
        &["inspect", "/dev/zero"],
        &["flash", "/dev/zero", "--port", "sim:skin.toml"],
        &["calibrate", "/dev/zero", "--readings", "none.csv"],
        &["build", "skin.toml", "-o", "new", "--preserve-calibration", "/dev/zero"],
        &["replay", "none.csv", "--patch", "/dev/zero"],
    ];
    for case in cases {
        let words = desk.run(case).refused();
        assert!(
            words.contains("/dev/zero") && words.contains("the most that such a file may"),
            "{case:?}: {words}"
        );
    }
    assert_eq!(desk.files(), ["skin.dermatome", "skin.toml"]);
}

#[test]
fn a_skin_that_no_board_takes_is_refused_before_the_work_with_the_memory_it_would_take() {
    let desk = Desk::empty();
    let many = TINY.replace("count = 8", "count = 250").replace("width = \"8 mm\"", "width = \"1 mm\"");
    desk.write("many.toml", many);
    let words = desk.run(&["build", "many.toml"]).refused();
    assert!(words.contains("`electrodes.count` gives 250 electrodes; a board takes 1 to 16"), "{words}");
    assert!(words.contains("allowed: `--no-patch`, to compute only, in 45.8 GB of memory"), "{words}");
}
