//! The table of plays: what takes hysteresis out of the strength of contacts.

use super::{PatchError, PatchView};
use crate::contact::hysteresis::{MAX_PLAYS, PLAY_BYTES, Play};

impl<'a> PatchView<'a> {
    /// Plays of the hysteresis operator; none if the skin has none or nobody measured it.
    pub fn plays(&self) -> impl Iterator<Item = Play> + Clone + use<'a> {
        self.plays.chunks_exact(PLAY_BYTES).map(|b| Play::from_bytes([b[0], b[1], b[2], b[3]]))
    }

    pub(super) fn check_plays(&self) -> Result<(), PatchError> {
        let count = usize::from(self.header.plays);
        if count > MAX_PLAYS {
            return Err(PatchError::Range { field: "plays", value: count, min: 0, max: MAX_PLAYS });
        }
        match self.plays().position(|play| !play.is_valid()) {
            Some(play) => Err(PatchError::Play { play }),
            None => Ok(()),
        }
    }
}
