//! Reflexes: rules by which a board acts by itself, and the rows that read a region's load ([`crate::pipeline::reflex`]).

use super::{PatchError, PatchHeader, PatchView, places::MAX_PLACES};
use crate::limits::REFLEX_PINS;
use heapless::String;

/// Most rules.
pub const MAX_REFLEXES: usize = 4;
/// Most rows, of all rules.
pub const MAX_REFLEX_ROWS: usize = 16;
/// Most products for a frame: of all rows, and of one more, with each measurement.
pub const MAX_REFLEX_PRODUCTS: usize = 2304;
/// Longest name of a rule, bytes.
pub const REFLEX_NAME_BYTES: usize = 16;

/// Bytes of a rule.
pub(super) const RULE_BYTES: usize = REFLEX_NAME_BYTES + 24;
/// Bytes of a row before its weights.
const ROW_BYTES: usize = 4 + MAX_PLACES / 8;
const TRIPS_BLIND: u8 = 1;

/// What a rule looks at, and its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Load on the cell of the region that reads most, in strengths of the standard press.
    Strength(f32),
    /// The same by the patch's calibration, N.
    Force(f32),
    /// Area of the region's cells that are pressed, m^2: of those that read this strength.
    Area {
        /// Limit, m^2.
        area: f32,
        /// Strength of the standard press from which a cell is pressed.
        strength: f32,
    },
}

/// One rule: what a region may bear, and what happens beyond it.
#[derive(Clone, Debug, PartialEq)]
pub struct ReflexRule {
    /// What people call it.
    pub name: String<REFLEX_NAME_BYTES>,
    /// The pin that falls, 1 to [`REFLEX_PINS`].
    pub pin: u8,
    /// What trips it.
    pub limit: Limit,
    /// Share of the limit below which it is released, 0 to 1.
    pub release: f32,
    /// Frames above the limit, one after the other, that trip it; 1 or more.
    pub frames: u8,
    /// How long it stays tripped at least, s.
    pub hold: f32,
    /// Whether it trips as well while the board cannot tell.
    pub trips_blind: bool,
    /// Rows of it, one for each cell of its region.
    pub rows: u8,
}

impl ReflexRule {
    fn to_bytes(&self) -> [u8; RULE_BYTES] {
        let (kind, limit, level) = match self.limit {
            Limit::Strength(strength) => (0, strength, 0.0),
            Limit::Force(newtons) => (1, newtons, 0.0),
            Limit::Area { area, strength } => (2, area, strength),
        };
        let mut bytes = [0; RULE_BYTES];
        let facts =
            [self.pin, kind, self.frames, self.rows, u8::from(self.trips_blind) * TRIPS_BLIND, 0, 0, 0];
        let numbers = [limit, level, self.release, self.hold];
        let name = self.name.bytes().chain(core::iter::repeat(0)).take(REFLEX_NAME_BYTES);
        let all = name.chain(facts).chain(numbers.into_iter().flat_map(f32::to_le_bytes));
        bytes.iter_mut().zip(all).for_each(|(byte, value)| *byte = value);
        bytes
    }

    // Once on the board, for all that asks.
    #[inline(never)]
    fn from_bytes(bytes: &[u8; RULE_BYTES]) -> Option<Self> {
        let (name, rest) = bytes.split_first_chunk::<REFLEX_NAME_BYTES>()?;
        let (&[pin, kind, frames, rows, flags, ..], numbers) = rest.split_first_chunk::<8>()?;
        let number =
            |at: usize| numbers.as_chunks().0.get(at).map_or(f32::NAN, |bytes| f32::from_le_bytes(*bytes));
        let limit = match kind {
            0 => Limit::Strength(number(0)),
            1 => Limit::Force(number(0)),
            2 => Limit::Area { area: number(0), strength: number(1) },
            _ => return None,
        };
        let length = name.iter().position(|&byte| byte == 0).unwrap_or(REFLEX_NAME_BYTES);
        let name = core::str::from_utf8(name.get(..length)?).ok()?.try_into().ok()?;
        let (release, hold) = (number(2), number(3));
        Some(Self { name, pin, limit, release, frames, hold, trips_blind: flags & TRIPS_BLIND != 0, rows })
    }

    /// Whether a board can follow it.
    fn is_valid(&self) -> bool {
        let is_positive = |value: f32| value > 0.0 && value.is_finite();
        let is_limit = match self.limit {
            Limit::Strength(limit) | Limit::Force(limit) => is_positive(limit),
            Limit::Area { area, strength } => is_positive(area) && is_positive(strength),
        };
        is_limit
            && self.rows >= 1
            && (1..=REFLEX_PINS).contains(&self.pin)
            && self.frames >= 1
            && (0.0..=1.0).contains(&self.release)
            && (0.0..=3600.0).contains(&self.hold)
    }
}

/// One row of a rule: what reads the load on one cell.
#[derive(Clone, Debug, PartialEq)]
pub struct ReflexRow<W> {
    /// Area of the cell, m^2.
    pub area: f32,
    /// The places in it, one bit each.
    pub places: [u8; MAX_PLACES / 8],
    /// Weights of relative changes: `[measurement]`.
    pub weights: W,
}

/// Weights of relative changes in a patch: `[measurement]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<'a>(&'a [[u8; 4]]);

impl<'a> Weights<'a> {
    /// That of a measurement; 0 of one that there is not.
    #[must_use]
    pub fn get(&self, measurement: usize) -> f32 {
        self.0.get(measurement).map_or(0.0, |bytes| f32::from_le_bytes(*bytes))
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = f32> + use<'a> {
        self.0.iter().map(|bytes| f32::from_le_bytes(*bytes))
    }
}

/// The tables of the reflexes, for writing a patch.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReflexTables<'a> {
    /// The rules.
    pub rules: &'a [ReflexRule],
    /// Their rows, one rule's after the other's.
    pub rows: &'a [ReflexRow<&'a [f32]>],
}

impl ReflexTables<'_> {
    pub(super) fn put(&self, mut put: impl FnMut(&[u8]) -> Option<()>) -> Option<()> {
        self.rules.iter().try_for_each(|rule| put(&rule.to_bytes()))?;
        self.rows.iter().try_for_each(|row| {
            put(&row.area.to_le_bytes())?;
            put(&row.places)?;
            row.weights.iter().try_for_each(|weight| put(&weight.to_le_bytes()))
        })
    }
}

/// Most rows of a patch of so many measurements.
#[must_use]
pub const fn most_reflex_rows(measurements: usize) -> usize {
    let rows = (MAX_REFLEX_PRODUCTS / if measurements > 0 { measurements } else { 1 }).saturating_sub(1);
    if rows < MAX_REFLEX_ROWS { rows } else { MAX_REFLEX_ROWS }
}

/// Bytes of the tables of so many rules and rows in a patch of so many measurements.
#[must_use]
pub fn reflex_bytes(rules: usize, rows: usize, measurements: usize) -> usize {
    RULE_BYTES * rules + row_bytes(rows, measurements)
}

/// Bytes of the table of rows.
pub(super) fn row_bytes(rows: usize, measurements: usize) -> usize {
    rows * (ROW_BYTES + 4 * measurements)
}

impl<'a> PatchView<'a> {
    /// Rules by which the board acts by itself.
    pub fn reflex_rules(&self) -> impl Iterator<Item = ReflexRule> + use<'a> {
        self.reflex_rules.as_chunks().0.iter().filter_map(ReflexRule::from_bytes)
    }

    /// Rows of all rules, one rule's after the other's.
    pub fn reflex_rows(&self) -> impl Iterator<Item = ReflexRow<Weights<'a>>> + use<'a> {
        let bytes = row_bytes(1, self.header.measurements.into());
        self.reflex_rows.chunks_exact(bytes).filter_map(|row| {
            let (area, row) = row.split_first_chunk()?;
            let (places, weights) = row.split_first_chunk()?;
            let weights = Weights(weights.as_chunks().0);
            Some(ReflexRow { area: f32::from_le_bytes(*area), places: *places, weights })
        })
    }

    pub(super) fn check_reflexes(&self) -> Result<(), PatchError> {
        let is_calibrated = force_of(&self.header, 1.0).is_some_and(|force| force > 0.0);
        let mut rows = 0;
        for (number, rule) in self.reflex_rules.as_chunks().0.iter().enumerate() {
            let rule = ReflexRule::from_bytes(rule)
                .filter(ReflexRule::is_valid)
                .filter(|rule| is_calibrated || !matches!(rule.limit, Limit::Force(_)));
            let Some(rule) = rule else { return Err(PatchError::ReflexRule { rule: number }) };
            rows += usize::from(rule.rows);
        }
        let is_finite = |row: &ReflexRow<Weights<'_>>| {
            row.area > 0.0 && row.area.is_finite() && row.weights.iter().all(f32::is_finite)
        };
        if rows == usize::from(self.header.reflex_rows)
            && self.reflex_rows().filter(is_finite).count() == rows
        {
            Ok(())
        } else {
            Err(PatchError::ReflexRows { rows })
        }
    }
}

/// Force of a standard press of this strength, N, without hysteresis; none where the skin is not calibrated.
// Once on the board, for all that asks.
#[inline(never)]
#[must_use]
pub fn force_of(header: &PatchHeader, strength: f32) -> Option<f32> {
    let radius = header.detection.radius;
    let area = header.calibration.load_share? * core::f32::consts::PI * radius * radius;
    Some(header.calibration.pressure(strength)? * area)
}

/// Strength of a standard press of this force, N, by a patch's calibration; without one none is so strong.
#[must_use]
pub fn strength_of(header: &PatchHeader, newtons: f32) -> f32 {
    let is_enough = |strength: f32| force_of(header, strength).is_some_and(|force| force >= newtons);
    let (mut low, mut high) = (0.0_f32, 1.0);
    while !is_enough(high) && high < 1e6 {
        high *= 2.0;
    }
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        if is_enough(middle) { high = middle } else { low = middle }
    }
    high
}
