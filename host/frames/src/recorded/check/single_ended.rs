//! Full squares of electrode potentials, where differences between pairs are meant.

use super::{
    super::{
        diagnose::{CLEARLY_BETTER, RESEMBLING, best},
        order::{Arrangement, OrderError},
        read::Frames,
    },
    Expected, Reference,
    numbering::correlations,
};
use num_complex::Complex64;

/// Differences of neighbouring columns, if they resemble the model and the columns do not.
pub(super) fn differences(
    expected: &Expected,
    frames: &Frames,
    used: Arrangement,
) -> Result<Option<Frames>, OrderError> {
    let n = usize::from(expected.electrodes);
    let Some(distance) = sense_distance(expected).filter(|_| frames.measurements == n * n) else {
        return Ok(None);
    };
    let fit = |frames: &Frames| -> Result<f64, OrderError> {
        Ok(best(&correlations(expected, &Reference::of(frames), used)?, used).1)
    };
    let apart = Frames { values: columns_apart(&frames.values, n, distance), ..frames.clone() };
    let (as_they_are, as_potentials) = (fit(frames)?, fit(&apart)?);
    Ok((as_potentials > RESEMBLING.max(as_they_are + CLEARLY_BETTER)).then_some(apart))
}

/// Electrodes from the plus to the minus input, where it is the same in all steps.
fn sense_distance(expected: &Expected) -> Option<usize> {
    let n = u16::from(expected.electrodes);
    let distance = |sense: [u8; 2]| (u16::from(sense[1]) + n - u16::from(sense[0])) % n;
    let mut distances = expected.steps.iter().map(|step| distance([step.sense_plus, step.sense_minus]));
    let first = distances.next()?;
    distances.all(|other| other == first).then_some(usize::from(first))
}

/// Each column of squares minus the one so far behind it.
fn columns_apart(squares: &[Complex64], n: usize, distance: usize) -> Vec<Complex64> {
    let in_row = |row: &[Complex64]| -> Vec<Complex64> {
        (0..n).map(|column| row[column] - row[(column + distance) % n]).collect()
    };
    squares.chunks_exact(n).flat_map(in_row).collect()
}
