//! Criteria against their definitions.

use super::*;
use crate::{
    inverse::{DataSpace, Whitening, figures},
    prior::Prior,
};
use faer::{
    Mat,
    linalg::solvers::{PartialPivLu, SolveCore},
};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// A smoothing problem whose singular values fall by many decades: data are blurred images of a
/// chain of pixels, and neighbours are alike.
struct Problem {
    jacobian: Mat<f64>,
    areas: Vec<f64>,
    space: DataSpace,
    spectrum: Spectrum,
}

const MEASUREMENTS: usize = 20;
const PIXELS: usize = 40;

impl Problem {
    fn new(prior: &Prior) -> Self {
        let jacobian = Mat::from_fn(MEASUREMENTS, PIXELS, |i, j| {
            let distance = (i as f64 + 0.5) / MEASUREMENTS as f64 - (j as f64 + 0.5) / PIXELS as f64;
            (-(distance / 0.12).powi(2)).exp() / PIXELS as f64
        });
        let whitening = Whitening::from_weights(&[1.0; MEASUREMENTS]).unwrap();
        let space = DataSpace::one_step(whitening.transposed(&jacobian), prior, None).unwrap();
        let areas = (0..PIXELS).map(|i| 1.0 + (i % 3) as f64).collect();
        Self { spectrum: space.spectrum().unwrap(), jacobian, areas, space }
    }

    fn laplace() -> Self {
        Self::new(&Prior::Laplace { pixels: PIXELS, neighbours: (1..PIXELS).map(|i| [i - 1, i]).collect() })
    }

    /// Answer to a bump in the middle.
    fn bump(&self) -> Vec<f64> {
        let image = Mat::from_fn(PIXELS, 1, |i, _| (-((i as f64 - 19.5) / 3.0).powi(2)).exp());
        (&self.jacobian * image).col(0).iter().copied().collect()
    }

    /// Noisy answers, `[measurement][frame]`.
    fn frames(&self, noise: f64, count: usize) -> Mat<f64> {
        let (bump, mut random) = (self.bump(), Pcg64Mcg::seed_from_u64(7));
        Mat::from_fn(MEASUREMENTS, count, |i, _| {
            let unit: f64 = StandardNormal.sample(&mut random);
            bump[i] + noise * unit
        })
    }

    fn frame(&self, noise: f64) -> Vec<f64> {
        self.frames(noise, 1).col(0).iter().copied().collect()
    }

    /// J K, which predicts the data from themselves.
    fn influence(&self, hyperparameter: f64) -> Mat<f64> {
        &self.jacobian * self.space.matrix(hyperparameter).unwrap()
    }

    fn image(&self, hyperparameter: f64, data: &[f64]) -> Vec<f64> {
        let data = Mat::from_fn(data.len(), 1, |i, _| data[i]);
        (self.space.matrix(hyperparameter).unwrap() * data).col(0).iter().copied().collect()
    }
}

fn residual(influence: &Mat<f64>, data: &[f64]) -> Vec<f64> {
    let predicted = influence * Mat::from_fn(data.len(), 1, |i, _| data[i]);
    data.iter().enumerate().map(|(i, y)| y - predicted[(i, 0)]).collect()
}

/// The definition, with dense matrices.
fn cross_validation_by_definition(problem: &Problem, data: &[f64], hyperparameter: f64) -> f64 {
    let influence = problem.influence(hyperparameter);
    let squares: f64 = residual(&influence, data).iter().map(|r| r * r).sum();
    let trace: f64 = (0..data.len()).map(|i| 1.0 - influence[(i, i)]).sum();
    squares / trace.powi(2)
}

#[test]
fn cross_validation_is_its_definition_and_finds_its_minimum() {
    let problem = Problem::laplace();
    let data = problem.frame(1e-3);
    let selection = cross_validation(&problem.spectrum, &data).unwrap();
    let value = |hyperparameter| cross_validation_by_definition(&problem, &data, hyperparameter);
    for point in selection.curve.iter().skip(20) {
        let expected = value(point.hyperparameter);
        assert!((point.ordinate / expected - 1.0).abs() < 1e-6, "{point:?} {expected}");
    }
    let chosen = selection.chosen.hyperparameter;
    let least = value(chosen);
    for exponent in -300..=300 {
        let other = value(chosen * 10_f64.powf(f64::from(exponent) / 100.0));
        assert!(other >= least * (1.0 - 1e-6), "{exponent}");
    }
}

/// Leaving measurements out one by one, with the matrix computed anew each time, leaves the errors
/// r_i / (1 - a_ii). Generalised cross-validation is their mean square where all a_ii are equal, as
/// here on a ring.
#[test]
fn on_a_ring_generalised_cross_validation_is_leaving_one_out() {
    const RING: usize = 12;
    let jacobian = Mat::from_fn(RING, RING, |i, j| {
        let distance = (i + RING - j) % RING;
        0.4_f64.powi(distance.min(RING - distance) as i32)
    });
    let prior = Prior::Diagonal(vec![1.0; RING]);
    let whitening = Whitening::from_weights(&[1.0; RING]).unwrap();
    let spectrum =
        DataSpace::one_step(whitening.transposed(&jacobian), &prior, None).unwrap().spectrum().unwrap();
    let data: Vec<f64> =
        (0..RING).map(|i| [0.3, 1.0, -0.2, 0.7, 0.1, -0.5][i % 6] + i as f64 / 20.0).collect();
    let selection = cross_validation(&spectrum, &data);
    let curve = match &selection {
        Ok(selection) => &selection.curve,
        Err(error) => panic!("{error}"),
    };
    for point in curve.iter().skip(30).step_by(5) {
        let squares: f64 = (0..RING)
            .map(|left_out| {
                let kept = |i: usize| if i < left_out { i } else { i + 1 };
                let less = Mat::from_fn(RING - 1, RING, |i, j| jacobian[(kept(i), j)]);
                let normal = less.transpose() * &less
                    + Mat::<f64>::identity(RING, RING) * faer::Scale(point.hyperparameter.powi(2));
                let mut image = less.transpose() * Mat::from_fn(RING - 1, 1, |i, _| data[kept(i)]);
                PartialPivLu::new(normal.as_ref()).solve_in_place_with_conj(faer::Conj::No, image.as_mut());
                let predicted = jacobian.subrows(left_out, 1) * image;
                (data[left_out] - predicted[(0, 0)]).powi(2)
            })
            .sum();
        // Sum of (r_i / (1 - a))^2 = |r|^2 / (1 - a)^2, and the trace is RING (1 - a).
        let expected = squares / (RING * RING) as f64;
        assert!((point.ordinate / expected - 1.0).abs() < 1e-6, "{point:?} {expected}");
    }
}

#[test]
fn cross_validation_comes_close_to_the_best_image_there_is() {
    let problem = Problem::laplace();
    let truth: Vec<f64> = (0..PIXELS).map(|i| (-((i as f64 - 19.5) / 3.0).powi(2)).exp()).collect();
    let data = problem.frame(1e-3);
    let error = |hyperparameter| -> f64 {
        let image = problem.image(hyperparameter, &data);
        image.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    let selection = cross_validation(&problem.spectrum, &data).unwrap();
    let best = selection.curve.iter().map(|point| error(point.hyperparameter)).fold(f64::INFINITY, f64::min);
    assert!(error(selection.chosen.hyperparameter) < 1.5 * best);
}

/// Components s of signal and 1e-4 of noise on modes s = 10^(-0.6 k). The image's size is that of the
/// signal, sum of s, as long as lambda is strong, and that of the noise, sum of 1e-8 s / (s + lambda^2)^2,
/// when it is weak. The corner lies where the two meet.
#[test]
fn the_corner_of_an_l_curve_is_where_noise_begins_to_make_the_image_large() {
    let values: Vec<f64> = (0..MEASUREMENTS).rev().map(|k| 10_f64.powf(-0.6 * k as f64)).collect();
    let data: Vec<f64> = values.iter().map(|s| s + 1e-4).collect();
    let signal: f64 = values.iter().sum();
    let noise = |lambda: f64| values.iter().map(|s| 1e-8 * s / (s + lambda * lambda).powi(2)).sum::<f64>();
    let spectrum =
        Spectrum { values: values.clone(), modes: Mat::identity(MEASUREMENTS, MEASUREMENTS), unit: 1.0 };
    let chosen = l_curve(&spectrum, &data).unwrap().chosen.hyperparameter;
    let crossing = spectrum.range(1000).into_iter().find(|&lambda| noise(lambda) < signal).unwrap();
    assert!((0.2..5.0).contains(&(chosen / crossing)), "{chosen:e} {crossing:e}");
}

#[test]
fn curvature_of_the_l_curve_agrees_with_differences_of_its_points() {
    let problem = Problem::laplace();
    let data = problem.frame(1e-3);
    let selection = l_curve(&problem.spectrum, &data).unwrap();
    let point = |hyperparameter: f64| {
        let influence = problem.influence(hyperparameter);
        residual(&influence, &data).iter().map(|r| r * r).sum::<f64>().sqrt()
    };
    for scanned in selection.curve.iter().skip(25).step_by(4) {
        assert!((scanned.abscissa / point(scanned.hyperparameter) - 1.0).abs() < 1e-6);
        let image = problem.image(scanned.hyperparameter, &data);
        let size: f64 = image.windows(2).map(|pair| 2.0 * (pair[0] - pair[1]).powi(2)).sum();
        assert!((scanned.ordinate / size.sqrt() - 1.0).abs() < 1e-6);
    }
    let curvature = |step: f64| {
        let at = |exponent: f64| {
            let h = selection.chosen.hyperparameter * (exponent * step).exp();
            let image = problem.image(h, &data);
            let size: f64 = image.windows(2).map(|pair| 2.0 * (pair[0] - pair[1]).powi(2)).sum();
            (point(h).ln(), size.ln() / 2.0)
        };
        let (a, b, c) = (at(-1.0), at(0.0), at(1.0));
        let (dx, dy) = ((c.0 - a.0) / 2.0, (c.1 - a.1) / 2.0);
        let (ddx, ddy) = (c.0 - 2.0 * b.0 + a.0, c.1 - 2.0 * b.1 + a.1);
        (dx * ddy - ddx * dy) / dx.hypot(dy).powi(3)
    };
    let sharpest = curvature(0.01);
    assert!(sharpest > 0.3);
}

#[test]
fn data_of_noise_alone_have_no_corner_or_no_minimum() {
    // Components that fall like the modes do: a straight line in the logarithmic plot.
    let values: Vec<f64> = (0..40).rev().map(|k| 10_f64.powf(-0.5 * k as f64)).collect();
    let data: Vec<f64> = values.iter().map(|s| s.powf(0.25)).collect();
    let spectrum = Spectrum { values: values.clone(), modes: Mat::identity(40, 40), unit: 1.0 };
    let error = l_curve(&spectrum, &data).unwrap_err();
    assert!(matches!(error, SelectionError::NoCorner { .. }), "{error}");
    assert!(error.to_string().contains("`inverse.hyperparameter` is \"l-curve\""));
    // Data without any noise: the weaker the better.
    let exact: Vec<f64> = values.clone();
    let error = cross_validation(&spectrum, &exact).unwrap_err();
    assert!(matches!(error, SelectionError::NoMinimum { criterion: "gcv", .. }), "{error}");
}

fn figure_of<'a>(problem: &'a Problem, signal: &'a [f64], noise: &'a [f64]) -> NoiseFigure<'a> {
    let data_snr = figures::signal_to_noise(signal, noise);
    NoiseFigure { signal, noise, data_snr, areas: &problem.areas }
}

/// Noise of different size on each measurement.
fn uneven_noise() -> Vec<f64> {
    (0..MEASUREMENTS).map(|i| 1e-3 * (1.0 + (i % 4) as f64)).collect()
}

#[test]
fn the_noise_figure_chosen_is_the_one_asked_for_and_the_formula_of_the_matrix() {
    for prior in [Problem::laplace(), Problem::new(&Prior::Diagonal(vec![1.0; PIXELS]))] {
        let (signal, noise) = (prior.bump(), uneven_noise());
        for asked in [0.5, 1.0, 2.0] {
            let selection =
                noise_figure(&prior.space, &prior.spectrum, &figure_of(&prior, &signal, &noise), asked)
                    .unwrap();
            let matrix = prior.space.matrix(selection.chosen.hyperparameter).unwrap();
            let got = figures::noise_figure(&matrix, &signal, &noise, &prior.areas);
            assert!((got / asked - 1.0).abs() < 1e-4, "{got}, not {asked}");
            assert!((selection.chosen.ordinate / asked - 1.0).abs() < 1e-4);
        }
    }
}

#[test]
fn the_noise_figure_agrees_with_many_noisy_frames() {
    let problem = Problem::laplace();
    let (signal, noise) = (problem.bump(), uneven_noise());
    let matrix = problem.space.matrix(3e-3).unwrap();
    let expected = figures::noise_figure(&matrix, &signal, &noise, &problem.areas);
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let frames = Mat::from_fn(MEASUREMENTS, 20_000, |i, _| {
        let unit: f64 = StandardNormal.sample(&mut random);
        noise[i] * unit
    });
    let images = &matrix * &frames;
    let mean_square = |values: &Mat<f64>, weights: &[f64]| {
        let rows =
            (0..values.nrows()).map(|i| values.row(i).iter().map(|v| (v * weights[i]).powi(2)).sum::<f64>());
        rows.sum::<f64>() / (values.nrows() * values.ncols()) as f64
    };
    let image = problem.image(3e-3, &signal);
    let mean = |values: &[f64], weights: &[f64]| {
        values.iter().zip(weights).map(|(v, w)| (v * w).abs()).sum::<f64>() / values.len() as f64
    };
    let ones = [1.0; MEASUREMENTS];
    let data_snr = mean(&signal, &ones) / mean_square(&frames, &ones).sqrt();
    let image_snr = mean(&image, &problem.areas) / mean_square(&images, &problem.areas).sqrt();
    let measured = data_snr / image_snr;
    assert!((measured / expected - 1.0).abs() < 0.01, "{measured} {expected}");
}

#[test]
fn a_noise_figure_out_of_reach_is_refused_with_the_range() {
    let problem = Problem::laplace();
    let (signal, noise) = (problem.bump(), uneven_noise());
    let error = noise_figure(&problem.space, &problem.spectrum, &figure_of(&problem, &signal, &noise), 1e-3)
        .unwrap_err();
    let SelectionError::NoiseFigure { asked, least, most } = error else { panic!("{error}") };
    assert_eq!(asked, 1e-3);
    assert!(least > 1e-3 && most > 10.0, "{least} {most}");
    assert!(error.to_string().contains("`inverse.noise_figure` is 0.001"));
    noise_figure(&problem.space, &problem.spectrum, &figure_of(&problem, &signal, &noise), 1.01 * least)
        .unwrap();
}

#[test]
fn best_resolution_is_weaker_where_there_is_less_noise() {
    let problem = Problem::laplace();
    let choose = |noise: f64| {
        let frames = problem.frames(noise, 200);
        best_resolution(&problem.space, &problem.spectrum, &frames, &problem.areas).unwrap()
    };
    let (quiet, noisy) = (choose(1e-4), choose(5e-2));
    assert!(quiet.chosen.hyperparameter < noisy.chosen.hyperparameter / 3.0, "{quiet:?} {noisy:?}");
    assert!(quiet.chosen.ordinate < noisy.chosen.ordinate);
    for selection in [quiet, noisy] {
        let least = selection.curve.iter().map(|point| point.ordinate).fold(f64::INFINITY, f64::min);
        assert_eq!(selection.chosen.ordinate, least);
    }
}
