//! Jacobian: how each measurement answers to each pixel's conductivity.
//!
//! dV/dsigma of one element is minus the integral over it of grad u_drive . grad u_sense, with
//! u_sense the field of unit current through the sensing pair (adjoint fields). Both are
//! differences of electrode fields, so an element contributes the Gram matrix of all electrode
//! fields' gradients, and pixels add up Gram matrices: nothing is ever stored per element.

use crate::{
    forward::{Admittivity, Fields},
    pixels::Pixels,
};
use dermatome_geometry::mesh::Mesh;
use dermatome_shared::{patch::CombinedInto, stimulation::Step};
use faer::Mat;
use rayon::prelude::*;

/// d voltage / d relative conductivity at unit current: `[step][pixel]`.
#[must_use]
pub fn jacobian<T: Admittivity>(mesh: &Mesh, fields: &Fields<T>, steps: &[Step], pixels: &Pixels) -> Mat<T> {
    let mut jacobian = Mat::from_fn(steps.len(), pixels.count(), |_, _| T::default());
    let share = pixels.count().div_ceil(SHARES).max(1);
    jacobian.par_col_chunks_mut(share).zip(pixels.elements.par_chunks(share)).for_each(|(columns, parts)| {
        let mut gram = Gram::new(fields.electrodes());
        for (parts, column) in parts.iter().zip(columns.col_iter_mut()) {
            gram.fill(mesh, fields, parts);
            column.iter_mut().zip(steps).for_each(|(entry, step)| *entry = gram.entry(step));
        }
    });
    jacobian
}

/// The pixels are worked on in this many parts, so that no core waits long for another.
const SHARES: usize = 64;

/// Sum over elements of the products of the gradients of all electrode fields, lower half:
/// `[electrode][electrode]`.
struct Gram<T> {
    electrodes: usize,
    sums: Vec<T>,
    /// Gradients in one element: `[axis][electrode]`.
    along: [Vec<T>; 2],
}

impl<T: Admittivity> Gram<T> {
    fn new(electrodes: usize) -> Self {
        let row = || vec![T::default(); electrodes];
        Self { electrodes, sums: vec![T::default(); electrodes * electrodes], along: [row(), row()] }
    }

    fn fill(&mut self, mesh: &Mesh, fields: &Fields<T>, parts: &[(usize, f64)]) {
        self.sums.fill(T::default());
        for &(element, weight) in parts {
            gradients(mesh, fields, element, &mut self.along);
            self.add(weight);
        }
    }

    /// Entry of the Jacobian.
    fn entry(&self, step: &Step) -> T {
        let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
        (self.at(sp, dm) - self.at(sp, dp)) - (self.at(sm, dm) - self.at(sm, dp))
    }

    fn at(&self, a: usize, b: usize) -> T {
        self.sums[a.max(b) * self.electrodes + a.min(b)]
    }

    fn add(&mut self, weight: f64) {
        let [x, y] = &self.along;
        for (a, row) in self.sums.chunks_exact_mut(self.electrodes).enumerate() {
            let (xa, ya) = (x[a] * weight, y[a] * weight);
            for ((sum, &xb), &yb) in row[..=a].iter_mut().zip(x).zip(y) {
                *sum = *sum + (xa * xb + ya * yb);
            }
        }
    }
}

/// Gradients of all electrode fields in one element, times the root of its area:
/// `[axis][electrode]`.
fn gradients<T: Admittivity>(mesh: &Mesh, fields: &Fields<T>, element: usize, along: &mut [Vec<T>; 2]) {
    let shape = fields.sheet().gradients(element, mesh.corners(element));
    let [p, q, r] = mesh.elements[element].map(|node| fields.at(node));
    for (axis, row) in along.iter_mut().zip(shape.0) {
        for (((g, &p), &q), &r) in axis.iter_mut().zip(p).zip(q).zip(r) {
            *g = p * row[0] + q * row[1] + r * row[2];
        }
    }
}

/// Averages the in-phase rows of steps that share a measurement: `[measurement][pixel]`.
#[must_use]
pub fn combine_rows<T: Admittivity>(jacobian: &Mat<T>, combination: &[CombinedInto]) -> Mat<f64> {
    let counts = step_counts(combination);
    let mut combined = Mat::zeros(counts.len(), jacobian.ncols());
    combined.par_col_iter_mut().zip(jacobian.par_col_iter()).for_each(|(mut sums, steps)| {
        for (value, target) in steps.iter().zip(combination) {
            let row = usize::from(target.measurement);
            sums[row] += sign(target) * value.in_phase() / counts[row];
        }
    });
    combined
}

/// Averages the voltages of steps that share a measurement: `[measurement]`.
#[must_use]
pub fn combine_voltages(voltages: &[f64], combination: &[CombinedInto]) -> Vec<f64> {
    let counts = step_counts(combination);
    let mut combined = vec![0.0; counts.len()];
    for (voltage, target) in voltages.iter().zip(combination) {
        combined[usize::from(target.measurement)] += sign(target) * voltage;
    }
    combined.iter().zip(&counts).map(|(sum, count)| sum / count).collect()
}

/// How many steps share each measurement: `[measurement]`. Their mean has that many times less
/// variance, so this is also the measurement's weight W.
#[must_use]
pub fn step_counts(combination: &[CombinedInto]) -> Vec<f64> {
    let measurements =
        combination.iter().map(|target| usize::from(target.measurement) + 1).max().unwrap_or(0);
    let mut counts = vec![0.0; measurements];
    combination.iter().for_each(|target| counts[usize::from(target.measurement)] += 1.0);
    counts
}

fn sign(target: &CombinedInto) -> f64 {
    if target.flipped { -1.0 } else { 1.0 }
}
