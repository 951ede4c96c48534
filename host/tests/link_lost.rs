//! Boards that are lost while somebody streams from them: restarted, cut off, killed, silent.

mod program;
mod testbench;

use dermatome::simulate::board::{BoardOptions, SimulatedBoard};
use dermatome_shared::{
    drive::Drive,
    protocol::{Info, PatchInfo, Reply, Request, Selection, Version},
};
use program::{Desk, Running};
use serde_json::Value;
use std::{
    net::SocketAddr,
    thread,
    time::{Duration, Instant},
};
use testbench::{Held, Pressed, cable::Cable, connect, fake_board, hello, info, small_patch};

/// A board at 50 frames a second that holds `patch`, at `listen`.
fn board_at(listen: SocketAddr, patch: Vec<u8>) -> SimulatedBoard {
    let options = BoardOptions { listen, patch: Some(patch), ..BoardOptions::default() };
    SimulatedBoard::start(options, Pressed::new(1)).unwrap()
}

fn board() -> SimulatedBoard {
    board_at(([127, 0, 0, 1], 0).into(), small_patch("small", 50.0))
}

/// `stream` from `address`, after its first line.
fn streaming(desk: &Desk, address: SocketAddr, more: &[&str]) -> Running {
    let port = format!("tcp:{address}");
    let mut stream = desk.start(&[&["stream", "--port", &port, "--json", "stream.json"], more].concat());
    stream.line();
    stream
}

fn only_gap(report: &Value) -> &Value {
    let [gap] = report["gaps"].as_array().unwrap().as_slice() else { panic!("{report:#}") };
    gap
}

#[test]
fn a_board_that_was_restarted_streams_on_with_a_new_reference_and_its_drive() {
    let desk = Desk::empty();
    let first = board();
    let address = first.address();
    let drive = Drive::new(50e3, 0.5e-3, 100.0);
    connect(address).unwrap().request(&Request::Drive(Some(drive))).unwrap();
    let stream = streaming(&desk, address, &["--frames", "150"]);
    first.stop().unwrap();
    let _second = board_at(address, small_patch("small", 50.0));
    let done = stream.finish().success();
    let report = desk.report("stream.json");
    assert_eq!((&report["frames_received"], &report["ended"]), (&150.into(), &"frames".into()));
    let gap = only_gap(&report);
    assert_eq!((&gap["drive_restored"], &gap["tared"]), (&true.into(), &true.into()));
    for words in ["lost the board: ", "setting it again", "averaging 20 frames", "connected again after"] {
        assert!(done.err.contains(words), "{words} in {}", done.err);
    }
    assert_eq!(done.out.lines().filter(|line| line.starts_with("# gap of ")).count(), 1, "{}", done.out);
    assert_eq!(connect(address).unwrap().info().unwrap().drive, Some(drive));
}

#[test]
fn a_board_that_was_restarted_makes_no_reference_of_a_skin_that_is_pressed() {
    let desk = Desk::empty();
    let first = board();
    let address = first.address();
    let stream = streaming(&desk, address, &["--frames", "60"]);
    first.stop().unwrap();
    let patch = Some(small_patch("small", 50.0));
    let options = BoardOptions { listen: address, patch, ..BoardOptions::default() };
    let _second = SimulatedBoard::start(options, Held::new(8)).unwrap();
    let done = stream.finish().success();
    let said = |words| done.err.rfind(words).unwrap_or_else(|| panic!("{words} in {}", done.err));
    assert!(said("something presses on the skin") < said("averaging 20 frames"), "{}", done.err);
    assert_eq!(only_gap(&desk.report("stream.json"))["tared"], true);
}

#[test]
fn a_cable_that_was_pulled_costs_frames_but_no_reference() {
    let desk = Desk::empty();
    let board = board();
    let cable = Cable::to(board.address());
    let stream = streaming(&desk, cable.address(), &["--frames", "100"]);
    let pulled = Instant::now();
    cable.pull();
    thread::sleep(Duration::from_millis(300));
    cable.plug_in();
    stream.finish().success();
    let report = desk.report("stream.json");
    let gap = only_gap(&report);
    assert_eq!((&report["frames_received"], &gap["tared"]), (&100.into(), &false.into()));
    assert!(
        (0.3..=pulled.elapsed().as_secs_f64() + 1.0).contains(&gap["seconds"].as_f64().unwrap()),
        "{gap}"
    );
    assert!(gap["frames_missed"].as_u64() >= Some(14), "{gap}");
}

#[test]
fn a_board_that_stays_away_is_an_error_once_the_time_to_give_up_has_come() {
    let desk = Desk::empty();
    let board = board();
    let stream = streaming(&desk, board.address(), &["--give-up-after", "2"]);
    board.stop().unwrap();
    let words = stream.finish().refused();
    assert!(words.contains("trying again") && words.contains("has sent no frame for"), "{words}");
    assert!(words.contains("no board listens there"), "{words}");
    assert_eq!(desk.report("stream.json")["ended"], "error");
}

#[test]
fn a_board_that_comes_back_with_another_patch_is_an_error() {
    let desk = Desk::empty();
    let first = board();
    let address = first.address();
    let stream = streaming(&desk, address, &[]);
    first.stop().unwrap();
    let _second = board_at(address, small_patch("other", 50.0));
    let words = stream.finish().refused();
    assert!(words.contains("another patch than before, `other`"), "{words}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_the_wait_for_a_lost_board_at_once() {
    let desk = Desk::empty();
    let board = board();
    let stream = streaming(&desk, board.address(), &[]);
    board.stop().unwrap();
    thread::sleep(Duration::from_millis(300));
    let asked = Instant::now();
    stream.interrupt();
    stream.finish().success();
    assert!(asked.elapsed() < Duration::from_secs(10), "{:?}", asked.elapsed());
    assert_eq!(desk.report("stream.json")["ended"], "interrupt");
}

/// What a board says that holds a patch of 50 frames a second and streams.
fn streams() -> Reply {
    let Reply::Info(info) = info(8, 1000) else { unreachable!() };
    let drive = Drive::new(50e3, 1e-3, 50.0);
    let skin = "small".try_into().unwrap();
    let patch = PatchInfo { crc: 1, electrodes: 8, steps: 40, measurements: 40, pixels: 4, drive, skin };
    let streaming = Selection { contacts: 1, ..Selection::default() };
    Reply::Info(Info { drive: Some(drive), patch: Some(patch), tared: true, streaming, ..info })
}

#[test]
fn a_board_that_says_that_it_streams_and_sends_nothing_is_lost() {
    let address = fake_board(|request| match request {
        Request::Hello(_) => Some(hello(Version::current())),
        Request::Info => Some(streams()),
        Request::Stream(_) => Some(Reply::Streaming { first_sequence: 0 }),
        _ => Some(Reply::Done),
    });
    let desk = Desk::empty();
    let port = format!("tcp:{address}");
    let words = desk.run(&["stream", "--port", &port, "--give-up-after", "0"]).refused();
    assert!(
        words.contains("nothing came from the board") && words.contains("says that it streams"),
        "{words}"
    );
}

#[cfg(unix)]
#[test]
fn a_reader_that_stalls_gets_no_old_frames_and_reads_how_many_were_dropped() {
    let desk = Desk::empty();
    let skin = Pressed::new(1);
    let log = skin.log.clone();
    let patch = Some(small_patch("small", 1000.0));
    let options = BoardOptions { patch, ..BoardOptions::default() };
    let board = SimulatedBoard::start(options, skin).unwrap();
    let mut stream = streaming(&desk, board.address(), &[]);
    // The pipe holds some 1,500 frames, the program a second.
    let started = Instant::now();
    while log.lock().unwrap().len() < 6000 {
        assert!(started.elapsed() < Duration::from_secs(60), "only {} scans", log.lock().unwrap().len());
        thread::sleep(Duration::from_millis(20));
    }
    let sequence = |line: &str| line.split('\t').next().unwrap().parse::<u32>().unwrap();
    let mut before = 0;
    let dropped = loop {
        let line = stream.line();
        if line.starts_with('#') {
            break line;
        }
        before = sequence(&line);
    };
    assert!(dropped.contains(" frames dropped"), "{dropped}");
    let after = sequence(&stream.line());
    // Some that wait are fresh enough, where scans are slow.
    assert!(before < 5000 && after > before + 500, "{before} {after}");
    stream.interrupt();
    let done = stream.finish().success();
    assert!(done.err.contains("standard output was not read in time"), "{}", done.err);
    assert!(desk.report("stream.json")["frames_dropped"].as_u64() >= Some(500), "{}", done.err);
}
