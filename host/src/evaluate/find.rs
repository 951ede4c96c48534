//! Finding contacts in an image: as the board does where its pixels fit a board, else in f64.

use crate::{
    metrics::parts::parts,
    pixels::{Pixels, SurfaceTables},
};
use dermatome_shared::{contact, units::RelativeConductivity};
use nalgebra::Point3;

/// Finds the contacts in images of one skin.
#[derive(Clone, Debug)]
pub(super) struct Finder<'a> {
    pixels: &'a Pixels,
    board: Option<SurfaceTables>,
    threshold: f64,
}

impl<'a> Finder<'a> {
    /// `threshold` is the smallest relative conductivity change that counts.
    #[must_use]
    pub(super) fn new(pixels: &'a Pixels, threshold: f64) -> Self {
        Self { pixels, board: SurfaceTables::new(pixels), threshold }
    }

    /// Whether contacts are found the board's way.
    #[must_use]
    pub(super) fn is_board(&self) -> bool {
        self.board.is_some()
    }

    /// Centres of the contacts, m, strongest first; the image's press is positive.
    #[must_use]
    pub(super) fn contacts(&self, image: &[f64]) -> Vec<Point3<f64>> {
        match &self.board {
            Some(tables) => as_board(tables, image, self.threshold),
            None => parts(image, self.pixels, self.threshold).iter().map(|part| part.centre).collect(),
        }
    }
}

/// The board's own code, on the image rounded to its fixed point.
fn as_board(tables: &SurfaceTables, image: &[f64], threshold: f64) -> Vec<Point3<f64>> {
    let codes: Vec<_> = image.iter().map(|&value| RelativeConductivity::from_f64(value)).collect();
    let threshold = RelativeConductivity::from_f64(threshold);
    let contacts = contact::find(&tables.view(), &codes, threshold);
    contacts.iter().map(|contact| Point3::from(contact.position.map(f64::from))).collect()
}
