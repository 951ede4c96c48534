//! Recordings: what `--record` writes, what `replay` makes of it, and a recording as a port.

mod program;

use dermatome::recording::{
    frames::{Frames, Item},
    read::Recording,
};
use program::{Desk, TINY};

const POSE: &str = "\n[pose]\nlink = \"palm\"\nposition = [1, 2, \"3 m\"]\norientation = [0, 0, 0.7071067811865476, 0.7071067811865476]\n";

/// A folder with `run.mcap`: frames of a board whose electrodes come off and short on the way.
fn recorded(more: &[&str]) -> Desk {
    let desk = Desk::with_patch();
    let (board, port) = desk.board("skin.toml", &["--fault", "open:7@1s", "--fault", "short:3-4@2s"]);
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    // The board has seen another host before: numbers of frames and contacts go on.
    desk.run(&["stream", "--port", &port, "--frames", "20"]).success();
    let stream = ["stream", "--port", &port, "--frames", "150", "--record", "run.mcap"];
    let done = desk.run(&[&stream[..], more].concat()).success();
    assert!(done.err.contains("150 frames received, 0 lost"), "{}", done.err);
    assert!(done.err.contains("frames to run.mcap"), "{}", done.err);
    drop(board);
    desk
}

#[test]
fn a_replay_is_what_the_board_sent_bit_for_bit_with_faults_on_the_way() {
    let desk = recorded(&[]);
    let done = desk.run(&["replay", "run.mcap", "--json", "replay.json"]).success();
    assert!(done.err.contains("the same as simulated sent, bit for bit"), "{}", done.err);
    let report = desk.report("replay.json");
    let same = &report["same"];
    assert!(same["images_compared"].as_u64() >= Some(148), "{same}");
    assert_eq!(same["images_compared"], same["contacts_compared"]);
    assert_eq!((&same["images_differ"], &same["contacts_differ"]), (&0.into(), &0.into()));
    assert_eq!((&report["is_whole"], &same["frames_missing"]), (&true.into(), &0.into()));
    let flagged = report["frames_flagged"].as_object().unwrap();
    for flag in ["open electrode", "shorted electrode", "bad electrodes masked"] {
        assert!(flagged.contains_key(flag), "{flag}: {report}");
    }
    assert!(report["frames_with_contacts"].as_u64() > Some(20), "{report}");
}

#[test]
fn contacts_on_a_link_are_replayed_as_they_were_recorded() {
    let desk = Desk::with_patch();
    desk.write("posed.toml", TINY.to_owned() + POSE);
    let (_board, port) = desk.board("skin.toml", &[]);
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    let stream =
        ["stream", "--port", &port, "--skin", "posed.toml", "--frames", "40", "--record", "run.mcap"];
    desk.run(&stream).success();
    let done = desk.run(&["replay", "run.mcap"]).success();
    assert!(done.err.contains("bit for bit"), "{}", done.err);
    let on_link = desk.run(&["replay", "run.mcap", "--patch", "skin.dermatome", "--skin", "posed.toml"]);
    let line = on_link.success().out.lines().last().unwrap().to_owned();
    assert!(line.contains("\"link\":\"palm\""), "{line}");
}

#[test]
fn another_patch_makes_another_image_of_the_same_frames() {
    let desk = recorded(&[]);
    let smooth = TINY.replace("hyperparameter = 0.03", "hyperparameter = 0.3");
    desk.write("smooth.toml", smooth.replace("[contact]", "[contact]\nfound_in = \"image\""));
    desk.run(&["build", "smooth.toml", "-o", "smooth.dermatome"]).success();
    let by_patch = ["replay", "run.mcap", "--patch", "smooth.dermatome"];
    let done =
        desk.run(&[&by_patch[..], &["--record", "smooth.mcap", "--json", "r.json"]].concat()).success();
    assert!(!done.err.contains("bit for bit"), "{}", done.err);
    let report = desk.report("r.json");
    assert_ne!(report["recorded_with"], report["patch_crc"]);
    assert_eq!(report["same"], serde_json::Value::Null);
    let by_skin = desk.run(&["replay", "run.mcap", "--skin", "smooth.toml"]).success();
    assert!(by_skin.out == done.out, "the patch is built of the skin file");
    let own = desk.run(&["replay", "run.mcap"]).success();
    assert!(own.out != done.out);
    // What the other patch made of it was recorded, and is replayed like any recording.
    let again = desk.run(&["replay", "smooth.mcap"]).success();
    assert!(again.err.contains("bit for bit"), "{}", again.err);
    assert!(again.out == done.out);
    let of_own = times(&desk, "run.mcap");
    assert!(of_own.len() > 160 && of_own.ends_with(&times(&desk, "smooth.mcap")), "frames keep their times");
}

/// Sequence of each frame, and when it came.
fn times(desk: &Desk, name: &str) -> Vec<(u32, u64)> {
    let mut frames = Frames::of(Recording::open(&desk.path(name)).unwrap());
    let items = std::iter::from_fn(|| frames.next_item().unwrap());
    let time = |item: Item| match item {
        Item::Frame(frame) => Some((frame.at.sequence, frame.log_time)),
        Item::Reference(_) => None,
    };
    items.filter_map(time).collect()
}

#[test]
fn a_patch_that_needs_what_was_not_measured_is_refused_by_the_step() {
    let desk = recorded(&[]);
    desk.write("opposite.toml", TINY.replace("pattern = \"adjacent\"", "pattern = \"opposite\""));
    desk.run(&["build", "opposite.toml", "-o", "opposite.dermatome"]).success();
    let words = desk.run(&["replay", "run.mcap", "--patch", "opposite.dermatome"]).refused();
    assert!(words.contains("`run.mcap`") && words.contains("does not hold"), "{words}");
}

#[test]
fn a_recording_is_a_port_of_other_commands() {
    let desk = recorded(&[]);
    let contacts = |out: &str| -> Vec<String> {
        // x to force: frames are counted anew, and come now.
        out.lines().map(|line| line.split('\t').skip(2).take(7).collect::<Vec<_>>().join(" ")).collect()
    };
    let replayed = contacts(&desk.run(&["replay", "run.mcap"]).success().out);
    let streamed = desk.run(&["stream", "--port", "replay:run.mcap", "--frames", "140"]).success();
    let streamed = contacts(&streamed.out);
    assert!(streamed.len() > 20);
    assert_eq!(streamed[..], replayed[..streamed.len()]);
    let mut board = desk.start(&["replay", "run.mcap", "--listen", "tcp:127.0.0.1:0"]);
    let line = board.line();
    let port = line.trim().rsplit(' ').next().unwrap().to_owned();
    let streamed = desk.run(&["stream", "--port", &port, "--frames", "140"]).success();
    assert_eq!(contacts(&streamed.out), replayed[..contacts(&streamed.out).len()]);
    // Behind its end it begins anew.
    let long = desk.run(&["stream", "--port", &port, "--frames", "200"]);
    assert!(long.success().err.contains("200 frames received"));
}

#[test]
fn a_recording_is_cut_anywhere_and_what_is_before_is_replayed() {
    let desk = recorded(&[]);
    let bytes = desk.read("run.mcap");
    let whole = desk.run(&["replay", "run.mcap"]).success().out;
    for part in [0.3, 0.6, 0.9, 0.999] {
        desk.write("cut.mcap", &bytes[..(part * bytes.len() as f64) as usize]);
        let done = desk.run(&["replay", "cut.mcap", "--json", "cut.json"]).success();
        assert!(done.err.contains("the recording was cut off"), "{part}: {}", done.err);
        assert!(done.err.contains("bit for bit"), "{part}: {}", done.err);
        assert!(whole.starts_with(&done.out), "{part}");
        assert_eq!(desk.report("cut.json")["is_whole"], false);
    }
}

#[test]
fn a_recording_takes_no_files_place_and_a_full_disk_is_told() {
    let desk = Desk::with_patch();
    desk.write("there.mcap", "mine");
    let stream = ["stream", "--port", "sim:skin.toml", "--frames", "5", "--record"];
    let words = desk.run(&[&stream[..], &["there.mcap"]].concat()).refused();
    assert!(words.contains("there.mcap") && words.contains("--force"), "{words}");
    assert_eq!(desk.read("there.mcap"), b"mine");
    desk.run(&[&stream[..], &["there.mcap", "--force"]].concat()).success();
    if cfg!(target_os = "linux") {
        let words = desk.run(&[&stream[..], &["/dev/full"]].concat()).refused();
        assert!(words.contains("/dev/full") && words.to_lowercase().contains("space"), "{words}");
    }
}

#[test]
fn what_is_no_recording_is_refused_in_words() {
    let desk = recorded(&[]);
    desk.write("empty.mcap", "");
    desk.write("text.mcap", "time,pressure\n0,1\n");
    desk.write("start.mcap", &desk.read("run.mcap")[..300]);
    for (arguments, words) in [
        (vec!["replay", "empty.mcap"], "no recording"),
        (vec!["replay", "text.mcap"], "no recording"),
        (vec!["replay", "none.mcap"], "no recording"),
        (vec!["replay", "start.mcap"], "before the patch"),
        (
            vec!["replay", "text.mcap", "--listen", "tcp:127.0.0.1:0", "--patch", "skin.dermatome"],
            "must end in",
        ),
        (vec!["stream", "--port", "replay:none.mcap"], "none.mcap"),
        (vec!["stream", "--port", "replay:text.mcap"], "no MCAP file"),
        (vec!["replay", "run.mcap", "--patch", "skin.toml"], "skin.toml"),
        (vec!["replay", "run.mcap", "--listen", "0.0.0.0:0"], "tcp:HOST:PORT"),
    ] {
        let told = desk.run(&arguments).refused();
        assert!(told.contains(words), "{arguments:?}: {told}");
    }
}

#[test]
fn the_demo_and_a_calibration_are_recorded_and_replayed() {
    let desk = Desk::with_patch();
    desk.write("loads.csv", "time_s,pressure_kpa\n0,0\n0.4,1\n0.8,2\n1.2,3\n");
    let calibrate = ["calibrate", "skin.dermatome", "--port", "sim:skin.toml", "--loads", "loads.csv"];
    // Whether these loads make a curve is another matter: they were recorded.
    desk.run(&[&calibrate[..], &["--record", "loads.mcap", "--save", "readings.csv"]].concat());
    desk.run(&["demo", "--record", "demo.mcap"]).success();
    for (file, least) in [("loads.mcap", 50), ("demo.mcap", 300)] {
        let done = desk.run(&["replay", file, "--json", "r.json"]).success();
        assert!(done.err.contains("bit for bit"), "{}", done.err);
        assert!(desk.report("r.json")["same"]["images_compared"].as_u64() >= Some(least), "{file}");
    }
}
