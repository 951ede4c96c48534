//! Finding contacts in an image: as the board does where there is a board's grid, else in f64.

use crate::{metrics::parts::parts, pixels::Pixels};
use dermatome_shared::{MAX_PIXELS, contact, image::Geometry, units::RelativeConductivity};
use nalgebra::Point3;

/// Finds the contacts in images of one skin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finder<'a> {
    pixels: &'a Pixels,
    board: Option<&'a Geometry>,
    threshold: f64,
}

impl<'a> Finder<'a> {
    /// `threshold` is the smallest relative conductivity change that counts.
    #[must_use]
    pub(super) fn new(pixels: &'a Pixels, threshold: f64) -> Self {
        let board = pixels.grid.as_ref().filter(|_| pixels.count() <= MAX_PIXELS);
        Self { pixels, board, threshold }
    }

    /// Whether contacts are found the board's way.
    #[must_use]
    pub(super) fn is_board(&self) -> bool {
        self.board.is_some()
    }

    /// Centres of the contacts, m, strongest first; the image's press is positive.
    #[must_use]
    pub(super) fn contacts(&self, image: &[f64]) -> Vec<Point3<f64>> {
        match self.board {
            Some(geometry) => on_grid(geometry, image, self.threshold),
            None => parts(image, self.pixels, self.threshold).iter().map(|part| part.centre).collect(),
        }
    }
}

/// The board's own code, on the image rounded to its fixed point.
fn on_grid(geometry: &Geometry, image: &[f64], threshold: f64) -> Vec<Point3<f64>> {
    let codes: Vec<_> = image.iter().map(|&value| RelativeConductivity::from_f64(value)).collect();
    let threshold = RelativeConductivity::from_f64(threshold);
    let contacts = contact::find(&geometry.grid, &geometry.mask, &codes, threshold);
    let centre = |contact: &contact::Contact| {
        let [x, y] = contact.position.map(f64::from);
        Point3::new(x, y, 0.0)
    };
    contacts.iter().map(centre).collect()
}
