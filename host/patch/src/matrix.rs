//! Matrix: a patch's reconstruction matrix in owned form.

use dermatome_shared::patch::matrix::{GROUP, Interpolation, Matrix, MatrixTables, coefficient_index};

/// The parts of [`MatrixTables`], owned.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedMatrix {
    column_exponents: Vec<i8>,
    row_exponents: Vec<i8>,
    positions: Vec<u16>,
    interpolations: Vec<Interpolation>,
    inputs: Vec<u16>,
    mantissas: Vec<i16>,
}

impl FixedMatrix {
    /// Pixels from the data: `mantissas` `[position][measurement]`. As they stand, the positions are the pixels.
    ///
    /// # Panics
    /// Panics if there is not a mantissa for each row and column.
    #[must_use]
    pub fn from_data(column_exponents: Vec<i8>, row_exponents: Vec<i8>, mantissas: &[i16]) -> Self {
        let positions = (0..row_exponents.len() as u16).collect();
        let columns = column_exponents.len();
        assert_eq!(mantissas.len(), row_exponents.len() * columns, "a mantissa for each row and column");
        let mut matrix = Self {
            column_exponents,
            row_exponents,
            positions,
            interpolations: Vec::new(),
            inputs: Vec::new(),
            mantissas: Vec::new(),
        };
        matrix.append(mantissas, columns);
        matrix
    }

    /// The next pixels, interpolated: `mantissas` `[output][input]`.
    ///
    /// # Panics
    /// Panics if there are no inputs, or not as many mantissas for each output.
    pub fn interpolate(&mut self, inputs: &[u16], mantissas: &[i16]) {
        assert!(mantissas.len().is_multiple_of(inputs.len()), "rows differ in length");
        let (whole, outputs) = (inputs.len().next_multiple_of(GROUP), mantissas.len() / inputs.len());
        self.interpolations.push(Interpolation { inputs: whole as u16, outputs: outputs as u16 });
        self.inputs.extend_from_slice(inputs);
        self.inputs.extend(std::iter::repeat_n(inputs[0], whole - inputs.len()));
        self.append(mantissas, inputs.len());
        let next = self.positions.len() as u16;
        self.positions.extend(next..next + outputs as u16);
    }

    /// The same for pixels that become known in this order.
    ///
    /// # Panics
    /// Panics if the order names a pixel that there is not.
    #[must_use]
    pub fn in_order(mut self, order: &[usize]) -> Self {
        for (position, &pixel) in order.iter().enumerate() {
            self.positions[pixel] = position as u16;
        }
        self
    }

    /// That of a patch.
    #[must_use]
    pub fn read(matrix: &Matrix<'_>) -> Self {
        Self {
            column_exponents: matrix.column_exponents().collect(),
            row_exponents: matrix.row_exponents().collect(),
            positions: words(matrix.positions()).collect(),
            interpolations: matrix.interpolations().collect(),
            inputs: words(matrix.inputs()).collect(),
            mantissas: mantissas(matrix.mantissas()),
        }
    }

    /// The same where a press raises what the image shows by these factors more: `[pixel]`; the image shows as much less. None
    /// where pixels are interpolated from each other.
    ///
    /// # Panics
    /// Panics if there is not a gain above zero for each pixel.
    #[must_use]
    pub fn with_gains(mut self, gains: &[f64]) -> Option<Self> {
        assert_eq!(gains.len(), self.positions.len(), "a gain for each pixel");
        if !self.interpolations.is_empty() {
            return None;
        }
        let columns = self.column_exponents.len();
        for (&position, gain) in self.positions.iter().zip(gains) {
            let row = usize::from(position);
            scale_row(&mut self.mantissas, &mut self.row_exponents[row], columns, row, 1.0 / gain);
        }
        Some(self)
    }

    /// For writing a patch.
    #[must_use]
    pub fn tables(&self) -> MatrixTables<'_> {
        MatrixTables {
            column_exponents: &self.column_exponents,
            row_exponents: &self.row_exponents,
            positions: &self.positions,
            interpolations: &self.interpolations,
            inputs: &self.inputs,
            mantissas: &self.mantissas,
        }
    }

    /// Rows of `columns` mantissas, each in its place among zeros.
    fn append(&mut self, mantissas: &[i16], columns: usize) {
        self.mantissas.extend(in_groups(mantissas, columns));
    }
}

/// Where the mantissas of a row lie: `[measurement]`.
pub(crate) fn indices(columns: usize, row: usize) -> impl Iterator<Item = usize> + use<> {
    (0..columns).map(move |column| coefficient_index(columns.next_multiple_of(GROUP), row, column))
}

/// A row times a factor, with the finest exponent that fits.
///
/// # Panics
/// Panics if the factor is not above zero.
pub(crate) fn scale_row(mantissas: &mut [i16], exponent: &mut i8, columns: usize, row: usize, factor: f64) {
    assert!(factor.is_finite() && factor > 0.0, "gains are above zero");
    let largest = indices(columns, row).map(|index| mantissas[index].unsigned_abs()).max().unwrap_or(0);
    if largest == 0 {
        return;
    }
    let finer = (f64::from(i16::MAX) / (factor * f64::from(largest))).log2().floor();
    let scaled = (f64::from(*exponent) + finer).clamp(-128.0, 127.0);
    let factor = factor * (scaled - f64::from(*exponent)).exp2();
    *exponent = scaled as i8;
    for index in indices(columns, row) {
        mantissas[index] = (factor * f64::from(mantissas[index])).round() as i16;
    }
}

/// Rows of `columns` mantissas in the order of [`coefficient_index`].
pub(crate) fn in_groups(mantissas: &[i16], columns: usize) -> Vec<i16> {
    let rows = mantissas.chunks_exact(columns.max(1));
    let whole = columns.next_multiple_of(GROUP);
    let mut grouped = vec![0; rows.len().next_multiple_of(GROUP) * whole];
    for (row, values) in rows.enumerate() {
        for (column, value) in values.iter().enumerate() {
            grouped[coefficient_index(whole, row, column)] = *value;
        }
    }
    grouped
}

/// Little-endian i16.
pub(crate) fn mantissas(bytes: &[u8]) -> Vec<i16> {
    bytes.chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect()
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u16> + '_ {
    bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_pixels_are_divided_by_their_gains_unless_some_are_interpolated() {
        let rows: [i16; 9] = [32_000, -7, 100, 20_000, 19_999, -1, -30_000, 2, 3];
        let plain = FixedMatrix::from_data(vec![0; 3], vec![2, -1, 0], &rows).in_order(&[2, 0, 1]);
        let gains = [0.8, 1.0, 1.7];
        let scaled = plain.clone().with_gains(&gains).unwrap();
        for (pixel, gain) in gains.into_iter().enumerate() {
            let row = usize::from(plain.positions[pixel]);
            let step = |of: &FixedMatrix| (-f64::from(of.row_exponents[row])).exp2();
            for (column, index) in indices(3, row).enumerate() {
                assert_eq!(plain.mantissas[index], rows[3 * row + column]);
                let [after, before] = [&scaled, &plain].map(|of| step(of) * f64::from(of.mantissas[index]));
                assert!(
                    (after - before / gain).abs() <= 0.5 * step(&scaled),
                    "{pixel} {column}: {before} {after}"
                );
            }
        }
        assert_eq!(plain.clone().with_gains(&[1.0; 3]), Some(plain.clone()));
        let mut interpolated = plain;
        interpolated.interpolate(&[0, 1], &[2048, 2048]);
        assert_eq!(interpolated.with_gains(&[1.0; 4]), None);
    }
}
