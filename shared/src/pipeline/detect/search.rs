//! Search: what some presses leave of the data, and whether it asks for another, or for two in place of one.

use super::{
    SUDDEN,
    filter::{self, Look, Norms},
    fit::{Fit, Skin},
    press::Press,
    spot::{Spot, at},
    sums::Sums,
    system::System,
};
use crate::pipeline::reconstruct;

/// One of several presses that come in one frame explains more than this share of what is left. Sheets that are stretched by
/// 2 % leave 5 % to a press.
const ONE_OF_SEVERAL: f32 = 0.15;
/// Two presses for one explain more than this share of what it does beside that. Two for a finger of 4 % of the size gained
/// up to 1 % on a hemisphere with electrodes inside; two for two fingers a fifth of a disc apart 3 to 24 %.
const TWO_FOR_ONE: f32 = 0.02;
/// And leave less than this share of what they do: sheets that are stretched and electrodes that slip leave more.
const TWO_LEAVE: f32 = 0.05;

impl Fit<'_> {
    /// Whether another press of this strength that explains so much more, and leaves this misfit, is asked for. What presses
    /// leave unexplained is noise of a kind: of another one it asks for more. But while they leave most of the data
    /// unexplained, and none was taken away, that may be several others, which came as suddenly.
    // Once on the board, for all that asks.
    #[inline(never)]
    pub(super) fn is_asked_for(
        &self,
        look: &Look,
        strength: f32,
        more: f32,
        misfit: f32,
        level: f32,
    ) -> bool {
        let left = self.unexplained();
        let is_one_of_several = left > self.explained
            && more > ONE_OF_SEVERAL * left
            && strength >= SUDDEN
            && look.most.1 > -look.least.1;
        more > level * level * if is_one_of_several { self.noise } else { misfit }
    }

    /// Whether a press of this strength there could be what the standard press of another does not explain.
    // Once on the board, for all that asks.
    #[inline(never)]
    fn is_beside(&self, here: [f32; 3], strength: f32) -> bool {
        let mut presses = self.presses.iter().filter(|press| !press.is_satellite());
        presses.any(|press| press.is_joined_by(here, strength, self.skin.radius))
    }

    /// The strongest press that is no satellite.
    fn strongest(&self) -> Option<&Press> {
        let free = self.presses.iter().filter(|press| !press.is_satellite());
        free.reduce(|most, press| if press.strength > most.strength { press } else { most })
    }

    /// What is left of the data resembles.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub(super) fn look(&self, sums: &mut Sums, norms: &Norms) -> Look {
        let (left, energy) = self.left(sums);
        let look = filter::look(&self.skin.places, &left, norms, &sums.known);
        Look { left: energy - self.measurements * self.noise, ..look }
    }

    /// A press where what the others leave resembles one most, if it is above the level. Beside another press it is its
    /// satellite.
    pub(super) fn loudest(&self, look: &Look, norms: &Norms, level: f32) -> Option<Press> {
        let Skin { places, surface, .. } = self.skin;
        let (place, z) = look.most;
        let strength = filter::strength(places, place, norms, z);
        // Fitting its place explains some more, but hardly twice as much.
        let most = 2.0 * z * z;
        if self.significance(z * z) <= level
            || !self.is_asked_for(look, strength, most, self.misfit_after(most), level)
        {
            return None;
        }
        let spot =
            if self.is_beside(at(surface, places, place).0, strength) { Spot::fixed } else { Spot::new };
        Some(Press::at(spot(surface, places, place), strength))
    }

    /// Takes two presses for the strongest one, where they explain clearly more. One halfway explains two that are close so
    /// well that what it leaves is like neither, but like a weak one elsewhere.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub(super) fn split(&mut self, sums: &mut Sums, norms: &Norms, level: f32) {
        let Skin { places, surface, .. } = self.skin;
        let more = TWO_FOR_ONE * self.explained;
        if !self.has_room() || self.unexplained() < more.max(level * level * self.noise) {
            return;
        }
        let Some(whole) = self.strongest() else { return };
        let Some(place) = self.loudest_round(whole, sums, norms) else { return };
        let mut next = self.clone();
        let _ = next.presses.push(Press::at(Spot::new(surface, places, place), whole.size()));
        next.refine(sums, true);
        if next.explained - self.explained < more {
            return;
        }
        next.refine(sums, true);
        if next.retain(&|_| true) {
            return;
        }
        let is_more = next.explained - self.explained > level * level * next.misfit()
            && next.unexplained() < TWO_LEAVE * next.explained;
        let Some(last) = next.presses.pop() else { return };
        if is_more
            && next.presses.len() == self.presses.len()
            && !next.is_beside(last.position, last.strength)
            && !next.strongest().is_some_and(|most| most.is_much_more_than(last.strength))
        {
            self.clone_from(&next);
            let _ = self.presses.push(last);
        }
    }

    /// The place round a press that what is left resembles most.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn loudest_round(&self, press: &Press, sums: &mut Sums, norms: &Norms) -> Option<usize> {
        let (left, _) = self.left(sums);
        let z = |place: usize| {
            let product = reconstruct::product(self.skin.places.row(place), &left.codes) as f32;
            norms.get(place).map_or(0.0, |norm| norm * product)
        };
        let round = self.skin.places.neighbours(press.spot.place()).map(usize::from);
        round.into_iter().max_by(|a, b| z(*a).total_cmp(&z(*b)))
    }

    /// What a press that was taken away, where what is left resembles one most, would explain of it.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub(super) fn by_lift(&self, look: &Look, norms: &Norms, sums: &mut Sums) -> f32 {
        let Skin { places, surface, .. } = self.skin;
        let (place, z) = look.least;
        let mut fit = self.clone();
        let strength = filter::strength(places, place, norms, z);
        let _ = fit.presses.push(Press::at(Spot::new(surface, places, place), strength));
        if fit.solve(sums, &mut System::default()) { fit.explained - self.explained } else { 0.0 }
    }
}
