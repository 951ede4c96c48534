//! Links to a real simulated board over TCP.

mod testbench;

use dermatome::{
    link::{Link, LinkErrorKind, stream, tare, upload},
    simulate::{
        board::{BoardError, BoardOptions, Pace, SimulatedBoard},
        instrument::{Instrument, ScanTable},
    },
};
use dermatome_shared::{
    frame::Frame,
    protocol::{Event, FrameStamp, MAX_PACKET_BYTES, Refusal, Request, RequestPacket, Selection, encode},
};
use std::{
    io::Write,
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

fn next(link: &mut Link) -> Event {
    link.next_event(2 * SECOND).unwrap().expect("an event within two seconds")
}

fn stamp(event: &Event) -> FrameStamp {
    match event {
        Event::Image { at, .. }
        | Event::Contacts { at, .. }
        | Event::Measurements { at, .. }
        | Event::Health { at, .. } => *at,
        Event::Tared { .. } | Event::Scope(_) => panic!("{event:?} has no frame"),
    }
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
    let first = stream(&mut link, ALL).unwrap();
    assert_eq!(first, 5);
    for sequence in first..first + 200 {
        let events = [next(&mut link), next(&mut link), next(&mut link), next(&mut link)];
        assert!(events.iter().all(|event| stamp(event).sequence == sequence), "{sequence}");
        let [
            Event::Contacts { contacts, .. },
            Event::Health { .. },
            Event::Measurements { codes, .. },
            Event::Image { image, .. },
        ] = &events
        else {
            panic!("wrong kinds or order")
        };
        let expected = 0.1 * f64::from(sequence - first) / 100.0;
        assert_eq!((codes.len(), image.mantissas.len()), (208, 196));
        assert!((image.values().nth(1).unwrap() - expected).abs() < 4e-4, "{sequence}");
        assert_eq!(contacts.len(), usize::from(expected > 0.01 + 4e-4), "{sequence}");
    }
    assert_eq!((link.events_lost(), link.packets_damaged()), (0, 0));
}

/// Streams 50 frames after a tare, with `pause` wherever a host may dawdle.
fn streamed(seed: u64, pause: Duration) -> Vec<Event> {
    let patch = Some(small_patch("small", 50.0));
    let options = BoardOptions { patch, pace: Pace::Unpaced, ..BoardOptions::default() };
    let board = SimulatedBoard::start(options, Pressed::new(seed)).unwrap();
    thread::sleep(pause);
    let mut link = connect(board.address()).unwrap();
    tare(&mut link, 3, SECOND).unwrap();
    thread::sleep(pause);
    stream(&mut link, ALL).unwrap();
    (0..200).map(|_| next(&mut link)).collect()
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
    stream(&mut link, CONTACTS).unwrap();
    for _ in 0..6 {
        next(&mut link);
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
        stream(&mut link, MEASUREMENTS).unwrap();
        next(&mut link);
        next(&mut link);
        stream(&mut link, Selection::default()).unwrap();
    }
    let starts = log.lock().unwrap().iter().filter(|time| **time == Some(0.0)).count();
    assert_eq!(starts, 2);
    stream(&mut link, MEASUREMENTS).unwrap();
    tare(&mut link, 4, SECOND).unwrap();
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
    let first = stream(&mut link, Selection { contacts: 1, ..NOTHING }).unwrap();
    assert_eq!(next(&mut link), Event::Tared { frames: 20 });
    assert_eq!(stamp(&next(&mut link)).sequence, first + 20);
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
    stream(&mut link, MEASUREMENTS).unwrap();
    let first = stamp(&next(&mut link));
    let start = Instant::now();
    let mut last = first;
    for _ in 0..8 {
        last = stamp(&next(&mut link));
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
    stream(&mut link, MEASUREMENTS).unwrap();
    next(&mut link);
    drop(link);
    let mut link = connect(board.address()).unwrap();
    assert!(!link.info().unwrap().streaming.any());
    assert_eq!(link.next_event(Duration::from_millis(50)).unwrap(), None);
}

#[test]
fn events_a_host_does_not_read_are_dropped_and_counted_and_replies_still_come() {
    let options = BoardOptions { patch: Some(square_patch("s", 16, 2, 40_000.0)), ..BoardOptions::default() };
    let source = Pressed::new(1);
    let log = source.log.clone();
    let board = SimulatedBoard::start(options, source).unwrap();
    let mut link = connect(board.address()).unwrap();
    tare(&mut link, 1, SECOND).unwrap();
    let first = stream(&mut link, MEASUREMENTS).unwrap();
    // Some megabytes fit into the buffers of the system; then the board's own ones are full.
    let start = Instant::now();
    while log.lock().unwrap().len() < 20_000 {
        assert!(start.elapsed() < 20 * SECOND, "the board waits for its host");
        thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(link.info().unwrap().streaming.measurements, 1);
    stream_until(&mut link, first);
}

/// Reads until events have been lost, stops the stream, and accounts for every frame.
fn stream_until(link: &mut Link, first: u32) {
    let mut received = 0;
    let mut last = first;
    while link.events_lost() == 0 || received < 100 {
        last = stamp(&next(link)).sequence;
        received += 1;
    }
    while let Some(event) = next_kept(link) {
        last = stamp(&event).sequence;
        received += 1;
    }
    assert!(link.events_lost() > 100, "only {} lost", link.events_lost());
    assert_eq!(u64::from(last - first) + 1, received + link.events_lost());
    assert_eq!(link.packets_damaged(), 0);
}

/// What is still under way after the board has been told to stop.
fn next_kept(link: &mut Link) -> Option<Event> {
    // Not `stream`, which forgets the events before it.
    link.request(&Request::Stream(Selection::default())).unwrap();
    link.next_event(Duration::from_millis(20)).unwrap()
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
    for error in [stream(&mut link, CONTACTS).unwrap_err(), tare(&mut link, 1, SECOND).unwrap_err()] {
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
    stream(&mut link, CONTACTS).unwrap();
    let received = std::iter::from_fn(|| link.next_event(Duration::from_millis(100)).unwrap()).count();
    assert_eq!(received, 7);
    assert!(!link.info().unwrap().streaming.any());
    stream(&mut link, CONTACTS).unwrap();
    assert!(!link.info().unwrap().streaming.any(), "there are no frames left to stream");
    assert!(!board.is_finished());
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
    stream(&mut link, MEASUREMENTS).unwrap();
    let start = Instant::now();
    board.stop().unwrap();
    assert!(start.elapsed() < 5 * SECOND, "{:?}", start.elapsed());
    let error = link.info().unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::Cut), "{error}");
}

#[test]
fn a_second_host_waits_until_the_first_has_left() {
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
fn a_link_that_owns_its_board_keeps_it_alive() {
    let board = board_with(&small_patch("small", 50.0));
    let mut link = board.connect("sim:skin.toml").unwrap();
    assert_eq!(link.port(), "sim:skin.toml");
    assert_eq!(link.info().unwrap().patch.unwrap().skin, "small");
}
