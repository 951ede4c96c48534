//! Contacts: where an image says the skin is pressed.
//!
//! The region of interest holds the pixels above a quarter of the image's largest value (thesis
//! section 3.5.1); each connected part of it (pixels that share an edge) is one contact. Where
//! the largest value stays below the patch's threshold there is no contact, so that noise on an
//! untouched skin stays silent.

use crate::{
    MAX_CONTACTS, MAX_GRID_SIDE, MAX_PIXELS,
    image::{PixelCells, PixelGrid},
    units::RelativeConductivity,
};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// One place where the skin is pressed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Contact {
    /// Centre of pressure in the skin's frame, m: the mean of the pixel centres, weighted by
    /// conductivity change (thesis equation 3.4).
    pub position: [f32; 2],
    /// Area of the region of interest, m^2.
    pub area: f32,
    /// Strength: mean relative conductivity change over the region (thesis section 3.5.1).
    pub strength: f32,
    /// Largest relative conductivity change in the region.
    pub peak: f32,
    /// Pressure, Pa, by the patch's calibration; none without one.
    pub pressure: Option<f32>,
}

impl Contact {
    /// Force, N: pressure times area; none without a calibration.
    #[must_use]
    pub fn force(&self) -> Option<f32> {
        self.pressure.map(|pressure| pressure * self.area)
    }
}

/// Contacts of one image, strongest peak first.
pub type Contacts = Vec<Contact, MAX_CONTACTS>;

/// Value above which a pixel belongs to the region of interest, or `None` on an untouched skin.
#[must_use]
pub fn region_level(image: &[RelativeConductivity], threshold: RelativeConductivity) -> Option<i32> {
    let peak = image.iter().copied().max()?;
    (peak >= threshold && peak.0 > 0).then_some(peak.0 / 4)
}

/// Finds the contacts in `image`, `[pixel]`, on the masked `grid`.
///
/// More than [`MAX_CONTACTS`] regions keep the strongest.
// Not inlined, so that what it needs of the stack is free again for all else.
#[inline(never)]
#[must_use]
pub fn find(
    grid: &PixelGrid,
    mask: &[u8],
    image: &[RelativeConductivity],
    threshold: RelativeConductivity,
) -> Contacts {
    let Some(level) = region_level(image, threshold) else {
        return Contacts::new();
    };
    let mut labels = Labels::of_regions(grid, mask, image, level);
    let mut regions = labels.strongest(threshold);
    let columns = usize::from(grid.columns);
    for place in 0..labels.members.len() {
        let root = labels.root(place as u16);
        let Some(member) = labels.members.get(place) else { continue };
        if let Some(region) = regions.iter_mut().find(|region| region.root == root) {
            let cell = usize::from(member.cell);
            region.add(cell % columns, cell / columns, member.value);
        }
    }
    regions.iter().map(|region| region.contact(grid)).collect()
}

/// Union-find forest over the region of interest: each of its pixels points towards its root, the first
/// pixel of its connected part.
struct Labels {
    /// In the order of the cells.
    members: Vec<Member, MAX_PIXELS>,
}

/// A pixel of the region of interest.
#[derive(Clone, Copy)]
struct Member {
    value: RelativeConductivity,
    cell: u16,
    /// Place of another member, or its own.
    parent: u16,
}

impl Labels {
    fn of_regions(grid: &PixelGrid, mask: &[u8], image: &[RelativeConductivity], level: i32) -> Self {
        let mut labels = Self { members: Vec::new() };
        let columns = usize::from(grid.columns);
        let mut cells = PixelCells::new(mask);
        // The latest member in each column, as the rows are walked from the top.
        let mut above = [0_u16; MAX_GRID_SIDE];
        for (pixel, &value) in image.iter().enumerate().filter(|(_, value)| value.0 > level) {
            let Some(cell) = cells.cell(pixel) else { break };
            let (place, column) = (labels.members.len() as u16, cell % columns);
            let _ = labels.members.push(Member { value, cell: cell as u16, parent: place });
            if column > 0 && place > 0 {
                labels.join_neighbour(place, place - 1, cell.wrapping_sub(1));
            }
            let up = core::mem::replace(&mut above[column], place);
            labels.join_neighbour(place, up, cell.wrapping_sub(columns));
        }
        labels
    }

    /// Joins two members, if the other one is the pixel at that cell.
    fn join_neighbour(&mut self, place: u16, other: u16, cell: usize) {
        if self.members.get(usize::from(other)).is_some_and(|member| usize::from(member.cell) == cell) {
            let (a, b) = (self.root(place), self.root(other));
            self.set_parent(a.max(b), a.min(b));
        }
    }

    fn parent(&self, place: u16) -> u16 {
        self.members.get(usize::from(place)).map_or(place, |member| member.parent)
    }

    fn set_parent(&mut self, place: u16, parent: u16) {
        if let Some(member) = self.members.get_mut(usize::from(place)) {
            member.parent = parent;
        }
    }

    fn root(&mut self, mut place: u16) -> u16 {
        while self.parent(place) != place {
            let grandparent = self.parent(self.parent(place));
            self.set_parent(place, grandparent);
            place = grandparent;
        }
        place
    }

    /// The regions with the largest peaks, strongest first, not yet summed up.
    fn strongest(&mut self, threshold: RelativeConductivity) -> Vec<Region, MAX_CONTACTS> {
        let mut peaks: Vec<RelativeConductivity, MAX_PIXELS> = Vec::new();
        for place in 0..self.members.len() {
            let value = self.members[place].value;
            let _ = peaks.push(value);
            // A root comes before all that point to it.
            let root = usize::from(self.root(place as u16));
            peaks[root] = peaks[root].max(value);
        }
        let mut strongest = Vec::new();
        for (place, &peak) in peaks.iter().enumerate().filter(|(_, peak)| **peak >= threshold) {
            if usize::from(self.parent(place as u16)) == place {
                insert_by_peak(&mut strongest, Region { root: place as u16, peak, ..Region::default() });
            }
        }
        strongest
    }
}

/// Sums over one region, exact.
#[derive(Default)]
struct Region {
    root: u16,
    peak: RelativeConductivity,
    pixels: u32,
    weight: i64,
    weighted_column: i64,
    weighted_row: i64,
}

impl Region {
    fn add(&mut self, column: usize, row: usize, value: RelativeConductivity) {
        let weight = i64::from(value.0);
        self.pixels += 1;
        self.weight += weight;
        self.weighted_column += weight * column as i64;
        self.weighted_row += weight * row as i64;
    }

    fn contact(&self, grid: &PixelGrid) -> Contact {
        let weight = self.weight as f32;
        let column = self.weighted_column as f32 / weight + 0.5;
        let row = self.weighted_row as f32 / weight + 0.5;
        Contact {
            position: grid.position(column, row),
            area: self.pixels as f32 * grid.pitch * grid.pitch,
            strength: weight / self.pixels as f32 / RelativeConductivity::ONE as f32,
            peak: self.peak.to_f32(),
            pressure: None,
        }
    }
}

fn insert_by_peak(regions: &mut Vec<Region, MAX_CONTACTS>, region: Region) {
    let place = regions.iter().position(|other| other.peak < region.peak).unwrap_or(regions.len());
    if place < MAX_CONTACTS && regions.is_full() {
        regions.pop();
    }
    // Fails only if the list is full of stronger regions.
    let _ = regions.insert(place, region);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn grid(columns: u8, rows: u8) -> PixelGrid {
        PixelGrid { columns, rows, pitch: 0.01, left: 0.0, top: f32::from(rows) * 0.01 }
    }

    fn image(values: &[i32]) -> std::vec::Vec<RelativeConductivity> {
        values.iter().map(|&v| RelativeConductivity(v * 1000)).collect()
    }

    const LOW: RelativeConductivity = RelativeConductivity(1);

    #[test]
    fn two_fingers_apart_are_two_contacts_strongest_first() {
        let values = [0, 0, 0, 0, 0, 4, 0, 0, 0, 8, 0, 0, 0, 0, 0];
        let found = find(&grid(5, 3), &[0xFF, 0xFF], &image(&values), LOW);
        assert_eq!(found.len(), 2);
        assert!((found[0].position[0] - 0.045).abs() < 1e-6 && (found[0].position[1] - 0.015).abs() < 1e-6);
        assert!((found[1].position[0] - 0.005).abs() < 1e-6);
        assert!((found[0].area - 1e-4).abs() < 1e-9);
    }

    #[test]
    fn pixels_joined_only_further_down_are_one_contact() {
        // A 'U': both arms meet in the last row.
        let values = [9, 0, 9, 9, 0, 9, 9, 9, 9];
        let found = find(&grid(3, 3), &[0xFF, 0x01], &image(&values), LOW);
        assert_eq!(found.len(), 1);
        assert!((found[0].position[0] - 0.015).abs() < 1e-6);
        assert!((found[0].area - 7e-4).abs() < 1e-9);
    }

    #[test]
    fn pixels_at_or_below_a_quarter_stay_outside_the_region() {
        let found = find(&grid(4, 1), &[0x0F], &image(&[8, 2, 3, 8]), LOW);
        assert_eq!(found.len(), 2, "the 2 is a quarter of 8 and must separate");
    }

    #[test]
    fn an_untouched_skin_has_no_contact() {
        assert!(find(&grid(2, 1), &[3], &image(&[1, 2]), RelativeConductivity(3000)).is_empty());
        assert!(find(&grid(2, 1), &[3], &image(&[-5, -9]), RelativeConductivity(-10_000)).is_empty());
        assert!(find(&grid(2, 1), &[3], &[], LOW).is_empty());
    }

    #[test]
    fn pixels_on_either_side_of_a_masked_cell_do_not_touch() {
        let found = find(&grid(3, 1), &[0b101], &image(&[5, 5]), LOW);
        assert_eq!(found.len(), 2);
    }

    #[test]
    fn more_regions_than_fit_keep_the_strongest() {
        let values: std::vec::Vec<i32> = (0..40).map(|i| if i % 2 == 0 { 40 + i } else { 0 }).collect();
        let found = find(&grid(40, 1), &[0xFF; 5], &image(&values), LOW);
        assert_eq!(found.len(), MAX_CONTACTS);
        assert!(found.windows(2).all(|pair| pair[0].peak >= pair[1].peak));
        assert!((found[0].peak - RelativeConductivity(78_000).to_f32()).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn contacts_lie_on_the_grid_and_cover_the_region(
            values in prop::collection::vec(-100_i32..100, 64),
            mask in prop::collection::vec(any::<u8>(), 8),
        ) {
            let pixels = mask.iter().map(|byte| byte.count_ones() as usize).sum::<usize>();
            let image = image(&values[..pixels]);
            let found = find(&grid(8, 8), &mask, &image, LOW);
            let covered: f32 = found.iter().map(|contact| contact.area).sum();
            let level = region_level(&image, LOW).unwrap_or(i32::MAX);
            let expected = image.iter().filter(|value| value.0 > level).count() as f32 * 1e-4;
            prop_assert!(covered <= expected + 1e-6);
            if found.len() < MAX_CONTACTS {
                prop_assert!((covered - expected).abs() < 1e-6);
            }
            for contact in &found {
                prop_assert!((0.0..=0.08).contains(&contact.position[0]));
                prop_assert!((0.0..=0.08).contains(&contact.position[1]));
                prop_assert!(contact.peak >= contact.strength);
            }
        }
    }
}
