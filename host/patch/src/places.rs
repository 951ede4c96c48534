//! Places: where a patch looks for presses, in owned form.

use crate::matrix::in_groups;
use dermatome_shared::patch::places::{Place, Places, PlacesTables};

/// The parts of [`PlacesTables`], owned; empty if contacts are found in the image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FixedPlaces {
    places: Vec<Place>,
    column_exponents: Vec<i8>,
    row_exponents: Vec<i8>,
    mantissas: Vec<i16>,
}

impl FixedPlaces {
    /// Places and the responses to a press there: `mantissas` `[place][measurement]`.
    ///
    /// # Panics
    /// Panics if there is not a mantissa for each row and column.
    #[must_use]
    pub fn new(
        places: Vec<Place>,
        column_exponents: Vec<i8>,
        row_exponents: Vec<i8>,
        mantissas: &[i16],
    ) -> Self {
        let columns = column_exponents.len();
        assert_eq!(mantissas.len(), places.len() * columns, "a mantissa for each row and column");
        Self { mantissas: in_groups(mantissas, columns), places, column_exponents, row_exponents }
    }

    /// Those of a patch.
    #[must_use]
    pub fn read(places: &Places<'_>) -> Self {
        let mantissas = places.mantissas().chunks_exact(2);
        Self {
            places: places.iter().collect(),
            column_exponents: places.column_exponents().collect(),
            row_exponents: places.row_exponents().collect(),
            mantissas: mantissas.map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect(),
        }
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
