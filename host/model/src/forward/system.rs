//! The system matrix: which entries there are, and their values for an admittivity.

use super::{
    Admittivity, ForwardError,
    admittivity::{Index, TOGETHER},
};
use dermatome_geometry::mesh::{ElectrodeContact, Mesh, triangle, triangle::Gradients};
use faer::{
    Mat,
    sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat, SymbolicSparseColMatRef},
};
use nalgebra::Point3;
use rayon::prelude::*;

/// Unknowns transposed together, so that both sides stay in the cache.
const BLOCK: usize = 64;
/// Lower corners of a local 3 x 3 matrix.
const LOWER: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

/// The pattern of the matrix without the ground's row and column, and what fills it.
#[derive(Debug)]
pub(super) struct System<T> {
    unknowns: usize,
    ground: usize,
    electrodes: Vec<usize>,
    /// Of the mesh: `[node]`.
    nodes: Vec<Point3<f64>>,
    /// Node numbers of each element. Its gradients are computed anew for each admittivity: they are four times as large.
    elements: Vec<[Index; 3]>,
    /// Fixed entries of the complete electrode model: row, column, value.
    contacts: Vec<(usize, usize, T)>,
    pattern: SymbolicSparseColMat<Index>,
    order: Argsort<Index>,
}

pub(super) fn electrode_unknown(mesh: &Mesh, electrode: usize) -> usize {
    let is_node = |contact: &&ElectrodeContact| matches!(contact, ElectrodeContact::Node(_));
    match mesh.electrodes[electrode] {
        ElectrodeContact::Node(node) => node,
        ElectrodeContact::Edges(_) | ElectrodeContact::Faces(_) => {
            let points_before = mesh.electrodes[..electrode].iter().filter(is_node).count();
            mesh.nodes.len() + electrode - points_before
        }
    }
}

impl<T: Admittivity> System<T> {
    pub(super) fn new(mesh: &Mesh, contact_impedance: &[T], ground: usize) -> Result<Self, ForwardError> {
        let electrodes: Vec<_> = (0..mesh.electrodes.len()).map(|e| electrode_unknown(mesh, e)).collect();
        let unknowns = electrodes.iter().map(|&u| u + 1).max().unwrap_or(0).max(mesh.nodes.len());
        let contacts = contact_entries(mesh, contact_impedance);
        let positions = mesh.elements.iter().flat_map(|&element| element_positions(element));
        let positions = positions.chain(contacts.iter().map(|&(row, col, _)| (row, col)));
        let pairs: Vec<_> = positions
            .filter(|&(row, col)| row != ground && col != ground)
            .flat_map(|(row, col)| T::entries(without(ground, row), without(ground, col), T::default()))
            .map(|(row, col, _)| Pair { row: row as Index, col: col as Index })
            .collect();
        let size = T::PARTS * (unknowns - 1);
        let (pattern, order) =
            SymbolicSparseColMat::try_new_from_indices(size, size, &pairs).map_err(ForwardError::solver)?;
        Ok(Self {
            unknowns,
            ground,
            electrodes,
            nodes: mesh.nodes.clone(),
            elements: mesh.elements.iter().map(|element| element.map(|node| node as Index)).collect(),
            contacts,
            pattern,
            order,
        })
    }

    pub(super) fn pattern(&self) -> SymbolicSparseColMatRef<'_, Index> {
        self.pattern.as_ref()
    }

    pub(super) fn electrodes(&self) -> &[usize] {
        &self.electrodes
    }

    /// The real matrix for one admittivity, lower half, ground left out.
    pub(super) fn matrix(&self, admittivity: &[T]) -> Result<SparseColMat<Index, f64>, ForwardError> {
        let values: Vec<f64> = self
            .lower_entries(admittivity)?
            .filter(|&(row, col, _)| row != self.ground && col != self.ground)
            .flat_map(|(row, col, value)| T::entries(row, col, value))
            .map(|(_, _, value)| value)
            .collect();
        SparseColMat::new_from_argsort(self.pattern.clone(), &self.order, &values)
            .map_err(ForwardError::solver)
    }

    /// Both halves, ground included; entries of one place are to be added.
    pub(super) fn entries(&self, admittivity: &[T]) -> Result<Vec<(usize, usize, T)>, ForwardError> {
        let mirrored = |(row, col, value)| {
            let other = (row != col).then_some((col, row, value));
            std::iter::once((row, col, value)).chain(other)
        };
        Ok(self.lower_entries(admittivity)?.flat_map(mirrored).collect())
    }

    fn lower_entries<'a>(
        &'a self,
        admittivity: &'a [T],
    ) -> Result<impl Iterator<Item = (usize, usize, T)> + 'a, ForwardError> {
        if admittivity.len() != self.elements.len() {
            let (elements, given) = (self.elements.len(), admittivity.len());
            return Err(ForwardError::Conductivities { elements, given });
        }
        let local = |(element, &sigma): (&[Index; 3], &'a T)| {
            let element = element.map(|node| node as usize);
            let gradients = Gradients::of(element.map(|node| self.nodes[node]));
            let values = LOWER.map(|(i, j)| sigma * gradients.admittance(i, j));
            element_positions(element).zip(values).map(|((row, col), value)| (row, col, value))
        };
        let elements = self.elements.iter().zip(admittivity).flat_map(local);
        Ok(elements.chain(self.contacts.iter().copied()))
    }

    /// Unit current into each electrode, a few electrodes at a time: blocks of `[real unknown without ground, in the
    /// order of elimination][electrode]`.
    pub(super) fn currents(&self, places: &[Index]) -> impl ParallelIterator<Item = Mat<f64>> {
        self.electrodes.par_chunks(TOGETHER).map(|electrodes| {
            let mut currents = Mat::zeros(T::PARTS * (self.unknowns - 1), electrodes.len());
            for (column, &unknown) in electrodes.iter().enumerate().filter(|(_, u)| **u != self.ground) {
                let place = places[T::PARTS * without(self.ground, unknown)];
                currents[(place as usize, column)] = 1.0;
            }
            currents
        })
    }

    /// Puts unknowns back in their order, and the ground's zeros between them: `[unknown][electrode]`.
    pub(super) fn with_ground(&self, solution: &[Mat<f64>], places: &[Index]) -> Vec<T> {
        let columns: Vec<&[f64]> = solution
            .iter()
            .flat_map(|block| (0..block.ncols()).map(|column| block.col_as_slice(column)))
            .collect();
        let electrodes = columns.len();
        let mut potentials = vec![T::default(); electrodes * self.unknowns];
        potentials.par_chunks_mut(BLOCK * electrodes.max(1)).enumerate().for_each(|(block, rows)| {
            for (electrode, column) in columns.iter().enumerate() {
                let unknowns = (block * BLOCK..).zip(rows.chunks_exact_mut(electrodes));
                for (unknown, row) in unknowns.filter(|(unknown, _)| *unknown != self.ground) {
                    let first = T::PARTS * without(self.ground, unknown);
                    row[electrode] = T::from_parts(|part| column[places[first + part] as usize]);
                }
            }
        });
        potentials
    }
}

fn without(ground: usize, unknown: usize) -> usize {
    if unknown > ground { unknown - 1 } else { unknown }
}

/// Places of an element's local entries in the lower half.
fn element_positions(element: [usize; 3]) -> impl Iterator<Item = (usize, usize)> {
    LOWER.into_iter().map(move |(i, j)| lower(element[i], element[j]))
}

fn lower(a: usize, b: usize) -> (usize, usize) {
    (a.max(b), a.min(b))
}

/// Entries of the complete electrode model.
fn contact_entries<T: Admittivity>(mesh: &Mesh, contact_impedance: &[T]) -> Vec<(usize, usize, T)> {
    let mut entries = Vec::new();
    for (electrode, contact) in mesh.electrodes.iter().enumerate() {
        let unknown = electrode_unknown(mesh, electrode);
        let per_metre = contact_impedance[electrode].reciprocal();
        match contact {
            ElectrodeContact::Node(_) => {}
            ElectrodeContact::Edges(edges) => {
                edges.iter().for_each(|edge| edge_entries(&mut entries, mesh, unknown, *edge, per_metre));
            }
            ElectrodeContact::Faces(faces) => {
                let areas: Vec<f64> = faces.iter().map(|&face| triangle::area(mesh.points(face))).collect();
                let total: f64 = areas.iter().sum();
                // A disc has the impedance of an edge as long as its diameter.
                let whole = per_metre * mesh.width(contact);
                for (face, area) in faces.iter().zip(areas) {
                    face_entries(&mut entries, unknown, *face, whole * (area / total));
                }
            }
        }
    }
    entries
}

/// On an edge of length l under an electrode with contact impedance z, the current density is
/// (electrode potential - potential) / z, both linear.
fn edge_entries<T: Admittivity>(
    entries: &mut Vec<(usize, usize, T)>,
    mesh: &Mesh,
    unknown: usize,
    [a, b]: [usize; 2],
    per_metre: T,
) {
    let admittance = per_metre * (mesh.nodes[a] - mesh.nodes[b]).norm();
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

/// The same on a triangle that an electrode inside the skin covers.
fn face_entries<T: Admittivity>(
    entries: &mut Vec<(usize, usize, T)>,
    unknown: usize,
    face: [usize; 3],
    admittance: T,
) {
    for (i, j) in LOWER {
        let (row, col) = lower(face[i], face[j]);
        entries.push((row, col, admittance / if i == j { 6.0 } else { 12.0 }));
    }
    entries.extend(face.map(|node| (unknown, node, -admittance / 3.0)));
    entries.push((unknown, unknown, admittance));
}
