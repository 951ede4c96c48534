//! Places: where a patch looks for presses, in owned form.

use crate::matrix::{in_groups, indices, mantissas, scale_row};
use dermatome_shared::patch::{
    PatchView,
    places::{DetectionLayout, Place, PlacesTables},
};

/// Mantissas that are scaled alike differ by no more than this from each other, by rounding.
const ROUNDING: f64 = 2.0;

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

    /// The same where a press changes the measurements by these factors more: `[place]`. A board takes it for as much less.
    ///
    /// # Panics
    /// Panics if there is not a gain above zero for each place.
    #[must_use]
    pub fn with_gains(mut self, gains: &[f64]) -> Self {
        assert_eq!(gains.len(), self.places.len(), "a gain for each place");
        let columns = self.column_exponents.len();
        for (row, &gain) in gains.iter().enumerate() {
            scale_row(&mut self.mantissas, &mut self.row_exponents[row], columns, row, gain);
        }
        self
    }

    /// Whether these are the same places as others, but for a gain of each.
    #[must_use]
    pub fn differ_by_gains(&self, others: &Self) -> bool {
        let count = self.places.len();
        self.places == others.places
            && self.column_exponents == others.column_exponents
            && self.row_exponents.len() == others.row_exponents.len()
            && self.row_exponents[count..] == others.row_exponents[count..]
            && (0..count).all(|row| self.is_multiple(others, row))
            && (count..self.row_exponents.len()).all(|row| self.row(row).eq(others.row(row)))
    }

    /// With the places and responses of others, and its own way to look for presses.
    #[must_use]
    pub fn with_responses_of(&self, others: Self) -> Self {
        Self { layout: DetectionLayout { places: others.layout.places, ..self.layout }, ..others }
    }

    /// Whether a row is a multiple of the other's, but for rounding.
    fn is_multiple(&self, others: &Self, row: usize) -> bool {
        let pairs = || self.row(row).map(f64::from).zip(others.row(row).map(f64::from));
        let (product, square) =
            pairs().fold((0.0, 0.0), |(product, square), (a, b)| (product + a * b, square + b * b));
        let factor = if square > 0.0 { product / square } else { 0.0 };
        factor > 0.0 && pairs().all(|(a, b)| (a - factor * b).abs() <= ROUNDING * factor.max(1.0))
    }

    /// Mantissas of a row: `[measurement]`.
    fn row(&self, row: usize) -> impl Iterator<Item = i16> + '_ {
        indices(self.column_exponents.len(), row).map(|index| self.mantissas[index])
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

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: [[i16; 6]; 4] = [
        [32_000, -20_000, 3, 0, 17_000, 1],
        [-16_500, 400, -9, 5, 0, 12_345],
        [20_000, 30_000, 25_000, -1, 7, 9],
        [100, 200, 32_767, 1, 2, 3],
    ];

    /// Three places and a smooth change.
    fn places(rows: [[i16; 6]; 4]) -> FixedPlaces {
        let layout = DetectionLayout { smooth: 1, level: 5.0, ..DetectionLayout::default() };
        let place = |pixel| Place { pixel, neighbours: [0; 6], shares: [[0; 5]; 7] };
        FixedPlaces::new(
            layout,
            vec![place(4), place(2), place(9)],
            vec![0; 6],
            vec![3, -2, 0, 1],
            rows.as_flattened(),
        )
    }

    fn value(places: &FixedPlaces, row: usize, column: usize) -> f64 {
        let mantissa = places.row(row).nth(column).unwrap();
        f64::from(mantissa) * (-f64::from(places.row_exponents[row])).exp2()
    }

    #[test]
    fn rows_are_scaled_to_half_a_step_and_known_changes_stay() {
        let plain = places(ROWS);
        for gains in [[1.0; 3], [1.3, 0.7, 1.02], [4.0, 0.25, 0.5]] {
            let scaled = plain.clone().with_gains(&gains);
            for (row, gain) in gains.into_iter().chain([1.0]).enumerate() {
                let step = (-f64::from(scaled.row_exponents[row])).exp2();
                let largest = scaled.row(row).map(i16::unsigned_abs).max().unwrap();
                assert!((16_384..=32_767).contains(&largest), "{largest}");
                for column in 0..6 {
                    let off = value(&scaled, row, column) - gain * value(&plain, row, column);
                    assert!(off.abs() <= 0.5 * step, "{gains:?} {row} {column}: {off}");
                }
            }
            assert!(scaled.differ_by_gains(&plain) && plain.differ_by_gains(&scaled));
        }
        assert_eq!(plain.clone().with_gains(&[1.0; 3]), plain);
    }

    #[test]
    fn other_places_and_other_responses_differ_by_more_than_gains() {
        let plain = places(ROWS);
        let mut other = ROWS;
        other[1][5] += 40;
        assert!(!places(other).differ_by_gains(&plain));
        let mut other = ROWS;
        other[3][0] += 1;
        assert!(!places(other).differ_by_gains(&plain));
        let moved = FixedPlaces { places: plain.places.iter().rev().copied().collect(), ..plain.clone() };
        assert!(!moved.differ_by_gains(&plain));
        let turned = ROWS.map(|row| row.map(|mantissa| -mantissa));
        assert!(!places(turned).differ_by_gains(&plain));
    }

    #[test]
    fn gains_of_others_come_with_their_own_level() {
        let plain = places(ROWS);
        let mut later = plain.clone();
        later.layout.level = 6.0;
        let scaled = plain.with_gains(&[1.5, 1.0, 0.8]);
        let with = later.with_responses_of(scaled.clone());
        assert!((with.layout.level - 6.0).abs() < 1e-6);
        assert_eq!(FixedPlaces { layout: scaled.layout, ..with }, scaled);
    }
}
