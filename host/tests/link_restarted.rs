//! A board that restarts behind a serial adapter that stays: nothing is cut, and nothing comes.
//!
//! Apart from other tests of serial ports: a program that is started holds their ends open.
#![cfg(unix)]

mod program;
mod testbench;

use dermatome::simulate::board::{BoardOptions, SimulatedBoard};
use program::Desk;
use serialport::{SerialPort, TTYPort};
use std::{
    io::{Read, Write},
    net::TcpStream,
    sync::{Arc, Mutex},
    thread,
};
use testbench::{Pressed, raw, small_patch};

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

/// A board of 50 frames a second, and a line to it.
fn small_board() -> (SimulatedBoard, TcpStream) {
    let options = BoardOptions { patch: Some(small_patch("small", 50.0)), ..BoardOptions::default() };
    let board = SimulatedBoard::start(options, Pressed::new(1)).unwrap();
    let line = raw(board.address());
    (board, line)
}

#[test]
fn a_board_that_restarts_behind_an_adapter_that_stays_streams_on() {
    let (near, far) = TTYPort::pair().unwrap();
    let port = far.name().unwrap();
    let (first, line) = small_board();
    to_host(line.try_clone().unwrap(), near.try_clone_native().unwrap());
    let to_board = Arc::new(Mutex::new(line));
    let (mut from_host, written) = (near.try_clone_native().unwrap(), to_board.clone());
    // Ends with the test.
    thread::spawn(move || {
        let mut buffer = [0; 256];
        loop {
            if let Ok(length) = from_host.read(&mut buffer) {
                // What is said to a board that is off is lost.
                let _ = written.lock().unwrap().write_all(&buffer[..length]);
            }
        }
    });
    let desk = Desk::empty();
    let mut stream = desk.start(&["stream", "--port", &port, "--frames", "100", "--json", "stream.json"]);
    stream.line();
    first.stop().unwrap();
    let (_second, line) = small_board();
    *to_board.lock().unwrap() = line.try_clone().unwrap();
    to_host(line, near);
    let done = stream.finish().success();
    assert!(done.err.contains("connected again after"), "{}", done.err);
    let report = desk.report("stream.json");
    assert_eq!((&report["frames_received"], &report["gaps"][0]["tared"]), (&100.into(), &true.into()));
    assert_eq!(report["events_lost"], 0, "{report:#}");
}
