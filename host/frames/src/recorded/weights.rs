//! Weights of measurements, from frames of the untouched skin.

use super::order::FileIndex;
use dermatome_shared::patch::CombinedInto;
use num_complex::Complex64;

/// W for normalised data of an instrument whose errors have one size, in its own unit, in every
/// measurement: `[measurement]`, with a mean of 1.
///
/// A ratio to the reference r then has an error of 1 / |r|, so W is |r|^2 with r the *measured*
/// reference, times the steps averaged. An instrument that reads some pairs far weaker than the model
/// says is followed in that: their ratios stay, and count little. Dead measurements count
/// nothing. `reference` is in the file's order; `combination` says where each step goes.
#[must_use]
pub fn by_magnitude(reference: &[Complex64], map: &[FileIndex], combination: &[CombinedInto]) -> Vec<f64> {
    let measurements =
        combination.iter().map(|target| usize::from(target.measurement) + 1).max().unwrap_or(0);
    let (mut sums, mut counts) = (vec![0.0; measurements], vec![0.0; measurements]);
    for (place, target) in map.iter().zip(combination) {
        let measurement = usize::from(target.measurement);
        sums[measurement] += reference[place.index].norm();
        counts[measurement] += 1.0;
    }
    let squares: Vec<f64> = sums.iter().zip(&counts).map(|(sum, count)| sum * sum / count).collect();
    let mean = squares.iter().sum::<f64>() / measurements as f64;
    squares.iter().map(|square| if mean > 0.0 { square / mean } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(measurement: u16) -> CombinedInto {
        CombinedInto { measurement, flipped: false }
    }

    fn map(indices: &[usize]) -> Vec<FileIndex> {
        indices.iter().map(|&index| FileIndex { index, flipped: false }).collect()
    }

    #[test]
    fn a_pair_read_three_times_as_strong_counts_nine_times_whatever_its_sign() {
        let reference = [1.0, -3.0].map(Complex64::from);
        assert_eq!(by_magnitude(&reference, &map(&[1, 0]), &[target(0), target(1)]), [1.8, 0.2]);
    }

    #[test]
    fn the_mean_of_two_steps_counts_twice_one_step() {
        let reference = [2.0, 2.0, 2.0].map(Complex64::from);
        let weights = by_magnitude(&reference, &map(&[0, 1, 2]), &[target(0), target(0), target(1)]);
        assert!((weights[0] / weights[1] - 2.0).abs() < 1e-12, "{weights:?}");
    }

    #[test]
    fn a_dead_measurement_counts_nothing() {
        let reference = [0.0, 5.0].map(Complex64::from);
        assert_eq!(by_magnitude(&reference, &map(&[0, 1]), &[target(0), target(1)]), [0.0, 2.0]);
    }
}
