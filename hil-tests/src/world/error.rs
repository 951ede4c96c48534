//! Why there is no world.

use super::skin::LEADS;
use dermatome::model::ModelError;

/// Why there is no world.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorldError {
    /// More electrodes than channels.
    #[error(
        "skin `{name}` has {electrodes} electrodes; allowed: up to {LEADS}, the channels of a multiplexer"
    )]
    Electrodes {
        /// Name of the skin.
        name: String,
        /// Its electrodes.
        electrodes: u8,
    },
    /// The skin has no model.
    #[error("skin `{name}`: {error}")]
    Skin {
        /// Name of the skin.
        name: String,
        /// Why.
        error: ModelError,
    },
    /// A value that makes no sense.
    #[error("`{field}` is {value}; allowed: {allowed}")]
    Value {
        /// What.
        field: &'static str,
        /// Its value.
        value: String,
        /// What it may be.
        allowed: String,
    },
}
