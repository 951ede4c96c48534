//! Real probes, through the library that `dermatome firmware` uses.

use super::ProgrammerError;
use dermatome::link::program::{
    firmware::Firmware,
    probe::{
        DebugProbe,
        attached::{self, Board, ProbeError},
    },
};
use std::error::Error as _;

/// The probes of this machine.
pub(super) fn probes() -> Option<Vec<DebugProbe>> {
    Some(attached::probes())
}

/// Programs a firmware, if there is one to program, and starts the board anew.
pub(super) fn restart(probe: &DebugProbe, firmware: Option<&Firmware>) -> Result<(), ProgrammerError> {
    let mut board = Board::attach(probe)?;
    if let Some(firmware) = firmware {
        board.program(firmware, |_| ())?;
    }
    Ok(board.reset(None)?)
}

impl From<ProbeError> for ProgrammerError {
    /// With all the reasons behind it.
    fn from(error: ProbeError) -> Self {
        let mut words = error.to_string();
        let mut reason = error.source();
        while let Some(cause) = reason {
            words += &format!(": {cause}");
            reason = cause.source();
        }
        Self::Board(words)
    }
}
