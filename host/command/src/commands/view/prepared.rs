//! Prepared: patches that stand ready, through which this computer takes the board's raw frames.

use anyhow::Context;
use dermatome_link::ScanFrame;
use dermatome_recording::{
    frames::{Item, RecordedFrame},
    play::Player,
};
use dermatome_shared::{patch::PatchView, stimulation::Step};

/// A patch that is not on the board, in use.
pub(super) struct Prepared<'a> {
    player: Player<'a>,
}

impl<'a> Prepared<'a> {
    /// Begins with the frames of the board's last tare, `tare`, measured in these steps.
    pub(super) fn new(patch: &'a PatchView<'a>, steps: &[Step], tare: &[Item]) -> anyhow::Result<Self> {
        let mut prepared = Self { player: Player::new(patch, steps)? };
        prepared.tare(tare)?;
        Ok(prepared)
    }

    /// Makes its reference of the frames of a tare.
    pub(super) fn tare(&mut self, tare: &[Item]) -> anyhow::Result<()> {
        let mut items = tare.iter();
        items.try_for_each(|item| self.player.take(item).map(drop)).context("the frames of the last tare")
    }

    /// The frame as a board with this patch would have sent it: without image and contacts before a reference.
    pub(super) fn frame(&mut self, frame: &ScanFrame, now: u64) -> anyhow::Result<ScanFrame> {
        let item = RecordedFrame::of(frame, now).map(|frame| Item::Frame(Box::new(frame)));
        let played = item.map_or(Ok(None), |item| self.player.take(&item))?;
        Ok(ScanFrame {
            at: played.as_ref().map_or(frame.at, |played| Some(played.at)),
            image: played.as_ref().map(|played| played.image.clone()),
            contacts: played.map(|played| played.contacts),
            ..frame.clone()
        })
    }
}
