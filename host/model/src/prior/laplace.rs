//! The graph Laplacian of neighbouring pixels.

use super::PriorError;
use crate::forward::solve_columns;
use faer::{
    Mat, Side,
    linalg::solvers::SolveCore,
    reborrow::Reborrow,
    sparse::{SparseColMat, Triplet, linalg::solvers::Llt},
};
use std::collections::BTreeMap;

/// Entries of `factor` times the graph Laplacian; entries of one place are to be added.
pub(super) fn entries(neighbours: &[[usize; 2]], factor: f64) -> Vec<(usize, usize, f64)> {
    let pair = |&[a, b]: &[usize; 2]| [(a, a, factor), (b, b, factor), (a, b, -factor), (b, a, -factor)];
    neighbours.iter().flat_map(pair).collect()
}

/// Entries of the product of the graph Laplacian with itself, one for each place.
pub(super) fn squared_entries(pixels: usize, neighbours: &[[usize; 2]]) -> Vec<(usize, usize, f64)> {
    let mut rows = vec![BTreeMap::<usize, f64>::new(); pixels];
    for (row, col, value) in entries(neighbours, 1.0) {
        *rows[row].entry(col).or_default() += value;
    }
    let product = |row: usize| {
        let mut sums = BTreeMap::<usize, f64>::new();
        for (&middle, left) in &rows[row] {
            rows[middle].iter().for_each(|(&col, right)| *sums.entry(col).or_default() += left * right);
        }
        sums.into_iter().map(move |(col, value)| (row, col, value))
    };
    (0..pixels).flat_map(product).collect()
}

/// The part of each pixel, and the number of parts: pixels of one part are linked by neighbours.
pub(super) fn connected_parts(pixels: usize, neighbours: &[[usize; 2]]) -> (Vec<usize>, usize) {
    let mut adjacent = vec![Vec::new(); pixels];
    for &[a, b] in neighbours {
        adjacent[a].push(b);
        adjacent[b].push(a);
    }
    let mut part = vec![usize::MAX; pixels];
    let mut count = 0;
    for start in 0..pixels {
        let mut waiting = if part[start] == usize::MAX { vec![start] } else { continue };
        while let Some(pixel) = waiting.pop() {
            if part[pixel] == usize::MAX {
                part[pixel] = count;
                waiting.extend(&adjacent[pixel]);
            }
        }
        count += 1;
    }
    (part, count)
}

/// The Laplacian, factored with one pixel of each part held at zero.
pub(super) struct Laplacian {
    part_of_pixel: Vec<usize>,
    /// First pixel of each part: `[part]`.
    held: Vec<usize>,
    /// Pixels of each part: `[part]`.
    sizes: Vec<f64>,
    factor: Llt<usize, f64>,
}

impl Laplacian {
    pub(super) fn new(pixels: usize, neighbours: &[[usize; 2]], factor: f64) -> Result<Self, PriorError> {
        let (part_of_pixel, count) = connected_parts(pixels, neighbours);
        let mut held = vec![usize::MAX; count];
        let mut sizes = vec![0.0; count];
        for (pixel, &part) in part_of_pixel.iter().enumerate() {
            held[part] = held[part].min(pixel);
            sizes[part] += 1.0;
        }
        let factor = factored(pixels, neighbours, factor, |pixel| held[part_of_pixel[pixel]] == pixel)?;
        Ok(Self { part_of_pixel, held, sizes, factor })
    }

    /// Solves for every column; held pixels are zero in the solution.
    pub(super) fn solve(&self, mut rhs: Mat<f64>) -> Result<Mat<f64>, PriorError> {
        for mut column in rhs.col_iter_mut() {
            self.held.iter().for_each(|&pixel| column[pixel] = 0.0);
        }
        Ok(solve_columns(rhs, |columns| self.factor.solve_in_place_with_conj(faer::Conj::No, columns)))
    }

    /// Solves twice; taking out the means between makes the inverse of the square symmetric.
    pub(super) fn solve_twice(&self, rhs: Mat<f64>) -> Result<Mat<f64>, PriorError> {
        let once = self.centred(self.solve(self.centred(rhs))?);
        Ok(self.centred(self.solve(once)?))
    }

    /// Takes the mean of each part out of every column.
    fn centred(&self, mut columns: Mat<f64>) -> Mat<f64> {
        for column in columns.col_iter_mut() {
            let mut means = vec![0.0; self.sizes.len()];
            for (value, &part) in column.rb().iter().zip(&self.part_of_pixel) {
                means[part] += value / self.sizes[part];
            }
            column.iter_mut().zip(&self.part_of_pixel).for_each(|(value, &part)| *value -= means[part]);
        }
        columns
    }
}

fn factored(
    pixels: usize,
    neighbours: &[[usize; 2]],
    factor: f64,
    is_held: impl Fn(usize) -> bool,
) -> Result<Llt<usize, f64>, PriorError> {
    let failed = |error: String| PriorError::Solver(error);
    let lower = entries(neighbours, factor)
        .into_iter()
        .filter(|&(row, col, _)| row >= col && !is_held(row) && !is_held(col));
    let unit = (0..pixels).filter(|&pixel| is_held(pixel)).map(|pixel| (pixel, pixel, 1.0));
    let triplets: Vec<_> = lower.chain(unit).map(|(row, col, val)| Triplet { row, col, val }).collect();
    let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(pixels, pixels, &triplets)
        .map_err(|error| failed(format!("{error:?}")))?;
    matrix.sp_cholesky(Side::Lower).map_err(|error| failed(format!("{error:?}")))
}
