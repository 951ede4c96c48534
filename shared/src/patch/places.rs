//! Places where a press is looked for, and how the measurements respond to one there.
//!
//! A place is a pixel. The response to a standard press on it (of the header's radius, changing the conductivity by its own
//! size) is a row `[measurement]`, in the patch's kind of difference data. Rows and columns have exponents and lie as
//! those of the reconstruction matrix do.

use super::{
    PatchError,
    matrix::{COLUMN_EXPONENTS, GROUP, Rows, coefficient_index},
};
use crate::limits::MAX_ELECTRODES;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most places: their numbers are bytes.
pub const MAX_PLACES: usize = 256;
/// Places that each place has for neighbours.
pub const PLACE_NEIGHBOURS: usize = 6;
/// Rows that the response round a place is made of: its own, and those of its neighbours.
pub const PLACE_ROWS: usize = 1 + PLACE_NEIGHBOURS;
/// How a row's share in that grows with the offset (x, y) from the place, in mean distances of its neighbours: with x, y,
/// x²/2, xy and y²/2. x goes towards the first neighbour, square to the pixel's normal, and y is square to both.
pub const SHARE_TERMS: usize = 5;
/// What shares are counted in.
pub const SHARE_UNIT: f32 = 1.0 / 32.0;
/// Most smooth changes.
pub const MAX_SMOOTH: usize = 8;
/// Most changes that are known to be no press: smooth ones, and the slip of each electrode.
pub const MAX_KNOWN: usize = MAX_SMOOTH + MAX_ELECTRODES;

/// Bytes of a place: its pixel, its neighbours and shares.
const PLACE_BYTES: usize = 2 + PLACE_NEIGHBOURS + PLACE_ROWS * SHARE_TERMS;

/// How presses are looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct DetectionLayout {
    /// Number of places; 0 finds contacts in the image.
    pub places: u16,
    /// Significance from which a press is a contact, standard deviations.
    pub level: f32,
    /// Radius of the standard press, m.
    pub radius: f32,
    /// Smooth changes of the sheet that a press is told from, of no place, in rows behind those of the places.
    pub smooth: u8,
    /// Electrodes whose slip along the rim a press is told from, or ways that a skin with others may be stretched, in rows
    /// behind those.
    pub slips: u8,
    /// Time over which still frames are averaged, s; 0 takes each for itself.
    pub averaging: f32,
}

impl DetectionLayout {
    /// Bytes that it takes in a patch of so many measurements.
    #[must_use]
    pub fn bytes(&self, measurements: u16) -> usize {
        self.sizes(measurements).iter().sum()
    }

    /// Bytes of places, exponents of the columns and of the rows, and mantissas.
    pub(super) fn sizes(&self, measurements: u16) -> [usize; 4] {
        let (places, columns) = (usize::from(self.places), usize::from(measurements));
        if places == 0 {
            return [0; 4];
        }
        let rows = places + usize::from(self.smooth) + usize::from(self.slips);
        let mantissas = rows.next_multiple_of(GROUP) * columns.next_multiple_of(GROUP);
        [PLACE_BYTES * places, columns, rows, 2 * mantissas]
    }
}

/// One place, for writing a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The pixel that it is.
    pub pixel: u16,
    /// The places round it.
    pub neighbours: [u8; PLACE_NEIGHBOURS],
    /// What the response round it has of its own row and of theirs, [`SHARE_UNIT`]s: `[row][term]`. At the place it is its own
    /// row.
    pub shares: [[i8; SHARE_TERMS]; PLACE_ROWS],
}

impl Place {
    fn to_bytes(self) -> [u8; PLACE_BYTES] {
        let mut bytes = [0; PLACE_BYTES];
        let shares = self.shares.as_flattened().iter().map(|share| *share as u8);
        let all = self.pixel.to_le_bytes().into_iter().chain(self.neighbours).chain(shares);
        bytes.iter_mut().zip(all).for_each(|(byte, value)| *byte = value);
        bytes
    }

    fn from_bytes(bytes: &[u8; PLACE_BYTES]) -> Self {
        let [p0, p1, a, b, c, d, e, f, shares @ ..] = *bytes;
        let share = |row: usize, term: usize| shares[SHARE_TERMS * row + term] as i8;
        Self {
            pixel: u16::from_le_bytes([p0, p1]),
            neighbours: [a, b, c, d, e, f],
            shares: core::array::from_fn(|row| core::array::from_fn(|term| share(row, term))),
        }
    }
}

/// The parts of the places, for writing a patch.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlacesTables<'a> {
    /// The places.
    pub places: &'a [Place],
    /// Exponents of the columns: `[measurement]`.
    pub column_exponents: &'a [i8],
    /// Exponents of the rows: `[place]`, then `[smooth change]` and `[slip]`.
    pub row_exponents: &'a [i8],
    /// Mantissas, see [`coefficient_index`].
    pub mantissas: &'a [i16],
}

impl PlacesTables<'_> {
    /// Puts all but the mantissas behind each other.
    pub(super) fn put(&self, mut put: impl FnMut(&[u8]) -> Option<()>) -> Option<()> {
        self.places.iter().try_for_each(|place| put(&place.to_bytes()))?;
        let exponents = self.column_exponents.iter().chain(self.row_exponents);
        exponents.copied().try_for_each(|exponent| put(&exponent.to_le_bytes()))
    }
}

/// Four columns of a row: two pairs, each beside those of the other rows of its group.
#[inline(always)]
fn mantissas(row: &[u8], four: usize) -> [i16; GROUP] {
    let at = four * 8 * GROUP;
    match row.get(at..at + 20).and_then(<[u8]>::first_chunk::<20>) {
        Some(&[a, b, c, d, .., e, f, g, h]) => [[a, b], [c, d], [e, f], [g, h]].map(i16::from_le_bytes),
        None => [0; GROUP],
    }
}

/// The places of a patch, read in place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Places<'a> {
    places: &'a [[u8; PLACE_BYTES]],
    column_exponents: &'a [u8],
    row_exponents: &'a [u8],
    mantissas: &'a [u8],
}

impl<'a> Places<'a> {
    /// Of these tables, as [`DetectionLayout::sizes`] has them.
    pub(super) fn new([places, column_exponents, row_exponents, mantissas]: [&'a [u8]; 4]) -> Self {
        Self { places: places.as_chunks().0, column_exponents, row_exponents, mantissas }
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// A place.
    #[must_use]
    pub fn get(&self, place: usize) -> Option<Place> {
        self.places.get(place).map(Place::from_bytes)
    }

    /// The places round one.
    #[must_use]
    pub fn neighbours(&self, place: usize) -> [u8; PLACE_NEIGHBOURS] {
        self.get(place).map_or([0; PLACE_NEIGHBOURS], |place| place.neighbours)
    }

    /// The places whose rows the response round one is made of, with what each has of it by term, [`SHARE_UNIT`]s, see
    /// [`SHARE_TERMS`].
    pub fn rows_round(&self, place: usize) -> impl Iterator<Item = (usize, [i32; SHARE_TERMS])> + use<'a> {
        self.places.get(place).into_iter().flat_map(move |[_, _, rest @ ..]| {
            let (neighbours, shares) = rest.split_at(PLACE_NEIGHBOURS);
            let rows = core::iter::once(place).chain(neighbours.iter().map(|&place| place.into()));
            let shares = shares.as_chunks().0.iter();
            rows.zip(shares.map(|terms: &[u8; SHARE_TERMS]| terms.map(|byte| i32::from(byte as i8))))
        })
    }

    /// All places.
    pub fn iter(&self) -> impl Iterator<Item = Place> + use<'a> {
        self.places.iter().map(Place::from_bytes)
    }

    /// Exponents of the columns: `[measurement]`.
    pub fn column_exponents(&self) -> impl Iterator<Item = i8> + Clone + use<'a> {
        self.column_exponents.iter().map(|&byte| byte as i8)
    }

    /// Exponents of the rows: `[place]`, then `[smooth change]` and `[slip]`.
    pub fn row_exponents(&self) -> impl Iterator<Item = i8> + Clone + use<'a> {
        self.row_exponents.iter().map(|&byte| byte as i8)
    }

    /// Exponent of a row.
    #[must_use]
    pub fn row_exponent(&self, place: usize) -> i8 {
        self.row_exponents.get(place).map_or(0, |&byte| byte as i8)
    }

    /// The mantissas, little-endian i16.
    #[must_use]
    pub fn mantissas(&self) -> &'a [u8] {
        self.mantissas
    }

    /// How many rows there are behind those of the places: the responses to changes that are no press, smooth ones and
    /// then slips.
    #[must_use]
    pub fn known(&self) -> usize {
        self.row_exponents.len() - self.count()
    }

    /// The responses, of places and then of known changes, as rows that meet data.
    #[must_use]
    pub fn rows(&self) -> Rows<'a> {
        Rows {
            count: self.row_exponents.len(),
            inputs: &[],
            columns: self.columns(),
            mantissas: self.mantissas,
        }
    }

    /// The response at a place, for [`Self::four`].
    #[must_use]
    pub fn row(&self, place: usize) -> &'a [u8] {
        self.mantissas.get(2 * coefficient_index(self.columns(), place, 0)..).unwrap_or_default()
    }

    /// Four columns of a row, the first of them `4 * four`; an entry is `mantissa * 2^-(exponents of both)`.
    #[inline(always)]
    #[must_use]
    pub fn four(row: &[u8], four: usize) -> [f32; GROUP] {
        mantissas(row, four).map(f32::from)
    }

    /// The exact sum of a row's mantissas of four columns, the first of them `4 * four`, times codes.
    #[inline(always)]
    #[must_use]
    pub fn product(row: &[u8], four: usize, codes: &[i16; GROUP]) -> i64 {
        let products = mantissas(row, four).into_iter().zip(codes);
        products.fold(0, |sum, (mantissa, &code)| sum + i64::from(i32::from(mantissa) * i32::from(code)))
    }

    fn columns(&self) -> usize {
        self.column_exponents.len().next_multiple_of(GROUP)
    }

    /// Checks that all places are pixels, with neighbours that are places.
    pub(super) fn check(&self, layout: &DetectionLayout, pixels: u16) -> Result<(), PatchError> {
        if self.places.is_empty() {
            return Ok(());
        }
        let is_positive = |value: f32| value.is_finite() && value > 0.0;
        for (field, value) in [("detection.level", layout.level), ("detection.radius", layout.radius)] {
            if !is_positive(value) {
                return Err(PatchError::NotPositive { field });
            }
        }
        if !layout.averaging.is_finite() || layout.averaging < 0.0 {
            return Err(PatchError::NotPositive { field: "detection.averaging" });
        }
        if let Some(measurement) =
            self.column_exponents().position(|exponent| !COLUMN_EXPONENTS.contains(&exponent))
        {
            return Err(PatchError::ColumnExponent { measurement });
        }
        let is_wrong = |place: Place| {
            place.pixel >= pixels || place.neighbours.iter().any(|&other| usize::from(other) >= self.count())
        };
        match self.iter().position(is_wrong) {
            Some(place) => Err(PatchError::Place { place }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    const LAYOUT: DetectionLayout =
        DetectionLayout { places: 2, level: 5.0, radius: 0.01, smooth: 0, slips: 0, averaging: 0.0 };

    const SHARES: [[i8; SHARE_TERMS]; PLACE_ROWS] = {
        let mut shares = [[0; SHARE_TERMS]; PLACE_ROWS];
        shares[0] = [-32, 1, 2, 3, 4];
        shares[6][4] = 127;
        shares
    };

    fn tables(pixel: u16, neighbour: u8) -> Vec<u8> {
        let place = |pixel, neighbour| Place { pixel, neighbours: [neighbour; 6], shares: SHARES };
        let places = [place(3, 1), place(pixel, neighbour)];
        places.iter().flat_map(|place| place.to_bytes()).collect()
    }

    #[test]
    fn a_place_that_is_no_pixel_or_has_no_such_neighbour_is_refused() {
        for (pixel, neighbour, refused) in [(2, 0, false), (9, 0, true), (2, 2, true)] {
            let bytes = tables(pixel, neighbour);
            let places = Places::new([&bytes, &[0; 3], &[0; 2], &[0; 32]]);
            let found = places.check(&LAYOUT, 9);
            assert_eq!(found, if refused { Err(PatchError::Place { place: 1 }) } else { Ok(()) });
        }
    }

    #[test]
    fn shares_are_read_as_they_were_written() {
        let bytes = tables(2, 0);
        let places = Places::new([&bytes, &[0; 3], &[0; 2], &[0; 32]]);
        assert_eq!(places.get(1), Some(Place { pixel: 2, neighbours: [0; 6], shares: SHARES }));
        let round: Vec<_> = places.rows_round(1).collect();
        assert_eq!(round.len(), PLACE_ROWS);
        assert_eq!(round[0], (1, [-32, 1, 2, 3, 4]));
        assert_eq!(round[6], (0, [0, 0, 0, 0, 127]));
        assert_eq!(places.rows_round(2).count(), 0);
    }

    #[test]
    fn level_and_radius_are_above_zero_and_exponents_in_range() {
        let bytes = tables(2, 0);
        let places = Places::new([&bytes, &[0; 3], &[0; 2], &[0; 32]]);
        let level = DetectionLayout { level: f32::NAN, ..LAYOUT };
        assert_eq!(places.check(&level, 9), Err(PatchError::NotPositive { field: "detection.level" }));
        let radius = DetectionLayout { radius: 0.0, ..LAYOUT };
        assert_eq!(places.check(&radius, 9), Err(PatchError::NotPositive { field: "detection.radius" }));
        let far = Places::new([&bytes, &[0, 31, 0], &[0; 2], &[0; 32]]);
        assert_eq!(far.check(&LAYOUT, 9), Err(PatchError::ColumnExponent { measurement: 1 }));
    }

    #[test]
    fn four_columns_are_those_of_their_row() {
        let mut mantissas = [0_i16; 32];
        for row in 0..2 {
            for column in 0..6 {
                mantissas[coefficient_index(8, row, column)] = (10 * row + column) as i16;
            }
        }
        let bytes: Vec<u8> = mantissas.iter().flat_map(|mantissa| mantissa.to_le_bytes()).collect();
        let places = tables(2, 0);
        let places = Places::new([&places, &[0; 6], &[0; 2], &bytes]);
        assert_eq!(Places::four(places.row(1), 1), [14.0, 15.0, 0.0, 0.0]);
        assert_eq!(Places::four(places.row(0), 0), [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(Places::four(places.row(7), 9), [0.0; 4]);
        assert_eq!(Places::product(places.row(1), 0, &[1, 0, 0, 100]), 10 + 13 * 100);
    }
}
