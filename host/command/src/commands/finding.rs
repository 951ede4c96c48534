//! What contacts are found in, as an option.

use clap::ValueEnum;
use dermatome_model::skin::FoundIn;

/// What contacts are found in.
#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Finding {
    Image,
    Voltages,
}

impl From<Finding> for FoundIn {
    fn from(finding: Finding) -> Self {
        match finding {
            Finding::Image => Self::Image,
            Finding::Voltages => Self::Voltages,
        }
    }
}
