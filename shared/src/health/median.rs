//! Median of a few values, in the flash of a small chip.

/// The median, the upper one of two; it sorts the values. None of none.
pub(crate) fn median(values: &mut [f32]) -> Option<f32> {
    sort(values);
    values.get(values.len() / 2).copied()
}

/// Shell's sort: the library's takes two kilobytes of a board's flash.
fn sort(values: &mut [f32]) {
    // Gaps of M. Ciura (2001).
    for gap in [57, 23, 10, 4, 1] {
        for end in gap..values.len() {
            let value = values[end];
            let mut place = end;
            while place >= gap && values[place - gap].total_cmp(&value).is_gt() {
                values[place] = values[place - gap];
                place -= gap;
            }
            values[place] = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest::proptest! {
        #[test]
        fn the_median_is_that_of_sorted_values(mut values in proptest::collection::vec(-1e6_f32..1e6, 0..260)) {
            let mut sorted = values.clone();
            sorted.sort_by(f32::total_cmp);
            proptest::prop_assert_eq!(median(&mut values), sorted.get(sorted.len() / 2).copied());
            proptest::prop_assert_eq!(values, sorted);
        }
    }
}
