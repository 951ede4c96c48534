//! Places: where a patch looks for presses, in owned form.

use crate::matrix::{in_groups, mantissas};
use dermatome_shared::patch::{
    PatchView,
    places::{DetectionLayout, Place, PlacesTables},
};

/// The parts of [`PlacesTables`], owned; empty if contacts are found in the image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FixedPlaces {
    layout: DetectionLayout,
    places: Vec<Place>,
    column_exponents: Vec<i8>,
    row_exponents: Vec<i8>,
    mantissas: Vec<i16>,
}

impl FixedPlaces {
    /// Places, and the responses to a press there and then to the layout's known changes: `mantissas`
    /// `[row][measurement]`. The layout's count of places is set.
    ///
    /// # Panics
    /// Panics if there is not a row for each place and change, or not a mantissa for each row and column.
    #[must_use]
    pub fn new(
        layout: DetectionLayout,
        places: Vec<Place>,
        column_exponents: Vec<i8>,
        row_exponents: Vec<i8>,
        mantissas: &[i16],
    ) -> Self {
        let columns = column_exponents.len();
        assert_eq!(mantissas.len(), row_exponents.len() * columns, "a mantissa for each row and column");
        let known = usize::from(layout.smooth) + usize::from(layout.slips);
        assert_eq!(row_exponents.len(), places.len() + known, "a row for each place and change");
        let layout = DetectionLayout { places: places.len() as u16, ..layout };
        Self { layout, mantissas: in_groups(mantissas, columns), places, column_exponents, row_exponents }
    }

    /// Those of a patch.
    #[must_use]
    pub fn read(patch: &PatchView<'_>) -> Self {
        let places = patch.places();
        Self {
            layout: patch.header.detection,
            places: places.iter().collect(),
            column_exponents: places.column_exponents().collect(),
            row_exponents: places.row_exponents().collect(),
            mantissas: mantissas(places.mantissas()),
        }
    }

    /// How many there are, and how presses are looked for.
    #[must_use]
    pub fn layout(&self) -> DetectionLayout {
        self.layout
    }

    /// For writing a patch.
    #[must_use]
    pub fn tables(&self) -> PlacesTables<'_> {
        PlacesTables {
            places: &self.places,
            column_exponents: &self.column_exponents,
            row_exponents: &self.row_exponents,
            mantissas: &self.mantissas,
        }
    }
}
