//! What a program without the feature `probe` does with probes: nothing.

use super::ProgrammerError;
use dermatome::link::program::{firmware::Firmware, probe::DebugProbe};

/// It cannot tell.
pub(super) fn probes() -> Option<Vec<DebugProbe>> {
    None
}

/// It cannot.
pub(super) fn restart(probe: &DebugProbe, _: Option<&Firmware>) -> Result<(), ProgrammerError> {
    Err(ProgrammerError::NotBuilt { id: probe.id() })
}
