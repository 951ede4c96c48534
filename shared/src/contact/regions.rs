//! Regions: connected parts of the region of interest, divided where two contacts have grown together.
//!
//! Every pixel belongs to the peak that the steepest ascent from it leads to. Peaks whose pixels touch no
//! deeper than an eighth below the lower one of the two are one region; others are regions of their own.

use super::Contact;
use crate::{
    image::surface::{Pixel, Surface},
    limits::MAX_PIXELS,
    units::RelativeConductivity,
};
use heapless::Vec;

/// Most peaks of a connected part that are looked at; a part with more is noise, and stays whole.
const MAX_PEAKS: usize = 16;
/// Bits of a value in a sum: larger ones are rounded, so that no sum ever overflows.
const VALUE_BITS: u32 = 22;
/// No pixel.
const UNSEEN: u16 = u16::MAX;

/// Follows the connected parts of what lies above a level.
pub(super) struct Search<'a> {
    surface: &'a Surface<'a>,
    image: &'a [RelativeConductivity],
    level: i32,
    /// Bits that the values of this image lose in sums.
    shift: u32,
    /// Pixels of the part that is looked at.
    members: Vec<u16, MAX_PIXELS>,
    /// The highest neighbour of each member, or itself where none is higher: `[pixel]`; [`UNSEEN`] of those
    /// that no part has met.
    uphill: [u16; MAX_PIXELS],
}

impl<'a> Search<'a> {
    /// Nothing is found yet; `peak` is the largest value of `image`.
    pub(super) fn new(
        surface: &'a Surface<'a>,
        image: &'a [RelativeConductivity],
        level: i32,
        peak: i32,
    ) -> Self {
        let shift = (32 - peak.leading_zeros()).saturating_sub(VALUE_BITS);
        Self { surface, image, level, shift, members: Vec::new(), uphill: [UNSEEN; MAX_PIXELS] }
    }

    /// Hands the regions of the part round a pixel to `take`, unless that part is known.
    pub(super) fn explore(&mut self, seed: usize, mut take: impl FnMut(Region)) {
        if self.uphill_of(seed) != usize::from(UNSEEN) {
            return;
        }
        let peaks = self.grow(seed as u16);
        if (2..=MAX_PEAKS).contains(&peaks) {
            self.divide(&mut take);
        } else {
            take(self.sum(None));
        }
    }

    /// Collects all members that are connected with the first one; says how many of them are peaks.
    fn grow(&mut self, seed: u16) -> usize {
        self.members.clear();
        self.meet(seed);
        let (mut next, mut peaks) = (0, 0);
        while let Some(&pixel) = self.members.get(next) {
            let uphill = self.look_round(usize::from(pixel));
            self.uphill[usize::from(pixel) % MAX_PIXELS] = uphill;
            peaks += usize::from(uphill == pixel);
            next += 1;
        }
        peaks
    }

    /// Takes a pixel in, unless it is a member.
    #[inline(always)]
    fn meet(&mut self, pixel: u16) {
        let uphill = &mut self.uphill[usize::from(pixel) % MAX_PIXELS];
        if *uphill == UNSEEN {
            *uphill = pixel;
            // Never full: each pixel comes in once.
            let _ = self.members.push(pixel);
        }
    }

    /// Members without a higher neighbour.
    fn peaks(&self) -> impl Iterator<Item = usize> {
        self.members.iter().map(|&pixel| usize::from(pixel)).filter(|&pixel| self.uphill_of(pixel) == pixel)
    }

    fn uphill_of(&self, pixel: usize) -> usize {
        usize::from(self.uphill[pixel % MAX_PIXELS])
    }

    /// Adds the new members round a pixel, and gives the highest of them all.
    fn look_round(&mut self, pixel: usize) -> u16 {
        let (mut uphill, mut highest) = (pixel, self.value(pixel));
        for other in self.surface.neighbours(pixel) {
            let value = self.value(other);
            if value <= self.level {
                continue;
            }
            // Of equal ones the first is the highest, so that every ascent ends.
            if value > highest || value == highest && other < uphill {
                (uphill, highest) = (other, value);
            }
            self.meet(other as u16);
        }
        uphill as u16
    }

    fn value(&self, pixel: usize) -> i32 {
        self.image.get(pixel).map_or(i32::MIN, |value| value.0)
    }

    /// Hands out a region for each peak that stands alone.
    // Not inlined, so that its labels take stack only where there are several peaks.
    #[inline(never)]
    fn divide(&self, take: &mut dyn FnMut(Region)) {
        let mut basins = self.basins();
        self.spread(&mut basins.labels);
        self.join_shallow(&mut basins);
        for basin in 0..basins.peaks.len() {
            if basins.into[basin] == basin as u8 {
                take(self.sum(Some((&basins, basin as u8))));
            }
        }
    }

    /// A basin for each peak, which alone belongs to it so far.
    fn basins(&self) -> Basins {
        let mut basins = Basins { labels: [0; MAX_PIXELS], peaks: Vec::new(), into: [0; MAX_PEAKS] };
        for pixel in self.peaks() {
            let basin = basins.peaks.len();
            // Not full: the peaks have been counted.
            if basins.peaks.push(self.value(pixel)).is_ok() {
                basins.into[basin] = basin as u8;
                basins.labels[pixel % MAX_PIXELS] = basin as u8 + 1;
            }
        }
        basins
    }

    /// Every member takes the label of the peak above it. Each ascent goes on only to the first pixel that has
    /// one, and gives it to all on the way: however long the ascents of a plateau are, no step is made thrice.
    fn spread(&self, labels: &mut [u8; MAX_PIXELS]) {
        for &member in &self.members {
            let start = usize::from(member);
            let mut top = start;
            while labels[top % MAX_PIXELS] == 0 {
                top = self.uphill_of(top);
            }
            let label = labels[top % MAX_PIXELS];
            let mut pixel = start;
            while labels[pixel % MAX_PIXELS] == 0 {
                labels[pixel % MAX_PIXELS] = label;
                pixel = self.uphill_of(pixel);
            }
        }
    }

    /// Joins each two basins that touch above 7/8 of the lower one of their peaks.
    fn join_shallow(&self, basins: &mut Basins) {
        for &member in &self.members {
            let pixel = usize::from(member);
            for other in self.surface.neighbours(pixel) {
                let saddle = self.value(pixel).min(self.value(other));
                let lower = basins.peak(pixel).min(basins.peak(other));
                if saddle > self.level && saddle > lower - lower / 8 {
                    basins.join(basins.of(pixel), basins.of(other));
                }
            }
        }
    }

    /// Sums over the members, or over those of one basin.
    #[inline(never)]
    fn sum(&self, only: Option<(&Basins, u8)>) -> Region {
        let mut region = Region::default();
        for &member in &self.members {
            let pixel = usize::from(member);
            let is_inside = only.is_none_or(|(basins, basin)| basins.of(pixel) == basin);
            if is_inside && let Some(at) = self.surface.pixel(pixel) {
                region.add(pixel, self.value(pixel), at, self.shift);
            }
        }
        region
    }

    /// A region as a contact.
    pub(super) fn contact(&self, region: &Region) -> Contact {
        region.contact(self.surface, self.shift)
    }
}

/// Which peak each member belongs to.
struct Basins {
    /// `[pixel]`, counted from 1.
    labels: [u8; MAX_PIXELS],
    peaks: Vec<i32, MAX_PEAKS>,
    /// The basin that a basin has been joined to, or itself.
    into: [u8; MAX_PEAKS],
}

impl Basins {
    fn label(&self, pixel: usize) -> usize {
        usize::from(self.labels[pixel % MAX_PIXELS].saturating_sub(1)) % MAX_PEAKS
    }

    /// Basin of a member.
    fn of(&self, pixel: usize) -> u8 {
        self.into[self.label(pixel)]
    }

    /// The peak that the ascent from a member leads to.
    fn peak(&self, pixel: usize) -> i32 {
        self.peaks.get(self.label(pixel)).copied().unwrap_or(0)
    }

    fn join(&mut self, one: u8, other: u8) {
        if one != other {
            self.into.iter_mut().filter(|basin| **basin == one).for_each(|basin| *basin = other);
        }
    }
}

/// Sums over one region, exact but for values of 4 and more.
#[derive(Clone, Copy, Default)]
pub(super) struct Region {
    pub(super) peak: RelativeConductivity,
    peak_pixel: usize,
    area: u32,
    weight: i64,
    moments: [i64; 3],
}

impl Region {
    fn add(&mut self, pixel: usize, value: i32, at: Pixel, shift: u32) {
        // Below 2^22 times 2^8; 1024 of them times 2^15 stay below 2^55.
        let weight = (value >> shift) * i32::from(at.area);
        self.area += u32::from(at.area);
        self.weight += i64::from(weight);
        let [x, y, z] = at.centre.map(|place| i64::from(weight) * i64::from(place));
        self.moments = [self.moments[0] + x, self.moments[1] + y, self.moments[2] + z];
        if value > self.peak.0 {
            (self.peak, self.peak_pixel) = (RelativeConductivity(value), pixel);
        }
    }

    fn contact(&self, surface: &Surface<'_>, shift: u32) -> Contact {
        let weight = self.weight as f32;
        let mean = self.moments.map(|moment| moment as f32 / weight);
        let (position, normal) = onto_surface(surface, self.peak_pixel, mean);
        let unit = (1_u64 << shift) as f32 / RelativeConductivity::ONE as f32;
        Contact {
            position,
            normal,
            area: self.area as f32 * surface.scale.area,
            strength: weight / self.area as f32 * unit,
            peak: self.peak.to_f32(),
            pressure: None,
            load_area: None,
            evidence: None,
            identity: None,
        }
    }
}

/// Lays a mean of centres, in steps, onto the plane of the nearest pixel: on a curved surface means lie
/// beneath it. The nearest is found by a walk downhill in distance that begins at `pixel`.
fn onto_surface(surface: &Surface<'_>, pixel: usize, mean: [f32; 3]) -> ([f32; 3], [f32; 3]) {
    let (mut nearest, mut least) = (pixel, distance(surface, pixel, mean));
    let mut before = None;
    while before != Some(nearest) {
        before = Some(nearest);
        for other in surface.neighbours(nearest) {
            let distance = distance(surface, other, mean);
            if distance < least {
                (nearest, least) = (other, distance);
            }
        }
    }
    let Some(at) = surface.pixel(nearest) else { return (surface.place(mean), [0.0, 0.0, 1.0]) };
    let normal = surface.normal(&at);
    let up = dot(away(&at, mean), normal);
    let [x, y, z] = normal.map(|part| part * up);
    (surface.place([mean[0] + x, mean[1] + y, mean[2] + z]), normal)
}

/// Squared distance of a pixel from a place, both in steps.
#[inline(never)]
fn distance(surface: &Surface<'_>, pixel: usize, place: [f32; 3]) -> f32 {
    surface.pixel(pixel).map_or(f32::INFINITY, |at| dot(away(&at, place), away(&at, place)))
}

fn away(pixel: &Pixel, place: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = pixel.centre.map(f32::from);
    [x - place[0], y - place[1], z - place[2]]
}

fn dot([x, y, z]: [f32; 3], [u, v, w]: [f32; 3]) -> f32 {
    x * u + y * v + z * w
}
