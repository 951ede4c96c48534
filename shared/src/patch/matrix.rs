//! The reconstruction matrix as a board applies it: some pixels from the data, the others from those.
//!
//! The values of neighbouring pixels are nearly multiples of each other's, so most are interpolated from some that
//! are known (an interpolative decomposition, Cheng et al., SIAM J. Sci. Comput. 26(4), 2005). That is half the
//! products. The pixels become known one after the other: first those from the data, then the outputs of each
//! [`Interpolation`]. A pixel's place in that order is its position.
//!
//! The sum of a row that meets data is exact in 64 bits; that of an interpolation in 32: its mantissas add up to at
//! most [`MOST_OF_ROW`]. They lie in the order in which a board takes them: groups of four rows, in each the columns
//! two by two, for one row after the other, see [`coefficient_index`]. What is left of the last group and of the last
//! four columns is zero.

use super::PatchError;
use crate::limits::{MAX_MEASUREMENTS, MAX_PIXELS};
use core::ops::RangeInclusive;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Rows in a group, and columns in a block.
pub const GROUP: usize = 4;
/// Most inputs of an interpolation.
pub const MAX_INPUTS: usize = MAX_MEASUREMENTS;
/// Largest sum of the sizes of an interpolation's mantissas: they meet pixels of 16 bits, `65,535 * 32,768 < 2^31`.
pub const MOST_OF_ROW: u32 = 65_535;
/// A coefficient of an interpolation is `mantissa * 2^-INTERPOLATION_EXPONENT`.
pub const INTERPOLATION_EXPONENT: u32 = 12;
/// What exponents of columns may be.
pub const COLUMN_EXPONENTS: RangeInclusive<i8> = -30..=30;
/// Pixels that interpolations take may pass the largest one from data by so many bits; beyond, they are cut.
pub const HEADROOM_BITS: i32 = 2;

const INTERPOLATION_BYTES: usize = 4;

/// How large the parts of the matrix are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct MatrixLayout {
    /// Pixels computed from the data.
    pub from_data: u16,
    /// Interpolations.
    pub interpolations: u8,
    /// Entries of all lists of inputs.
    pub inputs: u16,
    /// Mantissas, with the zeros between them.
    pub mantissas: u32,
}

impl MatrixLayout {
    /// Bytes of exponents of the columns and of the rows, positions, interpolations, inputs and mantissas.
    pub(super) fn sizes(&self, measurements: u16, pixels: u16) -> [usize; 6] {
        [
            measurements.into(),
            self.from_data.into(),
            2 * usize::from(pixels),
            INTERPOLATION_BYTES * usize::from(self.interpolations),
            2 * usize::from(self.inputs),
            // Doubled it may pass 2^32.
            (self.mantissas as usize).saturating_mul(2).min(u32::MAX as usize / 2),
        ]
    }
}

/// One step of the interpolation: from pixels that are known to the next ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interpolation {
    /// Pixels it takes: a multiple of [`GROUP`].
    pub inputs: u16,
    /// Pixels it makes.
    pub outputs: u16,
}

impl Interpolation {
    fn from_bytes(bytes: [u8; INTERPOLATION_BYTES]) -> Self {
        let [i0, i1, o0, o1] = bytes;
        Self { inputs: u16::from_le_bytes([i0, i1]), outputs: u16::from_le_bytes([o0, o1]) }
    }

    fn to_bytes(self) -> [u8; INTERPOLATION_BYTES] {
        let ([i0, i1], [o0, o1]) = (self.inputs.to_le_bytes(), self.outputs.to_le_bytes());
        [i0, i1, o0, o1]
    }
}

/// Where a mantissa lies among those of its rows, which have `columns` (a multiple of [`GROUP`]).
#[must_use]
pub fn coefficient_index(columns: usize, row: usize, column: usize) -> usize {
    let (group, block) = (row / GROUP, column / GROUP);
    let pair = column % GROUP / 2;
    (group * columns + block * GROUP) * GROUP + (pair * GROUP + row % GROUP) * 2 + column % 2
}

/// The parts of a matrix, for writing a patch.
#[derive(Clone, Copy, Debug)]
pub struct MatrixTables<'a> {
    /// Exponents of the columns that meet data: `[measurement]`.
    pub column_exponents: &'a [i8],
    /// Exponents of the rows that meet data: `[position]`.
    pub row_exponents: &'a [i8],
    /// The position of each pixel: `[pixel]`.
    pub positions: &'a [u16],
    /// The interpolations.
    pub interpolations: &'a [Interpolation],
    /// Positions that they take, list after list.
    pub inputs: &'a [u16],
    /// Mantissas, see [`coefficient_index`].
    pub mantissas: &'a [i16],
}

impl MatrixTables<'_> {
    /// How large they are.
    #[must_use]
    pub fn layout(&self) -> MatrixLayout {
        MatrixLayout {
            from_data: self.row_exponents.len() as u16,
            interpolations: self.interpolations.len() as u8,
            inputs: self.inputs.len() as u16,
            mantissas: self.mantissas.len() as u32,
        }
    }

    /// Puts all but the mantissas behind each other.
    pub(super) fn put(&self, mut put: impl FnMut(&[u8]) -> Option<()>) -> Option<()> {
        let exponents = self.column_exponents.iter().chain(self.row_exponents);
        exponents.copied().try_for_each(|exponent| put(&exponent.to_le_bytes()))?;
        self.positions.iter().try_for_each(|position| put(&position.to_le_bytes()))?;
        self.interpolations.iter().try_for_each(|interpolation| put(&interpolation.to_bytes()))?;
        self.inputs.iter().try_for_each(|position| put(&position.to_le_bytes()))
    }
}

/// The matrix of a patch, read in place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix<'a> {
    column_exponents: &'a [u8],
    row_exponents: &'a [u8],
    positions: &'a [u8],
    interpolations: &'a [u8],
    inputs: &'a [u8],
    mantissas: &'a [u8],
}

/// Rows that take the same inputs.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// How many there are.
    pub count: usize,
    /// Positions of their inputs, little-endian u16; none where the data are.
    pub inputs: &'a [u8],
    /// Columns, a multiple of [`GROUP`].
    pub columns: usize,
    /// Their mantissas, little-endian i16, whole groups of them.
    pub mantissas: &'a [u8],
}

impl<'a> Matrix<'a> {
    /// Of these tables, as [`MatrixLayout::sizes`] has them.
    pub(super) fn new(tables: [&'a [u8]; 6]) -> Self {
        let [column_exponents, row_exponents, positions, interpolations, inputs, mantissas] = tables;
        Self { column_exponents, row_exponents, positions, interpolations, inputs, mantissas }
    }

    /// Exponents of the columns that meet data: a column is smaller than its mantissas say by so many octaves, and its
    /// data are larger than their codes say: `[measurement]`.
    pub fn column_exponents(&self) -> impl Iterator<Item = i8> + Clone + use<'a> {
        signed(self.column_exponents)
    }

    /// Exponents of the rows that meet data: `[position]`.
    pub fn row_exponents(&self) -> impl Iterator<Item = i8> + Clone + use<'a> {
        signed(self.row_exponents)
    }

    /// The position of each pixel, little-endian u16: `[pixel]`.
    #[must_use]
    pub fn positions(&self) -> &'a [u8] {
        self.positions
    }

    /// The interpolations.
    pub fn interpolations(&self) -> impl Iterator<Item = Interpolation> + use<'a> {
        self.interpolations
            .chunks_exact(INTERPOLATION_BYTES)
            .map(|b| Interpolation::from_bytes([b[0], b[1], b[2], b[3]]))
    }

    /// Positions that the interpolations take, list after list, little-endian u16.
    #[must_use]
    pub fn inputs(&self) -> &'a [u8] {
        self.inputs
    }

    /// The mantissas, little-endian i16.
    #[must_use]
    pub fn mantissas(&self) -> &'a [u8] {
        self.mantissas
    }

    /// The rows in the order in which they are applied: first those of the data, then each interpolation's. It ends
    /// before the first that the tables do not hold.
    pub fn rows(&self) -> impl Iterator<Item = Rows<'a>> + use<'a> {
        let (mut inputs, mut mantissas) = (self.inputs, self.mantissas);
        let columns = self.column_exponents.len().next_multiple_of(GROUP);
        let from_data = (self.row_exponents.len(), 0, columns);
        let of = |interpolation: Interpolation| {
            let count = usize::from(interpolation.inputs);
            (usize::from(interpolation.outputs), count, count)
        };
        core::iter::once(from_data).chain(self.interpolations().map(of)).map_while(
            move |(count, taken, columns)| {
                let (list, later_inputs) = inputs.split_at_checked(2 * taken)?;
                let bytes = (2 * columns).checked_mul(count.next_multiple_of(GROUP))?;
                let (own, later) = mantissas.split_at_checked(bytes)?;
                (inputs, mantissas) = (later_inputs, later);
                Some(Rows { count, inputs: list, columns, mantissas: own })
            },
        )
    }

    /// Checks that every pixel is known once, from what is known before, and that no sum can overflow.
    pub(super) fn check(&self) -> Result<(), PatchError> {
        if let Some(measurement) =
            self.column_exponents().position(|exponent| !COLUMN_EXPONENTS.contains(&exponent))
        {
            return Err(PatchError::ColumnExponent { measurement });
        }
        self.check_positions()?;
        let wrong = |interpolation| PatchError::Interpolation { interpolation };
        let (mut known, mut inputs, mut mantissas, mut parts) = (0, 0, 0, 0);
        for (part, rows) in self.rows().enumerate() {
            let is_fed = part == 0
                || (rows.count > 0
                    && (GROUP..=MAX_INPUTS).contains(&rows.columns)
                    && rows.columns.is_multiple_of(GROUP)
                    && words(rows.inputs).all(|position| usize::from(position) < known));
            if !is_fed {
                return Err(wrong(part - 1));
            }
            if part > 0
                && let Some(row) = rows.first_above(MOST_OF_ROW)
            {
                return Err(PatchError::Row { row: known + row });
            }
            known += rows.count;
            inputs += rows.inputs.len();
            mantissas += rows.mantissas.len();
            parts += 1;
        }
        let all = self.interpolations().count() + 1;
        let is_whole = known == self.positions.len() / 2
            && inputs == self.inputs.len()
            && mantissas == self.mantissas.len();
        if parts == all && is_whole { Ok(()) } else { Err(wrong(parts.saturating_sub(1))) }
    }

    fn check_positions(&self) -> Result<(), PatchError> {
        let mut is_taken = [false; MAX_PIXELS];
        let pixels = self.positions.len() / 2;
        for (pixel, position) in words(self.positions).map(usize::from).enumerate() {
            if position >= pixels || is_taken[position] {
                return Err(PatchError::Position { pixel });
            }
            is_taken[position] = true;
        }
        Ok(())
    }
}

impl Rows<'_> {
    /// The first row whose mantissas' sizes add up to more than `most`.
    fn first_above(&self, most: u32) -> Option<usize> {
        let groups = self.mantissas.chunks_exact((2 * GROUP * self.columns).max(1));
        groups.enumerate().find_map(|(group, mantissas)| {
            let mut sums = [0_u32; GROUP];
            for (word, pair) in mantissas.chunks_exact(4).enumerate() {
                let size = |low, high| u32::from(i16::from_le_bytes([low, high]).unsigned_abs());
                sums[word % GROUP] += size(pair[0], pair[1]) + size(pair[2], pair[3]);
            }
            sums.iter().position(|&sum| sum > most).map(|row| group * GROUP + row)
        })
    }
}

fn signed<'a>(bytes: &'a [u8]) -> impl Iterator<Item = i8> + Clone + use<'a> {
    bytes.iter().map(|&byte| i8::from_le_bytes([byte]))
}

fn words<'a>(bytes: &'a [u8]) -> impl ExactSizeIterator<Item = u16> + use<'a> {
    bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]]))
}
