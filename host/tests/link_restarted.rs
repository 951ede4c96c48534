//! A board that restarts behind a serial adapter that stays: nothing is cut, and nothing comes.
//!
//! Apart from other tests of serial ports: a program that is started holds their ends open.
#![cfg(unix)]

mod program;
mod testbench;

use dermatome::{
    body::keeper::{Asked, Phase, State, Told},
    shared::{drive::Drive, frame::Frame, protocol::Selection},
    simulate::{
        board::{BoardOptions, SimulatedBoard},
        instrument::{Instrument, ScanTable},
    },
};
use program::{
    Desk,
    keeping::{is, keep, wait},
};
use serialport::{SerialPort, TTYPort};
use std::{
    io::{Read, Write},
    net::TcpStream,
    sync::{Arc, Mutex},
    thread,
};
use testbench::{Pressed, raw, small_patch};

/// A skin that nothing presses.
struct Untouched(Pressed);

impl Instrument for Untouched {
    fn scan(&mut self, table: &ScanTable, _script_time: Option<f64>) -> Frame {
        self.0.scan(table, None)
    }
}

/// Copies bytes to the host until the board has gone.
fn to_host(mut board: TcpStream, mut host: TTYPort) {
    board.set_read_timeout(None).unwrap();
    thread::spawn(move || {
        let mut buffer = [0; 256];
        while let Ok(length @ 1..) = board.read(&mut buffer) {
            host.write_all(&buffer[..length]).unwrap();
        }
    });
}

/// What stays when a board behind it starts anew.
struct Adapter {
    near: TTYPort,
    /// The host's end.
    far: TTYPort,
    to_board: Arc<Mutex<Option<TcpStream>>>,
}

impl Adapter {
    fn new() -> Self {
        let (near, far) = TTYPort::pair().unwrap();
        let to_board = Arc::<Mutex<Option<TcpStream>>>::default();
        let (mut from_host, written) = (near.try_clone_native().unwrap(), to_board.clone());
        // Ends with the test.
        thread::spawn(move || {
            let mut buffer = [0; 256];
            loop {
                if let Ok(length) = from_host.read(&mut buffer) {
                    // What is said to a board that is off is lost.
                    let _ = written.lock().unwrap().as_mut().map(|board| board.write_all(&buffer[..length]));
                }
            }
        });
        Self { near, far, to_board }
    }

    fn port(&self) -> String {
        self.far.name().unwrap()
    }

    /// A board with this patch, on this skin, is behind it from now on.
    fn board(&self, patch: Vec<u8>, skin: impl Instrument + 'static) -> SimulatedBoard {
        let options = BoardOptions { patch: Some(patch), ..BoardOptions::default() };
        let board = SimulatedBoard::start(options, skin).unwrap();
        let line = raw(board.address());
        *self.to_board.lock().unwrap() = Some(line.try_clone().unwrap());
        to_host(line, self.near.try_clone_native().unwrap());
        board
    }
}

#[test]
fn a_board_that_restarts_behind_an_adapter_that_stays_streams_on() {
    let adapter = Adapter::new();
    let first = adapter.board(small_patch("small", 50.0), Pressed::new(1));
    let desk = Desk::empty();
    let arguments = ["stream", "--port", &adapter.port(), "--frames", "100", "--json", "stream.json"];
    let mut stream = desk.start(&arguments);
    stream.line();
    first.stop().unwrap();
    let _second = adapter.board(small_patch("small", 50.0), Pressed::new(1));
    let done = stream.finish().success();
    assert!(done.err.contains("connected again after"), "{}", done.err);
    let report = desk.report("stream.json");
    assert_eq!((&report["frames_received"], &report["gaps"][0]["tared"]), (&100.into(), &true.into()));
    assert_eq!(report["events_lost"], 0, "{report:#}");
}

#[test]
fn a_board_that_restarts_behind_an_adapter_that_stays_gets_the_drive_that_it_had_from_its_keeper() {
    let adapter = Adapter::new();
    let desk = Desk::with_patch();
    let first = adapter.board(desk.read("skin.dermatome"), Untouched(Pressed::new(1)));
    let selection = Selection { contacts: 1, ..Selection::default() };
    let (keeper, told) = keep(&desk, &adapter.port(), selection);
    let before = wait(&told, |told| if let Told::Driven(driven) = told { Some(driven.drive) } else { None });
    wait(&told, |told| is(&told, Phase::Live).then_some(()));
    let slow = Drive { frame_rate: before.frame_rate / 2.0, ..before };
    keeper.ask(Asked::Drive(slow));
    wait(&told, |told| is(&told, Phase::Taring).then_some(()));
    wait(&told, |told| is(&told, Phase::Live).then_some(()));
    first.stop().unwrap();
    let second = adapter.board(desk.read("skin.dermatome"), Untouched(Pressed::new(1)));
    let lost = wait(&told, |told| match told {
        Told::State(State { phase: Phase::Lost, text }) => Some(text),
        _ => None,
    });
    assert!(lost.starts_with("no frame came"), "the port was opened anew: {lost}");
    wait(&told, |told| matches!(&told, Told::Driven(driven) if driven.drive == slow).then_some(()));
    wait(&told, |told| is(&told, Phase::Live).then_some(()));
    // By the board's own clock.
    let frames = (0..10).map(|_| {
        wait(
            &told,
            |told| if let Told::Frame { frame, .. } = told { Some(frame.at?.timestamp_us) } else { None },
        )
    });
    let times: Vec<u64> = frames.collect();
    let period = (times[9] - times[0]) as f64 * 1e-6 / 9.0;
    assert!((period * f64::from(slow.frame_rate) - 1.0).abs() < 0.2, "{period} s");
    // The keeper ends, though nobody answers when it ends the stream.
    second.stop().unwrap();
    drop(keeper);
}
