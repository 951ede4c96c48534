//! `check`, `scope` and `drive` as processes, against simulated boards over TCP.
#![cfg(unix)]

mod program;

use dermatome::{
    model::Model,
    quantize,
    simulate::{
        Noise, Press, Script, SimulatedSkin,
        board::{BoardOptions, SimulatedBoard},
        instrument::{Instrument, ScanTable},
    },
    skin::Skin,
};
use dermatome_shared::{acquire::FrontEnd, frame::Frame};
use program::{Desk, TINY};
use serde_json::Value;
use std::{path::Path, thread, time::Duration};

/// The tiny skin on a board of its own, with `fault` done to every scan.
struct Faulty<F> {
    skin: SimulatedSkin,
    fault: F,
}

impl<F: FnMut(&mut Frame) + Send> Instrument for Faulty<F> {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        let mut frame = self.skin.scan(table, script_time);
        (self.fault)(&mut frame);
        frame
    }

    fn front_end(&self) -> Option<FrontEnd> {
        self.skin.front_end()
    }
}

/// A board of a skin file's text, untouched, that holds its patch; and its port.
fn board(text: &str, fault: impl FnMut(&mut Frame) + Send + 'static) -> (SimulatedBoard, String) {
    let skin = Skin::parse(Path::new("skin.toml"), text).unwrap().made().unwrap();
    let patch = quantize::patch(&skin, &Model::build(&skin, |_| ()).unwrap()).unwrap();
    let script = Script::still(&[] as &[Press], skin.shape.flat().unwrap()).unwrap();
    let noise = Noise { snr_db: 70.0, seed: 3 };
    let source = Faulty { skin: SimulatedSkin::new(&skin, script, noise).unwrap(), fault };
    let options = BoardOptions { electrodes: 8, patch: Some(patch), ..BoardOptions::default() };
    let board = SimulatedBoard::start(options, source).unwrap();
    let port = format!("tcp:{}", board.address());
    (board, port)
}

fn ohms(report: &Value) -> Vec<f64> {
    let electrodes = report["electrodes"].as_array().unwrap();
    electrodes.iter().map(|electrode| electrode["contact_impedance_ohm"].as_f64().unwrap()).collect()
}

#[test]
fn a_healthy_board_shows_the_contact_impedances_of_its_skin() {
    let desk = Desk::empty();
    let (_board, port) = board(TINY, |_| ());
    let done = desk.run(&["check", "--port", &port, "--json", "check.json"]).success();
    assert!(
        done.out.contains("nothing looks wrong") && done.out.matches("  ok\n").count() == 8,
        "{}",
        done.out
    );
    assert_eq!(done.err, "");
    let report = desk.report("check.json");
    // 0.18 ohm m over 8 mm; the coarse model of this skin knows its sheet to a few ohms.
    let found = ohms(&report);
    assert!(found.iter().all(|ohms| (ohms - 22.5).abs() < 5.0), "{found:?}");
    assert_eq!((&report["frames"], &report["findings"]), (&20.into(), &Value::Array(Vec::new())));
    assert!((report["frames_per_second"].as_f64().unwrap() - 50.0).abs() < 1e-6);
    assert!(report["reciprocity_error_percent"].as_f64().unwrap() < 1.0);
    assert_eq!(report["load_percent"], Value::Null, "a simulated board has no CPU of its own");
}

#[test]
fn an_electrode_that_touches_worse_is_told() {
    let worse = "contact_impedance = [0.18, 0.18, 0.18, 0.18, 1.8, 0.18, 0.18, 0.18]";
    let desk = Desk::empty();
    let (_board, port) = board(&TINY.replace("contact_impedance = \"0.18 ohm m\"", worse), |_| ());
    let done = desk.run(&["check", "--port", &port, "--json", "check.json"]);
    let (out, found) = (done.out.clone(), ohms(&desk.report("check.json")));
    done.refused();
    assert!(out.contains("wrong: electrode 5 touches worse than most"), "{out}");
    assert!((found[4] - 225.0).abs() < 10.0 && found[3] < 30.0, "{found:?}");
}

#[test]
fn an_open_electrode_is_named_and_the_exit_code_says_so() {
    let desk = Desk::empty();
    let open = |frame: &mut Frame| {
        frame.tests[2].is_clipped = true;
        frame.tests[1].in_phase.0 = 0;
    };
    let (_board, port) = board(TINY, open);
    let done = desk.run(&["check", "--port", &port, "--frames", "5"]);
    assert_eq!(done.status.code(), Some(1));
    let out = done.out.clone();
    assert!(out.contains("wrong: electrode 3 has no contact: check its wire"), "{out}");
    assert!(out.contains("flags              open electrode (5)"), "{out}");
    let err = done.refused();
    assert!(err.contains("one thing is wrong"), "{err}");
}

#[test]
fn a_board_without_current_is_told() {
    let desk = Desk::empty();
    let dead = |frame: &mut Frame| frame.tests.iter_mut().for_each(|test| test.in_phase.0 = 40);
    let (_board, port) = board(TINY, dead);
    let done = desk.run(&["check", "--port", &port, "--frames", "3"]);
    assert_eq!(done.out.matches("  unknown\n").count(), 8, "{}", done.out);
    assert!(
        done.out.contains("wrong: no current in 3 of 3 frames: check the current source"),
        "{}",
        done.out
    );
    done.refused();
}

#[test]
fn ctrl_c_stops_a_check_of_a_slow_board() {
    let desk = Desk::empty();
    let (_board, port) = board(&TINY.replace("\"50 Hz\"", "\"0.1 Hz\""), |_| ());
    let check = desk.start(&["check", "--port", &port]);
    thread::sleep(Duration::from_secs(1));
    check.interrupt();
    let err = check.finish_within(Duration::from_secs(8)).refused();
    assert!(err.contains("stopped before the first frame came"), "{err}");
}

/// A simulated board as a process of its own, flashed.
fn flashed(desk: &Desk) -> (program::Running, String) {
    let (board, port) = desk.board("skin.toml", &[]);
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    (board, port)
}

#[test]
fn scope_shows_the_samples_of_a_slot_with_the_lock_ins_fit() {
    let desk = Desk::with_patch();
    let (_board, port) = flashed(&desk);
    let out = desk.run(&["scope", "--port", &port, "--slot", "3"]).success().out;
    assert!(out.starts_with("slot 3 of `tiny`: step 3, current 1 -> 2, voltage 6 - 7\n"), "{out}");
    assert!(out.contains("50 of which 10 settle, 40 per carrier period, 2000000 a second"), "{out}");
    assert!(out.contains("clipped   0 samples") && out.matches('o').count() > 8, "{out}");
    // The board's automatic gain brings a peak to 450 to 900 of 2047 steps.
    let amplitude: f64 = out.split("amplitude ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((440.0..910.0).contains(&amplitude), "{out}");
    let out = desk.run(&["scope", "--port", &port, "--slot", "47", "--png", "slot.png"]).success().out;
    assert!(out.contains("test of electrode 8") && out.contains("picture   slot.png"), "{out}");
    assert!(desk.read("slot.png").starts_with(b"\x89PNG"));
    let err = desk.run(&["scope", "--port", &port, "--slot", "48"]).refused();
    assert!(err.contains("slots 0 to 47"), "{err}");
}

#[test]
fn a_board_without_samples_is_told_from_a_silent_one() {
    let desk = Desk::empty();
    let (_board, port) = board(TINY, |_| ());
    let err = desk.run(&["scope", "--port", &port]).refused();
    assert!(err.contains("no answer from"), "{err}");
}

#[test]
fn drive_shows_what_is_in_effect_changes_it_and_goes_back_to_the_patch() {
    let desk = Desk::with_patch();
    let (_board, port) = flashed(&desk);
    let out = desk.run(&["drive", "--port", &port]).success().out;
    for words in ["50 kHz", "1 mA (100 % of full scale)", "automatic", "real", "as the patch says"] {
        assert!(out.contains(words), "{words}: {out}");
    }
    let change = ["--frequency", "100 kHz", "--amplitude", "50%", "--gain", "2", "--phase", "30"];
    let more = ["--settling", "0.5", "--integration", "2", "--component", "magnitude", "--json", "d.json"];
    let out = desk.run(&[&["drive", "--port", &port][..], &change, &more].concat()).success().out;
    assert!(out.contains("0.5 mA (50 % of full scale)") && out.contains("until the next patch"), "{out}");
    let drive = &desk.report("d.json")["drive"];
    assert_eq!((&drive["frequency_hz"], &drive["gain"]), (&100e3.into(), &2.into()));
    assert_eq!((&drive["component"], &drive["integration_periods"]), (&"magnitude".into(), &2.into()));
    let scope = desk.run(&["scope", "--port", &port]).success().out;
    assert!(scope.contains("gain      2\n") && scope.contains("50 of which 10 settle, 20 per"), "{scope}");
    let devices = desk.run(&["devices", "--port", &port]).success().out;
    assert!(devices.contains("drive       100 kHz, 0.5 mA (50 % of full scale), "), "{devices}");
    let out = desk.run(&["drive", "--port", &port, "--patch"]).success().out;
    assert!(out.contains("50 kHz") && out.contains("as the patch says"), "{out}");
}

#[test]
fn half_the_current_reads_the_same_contact_impedances() {
    let desk = Desk::with_patch();
    let (_board, port) = flashed(&desk);
    let check = |json: &str| {
        desk.run(&["check", "--port", &port, "--frames", "5", "--json", json]).success();
        ohms(&desk.report(json))
    };
    let before = check("before.json");
    desk.run(&["drive", "--port", &port, "--amplitude", "0.5 mA"]).success();
    let after = check("after.json");
    assert!(before.iter().zip(&after).all(|(a, b)| (a - b).abs() < 1.0), "{before:?} {after:?}");
}
