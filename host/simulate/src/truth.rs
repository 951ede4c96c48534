//! The true skin: solved on a mesh of its own, never on the one its images are reconstructed with.

use dermatome_geometry::mesh::{Lattice, Mesh, refine, triangle};
use dermatome_model::{
    forward::{Admittivity, Fields, ForwardModel, SheetTensors},
    indenter::Press,
    model::{ModelError, forward_model, mesh},
    pixels::samples,
    skin::{Shape, Skin},
};
use dermatome_shared::stimulation::Step;
use nalgebra::Point3;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Triangles of the true skin are this much smaller than the reconstruction's, along an edge.
const FINENESS: f64 = 0.66;
/// Least relative conductivity of an element.
pub(super) const LEAST: f64 = 0.01;
/// The lattice is turned and shifted against the reconstruction's.
const LATTICE: Lattice = Lattice { angle: 0.35, shift: 0.37 };

/// A skin whose voltages can be solved for any conductivity.
#[derive(Debug)]
pub struct TrueSkin {
    mesh: Mesh,
    forward: Forward,
    /// Carrier frequency of the skin file, Hz.
    frequency: f64,
}

/// Forward model of a sheet without or with capacitance.
#[derive(Debug)]
enum Forward {
    Real(Box<ForwardModel<f64>>),
    /// With the relative susceptance of the sheet for each hertz, which presses leave as it is.
    Complex(Box<ForwardModel<Complex64>>, f64),
}

impl TrueSkin {
    /// Meshes a skin; an imported mesh is refined instead, which keeps its nodes.
    pub fn new(skin: &Skin) -> Result<Self, ModelError> {
        Self::of_mesh(skin, true_mesh(skin)?)
    }

    /// The same skin once its nodes have moved, `[node]`, m: a sheet that is stretched, or electrodes that slip. `skin` is
    /// the one it was made of. Its elements stay, so that nothing else changes.
    pub fn moved(&self, skin: &Skin, nodes: Vec<Point3<f64>>) -> Result<Self, ModelError> {
        Self::of_mesh(skin, Mesh { nodes, ..self.mesh.clone() })
    }

    fn of_mesh(skin: &Skin, mesh: Mesh) -> Result<Self, ModelError> {
        let forward = match skin.admittivity() {
            admittivity if admittivity.im == 0.0 => Forward::Real(Box::new(forward_model(skin, &mesh)?)),
            admittivity => {
                let per_hertz = admittivity.im / skin.drive.frequency;
                Forward::Complex(Box::new(forward_model(skin, &mesh)?), per_hertz)
            }
        };
        Ok(Self { mesh, forward, frequency: skin.drive.frequency })
    }

    /// The same with other contacts, at a frequency, Hz, that need not be the skin file's, and stretched along x by this
    /// share. `contact_impedance`, ohm m, `[electrode]`, is not used by point electrodes.
    pub fn with_contacts(
        skin: &Skin,
        contact_impedance: &[Complex64],
        frequency: f64,
        stretch: f64,
    ) -> Result<Self, ModelError> {
        let mut mesh = true_mesh(skin)?;
        mesh.nodes.iter_mut().for_each(|node| node.x *= 1.0 + stretch);
        let forward = forward_with(skin, &mesh, contact_impedance, frequency)?;
        Ok(Self { mesh, forward, frequency })
    }

    /// Its mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// In-phase voltages at unit current: `[step]`. `conductivity`, `[element]`, is relative and must
    /// be above zero.
    #[must_use]
    pub fn voltages(&self, conductivity: &[f64], steps: &[Step]) -> Vec<f64> {
        self.phasors(conductivity, steps, self.frequency).into_iter().map(|voltage| voltage.re).collect()
    }

    /// Voltages at unit current of this frequency, Hz: `[step]`.
    #[must_use]
    pub fn phasors(&self, conductivity: &[f64], steps: &[Step], frequency: f64) -> Vec<Complex64> {
        match &self.forward {
            Forward::Real(model) => {
                let fields = solve(model, conductivity);
                fields.voltages(steps).into_iter().map(Complex64::from).collect()
            }
            Forward::Complex(model, per_hertz) => {
                solve(model, &admittivity(conductivity, per_hertz * frequency)).voltages(steps)
            }
        }
    }

    /// Potential of each electrode for unit current into each and out of one node, relative:
    /// `[electrode][electrode driven]`. `conductivity` as in [`Self::voltages`].
    #[must_use]
    pub fn transfer(&self, conductivity: &[f64]) -> Vec<Vec<Complex64>> {
        self.transfer_at(conductivity, self.frequency)
    }

    /// The same for a current of this frequency, Hz.
    #[must_use]
    pub fn transfer_at(&self, conductivity: &[f64], frequency: f64) -> Vec<Vec<Complex64>> {
        match &self.forward {
            Forward::Real(model) => transfer(&solve(model, conductivity), Complex64::from),
            Forward::Complex(model, per_hertz) => {
                transfer(&solve(model, &admittivity(conductivity, per_hertz * frequency)), |value| value)
            }
        }
    }

    /// Relative conductivity of each element under these presses: `[element]`.
    #[must_use]
    pub fn conductivity(&self, presses: &[Press]) -> Vec<f64> {
        // Presses that overlap may not make the sheet vanish.
        self.sums(presses, Press::change_at).map(|change| (1.0 + change).max(LEAST)).collect()
    }

    /// The highest point of the skin at x, y, m; beside the skin the nearest node's.
    #[must_use]
    pub fn lay(&self, [x, y]: [f64; 2]) -> Point3<f64> {
        let elements = 0..self.mesh.elements.len();
        let points = elements.filter_map(|element| triangle::point_above(self.mesh.corners(element), [x, y]));
        points.max_by(|a, b| a.z.total_cmp(&b.z)).unwrap_or_else(|| {
            let away = |node: &Point3<f64>| (node.x - x).hypot(node.y - y);
            let nearest = self.mesh.nodes.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            Point3::new(x, y, nearest.map_or(0.0, |node| node.z))
        })
    }

    /// Mean pressure on each element, Pa: `[element]`.
    #[must_use]
    pub fn pressure(&self, presses: &[Press]) -> Vec<f64> {
        self.sums(presses, Press::pressure_at).collect()
    }

    /// What presses add up to: `[element]`.
    fn sums(&self, presses: &[Press], of: fn(&Press, [f64; 2]) -> f64) -> impl Iterator<Item = f64> {
        let laid: Vec<_> = presses.iter().map(|press| (press, self.lay(press.position))).collect();
        (0..self.mesh.elements.len())
            .map(move |element| laid.iter().map(|&(press, at)| self.mean_over(element, press, at, of)).sum())
    }

    /// Mean over an element of what a press round this point does.
    fn mean_over(
        &self,
        element: usize,
        press: &Press,
        centre: Point3<f64>,
        of: fn(&Press, [f64; 2]) -> f64,
    ) -> f64 {
        let corners = self.mesh.corners(element);
        let reach = corners.iter().map(|corner| (corner - centre).norm());
        let longest_edge = (corners[1] - corners[0]).norm().max((corners[2] - corners[0]).norm());
        if reach.fold(f64::INFINITY, f64::min) > press.footprint.reach() + longest_edge {
            return 0.0;
        }
        let (sum, count) = samples(corners).fold((0.0, 0.0), |(sum, count), point| {
            (sum + of(press, beside(press, centre, point)), count + 1.0)
        });
        sum / count
    }
}

/// Where a point of the skin lies for a press round `centre`: in its direction as seen from above, and as far
/// away as it is in space. On a flat skin that is where it is.
fn beside(press: &Press, centre: Point3<f64>, point: Point3<f64>) -> [f64; 2] {
    let away = point - centre;
    let seen = away.xy().norm();
    let stretch = if seen > 0.0 { away.norm() / seen } else { 1.0 };
    [press.position[0] + away.x * stretch, press.position[1] + away.y * stretch]
}

fn forward_with(
    skin: &Skin,
    mesh: &Mesh,
    contact_impedance: &[Complex64],
    frequency: f64,
) -> Result<Forward, ModelError> {
    let sheet = skin.material.sheet_conductivity;
    let susceptance = TAU * frequency * skin.material.sheet_capacitance / sheet;
    let relative: Vec<Complex64> = contact_impedance.iter().map(|z| z * sheet).collect();
    let tensors = SheetTensors::new(&skin.material, mesh);
    if susceptance == 0.0 && relative.iter().all(|z| z.im == 0.0) {
        let real: Vec<f64> = relative.iter().map(|z| z.re).collect();
        return Ok(Forward::Real(Box::new(ForwardModel::on_sheet(mesh, &real, tensors)?)));
    }
    let model = ForwardModel::on_sheet(mesh, &relative, tensors)?;
    Ok(Forward::Complex(Box::new(model), susceptance / frequency))
}

fn true_mesh(skin: &Skin) -> Result<Mesh, ModelError> {
    match &skin.shape {
        Shape::Sheet(_) => mesh(skin, FINENESS, LATTICE),
        Shape::Mesh { mesh, .. } => Ok(refine(mesh)),
    }
}

fn admittivity(conductivity: &[f64], susceptance: f64) -> Vec<Complex64> {
    conductivity.iter().map(|&sigma| Complex64::new(sigma, susceptance)).collect()
}

fn solve<T: Admittivity>(model: &ForwardModel<T>, admittivity: &[T]) -> Fields<T> {
    model.solve(admittivity).expect("a positive conductivity has a solution")
}

fn transfer<T: Admittivity>(fields: &Fields<T>, complex: impl Fn(T) -> Complex64) -> Vec<Vec<Complex64>> {
    let electrodes = 0..fields.electrodes();
    let row = |at| electrodes.clone().map(|driven| complex(fields.transfer(at, driven))).collect();
    electrodes.clone().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn square() -> Skin {
        Skin::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/square-50mm/skin.toml")))
            .unwrap()
            .made()
            .unwrap()
    }

    #[test]
    fn transfer_impedances_hold_the_voltages_of_every_step() {
        let (skin, press) = (square(), Press::finger([0.005, 0.002], 0.008, 1.0));
        let truth = TrueSkin::new(&skin).unwrap();
        let conductivity = truth.conductivity(&[press]);
        let transfer = truth.transfer(&conductivity);
        let steps = skin.steps();
        for (step, voltage) in steps.iter().zip(truth.voltages(&conductivity, &steps)) {
            let [plus, minus, high, low] = step.to_bytes().map(usize::from);
            let driven = |at: usize| transfer[at][plus] - transfer[at][minus];
            assert!((driven(high) - driven(low) - voltage).norm() < 1e-12);
        }
    }

    #[test]
    fn contacts_with_capacitance_turn_the_phase_of_their_own_electrode_only() {
        let skin = square();
        let contacts = vec![Complex64::new(25.0, -12.5); 16];
        let truth = TrueSkin::with_contacts(&skin, &contacts, 50e3, 0.0).unwrap();
        let transfer = truth.transfer(&truth.conductivity(&[]));
        let voltage = |at: usize, from: usize| {
            (transfer[at][4] - transfer[at][5]) - (transfer[from][4] - transfer[from][5])
        };
        assert!(voltage(4, 5).im < -0.03 * voltage(4, 5).re, "{}", voltage(4, 5));
        assert!(voltage(12, 13).im.abs() < 0.01 * voltage(12, 13).re.abs(), "{}", voltage(12, 13));
    }
}
