//! Matched filter: where data resemble the response to a press most, in the fixed point of images.

use super::{
    known::{Known, KnownFit},
    sums::Scaled,
};
use crate::{
    patch::{
        matrix::GROUP,
        places::{MAX_KNOWN, MAX_PLACES, Places},
    },
    pipeline::{
        reconstruct::{self, LOW_BITS},
        reference::{DifferenceData, power_of_two},
    },
};
use heapless::Vec;

/// Most rows, whole groups of them.
const MAX_ROWS: usize = MAX_PLACES + MAX_KNOWN;

/// 1 / sqrt(a' S^-1 a) of the responses a, without what they have in common with a change that is common to all, and less
/// the exponents of their rows: `[place]`.
pub(super) type Norms = Vec<f32, MAX_PLACES>;

/// What data resemble: the places where z = a' S^-1 y / sqrt(a' S^-1 a) is largest and least, each with its z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Look {
    /// The press that they resemble most.
    pub(super) most: (usize, f32),
    /// The press that was taken away.
    pub(super) least: (usize, f32),
    /// How much there is, in units of one frame's variance, beside noise.
    pub(super) left: f32,
    /// The changes known to be no press that explain them best.
    pub(super) known: KnownFit,
}

impl Look {
    /// Whether they resemble a press that was taken away more than one that came.
    pub(super) fn is_of_lift(&self) -> bool {
        self.least.1 < -self.most.1
    }
}

/// Looks at data y that come without what is common to all, times their inverse variances S^-1: `[measurement]`.
// Not inlined, so that what it needs of the stack is free again for all else.
#[inline(never)]
pub(super) fn look(places: &Places<'_>, data: &DifferenceData, norms: &Norms, known: &Known) -> Look {
    let mut values = [0; MAX_ROWS];
    let count = places.rows().count.next_multiple_of(GROUP).min(MAX_ROWS);
    reconstruct::products(&places.rows(), data, &mut values[..count]);
    let mut look = Look::default();
    for (place, (&value, norm)) in values.iter().zip(norms).enumerate() {
        let z = value as f32 * norm;
        if z > look.most.1 {
            look.most = (place, z);
        }
        if z < look.least.1 {
            look.least = (place, z);
        }
    }
    let scale = power_of_two(LOW_BITS - data.exponent);
    look.most.1 *= scale;
    look.least.1 *= scale;
    let sums = values.get(places.count()..).unwrap_or_default();
    look.known = known.fit(places, sums.iter().map(|&sum| sum as f32 * scale));
    look
}

/// The norm of a place, without what it has in common with a change that is common to all.
pub(super) fn norm(places: &Places<'_>, place: usize, scaled: &Scaled) -> f32 {
    let row = places.row(place);
    let (mut square, mut with_common) = (0.0, 0.0);
    for (four, [weights, common]) in scaled.fours.iter().enumerate() {
        for (n, mantissa) in Places::four(row, four).into_iter().enumerate() {
            let weighted = weights[n] * mantissa;
            square += weighted * mantissa;
            with_common += weighted * common[n];
        }
    }
    if scaled.of_common > 0.0 {
        square -= with_common * with_common / scaled.of_common;
    }
    if square > 0.0 { 1.0 / libm::sqrtf(square) } else { 0.0 }
}

/// The strength of a press whose z is this.
pub(super) fn strength(places: &Places<'_>, place: usize, norms: &Norms, z: f32) -> f32 {
    z * norms.get(place).map_or(0.0, |norm| norm * power_of_two(places.row_exponent(place).into()))
}
