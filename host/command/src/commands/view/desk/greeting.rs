//! Greeting: a board that has just answered is made ready, and shown.

use super::{Desk, LOOK_AGAIN, Present};
use crate::commands::{interrupt, outlets::session, stream::session::Session as Board};
use anyhow::Context;
use dermatome_link::{Untouched, silence_timeout};
use dermatome_messages::dermatome::number_of_gain;
use dermatome_recording::session::Session;
use dermatome_shared::{drive::Drive, patch::PatchView, protocol::Request};

impl Desk<'_> {
    /// Gets to know a board that has just answered, and makes it ready.
    pub(super) fn greet(&mut self, board: &mut Board<'_>) -> anyhow::Result<Present> {
        let text = self.task.look.text();
        let link = board.link()?;
        let session = session(link, text)?;
        let info = link.info()?;
        let is_same_skin = session.skin == self.status.skin;
        if let Some(drive) = self.drive.filter(|drive| is_same_skin && Some(*drive) != info.drive) {
            link.request(&Request::Drive(Some(drive)))?;
            board.patch.drive = drive;
        }
        let patch = board.patch.clone();
        let link = board.link()?;
        if !Untouched::is_lost(self.untouched.as_ref(), link, &patch)? {
            self.untouched = Untouched::of(link, &patch).ok();
        } else {
            // One that the board begins by itself may take frames before the stream.
            self.wants_tare = true;
            self.wait_untouched(board)?;
            let Board { link, patch, .. } = &mut *board;
            let link = link.as_mut().context("the board is lost")?;
            self.task.current.fit(link, patch, || !interrupt::requested())?;
        }
        let (pose, look) = self.task.look.on(&session)?;
        let patch = PatchView::validate(&session.patch).context("the board's patch")?;
        let steps = patch.steps().collect();
        self.rules = patch.reflex_rules().collect();
        let front_end = info.front_end;
        let present = Present {
            pose,
            look,
            steps,
            largest_amplitude: front_end.map_or(0.0, |front_end| front_end.full_scale_current),
            sample_rate: front_end.map(|front_end| front_end.sample_rate),
            session,
        };
        self.show_board(&present, board);
        Ok(present)
    }

    /// A board that has lost its reference waits for a skin that nothing presses, or until the page asks for a tare all
    /// the same.
    fn wait_untouched(&mut self, board: &mut Board<'_>) -> anyhow::Result<()> {
        let patch = &board.patch;
        let Some(untouched) = self.untouched.clone().filter(|it| it.is_of(patch)) else { return Ok(()) };
        let timeout = silence_timeout(patch);
        while self.waiting.is_empty() && untouched.is_pressed(board.link()?, timeout)? {
            self.state(
                "not_tared",
                "the board has lost its reference, and something presses on the skin, or it has changed",
                "free the skin: the board makes its new reference then; or tare now, and what presses is not seen",
            );
            if !self.wait(LOOK_AGAIN, "the board has no reference") {
                break;
            }
        }
        Ok(())
    }

    /// The page shows this board from now on.
    fn show_board(&mut self, present: &Present, board: &Board<'_>) {
        let Session { board: kind, firmware, skin, .. } = &present.session;
        let named = self.task.patches.iter().map(|(name, _)| name.clone());
        let patches = std::iter::once(format!("{skin} (on the board)")).chain(named).collect();
        let status = &mut self.status;
        (status.board, status.firmware, status.skin) = (kind.clone(), firmware.clone(), skin.clone());
        (status.patch_crc, status.patches) = (board.patch.crc, patches);
        status.largest_amplitude = present.largest_amplitude;
        self.show_drive(&board.patch.drive, present);
        self.show_patch(present);
    }

    pub(super) fn show_drive(&mut self, drive: &Drive, present: &Present) {
        self.outlets.drive(drive, present.sample_rate);
        let status = &mut self.status;
        (status.frequency, status.amplitude, status.frame_rate) =
            (drive.frequency, drive.amplitude, drive.frame_rate);
        status.gain = number_of_gain(drive.gain);
    }

    /// The page shows the skin of the chosen patch.
    pub(super) fn show_patch(&mut self, present: &Present) {
        let Session { board, firmware, patch, .. } = &present.session;
        let own = PatchView::validate(patch).ok();
        let chosen = self.chosen.checked_sub(1).and_then(|index| self.task.patches.get(index));
        let chosen = chosen.map(|(_, patch)| patch).or(own.as_ref());
        if let Some(chosen) = chosen {
            self.outlets.show_patch(
                chosen,
                present.pose.as_ref(),
                &present.look,
                format!("{board} {firmware}"),
            );
        }
    }
}
