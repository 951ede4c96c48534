use super::*;
use crate::acquire::tests::FRONT_END;
use crate::patch::{
    Difference,
    reflexes::Limit,
    tests::{flat_frame, patch_with_reflexes, row, rule, small_patch},
};
use crate::pipeline::reflex::Watch;
use crate::protocol::MAX_CHUNK_BYTES;
use std::{vec, vec::Vec};

#[derive(Default)]
struct Memory {
    active: Option<Vec<u8>>,
    staged: Vec<u8>,
    trim: Option<Trim>,
}

impl PatchStore for Memory {
    fn active(&self) -> Option<&[u8]> {
        self.active.as_deref()
    }
    fn begin(&mut self, _: usize) -> Result<(), StoreError> {
        self.staged.clear();
        Ok(())
    }
    fn append(&mut self, bytes: &[u8]) -> Result<(), StoreError> {
        self.staged.extend(bytes);
        Ok(())
    }
    fn staged(&self) -> &[u8] {
        &self.staged
    }
    fn commit(&mut self) -> Result<(), StoreError> {
        self.active = Some(core::mem::take(&mut self.staged));
        Ok(())
    }
    fn trim(&self) -> Option<Trim> {
        self.trim
    }
    fn keep_trim(&mut self, trim: &Trim) -> Result<(), StoreError> {
        self.trim = Some(*trim);
        Ok(())
    }
}

fn facts(electrodes: u8) -> BoardFacts {
    let identity = Identity { board: "test".try_into().unwrap(), firmware: "0".try_into().unwrap() };
    BoardFacts {
        identity,
        electrodes,
        frame_source: FrameSource::Synthetic,
        front_end: None,
        started_after: Restart::Watchdog,
        sees_host_go: false,
    }
}

fn device() -> Device<Memory> {
    Device::new(facts(16), Memory::default(), PipelineState::default())
}

fn ask(device: &mut Device<Memory>, request: Request) -> Reply {
    match device.handle(&RequestPacket { sequence: 77, request }, 5000) {
        BoardPacket::Reply { sequence: 77, reply } => reply,
        other => panic!("{other:?}"),
    }
}

fn upload(device: &mut Device<Memory>, bytes: &[u8], crc: u32) -> Reply {
    let begin = Request::BeginUpload { length: bytes.len() as u32, crc };
    assert_eq!(ask(device, begin), Reply::Done);
    for (i, chunk) in bytes.chunks(MAX_CHUNK_BYTES).enumerate() {
        let bytes = heapless::Vec::from_slice(chunk).unwrap();
        let offset = (i * MAX_CHUNK_BYTES) as u32;
        assert_eq!(ask(device, Request::UploadChunk { offset, bytes }), Reply::Done);
    }
    ask(device, Request::CommitUpload)
}

fn upload_good(device: &mut Device<Memory>, difference: Difference) -> u32 {
    let bytes = small_patch(difference);
    let crc = PatchView::validate(&bytes).unwrap().crc();
    assert_eq!(upload(device, &bytes, crc), Reply::Done);
    crc
}

fn events(device: &mut Device<Memory>, frame: &Frame) -> Vec<(u32, Event)> {
    let mut seen = Vec::new();
    device.process(&mut frame.clone(), &Arrival::default(), |packet| match packet {
        BoardPacket::Event { number, event } => seen.push((*number, event.clone())),
        BoardPacket::Reply { .. } => panic!("a reply nobody asked for"),
    });
    seen
}

#[test]
fn a_stream_ends_when_its_host_has_been_silent_for_30_s_unless_the_link_tells_when_it_goes() {
    for sees_host_go in [false, true] {
        let stored = Memory { active: Some(small_patch(Difference::Plain)), ..Memory::default() };
        let mut device =
            Device::new(BoardFacts { sees_host_go, ..facts(8) }, stored, PipelineState::default());
        assert!(!device.check_host(60_000), "nothing streams");
        // Both are asked 5 s after the start.
        ask(&mut device, Request::Stream(Selection { contacts: 1, ..Selection::default() }));
        assert!(!device.check_host(34_999) && device.needs_frames());
        device.handle(&RequestPacket { sequence: 1, request: Request::Info }, 20_000);
        assert!(!device.check_host(49_999) && device.needs_frames());
        assert_eq!(device.check_host(50_000), !sees_host_go);
        assert_eq!(device.needs_frames(), sees_host_go);
    }
}

#[test]
fn a_host_of_another_protocol_version_is_refused() {
    let version = Version { protocol: 99, schema: [0; 8] };
    let reply = ask(&mut device(), Request::Hello(version));
    assert_eq!(reply, Reply::Refused(Refusal::Version { board: PROTOCOL_VERSION }));
    assert!(matches!(ask(&mut device(), Request::Hello(Version::current())), Reply::Hello { .. }));
}

#[test]
fn a_board_without_a_patch_says_so() {
    let mut device = device();
    assert_eq!(ask(&mut device, Request::Tare { frames: 1 }), Reply::Refused(Refusal::NoPatch));
    assert_eq!(ask(&mut device, Request::ReadPatch { offset: 0 }), Reply::Refused(Refusal::NoPatch));
    let all = Selection { images: 1, contacts: 1, measurements: 1, ..Selection::default() };
    assert_eq!(ask(&mut device, Request::Stream(all)), Reply::Refused(Refusal::NoPatch));
    assert!(events(&mut device, &flat_frame(5)).is_empty());
}

#[test]
fn upload_tare_and_stream_number_their_events_without_gaps() {
    let mut device = device();
    upload_good(&mut device, Difference::Plain);
    let wanted = Selection { images: 1, contacts: 1, ..Selection::default() };
    assert_eq!(ask(&mut device, Request::Reference), Reply::Refused(Refusal::NotTared));
    assert_eq!(ask(&mut device, Request::Tare { frames: 2 }), Reply::Done);
    assert!(events(&mut device, &flat_frame(100)).is_empty());
    assert_eq!(events(&mut device, &flat_frame(100)), [(0, Event::Tared { frames: 2 })]);
    let sums = (0..40).map(|_| 200).collect();
    assert_eq!(ask(&mut device, Request::Reference), Reply::Reference { frames: 2, sums });
    assert_eq!(ask(&mut device, Request::Stream(wanted)), Reply::Streaming { first_sequence: 2 });
    let seen = events(&mut device, &flat_frame(150));
    assert!(matches!(seen[1], (2, Event::Image { .. })));
    let (1, Event::Contacts { at, contacts }) = &seen[0] else { panic!("{seen:?}") };
    assert_eq!((at.sequence, contacts.len()), (2, 1));
    assert!((contacts[0].strength - 0.5).abs() < 1e-4);
}

#[test]
fn a_damaged_upload_leaves_the_old_patch_in_use() {
    let mut device = device();
    let old = upload_good(&mut device, Difference::Plain);
    let mut bytes = small_patch(Difference::Normalised);
    let crc = PatchView::validate(&bytes).unwrap().crc();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    assert_eq!(upload(&mut device, &bytes, crc), Reply::Refused(Refusal::BadPatch));
    assert_eq!(device.patch().unwrap().crc(), old);
}

#[test]
fn a_link_cut_in_the_middle_of_an_upload_leaves_the_old_patch_in_use() {
    let mut device = device();
    let old = upload_good(&mut device, Difference::Plain);
    let bytes = small_patch(Difference::Normalised);
    ask(&mut device, Request::BeginUpload { length: bytes.len() as u32, crc: 1 });
    let piece = heapless::Vec::from_slice(&bytes[..100]).unwrap();
    assert_eq!(ask(&mut device, Request::UploadChunk { offset: 0, bytes: piece.clone() }), Reply::Done);
    device.disconnect();
    let next = Request::UploadChunk { offset: 100, bytes: piece };
    assert_eq!(ask(&mut device, next), Reply::Refused(Refusal::NoUpload));
    assert_eq!(device.patch().unwrap().crc(), old);
}

#[test]
fn pieces_out_of_turn_and_patches_too_long_are_refused() {
    let mut device = device();
    let long = Request::BeginUpload { length: MAX_PATCH_BYTES as u32 + 1, crc: 0 };
    assert!(matches!(ask(&mut device, long), Reply::Refused(Refusal::TooLong { .. })));
    assert_eq!(ask(&mut device, Request::CommitUpload), Reply::Refused(Refusal::NoUpload));
    ask(&mut device, Request::BeginUpload { length: 10, crc: 0 });
    let bytes = heapless::Vec::from_slice(&[0; 11]).unwrap();
    let refused = Reply::Refused(Refusal::OutOfOrder { expected: 0 });
    assert_eq!(ask(&mut device, Request::UploadChunk { offset: 0, bytes: bytes.clone() }), refused);
    assert_eq!(ask(&mut device, Request::UploadChunk { offset: 4, bytes }), refused);
    assert_eq!(ask(&mut device, Request::CommitUpload), refused);
}

#[test]
fn a_stored_patch_that_rotted_counts_as_none() {
    let mut bytes = small_patch(Difference::Plain);
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    let device =
        Device::new(facts(16), Memory { active: Some(bytes), ..Memory::default() }, PipelineState::default());
    assert!(device.patch().is_none());
}

#[test]
fn a_patch_for_more_electrodes_than_are_wired_is_refused() {
    let mut device = Device::new(facts(4), Memory::default(), PipelineState::default());
    let bytes = small_patch(Difference::Plain);
    let crc = PatchView::validate(&bytes).unwrap().crc();
    let refused = Reply::Refused(Refusal::Electrodes { patch: 8, board: 4 });
    assert_eq!(upload(&mut device, &bytes, crc), refused);
    assert!(device.patch().is_none());
}

#[test]
fn a_tare_of_no_frames_is_refused() {
    let mut device = device();
    upload_good(&mut device, Difference::Plain);
    let refused = Reply::Refused(Refusal::TareFrames { max: MAX_TARE_FRAMES });
    assert_eq!(ask(&mut device, Request::Tare { frames: 0 }), refused);
}

#[test]
fn a_board_says_where_its_frames_come_from_and_why_and_when_it_started() {
    let Reply::Info(info) = ask(&mut device(), Request::Info) else { panic!("no info") };
    assert_eq!((info.electrodes, info.frame_source), (16, FrameSource::Synthetic));
    assert_eq!((info.started_after, info.uptime_ms), (Restart::Watchdog, 5000));
}

#[test]
fn frames_are_needed_while_a_tare_or_a_stream_is_under_way() {
    let mut device = device();
    upload_good(&mut device, Difference::Plain);
    assert!(!device.needs_frames());
    ask(&mut device, Request::Tare { frames: 1 });
    assert!(device.needs_frames());
    events(&mut device, &flat_frame(100));
    assert!(!device.needs_frames());
    ask(&mut device, Request::Stream(Selection { contacts: 1, ..Selection::default() }));
    assert!(device.needs_frames());
}

#[test]
fn a_tare_that_began_by_itself_ends_with_the_stream_and_one_that_finds_no_current_gives_up() {
    let mut device = device();
    upload_good(&mut device, Difference::Plain);
    ask(&mut device, Request::Stream(Selection { contacts: 1, ..Selection::default() }));
    events(&mut device, &flat_frame(100));
    assert!(device.pipeline().is_taring());
    ask(&mut device, Request::Stream(Selection::default()));
    assert!(!device.needs_frames());
    ask(&mut device, Request::Tare { frames: 5 });
    let dead = Frame { flags: FrameFlags::NO_CURRENT, ..flat_frame(0) };
    let frames = (0..1000).take_while(|_| {
        events(&mut device, &dead);
        device.needs_frames()
    });
    assert_eq!(frames.count(), 19);
}

#[test]
fn each_event_comes_every_so_many_frames() {
    let mut device = device();
    upload_good(&mut device, Difference::Plain);
    ask(&mut device, Request::Tare { frames: 1 });
    events(&mut device, &flat_frame(100));
    let wanted = Selection { images: 4, contacts: 1, measurements: 2, health: 3, ..Selection::default() };
    ask(&mut device, Request::Stream(wanted));
    let mut seen = [0; 4];
    for _ in 1..=12 {
        for (_, event) in events(&mut device, &flat_frame(100)) {
            seen[match event {
                Event::Image { .. } => 0,
                Event::Contacts { .. } => 1,
                Event::Measurements { .. } => 2,
                Event::Health { .. } => 3,
                other => panic!("{other:?}"),
            }] += 1;
        }
    }
    assert_eq!(seen, [3, 12, 6, 4]);
}

#[test]
fn of_a_frame_the_tare_comes_first_then_contacts_health_codes_and_at_last_the_image() {
    let mut device = device();
    upload_good(&mut device, Difference::Plain);
    ask(&mut device, Request::Tare { frames: 1 });
    let all = Selection { images: 1, contacts: 1, measurements: 1, health: 1, ..Selection::default() };
    ask(&mut device, Request::Stream(all));
    let seen = events(&mut device, &flat_frame(100));
    assert!(
        matches!(
            seen.as_slice(),
            [(0, Event::Tared { .. }), (1, Event::Health { .. }), (2, Event::Measurements { .. })]
        ),
        "{seen:?}"
    );
    let seen = events(&mut device, &flat_frame(100));
    assert!(
        matches!(
            seen.as_slice(),
            [
                (3, Event::Contacts { .. }),
                (4, Event::Health { .. }),
                (5, Event::Measurements { .. }),
                (6, Event::Image { .. })
            ]
        ),
        "{seen:?}"
    );
}

fn board_with_a_front_end() -> Device<Memory> {
    let mut device = Device::new(
        BoardFacts { front_end: Some(FRONT_END), ..facts(16) },
        Memory::default(),
        PipelineState::default(),
    );
    upload_good(&mut device, Difference::Normalised);
    device
}

#[test]
fn a_drive_that_the_front_end_cannot_make_is_refused() {
    let mut device = board_with_a_front_end();
    let usual = Drive::new(100e3, 1e-3, 50.0);
    let wrong = [
        Drive { frequency: 90e3, ..usual },
        Drive { amplitude: 2e-3, ..usual },
        Drive { gain: crate::drive::Gain::Fixed(7), ..usual },
    ];
    for drive in wrong {
        let reply = ask(&mut device, Request::Drive(Some(drive)));
        assert_eq!(reply, Reply::Refused(Refusal::Drive { max_microamperes: 1000, max_gain: 64 }));
    }
    assert_eq!(device.drive().unwrap().frequency, 50e3);
}

#[test]
fn a_gain_beyond_the_boards_amplifier_is_refused() {
    let mut device = board_with_a_front_end();
    device.facts.front_end = device.facts.front_end.map(|known| FrontEnd { largest_gain: 1, ..known });
    let with = |gain| Request::Drive(Some(Drive { gain, ..Drive::new(100e3, 1e-3, 50.0) }));
    let refused = Reply::Refused(Refusal::Drive { max_microamperes: 1000, max_gain: 1 });
    assert_eq!(ask(&mut device, with(crate::drive::Gain::Fixed(2))), refused);
    assert_eq!(ask(&mut device, with(crate::drive::Gain::Fixed(1))), Reply::Done);
    assert_eq!(ask(&mut device, with(crate::drive::Gain::Automatic)), Reply::Done);
}

#[test]
fn a_trim_is_kept_and_measured_with_and_one_that_no_part_needs_is_refused() {
    let mut device = board_with_a_front_end();
    let mut trim = Trim::NONE;
    trim.multiply(2, 3, [1.25, -0.5]);
    let scan = device.scan();
    assert_eq!(ask(&mut device, Request::Trim(trim)), Reply::Done);
    assert_ne!(device.scan(), scan);
    assert_eq!(device.front_end().unwrap().trim, trim);
    let mut wild = trim;
    wild.multiply(0, 0, [2.0, 0.0]);
    assert_eq!(ask(&mut device, Request::Trim(wild)), Reply::Refused(Refusal::Trim));
    let Reply::Info(info) = ask(&mut device, Request::Info) else { panic!("no info") };
    assert_eq!(info.front_end.unwrap().trim, trim);
    let started = Device::new(
        BoardFacts { front_end: Some(FRONT_END), ..facts(16) },
        device.store,
        PipelineState::default(),
    );
    assert_eq!(started.front_end().unwrap().trim, trim);
}

#[test]
fn a_board_that_does_not_measure_has_nothing_to_trim() {
    let refused = Reply::Refused(Refusal::Unsupported);
    assert_eq!(ask(&mut device(), Request::Trim(Trim::NONE)), refused);
}

#[test]
fn a_new_drive_begins_a_new_scan_and_the_old_reference_counts_no_more() {
    let mut device = board_with_a_front_end();
    ask(&mut device, Request::Tare { frames: 1 });
    events(&mut device, &flat_frame(100));
    assert!(device.pipeline().reference().is_some());
    let scan = device.scan();
    let drive = Drive::new(100e3, 0.5e-3, 50.0);
    assert_eq!(ask(&mut device, Request::Drive(Some(drive))), Reply::Done);
    assert_ne!(device.scan(), scan);
    assert!(device.pipeline().reference().is_none());
    assert_eq!(device.drive(), Some(drive));
    ask(&mut device, Request::Drive(None));
    assert_eq!(device.drive().unwrap().frequency, 50e3);
}

#[test]
fn a_scope_beyond_the_scan_is_refused() {
    let mut device = board_with_a_front_end();
    let beyond = Selection { scope: 1, scope_slot: 48, ..Selection::default() };
    assert_eq!(ask(&mut device, Request::Stream(beyond)), Reply::Refused(Refusal::Slot { last: 47 }));
    let last = Selection { scope_slot: 47, ..beyond };
    assert!(matches!(ask(&mut device, Request::Stream(last)), Reply::Streaming { .. }));
}

#[test]
fn a_frame_with_an_open_electrode_is_flagged_and_its_image_masked() {
    use crate::{frame::ElectrodeTest, units::AdcCode};
    let mut device = board_with_a_front_end();
    ask(&mut device, Request::Tare { frames: 1 });
    events(&mut device, &flat_frame(1000));
    let test = ElectrodeTest { in_phase: AdcCode(1_500_000), ..ElectrodeTest::default() };
    let mut broken = flat_frame(1200);
    broken.tests = (0..8).map(|_| test).collect();
    broken.tests[3] = ElectrodeTest { in_phase: AdcCode(7_000_000), is_clipped: true, ..test };
    // What changes with the electrode is no press.
    for _ in 0..3 {
        device.process(&mut broken.clone(), &Arrival::default(), |_| ());
        assert!(device.pipeline().image().iter().all(|pixel| pixel.0 == 0));
    }
    broken.codes.iter_mut().for_each(|code| code.0 = 1800);
    device.process(&mut broken, &Arrival::default(), |_| ());
    assert!(broken.flags.contains(FrameFlags::OPEN_ELECTRODE));
    assert!(broken.flags.contains(FrameFlags::MASKED));
    assert_eq!(device.health().open.iter().collect::<Vec<_>>(), [3]);
    // Steps 0, 1 and 2 sense electrode 3 under drive 0, the one that pixel 3 reads does not.
    let image = device.pipeline().image();
    assert_eq!(image[0].0, 0);
    assert!((image[3].to_f64() - 0.5).abs() < 1e-4, "{image:?}");
}

#[test]
fn a_frame_gets_number_time_and_flags_of_the_board_where_it_is_processed() {
    let mut device = board_with_a_front_end();
    device.set_vitals(Vitals { temperature: Some(86.0), ..Vitals::default() });
    ask(&mut device, Request::Tare { frames: 1 });
    let mut frame = flat_frame(1000);
    device.process(&mut frame, &Arrival::default(), |_| ());
    assert_eq!((frame.sequence, frame.timestamp_us, frame.flags), (0, 0, FrameFlags::HOT));
    frame = Frame { sequence: 77, timestamp_us: 5, ..flat_frame(1000) };
    device.process(&mut frame, &Arrival { timestamp_us: 20_000, missed: true, ..Arrival::default() }, |_| ());
    assert_eq!((frame.sequence, frame.timestamp_us), (1, 20_000));
    assert_eq!(frame.flags, FrameFlags::HOT.union(FrameFlags::MISSED));
    let selection = Selection { health: 1, ..Selection::default() };
    assert_eq!(ask(&mut device, Request::Stream(selection)), Reply::Streaming { first_sequence: 2 });
    let seen = events(&mut device, &flat_frame(1000));
    assert!(matches!(seen[0].1, Event::Health { missed: 1, .. }), "{seen:?}");
}

#[test]
fn a_contact_that_becomes_worse_after_the_tare_is_told_and_masked() {
    use crate::{frame::ElectrodeTest, units::AdcCode};
    let mut device = board_with_a_front_end();
    let mut frame = flat_frame(1000);
    frame.tests =
        (0..8).map(|_| ElectrodeTest { in_phase: AdcCode(1_500_000), ..ElectrodeTest::default() }).collect();
    ask(&mut device, Request::Tare { frames: 2 });
    for _ in 0..3 {
        let mut taken = frame.clone();
        device.process(&mut taken, &Arrival::default(), |_| ());
        assert_eq!(taken.flags, FrameFlags::default());
    }
    frame.tests[5].in_phase = AdcCode(2_200_000);
    device.process(&mut frame, &Arrival::default(), |_| ());
    assert_eq!(frame.flags, FrameFlags::WORSE_CONTACT.union(FrameFlags::MASKED));
    assert_eq!(device.health().worse.iter().collect::<Vec<_>>(), [5]);
}

#[test]
fn a_board_with_reflexes_scans_for_itself_and_tells_what_they_say_when_that_changes() {
    let bytes = patch_with_reflexes(&[rule(Limit::Strength(0.5))], &[row(&[10.0; 40])]);
    let stored = Memory { active: Some(bytes), ..Memory::default() };
    let mut device = Device::new(facts(8), stored, PipelineState::default());
    let mut watch = Watch::new();
    assert!(device.needs_frames(), "with no host");
    device.begin_watch(&mut watch);
    let mut told = |device: &mut Device<Memory>, code: i32, time: u64| {
        let mut frame = flat_frame(code);
        let arrival = Arrival { timestamp_us: time, missed: false, reflexes: watch.see(&frame, time) };
        let mut told = Vec::new();
        device.process(&mut frame, &arrival, |packet| {
            if let BoardPacket::Event { event: Event::Reflexes { at, reflexes }, .. } = packet {
                told.push((at.timestamp_us, reflexes.tripped, reflexes.is_blind));
            }
        });
        device.brief(&mut watch);
        told
    };
    // Blind until a reference is there, which the board makes by itself, and has been taken over into both rows.
    let blind: Vec<_> = (0..30).flat_map(|time| told(&mut device, 1000, time)).collect();
    assert_eq!(blind, [(0, 1, true), (21, 0, false)]);
    assert_eq!([told(&mut device, 1010, 40), told(&mut device, 1010, 41)], [vec![(40, 1, false)], vec![]]);
    assert_eq!(told(&mut device, 1000, 42), [(42, 0, false)]);
    // A host that comes later is told, and now and then again.
    ask(&mut device, Request::Stream(Selection { contacts: 1, ..Selection::default() }));
    let again: Vec<_> = (50..150).flat_map(|time| told(&mut device, 1000, time)).collect();
    assert_eq!(again.first(), Some(&(50, 0, false)));
    assert!((2..=3).contains(&again.len()), "{again:?}");
    // Another patch without reflexes ends them.
    upload_good(&mut device, Difference::Plain);
    assert!(!device.needs_frames());
}
