//! Regressions from measurements to places, beside which `learn` is judged, and what makes a skin unlike its model.
#![allow(dead_code, reason = "each test binary uses its own part")]

use dermatome::learn::presses::Presses;
use faer::{Mat, linalg::solvers::Solve};
use nalgebra::Point3;

pub(crate) fn some_of(presses: &Presses, which: std::ops::Range<usize>) -> Presses {
    Presses {
        data: presses.data[which.clone()].to_vec(),
        places: presses.places[which].to_vec(),
        ..presses.clone()
    }
}

/// What a regression sees of a press.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Features {
    /// Relative changes over their usual sizes.
    Linear,
    /// The same, of size 1 for each press.
    Direction,
    /// Logarithms of their magnitudes, with a mean of zero for each press.
    Logarithm,
}

pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Usual size of each measurement.
pub(crate) fn usual(presses: &Presses) -> Vec<f64> {
    let of = |m: usize| median(presses.data.iter().map(|data| data[m].abs())).max(1e-9);
    (0..presses.measurements()).map(of).collect()
}

pub(crate) fn features(presses: &Presses, usual: &[f64], kind: Features) -> Mat<f64> {
    let count = presses.count();
    let mut rows = Mat::from_fn(count, usual.len(), |press, m| presses.data[press][m] / usual[m]);
    for press in 0..count {
        let size = rows.row(press).norm_l2();
        let root = size / (usual.len() as f64).sqrt();
        let value = |value: &f64| match kind {
            Features::Linear => *value,
            Features::Direction => value / size,
            Features::Logarithm => (value.abs() / root + 0.03).ln(),
        };
        let values: Vec<f64> = rows.row(press).iter().map(value).collect();
        let is_logarithm = matches!(kind, Features::Logarithm);
        let mean = if is_logarithm { values.iter().sum::<f64>() / values.len() as f64 } else { 0.0 };
        rows.row_mut(press).iter_mut().zip(values).for_each(|(row, value)| *row = value - mean);
    }
    rows
}

/// Errors of places by (kernel) ridge regression, mm, its parameters by leave-one-out: `[press]`. `lay` takes what it tells
/// to where it counts.
pub(crate) fn regression(
    taught: &Presses,
    judged: &Presses,
    kind: Features,
    is_kernel: bool,
    lay: impl Fn(Point3<f64>) -> Point3<f64>,
) -> Vec<f64> {
    let usual = usual(taught);
    let (known, unknown) = (features(taught, &usual, kind), features(judged, &usual, kind));
    let count = taught.count();
    let squares = |a: &Mat<f64>, b: &Mat<f64>| {
        Mat::from_fn(a.nrows(), b.nrows(), |i, j| (a.row(i) - b.row(j)).squared_norm_l2())
    };
    let (near, far) = (squares(&known, &known), squares(&unknown, &known));
    let scale = median((0..count).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| near[(i, j)]));
    let kernels: Vec<(Mat<f64>, Mat<f64>)> = if is_kernel {
        let of = |share: f64| {
            let kernel = |squares: &Mat<f64>| {
                Mat::from_fn(squares.nrows(), squares.ncols(), |i, j| {
                    (-squares[(i, j)] / (share * scale)).exp()
                })
            };
            (kernel(&near), kernel(&far))
        };
        [0.5, 1.0, 2.0, 4.0, 8.0].map(of).into()
    } else {
        vec![(&known * known.transpose(), &unknown * known.transpose())]
    };
    let places = |presses: &Presses| Mat::from_fn(presses.count(), 3, |i, axis| presses.places[i][axis]);
    let targets = places(taught);
    let means = [0, 1, 2].map(|axis| targets.col(axis).iter().sum::<f64>() / count as f64);
    let centred = Mat::from_fn(count, 3, |i, axis| targets[(i, axis)] - means[axis]);
    let mut best: Option<(f64, Mat<f64>)> = None;
    for (kernel, other) in &kernels {
        let size = (0..count).map(|i| kernel[(i, i)]).sum::<f64>() / count as f64;
        for ridge in [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0] {
            let mut system = kernel.clone();
            (0..count).for_each(|i| system[(i, i)] += ridge * size);
            let inverse = system.partial_piv_lu().solve(Mat::<f64>::identity(count, count));
            let weights = &inverse * &centred;
            let left =
                (0..count).map(|i| weights.row(i).squared_norm_l2() / inverse[(i, i)].powi(2)).sum::<f64>();
            if best.as_ref().is_none_or(|(least, _)| left < *least) {
                best = Some((left, other * weights));
            }
        }
    }
    let told = best.unwrap().1;
    let off = |(i, place): (usize, &Point3<f64>)| {
        let told = Point3::from([0, 1, 2].map(|axis| told[(i, axis)] + means[axis]));
        (lay(told) - place).norm() * 1e3
    };
    judged.places.iter().enumerate().map(off).collect()
}
