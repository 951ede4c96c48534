//! The system matrix: which entries there are, and their values for an admittivity.

use super::{
    Admittivity, ForwardError, SheetTensors,
    admittivity::{Index, TOGETHER},
};
use dermatome_geometry::mesh::{ElectrodeContact, Mesh, triangle};
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

/// The matrix without the ground's row and column: its pattern, and what fills it.
#[derive(Debug)]
pub(super) struct System<T> {
    filling: Filling<T>,
    pattern: SymbolicSparseColMat<Index>,
    order: Argsort<Index>,
}

/// What the entries of the matrix are made of.
///
/// Where an electrode's contact conducts better than a square of the sheet, the unknown of a node under it is not the
/// node's potential but how far it is from the electrode's, which *carries* the node. The contact then adds to the
/// diagonal only: however well it conducts, what the sheet adds is not lost in rounding beside it, and a perfect
/// contact is the limit. Other contacts stay as they are, so that an open one leaves the rest of the matrix alone.
#[derive(Debug)]
struct Filling<T> {
    unknowns: usize,
    /// Held at 0 V: a node that no electrode carries. An electrode would not do: if its contact is open, the current
    /// that returns through it lifts all potentials so high that their differences are lost.
    ground: usize,
    /// Unknown of each electrode's potential: `[electrode]`.
    electrodes: Vec<usize>,
    /// Of the mesh: `[node]`.
    nodes: Vec<Point3<f64>>,
    /// Node numbers of each element. Its gradients are computed anew for each admittivity: they are four times as large.
    elements: Vec<[Index; 3]>,
    /// Fixed entries of the complete electrode model, of potentials: row, column, value.
    contacts: Vec<Entry<T>>,
    /// The same of the unknowns that are solved for.
    carried_contacts: Vec<Entry<T>>,
    /// Unknown of the electrode that carries each unknown: `[unknown]`.
    carrier: Vec<Option<usize>>,
    sheet: SheetTensors,
}

/// Row, column and value.
type Entry<T> = (usize, usize, T);

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
    pub(super) fn new(
        mesh: &Mesh,
        contact_impedance: &[T],
        sheet: SheetTensors,
    ) -> Result<Self, ForwardError> {
        let filling = Filling::new(mesh, contact_impedance, sheet)?;
        let nothing = T::default();
        let of_elements = mesh.elements.iter().flat_map(|&element| element_positions(element));
        let pairs: Vec<_> = filling
            .carried_entries(of_elements.map(|(row, col)| (row, col, nothing)))
            .flat_map(|(row, col, _)| {
                T::entries(without(filling.ground, row), without(filling.ground, col), T::default())
            })
            .map(|(row, col, _)| Pair { row: row as Index, col: col as Index })
            .collect();
        let size = T::PARTS * (filling.unknowns - 1);
        let (pattern, order) =
            SymbolicSparseColMat::try_new_from_indices(size, size, &pairs).map_err(ForwardError::solver)?;
        Ok(Self { filling, pattern, order })
    }

    pub(super) fn pattern(&self) -> SymbolicSparseColMatRef<'_, Index> {
        self.pattern.as_ref()
    }

    pub(super) fn electrodes(&self) -> &[usize] {
        &self.filling.electrodes
    }

    pub(super) fn sheet(&self) -> &SheetTensors {
        &self.filling.sheet
    }

    /// The real matrix for one admittivity, lower half, ground left out.
    pub(super) fn matrix(&self, admittivity: &[T]) -> Result<SparseColMat<Index, f64>, ForwardError> {
        self.filling.check(admittivity)?;
        let values: Vec<f64> = self
            .filling
            .carried_entries(self.filling.element_entries(admittivity))
            .flat_map(|(row, col, value)| T::entries(row, col, value))
            .map(|(_, _, value)| value)
            .collect();
        SparseColMat::new_from_argsort(self.pattern.clone(), &self.order, &values)
            .map_err(ForwardError::solver)
    }

    /// Of potentials: both halves, ground included; entries of one place are to be added.
    pub(super) fn entries(&self, admittivity: &[T]) -> Result<Vec<Entry<T>>, ForwardError> {
        self.filling.check(admittivity)?;
        let mirrored = |(row, col, value)| {
            let other = (row != col).then_some((col, row, value));
            std::iter::once((row, col, value)).chain(other)
        };
        let contacts = self.filling.contacts.iter().copied();
        Ok(self.filling.element_entries(admittivity).chain(contacts).flat_map(mirrored).collect())
    }

    /// Unit current into each electrode, a few electrodes at a time: blocks of `[real unknown without ground, in the
    /// order of elimination][electrode]`.
    pub(super) fn currents(&self, places: &[Index]) -> impl ParallelIterator<Item = Mat<f64>> {
        self.filling.electrodes.par_chunks(TOGETHER).map(|electrodes| {
            let mut currents = Mat::zeros(places.len(), electrodes.len());
            for (column, &electrode) in electrodes.iter().enumerate() {
                for place in self.current_enters(electrode, places) {
                    currents[(place, column)] = 1.0;
                }
            }
            currents
        })
    }

    /// The equations, in the order of elimination, that a current into an unknown is part of.
    pub(super) fn current_enters(&self, unknown: usize, places: &[Index]) -> impl Iterator<Item = usize> {
        let ground = self.filling.ground;
        let equations = std::iter::once(unknown).chain(self.filling.carrier[unknown]);
        equations
            .filter(move |&it| it != ground)
            .map(move |it| places[T::PARTS * without(ground, it)] as usize)
    }

    /// Whether each real unknown, in the order of elimination, is an electrode's potential.
    pub(super) fn is_electrode(&self, places: &[Index]) -> Vec<bool> {
        let mut is_electrode = vec![false; places.len()];
        let beyond_nodes = self.filling.electrodes.iter().filter(|&&it| it >= self.filling.nodes.len());
        for &unknown in beyond_nodes.filter(|&&it| it != self.filling.ground) {
            let first = T::PARTS * without(self.filling.ground, unknown);
            (first..first + T::PARTS).for_each(|part| is_electrode[places[part] as usize] = true);
        }
        is_electrode
    }

    /// Potentials of the unknowns in their order: `[unknown][electrode]`.
    pub(super) fn potentials(&self, solution: &[Mat<f64>], places: &[Index]) -> Vec<T> {
        let columns: Vec<&[f64]> = solution
            .iter()
            .flat_map(|block| (0..block.ncols()).map(|column| block.col_as_slice(column)))
            .collect();
        let electrodes = columns.len();
        let Filling { unknowns, ground, carrier, .. } = &self.filling;
        let solved = |column: &[f64], unknown: usize| {
            let first = T::PARTS * without(*ground, unknown);
            T::from_parts(|part| column[places[first + part] as usize])
        };
        let mut potentials = vec![T::default(); electrodes * unknowns];
        potentials.par_chunks_mut(BLOCK * electrodes.max(1)).enumerate().for_each(|(block, rows)| {
            for (electrode, column) in columns.iter().enumerate() {
                for (unknown, row) in (block * BLOCK..).zip(rows.chunks_exact_mut(electrodes)) {
                    let parts = std::iter::once(unknown).chain(carrier[unknown]);
                    row[electrode] = parts.filter(|it| it != ground).map(|it| solved(column, it)).sum();
                }
            }
        });
        potentials
    }
}

impl<T: Admittivity> Filling<T> {
    fn new(mesh: &Mesh, contact_impedance: &[T], sheet: SheetTensors) -> Result<Self, ForwardError> {
        let electrodes: Vec<_> = (0..mesh.electrodes.len()).map(|e| electrode_unknown(mesh, e)).collect();
        let unknowns = electrodes.iter().map(|&u| u + 1).max().unwrap_or(0).max(mesh.nodes.len());
        let carrier = carriers(mesh, &electrodes, contact_impedance, unknowns);
        let ground = carrier[..mesh.nodes.len()].iter().position(Option::is_none).unwrap_or(unknowns - 1);
        let mut filling = Self {
            unknowns,
            ground,
            electrodes,
            nodes: mesh.nodes.clone(),
            elements: mesh.elements.iter().map(|element| element.map(|node| node as Index)).collect(),
            contacts: Vec::new(),
            carried_contacts: Vec::new(),
            carrier,
            sheet,
        };
        for (electrode, &impedance) in contact_impedance.iter().enumerate() {
            filling.add_contact(mesh, electrode, impedance)?;
        }
        Ok(filling)
    }

    fn add_contact(&mut self, mesh: &Mesh, electrode: usize, impedance: T) -> Result<(), ForwardError> {
        let contact = &mesh.electrodes[electrode];
        let unknown = self.electrodes[electrode];
        let entries = contact_entries(mesh, contact, unknown, impedance.reciprocal());
        if entries.iter().any(|(.., value)| !(value.size().is_finite() && value.size() > 0.0)) {
            return Err(ForwardError::ContactImpedance { electrode, size: impedance.size() });
        }
        if contact.nodes().any(|node| self.carrier[node] == Some(unknown)) {
            let of_nodes = |&&(row, col, _): &&Entry<T>| row != unknown && col != unknown;
            self.carried_contacts.extend(entries.iter().filter(of_nodes));
        } else {
            let carried = entries.iter().flat_map(|&entry| carried(&self.carrier, entry));
            self.carried_contacts.extend(carried);
        }
        self.contacts.extend(entries);
        Ok(())
    }

    fn check(&self, admittivity: &[T]) -> Result<(), ForwardError> {
        let (elements, given) = (self.elements.len(), admittivity.len());
        if elements == given { Ok(()) } else { Err(ForwardError::Conductivities { elements, given }) }
    }

    /// Lower half, of potentials, without contacts.
    fn element_entries<'a>(&'a self, admittivity: &'a [T]) -> impl Iterator<Item = Entry<T>> + 'a {
        self.elements.iter().zip(admittivity).enumerate().flat_map(|(number, (element, &sigma))| {
            let element = element.map(|node| node as usize);
            let gradients = self.sheet.gradients(number, element.map(|node| self.nodes[node]));
            let values = LOWER.map(|(i, j)| sigma * gradients.admittance(i, j));
            element_positions(element).zip(values).map(|((row, col), value)| (row, col, value))
        })
    }

    /// Lower half, of the unknowns that are solved for, ground left out; from entries of elements.
    fn carried_entries<'a>(
        &'a self,
        of_elements: impl Iterator<Item = Entry<T>> + 'a,
    ) -> impl Iterator<Item = Entry<T>> + 'a {
        of_elements
            .flat_map(|entry| carried(&self.carrier, entry))
            .chain(self.carried_contacts.iter().copied())
            .filter(|&(row, col, _)| row != self.ground && col != self.ground)
    }
}

/// Which electrode carries each unknown: `[unknown]`. A node under two electrodes goes with the first.
fn carriers<T: Admittivity>(
    mesh: &Mesh,
    electrodes: &[usize],
    contact_impedance: &[T],
    unknowns: usize,
) -> Vec<Option<usize>> {
    let mut carrier = vec![None; unknowns];
    for ((contact, &unknown), impedance) in mesh.electrodes.iter().zip(electrodes).zip(contact_impedance) {
        let is_node = matches!(contact, ElectrodeContact::Node(_));
        let is_free = || contact.nodes().all(|node| carrier[node].is_none());
        if !is_node && impedance.size() < mesh.width(contact) && is_free() {
            contact.nodes().for_each(|node| carrier[node] = Some(unknown));
        }
    }
    carrier
}

/// What an entry of potentials becomes: where u = w + U, with U the carrier's potential, u'K u is
/// w'K w + 2 U'K w + U'K U. Lower half.
fn carried<T: Admittivity>(
    carrier: &[Option<usize>],
    (row, col, value): Entry<T>,
) -> impl Iterator<Item = Entry<T>> + use<T> {
    let at = |a: usize, b: usize, value: T| {
        let (row, col) = lower(a, b);
        (row, col, value)
    };
    let of_row = carrier[row].map(|above| at(above, col, value));
    let of_col = carrier[col].filter(|_| row != col).map(|above| at(above, row, value));
    let of_both = carrier[row].zip(carrier[col]).map(|(a, b)| {
        // Off the diagonal an entry stands for two.
        at(a, b, if a == b && row != col { value + value } else { value })
    });
    std::iter::once((row, col, value)).chain(of_row).chain(of_col).chain(of_both)
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

/// Entries of the complete electrode model for one electrode, lower half.
fn contact_entries<T: Admittivity>(
    mesh: &Mesh,
    contact: &ElectrodeContact,
    unknown: usize,
    per_metre: T,
) -> Vec<Entry<T>> {
    let mut entries = Vec::new();
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
    entries
}

/// On an edge of length l under an electrode with contact impedance z, the current density is
/// (electrode potential - potential) / z, both linear.
fn edge_entries<T: Admittivity>(
    entries: &mut Vec<Entry<T>>,
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
    entries: &mut Vec<Entry<T>>,
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
