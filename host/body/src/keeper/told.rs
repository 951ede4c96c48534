//! Told: what a keeper says of its board, and what comes from it.

use crate::driven::Driven;
use dermatome_link::{ScanFrame, tables::SurfaceTables};
use dermatome_shared::{drive::Drive, protocol::FrameSource};

/// What a keeper tells.
#[derive(Debug)]
pub enum Told {
    /// How the board stands now.
    State(State),
    /// The board holds this patch, which is of the skin: frames from now on are of it.
    Patch {
        /// As the board has it.
        bytes: Vec<u8>,
        /// Its pixels.
        tables: Box<SurfaceTables>,
        /// Kind of board.
        board: String,
        /// Version of its firmware.
        firmware: String,
        /// Where its frames come from.
        frame_source: FrameSource,
    },
    /// The board drives its skin like this.
    Driven(Box<Driven>),
    /// The board refused to drive it like this.
    NotDriven {
        /// As it was asked to.
        drive: Drive,
        /// Why, in words.
        why: String,
    },
    /// A drive that waited until nothing presses was given up for another one.
    GivenUp(Drive),
    /// The board compares frames with this reference from now on.
    Reference(Box<Reference>),
    /// A frame.
    Frame {
        /// As it came.
        frame: Box<ScanFrame>,
        /// When, by this computer's clock, ns since 1970.
        received_ns: u64,
        /// Frames of this stream that have not come.
        missing: u64,
    },
}

/// What the untouched skin measures.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// When it was made, by this computer's clock, ns since 1970; none where the board had it before.
    pub made_ns: Option<u64>,
    /// In codes: `[measurement]`.
    pub voltages: Vec<f64>,
}

/// How a board stands.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct State {
    /// In one word.
    pub phase: Phase,
    /// Why, in words; empty where there is nothing to say.
    pub text: String,
}

/// What is said while a new reference waits for something to leave the skin.
pub(crate) const WAITS: &str = "something presses on the skin: its new reference waits until it is free";

/// The same of a drive that was asked for.
pub(crate) const DRIVE_WAITS: &str = "something presses on the skin: its new drive waits until it is free";

impl State {
    /// Whether a new reference waits for something to leave the skin.
    #[must_use]
    pub fn waits(&self) -> bool {
        self.text == WAITS
    }

    /// Whether a new drive does, and the reference that comes with it.
    #[must_use]
    pub fn drive_waits(&self) -> bool {
        self.text == DRIVE_WAITS
    }
}

/// How a board stands, in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// It has not answered yet.
    NoBoard,
    /// It answered before.
    Lost,
    /// It holds no patch.
    NoPatch,
    /// It holds another skin's patch.
    OtherPatch,
    /// It has no reference, and something presses.
    NotTared,
    /// It averages the untouched skin.
    Taring,
    /// It sends contacts.
    Live,
    /// It is not tried again.
    Ended,
}
