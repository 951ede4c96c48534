//! The system matrix: which entries there are, and their values for a conductivity.

use super::ForwardError;
use crate::mesh::{ElectrodeContact, Mesh, triangle::Gradients};
use faer::{
    Mat,
    sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat, SymbolicSparseColMatRef},
};

/// Lower corners of a local 3 x 3 matrix.
const LOWER: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

/// The pattern of the matrix without the ground's row and column, and what fills it.
#[derive(Debug)]
pub(super) struct System {
    unknowns: usize,
    ground: usize,
    electrodes: Vec<usize>,
    gradients: Vec<Gradients>,
    elements: Vec<[usize; 3]>,
    /// Fixed entries of the complete electrode model: row, column, value.
    contacts: Vec<(usize, usize, f64)>,
    pattern: SymbolicSparseColMat<usize>,
    order: Argsort<usize>,
}

pub(super) fn electrode_unknown(mesh: &Mesh, electrode: usize) -> usize {
    match mesh.electrodes[electrode] {
        ElectrodeContact::Node(node) => node,
        ElectrodeContact::Edges(_) => mesh.nodes.len() + electrode,
    }
}

impl System {
    pub(super) fn new(mesh: &Mesh, contact_impedance: &[f64], ground: usize) -> Result<Self, ForwardError> {
        let electrodes: Vec<_> = (0..mesh.electrodes.len()).map(|e| electrode_unknown(mesh, e)).collect();
        let unknowns = electrodes.iter().map(|&u| u + 1).max().unwrap_or(0).max(mesh.nodes.len());
        let contacts = contact_entries(mesh, contact_impedance);
        let positions =
            element_positions(&mesh.elements).chain(contacts.iter().map(|&(row, col, _)| (row, col)));
        let pairs: Vec<_> = positions
            .filter(|&(row, col)| row != ground && col != ground)
            .map(|(row, col)| Pair { row: without(ground, row), col: without(ground, col) })
            .collect();
        let (pattern, order) = SymbolicSparseColMat::try_new_from_indices(unknowns - 1, unknowns - 1, &pairs)
            .map_err(|error| ForwardError::Solver(format!("{error:?}")))?;
        Ok(Self {
            unknowns,
            ground,
            electrodes,
            gradients: (0..mesh.elements.len()).map(|e| Gradients::of(mesh.corners(e))).collect(),
            elements: mesh.elements.clone(),
            contacts,
            pattern,
            order,
        })
    }

    pub(super) fn pattern(&self) -> SymbolicSparseColMatRef<'_, usize> {
        self.pattern.as_ref()
    }

    pub(super) fn electrodes(&self) -> &[usize] {
        &self.electrodes
    }

    /// The matrix for one conductivity, lower half, ground left out.
    pub(super) fn matrix(&self, conductivity: &[f64]) -> Result<SparseColMat<usize, f64>, ForwardError> {
        let values: Vec<f64> = self
            .lower_entries(conductivity)?
            .filter(|&(row, col, _)| row != self.ground && col != self.ground)
            .map(|(_, _, value)| value)
            .collect();
        SparseColMat::new_from_argsort(self.pattern.clone(), &self.order, &values)
            .map_err(|error| ForwardError::Solver(format!("{error:?}")))
    }

    /// Both halves, ground included; entries of one place are to be added.
    pub(super) fn entries(&self, conductivity: &[f64]) -> Result<Vec<(usize, usize, f64)>, ForwardError> {
        let mirrored = |(row, col, value)| {
            let other = (row != col).then_some((col, row, value));
            std::iter::once((row, col, value)).chain(other)
        };
        Ok(self.lower_entries(conductivity)?.flat_map(mirrored).collect())
    }

    fn lower_entries<'a>(
        &'a self,
        conductivity: &'a [f64],
    ) -> Result<impl Iterator<Item = (usize, usize, f64)> + 'a, ForwardError> {
        if conductivity.len() != self.elements.len() {
            let (elements, given) = (self.elements.len(), conductivity.len());
            return Err(ForwardError::Conductivities { elements, given });
        }
        let local = self.gradients.iter().zip(conductivity).flat_map(|(gradients, sigma)| {
            LOWER.iter().map(move |&(i, j)| sigma * gradients.admittance(i, j))
        });
        let elements =
            element_positions(&self.elements).zip(local).map(|((row, col), value)| (row, col, value));
        Ok(elements.chain(self.contacts.iter().copied()))
    }

    /// Unit current into each electrode: `[unknown without ground][electrode]`.
    pub(super) fn currents(&self) -> Mat<f64> {
        let mut currents = Mat::zeros(self.unknowns - 1, self.electrodes.len());
        for (column, &unknown) in self.electrodes.iter().enumerate().filter(|(_, u)| **u != self.ground) {
            currents[(without(self.ground, unknown), column)] = 1.0;
        }
        currents
    }

    /// Puts the ground's row of zeros back.
    pub(super) fn with_ground(&self, reduced: &Mat<f64>) -> Mat<f64> {
        Mat::from_fn(self.unknowns, reduced.ncols(), |unknown, column| {
            if unknown == self.ground { 0.0 } else { reduced[(without(self.ground, unknown), column)] }
        })
    }
}

fn without(ground: usize, unknown: usize) -> usize {
    if unknown > ground { unknown - 1 } else { unknown }
}

/// Places of the elements' local entries in the lower half.
fn element_positions(elements: &[[usize; 3]]) -> impl Iterator<Item = (usize, usize)> + '_ {
    elements.iter().flat_map(|element| LOWER.iter().map(|&(i, j)| lower(element[i], element[j])))
}

fn lower(a: usize, b: usize) -> (usize, usize) {
    (a.max(b), a.min(b))
}

/// Entries of the complete electrode model: on an edge of length l under an electrode with
/// contact impedance z, the current density is (electrode potential - potential) / z, both linear.
fn contact_entries(mesh: &Mesh, contact_impedance: &[f64]) -> Vec<(usize, usize, f64)> {
    let mut entries = Vec::new();
    for (electrode, contact) in mesh.electrodes.iter().enumerate() {
        let ElectrodeContact::Edges(edges) = contact else { continue };
        let unknown = electrode_unknown(mesh, electrode);
        for &[a, b] in edges {
            let admittance = (mesh.nodes[a] - mesh.nodes[b]).norm() / contact_impedance[electrode];
            let (row, col) = lower(a, b);
            entries.extend([
                (a, a, admittance / 3.0),
                (b, b, admittance / 3.0),
                (row, col, admittance / 6.0),
                (unknown, a, -admittance / 2.0),
                (unknown, b, -admittance / 2.0),
                (unknown, unknown, admittance),
            ]);
        }
    }
    entries
}
