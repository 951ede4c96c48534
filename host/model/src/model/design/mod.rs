//! Design: places of electrodes, and a stimulation pattern, with which a press stands out everywhere.
//!
//! Point electrodes at many candidates, on the rim and inside, are solved for once; fields of any choice of them are among
//! these. A choice is judged by its least d' ([`crate::metrics::detectability`]) over the skin, a little smoothed, so that
//! each step of the search helps the deafest places. The search exchanges places, and which electrodes follow each other
//! in the pattern, until nothing helps. Point electrodes are not the skin's own, so what is proposed has to be modelled
//! anew.

mod candidates;
mod search;

use super::ModelError;
use crate::{metrics::detectability::Sought, skin::Skin};
use candidates::Candidates;
use dermatome_shared::MAX_ELECTRODES;
use nalgebra::Point3;
use search::Search;

/// What a design is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Number of electrodes.
    pub electrodes: u8,
    /// Press and noise.
    pub sought: Sought,
}

/// What is proposed.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// Where electrodes lie, m, in the order in which the pattern goes round: `[electrode]`.
    pub positions: Vec<Point3<f64>>,
    /// How many of them lie on the rim.
    pub on_rim: usize,
    /// How many electrodes further the other one of each pair lies: 1 is adjacent.
    pub distance: u8,
    /// How many choices were judged.
    pub judged: usize,
}

/// Why nothing is proposed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// Too few or too many electrodes.
    #[error("`electrodes` is {electrodes}; allowed: 6 to {MAX_ELECTRODES}, as many as a board takes")]
    Count {
        /// As many as were wanted.
        electrodes: u8,
    },
    /// No room for so many electrodes.
    #[error("`electrodes` is {electrodes}; allowed here: electrodes of {:.2} mm that have room on the skin", width * 1e3)]
    NoRoom {
        /// As many as were wanted.
        electrodes: u8,
        /// How wide each is, m.
        width: f64,
    },
    /// No mesh or no forward solution.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Proposes electrodes for a skin; `on_stage` hears what is done.
pub fn propose(
    skin: &Skin,
    wanted: &Wanted,
    mut on_stage: impl FnMut(&'static str),
) -> Result<Proposal, DesignError> {
    let Wanted { electrodes, sought } = *wanted;
    if !(6..=MAX_ELECTRODES).contains(&usize::from(electrodes)) {
        return Err(DesignError::Count { electrodes });
    }
    on_stage("candidates");
    let candidates = Candidates::new(skin, &sought)?;
    on_stage("search");
    let search = Search::new(&candidates, usize::from(electrodes), sought);
    let found = search.run().ok_or(DesignError::NoRoom { electrodes, width: candidates.width })?;
    Ok(Proposal {
        positions: found.order.iter().map(|&candidate| candidates.positions[candidate]).collect(),
        on_rim: found.order.iter().filter(|&&candidate| candidate < candidates.on_rim).count(),
        distance: found.distance,
        judged: search.judged(),
    })
}

#[cfg(test)]
mod tests;
