use super::*;
use crate::patch::{
    Difference,
    matrix::{MOST_OF_ROW, coefficient_index},
    tests::{TestMatrix, patch_with_matrix},
};
use proptest::prelude::*;
use std::vec::Vec;

proptest! {
    #[test]
    fn shift_rounds_to_nearest(value in any::<i32>(), places in -70_i32..70) {
        let exact = f64::from(value) * 2_f64.powi(places);
        let bounded = exact.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
        prop_assert!((f64::from(shifted(value, places)) - bounded).abs() <= 0.5);
    }

    /// Against the same rows in f64: what is rounded is the largest value's 13th bit, and half a step of the image.
    #[test]
    fn images_are_those_of_f64(
        seeds in prop::collection::vec(-1.0..1.0_f64, 400),
        data in prop::collection::vec(-0.5..0.5_f32, 40),
        scales in prop::array::uniform6(-3_i32..4),
    ) {
        let matrix = TestMatrix::new(&seeds, &scales);
        let bytes = patch_with_matrix(Difference::Normalised, 3, &matrix);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut difference = DifferenceData::default();
        difference.quantise(&data, patch.matrix().column_exponents());
        let (mut image, mut known) = (Image::new(), Vec::new());
        portable(&patch, &difference, &mut image);
        let value = |(code, column): (&i16, &i8)| {
            f64::from(*code) * 2_f64.powi(i32::from(*column) - difference.exponent)
        };
        let data: Vec<f64> = difference.codes.iter().zip(&matrix.column_exponents).map(value).collect();
        matrix.apply(&data, &mut known);
        let peak = known[..6].iter().fold(0.0, |max: f64, value| max.max(value.abs()));
        for (pixel, position) in image.iter().zip(&matrix.positions) {
            let (found, value) = (pixel.to_f64(), known[usize::from(*position)]);
            // Each input is rounded to a part in 2^13 of the peak, and its row's sizes add up to at most four.
            let allowed = (4.5 * peak) / f64::from(1 << PEAK_BITS) + 1.0 / RelativeConductivity::ONE;
            prop_assert!((found - value).abs() <= allowed, "{found} {value} of {peak}");
        }
    }
}

/// Of one row among four, the third.
fn sum_of(code: i16, row: &[i16], low_bits: i32) -> i32 {
    let mut mantissas = std::vec![0_i16; row.len() * GROUP];
    for (column, mantissa) in row.iter().enumerate() {
        mantissas[coefficient_index(row.len(), 2, column)] = *mantissa;
    }
    let bytes: Vec<u8> = mantissas.iter().flat_map(|mantissa| mantissa.to_le_bytes()).collect();
    let mut values = [1; GROUP];
    let rows = Rows { count: GROUP, inputs: &[], columns: row.len(), mantissas: &bytes };
    sums(&Codes([code; MAX_INPUTS]), &rows, &mut values, low_bits);
    assert_eq!([values[0], values[1], values[3]], [0; 3]);
    values[2]
}

#[test]
fn the_largest_sums_fit() {
    let largest = 1 << (INPUT_BITS - 1);
    assert!(i64::from(MOST_OF_ROW) * largest < 1 << 31);
    assert_eq!(sum_of(i16::MIN, &[32_767, 1, 0, 32_767], 0), -65_535 << 15);
    let of_data = |code: i16, mantissa: i16| (256 * i64::from(code) * i64::from(mantissa)) >> LOW_BITS;
    for (code, mantissa) in [(32_767, i16::MIN), (-32_767, i16::MIN), (32_767, 32_767)] {
        assert_eq!(i64::from(sum_of(code, &[mantissa; 256], LOW_BITS)), of_data(code, mantissa));
    }
}

#[test]
fn a_patch_that_was_not_validated_gives_some_image() {
    let bytes = patch_with_matrix(Difference::Normalised, 3, &TestMatrix::new(&[0.5; 400], &[0; 6]));
    let mut difference = DifferenceData::default();
    difference.quantise(&[0.25; 40], [0; 40].into_iter());
    for place in 40..bytes.len() {
        let mut bytes = bytes.clone();
        bytes[place] ^= 0xFF;
        if let Ok(patch) = PatchView::open(&bytes) {
            portable(&patch, &difference, &mut Image::new());
        }
    }
}

proptest! {
    /// Whether or not the columns are whole blocks of four, in each of a group's rows.
    #[test]
    fn the_product_of_a_row_is_that_of_its_columns(
        columns in prop::collection::vec((any::<i16>(), any::<i16>()), 1..30),
        row in 0..GROUP,
    ) {
        let whole = columns.len().next_multiple_of(GROUP);
        let mut mantissas = std::vec![7_i16; whole * GROUP];
        for column in 0..whole {
            mantissas[coefficient_index(whole, row, column)] = columns.get(column).map_or(0, |column| column.0);
        }
        let bytes: Vec<u8> = mantissas.iter().flat_map(|mantissa| mantissa.to_le_bytes()).collect();
        let codes: Vec<i16> = columns.iter().map(|column| column.1).collect();
        let expected: i64 = columns.iter().map(|&(a, b)| i64::from(a) * i64::from(b)).sum();
        prop_assert_eq!(product(&bytes[2 * coefficient_index(whole, row, 0)..], &codes), expected);
    }
}
