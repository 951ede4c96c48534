//! Recordings that end too early, are damaged, or are none.

use dermatome_link::{ScanFrame, assemble::Measurements};
use dermatome_messages::{
    Packed, Topic, cdr,
    dermatome::Reference,
    frame::{Outlook, Place},
};
use dermatome_recording::{
    frames::{Frames, Item},
    read::{Ending, Problem, Recording},
    session::Session,
    write::Recorder,
};
use dermatome_shared::{
    drive::Drive,
    frame::FrameFlags,
    protocol::{FrameSource, FrameStamp, PackedImage},
    units::AdcCode,
};
use proptest::prelude::*;
use std::{io::Cursor, path::Path, sync::OnceLock};

/// Frames before the chunk that is cut, and in it.
const FIRST: u32 = 20;
const LAST: u32 = 4;

fn session() -> Session {
    Session {
        skin: "palm".to_owned(),
        board: "simulated".to_owned(),
        firmware: "0.1.0".to_owned(),
        frame_source: FrameSource::Synthetic,
        port: "sim:skin.toml".to_owned(),
        protocol: 13,
        host: "0.1.0".to_owned(),
        patch: vec![7; 100],
        skin_file: Some("name = \"palm\"".to_owned()),
    }
}

/// A frame whose codes do not compress.
fn frame(sequence: u32) -> ScanFrame {
    let mut state = sequence.wrapping_mul(2_654_435_761);
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 8
    };
    let codes = (0..208).map(|_| AdcCode(random() as i32)).collect();
    let mantissas = (0..300).map(|_| random() as i16).collect();
    ScanFrame {
        at: Some(FrameStamp {
            sequence,
            timestamp_us: u64::from(sequence) * 2500,
            flags: FrameFlags::default(),
        }),
        measurements: Some(Measurements { codes, quadrature: Vec::new() }),
        image: Some(PackedImage { exponent: 12, mantissas }),
        contacts: Some(Default::default()),
        ..ScanFrame::default()
    }
}

/// Bytes of a recording, and its length before the last frames were written.
fn recorded() -> &'static (Vec<u8>, usize) {
    static RECORDED: OnceLock<(Vec<u8>, usize)> = OnceLock::new();
    RECORDED.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        let mut recorder = Recorder::create(&path, &session()).unwrap();
        let reference = Reference::new(Default::default(), 0, 20, &Drive::new(50e3, 1e-3, 400.0));
        recorder.record(vec![Packed::now(Topic::Reference, 0, cdr::encode(&reference))]);
        let mut outlook = Outlook::new(Place::of("palm", None));
        let mut record = |recorder: &mut Recorder, sequence| {
            recorder.record(outlook.messages(&frame(sequence), 1_700_000_000_000_000_000, |_| true));
        };
        (0..FIRST).for_each(|sequence| record(&mut recorder, sequence));
        // A chunk is written with the first message that comes a second later.
        std::thread::sleep(std::time::Duration::from_millis(1100));
        record(&mut recorder, FIRST);
        while recorder.recorded().frames <= u64::from(FIRST) {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
        let before = recorder.recorded().bytes as usize;
        (FIRST + 1..FIRST + LAST).for_each(|sequence| record(&mut recorder, sequence));
        let recorded = recorder.finish().unwrap();
        assert_eq!((recorded.frames, recorded.dropped), (u64::from(FIRST + LAST), 0));
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(recorded.bytes as usize, bytes.len());
        (bytes, before)
    })
}

/// Frames of the recording in some bytes, and how it ends.
fn read(bytes: Vec<u8>) -> Result<(Vec<u32>, bool, Ending), Problem> {
    let length = bytes.len() as u64;
    let recording = Recording::of(Path::new("run.mcap"), Box::new(Cursor::new(bytes)), length);
    let mut frames = Frames::of(recording.map_err(|error| error.problem)?);
    let (mut sequences, mut has_reference) = (Vec::new(), false);
    while let Some(item) = frames.next_item().map_err(|error| error.problem)? {
        match item {
            Item::Reference(reference) => has_reference = reference.frames == 20,
            Item::Frame(frame) => sequences.push(frame.at.sequence),
        }
    }
    Ok((sequences, has_reference, frames.recording().ending().clone()))
}

#[test]
fn a_whole_recording_holds_all_frames_and_what_it_is_of() {
    let (bytes, _) = recorded();
    let (sequences, has_reference, ending) = read(bytes.clone()).unwrap();
    assert_eq!(sequences, (0..FIRST + LAST).collect::<Vec<_>>());
    assert!(has_reference);
    assert_eq!(ending, Ending::Whole);
    let source = Box::new(Cursor::new(bytes.clone()));
    let recording = Recording::of(Path::new("run.mcap"), source, bytes.len() as u64).unwrap();
    assert_eq!(recording.session(), &session());
}

#[test]
fn cut_at_every_byte_of_what_came_last_all_before_is_there() {
    let (bytes, before) = recorded();
    assert!(bytes.len() - before > 2000, "{} of {}", before, bytes.len());
    for length in *before..bytes.len() {
        let (sequences, has_reference, ending) = read(bytes[..length].to_vec()).unwrap();
        assert!(has_reference, "{length}");
        let count = sequences.len() as u32;
        assert!((FIRST + 1..=FIRST + LAST).contains(&count), "{length}: {count} frames");
        assert_eq!(sequences, (0..count).collect::<Vec<_>>(), "{length}");
        assert_eq!(ending, Ending::Cut, "{length}");
    }
}

#[test]
fn cut_before_its_patch_and_other_files_are_refused_in_words() {
    let (bytes, _) = recorded();
    let problem = |bytes: &[u8]| read(bytes.to_vec()).unwrap_err();
    assert!(matches!(problem(b""), Problem::NotMcap));
    assert!(matches!(problem(b"\x93NUMPY and so on, an array of another program"), Problem::NotMcap));
    assert!(matches!(problem(&bytes[..8]), Problem::NotMcap));
    let refused = (8..700).filter(|length| read(bytes[..*length].to_vec()).is_err()).count();
    assert!(refused > 100, "{refused}");
}

#[test]
fn what_does_not_come_from_a_board_waits_for_the_disk() {
    const FRAMES: u32 = 20_000;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut recorder = Recorder::create(&path, &session()).unwrap().waiting();
    let messages = Outlook::new(Place::of("palm", None)).messages(&frame(1), 1, |_| true);
    (0..FRAMES).for_each(|_| recorder.record(messages.clone()));
    let recorded = recorder.finish().unwrap();
    assert_eq!((recorded.frames, recorded.dropped), (FRAMES.into(), 0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn damaged_bytes_are_an_end_or_an_error_and_no_panic(
        places in prop::collection::vec((0_usize..6000, any::<u8>()), 1..6),
        from_end: bool,
    ) {
        let mut bytes = recorded().0.clone();
        let length = bytes.len();
        for (place, value) in places {
            let place = if from_end { length - 1 - place % length } else { place % length };
            bytes[place] = value;
        }
        if let Ok((sequences, _, _)) = read(bytes) {
            prop_assert!(sequences.len() as u32 <= FIRST + LAST);
        }
    }
}
