//! Reflexes: what a board does by itself, as the skin file says it.

use dermatome_shared::patch::reflexes::Limit;
use nalgebra::Point3;

/// One rule: a region, what it may bear, and what follows beyond that.
#[derive(Clone, Debug, PartialEq)]
pub struct Reflex {
    /// What people call it: 1 to 16 letters, digits, "-" or "_".
    pub name: String,
    /// The pin that falls, 1 to [`dermatome_shared::REFLEX_PINS`].
    pub pin: u8,
    /// What trips it.
    pub limit: Limit,
    /// Where it looks.
    pub region: Region,
    /// Share of the limit below which it is released, 0 to 1.
    pub release: f64,
    /// Frames above the limit, one after the other, that trip it.
    pub frames: u8,
    /// How long it stays tripped at least, s.
    pub hold: f64,
    /// Whether it trips as well while the board cannot tell.
    pub trips_blind: bool,
}

/// A part of a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// All of it.
    Whole,
    /// What is no farther from a point than that.
    Around {
        /// In the skin's frame, m.
        centre: Point3<f64>,
        /// Straight through space, m.
        radius: f64,
    },
}

impl Region {
    /// How far a place lies outside, m; not above zero inside.
    #[must_use]
    pub fn beyond(&self, place: &Point3<f64>) -> f64 {
        match self {
            Self::Whole => f64::NEG_INFINITY,
            Self::Around { centre, radius } => (place - centre).norm() - radius,
        }
    }
}
