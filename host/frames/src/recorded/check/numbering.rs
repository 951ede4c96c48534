//! Which electrode of the skin each electrode of the file is.

use super::{
    super::order::{Arrangement, OrderError},
    causes::{self, Explained},
    likeness::Comparison,
    reading::Reading,
    wiring::Exchange,
};
use serde::Serialize;

/// What the reference says about the order and the numbers of a file's electrodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Numbering {
    /// The arrangement asked for.
    pub used: Arrangement,
    /// Its correlation of log magnitudes with the model, -1 to 1.
    pub correlation: f64,
    /// The best arrangement; of those that tie, the one with the fewest changes.
    pub best: Arrangement,
    /// Its correlation.
    pub best_correlation: f64,
    /// Whether another rotation is as good as the best one, as on any disc.
    pub rotation_ambiguous: bool,
    /// Electrodes that seem to be exchanged, besides.
    pub exchanged: Vec<Exchange>,
    /// The correlation once they are put right; that of `best` if there are none.
    pub exchanged_correlation: f64,
}

impl Numbering {
    /// Of a frame that is read as explained; correlations are with everything else that was found.
    pub(super) fn of(
        comparison: &Comparison<'_>,
        explained: &Explained,
        used: Arrangement,
    ) -> Result<Self, OrderError> {
        let electrodes = comparison.expected.electrodes;
        let best = explained.reading.arrangement();
        let as_wired = Reading { exchanged: Vec::new(), ..explained.reading.clone() };
        let correlation = |arrangement: Arrangement| -> Result<f64, OrderError> {
            Ok(comparison.of(&as_wired.rearranged(arrangement, electrodes))?.correlation())
        };
        Ok(Self {
            used,
            correlation: correlation(used)?,
            best,
            best_correlation: correlation(best)?,
            rotation_ambiguous: another_rotation_ties(comparison, explained),
            exchanged: explained.reading.exchanged.clone(),
            exchanged_correlation: explained.likeness.correlation(),
        })
    }
}

/// Whether another rotation explains the frame as well.
fn another_rotation_ties(comparison: &Comparison<'_>, last: &Explained) -> bool {
    let electrodes = comparison.expected.electrodes;
    let arrangement = last.reading.arrangement();
    let others = (0..electrodes).filter(|&rotation| rotation != arrangement.rotation);
    let ties = |rotation: u8| {
        let reading = last.reading.rearranged(Arrangement { rotation, ..arrangement }, electrodes);
        comparison.of(&reading).is_ok_and(|other| causes::ties(other.disorder(), last.likeness.disorder()))
    };
    others.into_iter().any(ties)
}
