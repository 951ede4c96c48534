//! Detection: presses are looked for in the difference data, where they stand out from the noise most.
//!
//! The matched filter z = a' S^-1 y / sqrt(a' S^-1 a) is the strongest test for a press of response a in data y with
//! covariance S (Kay, Fundamentals of Statistical Signal Processing II, chapter 4); on an untouched skin its variance is 1
//! wherever a lies. S is diagonal, as the board measured it ([`super::noise`]). The patch has the responses at some hundred
//! places.
//!
//! The presses of the frame before are fitted to the new one (`fit`); what they leave is searched for another, until no
//! place has one. A press that noise, or what the others leave unexplained, accounts for is none.

mod fit;

use super::{
    noise::Noise,
    reconstruct::{self, LOW_BITS},
    reference::{Changes, DifferenceData, Reference, power_of_two},
};
use crate::{
    contact::{Contact, Contacts, Evidence},
    limits::MAX_CONTACTS,
    patch::{
        PatchView,
        matrix::GROUP,
        places::{MAX_PLACES, Places},
    },
};
pub use fit::Press;
use fit::{Fit, MAX_PRESSES};
use heapless::Vec;

/// Places whose normalisation is brought up to date in one frame.
const REFRESHED: usize = 4;
/// A press that is one stays one until its significance falls below this share of the level.
const RELEASE: f32 = 0.7;
/// Weaker ones than this share of the strongest are none, as with the quarter of an image's peak.
const LEAST_SHARE: f32 = 0.2;

/// What detection remembers from frame to frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Detector {
    noise: Noise,
    /// Inverse variances of the data: `[measurement]`.
    weights: Changes,
    /// 1 / sqrt(a' S^-1 a): `[place]`.
    norms: Vec<f32, MAX_PLACES>,
    /// The place whose norm is next to be brought up to date.
    next: usize,
    /// Presses of the latest frame with their satellites.
    presses: Vec<Press, MAX_PRESSES>,
    /// The same as contacts.
    contacts: Presses,
}

/// Presses of one frame, strongest first.
pub type Presses = Vec<Press, MAX_CONTACTS>;

impl Detector {
    /// Takes in a frame's measurements.
    #[inline(never)]
    pub fn see(&mut self, measured: &[i64]) {
        self.noise.see(measured);
    }

    /// The frame seen last, and the one before, were of an untouched skin.
    #[inline(never)]
    pub fn count(&mut self) {
        self.noise.count();
    }

    /// A new reference: nothing presses.
    #[inline(never)]
    pub fn begin(&mut self, patch: &PatchView<'_>, reference: &Reference) {
        self.presses.clear();
        self.contacts.clear();
        self.norms.clear();
        self.next = 0;
        if patch.places().count() == 0 {
            return;
        }
        self.noise.inverse_variances(patch, reference, &mut self.weights);
        let places = patch.places();
        self.norms = (0..places.count()).map(|place| norm(&places, place, &self.weights)).collect();
    }

    /// Follows the noise, a few places in each frame.
    #[inline(never)]
    pub fn refresh(&mut self, patch: &PatchView<'_>, reference: &Reference) {
        if self.norms.is_empty() {
            return;
        }
        if self.next == 0 {
            self.noise.inverse_variances(patch, reference, &mut self.weights);
        }
        let places = patch.places();
        for place in self.next..self.next + REFRESHED {
            if let Some(known) = self.norms.get_mut(place) {
                *known = norm(&places, place, &self.weights);
            }
        }
        self.next = if self.next + REFRESHED < places.count() { self.next + REFRESHED } else { 0 };
    }

    /// The presses in relative changes, `[measurement]`; those that are not finite say nothing.
    #[inline(always)]
    pub fn detect(&mut self, patch: &PatchView<'_>, relative: &[f32]) {
        if self.norms.is_empty() {
            return;
        }
        self.search(patch, relative);
    }

    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn search(&mut self, patch: &PatchView<'_>, relative: &[f32]) {
        let level = patch.header.detection.level;
        let mut left = Changes::new();
        let mut fit = Fit::of_nothing(patch, relative, &self.weights);
        if !self.presses.is_empty() {
            fit = fit::refined(patch, &self.presses, relative, &self.weights);
            fit.retain(|press, fit| press.significance >= RELEASE * level && fit.is_worth(press));
        }
        while fit.has_room() {
            fit.left(patch, relative, &mut left);
            let Some(press) = self.loudest(patch, &left, &fit) else { break };
            let mut more = fit.presses.clone();
            let _ = more.push(press);
            let next = fit::refined(patch, &more, relative, &self.weights);
            let gain = next.explained - fit.explained;
            // What the presses leave unexplained is noise of a kind: of another one it asks for more.
            let is_more = next.presses.len() > fit.presses.len() && gain > level * level * next.misfit();
            if !(is_more && next.presses.iter().all(|press| next.is_worth(press))) {
                break;
            }
            fit = next;
        }
        self.contacts = if fit.is_explained() { fit.contacts() } else { Presses::new() };
        let least = LEAST_SHARE * self.contacts.first().map_or(0.0, |press| press.strength);
        self.contacts.retain(|press| press.strength >= least);
        self.presses = fit.presses;
    }

    /// The presses as contacts, strongest first. Strengths are those over the area of the standard press.
    #[inline(never)]
    #[must_use]
    pub fn contacts(&self, patch: &PatchView<'_>) -> Contacts {
        let (places, surface, radius) = (patch.places(), patch.surface(), patch.header.detection.radius);
        let contact = |press: &Press| Contact {
            position: press.position,
            normal: surface
                .pixel(press.pixel(&places))
                .map_or([0.0, 0.0, 1.0], |pixel| surface.normal(&pixel)),
            area: core::f32::consts::PI * radius * radius,
            strength: press.strength,
            peak: press.strength,
            pressure: None,
            load_area: None,
            evidence: Some(Evidence {
                significance: press.significance,
                position_deviation: press.position_deviation,
                strength_deviation: press.strength_deviation,
            }),
        };
        self.contacts.iter().map(contact).collect()
    }

    /// A press where the matched filter is largest and above the level. Beside another press it is its satellite.
    #[inline(never)]
    fn loudest(&self, patch: &PatchView<'_>, left: &[f32], fit: &Fit) -> Option<Press> {
        let places = patch.places();
        let weighted: Changes = left.iter().zip(&self.weights).map(|(y, weight)| y * weight).collect();
        let mut data = DifferenceData::default();
        data.quantise(&weighted, places.column_exponents());
        let mut values = [0; MAX_PLACES];
        let count = places.count().next_multiple_of(GROUP).min(MAX_PLACES);
        reconstruct::products(&places.rows(), &data, &mut values[..count]);
        let level = patch.header.detection.level;
        let (mut best, mut most) = (None, level);
        let rows = values.iter().zip(places.row_exponents()).zip(&self.norms);
        for (place, ((&value, exponent), &norm)) in rows.enumerate() {
            let exponent = LOW_BITS - i32::from(exponent) - data.exponent;
            let z = value as f32 * power_of_two(exponent.clamp(-126, 127)) * norm;
            if z > most {
                (best, most) = (Some((place, z * norm)), z);
            }
        }
        let (place, strength) = best?;
        // Fitting its place explains some more, but hardly twice as much.
        let is_lost = 2.0 * most * most < level * level * fit.misfit_after(2.0 * most * most);
        (!is_lost).then(|| Press::at(place, strength, fit.is_beside(patch, place, strength)))
    }
}

/// 1 / sqrt(a' S^-1 a) of a place.
fn norm(places: &Places<'_>, place: usize, weights: &[f32]) -> f32 {
    let row = places.row_exponent(place);
    let own = places.row(place);
    let mut exponents = places.column_exponents();
    let mut square = 0.0;
    for (pair, weights) in weights.chunks(2).enumerate() {
        for (mantissa, weight) in Places::pair(own, pair).into_iter().zip(weights) {
            square +=
                mantissa * mantissa * weight * power_of_two(-2 * i32::from(exponents.next().unwrap_or(0)));
        }
    }
    let size = libm::sqrtf(square) * power_of_two(-i32::from(row));
    if size > 0.0 { 1.0 / size } else { 0.0 }
}
