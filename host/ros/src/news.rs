//! News: what a keeper tells, without what the body takes of it.

use dermatome_body::keeper::{State, Told};
use dermatome_shared::drive::Drive;

/// What a keeper told.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// A frame.
    Frame,
    /// How the board stands.
    State(State),
    /// Which pixels the skin has.
    Patch,
    /// How the board drives it.
    Driven(Drive),
    /// Why it does not drive it as it was asked to.
    NotDriven(String),
}

impl News {
    /// Of what a keeper told.
    #[must_use]
    pub fn of(told: &Told) -> Self {
        match told {
            Told::State(state) => Self::State(state.clone()),
            Told::Patch { .. } => Self::Patch,
            Told::Driven(driven) => Self::Driven(driven.drive),
            Told::NotDriven(why) => Self::NotDriven(why.clone()),
            Told::Frame { .. } => Self::Frame,
        }
    }
}
