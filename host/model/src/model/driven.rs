//! Voltages that are measured on driven electrodes, and how far off a mesh has them.
//!
//! Under a driven electrode of the complete model the current is densest at the electrode's edges, without bound as
//! contact impedance falls, and what is measured there contains it. So these voltages err more than all others, by an
//! amount that roughly halves with the edges.

use super::{ModelError, forward_model};
use crate::skin::Skin;
use dermatome_geometry::{
    mesh::{Mesh, refine},
    sheet::ElectrodeModel,
};
use dermatome_shared::stimulation::Step;

/// Largest relative error of voltages measured on driven electrodes, estimated: twice the change on a mesh of
/// half the edges. None if there are no such voltages, or electrodes are points, on which they have no limit.
pub fn driven_error(skin: &Skin, mesh: &Mesh) -> Result<Option<f64>, ModelError> {
    let mut steps = skin.steps();
    steps.retain(measures_driven);
    if steps.is_empty() || skin.electrodes.model == ElectrodeModel::Point {
        return Ok(None);
    }
    let voltages = |mesh: &Mesh| -> Result<Vec<f64>, ModelError> {
        let fields = forward_model::<f64>(skin, mesh)?.solve(&vec![1.0; mesh.elements.len()])?;
        Ok(fields.voltages(&steps))
    };
    let (coarse, fine) = (voltages(mesh)?, voltages(&refine(mesh))?);
    let changes = coarse.iter().zip(&fine).map(|(coarse, fine)| ((coarse - fine) / fine).abs());
    Ok(Some(2.0 * changes.fold(0.0, f64::max)))
}

fn measures_driven(step: &Step) -> bool {
    [step.sense_plus, step.sense_minus]
        .iter()
        .any(|sensed| [step.drive_plus, step.drive_minus].contains(sensed))
}
