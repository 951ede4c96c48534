//! The commands that talk to a board, as processes, against a simulated board.

mod program;
mod testbench;

use assert_cmd::cargo::cargo_bin;
use dermatome::simulate::board::{BoardOptions, Pace, SimulatedBoard};
use program::{Done, Running};
use serde_json::Value;
use std::{
    path::Path,
    process::{Command, Stdio},
};
use testbench::{Pressed, board_with, crc, empty_board, small_patch};

fn dermatome(arguments: &[&str], board: &SimulatedBoard) -> Command {
    let mut command = Command::new(cargo_bin("dermatome"));
    command.args(arguments).arg("--port").arg(format!("tcp:{}", board.address()));
    command
}

/// Runs a command to its end, or to its time limit.
fn run(command: &mut Command) -> Done {
    start(command).finish()
}

fn start(command: &mut Command) -> Running {
    Running::start(command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()))
}

/// Output of a command that must succeed: standard output, standard error.
fn succeed(command: &mut Command) -> (String, String) {
    let done = run(command).success();
    (done.out, done.err)
}

fn report(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn keys(report: &Value) -> Vec<&str> {
    report.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn flash_tare_and_stream_lead_from_an_empty_board_to_contacts() {
    let folder = tempfile::tempdir().unwrap();
    let (patch, json) = (folder.path().join("small.patch"), folder.path().join("report.json"));
    let bytes = small_patch("small", 50.0);
    std::fs::write(&patch, &bytes).unwrap();
    let board = empty_board();
    let (patch, json_argument) = (patch.to_str().unwrap(), json.to_str().unwrap());

    let (out, err) = succeed(&mut dermatome(&["flash", patch, "--json", json_argument], &board));
    assert!(out.contains("simulated") && out.contains("`small`"), "{out}");
    assert_eq!(err, "", "no progress bar where there is no terminal");
    let flash = report(&json);
    let expected = ["board", "duration_s", "firmware", "patch_bytes", "patch_crc", "port", "skin"];
    assert_eq!(keys(&flash), expected);
    assert_eq!(flash["patch_crc"], format!("{:#010x}", crc(&bytes)));

    succeed(&mut dermatome(&["tare", "--frames", "4", "--json", json_argument], &board));
    let tare = report(&json);
    assert_eq!(keys(&tare), ["amplitude_a", "board", "duration_s", "firmware", "frames", "port", "skin"]);
    assert_eq!(tare["frames"], 4);

    let arguments = ["stream", "--frames", "60", "--json", json_argument];
    let (out, err) = succeed(&mut dermatome(&arguments, &board));
    let stream = report(&json);
    let expected = [
        "board",
        "ended",
        "events_lost",
        "firmware",
        "frames_dropped",
        "frames_flagged",
        "frames_lost",
        "frames_received",
        "gaps",
        "images_per_second",
        "link",
        "packets_damaged",
        "port",
        "skin",
        "tared_first",
    ];
    assert_eq!(keys(&stream), expected);
    assert_eq!((&stream["frames_received"], &stream["frames_lost"]), (&60.into(), &0.into()));
    assert_eq!((&stream["ended"], &stream["tared_first"]), (&"frames".into(), &false.into()));
    assert!(err.contains("60 frames received, 0 lost") && err.contains("0 packets damaged"), "{err}");
    assert_contacts(&out);
}

/// The script raises pixel 1 by 0.1 a second: it is a contact once it is above 0.01.
fn assert_contacts(lines: &str) {
    let row = |line: &str| line.split('\t').take(7).map(|field| field.parse().unwrap()).collect();
    let rows: Vec<Vec<f64>> = lines.lines().map(row).collect();
    assert!((50..60).contains(&rows.len()), "{lines}");
    let last = &rows[rows.len() - 1];
    // Without a calibration there is no pressure; the host's time comes last.
    let is_whole =
        |line: &str| line.split('\t').skip(7).take(3).all(str::is_empty) && line.split('\t').count() == 11;
    assert!(lines.lines().all(is_whole), "{lines}");
    assert_eq!((last[0], last[2], last[3], last[4], last[5]), (4.0 + 59.0, 5.0, 5.0, 0.0, 100.0));
    assert!((last[1] - 64.0 / 50.0).abs() < 1e-6 && (last[6] - 0.118).abs() < 1e-3, "{last:?}");
}

#[test]
fn stream_tares_an_untared_board_first_and_says_so() {
    let board = board_with(&small_patch("small", 50.0));
    let (_, err) = succeed(&mut dermatome(&["stream", "--frames", "3"], &board));
    assert!(err.contains("averaging 20 frames"), "{err}");
    let (_, err) = succeed(&mut dermatome(&["stream", "--frames", "3"], &board));
    assert!(!err.contains("averaging"), "{err}");
}

#[test]
fn stream_ends_when_the_board_ends_it() {
    let options = BoardOptions {
        patch: Some(small_patch("small", 50.0)),
        pace: Pace::Unpaced,
        max_frames: Some(5),
        ..BoardOptions::default()
    };
    let board = SimulatedBoard::start(options, Pressed::new(1)).unwrap();
    let (_, err) = succeed(&mut dermatome(&["stream"], &board));
    assert!(err.contains("5 frames received") && err.contains("the board ended its stream"), "{err}");
}

/// `stream` without a limit, after its first line of output.
fn streaming(board: &SimulatedBoard) -> Running {
    let mut stream = start(&mut dermatome(&["stream"], board));
    stream.line();
    stream
}

#[test]
fn a_reader_that_has_seen_enough_ends_the_stream_quietly() {
    let board = board_with(&small_patch("small", 50.0));
    let mut stream = streaming(&board);
    stream.close_output();
    let done = stream.finish().success();
    assert!(!done.err.contains("error") && !done.err.contains("received"), "{}", done.err);
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_the_stream_and_prints_the_summary() {
    let board = board_with(&small_patch("small", 50.0));
    let stream = streaming(&board);
    stream.interrupt();
    let done = stream.finish().success();
    assert!(done.err.contains("frames received, 0 lost"), "{}", done.err);
}

#[test]
fn a_board_that_goes_in_mid_stream_is_an_error_with_a_report_of_what_came() {
    let board = board_with(&small_patch("small", 50.0));
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("stream.json");
    let arguments = ["stream", "--give-up-after", "0", "--json", json.to_str().unwrap()];
    let mut stream = start(&mut dermatome(&arguments, &board));
    stream.line();
    board.stop().unwrap();
    let err = stream.finish().refused();
    assert!(err.contains("was cut") && err.contains("frames received, 0 lost"), "{err}");
    let stream = report(&json);
    assert_eq!(stream["ended"], "error");
    assert!(stream["frames_received"].as_u64() > Some(0));
}

#[test]
fn a_board_without_patch_and_a_patch_that_is_none_are_errors() {
    let board = empty_board();
    for command in ["tare", "stream"] {
        let err = run(&mut dermatome(&[command], &board)).refused();
        assert!(err.contains("dermatome flash"), "{err}");
    }
    let file = tempfile::NamedTempFile::new().unwrap();
    let path = file.path().to_str().unwrap();
    let err = run(&mut dermatome(&["flash", path], &board)).refused();
    assert!(err.contains(path) && err.contains("patch"), "{err}");
}

#[test]
fn a_board_that_ends_its_stream_before_the_frames_asked_for_is_an_error() {
    let options = BoardOptions {
        patch: Some(small_patch("small", 50.0)),
        pace: Pace::Unpaced,
        max_frames: Some(5),
        ..BoardOptions::default()
    };
    let board = SimulatedBoard::start(options, Pressed::new(1)).unwrap();
    let err = run(&mut dermatome(&["stream", "--frames", "9"], &board)).refused();
    assert!(err.contains("ended its stream after 5 of 9 frames"), "{err}");
}

#[test]
fn a_port_nobody_could_mean_is_refused_with_the_forms_allowed() {
    let mut command = Command::new(cargo_bin("dermatome"));
    let err = run(command.args(["tare", "--port", "ttyACM0"])).refused();
    assert!(err.contains("tcp:HOST:PORT") && err.contains("/dev/ttyACM0"), "{err}");
}

#[test]
fn devices_asks_one_board_what_it_is_and_what_it_holds() {
    let folder = tempfile::tempdir().unwrap();
    let (patch, json) = (folder.path().join("small.patch"), folder.path().join("board.json"));
    std::fs::write(&patch, small_patch("small", 50.0)).unwrap();
    let board = empty_board();
    let ask = ["devices", "--json", json.to_str().unwrap()];

    let (out, _) = succeed(&mut dermatome(&ask, &board));
    for words in
        ["simulated at tcp:", "computed from a simulated skin", "ago, after power on", "patch       none"]
    {
        assert!(out.contains(words), "{words} in {out}");
    }
    assert_eq!(report(&json)["skin"], Value::Null);

    succeed(&mut dermatome(&["flash", patch.to_str().unwrap()], &board));
    let (out, _) = succeed(&mut dermatome(&ask, &board));
    assert!(out.contains("`small`") && out.contains("not tared"), "{out}");
    let answer = report(&json);
    assert_eq!((&answer["skin"], &answer["tared"]), (&Value::from("small"), &Value::from(false)));
    assert!(answer["uptime_s"].as_f64().unwrap() < 600.0);
}
