//! Choices of the command line that stand for a library's: the libraries know no command line.

use clap::ValueEnum;
use dermatome_frames::{learn, recorded};

/// Order of the sense pairs inside each drive.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(super) enum SenseOrder {
    /// By electrode number, as in EIDORS: the canonical order.
    #[default]
    Absolute,
    /// From the electrode where current leaves, and round from there: the first pair is the first one
    /// behind it that the pattern measures.
    Relative,
}

impl From<SenseOrder> for recorded::order::SenseOrder {
    fn from(choice: SenseOrder) -> Self {
        match choice {
            SenseOrder::Absolute => Self::Absolute,
            SenseOrder::Relative => Self::Relative,
        }
    }
}

/// Whether what is looked for raises or lowers the conductivity.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(super) enum Polarity {
    /// Whichever the strongest pixel of the frame does.
    #[default]
    Auto,
    /// Conductivity up, as a press on piezoresistive fabric.
    Up,
    /// Conductivity down, as a plastic rod in a tank.
    Down,
}

impl From<Polarity> for recorded::reconstruct::Polarity {
    fn from(choice: Polarity) -> Self {
        match choice {
            Polarity::Auto => Self::Auto,
            Polarity::Up => Self::Up,
            Polarity::Down => Self::Down,
        }
    }
}

/// What the strength of a press in the image follows.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(super) enum Strength {
    /// The size of the measurements' answer, as in the model's images: places come out best.
    #[default]
    Answer,
    /// The force: equal forces look alike all over the skin, and places come out less well.
    Force,
}

impl From<Strength> for learn::Strength {
    fn from(choice: Strength) -> Self {
        match choice {
            Strength::Answer => Self::Response,
            Strength::Force => Self::Force,
        }
    }
}
