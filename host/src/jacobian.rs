//! Jacobian: how each measurement answers to each pixel's conductivity.
//!
//! dV/dsigma of one element is minus the integral over it of grad u_drive . grad u_sense, with
//! u_sense the field of unit current through the sensing pair (adjoint fields). Both are
//! differences of electrode fields, so an element contributes the Gram matrix of all electrode
//! fields' gradients, and pixels add up Gram matrices: nothing is ever stored per element.

use crate::{
    forward::Fields,
    mesh::{Mesh, triangle::Gradients},
    pixels::Pixels,
};
use dermatome_shared::{patch::CombinedInto, stimulation::Step};
use faer::Mat;
use rayon::prelude::*;

/// d voltage / d relative conductivity at unit current: `[step][pixel]`.
#[must_use]
pub fn jacobian(mesh: &Mesh, fields: &Fields, steps: &[Step], pixels: &Pixels) -> Mat<f64> {
    let columns: Vec<Vec<f64>> =
        pixels.elements.par_iter().map(|parts| pixel_column(mesh, fields, steps, parts)).collect();
    Mat::from_fn(steps.len(), columns.len(), |step, pixel| columns[pixel][step])
}

fn pixel_column(mesh: &Mesh, fields: &Fields, steps: &[Step], parts: &[(usize, f64)]) -> Vec<f64> {
    let electrodes = fields.potentials.ncols();
    let mut gram = vec![0.0; electrodes * electrodes];
    for &(element, weight) in parts {
        add_gram(&mut gram, mesh, fields, element, weight);
    }
    let at = |a: u8, b: u8| gram[usize::from(a.max(b)) * electrodes + usize::from(a.min(b))];
    let entry = |step: &Step| {
        let [dp, dm, sp, sm] = step.to_bytes();
        (at(sp, dm) - at(sp, dp)) - (at(sm, dm) - at(sm, dp))
    };
    steps.iter().map(entry).collect()
}

/// Adds `weight` times the element's Gram matrix, lower half: `[electrode][electrode]`.
fn add_gram(gram: &mut [f64], mesh: &Mesh, fields: &Fields, element: usize, weight: f64) {
    let electrodes = fields.potentials.ncols();
    let gradients = Gradients::of(mesh.corners(element));
    let nodes = mesh.elements[element];
    let of_electrode = |e: usize| gradients.of_field(nodes.map(|node| fields.potentials[(node, e)]));
    let fields: Vec<[f64; 2]> = (0..electrodes).map(of_electrode).collect();
    for (a, row) in gram.chunks_exact_mut(electrodes).enumerate() {
        let [x, y] = fields[a].map(|g| g * weight);
        for (sum, other) in row[..=a].iter_mut().zip(&fields) {
            *sum += x * other[0] + y * other[1];
        }
    }
}

/// Averages the rows of steps that share a measurement: `[measurement][pixel]`.
#[must_use]
pub fn combine_rows(jacobian: &Mat<f64>, combination: &[CombinedInto]) -> Mat<f64> {
    let counts = step_counts(combination);
    let mut combined = Mat::zeros(counts.len(), jacobian.ncols());
    for pixel in 0..jacobian.ncols() {
        for (step, target) in combination.iter().enumerate() {
            let row = usize::from(target.measurement);
            combined[(row, pixel)] += sign(target) * jacobian[(step, pixel)] / counts[row];
        }
    }
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
