//! Median of a few values, in the flash of a small chip.

/// The median, the upper one of two; it moves the values about. None of none.
pub(crate) fn median(values: &mut [f32]) -> Option<f32> {
    let middle = values.len() / 2;
    // Hoare's FIND, as N. Wirth has it: what lies on the other side of the middle is left alone from then on.
    let (mut first, mut last) = (0, values.len().saturating_sub(1) as isize);
    while first < last {
        let pivot = *values.get(middle)?;
        let (mut low, mut high) = (first, last);
        while low <= high {
            while values[low as usize].total_cmp(&pivot).is_lt() {
                low += 1;
            }
            while values[high as usize].total_cmp(&pivot).is_gt() {
                high -= 1;
            }
            if low <= high {
                values.swap(low as usize, high as usize);
                low += 1;
                high -= 1;
            }
        }
        if high < middle as isize {
            first = low;
        }
        if low > middle as isize {
            last = high;
        }
    }
    values.get(middle).copied()
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
        }
    }
}
