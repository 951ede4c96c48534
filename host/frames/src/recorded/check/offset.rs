//! A constant that every value holds, as raw counts of a converter do.

use super::{super::statistics::median, causes::Explained};
use serde::Serialize;

/// A constant that every value seems to hold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Offset {
    /// The constant, in the file's unit.
    pub value: f64,
    /// Its imaginary part; 0 for real data.
    pub imaginary: f64,
    /// Its share of the median magnitude without it, %.
    pub share_percent: f64,
    /// Correlation of log magnitudes with the model, with it.
    pub correlation_before: f64,
    /// The same once it is subtracted.
    pub correlation: f64,
}

impl Offset {
    /// The one that was found, if any.
    pub(super) fn of(found: &[Explained]) -> Option<Self> {
        let is_offset = |it: &Explained| it.reading.offset.norm() > 0.0;
        let (before, after) =
            (found.iter().rfind(|it| !is_offset(it))?, found.iter().find(|it| is_offset(it))?);
        let offset = after.reading.offset;
        let magnitude = median(after.likeness.measured.iter().map(|value| value.abs())) * after.likeness.gain;
        Some(Self {
            value: offset.re,
            imaginary: offset.im,
            share_percent: 100.0 * offset.norm() / magnitude.max(f64::MIN_POSITIVE),
            correlation_before: before.likeness.correlation(),
            correlation: after.likeness.correlation(),
        })
    }
}
