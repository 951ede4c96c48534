//! Contacts: where an image says the skin is pressed.
//!
//! The region of interest holds the pixels above a quarter of the image's largest value (thesis
//! section 3.5.1); each connected part of it (pixels that touch) is one contact, or several where it has
//! peaks that stand apart (`regions`). Where the largest value stays below the patch's threshold there
//! is no contact, so that noise on an untouched skin stays silent.
//!
//! An image rings beside a strong contact, most near the boundary: a lower peak so close to a contact that no second
//! finger would show as a peak of its own there is not one (non-maximum suppression, `Contact::suppresses`).
//!
//! A patch with places has its contacts found in the voltages instead ([`crate::pipeline::detect`]).
//!
//! Most pixels cost one comparison, for the largest value of each block of 16; only blocks that reach
//! above the level are looked at again.

pub mod calibration;
pub mod hysteresis;
mod regions;
pub mod track;

use crate::{
    image::surface::{Surface, square_distance},
    limits::{MAX_CONTACTS, MAX_PIXELS},
    units::RelativeConductivity,
};
use heapless::Vec;
use postcard_schema::Schema;
use regions::{Region, Search};
use serde::{Deserialize, Serialize};
use track::Identity;

/// Pixels of a block.
const BLOCK: usize = 16;

/// One place where the skin is pressed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Contact {
    /// Centre of pressure in the skin's frame, m: the mean of the pixel centres, weighted by area and
    /// conductivity change (thesis equation 3.4), laid onto the plane of the pixel nearest to it.
    pub position: [f32; 3],
    /// Unit normal of the skin there.
    pub normal: [f32; 3],
    /// Area of the region of interest, m^2.
    pub area: f32,
    /// Strength: mean relative conductivity change over the region (thesis section 3.5.1).
    pub strength: f32,
    /// Largest relative conductivity change in the region.
    pub peak: f32,
    /// Pressure, Pa, by the patch's calibration; none without one.
    pub pressure: Option<f32>,
    /// Area that the pressure acts on, m^2: that of the region of interest without what the image's blur adds,
    /// by the patch's calibration; none where it does not know the area of its indenter.
    pub load_area: Option<f32>,
    /// How sure it is; none of a contact that was found in the image.
    pub evidence: Option<Evidence>,
    /// Which one it is through time; none before it is followed ([`track`]).
    pub identity: Option<Identity>,
}

/// How sure a contact is, by the noise that the board measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Evidence {
    /// By how many standard deviations its strength is above zero.
    pub significance: f32,
    /// Standard deviation of its position along the skin, m.
    pub position_deviation: f32,
    /// Standard deviation of its strength.
    pub strength_deviation: f32,
}

impl Contact {
    /// Where it lies as seen from above, x and y, m.
    #[must_use]
    pub fn from_above(&self) -> [f64; 2] {
        [self.position[0], self.position[1]].map(f64::from)
    }

    /// Force, N: pressure times the area that it acts on; none where either is unknown.
    ///
    /// Blur leaves the sum of change times area as it is, so that a contact smaller than the calibration's
    /// indenter reads as a lower pressure on as much area, and its force is right.
    #[must_use]
    pub fn force(&self) -> Option<f32> {
        Some(self.pressure? * self.load_area?)
    }

    /// Square of the distance within which a later contact is on the same place, m^2: the radius of a disc of its area, and
    /// twice that of the standard press.
    pub(crate) fn square_reach(&self) -> f32 {
        let wider = if self.evidence.is_some() { 4.0 } else { 1.0 };
        wider * self.area * core::f32::consts::FRAC_1_PI
    }

    /// Whether a weaker contact is only the ringing beside this one: it lies closer than the side of a square as
    /// large as this one's area (1.8 times its radius), and its peak stays below three quarters of this one's.
    fn suppresses(&self, weaker: &Self) -> bool {
        square_distance(self.position, weaker.position) < self.area && weaker.peak < 0.75 * self.peak
    }
}

/// Contacts of one image, strongest peak first.
pub type Contacts = Vec<Contact, MAX_CONTACTS>;

/// Value above which a pixel belongs to the region of interest, or `None` on an untouched skin.
#[must_use]
pub fn region_level(image: &[RelativeConductivity], threshold: RelativeConductivity) -> Option<i32> {
    level_below(image.iter().copied().max()?.0, threshold)
}

fn level_below(peak: i32, threshold: RelativeConductivity) -> Option<i32> {
    (peak >= threshold.0 && peak > 0).then_some(peak / 4)
}

/// Finds the contacts in `image`, `[pixel]`, on a surface.
///
/// More than [`MAX_CONTACTS`] regions keep the strongest.
// Not inlined, so that what it needs of the stack is free again for all else.
#[inline(never)]
#[must_use]
pub fn find(
    surface: &Surface<'_>,
    image: &[RelativeConductivity],
    threshold: RelativeConductivity,
) -> Contacts {
    let image = &image[..image.len().min(MAX_PIXELS)];
    let blocks = largest_of_blocks(image);
    let peak = blocks.iter().copied().max().unwrap_or(0);
    let Some(level) = level_below(peak, threshold) else { return Contacts::new() };
    let mut regions = Vec::new();
    let mut search = Search::new(surface, image, level, peak);
    for (number, (block, &largest)) in image.chunks(BLOCK).zip(&blocks).enumerate() {
        if largest > level {
            for (pixel, value) in block.iter().enumerate() {
                if value.0 > level {
                    let take = |region| insert_by_peak(&mut regions, region, threshold);
                    search.explore(number * BLOCK + pixel, take);
                }
            }
        }
    }
    let mut contacts = Contacts::new();
    for contact in regions.iter().map(|region| search.contact(region)) {
        if !contacts.iter().any(|stronger| stronger.suppresses(&contact)) {
            // Never full: regions are no more.
            let _ = contacts.push(contact);
        }
    }
    contacts
}

/// Largest value of each block of pixels.
fn largest_of_blocks(image: &[RelativeConductivity]) -> Vec<i32, { MAX_PIXELS / BLOCK }> {
    // Blocks of a known length are looked at without a loop.
    let (whole, rest) = image.as_chunks::<BLOCK>();
    let rest = (!rest.is_empty()).then(|| largest(rest));
    whole.iter().map(|block| largest(block)).chain(rest).collect()
}

#[inline(always)]
fn largest(block: &[RelativeConductivity]) -> i32 {
    block.iter().fold(i32::MIN, |most, value| most.max(value.0))
}

fn insert_by_peak(regions: &mut Vec<Region, MAX_CONTACTS>, region: Region, threshold: RelativeConductivity) {
    let place = regions.iter().position(|other| other.peak < region.peak).unwrap_or(regions.len());
    if region.peak < threshold || place == MAX_CONTACTS {
        return;
    }
    if regions.is_full() {
        regions.pop();
    }
    // Cannot fail: there is room now.
    let _ = regions.insert(place, region);
}

#[cfg(test)]
mod tests;
