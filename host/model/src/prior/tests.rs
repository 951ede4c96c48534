//! Priors against their definitions.

use super::*;
use faer::Mat;
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

/// A grid of square pixels, `pitch` apart.
fn squares(columns: usize, rows: usize, pitch: f64) -> Pixels {
    let places: Vec<_> = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))).collect();
    let number = |column: usize, row: usize| row * columns + column;
    let right =
        places.iter().filter(|(c, _)| c + 1 < columns).map(|&(c, r)| [number(c, r), number(c + 1, r)]);
    let up = places.iter().filter(|(_, r)| r + 1 < rows).map(|&(c, r)| [number(c, r), number(c, r + 1)]);
    Pixels {
        elements: vec![Vec::new(); places.len()],
        neighbours: right.chain(up).collect(),
        centres: places.iter().map(|&(c, r)| Point3::new(c as f64, r as f64, 0.0) * pitch).collect(),
        normals: vec![Vector3::z(); places.len()],
        areas: vec![pitch * pitch; places.len()],
        grid: None,
    }
}

fn dense(prior: &Prior, pixels: usize) -> Mat<f64> {
    let mut matrix = Mat::zeros(pixels, pixels);
    for (row, col, value) in prior.entries().unwrap() {
        matrix[(row, col)] += value;
    }
    matrix
}

fn largest(matrix: &Mat<f64>) -> f64 {
    (0..matrix.ncols())
        .flat_map(|j| matrix.col(j).iter().map(|v| v.abs()).collect::<Vec<_>>())
        .fold(0.0, f64::max)
}

/// Some Jacobian, `[measurement][pixel]`.
fn jacobian(measurements: usize, pixels: usize) -> Mat<f64> {
    Mat::from_fn(measurements, pixels, |i, j| ((3 * i + 7 * j + i * j) % 11) as f64 - 4.5)
}

const KINDS: [skin::Prior; 5] = [
    skin::Prior::Laplace,
    skin::Prior::SquaredLaplace,
    skin::Prior::Tikhonov,
    skin::Prior::Noser { exponent: 0.7 },
    skin::Prior::Gaussian { diameter: 0.2 },
];

proptest! {
    /// R G b = b for every b that is orthogonal to the constants R is blind to; G is symmetric.
    #[test]
    fn solving_inverts_each_prior(values in prop::collection::vec(-1.0..1.0_f64, 42)) {
        let pixels = squares(7, 6, 0.01);
        let mean = values.iter().sum::<f64>() / 42.0;
        for kind in KINDS {
            let prior = Prior::new(kind, &pixels, &jacobian(5, 42), &[1.0, 2.0, 0.5, 1.0, 3.0]);
            let level = if prior.blind_parts().1 > 0 { mean } else { 0.0 };
            let rhs = Mat::from_fn(42, 1, |i, _| values[i] - level);
            let solution = prior.solve(rhs.clone()).unwrap();
            let error = largest(&(dense(&prior, 42) * solution - &rhs));
            prop_assert!(error < 1e-9, "{kind:?}: {error:e}");
        }
        let inverse = Prior::new(KINDS[1], &pixels, &jacobian(5, 42), &[1.0; 5]).solve(Mat::identity(42, 42)).unwrap();
        prop_assert!(largest(&(&inverse - inverse.transpose())) < 1e-9 * largest(&inverse));
    }
}

#[test]
fn squared_laplace_is_the_laplacian_times_itself() {
    let pixels = squares(4, 3, 0.01);
    let [single, squared] =
        [KINDS[0], KINDS[1]].map(|kind| dense(&Prior::new(kind, &pixels, &jacobian(2, 12), &[1.0; 2]), 12));
    let half = single * faer::Scale(0.5);
    assert!(largest(&(&half * &half - squared)) < 1e-12);
}

#[test]
fn inside_a_grid_the_laplacian_is_the_thesis_equation_3_1_with_four_neighbours() {
    let laplacian = dense(&Prior::new(KINDS[0], &squares(3, 3, 1.0), &jacobian(2, 9), &[1.0; 2]), 9);
    let row: Vec<f64> = laplacian.row(4).iter().map(|value| value / 2.0).collect();
    assert_eq!(row, [0.0, -1.0, 0.0, -1.0, 4.0, -1.0, 0.0, -1.0, 0.0]);
}

#[test]
fn noser_is_a_power_of_the_diagonal_of_the_weighted_normal_matrix() {
    let (jacobian, weights) = (jacobian(3, 4), [1.0, 2.0, 5.0]);
    let pixels = squares(2, 2, 1.0);
    for exponent in [0.0, 0.5, 1.0] {
        let Prior::Diagonal(diagonal) =
            Prior::new(skin::Prior::Noser { exponent }, &pixels, &jacobian, &weights)
        else {
            panic!("NOSER is diagonal")
        };
        let weighted = Mat::from_fn(3, 4, |i, j| weights[i] * jacobian[(i, j)]);
        let normal = jacobian.transpose() * weighted;
        for (pixel, value) in diagonal.iter().enumerate() {
            assert!((value - normal[(pixel, pixel)].powf(exponent)).abs() < 1e-12);
        }
    }
}

#[test]
fn a_pixel_that_no_measurement_answers_to_is_named() {
    let mut jacobian = jacobian(3, 4);
    (0..3).for_each(|i| jacobian[(i, 2)] = 0.0);
    let prior = Prior::new(skin::Prior::Noser { exponent: 0.5 }, &squares(2, 2, 1.0), &jacobian, &[1.0; 3]);
    let error = prior.solve(Mat::identity(4, 4)).unwrap_err();
    assert_eq!(error, PriorError::Singular { pixel: 2 });
}

/// Away from the rim the filter's Gaussian has integral 1, so a constant comes out as zero; an image
/// that alternates from pixel to pixel goes through.
#[test]
fn a_high_pass_stops_constants_and_passes_what_alternates() {
    let filter = HighPass::new(&squares(31, 31, 0.01), 0.1).filter().unwrap();
    let middle = 15 * 31 + 15;
    let of_constant: f64 = filter.row(middle).iter().sum();
    let of_alternating: f64 =
        filter.row(middle).iter().enumerate().map(|(i, v)| if i % 2 == 0 { *v } else { -v }).sum();
    assert!(of_constant.abs() < 1e-6, "{of_constant}");
    assert!((of_alternating - 1.0).abs() < 0.01, "{of_alternating}");
}

/// The Gaussian falls to half its height half a diameter away: of 0.4 times 31 pixels, 6.2 pixels.
#[test]
fn a_high_pass_has_the_diameter_that_is_asked_for() {
    let filter = HighPass::new(&squares(31, 31, 0.01), 0.4).filter().unwrap();
    let middle = 15 * 31 + 15;
    let height = |distance: usize| -filter[(middle, middle + distance)] / (1.0 - filter[(middle, middle)]);
    assert!(height(6) > 0.5 && height(7) < 0.5, "{} {}", height(6), height(7));
}

/// Pixels as far apart as the Gaussian is wide, away from the rim: their shares, 1.02 in all, were more than its
/// integral.
#[test]
fn a_high_pass_of_pixels_as_large_as_its_gaussian_is_regular() {
    let pixels = squares(20, 20, 0.01);
    let filter = HighPass::new(&pixels, 0.05);
    let eigenvalues = filter.filter().unwrap().self_adjoint_eigenvalues(faer::Side::Lower).unwrap();
    assert!(eigenvalues.iter().all(|&value| value > 0.0 && value < 2.0), "{eigenvalues:?}");
    let prior = Prior::HighPass(filter);
    let rhs = Mat::from_fn(400, 1, |i, _| ((7 * i) % 13) as f64 - 6.0);
    let error = largest(&(dense(&prior, 400) * prior.solve(rhs.clone()).unwrap() - &rhs));
    assert!(error < 1e-9, "{error:e}");
}
