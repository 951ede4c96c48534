//! Trouble: why a board does not stream.

use super::told::Phase;
use dermatome_link::{LinkError, LinkErrorKind};
use dermatome_shared::patch::PatchError;
use dermatome_simulate::port::OpenError;

/// Why a board does not stream.
#[derive(Debug, thiserror::Error)]
pub(super) enum Trouble {
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error(transparent)]
    Open(OpenError),
    #[error("the board holds no patch: send it one with `dermatome flash`")]
    NoPatch,
    #[error("the board's patch: {0}")]
    Patch(PatchError),
    #[error(
        "the board holds a patch for `{0}`, not for this skin: send it the right one with `dermatome flash`"
    )]
    OtherSkin(String),
    #[error(
        "the board's patch has its pixels elsewhere than the skin file: build it anew and send it with `dermatome flash`"
    )]
    OtherPixels,
}

impl From<OpenError> for Trouble {
    fn from(error: OpenError) -> Self {
        match error {
            OpenError::Link(error) => Self::Link(error),
            other => Self::Open(other),
        }
    }
}

impl Trouble {
    /// How a board stands with it that has come before, or has not.
    pub(super) fn phase(&self, has_come: bool) -> Phase {
        match self {
            Self::NoPatch => Phase::NoPatch,
            Self::Patch(_) | Self::OtherSkin(_) | Self::OtherPixels => Phase::OtherPatch,
            Self::Open(OpenError::Simulation(_) | OpenError::Replay(_)) => Phase::Ended,
            Self::Link(_) | Self::Open(_) if has_come => Phase::Lost,
            Self::Link(_) | Self::Open(_) => Phase::NoBoard,
        }
    }

    /// Whether its line carries no more.
    pub(super) fn is_full_line(&self) -> bool {
        matches!(self, Self::Link(error) if matches!(error.kind, LinkErrorKind::Overload(_)))
    }
}
