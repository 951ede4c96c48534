//! Recordings of all skins of a body: each is read by itself, from when its board was there, wherever the file ends.

use dermatome_link::{ScanFrame, assemble::Measurements};
use dermatome_messages::frame::{Outlook, Place};
use dermatome_recording::{
    frames::{Frames, Item},
    read::{Ending, Problem, ReadError, Recording, file_and_patch},
    session::{Body, Session},
    write::Recorder,
};
use dermatome_shared::{
    frame::FrameFlags,
    protocol::{FrameSource, FrameStamp},
    units::AdcCode,
};
use std::path::{Path, PathBuf};

/// Frames of the palm before the back's board is there, and of both from then on.
const ALONE: u32 = 30;
const BOTH: u32 = 50;

fn session(skin: &str) -> Session {
    Session {
        skin: format!("{skin}-skin"),
        board: "simulated".to_owned(),
        firmware: "0.1.0".to_owned(),
        frame_source: FrameSource::Simulated,
        port: format!("sim:{skin}.toml"),
        protocol: 14,
        host: "0.1.0".to_owned(),
        patch: skin.repeat(20).into_bytes(),
        skin_file: Some(format!("name = \"{skin}-skin\"")),
    }
}

/// A frame whose codes tell its number.
fn frame(sequence: u32) -> ScanFrame {
    let codes = (0..104).map(|step| AdcCode((sequence * 1000 + step) as i32)).collect();
    let timestamp_us = u64::from(sequence) * 2500;
    ScanFrame {
        at: Some(FrameStamp { sequence, timestamp_us, flags: FrameFlags::default() }),
        measurements: Some(Measurements { codes, quadrature: Vec::new() }),
        contacts: Some(Default::default()),
        ..ScanFrame::default()
    }
}

fn body() -> Body {
    Body { name: "arm".to_owned(), patches: ["palm", "back", "gone"].map(str::to_owned).into() }
}

/// A file of a palm from frame 100 on, of a back that comes later, from 500 on, and of a board that never does.
fn recorded(folder: &Path) -> PathBuf {
    let path = folder.join("run.mcap");
    let whole = Recorder::create_of_body(&path, "0.1.0", &body()).unwrap();
    let [mut palm, mut back, mut gone] = [0, 1, 2].map(|skin| whole.part(skin));
    let mut outlook = Outlook::new(Place::of("skin", None));
    let mut messages =
        |sequence: u32| outlook.messages(&frame(sequence), 1_700_000_000_000_000_000, |_| true);
    palm.begin(&session("palm"));
    back.record(messages(1));
    (0..ALONE).for_each(|frame| palm.record(messages(100 + frame)));
    back.begin(&session("back"));
    for frame in 0..BOTH {
        back.record(messages(500 + frame));
        palm.record(messages(100 + ALONE + frame));
    }
    gone.record(messages(2));
    let so_far = gone.finish().unwrap();
    assert_eq!(so_far.failure, None);
    drop((palm, back));
    let recorded = whole.finish().unwrap();
    assert_eq!((recorded.frames, recorded.dropped), (u64::from(ALONE + 2 * BOTH), 0));
    assert_eq!(recorded.bytes, std::fs::metadata(&path).unwrap().len());
    path
}

/// Numbers of the frames of a skin, and how the file ends.
fn read(path: &Path) -> Result<(Session, Vec<u32>, Ending), ReadError> {
    let mut frames = Frames::of(Recording::open(path)?);
    let mut sequences = Vec::new();
    while let Some(item) = frames.next_item()? {
        let Item::Frame(frame) = item else { continue };
        let [codes, _] = frame.codes.unwrap();
        assert_eq!(codes[3].0, (frame.at.sequence * 1000 + 3) as i32);
        sequences.push(frame.at.sequence);
    }
    Ok((frames.recording().session().clone(), sequences, frames.recording().ending().clone()))
}

fn behind(path: &Path, patch: &str) -> PathBuf {
    format!("{}:{patch}", path.display()).into()
}

#[test]
fn each_skin_is_read_by_itself_with_its_patch_and_skin_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path());
    for (patch, first, count) in [("palm", 100, ALONE + BOTH), ("back", 500, BOTH)] {
        let (found, sequences, ending) = read(&behind(&path, patch)).unwrap();
        assert_eq!((found, ending), (session(patch), Ending::Whole));
        assert_eq!(sequences, (first..first + count).collect::<Vec<_>>(), "{patch}");
    }
}

#[test]
fn one_of_several_skins_is_asked_for_by_name_and_others_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path());
    let refused = |path: &Path| read(path).unwrap_err();
    let words = refused(&path).to_string();
    assert!(
        words.contains("3 skins of the body `arm`") && words.contains("`:palm`, `:back`, `:gone`"),
        "{words}"
    );
    let other = refused(&behind(&path, "foot"));
    assert!(matches!(other.problem, Problem::Other { .. }), "{other}");
    assert!(other.to_string().contains("`foot`") && other.to_string().contains("`:back`"), "{other}");
    assert_eq!(other.path, path);
    let unheard = refused(&behind(&path, "gone"));
    assert!(matches!(&unheard.problem, Problem::Unheard(skin) if skin == "arm/gone"), "{unheard}");
}

#[test]
fn the_only_skin_of_a_body_and_a_single_one_need_no_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("one.mcap");
    let only = Body { patches: vec!["palm".to_owned()], ..body() };
    let whole = Recorder::create_of_body(&path, "0.1.0", &only).unwrap();
    let mut palm = whole.part(0);
    palm.begin(&session("palm"));
    drop(palm);
    whole.finish().unwrap();
    assert_eq!(read(&path).unwrap().0, session("palm"));
    let single = folder.path().join("single.mcap");
    Recorder::create(&single, &session("palm")).unwrap().finish().unwrap();
    assert_eq!(read(&behind(&single, "palm-skin")).unwrap().0, session("palm"));
    let other = read(&behind(&single, "back")).unwrap_err().to_string();
    assert!(other.contains("`back`") && other.contains("nothing, or `palm-skin`"), "{other}");
}

#[test]
fn cut_anywhere_each_skin_is_there_up_to_its_last_whole_chunk_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path());
    let bytes = std::fs::read(&path).unwrap();
    let cut = folder.path().join("cut.mcap");
    let mut longest = [0; 2];
    let mut lacks = 0;
    for length in (0..bytes.len()).step_by(37) {
        std::fs::write(&cut, &bytes[..length]).unwrap();
        for (most, (patch, first)) in longest.iter_mut().zip([("palm", 100), ("back", 500)]) {
            match read(&behind(&cut, patch)) {
                Ok((found, sequences, ending)) => {
                    assert_eq!(found.patch, session(patch).patch);
                    assert_eq!(sequences, (first..first + sequences.len() as u32).collect::<Vec<_>>());
                    assert!(sequences.len() >= *most, "{length}");
                    *most = sequences.len();
                    assert_eq!(ending, Ending::Cut, "{length}");
                }
                Err(error) => {
                    assert!(matches!(error.problem, Problem::NotMcap | Problem::Unheard(_)), "{error}");
                    assert_eq!(*most, 0);
                    lacks += 1;
                }
            }
        }
    }
    assert!(longest.iter().all(|frames| *frames > 0) && lacks > 5, "{longest:?}, {lacks}");
}

#[test]
fn the_patch_stands_behind_a_file_of_its_ending_alone() {
    let split = |text: &str| file_and_patch(Path::new(text));
    assert_eq!(split("run.mcap:palm"), ("run.mcap".into(), Some("palm".to_owned())));
    assert_eq!(split("C:\\run.MCAP:palm"), ("C:\\run.MCAP".into(), Some("palm".to_owned())));
    for text in ["C:\\run.mcap", "run.mcap", "run.npz:palm", ""] {
        assert_eq!(split(text), (text.into(), None));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_without_room_is_told_before_anything_is_recorded() {
    let full = Recorder::create_of_body(Path::new("/dev/full"), "0.1.0", &body());
    let words = full.unwrap_err().to_string();
    assert!(words.contains("`/dev/full`") && words.contains("space"), "{words}");
}
