//! Finding contacts as a board does: in the voltages or in the image.

use dermatome_model::{metrics::parts::parts, pixels::Pixels};
use dermatome_patch::tables::SurfaceTables;
use dermatome_shared::{
    contact::{self, Contact},
    units::RelativeConductivity,
};
use nalgebra::Point3;

/// What contacts are found in, and by what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoundBy {
    /// The voltages, by a board.
    Voltages,
    /// The image, by a board's code.
    Image,
    /// The f64 image, of more pixels than a board takes.
    F64Image,
}

/// A contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Where it is, m.
    pub centre: Point3<f64>,
    /// Area of its region of interest, m^2; none in the voltages, which do not tell it.
    pub area: Option<f64>,
    /// Its strength: relative conductivity change.
    pub strength: f64,
    /// How sure it is; none in the image.
    pub evidence: Option<Evidence>,
}

/// How sure a contact is by what the board says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Standard deviations above the noise.
    pub significance: f64,
    /// Standard deviation of its place, m.
    pub position_deviation: f64,
}

impl From<&Contact> for Found {
    fn from(contact: &Contact) -> Self {
        let evidence = contact.evidence.map(|evidence| Evidence {
            significance: evidence.significance.into(),
            position_deviation: evidence.position_deviation.into(),
        });
        Self {
            centre: Point3::from(contact.position.map(f64::from)),
            area: evidence.is_none().then(|| contact.area.into()),
            strength: contact.strength.into(),
            evidence,
        }
    }
}

/// Finds them in images: as a board does where its pixels fit a board, else in f64.
#[derive(Debug)]
pub(super) struct ImageFinder<'a> {
    pixels: &'a Pixels,
    board: Option<SurfaceTables>,
    threshold: f64,
}

impl<'a> ImageFinder<'a> {
    /// `threshold` is the smallest relative conductivity change that counts.
    #[must_use]
    pub(super) fn new(pixels: &'a Pixels, threshold: f64) -> Self {
        Self { pixels, board: pixels.surface_tables(), threshold }
    }

    /// By what it finds them.
    #[must_use]
    pub(super) fn found_by(&self) -> FoundBy {
        if self.board.is_some() { FoundBy::Image } else { FoundBy::F64Image }
    }

    /// The contacts, strongest first; the image's press is positive.
    #[must_use]
    pub(super) fn contacts(&self, image: &[f64]) -> Vec<Found> {
        match &self.board {
            Some(tables) => as_board(tables, image, self.threshold),
            None => self.in_f64(image),
        }
    }

    fn in_f64(&self, image: &[f64]) -> Vec<Found> {
        let parts = parts(image, self.pixels, self.threshold).into_iter();
        parts
            .map(|part| Found {
                centre: part.centre,
                area: Some(part.area),
                strength: part.strength,
                evidence: None,
            })
            .collect()
    }
}

/// The board's own code, on the image rounded to its fixed point.
fn as_board(tables: &SurfaceTables, image: &[f64], threshold: f64) -> Vec<Found> {
    let codes: Vec<_> = image.iter().map(|&value| RelativeConductivity::from_f64(value)).collect();
    let threshold = RelativeConductivity::from_f64(threshold);
    contact::find(&tables.view(), &codes, threshold).iter().map(Found::from).collect()
}
