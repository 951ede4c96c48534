//! Places: where readings were taken, which of them are one place, and whether that is on the skin.

use super::{Reading, loading::UNLOADED};
use dermatome_shared::patch::PatchView;
use nalgebra::{Point3, Vector3};

/// Readings closer than this share of the skin's size are at one place.
const SAME_PLACE: f64 = 0.045;
/// A place may lie this many pixel widths from the nearest pixel's centre.
const REACH: f64 = 1.5;
/// Loads below this share of the largest one do not say where they press.
const LEAST_LOAD: f64 = 0.1;

/// A place that is not on the skin.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "reading {reading} (counted from 1) is at x = {:.1} mm, y = {:.1} mm, {away_mm:.0} mm from the skin; allowed: places on it, in \
     its own frame, x from {:.1} to {:.1} mm, y from {:.1} to {:.1} mm",
    at_mm[0], at_mm[1], x_mm[0], x_mm[1], y_mm[0], y_mm[1]
)]
pub struct OffSkin {
    /// Which reading.
    pub reading: usize,
    /// Where it is said to be.
    pub at_mm: [f64; 2],
    /// How far that is from the skin.
    pub away_mm: f64,
    /// Where the skin lies.
    pub x_mm: [f64; 2],
    /// Where the skin lies.
    pub y_mm: [f64; 2],
}

/// Centres of a patch's pixels, m.
pub(super) fn centres(patch: &PatchView<'_>) -> Vec<Point3<f64>> {
    let surface = patch.surface();
    surface.pixels().map(|pixel| Point3::from(surface.centre(&pixel).map(f64::from))).collect()
}

/// Largest extent along an axis, m.
pub(super) fn size(centres: &[Point3<f64>]) -> f64 {
    (0..3).map(|axis| extent(centres, axis)).map(|[low, high]| high - low).fold(0.0, f64::max)
}

fn extent(centres: &[Point3<f64>], axis: usize) -> [f64; 2] {
    let along = || centres.iter().map(|centre| centre[axis]);
    [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
}

/// The readings with the same place wherever they are at one, and none where there is no load; what presses hardly goes
/// with what presses hard before or after it.
pub fn at_places(readings: &[Reading], patch: &PatchView<'_>) -> Result<Vec<Reading>, OffSkin> {
    if readings.iter().all(|reading| reading.place.is_none()) {
        return Ok(readings.to_vec());
    }
    let skin = Skin::new(patch);
    let largest = readings.iter().fold(0.0, |most: f64, reading| most.max(reading.pressure_kpa));
    let lay = |(number, reading): (usize, &Reading)| {
        let place = reading.place.map(|place| skin.lay(number, place)).transpose()?;
        Ok(place.filter(|_| reading.pressure_kpa >= LEAST_LOAD * largest))
    };
    let laid: Vec<_> = readings.iter().enumerate().map(lay).collect::<Result<_, _>>()?;
    let places = grouped(&laid, SAME_PLACE * size(&skin.centres));
    let is_loaded = |number: &usize| readings[*number].pressure_kpa > UNLOADED * largest;
    let place = |number: usize| {
        let before = (0..=number).rev().take_while(is_loaded);
        let after = (number..readings.len()).take_while(is_loaded);
        before.chain(after).find_map(|other| places[other])
    };
    let numbers = 0..readings.len();
    Ok(numbers.map(|number| Reading { place: place(number), ..readings[number] }).collect())
}

/// Places within a reach from the first of them, m, become their mean.
fn grouped(places: &[Option<Point3<f64>>], reach: f64) -> Vec<Option<[f64; 3]>> {
    let mut groups: Vec<Vec<Point3<f64>>> = Vec::new();
    let mut group_of = |place: Point3<f64>| {
        let near = groups.iter().position(|group| (group[0] - place).norm() <= reach);
        let group = near.unwrap_or(groups.len());
        match groups.get_mut(group) {
            Some(group) => group.push(place),
            None => groups.push(vec![place]),
        }
        group
    };
    let of_places: Vec<Option<usize>> = places.iter().map(|place| place.map(&mut group_of)).collect();
    let mean = |group: &Vec<Point3<f64>>| {
        let sum = group.iter().fold(Vector3::zeros(), |sum, place| sum + place.coords);
        <[f64; 3]>::from(sum / group.len() as f64)
    };
    let means: Vec<[f64; 3]> = groups.iter().map(mean).collect();
    of_places.into_iter().map(|group| group.map(|group| means[group])).collect()
}

/// Where a place can be.
struct Skin {
    centres: Vec<Point3<f64>>,
    /// Width of a pixel, m: `[pixel]`.
    widths: Vec<f64>,
    /// Whether it is seen from above: `[pixel]`.
    is_seen: Vec<bool>,
}

impl Skin {
    fn new(patch: &PatchView<'_>) -> Self {
        let surface = patch.surface();
        Self {
            centres: centres(patch),
            widths: surface.pixels().map(|pixel| f64::from(surface.area(&pixel)).sqrt()).collect(),
            is_seen: surface.pixels().map(|pixel| surface.normal(&pixel)[2] >= 0.0).collect(),
        }
    }

    /// A place on it; z that is not a number is that of the skin as seen from above.
    fn lay(&self, number: usize, place: [f64; 3]) -> Result<Point3<f64>, OffSkin> {
        let [x, y, z] = place;
        let away = |pixel: usize| {
            let centre = &self.centres[pixel];
            let flat = (centre.x - x).hypot(centre.y - y);
            if z.is_nan() { flat } else { flat.hypot(centre.z - z) }
        };
        let pixels = (0..self.centres.len()).filter(|&pixel| !z.is_nan() || self.is_seen[pixel]);
        let nearest = pixels.min_by(|&a, &b| away(a).total_cmp(&away(b)));
        let off = |away: f64| OffSkin {
            reading: number + 1,
            at_mm: [1e3 * x, 1e3 * y],
            away_mm: 1e3 * away,
            x_mm: extent(&self.centres, 0).map(|end| 1e3 * end),
            y_mm: extent(&self.centres, 1).map(|end| 1e3 * end),
        };
        let pixel = nearest.ok_or_else(|| off(f64::INFINITY))?;
        if away(pixel) > REACH * self.widths[pixel] {
            return Err(off(away(pixel)));
        }
        Ok(Point3::new(x, y, if z.is_nan() { self.centres[pixel].z } else { z }))
    }
}
