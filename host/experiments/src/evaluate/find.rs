//! Finding contacts in an image: as the board does where its pixels fit a board, else in f64.

use dermatome_model::{metrics::parts::parts, pixels::Pixels};
use dermatome_patch::tables::SurfaceTables;
use dermatome_shared::{
    contact::{self, Contact},
    units::RelativeConductivity,
};
use nalgebra::Point3;

/// A contact in an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// Centre, m.
    pub(super) centre: Point3<f64>,
    /// Area of its region of interest, m^2.
    pub(super) area: f64,
}

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
        Self { pixels, board: pixels.surface_tables(), threshold }
    }

    /// Whether contacts are found the board's way.
    #[must_use]
    pub(super) fn is_board(&self) -> bool {
        self.board.is_some()
    }

    /// The contacts, strongest first; the image's press is positive.
    #[must_use]
    pub(super) fn contacts(&self, image: &[f64]) -> Vec<Found> {
        let parts = || parts(image, self.pixels, self.threshold);
        match &self.board {
            Some(tables) => as_board(tables, image, self.threshold),
            None => parts().iter().map(|part| Found { centre: part.centre, area: part.area }).collect(),
        }
    }
}

/// The board's own code, on the image rounded to its fixed point.
fn as_board(tables: &SurfaceTables, image: &[f64], threshold: f64) -> Vec<Found> {
    let codes: Vec<_> = image.iter().map(|&value| RelativeConductivity::from_f64(value)).collect();
    let threshold = RelativeConductivity::from_f64(threshold);
    let contacts = contact::find(&tables.view(), &codes, threshold);
    let found = |contact: &Contact| Found {
        centre: Point3::from(contact.position.map(f64::from)),
        area: f64::from(contact.area),
    };
    contacts.iter().map(found).collect()
}
