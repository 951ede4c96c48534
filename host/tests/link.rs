//! Links to a real simulated board over TCP.

mod testbench;

use dermatome::{
    link::{Link, LinkErrorKind, ScanFrame, Subscription, Totals, assemble::Parts, tare, upload},
    simulate::{
        board::{BoardError, BoardOptions, Pace, SimulatedBoard},
        instrument::{Instrument, ScanTable},
    },
};
use dermatome_shared::{
    frame::Frame,
    protocol::{FrameStamp, MAX_PACKET_BYTES, Refusal, Reply, Request, RequestPacket, Selection, encode},
};
use std::{
    io::{ErrorKind, Read, Write},
    thread,
    time::{Duration, Instant},
};
use testbench::{Pressed, board_with, connect, crc, empty_board, raw, small_patch, square_patch};

const SECOND: Duration = Duration::from_secs(1);
const NOTHING: Selection =
    Selection { images: 0, contacts: 0, measurements: 0, health: 0, scope: 0, scope_slot: 0 };
const CONTACTS: Selection = Selection { contacts: 1, ..NOTHING };
const MEASUREMENTS: Selection = Selection { measurements: 1, ..NOTHING };
const ALL: Selection = Selection { images: 1, contacts: 1, measurements: 1, health: 1, ..NOTHING };

fn next(stream: &mut Subscription<'_>) -> ScanFrame {
    stream.next(2 * SECOND).unwrap().expect("a frame within two seconds")
}

fn stamp(frame: &ScanFrame) -> FrameStamp {
    frame.at.expect("no samples of the scope alone")
}

#[test]
fn upload_tare_and_stream_lose_nothing() {
    let board = empty_board();
    let mut link = connect(board.address()).unwrap();
    assert_eq!(link.identity().board, "simulated");
    let patch = square_patch("sixteen", 16, 14, 100.0);
    let mut sent = 0;
    let used = upload(&mut link, &patch, |bytes| sent += bytes).unwrap();
    assert_eq!((sent, used.crc, used.skin.as_str()), (patch.len(), crc(&patch), "sixteen"));
    tare(&mut link, 5, SECOND).unwrap();
    assert!(link.info().unwrap().tared);
    let mut stream = link.subscribe(ALL).unwrap();
    let first = stream.first_sequence();
    assert_eq!(first, 5);
    for sequence in first..first + 200 {
        let frame = next(&mut stream);
        assert_eq!((stamp(&frame).sequence, frame.missing), (sequence, Parts::default()));
        let (Some(contacts), Some(measurements), Some(image)) =
            (frame.contacts, frame.measurements, frame.image)
        else {
            panic!("nothing is missing, and yet not all is there")
        };
        let expected = 0.1 * f64::from(sequence - first) / 100.0;
        assert_eq!((measurements.codes.len(), image.mantissas.len()), (208, 196));
        assert!((image.values().nth(1).unwrap() - expected).abs() < 4e-4, "{sequence}");
        assert_eq!(contacts.len(), usize::from(expected > 0.01 + 4e-4), "{sequence}");
    }
    assert_eq!(stream.totals(), Totals { frames: 200, ..Totals::default() });
    let link = stream.link();
    assert_eq!((link.events_lost(), link.packets_damaged()), (0, 0));
}

/// Streams 50 frames after a tare, with `pause` wherever a host may dawdle.
fn streamed(seed: u64, pause: Duration) -> Vec<ScanFrame> {
    let patch = Some(small_patch("small", 50.0));
    let options = BoardOptions { patch, pace: Pace::Unpaced, ..BoardOptions::default() };
    let board = SimulatedBoard::start(options, Pressed::new(seed)).unwrap();
    thread::sleep(pause);
    let mut link = connect(board.address()).unwrap();
    tare(&mut link, 3, SECOND).unwrap();
    thread::sleep(pause);
    let mut stream = link.subscribe(ALL).unwrap();
    let frames: Vec<_> = (0..50).map(|_| next(&mut stream)).collect();
    assert_eq!(stream.totals(), Totals { frames: 50, ..Totals::default() });
    frames
}

#[test]
fn what_is_streamed_depends_on_the_seed_and_not_on_wall_time() {
    let quick = streamed(1, Duration::ZERO);
    assert_eq!(quick, streamed(1, Duration::from_millis(40)));
    assert_ne!(quick, streamed(2, Duration::ZERO));
}

#[test]
fn the_script_runs_only_while_streaming_and_starts_anew_with_each_stream() {
    let source = Pressed::new(1);
    let log = source.log.clone();
    let options = BoardOptions {
        patch: Some(small_patch("small", 50.0)),
        pace: Pace::Unpaced,
        max_frames: Some(6),
        ..BoardOptions::default()
    };
    let board = SimulatedBoard::start(options, source).unwrap();
    let mut link = connect(board.address()).unwrap();
    tare(&mut link, 2, SECOND).unwrap();
    thread::sleep(Duration::from_millis(20));
    assert_eq!(log.lock().unwrap().as_slice(), [None, None], "nothing to scan for after the tare");
    let mut stream = link.subscribe(CONTACTS).unwrap();
    for _ in 0..6 {
        next(&mut stream);
    }
    let script: Vec<_> = [0.0, 0.02, 0.04, 0.06, 0.08, 0.1].into_iter().map(Some).collect();
    assert_eq!(log.lock().unwrap()[2..], script);
}

#[test]
fn a_second_stream_and_a_tare_in_between_see_the_skin_untouched_at_first() {
    let source = Pressed::new(1);
    let log = source.log.clone();
    let options = BoardOptions { patch: Some(small_patch("small", 500.0)), ..BoardOptions::default() };
    let board = SimulatedBoard::start(options, source).unwrap();
    let mut link = connect(board.address()).unwrap();
    tare(&mut link, 1, SECOND).unwrap();
    for _ in 0..2 {
        let mut stream = link.subscribe(MEASUREMENTS).unwrap();
        next(&mut stream);
        next(&mut stream);
        stream.stop().unwrap();
    }
    let starts = log.lock().unwrap().iter().filter(|time| **time == Some(0.0)).count();
    assert_eq!(starts, 2);
    let mut stream = link.subscribe(MEASUREMENTS).unwrap();
    tare(stream.link(), 4, SECOND).unwrap();
    let log = log.lock().unwrap();
    assert_eq!(log.iter().filter(|time| time.is_none()).count(), 1 + 4);
}

#[test]
fn a_stream_without_a_tare_makes_its_reference_of_the_untouched_skin() {
    let source = Pressed::new(1);
    let log = source.log.clone();
    let options = BoardOptions {
        patch: Some(small_patch("small", 50.0)),
        pace: Pace::Unpaced,
        ..BoardOptions::default()
    };
    let board = SimulatedBoard::start(options, source).unwrap();
    let mut link = connect(board.address()).unwrap();
    let mut stream = link.subscribe(CONTACTS).unwrap();
    assert_eq!(stamp(&next(&mut stream)).sequence, stream.first_sequence() + 20);
    let totals = Totals { frames: 1, frames_missing: 20, tares: 1, ..Totals::default() };
    assert_eq!(stream.totals(), totals, "there are no contacts while it tares");
    let reference = stream.link().request(&Request::Reference).unwrap();
    assert!(matches!(reference, Reply::Reference { frames: 20, .. }), "{reference:?}");
    let log = log.lock().unwrap();
    assert!(log[..20].iter().all(Option::is_none));
    assert_eq!(log[20], Some(0.0));
}

/// A source that takes most of a frame's time.
struct Slow(Pressed);

impl Instrument for Slow {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        thread::sleep(Duration::from_millis(80));
        self.0.scan(table, script_time)
    }
}

#[test]
fn a_paced_board_keeps_its_frame_rate_however_long_a_scan_takes() {
    let options = BoardOptions { patch: Some(small_patch("small", 10.0)), ..BoardOptions::default() };
    let board = SimulatedBoard::start(options, Slow(Pressed::new(1))).unwrap();
    let mut link = connect(board.address()).unwrap();
    tare(&mut link, 1, SECOND).unwrap();
    let mut stream = link.subscribe(MEASUREMENTS).unwrap();
    let first = stamp(&next(&mut stream));
    let start = Instant::now();
    let mut last = first;
    for _ in 0..8 {
        last = stamp(&next(&mut stream));
    }
    let took = start.elapsed().as_secs_f64();
    // Waiting a period after each scan would take 1.44 s.
    assert!((0.6..1.3).contains(&took), "8 frames at 10 a second took {took} s");
    assert_eq!(last.timestamp_us - first.timestamp_us, 800_000);
}

#[test]
fn a_host_that_vanishes_in_the_middle_of_an_upload_leaves_the_old_patch() {
    let (old, new) = (small_patch("old", 50.0), small_patch("new", 50.0));
    let board = board_with(&old);
    let mut link = connect(board.address()).unwrap();
    tare(&mut link, 2, SECOND).unwrap();
    link.request(&Request::BeginUpload { length: new.len() as u32, crc: crc(&new) }).unwrap();
    let bytes = new[..100].iter().copied().collect();
    link.request(&Request::UploadChunk { offset: 0, bytes }).unwrap();
    drop(link);
    let mut link = connect(board.address()).unwrap();
    let info = link.info().unwrap();
    assert_eq!((info.patch.unwrap().crc, info.tared), (crc(&old), true));
    let error = link.request(&Request::CommitUpload).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::Refused(Refusal::NoUpload)), "{error}");
}

#[test]
fn a_host_that_vanishes_while_streaming_leaves_a_quiet_board() {
    let board = board_with(&small_patch("small", 50.0));
    let mut link = connect(board.address()).unwrap();
    tare(&mut link, 1, SECOND).unwrap();
    let mut stream = link.subscribe(MEASUREMENTS).unwrap();
    next(&mut stream);
    // Who vanishes does not tell the board to stop.
    std::mem::forget(stream);
    drop(link);
    let mut line = raw(board.address());
    let mut link = Link::connect("raw", line.try_clone().unwrap()).unwrap();
    assert!(!link.info().unwrap().streaming.any());
    thread::sleep(Duration::from_millis(50));
    let silence = line.read(&mut [0]).expect_err("the board sends something");
    assert!(matches!(silence.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut), "{silence}");
}

#[test]
fn events_a_host_does_not_read_are_dropped_and_counted_and_replies_still_come() {
    let options = BoardOptions { patch: Some(square_patch("s", 16, 2, 40_000.0)), ..BoardOptions::default() };
    let source = Pressed::new(1);
    let log = source.log.clone();
    let board = SimulatedBoard::start(options, source).unwrap();
    let mut link = connect(board.address()).unwrap();
    tare(&mut link, 1, SECOND).unwrap();
    let mut stream = link.subscribe(MEASUREMENTS).unwrap();
    // Some megabytes fit into the buffers of the system; then the board's own ones are full.
    let start = Instant::now();
    while log.lock().unwrap().len() < 20_000 {
        assert!(start.elapsed() < 20 * SECOND, "the board waits for its host");
        thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(stream.link().info().unwrap().streaming.measurements, 1);
    while stream.totals().frames_missing == 0 || stream.totals().frames < 100 {
        next(&mut stream);
    }
    // By their sequence numbers as many frames are missing as events by theirs.
    let totals = stream.stop().unwrap();
    assert!(link.events_lost() > 100, "only {} lost", link.events_lost());
    let only = Totals { frames: totals.frames, frames_missing: link.events_lost(), ..Totals::default() };
    assert_eq!((totals, link.packets_damaged()), (only, 0));
}

#[test]
fn a_port_in_use_is_named() {
    let board = empty_board();
    let options = BoardOptions { listen: board.address(), ..BoardOptions::default() };
    let error = SimulatedBoard::start(options, Pressed::new(1)).unwrap_err();
    assert!(matches!(error, BoardError::PortInUse { .. }), "{error}");
    assert!(error.to_string().contains(&board.address().to_string()), "{error}");
}

#[test]
fn damaged_bytes_from_the_host_are_ignored_and_the_next_request_is_answered() {
    let board = board_with(&small_patch("small", 50.0));
    let mut stream = raw(board.address());
    let mut link = Link::connect("raw", stream.try_clone().unwrap()).unwrap();
    stream.write_all(&[0x55; 5000]).unwrap();
    stream.write_all(b"\0\x03\x01\0").unwrap();
    let mut buffer = [0; MAX_PACKET_BYTES];
    let request = RequestPacket { sequence: 9, request: Request::CommitUpload };
    let mut packet = encode(&request, &mut buffer).unwrap().to_vec();
    packet[2] ^= 0x10;
    stream.write_all(&packet).unwrap();
    assert_eq!(link.info().unwrap().patch.unwrap().skin, "small");
    assert_eq!(link.packets_damaged(), 0);
}

#[test]
fn line_noise_before_hello_does_not_cost_an_answer() {
    let board = empty_board();
    let mut stream = raw(board.address());
    stream.write_all(&[0x55; 20]).unwrap();
    let start = Instant::now();
    Link::connect("raw", stream).unwrap();
    // The second Hello comes after a second.
    assert!(start.elapsed() < Duration::from_millis(900), "{:?}", start.elapsed());
}

#[test]
fn a_host_that_floods_the_board_with_requests_does_not_keep_it_from_stopping() {
    let board = empty_board();
    let mut stream = raw(board.address());
    stream.set_write_timeout(Some(Duration::from_millis(20))).unwrap();
    let request = RequestPacket { sequence: 9, request: Request::Info };
    let packets = encode(&request, &mut [0; 64]).unwrap().repeat(1000);
    // Until nothing moves any more: the board has given this host up, or its buffers are full.
    while stream.write_all(&packets).is_ok() {}
    let start = Instant::now();
    board.stop().unwrap();
    assert!(start.elapsed() < 5 * SECOND, "{:?}", start.elapsed());
}

#[test]
fn refusals_are_errors_in_the_boards_words() {
    let board = empty_board();
    let mut link = connect(board.address()).unwrap();
    let refused = link.subscribe(CONTACTS).map(drop).unwrap_err();
    for error in [refused, tare(&mut link, 1, SECOND).unwrap_err()] {
        assert!(matches!(error.kind, LinkErrorKind::Refused(Refusal::NoPatch)), "{error}");
        assert!(error.to_string().contains(&Refusal::NoPatch.to_string()), "{error}");
    }
    upload(&mut link, &small_patch("small", 50.0), |_| ()).unwrap();
    let error = link.request(&Request::Reference).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::Refused(Refusal::NotTared)), "{error}");
    assert!(error.to_string().contains("dermatome tare"), "{error}");
}

#[test]
fn a_board_with_a_frame_limit_ends_its_stream_and_then_itself() {
    let options = BoardOptions {
        patch: Some(small_patch("small", 50.0)),
        pace: Pace::Unpaced,
        max_frames: Some(7),
        ..BoardOptions::default()
    };
    let board = SimulatedBoard::start(options, Pressed::new(1)).unwrap();
    let mut link = connect(board.address()).unwrap();
    tare(&mut link, 2, SECOND).unwrap();
    let mut stream = link.subscribe(CONTACTS).unwrap();
    let received = std::iter::from_fn(|| stream.next(Duration::from_millis(100)).unwrap()).count();
    assert_eq!((received, stream.totals()), (7, Totals { frames: 7, ..Totals::default() }));
    assert!(!stream.link().info().unwrap().streaming.any());
    drop(stream);
    let mut stream = link.subscribe(CONTACTS).unwrap();
    assert!(!stream.link().info().unwrap().streaming.any(), "there are no frames left to stream");
    assert!(!board.is_finished());
    drop(stream);
    drop(link);
    let start = Instant::now();
    while !board.is_finished() {
        assert!(start.elapsed() < 10 * SECOND, "the board goes on without frames and without host");
        thread::sleep(Duration::from_millis(1));
    }
    board.stop().unwrap();
}

#[test]
fn an_uploaded_patch_survives_a_restart_of_the_board_in_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let start = || {
        let patch = Some(small_patch("factory", 50.0));
        let store = Some(folder.path().join("board.patch"));
        let options = BoardOptions { patch, store, ..BoardOptions::default() };
        SimulatedBoard::start(options, Pressed::new(1)).unwrap()
    };
    let board = start();
    let mut link = connect(board.address()).unwrap();
    assert_eq!(link.info().unwrap().patch.unwrap().skin, "factory");
    let patch = small_patch("mine", 50.0);
    upload(&mut link, &patch, |_| ()).unwrap();
    board.stop().unwrap();
    let board = start();
    let mut link = connect(board.address()).unwrap();
    assert_eq!(link.info().unwrap().patch.unwrap().crc, crc(&patch));
}

#[test]
fn a_board_stops_promptly_and_cuts_its_host_off() {
    let board = board_with(&small_patch("small", 50.0));
    let mut link = connect(board.address()).unwrap();
    let mut stream = link.subscribe(MEASUREMENTS).unwrap();
    let start = Instant::now();
    board.stop().unwrap();
    assert!(start.elapsed() < 5 * SECOND, "{:?}", start.elapsed());
    let error = stream.link().info().unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::Cut), "{error}");
}

#[test]
fn a_second_host_is_let_in_when_the_first_leaves_soon() {
    let board = board_with(&small_patch("small", 50.0));
    let address = board.address();
    let first = connect(address).unwrap();
    let second = thread::spawn(move || connect(address).map(|link| link.identity().board.to_string()));
    thread::sleep(Duration::from_millis(50));
    assert!(!second.is_finished());
    drop(first);
    assert_eq!(second.join().unwrap().unwrap(), "simulated");
}

#[test]
fn a_second_host_is_told_that_the_board_is_busy_while_the_first_speaks() {
    let board = board_with(&small_patch("small", 50.0));
    let mut first = connect(board.address()).unwrap();
    let error = connect(board.address()).map(drop).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::Refused(Refusal::Busy)), "{error}");
    first.info().unwrap();
}

#[test]
fn a_second_host_takes_the_place_of_one_that_has_been_silent_for_long() {
    let options = BoardOptions {
        patch: Some(small_patch("small", 50.0)),
        lease: Duration::from_millis(200),
        ..BoardOptions::default()
    };
    let board = SimulatedBoard::start(options, Pressed::new(1)).unwrap();
    let idle = raw(board.address());
    let mut link = connect(board.address()).unwrap();
    assert!(!link.info().unwrap().streaming.any());
    drop(idle);
}

#[test]
fn a_link_that_owns_its_board_keeps_it_alive() {
    let board = board_with(&small_patch("small", 50.0));
    let mut link = board.connect("sim:skin.toml").unwrap();
    assert_eq!(link.port(), "sim:skin.toml");
    assert_eq!(link.info().unwrap().patch.unwrap().skin, "small");
}
