//! Mesh: triangles with electrodes, and what the forward model says of them.

use crate::{
    array::{columns_of, list, matrix, numbers, one_or_each, rows, rows_of},
    error::raised,
    waiting::compute,
};
use dermatome_geometry::mesh::{ElectrodeContact, Mesh as Triangles, neighbours::boundary_edges};
use dermatome_model::{
    forward::{Admittivity, Fields, ForwardError, ForwardModel},
    jacobian::jacobian,
    pixels,
};
use dermatome_shared::stimulation::{self, Driven, Step};
use faer::Mat;
use nalgebra::Point3;
use num_complex::Complex64;
use numpy::PyArray2;
use pyo3::{exceptions::PyValueError, prelude::*, types::PyList};
use std::sync::Arc;

/// Triangles in the plane or in space, with electrodes.
///
/// `nodes` are [node][x, y] or [x, y, z] in m, `elements` [element][corner]. Each electrode is a node (point model), a list
/// of nodes, of which the edges of the rim between them belong to it, or edges [edge][2] or triangles [triangle][3], all of
/// the complete model. Everything counts from 0.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Mesh {
    mesh: Arc<Triangles>,
}

impl From<&Triangles> for Mesh {
    fn from(mesh: &Triangles) -> Self {
        Self { mesh: Arc::new(mesh.clone()) }
    }
}

#[pymethods]
impl Mesh {
    #[new]
    fn new(
        nodes: &Bound<'_, PyAny>,
        elements: &Bound<'_, PyAny>,
        electrodes: Vec<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let nodes: Vec<Point3<f64>> = match columns_of(nodes) {
            Some(2) => {
                rows_of::<f64, 2>(nodes, "nodes")?.iter().map(|[x, y]| Point3::new(*x, *y, 0.0)).collect()
            }
            _ => rows_of::<f64, 3>(nodes, "nodes")?.into_iter().map(Point3::from).collect(),
        };
        if let Some(node) = nodes.iter().position(|node| !node.iter().all(|value| value.is_finite())) {
            return Err(PyValueError::new_err(format!(
                "node {node} lies nowhere; allowed: finite numbers, in m"
            )));
        }
        let known = Known { nodes: nodes.len() };
        let elements = known.rows("elements", &rows_of::<i64, 3>(elements, "elements")?)?;
        let rim = boundary_edges(&elements);
        let electrodes =
            electrodes.iter().map(|given| known.electrode(given, &rim)).collect::<PyResult<_>>()?;
        Ok(Self { mesh: Arc::new(Triangles { nodes, elements, electrodes }) })
    }

    /// m: float64 [node][x, y, z].
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.mesh.nodes.iter().map(|node| node.coords.into()))
    }

    /// Nodes of the triangles: int64 [element][corner].
    #[getter]
    fn elements<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        rows(py, self.mesh.elements.iter().map(|corners| corners.map(|node| node as i64)))
    }

    /// Nodes, edges or triangles of each electrode: int64, (1,), (edges, 2) or (triangles, 3).
    #[getter]
    fn electrodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let of = |contact: &ElectrodeContact| -> PyResult<Bound<'py, PyAny>> {
            Ok(match contact {
                ElectrodeContact::Node(node) => list(py, vec![*node as i64]).into_any(),
                ElectrodeContact::Edges(edges) => {
                    rows(py, edges.iter().map(|edge| edge.map(|node| node as i64)))?.into_any()
                }
                ElectrodeContact::Faces(faces) => {
                    rows(py, faces.iter().map(|face| face.map(|node| node as i64)))?.into_any()
                }
            })
        };
        PyList::new(py, self.mesh.electrodes.iter().map(of).collect::<PyResult<Vec<_>>>()?)
    }

    /// Middles of the electrodes, m: float64 [electrode][x, y, z].
    #[getter]
    fn electrode_centre<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.mesh.electrodes.iter().map(|contact| self.mesh.centre(contact).coords.into()))
    }

    /// Voltages at unit current: [step], float64, or complex128 where a conductivity or impedance is complex.
    ///
    /// `steps` are [step][drive plus, drive minus, sense plus, sense minus], as of `dermatome.pattern`; conductivity is 1 or
    /// [element]; contact impedance, ohm m times the sheet conductivity, is one number or [electrode], and points have none.
    #[pyo3(signature = (steps, conductivity=None, contact_impedance=None))]
    fn forward<'py>(
        &self,
        py: Python<'py>,
        steps: &Bound<'py, PyAny>,
        conductivity: Option<&Bound<'py, PyAny>>,
        contact_impedance: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let problem = self.problem(steps, conductivity, contact_impedance)?;
        let solved = compute(py, move || {
            problem.solve(
                |problem, fields| fields.voltages(&problem.steps),
                |problem, fields| fields.voltages(&problem.steps),
            )
        })?;
        Ok(match solved.map_err(raised)? {
            Solved::Real(voltages) => list(py, voltages).into_any(),
            Solved::Complex(voltages) => list(py, voltages).into_any(),
        })
    }

    /// d voltage / d conductivity of each element, at unit current: [step][element]; arguments as of `forward`.
    #[pyo3(signature = (steps, conductivity=None, contact_impedance=None))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        steps: &Bound<'py, PyAny>,
        conductivity: Option<&Bound<'py, PyAny>>,
        contact_impedance: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let problem = self.problem(steps, conductivity, contact_impedance)?;
        let solved =
            compute(py, move || problem.solve(Problem::jacobian::<f64>, Problem::jacobian::<Complex64>))?;
        Ok(match solved.map_err(raised)? {
            Solved::Real(jacobian) => matrix(py, &jacobian)?.into_any(),
            Solved::Complex(jacobian) => matrix(py, &jacobian)?.into_any(),
        })
    }

    fn __repr__(&self) -> String {
        let Triangles { nodes, elements, electrodes } = &*self.mesh;
        format!("<Mesh {} nodes, {} elements, {} electrodes>", nodes.len(), elements.len(), electrodes.len())
    }
}

impl Mesh {
    fn problem(
        &self,
        steps: &Bound<'_, PyAny>,
        conductivity: Option<&Bound<'_, PyAny>>,
        contact_impedance: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Problem> {
        let electrodes = self.mesh.electrodes.len();
        let elements = self.mesh.elements.len();
        let admittivity = conductivity.map_or(Ok(vec![Complex64::ONE; elements]), |given| {
            one_or_each(given, "conductivity", elements)
        })?;
        let impedance = contact_impedance.map_or(Ok(vec![Complex64::ZERO; electrodes]), |given| {
            one_or_each(given, "contact_impedance", electrodes)
        })?;
        Ok(Problem { mesh: self.mesh.clone(), steps: steps_of(steps, electrodes)?, admittivity, impedance })
    }
}

/// A mesh to be solved.
struct Problem {
    mesh: Arc<Triangles>,
    steps: Vec<Step>,
    admittivity: Vec<Complex64>,
    impedance: Vec<Complex64>,
}

/// What comes of it, real or complex.
enum Solved<R, C> {
    Real(R),
    Complex(C),
}

impl Problem {
    fn solve<R, C>(
        &self,
        real: impl Fn(&Self, &Fields<f64>) -> R,
        complex: impl Fn(&Self, &Fields<Complex64>) -> C,
    ) -> Result<Solved<R, C>, ForwardError> {
        if self.admittivity.iter().chain(&self.impedance).all(|value| value.im == 0.0) {
            let parts = |values: &[Complex64]| values.iter().map(|value| value.re).collect::<Vec<f64>>();
            let fields = self.fields(&parts(&self.admittivity), &parts(&self.impedance))?;
            return Ok(Solved::Real(real(self, &fields)));
        }
        let fields = self.fields(&self.admittivity, &self.impedance)?;
        Ok(Solved::Complex(complex(self, &fields)))
    }

    fn fields<T: Admittivity>(&self, admittivity: &[T], impedance: &[T]) -> Result<Fields<T>, ForwardError> {
        ForwardModel::new(&self.mesh, impedance)?.solve(admittivity)
    }

    fn jacobian<T: Admittivity>(&self, fields: &Fields<T>) -> Mat<T> {
        jacobian(&self.mesh, fields, &self.steps, &pixels::per_element(&self.mesh))
    }
}

/// Steps as Python gives them, of electrodes that there are.
fn steps_of(given: &Bound<'_, PyAny>, electrodes: usize) -> PyResult<Vec<Step>> {
    let steps = rows_of::<i64, 4>(given, "steps")?;
    let of = |(number, pins): (usize, &[i64; 4])| {
        let mut bytes = [0; 4];
        for (byte, &pin) in bytes.iter_mut().zip(pins) {
            let known = u8::try_from(pin).ok().filter(|&pin| usize::from(pin) < electrodes);
            *byte = known.ok_or_else(|| {
                let last = electrodes.saturating_sub(1);
                PyValueError::new_err(format!("step {number} is {pins:?}; allowed: electrodes 0 to {last}"))
            })?;
        }
        Ok(Step::from_bytes(bytes))
    };
    steps.iter().enumerate().map(of).collect()
}

/// The nodes that there are.
struct Known {
    nodes: usize,
}

impl Known {
    fn node(&self, what: &str, node: i64) -> PyResult<usize> {
        usize::try_from(node).ok().filter(|&node| node < self.nodes).ok_or_else(|| {
            let last = self.nodes.saturating_sub(1);
            PyValueError::new_err(format!("{what} name node {node}; allowed: 0 to {last}"))
        })
    }

    fn rows<const N: usize>(&self, what: &str, rows: &[[i64; N]]) -> PyResult<Vec<[usize; N]>> {
        let of = |row: &[i64; N]| -> PyResult<[usize; N]> {
            let mut nodes = [0; N];
            for (node, &given) in nodes.iter_mut().zip(row) {
                *node = self.node(what, given)?;
            }
            Ok(nodes)
        };
        rows.iter().map(of).collect()
    }

    fn electrode(&self, given: &Bound<'_, PyAny>, rim: &[[usize; 2]]) -> PyResult<ElectrodeContact> {
        const WHAT: &str = "electrodes";
        if let Ok(node) = given.extract::<i64>() {
            return Ok(ElectrodeContact::Node(self.node(WHAT, node)?));
        }
        match columns_of(given) {
            Some(2) => Ok(ElectrodeContact::Edges(self.rows(WHAT, &rows_of::<i64, 2>(given, WHAT)?)?)),
            Some(3) => Ok(ElectrodeContact::Faces(self.rows(WHAT, &rows_of::<i64, 3>(given, WHAT)?)?)),
            Some(_) => Err(PyValueError::new_err("an electrode has edges of 2 or triangles of 3 nodes")),
            None => {
                let nodes = numbers::<i64>(given, "nodes of an electrode")?;
                let nodes =
                    nodes.into_iter().map(|node| self.node(WHAT, node)).collect::<PyResult<Vec<_>>>()?;
                if let [node] = nodes[..] {
                    return Ok(ElectrodeContact::Node(node));
                }
                let is_under = |edge: &&[usize; 2]| edge.iter().all(|node| nodes.contains(node));
                let edges: Vec<_> = rim.iter().filter(is_under).copied().collect();
                if edges.is_empty() {
                    return Err(PyValueError::new_err(
                        "no edge of the rim lies between the nodes of an electrode",
                    ));
                }
                Ok(ElectrodeContact::Edges(edges))
            }
        }
    }
}

/// Stimulation table of a pattern: uint8 [step][drive plus, drive minus, sense plus, sense minus], electrodes from 0.
///
/// Pairs `drive_distance` and `sense_distance` apart: adjacent is (1, 1), skip-n (n + 1, n + 1). Voltages of driven
/// electrodes are left out unless `driven` is true.
#[pyfunction]
#[pyo3(signature = (electrodes=16, drive_distance=1, sense_distance=1, *, driven=false))]
pub(crate) fn pattern(
    py: Python<'_>,
    electrodes: u8,
    drive_distance: u8,
    sense_distance: u8,
    driven: bool,
) -> PyResult<Bound<'_, PyArray2<u8>>> {
    let driven = if driven { Driven::Measured } else { Driven::Skipped };
    let steps = stimulation::pattern(electrodes, drive_distance, sense_distance, driven);
    rows(py, steps.map(Step::to_bytes))
}
