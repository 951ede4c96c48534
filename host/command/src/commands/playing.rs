//! Playing: recorded frames through a board's pipeline, and what comes of them into a recording, if there is to be one.

use super::outlets::{Outlets, recorded_in_words};
use anyhow::Context;
use dermatome_link::{ScanFrame, assemble::Measurements, pose::Pose};
use dermatome_messages::skin::Look;
use dermatome_recording::{
    frames::{Item, RecordedFrame},
    play::{PlayError, Played, Player},
    session::Session,
    write::Recorder,
};
use dermatome_shared::{
    patch::PatchView,
    protocol::{FrameSource, PROTOCOL_VERSION},
    stimulation::Step,
};
use std::path::Path;

/// Recorded frames on their way.
pub(super) struct Playing<'a> {
    player: Player<'a>,
    outlets: Option<Outlets>,
}

impl<'a> Playing<'a> {
    /// With a patch, for frames that were recorded with these steps.
    pub(super) fn new(patch: &'a PatchView<'a>, recorded: &[Step]) -> Result<Self, PlayError> {
        Ok(Self { player: Player::new(patch, recorded)?, outlets: None })
    }

    /// Records to `file` what comes of them, of a skin that lies so; they have begun then, ns since 1970.
    pub(super) fn record(
        &mut self,
        file: &Path,
        session: &Session,
        pose: Option<&Pose>,
        begun: u64,
    ) -> anyhow::Result<()> {
        let mut outlets = Outlets::new(session, pose, &Look::default())?;
        outlets.record_from(Recorder::create(file, session)?.waiting(), begun);
        self.outlets = Some(outlets);
        Ok(())
    }

    /// Whether there was a reference.
    pub(super) fn has_begun(&self) -> bool {
        self.player.has_begun()
    }

    /// Takes what comes next; gives what a board would have said of a frame.
    pub(super) fn take(&mut self, item: &Item) -> Result<Option<Played>, PlayError> {
        let played = self.player.take(item)?;
        let Some(outlets) = self.outlets.as_mut().filter(|_| self.player.has_begun()) else {
            return Ok(played);
        };
        match item {
            Item::Reference(reference) => {
                outlets.drive(&reference.drive(), None);
                outlets.tare_begins(reference.frames);
            }
            Item::Frame(recorded) => {
                outlets.frame_of(&scan_frame(recorded, played.as_ref()), None, recorded.log_time);
            }
        }
        Ok(played)
    }

    /// Ends the recording, if there is one, and says what is in it.
    pub(super) fn finish(mut self) -> anyhow::Result<()> {
        let Some(outlets) = &mut self.outlets else { return Ok(()) };
        let written = outlets.finish_recording()?;
        written.iter().for_each(|(file, recorded)| eprintln!("{}", recorded_in_words(file, recorded)));
        Ok(())
    }
}

/// What a recording is of that is made of another instrument's `frames` with a patch.
pub(super) fn session_of_others(
    patch: &PatchView<'_>,
    frames: String,
    skin_file: Option<&Path>,
) -> anyhow::Result<Session> {
    Ok(Session {
        skin: patch.header.skin.as_str().to_owned(),
        board: "replay".to_owned(),
        firmware: env!("CARGO_PKG_VERSION").to_owned(),
        frame_source: FrameSource::Skin,
        port: frames,
        protocol: PROTOCOL_VERSION,
        host: env!("CARGO_PKG_VERSION").to_owned(),
        patch: patch.bytes().to_vec(),
        skin_file: skin_file
            .map(std::fs::read_to_string)
            .transpose()
            .context("cannot read the skin file once more")?,
    })
}

/// A frame as a board with the patch would have sent it.
fn scan_frame(recorded: &RecordedFrame, played: Option<&Played>) -> ScanFrame {
    let codes = recorded.codes.clone();
    let measurements = codes.map(|[codes, quadrature]| Measurements { codes, quadrature });
    ScanFrame {
        at: Some(played.map_or(recorded.at, |played| played.at)),
        measurements,
        image: played.map(|played| played.image.clone()),
        contacts: played.map(|played| played.contacts.clone()),
        health: recorded.health.clone(),
        ..ScanFrame::default()
    }
}
