//! Any bytes as a recording: read up to an end or an error, and what is read goes through the pipeline of its patch.
#![no_main]

use dermatome::recording::{
    frames::{Frames, Item},
    play::Player,
    read::Recording,
};
use dermatome_shared::patch::PatchView;
use libfuzzer_sys::fuzz_target;
use std::{io::Cursor, path::Path};

fuzz_target!(|bytes: &[u8]| {
    let source = Box::new(Cursor::new(bytes.to_vec()));
    let Ok(recording) = Recording::of(Path::new("run.mcap"), source, bytes.len() as u64) else { return };
    let patch = recording.session().patch.clone();
    let patch = PatchView::validate(&patch).ok();
    let steps: Vec<_> = patch.iter().flat_map(|patch| patch.steps()).collect();
    let mut player = patch.as_ref().and_then(|patch| Player::new(patch, &steps).ok());
    let mut frames = Frames::of(recording);
    while let Ok(Some(item)) = frames.next_item() {
        if let Item::Frame(frame) = &item {
            let _ = frame.raw();
        }
        let _ = player.as_mut().map(|player| player.take(&item));
    }
    assert!(frames.recording().progress() <= 1.0);
});
