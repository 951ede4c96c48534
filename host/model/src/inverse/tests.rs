//! The data space against the image-space formulas it stands for.

use super::{movement::Movement, *};
use faer::{
    Side,
    linalg::solvers::{PartialPivLu, SolveCore},
};
use proptest::prelude::*;

const MEASUREMENTS: usize = 5;
const PIXELS: usize = 9;

fn jacobian() -> impl Strategy<Value = Mat<f64>> {
    prop::collection::vec(-1.0..1.0_f64, MEASUREMENTS * PIXELS)
        .prop_map(|values| Mat::from_fn(MEASUREMENTS, PIXELS, |i, j| values[i * PIXELS + j]))
}

fn weights() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.2..5.0_f64, MEASUREMENTS)
}

/// A ring of six pixels and a chain of three: two parts, each of which Laplace leaves open.
fn two_parts() -> Vec<[usize; 2]> {
    vec![[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [0, 5], [6, 7], [7, 8]]
}

fn priors() -> Vec<Prior> {
    vec![
        Prior::Diagonal((1..=PIXELS).map(|i| i as f64 / 4.0).collect()),
        Prior::Laplace { pixels: PIXELS, neighbours: two_parts() },
        Prior::SquaredLaplace { pixels: PIXELS, neighbours: two_parts() },
    ]
}

fn dense(prior: &Prior) -> Mat<f64> {
    let mut matrix = Mat::zeros(PIXELS, PIXELS);
    prior.entries().unwrap().into_iter().for_each(|(i, j, value)| matrix[(i, j)] += value);
    matrix
}

fn diagonal(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), values.len(), |i, j| if i == j { values[i] } else { 0.0 })
}

fn solved(matrix: &Mat<f64>, rhs: Mat<f64>) -> Mat<f64> {
    let mut solution = rhs;
    PartialPivLu::new(matrix.as_ref()).solve_in_place_with_conj(faer::Conj::No, solution.as_mut());
    solution
}

/// (J'WJ + lambda^2 R)^-1 J'W.
fn image_space(jacobian: &Mat<f64>, weight: &Mat<f64>, prior: &Mat<f64>, hyperparameter: f64) -> Mat<f64> {
    let normal = jacobian.transpose() * weight * jacobian + prior * faer::Scale(hyperparameter.powi(2));
    solved(&normal, jacobian.transpose() * weight)
}

fn relative_error(got: &Mat<f64>, expected: &Mat<f64>) -> f64 {
    (got - expected).norm_max() / expected.norm_max()
}

proptest! {
    #[test]
    fn data_space_is_image_space(jacobian in jacobian(), weights in weights(), lambda in 0.1..3.0_f64) {
        for prior in priors() {
            let got = reconstruction_matrix(&jacobian, &prior, &weights, lambda).unwrap();
            let expected = image_space(&jacobian, &diagonal(&weights), &dense(&prior), lambda);
            let error = relative_error(&got, &expected);
            prop_assert!(error < 1e-8, "{prior:?}: {error:e}");
        }
    }

    #[test]
    fn correlated_noise_weighs_by_its_inverse_covariance(
        jacobian in jacobian(), weights in weights(), shared in 0.0..2.0_f64, lambda in 0.1..3.0_f64,
    ) {
        let covariance = diagonal(&weights) + Mat::from_fn(MEASUREMENTS, MEASUREMENTS, |_, _| shared);
        let whitening = Whitening::from_covariance(&covariance).unwrap();
        for prior in priors() {
            let space = DataSpace::one_step(whitening.transposed(&jacobian), &prior, None).unwrap();
            let mut got = space.matrix(lambda).unwrap();
            whitening.columns(&mut got);
            let weight = solved(&covariance, Mat::identity(MEASUREMENTS, MEASUREMENTS));
            let expected = image_space(&jacobian, &weight, &dense(&prior), lambda);
            prop_assert!(relative_error(&got, &expected) < 1e-8);
        }
    }

    /// Movements as unknowns of their own, dropped from the solution.
    #[test]
    fn electrode_movement_is_solved_for_and_dropped(
        jacobian in jacobian(), weights in weights(), lambda in 0.1..3.0_f64, weight in 0.1..3.0_f64,
        moving in prop::collection::vec(-1.0..1.0_f64, MEASUREMENTS * 4), is_on_rim in any::<bool>(),
    ) {
        let moving = Mat::from_fn(MEASUREMENTS, 4, |i, j| moving[4 * i + j]);
        let whitening = Whitening::from_weights(&weights).unwrap();
        let movement = Movement { responses: moving.clone(), is_on_rim };
        let covariance = movement::covariance(&movement, weight, &whitening);
        let movement_prior = movement::prior(4, weight, is_on_rim);
        for prior in priors() {
            let space = DataSpace::one_step(whitening.transposed(&jacobian), &prior, Some(&covariance)).unwrap();
            let mut got = space.matrix(lambda).unwrap();
            whitening.columns(&mut got);
            let image_prior = dense(&prior);
            let both = Mat::from_fn(PIXELS + 4, PIXELS + 4, |i, j| match (i < PIXELS, j < PIXELS) {
                (true, true) => image_prior[(i, j)],
                (false, false) => movement_prior[(i - PIXELS, j - PIXELS)],
                _ => 0.0,
            });
            let extended = Mat::from_fn(MEASUREMENTS, PIXELS + 4, |i, j| {
                if j < PIXELS { jacobian[(i, j)] } else { moving[(i, j - PIXELS)] }
            });
            let expected = image_space(&extended, &diagonal(&weights), &both, lambda);
            let error = relative_error(&got, &expected.subrows(0, PIXELS).to_owned());
            prop_assert!(error < 1e-8, "{error:e}");
        }
    }

    /// The spectrum's image, residual and size are those of the matrix.
    #[test]
    fn the_spectrum_gives_what_the_matrix_gives(
        jacobian in jacobian(), data in prop::collection::vec(-1.0..1.0_f64, MEASUREMENTS), lambda in 0.1..3.0_f64,
    ) {
        let whitening = Whitening::from_weights(&[1.0; MEASUREMENTS]).unwrap();
        let y = Mat::from_fn(MEASUREMENTS, 1, |i, _| data[i]);
        for prior in priors() {
            let space = DataSpace::one_step(whitening.transposed(&jacobian), &prior, None).unwrap();
            let spectrum = space.spectrum().unwrap();
            let dual = spectrum.dual(&spectrum.components(&data), lambda).as_mat().to_owned();
            let image = space.matrix(lambda).unwrap() * &y;
            prop_assert!(relative_error(&space.images(&dual, &y), &image) < 1e-8);
            let residual = &y - &jacobian * &image;
            prop_assert!((residual - &dual * faer::Scale(lambda * lambda)).norm_max() < 1e-9);
        }
    }
}

#[test]
fn a_part_that_no_measurement_answers_to_is_named() {
    let jacobian = Mat::from_fn(MEASUREMENTS, PIXELS, |i, j| if j < 6 { (i * j) as f64 + 1.0 } else { 0.0 });
    let prior = Prior::Laplace { pixels: PIXELS, neighbours: two_parts() };
    let error = reconstruction_matrix(&jacobian, &prior, &[1.0; MEASUREMENTS], 1.0).unwrap_err();
    assert_eq!(error, InverseError::Blind { pixel: 6 });
    let single = Mat::from_fn(1, PIXELS, |_, j| j as f64);
    let error = reconstruction_matrix(&single, &prior, &[1.0], 1.0).unwrap_err();
    assert_eq!(error, InverseError::Blind { pixel: 6 });
}

#[test]
fn a_hyperparameter_lost_in_rounding_is_refused_with_the_least_that_is_not() {
    // Two measurements that are the same: M is singular.
    let jacobian = Mat::from_fn(2, 3, |_, j| j as f64 + 1.0);
    let prior = Prior::Diagonal(vec![1.0; 3]);
    let error = reconstruction_matrix(&jacobian, &prior, &[1.0; 2], 1e-12).unwrap_err();
    let InverseError::Rounding { hyperparameter, least } = error else { panic!("{error}") };
    assert_eq!(hyperparameter, 1e-12);
    assert!(reconstruction_matrix(&jacobian, &prior, &[1.0; 2], least).is_ok());
}

#[test]
fn weights_and_covariances_that_are_none_are_refused() {
    let weight = |weights: &[f64]| Whitening::from_weights(weights).unwrap_err();
    assert_eq!(weight(&[1.0, -2.0]), InverseError::Weight { measurement: 1, value: -2.0 });
    assert_eq!(weight(&[0.0, 0.0]), InverseError::Weight { measurement: 0, value: 0.0 });
    assert!(weight(&[1.0, f64::NAN]).to_string().contains("NaN for measurement 1"));
    let indefinite = Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { 2.0 });
    assert_eq!(Whitening::from_covariance(&indefinite).unwrap_err(), InverseError::Covariance);
}

#[test]
fn a_measurement_of_weight_zero_is_left_out() {
    let jacobian = Mat::from_fn(3, 4, |i, j| ((i + 2) * (j + 1) % 5) as f64);
    let prior = Prior::Diagonal(vec![1.0; 4]);
    let with = reconstruction_matrix(&jacobian, &prior, &[1.0, 0.0, 2.0], 0.3).unwrap();
    let less = Mat::from_fn(2, 4, |i, j| jacobian[(2 * i, j)]);
    let without = reconstruction_matrix(&less, &prior, &[1.0, 2.0], 0.3).unwrap();
    for pixel in 0..4 {
        assert_eq!(with[(pixel, 1)], 0.0);
        assert!((with[(pixel, 0)] - without[(pixel, 0)]).abs() < 1e-12);
        assert!((with[(pixel, 2)] - without[(pixel, 1)]).abs() < 1e-12);
    }
}

/// What EIDORS calls M in `calc_GREIT_RM`.
#[test]
fn a_trained_matrix_minimises_the_error_over_targets_and_noise() {
    let (answers, desired) = (
        Mat::from_fn(3, 6, |i, j| ((2 * i + 3 * j) % 7) as f64 - 3.0),
        Mat::from_fn(4, 6, |i, j| ((i + j) % 3) as f64),
    );
    let space = DataSpace::trained(&desired * answers.transpose(), &answers * answers.transpose(), 0.5);
    let got = space.matrix(0.8).unwrap();
    // The same as training with three more targets, noise of size 0.4 on one measurement each.
    let noisy = &answers * answers.transpose() + diagonal(&[0.16; 3]);
    let expected = solved(&noisy, &answers * desired.transpose()).transpose().to_owned();
    assert!(relative_error(&got, &expected) < 1e-10);
    let eigen = noisy.self_adjoint_eigen(Side::Lower).unwrap();
    let spectrum = space.spectrum().unwrap();
    for mode in 0..3 {
        assert!((spectrum.values[mode] + 0.16 - eigen.S().column_vector()[mode]).abs() < 1e-9);
    }
}
