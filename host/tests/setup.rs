//! `dermatome setup` as a script runs it, on a simulated board: new, wired in another order, without presses, with a bad
//! contact, with nobody to ask.

mod program;

use program::{Desk, TINY, with};
use serde_json::Value;

/// The tiny disc with 16 electrodes, so that a quarter of the way round is electrode 5.
fn skin() -> String {
    let changes = [("count = 8", "count = 16"), ("width = \"8 mm\"", "width = \"6 mm\"")];
    changes.iter().fold(TINY.to_owned(), |text, (line, other)| with(&text, line, other))
}

/// A finger near electrode 1 of [`skin`], at the top, then one near electrode 5, on the right.
const PRESSES: &str = "time_s,finger,x_m,y_m,radius_m,depth\n\
    0,1,0,0.038,0.006,0\n0.5,1,0,0.038,0.006,0\n0.6,1,0,0.038,0.006,1\n2.0,1,0,0.038,0.006,1\n2.1,1,0,0.038,0.006,0\n\
    2.6,2,0.038,0,0.006,0\n2.7,2,0.038,0,0.006,1\n4.5,2,0.038,0,0.006,1\n4.6,2,0.038,0,0.006,0\n\
    5.5,1,0,0.038,0.006,0\n";

fn desk() -> Desk {
    let desk = Desk::empty();
    desk.write("skin.toml", skin());
    desk.write("presses.csv", PRESSES);
    desk
}

fn step<'a>(report: &'a Value, name: &str) -> &'a Value {
    let steps = report["steps"].as_array().unwrap();
    steps.iter().find(|step| step["step"] == name).unwrap_or_else(|| panic!("{name}: {report:#}"))
}

/// State of each step.
fn states(report: &Value) -> Vec<&str> {
    report["steps"].as_array().unwrap().iter().map(|step| step["state"].as_str().unwrap()).collect()
}

const SETUP: [&str; 7] = ["setup", "--skin", "skin.toml", "--yes", "--json", "setup.json", "--port"];

#[test]
fn a_new_board_gets_its_patch_and_two_presses_show_that_its_wires_are_right() {
    let desk = desk();
    let (_board, port) = desk.board("skin.toml", &["--path", "presses.csv"]);
    let done =
        desk.run(&[&SETUP[..], &[&port, "--press-within", "30", "-o", "new.dermatome"]].concat()).success();
    let report = desk.report("setup.json");
    assert_eq!(states(&report), ["ok", "mended", "ok", "ok", "ok", "ok", "ok", "ok"], "{done:#?}");
    assert_eq!((&report["ended"], &report["corrected"]), (&"done".into(), &false.into()));
    assert!(report["snr_db"].as_f64().unwrap() > 50.0, "{report:#}");
    let change = report["smallest_press"]["median_change_percent"].as_f64().unwrap();
    assert!((0.1..50.0).contains(&change), "{change}");
    // The file is what the board uses.
    let told = desk.run(&["inspect", "new.dermatome", "--json", "inspect.json"]).success();
    assert_eq!(desk.report("inspect.json")["patch_crc"], report["patch_crc"], "{told:#?}");
    // Done again, there is nothing to mend.
    desk.run(&[&SETUP[..], &[&port]].concat()).success();
    assert_eq!(states(&desk.report("setup.json")), ["ok", "ok", "ok", "ok", "ok", "ok", "ok", "skipped"]);
}

#[test]
fn wires_in_another_order_are_corrected_by_two_presses_and_the_skin_file_is_given() {
    for (other, told) in [
        ("first = \"0 deg\"", "wire 1 goes to electrode 5"),
        (
            "first = \"45 deg\"\ndirection = \"counter-clockwise\"",
            "wire 1 goes to electrode 3, and the others go round the other way",
        ),
    ] {
        let desk = desk();
        desk.write(
            "real.toml",
            with(&skin(), "placement = \"rim\"", &format!("placement = \"rim\"\n{other}")),
        );
        let (_board, port) = desk.board("real.toml", &["--path", "presses.csv"]);
        let done = desk
            .run(&[&SETUP[..], &[&port, "--press-within", "30", "--corrected", "corrected.toml"]].concat());
        let done = done.success();
        let report = desk.report("setup.json");
        assert_eq!(step(&report, "presses")["state"], "mended", "{done:#?}");
        assert_eq!(report["corrected"], true);
        assert!(done.out.contains(told), "{done:#?}");
        // The corrected file is that of the real skin: its own patch is the one on the board.
        desk.run(&["build", "corrected.toml", "-o", "corrected.dermatome", "--json", "build.json"]).success();
        assert_eq!(desk.report("build.json")["patch_crc"], report["patch_crc"]);
        for (a, b) in centres(&desk, "corrected.toml").iter().zip(&centres(&desk, "real.toml")) {
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-5, "{a:?} {b:?}");
        }
    }
}

fn centres(desk: &Desk, file: &str) -> Vec<[f64; 2]> {
    let skin = dermatome::skin::Skin::load(&desk.path(file)).unwrap().made().unwrap();
    dermatome::skin::electrodes_in_plane(&skin.shape)
}

#[test]
fn another_skin_s_patch_is_replaced_and_a_calibrated_one_is_not() {
    let desk = desk();
    desk.write("other.toml", with(&skin(), "name = \"tiny\"", "name = \"other\""));
    desk.run(&["build", "other.toml", "-o", "store.dermatome"]).success();
    let (board, port) = desk.board("skin.toml", &["--store", "store.dermatome"]);
    let done = desk.run(&[&SETUP[..], &[&port]].concat()).success();
    assert!(done.out.contains("of `other` is not what skin file `skin.toml` gives"), "{done:#?}");
    drop(board);
    desk.write("readings.csv", "pressure_kpa,strength\n0,0\n10,0.2\n20,0.4\n30,0.6\n");
    desk.run(&["calibrate", "store.dermatome", "--readings", "readings.csv"]).success();
    let (_board, port) = desk.board("skin.toml", &["--store", "store.dermatome"]);
    let done = desk.run(&[&SETUP[..], &[&port]].concat()).success();
    assert!(done.out.contains("calibrated: kept"), "{done:#?}");
}

#[test]
fn a_current_that_clips_is_lowered_in_the_patch_and_told_for_the_skin_file() {
    let desk = desk();
    desk.write("skin.toml", with(&skin(), "frequency = ", "gain = 64\nfrequency = "));
    let (_board, port) = desk.board("skin.toml", &["--path", "presses.csv"]);
    let done = desk.run(&[&SETUP[..], &[&port, "--corrected", "new.toml"]].concat()).success();
    let report = desk.report("setup.json");
    assert_eq!(step(&report, "current")["state"], "mended", "{done:#?}");
    let amplitude = report["amplitude_a"].as_f64().unwrap();
    assert!((1e-6..0.6e-3).contains(&amplitude) && report["corrected"] == true, "{report:#}");
    let said = format!("amplitude = \"{:.4} mA\"", 1e3 * amplitude);
    assert!(String::from_utf8(desk.read("new.toml")).unwrap().contains(&said), "{said}");
    let drive = desk.run(&["drive", "--port", &port]).success();
    assert!(drive.out.contains("as the patch says"), "{drive:#?}");
}

#[test]
fn a_bad_contact_is_told_and_no_current_is_lowered_for_it() {
    let desk = desk();
    let contacts = (1..=16).map(|electrode| if electrode == 3 { "\"3 ohm m\"" } else { "\"0.18 ohm m\"" });
    let list = format!("contact_impedance = [{}]", contacts.collect::<Vec<_>>().join(", "));
    desk.write("real.toml", with(&skin(), "contact_impedance = \"0.18 ohm m\"", &list));
    let (_board, port) = desk.board("real.toml", &["--path", "presses.csv"]);
    let done = desk.run(&[&SETUP[..], &[&port]].concat());
    assert_eq!(done.status.code(), Some(1), "{done:#?}");
    assert!(done.out.contains("electrode 3 touches worse than most"), "{done:#?}");
    let report = desk.report("setup.json");
    assert_eq!(step(&report, "electrodes")["state"], "wrong");
    assert_eq!(step(&report, "current")["state"], "ok");
    assert_eq!((&report["ended"], &report["corrected"]), (&"wrong".into(), &false.into()));
}

#[test]
fn nobody_to_ask_a_skin_that_is_none_and_presses_that_do_not_come_are_told() {
    let desk = desk();
    let (_board, port) = desk.board("skin.toml", &["--press", "0.02,0,0.006,1"]);
    let words = desk.run(&["setup", "--skin", "skin.toml", "--port", &port]).refused();
    assert!(words.contains("standard input is no terminal") && words.contains("`--yes`"), "{words}");
    let words = desk.run(&["setup", "--skin", "none.toml", "--yes", "--port", &port]).refused();
    assert!(words.contains("none.toml"), "{words}");
    // A finger that rests is one press, and no other.
    let done = desk.run(&[&SETUP[..], &[&port, "--press-within", "2"]].concat());
    assert_eq!(done.status.code(), Some(1), "{done:#?}");
    assert!(done.out.contains("1 of 2 presses came within 2 s each"), "{done:#?}");
    assert!(done.err.contains("one step found something wrong"), "{done:#?}");
    assert_eq!(step(&desk.report("setup.json"), "presses")["state"], "wrong");
}

#[cfg(unix)]
#[test]
fn ctrl_c_while_it_waits_for_a_press_ends_it_cleanly_and_the_report_says_so() {
    let desk = desk();
    let (_board, port) = desk.board("skin.toml", &["--press", "0.02,0,0.006,0"]);
    let mut setup = desk.start(&[&SETUP[..], &[&port, "--press-within", "100"]].concat());
    while !setup.line().starts_with("press near electrode 1") {}
    setup.interrupt();
    let done = setup.finish();
    assert!(done.status.success() && done.out.ends_with("stopped\n"), "{done:#?}");
    assert_eq!(desk.report("setup.json")["ended"], "stopped");
}
