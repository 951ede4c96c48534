//! Boards that are lost, that are none, or not the right ones.

use super::{
    handle::Handle,
    testbench::{
        Pressed, board_with,
        cable::{Cable, Carries},
        crc, empty_board, fake_board, hello, raw, small_patch, square_patch,
    },
};
use dermatome::simulate::board::{BoardOptions, SimulatedBoard};
use dermatome_c::{codes::*, records::Options};
use dermatome_shared::protocol::{Request, Version};
use std::{
    io::{Read, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{Arc, Mutex, mpsc::channel},
    thread,
    time::{Duration, Instant},
};

fn options(patch: Vec<u8>) -> BoardOptions {
    BoardOptions { patch: Some(patch), ..BoardOptions::default() }
}

/// A board of 8 electrodes at 50 frames a second.
fn small_board() -> SimulatedBoard {
    SimulatedBoard::start(options(small_patch("small", 50.0)), Pressed::new(1)).unwrap()
}

fn refused(port: &str) -> (i32, String) {
    Handle::open(port).map(drop).unwrap_err()
}

#[test]
fn a_board_that_was_restarted_is_cut_and_opened_anew() {
    let first = small_board();
    let address = first.address();
    let handle = Handle::at(address);
    handle.start_plainly().unwrap();
    handle.frame().unwrap();
    first.stop().unwrap();
    assert_eq!(handle.poll_until(|code| code < 0), DERMATOME_CUT);
    assert!(handle.error().contains("was cut"), "{}", handle.error());
    assert_eq!(handle.poll_until(|_| true), DERMATOME_CUT, "it stays so");
    let again = BoardOptions { listen: address, ..options(small_patch("small", 50.0)) };
    let _second = SimulatedBoard::start(again, Pressed::new(1)).unwrap();
    let handle = Handle::at(address);
    handle.start_plainly().unwrap();
    assert_eq!(handle.frame().unwrap().valid, 1);
}

#[test]
fn a_cable_that_is_pulled_is_cut_and_plugged_in_it_is_opened_anew() {
    let board = small_board();
    let cable = Cable::to(board.address());
    let handle = Handle::at(cable.address());
    handle.start_plainly().unwrap();
    handle.frame().unwrap();
    cable.pull();
    assert_eq!(handle.poll_until(|code| code < 0), DERMATOME_CUT);
    assert_eq!(handle.stop(), Err(DERMATOME_CUT));
    drop(handle);
    cable.plug_in();
    let handle = Handle::at(cable.address());
    handle.start_plainly().unwrap();
    handle.frame().unwrap();
}

#[test]
fn a_board_that_is_silent_says_so_and_goes_on_when_it_is_heard_again() {
    let board = small_board();
    let cable = Cable::to(board.address());
    let handle = Handle::at(cable.address());
    handle.tare(2).unwrap();
    handle.start(Options { silence_ms: 200, ..Options::default() }).unwrap();
    handle.poll_until(|code| code == DERMATOME_FRAME);
    cable.carry(Carries::Later);
    handle.poll_until(|code| code == DERMATOME_SILENT);
    assert!(handle.error().starts_with("no frame has come for "), "{}", handle.error());
    cable.carry(Carries::All);
    handle.poll_until(|code| code == DERMATOME_FRAME);
    handle.poll_until(|code| code == DERMATOME_OK);
    assert_eq!(handle.counts().frames_missing, 0);
}

/// Copies what a board sends to a host until the board has gone; the host's line stays.
fn to_host(mut board: TcpStream, mut host: TcpStream) {
    board.set_read_timeout(None).unwrap();
    thread::spawn(move || {
        let mut buffer = [0; 256];
        while let Ok(length @ 1..) = board.read(&mut buffer) {
            // Fails once the test is over.
            let _ = host.write_all(&buffer[..length]);
        }
    });
}

#[test]
fn a_board_that_restarts_behind_an_adapter_that_stays_is_silent_until_it_is_started_again() {
    let first = small_board();
    let adapter = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = adapter.local_addr().unwrap();
    let to_board = Arc::new(Mutex::new(raw(first.address())));
    let (line, (give, host)) = (to_board.clone(), channel());
    thread::spawn(move || {
        let (mut host, _) = adapter.accept().unwrap();
        to_host(line.lock().unwrap().try_clone().unwrap(), host.try_clone().unwrap());
        give.send(host.try_clone().unwrap()).unwrap();
        let mut buffer = [0; 256];
        while let Ok(length @ 1..) = host.read(&mut buffer) {
            // What is said to a board that is off is lost.
            let _ = line.lock().unwrap().write_all(&buffer[..length]);
        }
    });
    let handle = Handle::at(address);
    handle.start(Options { silence_ms: 300, ..Options::default() }).unwrap();
    handle.poll_until(|code| code == DERMATOME_FRAME);
    first.stop().unwrap();
    let second = small_board();
    *to_board.lock().unwrap() = raw(second.address());
    to_host(to_board.lock().unwrap().try_clone().unwrap(), host.recv().unwrap());
    assert_eq!(handle.poll_until(|code| code < 0), DERMATOME_SILENT);
    handle.stop().unwrap();
    handle.start_plainly().unwrap();
    let frame = handle.frame().unwrap();
    assert_eq!((frame.valid, frame.counts.tares), (1, 1), "it has made a reference of its own");
}

#[test]
fn a_patch_that_is_not_there_or_another_one_is_refused() {
    let empty = empty_board();
    let handle = Handle::at(empty.address());
    assert_eq!(handle.skin().map(drop), Err(DERMATOME_NO_PATCH));
    assert_eq!(handle.start_plainly(), Err(DERMATOME_NO_PATCH));
    assert_eq!(handle.tare(1), Err(DERMATOME_NO_PATCH));
    let (right, wrong) = (small_patch("right", 50.0), small_patch("wrong", 50.0));
    let board = board_with(&wrong);
    let handle = Handle::at(board.address());
    let wanted = Options { patch_crc: crc(&right), ..Options::default() };
    assert_eq!(handle.start(wanted), Err(DERMATOME_WRONG_PATCH));
    let words = format!("its checksum is {:#010x}, and {:#010x} was asked for", crc(&wrong), crc(&right));
    assert!(handle.error().contains(&words), "{}", handle.error());
    handle.start(Options { patch_crc: crc(&wrong), ..Options::default() }).unwrap();
    handle.frame().unwrap();
}

#[test]
fn a_board_of_another_protocol_is_named_with_what_to_update() {
    let older = Version { protocol: 1, ..Version::current() };
    let other = Version { schema: [7; 8], ..Version::current() };
    for (version, words) in [(older, "speaks protocol version 1"), (other, "their messages differ")] {
        let address = fake_board(move |request| matches!(request, Request::Hello(_)).then(|| hello(version)));
        let (code, said) = refused(&format!("tcp:{address}"));
        assert_eq!(code, DERMATOME_VERSION, "{said}");
        assert!(said.contains(words) && said.contains(&address.to_string()), "{said}");
    }
}

/// A peer that sends these bytes for ever.
fn peer(bytes: &'static [u8]) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        while stream.write_all(bytes).is_ok() {
            thread::sleep(Duration::from_millis(1));
        }
    });
    address
}

#[test]
fn what_is_no_board_is_no_answer_and_what_is_not_there_no_port() {
    for (bytes, words) in
        [(&b"login: \r\n\0"[..], "damaged packets"), (&[0x55; 4096], "is it a Dermatome board")]
    {
        let (code, said) = refused(&format!("tcp:{}", peer(bytes)));
        assert_eq!(code, DERMATOME_NO_ANSWER, "{said}");
        assert!(said.contains(words), "{said}");
    }
    let nobody = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    for (port, words) in [
        (format!("tcp:{nobody}"), "no board listens there"),
        ("/dev/ttyNOTTHERE7".to_owned(), "does not exist"),
        ("sim:skin.toml".to_owned(), "allowed are a serial port"),
        (String::new(), "names no port"),
    ] {
        let (code, said) = refused(&port);
        assert_eq!(code, DERMATOME_PORT, "{said}");
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn a_board_that_serves_another_host_is_in_use() {
    let board = small_board();
    let _first = Handle::at(board.address());
    let (code, said) = refused(&format!("tcp:{}", board.address()));
    assert_eq!(code, DERMATOME_IN_USE, "{said}");
}

#[test]
fn what_a_slow_loop_does_not_take_in_time_is_counted() {
    let skin = Pressed::new(1);
    let log = skin.log.clone();
    let board = SimulatedBoard::start(options(square_patch("fast", 16, 14, 40_000.0)), skin).unwrap();
    let handle = Handle::at(board.address());
    handle.start(Options { images_every: 1, ..Options::default() }).unwrap();
    let tared = handle.frame().unwrap().counts.frames_missing;
    // Some megabytes fit into the buffers of the system; then the board's own ones are full.
    let begun = Instant::now();
    while log.lock().unwrap().len() < 25_000 {
        assert!(begun.elapsed() < Duration::from_secs(30), "the board waits for its host");
        thread::sleep(Duration::from_millis(5));
    }
    while handle.counts().frames_missing <= tared + 20 {
        handle.frame().unwrap();
    }
    let counts = handle.counts();
    let of_frames = 2 * (counts.frames_missing - tared) + counts.parts_missing;
    assert!(counts.events_lost > 0 && counts.packets_damaged == 0, "{counts:?}");
    // What waits for one that may still come is not in a frame yet.
    assert!(of_frames.abs_diff(counts.events_lost) <= 64, "each is counted: {of_frames}, {counts:?}");
}
