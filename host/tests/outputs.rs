//! No command overwrites what it reads, another of its outputs, or a file that holds something else.

mod program;

use program::{Desk, TINY};

/// A folder with a file of each kind that commands read.
fn desk() -> Desk {
    let desk = Desk::with_patch();
    std::fs::copy(desk.path("skin.dermatome"), desk.path("cal.dermatome")).unwrap();
    desk.write("readings.csv", "pressure_kpa,strength\n0,0\n1,0.1\n2,0.2\n3,0.3\n");
    desk.write("notes.txt", "mine");
    desk.write("ones.csv", "1\n");
    desk.run(&["export", "skin.toml", "--out", "model"]).success();
    std::fs::copy(desk.path("model/skin.stl"), desk.path("link.stl")).unwrap();
    let table = std::fs::read_to_string(desk.path("model/stimulation.csv")).unwrap();
    desk.write("steps.csv", table);
    desk.write("tabled.toml", TINY.replace("pattern = \"adjacent\"", "table = \"steps.csv\""));
    desk
}

/// All files with what they hold, folders left out.
fn contents(desk: &Desk) -> Vec<(String, Vec<u8>)> {
    let files = desk.files().into_iter().filter(|name| desk.path(name).is_file());
    files.map(|name| (name.clone(), desk.read(&name))).collect()
}

#[test]
fn no_output_takes_the_place_of_an_input_even_by_force() {
    let desk = desk();
    std::fs::hard_link(desk.path("skin.toml"), desk.path("linked.toml")).unwrap();
    let before = contents(&desk);
    let cases: &[&[&str]] = &[
        &["build", "skin.toml", "-o", "skin.toml"],
        &["build", "skin.toml", "-o", "./model/../skin.toml"],
        &["build", "skin.toml", "-o", "linked.toml"],
        &["build", "skin.toml", "--json", "skin.toml"],
        &["build", "skin.toml", "--hyperparameter-plot", "skin.toml"],
        &["build", "skin.toml", "--preserve-calibration", "cal.dermatome", "--json", "cal.dermatome"],
        &["build", "tabled.toml", "-o", "steps.csv"],
        &["evaluate", "skin.toml", "--json", "skin.toml"],
        &["evaluate", "skin.toml", "--png", "skin.toml"],
        &["forward", "skin.toml", "--json", "skin.toml"],
        &["forward", "skin.toml", "--conductivity", "ones.csv", "--out", "ones.csv"],
        &["forward", "tabled.toml", "--out", "steps.csv"],
        &[
            "reconstruct",
            "skin.toml",
            "--reference",
            "ones.csv",
            "--frames",
            "ones.csv",
            "--png",
            "skin.toml",
        ],
        &[
            "reconstruct",
            "skin.toml",
            "--reference",
            "ones.csv",
            "--frames",
            "ones.csv",
            "--json",
            "ones.csv",
        ],
        &[
            "replay",
            "ones.csv",
            "--reference",
            "ones.csv",
            "--patch",
            "cal.dermatome",
            "--json",
            "cal.dermatome",
        ],
        &["learn", "skin.toml", "--presses", "ones.csv", "-o", "skin.toml"],
        &["learn", "skin.toml", "--presses", "ones.csv", "-o", "ones.csv"],
        &["calibrate", "cal.dermatome", "--readings", "readings.csv", "--out", "readings.csv"],
        &["calibrate", "cal.dermatome", "--readings", "readings.csv", "--plot", "readings.csv"],
        &["calibrate", "cal.dermatome", "--readings", "readings.csv", "--json", "readings.csv"],
        &["calibrate", "cal.dermatome", "--readings", "readings.csv", "--json", "cal.dermatome"],
        &[
            "cut", "link.stl", "--unit", "mm", "--around", "0,0,0", "--radius", "5", "--out", "new",
            "--json", "link.stl",
        ],
        &["design", "skin.toml", "--out", "skin.toml"],
        &["inspect", "cal.dermatome", "--json", "cal.dermatome"],
        &["export", "skin.toml", "--out", "new", "--json", "skin.toml"],
        &["check-data", "skin.toml", "ones.csv", "--json", "ones.csv"],
        &["experiment", "trust", "skin.toml", "--json", "skin.toml"],
        &["scope", "--port", "sim:skin.toml", "--png", "skin.toml"],
        &["simulate", "skin.toml", "--listen", "tcp:127.0.0.1:0", "--store", "skin.toml"],
    ];
    for case in cases {
        for force in [&[][..], &["--force"]] {
            let words = desk.run(&[case, force].concat()).refused();
            assert!(words.contains("would overwrite `"), "{case:?}: {words}");
        }
    }
    assert!(contents(&desk) == before, "{:?}", desk.files());
}

#[test]
fn a_folder_that_holds_an_input_by_a_name_that_is_written_is_refused() {
    let desk = desk();
    let words = desk.run(&[
        "cut",
        "model/skin.msh",
        "--unit",
        "mm",
        "--around",
        "0,0,0",
        "--radius",
        "5",
        "--out",
        "model",
        "--force",
    ]);
    let words = words.refused();
    assert!(words.contains("`--out` would overwrite `model/skin.msh`, which `LINK` reads"), "{words}");
}

#[test]
fn outputs_are_files_of_their_own() {
    let desk = desk();
    let before = contents(&desk);
    let cases: &[&[&str]] = &[
        &["build", "skin.toml", "-o", "x", "--json", "x"],
        &["build", "skin.toml", "-o", "x", "--json", "./model/../x", "--force"],
        &["evaluate", "skin.toml", "--png", "x", "--json", "x"],
        &["calibrate", "cal.dermatome", "--readings", "readings.csv", "--plot", "x", "--json", "x"],
    ];
    for case in cases {
        let words = desk.run(case).refused();
        assert!(words.contains("are the same file `"), "{case:?}: {words}");
    }
    assert!(contents(&desk) == before, "{:?}", desk.files());
}

#[test]
fn a_file_of_another_kind_is_replaced_by_force_alone() {
    let desk = desk();
    let cases: &[&[&str]] = &[
        &["build", "skin.toml", "-o", "notes.txt"],
        &["build", "skin.toml", "--json", "notes.txt"],
        &["forward", "skin.toml", "--json", "notes.txt"],
        &["inspect", "skin.dermatome", "--json", "cal.dermatome"],
        &["calibrate", "cal.dermatome", "--readings", "readings.csv", "--plot", "notes.txt"],
        &["design", "skin.toml", "--out", "notes.txt"],
    ];
    let before = contents(&desk);
    for case in cases {
        let words = desk.run(case).refused();
        assert!(words.contains("`--force`"), "{case:?}: {words}");
    }
    assert!(contents(&desk) == before, "{:?}", desk.files());
    desk.run(&["build", "skin.toml", "-o", "notes.txt", "--force"]).success();
    assert_eq!(desk.read("notes.txt")[..4], *b"DSKP");
    // Of the same kind, empty, or no ordinary file: replaced, or written to, as ever.
    desk.write("empty.json", "");
    for json in ["new.json", "new.json", "empty.json", "/dev/null"] {
        desk.run(&["inspect", "skin.dermatome", "--json", json]).success();
    }
    let words = desk.run(&["inspect", "skin.dermatome", "--json", "-"]).refused();
    assert!(words.contains("`-` is no file here; allowed: a file (/dev/stdout"), "{words}");
}

#[test]
fn a_file_that_an_export_would_replace_is_kept_unless_an_export_wrote_it() {
    let desk = desk();
    desk.run(&["export", "skin.toml", "--out", "model"]).success();
    std::fs::remove_file(desk.path("model/export.json")).unwrap();
    let words = desk.run(&["export", "skin.toml", "--out", "model"]).refused();
    assert!(words.contains("is there already; allowed: another `--out`, or `--force`"), "{words}");
    desk.run(&["export", "skin.toml", "--out", "model", "--force"]).success();
}

#[test]
fn a_name_that_is_derived_takes_no_other_file_either() {
    let desk = desk();
    desk.write("tiny.dermatome", "mine");
    desk.write("tiny-designed.toml", "mine");
    for case in [["build", "skin.toml"], ["design", "skin.toml"]] {
        let words = desk.run(&case).refused();
        assert!(words.contains("to remove that file"), "{words}");
    }
    assert_eq!(desk.read("tiny.dermatome"), b"mine");
    assert_eq!(desk.read("tiny-designed.toml"), b"mine");
}
