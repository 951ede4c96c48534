//! Parts: the contacts in an image on any pixels, in f64.
//!
//! What [`dermatome_shared::contact`] does on a board's grid, for images without one.

use super::{on_surface, thesis::region};
use crate::pixels::Pixels;
use dermatome_geometry::mesh::neighbours::Adjacency;
use nalgebra::{Point3, Vector3};

/// A connected part of the region of interest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Mean of pixel centres, weighted by conductivity change, m.
    pub centre: Point3<f64>,
    /// Area, m^2.
    pub area: f64,
    /// Mean relative conductivity change.
    pub strength: f64,
    /// Largest relative conductivity change.
    pub peak: f64,
}

/// Connected parts of the region of interest whose peak reaches `threshold`, strongest first.
#[must_use]
pub fn parts(image: &[f64], pixels: &Pixels, threshold: f64) -> Vec<Part> {
    let Some(mut waiting) = region(image) else { return Vec::new() };
    let pairs = pixels.neighbours.iter().map(|&pair| (pair, ()));
    let adjacent = Adjacency::new(pixels.count(), pairs, ());
    let mut parts = Vec::new();
    for first in 0..waiting.len() {
        if waiting[first] {
            let members = connected(first, &mut waiting, &adjacent);
            parts.push(Part::new(&members, image, pixels));
        }
    }
    parts.retain(|part| part.peak >= threshold);
    parts.sort_by(|a, b| b.peak.total_cmp(&a.peak));
    parts
}

/// Takes all pixels connected with `first` out of `waiting`.
fn connected(first: usize, waiting: &mut [bool], adjacent: &Adjacency<()>) -> Vec<usize> {
    waiting[first] = false;
    let mut members = vec![first];
    let mut next = 0;
    while let Some(&pixel) = members.get(next) {
        next += 1;
        for (other, ()) in adjacent.of(pixel) {
            if std::mem::replace(&mut waiting[other], false) {
                members.push(other);
            }
        }
    }
    members
}

impl Part {
    fn new(members: &[usize], image: &[f64], pixels: &Pixels) -> Self {
        let (mut sum, mut weight, mut area, mut peak) = (Vector3::zeros(), 0.0, 0.0, 0.0_f64);
        for &pixel in members {
            let change = pixels.areas[pixel] * image[pixel];
            sum += pixels.centres[pixel].coords * change;
            weight += change;
            area += pixels.areas[pixel];
            peak = peak.max(image[pixel]);
        }
        Self { centre: on_surface(pixels, Point3::from(sum / weight)), area, strength: weight / area, peak }
    }
}
