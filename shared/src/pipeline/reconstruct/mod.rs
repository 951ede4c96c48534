//! Reconstruction: fixed matrix times difference data, in integers.
//!
//! Some pixels come from the data, the others are interpolated from those ([`crate::patch::matrix`]). The sum of
//! each row is exact. The pixels from the data are shifted, all by as much, until the largest has 13 bits beside the
//! interpolations' fraction: they keep 32 bits, are interpolated as 16 bits, and are rounded once more to
//! [`RelativeConductivity`] steps.
//!
//! With the feature `dsp`, a Cortex-M that has the DSP instructions sums the rows by the kernels in `kernel.rs`,
//! with the same bits as the plain Rust that runs everywhere else.

#[cfg(all(target_arch = "arm", feature = "dsp"))]
mod kernel;

use crate::{
    image::Image,
    limits::MAX_PIXELS,
    patch::{
        PatchView,
        matrix::{GROUP, HEADROOM_BITS, INTERPOLATION_EXPONENT, MAX_INPUTS, Matrix, Rows},
        places::Places,
    },
    pipeline::reference::DifferenceData,
    units::RelativeConductivity,
};

/// Bits of a sum of data that its value leaves out: at most 256 products are below 2^38.
pub(super) const LOW_BITS: i32 = 8;
/// Bits of the largest pixel from the data, as the interpolations take it.
const PEAK_BITS: i32 = 13;
/// Bits of the pixels that interpolations take, their sign included.
const INPUT_BITS: i32 = PEAK_BITS + HEADROOM_BITS + 1;

/// What rows are multiplied with, in whole words.
#[repr(align(4))]
struct Codes([i16; MAX_INPUTS]);

/// The pixels that are known: `[position]`, and room for the rest of the last group.
struct Values([i32; MAX_PIXELS + GROUP]);

/// How rows are summed, into the values of their positions: less so many bits.
type Sums = fn(&Codes, &Rows<'_>, &mut [i32], i32);

/// Applies the patch's matrix: `image[pixel] = sum over measurements of matrix * difference`.
// Never inlined, so that a test can find it in the firmware's ELF and count its cycles.
#[inline(never)]
pub fn reconstruct(patch: &PatchView<'_>, difference: &DifferenceData, image: &mut Image) {
    #[cfg(all(target_arch = "arm", feature = "dsp"))]
    apply(patch, difference, image, kernel::sums);
    #[cfg(not(all(target_arch = "arm", feature = "dsp")))]
    apply(patch, difference, image, sums);
}

/// As [`reconstruct`], in plain Rust.
pub fn portable(patch: &PatchView<'_>, difference: &DifferenceData, image: &mut Image) {
    apply(patch, difference, image, sums);
}

/// Rows that meet data, times data: each value is the sum's, `2^LOW_BITS` times as large. There is a value for each row,
/// whole groups of them.
pub(super) fn products(rows: &Rows<'_>, data: &DifferenceData, values: &mut [i32]) {
    let mut codes = Codes([0; MAX_INPUTS]);
    codes.0.iter_mut().zip(&data.codes).for_each(|(code, datum)| *code = *datum);
    #[cfg(all(target_arch = "arm", feature = "dsp"))]
    kernel::sums(&codes, rows, values, LOW_BITS);
    #[cfg(not(all(target_arch = "arm", feature = "dsp")))]
    sums(&codes, rows, values, LOW_BITS);
}

/// The exact sum of a row's mantissas times codes, `[measurement]`; the row is one of a group, from its own words on.
// Not inlined: its loop wants registers for itself.
#[inline(never)]
pub(super) fn product(row: &[u8], codes: &[i16]) -> i64 {
    let (blocks, rest) = codes.as_chunks();
    let mut last = [0; GROUP];
    last.iter_mut().zip(rest).for_each(|(place, code)| *place = *code);
    #[cfg(all(target_arch = "arm", feature = "dsp"))]
    let sum = kernel::row(row, blocks);
    #[cfg(not(all(target_arch = "arm", feature = "dsp")))]
    let sum = blocks.iter().enumerate().map(|(four, codes)| Places::product(row, four, codes)).sum::<i64>();
    sum + Places::product(row, blocks.len(), &last)
}

#[inline(always)]
fn apply(patch: &PatchView<'_>, difference: &DifferenceData, image: &mut Image, sums: Sums) {
    let matrix = patch.matrix();
    let mut values = Values([0; MAX_PIXELS + GROUP]);
    let mut codes = Codes([0; MAX_INPUTS]);
    codes.0.iter_mut().zip(&difference.codes).for_each(|(code, datum)| *code = *datum);
    let mut parts = matrix.rows();
    let mut exponent = difference.exponent - RelativeConductivity::FRACTION_BITS;
    let mut position = 0;
    if let Some(rows) = parts.next()
        && let Some(found) = values.of(position, &rows)
    {
        sums(&codes, &rows, found, LOW_BITS);
        exponent += scale(&matrix, found);
        position += rows.count;
    }
    for rows in parts {
        values.take(rows.inputs, &mut codes);
        let Some(found) = values.of(position, &rows) else { break };
        sums(&codes, &rows, found, 0);
        position += rows.count;
    }
    values.write(matrix.positions(), exponent, image);
}

impl Values {
    /// Those of rows from a position onwards, whole groups of them.
    fn of(&mut self, position: usize, rows: &Rows<'_>) -> Option<&mut [i32]> {
        self.0.get_mut(position..position + rows.count.next_multiple_of(GROUP))
    }

    /// Of a little-endian u16.
    #[inline(always)]
    fn at(&self, position: [u8; 2]) -> i32 {
        self.0[usize::from(u16::from_le_bytes(position)) % MAX_PIXELS]
    }

    /// What an interpolation takes, four at a time.
    #[inline(always)]
    fn take(&self, positions: &[u8], codes: &mut Codes) {
        let code = |position| {
            let rounded = self.at(position).saturating_add(1 << (INTERPOLATION_EXPONENT - 1));
            (rounded >> INTERPOLATION_EXPONENT).clamp(-(1 << (INPUT_BITS - 1)), (1 << (INPUT_BITS - 1)) - 1)
                as i16
        };
        for (codes, positions) in codes.0.as_chunks_mut::<GROUP>().0.iter_mut().zip(fours(positions)) {
            *codes = positions.map(code);
        }
    }

    /// The image of values with this exponent beside its own.
    #[inline(always)]
    fn write(&self, positions: &[u8], exponent: i32, image: &mut Image) {
        let count = positions.len() / 2;
        if image.len() != count {
            image.clear();
            let _ = image.resize(count, RelativeConductivity(0));
        }
        let usual = (1..=31).contains(&exponent);
        let shift = |value: i32| {
            if usual { ((value >> (exponent - 1)) + 1) >> 1 } else { shifted(value, -exponent) }
        };
        let pixel = |position| RelativeConductivity(shift(self.at(position)));
        let (pixels, last) = image.as_chunks_mut::<GROUP>();
        for (pixels, positions) in pixels.iter_mut().zip(fours(positions)) {
            *pixels = positions.map(pixel);
        }
        let (positions, _) = positions[2 * (count - last.len())..].as_chunks::<2>();
        last.iter_mut().zip(positions).for_each(|(place, position)| *place = pixel(*position));
    }
}

/// Little-endian u16, four at a time.
fn fours(bytes: &[u8]) -> impl Iterator<Item = [[u8; 2]; GROUP]> + '_ {
    bytes.as_chunks::<2>().0.as_chunks::<GROUP>().0.iter().copied()
}

/// Exact sums of mantissas times codes, four rows at a time, less their lowest bits. Those of validated patches fit.
fn sums(codes: &Codes, rows: &Rows<'_>, values: &mut [i32], low_bits: i32) {
    let codes = &codes.0[..rows.columns.min(MAX_INPUTS)];
    let groups = rows.mantissas.chunks_exact((2 * GROUP * rows.columns).max(1));
    for (mantissas, values) in groups.zip(values.chunks_exact_mut(GROUP)) {
        let mut sums = [0_i64; GROUP];
        for (words, pair) in mantissas.chunks_exact(4 * GROUP).zip(codes.chunks_exact(2)) {
            for (row, sum) in sums.iter_mut().enumerate() {
                let product = |column: usize| {
                    let at = 4 * row + 2 * column;
                    i32::from(i16::from_le_bytes([words[at], words[at + 1]])) * i32::from(pair[column])
                };
                *sum += i64::from(product(0)) + i64::from(product(1));
            }
        }
        values.iter_mut().zip(sums).for_each(|(place, sum)| *place = (sum >> low_bits) as i32);
    }
}

/// Brings sums of rows that differ in their exponents to one: the values' exponent, beside that of the data.
#[inline(always)]
fn scale(matrix: &Matrix<'_>, values: &mut [i32]) -> i32 {
    let least = matrix.row_exponents().min().map_or(0, i32::from);
    let finer = |exponent: i8| (i32::from(exponent) - least).min(31);
    let sizes = values.iter().zip(matrix.row_exponents());
    let bits = sizes.fold(0, |bits, (value, exponent)| bits | (value ^ (value >> 31)) >> finer(exponent));
    let largest_bits = 32 - bits.leading_zeros() as i32;
    let up = PEAK_BITS + INTERPOLATION_EXPONENT as i32 - largest_bits;
    for (value, exponent) in values.iter_mut().zip(matrix.row_exponents()) {
        let down = finer(exponent) - up;
        // To the left no bit is lost: the largest has room.
        *value = if down > 0 { ((*value >> (down - 1).min(31)) + 1) >> 1 } else { *value << -down };
    }
    least + up - LOW_BITS
}

/// `value * 2^places`, rounded to nearest; beyond the range its ends.
#[inline(always)]
fn shifted(value: i32, places: i32) -> i32 {
    match places {
        -31..=-1 => ((value >> (-places - 1)) + 1) >> 1,
        0..=31 => (i64::from(value) << places).clamp(i32::MIN.into(), i32::MAX.into()) as i32,
        32.. if value > 0 => i32::MAX,
        32.. if value < 0 => i32::MIN,
        _ => 0,
    }
}

#[cfg(test)]
mod tests;
