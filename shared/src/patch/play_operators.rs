//! The table of play operators: what takes hysteresis out of the strength of contacts.

use super::{PatchError, PatchView};
use crate::contact::hysteresis::{MAX_PLAY_OPERATORS, PLAY_OPERATOR_BYTES, PlayOperator};

impl<'a> PatchView<'a> {
    /// Play operators of the hysteresis model; none if the skin has none or nobody measured it.
    pub fn play_operators(&self) -> impl Iterator<Item = PlayOperator> + Clone + use<'a> {
        self.play_operators
            .chunks_exact(PLAY_OPERATOR_BYTES)
            .map(|b| PlayOperator::from_bytes([b[0], b[1], b[2], b[3]]))
    }

    pub(super) fn check_play_operators(&self) -> Result<(), PatchError> {
        let count = usize::from(self.header.play_operators);
        if count > MAX_PLAY_OPERATORS {
            return Err(PatchError::Range {
                field: "play_operators",
                value: count,
                min: 0,
                max: MAX_PLAY_OPERATORS,
            });
        }
        match self.play_operators().position(|operator| !operator.is_valid()) {
            Some(operator) => Err(PatchError::PlayOperator { operator }),
            None => Ok(()),
        }
    }
}
