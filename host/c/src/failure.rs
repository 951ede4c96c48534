//! Failure: why a call did not do what it was to do, as a code and in words.

use crate::codes;
use dermatome_link::{LinkError, LinkErrorKind, PortError, shared::protocol::Refusal};

/// Why a call failed. It is made without an allocation; its words are not.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// An argument, and what it must be.
    #[error("{0}")]
    Argument(&'static str),
    /// An argument of so many bytes.
    #[error("{what} of {given} bytes, and it is {expected}: do header and library belong together?")]
    Size {
        /// What it is.
        what: &'static str,
        /// Bytes given.
        given: usize,
        /// Bytes it has.
        expected: usize,
    },
    /// Too little room for as many.
    #[error("room for {given} {what}, and there are {needed}")]
    Room {
        /// What they are.
        what: &'static str,
        /// How many there is room for.
        given: usize,
        /// How many there are.
        needed: usize,
    },
    /// Not now.
    #[error("{0}")]
    State(&'static str),
    /// Text that names no port.
    #[error(transparent)]
    Port(#[from] PortError),
    /// At the port.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// No patch.
    #[error("the board holds no patch (send one with `dermatome flash`)")]
    NoPatch,
    /// Another patch.
    #[error(
        "the board holds another patch: its checksum is {found:#010x}, and {expected:#010x} was asked for"
    )]
    WrongPatch {
        /// Checksum of the board's patch.
        found: u32,
        /// Checksum asked for.
        expected: u32,
    },
    /// No frames.
    #[error("no frame has come for {milliseconds} ms")]
    Silent {
        /// For so long.
        milliseconds: u64,
    },
    /// A panic.
    #[error("a fault of the library: close this handle, and report what it printed")]
    Fault,
}

impl Failure {
    /// Its code.
    #[must_use]
    pub fn code(&self) -> i32 {
        match self {
            Self::Argument(_) => codes::DERMATOME_ARGUMENT,
            Self::Size { .. } | Self::Room { .. } => codes::DERMATOME_SIZE,
            Self::State(_) => codes::DERMATOME_STATE,
            Self::Port(_) => codes::DERMATOME_PORT,
            Self::Link(error) => of_link(&error.kind),
            Self::NoPatch => codes::DERMATOME_NO_PATCH,
            Self::WrongPatch { .. } => codes::DERMATOME_WRONG_PATCH,
            Self::Silent { .. } => codes::DERMATOME_SILENT,
            Self::Fault => codes::DERMATOME_FAULT,
        }
    }
}

fn of_link(kind: &LinkErrorKind) -> i32 {
    match kind {
        LinkErrorKind::Missing
        | LinkErrorKind::NoPort
        | LinkErrorKind::ConnectionRefused
        | LinkErrorKind::Open(_) => codes::DERMATOME_PORT,
        LinkErrorKind::Permission => codes::DERMATOME_PERMISSION,
        LinkErrorKind::InUse | LinkErrorKind::Refused(Refusal::Busy) => codes::DERMATOME_IN_USE,
        LinkErrorKind::NoAnswer { .. }
        | LinkErrorKind::Damaged { .. }
        | LinkErrorKind::NoFrame { .. }
        | LinkErrorKind::WrongReply { .. }
        | LinkErrorKind::NoTare { .. } => codes::DERMATOME_NO_ANSWER,
        LinkErrorKind::Cut | LinkErrorKind::Failed(_) => codes::DERMATOME_CUT,
        LinkErrorKind::ProtocolVersion { .. }
        | LinkErrorKind::Schema { .. }
        | LinkErrorKind::Refused(Refusal::Version { .. }) => codes::DERMATOME_VERSION,
        LinkErrorKind::Refused(Refusal::NoPatch) => codes::DERMATOME_NO_PATCH,
        LinkErrorKind::Refused(_)
        | LinkErrorKind::Overload(_)
        | LinkErrorKind::NoFrontEnd
        | LinkErrorKind::NoCarrier { .. } => codes::DERMATOME_REFUSED,
    }
}
