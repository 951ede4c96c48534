//! Sums over the measurements that a fit is made of: inner products of the responses of presses with each other and with the
//! data, weighted by the noise. Most presses stay where they were, so that the former are kept from frame to frame.

use super::{
    known::{Known, KnownFit, Parts},
    spot::{Spot, UNKNOWNS},
    still,
};
use crate::{
    limits::MAX_MEASUREMENTS,
    patch::{matrix::GROUP, places::Places},
    pipeline::{
        reconstruct,
        reference::{Changes, DifferenceData, power_of_two, resize},
    },
};
use heapless::Vec;

/// How many of presses with each other are kept: those of ten presses.
const KEPT: usize = 55;
/// And of presses with the data.
const KEPT_OF_DATA: usize = 13;
/// And with known changes: those of two presses, as no more are fitted beside them.
const KEPT_OF_KNOWN: usize = 2 * UNKNOWNS;

/// Of response and slopes with the data.
type Side = [f32; UNKNOWNS];
/// Of response and slopes of one spot with those of another.
type Block = [Side; UNKNOWNS];

/// The data of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Data {
    /// Relative changes without what is common to all: `[measurement]`.
    pub(super) values: Changes,
    /// Their inverse variances, 0 where one says nothing: `[measurement]`.
    pub(super) weights: Changes,
    /// Sum of their squares, in units of one frame's variance.
    pub(super) energy: f32,
    /// How many of them say something.
    pub(super) known: f32,
    /// Variance of their noise, that of one frame being 1.
    pub(super) noise: f32,
    /// Made when asked for.
    codes: DifferenceData,
}

/// Inverse variances and the change that is common to all as they meet mantissas of responses: with the columns'
/// exponents, exactly.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Scaled {
    /// Four measurements at a time, zero behind the last: inverse variances, and the common change.
    pub(super) fours: Vec<[[f32; GROUP]; 2], { MAX_MEASUREMENTS.div_ceil(GROUP) }>,
    /// `c' S^-1 c` of the common change c.
    pub(super) of_common: f32,
}

impl Scaled {
    /// Made of these, `[measurement]`.
    // Not inlined: it is asked for here and there.
    #[inline(never)]
    pub(super) fn set(&mut self, places: &Places<'_>, weights: &[f32], common: &[f32]) {
        self.fours.clear();
        let _ = self.fours.resize(weights.len().div_ceil(GROUP), Default::default());
        self.of_common = 0.0;
        let mut values = weights.iter().zip(common).zip(places.column_exponents());
        for [weights, commons] in &mut self.fours {
            for (scaled_weight, scaled_common) in weights.iter_mut().zip(commons) {
                let Some(((weight, common), exponent)) = values.next() else { return };
                let exponent = i32::from(exponent);
                *scaled_weight = weight * power_of_two(-2 * exponent);
                *scaled_common = common * power_of_two(exponent);
                self.of_common += weight * common * common;
            }
        }
    }
}

/// The data of the latest frame, and sums in use lately.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sums {
    pub(super) data: Data,
    /// Made when asked for.
    pub(super) scaled: Scaled,
    /// Changes that are no press, under the noise.
    pub(super) known: Known,
    /// Those that were looked for last: of the data, or of what presses leave of them.
    pub(super) latest_known: KnownFit,
    /// By two spots.
    blocks: Kept<Block, KEPT>,
    /// By spot.
    sides: Kept<Side, KEPT_OF_DATA>,
    /// By spot, and which of response and slopes.
    known_parts: Kept<Parts, KEPT_OF_KNOWN>,
}

impl Sums {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.data.weights.clear();
        self.blocks.clear();
    }

    /// Relative changes of a new frame with the inverse variances of one frame's, less the change that is common to all:
    /// `[measurement]`. Their own variance is `noise` times that.
    pub(super) fn take(&mut self, relative: &[f32], inverse_variances: &[f32], common: &[f32], noise: f32) {
        let Data { values, weights, energy, known, noise: of_data, codes } = &mut self.data;
        *of_data = noise;
        let count = relative.len().min(inverse_variances.len());
        resize(values, count);
        resize(weights, count);
        *known = 0.0;
        let mut is_other = false;
        let places = values.iter_mut().zip(&mut *weights);
        for ((&y, &weight), (value, known_weight)) in relative.iter().zip(inverse_variances).zip(places) {
            let (y, weight) = if y.is_finite() { (y, weight) } else { (0.0, 0.0) };
            is_other |= *known_weight != weight;
            (*value, *known_weight) = (y, weight);
            *known += if weight > 0.0 { 1.0 } else { 0.0 };
        }
        take_out(common, weights, values);
        *energy = self::energy(values, weights);
        if is_other {
            self.blocks.clear();
        }
        self.sides.clear();
        self.known_parts.clear();
        self.scaled.fours.clear();
        codes.codes.clear();
    }

    /// `one' S^-1 y` of the data y.
    pub(super) fn with_data(&mut self, places: &Places<'_>, one: &Spot) -> Side {
        let data = &mut self.data;
        self.sides.get(one.key().into(), || one.of_places(places, |place| data.with(places, place)))
    }

    /// What known changes explain of values, `[measurement]`, that come without what is common to all.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub(super) fn known_of(&self, places: &Places<'_>, values: &[f32]) -> KnownFit {
        of_known(&self.known, places, &self.data.weights, values)
    }

    /// The parts along known changes of the response at a spot, or of one of its slopes.
    // Not inlined, so that what it needs of the stack is free again for all else; one at a time, as that is not much.
    #[inline(never)]
    pub(super) fn known_with(
        &mut self,
        places: &Places<'_>,
        common: &[f32],
        spot: &Spot,
        unknown: usize,
    ) -> Parts {
        let (known, weights) = (&self.known, &self.data.weights);
        let make = || {
            let mut unit = [0.0; UNKNOWNS];
            unit[unknown] = 1.0;
            let mut values = Changes::new();
            let mut push = |_, value| values.push(value).unwrap_or(());
            still::responses(places, &[(spot.key(), unit)], &mut push);
            take_out(common, weights, &mut values);
            of_known(known, places, weights, &values).parts
        };
        self.known_parts.get((UNKNOWNS * usize::from(spot.key()) + unknown) as u32, make)
    }

    /// `one' S^-1 other`, less what both have in common with a change that is common to all.
    pub(super) fn with_other(
        &mut self,
        places: &Places<'_>,
        common: &[f32],
        one: &Spot,
        other: &Spot,
    ) -> Block {
        let is_turned = one.key() > other.key();
        let (one, other) = if is_turned { (other, one) } else { (one, other) };
        let key = u32::from(one.key()) << 16 | u32::from(other.key());
        let (weights, scaled) = (&self.data.weights, &mut self.scaled);
        let make = || {
            if scaled.fours.is_empty() {
                scaled.set(places, weights, common);
            }
            block(places, scaled, one, other)
        };
        let block = self.blocks.get(key, make);
        if is_turned { [0, 1, 2].map(|i| [0, 1, 2].map(|j| block[j][i])) } else { block }
    }
}

impl Data {
    /// `a' S^-1 y` of the response a at a place.
    fn with(&mut self, places: &Places<'_>, place: usize) -> f32 {
        let codes = self.codes(places);
        let exponent = -i32::from(places.row_exponent(place)) - codes.exponent;
        reconstruct::product(places.row(place), &codes.codes) as f32 * power_of_two(exponent.clamp(-126, 127))
    }

    /// The data as they meet responses.
    pub(super) fn codes(&mut self, places: &Places<'_>) -> &DifferenceData {
        if self.codes.codes.is_empty() {
            quantise(places, &self.values, &self.weights, &mut self.codes);
        }
        &self.codes
    }
}

/// What known changes explain of values under these weights, `[measurement]`.
// Once on the board, for all that asks.
#[inline(never)]
fn of_known(known: &Known, places: &Places<'_>, weights: &[f32], values: &[f32]) -> KnownFit {
    let mut codes = DifferenceData::default();
    quantise(places, values, weights, &mut codes);
    let scale = power_of_two((-codes.exponent).clamp(-126, 127));
    let rows = places.count()..places.count() + places.known();
    let sums = rows.map(|row| reconstruct::product(places.row(row), &codes.codes) as f32 * scale);
    known.fit(places, sums)
}

/// Values times their inverse variances, `[measurement]`, as they meet responses.
pub(super) fn quantise(places: &Places<'_>, values: &[f32], weights: &[f32], codes: &mut DifferenceData) {
    let mut weighted = Changes::new();
    weighted.extend(values.iter().zip(weights).map(|(y, weight)| y * weight));
    codes.quantise(&weighted, places.column_exponents());
}

// Not inlined, so that what it needs of the stack is free again for all else.
#[inline(never)]
fn block(places: &Places<'_>, scaled: &Scaled, one: &Spot, other: &Spot) -> Block {
    let (rows, columns) = (one.columns(places), other.columns(places));
    let is_same = one.key() == other.key();
    let mut block = Block::default();
    let (mut of_one, mut of_other) = (Side::default(), Side::default());
    for (four, [weights, common]) in scaled.fours.iter().enumerate() {
        let left = rows.four(four);
        let mut right = if is_same { left } else { columns.four(four) };
        let weighted = [0, 1, 2, 3].map(|n| weights[n] * common[n]);
        of_other.iter_mut().zip(&right).for_each(|(sum, right)| *sum += dot(right, &weighted));
        right
            .iter_mut()
            .flat_map(|right| right.iter_mut().zip(weights))
            .for_each(|(right, weight)| *right *= weight);
        for ((sums, of_one), left) in block.iter_mut().zip(&mut of_one).zip(&left) {
            *of_one += dot(left, &weighted);
            sums.iter_mut().zip(&right).for_each(|(sum, right)| *sum += dot(left, right));
        }
    }
    let inverse = if scaled.of_common > 0.0 { 1.0 / scaled.of_common } else { 0.0 };
    for (sums, one) in block.iter_mut().zip(of_one) {
        sums.iter_mut().zip(of_other).for_each(|(sum, other)| *sum -= one * other * inverse);
    }
    block
}

/// Takes the change that is common to all out of others, under these weights: `[measurement]`.
// Once on the board, for all that is done with it.
#[inline(never)]
pub(super) fn take_out(common: &[f32], weights: &[f32], values: &mut [f32]) {
    let (mut of_common, mut of_values) = (0.0, 0.0);
    for ((common, weight), value) in common.iter().zip(weights).zip(&*values) {
        of_common += weight * common * common;
        of_values += weight * common * value;
    }
    if of_common > 0.0 {
        let share = of_values / of_common;
        values.iter_mut().zip(common).for_each(|(value, common)| *value -= share * common);
    }
}

/// Sum of squares of values, `[measurement]`, under these weights.
// Once on the board, for all that asks.
#[inline(never)]
pub(super) fn energy(values: &[f32], weights: &[f32]) -> f32 {
    values.iter().zip(weights).map(|(y, weight)| weight * y * y).sum()
}

fn dot(a: &[f32; GROUP], b: &[f32; GROUP]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What was made lately, so that it need not be made again.
#[derive(Clone, Debug, PartialEq)]
struct Kept<Value, const COUNT: usize> {
    keys: Vec<u32, COUNT>,
    values: Vec<Value, COUNT>,
    /// The one that makes room for the next, once all are there.
    oldest: usize,
}

impl<Value, const COUNT: usize> Default for Kept<Value, COUNT> {
    fn default() -> Self {
        Self { keys: Vec::new(), values: Vec::new(), oldest: 0 }
    }
}

impl<Value: Copy, const COUNT: usize> Kept<Value, COUNT> {
    fn clear(&mut self) {
        self.keys.clear();
        self.values.clear();
        self.oldest = 0;
    }

    fn get(&mut self, key: u32, make: impl FnOnce() -> Value) -> Value {
        if let Some(at) = self.keys.iter().position(|known| *known == key) {
            return self.values[at];
        }
        let value = make();
        if self.keys.push(key).is_err() || self.values.push(value).is_err() {
            (self.keys[self.oldest], self.values[self.oldest]) = (key, value);
            self.oldest = (self.oldest + 1) % COUNT;
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_made_once_and_the_oldest_makes_room() {
        let mut kept = Kept::<u32, 4>::default();
        let mut made = std::vec::Vec::new();
        for key in [1, 2, 1, 3, 4, 2, 5, 1, 3, 2] {
            let value = kept.get(key, || {
                made.push(key);
                10 * key
            });
            assert_eq!(value, 10 * key);
        }
        // 5 took the room of 1, 1 that of 2, and 2 that of 3.
        assert_eq!(made, [1, 2, 3, 4, 5, 1, 2]);
        kept.clear();
        assert_eq!(kept.get(5, || 7), 7);
    }
}
