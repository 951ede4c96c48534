//! `dermatome replay`: recorded frames through a board's own pipeline, with built and learnt patches.
#![cfg(unix)]

mod program;

use dermatome::{
    simulate::{Press, TrueSkin},
    skin::Skin,
};
use dermatome_shared::stimulation::Step;
use insta::{Settings, assert_snapshot};
use program::{Desk, Running, TINY, row, shape, tiny_voltages, transcript};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use serde_json::Value;
use std::{fmt::Write as _, path::Path, time::Duration};

const REAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/real/hydrogel_skin_wam.npz");
const HYDROGEL: &str = include_str!("data/hydrogel.toml");
const POSE: &str = "[pose]\nlink = \"palm\"\nposition = [1, 2, \"3 m\"]\norientation = [0, 0, 0.7071067811865476, 0.7071067811865476]\n";
/// Where the finger presses, m.
const FINGER: [f64; 2] = [0.02, -0.01];

/// The tiny skin under an instrument of 60 dB.
struct Bench {
    truth: TrueSkin,
    skin: Skin,
    random: Pcg64Mcg,
}

impl Bench {
    fn new(seed: u64) -> Self {
        let skin = Skin::parse(Path::new("tiny.toml"), TINY).unwrap().made().unwrap();
        Self { truth: TrueSkin::new(&skin).unwrap(), skin, random: Pcg64Mcg::seed_from_u64(seed) }
    }

    /// Voltages of so many frames under these presses, one frame a line.
    fn frames(&mut self, presses: &[Press], count: usize) -> String {
        let steps = self.skin.steps();
        let voltages = self.truth.voltages(&self.truth.conductivity(presses), &steps);
        let size = (voltages.iter().map(|v| v * v).sum::<f64>() / voltages.len() as f64).sqrt() * 1e-3;
        let mut noisy = || -> Vec<f64> {
            let mut add = |v: &f64| v + size * Distribution::<f64>::sample(&StandardNormal, &mut self.random);
            voltages.iter().map(&mut add).collect()
        };
        (0..count).map(|_| row(&noisy())).collect()
    }

    fn finger(&mut self, count: usize) -> String {
        self.frames(&[Press::finger(FINGER, 0.012, 1.0)], count)
    }
}

/// 20 frames of the untouched skin, ten of a finger, ten without.
fn recorded(desk: &Desk) {
    let mut bench = Bench::new(1);
    let text = bench.frames(&[], 20) + &bench.finger(10) + &bench.frames(&[], 10);
    desk.write("run.csv", text);
}

/// Frame, time, x and y of each contact that was printed.
fn contacts(out: &str) -> Vec<[f64; 4]> {
    let contact = |line: &str| {
        let fields: Vec<&str> = line.split('\t').collect();
        assert_eq!(fields.len(), 10, "{line}");
        [0, 1, 2, 3].map(|field| fields[field].parse().unwrap())
    };
    out.lines().map(contact).collect()
}

fn off_mm(contact: &[f64; 4], [x, y]: [f64; 2]) -> f64 {
    (contact[2] - x * 1e3).hypot(contact[3] - y * 1e3)
}

#[test]
fn a_recorded_finger_is_found_in_the_frames_in_which_it_pressed() {
    let desk = Desk::with_patch();
    recorded(&desk);
    let done =
        desk.run(&["replay", "run.csv", "--patch", "skin.dermatome", "--json", "replay.json"]).success();
    let found = contacts(&done.out);
    let frames: Vec<f64> = found.iter().map(|contact| contact[0]).collect();
    assert_eq!(frames, (20..30).map(f64::from).collect::<Vec<_>>());
    for contact in &found {
        assert!(
            (contact[1] - contact[0] / 50.0).abs() < 1e-6,
            "the patch has 50 frames a second: {contact:?}"
        );
        assert!(off_mm(contact, FINGER) < 4.0, "{contact:?}");
    }
    assert!(done.err.contains("without times: taken as 50 a second"), "{}", done.err);
    assert!(done.err.contains("20 frames replayed, 10 with contacts, at most 1 at once"), "{}", done.err);
    let report = desk.report("replay.json");
    assert_snapshot!("replay_json", shape(&report));
    assert_eq!((&report["frames_with_contacts"], &report["reference_frames"]), (&10.into(), &20.into()));
}

#[test]
fn times_of_the_recording_count_and_a_rate_is_taken_as_given() {
    let desk = Desk::with_patch();
    recorded(&desk);
    let times: String = (0..40).fold(String::new(), |mut text, frame| {
        writeln!(text, "{:.3}", 100.0 + 0.1 * f64::from(frame)).unwrap();
        text
    });
    desk.write("times.csv", times);
    let replay = ["replay", "run.csv", "--patch", "skin.dermatome"];
    let timed = desk.run(&[&replay[..], &["--times", "times.csv", "--json", "r.json"]].concat()).success();
    let found = contacts(&timed.out);
    assert_eq!(found.first().map(|contact| contact[..2].to_vec()), Some(vec![20.0, 102.0]));
    assert!(!timed.err.contains("without times"), "{}", timed.err);
    assert_eq!(desk.report("r.json")["frame_rate"], Value::Null);
    let rated = desk.run(&[&replay[..], &["--rate", "10"]].concat()).success();
    assert_eq!(contacts(&rated.out)[0][..2], [20.0, 2.0]);
    assert!(!rated.err.contains("without times"), "{}", rated.err);
}

#[test]
fn with_the_skins_pose_each_frame_is_a_line_of_json_in_the_links_frame() {
    let desk = Desk::empty();
    desk.write("skin.toml", format!("{TINY}{POSE}"));
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    recorded(&desk);
    let replay = ["replay", "run.csv", "--patch", "skin.dermatome", "--rate", "50"];
    let plain = contacts(&desk.run(&replay).success().out);
    let done = desk.run(&[&replay[..], &["--skin", "skin.toml"]].concat()).success();
    let frames: Vec<Value> = done.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let counts: Vec<usize> = frames.iter().map(|frame| frame["contacts"].as_array().unwrap().len()).collect();
    assert_eq!(counts, [[1; 10], [0; 10]].concat());
    for (frame, contact) in frames.iter().zip(&plain) {
        assert_eq!((&frame["link"], frame["sequence"].as_f64().unwrap()), (&"palm".into(), contact[0]));
        // A quarter of a turn: the skin's x is the link's y.
        let place = |axis: usize| frame["contacts"][0]["position_m"][axis].as_f64().unwrap();
        let expected = [1.0 - contact[3] * 1e-3, 2.0 + contact[2] * 1e-3, 3.0];
        assert!((0..3).all(|axis| (place(axis) - expected[axis]).abs() < 1e-5), "{frame} {expected:?}");
        assert_eq!(frame["contacts"][0]["id"], 1);
    }
    desk.write("other.toml", format!("{TINY}{POSE}").replace("columns = 16", "columns = 15"));
    let other = desk.run(&[&replay[..], &["--skin", "other.toml"]].concat()).refused();
    assert!(other.contains("`other.toml`: its pixels do not lie where"), "{other}");
}

#[test]
fn presses_learnt_from_are_replayed_each_against_its_own_reference() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    let mut bench = Bench::new(2);
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let (mut presses, mut frames, mut idle, mut places) =
        (String::new(), String::new(), String::new(), Vec::new());
    for _ in 0..60 {
        let (radius, angle) =
            (0.04 * random.random::<f64>().sqrt(), random.random_range(0.0..std::f64::consts::TAU));
        let place: [f64; 2] = [radius * angle.cos(), radius * angle.sin()];
        let frame = bench.frames(&[Press::finger(place, 0.008, random.random_range(0.4..1.2))], 1);
        write!(presses, "{:.6},{:.6},{frame}", place[0], place[1]).unwrap();
        frames += &frame;
        idle += &bench.frames(&[], 1);
        places.push(place);
    }
    desk.write("presses.csv", presses);
    desk.write("frames.csv", frames);
    desk.write("idle.csv", idle);
    desk.run(&["learn", "skin.toml", "--presses", "presses.csv", "--reference", "idle.csv"]).success();
    for each in [&["--each"][..], &[]] {
        let replay = [
            "replay",
            "frames.csv",
            "--patch",
            "tiny.dermatome",
            "--reference",
            "idle.csv",
            "--json",
            "r.json",
        ];
        let done = desk.run(&[&replay[..], each].concat()).success();
        let found = contacts(&done.out);
        assert_eq!(desk.report("r.json")["reference_frames"], if each.is_empty() { 60 } else { 1 });
        let mut errors: Vec<f64> =
            found.iter().map(|contact| off_mm(contact, places[contact[0] as usize])).collect();
        errors.sort_by(f64::total_cmp);
        println!("{each:?}: {} contacts of 60 presses, median error {:.2} mm", found.len(), errors[30]);
        assert!((58..=62).contains(&found.len()) && errors[30] < 2.5, "{} {:.2}", found.len(), errors[30]);
    }
}

/// Contacts without number and time of their frames, which a board counts for itself.
fn places(out: &str) -> Vec<String> {
    out.lines().map(|line| line.split('\t').skip(2).take(7).collect::<Vec<_>>().join(" ")).collect()
}

/// A patch that finds contacts in the image, presses that drift, and their references.
fn drifting(desk: &Desk) {
    let text = TINY.replace("[contact]", "[contact]\nfound_in = \"image\"");
    desk.write("skin.toml", text);
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    let mut bench = Bench::new(4);
    let (mut pressed, mut before) = (String::new(), String::new());
    for press in 0..12 {
        let angle = f64::from(press) * 0.5;
        let place = [0.025 * angle.cos(), 0.025 * angle.sin()];
        let drift = |text: &str| {
            let value = |(m, cell): (usize, &str)| {
                cell.parse::<f64>().unwrap() * (1.0 + 0.1 * (f64::from(press) * 7.0 + m as f64).sin())
            };
            row(&text.trim().split(',').enumerate().map(value).collect::<Vec<_>>())
        };
        pressed += &drift(&bench.frames(&[Press::finger(place, 0.01, 1.0)], 1));
        before += &drift(&bench.frames(&[], 1));
    }
    desk.write("pressed.csv", pressed);
    desk.write("before.csv", before);
}

#[test]
fn what_a_replay_of_others_frames_records_is_replayed_bit_for_bit() {
    let desk = Desk::with_patch();
    recorded(&desk);
    desk.write("idle.csv", Bench::new(5).frames(&[], 30));
    let replay =
        ["replay", "run.csv", "--patch", "skin.dermatome", "--rate", "20", "--record", "run.mcap", "--force"];
    for more in [&[][..], &["--reference", "idle.csv"]] {
        let done = desk.run(&[&replay[..], more].concat()).success();
        assert!(done.err.contains("frames to run.mcap"), "{}", done.err);
        let again = desk.run(&["replay", "run.mcap", "--json", "again.json"]).success();
        assert!(again.err.contains("bit for bit"), "{}", again.err);
        assert_eq!(places(&again.out), places(&done.out));
        assert!(done.out.lines().count() >= 10, "{}", done.out);
        let report = desk.report("again.json");
        let frames = if more.is_empty() { 20 } else { 40 };
        assert_eq!(
            (&report["same"]["images_compared"], &report["frames_before_reference"]),
            (&frames.into(), &0.into())
        );
        assert_eq!((&report["recorded_at"], &report["is_whole"]), (&"run.csv".into(), &true.into()));
        if more.is_empty() {
            assert_eq!(again.out, done.out, "numbers and times are those of the file");
        }
    }
}

#[test]
fn presses_each_with_its_reference_are_recorded_and_replayed_bit_for_bit() {
    let desk = Desk::empty();
    drifting(&desk);
    let replay = [
        "replay",
        "pressed.csv",
        "--patch",
        "skin.dermatome",
        "--reference",
        "before.csv",
        "--each",
        "--record",
        "run.mcap",
    ];
    let done = desk.run(&replay).success();
    assert!(done.out.lines().count() >= 12, "{}", done.out);
    let again = desk.run(&["replay", "run.mcap", "--json", "again.json"]).success();
    assert!(again.err.contains("bit for bit"), "{}", again.err);
    assert_eq!(places(&again.out), places(&done.out));
    assert_eq!(desk.report("again.json")["same"]["images_compared"], 12);
}

#[test]
fn a_recording_of_others_frames_on_a_link_holds_its_pose() {
    let desk = Desk::empty();
    desk.write("skin.toml", format!("{TINY}{POSE}"));
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    recorded(&desk);
    for skin in [&["--patch", "skin.dermatome", "--skin", "skin.toml"][..], &["--skin", "skin.toml"]] {
        let replay =
            [&["replay", "run.csv", "--rate", "50", "--record", "run.mcap", "--force"][..], skin].concat();
        let done = desk.run(&replay).success();
        assert!(done.out.lines().next().unwrap().contains("\"link\":\"palm\""), "{}", done.out);
        let again = desk.run(&["replay", "run.mcap", "--skin", "skin.toml"]).success();
        assert!(again.err.contains("bit for bit"), "{}", again.err);
        assert_eq!(again.out, done.out);
    }
}

#[test]
fn a_board_that_plays_others_frames_sends_what_replay_prints() {
    let desk = Desk::with_patch();
    recorded(&desk);
    let plain = ["replay", "run.csv", "--patch", "skin.dermatome", "--rate", "200"];
    let replayed = places(&desk.run(&plain).success().out);
    assert!(replayed.len() >= 10);
    let (_board, port) = playing(&desk, &plain);
    let done = desk.run(&["stream", "--port", &port, "--frames", "20"]).success();
    assert_eq!(places(&done.out), replayed);
    // Behind its end it begins anew, and other commands work on it as well.
    desk.run(&["stream", "--port", &port, "--frames", "60"]).success();
    desk.run(&["tare", "--port", &port]).success();
    let devices = desk.run(&["devices", "--port", &port]).success();
    assert!(devices.out.contains("replay") && devices.out.contains("200"), "{}", devices.out);
    // Nobody knows the stack of a board that there is not.
    let check = desk.run(&["check", "--port", &port]);
    assert!(check.out.contains("free stack") && !check.out.contains("never used"), "{check:?}");
}

#[test]
fn a_board_that_plays_presses_compares_each_with_its_own_reference() {
    let desk = Desk::empty();
    drifting(&desk);
    let each = ["replay", "pressed.csv", "--skin", "skin.toml", "--reference", "before.csv", "--each"];
    let replayed = places(&desk.run(&each).success().out);
    assert!(replayed.len() >= 12);
    let (_board, port) = playing(&desk, &[&each[..], &["--rate", "100"]].concat());
    let done = desk.run(&["stream", "--port", &port, "--frames", "12"]).success();
    assert_eq!(places(&done.out), replayed);
}

/// The full square of electrode potentials that make these differences, a drive after the other.
fn potentials(differences: &[f64], steps: &[Step]) -> Vec<f64> {
    let mut square = vec![0.0; 64];
    for drive in 0..8 {
        let of_pair = |plus: usize| {
            let is_it = |step: &Step| {
                usize::from(step.drive_minus) == drive && usize::from(step.sense_plus) == plus % 8
            };
            steps.iter().position(is_it).map(|step| differences[step])
        };
        // Pairs that touch driven electrodes are not measured; the others follow one another round the skin.
        let first = (0..8).find(|&plus| of_pair(plus).is_some() && of_pair(plus + 7).is_none()).unwrap();
        let mut potential = 1.0;
        for plus in first..first + 8 {
            square[drive * 8 + plus % 8] = potential;
            potential -= of_pair(plus).unwrap_or(0.0);
        }
    }
    square
}

#[test]
fn potentials_of_electrodes_are_replayed_as_their_differences() {
    let desk = Desk::with_patch();
    recorded(&desk);
    let steps = Bench::new(1).skin.steps();
    let of_line = |line: &str| {
        let differences: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let square = potentials(&differences, &steps);
        square.iter().map(|value| format!("{value:.15e}")).collect::<Vec<_>>().join(",") + "\n"
    };
    let text = String::from_utf8(desk.read("run.csv")).unwrap();
    desk.write("potentials.csv", text.lines().map(of_line).collect::<String>());
    let replay = |file: &str, more: &[&str]| {
        let command = ["replay", file, "--patch", "skin.dermatome", "--rate", "50"];
        contacts(&desk.run(&[&command[..], more].concat()).success().out)
    };
    let (differences, potentials) = (replay("run.csv", &[]), replay("potentials.csv", &["--single-ended"]));
    assert!(differences.len() >= 10);
    assert_eq!(potentials.len(), differences.len());
    for (a, b) in potentials.iter().zip(&differences) {
        assert!((0..4).all(|field| (a[field] - b[field]).abs() < 2e-3), "{a:?} {b:?}");
    }
}

/// A board that plays what a replay would print, and its port.
fn playing(desk: &Desk, replay: &[&str]) -> (Running, String) {
    let mut board = desk.start(&[replay, &["--listen", "tcp:127.0.0.1:0"]].concat());
    let line = board.line();
    let port = line.trim().rsplit(' ').next().unwrap().to_owned();
    (board, port)
}

#[test]
fn what_cannot_be_replayed_is_refused_by_file_and_value() {
    let desk = Desk::with_patch();
    recorded(&desk);
    desk.write("short.csv", "1,2,3\n4,5,6\n");
    desk.write("idle.csv", row(&tiny_voltages()));
    desk.write("zero.csv", row(&[0.0; 40]));
    desk.write("backwards.csv", (0..40).rev().map(|frame| format!("{frame}\n")).collect::<String>());
    desk.write("few.csv", "1\n2\n3\n");
    let replay = |more: &[&'static str]| [&["replay", "run.csv", "--patch", "skin.dermatome"], more].concat();
    let commands: Vec<Vec<&str>> = vec![
        vec!["replay", "run.csv", "--patch", "none.dermatome"],
        vec!["replay", "run.csv", "--patch", "skin.toml"],
        vec!["replay", "none.csv", "--patch", "skin.dermatome"],
        vec!["replay", "short.csv", "--patch", "skin.dermatome", "--tare", "1"],
        vec!["replay", "idle.csv", "--patch", "skin.dermatome"],
        replay(&["--tare", "40"]),
        replay(&["--reference", "short.csv"]),
        replay(&["--reference", "zero.csv"]),
        replay(&["--reference", "run.csv", "--each"]),
        replay(&["--each"]),
        replay(&["--times", "backwards.csv"]),
        replay(&["--times", "few.csv"]),
        replay(&["--rate", "0"]),
        replay(&["--rotation", "8"]),
        replay(&["--skin", "skin.toml"]),
    ];
    let commands: Vec<&[&str]> = commands.iter().map(Vec::as_slice).collect();
    let mut settings = Settings::clone_current();
    settings.set_omit_expression(true);
    settings.bind(|| assert_snapshot!("errors_replay", transcript(&desk, &commands)));
}

/// The real hydrogel skin: a patch learnt from its presses on its own recordings.
#[test]
fn a_patch_learnt_from_real_presses_finds_real_touches_in_recordings() {
    if !Path::new(REAL).exists() {
        eprintln!("NOT RUN: hydrogel_skin_wam.npz is absent, so no real recording was replayed");
        return;
    }
    let desk = Desk::empty();
    desk.write("skin.toml", HYDROGEL);
    let learn = ["learn", "skin.toml", "--presses", REAL, "--weights", "magnitude"];
    desk.start(&learn).finish_within(Duration::from_secs(300)).success();
    let replay = |key: &str| {
        let files = ["pressed", "unpressed"].map(|part| format!("{REAL}:{key}{part}"));
        let [frames, reference] = &files;
        let arguments =
            ["replay", frames, "--patch", "hydrogel.dermatome", "--reference", reference, "--each"];
        contacts(&desk.run(&arguments).success().out)
    };
    let of_frames = |found: &[[f64; 4]]| {
        let count = |frame: usize| found.iter().filter(|contact| contact[0] == frame as f64).count();
        (0..8).map(count).collect::<Vec<_>>()
    };
    let (far, near) = (of_frames(&replay("multitouchA_")), of_frames(&replay("multitouchB_")));
    println!("contacts of two touches: far {far:?}, near {near:?}");
    assert_eq!(far, [2; 8]);
    assert!(near.iter().all(|count| (1..=2).contains(count)), "{near:?}");
    let places = dermatome::recorded::read::read(&dermatome::recorded::read::Source {
        path: REAL.into(),
        key: Some("positions_m".to_owned()),
    })
    .unwrap();
    let places: Vec<[f64; 2]> = places.iter().map(|place| [place[0].re, place[1].re]).collect();
    let found = replay("v_");
    let mut errors: Vec<f64> =
        found.iter().map(|contact| off_mm(contact, places[contact[0] as usize])).collect();
    errors.sort_by(f64::total_cmp);
    let median = errors[errors.len() / 2];
    println!(
        "{} contacts of {} presses, most of them learnt from: median {median:.2} mm",
        found.len(),
        places.len()
    );
    assert!((396..=408).contains(&found.len()) && median < 2.6, "{} {median:.2}", found.len());
}
