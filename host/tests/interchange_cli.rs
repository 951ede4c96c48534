//! `export`, `forward` and `check-data` as a user runs them.
#![cfg(unix)]

mod program;

use dermatome::{
    recorded::{order::Arrangement, weights::by_magnitude},
    skin::Skin,
};
use insta::{Settings, assert_snapshot};
use num_complex::Complex64;
use program::{Desk, TINY, row, shape, tiny_voltages, transcript};
use std::path::Path;

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

/// A skin that no model fits: frames from when all was well stand in for it.
#[test]
fn check_data_compares_with_good_frames() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    let unlike = |at: usize| [1.0, 3.0, 0.4, 1.7, 0.7, 2.2, 0.3][at * at % 7];
    let good: Vec<f64> = tiny_voltages().iter().enumerate().map(|(at, v)| v * unlike(at)).collect();
    let mut dead = good.clone();
    dead[7] = 0.0;
    desk.write("good.csv", row(&good));
    desk.write("dead.csv", row(&dead));
    desk.write("zero.csv", row(&vec![0.0; good.len()]));
    desk.write("length.csv", "1\n2\n");
    let check = |file: &str, good: &[&str]| {
        desk.run(&[&["check-data", "skin.toml", file, "--strict"], good].concat())
    };
    assert!(!check("good.csv", &[]).refused().is_empty());
    let same = check("good.csv", &["--good", "good.csv"]).success();
    assert!(same.out.contains("correlation with the good frames 1.000"), "{}", same.out);
    assert!(same.out.ends_with("nothing looks wrong\n"), "{}", same.out);
    assert_eq!(check("dead.csv", &["--good", "good.csv"]).refused(), "error: `dead.csv` has faults: 1\n");
    let refused = |file: &str| check("good.csv", &["--good", file]).refused();
    assert_eq!(
        refused("zero.csv"),
        "error: --good `zero.csv`: the good frames are zero, or nearly, on average\n"
    );
    assert!(refused("length.csv").starts_with("error: --good `length.csv`: frames hold "));
    assert!(refused("missing.csv").contains("`missing.csv`"));
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

#[test]
fn check_data_fits_contact_impedances_if_asked_to() {
    let desk = Desk::empty();
    let measured = TINY.replace("\"adjacent\"", "\"adjacent\"\ndriven = \"measured\"");
    let better = measured.replace("contact_impedance = \"0.18 ohm m\"", "contact_impedance = \"0.27 ohm m\"");
    desk.write("skin.toml", &measured);
    desk.write("better.toml", better);
    desk.run(&["forward", "better.toml", "--out", "idle.csv"]).success();
    let done = desk.run(&["check-data", "skin.toml", "idle.csv", "--fit", "--json", "fit.json"]).success();
    assert_eq!(done.err, "");
    filtered(|| assert_snapshot!("check_data_fit", done.out));
    let report = desk.report("fit.json");
    filtered(|| assert_snapshot!("check_data_fit_json", shape(&report["fit"])));
    for contact in report["fit"]["contacts"].as_array().unwrap() {
        assert!((contact["contact_impedance"].as_f64().unwrap() - 0.27).abs() < 1e-6, "{contact}");
    }
    // Frames of something else are fitted as well as they can be, and it says so.
    desk.write("noise.csv", row(&(0..64).map(|i| f64::from(i * 37 % 64) - 31.5).collect::<Vec<_>>()));
    let noise = desk.run(&["check-data", "skin.toml", "noise.csv", "--fit"]).success();
    assert!(noise.err.contains("these impedances mean little"), "{}", noise.err);
    let point = measured.replace("\"complete\"", "\"point\"").replace("width = \"8 mm\"\n", "");
    desk.write("point.toml", point.replace("contact_impedance = \"0.18 ohm m\"\n", ""));
    let words = desk.run(&["check-data", "point.toml", "idle.csv", "--fit"]).refused();
    assert!(words.contains("--fit of `idle.csv`") && words.contains("allowed: \"complete\""), "{words}");
}

#[test]
fn weights_by_magnitude_are_those_of_the_measured_reference() {
    let desk = Desk::empty();
    let (reference, frame) = {
        let untouched = tiny_voltages();
        // An instrument that reads some pairs weaker than others.
        let gain = |step: usize| 1.0 / (1.0 + (step % 4) as f64);
        let read = |change: f64| -> Vec<f64> {
            let value = |(step, v): (usize, &f64)| v * gain(step) * (1.0 + change * (step % 7) as f64);
            untouched.iter().enumerate().map(value).collect()
        };
        (read(0.0), read(0.01))
    };
    desk.write("idle.csv", row(&reference));
    desk.write("press.csv", row(&frame));
    let skin = Skin::parse(Path::new("skin.toml"), TINY).unwrap().made().unwrap();
    let steps = skin.steps();
    let map = Arrangement::default().index_map(&steps, 8, 40).unwrap();
    let values: Vec<_> = reference.iter().copied().map(Complex64::from).collect();
    let weights = by_magnitude(&values, &map, &skin.stimulation().combination);
    desk.write("skin.toml", TINY);
    desk.write(
        "listed.toml",
        TINY.replace("normalised = true", &format!("normalised = true\nweights = {weights:?}")),
    );
    let images = |skin: &str, more: &[&str]| {
        let files =
            ["reconstruct", skin, "--reference", "idle.csv", "--frames", "press.csv", "--json", "r.json"];
        desk.run(&[&files[..], more].concat()).success();
        desk.report("r.json")["frames"].clone()
    };
    let weighed = images("skin.toml", &["--weights", "magnitude"]);
    // The reference went through text of ten digits.
    let peak = |frames: &serde_json::Value| frames[0]["peak"].as_f64().unwrap();
    assert!((peak(&weighed) / peak(&images("listed.toml", &[])) - 1.0).abs() < 1e-6, "{weighed}");
    assert!((peak(&weighed) / peak(&images("skin.toml", &[])) - 1.0).abs() > 1e-3, "{weighed}");
    desk.write("plain.toml", TINY.replace("normalised = true", "normalised = false"));
    let words = desk
        .run(&[
            "reconstruct",
            "plain.toml",
            "--reference",
            "idle.csv",
            "--frames",
            "press.csv",
            "--weights",
            "magnitude",
        ])
        .refused();
    assert!(words.contains("`magnitude`") && words.contains("`inverse.normalised` is false"), "{words}");
}
