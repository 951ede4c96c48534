//! Reflex: what a board says about loads by itself, right after the last sample of a frame, by rules in its patch.
//!
//! Contacts take milliseconds, as presses are looked for and fitted, and what is learnt on the way decides what is one. A
//! reflex is one fixed sum instead: the load on a cell of a region is a weight for each relative change, which the host has chosen
//! (`dermatome_model::quantize`). The reference is multiplied in beforehand ([`Watch::brief`]), so that a frame costs one
//! product for each measurement and row ([`Watch::see`]), in whole numbers that lose nothing:
//!
//! ```text
//! load = sum of weight[m] * (v[m] - reference[m]) / reference[m]
//!      = unit * (sum of factor[m] * sum of codes[m] - offset)
//! ```
//!
//! A factor is a weight over its reference, rounded to 16 bits of the row's largest. The offset is made of the rounded ones,
//! so that an untouched skin reads nothing; a load is wrong by half a step for each code by which a voltage has changed.
//!
//! Where the sum means nothing the board is *blind*: without a reference, with a bad electrode, at the end of the
//! converter's range, or without the current that the reference was made with.
//!
//! Whoever gets frames first holds the [`Watch`]; whoever takes them through the pipeline briefs it, of one row after each
//! frame: all at once would keep a board from its samples.

use super::{
    PipelineState,
    reference::{Changes, Reference},
};
use crate::{
    frame::Frame,
    limits::{MAX_MEASUREMENTS, MAX_STEPS},
    patch::{
        CombinedInto, PatchHeader, PatchView,
        reflexes::{Limit, MAX_REFLEX_PRODUCTS, MAX_REFLEX_ROWS, MAX_REFLEXES, ReflexRule, strength_of},
    },
};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// One row more than rules have: it reads how large all voltages are.
const ROWS: usize = MAX_REFLEX_ROWS + 1;
/// Mean of all voltages, as a share of the reference's, beyond which they are none of this skin under this current.
const PLAUSIBLE: core::ops::RangeInclusive<f32> = 0.5..=2.0;
/// What the rules say of one frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct Reflexes {
    /// Rules that are tripped: a bit for each, the first one's lowest.
    pub tripped: u8,
    /// Whether the loads mean nothing.
    pub is_blind: bool,
    /// Loads, in strengths of the standard press, or pressed areas, m^2: `[rule]`.
    pub values: Vec<f32, MAX_REFLEXES>,
}

impl Reflexes {
    /// Which rules are tripped, a bit for each, and whether the loads mean nothing: what is told when it changes.
    #[must_use]
    pub fn state(&self) -> (u8, bool) {
        (self.tripped, self.is_blind)
    }

    /// Whether the rule of this number is tripped.
    #[must_use]
    pub fn is_tripped(&self, rule: usize) -> bool {
        self.tripped.checked_shr(rule as u32).unwrap_or(0) & 1 == 1
    }
}

/// Watches frames by a patch's rules.
#[derive(Clone, Debug)]
pub struct Watch {
    rules: Vec<Watched, MAX_REFLEXES>,
    /// Areas of the cells, m^2: `[row]`.
    areas: Vec<f32, MAX_REFLEX_ROWS>,
    /// Where each step's code goes: `[step]`.
    combination: Vec<CombinedInto, MAX_STEPS>,
    /// What a sum of codes counts: `[row][measurement]`, the row after those of the rules for all voltages.
    factors: Vec<i16, MAX_REFLEX_PRODUCTS>,
    /// What the reference reads: `[row]`.
    offsets: [i64; ROWS],
    /// What 1 is worth: `[row]`.
    units: [f32; ROWS],
    /// The row that is briefed next.
    next: usize,
    /// Whether all are. As all else here it begins as zeros, which take no room in a board's flash.
    sees: bool,
}

impl Default for Watch {
    fn default() -> Self {
        Self::new()
    }
}

impl Watch {
    /// One that has no rules.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            rules: Vec::new(),
            areas: Vec::new(),
            combination: Vec::new(),
            factors: Vec::new(),
            offsets: [0; ROWS],
            units: [0.0; ROWS],
            next: 0,
            sees: false,
        }
    }

    /// Watches by this patch's rules from now on, or by none; blind until it is briefed.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub fn begin(&mut self, patch: Option<&PatchView<'_>>) {
        self.rules.clear();
        self.areas.clear();
        self.combination.clear();
        self.factors.clear();
        self.blind();
        if let Some(patch) = patch {
            self.rules.extend(patch.reflex_rules().map(|rule| Watched::new(&patch.header, &rule)));
            self.areas.extend(patch.reflex_rows().map(|row| row.area));
            self.combination.extend(patch.combination());
            // The patch has no more rows than there is room for.
            let _ = self.factors.resize((self.areas.len() + 1) * usize::from(patch.header.measurements), 0);
        }
    }

    /// Whether there are rules.
    #[must_use]
    pub fn has_rules(&self) -> bool {
        !self.rules.is_empty()
    }

    /// What was known means nothing: no frames come any more, or an electrode is bad.
    pub fn blind(&mut self) {
        (self.next, self.sees) = (0, false);
    }

    /// Takes the reference that the pipeline has now over into the next row; sees once that was done for all.
    pub fn brief(&mut self, patch: &PatchView<'_>, state: &PipelineState) {
        let Some(reference) = state.reference.as_ref().filter(|_| state.wiring.bad().is_empty()) else {
            return self.blind();
        };
        let mut weights = Changes::new();
        match patch.reflex_rows().nth(self.next) {
            Some(row) => {
                weights.extend(row.weights.iter());
                self.set_row(self.next, reference, &weights);
            }
            None => {
                let size: f32 = reference.weights().iter().map(|reads| reads.abs()).sum();
                weights.extend(reference.weights().iter().map(|reads| 1.0_f32.copysign(*reads) / size));
                self.set_row(self.next, reference, &weights);
                // All voltages are read as they are, and not as they changed.
                self.offsets[self.next] = 0;
            }
        }
        self.next = (self.next + 1) % (self.areas.len() + 1);
        self.sees |= self.next == 0;
    }

    /// What codes count and the reference reads in a row of these weights of relative changes: `[measurement]`.
    // Once on the board, for all rows.
    #[inline(never)]
    fn set_row(&mut self, row: usize, reference: &Reference, weights: &[f32]) {
        let products = || weights.iter().zip(reference.scales()).map(|(weight, scale)| weight * scale);
        let largest = products().map(f32::abs).fold(0.0, f32::max);
        let unit = if largest > 0.0 { largest / f32::from(i16::MAX) } else { 1.0 };
        let own = self.factors.chunks_exact_mut(weights.len().max(1)).nth(row).unwrap_or_default();
        let mut offset = 0_i64;
        for ((factor, product), sum) in own.iter_mut().zip(products()).zip(reference.sums()) {
            *factor = nearest(product / unit);
            // Each sum has 36 bits, a factor 15, and there are 256.
            offset = offset.wrapping_add(i64::from(*factor).wrapping_mul(*sum));
        }
        let frames = i64::from(reference.frames().max(1));
        // Rounded: less than what one step of the converter counts.
        self.offsets[row] = offset / frames;
        self.units[row] = unit * frames as f32;
    }

    /// What the rules say of a frame that ended at this time, us of the board's clock.
    // Not inlined, so that slots within a frame find all they go through in the flash's cache.
    #[inline(never)]
    pub fn see(&mut self, frame: &Frame, timestamp_us: u64) -> Reflexes {
        if !self.has_rules() {
            return Reflexes::default();
        }
        let loads = self.loads(frame);
        let is_blind = loads.is_none() || !frame.clipped.is_empty();
        let loads = loads.unwrap_or_default();
        let mut reflexes = Reflexes { is_blind, ..Reflexes::default() };
        let (mut loads, mut areas) = (&loads[..self.areas.len()], &self.areas[..]);
        for (number, rule) in self.rules.iter_mut().enumerate() {
            let rows = usize::from(rule.rows).min(loads.len());
            let value = rule.value(&loads[..rows], &areas[..rows]);
            (loads, areas) = (&loads[rows..], &areas[rows..]);
            if rule.follow(value, is_blind, timestamp_us) {
                reflexes.tripped |= 1 << number;
            }
            let _ = reflexes.values.push(value);
        }
        reflexes
    }

    /// Loads, `[row]`; none where the frame is none of the reference's.
    fn loads(&self, frame: &Frame) -> Option<[f32; ROWS]> {
        if !self.sees || frame.codes.len() != self.combination.len() {
            return None;
        }
        let mut sums = [0_i32; MAX_MEASUREMENTS];
        for (code, target) in frame.codes.iter().zip(&self.combination) {
            if let Some(sum) = sums.get_mut(usize::from(target.measurement)) {
                // A measured code has 26 bits at most, and more than two steps hardly measure the same; others mean nothing.
                *sum = sum.wrapping_add(if target.flipped { code.0.wrapping_neg() } else { code.0 });
            }
        }
        let mut loads = [0.0; ROWS];
        let rows = self.areas.len() + 1;
        let of_row = self.factors.chunks_exact((self.factors.len() / rows).max(1));
        for (((load, factors), offset), unit) in
            loads.iter_mut().zip(of_row).zip(&self.offsets).zip(&self.units)
        {
            let products = sums.iter().zip(factors).map(|(sum, factor)| i64::from(*sum) * i64::from(*factor));
            *load = products.sum::<i64>().wrapping_sub(*offset) as f32 * unit;
        }
        PLAUSIBLE.contains(&loads[rows - 1]).then_some(loads)
    }

    /// Pins that are high, a bit for each, the first one's lowest: those of rules none of which is tripped.
    #[must_use]
    pub fn high_pins(&self) -> u8 {
        let pins = |tripped: bool| {
            let rules = self.rules.iter().filter(move |rule| rule.is_tripped == tripped);
            rules.fold(0, |pins, rule| pins | rule.pin)
        };
        pins(false) & !pins(true)
    }
}

/// Nearest whole number of one that fits, halves away from zero.
fn nearest(value: f32) -> i16 {
    (value + 0.5_f32.copysign(value)) as i16
}

/// One rule under watch.
#[derive(Clone, Debug)]
struct Watched {
    /// Its pin's bit.
    pin: u8,
    rows: u8,
    limit: f32,
    /// Below that it is released.
    release: f32,
    /// Strength from which a cell is pressed, of a rule about areas.
    pressed: Option<f32>,
    frames: u8,
    hold_us: u64,
    trips_blind: bool,
    /// Frames above the limit, one after the other.
    above: u8,
    is_tripped: bool,
    tripped_us: u64,
}

impl Watched {
    /// Tripped, until a frame shows that it is not.
    fn new(header: &PatchHeader, rule: &ReflexRule) -> Self {
        let (limit, pressed) = match rule.limit {
            Limit::Strength(strength) => (strength, None),
            Limit::Force(newtons) => (strength_of(header, newtons), None),
            Limit::Area { area, strength } => (area, Some(strength)),
        };
        Self {
            pin: 1 << (rule.pin.max(1) - 1),
            rows: rule.rows,
            limit,
            release: rule.release * limit,
            pressed,
            frames: rule.frames,
            hold_us: (rule.hold * 1e6) as u64,
            trips_blind: rule.trips_blind,
            above: 0,
            is_tripped: rule.trips_blind,
            tripped_us: 0,
        }
    }

    fn value(&self, loads: &[f32], areas: &[f32]) -> f32 {
        let Some(pressed) = self.pressed else { return loads.iter().copied().fold(f32::MIN, f32::max) };
        loads.iter().zip(areas).filter(|(load, _)| **load >= pressed).map(|(_, area)| area).sum()
    }

    /// Takes in a frame; says whether it is tripped.
    fn follow(&mut self, value: f32, is_blind: bool, timestamp_us: u64) -> bool {
        let is_above = if is_blind { self.trips_blind } else { value >= self.limit };
        self.above = if is_above { self.above.saturating_add(1) } else { 0 };
        if self.above >= self.frames || (is_blind && is_above) {
            (self.is_tripped, self.tripped_us) = (true, timestamp_us);
        }
        let is_held = timestamp_us.saturating_sub(self.tripped_us) < self.hold_us;
        let is_released = !is_blind && value < self.release;
        self.is_tripped &= is_above || is_held || !is_released;
        self.is_tripped
    }
}

#[cfg(test)]
mod tests;
