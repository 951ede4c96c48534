//! `export`, `forward` and `check-data` as a user runs them.
#![cfg(unix)]

mod program;

use insta::{Settings, assert_snapshot};
use program::{Desk, TINY, row, shape, tiny_voltages, transcript};

/// Snapshots without the test's own code.
fn filtered(check: impl FnOnce()) {
    let mut settings = Settings::clone_current();
    settings.set_omit_expression(true);
    settings.bind(check);
}

#[test]
fn export_lists_what_it_writes_and_its_table_makes_the_same_skin() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    let done = desk.run(&["export", "skin.toml", "--out", "out/tiny", "--json", "report.json"]).success();
    assert_eq!(done.err, "");
    filtered(|| assert_snapshot!("export", done.out));
    let (report, contents) = (desk.report("report.json"), desk.report("out/tiny/export.json"));
    assert_eq!(report, contents);
    let mut others = contents.clone();
    let arrays = others.as_object_mut().unwrap().remove("arrays").unwrap();
    let mut keys = shape(&others) + "arrays:\n";
    for (name, entry) in arrays.as_object().unwrap() {
        assert_eq!(entry["file"], format!("{name}.npy"));
        assert!(desk.read(&format!("out/tiny/{name}.npy")).starts_with(b"\x93NUMPY"));
        let sides = entry["shape"].as_array().unwrap().len();
        keys += &format!("{name} {sides}D {} {} {}\n", entry["type"], entry["unit"], entry["meaning"]);
    }
    filtered(|| assert_snapshot!("export_json", keys));
    assert!(desk.read("out/tiny/skin.mat").starts_with(b"MATLAB 5.0 MAT-file"));
    let table =
        TINY.replace("pattern = \"adjacent\"", "pattern = \"table\"\ntable = \"out/tiny/stimulation.csv\"");
    desk.write("again.toml", table);
    desk.run(&["export", "again.toml", "--out", "out/again"]).success();
    assert_eq!(desk.read("out/again/voltages.npy"), desk.read("out/tiny/voltages.npy"));
    assert_eq!(desk.read("out/again/jacobian.npy"), desk.read("out/tiny/jacobian.npy"));
}

#[test]
fn forward_prints_writes_and_reports_voltages() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    desk.run(&["export", "skin.toml", "--out", "out"]).success();
    let printed = desk.run(&["forward", "skin.toml", "--json", "forward.json"]).success();
    assert_eq!(printed.err, "");
    assert_eq!(printed.out.lines().count(), 1 + 40 + 1, "{}", printed.out);
    assert!(
        printed.out.ends_with("40 steps, 20 different measurements, rank 20 of at most 28\n"),
        "{}",
        printed.out
    );
    let report = desk.report("forward.json");
    filtered(|| assert_snapshot!("forward_json", shape(&report)));
    let voltages: Vec<f64> =
        report["voltages"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
    // What reads JSON here may miss the last digit.
    let digits = |values: &[f64]| values.iter().map(|value| format!("{value:.13}")).collect::<Vec<_>>();
    assert_eq!(digits(&voltages), digits(&tiny_voltages()));
    // Written, the untouched skin's are the exported ones, whether computed or read.
    desk.run(&["forward", "skin.toml", "--out", "a.npy"]).success();
    assert_eq!(desk.read("a.npy"), desk.read("out/voltages.npy"));
    desk.run(&["forward", "skin.toml", "--conductivity", "out/conductivity.npy", "--out", "b.npy"]).success();
    assert_eq!(desk.read("b.npy"), desk.read("a.npy"));
    // And what is written as a table is a frame.
    desk.run(&["forward", "skin.toml", "--out", "c.csv"]).success();
    let check = desk.run(&["check-data", "skin.toml", "c.csv", "--strict"]).success();
    assert!(
        check.out.contains("1 of 40 measurements, real") && check.out.contains("nothing looks wrong"),
        "{}",
        check.out
    );
    // In volts twice the conductivity is half the voltage, up to the contacts.
    let elements = report["elements"].as_u64().unwrap() as usize;
    desk.write("double.csv", "2\n".repeat(elements));
    desk.run(&["forward", "skin.toml", "--conductivity", "double.csv", "--json", "double.json"]).success();
    let double = desk.report("double.json")["voltages"][0].as_f64().unwrap();
    assert!((double / voltages[0] - 0.5).abs() < 0.05, "{double} {}", voltages[0]);
}

#[test]
fn check_data_says_what_is_wrong_and_fails_only_if_told_to() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    let untouched = tiny_voltages();
    desk.write("idle.csv", row(&untouched));
    let good = desk.run(&["check-data", "skin.toml", "idle.csv", "--strict"]).success();
    assert!(good.out.ends_with("nothing looks wrong\n"), "{}", good.out);
    let mut dead = untouched.clone();
    dead[7] = 0.0;
    desk.write("dead.csv", row(&dead));
    let files = ["check-data", "skin.toml", "dead.csv", "--json", "check.json"];
    let done = desk.run(&files).success();
    assert_eq!(done.err, "");
    filtered(|| assert_snapshot!("check_data", done.out));
    let report = desk.report("check.json");
    filtered(|| assert_snapshot!("check_data_json", shape(&report)));
    assert_eq!(report["faults"], 1);
    assert_eq!(report["dead_steps"], serde_json::json!([7]));
    let refused = desk.run(&[&files[..], &["--strict"]].concat()).refused();
    assert_eq!(refused, "error: `dead.csv` has faults: 1\n");
}

#[test]
fn errors_of_export_forward_and_check_data() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    desk.write("idle.csv", row(&tiny_voltages()));
    desk.write("file", "");
    desk.write("length.csv", "1\n2\n");
    desk.write("comma.csv", "1,5;2,5\n");
    desk.write("opposite.csv", row(&[1.0; 32]));
    desk.write("columns.csv", "1,2\n".repeat(40));
    let before = desk.files();
    let words = transcript(
        &desk,
        &[
            &["export", "skin.toml"],
            &["export", "missing.toml", "--out", "out"],
            &["export", "skin.toml", "--out", "file"],
            &["export", "skin.toml", "--out", "file/out"],
            &["forward", "missing.toml"],
            &["forward", "skin.toml", "--out", "voltages.mat"],
            &["forward", "skin.toml", "--out", "missing/voltages.npy"],
            &["forward", "skin.toml", "--conductivity", "missing.npy"],
            &["forward", "skin.toml", "--conductivity", "length.csv"],
            &["forward", "skin.toml", "--conductivity", "comma.csv"],
            &["check-data", "skin.toml"],
            &["check-data", "skin.toml", "missing.npy"],
            &["check-data", "skin.toml", "length.csv"],
            &["check-data", "skin.toml", "comma.csv"],
            &["check-data", "skin.toml", "opposite.csv"],
            &["check-data", "skin.toml", "columns.csv"],
            &["check-data", "skin.toml", "idle.csv", "--rotation", "8"],
            &["check-data", "skin.toml", "idle.csv", "--offset", "nan"],
        ],
    );
    filtered(|| assert_snapshot!("errors_interchange", words));
    assert_eq!(desk.files(), before, "nothing is left behind");
}
