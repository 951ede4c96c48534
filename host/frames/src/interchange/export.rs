//! Export: a skin's whole model as files for NumPy and MATLAB, and its mesh for Gmsh and others.
//!
//! Everything counts from 0. Steps are those of the skin's own stimulation table, before reciprocal
//! ones are averaged; `step_measurement` and `step_sign` lead from there to the columns of the
//! reconstruction matrix.

pub use super::contents::{CONTENTS, GMSH, MATLAB, PLY, STIMULATION, STL, is_exported};

use super::{
    contents::{Contents, file_name},
    variable::{Entries, Variable, summed},
};
use crate::array::{Array, Number, mat, npy};
use dermatome_geometry::{
    mesh::{
        ElectrodeContact, Mesh,
        export::{PlyError, msh, ply, stl},
    },
    sheet::ElectrodeModel,
};
use dermatome_model::{
    forward::{Admittivity, ForwardError, SheetTensors},
    inverse::InverseError,
    model::{self, Model, ModelError, Solved},
    pixels::Pixels,
    prior::Prior,
    skin::Skin,
    stimulation::table_csv,
};
use dermatome_patch::output::{WriteError, check_folder, stream_whole, write_whole};
use dermatome_shared::{patch::CombinedInto, stimulation::Step};
use faer::Mat;
use num_complex::Complex64;
use std::{
    io,
    path::{Path, PathBuf},
    rc::Rc,
};

/// Unit of voltages: volts at a current of 1 A through a sheet of 1 S per square.
const RELATIVE_VOLTS: &str = "V at 1 A and 1 S";

/// Everything computed for one skin.
pub struct Export<'a> {
    skin: &'a Skin,
    mesh: Mesh,
    contact_impedance: Vec<f64>,
    pixels: Pixels,
    steps: Vec<Step>,
    combination: Vec<CombinedInto>,
    weights: Vec<f64>,
    prior: Option<Entries<f64>>,
    hyperparameter: f64,
    reconstruction_matrix: Mat<f64>,
    solution: Solution,
}

/// The untouched skin's response, real or, for a sheet with capacitance, complex.
enum Solution {
    Real(Untouched<f64>),
    Complex(Untouched<Complex64>),
}

struct Untouched<T> {
    admittivity: T,
    system_matrix: Entries<T>,
    voltages: Vec<T>,
    /// `[step][pixel]`.
    jacobian: Mat<T>,
}

/// Row and column of the parts of a tensor that are exported.
const TENSOR_PARTS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];

/// Why a model could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The skin has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The folder cannot be made.
    #[error("cannot make the folder `{}`: {reason}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        reason: io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The mesh does not fit into a PLY file.
    #[error(transparent)]
    Ply(#[from] PlyError),
    /// The contents of an earlier export cannot be taken away.
    #[error("cannot remove `{}`, which lists the files of an earlier export: {reason}", path.display())]
    Remove {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: io::Error,
    },
}

/// Makes the folder, and checks that files can be written there: before the work whose result they hold.
pub fn prepare_folder(folder: &Path) -> Result<(), ExportError> {
    std::fs::create_dir_all(folder)
        .map_err(|reason| ExportError::Folder { path: folder.to_owned(), reason })?;
    Ok(check_folder(&folder.join(CONTENTS))?)
}

impl<'a> Export<'a> {
    /// Computes everything; `on_stage` hears the name of each stage as it begins.
    pub fn new(skin: &'a Skin, mut on_stage: impl FnMut(&'static str)) -> Result<Self, ModelError> {
        let mut solved = None;
        // The model's own Jacobian, of combined measurements, is dropped here.
        let model =
            Model::build_beside(skin, &mut on_stage, &mut |solution| solved = Some(solution), &mut |_| ())?;
        let prior = model.prior.as_ref().map(Prior::entries).transpose().map_err(InverseError::from)?;
        let Model { steps, combination, mesh, pixels, weights, hyperparameter, .. } = model;
        on_stage("arrays");
        let elements = mesh.elements.len();
        let solution = match solved.expect("a model that is built was solved") {
            model::Solution::Real(solved) => Solution::Real(Untouched::new(*solved, elements)?),
            model::Solution::Complex(solved) => Solution::Complex(Untouched::new(*solved, elements)?),
        };
        let contact_impedance = match &skin.electrodes.model {
            ElectrodeModel::Point => Vec::new(),
            ElectrodeModel::Complete { contact_impedance, .. } => {
                contact_impedance.iter().map(|z| z * skin.material.sheet_conductivity).collect()
            }
        };
        Ok(Self {
            skin,
            contact_impedance,
            weights,
            prior: prior.map(summed),
            hyperparameter,
            mesh,
            pixels,
            steps,
            combination,
            reconstruction_matrix: model.conductivity_from_difference,
            solution,
        })
    }

    /// Pixels and measurements.
    fn counts(&self) -> [usize; 2] {
        [self.pixels.count(), self.weights.len()]
    }

    /// What is in the folder.
    #[must_use]
    pub fn contents(&self) -> Contents {
        Contents::new(self.skin, &self.mesh, self.counts(), self.hyperparameter, &self.arrays())
    }

    /// Writes all files; each is whole, and [`CONTENTS`] comes last. Other files are left alone.
    pub fn write(&self, folder: &Path) -> Result<(), ExportError> {
        remove_contents(folder)?;
        let (contents, arrays) = (self.contents(), self.arrays());
        for array in &arrays {
            let path = folder.join(file_name(array));
            stream_whole(&path, |out| npy::write(out, &array.array))?;
        }
        stream_whole(&folder.join(MATLAB), |out| write_mat(out, &contents, &arrays))?;
        write_whole(&folder.join(GMSH), &msh(&self.mesh))?;
        write_whole(&folder.join(PLY), &ply(&self.mesh, &[])?)?;
        write_whole(&folder.join(STL), &stl(&self.mesh))?;
        write_whole(&folder.join(STIMULATION), table_csv(&self.steps).as_bytes())?;
        Ok(write_whole(&folder.join(CONTENTS), contents.json().as_bytes())?)
    }

    /// Every array.
    #[must_use]
    pub fn arrays(&self) -> Vec<Variable<'_>> {
        let mut arrays = self.mesh_arrays();
        match &self.solution {
            Solution::Real(untouched) => arrays.extend(untouched.arrays(self.mesh.elements.len())),
            Solution::Complex(untouched) => arrays.extend(untouched.arrays(self.mesh.elements.len())),
        }
        arrays.extend(self.stimulation_arrays());
        arrays.extend(self.inverse_arrays());
        arrays.extend(pixel_arrays(&self.pixels));
        arrays
    }

    fn mesh_arrays(&self) -> Vec<Variable<'_>> {
        let mesh = &self.mesh;
        let points = electrode_rows(mesh, |contact| match contact {
            ElectrodeContact::Node(node) => vec![[*node]],
            _ => vec![],
        });
        let edges = electrode_rows(mesh, |contact| match contact {
            ElectrodeContact::Edges(edges) => edges.clone(),
            _ => vec![],
        });
        let faces = electrode_rows(mesh, |contact| match contact {
            ElectrodeContact::Faces(faces) => faces.clone(),
            _ => vec![],
        });
        let sheet = SheetTensors::new(&self.skin.material, mesh);
        let is_uniform = sheet.tensor(0).is_none();
        let tensor = (!is_uniform).then(|| {
            let part = move |element: usize, part: usize| {
                let [row, column] = TENSOR_PARTS[part];
                sheet.tensor(element).map_or(0.0, |tensor| tensor[(row, column)])
            };
            Variable::table("sheet_tensor", mesh.elements.len(), TENSOR_PARTS.len(), part).means(
                "",
                "[element][xx, yy, zz, xy, xz, yz]: conductivity tensor that `conductivity` multiplies",
            )
        });
        let arrays = vec![
            Variable::table("nodes", mesh.nodes.len(), 3, |node, axis| mesh.nodes[node][axis])
                .means("m", "[node][x, y, z]"),
            Variable::table("elements", mesh.elements.len(), 3, |element, corner| {
                mesh.elements[element][corner]
            })
            .means("", "[element][corner]: nodes of each triangle"),
            rows_array("electrode_points", points).means("", "electrode, node: of the point model"),
            rows_array("electrode_edges", edges)
                .means("", "electrode, node, node: edges under the electrodes of the complete model"),
            rows_array("electrode_faces", faces)
                .means("", "electrode, node, node, node: triangles under electrodes inside the skin"),
            Variable::list("contact_impedance", self.contact_impedance.len(), |e| self.contact_impedance[e])
                .means("m", "[electrode]: ohm m times the sheet conductivity; empty for the point model"),
        ];
        arrays.into_iter().chain(tensor).collect()
    }

    fn stimulation_arrays(&self) -> Vec<Variable<'_>> {
        let combination = &self.combination;
        let steps: Vec<[u8; 4]> = self.steps.iter().map(|step| step.to_bytes()).collect();
        vec![
            Variable::table("stimulation", steps.len(), 4, move |step, pin| usize::from(steps[step][pin]))
                .means("", "[step][drive_plus, drive_minus, sense_plus, sense_minus]: electrodes"),
            Variable::list("step_measurement", combination.len(), |s| {
                usize::from(combination[s].measurement)
            })
            .means("", "[step]: measurement that the step is averaged into"),
            Variable::list(
                "step_sign",
                combination.len(),
                |s| if combination[s].flipped { -1_i64 } else { 1 },
            )
            .means("", "[step]: sign with which it is averaged"),
        ]
    }

    fn inverse_arrays(&self) -> Vec<Variable<'_>> {
        let prior = self
            .prior
            .iter()
            .flat_map(|prior| entry_arrays(["prior_row", "prior_col", "prior_value"], prior));
        let prior = prior.map(|array| array.means("", "R, pixel by pixel, entry by entry"));
        let inverse = [
            Variable::list("weights", self.weights.len(), |m| self.weights[m])
                .means("", "[measurement]: diagonal of W for voltages in the unit of `voltages`"),
            Variable::matrix("reconstruction_matrix", &self.reconstruction_matrix)
                .means("", "[pixel][measurement]: relative conductivity change from difference data"),
        ];
        prior.chain(inverse).collect()
    }
}

impl<T: Admittivity + Number> Untouched<T> {
    fn new(solved: Solved<T>, elements: usize) -> Result<Self, ForwardError> {
        let Solved { admittivity, forward, voltages, jacobian } = solved;
        let system_matrix = summed(forward.system_matrix(&vec![admittivity; elements])?);
        Ok(Self { admittivity, system_matrix, voltages, jacobian })
    }

    fn arrays(&self, elements: usize) -> impl Iterator<Item = Variable<'_>> {
        let names = ["system_matrix_row", "system_matrix_col", "system_matrix_value"];
        let system_matrix = entry_arrays(names, &self.system_matrix)
            .map(|array| array.means("", "admittance between unknowns, entry by entry, ground included"));
        let others = [
            Variable::list("conductivity", elements, |_| self.admittivity)
                .means("", "[element]: relative admittivity of the untouched skin"),
            Variable::list("voltages", self.voltages.len(), |step| self.voltages[step])
                .means(RELATIVE_VOLTS, "[step]: of the untouched skin; times volts_per_unit: V"),
            Variable::matrix("jacobian", &self.jacobian).means(
                RELATIVE_VOLTS,
                "[step][pixel]: change of voltage with the pixel's relative conductivity",
            ),
        ];
        system_matrix.into_iter().chain(others)
    }
}

fn entry_arrays<'a, T: Number>(names: [&'static str; 3], entries: &'a Entries<T>) -> [Variable<'a>; 3] {
    let [row, column, value] = names;
    [
        Variable::list(row, entries.len(), |entry| entries[entry].0),
        Variable::list(column, entries.len(), |entry| entries[entry].1),
        Variable::list(value, entries.len(), |entry| entries[entry].2),
    ]
}

fn write_mat(out: &mut dyn io::Write, contents: &Contents, arrays: &[Variable<'_>]) -> io::Result<()> {
    mat::write_header(out)?;
    for variable in arrays.iter().filter(|variable| mat::fits(&variable.array)) {
        mat::write_array(out, variable.name, &variable.array)?;
    }
    mat::write_array(out, "ground", &Array::list(1, |_| contents.ground))?;
    mat::write_array(out, "volts_per_unit", &Array::list(1, |_| contents.volts_per_unit))?;
    mat::write_array(out, "hyperparameter", &Array::list(1, |_| contents.hyperparameter))?;
    mat::write_text(out, "skin", &contents.skin)?;
    mat::write_text(out, "electrode_model", contents.electrode_model)
}

/// What each electrode touches, with the electrode: `[row]`.
fn electrode_rows<const N: usize>(
    mesh: &Mesh,
    touched: impl Fn(&ElectrodeContact) -> Vec<[usize; N]>,
) -> Vec<(usize, [usize; N])> {
    let of = |(electrode, contact)| touched(contact).into_iter().map(move |nodes| (electrode, nodes));
    mesh.electrodes.iter().enumerate().flat_map(of).collect()
}

/// Rows of an electrode and its nodes.
fn rows_array<const N: usize>(name: &'static str, rows: Vec<(usize, [usize; N])>) -> Variable<'static> {
    Variable::table(name, rows.len(), 1 + N, move |row, column| match column {
        0 => rows[row].0,
        _ => rows[row].1[column - 1],
    })
}

fn pixel_arrays(pixels: &Pixels) -> Vec<Variable<'_>> {
    let parts: Vec<(usize, usize, f64)> = pixels
        .elements
        .iter()
        .enumerate()
        .flat_map(|(pixel, parts)| parts.iter().map(move |&(element, share)| (pixel, element, share)))
        .collect();
    let parts = Rc::new(parts);
    let [pixel, element, share] = [parts.clone(), parts.clone(), parts];
    vec![
        Variable::table("pixel_centre", pixels.count(), 3, |pixel, axis| pixels.centres[pixel][axis])
            .means("m", "[pixel][x, y, z]: centre of gravity"),
        Variable::table("pixel_normal", pixels.count(), 3, |pixel, axis| pixels.normals[pixel][axis])
            .means("", "[pixel][x, y, z]: unit normal of the surface"),
        Variable::list("pixel_area", pixels.count(), |pixel| pixels.areas[pixel]).means("m^2", "[pixel]"),
        Variable::list("pixel_element_pixel", pixel.len(), move |entry| pixel[entry].0)
            .means("", "which elements make up which pixel: the pixel"),
        Variable::list("pixel_element_element", element.len(), move |entry| element[entry].1)
            .means("", "the element"),
        Variable::list("pixel_element_share", share.len(), move |entry| share[entry].2)
            .means("", "share of the element's area that lies in the pixel"),
    ]
}

/// While files are replaced, nothing may say that the folder is complete.
fn remove_contents(folder: &Path) -> Result<(), ExportError> {
    let path = folder.join(CONTENTS);
    match std::fs::remove_file(&path) {
        Err(reason) if reason.kind() != io::ErrorKind::NotFound => Err(ExportError::Remove { path, reason }),
        _ => Ok(()),
    }
}
