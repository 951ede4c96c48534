//! Boards and lines that misbehave: what the host says and counts.

mod testbench;

use dermatome::link::{
    Link, LinkErrorKind, ScanFrame, Subscription, Totals, Transport, UploadError, assemble::Parts, health,
    scope, tare, upload,
};
use dermatome_shared::{
    MAX_PATCH_BYTES,
    acquire::{FrontEnd, trim::Trim},
    contact::Contact,
    drive::Drive,
    protocol::{
        BoardPacket, Event, FrameStamp, Info, MAX_PACKET_BYTES, PROTOCOL_VERSION, PacketReader, Refusal,
        Reply, Request, RequestPacket, Selection, Version, encode,
    },
};
use std::{
    collections::VecDeque,
    io::{self, Read, Write},
    net::TcpListener,
    sync::{Arc, Mutex},
    thread,
    time::{Duration, Instant},
};
use testbench::{Answer, connect, fake_board, fake_line, hello, info, small_patch, square_patch};

#[test]
fn a_board_of_another_protocol_version_is_refused_with_both_versions() {
    let version = Version { protocol: 99, ..Version::current() };
    let error = connect(fake_board(move |_| Some(hello(version)))).map(drop).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::ProtocolVersion { board: 99 }), "{error}");
    let text = error.to_string();
    assert!(text.contains("version 99") && text.contains(&format!("version {PROTOCOL_VERSION}")), "{text}");
    assert!(text.contains("update this host program"), "{text}");
    let refusing = fake_board(|_| Some(Reply::Refused(Refusal::Version { board: 99 })));
    assert_eq!(
        connect(refusing).map(drop).unwrap_err().to_string().replace(char::is_numeric, ""),
        text.replace(char::is_numeric, "")
    );
}

#[test]
fn a_board_with_other_messages_is_refused_with_both_hashes() {
    let version = Version { schema: *b"\x01\x02\x03\x04\x05\x06\x07\x08", ..Version::current() };
    let error = connect(fake_board(move |_| Some(hello(version)))).map(drop).unwrap_err().to_string();
    let own = u64::from_be_bytes(Version::current().schema);
    assert!(error.contains("0102030405060708") && error.contains(&format!("{own:016x}")), "{error}");
    assert!(error.contains("update the board's firmware"), "{error}");
}

#[test]
fn a_peer_that_says_nothing_is_given_up_after_two_seconds() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let start = Instant::now();
    let error = connect(address).map(drop).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::NoAnswer { .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains(&format!("tcp:{address}")) && text.contains("another program"), "{text}");
    assert!((1.9..10.0).contains(&start.elapsed().as_secs_f64()));
}

#[test]
fn a_peer_that_only_chatters_is_told_apart_from_a_silent_one() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        while stream.write_all(b"login: \r\n\0").is_ok() {
            thread::sleep(Duration::from_millis(5));
        }
    });
    let error = connect(address).map(drop).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::Damaged { packets: 10.., .. }), "{error}");
}

#[test]
fn a_board_that_closes_in_the_middle_of_an_upload_cuts_the_link() {
    let mut pieces = 0;
    let address = fake_board(move |request| match request {
        Request::Hello(_) => Some(hello(Version::current())),
        Request::Info => Some(info(16, MAX_PATCH_BYTES as u32)),
        Request::UploadChunk { .. } => {
            pieces += 1;
            (pieces < 2).then_some(Reply::Done)
        }
        _ => Some(Reply::Done),
    });
    let mut link = connect(address).unwrap();
    let mut sent = 0;
    let error = upload(&mut link, &square_patch("s", 16, 14, 1.0), |bytes| sent += bytes).unwrap_err();
    assert!(
        matches!(&error, UploadError::Link(error) if matches!(error.kind, LinkErrorKind::Cut)),
        "{error}"
    );
    assert!(error.to_string().contains(&address.to_string()), "{error}");
    assert_eq!(sent, 512);
}

#[test]
fn a_patch_that_is_damaged_or_does_not_fit_the_board_is_not_sent() {
    let small = || {
        let address = fake_board(|request| match request {
            Request::Hello(_) => Some(hello(Version::current())),
            Request::Info => Some(info(6, 1000)),
            other => panic!("sent {other:?}"),
        });
        connect(address).unwrap()
    };
    let long = square_patch("s", 8, 5, 1.0);
    let error = upload(&mut small(), &long, |_| ()).unwrap_err();
    assert!(matches!(error, UploadError::TooLong { max: 1000, .. }), "{error}");
    let error = upload(&mut small(), &small_patch("s", 1.0), |_| ()).unwrap_err();
    assert!(matches!(error, UploadError::Electrodes { patch: 8, board: 6 }), "{error}");
    let mut damaged = small_patch("s", 1.0);
    damaged[60] ^= 1;
    let error = upload(&mut small(), &damaged, |_| ()).unwrap_err();
    assert!(matches!(error, UploadError::Patch(_)), "{error}");
}

/// Plays packets to the host as a board would send them, whatever the host says; replies count from the number at which
/// the host begins.
struct Played<P> {
    packets: P,
    bytes: VecDeque<u8>,
    reader: PacketReader,
    /// Number of the host's first request but Hello, once that has come.
    first: Option<u16>,
}

/// A link to a board that plays these packets.
fn link_to(packets: impl IntoIterator<Item = Vec<u8>, IntoIter: Send + 'static>) -> Link {
    let (bytes, reader) = (VecDeque::new(), PacketReader::default());
    let played = Played { packets: packets.into_iter(), bytes, reader, first: None };
    Link::connect("played", played).unwrap()
}

impl<P: Iterator<Item = Vec<u8>>> Read for Played<P> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.bytes.is_empty() {
            let mut next = self.packets.next().ok_or(io::ErrorKind::TimedOut)?;
            let mut reader = PacketReader::default();
            let read = next.iter().find_map(|&byte| reader.push(byte));
            if let (Some(Ok(BoardPacket::Reply { sequence, reply: played })), Some(first)) =
                (read, self.first)
            {
                let number = u32::from(first) - 1 + u32::from(sequence);
                // As the host does it: none is 0.
                next = reply((number + (number >> 16)) as u16, played);
            }
            self.bytes.extend(next);
        }
        let length = buffer.len().min(7);
        self.bytes.read(&mut buffer[..length])
    }
}

impl<P> Write for Played<P> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for packet in bytes.iter().filter_map(|&byte| self.reader.push::<RequestPacket>(byte)) {
            let sequence = packet.unwrap().sequence;
            self.first = self.first.or((sequence > 0).then_some(sequence));
        }
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<P: Iterator<Item = Vec<u8>> + Send> Transport for Played<P> {}

fn packet(message: &BoardPacket) -> Vec<u8> {
    encode(message, &mut [0; MAX_PACKET_BYTES]).unwrap().to_vec()
}

fn reply(sequence: u16, reply: Reply) -> Vec<u8> {
    packet(&BoardPacket::Reply { sequence, reply })
}

/// An event of this number: the contacts, none, of a frame.
fn contacts(number: u32, frame: u32) -> Vec<u8> {
    let at = FrameStamp { sequence: frame, timestamp_us: 2, flags: Default::default() };
    packet(&BoardPacket::Event { number, event: Event::Contacts { at, contacts: Default::default() } })
}

const CONTACTS: Selection =
    Selection { contacts: 1, images: 0, measurements: 0, health: 0, scope: 0, scope_slot: 0 };

/// Numbers of all frames that come.
fn frames(stream: &mut Subscription<'_>) -> Vec<u32> {
    let number = |frame: ScanFrame| frame.at.unwrap().sequence;
    std::iter::from_fn(|| stream.next(Duration::ZERO).unwrap()).map(number).collect()
}

#[test]
fn an_event_damaged_on_the_way_counts_as_damaged_and_as_lost() {
    let mut damaged = contacts(1, 1);
    damaged[3] ^= 0x40;
    let bytes = [
        b"half an old packet\0".to_vec(),
        reply(0, hello(Version::current())),
        reply(1, Reply::Streaming { first_sequence: u32::MAX }),
        contacts(u32::MAX, u32::MAX),
        contacts(0, 0),
        damaged,
        contacts(2, 2),
        contacts(5, 5),
    ];
    let mut link = link_to(bytes);
    let mut stream = link.subscribe(CONTACTS).unwrap();
    assert_eq!(frames(&mut stream), [u32::MAX, 0, 2, 5]);
    assert_eq!(stream.totals(), Totals { frames: 4, frames_missing: 1 + 2, ..Totals::default() });
    let link = stream.link();
    assert_eq!((link.packets_damaged(), link.events_lost()), (1, 1 + 2));
}

#[test]
fn a_contact_at_no_number_is_a_damaged_packet_and_never_a_contact() {
    let at = |sequence| FrameStamp { sequence, timestamp_us: 2, flags: Default::default() };
    let contact = Contact {
        position: [0.0; 3],
        normal: [0.0, 0.0, 1.0],
        area: 1e-4,
        strength: 0.1,
        peak: 0.1,
        pressure: None,
        load_area: None,
        evidence: None,
        identity: None,
    };
    let wrong = [
        contact,
        Contact { position: [0.0, f32::NAN, 0.0], ..contact },
        Contact { strength: f32::INFINITY, ..contact },
        Contact { pressure: Some(f32::NAN), ..contact },
    ];
    let event = |(number, contact): (u32, &Contact)| {
        let contacts = [*contact].into_iter().collect();
        packet(&BoardPacket::Event { number, event: Event::Contacts { at: at(number), contacts } })
    };
    let health = Event::Health {
        at: at(4),
        health: Default::default(),
        vitals: Default::default(),
        drift: f32::NAN,
        missed: 0,
    };
    let mut packets =
        vec![reply(0, hello(Version::current())), reply(1, Reply::Streaming { first_sequence: 0 })];
    packets.extend((0..).zip(&wrong).map(event));
    packets.push(packet(&BoardPacket::Event { number: 4, event: health }));
    let mut link = link_to(packets);
    let mut stream = link.subscribe(CONTACTS).unwrap();
    assert_eq!(frames(&mut stream), [0]);
    assert_eq!(stream.link().packets_damaged(), 4);
}

#[test]
fn a_late_reply_does_not_pass_for_the_next_one() {
    let bytes = [
        reply(0, hello(Version::current())),
        reply(7, Reply::Refused(Refusal::NoPatch)),
        reply(0, hello(Version::current())),
        reply(1, info(8, 100)),
    ];
    let mut link = link_to(bytes);
    assert_eq!(link.info().unwrap().electrodes, 8);
}

#[test]
fn a_late_reply_to_another_host_does_not_pass_for_one_to_this() {
    let bytes = [
        reply(0, hello(Version::current())),
        // A host before this one asked as much, from another number.
        reply(12_001, Reply::Refused(Refusal::NoPatch)),
        reply(1, info(8, 100)),
    ];
    assert_eq!(link_to(bytes).info().unwrap().electrodes, 8);
}

#[test]
fn what_changes_nothing_is_asked_again_with_its_number_when_no_answer_comes() {
    let asked = Arc::<Mutex<Vec<u16>>>::default();
    let heard = asked.clone();
    let address = fake_line(move |RequestPacket { sequence, request }| match request {
        Request::Hello(_) => Answer::Reply(hello(Version::current()).into()),
        Request::Info | Request::Tare { .. } => {
            let mut heard = heard.lock().unwrap();
            heard.push(sequence);
            if heard.len() == 2 { Answer::Reply(info(8, 100).into()) } else { Answer::Silence }
        }
        other => panic!("sent {other:?}"),
    });
    let mut link = connect(address).unwrap();
    assert_eq!(link.info().unwrap().electrodes, 8);
    let first = asked.lock().unwrap()[0];
    assert_eq!(*asked.lock().unwrap(), [first, first]);
    // A tare would begin anew.
    assert!(matches!(
        link.request(&Request::Tare { frames: 9 }).unwrap_err().kind,
        LinkErrorKind::NoAnswer { .. }
    ));
    assert_eq!(*asked.lock().unwrap(), [first, first, first.checked_add(1).unwrap_or(1)]);
}

#[test]
fn events_of_an_earlier_stream_are_forgotten_when_a_new_one_starts() {
    let bytes = [
        reply(0, hello(Version::current())),
        contacts(7, 11),
        reply(1, Reply::Streaming { first_sequence: 12 }),
        contacts(8, 12),
    ];
    let mut link = link_to(bytes);
    let mut stream = link.subscribe(CONTACTS).unwrap();
    assert_eq!((stream.first_sequence(), frames(&mut stream)), (12, vec![12]));
    assert_eq!(stream.totals(), Totals { frames: 1, ..Totals::default() });
    assert_eq!(stream.link().events_lost(), 0);
}

#[test]
fn a_tare_that_never_ends_is_an_error_and_other_events_are_kept() {
    let bytes = [
        reply(0, hello(Version::current())),
        reply(1, Reply::Streaming { first_sequence: 1 }),
        reply(2, Reply::Done),
        contacts(0, 1),
    ];
    let mut link = link_to(bytes);
    let mut stream = link.subscribe(CONTACTS).unwrap();
    let error = tare(stream.link(), 20, Duration::from_millis(30)).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::NoTare { frames: 20, .. }), "{error}");
    assert_eq!(frames(&mut stream), [1]);
}

/// A board that obeys but never sends a frame; and all that it was told to stream.
fn silent_board() -> (Link, Arc<Mutex<Vec<Selection>>>) {
    let told = Arc::<Mutex<Vec<Selection>>>::default();
    let asked = told.clone();
    let address = fake_board(move |request| match request {
        Request::Hello(_) => Some(hello(Version::current())),
        Request::Stream(selection) => {
            asked.lock().unwrap().push(selection);
            Some(Reply::Streaming { first_sequence: 5 })
        }
        _ => Some(Reply::Done),
    });
    (connect(address).unwrap(), told)
}

const SHORT: Duration = Duration::from_millis(150);
const HEALTH: Selection =
    Selection { health: 1, images: 0, contacts: 0, measurements: 0, scope: 0, scope_slot: 0 };

#[test]
fn a_board_that_sends_no_health_is_told_to_stop() {
    let (mut link, told) = silent_board();
    let error = health::watch(&mut link, 5, SHORT, || true).map(drop).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::NoAnswer { timeout: SHORT }), "{error}");
    assert_eq!(*told.lock().unwrap(), [HEALTH, Selection::default()]);
}

#[test]
fn a_board_that_shows_no_samples_is_told_to_stop() {
    let (mut link, told) = silent_board();
    let Reply::Info(info) = info(8, 1000) else { unreachable!() };
    let front_end = FrontEnd {
        sample_rate: 2_000_000,
        volts_per_code: 1e-6,
        full_scale_current: 1e-3,
        small_range: None,
        gain_bandwidth: 1e7,
        largest_gain: 64,
        bandwidths: [1e6; 4],
        lead_corner: f32::INFINITY,
        waveform_rate: 2_000_000,
        lead: 0.0,
        trim: Trim::NONE,
    };
    let info = Info { front_end: Some(front_end), drive: Some(Drive::new(50e3, 1e-3, 50.0)), ..info };
    let error = scope::capture(&mut link, &info, 3, SHORT, || true).map(drop).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::NoAnswer { timeout: SHORT }), "{error}");
    let asked = Selection { scope: 1, scope_slot: 3, ..Selection::default() };
    assert_eq!(*told.lock().unwrap(), [asked, Selection::default()]);
}

#[test]
fn whoever_waits_for_a_silent_board_can_stop_and_so_does_the_board() {
    let (mut link, told) = silent_board();
    let watch = health::watch(&mut link, 5, Duration::from_secs(60), {
        let started = Instant::now();
        move || started.elapsed() < SHORT
    });
    assert!(watch.unwrap().diagnosis(false, health::Known::default()).is_none());
    assert_eq!(*told.lock().unwrap(), [HEALTH, Selection::default()]);
}

#[test]
fn a_subscription_stops_the_board_when_it_is_dropped_and_only_once() {
    let (mut link, told) = silent_board();
    let mut stream = link.subscribe(HEALTH).unwrap();
    assert_eq!(stream.first_sequence(), 5);
    assert_eq!(stream.next(Duration::ZERO).unwrap(), None);
    drop(stream);
    assert_eq!(*told.lock().unwrap(), [HEALTH, Selection::default()]);
    assert_eq!(link.subscribe(HEALTH).unwrap().stop().unwrap(), Totals::default());
    assert_eq!(told.lock().unwrap().len(), 4);
}

#[test]
fn a_board_whose_reply_to_a_subscription_is_wrong_is_told_to_stop_and_one_that_refuses_is_not() {
    let told = Arc::<Mutex<Vec<Selection>>>::default();
    for (answer, count) in [(Reply::Done, 2), (Reply::Refused(Refusal::NoPatch), 1)] {
        let asked = told.clone();
        let address = fake_board(move |request| match request {
            Request::Hello(_) => Some(hello(Version::current())),
            Request::Stream(selection) => {
                asked.lock().unwrap().push(selection);
                Some(answer.clone())
            }
            other => panic!("sent {other:?}"),
        });
        let error = connect(address).unwrap().subscribe(HEALTH).map(drop).unwrap_err();
        let is_expected = matches!(error.kind, LinkErrorKind::WrongReply { .. } | LinkErrorKind::Refused(_));
        assert!(is_expected, "{error}");
        assert_eq!(std::mem::take(&mut *told.lock().unwrap()).len(), count, "{error}");
    }
}

#[test]
fn what_came_of_a_frame_is_handed_out_once_the_board_has_been_silent() {
    let bytes = [
        reply(0, hello(Version::current())),
        reply(1, Reply::Streaming { first_sequence: 12 }),
        contacts(0, 12),
        reply(2, Reply::Streaming { first_sequence: 13 }),
    ];
    let mut link = link_to(bytes);
    let mut stream = link.subscribe(Selection { contacts: 1, images: 1, ..Selection::default() }).unwrap();
    let frame = stream.next(Duration::from_secs(5)).unwrap().expect("the contacts");
    let at = FrameStamp { sequence: 12, timestamp_us: 2, flags: Default::default() };
    assert_eq!((frame.at, frame.contacts.is_some(), frame.missing), (Some(at), true, Parts::IMAGE));
    let totals = Totals { frames: 1, incomplete: 1, parts_missing: 1, ..Totals::default() };
    assert_eq!(stream.totals(), totals);
}

#[test]
fn a_board_that_sends_other_events_than_it_was_asked_for_is_an_error_in_time() {
    let first = [reply(0, hello(Version::current())), reply(1, Reply::Streaming { first_sequence: 12 })];
    let tared = |number| packet(&BoardPacket::Event { number, event: Event::Tared { frames: 20 } });
    let without_end = (0..).map(tared).inspect(|_| thread::sleep(Duration::from_millis(1)));
    let mut link = link_to(first.into_iter().chain(without_end));
    let mut stream = link.subscribe(CONTACTS).unwrap();
    let error = stream.next_while(SHORT, || true).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::NoFrame { events: 10.., .. }), "{error}");
    assert!(error.to_string().contains("but no frame"), "{error}");
    std::mem::forget(stream);
}

#[test]
fn no_more_of_a_patch_is_read_than_its_board_states() {
    // The length of the whole, in its prefix, says less than what the tables need.
    let mut patch = square_patch("s", 16, 14, 1.0);
    patch[8..12].copy_from_slice(&100_u32.to_le_bytes());
    let asked = Arc::<Mutex<usize>>::default();
    let count = asked.clone();
    let address = fake_board(move |request| match request {
        Request::Hello(_) => Some(hello(Version::current())),
        Request::ReadPatch { offset } => {
            let mut asked = count.lock().unwrap();
            *asked += 1;
            let rest = patch.iter().copied().cycle().skip(offset as usize);
            // Never ends by itself: the host must.
            (*asked < 2000).then(|| Reply::Patch { bytes: rest.take(512).collect() })
        }
        other => panic!("sent {other:?}"),
    });
    let error = connect(address).unwrap().surface().unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::WrongReply { request: "ReadPatch" }), "{error}");
    assert!(*asked.lock().unwrap() <= MAX_PATCH_BYTES / 512 + 2);
}
