//! Fit: places and strengths of some presses by least squares, weighted by the noise.
//!
//! Strengths and offsets of all presses follow from one linear system, with their covariances; a press that lies nearer to
//! another place is fitted there again. The matrix of the system is
//! the same until a press goes to another place.

use super::{
    MAX_PRESSES, MAX_UNKNOWNS,
    known::Parts,
    press::{Press, copy},
    spot::{Spot, UNKNOWNS},
    still,
    sums::{Data, Sums, energy, quantise, take_out},
    system::System,
};
use crate::{
    image::surface::Surface,
    patch::{
        PatchView,
        places::{MAX_KNOWN, Places},
    },
    pipeline::reference::{Changes, DifferenceData},
};
use heapless::Vec;

/// Times that presses go to nearer places.
const ROUNDS: usize = 4;
/// Most unknowns beside known changes.
const MAX_BESIDE: usize = 2 * UNKNOWNS;
/// Standard deviation of an offset before anything is measured, distances from place to place.
const FREE: f32 = 0.7;

/// The skin that presses lie on.
pub(super) struct Skin<'a> {
    pub(super) places: Places<'a>,
    pub(super) surface: Surface<'a>,
    /// Radius of the standard press, m.
    pub(super) radius: f32,
    /// What all voltages changing by their own size would read: `[measurement]`.
    pub(super) common: &'a [f32],
}

impl<'a> Skin<'a> {
    pub(super) fn of(patch: &PatchView<'a>, common: &'a [f32]) -> Self {
        let radius = patch.header.detection.radius;
        Self { places: patch.places(), surface: patch.surface(), radius, common }
    }
}

/// `a' S^-1 b` of what known changes explain of a and b, which have these parts.
// Of slices, and not inlined: the compiler writes loops of a known length out.
#[inline(never)]
fn with_parts(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Some presses, and how well they explain the data.
pub(super) struct Fit<'a> {
    pub(super) skin: &'a Skin<'a>,
    pub(super) presses: Vec<Press, MAX_PRESSES>,
    /// Whether known changes are fitted together with presses.
    is_beside_known: bool,
    /// Sum of squares of the data, in units of the noise's variance, less what known changes explain then.
    pub(super) energy: f32,
    /// What the presses explain of it.
    pub(super) explained: f32,
    /// How many measurements say something.
    pub(super) measurements: f32,
    /// Variance of the data's noise, that of one frame being 1.
    pub(super) noise: f32,
}

impl Clone for Fit<'_> {
    // Inlined, as moving a list copies all of its room.
    #[inline(always)]
    fn clone(&self) -> Self {
        let mut fit = Self { presses: Vec::new(), ..*self };
        copy(&self.presses, &mut fit.presses);
        fit
    }

    /// Without another on the stack.
    fn clone_from(&mut self, other: &Self) {
        let Self { skin, presses, is_beside_known, energy, explained, measurements, noise } = self;
        (*skin, *is_beside_known) = (other.skin, other.is_beside_known);
        (*energy, *explained) = (other.energy, other.explained);
        (*measurements, *noise) = (other.measurements, other.noise);
        copy(&other.presses, presses);
    }
}

impl<'a> Fit<'a> {
    /// No presses.
    // Inlined, as moving a list copies all of its room.
    #[inline(always)]
    pub(super) fn new(skin: &'a Skin<'a>, data: &Data) -> Self {
        let Data { energy, known, noise, .. } = *data;
        Self {
            skin,
            presses: Vec::new(),
            is_beside_known: false,
            energy,
            explained: 0.0,
            measurements: known,
            noise,
        }
    }

    /// No presses, and known changes beside those to come, of the same data.
    #[inline(always)]
    pub(super) fn beside_known(&self, sums: &mut Sums) -> Self {
        sums.latest_known = sums.known_of(&self.skin.places, &sums.data.values);
        let mut fit = Self::new(self.skin, &sums.data);
        fit.energy -= sums.latest_known.with_slips;
        fit.is_beside_known = true;
        fit
    }

    /// Takes presses of the frame before, which are not fitted yet.
    pub(super) fn begin(&mut self, presses: &[Press]) {
        copy(presses, &mut self.presses);
        self.presses.iter_mut().for_each(|press| press.before = press.strength);
        self.free_strong_satellites();
    }

    /// A satellite that is no longer weak beside its press may be that press, which moved: it is free to move as well.
    fn free_strong_satellites(&mut self) {
        let Skin { places, surface, .. } = self.skin;
        for one in 0..self.presses.len() {
            let satellite = &self.presses[one];
            if !satellite.is_satellite() || self.unknowns() + UNKNOWNS - 1 > MAX_UNKNOWNS {
                continue;
            }
            let away = |other: &&Press| other.away_from(satellite.position);
            let others = self.presses.iter().filter(|other| !other.is_satellite());
            let near = others.min_by(|a, b| away(a).total_cmp(&away(b)));
            if !near.is_some_and(|near| near.is_much_more_than(satellite.strength)) {
                self.presses[one].spot = Spot::new(surface, places, satellite.spot.place());
            }
        }
    }

    /// Fits the presses, from where they are; says whether they explain more at other places. Those that are not free to
    /// go stay, unless none of them could lie there.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub(super) fn refine(&mut self, sums: &mut Sums, may_go: bool) -> bool {
        let mut system = System::default();
        let (mut best, mut most) = (Vec::new(), f32::NEG_INFINITY);
        let mut has_gone = false;
        // Whether the system is that of the presses as they are.
        let mut is_theirs = false;
        for round in 0..ROUNDS {
            let has_factor = self.solve(sums, &mut system);
            let is_lost = self.presses.iter().any(Press::is_out_of_reach);
            let is_best = !is_lost && (self.presses.len() < best.len() || self.explained > most);
            if is_best {
                copy(&self.presses, &mut best);
                most = self.explained;
                has_gone = round > 0;
            }
            let may_go = may_go || is_lost;
            if !may_go || !(self.go_to_nearest() | self.join() | is_lost) {
                is_theirs = has_factor && is_best;
                break;
            }
        }
        if !is_theirs && most.is_finite() {
            copy(&best, &mut self.presses);
            self.explained = most;
        }
        if is_theirs || self.factor(sums, &mut system) {
            self.judge(&system);
        }
        self.presses.iter_mut().for_each(Press::settle);
        has_gone
    }

    /// Variance of what the presses do not explain, that of one frame's noise being 1; at least that of the noise.
    pub(super) fn misfit(&self) -> f32 {
        self.misfit_after(0.0)
    }

    /// The same if so much more were explained.
    // Once on the board, for all that asks.
    #[inline(never)]
    pub(super) fn misfit_after(&self, more: f32) -> f32 {
        let free = (self.measurements - self.unknowns() as f32).max(1.0);
        ((self.energy - self.explained - more) / free).max(self.noise)
    }

    // Once on the board, for all that asks.
    #[inline(never)]
    fn unknowns(&self) -> usize {
        self.presses.iter().map(Press::unknowns).sum()
    }

    /// Whether there is room for another press.
    pub(super) fn has_room(&self) -> bool {
        !self.presses.is_full()
            && self.unknowns() + UNKNOWNS <= if self.is_beside_known { MAX_BESIDE } else { MAX_UNKNOWNS }
    }

    /// What neither presses nor noise explain, in units of one frame's variance.
    pub(super) fn unexplained(&self) -> f32 {
        self.energy - self.explained - self.measurements * self.noise
    }

    /// Standard deviation of what noise leaves.
    pub(super) fn spread(&self) -> f32 {
        self.noise * libm::sqrtf(2.0 * self.measurements)
    }

    /// Significance of a sum of squares, in standard deviations.
    pub(super) fn significance(&self, explained: f32) -> f32 {
        libm::sqrtf(explained.max(0.0) / self.noise)
    }

    /// Keeps those of the presses that are strong enough beside the others, and held; the rest is to be fitted anew if
    /// there were others, and says whether there were.
    // Once on the board, for all that is done with it.
    #[inline(never)]
    pub(super) fn retain(&mut self, is_held: &dyn Fn(&Press) -> bool) -> bool {
        let count = self.presses.len();
        let strongest = self.presses.iter().fold(0.0, |most: f32, press| most.max(press.strength));
        self.presses.retain(|press| is_held(press) && press.is_worth(strongest));
        self.presses.len() < count
    }

    /// What the presses' responses leave of the data, and known changes where they are fitted as well, as it meets responses,
    /// and the sum of its squares.
    pub(super) fn left(&self, sums: &mut Sums) -> (DifferenceData, f32) {
        let Skin { places, common, .. } = self.skin;
        if self.presses.is_empty() && !self.is_beside_known {
            return (sums.data.codes(places).clone(), self.energy);
        }
        let mut left = Changes::new();
        left.extend(sums.data.values.iter().copied());
        let mut take = |m: usize, change: f32| {
            if let Some(y) = left.get_mut(m) {
                *y -= change;
            }
        };
        still::responses(places, &still::of(&self.presses), &mut take);
        if self.is_beside_known {
            let parts = self.known(sums);
            sums.known.add(&parts, false, places, &mut take);
        }
        let weights = &sums.data.weights;
        take_out(common, weights, &mut left);
        let energy = energy(&left, weights);
        let mut codes = DifferenceData::default();
        quantise(places, &left, weights, &mut codes);
        (codes, energy)
    }

    /// The parts along known changes of what the presses leave of the data.
    pub(super) fn known(&self, sums: &mut Sums) -> Parts {
        let Skin { places, common, .. } = self.skin;
        let mut left = sums.latest_known.parts;
        for press in &self.presses {
            for (unknown, size) in press.solved().into_iter().enumerate().take(press.unknowns()) {
                let parts = sums.known_with(places, common, &press.spot, unknown);
                left.iter_mut().zip(parts).for_each(|(left, part)| *left -= size * part);
            }
        }
        left
    }

    /// Strengths and offsets of all presses at their places; no presses where they cannot be told apart, and says whether
    /// they can.
    pub(super) fn solve(&mut self, sums: &mut Sums, system: &mut System) -> bool {
        if !self.factor(sums, system) {
            self.presses.clear();
            self.explained = 0.0;
            return false;
        }
        let found = system.solution();
        self.explained = system.right[..system.count].iter().zip(&found).map(|(b, x)| b * x).sum();
        let mut first = 0;
        for press in &mut self.presses {
            press.strength = found[first];
            if !press.is_satellite() {
                press.offset = press.spot.offset_of(press.size(), [found[first + 1], found[first + 2]]);
            }
            first += press.unknowns();
        }
        true
    }

    /// Deviations and significances of the presses, by their factor.
    fn judge(&mut self, system: &System) {
        let (misfit, noise) = (self.misfit(), self.noise);
        let mut first = 0;
        for press in &mut self.presses {
            let of_strength = system.variance(first);
            press.significance = press.strength / libm::sqrtf(of_strength * noise);
            press.strength_deviation = libm::sqrtf(of_strength * misfit);
            if !press.is_satellite() {
                let mean = (system.variance(first + 1) + system.variance(first + 2)) / 2.0 * misfit;
                press.position_deviation = libm::sqrtf(mean) / press.size() * press.spot.spacing;
            }
            first += press.unknowns();
        }
    }

    /// The factor of the normal equations of the presses at their places; says whether there is one.
    fn factor(&self, sums: &mut Sums, system: &mut System) -> bool {
        let Skin { places, common, .. } = self.skin;
        system.count = self.unknowns();
        let mut row = 0;
        for (n, press) in self.presses.iter().enumerate() {
            let own = row..row + press.unknowns();
            let side = sums.with_data(places, &press.spot);
            system.right[own.clone()].copy_from_slice(&side[..own.len()]);
            let mut column = 0;
            for other in &self.presses[..=n] {
                let others = column..column + other.unknowns();
                let block = sums.with_other(places, common, &press.spot, &other.spot);
                for (values, block) in system.matrix[own.clone()].iter_mut().zip(&block) {
                    values[others.clone()].iter_mut().zip(block).for_each(|(value, block)| *value = *block);
                }
                column = others.end;
            }
            // Before anything is measured, an offset is zero but for some of the distance to the next place.
            let free = FREE * press.size();
            for unknown in row + 1..own.end {
                system.matrix[unknown][unknown] += self.noise / (free * free);
            }
            row = own.end;
        }
        if self.is_beside_known {
            self.leave_known_out(sums, system);
        }
        system.factor()
    }

    /// Leaves of the normal equations what known changes do not explain.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn leave_known_out(&self, sums: &mut Sums, system: &mut System) {
        let Skin { places, common, .. } = self.skin;
        let mut all = [[0.0; MAX_KNOWN]; MAX_BESIDE];
        let mut row = 0;
        for press in &self.presses {
            for unknown in 0..press.unknowns().min(MAX_BESIDE - row) {
                all[row] = sums.known_with(places, common, &press.spot, unknown);
                system.right[row] -= with_parts(&all[row], &sums.latest_known.parts);
                for column in 0..=row {
                    system.matrix[row][column] -= with_parts(&all[row], &all[column]);
                }
                row += 1;
            }
        }
    }

    /// Presses that lie nearer to another place go there; says whether any did.
    fn go_to_nearest(&mut self) -> bool {
        let Skin { places, surface, .. } = self.skin;
        let mut moved = false;
        for press in self.presses.iter_mut().filter(|press| !press.is_satellite()) {
            if let Some(spot) = press.spot.nearest(surface, places, press.offset) {
                press.spot = spot;
                moved = true;
            }
        }
        moved
    }

    /// Presses that met become one; says whether any did.
    fn join(&mut self) -> bool {
        for one in 0..self.presses.len() {
            for other in one + 1..self.presses.len() {
                if self.presses[one].spot.place() == self.presses[other].spot.place() {
                    let gone = self.presses.swap_remove(other);
                    let stays = &mut self.presses[one];
                    stays.strength += gone.strength;
                    if stays.is_satellite() {
                        stays.spot = gone.spot;
                    }
                    return true;
                }
            }
        }
        false
    }
}
