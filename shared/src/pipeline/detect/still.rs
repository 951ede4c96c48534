//! Presses as they lie: their responses, and no more.

use super::{
    MAX_PRESSES,
    press::Press,
    spot::{Response, Spot, UNKNOWNS, each},
};
use crate::patch::{matrix::GROUP, places::Places};
use heapless::Vec;

/// The key of a press' spot, and its unknowns.
pub(super) type Still = (u16, [f32; UNKNOWNS]);

/// Presses where they lie.
// Once on the board, for all that asks.
#[inline(never)]
pub(super) fn of(presses: &[Press]) -> Vec<Still, MAX_PRESSES> {
    presses.iter().map(|press| (press.spot.key(), press.solved())).collect()
}

/// Sum of their responses: `[measurement]`.
// Once on the board, for all that is done with them.
#[inline(never)]
pub(super) fn responses(places: &Places<'_>, presses: &[Still], add: &mut dyn FnMut(usize, f32)) {
    let responses: Vec<Response<'_>, MAX_PRESSES> =
        presses.iter().map(|(key, solved)| Spot::of_key(*key).response(places, *solved)).collect();
    let four = |at| {
        let mut sum = [0.0; GROUP];
        for response in &responses {
            sum.iter_mut().zip(response.four(at)).for_each(|(sum, response)| *sum += response);
        }
        sum
    };
    each(places, four, add);
}
