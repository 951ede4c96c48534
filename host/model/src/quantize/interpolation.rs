//! Interpolation: which pixels a board computes from the data, and how the others follow from those.
//!
//! The rows of neighbouring pixels are nearly dependent on the data that occur. Pixels are halved again and again
//! into tiles of some fifty. In each, from the smallest to the halves, some pixels are picked until all others
//! follow from them (interpolative decomposition, Cheng et al., SIAM J. Sci. Comput. 26(4), 2005, by a pivoted
//! Cholesky factorisation); those that were picked go on to the next larger tile. A board goes the other way.

use crate::pixels::halving::Halves;
use dermatome_shared::patch::matrix::{GROUP, HEADROOM_BITS, INTERPOLATION_EXPONENT, MOST_OF_ROW};
use faer::{ColRef, Mat, RowRef, Side};
use nalgebra::Point3;
use rand::{Rng, SeedableRng};

/// Pixels of the smallest tiles, about.
const SMALLEST: f64 = 50.0;
/// Error at which picking begins to stop, of the peak; less where the images tried ask for it.
const TOLERANCE: f64 = 2.5e-3;
/// The largest errors of images of presses and of noise alone, of their peaks.
const MOST: [f64; 2] = [1e-3, 2e-3];
/// Images of noise that are tried.
const NOISE_IMAGES: usize = 64;
/// Where fewer of a tile's pixels than this share would follow from the others, none does.
const WORTHWHILE: f64 = 0.1;

/// How the pixels follow from data.
#[derive(Clone, Debug)]
pub(super) struct Interpolated {
    /// Which pixel is known at which position: `[position]`.
    pub order: Vec<usize>,
    /// Pixels from the data, the first ones.
    pub from_data: usize,
    /// How the next ones follow.
    pub interpolations: Vec<Interpolation>,
}

/// Pixels that follow from known ones.
#[derive(Clone, Debug)]
pub(super) struct Interpolation {
    /// Positions of what they follow from.
    pub inputs: Vec<usize>,
    /// `[output][input]`.
    pub weights: Mat<f64>,
}

/// The data that occur: what an interpolation must get right.
#[derive(Clone, Debug)]
pub(super) struct Occurring {
    /// Difference data of presses: `[measurement][press]`.
    pub presses: Mat<f64>,
    /// Noise, in proportion: `[measurement]`.
    pub noise: Vec<f64>,
}

impl Interpolated {
    /// Every pixel from the data.
    #[must_use]
    pub(super) fn none(pixels: usize) -> Self {
        Self { order: (0..pixels).collect(), from_data: pixels, interpolations: Vec::new() }
    }

    /// Finds it for a matrix `[pixel][measurement]`: the presses' images are off by at most 0.1 % of their peaks,
    /// those of noise by 0.2 %.
    #[must_use]
    pub(super) fn new(matrix: &Mat<f64>, centres: &[Point3<f64>], data: &Occurring) -> Self {
        let tried = Tried::new(matrix, data);
        let Some(rows) = weighed_rows(matrix, data) else { return Self::none(matrix.nrows()) };
        let tiles = tiles(centres);
        let mut tolerance = TOLERANCE;
        for _ in 0..24 {
            let found = from_largest(pick(&rows, tiles.clone(), tolerance), matrix.nrows());
            if found.work(matrix.ncols()) >= matrix.nrows() * matrix.ncols() {
                break;
            }
            if tried.is_kept_by(&found) {
                return found;
            }
            tolerance *= 0.85;
        }
        Self::none(matrix.nrows())
    }

    /// What it costs a board, in products: by the cycles of the emulated one an input takes as long as 3 products, and
    /// a step as 110 more.
    fn work(&self, measurements: usize) -> usize {
        let of_step = |step: &Interpolation| step.inputs.len() * (step.weights.nrows() + 3) + 110;
        measurements * self.from_data + self.interpolations.iter().map(of_step).sum::<usize>()
    }

    /// Values of all pixels from those of the pixels from data: `[pixel][image]`, of which the others are ignored.
    fn apply(&self, images: &Mat<f64>) -> Mat<f64> {
        let mut known = Mat::zeros(images.nrows(), images.ncols());
        for (position, &pixel) in self.order[..self.from_data].iter().enumerate() {
            known.row_mut(position).copy_from(images.row(pixel));
        }
        let largest =
            |image| (0..self.from_data).fold(0.0, |max: f64, i| max.max(f64::abs(known[(i, image)])));
        // As a board does.
        let most = f64::from(1 << HEADROOM_BITS);
        let cut: Vec<f64> = (0..images.ncols()).map(|image| most * largest(image)).collect();
        let mut next = self.from_data;
        for step in &self.interpolations {
            let inputs = Mat::from_fn(step.inputs.len(), images.ncols(), |i, image| {
                known[(step.inputs[i], image)].max(-cut[image]).min(cut[image])
            });
            let outputs = &step.weights * inputs;
            known.subrows_mut(next, outputs.nrows()).copy_from(&outputs);
            next += outputs.nrows();
        }
        let mut of_pixels = known.clone();
        for (position, &pixel) in self.order.iter().enumerate() {
            of_pixels.row_mut(pixel).copy_from(known.row(position));
        }
        of_pixels
    }
}

/// Images by which an interpolation is judged.
struct Tried {
    /// `[pixel][image]`: those of presses with some noise, then those of noise.
    images: Mat<f64>,
    presses: usize,
}

impl Tried {
    fn new(matrix: &Mat<f64>, data: &Occurring) -> Self {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(2);
        let presses = data.presses.ncols();
        let strength = |press: ColRef<'_, f64>| {
            press.iter().zip(&data.noise).fold(0.0, |max: f64, (value, noise)| max.max((value / noise).abs()))
        };
        let strengths: Vec<f64> = data.presses.col_iter().map(strength).collect();
        let frames = Mat::from_fn(data.noise.len(), presses + NOISE_IMAGES, |m, image| {
            let noise = data.noise[m] * random.random_range(-1.0..1.0);
            if image < presses { data.presses[(m, image)] + 0.01 * strengths[image] * noise } else { noise }
        });
        Self { images: matrix * frames, presses }
    }

    fn is_kept_by(&self, interpolated: &Interpolated) -> bool {
        let found = interpolated.apply(&self.images);
        (0..self.images.ncols()).all(|image| {
            let exact = self.images.col(image);
            let error = (exact - found.col(image)).norm_max();
            error <= exact.norm_max() * MOST[usize::from(image >= self.presses)]
        })
    }
}

/// The rows in a measure in which their lengths are the sizes of pixels in the images that occur, with a peak of
/// one: `[pixel][any]`. None if the data are not finite, or the images zero.
fn weighed_rows(matrix: &Mat<f64>, data: &Occurring) -> Option<Mat<f64>> {
    // Of so many presses one is near a given pixel; the image's noise is this share of a press.
    const PRESSES_FOR_ONE_NEAR: f64 = 20.0;
    const NOISE: f64 = 0.5;
    let presses = data.presses.ncols();
    let images = matrix * &data.presses;
    let share = (PRESSES_FOR_ONE_NEAR / presses as f64).sqrt();
    let factors: Vec<f64> = images.col_iter().map(|image| share / image.norm_max()).collect();
    let of_peak =
        Mat::from_fn(data.noise.len(), presses, |m, image| data.presses[(m, image)] * factors[image]);
    let noise_of = |row: usize| {
        matrix.row(row).iter().zip(&data.noise).map(|(c, noise)| (c * noise).powi(2)).sum::<f64>().sqrt()
    };
    let image_noise = (0..matrix.nrows()).map(noise_of).fold(0.0, f64::max);
    let noise = NOISE / image_noise;
    let mut covariance = &of_peak * of_peak.transpose();
    for (m, of_measurement) in data.noise.iter().enumerate() {
        covariance[(m, m)] += (of_measurement * noise).powi(2);
    }
    let rows = matrix * covariance.llt(Side::Lower).ok()?.L();
    let is_finite = rows.col_iter().all(|column| column.iter().all(|value| value.is_finite()));
    is_finite.then_some(rows)
}

/// Pixels halved by place until each tile has about [`SMALLEST`]; a power of two of tiles.
fn tiles(centres: &[Point3<f64>]) -> Vec<Vec<usize>> {
    let times = (centres.len() as f64 / SMALLEST).log2().round().max(0.0) as u32;
    let sorted = |tile: &[usize]| {
        let mut tile = tile.to_vec();
        tile.sort_unstable();
        tile
    };
    Halves::new(centres, 1 << times).parts().map(sorted).collect()
}

/// Pixels of a tile that follow from others.
struct Picked {
    inputs: Vec<usize>,
    outputs: Vec<usize>,
    weights: Mat<f64>,
    /// Those that follow, but not by what a board holds.
    others: Vec<usize>,
}

/// Interpolations from the smallest tiles to the halves, and the pixels that are left in the end.
fn pick(rows: &Mat<f64>, mut tiles: Vec<Vec<usize>>, tolerance: f64) -> (Vec<Picked>, Vec<usize>) {
    let mut steps = Vec::new();
    loop {
        let mut kept: Vec<Vec<usize>> = Vec::with_capacity(tiles.len());
        for tile in tiles {
            let step = pick_in(rows, &tile, tolerance);
            kept.push(step.as_ref().map_or(tile, |step| [&step.inputs[..], &step.others].concat()));
            steps.extend(step);
        }
        // One step from the halves to the whole would spare nothing.
        if kept.len() <= 2 {
            return (steps, kept.concat());
        }
        tiles = kept.chunks(2).map(<[_]>::concat).collect();
    }
}

/// Picks pixels of a tile until the others follow from them within the tolerance; none if that spares nothing.
fn pick_in(rows: &Mat<f64>, tile: &[usize], tolerance: f64) -> Option<Picked> {
    let own = Mat::from_fn(tile.len(), rows.ncols(), |i, j| rows[(tile[i], j)]);
    let (pivots, factor) = pivoted_cholesky(&(&own * own.transpose()), tolerance);
    let mut is_pivot = vec![false; tile.len()];
    pivots.iter().for_each(|&pivot| is_pivot[pivot] = true);
    let follow: Vec<usize> = (0..tile.len()).filter(|&i| !is_pivot[i]).collect();
    let mut weights = Mat::from_fn(follow.len(), pivots.len(), |i, j| factor[j][follow[i]]);
    // weights * (the pivots' rows of the factor, a triangle) = the others' rows.
    for column in (0..pivots.len()).rev() {
        for output in 0..follow.len() {
            let known = (column + 1..pivots.len()).map(|k| weights[(output, k)] * factor[column][pivots[k]]);
            let known: f64 = known.sum();
            weights[(output, column)] = (weights[(output, column)] - known) / factor[column][pivots[column]];
        }
    }
    let rows = follow.into_iter().enumerate();
    let (held, others): (Vec<_>, Vec<_>) = rows.partition(|&(row, _)| fits_a_board(weights.row(row)));
    let pixels = |of: &[(usize, usize)]| of.iter().map(|&(_, i)| tile[i]).collect();
    let is_worthwhile = held.len() as f64 >= WORTHWHILE * tile.len() as f64;
    is_worthwhile.then(|| Picked {
        inputs: pivots.iter().map(|&i| tile[i]).collect(),
        outputs: pixels(&held),
        weights: Mat::from_fn(held.len(), pivots.len(), |i, j| weights[(held[i].0, j)]),
        others: pixels(&others),
    })
}

/// Whether the weights of a pixel, rounded, add up to no more than a board's sums hold.
fn fits_a_board(weights: RowRef<'_, f64>) -> bool {
    let step = (-f64::from(INTERPOLATION_EXPONENT)).exp2();
    let sizes = || weights.iter().map(|weight| weight.abs() + step);
    sizes().sum::<f64>() < f64::from(MOST_OF_ROW) * step && sizes().all(|size| size < 32_767.0 * step)
}

/// Pivots in their order, a multiple of [`GROUP`] if there are enough, and the columns of the factor.
fn pivoted_cholesky(gram: &Mat<f64>, tolerance: f64) -> (Vec<usize>, Vec<Vec<f64>>) {
    let mut left: Vec<f64> = (0..gram.nrows()).map(|i| gram[(i, i)]).collect();
    let negligible = 1e-12 * left.iter().fold(0.0, |max: f64, value| max.max(*value));
    let (mut pivots, mut factor) = (Vec::new(), Vec::<Vec<f64>>::new());
    while let Some(pivot) = (0..left.len()).max_by(|&a, &b| left[a].total_cmp(&left[b])) {
        let is_enough = left[pivot] <= tolerance.powi(2) && pivots.len().is_multiple_of(GROUP);
        if is_enough || left[pivot] <= negligible {
            break;
        }
        let root = left[pivot].sqrt();
        let mut column: Vec<f64> = gram.col(pivot).iter().copied().collect();
        for earlier in &factor {
            let factor = earlier[pivot];
            column.iter_mut().zip(earlier).for_each(|(value, earlier)| *value -= factor * earlier);
        }
        column.iter_mut().for_each(|value| *value /= root);
        left.iter_mut().zip(&column).for_each(|(left, value)| *left -= value * value);
        left[pivot] = f64::NEG_INFINITY;
        pivots.push(pivot);
        factor.push(column);
    }
    (pivots, factor)
}

/// Turns the interpolations round: pixels from data first, then from the halves to the smallest tiles.
fn from_largest((steps, from_data): (Vec<Picked>, Vec<usize>), pixels: usize) -> Interpolated {
    let mut order = from_data;
    let mut position = vec![usize::MAX; pixels];
    let from_data = order.len();
    order.iter().enumerate().for_each(|(at, &pixel)| position[pixel] = at);
    let mut turned = Vec::with_capacity(steps.len());
    for step in steps.into_iter().rev() {
        for pixel in step.outputs {
            position[pixel] = order.len();
            order.push(pixel);
        }
        let inputs = step.inputs.iter().map(|&pixel| position[pixel]).collect();
        turned.push(Interpolation { inputs, weights: step.weights });
    }
    Interpolated { order, from_data, interpolations: turned }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Pixels on a square whose rows are waves: the nearer two pixels, the more alike.
    fn smooth(across: usize) -> (Mat<f64>, Vec<Point3<f64>>, Occurring) {
        let place = |pixel: usize| [pixel % across, pixel / across].map(|i| i as f64 / across as f64);
        let centres = (0..across * across).map(|pixel| Point3::new(place(pixel)[0], place(pixel)[1], 0.0));
        let wave = |pixel: usize, m: usize| {
            let [x, y] = place(pixel);
            let (along, across) = ((m % 10) as f64, (m / 10) as f64);
            (TAU / 4.0 * along * x + 0.3).cos() * (TAU / 4.0 * across * y + 0.2).cos()
                / (1.0 + along + across).powi(2)
        };
        let matrix = Mat::from_fn(across * across, 80, wave);
        let presses = Mat::from_fn(80, across * across, |m, pixel| wave(pixel, m));
        (matrix, centres.collect(), Occurring { presses, noise: vec![1.0; 80] })
    }

    /// The largest error of images, of their peaks.
    fn worst(interpolated: &Interpolated, images: &Mat<f64>) -> f64 {
        let found = interpolated.apply(images);
        let of_image =
            |image: usize| (images.col(image) - found.col(image)).norm_max() / images.col(image).norm_max();
        (0..images.ncols()).map(of_image).fold(0.0, f64::max)
    }

    #[test]
    fn presses_that_were_not_tried_are_kept_with_half_the_products() {
        let (matrix, centres, data) = smooth(28);
        let interpolated = Interpolated::new(&matrix, &centres, &data);
        let of_step = |step: &Interpolation| step.weights.nrows() * step.inputs.len();
        let products =
            80 * interpolated.from_data + interpolated.interpolations.iter().map(of_step).sum::<usize>();
        assert!(products < matrix.nrows() * 80 / 2, "{products}");
        let wide = Mat::from_fn(80, 27 * 27, |m, i| {
            let corner = i / 27 * 28 + i % 27;
            [0, 1, 28, 29].map(|next| data.presses[(m, corner + next)]).iter().sum::<f64>()
        });
        let error = worst(&interpolated, &(&matrix * wide));
        assert!(error <= 2e-3, "{error}");
        let mut order = interpolated.order.clone();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..784));
    }

    #[test]
    fn what_cannot_be_interpolated_comes_from_the_data() {
        let (matrix, centres, data) = smooth(3);
        let few = Interpolated::new(&matrix, &centres, &data);
        assert_eq!((few.from_data, few.interpolations.len()), (9, 0));
        let (mut matrix, centres, data) = smooth(16);
        matrix[(3, 4)] = f64::NAN;
        assert_eq!(Interpolated::new(&matrix, &centres, &data).from_data, 256);
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        let rough = Mat::from_fn(256, 80, |_, _| random.random_range(-1.0..1.0));
        let interpolated = Interpolated::new(&rough, &centres, &data);
        let error = worst(&interpolated, &(&rough * &data.presses));
        assert!(error <= 2e-3, "{error}");
    }
}
