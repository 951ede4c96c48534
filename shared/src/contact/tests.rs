use super::*;
use crate::image::{
    Geometry, PixelGrid,
    surface::{PIXEL_BYTES, Pixel, SurfaceScale},
};
use proptest::prelude::*;
use std::vec::Vec;

/// A surface with its tables.
struct Tables {
    scale: SurfaceScale,
    pixels: Vec<[u8; PIXEL_BYTES]>,
    neighbours: Vec<[u8; 2]>,
}

impl Tables {
    fn new(scale: SurfaceScale, pixels: &[Pixel], neighbours: &[u16]) -> Self {
        let pixels = pixels.iter().map(|pixel| pixel.to_bytes()).collect();
        Self { scale, pixels, neighbours: neighbours.iter().map(|n| n.to_le_bytes()).collect() }
    }

    fn flat(columns: u8, rows: u8, mask: &[u8]) -> Self {
        let grid = PixelGrid { columns, rows, pitch: 0.01, left: 0.0, top: f32::from(rows) * 0.01 };
        let geometry = Geometry { grid, mask: mask.iter().copied().collect() };
        let (pixels, neighbours) = geometry.tables();
        Self::new(geometry.scale(), &pixels, &neighbours)
    }

    fn view(&self) -> Surface<'_> {
        Surface::new(self.scale, self.pixels.as_flattened(), self.neighbours.as_flattened())
    }
}

/// Contacts on a grid of 10 mm pixels whose lower left corner is the origin.
fn found(columns: u8, rows: u8, mask: &[u8], image: &[RelativeConductivity]) -> Contacts {
    find(&Tables::flat(columns, rows, mask).view(), image, LOW)
}

fn image(values: &[i32]) -> Vec<RelativeConductivity> {
    values.iter().map(|&v| RelativeConductivity(v * 1000)).collect()
}

const LOW: RelativeConductivity = RelativeConductivity(1);

#[test]
fn two_fingers_apart_are_two_contacts_strongest_first() {
    let values = [0, 0, 0, 0, 0, 4, 0, 0, 0, 8, 0, 0, 0, 0, 0];
    let found = found(5, 3, &[0xFF, 0xFF], &image(&values));
    assert_eq!(found.len(), 2);
    assert!((found[0].position[0] - 0.045).abs() < 1e-6 && (found[0].position[1] - 0.015).abs() < 1e-6);
    assert!((found[1].position[0] - 0.005).abs() < 1e-6);
    assert!((found[0].area - 1e-4).abs() < 1e-9);
}

#[test]
fn pixels_joined_only_further_down_are_one_contact() {
    // A 'U': both arms meet in the last row.
    let values = [9, 0, 9, 9, 0, 9, 9, 9, 9];
    let found = found(3, 3, &[0xFF, 0x01], &image(&values));
    assert_eq!(found.len(), 1);
    assert!((found[0].position[0] - 0.015).abs() < 1e-6);
    assert!((found[0].area - 7e-4).abs() < 1e-9);
}

#[test]
fn pixels_at_or_below_a_quarter_stay_outside_the_region() {
    let found = found(4, 1, &[0x0F], &image(&[8, 2, 3, 8]));
    assert_eq!(found.len(), 2, "the 2 is a quarter of 8 and must separate");
}

#[test]
fn an_untouched_skin_has_no_contact() {
    let two = Tables::flat(2, 1, &[3]);
    assert!(find(&two.view(), &image(&[1, 2]), RelativeConductivity(3000)).is_empty());
    assert!(find(&two.view(), &image(&[-5, -9]), RelativeConductivity(-10_000)).is_empty());
    assert!(find(&two.view(), &[], LOW).is_empty());
}

#[test]
fn a_region_begins_above_a_quarter_of_a_peak_that_reaches_the_threshold_and_is_positive() {
    for (peak, threshold, level) in
        [(7, 7, Some(1750)), (6, 7, None), (0, 0, None), (0, -1, None), (-1, -1, None), (9, 1, Some(2250))]
    {
        let found = region_level(&image(&[-20, peak]), RelativeConductivity(threshold * 1000));
        assert_eq!(found, level, "{peak} {threshold}");
    }
    assert_eq!(region_level(&[], LOW), None);
}

#[test]
fn contacts_of_equal_peaks_come_in_the_order_of_their_pixels() {
    let found = found(5, 1, &[0x1F], &image(&[8, 0, 8, 0, 8]));
    let places: Vec<i32> = found.iter().map(|contact| (contact.position[0] * 1e3).round() as i32).collect();
    assert_eq!(places, [5, 25, 45]);
}

#[test]
fn force_is_pressure_times_the_area_that_it_acts_on() {
    let contact = found(1, 1, &[1], &image(&[8]))[0];
    let force = |pressure, load_area| Contact { pressure, load_area, ..contact }.force();
    assert_eq!(force(Some(20_000.0), Some(0.5e-4)), Some(1.0));
    assert_eq!([force(None, Some(1.0)), force(Some(1.0), None)], [None; 2]);
}

#[test]
fn pixels_on_either_side_of_a_masked_cell_do_not_touch() {
    let found = found(3, 1, &[0b101], &image(&[5, 5]));
    assert_eq!(found.len(), 2);
}

#[test]
fn more_regions_than_fit_keep_the_strongest() {
    let values: Vec<i32> = (0..40).map(|i| if i % 2 == 0 { 40 + i } else { 0 }).collect();
    let found = found(40, 1, &[0xFF; 5], &image(&values));
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
        let found = find(&Tables::flat(8, 8, &mask).view(), &image, LOW);
        let covered: f32 = found.iter().map(|contact| contact.area).sum();
        let level = region_level(&image, LOW).unwrap_or(i32::MAX);
        let expected = image.iter().filter(|value| value.0 > level).count() as f32 * 1e-4;
        prop_assert!(covered <= expected + 1e-6);
        // Beside contacts of one pixel nothing is taken for ringing.
        if found.len() < MAX_CONTACTS && found.iter().all(|contact| contact.area < 1.5e-4) {
            prop_assert!((covered - expected).abs() < 1e-6);
        }
        for contact in &found {
            prop_assert!((0.0..=0.08).contains(&contact.position[0]));
            prop_assert!((0.0..=0.08).contains(&contact.position[1]));
            prop_assert!(contact.peak >= contact.strength);
        }
    }
}

/// The height of a hill of this radius, in pixels, at a distance from its top.
fn hill(distance: f64, radius: f64) -> f64 {
    (-(distance / radius).powi(2)).exp()
}

/// An image of 32 x 32 pixels of hills at column, row, height.
fn hills(tops: &[[f64; 3]], radius: f64) -> Vec<RelativeConductivity> {
    let at = |cell: usize| {
        let (column, row) = ((cell % 32) as f64, (cell / 32) as f64);
        tops.iter().map(|[x, y, height]| height * hill((x - column).hypot(y - row), radius)).sum()
    };
    (0..1024).map(|cell| RelativeConductivity::from_f64(at(cell))).collect()
}

#[test]
fn two_hills_that_have_grown_together_are_two_contacts_each_with_its_own_place() {
    let image = hills(&[[10.0, 16.0, 0.5], [18.0, 16.0, 0.4]], 4.0);
    let contacts = found(32, 32, &[0xFF; 128], &image);
    assert_eq!(contacts.len(), 2);
    for (contact, column) in contacts.iter().zip([10.0, 18.0]) {
        let [x, y, _] = contact.position.map(|part| f64::from(part) / 0.01);
        assert!((x - 0.5 - column).abs() < 0.6 && (y - 15.5).abs() < 0.01, "{x} {y}");
    }
}

#[test]
fn a_hill_with_a_shallow_saddle_is_one_contact() {
    let image = hills(&[[10.0, 16.0, 0.5], [17.0, 16.0, 0.45]], 4.5);
    assert_eq!(found(32, 32, &[0xFF; 128], &image).len(), 1);
}

/// Contacts of a hill of 0.5 and one pixel of this height so many columns beside its top. The hill's region
/// has a radius of 4.7 pixels, and is as large as a square of 8.3.
fn beside_a_hill(columns: usize, height: f64) -> usize {
    let mut image = hills(&[[10.0, 16.0, 0.5]], 4.0);
    image[16 * 32 + 10 + columns] = RelativeConductivity::from_f64(height);
    found(32, 32, &[0xFF; 128], &image).len()
}

#[test]
fn ringing_beside_a_strong_contact_is_none() {
    assert_eq!(beside_a_hill(7, 0.13), 1);
    assert_eq!(beside_a_hill(7, 0.36), 1);
}

#[test]
fn what_is_as_strong_or_farther_away_is_no_ringing() {
    assert_eq!(beside_a_hill(7, 0.38), 2);
    assert_eq!(beside_a_hill(9, 0.13), 2);
}

#[test]
fn a_plateau_is_one_contact() {
    let flat = [RelativeConductivity(500_000); 1024];
    let contacts = found(32, 32, &[0xFF; 128], &flat);
    assert_eq!(contacts.len(), 1);
    assert!((contacts[0].position[0] - 0.16).abs() < 1e-6 && (contacts[0].area - 0.1024).abs() < 1e-6);
}

#[test]
fn the_largest_values_there_are_overflow_no_sum() {
    let contacts = found(32, 32, &[0xFF; 128], &[RelativeConductivity(i32::MAX); 1024]);
    assert!((contacts[0].strength / 2048.0 - 1.0).abs() < 1e-3, "{}", contacts[0].strength);
    assert!((contacts[0].position[1] - 0.16).abs() < 1e-6);
}

/// Pixels on half a sphere of 0.1 m: rings of latitude, each pixel with its two neighbours in the ring and
/// the nearest two in the rings above and below.
fn sphere() -> Tables {
    const RINGS: usize = 20;
    const AROUND: usize = 40;
    let angles = |ring: usize, around: usize| {
        let tilt = (ring as f64 + 0.5) / RINGS as f64 * 1.5;
        (tilt, around as f64 / AROUND as f64 * std::f64::consts::TAU)
    };
    let (mut pixels, mut neighbours) = (Vec::new(), Vec::new());
    for ring in 0..RINGS {
        for around in 0..AROUND {
            let (tilt, turn) = angles(ring, around);
            let normal = [tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()];
            let in_ring = |ring: usize, by: usize| (ring * AROUND + (around + by) % AROUND) as u16;
            neighbours.extend([in_ring(ring, 1), in_ring(ring, AROUND - 1)]);
            if ring > 0 {
                neighbours.push(in_ring(ring - 1, 0));
            }
            if ring + 1 < RINGS {
                neighbours.push(in_ring(ring + 1, 0));
            }
            pixels.push(Pixel {
                centre: normal.map(|part| (part * 32_767.0).round() as i16),
                neighbours_end: neighbours.len() as u16,
                normal: normal.map(|part| (part * 127.0).round() as i8),
                area: (255.0 * tilt.sin()).ceil() as u8,
            });
        }
    }
    let scale = SurfaceScale { origin: [0.0; 3], step: 0.1 / 32_767.0, area: 1e-6 };
    Tables::new(scale, &pixels, &neighbours)
}

proptest! {
    #[test]
    fn a_contact_on_a_sphere_lies_on_the_sphere_where_its_hill_is(tilt in 0.3..1.2_f64, turn in 0.0..6.2_f64) {
        let sphere = sphere();
        let surface = sphere.view();
        let top = [tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()];
        let distance = |place: [f32; 3]| {
            let parts = place.iter().zip(top).map(|(part, top)| f64::from(*part) / 0.1 - top);
            parts.map(|part| part * part).sum::<f64>().sqrt()
        };
        let value = |pixel: Pixel| 0.5 * hill(distance(surface.centre(&pixel)), 0.25);
        let image: Vec<_> = surface.pixels().map(|p| RelativeConductivity::from_f64(value(p))).collect();
        let contacts = find(&surface, &image, LOW);
        prop_assert_eq!(contacts.len(), 1);
        let contact = &contacts[0];
        let radius = contact.position.iter().map(|part| part * part).sum::<f32>().sqrt();
        // The plane of a pixel leaves the sphere by at most (half a pixel)^2 / 2 R.
        prop_assert!((radius / 0.1 - 1.0).abs() < 4e-3, "{radius}");
        prop_assert!(distance(contact.position) < 0.03, "{}", distance(contact.position));
        let up: f64 = contact.normal.iter().zip(top).map(|(part, top)| f64::from(*part) * top).sum();
        prop_assert!(up > 0.995, "{up}");
    }
}
