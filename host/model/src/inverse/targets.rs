//! Targets: what the model simulates for the inverse. A standard target in the middle of the skin,
//! on which hyperparameters are chosen and noise figures stated; training targets for GREIT; moving
//! electrodes.

use super::movement::{self, Movement};
use crate::{
    forward::{Admittivity, Fields, ForwardModel},
    inverse::InverseError,
    jacobian::{combine_rows, combine_voltages, jacobian},
    pixels::{Pixels, element_patches, samples},
    skin::{Criterion, Hyperparameter, Inverse, Method},
};
use dermatome_geometry::mesh::{Mesh, triangle};
use dermatome_shared::{patch::CombinedInto, stimulation::Step};
use faer::Mat;
use nalgebra::{Point3, Vector3};

/// Radius of the standard target as a share of half the skin's larger side.
pub const TARGET_RADIUS: f64 = 0.1;
/// Relative change of conductivity of the standard target where a frame of it is simulated: it
/// doubles.
pub const TARGET_CHANGE: f64 = 1.0;
/// Training targets of GREIT; EIDORS' `mk_GREIT_model` takes as many.
pub const TRAINING_TARGETS: usize = 1000;

/// How measurements respond to the targets, in model volts.
#[derive(Clone, Debug)]
pub struct Responses {
    /// d voltage / d relative conductivity of the standard target: `[measurement]`.
    pub target: Vec<f64>,
    /// Change of voltage when the target's conductivity doubles, where a criterion needs it:
    /// `[measurement]`.
    pub frame: Option<Vec<f64>>,
    /// GREIT's training targets.
    pub training: Option<Training>,
    /// Movement of the electrodes, where it is asked for or all are on the rim.
    pub movement: Option<Movement>,
}

/// GREIT's training targets: element patches, of about equal area all over the skin.
#[derive(Clone, Debug)]
pub struct Training {
    /// Where each target lies, m: `[target]`.
    pub centres: Vec<Point3<f64>>,
    /// Area of each target, m^2: `[target]`.
    pub areas: Vec<f64>,
    /// d voltage / d relative conductivity of each target: `[measurement][target]`.
    pub responses: Mat<f64>,
    /// Half the skin's larger side, m.
    pub half_side: f64,
}

/// The forward solution of an untouched skin.
pub struct Untouched<'a, T: Admittivity> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Its forward model.
    pub forward: &'a ForwardModel<T>,
    /// Relative admittivity of the skin.
    pub admittivity: T,
    /// Its fields.
    pub fields: &'a Fields<T>,
    /// Stimulation table.
    pub steps: &'a [Step],
}

impl Responses {
    /// Simulates what `inverse` needs; the measurements are those of `combination`.
    pub fn simulate<T: Admittivity>(
        of: &Untouched<'_, T>,
        inverse: &Inverse,
        combination: &[CombinedInto],
    ) -> Result<Self, InverseError> {
        let elements = central_target(of.mesh);
        let combined = |matrix: Mat<T>| {
            let in_phase = Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)].in_phase());
            combine_rows(&in_phase, combination)
        };
        let target = combined(jacobian(of.mesh, of.fields, of.steps, &single(elements.clone())));
        let needs_frame = match inverse.hyperparameter {
            Hyperparameter::Fixed(_) | Hyperparameter::Chosen(Criterion::NoiseFigure(_)) => false,
            Hyperparameter::Chosen(_) => true,
        };
        let frame = needs_frame.then(|| frame(of, &elements)).transpose()?;
        let training = matches!(inverse.method, Method::Greit { .. }).then(|| {
            let patches = element_patches(of.mesh, TRAINING_TARGETS);
            let responses = combined(jacobian(of.mesh, of.fields, of.steps, &patches));
            Training {
                centres: patches.centres,
                areas: patches.areas,
                responses,
                half_side: half_side(of.mesh),
            }
        });
        let is_on_rim = movement::are_on_rim(of.mesh);
        let movement = (is_on_rim || inverse.electrode_movement.is_some()).then(|| {
            let per_metre = movement::jacobian(of.mesh, of.admittivity, of.fields, of.steps);
            Movement { responses: combined(per_metre) * faer::Scale(half_side(of.mesh)), is_on_rim }
        });
        Ok(Self {
            target: target.col(0).iter().copied().collect(),
            frame: frame.map(|frame| combine_voltages(&frame, combination)),
            training,
            movement,
        })
    }
}

/// Change of voltage when the conductivity of some elements doubles: `[step]`.
fn frame<T: Admittivity>(of: &Untouched<'_, T>, target: &[(usize, f64)]) -> Result<Vec<f64>, InverseError> {
    let mut admittivity = vec![of.admittivity; of.mesh.elements.len()];
    for &(element, share) in target {
        admittivity[element] = admittivity[element] + T::from(TARGET_CHANGE * share);
    }
    let fields = of.forward.solve(&admittivity)?;
    Ok(of.steps.iter().map(|&step| (fields.voltage(step) - of.fields.voltage(step)).in_phase()).collect())
}

/// Elements of a ball round the middle of the skin, with the share of each that lies in it.
#[must_use]
pub fn central_target(mesh: &Mesh) -> Vec<(usize, f64)> {
    let centre = mesh_centre(mesh);
    let radius = TARGET_RADIUS * half_side(mesh);
    let near = |corners: [Point3<f64>; 3]| {
        let count = samples(corners).count();
        samples(corners).filter(|point| (point - centre).norm() < radius).count() as f64 / count as f64
    };
    // An element as far away as its longest edges reach has no part in the ball.
    let may_be_near = |[a, b, c]: [Point3<f64>; 3]| {
        (a - centre).norm() <= radius + 1.001 * (b - a).norm().max((c - a).norm())
    };
    let shares = (0..mesh.elements.len())
        .filter(|&element| may_be_near(mesh.corners(element)))
        .map(|element| (element, near(mesh.corners(element))));
    let inside: Vec<_> = shares.filter(|(_, share)| *share > 0.0).collect();
    if inside.is_empty() { vec![(nearest_element(mesh, centre), 1.0)] } else { inside }
}

/// The place on the skin that is closest to its centre of gravity.
fn mesh_centre(mesh: &Mesh) -> Point3<f64> {
    let (mut moment, mut total) = (Vector3::zeros(), 0.0);
    for element in 0..mesh.elements.len() {
        let area = triangle::area(mesh.corners(element));
        moment += triangle::centroid(mesh.corners(element)).coords * area;
        total += area;
    }
    let gravity = Point3::from(moment / total);
    let closest = mesh.elements[nearest_element(mesh, gravity)];
    let [a, b, c] = mesh.points(closest);
    let normal = triangle::normal([a, b, c]);
    let middle = triangle::centroid([a, b, c]);
    // In the plane of that element, so that the centre of a flat skin is the centre itself.
    gravity - normal * normal.dot(&(gravity - middle))
}

fn nearest_element(mesh: &Mesh, point: Point3<f64>) -> usize {
    let distance = |element: &usize| (triangle::centroid(mesh.corners(*element)) - point).norm_squared();
    (0..mesh.elements.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// Half the larger side of the box round a mesh, m.
#[must_use]
pub fn half_side(mesh: &Mesh) -> f64 {
    let side = |axis: usize| {
        let places = || mesh.nodes.iter().map(|node| node[axis]);
        places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
    };
    (0..3).map(side).fold(0.0, f64::max) / 2.0
}

/// Some elements as a single pixel, of which only the Jacobian is wanted.
fn single(elements: Vec<(usize, f64)>) -> Pixels {
    Pixels {
        elements: vec![elements],
        neighbours: Vec::new(),
        centres: Vec::new(),
        normals: Vec::new(),
        areas: Vec::new(),
        grid: None,
    }
}
